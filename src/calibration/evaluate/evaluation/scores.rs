//! The scores of one frame: clicks and camera of the truth against the camera of the estimate.

use super::Measure;
use crate::calibrate::observations;
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldElement, FieldModel};
use touchline_core::geometry::{ImageSize, Vec3, mean, median};
use touchline_core::score::{
    AnnotatedLine, FieldView, MarkingMatch, annotated_lines, camera_error, ground_error_m,
    iou_part, iou_segments, iou_whole, landmark_errors, squared_mahalanobis,
};
use touchline_core::solve::{Observation, ObservationError};
use touchline_documents::document::{Frame, Target};

/// The scores of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameScores {
    // Indexed by `measure as usize`: the variants are numbered from 0 and `ALL` lists every one.
    values: [Option<f64>; Measure::ALL.len()],
    /// Distance of each click from which the estimate was made, px; infinite if the estimate does
    /// not show its target.
    pub clicks_px: Vec<f64>,
    /// Distance of each other click, px.
    pub held_out_px: Vec<f64>,
    /// Distances on the ground of those other clicks that are on ground landmarks, m; infinite if
    /// the estimate sees no ground there.
    pub held_out_m: Vec<f64>,
}

impl FrameScores {
    /// The value of a measure; none if it cannot be computed for the frame.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.values[measure as usize]
    }

    fn set(&mut self, measure: Measure, value: Option<f64>) {
        self.values[measure as usize] = value;
    }
}

/// The measures by their keys, and the distances of all clicks.
impl Serialize for FrameScores {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for measure in Measure::ALL {
            if let Some(value) = self.get(measure) {
                map.serialize_entry(measure.key(), &value)?;
            }
        }
        map.serialize_entry("every_click_px", &self.clicks_px)?;
        map.serialize_entry("every_held_out_click_px", &self.held_out_px)?;
        map.serialize_entry("every_held_out_click_m", &self.held_out_m)?;
        map.end()
    }
}

/// A frame of the truth with its field and, if it is solved, its camera.
pub(super) struct TrueFrame<'a> {
    pub frame: &'a Frame,
    pub field: &'a FieldModel,
    pub camera: Option<PtzCamera>,
}

/// Scores the estimate's camera in a frame of the truth.
///
/// # Errors
/// A click of the truth is on a target that the estimate's field lacks.
pub(super) fn scores(
    truth: &TrueFrame,
    estimate: &Frame,
    shown: FieldView,
) -> Result<FrameScores, ObservationError> {
    let mut scores = FrameScores::default();
    let size = truth.frame.image_size;
    add_clicks(&mut scores, truth.frame, estimate, shown)?;
    // The annotation for JaC: lines as the true camera shows them if there is one, otherwise the
    // clicked lines.
    let annotated = match &truth.camera {
        Some(true_camera) => {
            add_camera(
                &mut scores,
                FieldView {
                    field: truth.field,
                    camera: true_camera,
                },
                shown,
                size,
            );
            add_sigmas(&mut scores, true_camera, shown.camera, estimate);
            annotated_lines(truth.field, true_camera, size)
        }
        None => clicked_lines(truth),
    };
    if !annotated.is_empty() {
        let found = MarkingMatch::compare(truth.field, &annotated, shown, size);
        // As the SoccerNet task counts: px of a picture 960 px wide.
        scores.set(Measure::Jaccard5, Some(found.jaccard(5.0)));
        scores.set(Measure::Jaccard10, Some(found.jaccard(10.0)));
        scores.set(Measure::Jaccard20, Some(found.jaccard(20.0)));
    }
    Ok(scores)
}

/// Adds the measures that compare the estimated camera with a true one.
fn add_camera(scores: &mut FrameScores, truth: FieldView, estimate: FieldView, size: ImageSize) {
    // The errors of the parameters, then those of the field in the picture and on the ground.
    let error = camera_error(truth.camera, estimate.camera);
    scores.set(
        Measure::IouPart,
        iou_part(truth.field, truth.camera, estimate.camera, size),
    );
    scores.set(
        Measure::IouSegments,
        iou_segments(truth.field, truth.camera, estimate.camera, size),
    );
    scores.set(
        Measure::IouWhole,
        Some(iou_whole(truth.field, truth.camera, estimate.camera)),
    );
    scores.set(Measure::Rotation, Some(error.rotation.degrees()));
    scores.set(Measure::Pan, Some(error.pan.degrees().abs()));
    scores.set(Measure::Tilt, Some(error.tilt.degrees().abs()));
    scores.set(Measure::Focal, Some(error.focal_px.abs()));
    scores.set(Measure::FocalPercent, Some(error.focal_percent.abs()));
    scores.set(Measure::Position, Some(error.position_m));
    // A landmark that the estimate cannot project has an infinite error in the picture.
    let landmarks = landmark_errors(truth, estimate, size);
    let in_image: Vec<f64> = landmarks
        .iter()
        .map(|error| error.image_px.unwrap_or(f64::INFINITY))
        .collect();
    let on_ground: Vec<f64> = landmarks
        .iter()
        .filter_map(|error| error.ground_m)
        .collect();
    scores.set(Measure::Landmarks, mean(&in_image));
    scores.set(
        Measure::WorstLandmark,
        in_image.iter().copied().reduce(f64::max),
    );
    scores.set(Measure::LandmarksOnGround, mean(&on_ground));
}

