//! Updates frames that were solved with another base or field than the merged document has.
//!
//! A merge takes a frame from one side and may take its camera from the other. The frame's clicks
//! remain valid, but its solution was computed for another base. Clicked frames are solved again.
//! Frames without clicks keep their lines in place on the picture as well as the new base allows,
//! and mere proposals are withdrawn.

use super::follow_base::follow_base;
use super::refit::refit;
use crate::calibrate::frames::solve_frames::{is_by_clicks, solve_by_clicks};
use std::path::Path;
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldError;
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, Document, FieldSpec, Frame};

/// Numbers of frames that a merge put onto another base or field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolvedAfterMerge {
    /// Frames that were solved again from their clicks.
    pub solved: usize,
    /// Frames without clicks whose lines were kept in place.
    pub refitted: usize,
    /// Proposals that were withdrawn.
    pub withdrawn: usize,
}

/// Updates the frames of a merged document that come from a side with another base or field. A
/// frame that is on no side was solved for an unknown base, so it is solved again. `folder` is the
/// document's.
///
/// # Errors
/// A field of the document is not valid; no clicked frame is solved then.
pub fn solve_after_merge(
    document: &mut Document,
    sides: &[&Document],
    folder: &Path,
) -> Result<SolvedAfterMerge, FieldError> {
    let mut done = SolvedAfterMerge::default();
    let mut clicked = Vec::new();
    // By index, because following a base changes the document while the loop runs.
    for index in 0..document.frames.len() {
        let frame = &document.frames[index];
        // A frame is up to date if one of the sides with the same frame has the merged document's
        // base and field.
        let origins: Vec<&Document> = sides
            .iter()
            .copied()
            .filter(|side| holds_frame(side, frame))
            .collect();
        let ground = Ground::under(document, frame);
        if origins
            .iter()
            .any(|side| Ground::under(side, frame) == ground)
        {
            continue;
        }
        if is_by_clicks(frame) {
            clicked.push(index);
        } else if let (Some(origin), true) = (origins.first(), frame.ptz.is_some()) {
            // The side's camera shows where the lines were on the picture.
            let before = with_cameras_of(document, origin);
            if follow_base(document, index, &before) {
                done.withdrawn += 1;
            } else {
                // `follow_base` may have refitted the frame; to refit it again changes nothing.
                refit(document, index, &before);
                done.refitted += 1;
            }
        }
    }
    // Clicked frames come last and all at once. Where the clicks of a frame fit two cameras its
    // neighbours decide, and these are then on their new base.
    if !clicked.is_empty() {
        done.solved = solve_by_clicks(document, folder, &clicked, &Progress::default())?;
    }
    Ok(done)
}

/// The base and the field that a frame's solution depends on.
#[derive(PartialEq)]
struct Ground<'a> {
    base: Option<CameraBase>,
    field: &'a FieldSpec,
}

impl<'a> Ground<'a> {
    fn under(document: &'a Document, frame: &Frame) -> Self {
        let base = document.camera_of(frame).and_then(Camera::base);
        Self {
            base,
            field: document.field_of(frame),
        }
    }
}

/// Whether a document contains a frame with the same contents.
fn holds_frame(document: &Document, frame: &Frame) -> bool {
    document
        .frames
        .by_id(&frame.id)
        .is_some_and(|known| known.has_content_of(frame))
}

