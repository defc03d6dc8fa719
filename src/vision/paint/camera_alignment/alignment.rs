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

use super::ground_on_field::ground_on_field;
use super::sightings::{LineObservations, SamplingDistances};
use crate::paint::{GroundPicture, SnapError};
use nalgebra::Vector1;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, Mat3, Vec3, subsample};
use touchline_core::solve::{
    BlockEquations, Linearised, Loss, Observation, Problem, Refined, Residual, gauss_newton_step,
    refine,
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
        Ptz {
            pan: (ptz.pan + Angle::from_radians(change.x)).wrap(),
            tilt: ptz.tilt + Angle::from_radians(change.y),
            focal_px: ptz.focal_px * change.z.clamp(-MAX_LOG_FOCAL, MAX_LOG_FOCAL).exp(),
        }
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

/// A point at which the centre of a line's paint is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintPlace {
    /// The line, as an index into [`FieldModel::lines`].
    pub line: usize,
    /// Position, px.
    pub image: ImagePoint,
    /// 1-σ across the line, px, including this point's share of the error that all points of the
    /// line have in common.
    pub sigma_px: f64,
}

/// Sampling of the picture, px at 1920 px width.
const LOOK: SamplingDistances = SamplingDistances {
    reach_px: 8.0,
    spacing_px: 24.0,
    step_px: 0.5,
};

/// Maximum distance of paint from where it is predicted, px at 1920 px width. Paint farther away
/// belongs to another line.
const NEAR_PX: f64 = 5.0;

/// Minimum number of points of a line. Fewer may be a sock or a sign.
const FEWEST_OF_LINE: usize = 4;

/// Maximum number of points of a line. More add little, because their common error remains.
const MOST_OF_LINE: usize = 16;

