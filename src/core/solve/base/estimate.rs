//! From clicks to a base: start, adjustment, choice of the model, disputed clicks.

use super::adjust::{PLACING_FRAMES, adjust_base, cameras_with_clicks};
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

/// The user's choices for an estimation.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseOptions {
    /// The lens; none: chosen by cross-validation.
    pub lens: Option<LensModel>,
    /// The pitch; none: chosen by cross-validation between the field's crown, or flat, and a free
    /// one.
    pub crown: Option<CrownModel>,
    /// Whether to estimate the principal point as well where there are enough frames, with a prior
    /// at the middle of the picture. True by default.
    pub principal_point: bool,
    /// The minimum number of frames for that. With fewer the principal point stays in the middle,
    /// and its prior σ enters the uncertainty. 12 by default.
    pub placing_frames: usize,
    /// How to adjust.
    pub adjust: AdjustOptions,
}

impl BaseEstimate {
    /// A notice for the user if all frames look the same way, because they then determine the
    /// position less well than their number suggests. None if the views differ, or for a single
    /// frame.
    #[must_use]
    pub fn one_view(&self) -> Option<String> {
        /// Frames whose pan and focal length differ by less than this are one view, degrees and log
        /// f.
        const SAME: [f64; 2] = [3.0, 0.1];
        let solved: Vec<&FrameFit> = self.frames.iter().flatten().collect();
        let pan_deg = AngleRange::smallest(solved.iter().map(|fit| fit.ptz.pan))?
            .width()
            .degrees();
        let log_focals = solved.iter().map(|fit| fit.ptz.focal_px.ln());
        let (least, most) = log_focals.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let same = solved.len() > 1 && pan_deg < SAME[0] && most - least < SAME[1];
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
    /// The mean of the principal point's prior; none if the principal point is not estimated. Few
    /// frames do not determine it: on real matches the error of one or two frames is a tenth larger
    /// with it than without, that of ten frames 2 % larger, and that of all frames a tenth smaller.
    fn free_centre(&self, nominal: ImagePoint, frames: usize) -> Option<ImagePoint> {
        (self.principal_point && frames >= self.placing_frames).then_some(nominal)
    }

    /// The options of the adjustment, with the prescriptions of these options.
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

    /// The model with the most free parameters among the allowed ones.
    #[must_use]
    pub fn richest(&self, clicks: &CameraClicks<'_>) -> BaseModel {
        let centre = self.free_centre(clicks.principal_point, clicks.frames.len());
        models(clicks.field, centre, self)
            .pop()
            .unwrap_or_else(|| pinhole(clicks.field))
    }
}

impl Default for BaseOptions {
    /// All choices left to the program.
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

/// A base estimated from clicks, with its errors and diagnostics.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaseEstimate {
    /// The base with its sigma. The sigma is that of the adjustment, which includes landmarks
    /// displaced in every frame, raised in the directions in which the jackknife over groups of
    /// frames is larger.
    pub base: CameraBase,
    /// The crown of the pitch, m.
    pub crown_m: f64,
    /// Which parameters were free.
    pub model: BaseModel,
    /// Why this model was chosen.
    pub reason: ModelReason,
    /// The cross-validation scores of all models; a single one where the model was prescribed.
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
    /// The median distance of all clicks under the previous base, px, if one was given.
    pub previous_median_px: Option<f64>,
    /// Where frames are few: the further frame that would reduce the uncertainty most.
    pub one_more_frame: Option<OneMoreFrame>,
    /// Clicks that contradict the others, without those of mirrored frames.
    pub disputed: Vec<DisputedClick>,
    /// Frames whose landmarks are named from the wrong side of the field.
    pub mirrored: Vec<MirroredFrame>,
}

/// Estimates the base from the clicks of many frames (one is enough where it has four landmarks).
///
/// The field's crown is the initial value, and is kept under [`CrownModel::Fixed`]. `previous` is
/// an alternative start, used if the clicks give none, and a base to compare with.
///
/// # Errors
/// No frame to start from, no camera that explains half of the clicks, frames that do not determine
/// the position, or cancellation by `progress` ([`BaseError::Stopped`]).
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
        ..
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

    // Start from the clicks alone; the previous base is only a fallback, because it may be the one
    // that is wrong.
    let (mut base, mut ptz) = match start_base(clicks) {
        Ok(start) => (start.base, start.ptz),
        Err(error) => previous_fit
            .as_ref()
            .map(|(base, _, ptz)| (*base, ptz.clone()))
            .ok_or(error)?,
    };
    // Adjust a pinhole first: without lens parameters a rough start cannot diverge. Then solve each
    // frame anew with the adjusted base, so that frames without a camera so far can join, and
    // frames at a wrong minimum can leave it.
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

