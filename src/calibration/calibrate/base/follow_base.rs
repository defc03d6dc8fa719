//! What happens to frames without clicks when their camera's base has changed.

use super::refit::refit;
use crate::calibrate::paint::{LINE_CHECK, replace_warning};
use std::collections::BTreeSet;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::Angle;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Camera, CameraId, Document, Frame, FrameStatus, Solution, SolutionSource,
};

/// Pans that differ by less are equal, degrees: the conversion to another gauge rounds.
const SAME_PAN_DEG: f64 = 1e-9;

/// The frames, by ascending index, whose camera has another base than in `before`, or that now
/// belong to another camera.
fn frames_with_changed_base(before: &Document, now: &Document) -> Vec<usize> {
    // If the lists of cameras are equal, no base has changed.
    let ids = now
        .cameras
        .iter()
        .filter(|_| before.cameras != now.cameras)
        .map(|camera| &camera.id);
    let moved: BTreeSet<&CameraId> = ids
        .filter(|id| {
            before.camera(id).and_then(Camera::base) != now.camera(id).and_then(Camera::base)
        })
        .collect();
    let given_away = now
        .frames
        .differences(&before.frames)
        .into_iter()
        .filter(|index| {
            let frame = &now.frames[*index];
            before
                .frames
                .get(*index)
                .is_some_and(|known| known.id == frame.id && known.camera != frame.camera)
        });
    if moved.is_empty() {
        return given_away.collect();
    }
    let mut frames: Vec<usize> = (0..now.frames.len())
        .filter(|index| moved.contains(&now.frames[*index].camera))
        .chain(given_away)
        .collect();
    frames.sort_unstable();
    frames.dedup();
    frames
}

/// Updates those of some frames (ascending indices) whose camera's base has changed since `before`;
/// returns the number of withdrawn proposals. `progress` counts proposals, before each is
/// processed. If it cancels this, the remaining frames are not updated.
pub(crate) fn follow_bases(
    document: &mut Document,
    before: &Document,
    places: &[usize],
    progress: &Progress<'_, ()>,
) -> usize {
    let mut moved = frames_with_changed_base(before, document);
    moved.retain(|index| places.binary_search(index).is_ok());
    follow_each(document, before, &moved, progress)
}

/// Updates all frames whose camera's base has changed since `before`; returns the number of
/// withdrawn proposals.
pub fn follow_all_bases(document: &mut Document, before: &Document) -> usize {
    let moved = frames_with_changed_base(before, document);
    follow_each(document, before, &moved, &Progress::default())
}

fn follow_each(
    document: &mut Document,
    before: &Document,
    moved: &[usize],
    progress: &Progress<'_, ()>,
) -> usize {
    let mut withdrawn = 0;
    for &index in moved {
        if document.frames[index].is_suggestion() && progress.report(()).is_break() {
            break;
        }
        withdrawn += usize::from(follow_base(document, index, before));
    }
    withdrawn
}

/// Updates a frame whose camera had another base in `before`. True if a proposal was withdrawn.
///
/// * An unaccepted proposal of the forest or of tracking is withdrawn; they propose again with the
///   new base.
/// * Any other camera that came from the picture is turned and zoomed so that its lines stay in
///   place on the picture. Its uncertainty is removed.
/// * A camera from clicks, a typed one, and one that was found with the new base are not changed.
pub(crate) fn follow_base(document: &mut Document, index: usize, before: &Document) -> bool {
    let Some(frame) = document.frames.get(index) else {
        return false;
    };
    // A camera that has changed since `before` was found with the new base.
    let is_of_old_base = before
        .frames
        .get(index)
        .is_some_and(|known| is_same_camera((&*document, &**frame), (before, &**known)));
    // A proposal that no person has accepted.
    if is_of_old_base && frame.is_suggestion() && frame.status != FrameStatus::Reference {
        withdraw(&mut document.frames[index]);
        return true;
    }
    // Any other camera that came from the picture.
    if is_of_old_base && follows_picture(frame) {
        refit(document, index, before);
        forget_certainty(&mut document.frames[index]);
    }
    // A later correction must not start from what was proposed with the old base.
    if keeps_proposal(&document.frames[index])
        && let Some(solution) = &mut document.frames[index].solution
    {
        solution.proposed = None;
    }
    false
}

