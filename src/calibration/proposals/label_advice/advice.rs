//! Advice on where to label next. All panels, the status row and the command line use it.
//!
//! A label helps frames with overlapping views, and most where few references look: each further
//! reference in one direction adds less. If the directions of a shot's frames are unknown, a label
//! in the shot with most such frames helps.

use super::label_needs::LabelNeeds;
use super::needing_frames::{DIRECTION_DEG, HorizontalView, NeedingFrames};
use crate::proposals::Coverage;
use touchline_core::geometry::{Angle, AngleRange};
use touchline_documents::document::{CameraId, Document};

/// Assumed overlap of the views of a shot's frames if their directions are unknown.
const BLIND_OVERLAP: f64 = 0.5;

/// The frames without a confident answer, and what to do about them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LabelAdvice {
    /// Number of frames without an answer.
    pub unanswered: usize,
    /// Number of suggestions that the forest is not sure of: see
    /// [`CERTAIN`](touchline_vision::relocalize::CERTAIN).
    pub uncertain: usize,
    /// The frame to label next; none if every frame has a confident answer or none of the others
    /// has a picture.
    pub next: Option<LabelNext>,
}

/// The frame to label next: its label helps many others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelNext {
    /// Index of the frame in the document.
    pub frame: usize,
    /// Its pan, from its own uncertain answer or from the frames around it, degrees; none if
    /// unknown.
    pub pan_deg: Option<f64>,
    /// Number of frames without a confident answer that share at least half of its view, or, if its
    /// pan is unknown, are in its shot and have no known direction either.
    pub shared_by: usize,
    /// Pan of the middle of the widest part of the field that no reference of its camera sees,
    /// degrees; none if all is seen or the coverage is unknown.
    pub missing_pan_deg: Option<f64>,
}

/// Advice for a document. `coverage` has the directions of the references of its cameras; a camera
/// may be missing.
pub fn label_advice(document: &Document, coverage: &[Coverage]) -> LabelAdvice {
    LabelAdvice::from_needs(&LabelNeeds::from_document(document), coverage)
}

impl LabelAdvice {
    /// The advice for the frames that need a label.
    pub fn from_needs(needs: &LabelNeeds, coverage: &[Coverage]) -> Self {
        let places = needs
            .needing()
            .filter_map(|(camera, needing)| best_place(needing, coverage_of(camera, coverage)));
        // Among equals the first camera by name, so that the order of frames does not matter.
        let place = places.rev().max_by(|a, b| a.0.total_cmp(&b.0));
        // Compare with the shot that has most frames of unknown direction, of which a label is
        // assumed to help a share.
        let blind = needs.unknown();
        let blind_gain = blind.map_or(0.0, |blind| BLIND_OVERLAP * blind.len() as f64);
        let mut next = match (place, blind) {
            (Some((gain, next)), _) if gain >= blind_gain => Some(next),
            (_, blind) => blind.and_then(|blind| {
                let (&frame, shared_by) = (blind.iter().nth(blind.len() / 2)?, blind.len());
                Some(LabelNext {
                    frame,
                    pan_deg: None,
                    shared_by,
                    missing_pan_deg: None,
                })
            }),
        };
        if let Some(next) = &mut next {
            let coverage = needs
                .camera_of(next.frame)
                .and_then(|camera| coverage_of(camera, coverage));
            next.missing_pan_deg = coverage.and_then(|coverage| coverage.missing_pan_deg);
        }
        Self {
            unanswered: needs.unanswered,
            uncertain: needs.uncertain,
            next,
        }
    }
}

/// The coverage of one of these cameras.
fn coverage_of<'a>(camera: &CameraId, coverage: &'a [Coverage]) -> Option<&'a Coverage> {
    coverage.iter().find(|coverage| coverage.camera == *camera)
}

