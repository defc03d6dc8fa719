//! Aligns a camera with ridges of paint and with clicks: the problem linearised around one camera,
//! and its robust solution.
//!
//! # Problem
//!
//! A camera predicts where the field's lines appear. At samples along each predicted line the
//! picture was searched across the line, and ridges of paint were found at some offsets
//! ([`LineObservations`]). Find the small change u of the camera after which the lines lie on the
//! ridges and the clicks near their landmarks.
//!
//! # Method
//!
//! A sample measures across its line only; along the line one ridge looks like the next. With the
//! sample's image p, its unit normal n and the ridge's offset o along n, the residual is
//!
//! ```text
//! r(u) = o − n·(∂p/∂u) u
//! ```
//!
//! as in edge trackers that search along normals (Harris: "Tracking with rigid models", 1992) and
//! in point-to-line ICP (Chen and Medioni, 1992). With three unknowns each Gauss–Newton step
//! ([`gauss_newton_step`]) solves a 3 × 3 system. Two things make it robust:
//!
//! * A sample may have several ridges: its own line, a parallel one, a board. It is paired with the
//!   ridge nearest to its line *after the step so far*, chosen anew in every iteration.
//! * Geman–McClure weights nearly ignore ridges farther off than the scale of the loss, and that
//!   scale shrinks from iteration to iteration (graduated non-convexity).
//!
//! The picture is not read again between iterations. The linearisation therefore has to be good
//! over the reach of the search. `snap.rs` reads the picture again around the result, within a
//! smaller reach, and repeats the alignment.

use super::sightings::LineObservations;
use nalgebra::Vector1;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_core::solve::{
    BlockEquations, Linearised, Loss, Observation, Problem, Residual, gauss_newton_step,
};

/// 1-σ of the independent part of a ridge's error, px at 1920 px width.
const RIDGE_SIGMA_PX: f64 = 0.5;

/// 1-σ of the error that all samples of a line have in common, px at 1920 px width: the paint is
/// not where the rules put it, or the base is slightly wrong.
const LINE_SIGMA_PX: f64 = 0.16;

/// The influence of a click stops growing beyond 2 σ.
const CLICK_LOSS: Loss = Loss::Huber { k: 2.0 };

/// Damping of the normal equations, 1/px²: keeps the step finite if neither ridges nor clicks
/// constrain it.
const DAMPING: f64 = 1e-9;

/// A change of a camera in px: pan and tilt as motion of the picture's centre, focal length as
/// motion of its left and right border. In these units all three numbers have the same scale, so
/// the Euclidean distance between steps is meaningful.
pub(super) type StepPx = Vec3;

/// A camera, and the scale of steps around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearisedCamera {
    pub camera: PtzCamera,
    /// Change of (pan, tilt, log f) per px of a step.
    ptz_per_px: Vec3,
}

impl LinearisedCamera {
    /// Near the centre of the picture, 1/f rad of pan or tilt move the image by 1 px (a pan by
    /// cos(tilt) of it, which is left out). A factor exp(2/width) of the focal length moves the
    /// borders, width/2 from the centre, by 1 px.
    pub fn new(base: &CameraBase, ptz: Ptz, width_px: u32) -> Self {
        let rad_per_px = 1.0 / ptz.focal_px;
        let log_focal_per_px = 2.0 / f64::from(width_px);
        Self {
            camera: PtzCamera::new(*base, ptz),
            ptz_per_px: Vec3::new(rad_per_px, rad_per_px, log_focal_per_px),
        }
    }

    /// The camera after a step. The focal length changes by a factor of two at most, however far
    /// the step leads.
    pub fn ptz_after(&self, step: &StepPx) -> Ptz {
        const MAX_LOG_FOCAL: f64 = std::f64::consts::LN_2;
        // The focal length changes by its logarithm, so that it stays positive. Where the paint
        // hardly determines the zoom, a step of it may be of any size: hence the limit.
        let change = step.component_mul(&self.ptz_per_px);
        let ptz = self.camera.ptz();
        Ptz::new(
            (ptz.pan + Angle::from_radians(change.x)).wrap(),
            ptz.tilt + Angle::from_radians(change.y),
            ptz.focal_px * change.z.clamp(-MAX_LOG_FOCAL, MAX_LOG_FOCAL).exp(),
        )
    }

