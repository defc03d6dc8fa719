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

use super::field_prior::{FieldPrior, OpenLength};
use super::matched_frames::FramesAtScale;
use super::pitch_map::PitchMap;
use super::pose::{PaintCorrespondence, PanoramaPose, UPRIGHT_SIGMA, angular_scale};
use super::rotations_by_focal_scale::{FocalScale, RotationsByFocalScale};
use nalgebra::{SMatrix, SVector, Vector1};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::{BaseAngles, CameraBase};
use touchline_core::field::{FieldElement, FieldModel};
use touchline_core::geometry::{ImagePoint, Vec3, subsample};
use touchline_core::solve::base::BasePriors;
use touchline_core::solve::{
    BlockEquations, Linearised, Loss, Problem, Residual, Stopping, minimise,
};
use touchline_vision::track::RelativeRotations;

/// The gate of each round: paint farther than three times this from every line is left out, and the
/// loss has this scale. Degrees, for a camera at the usual height ([`angular_scale`]).
const GATES_DEG: [f64; 7] = [0.4, 0.3, 0.2, 0.15, 0.12, 0.1, 0.1];

/// Paint counts as explained within this angle of a line, degrees, for a camera at the usual
/// height.
const EXPLAINED_DEG: f64 = 0.15;

/// A fit to fewer correspondences is not trusted.
const MIN_CORRESPONDENCES: usize = 100;

/// The crown stays within what building rules allow, m.
const CROWN_RANGE_M: [f64; 2] = [-0.1, 0.5];

/// 1-σ of a parameter that is not fitted: all ten stay in the equations, and a tight prior holds
/// this one.
const HELD_SIGMA: f64 = 1e-6;

/// Number of parameters, and their indices: position (m) and rotation vector (rad) in `world`, log
/// focal scale, crown height (m), length and width of the field (m).
const NUM_PARAMETERS: usize = 10;
const POSITION: usize = 0;
const ROTATION: usize = 3;
const LEAN_ABOUT_X: usize = ROTATION;
const LEAN_ABOUT_Y: usize = ROTATION + 1;
const LOG_SCALE: usize = 6;
const CROWN: usize = 7;
const LENGTHS: usize = 8;

/// A panorama fitted to a field.
#[derive(Clone)]
pub(super) struct PanoramaFit {
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
        let PanoramaPose {
            position_m,
            world_from_panorama,
        } = self.pose;
        // In `panorama` the cameras of the frames have a level base (`RelativeRotations::camera`), so
        // `base_from_panorama` is that of the default angles.
        let base_from_panorama = BaseAngles::default().base_from_world();
        let base_from_world = base_from_panorama * world_from_panorama.transpose();
        let centre = self.rotations.image_size.centre();
        CameraBase {
            distortion: self.rotations.lens,
            ..CameraBase::new(position_m, base_from_world, centre)
        }
    }
}

/// The initial values of a fit.
#[derive(Clone, Copy)]
pub(super) struct PanoramaStart<'a> {
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
pub(super) fn fit_panorama(
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
    for gate_deg in GATES_DEG {
        // From a lower camera the lines lie nearer to each other as angles: the gate shrinks with
        // the height.
        let gate = angular_scale(found.pose.position_m.z) * gate_deg.to_radians();
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
    let within = angular_scale(at.pose.position_m.z) * EXPLAINED_DEG.to_radians();
    // Without a gate and without the subsample per line, so that fits with different gates are
    // comparable.
    let all = match_paint_to_lines(at, paint, family, f64::INFINITY)?;
    let is_explained =
        |pair: &&Correspondence| pair.value(at).is_some_and(|off| off[0].abs() < within);
    Some(all.iter().filter(is_explained).count() as f64 / paint.samples.len().max(1) as f64)
}

/// The fields that the fit chooses from: one field with other crowns and, where its size is open,
/// other lengths.
struct FieldFamily<'a> {
    field: &'a FieldModel,
    size_prior: Option<&'a FieldPrior>,
    /// The lengths to fit: at most two, none without a size prior.
    open_lengths: Vec<OpenLength>,
}

impl<'a> FieldFamily<'a> {
    fn new(field: &'a FieldModel, size_prior: Option<&'a FieldPrior>) -> Self {
        let open_lengths = size_prior.map_or_else(Vec::new, |prior| prior.open_lengths(field));
        Self {
            field,
            size_prior,
            open_lengths,
        }
    }

    /// The lengths that the fit begins with; zero for those that are not open.
    fn start_lengths_m(&self) -> [f64; 2] {
        [0, 1].map(|index| {
            self.open_lengths
                .get(index)
                .map_or(0.0, |length| length.value_m)
        })
    }

