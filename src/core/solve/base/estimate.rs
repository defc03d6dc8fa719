//! The whole way from clicks to a base: start, adjustment, choice of the model, what disagrees.

use super::adjust::{PLACING_FRAMES, adjust_base};
use super::disputes::{disputed_clicks, mirrored_frames};
use super::model_choice::{CrossValidation, Errors, FOLDS, MIN_FRAMES, choose};
use super::one_more::one_more_frame;
use super::progress::Adjustments;
use super::start::{solve_all, start_base};
use super::{
    AdjustOptions, AdjustedBase, BaseError, BaseModel, BaseProgress, CameraClicks, CrownModel,
    DisputedClick, FrameClicks, HeldOutErrors, LensModel, MirroredFrame, ModelReason, ModelScore,
    OneMoreFrame, Prescribed,
};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::{AngleRange, ImagePoint, ImageSize, Mat3, median, quantile};
use crate::progress::Progress;
use serde::Serialize;

/// What a person may ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseOptions {
    /// The lens; none: chosen by cross-validation.
    pub lens: Option<LensModel>,
    /// The pitch; none: chosen by cross-validation between the field's crown, or flat, and a free
    /// one.
    pub crown: Option<CrownModel>,
    /// Also find the principal point where enough frames may show it, held near the middle by its
    /// prior. True by default.
    pub principal_point: bool,
    /// How many frames are enough for that; with fewer it stays in the middle and counts in the
    /// uncertainty. 12 by default.
    pub placing_frames: usize,
    /// How to adjust.
    pub adjust: AdjustOptions,
}

impl BaseEstimate {
    /// What a person should know where all frames look the same way: they hold the position less
    /// well than their number suggests. None where they do not, or where there is only one.
    #[must_use]
    pub fn one_view(&self) -> Option<String> {
        /// Frames that differ less are one view, degrees and log f.
        const SAME: [f64; 2] = [3.0, 0.1];
        let solved: Vec<&FrameFit> = self.frames.iter().flatten().collect();
        let span = |of: &dyn Fn(&Ptz) -> f64| {
            let values = solved.iter().map(|fit| of(&fit.ptz));
            let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
            most - least
        };
        let pan_deg = AngleRange::smallest(solved.iter().map(|fit| fit.ptz.pan))?
            .width()
            .degrees();
        let same =
            solved.len() > 1 && pan_deg < SAME[0] && span(&|ptz| ptz.focal_px.ln()) < SAME[1];
        let sigma_m = self.base.sigma.position_m.norm();
        same.then(|| {
            format!(
                "all {} frames look the same way (pan within {pan_deg:.1}°), so the position is known to ±{sigma_m:.1} m: click landmarks in frames that look further left and right",
                solved.len()
            )
        })
    }
}

impl BaseOptions {
    /// Around which point the principal point is found; none where it stays. Few frames do not show
    /// it: on real matches one or two frames err by a tenth more with it than without, and ten by 2
    /// %; all frames err by a tenth less.
    fn free_centre(&self, nominal: ImagePoint, frames: usize) -> Option<ImagePoint> {
        (self.principal_point && frames >= self.placing_frames).then_some(nominal)
    }

    /// How to adjust, with what these options prescribe.
    fn adjusting(&self) -> AdjustOptions {
        let (lens, crown) = (self.lens.is_some(), self.crown.is_some());
        AdjustOptions {
            prescribed: Prescribed {
                lens,
                crown,
                principal_point: !self.principal_point,
            },
            ..self.adjust
        }
    }

    /// The model with most that is free among those that may be chosen.
    #[must_use]
    pub fn richest(&self, clicks: &CameraClicks<'_>) -> BaseModel {
        let centre = self.free_centre(clicks.principal_point, clicks.frames.len());
        models(clicks.field, centre, self)
            .pop()
            .unwrap_or_else(|| pinhole(clicks.field))
    }
}

impl Default for BaseOptions {
    /// Everything chosen by the program.
    fn default() -> Self {
        Self {
            lens: None,
            crown: None,
            principal_point: true,
            placing_frames: PLACING_FRAMES,
            adjust: AdjustOptions::default(),
        }
    }
}

/// How one frame fits the base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFit {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Median distance of its clicks, px.
    pub median_px: f64,
    /// Root mean square distance of its clicks, px.
    pub rms_px: f64,
}

