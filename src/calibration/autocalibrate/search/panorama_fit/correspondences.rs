//! Paint paired with lines, and the least squares over the pairs: one round of the fit.
//!
//! A round pairs each sample of paint with the line that it passes nearest to. A pair also holds
//! how its direction and its line move with focal scale, crown and size of the field. So a step
//! within the round builds no field and interpolates no rotations.

use super::super::bright_markings::{BrightMarkings, MarkingAtLine};
use super::super::pitch_map::PitchMap;
use super::super::pose::{PaintCorrespondence, paint_certainty};
use super::parameters::{
    CROWN, FieldFamily, LENGTHS, LOG_SCALE, NUM_PARAMETERS, POSITION, Parameters, Prior, ROTATION,
};
use crate::autocalibrate::frames::matched_frames::{FramesAtScale, PaintPoint};
use crate::autocalibrate::frames::rotations_by_focal_scale::RotationsByFocalScale;
use nalgebra::{SMatrix, SVector};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::{Vec3, subsample};
use touchline_core::solve::{BlockEquations, Linearised, Loss, Problem, Residual};
use touchline_vision::track::RelativeRotations;

/// The crown stays within what building rules allow, m.
const CROWN_RANGE_M: [f64; 2] = [-0.1, 0.5];

/// Points of paint in the pictures, evenly spread over the viewing sphere.
pub(super) struct PaintSamples<'a> {
    pub rotations: &'a RotationsByFocalScale,
    pub samples: Vec<PaintSample>,
}

pub(super) struct PaintSample {
    frame: usize,
    point: PaintPoint,
}

impl<'a> PaintSamples<'a> {
    /// The paint of frames, at most one sample per frame in each cell of a grid over the sphere.
    /// Several frames that show one point keep a sample each: they are independent measurements of
    /// it.
    pub fn spread_over_sphere(
        frames: &FramesAtScale,
        rotations: &'a RotationsByFocalScale,
    ) -> Self {
        const CELL_DEG: f64 = 0.1;
        const MAX_SAMPLES: usize = 12_000;
        let mut taken = BTreeSet::new();
        let mut samples = Vec::new();
        for (frame, paint) in frames.paint.iter().enumerate() {
            let camera = frames.rotations.camera(frame);
            for &point in paint {
                // Beyond the fold of the lens a pixel has no direction.
                let Ok(direction) = camera.world_direction_from_image(point.at) else {
                    continue;
                };
                // The grid is over pan and tilt in `panorama`.
                let cell = [
                    direction.x.atan2(direction.y),
                    direction.z.atan2(direction.xy().norm()),
                ]
                .map(|angle| (angle.to_degrees() / CELL_DEG).round() as i64);
                if taken.insert((frame, cell)) {
                    samples.push(PaintSample { frame, point });
                }
            }
        }
        Self {
            rotations,
            samples: subsample(samples, MAX_SAMPLES).collect(),
        }
    }

    /// The directions of all samples in `panorama` from the cameras of the frames, as
    /// [`RotationsByFocalScale::at`] gives them; none for a sample beyond the fold of the lens.
    fn directions(&self, rotations: &RelativeRotations) -> Vec<Option<Vec3>> {
        let cameras: Vec<_> = (0..rotations.ptz.len())
            .map(|frame| rotations.camera(frame))
            .collect();
        let directions = self.samples.iter().map(|sample| {
            cameras[sample.frame]
                .world_direction_from_image(sample.point.at)
                .ok()
        });
        directions.collect()
    }
}

/// Pairs each sample of paint with the line that it passes nearest to, if within three gates of it
/// and not too bright for it ([`BrightMarkings`]).
pub(super) fn match_paint_to_lines(
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
    let rotations = paint.rotations.at(at.log_scale)?;
    let directions = paint.directions(&rotations);
    let stepped_directions = paint.directions(&paint.rotations.at(at.log_scale + LOG_SCALE_STEP)?);

    let mut pairs = Vec::new();
    let mut markings = Vec::new();
    // A pair that is already farther from its line than three gates is probably paint of another
    // line, or no line at all.
    let directions = directions.into_iter().zip(stepped_directions);
    for (sample, (direction, stepped_direction)) in paint.samples.iter().zip(directions) {
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
        let paint_m = field.lines[line.line].width_m;
        let focal_px = rotations.ptz[sample.frame].focal_px;
        let width_px = pair.paint_angle(&at.pose, paint_m).unwrap_or(0.0) * focal_px;
        markings.push(MarkingAtLine {
            line: line.line,
            contrast_px: sample.point.contrast_px,
            width_px,
        });
        let pair = PaintCorrespondence {
            sigma: gate / paint_certainty(width_px).sqrt(),
            ..pair
        };
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
    let bright = BrightMarkings::measure(field.lines.len(), markings.iter().copied());
    let pairs = pairs.into_iter().zip(markings);
    let of_lines = pairs.filter(|(_, marking)| !bright.contain(*marking));
    Some(of_lines.map(|(pair, _)| pair).collect())
}

/// Keeps equally many pairs of each line. The near touchline, which every frame shows, would
/// otherwise outweigh all others, and alone it does not constrain the position along itself.
pub(super) fn subsample_per_line(pairs: Vec<Correspondence>) -> Vec<Correspondence> {
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

/// A direction of paint and its line, and how both move with the parameters other than the pose.
pub(super) struct Correspondence {
    /// The pair at `linearised_at`.
    paint: PaintCorrespondence,
    direction_by_log_scale: Vec3,
    /// The point of the line, by crown, length and width of the field.
    line_by_field: [Vec3; 3],
    linearised_at: Parameters,
}

impl Correspondence {
    /// Direction and line at other parameters, to first order.
    fn extrapolate_to(&self, at: &Parameters) -> PaintCorrespondence {
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

    fn sigma(&self) -> f64 {
        self.paint.sigma
    }

    fn value(&self, at: &Parameters) -> Option<SVector<f64, 1>> {
        self.extrapolate_to(at).value(&at.pose)
    }

    fn linearise(&self, at: &Parameters) -> Option<Linearised<1, 0, NUM_PARAMETERS>> {
        // The derivatives by the pose are those of the pair; the others follow from them by the
        // chain rule.
        let moved = self.extrapolate_to(at);
        let by_pose = moved.linearise(&at.pose)?;
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
        Some(Linearised::without_shared(by_pose.value, by_own))
    }
}

/// Least squares over correspondences and priors.
pub(super) struct PaintProblem {
    pub correspondences: Vec<Correspondence>,
    pub priors: Vec<Prior>,
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

    fn apply_step(&self, from: &Parameters, step: &SVector<f64, NUM_PARAMETERS>) -> Parameters {
        // Position and rotation are updated in `world`, the rotation by a rotation vector, so it
        // needs no parametrisation of its own.
        let shift_m = step.fixed_rows::<3>(POSITION).into_owned();
        let turn = step.fixed_rows::<3>(ROTATION).into_owned();
        Parameters {
            pose: from.pose.move_by(shift_m, turn),
            log_scale: from.log_scale + step[LOG_SCALE],
            crown_m: (from.crown_m + step[CROWN]).clamp(CROWN_RANGE_M[0], CROWN_RANGE_M[1]),
            lengths_m: [0, 1].map(|index| from.lengths_m[index] + step[LENGTHS + index]),
        }
    }
}
