//! A camera aligned to the painted lines of one picture, or the reason why not. Users know it as
//! *snapping*.
//!
//! # Problem
//!
//! A base is known, and a camera that is right within some 50 px. Find pan, tilt and focal length
//! that put the field's lines on their paint, and refuse wherever the paint does not decide: a
//! wrong camera that is sure of itself costs more than none.
//!
//! # Method
//!
//! 1. **Sightings** (`sightings.rs`): the field's lines are sampled as the camera predicts them,
//!    and the picture is searched across each sample for ridges of paint: narrow, brighter than the
//!    ground on both sides, of no other colour.
//! 2. **Likely steps** (`search.rs`): every change of the camera within reach is judged by how many
//!    samples then find a ridge. Several are kept, because a parallel line may be as near as the
//!    right one.
//! 3. **Alignment** (`alignment.rs`) from each: Gauss–Newton on distances across the lines, with
//!    Geman–McClure weights whose scale shrinks. Search and alignment are repeated with a smaller
//!    reach: 48, 16 and 8 px at 1920 px width.
//! 4. **Acceptance**. The best fit is refused where another one 10 px away has 90 % of its
//!    agreement (ambiguous); where fewer than 40 samples show paint; where two halves of the
//!    samples give cameras more than 1.5 px apart; where a click is left by more than 6 σ; where
//!    paint and clicks leave the worst corner open by more than 8 px; and where the line check
//!    (`check.rs`), which looks at the picture afresh, gives it a probability below 0.8.
//!
//! The covariance takes 0.5 px for a ridge and 0.16 px for all ridges of one line alike (paint is
//! not where the rules put it), and adds the base's own.
//!
//! # What it is proof against
//!
//! Parallel lines, boards, second sets of lines on a training ground, shadows, players. It is not
//! proof against a base that is wrong in a way that pan and tilt can make up for in one picture;
//! `calibrate::estimate_on_paint` adjusts base and frames together for that.

use super::alignment::{
    ClickAlignment, LinearisedCamera, RidgeAlignment, StepPx, sample_sigmas_px,
};
use super::check::{check_lines, halves_apart_px, overlays_apart_px};
use super::lens::{OwnLens, own_lens};
use super::search::likely_steps;
use super::sightings::Look;
use super::{GroundPicture, LineCheck, Sightings, SnapError};
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{stride_of_subsample, subsample};
use touchline_core::solve::{Observation, SolveError, Uncertainty};

/// How a camera is snapped. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapOptions {
    /// Paint is looked for this far from where the start predicts it. 48 by default.
    pub reach_px: f64,
    /// Fewer samples with paint give no camera. 40 by default.
    pub min_samples: usize,
    /// Two halves of the samples may give cameras this far apart. 1.5 by default.
    pub halves_px: f64,
    /// The overlay's 1-σ at the worst corner of the picture, as the paint and the clicks leave it,
    /// may be as large as this. 8 by default.
    pub max_corner_sigma_px: f64,
    /// A click may lie this far from where the result puts it, sigmas. 6 by default.
    pub click_sigmas: f64,
    /// The line check's score of the result is at least this. 0.8 by default.
    pub min_score: f64,
    /// Whether the frame's own k₁ is found as well, in place of the base's lens. Not by default.
    pub own_k1: bool,
}

impl Default for SnapOptions {
    fn default() -> Self {
        Self {
            reach_px: 48.0,
            min_samples: 40,
            halves_px: 1.5,
            max_corner_sigma_px: 8.0,
            click_sigmas: 6.0,
            min_score: 0.8,
            own_k1: false,
        }
    }
}

/// A camera on the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapped {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The lens that was found with them, where it was asked for.
    pub own_lens: Option<FocalCurve>,
    /// Samples with paint that took part.
    pub samples: usize,
    /// Root mean square of their distances from the lines, px.
    pub rms_px: f64,
    /// How far apart the cameras are that two halves of the samples give, px.
    pub halves_px: f64,
    /// What the lines and the clicks leave open.
    pub uncertainty: Uncertainty,
    /// What the paint says about the result.
    pub check: LineCheck,
}

/// Scales of the robust loss, one for each step, px at 1920 px width: coarse, middle, fine.
const SCALES_PX: [&[f64]; 3] = [
    &[8.0, 6.0, 4.0, 3.0],
    &[5.0, 4.0, 3.0, 2.0],
    &[3.0, 2.0, 1.5, 1.5],
];