/// A base estimated from clicks, with everything needed to judge it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaseEstimate {
    /// The base with its sigma: the adjustment's (landmarks that lie off their places in every
    /// frame included), raised where the jackknife over groups of frames shows more.
    pub base: CameraBase,
    /// The crown of the pitch, m.
    pub crown_m: f64,
    /// What was left free.
    pub model: BaseModel,
    /// Why.
    pub reason: ModelReason,
    /// The models compared on clicks that they had not seen; one only where it was prescribed.
    pub scores: Vec<ModelScore>,
    /// Covariance of the position, m².
    #[serde(serialize_with = "crate::geometry::rows")]
    pub position_covariance: Mat3,
    /// Each frame's fit; none where its clicks gave no camera.
    pub frames: Vec<Option<FrameFit>>,
    /// Median distance of all clicks, px.
    pub median_px: f64,
    /// The 90 % quantile of it, px.
    pub p90_px: f64,
    /// The same median under the base that was given, if one was.
    pub previous_median_px: Option<f64>,
    /// The frame that would make it clearly better known, where frames are few.
    pub one_more_frame: Option<OneMoreFrame>,
    /// Clicks that disagree, those of mirrored frames left out.
    pub disputed: Vec<DisputedClick>,
    /// Frames that are named from the wrong side.
    pub mirrored: Vec<MirroredFrame>,
}

/// Estimates the base from the clicks of many frames (one is enough where it has four landmarks).
///
/// The field's crown is a start, and holds where [`CrownModel::Fixed`] says so. `previous` is a
/// base to start from as well and to compare with.
///
/// # Errors
/// No frame to start from, no camera that explains half of the clicks, frames that leave the
/// position open, or `progress` cancelled it ([`BaseError::Stopped`]).
pub fn estimate_base(
    clicks: &CameraClicks<'_>,
    previous: Option<&CameraBase>,
    options: &BaseOptions,
    progress: &Progress<'_, BaseProgress>,
) -> Result<BaseEstimate, BaseError> {
    let CameraClicks {
        field,
        frames,
        image_size,
        principal_point,
    } = *clicks;
    let models = models(
        field,
        options.free_centre(principal_point, frames.len()),
        options,
    );
    let adjust = options.adjusting();
    let adjustments = Adjustments::new(progress, STARTING_ROUNDS + models.len() * FOLDS);
    let previous_fit = previous.map(|base| {
        let ptz = solve_all(base, frames, image_size);
        (
            *base,
            median(&mut distances(base, frames, &ptz)).unwrap_or(f64::INFINITY),
            ptz,
        )
    });
    let (mut base, mut ptz) = match start_base(clicks) {
        Ok(start) => (start.base, start.ptz),
        Err(error) => previous_fit
            .as_ref()
            .map(|(base, _, ptz)| (*base, ptz.clone()))
            .ok_or(error)?,
    };
    // First the pinhole, which has nothing to go astray with; then each frame anew from its clicks.
    let pinhole = pinhole(field);
    for _ in 0..STARTING_ROUNDS {
        let adjusted = adjust_base(clicks, &base, &ptz, &pinhole, &adjust);
        base = adjusted.base;
        ptz = solve_all(&base, frames, image_size);
        if adjustments.count().is_break() {
            return Err(BaseError::Stopped);
        }
    }

    let fit = chosen_fit(clicks, &models, (&base, &ptz), &adjust, &adjustments)?;
    let crowned = FieldModel {
        crown_m: fit.adjusted.crown_m,
        ..field.clone()
    };
    let frames: Vec<FrameClicks> = frames
        .iter()
        .map(|frame| on_field(frame, field, &crowned))
        .collect();
    let solved_frames = ptz.iter().flatten().count();
    let (model, adjusted_ptz) = (fit.model, fit.adjusted.ptz.clone());
    let ptz = solve_all(&fit.adjusted.base, &frames, image_size);
    let mut estimate = summary(fit, &crowned, &frames, &ptz, image_size)?;
    estimate.previous_median_px = previous_fit.map(|fit| fit.1);
    if solved_frames < MIN_FRAMES {
        let known_m = estimate.base.sigma.position_m.norm();
        let adjusting = (&model, &adjust);
        estimate.one_more_frame =
            one_more_frame(clicks, &estimate.base, &adjusted_ptz, adjusting, known_m);
    }
    Ok(estimate)
}

