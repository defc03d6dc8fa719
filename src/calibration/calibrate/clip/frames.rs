//! Which frames of a document form a sequence in time.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use touchline_documents::document::{
    CameraId, Clip, DocumentAt, FrameStatus, frames_in_transitions,
};
use touchline_vision::media::FrameRef;

/// A picture of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFrame {
    /// The file, and for a video the frame number.
    pub source: FrameRef,
    /// The index of the document's frame that shows it; none for a frame of a video that the
    /// document leaves out.
    pub place: Option<usize>,
}

/// Pictures of one camera that form a sequence in time.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFrames {
    /// The camera.
    pub camera: CameraId,
    /// In the order of time.
    pub frames: Vec<ClipFrame>,
}

/// The first and the last picture of a clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClipSpan {
    /// The first picture.
    pub first: FrameRef,
    /// The last picture.
    pub last: FrameRef,
    /// Number of pictures, these two included.
    pub num_pictures: usize,
}

impl ClipFrames {
    /// The first and the last picture; none if there are no pictures.
    pub fn span(&self) -> Option<ClipSpan> {
        let (first, last) = self.frames.first().zip(self.frames.last())?;
        let num_pictures = self.frames.len();
        Some(ClipSpan {
            first: first.source.clone(),
            last: last.source.clone(),
            num_pictures,
        })
    }
}

/// A clip ends where at least this number of consecutive frames of a video is missing from the
/// document: no camera can be propagated that far.
const GAP: usize = 300;

/// The clips of a document: the frames of each video, with the frames in between that the document
/// leaves out, and the images of each camera and shot in the document's order. Rejected frames
/// and those of transitions between shots belong to none. With `within`, only frames of a video
/// with these numbers and images at these indices count.
pub fn clips(document: DocumentAt<'_>, within: Option<&RangeInclusive<usize>>) -> Vec<ClipFrames> {
    type Key<'a> = (&'a CameraId, Option<&'a Clip>, Option<PathBuf>);
    let mut of_key: BTreeMap<Key<'_>, usize> = BTreeMap::new();
    let mut groups: Vec<(CameraId, Vec<(usize, FrameRef)>)> = Vec::new();
    let is_between_shots = frames_in_transitions(document.document);
    for (place, frame) in document.document.frames.iter().enumerate() {
        let Some(source) = frame.picture_source(document.folder) else {
            continue;
        };
        let number = video_frame_number(&source).unwrap_or(place);
        if frame.status == FrameStatus::Rejected
            || is_between_shots[place]
            || within.is_some_and(|within| !within.contains(&number))
        {
            continue;
        }
        let video = if let FrameRef::Video { path, .. } = &source {
            Some(path.to_path_buf())
        } else {
            None
        };
        // Clips are listed in the order in which their first frames appear in the document, not in
        // that of the map.
        let group = *of_key
            .entry((&frame.camera, frame.clip.as_ref(), video))
            .or_insert(groups.len());
        match groups.get_mut(group) {
            Some((_, frames)) => frames.push((place, source)),
            None => groups.push((frame.camera.clone(), vec![(place, source)])),
        }
    }
    groups
        .into_iter()
        .flat_map(|(camera, frames)| in_time(&camera, frames))
        .collect()
}

/// The clip that a frame of the document belongs to, by the frame's index.
pub fn clip_of_frame(document: DocumentAt<'_>, index: usize) -> Option<ClipFrames> {
    clips(document, None)
        .into_iter()
        .find(|clip| clip.frames.iter().any(|frame| frame.place == Some(index)))
}