/// How the picture is looked at in the three stages; the first reaches as far as the options say.
/// Px at 1920 px width.
const COARSE_SPACING_PX: f64 = 32.0;
const MIDDLE: Look = Look {
    reach_px: 16.0,
    spacing_px: 24.0,
    step_px: 1.0,
};
const FINE: Look = Look {
    reach_px: 8.0,
    spacing_px: 12.0,
    step_px: 0.5,
};

/// Ridges this far from their line after the last step are another's, px at 1920 px width.
const TAKES_PART_PX: f64 = 4.0;

/// Another camera fits as well if as many samples agree with it, by this share,
const AS_WELL: f64 = 0.9;

/// and if it is this far away, px at 1920 px width: nearer ones are the same lines.
const ELSEWHERE_PX: f64 = 10.0;

/// Cameras nearer to each other are one, px at 1920 px width.
const SAME_PX: f64 = 4.0;

/// The uncertainty is computed from at most this many of the samples.
const UNCERTAINTY_SAMPLES: usize = 120;

/// Pulls a camera onto the painted lines, from `start` and tied to `clicks` by their σ.
///
/// # Errors
/// [`SnapError`] names what speaks against a result: too little paint, halves that disagree, another camera that fits as
/// well, clicks that it leaves.
pub fn snap(
    ground: &GroundPicture,
    field: &FieldModel,
    base: &CameraBase,
    start: Ptz,
    clicks: &[Observation],
    options: &SnapOptions,
) -> Result<Snapped, SnapError> {
    let problem = Problem {
        ground,
        field,
        base,
        clicks,
        scale: ground.size().scale_from_1920(),
        options,
    };
    let mut fits = problem.fits(start);
    fits.sort_by(|a, b| b.agreeing.total_cmp(&a.agreeing));
    let Some(best) = fits.first() else {
        return Err(SnapError::TooFewSamples {
            found: 0,
            needed: options.min_samples,
        });
    };
    for other in fits
        .iter()
        .filter(|other| other.agreeing >= AS_WELL * best.agreeing)
    {
        let apart_px = problem.apart_px(best.ptz, other.ptz);
        if apart_px > ELSEWHERE_PX * problem.scale {
            return Err(SnapError::Ambiguous { apart_px });
        }
    }
    if !options.own_k1 {
        return problem.accepted(best);
    }
    let OwnLens { base, ptz } = own_lens(ground, field, &PtzCamera::new(*base, best.ptz), clicks)?;
    let problem = Problem {
        base: &base,
        ..problem
    };
    let bent = problem.refined(ptz).ok_or(SnapError::TooFewSamples {
        found: 0,
        needed: options.min_samples,
    })?;
    Ok(Snapped {
        own_lens: Some(base.distortion),
        ..problem.accepted(&bent)?
    })
}

/// What stays the same while a frame is snapped.
struct Problem<'a> {
    ground: &'a GroundPicture,
    field: &'a FieldModel,
    base: &'a CameraBase,
    clicks: &'a [Observation],
    scale: f64,
    options: &'a SnapOptions,
}

/// A camera that the paint pulled to.
struct Fit {
    ptz: Ptz,
    /// What was seen last, and around which camera.
    seen: Sightings,
    around: LinearisedCamera,
    /// The last step, from that camera to `ptz`.
    step: StepPx,
    /// Samples with paint where it is predicted, each by its distance, as a share of the open ones.
    agreeing: f64,
}