    /// Converts a derivative by (pan rad, tilt rad, focal length px) into one by a step.
    fn by_step_from_by_ptz(&self, by_ptz: Vec3) -> StepPx {
        // Chain rule: ∂/∂(log f) = f · ∂/∂f.
        let by_log_focal = by_ptz.z * self.camera.ptz().focal_px;
        Vec3::new(by_ptz.x, by_ptz.y, by_log_focal).component_mul(&self.ptz_per_px)
    }
}

/// The ridges observed around a camera, with the derivatives of their samples.
pub(super) struct RidgeAlignment<'a> {
    sightings: &'a LineObservations,
    /// n·∂p/∂u of each sample; zero where the sample cannot be seen.
    by_step: Vec<StepPx>,
    /// 1-σ of each sample's ridge, px.
    sigmas_px: Vec<f64>,
}

impl<'a> RidgeAlignment<'a> {
    /// `scale` is the width of the picture by 1920 px.
    pub fn new(around: &LinearisedCamera, sightings: &'a LineObservations, scale: f64) -> Self {
        let by_step = sightings.samples.iter().map(|sample| {
            // A sample that the linearised camera cannot see gets a zero row and constrains
            // nothing. It keeps its place, because samples are named by their index.
            let Ok((_, image_by_ptz)) = around.camera.image_from_world_by_ptz(sample.at) else {
                return StepPx::zeros();
            };
            around.by_step_from_by_ptz(image_by_ptz.tr_mul(&sample.normal))
        });
        Self {
            sightings,
            by_step: by_step.collect(),
            sigmas_px: sample_sigmas_px(sightings, scale),
        }
    }

    pub fn num_samples(&self) -> usize {
        self.by_step.len()
    }

    /// Signed distance from a sample's line, after a step, to the ridge nearest to it, px. None for
    /// a sample without ridges.
    pub fn residual_px(&self, sample: usize, step: &StepPx) -> Option<f64> {
        let line_moved_px = self.by_step[sample].dot(step);
        let ridge = self.sightings.nearest(sample, line_moved_px)?;
        Some(ridge.offset_px - line_moved_px)
    }

    /// Number of samples with a ridge on their line after a step. Each counts by its distance: 1 on
    /// the line, 0 from `within_px` on.
    pub fn votes(&self, step: &StepPx, within_px: f64) -> f64 {
        let residuals_px =
            (0..self.num_samples()).filter_map(|sample| self.residual_px(sample, step));
        residuals_px
            .map(|residual_px| (1.0 - (residual_px / within_px).powi(2)).max(0.0))
            .sum()
    }

    /// Aligns with the ridges of the samples in `takes_part` and with the clicks, beginning at
    /// `step`.
    ///
    /// Makes one Gauss–Newton step for each scale of the robust loss; scales go from coarse to
    /// fine.
    pub fn align(
        &self,
        step: StepPx,
        loss_scales_px: &[f64],
        clicks: Option<&ClickAlignment>,
        takes_part: impl Fn(usize) -> bool,
    ) -> StepPx {
        // With damping, only numbers that are not finite leave the equations without a solution.
        // The camera then stays where it is.
        loss_scales_px.iter().fold(step, |step, &loss_scale_px| {
            let problem = AlignmentAtScale {
                ridges: self,
                clicks,
                takes_part: &takes_part,
                loss_scale_px,
            };
            gauss_newton_step(&problem, &step).unwrap_or(step)
        })
    }
}

/// The alignment problem under one scale of the robust loss.
struct AlignmentAtScale<'a, TakesPart> {
    ridges: &'a RidgeAlignment<'a>,
    clicks: Option<&'a ClickAlignment>,
    /// Whether a sample is used.
    takes_part: &'a TakesPart,
    loss_scale_px: f64,
}

