//! Fits a panorama to the lines of the field: its pose, together with the focal scale, the crown
//! and the size of the field, which the search holds fixed.
//!
//! # Problem
//!
//! Pairwise matches give all frames' rotations relative to each other, so the paint of all frames
//! is one rigid set of directions: the panorama. Its pose in the world is open, and so are a few
//! numbers that matches determine badly or not at all. From a low camera these trade off against
//! each other: a pitch 2 m wider, seen from 3 m farther away, looks nearly the same. They are
//! therefore fitted together, ten parameters in all ([`Parameters`]).
//!
//! # Method
//!
//! Iterative closest point on the viewing sphere. Each round assigns every direction of paint to
//! the line that it passes nearest to, drops pairs beyond a gate, and minimises the angles between
//! the directions and the planes through camera and line (the point-to-line metric of Chen and
//! Medioni, 1992). The gate narrows from round to round, so that parallel lines are separated only
//! once the pose is good enough for it. A Cauchy loss bounds the influence of wrong pairs; priors
//! hold what paint leaves open.
//!
//! The derivatives by pose are analytic. Those by focal scale and by the field's lengths are finite
//! differences, taken once a round: rotations are interpolated between the focal scales at which
//! the matches were adjusted, and the field is built anew from its template, so neither has a
//! closed form.

mod correspondences;
mod parameters;

use super::pitch_map::angular_scale;
use super::places::relative_size;
use super::pose::PanoramaPose;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::FramesAtScale;
use crate::autocalibrate::frames::rotations_by_focal_scale::{FocalScale, RotationsByFocalScale};
use correspondences::{PaintProblem, PaintSamples, match_paint_to_lines, subsample_per_line};
use parameters::{FieldFamily, Parameters, priors};
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldModel;
use touchline_core::solve::{Residual, Stopping, minimise};
use touchline_vision::track::RelativeRotations;

/// The gate of each round: paint farther than three times this from every line is left out, and the
/// loss has this scale. Degrees, for a camera at the usual height ([`PitchMap::angular_scale`]).
const GATES_DEG: [f64; 7] = [0.4, 0.3, 0.2, 0.15, 0.12, 0.1, 0.1];

/// Paint counts as explained within this angle of a line, degrees, for a camera at the usual
/// height.
const EXPLAINED_DEG: f64 = 0.15;

/// A fit to fewer correspondences is not trusted.
const MIN_CORRESPONDENCES: usize = 100;

/// A panorama fitted to a field.
#[derive(Clone)]
pub struct PanoramaFit {
    pub pose: PanoramaPose,
    pub log_scale: f64,
    /// The rotations of the frames at that focal scale.
    pub rotations: RelativeRotations,
    /// The field with its fitted crown and, if a size prior was given, its fitted size.
    pub field: FieldModel,
    /// The share of the paint that lies on a line.
    pub explained: f64,
}

impl PanoramaFit {
    /// The base of the frames' camera.
    pub fn base(&self) -> CameraBase {
        self.pose.base(&self.rotations)
    }
}

/// The initial values of a fit.
#[derive(Clone, Copy)]
pub struct PanoramaStart<'a> {
    pub pose: PanoramaPose,
    pub log_scale: f64,
    /// The field, with the initial crown and size.
    pub field: &'a FieldModel,
}

/// Fits the panorama of frames to a field; with a size prior, the field's size as well. None if too
/// little paint lies near the lines.
///
/// The fit is made twice, with the focal scale that the matches suggest as a prior and without.
/// Matches are usually good to a few per cent, but scrolling boards or a lens that the model does
/// not describe bias all of them alike. Paint overrules them only if it is explained clearly better
/// without them.
pub fn fit_panorama(
    frames: &FramesAtScale,
    start: &PanoramaStart<'_>,
    size_prior: Option<&FieldPrior>,
    rotations: &RotationsByFocalScale,
) -> Option<PanoramaFit> {
    /// The fit without the matches' focal scale is chosen only if it explains this many times as
    /// much paint.
    const OVERRULES_MATCHES: f64 = 1.1;
    let paint = PaintSamples::spread_over_sphere(frames, rotations);
    let with_matches = fit_with_scale_prior(
        rotations.focal_scale_from_matches(),
        &paint,
        start,
        size_prior,
    );
    let without = fit_with_scale_prior(
        FocalScale::unknown(start.log_scale),
        &paint,
        start,
        size_prior,
    );
    // Prefer the fit with the matches' prior, unless the other is clearly better.
    match (with_matches, without) {
        (Some(with), Some(without)) if without.explained <= OVERRULES_MATCHES * with.explained => {
            Some(with)
        }
        (with, without) => without.or(with),
    }
}

