//! The shots of a document's videos: found, and written into the document.

use super::kept_work::KeptWork;
use crate::calibrate::kept::kept;
use crate::proposals::{PictureStream, read_picture};
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::geometry::{ImagePoint, PixelBox, subsample};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{
    Document, FoundCuts, ShotContent, ShotKind, VideoShots, shots_of_frames,
};
use touchline_vision::media::{Picture, ReadFrames};
use touchline_vision::paint::{GroundPicture, MarkingPixels};
use touchline_vision::track::{FoundCut, find_cuts};

/// Maximum number of pictures of a shot that say what it shows.
const LOOKED_AT: usize = 3;

/// Minimum share of the pixels of a shot's pictures that are marking pixels, where a field is in
/// view, at this width. Main cameras of soccer give 0.0032 and more, players before turf at most
/// 0.0006; of two drawn broadcasts cameras of the field 0.0014 and more, spectators 0.0005.
const LEAST_PAINT: f64 = 0.0008;
const PAINT_WIDTH_PX: f64 = 1280.0;

/// Minimum share of a picture that is ground, where a field is in view. The main cameras above give
/// 0.67 and more; courts fill less of a picture.
const LEAST_GROUND: f64 = 0.1;

kept! {
    FoundCut { frame, transition }
}

/// The boundaries of shots that a search found, as a document lists them: the first frame of each
/// transition and of each shot but the first one.
pub fn shot_starts(cuts: &[FoundCut]) -> Vec<(u64, ShotKind)> {
    let mut starts = Vec::new();
    for cut in cuts {
        if cut.is_gradual() {
            starts.push((cut.transition.start as u64, ShotKind::Transition));
            starts.push((cut.frame as u64, ShotKind::Fade));
        } else {
            starts.push((cut.frame as u64, ShotKind::Cut));
        }
    }
    starts
}

/// Finds the shots of those videos of a document that have none yet, and what they show, and
/// writes them into it. Videos of which it lacks frames stay without: where a shot ends is seen
/// between neighbouring frames only. `folder` is where the document's relative paths start.
///
/// Returns the number of shots that were found, with those of other videos; after a cancellation
/// the document has the shots of the videos that were finished.
pub(super) fn mark_shots(
    document: &mut Document,
    folder: &Path,
    reader: &mut dyn ReadFrames,
    work: &KeptWork,
    progress: &Progress<'_, Share>,
) -> usize {
    for (video, frames) in videos_without_shots(document) {
        let key = work.begin_key("cuts").and_then(|mut parts| {
            for (_, index) in &frames {
                let picture = document.frames[*index].picture_source(folder);
                parts.add_picture(picture.as_ref());
            }
            parts.finish()
        });
        let cuts = if let Some(kept) = key.as_ref().and_then(|key| work.recall(key)) {
            kept
        } else {
            let at = document.at(folder);
            let pictures = PictureStream::new(at, frames.iter().map(|(_, at)| *at))
                .with_reader(&mut *reader)
                .with_progress(progress.part(|share| share));
            let cuts = find_cuts(pictures.map(|frame| frame.picture.ok()));
            if let Some(key) = key.filter(|_| !progress.is_cancelled()) {
                work.keep(&key, &cuts);
            }
            cuts
        };
        let (Some((last, _)), false) = (frames.last(), progress.is_cancelled()) else {
            break;
        };
        let found = FoundCuts {
            last: *last,
            cuts: &shot_starts(&cuts),
            known: &[],
        };
        VideoShots::from_search(document, &video, found).write(document);
    }
    if !progress.is_cancelled() {
        mark_contents(document, folder, reader, work, progress);
    }
    let shots = document.shots.iter();
    shots
        .filter(|shot| shot.kind != ShotKind::Transition)
        .count()
}

/// The videos that have no shots yet and of which the document has every frame from the first one,
/// by name, with the numbers of their frames and the frames' indices in order.
fn videos_without_shots(document: &Document) -> Vec<(String, Vec<(u64, usize)>)> {
    let mut videos: BTreeMap<&str, Vec<(u64, usize)>> = BTreeMap::new();
    for (index, frame) in document.frames.iter().enumerate() {
        if let Some(video) = &frame.video {
            let frames = videos.entry(video.path.as_str()).or_default();
            frames.push((video.frame_index, index));
        }
    }
    for frames in videos.values_mut() {
        frames.sort_unstable();
    }
    let wanted = videos.into_iter().filter(|(video, frames)| {
        let is_whole = frames
            .iter()
            .enumerate()
            .all(|(number, (frame, _))| *frame == number as u64);
        is_whole && VideoShots::from_document(document, video).is_none()
    });
    wanted
        .map(|(video, frames)| (video.to_owned(), frames))
        .collect()
}