    /// The field with other lengths and another crown. Lengths that are not open are ignored.
    fn field_at(&self, lengths_m: [f64; 2], crown_m: f64) -> FieldModel {
        let open_lengths_m = &lengths_m[..self.open_lengths.len()];
        let resized = self
            .size_prior
            .and_then(|prior| prior.with_lengths(open_lengths_m));
        FieldModel {
            crown_m,
            ..resized.unwrap_or_else(|| self.field.clone())
        }
    }
}

/// The priors: the pan axis is vertical (camera heads are levelled), the focal scale is near
/// `scale_prior`, the crown is that of an ordinary pitch, and open lengths are near what the
/// document assumes.
fn priors(scale_prior: FocalScale, family: &FieldFamily<'_>) -> Vec<Prior> {
    // Fields that are never crowned keep a crown of zero.
    let (crown_m, crown_sigma_m) = if family.field.may_be_crowned() {
        BasePriors::default().crown_m
    } else {
        (0.0, HELD_SIGMA)
    };
    let mut priors = vec![
        Prior {
            parameter: LEAN_ABOUT_X,
            value: 0.0,
            sigma: UPRIGHT_SIGMA.radians(),
        },
        Prior {
            parameter: LEAN_ABOUT_Y,
            value: 0.0,
            sigma: UPRIGHT_SIGMA.radians(),
        },
        Prior {
            parameter: LOG_SCALE,
            value: scale_prior.log_scale,
            sigma: scale_prior.sigma,
        },
        Prior {
            parameter: CROWN,
            value: crown_m,
            sigma: crown_sigma_m,
        },
    ];
    // Lengths that are not open are held at zero: without a prior the equations would be singular.
    for index in 0..2 {
        let open = family.open_lengths.get(index);
        let (value, sigma) = open.map_or((0.0, HELD_SIGMA), |length| {
            (length.assumed_m, length.sigma_m)
        });
        priors.push(Prior {
            parameter: LENGTHS + index,
            value,
            sigma,
        });
    }
    priors
}

/// Points of paint in the pictures, evenly spread over the viewing sphere.
struct PaintSamples<'a> {
    rotations: &'a RotationsByFocalScale,
    samples: Vec<PaintSample>,
}

struct PaintSample {
    frame: usize,
    image: ImagePoint,
}

impl<'a> PaintSamples<'a> {
    /// The paint of frames, at most one sample per frame in each cell of a grid over the sphere.
    /// Several frames that show one point keep a sample each: they are independent measurements of
    /// it.
    fn spread_over_sphere(frames: &FramesAtScale, rotations: &'a RotationsByFocalScale) -> Self {
        const CELL_DEG: f64 = 0.1;
        const MAX_SAMPLES: usize = 12_000;
        let mut taken = BTreeSet::new();
        let mut samples = Vec::new();
        for (frame, paint) in frames.paint.iter().enumerate() {
            let camera = frames.rotations.camera(frame);
            for &image in paint {
                // Beyond the fold of the lens a pixel has no direction.
                let Ok(direction) = camera.world_direction_from_image(image) else {
                    continue;
                };
                // The grid is over pan and tilt in `panorama`.
                let cell = [
                    direction.x.atan2(direction.y),
                    direction.z.atan2(direction.xy().norm()),
                ]
                .map(|angle| (angle.to_degrees() / CELL_DEG).round() as i64);
                if taken.insert((frame, cell)) {
                    samples.push(PaintSample { frame, image });
                }
            }
        }
        Self {
            rotations,
            samples: subsample(samples, MAX_SAMPLES).collect(),
        }
    }

    /// The directions of all samples in `panorama` at a focal scale; none for a sample beyond the
    /// fold of the lens.
    fn directions_at(&self, log_scale: f64) -> Option<Vec<Option<Vec3>>> {
        let rotations = self.rotations.at(log_scale)?;
        let cameras: Vec<_> = (0..rotations.ptz.len())
            .map(|frame| rotations.camera(frame))
            .collect();
        let direction = |sample: &PaintSample| {
            cameras[sample.frame]
                .world_direction_from_image(sample.image)
                .ok()
        };
        Some(self.samples.iter().map(direction).collect())
    }
}

