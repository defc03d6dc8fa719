//! The base adjusted to the clicks of many frames.

use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState};
use super::covariance::Adjusted;
use super::parameters::{OF_BASE, Shared, free_parameters};
use super::priors::{BasePriors, LENS_FOCAL_PX, UsualView};
use super::{BaseModel, CameraClicks, FrameClicks, LensModel, Prescribed};
use crate::camera::{BaseSigma, CameraBase, FocalCurve, Ptz, StatedLens};
use crate::field::{Crown, FieldModel};
use crate::geometry::{ImageSize, Mat3};
use crate::solve::Loss;
use crate::solve::optimiser::least_squares::{Equations, Minimum};

/// Up to so many frames, the view of a start may be a poor one. The mean of more hardly matters.
const FEW_FRAMES: usize = 2;

/// Maximum number of times that the priors are made again where an adjusted base looks.
const MAX_VIEWS: usize = 2;

/// How to adjust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustOptions {
    /// The robust loss of the clicks.
    pub loss: Loss,
    /// The priors of the shared parameters.
    pub priors: BasePriors,
    /// The parameters that the user declared exact.
    pub prescribed: Prescribed,
    /// Maximum number of steps tried.
    pub max_iterations: usize,
}

impl Default for AdjustOptions {
    fn default() -> Self {
        Self {
            loss: Loss::Cauchy { c: 3.0 },
            priors: BasePriors::default(),
            prescribed: Prescribed::default(),
            max_iterations: 60,
        }
    }
}

impl AdjustOptions {
    /// The same with a lens as it is stated for pictures of a size.
    #[must_use]
    pub fn with_lens(self, lens: &StatedLens, image_size: ImageSize) -> Self {
        Self {
            priors: self.priors.with_lens(lens, image_size),
            ..self
        }
    }
}

/// A base fitted to many frames.
#[derive(Clone, Debug, PartialEq)]
pub struct AdjustedBase {
    /// The base, in the pan gauge of the conventions, with its own sigma.
    pub base: CameraBase,
    /// The crown of the pitch, m.
    pub crown_m: f64,
    /// Pan, tilt, focal length of every frame; none where the start had none, or where the frame
    /// has no clicks.
    pub ptz: Vec<Option<Ptz>>,
    /// Covariance of the position, m².
    pub position_covariance: Mat3,
    /// The ratio of the clicks' variance to the stated one, at least 1; the covariance includes it.
    pub noise_scale: f64,
    /// The minimised robust cost.
    pub cost: f64,
    /// Steps tried.
    pub iterations: usize,
}