/// The same from clicks and paint in one adjustment. `painted` has the clicks of each frame of
/// `clicks`, which may be none, followed by its paint; the cameras are adjusted from `start`, a
/// base and the frames' cameras, and stay where both together put them. The model is the one that
/// does best at paint that it has not seen.
///
/// # Errors
/// Those of [`estimate_base`].
pub fn estimate_base_on_paint(
    clicks: &CameraClicks<'_>,
    painted: &[FrameClicks],
    start: (&CameraBase, &[Option<Ptz>]),
    options: &BaseOptions,
    progress: &Progress<'_, BaseProgress>,
) -> Result<BaseEstimate, BaseError> {
    let CameraClicks {
        field,
        frames,
        image_size,
        principal_point,
    } = *clicks;
    let solved_frames = start.1.iter().flatten().count();
    let models = models(
        field,
        options.free_centre(principal_point, solved_frames),
        options,
    );
    let adjustments = Adjustments::new(progress, models.len() * FOLDS);
    let painted = CameraClicks {
        frames: painted,
        ..*clicks
    };
    let fit = chosen_fit(&painted, &models, start, &options.adjusting(), &adjustments)?;
    let crowned = FieldModel {
        crown_m: fit.adjusted.crown_m,
        ..field.clone()
    };
    let recrowned = |frames: &[FrameClicks]| {
        frames
            .iter()
            .map(|frame| on_field(frame, field, &crowned))
            .collect()
    };
    let (frames, painted): (Vec<FrameClicks>, Vec<FrameClicks>) =
        (recrowned(frames), recrowned(painted.frames));
    let ptz = fit.adjusted.ptz.clone();
    let mut estimate = summary(fit, &crowned, &frames, &ptz, image_size)?;
    let fits = painted
        .iter()
        .zip(&ptz)
        .map(|(frame, ptz)| frame_fit(&estimate.base, frame, (*ptz)?))
        .collect();
    estimate.frames = fits;
    Ok(estimate)
}

/// The errors of frames under a base that is not adjusted to them, each camera refined on one half
/// of its clicks and paint and judged by the other: of the paint, and of the clicks. `crown_m` is
/// the crown that goes with the base.
#[must_use]
pub fn held_out_on_paint(
    painted: &CameraClicks<'_>,
    base: &CameraBase,
    crown_m: f64,
    ptz: &[Option<Ptz>],
) -> (Option<HeldOutErrors>, Option<HeldOutErrors>) {
    let crowned = FieldModel {
        crown_m,
        ..painted.field.clone()
    };
    let mut errors = Errors::default();
    for (frame, ptz) in painted.frames.iter().zip(ptz) {
        if let Some(start) = ptz {
            errors.add_halves(base, *start, frame, painted.field, &crowned);
        }
    }
    errors.summaries()
}

/// A base adjusted with the model that was chosen.
struct ChosenFit {
    adjusted: AdjustedBase,
    model: BaseModel,
    reason: ModelReason,
    scores: Vec<ModelScore>,
}

/// The model chosen by cross-validation from a start, and everything adjusted with it.
fn chosen_fit(
    clicks: &CameraClicks<'_>,
    models: &[BaseModel],
    (base, ptz): (&CameraBase, &[Option<Ptz>]),
    options: &AdjustOptions,
    adjustments: &Adjustments<'_>,
) -> Result<ChosenFit, BaseError> {
    let validation = CrossValidation {
        clicks,
        start: base,
        start_ptz: ptz,
        options,
        adjustments,
    };
    let scores = validation.scores(models);
    if adjustments.are_cancelled() {
        return Err(BaseError::Stopped);
    }
    let solved_frames = ptz.iter().flatten().count();
    let (model, reason) =
        choose(&scores, solved_frames).unwrap_or((pinhole(clicks.field), ModelReason::Prescribed));
    let mut adjusted = adjust_base(clicks, base, ptz, &model, options);
    if let Some(score) = scores.iter().find(|score| score.model == model) {
        adjusted.base.sigma = adjusted.base.sigma.covering(&score.spread);
    }
    Ok(ChosenFit {
        adjusted,
        model,
        reason,
        scores,
    })
}

const fn pinhole(field: &FieldModel) -> BaseModel {
    BaseModel {
        lens: LensModel::Pinhole,
        crown: CrownModel::Fixed(field.crown_m),
        principal_point: None,
    }
}

