//! How ridges and clicks pull on pan, tilt and focal length, linear around a camera.
//!
//! A ridge pulls across its line only: with the sample's normal n, its image p and a step u of the camera, the residual is
//! `offset − n·(∂p/∂u) u`. Which of a sample's ridges is its line is chosen again at every step.

use super::Sightings;
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, Mat3, Vec3};
use crate::solve::{Loss, Observation};

/// 1-σ of a ridge's offset on its own, px at 1920 px width.
const RIDGE_SIGMA_PX: f64 = 0.5;

/// 1-σ of what all samples of a line have in common, px at 1920 px width: paint that is not where the rule puts it, a base that
/// is not quite right.
pub(super) const LINE_SIGMA_PX: f64 = 0.16;

/// Beyond this a click's pull grows no more, sigmas.
const CLICK_LOSS: Loss = Loss::Huber { k: 2.0 };

/// A step of a camera as three lengths in px: what pan and tilt move the middle of the picture by, what the focal length
/// moves its left and right border by.
pub(super) type Step = Vec3;

/// The linear neighbourhood of a camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub camera: PtzCamera,
    /// (rad, rad, log f) a px.
    unit: Vec3,
}

impl Around {
    pub fn new(base: &CameraBase, ptz: Ptz, width_px: u32) -> Self {
        let angle = 1.0 / ptz.focal_px;
        Self { camera: PtzCamera::new(*base, ptz), unit: Vec3::new(angle, angle, 2.0 / f64::from(width_px)) }
    }

    /// The camera after a step; the focal length changes by a factor of two at most.
    pub fn after(&self, step: &Step) -> Ptz {
        let by = step.component_mul(&self.unit);
        let ptz = self.camera.ptz();
        let limit = std::f64::consts::LN_2;
        Ptz {
            pan: (ptz.pan + Angle::from_radians(by.x)).wrapped(),
            tilt: ptz.tilt + Angle::from_radians(by.y),
            focal_px: ptz.focal_px * by.z.clamp(-limit, limit).exp(),
        }
    }

    /// A derivative by pan (rad), tilt (rad) and focal length (px) as one by a step.
    fn by_step(&self, by_ptz: Vec3) -> Step {
        Vec3::new(by_ptz.x, by_ptz.y, by_ptz.z * self.camera.ptz().focal_px).component_mul(&self.unit)
    }
}

/// The pull of ridges.
pub(super) struct RidgePull<'a> {
    sightings: &'a Sightings,
    rows: Vec<Step>,
    /// Of a sample whose ridge lies exactly where it is predicted, 1/px².
    weights: Vec<f64>,
}

