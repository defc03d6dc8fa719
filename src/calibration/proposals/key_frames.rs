//! Key frames of videos: the forest is asked for these, and cameras are carried from them to the
//! frames between.

use crate::calibrate::{ClipFrame, ClipFrames, clips};
use touchline_documents::document::DocumentAt;
use touchline_vision::media::FrameRef;

/// Pictures of a video from one key frame to the next, at most.
const EVERY: usize = 25;

/// Where a document has fewer of a video's pictures than every so manieth, carrying costs more than
/// asking the forest.
const SPARSE: usize = 8;

/// Key frames of a window, at most: so many are carried between at a time.
const OF_WINDOW: usize = 11;

/// Frames of a video that follow each other closely, from a key frame to a later one.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyWindow {
    /// All its pictures.
    pub clip: ClipFrames,
    /// The key frames, by their places in the document.
    pub keys: Vec<usize>,
    /// The other frames of the document, by their places.
    pub between: Vec<usize>,
}

impl KeyWindow {
    /// The windows of a document; a frame that belongs to none is one for which the forest is
    /// asked.
    #[must_use]
    pub fn of(at: DocumentAt<'_>) -> Vec<Self> {
        let is_of_video = |clip: &ClipFrames| {
            matches!(
                clip.frames.first(),
                Some(ClipFrame {
                    source: FrameRef::Video { .. },
                    ..
                })
            )
        };
        clips(at, None)
            .into_iter()
            .filter(is_of_video)
            .flat_map(|clip| Self::of_clip(&clip))
            .collect()
    }

    fn of_clip(clip: &ClipFrames) -> Vec<Self> {
        // Places in the clip at which the document has a frame, cut where it leaves out too many
        // pictures.
        let held: Vec<usize> = (0..clip.frames.len())
            .filter(|at| clip.frames[*at].place.is_some())
            .collect();
        held.chunk_by(|one, next| next - one < SPARSE)
            .flat_map(|run| Self::of_run(clip, run))
            .collect()
    }

    /// The windows of frames that follow each other closely.
    fn of_run(clip: &ClipFrames, run: &[usize]) -> Vec<Self> {
        let (Some(&first), Some(&last)) = (run.first(), run.last()) else {
            return Vec::new();
        };
        let mut keys = vec![first];
        for (at, next) in run.iter().zip(&run[1..]) {
            if keys.last().is_some_and(|key| next - key > EVERY) {
                keys.push(*at);
            }
        }
        keys.push(last);
        keys.dedup();
        let place = |at: &usize| clip.frames[*at].place;
        let window = |keys: &[usize]| {
            let (from, to) = (*keys.first()?, *keys.last()?);
            let is_between =
                |at: &&usize| (from..=to).contains(at) && keys.binary_search(at).is_err();
            let between: Vec<usize> = run.iter().filter(is_between).filter_map(place).collect();
            let frames = clip.frames[from..=to].to_vec();
            let clip = ClipFrames {
                camera: clip.camera.clone(),
                frames,
            };
            (!between.is_empty()).then(|| Self {
                clip,
                keys: keys.iter().filter_map(place).collect(),
                between,
            })
        };
        let starts = (0..keys.len().saturating_sub(1)).step_by(OF_WINDOW - 1);
        starts
            .filter_map(|start| window(&keys[start..(start + OF_WINDOW).min(keys.len())]))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Document, FieldSpec, Frame, VideoFrame};

    fn windows(numbers: impl IntoIterator<Item = u64>) -> Vec<KeyWindow> {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for number in numbers {
            let mut frame = Frame::from_image("v.mp4", "main".into(), ImageSize::new(64, 36));
            frame.image = None;
            frame.video = Some(VideoFrame::new("v.mp4", number, None));
            document.frames.push(frame.into());
        }
        KeyWindow::of(document.at(Path::new("/f")))
    }

    #[test]
    fn key_frames_are_a_second_apart_and_everything_else_lies_between() {
        let windows = windows(0..600);
        assert_eq!(windows.len(), 3);
        assert_eq!(windows[0].keys, (0..=250).step_by(25).collect::<Vec<_>>());
        assert_eq!(
            windows[1].keys.first(),
            Some(&250),
            "the next window goes on where this one ends"
        );
        assert_eq!(windows[2].keys, [500, 525, 550, 575, 599]);
        let mut all: Vec<usize> = windows
            .iter()
            .flat_map(|window| [&window.keys[..], &window.between].concat())
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all, (0..600).collect::<Vec<_>>());
        assert!(
            windows
                .iter()
                .all(|window| window.clip.frames.len() == window.keys.len() + window.between.len())
        );
    }

    #[test]
    fn pictures_that_the_document_leaves_out_are_counted_and_far_ones_end_a_window() {
        let every_fifth = windows((0..60).step_by(5).chain([900, 901]));
        assert_eq!(every_fifth.len(), 1, "two frames have nothing between");
        assert_eq!(every_fifth[0].keys, [0, 5, 10, 11]);
        assert_eq!(every_fifth[0].clip.frames.len(), 56);
        assert_eq!(
            windows((0..600).step_by(10)),
            [],
            "carrying over nine pictures costs more than asking"
        );
        assert_eq!(windows([]), []);
        assert_eq!(windows([4, 5]), []);
    }

    #[test]
    fn images_are_no_video() {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for number in 0..50 {
            let frame = Frame::from_image(
                &format!("{number}.jpg"),
                "main".into(),
                ImageSize::new(64, 36),
            );
            document.frames.push(frame.into());
        }
        assert_eq!(KeyWindow::of(document.at(Path::new("/f"))), []);
    }
}