/// Adds the error in units of the stated sigmas, if a covariance is stated.
fn add_sigmas(scores: &mut FrameScores, truth: &PtzCamera, estimate: &PtzCamera, frame: &Frame) {
    let error = error_in_own_bases(truth, estimate);
    let stated = frame
        .solution
        .as_ref()
        .and_then(|solution| solution.covariance);
    // Squared Mahalanobis distance of the error, divided by three parameters.
    let squared = stated.and_then(|covariance| squared_mahalanobis(error, &covariance));
    scores.set(
        Measure::Sigmas,
        squared.map(|squared| (squared / 3.0).sqrt()),
    );
}

/// The error of the estimate in pan (°), tilt (°) and focal length (px). Each camera is taken
/// relative to its own base, as the stated covariance is. The error includes the part of the base's
/// error that pan and tilt compensate; relative to the true base, it would also include the
/// rotation between the bases. Pans are relative to the base's pan gauge, because the zero of pan
/// is arbitrary.
fn error_in_own_bases(truth: &PtzCamera, estimate: &PtzCamera) -> Vec3 {
    let [true_pan, pan] =
        [truth, estimate].map(|camera| camera.ptz().pan + camera.base().in_pan_gauge().1);
    let tilt = estimate.ptz().tilt - truth.ptz().tilt;
    Vec3::new(
        pan.turn_from(true_pan).degrees(),
        tilt.degrees(),
        estimate.ptz().focal_px - truth.ptz().focal_px,
    )
}

/// Adds the distances of the truth's clicks. A click counts as used if the estimate's frame has a
/// click on the same target that takes part in its solve. All others count as held out.
fn add_clicks(
    scores: &mut FrameScores,
    truth: &Frame,
    estimate: &Frame,
    shown: FieldView,
) -> Result<(), ObservationError> {
    // The estimate's field gives the positions: a document with a field of another size answers for
    // it.
    for observation in observations(truth, shown.field)? {
        let distance_px = observation
            .distance_px(shown.camera)
            .unwrap_or(f64::INFINITY);
        let target = truth.clicks[observation.click].target.as_ref();
        let used = estimate
            .clicks
            .iter()
            .any(|click| click.target.as_ref() == target && !click.check);
        if used {
            scores.clicks_px.push(distance_px);
        } else {
            scores.held_out_px.push(distance_px);
            scores
                .held_out_m
                .extend(on_ground_m(shown, target, &observation));
        }
    }
    // The measures of the frame are medians over its clicks.
    let medians = [&scores.clicks_px, &scores.held_out_px, &scores.held_out_m]
        .map(|values| median(&mut values.clone()));
    for (measure, median) in [
        Measure::Clicks,
        Measure::HeldOutClicks,
        Measure::HeldOutOnGround,
    ]
    .into_iter()
    .zip(medians)
    {
        scores.set(measure, median);
    }
    Ok(())
}

/// The distance of a click on the ground, m; infinite if the estimate sees no ground there, none if
/// its target is not a landmark on the ground.
fn on_ground_m(
    shown: FieldView,
    target: Option<&Target>,
    observation: &Observation,
) -> Option<f64> {
    // Metres are only comparable on one plane: the crossbar of a goal has no error on the ground.
    let at = observation.shape.point()?;
    let landmark = shown.field.landmark(target?.as_str())?;
    landmark
        .is_on_ground()
        .then(|| ground_error_m(shown.camera, observation.image, at).unwrap_or(f64::INFINITY))
}

/// The clicks on lines, grouped by line.
fn clicked_lines(truth: &TrueFrame) -> Vec<AnnotatedLine> {
    let mut annotated: Vec<AnnotatedLine> = Vec::new();
    for click in &truth.frame.clicks {
        let element = click
            .target
            .as_ref()
            .and_then(|target| target.element(truth.field));
        let Some(FieldElement::Line(line)) = element else {
            continue;
        };
        match annotated.iter_mut().find(|marking| marking.line == line) {
            Some(marking) => marking.points.push(click.image),
            None => annotated.push(AnnotatedLine {
                line,
                points: vec![click.image],
            }),
        }
    }
    annotated
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{TestBase, base_at, soccer};

    #[test]
    fn a_click_where_the_estimate_sees_no_ground_is_infinitely_far_off() {
        let size = ImageSize::new(1280, 720);
        let field = soccer();
        let camera = base_at([0.0, -60.0, 15.0], size).aim(0.0, 60.0, 1500.0);
        let sky = FieldView {
            field: &field,
            camera: &camera,
        };
        for (name, expected) in [
            ("centre_mark", Some(f64::INFINITY)),
            ("post_far_left_top", None),
        ] {
            let click = Observation::from_landmark(&field, name, size.centre(), size, 0).unwrap();
            let target = Target::Landmark(name.into());
            assert_eq!(on_ground_m(sky, Some(&target), &click), expected, "{name}");
        }
    }
}