/// The direction in which a label helps the frames of a camera most, and its gain: the expected
/// number of frames that would be answered because of it. None if no frame sees the field.
fn best_place(needing: &NeedingFrames, coverage: Option<&Coverage>) -> Option<(f64, LabelNext)> {
    let (mut whole, mut half_view_deg) = (0.0, 0.0);
    let mut weights: Vec<(i64, f64)> = Vec::new();
    // The weight of a direction: how much its frames need a label, times how new the view is.
    for (to, direction) in needing.directions() {
        let half_view = direction.half_view();
        // Without a known coverage every view is new. A view that shows no field gets no weight: a
        // label there helps nowhere.
        let novelty = coverage.map_or(Some(1.0), |coverage| {
            coverage.novelty(AngleRange::around(HorizontalView::towards(to), half_view))
        });
        let Some(weight) = novelty.map(|novelty| novelty * direction.need()) else {
            continue;
        };
        weights.push((to, weight));
        (whole, half_view_deg) = (whole + weight, half_view_deg + weight * half_view.degrees());
    }
    // The mean width of a view. Where no frame has a weight it is 0 / 0, and `max` returns the
    // width of a direction in place of NaN.
    let view_deg = (2.0 * half_view_deg / whole).max(DIRECTION_DEG);
    // Of equal gains, the smallest pan.
    let gains = weights
        .iter()
        .map(|&(at, _)| (gain_of_label(at, &weights, view_deg), at));
    let (gain, at) = gains.rev().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let chosen = needing.neediest(at)?;
    let next = LabelNext {
        frame: chosen.frame,
        pan_deg: Some(chosen.look.pan.degrees()),
        shared_by: needing.within(chosen.look.pan, Angle::from_degrees(view_deg / 2.0)),
        missing_pan_deg: None,
    };
    Some((gain, next))
}