/// Pairs each sample of paint with the line that it passes nearest to, if within three gates of it.
fn match_paint_to_lines(
    at: &Parameters,
    paint: &PaintSamples<'_>,
    family: &FieldFamily<'_>,
    gate: f64,
) -> Option<Vec<Correspondence>> {
    /// Steps of the finite differences.
    const LOG_SCALE_STEP: f64 = 1e-3;
    const LENGTH_STEP_M: f64 = 0.1;

    // The field and the directions here, and a small step away for the finite differences.
    let field = family.field_at(at.lengths_m, at.crown_m);
    let stepped_fields = [0, 1].map(|index| {
        let mut lengths_m = at.lengths_m;
        lengths_m[index] += LENGTH_STEP_M;
        family.field_at(lengths_m, at.crown_m)
    });
    let map = PitchMap::without_grid(&field);
    let directions = paint.directions_at(at.log_scale)?;
    let stepped_directions = paint.directions_at(at.log_scale + LOG_SCALE_STEP)?;

    let mut pairs = Vec::new();
    // A pair that is already farther from its line than three gates is probably paint of another
    // line, or no line at all.
    for (direction, stepped_direction) in directions.into_iter().zip(stepped_directions) {
        let (Some(direction), Some(stepped_direction)) = (direction, stepped_direction) else {
            continue;
        };
        let Some(line) = at.pose.line_at(direction, &map) else {
            continue;
        };
        let pair = PaintCorrespondence {
            direction_in_panorama: direction,
            line,
            sigma: gate,
        };
        let Some(off) = pair.value(&at.pose) else {
            continue;
        };
        if off[0].abs() > 3.0 * gate {
            continue;
        }
        // z = 0 is the middle of the field: the higher the crown, the lower lie the touchlines
        // (`Crown::ground_z`).
        let line_by_crown = Vec3::new(0.0, 0.0, -field.crown().drop_share(line.at.y));
        let [line_by_length, line_by_width] =
            [0, 1].map(|index| line.offset_on(&stepped_fields[index]) / LENGTH_STEP_M);
        pairs.push(Correspondence {
            paint: pair,
            direction_by_log_scale: (stepped_direction - direction) / LOG_SCALE_STEP,
            line_by_field: [line_by_crown, line_by_length, line_by_width],
            linearised_at: *at,
        });
    }
    Some(pairs)
}

/// Keeps equally many pairs of each line. The near touchline, which every frame shows, would
/// otherwise outweigh all others, and alone it does not constrain the position along itself.
fn subsample_per_line(pairs: Vec<Correspondence>) -> Vec<Correspondence> {
    const MAX_PER_LINE: usize = 60;
    let mut pairs_by_line: BTreeMap<usize, Vec<Correspondence>> = BTreeMap::new();
    for pair in pairs {
        pairs_by_line
            .entry(pair.paint.line.line)
            .or_default()
            .push(pair);
    }
    pairs_by_line
        .into_values()
        .flat_map(|pairs| subsample(pairs, MAX_PER_LINE))
        .collect()
}

/// The fitted parameters.
#[derive(Clone, Copy)]
struct Parameters {
    pose: PanoramaPose,
    log_scale: f64,
    crown_m: f64,
    /// Length and width of the field, m; only the first [`FieldFamily::open_lengths`] count.
    lengths_m: [f64; 2],
}

/// A direction of paint and its line, and how both move with the parameters other than the pose.
struct Correspondence {
    /// The pair at `linearised_at`.
    paint: PaintCorrespondence,
    direction_by_log_scale: Vec3,
    /// The point of the line, by crown, length and width of the field.
    line_by_field: [Vec3; 3],
    linearised_at: Parameters,
}

impl Correspondence {
    /// Direction and line at other parameters, to first order.
    fn moved_to(&self, at: &Parameters) -> PaintCorrespondence {
        let from = &self.linearised_at;
        let direction = self.paint.direction_in_panorama
            + self.direction_by_log_scale * (at.log_scale - from.log_scale);
        let [by_crown, by_length, by_width] = &self.line_by_field;
        let mut line = self.paint.line;
        line.at += by_crown * (at.crown_m - from.crown_m);
        line.at += by_length * (at.lengths_m[0] - from.lengths_m[0]);
        line.at += by_width * (at.lengths_m[1] - from.lengths_m[1]);
        PaintCorrespondence {
            direction_in_panorama: direction.normalize(),
            line,
            sigma: self.paint.sigma,
        }
    }
}

