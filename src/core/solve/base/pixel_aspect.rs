//! Whether clicks and paint are of pictures with square pixels.
//!
//! Pictures that were scaled to another proportion (to 640 × 640 for a network, from a video whose
//! stated proportion was lost) still fit a camera of square pixels: seen from afar, a picture of a
//! plane that is stretched upwards looks like one from farther up. The camera then stands too high
//! by just the stretch, lines on the ground are right, and everything above the ground is wrong.
//! Only perspective and points above the ground show it.
//!
//! The test is a profile of the adjustment's cost over the aspect, fy/fx: for each value the clicks
//! are put back where they would be with square pixels, and the base is adjusted to them. Where the
//! cost is clearly least at another aspect than one, the difference of the two bases is an error of
//! the base that its covariance has to contain. A stated aspect is what the profile begins with, in
//! place of one: it is tested alike.

use super::adjust::adjust_base;
use super::{
    AdjustOptions, AdjustedBase, BaseModel, CameraClicks, CrownModel, FrameClicks, LensModel,
    Prescribed,
};
use crate::camera::{CameraBase, Ptz, PtzCamera, SHARED_PARAMETERS, SharedError};
use crate::geometry::{ImagePoint, ImageSize, Vec2};
use crate::solve::Observation;
use serde::Serialize;
use std::fmt;

/// A smaller deviation of the logarithm from zero is not reported: fields of another size than
/// assumed look like that, and no usual scaling of pictures is so small.
const MIN_DEVIATION: f64 = 0.06;

/// The deviation has to be this many sigmas.
const CLEAR_SIGMAS: f64 = 4.0;

/// Width over height of the pictures of broadcasts.
const USUAL_PROPORTION: f64 = 16.0 / 9.0;

/// The step of the finite differences of the logarithm, and the longest step of the search.
const DIFFERENCE: f64 = 0.04;
const MAX_STEP: f64 = 0.2;

/// Steps of the search at most; it ends when one is shorter than [`SHORT_STEP`].
const MAX_STEPS: usize = 12;
const SHORT_STEP: f64 = 0.01;

/// The aspect of the pixels that the clicks fit best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PixelAspect {
    /// The focal length down the picture over that across it, fy/fx.
    pub value: f64,
    /// Its 1-σ.
    pub sigma: f64,
    /// The aspect that is stated, with which the base was estimated; 1 where none is.
    pub stated: f64,
    /// The size of the pictures.
    #[serde(skip)]
    pub image_size: ImageSize,
}

impl PixelAspect {
    /// The deviation from the stated aspect in sigmas.
    pub fn sigmas(&self) -> f64 {
        self.deviation() * self.value / self.sigma
    }

    /// The size of its logarithm over that of the stated one.
    fn deviation(&self) -> f64 {
        (self.value / self.stated).ln().abs()
    }

    /// Whether the pixels are clearly not those that are stated.
    pub(super) fn is_clear(&self) -> bool {
        self.deviation() > MIN_DEVIATION && self.sigmas() > CLEAR_SIGMAS
    }
}

impl fmt::Display for PixelAspect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ImageSize { width, height } = self.image_size;
        if self.stated != 1.0 {
            return write!(
                f,
                "clicks and paint fit pixels that are {:.2} ± {:.2} times as wide as high, where \
                 pixel_aspect {} is stated for the camera: the camera's height and all heights \
                 would be wrong by the ratio, and are stated as uncertain. Correct pixel_aspect, \
                 or check the field's size",
                self.value, self.sigma, self.stated
            );
        }
        let unscaled = (f64::from(width) * self.value).round();
        write!(
            f,
            "clicks and paint fit pixels that are {:.2} ± {:.2} times as wide as high, as if pictures of about {unscaled} × {height} px had been scaled to {width} × {height}: the camera's height and all heights would be wrong by that factor, and are stated as uncertain. Take the pictures in their true proportion, which `touchline new` and `touchline import` give back with --stretched-from {unscaled}x{height}, or check the field's size",
            self.value, self.sigma
        )
    }
}

/// A base fitted to clicks, which the test begins with.
pub(super) struct AspectTest<'a> {
    clicks: &'a CameraClicks<'a>,
    model: BaseModel,
    options: &'a AdjustOptions,
    /// For each click of each frame on a line: the direction across the line in the picture.
    across: Vec<Vec<Option<Vec2>>>,
}

