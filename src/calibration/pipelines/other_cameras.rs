//! Further cameras of a video or folder: frames that match none of a camera's frames belong to
//! another camera.

use crate::calibrate::add_camera_like;
use std::collections::BTreeMap;
use touchline_documents::document::{CameraId, Clip, Document};

/// Minimum number of frames for a separate camera.
pub(super) const MIN_FRAMES: usize = 6;

/// Assigns the frames `others`, and those between two of them, to a new camera without a base.
/// `camera` is the camera that they had, and `looked_at` are its sampled frames. Returns the new
/// id; none if there are too few others, or if they all lie in its shots.
pub(super) fn split_off(
    document: &mut Document,
    camera: &CameraId,
    looked_at: &[usize],
    others: &[usize],
) -> Option<CameraId> {
    if others.len() < MIN_FRAMES {
        return None;
    }
    // Assign the frames that were not sampled. A frame between two sampled frames of the new camera
    // goes to it. Before the first and after the last sampled frame, the nearest one decides.
    let mut is_other: BTreeMap<usize, bool> =
        looked_at.iter().map(|index| (*index, false)).collect();
    is_other.extend(others.iter().map(|index| (*index, true)));
    // One camera films a shot, so that its sampled frames decide for all its frames; in doubt those
    // of the camera that they had, whose frames match each other.
    let mut of_shot: BTreeMap<Clip, bool> = BTreeMap::new();
    for (index, is_other) in &is_other {
        if let Some(shot) = &document.frames[*index].clip {
            *of_shot.entry(shot.clone()).or_insert(true) &= *is_other;
        }
    }
    let mut of_new = Vec::new();
    for index in 0..document.frames.len() {
        // A sampled frame is its own neighbour on both sides, so it gets the camera that it was
        // found to have.
        let before = is_other
            .range(..=index)
            .next_back()
            .map(|(_, other)| *other);
        let after = is_other.range(index..).next().map(|(_, other)| *other);
        let frame = &document.frames[index];
        let of_shot = frame.clip.as_ref().and_then(|shot| of_shot.get(shot));
        let is_of_new = of_shot
            .copied()
            .unwrap_or_else(|| before.or(after) == Some(true) && after.or(before) == Some(true));
        if frame.camera == *camera && is_of_new {
            of_new.push(index);
        }
    }
    if of_new.is_empty() {
        return None;
    }
    // The next free id: main, main_2, main_3, …
    let mut number = 2;
    let id = loop {
        let id = CameraId::from(format!("{}_{number}", first_name(camera)).as_str());
        if document.camera(&id).is_none() {
            break id;
        }
        number += 1;
    };
    // Cameras of one video or folder stand in the same stadium: they share graphics and field.
    add_camera_like(document, &id, camera).ok()?;
    for index in of_new {
        document.frames[index].camera = id.clone();
    }
    Some(id)
}

/// The id of a camera without the number that [`split_off`] appends.
fn first_name(camera: &CameraId) -> &str {
    let name = camera.as_str();
    match name.rsplit_once('_') {
        Some((first, number)) if !first.is_empty() && number.parse::<u32>().is_ok() => first,
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Camera, FieldSpec};
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn frames_between_two_of_another_camera_are_its_own() {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        let mut main = Camera::new("main".into(), size);
        main.field = Some(FieldSpec::new("futsal"));
        document.cameras.push(main.into());
        for index in 0..24 {
            document
                .frames
                .push(new_frame(&format!("{index}.png"), size).into());
        }
        // Every second frame is sampled: 0 to 10 are one camera's, 12 to 22 another's.
        let looked_at: Vec<usize> = (0..12).step_by(2).collect();
        let others: Vec<usize> = (12..24).step_by(2).collect();
        assert_eq!(
            split_off(&mut document, &"main".into(), &looked_at, &others[1..]),
            None,
            "too few"
        );
        let id = split_off(&mut document, &"main".into(), &looked_at, &others).unwrap();
        assert_eq!(id.as_str(), "main_2");
        let field = &document.camera(&id).unwrap().field;
        assert_eq!(*field, document.cameras[0].field, "the same stadium");
        let of_other: Vec<usize> = (0..24)
            .filter(|index| document.frames[*index].camera == id)
            .collect();
        assert_eq!(
            of_other,
            (12..24).collect::<Vec<_>>(),
            "frame 11 may be either's"
        );
        // A shot is one camera's, although its last frames lie behind a frame of the other one.
        let mut shots = soccer_document();
        shots.cameras = document.cameras.clone();
        for index in 0..24 {
            let mut frame = document.frames[index].clone();
            frame.camera = "main".into();
            frame.clip = Some(Clip::Number(i64::from(index >= 9)));
            shots.frames.push(frame);
        }
        let others: Vec<usize> = (12..24).step_by(2).collect();
        let looked_at = [0, 4, 8];
        let of_shots = split_off(&mut shots, &"main".into(), &looked_at, &others).unwrap();
        let of_other = shots.frames.iter().filter(|frame| frame.camera == of_shots);
        assert_eq!(of_other.count(), 15, "frames 9 to 23");
        let third = split_off(&mut document, &id, &others[..0], &others).unwrap();
        assert_eq!(third.as_str(), "main_3");
    }
}