/// Adjusts a base and its frames from a start. Frames without `ptz` are left out.
///
/// The principal point is the start's.
pub fn adjust_base(
    clicks: &CameraClicks<'_>,
    start: &CameraBase,
    start_ptz: &[Option<Ptz>],
    model: &BaseModel,
    options: &AdjustOptions,
) -> AdjustedBase {
    let CameraClicks { field, frames, .. } = *clicks;
    let image_size = clicks.image_size;
    // The equations of a frame without clicks would be singular.
    let start_ptz = cameras_with_clicks(frames, start_ptz);
    let clicks = frames.iter().map(|frame| {
        frame
            .used_clicks()
            .map(|click| BaseClick::new(click, field.crown()))
            .collect()
    });
    let (clicks, ptz): (_, Vec<Ptz>) = clicks
        .zip(&start_ptz)
        .filter_map(|(clicks, ptz): (Vec<_>, _)| Some((clicks, (*ptz)?)))
        .unzip();

    // Minimise the robust cost of all clicks and the priors.
    let mut view = UsualView::from_frames(start, &ptz);
    let mut bundle = Bundle::<OF_BASE> {
        frames: clicks,
        priors: options.priors.for_model(model, image_size, &view),
        free: free_parameters(model),
        loss: options.loss,
    };
    let shared = starting(field, start, image_size, model);
    let mut found = bundle.minimum(BundleState { shared, ptz }, options.max_iterations);

    // A poor start of a frame or two looks elsewhere, with another focal length, than the frames
    // that are adjusted to it, and the priors of the lens and the lean were those of its view. So
    // make them again from the adjusted view until it stands.
    for _ in 0..MAX_VIEWS {
        let BundleState { shared, ptz } = &found.state;
        if ptz.len() > FEW_FRAMES {
            break;
        }
        let adjusted = UsualView::from_frames(&shared.base, ptz);
        if adjusted.is_near(&view) {
            break;
        }
        view = adjusted;
        bundle.priors = options.priors.for_model(model, image_size, &view);
        let again = bundle.minimum(found.state, options.max_iterations);
        let iterations = found.iterations + again.iterations;
        found = Minimum {
            iterations,
            ..again
        };
    }
    let noise_scale = bundle.noise_scale(&found.state);
    let BundleState { shared, ptz } = &found.state;

    // The covariance, with the priors at where the adjusted frames look.
    let held = Adjusted {
        state: &found.state,
        model,
        field,
        noise_scale,
        prescribed: options.prescribed,
        principal_point_px: options.priors.principal_point_px * image_size.scale_from_1920(),
    };
    let view = UsualView::from_frames(start, ptz);
    let covariance = held.covariance(bundle, &|model| {
        options.priors.for_model(model, image_size, &view)
    });

    // Return to the pan gauge: the rotation that it takes out of the base is added to every pan.
    let (mut base, added) = shared.base.in_pan_gauge();
    base.sigma = BaseSigma::from_covariance(&covariance, shared.crown.width_m);
    let mut solved = ptz.iter().map(|ptz| Ptz {
        pan: (ptz.pan + added).wrap(),
        ..*ptz
    });
    AdjustedBase {
        base,
        crown_m: shared.crown.height_m,
        ptz: start_ptz
            .iter()
            .map(|ptz| ptz.and_then(|_| solved.next()))
            .collect(),
        noise_scale,
        position_covariance: covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        cost: Equations::cost(&found.equations),
        iterations: found.iterations,
    }
}

/// The cameras of the frames that have clicks or paint to be adjusted to.
pub(super) fn cameras_with_clicks(frames: &[FrameClicks], ptz: &[Option<Ptz>]) -> Vec<Option<Ptz>> {
    let frames = frames.iter().zip(ptz);
    frames
        .map(|(frame, ptz)| ptz.filter(|_| frame.used_clicks().next().is_some()))
        .collect()
}

/// The start's shared parameters, restricted to those that the model has: its lens and its crown.
pub(super) fn starting(
    field: &FieldModel,
    start: &CameraBase,
    image_size: ImageSize,
    model: &BaseModel,
) -> Shared {
    // k₁ refers to a fixed focal length, so that value and slope have the same meaning for all
    // bases.
    let at_focal_px = LENS_FOCAL_PX * image_size.scale_from_1920();
    let value = start.distortion.at(at_focal_px);
    // What the model does not have starts, and stays, at zero. The pixels' aspect is given.
    let distortion = match model.lens {
        LensModel::Pinhole => FocalCurve {
            at_focal_px,
            ..FocalCurve::NONE
        },
        LensModel::K1 => FocalCurve {
            at_focal_px,
            value,
            ..FocalCurve::NONE
        },
        LensModel::K1Focal | LensModel::K1FocalK2 => FocalCurve {
            at_focal_px,
            value,
            per_1000_px: start.distortion.per_1000_px,
            k2_per_k1_squared: if model.lens.never_folds() {
                FocalCurve::WITHOUT_FOLD
            } else {
                0.0
            },
            ..FocalCurve::NONE
        },
    }
    .with_pixel_aspect(start.distortion.pixel_aspect);
    let height_m = model.crown.fixed_height_m().unwrap_or(field.crown_m);
    Shared::new(
        &CameraBase {
            distortion,
            ..*start
        },
        Crown {
            height_m,
            ..field.crown()
        },
    )
}