/// The base with other pixels.
struct Trial {
    log_aspect: f64,
    adjusted: AdjustedBase,
}

impl<'a> AspectTest<'a> {
    /// The test with all that may be free: a lens or a principal point that few clicks leave open
    /// must not be taken for pixels that are not square.
    pub fn new(
        clicks: &'a CameraClicks<'a>,
        (base, ptz): (&CameraBase, &[Option<Ptz>]),
        chosen: &BaseModel,
        options: &'a AdjustOptions,
    ) -> Self {
        let Prescribed {
            lens,
            crown,
            principal_point,
        } = options.prescribed;
        let is_level = crown || !clicks.field.may_be_crowned();
        Self {
            clicks,
            model: BaseModel {
                lens: if lens {
                    chosen.lens
                } else {
                    LensModel::K1FocalK2
                },
                crown: if is_level {
                    chosen.crown
                } else {
                    CrownModel::Free
                },
                principal_point: (!principal_point).then_some(clicks.principal_point),
            },
            options,
            across: clicks
                .frames
                .iter()
                .zip(ptz)
                .map(|(frame, ptz)| directions_across(frame, base, *ptz))
                .collect(),
        }
    }

    /// The aspect that the clicks fit best and the error of the base that comes from having assumed
    /// square pixels; none where they agree with these.
    pub fn run(
        &self,
        base: &CameraBase,
        ptz: &[Option<Ptz>],
    ) -> Option<(PixelAspect, SharedError)> {
        let used = ptz.iter().zip(self.clicks.frames);
        let surplus: usize = used
            .filter(|(ptz, _)| ptz.is_some())
            .map(|(_, frame)| frame.equations().saturating_sub(3))
            .sum();
        // As many unknowns as a base has, and one.
        if surplus <= SHARED_PARAMETERS {
            return None;
        }
        // Lines alone give the aspect to a quarter only on real footage, whose ground and lens are
        // not quite those of the model: 1.26 on a broadcast with square pixels. They can say
        // whether a picture of an unusual proportion was a usual one, and nothing of others.
        let has_points = self.has_points();
        if !has_points && self.of_usual_scaled().abs() <= MIN_DEVIATION {
            return None;
        }
        // The same adjustment once more, from where it ended: the search compares costs, which have
        // to be those of minima.
        let square = self.adjust(0.0, 0.0, base, ptz);
        let mut at = self.adjust(0.0, 0.0, &square.adjusted.base, &square.adjusted.ptz);
        let (mut sigma, mut has_settled) = (f64::INFINITY, false);
        let (mut last, mut longest): (f64, f64) = (0.0, MAX_STEP);
        for _ in 0..MAX_STEPS {
            // Slope and curvature by central differences, and a Newton step; where the profile is
            // not convex, as long a step downhill as is allowed.
            let [less, more] = [-DIFFERENCE, DIFFERENCE].map(|by| self.beside(&at, by));
            let [below, here, above] = [&less, &at, &more].map(|trial| trial.adjusted.cost);
            let slope = (above - below) / (2.0 * DIFFERENCE);
            let curvature = (above - 2.0 * here + below) / DIFFERENCE.powi(2);
            let step = if curvature > 0.0 {
                sigma = (2.0 * at.adjusted.noise_scale / curvature).sqrt();
                -slope / curvature
            } else {
                -slope.signum() * MAX_STEP
            };
            has_settled = step.abs() < SHORT_STEP;
            if has_settled || !step.is_finite() {
                break;
            }
            // A step back is at most half of the one before: far from the minimum the robust cost
            // is flatter than a parabola, and a Newton step goes beyond it again and again.
            if step * last < 0.0 {
                longest = 0.5 * last.abs();
            }
            last = step.clamp(-longest, longest);
            at = self.beside(&at, last);
        }
        // Where little perspective is seen, the cost may fall on and on: no aspect fits best then.
        if !has_settled {
            return None;
        }
        let gain = (square.adjusted.cost - at.adjusted.cost) / at.adjusted.noise_scale;
        let stated = self.clicks.pixel_aspect;
        let value = stated * at.log_aspect.exp();
        let found = PixelAspect {
            value,
            stated,
            // The parabola holds near the minimum alone: the whole gain of cost says how far the
            // value is from one, too. The larger of both is the one to trust.
            sigma: value * sigma.max(at.log_aspect.abs() / gain.max(1e-9).sqrt()),
            image_size: self.clicks.image_size,
        };
        let is_credible =
            has_points || (at.log_aspect - self.of_usual_scaled()).abs() < at.log_aspect.abs();
        (found.is_clear() && is_credible).then(|| {
            (
                found,
                error_between(&at.adjusted.base, &square.adjusted.base),
            )
        })
    }