/// Writes what each shot shows that does not say so yet.
fn mark_contents(
    document: &mut Document,
    folder: &Path,
    reader: &mut dyn ReadFrames,
    work: &KeptWork,
    progress: &Progress<'_, Share>,
) {
    let mut frames_of: Vec<Vec<usize>> = vec![Vec::new(); document.shots.len()];
    for (frame, shot) in shots_of_frames(document).into_iter().enumerate() {
        if let Some(shot) = shot {
            frames_of[shot].push(frame);
        }
    }
    for (index, frames) in frames_of.into_iter().enumerate() {
        let shot = &document.shots[index];
        if shot.content.is_some() || shot.kind == ShotKind::Transition {
            continue;
        }
        if progress.is_cancelled() {
            return;
        }
        let looked_at: Vec<usize> = subsample(frames, LOOKED_AT).collect();
        let key = work.begin_key("paint of shots").and_then(|mut parts| {
            for frame in &looked_at {
                let frame = &document.frames[*frame];
                parts.add_picture(frame.picture_source(folder).as_ref());
                parts.add(&document.masks_of(frame));
            }
            parts.finish()
        });
        let shown = if let Some(kept) = key.as_ref().and_then(|key| work.recall(key)) {
            kept
        } else {
            let looks = looked_at.iter().filter_map(|frame| {
                let frame = &document.frames[*frame];
                let picture = read_picture(&mut *reader, frame, folder).ok()?;
                Some(share_of_paint(&picture, &document.masks_of(frame)))
            });
            let shown: Vec<f64> = looks.collect();
            if let Some(key) = key {
                work.keep(&key, &shown);
            }
            shown
        };
        if !shown.is_empty() {
            // In the mean: one picture of a field is enough, and one of spectators in which a little
            // looks like paint is not.
            let mean = shown.iter().sum::<f64>() / shown.len() as f64;
            document.shots[index].content = Some(if mean >= LEAST_PAINT {
                ShotContent::Field
            } else {
                ShotContent::NoField
            });
        }
    }
}

/// The share of a picture's pixels that are marking pixels, at [`PAINT_WIDTH_PX`]; 0 where it shows
/// too little ground.
fn share_of_paint(picture: &Picture, masks: &[PixelBox]) -> f64 {
    let ground = GroundPicture::new(picture, masks);
    let size = ground.size();
    let marked = MarkingPixels::detect(&ground).points.len() as f64;
    let area = f64::from(size.width) * f64::from(size.height);
    // Marking pixels lie along the lines, so that their number grows with the width of a picture.
    if ground_share(&ground) >= LEAST_GROUND {
        marked * (f64::from(size.width) / PAINT_WIDTH_PX) / area
    } else {
        0.0
    }
}

/// The share of a picture that has the colours of its ground.
fn ground_share(ground: &GroundPicture) -> f64 {
    const STEPS: u32 = 40;
    let size = ground.size();
    let at = |step: u32, side: u32| (f64::from(step) + 0.5) / f64::from(STEPS) * f64::from(side);
    let count = (0..STEPS)
        .flat_map(|row| (0..STEPS).map(move |column| (column, row)))
        .filter(|(column, row)| {
            ground.is_ground(ImagePoint::new(
                at(*column, size.width),
                at(*row, size.height),
            ))
        })
        .count();
    count as f64 / f64::from(STEPS * STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Frame, VideoFrame};
    use touchline_documents::testing::soccer_document;

    #[test]
    fn a_transition_is_listed_with_its_two_ends() {
        let cut = |transition: std::ops::Range<usize>| FoundCut {
            frame: transition.end,
            transition,
        };
        assert_eq!(
            shot_starts(&[cut(7..7), cut(20..31)]),
            [
                (7, ShotKind::Cut),
                (20, ShotKind::Transition),
                (31, ShotKind::Fade)
            ]
        );
    }

    #[test]
    fn only_whole_videos_without_shots_are_searched() {
        let mut document = soccer_document();
        for (video, frames) in [
            ("whole.mp4", 0..4),
            ("marked.mp4", 0..4),
            ("late.mp4", 2..6),
        ] {
            for index in frames {
                let video = VideoFrame::new(video, index, None);
                let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
                document.frames.push(frame.into());
            }
        }
        VideoShots::from_cuts(&document, "marked.mp4", 3, &[]).write(&mut document);
        let wanted = videos_without_shots(&document);
        let frames = vec![(0, 0), (1, 1), (2, 2), (3, 3)];
        assert_eq!(wanted, [("whole.mp4".to_owned(), frames)]);
    }

    #[test]
    fn a_picture_of_one_colour_shows_no_field() {
        let picture = Picture::with_colour(ImageSize::new(320, 180), [60, 140, 60, 255]);
        assert!(share_of_paint(&picture, &[]) < LEAST_PAINT);
    }
}