/// Whether a frame has the same pan, tilt and focal length in two documents, with pan in the gauge
/// of each document's base: [`EstimatedBase::write_to`](crate::calibrate::EstimatedBase::write_to)
/// converts the pans of all frames to the gauge of the new base.
fn is_same_camera(now: (&Document, &Frame), before: (&Document, &Frame)) -> bool {
    let (Some(ptz), Some(known)) = (&now.1.ptz, &before.1.ptz) else {
        return now.1.ptz == before.1.ptz;
    };
    // The usual case, in which both bases are in the pan gauge of the conventions.
    if ptz == known {
        return true;
    }
    let [base, base_before] =
        [now, before].map(|(document, frame)| document.camera_of(frame).and_then(Camera::base));
    // The pan that looks in the same direction of the world from the present base. All other
    // numbers, known and unknown keys included, have to be equal to the last digit.
    let turned = known.ptz().pan + pan_turn(base_before.as_ref(), base.as_ref());
    let mut in_gauge = known.clone();
    in_gauge.pan_deg = ptz.pan_deg;
    in_gauge == *ptz && ptz.ptz().pan.turn_from(turned).degrees().abs() < SAME_PAN_DEG
}

/// What is added to a pan where the base changes, so that it looks in the same direction of the
/// world: pan zero is along the heading of the base. Zero unless there is a base before and after.
pub(super) fn pan_turn(before: Option<&CameraBase>, now: Option<&CameraBase>) -> Angle {
    before.zip(now).map_or(Angle::ZERO, |(before, now)| {
        before.angles().heading.turn_from(now.angles().heading)
    })
}

/// Whether a frame's camera came from its picture, or from those of its neighbours. One from clicks
/// is solved again; one that a person typed stays.
fn follows_picture(frame: &Frame) -> bool {
    use SolutionSource::{Forest, Import, Interpolated, Markings, Tracking};
    let is_of_picture = matches!(
        frame.source(),
        Some(Forest | Tracking | Markings | Import | Interpolated)
    );
    frame.ptz.is_some() && is_of_picture
}

/// Removes the uncertainty of a camera and the paint's verdict on it: both were computed with the
/// old base.
pub(super) fn forget_certainty(frame: &mut Frame) {
    let Some(solution) = &mut frame.solution else {
        return;
    };
    (
        solution.covariance,
        solution.own_covariance,
        solution.worst_corner_sigma_px,
    ) = (None, None, None);
    (
        solution.confidence,
        solution.line_check,
        solution.rms_px,
        solution.samples,
    ) = (None, None, None, None);
    replace_warning(solution, LINE_CHECK, None);
}

/// Removes what was proposed for a frame. The camera that another program gave it is kept.
pub(crate) fn withdraw(frame: &mut Frame) {
    frame.keep_imported();
    frame.ptz = None;
    let imported = frame.take_imported();
    frame.solution = imported.map(|imported| Solution {
        imported: Some(imported),
        ..Solution::default()
    });
    if frame.status != FrameStatus::Rejected {
        frame.status = frame.undecided_status();
    }
}