/// The weights of the directions that a label in direction `at` helps. It helps a frame by the
/// overlap of their views: 1 in the same direction, linear to 0 at a distance of the width of a
/// view.
fn gain_of_label(at: i64, weights: &[(i64, f64)], view_deg: f64) -> f64 {
    weights
        .iter()
        .map(|&(other, weight)| {
            let apart = HorizontalView::towards(other)
                .turn_from(HorizontalView::towards(at))
                .abs();
            let overlap = 1.0 - apart.degrees() / view_deg;
            weight * overlap.max(0.0)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proposals::CoverageCell;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{
        Clip, FrameStatus, Solution, SolutionSource, SolutionWarning,
    };
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};
    use touchline_vision::relocalize::CERTAIN;

    const SURELY: f64 = 0.99;

    /// A pan and its confidence.
    type Answer = Option<(f64, f64)>;

    /// Frames of shots: solved at a pan with a confidence, or without an answer. Views are 20°
    /// wide.
    fn document(frames: &[(i64, Answer)]) -> Document {
        let mut document = soccer_document();
        for &(clip, answer) in frames {
            let mut frame = new_frame("x.jpg", ImageSize::new(1280, 720));
            frame.clip = Some(Clip::Number(clip));
            let mut solution = Solution {
                source: Some(SolutionSource::Forest),
                ..Solution::default()
            };
            match answer {
                Some((pan_deg, confidence)) => {
                    frame.ptz = ptz_at(pan_deg, -9.0, 3630.0);
                    frame.status = FrameStatus::Suggested;
                    solution.confidence = Some(confidence);
                }
                None => solution
                    .warnings
                    .push(SolutionWarning::new("coverage", "3 of 30.".to_owned())),
            }
            frame.solution = Some(solution);
            document.frames.push(frame.into());
        }
        document
    }

    /// A map of 10 columns from -50° to 50° with this many references in each.
    fn seen(references: [u32; 10]) -> Coverage {
        Coverage {
            camera: "main".into(),
            pan: AngleRange::around(Angle::ZERO, Angle::from_degrees(50.0)),
            tilt_deg: -20.0..=0.0,
            columns: 10,
            cells: references
                .map(|references| CoverageCell {
                    references,
                    field: true,
                })
                .to_vec(),
            missing_pan_deg: Some(45.0),
        }
    }

    fn next(document: &Document, coverage: &[Coverage]) -> LabelNext {
        label_advice(document, coverage).next.unwrap()
    }

    #[test]
    fn the_place_that_most_frames_wait_for_is_named_by_its_pan() {
        let frames = [
            (1, Some((-30.0, SURELY))),
            (1, None),
            (1, Some((-28.0, SURELY))),
            (2, Some((37.0, SURELY))),
            (2, None),
            (2, None),
            (2, Some((43.0, SURELY))),
        ];
        let found = label_advice(&document(&frames), &[]);
        assert_eq!((found.unanswered, found.uncertain), (3, 0));
        let next = found.next.unwrap();
        assert_eq!(
            (next.frame, next.shared_by, next.missing_pan_deg),
            (4, 2, None)
        );
        assert!((next.pan_deg.unwrap() - 39.0).abs() < 1e-9, "{next:?}");
    }

    #[test]
    fn fewer_frames_where_no_reference_looks_come_before_more_where_many_do() {
        let mut frames = vec![(1, Some((-30.0, SURELY)))];
        frames.extend([(1, None); 4]);
        frames.extend([
            (1, Some((-30.0, SURELY))),
            (2, Some((30.0, SURELY))),
            (2, None),
            (2, None),
            (2, Some((30.0, SURELY))),
        ]);
        let document = document(&frames);
        assert_eq!(
            next(&document, &[]).pan_deg.map(f64::round),
            Some(-30.0),
            "nothing is known of references"
        );
        let found = next(&document, &[seen([5, 5, 5, 5, 5, 1, 0, 0, 0, 0])]);
        assert_eq!(
            (found.frame, found.pan_deg.map(f64::round), found.shared_by),
            (8, Some(30.0), 2)
        );
        assert_eq!(found.missing_pan_deg, Some(45.0));
    }

    #[test]
    fn uncertain_answers_count_by_their_doubt() {
        let frames = [
            (1, Some((0.0, 0.6))),
            (1, Some((1.0, 0.7))),
            (1, Some((2.0, SURELY))),
            (2, Some((40.0, 0.5))),
        ];
        let found = label_advice(&document(&frames), &[]);
        assert_eq!((found.unanswered, found.uncertain), (0, 3));
        let next = found.next.unwrap();
        assert_eq!(
            (next.frame, next.pan_deg, next.shared_by),
            (0, Some(0.0), 2)
        );
        let all_sure = [(1, Some((0.0, SURELY))), (1, Some((3.0, CERTAIN)))];
        assert_eq!(
            label_advice(&document(&all_sure), &[]),
            LabelAdvice::default()
        );
    }

    #[test]
    fn far_from_the_only_solved_frame_it_is_unknown_where_a_frame_looks() {
        let mut frames = vec![(1, Some((5.0, SURELY)))];
        frames.extend([(1, None); 9]);
        let blind = next(&document(&frames), &[seen([1; 10])]);
        assert_eq!((blind.frame, blind.pan_deg, blind.shared_by), (6, None, 7));
        assert_eq!(
            blind.missing_pan_deg,
            Some(45.0),
            "somewhere else than the references, perhaps here"
        );
        assert_eq!(next(&document(&frames[..3]), &[]).pan_deg, Some(5.0));
    }

    #[test]
    fn what_cannot_be_labelled_is_not_named() {
        let mut document = document(&[(1, Some((0.0, SURELY))), (2, None), (2, None), (2, None)]);
        assert_eq!(
            next(&document, &[]).frame,
            2,
            "the middle of a shot without any answer"
        );
        for frame in document.frames.iter_mut().skip(1) {
            frame.solution.as_mut().unwrap().warnings[0].code = "picture".to_owned();
        }
        assert_eq!(
            label_advice(&document, &[]),
            LabelAdvice {
                unanswered: 3,
                ..LabelAdvice::default()
            }
        );
        document.frames[1].status = FrameStatus::Rejected;
        document.frames[2].status = FrameStatus::Draft;
        document.frames[3].solution = None;
        assert_eq!(label_advice(&document, &[]), LabelAdvice::default());
    }

    #[test]
    fn pan_has_no_seam_between_neighbours() {
        let found = next(
            &document(&[
                (1, Some((178.0, SURELY))),
                (1, None),
                (1, Some((-176.0, SURELY))),
            ]),
            &[],
        );
        assert!((found.pan_deg.unwrap() + 179.0).abs() < 1e-9, "{found:?}");
    }
}