impl Residual<1, 0, NUM_PARAMETERS> for Correspondence {
    type State = Parameters;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        self.paint.sigma
    }

    fn value(&self, at: &Parameters) -> Option<SVector<f64, 1>> {
        self.moved_to(at).value(&at.pose)
    }

    fn linearised(&self, at: &Parameters) -> Option<Linearised<1, 0, NUM_PARAMETERS>> {
        // The derivatives by the pose are those of the pair; the others follow from them by the
        // chain rule.
        let moved = self.moved_to(at);
        let by_pose = moved.linearised(&at.pose)?;
        let (normal, _) = moved.plane(&at.pose)?;
        let mut by_own = SMatrix::<f64, 1, NUM_PARAMETERS>::zeros();
        by_own
            .fixed_columns_mut::<6>(POSITION)
            .copy_from(&by_pose.by_own);
        // The residual is n·R d with n the unit normal of the plane through camera and line. That d
        // is normalised changes nothing to first order: the change is along d, and n·R d is nearly
        // zero.
        by_own[LOG_SCALE] =
            normal.dot(&(at.pose.world_from_panorama * self.direction_by_log_scale));
        // Moving the line is moving the camera the other way.
        let by_position = by_pose.by_own.fixed_columns::<3>(POSITION);
        for (index, line_by) in self.line_by_field.iter().enumerate() {
            by_own[CROWN + index] = -(by_position * line_by)[0];
        }
        Some(Linearised {
            value: by_pose.value,
            by_shared: SMatrix::zeros(),
            by_own,
        })
    }
}

/// A Gaussian prior on one parameter.
struct Prior {
    parameter: usize,
    value: f64,
    sigma: f64,
}

impl Prior {
    fn parameter_at(&self, at: &Parameters) -> f64 {
        // The lean is read off the pan axis: a small rotation by ε about x takes (0, 0, 1) to (0,
        // −ε, 1), one about y to (ε, 0, 1).
        let pan_axis = at.pose.world_from_panorama.column(2);
        match self.parameter {
            axis @ POSITION..ROTATION => at.pose.position_m[axis],
            LEAN_ABOUT_X => -pan_axis[1],
            LEAN_ABOUT_Y => pan_axis[0],
            LOG_SCALE => at.log_scale,
            CROWN => at.crown_m,
            length => at.lengths_m[length - LENGTHS],
        }
    }
}

impl Residual<1, 0, NUM_PARAMETERS> for Prior {
    type State = Parameters;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, at: &Parameters) -> Option<SVector<f64, 1>> {
        Some(Vector1::new(self.parameter_at(at) - self.value))
    }

    fn linearised(&self, at: &Parameters) -> Option<Linearised<1, 0, NUM_PARAMETERS>> {
        let mut by_own = SMatrix::<f64, 1, NUM_PARAMETERS>::zeros();
        by_own[self.parameter] = 1.0;
        Some(Linearised {
            value: self.value(at)?,
            by_shared: SMatrix::zeros(),
            by_own,
        })
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

/// Least squares over correspondences and priors.
struct PaintProblem {
    correspondences: Vec<Correspondence>,
    priors: Vec<Prior>,
}

impl Problem for PaintProblem {
    type State = Parameters;
    type Equations = BlockEquations<0, NUM_PARAMETERS>;

    fn equations(&self, at: &Parameters) -> Self::Equations {
        // σ of a pair is the gate, so the loss has the scale of the gate. Priors use a squared
        // loss.
        let loss = Loss::Cauchy { c: 1.0 };
        let mut equations = BlockEquations::zero();
        for correspondence in &self.correspondences {
            equations.add(correspondence, at, loss);
        }
        for prior in &self.priors {
            equations.add(prior, at, loss);
        }
        equations
    }

    fn stepped(&self, from: &Parameters, step: &SVector<f64, NUM_PARAMETERS>) -> Parameters {
        // Position and rotation are updated in `world`, the rotation by a rotation vector, so it
        // needs no parametrisation of its own.
        let shift_m = step.fixed_rows::<3>(POSITION).into_owned();
        let turn = step.fixed_rows::<3>(ROTATION).into_owned();
        Parameters {
            pose: from.pose.moved(shift_m, turn),
            log_scale: from.log_scale + step[LOG_SCALE],
            crown_m: (from.crown_m + step[CROWN]).clamp(CROWN_RANGE_M[0], CROWN_RANGE_M[1]),
            lengths_m: [0, 1].map(|index| from.lengths_m[index] + step[LENGTHS + index]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::matched_frames::FramePaint;
    use super::super::pitch_map::OnLine;
    use super::*;
    use std::path::Path;
    use touchline_core::camera::{FocalCurve, Ptz};
    use touchline_core::geometry::{Angle, ImageSize, Mat3};
    use touchline_documents::document::{Document, FieldSpec};

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
                image_size: SIZE,
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
            map.samples(1.0).filter_map(|line| shown(&line)).collect()
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
        let document = Document::new(FieldSpec::new("soccer"));
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
            let from = pose.moved(shift_m, Vec3::new(0.0, 0.0, f64::to_radians(turn_deg)));
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
