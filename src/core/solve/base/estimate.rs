//! From clicks to a base: start, adjustment, choice of the model. The result is checked and
//! summarised in `summary.rs`.

use super::adjust::{adjust_base, cameras_with_clicks};
use super::cross_validation::{CrossValidation, Errors, FOLDS, MIN_FRAMES, choose};
use super::one_more::one_more_frame;
use super::pixel_aspect::AspectTest;
use super::start::{solve_all, start_base};
use super::summary::{BaseEstimate, ChosenFit, distances, frame_fit, summary};
use super::{
    AdjustOptions, Adjustments, BaseError, BaseModel, BaseProgress, CameraClicks, CrownModel,
    FrameClicks, HeldOutErrors, LensModel, ModelReason, Prescribed,
};
use crate::camera::{CameraBase, Ptz, StatedLens};
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize, median};
use crate::progress::Progress;

/// With fewer frames the principal point cannot be separated from the position.
const PLACING_FRAMES: usize = 12;

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

impl BaseOptions {
    /// The same with a lens as it is stated for pictures of a size. A stated distortion is a prior
    /// of the model that can have it; without one the models are compared.
    #[must_use]
    pub fn with_lens(self, lens: &StatedLens, image_size: ImageSize) -> Self {
        Self {
            lens: self.lens.or(lens.radial.map(|_| LensModel::K1Focal)),
            adjust: self.adjust.with_lens(lens, image_size),
            ..self
        }
    }

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
    test_pixels(&mut estimate, clicks, &adjusted_ptz, &adjust);
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
    // Frames without paint, which are most of a long video, take no part in the choice of the
    // model.
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
    // Clicks show points above the ground, which say most. Where there are none, the paint decides.
    let tested = CameraClicks {
        field: &crowned,
        frames: if has_clicks(&frames) {
            &frames
        } else {
            &painted
        },
        ..*clicks
    };
    let ptz = cameras_with_clicks(tested.frames, &ptz);
    test_pixels(&mut estimate, &tested, &ptz, &options.adjusting());
    Ok(estimate)
}

fn has_clicks(frames: &[FrameClicks]) -> bool {
    frames
        .iter()
        .any(|frame| frame.used_clicks().next().is_some())
}

/// Maximum number of frames, evenly chosen, that say whether the pixels are square: the paint of so
/// many gives their aspect to a hundredth, and the test adjusts them some twenty times.
const MAX_FRAMES_OF_PIXELS: usize = 40;

/// Tests by clicks and paint whether the pixels are square. Where they are not, says so and covers
/// the error of the base.
fn test_pixels(
    estimate: &mut BaseEstimate,
    clicks: &CameraClicks<'_>,
    ptz: &[Option<Ptz>],
    options: &AdjustOptions,
) {
    let with_camera = clicks
        .frames
        .iter()
        .zip(ptz)
        .filter(|(_, ptz)| ptz.is_some());
    let step = with_camera
        .clone()
        .count()
        .div_ceil(MAX_FRAMES_OF_PIXELS)
        .max(1);
    let (frames, ptz): (Vec<FrameClicks>, Vec<Option<Ptz>>) = with_camera
        .step_by(step)
        .map(|(frame, ptz)| (frame.clone(), *ptz))
        .unzip();
    let chosen = CameraClicks {
        frames: &frames,
        ..*clicks
    };
    let test = AspectTest::new(&chosen, (&estimate.base, &ptz), &estimate.model, options);
    if let Some((aspect, error)) = test.run(&estimate.base, &ptz) {
        estimate.pixel_aspect = Some(aspect);
        estimate.base.sigma = estimate.base.sigma.with_error(&error);
        estimate.position_covariance = estimate.base.sigma.position_covariance();
    }
}

/// The errors of frames under a base that is not adjusted to them, at paint and at clicks. Each
/// camera is refined on one half of its clicks and paint and evaluated on the other. `crown_m` is
/// the crown that belongs to the base.
pub fn cross_validated_errors(
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

/// How many times the pinhole is adjusted before models are compared.
const STARTING_ROUNDS: usize = 2;

/// The models to compare, simple ones first.
fn models(
    field: &FieldModel,
    principal_point: Option<ImagePoint>,
    options: &BaseOptions,
) -> Vec<BaseModel> {
    // The order matters to `choose`: a later model has to be better than an earlier one, and the
    // last lens has the smaller errors where frames are few.
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
