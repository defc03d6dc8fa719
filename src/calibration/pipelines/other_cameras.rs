//! Further cameras of a video or folder: frames that match none of a camera's frames belong to
//! another camera, and so do shots that match them although the camera does not answer them.

use super::kept_search::SearchEnd;
use crate::calibrate::add_camera_like;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use touchline_documents::document::{CameraId, Clip, Document};

/// Minimum number of frames for a separate camera.
pub(super) const MIN_FRAMES: usize = 6;

/// The searched frames that are most likely of other cameras, in parts of one each, if the search
/// had frames of several. Cameras of one stadium match where both see the far stands.
pub(super) fn frames_of_others(
    document: &Document,
    end: &SearchEnd,
    is_found: bool,
) -> Vec<Vec<usize>> {
    let shot_of = |index: &usize| document.frames[*index].clip.as_ref();
    let in_shots = |is_in: &dyn Fn(&Clip) -> bool| -> Vec<usize> {
        let searched = end.searched.iter().copied();
        searched
            .filter(|index| shot_of(index).is_some_and(is_in))
            .collect()
    };
    if end.agreeing.len() >= MIN_FRAMES {
        // Shots of which no frame lies on the lines of the best camera.
        let agreeing: BTreeSet<&Clip> = end.agreeing.iter().filter_map(shot_of).collect();
        vec![in_shots(&|shot| !agreeing.contains(shot))]
    } else if is_found {
        Vec::new()
    } else {
        let parts = parts_by_best_link(document, end).into_iter().skip(1);
        parts
            .map(|part| in_shots(&|shot| part.contains(shot)))
            .collect()
    }
}

/// The shots of the searched frames, in parts that are most likely of one camera each, the largest
/// first: each shot is in one part with the shot that its own frames match best.
fn parts_by_best_link<'a>(document: &'a Document, end: &SearchEnd) -> Vec<BTreeSet<&'a Clip>> {
    let shot_of = |place: usize| document.frames[end.searched[place]].clip.as_ref();
    let mut best: BTreeMap<&Clip, (usize, &Clip)> = BTreeMap::new();
    for ([one, other], agreeing) in &end.links {
        let (Some(one), Some(other)) = (shot_of(*one), shot_of(*other)) else {
            continue;
        };
        for (from, to) in [(one, other), (other, one)] {
            let known = best.get(from).map_or(0, |(most, _)| *most);
            if from != to && *agreeing > known {
                best.insert(from, (*agreeing, to));
            }
        }
    }
    let mut parts: Vec<BTreeSet<&Clip>> = Vec::new();
    for (shot, (_, linked)) in best {
        let mut joined = BTreeSet::from([shot, linked]);
        parts.retain(|part| {
            let is_apart = part.is_disjoint(&joined);
            if !is_apart {
                joined.extend(part);
            }
            is_apart
        });
        parts.push(joined);
    }
    parts.sort_by_key(|part| Reverse(part.len()));
    parts
}

/// Assigns the frames `others`, and those between two of them, to a new camera without a base.
/// `camera` is the camera that they had, and `looked_at` are its sampled frames, `others` among them
/// or not. Returns the new id; none if there are too few others, or if they all lie in its shots.
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
    fn a_refused_group_falls_into_the_shots_that_match_best() {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        for index in 0..20 {
            let mut frame = new_frame(&format!("{index}.png"), size);
            frame.clip = Some(Clip::Number(index / 4));
            document.frames.push(frame.into());
        }
        // Shots 0, 1 and 3 are one camera's, 2 and 4 another's; all see the same stands.
        let same = [(0, 1, 60), (1, 3, 44), (2, 4, 90)];
        let stands = [(0, 2, 40), (1, 4, 42), (3, 4, 30)];
        let links = same.into_iter().chain(stands);
        let end = SearchEnd {
            searched: (0..20).collect(),
            links: links
                .map(|(one, other, points)| ([4 * one, 4 * other], points))
                .collect(),
            ..SearchEnd::default()
        };
        let others: Vec<usize> = (8..12).chain(16..20).collect();
        assert_eq!(frames_of_others(&document, &end, false), [others]);
        assert!(frames_of_others(&document, &end, true).is_empty());
        // Where frames agree with the best camera, they say which shots are another one's.
        let agreeing = (0..8).collect();
        let of_known = SearchEnd { agreeing, ..end };
        let rest: Vec<usize> = (8..20).collect();
        assert_eq!(frames_of_others(&document, &of_known, true), [rest]);
    }

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