impl<'a> RidgePull<'a> {
    /// The pull of what is seen around a camera of a picture; `scale` is its px by those of 1920 px width.
    pub fn new(around: &Around, sightings: &'a Sightings, scale: f64) -> Self {
        let rows = sightings.samples.iter().map(|sample| {
            let by_ptz = around.camera.image_from_world_by_ptz(sample.at).map(|(_, by_ptz)| by_ptz);
            by_ptz.map_or(Step::zeros(), |by_ptz| around.by_step(by_ptz.tr_mul(&sample.normal)))
        });
        let rows = rows.collect();
        let sigmas = sample_sigmas_px(sightings, scale);
        Self { sightings, rows, weights: sigmas.into_iter().map(|sigma| sigma.powi(-2)).collect() }
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// How far a sample's nearest ridge lies from its line after a step, px; none without a ridge.
    pub fn residual(&self, sample: usize, step: &Step) -> Option<f64> {
        let moved = self.rows[sample].dot(step);
        self.sightings.nearest(sample, moved).map(|ridge| ridge.offset_px - moved)
    }

    /// How many samples have a ridge where it is predicted after a step: each counts 1 at no distance and 0 beyond
    /// `within_px`.
    pub fn votes(&self, step: &Step, within_px: f64) -> f64 {
        let residuals = (0..self.len()).filter_map(|sample| self.residual(sample, step));
        residuals.map(|residual| (1.0 - (residual / within_px).powi(2)).max(0.0)).sum()
    }

    /// The step that the ridges of the samples in `takes_part` and the clicks agree on, from `step` on: one
    /// Gauss–Newton step for each scale of the robust loss, px.
    pub fn solved(
        &self,
        mut step: Step,
        scales_px: &[f64],
        clicks: Option<&ClickPull>,
        takes_part: impl Fn(usize) -> bool,
    ) -> Step {
        for scale_px in scales_px {
            let (mut matrix, mut gradient) = (Mat3::identity() * FAINT, Vec3::zeros());
            if let Some(clicks) = clicks {
                clicks.add(&step, &mut matrix, &mut gradient);
            }
            for sample in (0..self.len()).filter(|sample| takes_part(*sample)) {
                let Some(residual) = self.residual(sample, &step) else { continue };
                // Geman and McClure's weight: far ridges are another line's.
                let weight = self.weights[sample] / (1.0 + (residual / scale_px).powi(2)).powi(2);
                let row = self.rows[sample];
                matrix += row * row.transpose() * weight;
                gradient += row * (residual * weight);
            }
            if let Some(inverse) = matrix.try_inverse() {
                step += inverse * gradient;
            }
        }
        step
    }
}

/// Keeps a step from where nothing pulls at all, 1/px².
const FAINT: f64 = 1e-9;

/// 1-σ of every sample's ridge, px: samples of a line that has many count less each.
pub(super) fn sample_sigmas_px(sightings: &Sightings, scale: f64) -> Vec<f64> {
    let lines = sightings.samples.iter().map(|sample| sample.line + 1).max().unwrap_or(0);
    let mut counts = vec![0_u32; lines];
    for (index, sample) in sightings.samples.iter().enumerate() {
        counts[sample.line] += u32::from(!sightings.ridges_at(index).is_empty());
    }
    sightings.samples.iter().map(|sample| ridge_sigma_px(counts[sample.line], scale)).collect()
}

/// 1-σ of a ridge, px, beside `count` others of its line that err with it.
pub(super) fn ridge_sigma_px(count: u32, scale: f64) -> f64 {
    (RIDGE_SIGMA_PX.powi(2) + f64::from(count) * LINE_SIGMA_PX.powi(2)).sqrt() * scale
}

/// The pull of clicks.
pub(super) struct ClickPull {
    /// The derivative by a step, how far the click lies off (px), its 1-σ (px): one for each equation.
    rows: Vec<(Step, f64, f64)>,
}

impl ClickPull {
    pub fn new(around: &Around, clicks: &[Observation]) -> Self {
        let mut rows = Vec::with_capacity(2 * clicks.len());
        for click in clicks.iter().filter(|click| !click.check) {
            let Some((offset_px, by_ptz)) = click.shape.residual_by_ptz(&around.camera, click.image) else { continue };
            for axis in 0..click.equations() {
                rows.push((around.by_step(by_ptz.row(axis).transpose()), -offset_px[axis], click.sigma_px));
            }
        }
        Self { rows }
    }

    fn add(&self, step: &Step, matrix: &mut Mat3, gradient: &mut Vec3) {
        for (row, offset_px, sigma_px) in &self.rows {
            let residual = offset_px - row.dot(step);
            let (_, weight) = CLICK_LOSS.of((residual / sigma_px).powi(2));
            let weight = weight * sigma_px.powi(-2);
            *matrix += row * row.transpose() * weight;
            *gradient += row * (residual * weight);
        }
    }

    /// Whether no click is farther off after a step than clicks are, given how far off they are before.
    pub fn allows(&self, step: &Step, sigmas: f64) -> bool {
        self.rows
            .iter()
            .all(|(row, offset_px, sigma_px)| (offset_px - row.dot(step)).abs() <= sigmas * sigma_px + offset_px.abs())
    }
}
