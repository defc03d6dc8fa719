//! The least-squares problem of matched frames without a known base: each match is one direction,
//! seen by two frames. Unknowns are the lens, and rotation and focal length of every frame.

use super::ViewGraphEdge;
use super::edge_residual::{MatchJacobian, View};
use nalgebra::{DVector, SymmetricEigen, Vector1};
use touchline_core::camera::{FocalCurve, PanTilt, Ptz};
use touchline_core::geometry::rotation::{from_rotation_vector, nearest_rotation, q_pan, q_tilt};
use touchline_core::geometry::{Angle, Mat3, Vec3, median};
use touchline_core::solve::{DenseEquations, Loss, Problem};

/// Residual of a match that lies beyond the fold of the lens, px at 1920 px width.
const NOWHERE_PX: f64 = 1000.0;

/// 1-σ of the tilt prior of cameras at a field; it matters only where matches leave the tilt
/// undetermined.
const TILT_SIGMA: Angle = Angle::from_degrees(15.0);

/// Which rotations of a frame are free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Freedom {
    /// All three.
    Any,
    /// Pan and tilt about the common frame's axes.
    PanTilt,
}

impl Freedom {
    /// Number of parameters of a frame: those of the rotation, then the log focal length.
    const fn parameters(self) -> usize {
        match self {
            Self::Any => 4,
            Self::PanTilt => 3,
        }
    }
}

pub(super) struct EdgeProblem<'a> {
    pub edges: &'a [ViewGraphEdge],
    pub freedom: Freedom,
    pub loss: Loss,
    /// Image px per px at 1920 px width; it is also the 1-σ of a match.
    pub px: f64,
    /// The lens prior, in px of these frames.
    pub expected: FocalCurve,
    /// 1-σ of k₁ and of its slope per 1000 px of these frames.
    pub sigma: [f64; 2],
    /// Whether the mean of the log focal lengths is fixed.
    pub fixed_scale: bool,
}

#[derive(Clone, Debug)]
pub(super) struct EdgeState {
    pub views: Vec<View>,
    pub lens: FocalCurve,
}

/// Number of lens parameters; they precede those of the frames.
const LENS: usize = 2;

impl Problem for EdgeProblem<'_> {
    type State = EdgeState;
    type Equations = DenseEquations;

    fn equations(&self, at: &EdgeState) -> DenseEquations {
        let own = self.freedom.parameters();
        let mut equations = DenseEquations::zero(LENS + own * at.views.len());
        for edge in self.edges {
            let frames = [edge.first, edge.second];
            let [one, other] = frames.map(|frame| &at.views[frame]);
            for (first, second) in &edge.matches {
                // The match as seen by both frames. Beyond the fold it has a large constant
                // residual without a gradient, so that leaving the lens's range is never a gain.
                let seen =
                    MatchJacobian::new([one, other], [&at.lens, &at.lens], [*first, *second]);
                let Some(seen) = seen else {
                    equations.add(&Vector1::new(NOWHERE_PX * self.px), self.px, &[], self.loss);
                    continue;
                };
                // Scatter the derivatives to their columns: the lens, then rotation and ln f of
                // both frames.
                let mut by = Vec::with_capacity(LENS + 8);
                by.extend(seen.by_lens.into_iter().enumerate());
                for (frame, by_frame) in frames.into_iter().zip(&seen.by_frame) {
                    let first = LENS + own * frame;
                    match self.freedom {
                        Freedom::Any => {
                            by.extend((0..3).map(|axis| {
                                (first + axis, by_frame.turn.column(axis).into_owned())
                            }));
                        }
                        Freedom::PanTilt => {
                            by.extend([(first, by_frame.pan), (first + 1, by_frame.tilt)]);
                        }
                    }
                    by.push((first + own - 1, by_frame.log_focal));
                }
                equations.add(&seen.value_px, self.px, &by, self.loss);
            }
        }
        self.add_priors(at, &mut equations);
        equations
    }

    fn apply_step(&self, from: &EdgeState, step: &DVector<f64>) -> EdgeState {
        let own = self.freedom.parameters();
        // Additive step of the lens.
        let lens = FocalCurve {
            value: from.lens.value + step[0],
            per_1000_px: from.lens.per_1000_px + step[1],
            ..from.lens
        };
        let views = from.views.iter().enumerate().map(|(frame, view)| {
            let first = LENS + own * frame;
            let cam_from_common = match self.freedom {
                Freedom::Any => {
                    // Update on the right, R ← R exp(ω×), as `by_turn` differentiates it;
                    // re-orthonormalised against accumulated rounding.
                    let turn = Vec3::new(step[first], step[first + 1], step[first + 2]);
                    nearest_rotation(&(view.cam_from_common * from_rotation_vector(turn)))
                }
                Freedom::PanTilt => {
                    let ray = view.ray();
                    let (pan, tilt) = (
                        Angle::from_radians(step[first]),
                        Angle::from_radians(step[first + 1]),
                    );
                    q_tilt(ray.tilt + tilt) * q_pan(ray.pan + pan)
                }
            };
            View {
                cam_from_common,
                // At most a factor of two per step: the model is far from linear in ln f.
                focal_px: view.focal_px * step[first + own - 1].clamp(-0.7, 0.7).exp(),
                ..*view
            }
        });
        EdgeState {
            views: views.collect(),
            lens,
        }
    }
}