impl<TakesPart: Fn(usize) -> bool> Problem for AlignmentAtScale<'_, TakesPart> {
    type State = StepPx;
    type Equations = BlockEquations<0, 3>;

    fn equations(&self, step: &StepPx) -> BlockEquations<0, 3> {
        let mut equations = BlockEquations::zero();
        equations.own += Mat3::identity() * DAMPING;
        // Clicks: Huber's loss, so that even a wrong one keeps some influence.
        for click in self.clicks.iter().flat_map(|clicks| &clicks.rows) {
            equations.add(click, step, CLICK_LOSS);
        }
        // Ridges: each is paired anew. The loss takes its scale in σ of the residual, hence the
        // quotient.
        for sample in (0..self.ridges.num_samples()).filter(|sample| (self.takes_part)(*sample)) {
            let ridge = NearestRidge {
                ridges: self.ridges,
                sample,
            };
            equations.add(
                &ridge,
                step,
                Loss::GemanMcClure {
                    c: self.loss_scale_px / ridge.sigma(),
                },
            );
        }
        equations
    }

    fn apply_step(&self, from: &StepPx, change: &StepPx) -> StepPx {
        from + change
    }
}

/// The residual of one sample: the ridge nearest to where the step so far has moved its line. It
/// has no value if the sample has no ridges.
struct NearestRidge<'a> {
    ridges: &'a RidgeAlignment<'a>,
    sample: usize,
}

impl Residual<1, 0, 3> for NearestRidge<'_> {
    type State = StepPx;

    fn sigma(&self) -> f64 {
        self.ridges.sigmas_px[self.sample]
    }

    /// Predicted less seen, −r of the page above.
    fn value(&self, step: &StepPx) -> Option<Vector1<f64>> {
        Some(Vector1::new(-self.ridges.residual_px(self.sample, step)?))
    }

    fn linearise(&self, step: &StepPx) -> Option<Linearised<1, 0, 3>> {
        let by_own = self.ridges.by_step[self.sample].transpose();
        Some(Linearised::without_shared(self.value(step)?, by_own))
    }
}

/// 1-σ of every sample's ridge, px. The samples of a line share its error (see [`ridge_sigma_px`]).
pub(super) fn sample_sigmas_px(sightings: &LineObservations, scale: f64) -> Vec<f64> {
    let lines = sightings.samples.iter().map(|sample| sample.line + 1);
    let num_lines = lines.max().unwrap_or(0);
    // Count samples with ridges, not ridges: a sample contributes at most one residual.
    let mut ridges_of_line = vec![0_u32; num_lines];
    for (index, sample) in sightings.samples.iter().enumerate() {
        ridges_of_line[sample.line] += u32::from(!sightings.ridges_at(index).is_empty());
    }
    sightings
        .samples
        .iter()
        .map(|sample| ridge_sigma_px(ridges_of_line[sample.line], scale))
        .collect()
}

/// 1-σ of one of `count` ridges of a line, px, if they are treated as independent.
///
/// Their errors have a part of their own, σ, and a part τ that is common to the line. The mean of n
/// such ridges has the variance σ²/n + τ². Independent ridges of variance σ² + n τ² have the same
/// mean and the same variance of it, so a line with many samples does not count for more than its
/// common error allows, and no covariance matrix is needed.
pub(in crate::paint) fn ridge_sigma_px(count: u32, scale: f64) -> f64 {
    (RIDGE_SIGMA_PX.powi(2) + f64::from(count) * LINE_SIGMA_PX.powi(2)).sqrt() * scale
}

/// The clicks, linearised around a camera.
pub(super) struct ClickAlignment {
    rows: Vec<ClickRow>,
}

/// One equation of a click: a landmark has two, a point on a line one.
struct ClickRow {
    by_step: StepPx,
    /// From the predicted position to the click, px, along one axis or across the line.
    offset_px: f64,
    sigma_px: f64,
}

impl ClickRow {
    fn residual_px(&self, step: &StepPx) -> f64 {
        self.offset_px - self.by_step.dot(step)
    }
}

impl Residual<1, 0, 3> for ClickRow {
    type State = StepPx;

    fn sigma(&self) -> f64 {
        self.sigma_px
    }