/// Fits a panorama with a prior on its focal scale.
fn fit_with_scale_prior(
    scale_prior: FocalScale,
    paint: &PaintSamples<'_>,
    start: &PanoramaStart<'_>,
    size_prior: Option<&FieldPrior>,
) -> Option<PanoramaFit> {
    const STOPPING: Stopping = Stopping {
        max_iterations: 6,
        short_step: 1e-6,
        small_gain: 1e-6,
    };
    // Start from the pose of the search; open lengths start at those of the field.
    let family = FieldFamily::new(start.field, size_prior);
    let mut found = Parameters {
        pose: start.pose,
        log_scale: start.log_scale,
        crown_m: start.field.crown_m,
        lengths_m: family.start_lengths_m(),
    };
    let mut problem = PaintProblem {
        correspondences: Vec::new(),
        priors: priors(scale_prior, &family),
    };
    let relative_size = relative_size(start.field);
    for gate_deg in GATES_DEG {
        // From a lower camera the lines lie nearer to each other as angles: the gate shrinks with
        // the height.
        let gate = angular_scale(found.pose.position_m.z, relative_size) * gate_deg.to_radians();
        problem.correspondences =
            subsample_per_line(match_paint_to_lines(&found, paint, &family, gate)?);
        if problem.correspondences.len() < MIN_CORRESPONDENCES {
            return None;
        }
        found = minimise(&problem, found, STOPPING).state;
    }
    Some(PanoramaFit {
        pose: found.pose,
        log_scale: found.log_scale,
        rotations: paint.rotations.at(found.log_scale)?,
        field: family.field_at(found.lengths_m, found.crown_m),
        explained: explained_share(&found, paint, &family)?,
    })
}

