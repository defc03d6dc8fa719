//! Applies edits whose base is unknown to another document. Edits contain the new state of a frame,
//! but not its previous one.
//!
//! Without the base, changes of the edits cannot be distinguished from changes of the document. So
//! work is never lost: a frame with clicks or a decision is replaced only by another such frame.
//! Every frame with contents that is replaced, or that is kept although the edits differ, is
//! reported.

use super::merge::show_suggestions;
use crate::document::{Camera, Change, Document, Edit, Frame, FrameId, Merged, Shared};
use std::collections::BTreeMap;

/// Puts the frames of edits into a document that is not their base. Frames that the edits removed
/// stay, because they are not known; frames with only a suggestion, and changes of existing cameras
/// and of the field, are not applied.
pub fn graft(edits: &[Edit], onto: &Document) -> Merged {
    // Suggestions are removed on both sides, so that only people's work is compared. Those of
    // `onto` return at the end, in frames that are still untouched.
    let mut document = onto.without_suggestions();
    let mut conflicts = add_new_cameras(edits, &mut document);
    let mut places = Places::default();
    for (place, known) in document.frames.iter().enumerate() {
        places.add(known, place);
    }
    for edited in last_frames(edits) {
        let frame = edited.without_suggestion();
        let place = places.find(&frame);
        let Some(known) = place.and_then(|place| document.frames.get_mut(place)) else {
            let place = document.frames.len();
            document.frames.push(frame.into());
            places.add(&document.frames[place], place);
            continue;
        };
        // The document's frame keeps its id, to which other edits refer, and its revision, which
        // `count_edits_since` raises below if the frame changes.
        let is_earlier = frame.revision < known.revision;
        let frame = Frame {
            id: known.id.clone(),
            revision: known.revision,
            ..frame
        };
        if frame == **known || has_only_picture(&frame) {
            continue;
        }

        // Report every frame with contents that differs; replace it only if no work is lost, and
        // never by a state with fewer edits.
        if !has_only_picture(known) {
            conflicts.push(known.name());
        }
        if !is_earlier && (has_work(&frame) || !has_work(known)) {
            *known = frame.into();
        }
    }
    show_suggestions(&mut document, [onto, onto]);
    document.count_edits_since(onto);
    Merged {
        document,
        conflicts,
    }
}

/// The positions of a document's frames. A search among the frames themselves for each of many new
/// ones would take a time that grows with the square of their number.
#[derive(Default)]
struct Places {
    by_id: BTreeMap<FrameId, usize>,
    by_name: BTreeMap<String, usize>,
}

impl Places {
    fn add(&mut self, frame: &Frame, place: usize) {
        self.by_id.entry(frame.id.clone()).or_insert(place);
        self.by_name.entry(frame.name()).or_insert(place);
    }

    /// The position of the frame with the same id, else of one with the same picture, to which
    /// another program may have given another id.
    fn find(&self, frame: &Frame) -> Option<usize> {
        let same_id = self.by_id.get(&frame.id).copied();
        same_id.or_else(|| self.by_name.get(&frame.name()).copied())
    }
}

/// The last state of each frame in the edits, in the order of first occurrence.
fn last_frames(edits: &[Edit]) -> Vec<&Shared<Frame>> {
    let frames = edits
        .iter()
        .flat_map(|edit| &edit.changes)
        .flat_map(|change| match change {
            Change::Frame { frame, .. } => std::slice::from_ref(frame),
            Change::Insert { frames, .. } => frames,
            Change::Remove(_)
            | Change::Order(_)
            | Change::Cameras(_)
            | Change::Field(_)
            | Change::Rest { .. } => &[],
        });
    let mut places: BTreeMap<&FrameId, usize> = BTreeMap::new();
    let mut last: Vec<&Shared<Frame>> = Vec::new();
    for frame in frames {
        let place = *places.entry(&frame.id).or_insert(last.len());
        if place == last.len() {
            last.push(frame);
        } else {
            last[place] = frame;
        }
    }
    last
}

/// Adds the cameras that the document lacks, because new frames may refer to them. Returns the
/// names of cameras that differ, and of the field if it differs.
fn add_new_cameras(edits: &[Edit], document: &mut Document) -> Vec<String> {
    // A change states all cameras, or the whole field, so the last one says what the edits lead to.
    // Differences are only named: without the base, it is not known which side changed.
    let cameras: &[Shared<Camera>] = changes_from_last(edits)
        .find_map(|change| {
            if let Change::Cameras(cameras) = change {
                Some(&cameras[..])
            } else {
                None
            }
        })
        .unwrap_or_default();
    let mut differing = Vec::new();
    for camera in cameras {
        match document.camera(&camera.id) {
            None => document.cameras.push(camera.clone()),
            Some(known) if *known == **camera => {}
            Some(_) => differing.push(format!("camera {}", camera.id)),
        }
    }
    let field = changes_from_last(edits).find_map(|change| {
        if let Change::Field(field) = change {
            Some(field)
        } else {
            None
        }
    });
    if field.is_some_and(|field| *field != document.field) {
        differing.push("the field".to_owned());
    }
    differing
}