/// Whether the frame still stores the proposal that a person corrected.
fn keeps_proposal(frame: &Frame) -> bool {
    frame
        .solution
        .as_ref()
        .is_some_and(|solution| solution.proposed.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, Ptz};
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::{FramePtz, PaintEvidence};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    /// A frame on a base 17 m high, and the same document with the base 2 m higher.
    fn raised(source: Option<SolutionSource>, status: FrameStatus) -> (Document, Document) {
        let base = |height_m: f64| {
            let position_m = Vec3::new(0.0, -62.0, height_m);
            base_at(position_m, SIZE)
        };
        let mut document = match_from(&base(17.0), SIZE);
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(5.0, -14.0, 2300.0);
        let line_check = Some(PaintEvidence {
            score: 0.99,
            ..PaintEvidence::default()
        });
        frame.solution = Some(Solution {
            source,
            confidence: Some(0.98),
            line_check,
            ..Solution::default()
        });
        frame.status = status;
        document.frames.push(frame.into());
        let mut after = document.clone();
        after.cameras[0].set_base(&base(19.0));
        (document, after)
    }

    #[test]
    fn cameras_from_pictures_keep_their_lines_and_lose_their_certainty() {
        for (source, status) in [
            (SolutionSource::Markings, FrameStatus::Suggested),
            (SolutionSource::Markings, FrameStatus::Reference),
            (SolutionSource::Import, FrameStatus::Draft),
            (SolutionSource::Interpolated, FrameStatus::Suggested),
            (SolutionSource::Forest, FrameStatus::Reference),
        ] {
            let (before, mut after) = raised(Some(source), status);
            assert_eq!(follow_all_bases(&mut after, &before), 0, "{source:?}");
            let ground = Vec3::new(5.0, 3.0, 0.0);
            let at = |document: &Document| {
                document
                    .ptz_camera(&document.frames[0])
                    .unwrap()
                    .image_from_world(ground)
                    .unwrap()
            };
            let moved_px = at(&before).distance_px(at(&after));
            assert!(moved_px < 10.0, "{source:?} {status:?}: {moved_px}");
            let solution = after.frames[0].solution.as_ref().unwrap();
            assert_eq!(
                (solution.confidence, &solution.line_check),
                (None, &None),
                "{source:?} {status:?}"
            );
            assert_eq!(after.frames[0].status, status);
        }
    }

    #[test]
    fn what_proposes_again_is_withdrawn_and_typed_numbers_stay() {
        for source in [SolutionSource::Forest, SolutionSource::Tracking] {
            let (before, mut after) = raised(Some(source), FrameStatus::Suggested);
            assert_eq!(follow_all_bases(&mut after, &before), 1, "{source:?}");
            assert!(after.frames[0].ptz.is_none());
        }
        let (before, mut after) = raised(None, FrameStatus::Draft);
        follow_all_bases(&mut after, &before);
        assert_eq!(after.frames, before.frames);
    }

    #[test]
    fn a_proposal_whose_pan_was_turned_into_another_gauge_is_of_the_old_base() {
        let (mut before, mut after) = raised(Some(SolutionSource::Forest), FrameStatus::Suggested);
        let turned = BaseAngles {
            heading: Angle::from_degrees(20.0),
            ..BaseAngles::default()
        };
        let base = CameraBase {
            base_from_world: turned.base_from_world(),
            ..before.cameras[0].base().unwrap()
        };
        before.cameras[0].set_base(&base);
        let mut other = after.clone();
        for (document, pan_deg) in [(&mut after, 25.0), (&mut other, 26.0)] {
            let ptz = Ptz::from_degrees(pan_deg, -14.0, 2300.0);
            document.frames[0].ptz = Some(FramePtz::new(ptz, None));
        }
        assert_eq!(follow_all_bases(&mut after, &before), 1);
        assert_eq!(follow_all_bases(&mut other, &before), 0, "found since");
    }

    #[test]
    fn a_frame_that_was_found_with_the_new_base_is_not_touched() {
        let (before, mut after) = raised(Some(SolutionSource::Markings), FrameStatus::Suggested);
        after.frames[0].ptz = ptz_at(5.2, -15.0, 2350.0);
        let found = after.frames.clone();
        follow_all_bases(&mut after, &before);
        assert_eq!(after.frames, found);
    }
}