impl EdgeProblem<'_> {
    /// Adds the priors: the lens, the gauge, and a weak one of the tilt.
    fn add_priors(&self, at: &EdgeState, equations: &mut DenseEquations) {
        /// 1-σ that fixes a gauge parameter at its value, rad or ln px.
        const FIXED: f64 = 1e-6;
        /// Squared loss: a robust one would let the solution escape its gauge.
        const SURE: Loss = Loss::Squared;
        // The lens: its two parameters against their prior.
        let own = self.freedom.parameters();
        let one = Vector1::new(1.0);
        let off = [
            at.lens.value - self.expected.value,
            at.lens.per_1000_px - self.expected.per_1000_px,
        ];
        for (place, (off, sigma)) in off.into_iter().zip(self.sigma).enumerate() {
            equations.add(&Vector1::new(off), sigma, &[(place, one)], SURE);
        }
        // Gauge: matches do not change with a common rotation of all frames. The first frame keeps
        // its rotation, or, with the axis fixed, its pan. These residuals are zero wherever the
        // frame is: they are of the step, and stop it without drawing the frame anywhere.
        let gauge = match self.freedom {
            Freedom::Any => 0..3,
            Freedom::PanTilt => 0..1,
        };
        for parameter in gauge {
            equations.add(&Vector1::new(0.0), FIXED, &[(LENS + parameter, one)], SURE);
        }
        if self.freedom == Freedom::PanTilt {
            // Frames that hardly pan leave the pan axis, and with it all tilts, undetermined.
            for (frame, view) in at.views.iter().enumerate() {
                let tilt = view.ray().tilt;
                let value = Vector1::new((tilt - USUAL_TILT).radians());
                equations.add(
                    &value,
                    TILT_SIGMA.radians(),
                    &[(LENS + own * frame + 1, one)],
                    SURE,
                );
            }
        }
        // The sum of all steps in ln f is zero, likewise a residual of the step.
        if self.fixed_scale {
            let share = Vector1::new(1.0 / at.views.len() as f64);
            let of_all: Vec<_> = (0..at.views.len())
                .map(|frame| (LENS + own * frame + own - 1, share))
                .collect();
            equations.add(&Vector1::new(0.0), FIXED, &of_all, SURE);
        }
    }
}

impl EdgeState {
    /// Rotates the common frame so that the pan axis is its y axis, and removes the remaining roll
    /// of every frame.
    pub fn upright(mut self) -> Self {
        // Degenerate frames have no axis and stay as they are.
        let rotations: Vec<Mat3> = self.views.iter().map(|view| view.cam_from_common).collect();
        if let Some(upright) = upright_from_common(&rotations) {
            for view in &mut self.views {
                let forward = upright * view.cam_from_common.row(2).transpose();
                let ray = PanTilt::from_direction(forward);
                view.cam_from_common = q_tilt(ray.tilt) * q_pan(ray.pan);
            }
        }
        self
    }

    /// Multiplies all focal lengths by a factor and divides all angles from the mean tilt and from
    /// pan 0 by it. Image motion is about f times the angle, so the matches still nearly agree: a
    /// good start for the adjustment at the new scale.
    pub fn scale_focal_lengths(mut self, factor: f64) -> Self {
        let rays: Vec<PanTilt> = self.views.iter().map(View::ray).collect();
        let middle = rays.iter().map(|ray| ray.tilt.radians()).sum::<f64>() / rays.len() as f64;
        for (view, ray) in self.views.iter_mut().zip(rays) {
            let tilt = middle + (ray.tilt.radians() - middle) / factor;
            let pan = ray.pan.radians() / factor;
            view.cam_from_common =
                q_tilt(Angle::from_radians(tilt)) * q_pan(Angle::from_radians(pan));
            view.focal_px *= factor;
        }
        self
    }

    pub fn ptz(&self) -> Vec<Ptz> {
        self.views.iter().map(View::ptz).collect()
    }
}