    // Summarise on the fitted crown: each frame is solved once more with the final base and lens.
    let crowned = field.with_crown_m(fit.adjusted.crown_m);
    let frames = on_field(frames, field, &crowned);
    let solved_frames = ptz.iter().flatten().count();
    let (model, adjusted_ptz) = (fit.model, fit.adjusted.ptz.clone());
    let ptz = solve_all(&fit.adjusted.base, &frames, image_size);
    let mut estimate = summary(fit, &crowned, &frames, &ptz, image_size)?;
    estimate.previous_median_px = previous_fit.map(|fit| fit.1);

    // With few frames, suggest the next one to click.
    if solved_frames < MIN_FRAMES {
        let known_m = estimate.base.sigma.position_m.norm();
        let adjusting = (&model, &adjust);
        estimate.one_more_frame =
            one_more_frame(clicks, &estimate.base, &adjusted_ptz, adjusting, known_m);
    }
    Ok(estimate)
}

/// Estimates the base from clicks and paint in one adjustment. `painted` has the clicks of each
/// frame of `clicks` (possibly none), followed by its paint. `start` is a base and the frames'
/// cameras; the adjusted cameras are kept as they are, and are not solved again from the clicks
/// alone. The model is chosen by its errors at held-out paint.
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
        ..
    } = *clicks;
    // Frames without paint, which are most of a long video, take no part in the choice of the model.
    let ptz = cameras_with_clicks(painted, start.1);
    let solved_frames = ptz.iter().flatten().count();
    let models = models(
        field,
        options.free_centre(principal_point, solved_frames),
        options,
    );
    let adjustments = Adjustments::new(progress, models.len() * FOLDS);
    let start = (start.0, ptz.as_slice());
    let painted = CameraClicks {
        frames: painted,
        ..*clicks
    };
    let fit = chosen_fit(&painted, &models, start, &options.adjusting(), &adjustments)?;
    let crowned = field.with_crown_m(fit.adjusted.crown_m);

    // The summary is about the clicks; the fits of the frames are about clicks and paint together.
    let frames = on_field(frames, field, &crowned);
    let painted = on_field(painted.frames, field, &crowned);
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

/// The errors of frames under a base that is not adjusted to them, at paint and at clicks. Each
/// camera is refined on one half of its clicks and paint and evaluated on the other. `crown_m` is
/// the crown that belongs to the base.
#[must_use]
pub fn held_out_errors(
    painted: &CameraClicks<'_>,
    base: &CameraBase,
    crown_m: f64,
    ptz: &[Option<Ptz>],
) -> (Option<HeldOutErrors>, Option<HeldOutErrors>) {
    let crowned = painted.field.with_crown_m(crown_m);
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

/// Chooses the model by cross-validation and adjusts base and frames with it, from a given start.
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

    // The covariance of the adjustment assumes independent errors; the jackknife also shows what
    // the frames of a group have in common. Take the larger in each direction.
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

/// Checks a fit and summarises it, by the clicks on the fitted field and the frames' cameras.
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

    // Reject a base that does not explain half of the clicks, whose position is not determined, or
    // that stands below the ground. Comparisons are written so that NaN is rejected.
    let median_px = quantile_or_infinite(&errors, 0.5);
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

    // The clicks of a mirrored frame all disagree for one reason; only the frame is reported.
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
        p90_px: quantile_or_infinite(&errors, 0.9),
        previous_median_px: None,
        one_more_frame: None,
        disputed,
        mirrored,
    })
}

/// A quantile of errors in ascending order; infinite without any.
fn quantile_or_infinite(ascending: &[f64], share: f64) -> f64 {
    if ascending.is_empty() {
        f64::INFINITY
    } else {
        quantile(ascending, share)
    }
}

/// How many times the pinhole is adjusted before models are compared.
const STARTING_ROUNDS: usize = 2;

/// A fit with a larger median click error is rejected, px at 1920 px width.
const NO_FIT_PX: f64 = 25.0;

/// A base with a larger 1-σ of the position, along its worst direction, is rejected, m.
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
    crowns
        .into_iter()
        .flat_map(|crown| {
            lenses.iter().map(move |&lens| BaseModel {
                lens,
                crown,
                principal_point,
            })
        })
        .collect()
}

/// The same clicks on the same field with another crown.
fn on_field(frames: &[FrameClicks], from: &FieldModel, to: &FieldModel) -> Vec<FrameClicks> {
    frames
        .iter()
        .map(|frame| FrameClicks {
            observations: frame
                .observations
                .iter()
                .map(|click| click.change_crown(from, to))
                .collect(),
            start: frame.start,
        })
        .collect()
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
        found.extend(
            frame
                .used_clicks()
                .filter_map(|click| click.distance_px(&camera)),
        );
    }
    found
}