/// The share of the paint that lies on a line, without any gate.
fn explained_share(
    at: &Parameters,
    paint: &PaintSamples<'_>,
    family: &FieldFamily<'_>,
) -> Option<f64> {
    let field = family.field_at(at.lengths_m, at.crown_m);
    let scale = angular_scale(at.pose.position_m.z, relative_size(&field));
    let within = scale * EXPLAINED_DEG.to_radians();
    // Without a gate and without the subsample per line, so that fits with different gates are
    // comparable.
    let all = match_paint_to_lines(at, paint, family, f64::INFINITY)?;
    let explained = all
        .iter()
        .filter(|pair| pair.value(at).is_some_and(|off| off[0].abs() < within))
        .count();
    Some(explained as f64 / paint.samples.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::pitch_map::{OnLine, PitchMap};
    use super::*;
    use crate::autocalibrate::frames::matched_frames::{FramePaint, PaintPoint};
    use std::path::Path;
    use touchline_core::camera::{FocalCurve, Ptz};
    use touchline_core::geometry::{Angle, ImageSize, Mat3, Vec3};
    use touchline_documents::testing::soccer_document;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// The rotations of a low camera that pans along the near half of a pitch, at a focal scale:
    /// the longer the lens, the smaller the angles.
    fn rotations_at(percent: u32) -> (u32, RelativeRotations) {
        let scale = f64::from(percent) / 100.0;
        let ptz = |(pan_deg, focal_px): (f64, f64)| {
            Ptz::from_degrees(pan_deg / scale, -7.0 / scale, focal_px * scale)
        };
        let views =
            (-5..=5_i32).map(|view| (f64::from(view) * 9.0, 900.0 + 60.0 * f64::from(view.abs())));
        let residual_px = (0.09 + 9.0 * (scale.ln()).powi(2)).sqrt();
        let lens = FocalCurve::NONE;
        (
            percent,
            RelativeRotations {
                ptz: views.map(ptz).collect(),
                lens,
                principal_point: SIZE.centre(),
                residual_px,
            },
        )
    }

    fn rotations() -> RotationsByFocalScale {
        RotationsByFocalScale::new([94, 100, 106].map(rotations_at))
    }

    /// The paint of a field in the frames of a camera with this pose.
    fn frames(pose: &PanoramaPose, field: &FieldModel) -> FramesAtScale {
        frames_at(100, pose, field)
    }

    /// The same with the rotations of another focal scale.
    fn frames_at(percent: u32, pose: &PanoramaPose, field: &FieldModel) -> FramesAtScale {
        let (_, rotations) = rotations_at(percent);
        let map = PitchMap::without_grid(field);
        let of_frame = |frame: usize| -> FramePaint {
            let camera = rotations.camera(frame);
            let seen = |at: Vec3| {
                camera
                    .image_from_world(pose.direction_in_panorama(at)?)
                    .ok()
            };
            let shown = |line: &OnLine| seen(line.at).filter(|image| SIZE.contains(*image));
            map.samples(1.0)
                .filter_map(|line| shown(&line).map(PaintPoint::from))
                .collect()
        };
        let paint = (0..rotations.ptz.len()).map(of_frame).collect();
        FramesAtScale {
            log_scale: (f64::from(percent) / 100.0).ln(),
            rotations,
            paint,
        }
    }

    /// The prior of a soccer pitch of unknown size, and one field of another size.
    fn field_prior() -> (FieldPrior, FieldModel) {
        let document = soccer_document();
        let prior = FieldPrior::from_document(document.at(Path::new("")), &"main".into()).unwrap();
        let field = FieldModel {
            crown_m: 0.3,
            ..prior.with_lengths(&[107.5, 66.0]).unwrap()
        };
        (prior, field)
    }

    fn assert_near(found: &PanoramaFit, pose: &PanoramaPose, field: &FieldModel) {
        let off_m = (found.pose.position_m - pose.position_m).norm();
        assert!(off_m < 0.1, "{off_m:.3} m off");
        let turned = found.pose.world_from_panorama.transpose() * pose.world_from_panorama;
        assert!((turned - Mat3::identity()).norm() < 1e-3, "{turned:?}");
        assert!(found.log_scale.abs() < 2e-3, "{}", found.log_scale);
        let [length_m, width_m] = [
            found.field.length_m - field.length_m,
            found.field.width_m - field.width_m,
        ];
        assert!(
            length_m.abs() < 0.15 && width_m.abs() < 0.15,
            "{length_m:.3}, {width_m:.3} m"
        );
        assert!(
            (found.field.crown_m - field.crown_m).abs() < 0.05,
            "{}",
            found.field.crown_m
        );
        assert!(found.explained > 0.97, "{}", found.explained);
    }

    #[test]
    fn place_scale_crown_and_size_are_found_together_from_a_low_camera() {
        let (prior, field) = field_prior();
        let pose = PanoramaPose::upright(Vec3::new(-12.0, -63.0, 7.5), Angle::from_degrees(4.0));
        let frames = frames(&pose, &field);
        for (shift_m, turn_deg, log_scale) in [
            (Vec3::zeros(), 0.0, 0.0),
            (Vec3::new(0.6, -0.9, 0.1), 0.3, 0.01),
            (Vec3::new(-0.8, 0.7, -0.1), -0.3, -0.01),
        ] {
            let from = pose.move_by(shift_m, Vec3::new(0.0, 0.0, f64::to_radians(turn_deg)));
            let start = PanoramaStart {
                pose: from,
                log_scale,
                field: &prior.assumed,
            };
            let found = fit_panorama(&frames, &start, Some(&prior), &rotations()).unwrap();
            assert_near(&found, &pose, &field);
        }
    }

    #[test]
    fn paint_says_the_focal_scale_where_all_edges_are_put_off_together() {
        let (prior, field) = field_prior();
        let pose = PanoramaPose::upright(Vec3::new(-5.0, -66.0, 14.0), Angle::from_degrees(2.0));
        let frames = frames_at(135, &pose, &field);
        let rotations = RotationsByFocalScale::new(
            [88, 94, 100, 106, 113, 120, 127, 135, 143].map(rotations_at),
        );
        assert!(
            rotations.focal_scale_from_matches().sigma < 0.01,
            "they are sure of another scale"
        );
        let start = PanoramaStart {
            pose,
            log_scale: frames.log_scale,
            field: &prior.assumed,
        };
        let found = fit_panorama(&frames, &start, Some(&prior), &rotations).unwrap();
        assert!(
            (found.log_scale - frames.log_scale).abs() < 5e-3,
            "{}",
            found.log_scale
        );
        assert!(
            (found.pose.position_m - pose.position_m).norm() < 0.3,
            "{:?}",
            found.pose.position_m
        );
    }

    #[test]
    fn a_known_size_is_kept_and_one_that_is_wrong_explains_less() {
        let (prior, field) = field_prior();
        let pose = PanoramaPose::upright(Vec3::new(20.0, -60.0, 9.0), Angle::from_degrees(-10.0));
        let frames = frames(&pose, &field);
        let on = |field: &FieldModel| {
            fit_panorama(
                &frames,
                &PanoramaStart {
                    pose,
                    log_scale: 0.0,
                    field,
                },
                None,
                &rotations(),
            )
            .unwrap()
        };
        let known = on(&field);
        assert_near(&known, &pose, &field);
        let wrong = on(&prior.with_lengths(&[100.0, 70.0]).unwrap());
        assert!((wrong.field.length_m, wrong.field.width_m) == (100.0, 70.0));
        assert!(
            wrong.explained < known.explained - 0.1,
            "{} and {}",
            wrong.explained,
            known.explained
        );
    }

    #[test]
    fn paint_far_from_every_line_or_none_at_all_has_no_fit() {
        let (prior, field) = field_prior();
        let pose = PanoramaPose::upright(Vec3::new(-12.0, -63.0, 7.5), Angle::from_degrees(4.0));
        let mut frames = frames(&pose, &field);
        let away = PanoramaPose {
            position_m: Vec3::new(-12.0, -400.0, 7.5),
            ..pose
        };
        let start_at = |pose: PanoramaPose| PanoramaStart {
            pose,
            log_scale: 0.0,
            field: &prior.assumed,
        };
        assert!(fit_panorama(&frames, &start_at(away), Some(&prior), &rotations()).is_none());
        frames.paint.iter_mut().for_each(Vec::clear);
        assert!(fit_panorama(&frames, &start_at(pose), Some(&prior), &rotations()).is_none());
        let start = PanoramaStart {
            pose,
            log_scale: 0.0,
            field: &field,
        };
        assert!(fit_panorama(&frames, &start, None, &RotationsByFocalScale::new([])).is_none());
    }
}