impl Problem<'_> {
    fn look(&self, ptz: Ptz, look: Look) -> (LinearisedCamera, Sightings) {
        let around = LinearisedCamera::new(self.base, ptz, self.ground.size().width);
        let scaled = Look {
            reach_px: look.reach_px * self.scale,
            spacing_px: look.spacing_px * self.scale,
            step_px: look.step_px,
        };
        let seen = Sightings::of(self.ground, self.field, &around.camera, scaled);
        (around, seen)
    }

    fn scales_px(&self, stage: usize) -> Vec<f64> {
        SCALES_PX[stage]
            .iter()
            .map(|scale_px| scale_px * self.scale)
            .collect()
    }

    fn apart_px(&self, one: Ptz, other: Ptz) -> f64 {
        overlays_apart_px(&PtzCamera::new(*self.base, one), other, self.ground.size())
    }

    /// The cameras within reach of a start that the paint pulls to.
    fn fits(&self, start: Ptz) -> Vec<Fit> {
        let coarse = Look {
            reach_px: self.options.reach_px,
            spacing_px: COARSE_SPACING_PX,
            step_px: 1.0,
        };
        let (around, seen) = self.look(start, coarse);
        let ridges = RidgeAlignment::new(&around, &seen, self.scale);
        let clicks = ClickAlignment::new(&around, self.clicks);
        let mut fits: Vec<Fit> = Vec::new();
        for step in likely_steps(&ridges, &clicks, self.options.reach_px * self.scale) {
            let step = ridges.align(step, &self.scales_px(0), Some(&clicks), |_| true);
            let Some(fit) = self.refined(around.ptz_after(&step)) else {
                continue;
            };
            if fits
                .iter()
                .all(|other| self.apart_px(other.ptz, fit.ptz) > SAME_PX * self.scale)
            {
                fits.push(fit);
            }
        }
        fits
    }

    /// The middle and the fine stage.
    fn refined(&self, start: Ptz) -> Option<Fit> {
        let (around, seen) = self.look(Some(start).filter(Ptz::is_finite)?, MIDDLE);
        let (ridges, clicks) = (
            RidgeAlignment::new(&around, &seen, self.scale),
            ClickAlignment::new(&around, self.clicks),
        );
        let middle = around.ptz_after(&ridges.align(
            StepPx::zeros(),
            &self.scales_px(1),
            Some(&clicks),
            |_| true,
        ));
        let (around, seen) = self.look(Some(middle).filter(Ptz::is_finite)?, FINE);
        let (ridges, clicks) = (
            RidgeAlignment::new(&around, &seen, self.scale),
            ClickAlignment::new(&around, self.clicks),
        );
        let step = ridges.align(StepPx::zeros(), &self.scales_px(2), Some(&clicks), |_| true);
        let ptz = Some(around.ptz_after(&step)).filter(Ptz::is_finite)?;
        let residuals =
            (0..ridges.num_samples()).filter_map(|sample| ridges.residual_px(sample, &step));
        let (count, sum) = residuals.fold((0.0, 0.0), |(count, sum), residual| {
            (
                count + 1.0,
                sum + 1.0 / (1.0 + (residual / (2.0 * self.scale)).powi(2)),
            )
        });
        let agreeing = sum / (count + seen.bare() as f64 + 1.0);
        Some(Fit {
            ptz,
            seen,
            around,
            step,
            agreeing,
        })
    }

    /// A fit with what is known of it, if nothing speaks against it.
    fn accepted(&self, fit: &Fit) -> Result<Snapped, SnapError> {
        let options = self.options;
        let ridges = RidgeAlignment::new(&fit.around, &fit.seen, self.scale);
        let taking_part: Vec<(usize, f64)> = (0..ridges.num_samples())
            .filter_map(|sample| Some((sample, ridges.residual_px(sample, &fit.step)?.abs())))
            .filter(|(_, distance_px)| *distance_px <= TAKES_PART_PX * self.scale)
            .collect();
        let found = taking_part.len();
        if found < options.min_samples {
            return Err(SnapError::TooFewSamples {
                found,
                needed: options.min_samples,
            });
        }
        let size = self.ground.size();
        let last_scales = &self.scales_px(2)[2..];
        let halves_px = halves_apart_px(&ridges, &fit.around, fit.step, last_scales, size);
        let allowed_px = options.halves_px * self.scale;
        if !(halves_px <= allowed_px) {
            return Err(SnapError::HalvesDisagree {
                apart_px: halves_px,
                allowed_px,
            });
        }
        let camera = PtzCamera::new(*self.base, fit.ptz);
        for click in self.clicks.iter().filter(|click| !click.check) {
            let sigmas = click
                .distance_px(&camera)
                .map_or(f64::INFINITY, |distance_px| distance_px / click.sigma_px);
            if !(sigmas <= options.click_sigmas) {
                return Err(SnapError::AgainstClicks {
                    click: click.click,
                    sigmas,
                });
            }
        }
        let uncertainty = self.uncertainty(fit, &camera, &taking_part);
        let uncertainty = uncertainty.map_err(|_| SnapError::Undetermined {
            sigma_px: f64::INFINITY,
        })?;
        // What the base leaves open is no fault of the paint.
        let by_paint = uncertainty.with_exact_base();
        let sigma_px = by_paint.worst_corner_sigma_px(&camera, size);
        if !(sigma_px <= options.max_corner_sigma_px * self.scale) {
            return Err(SnapError::Undetermined { sigma_px });
        }
        let check = check_lines(self.ground, self.field, &camera);
        if !(check.score >= options.min_score) {
            return Err(SnapError::NotBorneOut { score: check.score });
        }
        let squares = taking_part
            .iter()
            .map(|(_, distance_px)| distance_px * distance_px);
        let rms_px = (squares.sum::<f64>() / found as f64).sqrt();
        Ok(Snapped {
            ptz: fit.ptz,
            own_lens: None,
            samples: found,
            rms_px,
            halves_px,
            uncertainty,
            check,
        })
    }

    /// What the lines and the clicks leave open, the base's uncertainty in it.
    fn uncertainty(
        &self,
        fit: &Fit,
        camera: &PtzCamera,
        taking_part: &[(usize, f64)],
    ) -> Result<Uncertainty, SolveError> {
        let sigmas_px = sample_sigmas_px(&fit.seen, self.scale);
        // A few samples stand for all: each weighs as much as those it stands for.
        let stands_for =
            (stride_of_subsample(taking_part.len(), UNCERTAINTY_SAMPLES) as f64).sqrt();
        let of_paint = subsample(taking_part, UNCERTAINTY_SAMPLES).filter_map(|(index, _)| {
            let sample = &fit.seen.samples[*index];
            let image = camera.image_from_world(sample.at).ok()?;
            Observation::of_paint(
                self.field,
                sample.line,
                image,
                sigmas_px[*index] / stands_for,
                *index,
            )
        });
        let clicks = self.clicks.iter().filter(|click| !click.check).copied();
        let observations: Vec<Observation> = of_paint.chain(clicks).collect();
        Uncertainty::of(camera, &observations, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, SIZE, camera, soccer, truth};
    use touchline_core::geometry::{ImagePoint, Vec2};

    fn snapped(start: &PtzCamera, clicks: &[Observation]) -> Result<Snapped, SnapError> {
        let field = soccer();
        let ground = GroundPicture::new(&PICTURE, &[]);
        snap(
            &ground,
            &field,
            start.base(),
            start.ptz(),
            clicks,
            &SnapOptions::default(),
        )
    }

    fn click(landmark: &str, off_px: Vec2) -> Observation {
        let field = soccer();
        let world = field.landmark_in_world(field.landmark(landmark).unwrap());
        let image: ImagePoint = truth().image_from_world(world).unwrap().moved(off_px);
        Observation::of_point(world, image, 1.5, 0)
    }

    #[test]
    fn a_drawn_picture_gives_its_camera_back_from_near_and_far() {
        for start in [
            camera(4.0, -14.0, 1500.0),
            camera(4.4, -14.3, 1510.0),
            camera(3.0, -14.6, 1480.0),
        ] {
            let found = snapped(&start, &[]).unwrap();
            let apart_px = overlays_apart_px(&truth(), found.ptz, SIZE);
            assert!(
                apart_px < 0.15,
                "{apart_px} px from {:?}: {found:?}",
                start.ptz()
            );
            assert!(
                found.halves_px < 0.3 && found.rms_px < 0.5 && found.samples > 150,
                "{found:?}"
            );
        }
    }

    #[test]
    fn the_stated_uncertainty_is_small_and_grows_with_the_bases() {
        let exact = snapped(&truth(), &[]).unwrap();
        let corner_px = exact.uncertainty.worst_corner_sigma_px(&truth(), SIZE);
        assert!((0.01..1.5).contains(&corner_px), "{corner_px}");
        let mut base = *truth().base();
        base.sigma.position_m = touchline_core::geometry::Vec3::repeat(0.2);
        let unsure = snapped(&PtzCamera::new(base, truth().ptz()), &[]).unwrap();
        assert!(unsure.uncertainty.worst_corner_sigma_px(&truth(), SIZE) > 2.0 * corner_px);
    }

    #[test]
    fn clicks_that_are_a_little_off_do_not_hold_the_camera_back_and_far_ones_are_named() {
        let clicks = [
            click("centre_mark", Vec2::new(2.0, 1.0)),
            click("halfway_far", Vec2::new(-1.5, 2.0)),
        ];
        let found = snapped(&camera(4.1, -14.05, 1504.0), &clicks).unwrap();
        assert!(overlays_apart_px(&truth(), found.ptz, SIZE) < 1.0);
        let wrong = [Observation {
            click: 3,
            ..click("centre_mark", Vec2::new(40.0, 0.0))
        }];
        let refused = snapped(&truth(), &wrong).unwrap_err();
        assert!(
            matches!(refused, SnapError::AgainstClicks { click: 3, sigmas } if sigmas > 6.0),
            "{refused:?}"
        );
    }

    #[test]
    fn where_there_is_no_paint_the_reason_is_named() {
        let away = snapped(&camera(180.0, -14.0, 1500.0), &[]).unwrap_err();
        assert!(
            matches!(away, SnapError::TooFewSamples { found: 0, .. }),
            "{away:?}"
        );
        // 150 px off another line may be within reach; it is refused whatever it is.
        let elsewhere = snapped(&camera(9.8, -14.0, 1500.0), &[]);
        assert!(elsewhere.is_err(), "{elsewhere:?}");
    }
}