/// What a fit is worth, by clicks on the field that it has found and the frames' cameras.
fn summary(
    fit: ChosenFit,
    field: &FieldModel,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    image_size: ImageSize,
) -> Result<BaseEstimate, BaseError> {
    let ChosenFit {
        adjusted,
        model,
        reason,
        scores,
    } = fit;
    let base = adjusted.base;
    let mut errors = distances(&base, frames, ptz);
    errors.sort_by(f64::total_cmp);
    let at = |share| {
        if errors.is_empty() {
            f64::INFINITY
        } else {
            quantile(&errors, share)
        }
    };
    let median_px = at(0.5);
    let has_clicks = frames.iter().any(|frame| frame.equations() > 0);
    if has_clicks && !(median_px < NO_FIT_PX * image_size.scale_from_1920()) {
        return Err(BaseError::NoFit { median_px });
    }
    let known = adjusted.position_covariance.iter().all(|x| x.is_finite());
    let sigma_m = if known {
        adjusted
            .position_covariance
            .symmetric_eigenvalues()
            .max()
            .max(0.0)
            .sqrt()
    } else {
        f64::INFINITY
    };
    if !(sigma_m < MAX_POSITION_SIGMA_M) {
        return Err(BaseError::Undetermined { sigma_m });
    }
    if base.position_m.z <= 0.0 {
        return Err(BaseError::BelowGround {
            depth_m: -base.position_m.z,
        });
    }
    let mirrored = mirrored_frames(&base, frames, ptz, image_size);
    let noise_scale = adjusted.noise_scale.sqrt();
    let mut disputed = disputed_clicks(&base, field, frames, ptz, noise_scale);
    disputed.retain(|click| mirrored.iter().all(|frame| frame.frame != click.frame));
    let frame_fits = frames
        .iter()
        .zip(ptz)
        .map(|(frame, ptz)| frame_fit(&base, frame, (*ptz)?))
        .collect();
    Ok(BaseEstimate {
        base,
        crown_m: adjusted.crown_m,
        model,
        reason,
        scores,
        position_covariance: adjusted.position_covariance,
        frames: frame_fits,
        median_px,
        p90_px: at(0.9),
        previous_median_px: None,
        one_more_frame: None,
        disputed,
        mirrored,
    })
}

/// How often the pinhole is adjusted before models are compared.
const STARTING_ROUNDS: usize = 2;

/// Clicks this far off (median, px at 1920 px width) are explained by no camera.
const NO_FIT_PX: f64 = 25.0;

/// A base whose position is less well known than this is none, m.
const MAX_POSITION_SIGMA_M: f64 = 20.0;

/// The models to compare, simple ones first.
fn models(
    field: &FieldModel,
    principal_point: Option<ImagePoint>,
    options: &BaseOptions,
) -> Vec<BaseModel> {
    let lenses = match options.lens {
        Some(lens) => vec![lens],
        None => vec![
            LensModel::Pinhole,
            LensModel::K1,
            LensModel::K1FocalK2,
            LensModel::K1Focal,
        ],
    };
    let crowns = match options.crown {
        Some(crown) => vec![crown],
        None if field.may_be_crowned() => vec![CrownModel::Fixed(field.crown_m), CrownModel::Free],
        None => vec![CrownModel::Fixed(field.crown_m)],
    };
    let of_crown = |crown| {
        lenses.iter().map(move |&lens| BaseModel {
            lens,
            crown,
            principal_point,
        })
    };
    crowns.into_iter().flat_map(of_crown).collect()
}

fn on_field(frame: &FrameClicks, from: &FieldModel, to: &FieldModel) -> FrameClicks {
    let observations = frame
        .observations
        .iter()
        .map(|click| click.recrowned(from, to))
        .collect();
    FrameClicks {
        observations,
        start: frame.start,
    }
}

fn frame_fit(base: &CameraBase, frame: &FrameClicks, ptz: Ptz) -> Option<FrameFit> {
    let mut errors = distances(base, std::slice::from_ref(frame), &[Some(ptz)]);
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let rms_px = (squares / errors.len() as f64).sqrt();
    Some(FrameFit {
        ptz,
        median_px: median(&mut errors)?,
        rms_px,
    })
}

/// The distances of all clicks of solved frames, px, in order.
fn distances(base: &CameraBase, frames: &[FrameClicks], ptz: &[Option<Ptz>]) -> Vec<f64> {
    let mut found = Vec::new();
    for (frame, ptz) in frames.iter().zip(ptz) {
        let Some(ptz) = ptz else { continue };
        let camera = PtzCamera::new(*base, *ptz);
        found.extend(frame.used().filter_map(|click| click.distance_px(&camera)));
    }
    found
}