/// A document's frames with the cameras of another.
fn with_cameras_of(document: &Document, origin: &Document) -> Document {
    Document {
        cameras: origin.cameras.clone(),
        ..document.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{FrameLookup, calibrate};
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::{SIZE, TestBase, base_at, soccer};
    use touchline_documents::document::{Click, FrameStatus, SolutionSource, merge};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at, solved_by};

    fn base(x_m: f64) -> CameraBase {
        base_at([x_m, -62.0, 17.0], SIZE)
    }

    /// Two untouched frames.
    fn document() -> Document {
        let mut document = match_from(&base(1.0), SIZE);
        document.frames = ["a", "b"]
            .map(|name| new_frame(name, SIZE).into())
            .into_iter()
            .collect();
        document
    }

    /// Clicks two landmarks where a camera at `x_m` sees them, and solves and accepts the frame.
    fn click(document: &mut Document, index: usize, x_m: f64) {
        let field = soccer();
        let camera = base(x_m).aim(-4.0, -14.0, 2300.0);
        for landmark in ["centre_mark", "halfway_far"] {
            let world = field.landmark_in_world(field.landmark(landmark).unwrap());
            let at = camera.image_from_world(world).unwrap();
            document.frames[index]
                .clicks
                .push(Click::landmark(landmark.into(), at));
        }
        let solved = calibrate(
            document,
            &FrameLookup::from_document(document),
            &document.frames[index].clone(),
            &field,
            index,
        )
        .unwrap();
        document.frames[index].record(&solved);
        document.frames[index].status = FrameStatus::Reference;
    }

    fn pan_deg(document: &Document, index: usize) -> f64 {
        document.frames[index].ptz.as_ref().unwrap().pan_deg
    }

    #[test]
    fn a_reference_is_solved_again_on_the_base_that_the_merge_took() {
        let (start, folder) = (document(), Path::new(""));
        let (mut ours, mut theirs) = (start.clone(), start.clone());
        click(&mut ours, 0, 1.0);
        theirs.cameras[0].set_base(&base(9.0));
        let mut merged = merge(&start, &ours, &theirs).document;
        assert_eq!(
            pan_deg(&merged, 0),
            pan_deg(&ours, 0),
            "the merge alone keeps what the old base gave"
        );
        let done = solve_after_merge(&mut merged, &[&ours, &theirs], folder).unwrap();
        assert_eq!(
            (done.solved, merged.frames[0].status),
            (1, FrameStatus::Reference)
        );
        let again = calibrate(
            &merged,
            &FrameLookup::from_document(&merged),
            &merged.frames[0],
            &soccer(),
            0,
        );
        assert!((pan_deg(&merged, 0) - again.unwrap().ptz.pan.degrees()).abs() < 1e-9);
        assert!((pan_deg(&merged, 0) - pan_deg(&ours, 0)).abs() > 1.0);
    }

    #[test]
    fn a_frame_of_too_few_clicks_is_not_counted_as_solved() {
        let (start, folder) = (document(), Path::new(""));
        let (mut ours, mut theirs) = (start.clone(), start.clone());
        click(&mut ours, 0, 1.0);
        let single = ours.frames[0].clicks[0].clone();
        ours.frames[1].clicks.push(single);
        theirs.cameras[0].set_base(&base(9.0));
        let mut merged = merge(&start, &ours, &theirs).document;
        let done = solve_after_merge(&mut merged, &[&ours, &theirs], folder).unwrap();
        assert_eq!(done.solved, 1);
    }

    #[test]
    fn what_stands_on_its_own_base_stays() {
        let (start, folder) = (document(), Path::new(""));
        let (mut ours, mut theirs) = (start.clone(), start.clone());
        click(&mut ours, 0, 1.0);
        click(&mut theirs, 1, 1.0);
        let mut merged = merge(&start, &ours, &theirs).document;
        let before = merged.clone();
        let done = solve_after_merge(&mut merged, &[&ours, &theirs], folder).unwrap();
        assert_eq!((done, merged), (SolvedAfterMerge::default(), before));
    }

    #[test]
    fn an_accepted_proposal_keeps_its_lines() {
        let (start, folder) = (document(), Path::new(""));
        let (mut ours, mut theirs) = (start.clone(), start.clone());
        let frame = &mut ours.frames[0];
        frame.ptz = ptz_at(-4.0, -14.0, 2300.0);
        frame.solution = solved_by(SolutionSource::Forest);
        frame.status = FrameStatus::Reference;
        theirs.cameras[0].set_base(&base(4.0));
        let mut merged = merge(&start, &ours, &theirs).document;
        let done = solve_after_merge(&mut merged, &[&ours, &theirs], folder).unwrap();
        assert_eq!((done.refitted, done.withdrawn), (1, 0));
        let ground = Vec3::new(3.0, 10.0, 0.0);
        let at = |document: &Document| {
            document
                .ptz_camera(&document.frames[0])
                .unwrap()
                .image_from_world(ground)
                .unwrap()
        };
        assert!(
            at(&merged).distance_px(at(&ours)) < 12.0,
            "{:?} {:?}",
            at(&merged),
            at(&ours)
        );
    }
}