/// The points of paint near the lines that a camera predicts, line by line.
pub fn paint_places(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> Vec<PaintPlace> {
    let ground = &*ground_on_field(ground, field, camera);
    let scale = ground.size().scale_from_1920();
    let look = SamplingDistances {
        reach_px: LOOK.reach_px * scale,
        spacing_px: LOOK.spacing_px * scale,
        ..LOOK
    };
    let seen = LineObservations::search(ground, field, camera, look);
    // The nearest ridge of each sample, if it is near enough.
    let mut of_line: Vec<Vec<ImagePoint>> = vec![Vec::new(); field.lines.len()];
    for (index, sample) in seen.samples.iter().enumerate() {
        let near = seen
            .nearest(index, 0.0)
            .filter(|ridge| ridge.offset_px.abs() <= NEAR_PX * scale);
        of_line[sample.line]
            .extend(near.map(|ridge| sample.image.translate(sample.normal * ridge.offset_px)));
    }
    // Points are spread over the line's whole length. Their common error counts once for the line
    // (see `ridge_sigma_px`), so that the 1-σ of each depends on how many of them there are.
    of_line
        .into_iter()
        .enumerate()
        .filter(|(_, places)| places.len() >= FEWEST_OF_LINE)
        .flat_map(|(line, places)| {
            let places = subsample(places, MOST_OF_LINE);
            let sigma_px = ridge_sigma_px(places.len() as u32, scale);
            places.map(move |image| PaintPlace {
                line,
                image,
                sigma_px,
            })
        })
        .collect()
}

// The lens of one frame: k₁ from its paint and clicks, for a camera whose lens is unknown.
//
// # Method
//
// Profile likelihood: the minimum of the cost over pan, tilt and focal length is a function of k₁
// alone. It is computed on a grid. The parabola through the best value and its two neighbours
// gives k₁ and its σ. Then the picture is searched for paint again with that lens, three times in
// all. A grid is used instead of descent because far from the minimum the robust loss makes the
// cost flat.

/// Number of times the picture is searched for paint.
const LOOKS: usize = 3;

/// Step of the grid of k₁.
const STEP: f64 = 0.02;

/// Grid steps on each side of the current k₁.
const STEPS: i32 = 5;

/// Maximum |k₁| of real lenses.
const MAX_K1: f64 = 0.5;

/// Maximum 1-σ of an accepted k₁.
const MAX_SIGMA: f64 = 0.05;

/// Ridges of something else have little influence.
const LOSS: Loss = Loss::Cauchy { c: 2.0 };

/// A frame's camera with its own k₁.
pub(super) struct OwnLens {
    /// The base with the fitted lens.
    pub base: CameraBase,
    pub ptz: Ptz,
}

/// Fits k₁ to a frame's paint and clicks, from a camera near by.
///
/// # Errors
///
/// [`SnapError::LensOpen`] if they do not determine k₁.
pub(super) fn own_lens(
    ground: &GroundPicture,
    field: &FieldModel,
    near: &PtzCamera,
    clicks: &[Observation],
) -> Result<OwnLens, SnapError> {
    // A constant k₁: the frame has one focal length, so that its paint says nothing about the slope
    // of a curve.
    let mut k1 = near.base().distortion.at(near.ptz().focal_px);
    let mut found = *near;
    for _ in 0..LOOKS {
        // Observations: ridges near the lines that the current camera predicts, and the clicks.
        let places = paint_places(ground, field, &found);
        let paint = places.iter().enumerate().filter_map(|(number, place)| {
            Observation::from_paint(field, place.line, place.image, place.sigma_px, number)
        });
        let seen: Vec<Observation> = clicks
            .iter()
            .filter(|click| !click.check)
            .copied()
            .chain(paint)
            .collect();
        // The profile of the cost: every k₁ of the grid has its own pan, tilt and focal length. The
        // ends of the grid are no candidates: they lack a neighbour. If the minimum lies beyond,
        // the next pass begins nearer to it.
        let values: Vec<f64> = (-STEPS..=STEPS)
            .map(|step| k1 + f64::from(step) * STEP)
            .collect();
        let costs: Vec<f64> = values
            .iter()
            .map(|k1| refine_with_k1(&found, *k1, &seen).cost)
            .collect();
        let inner = 1..values.len() - 1;
        let best = inner
            .min_by(|a, b| costs[*a].total_cmp(&costs[*b]))
            .unwrap_or(STEPS as usize);
        // First and second derivative by central differences.
        let [less, here, more] = [costs[best - 1], costs[best], costs[best + 1]];
        let (slope, curvature) = (
            (more - less) / (2.0 * STEP),
            (more - 2.0 * here + less) / (STEP * STEP),
        );
        // The cost is a sum of squares in σ; its second derivative is 2 / variance.
        let sigma = if curvature > 0.0 {
            (2.0 / curvature).sqrt()
        } else {
            f64::INFINITY
        };
        if !(sigma <= MAX_SIGMA) {
            return Err(SnapError::LensOpen { sigma });
        }
        // Newton step to the vertex of the parabola, at most one grid step.
        k1 = (values[best] + (-slope / curvature).clamp(-STEP, STEP)).clamp(-MAX_K1, MAX_K1);
        let ptz = refine_with_k1(&found, k1, &seen).ptz;
        let base = with_k1(near.base(), k1);
        let base = CameraBase {
            sigma: base.sigma.with_own_k1(sigma),
            ..base
        };
        found = PtzCamera::new(base, ptz);
    }
    Ok(OwnLens {
        base: *found.base(),
        ptz: found.ptz(),
    })
}

/// Pan, tilt and focal length for a given k₁, from those of a camera near by, and their cost.
fn refine_with_k1(near: &PtzCamera, k1: f64, seen: &[Observation]) -> Refined {
    refine(&with_k1(near.base(), k1), near.ptz(), seen, LOSS, None)
}

/// The base with a constant k₁, the same at all focal lengths, in place of its own curve.
fn with_k1(base: &CameraBase, k1: f64) -> CameraBase {
    CameraBase {
        distortion: FocalCurve::constant(k1),
        ..*base
    }
}

#[cfg(test)]
mod tests {
    use super::super::sightings::SamplingDistances;
    use super::*;
    use crate::paint::GroundPicture;
    use crate::paint::drawn::{PICTURE, SIZE, camera, soccer, truth};
    use touchline_core::geometry::{PixelBox, Vec2, median};
    use touchline_core::solve::Observation;
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

    #[test]
    fn places_lie_on_the_paint_whatever_the_camera_that_predicts_it() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        for predicting in [truth(), camera(4.05, -14.04, 1502.0)] {
            let places = paint_places(&ground, &field, &predicting);
            let mut off_px: Vec<f64> = places
                .iter()
                .map(|place| {
                    Observation::from_paint(&field, place.line, place.image, place.sigma_px, 0)
                        .unwrap()
                })
                .map(|seen| seen.distance_px(&truth()).unwrap())
                .collect();
            assert!(
                places.len() > 60 && places.iter().all(|place| place.sigma_px < 1.0),
                "{places:?}"
            );
            assert!(median(&mut off_px).unwrap() < 0.3, "{off_px:?}");
        }
        assert!(paint_places(&ground, &field, &camera(180.0, -14.0, 1500.0)).is_empty());
    }

    #[test]
    fn the_lens_of_a_drawn_picture_is_found_from_none() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        let near = PtzCamera::new(with_k1(truth().base(), 0.0), truth().ptz());
        let own = own_lens(&ground, &field, &near, &[]).unwrap();
        let k1 = truth().base().distortion.at(truth().ptz().focal_px);
        assert!(
            (own.base.distortion.at(own.ptz.focal_px) - k1).abs() < 0.01,
            "{:?}",
            own.base.distortion
        );
    }

    #[test]
    fn without_paint_the_lens_is_left_open() {
        let (width, height) = (f64::from(SIZE.width), f64::from(SIZE.height));
        let all = PixelBox {
            x: 0.0,
            y: 0.0,
            width,
            height,
        };
        let hidden = own_lens(
            &GroundPicture::new(&PICTURE, &[all]),
            &soccer(),
            &truth(),
            &[],
        );
        assert!(matches!(hidden, Err(SnapError::LensOpen { .. })));
    }
}