    fn value(&self, step: &StepPx) -> Option<Vector1<f64>> {
        Some(Vector1::new(-self.residual_px(step)))
    }

    fn linearise(&self, step: &StepPx) -> Option<Linearised<1, 0, 3>> {
        Some(Linearised::without_shared(
            self.value(step)?,
            self.by_step.transpose(),
        ))
    }
}

impl ClickAlignment {
    /// Clicks that only check the result are left out, and so are those on a landmark or line that
    /// the camera cannot see.
    pub fn new(around: &LinearisedCamera, clicks: &[Observation]) -> Self {
        let mut rows = Vec::with_capacity(2 * clicks.len());
        for click in clicks.iter().filter(|click| !click.check) {
            let Some((predicted_minus_click_px, by_ptz)) =
                click.shape.residual_by_ptz(&around.camera, click.image)
            else {
                continue;
            };
            // The residual of the click is prediction less click; a row stores its negative, as for
            // ridges.
            for axis in 0..click.equations() {
                rows.push(ClickRow {
                    by_step: around.by_step_from_by_ptz(by_ptz.row(axis).transpose()),
                    offset_px: -predicted_minus_click_px[axis],
                    sigma_px: click.sigma_px,
                });
            }
        }
        Self { rows }
    }

    /// Whether a step takes no click farther from its landmark or line than `sigmas` beyond its
    /// present distance.
    pub fn allows(&self, step: &StepPx, sigmas: f64) -> bool {
        // The present distance is added, because the camera may be far off before its first
        // alignment.
        self.rows
            .iter()
            .all(|row| row.residual_px(step).abs() <= sigmas * row.sigma_px + row.offset_px.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sightings::SamplingDistances;
    use super::*;
    use crate::paint::GroundPicture;
    use crate::paint::drawn::{PICTURE, SIZE, camera, soccer, truth};
    use touchline_core::geometry::Vec2;
    use touchline_core::testing::check_derivatives;

    #[test]
    fn ridges_and_clicks_change_with_a_step_as_their_derivatives_say() {
        let (field, near) = (soccer(), camera(4.1, -14.05, 1504.0));
        let look = SamplingDistances {
            reach_px: 16.0,
            spacing_px: 60.0,
            step_px: 1.0,
        };
        let sightings =
            LineObservations::search(&GroundPicture::new(&PICTURE, &[]), &field, &near, look);
        let around = LinearisedCamera::new(near.base(), near.ptz(), SIZE.width);
        let ridges = RidgeAlignment::new(&around, &sightings, 1.0);
        let from = StepPx::new(0.7, -0.4, 1.1);
        let with_ridge =
            (0..ridges.num_samples()).filter(|sample| !sightings.ridges_at(*sample).is_empty());
        for sample in with_ridge {
            check_derivatives(
                &NearestRidge {
                    ridges: &ridges,
                    sample,
                },
                |_, step| from + step,
            )
            .expect("ridge");
        }
        let world = field.landmark_in_world(field.landmark("centre_mark").unwrap());
        let image = truth()
            .image_from_world(world)
            .unwrap()
            .translate(Vec2::new(2.0, 1.0));
        let clicks = ClickAlignment::new(&around, &[Observation::from_point(world, image, 1.5, 0)]);
        assert_eq!(clicks.rows.len(), 2);
        for (row, axis_in_image) in clicks.rows.iter().zip([Vec2::x(), Vec2::y()]) {
            check_derivatives(row, |_, step| from + step).expect("click");
            // To first order, a step in px is the step of the camera itself.
            let moved = |step: StepPx| {
                let stepped = PtzCamera::new(*near.base(), around.ptz_after(&step));
                let at = stepped.image_from_world(world).unwrap();
                at.offset_from(near.image_from_world(world).unwrap())
                    .dot(&axis_in_image)
            };
            for axis in 0..3 {
                let h = StepPx::ith(axis, 1e-3);
                let numeric = (moved(h) - moved(-h)) / 2e-3;
                assert!(
                    (row.by_step[axis] - numeric).abs() < 1e-5,
                    "{axis}: {} is not {numeric}",
                    row.by_step[axis]
                );
            }
        }
    }
}