/// The changes of the edits, the last one first.
fn changes_from_last(edits: &[Edit]) -> impl Iterator<Item = &Change> {
    edits
        .iter()
        .rev()
        .flat_map(|edit| edit.changes.iter().rev())
}

/// Whether the user clicked in a frame, gave it a camera or decided on it.
fn has_work(frame: &Frame) -> bool {
    !frame.is_untouched()
}

/// Whether a frame is as it was created, without any work of the user.
fn has_only_picture(frame: &Frame) -> bool {
    // The listed keys state which frame it is, or come with the picture. Whatever else differs from
    // a new frame is work, also a key that is added to the type later.
    let Frame {
        id,
        revision,
        image,
        camera,
        video,
        sha256,
        image_size,
        clip,
        extra,
        ..
    } = frame.clone();
    let made = Frame {
        id,
        revision,
        image,
        video,
        sha256,
        clip,
        extra,
        ..Frame::from_image("", camera, image_size)
    };
    made == *frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, FrameStatus, SolutionSource};
    use crate::testing::{SMALL, document, names_and_comments};
    use crate::testing::{new_frame, ptz_at, solved_by};
    use touchline_core::geometry::ImagePoint;

    fn accept(frame: &mut Frame, x: f64) {
        frame
            .clicks
            .push(Click::without_name(ImagePoint::new(x, 1.0)));
        frame.status = FrameStatus::Reference;
    }

    fn propose(frame: &mut Frame) {
        frame.ptz = ptz_at(1.0, -9.0, 900.0);
        frame.status = FrameStatus::Suggested;
        frame.solution = solved_by(SolutionSource::Forest);
    }

    #[test]
    fn edits_of_an_unknown_document_bring_their_frames() {
        let base = document(&["a", "b"]);
        let mut ours = base.clone();
        ours.frames[1].comment = Some(" ours".to_owned());
        ours.frames.push(new_frame("new", SMALL).into());
        let edits = [Edit::between(&base, &ours, "Both")];
        let theirs = document(&["b", "z"]);
        let Merged {
            document,
            conflicts,
        } = graft(&edits, &theirs);
        assert_eq!(
            (names_and_comments(&document), conflicts.len()),
            (["b ours", "z", "new"].map(str::to_owned).to_vec(), 0)
        );
    }

    #[test]
    fn a_proposal_takes_no_label_away() {
        let base = document(&["a", "b", "c"]);
        let mut proposed = base.clone();
        proposed.frames.iter_mut().for_each(|frame| propose(frame));
        let edits = [Edit::between(&base, &proposed, "Proposals for 3 frames")];
        let mut now = base;
        accept(&mut now.frames[0], 1.0);
        now.frames[1].status = FrameStatus::Rejected;
        assert_eq!(
            graft(&edits, &now),
            Merged {
                document: now,
                conflicts: Vec::new()
            }
        );
    }

    #[test]
    fn a_frame_that_gives_way_and_one_that_does_not_are_named() {
        let base = document(&["a", "b", "c"]);
        let mut ours = base.clone();
        accept(&mut ours.frames[0], 1.0);
        ours.frames[1].comment = Some(" ours".to_owned());
        let mut now = base.clone();
        accept(&mut now.frames[0], 2.0);
        accept(&mut now.frames[1], 2.0);
        propose(&mut now.frames[2]);
        let Merged {
            document,
            conflicts,
        } = graft(&[Edit::between(&base, &ours, "Two")], &now);
        assert_eq!(conflicts, ["a", "b"]);
        assert_eq!(document.frames[0].clicks, ours.frames[0].clicks);
        assert_eq!(
            document.frames[1].clicks, now.frames[1].clicks,
            "a comment takes no clicks away"
        );
        assert_eq!(
            document.frames[2], now.frames[2],
            "what was suggested is shown again"
        );
    }

    #[test]
    fn cameras_of_new_frames_come_along_and_others_are_named() {
        let base = document(&["a"]);
        let mut ours = base.clone();
        ours.cameras[0].click_noise_px = Some(3.0);
        ours.cameras
            .push(Camera::new("second".into(), SMALL).into());
        ours.field.template = "futsal".to_owned();
        let Merged {
            document,
            conflicts,
        } = graft(&[Edit::between(&base, &ours, "Cameras")], &base);
        assert_eq!(conflicts, ["camera main", "the field"]);
        assert_eq!(
            (document.cameras.len(), document.cameras[0].click_noise_px),
            (2, None)
        );
    }
}