    /// The aspect that usual pictures scaled to this proportion have: its logarithm, over the
    /// stated one.
    fn of_usual_scaled(&self) -> f64 {
        let ImageSize { width, height } = self.clicks.image_size;
        let stated_width = f64::from(width) * self.clicks.pixel_aspect;
        (USUAL_PROPORTION * f64::from(height) / stated_width).ln()
    }

    /// Whether points are among the clicks, not lines alone.
    fn has_points(&self) -> bool {
        let clicks = self.clicks.frames.iter();
        let mut clicks = clicks.flat_map(FrameClicks::used_clicks);
        clicks.any(|click| click.shape.point().is_some())
    }

    /// The base at an aspect near that of a trial.
    fn beside(&self, trial: &Trial, by: f64) -> Trial {
        let AdjustedBase { base, ptz, .. } = &trial.adjusted;
        self.adjust(trial.log_aspect + by, by, base, ptz)
    }

    /// The base adjusted to the clicks as they would be with square pixels. `by` is the change of
    /// the logarithm since the start: the camera of a less stretched picture is lower, and looks
    /// down less.
    fn adjust(&self, log_aspect: f64, by: f64, base: &CameraBase, ptz: &[Option<Ptz>]) -> Trial {
        // Wider by the root of the aspect and lower by as much: so a change of the aspect makes no
        // residuals at landmarks smaller as such.
        let (wider, lower) = ((0.5 * log_aspect).exp(), (-by).exp());
        let unscale = |at: ImagePoint| {
            let off = at.offset_from(self.clicks.principal_point);
            self.clicks
                .principal_point
                .translate(Vec2::new(off.x * wider, off.y / wider))
        };
        let frames: Vec<FrameClicks> = self
            .clicks
            .frames
            .iter()
            .zip(&self.across)
            .map(|(frame, across)| {
                let mut frame = frame.clone();
                for (click, across) in frame.observations.iter_mut().zip(across) {
                    click.image = unscale(click.image);
                    // A distance across a line is wider or lower as the line lies; its σ follows.
                    if let Some(across) = across {
                        click.sigma_px /= Vec2::new(across.x / wider, across.y * wider).norm();
                    }
                }
                frame
            })
            .collect();
        let mut start = *base;
        start.position_m.z *= lower;
        let ptz: Vec<Option<Ptz>> = ptz
            .iter()
            .map(|ptz| {
                ptz.map(|ptz| Ptz {
                    tilt: ptz.tilt * lower,
                    focal_px: ptz.focal_px * (0.5 * by).exp(),
                    ..ptz
                })
            })
            .collect();
        let clicks = CameraClicks {
            frames: &frames,
            ..*self.clicks
        };
        Trial {
            log_aspect,
            adjusted: adjust_base(&clicks, &start, &ptz, &self.model, self.options),
        }
    }
}

/// The direction across its line of each click on one, where it lies beside it.
fn directions_across(
    frame: &FrameClicks,
    base: &CameraBase,
    ptz: Option<Ptz>,
) -> Vec<Option<Vec2>> {
    let camera = ptz.map(|ptz| PtzCamera::new(*base, ptz));
    let across = |click: &Observation| {
        let on_line = click.shape.point().is_none();
        let off_px = click
            .shape
            .offset_px(&camera.filter(|_| on_line)?, click.image)?;
        off_px.try_normalize(f64::MIN_POSITIVE)
    };
    frame.observations.iter().map(across).collect()
}

/// How far one base is from another, in position and rotation.
fn error_between(one: &CameraBase, other: &CameraBase) -> SharedError {
    let moved_m = one.position_m - other.position_m;
    let turned = one.rotation_from(other);
    let mut error = SharedError::zeros();
    error.fixed_rows_mut::<3>(0).copy_from(&moved_m);
    error.fixed_rows_mut::<2>(3).copy_from(&turned.xy());
    error
}
