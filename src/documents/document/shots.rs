//! The frames of a document by shot.

use super::{CameraId, Clip, Document};
use std::collections::BTreeMap;

/// The frames of every shot, by their indices and in order; the shots in the order in which they
/// begin. Frames of one camera without a shot form one.
pub fn shots(document: &Document) -> Vec<Vec<usize>> {
    let mut known: BTreeMap<(&CameraId, Option<&Clip>), usize> = BTreeMap::new();
    let mut shots: Vec<Vec<usize>> = Vec::new();
    for (index, frame) in document.frames.iter().enumerate() {
        let shot = *known
            .entry((&frame.camera, frame.clip.as_ref()))
            .or_insert(shots.len());
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
    use crate::document::Frame;
    use crate::testing::soccer_document;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn frames_of_two_cameras_taken_in_turns_are_two_shots() {
        let mut document = soccer_document();
        for (camera, clip) in [
            ("a", Some(1)),
            ("b", Some(1)),
            ("a", Some(1)),
            ("a", None),
            ("b", Some(2)),
            ("a", None),
        ] {
            let mut frame = Frame::from_image("x.jpg", camera.into(), ImageSize::new(64, 36));
            frame.clip = clip.map(Clip::Number);
            document.frames.push(frame.into());
        }
        assert_eq!(shots(&document), [vec![0, 2], vec![1], vec![3, 5], vec![4]]);
    }
}