/// The median residual of the matches, px: the difference of directions times the distance from the
/// centre of projection, as in [`MatchJacobian`].
pub(super) fn residual_px(edges: &[ViewGraphEdge], at: &EdgeState) -> f64 {
    let mut distances = Vec::new();
    for edge in edges {
        let (one, other) = (&at.views[edge.first], &at.views[edge.second]);
        distances.extend(edge.matches.iter().filter_map(|(first, second)| {
            let (here, there) = (
                one.direction(*first, &at.lens)?,
                other.direction(*second, &at.lens)?,
            );
            let range_px = (one.range_px(*first) * other.range_px(*second)).sqrt();
            Some((here.direction - there.direction).norm() * range_px)
        }));
    }
    median(&mut distances).unwrap_or(f64::INFINITY)
}

/// Typical tilt of cameras at a field; used where the frames leave it undetermined.
pub(super) const USUAL_TILT: Angle = Angle::from_degrees(-12.0);

/// Weight of the typical tilt, as the mean square of sin(pan): frames whose pans spread by more
/// than its root, 0.6°, determine the axis themselves.
const WEIGHT: f64 = 1e-4;

/// The rotation from the common frame to the one whose y axis is the pan axis, pointing down, and
/// whose z axis is the horizontal part of the mean viewing direction; `None` without frames.
pub(super) fn upright_from_common(cams_from_common: &[Mat3]) -> Option<Mat3> {
    // The sums of the frames' axes, in the common frame: their mean right, down and forward.
    let (right, down, forward) = (
        axis_sum(cams_from_common, 0).try_normalize(1e-9)?,
        axis_sum(cams_from_common, 1).try_normalize(1e-9)?,
        axis_sum(cams_from_common, 2),
    );
    // The axis minimises Σ (a · xᵢ)², where xᵢ is the x axis of frame i: the eigenvector of the
    // smallest eigenvalue of the mean of xᵢ xᵢᵀ.
    let mut scatter = Mat3::zeros();
    for turn in cams_from_common {
        let sideways = turn.row(0).transpose();
        scatter += sideways * sideways.transpose() / cams_from_common.len() as f64;
    }
    // If all frames have the same pan, every vector perpendicular to their x axis would do. A weak
    // term makes the axis perpendicular to the mean viewing direction levelled by the typical tilt.
    let (sin, cos) = USUAL_TILT.sin_cos();
    let level_forward = (right.cross(&down) * cos + down * sin).try_normalize(1e-9)?;
    scatter += level_forward * level_forward.transpose() * WEIGHT;
    let eigen = SymmetricEigen::new(scatter);
    let axis: Vec3 = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .into_owned();
    // An eigenvector has no sign; y points down.
    let axis = if axis.dot(&down) < 0.0 { -axis } else { axis };
    let ahead = (forward - axis * forward.dot(&axis)).try_normalize(1e-9)?;
    let sideways = axis.cross(&ahead);
    Some(Mat3::from_rows(&[
        sideways.transpose(),
        axis.transpose(),
        ahead.transpose(),
    ]))
}

/// The sum over all frames of one axis of the camera (0: x, 1: y, 2: z), in the common frame.
fn axis_sum(cams_from_common: &[Mat3], axis: usize) -> Vec3 {
    cams_from_common
        .iter()
        .map(|turn| turn.row(axis).transpose())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::rotation::{angle_between, from_rotation_vector, q_pan, q_tilt};

    fn cams(pans_deg: &[f64], common_from_upright: &Mat3) -> Vec<Mat3> {
        let tilts_deg = [-8.0, -14.0, -11.0, -16.0];
        let turn = |(pan, tilt): (&f64, &f64)| {
            q_tilt(Angle::from_degrees(*tilt))
                * q_pan(Angle::from_degrees(*pan))
                * common_from_upright.transpose()
        };
        pans_deg.iter().zip(&tilts_deg).map(turn).collect()
    }

    #[test]
    fn the_axis_is_found_whatever_frame_the_rotations_are_given_in() {
        let common_from_upright = from_rotation_vector(Vec3::new(0.4, -0.7, 0.2));
        let found =
            upright_from_common(&cams(&[-30.0, 12.0, 1.0, 25.0], &common_from_upright)).unwrap();
        let axis = found.row(1).transpose();
        assert!(axis.dot(&common_from_upright.column(1)) > 1.0 - 1e-7);
        assert!((found.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_camera_that_does_not_pan_is_taken_to_look_down_as_usual() {
        let found = upright_from_common(&cams(&[5.0, 5.0, 5.0, 5.0], &Mat3::identity())).unwrap();
        // The tilts average 12.25 degrees down.
        assert!(
            angle_between(&found, &q_pan(Angle::from_degrees(5.0))).degrees() < 1.0,
            "{found}"
        );
        assert!(upright_from_common(&[]).is_none());
    }
}