/// Splits the frames of one video or folder into clips without large gaps, and adds the frames in
/// between that the document leaves out.
fn in_time(camera: &CameraId, mut frames: Vec<(usize, FrameRef)>) -> Vec<ClipFrames> {
    // A video is sorted by frame number, of equal numbers the first in the document is kept. Images
    // have no number and keep their order.
    frames.sort_by_key(|(place, source)| (video_frame_number(source), *place));
    frames.dedup_by_key(|(place, source)| video_frame_number(source).unwrap_or(*place));
    let mut clips: Vec<ClipFrames> = Vec::new();
    for (place, source) in frames {
        // The frame numbers that the document leaves out before this frame; none for images.
        let between = match (
            video_frame_number(&source),
            clips.last().and_then(|clip| clip.frames.last()),
        ) {
            (Some(index), Some(last)) => {
                video_frame_number(&last.source).map_or(0..0, |last| last + 1..index)
            }
            _ => 0..0,
        };
        // A gap of `GAP` frames or more begins a new clip.
        let clip = match clips.last_mut() {
            Some(clip) if between.len() < GAP => clip,
            _ => {
                clips.push(ClipFrames {
                    camera: camera.clone(),
                    frames: vec![ClipFrame {
                        source,
                        place: Some(place),
                    }],
                });
                continue;
            }
        };
        if let FrameRef::Video { path, .. } = &source {
            clip.frames.extend(between.map(|index| ClipFrame {
                source: FrameRef::Video {
                    path: path.clone(),
                    index,
                },
                place: None,
            }));
        }
        clip.frames.push(ClipFrame {
            source,
            place: Some(place),
        });
    }
    clips
}

/// The number of a frame in its video; none for an image.
fn video_frame_number(source: &FrameRef) -> Option<usize> {
    match source {
        FrameRef::Video { index, .. } => Some(*index),
        FrameRef::Image(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Document, ShotKind, VideoFrame, VideoShots};
    use touchline_documents::testing::{new_frame, soccer_document};

    fn document(frames: &[(&str, Option<u64>)]) -> Document {
        let mut document = soccer_document();
        for (path, index) in frames {
            let mut frame = new_frame(path, ImageSize::new(64, 36));
            if let Some(index) = index {
                frame.image = None;
                frame.video = Some(VideoFrame::new(path, *index, None));
            }
            document.frames.push(frame.into());
        }
        document
    }

    fn listed(
        document: &Document,
        within: Option<&RangeInclusive<usize>>,
    ) -> Vec<Vec<Option<usize>>> {
        let clips = clips(document.at(Path::new("/f")), within);
        clips
            .iter()
            .map(|clip| clip.frames.iter().map(|frame| frame.place).collect())
            .collect()
    }

    #[test]
    fn frames_of_a_video_are_in_the_order_of_time_with_those_between() {
        let document = document(&[
            ("v.mp4", Some(7)),
            ("v.mp4", Some(4)),
            ("w.mp4", Some(5)),
            ("v.mp4", Some(900)),
        ]);
        let clips = clips(document.at(Path::new("/f")), None);
        let frames: Vec<_> = clips[0]
            .frames
            .iter()
            .map(|frame| frame.source.to_string())
            .collect();
        assert_eq!(frames.len(), 4, "{frames:?}");
        assert_eq!(
            listed(&document, None),
            [
                vec![Some(1), None, None, Some(0)],
                vec![Some(3)],
                vec![Some(2)]
            ]
        );
        assert_eq!(
            listed(&document, Some(&(5..=8))),
            [vec![Some(0)], vec![Some(2)]]
        );
    }

    #[test]
    fn frames_of_a_transition_belong_to_no_clip() {
        let names: Vec<_> = (0..6).map(|number| ("v.mp4", Some(number))).collect();
        let mut document = document(&names);
        let cuts = [(2, ShotKind::Transition), (4, ShotKind::Fade)];
        VideoShots::from_cuts(&document, "v.mp4", 5, &cuts).write(&mut document);
        assert_eq!(
            listed(&document, None),
            [[Some(0), Some(1)], [Some(4), Some(5)]]
        );
    }

    #[test]
    fn images_keep_their_order_and_rejected_ones_are_left_out() {
        let mut document = document(&[("b.jpg", None), ("a.jpg", None), ("c.jpg", None)]);
        document.frames[1].status = FrameStatus::Rejected;
        assert_eq!(listed(&document, None), [[Some(0), Some(2)]]);
    }
}
