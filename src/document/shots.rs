//! Frames by shot: what one camera filmed without a cut.

use super::{CameraId, Clip, Document, Extra, FrameId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A shot of a video as a document lists it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// Its first frame.
    pub from: ShotEnd,
    /// Its last frame.
    pub to: ShotEnd,
    /// The camera that filmed it, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraId>,
    /// How it was found.
    pub kind: ShotKind,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Where a shot begins or ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ShotEnd {
    /// A frame of the video, counted from 0.
    VideoFrame(u64),
    /// A frame of the document.
    Frame(FrameId),
}

/// How a shot was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShotKind {
    /// By a hard cut.
    Cut,
    /// By a cross-fade.
    Fade,
    /// A person marked it.
    ByHand,
}

/// The frames of every shot, by their places and in their order; the shots in the order in which they begin. Frames of a
/// camera that belong to no shot are one.
#[must_use]
pub fn shots(document: &Document) -> Vec<Vec<usize>> {
    let mut known: BTreeMap<(&CameraId, Option<&Clip>), usize> = BTreeMap::new();
    let mut shots: Vec<Vec<usize>> = Vec::new();
    for (index, frame) in document.frames.iter().enumerate() {
        let shot = *known.entry((&frame.camera, frame.clip.as_ref())).or_insert(shots.len());
        match shots.get_mut(shot) {
            Some(frames) => frames.push(index),
            None => shots.push(vec![index]),
        }
    }
    shots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{FieldSpec, Frame};
    use crate::geometry::ImageSize;

    #[test]
    fn frames_of_two_cameras_taken_in_turns_are_two_shots() {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for (camera, clip) in [("a", Some(1)), ("b", Some(1)), ("a", Some(1)), ("a", None), ("b", Some(2)), ("a", None)]
        {
            let mut frame = Frame::from_image("x.jpg", camera.into(), ImageSize::new(64, 36));
            frame.clip = clip.map(Clip::Number);
            document.frames.push(frame.into());
        }
        assert_eq!(shots(&document), [vec![0, 2], vec![1], vec![3, 5], vec![4]]);
    }
}
