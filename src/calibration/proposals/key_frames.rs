//! Key frames of videos: the forest is queried for these, and cameras are tracked from them to the
//! frames between.

use crate::calibrate::{ClipFrames, clips};
use touchline_documents::document::DocumentAt;
use touchline_vision::media::FrameRef;

/// Maximum number of pictures of a video between two key frames.
const EVERY: usize = 25;

/// If neighbouring frames of a document are this many pictures of the video apart, tracking costs
/// more than querying the forest.
const SPARSE: usize = 8;

/// Maximum number of key frames of a window, which is tracked at a time.
const OF_WINDOW: usize = 11;

/// A window of closely spaced frames of a video, from a key frame to a later one.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyWindow {
    /// All pictures of the video in the window.
    pub clip: ClipFrames,
    /// Indices of the key frames in the document.
    pub keys: Vec<usize>,
    /// Indices of the other frames in the document.
    pub between: Vec<usize>,
}

impl KeyWindow {
    /// The windows of a document. The forest is queried for every frame that belongs to none.
    pub fn from_document(at: DocumentAt<'_>) -> Vec<Self> {
        clips(at, None)
            .into_iter()
            .filter(|clip| {
                let first = clip.frames.first();
                first.is_some_and(|frame| matches!(frame.source, FrameRef::Video { .. }))
            })
            .flat_map(|clip| Self::from_clip(&clip))
            .collect()
    }

    /// The windows of one clip.
    fn from_clip(clip: &ClipFrames) -> Vec<Self> {
        // Positions in the clip of the document's frames, split where the document skips too many
        // pictures.
        let held: Vec<usize> = (0..clip.frames.len())
            .filter(|at| clip.frames[*at].place.is_some())
            .collect();
        held.chunk_by(|one, next| next - one < SPARSE)
            .flat_map(|run| Self::from_run(clip, run))
            .collect()
    }

    /// The windows of a run of closely spaced frames.
    fn from_run(clip: &ClipFrames, run: &[usize]) -> Vec<Self> {
        let (Some(&first), Some(&last)) = (run.first(), run.last()) else {
            return Vec::new();
        };
        // A frame becomes a key frame if the next one would be too far from the last key frame.
        // First and last frame are always key frames.
        let mut keys = vec![first];
        for (at, next) in run.iter().zip(&run[1..]) {
            if keys.last().is_some_and(|key| next - key > EVERY) {
                keys.push(*at);
            }
        }
        keys.push(last);
        keys.dedup();
        // Neighbouring windows share a key frame, so that no gap stays between them. Windows
        // without frames between keys are dropped.
        let starts = (0..keys.len().saturating_sub(1)).step_by(OF_WINDOW - 1);
        starts
            .filter_map(|start| {
                let keys = &keys[start..(start + OF_WINDOW).min(keys.len())];
                Self::from_keys(clip, run, keys)
            })
            .collect()
    }

    /// The window with these key frames of a run; none without a frame between them.
    fn from_keys(clip: &ClipFrames, run: &[usize], keys: &[usize]) -> Option<Self> {
        // The clip of a window has all pictures of the video between its keys, because points are
        // tracked from each to the next; only those that the document has get a camera.
        let (from, to) = (*keys.first()?, *keys.last()?);
        let between: Vec<usize> = run
            .iter()
            .filter(|&&at| (from..=to).contains(&at) && keys.binary_search(&at).is_err())
            .filter_map(|&at| clip.frames[at].place)
            .collect();
        if between.is_empty() {
            return None;
        }
        Some(Self {
            clip: ClipFrames {
                camera: clip.camera.clone(),
                frames: clip.frames[from..=to].to_vec(),
            },
            keys: keys
                .iter()
                .filter_map(|&at| clip.frames[at].place)
                .collect(),
            between,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::VideoFrame;
    use touchline_documents::testing::{WithFrames, new_frame, soccer_document};

    fn windows(numbers: impl IntoIterator<Item = u64>) -> Vec<KeyWindow> {
        let mut document = soccer_document();
        for number in numbers {
            let mut frame = new_frame("v.mp4", ImageSize::new(64, 36));
            frame.image = None;
            frame.video = Some(VideoFrame::new("v.mp4", number, None));
            document.frames.push(frame.into());
        }
        KeyWindow::from_document(document.at(Path::new("/f")))
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
        let document = soccer_document().with_numbered(50, ImageSize::new(64, 36));
        assert_eq!(KeyWindow::from_document(document.at(Path::new("/f"))), []);
    }
}
