//! The base adjusted to the clicks of many frames.

use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState, keep_determined};
use super::parameters::{OF_BASE, PRINCIPAL_POINT, Shared, free_parameters};
use super::shared_prior::{Expected, SharedPrior};
use super::{BaseModel, CameraClicks, CrownModel, FrameClicks, LensModel, Prescribed};
use crate::camera::{BaseSigma, CameraBase, FocalCurve, Ptz, SharedCovariance, StatedLens};
use crate::field::{Crown, FieldModel};
use crate::geometry::{Angle, ImageSize, Mat3, Vec2, Vec3};
use crate::solve::Loss;
use crate::solve::optimiser::least_squares::{Equations, Minimum, Problem as _};
use nalgebra::{SMatrix, Vector2};

/// Priors of a broadcast camera. They are weak, and matter only where the clicks are few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasePriors {
    /// 1-σ of the base's pitch: camera heads are levelled, but less well along the view than across
    /// it.
    pub pitch: Angle,
    /// 1-σ of the base's roll.
    pub roll: Angle,
    /// k₁ at a focal length of 2000 px of a frame 1920 px wide, and its 1-σ.
    pub k1: (f64, f64),
    /// The change of k₁ per 1000 px of such a frame, and its 1-σ.
    pub k1_slope: (f64, f64),
    /// The crown, m, and its 1-σ.
    pub crown_m: (f64, f64),
    /// 1-σ of the principal point, px of a frame 1920 px wide.
    pub principal_point_px: f64,
    /// The position (`world`) and its 1-σ along each axis, m, where something is known about it
    /// beforehand.
    pub position_m: Option<(Vec3, Vec3)>,
}

impl Default for BasePriors {
    /// Measured on nine matches: rolls of 0.1 to 0.4°, pitches of up to 1.6°, crowns of 0.05 to
    /// 0.25 m, k₁ ≈ −0.02 + 0.21 (f − 2000) / 1000. Twenty lenses of a World Cup, calibrated frame
    /// by frame by its provider, have principal points up to 69 px off the middle.
    fn default() -> Self {
        Self {
            pitch: Angle::from_degrees(1.0),
            roll: Angle::from_degrees(0.4),
            k1: (-0.02, 0.04),
            k1_slope: (0.21, 0.1),
            crown_m: (0.13, 0.07),
            principal_point_px: 40.0,
            position_m: None,
        }
    }
}

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
    // What the model does not have starts, and stays, at zero.
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
        },
    };
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

/// The focal length at which k₁ itself is a parameter, px of a frame 1920 px wide.
const LENS_FOCAL_PX: f64 = 2000.0;

/// Up to so many frames, the view of a start may be a poor one. The mean of more hardly matters.
const FEW_FRAMES: usize = 2;

/// Maximum number of times that the priors are made again where an adjusted base looks.
const MAX_VIEWS: usize = 2;

/// Views whose directions (radians) and logarithms of focal length differ by less have nearly the
/// same priors: k₁ by a quarter of its σ at 2000 px, the lean by a twentieth.
const NEAR_VIEW: f64 = 0.05;

/// Where a camera usually looks: the direction and focal length that its priors refer to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) struct UsualView {
    /// From the camera to the middle of the field, seen from above: unit, `world` x and y.
    /// Operators level the head along and across this direction, wherever a single frame looks.
    pub along: Vec2,
    /// 1-σ of that direction.
    pub sigma: Angle,
    /// The geometric mean of the frames' focal lengths, px; none where the focal length of the
    /// priors is used.
    pub focal_px: Option<f64>,
}

impl UsualView {
    /// The usual view of the frames of a base. One frame with four landmarks gives the direction
    /// from its camera to the field to a few degrees; the base's own sigma says how well.
    pub fn from_frames(base: &CameraBase, ptz: &[Ptz]) -> Self {
        // The direction's error is that of the position across it, seen from the field's middle.
        let along = direction_to_field(base.position_m);
        let across = Vec3::new(-along.y, along.x, 0.0);
        let variance = across.dot(&(base.sigma.position_covariance() * across));
        let sigma_rad = if variance.is_finite() {
            variance.max(0.0).sqrt() / base.position_m.xy().norm().max(1.0)
        } else {
            f64::INFINITY
        };
        let logs: f64 = ptz.iter().map(|ptz| ptz.focal_px.ln()).sum();
        Self {
            along,
            sigma: Angle::from_radians(sigma_rad),
            focal_px: (!ptz.is_empty()).then(|| (logs / ptz.len() as f64).exp()),
        }
    }

    /// Whether the priors of another view are nearly those of this one.
    fn is_near(&self, other: &Self) -> bool {
        let turned = (1.0 - self.along.dot(&other.along)).max(0.0) * 2.0;
        let zoomed = match (self.focal_px, other.focal_px) {
            (Some(own), Some(other)) => (own / other).ln().abs(),
            (own, other) => f64::from(own != other),
        };
        turned.sqrt() < NEAR_VIEW && zoomed < NEAR_VIEW
    }

    /// 1-σ of the lean along and across the stated direction, where heads lean by `pitch` and
    /// `roll` along and across the true one. A direction that is off by δ mixes the two: the
    /// variance of each has the share sin² δ of the other's, whose mean over a Gaussian δ is
    /// (1 − exp(−2σ²)) / 2.
    fn lean_sigmas(&self, pitch: Angle, roll: Angle) -> [f64; 2] {
        let mixed = 0.5 * (1.0 - (-2.0 * self.sigma.radians().powi(2)).exp());
        let [pitch, roll] = [pitch, roll].map(|sigma| sigma.radians().powi(2));
        [
            (pitch + mixed * (roll - pitch)).sqrt(),
            (roll + mixed * (pitch - roll)).sqrt(),
        ]
    }
}

/// The direction from a camera to the middle of the field, seen from above (`world` x and y, unit);
/// that of the main stand for a camera above the middle.
pub(in crate::solve) fn direction_to_field(position_m: Vec3) -> Vec2 {
    (-position_m.xy())
        .try_normalize(1e-9)
        .unwrap_or(Vec2::new(0.0, 1.0))
}

impl BasePriors {
    /// The same with a lens as it is stated for pictures of a size in place of the usual one.
    #[must_use]
    pub fn with_lens(self, lens: &StatedLens, image_size: ImageSize) -> Self {
        let Some(radial) = lens.radial else {
            return self;
        };
        let per_1920 = image_size.scale_from_1920();
        Self {
            k1: radial.k1_at(LENS_FOCAL_PX * per_1920),
            k1_slope: (
                radial.curve.per_1000_px * per_1920,
                radial.per_1000_px_sigma * per_1920,
            ),
            ..self
        }
    }

    /// The usual lens of broadcast cameras for pictures of a size: k₁ follows the focal length.
    pub fn usual_lens(&self, image_size: ImageSize) -> FocalCurve {
        let per_1920 = image_size.scale_from_1920();
        // k₁ is of normalised coordinates and has no unit of px; the focal lengths scale with the
        // width, and the slope per px of focal length with its inverse.
        FocalCurve {
            at_focal_px: LENS_FOCAL_PX * per_1920,
            value: self.k1.0,
            per_1000_px: self.k1_slope.0 / per_1920,
            k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
        }
    }

    /// The priors of the parameters that a model leaves free.
    ///
    /// Pitch and roll refer to the direction from the camera to the field, along and across which
    /// heads are levelled, not to the field's axes.
    pub(in crate::solve) fn for_model(
        &self,
        model: &BaseModel,
        image_size: ImageSize,
        view: &UsualView,
    ) -> Vec<SharedPrior> {
        let per_1920 = image_size.scale_from_1920();
        let [pitch, roll] = view.lean_sigmas(self.pitch, self.roll);
        let mut found = vec![
            SharedPrior::new(Expected::Pitch(view.along), pitch),
            SharedPrior::new(Expected::Roll(view.along), roll),
        ];
        if model.lens != LensModel::Pinhole {
            // A constant k₁ is that of the frames' mean focal length: evaluate the usual curve of
            // k₁ there, and add the uncertainty of its slope.
            let own_px = view.focal_px.filter(|_| !model.lens.follows_focal());
            // The distance of that focal length from the reference one, px of a frame 1920 px wide.
            let beyond_px = own_px.map_or(0.0, |own_px| own_px / per_1920 - LENS_FOCAL_PX);
            let expected = self.k1.0 + self.k1_slope.0 * beyond_px / 1000.0;
            found.push(SharedPrior::new(
                Expected::K1(expected),
                self.k1.1.hypot(self.k1_slope.1 * beyond_px / 1000.0),
            ));
        }
        if model.lens.follows_focal() {
            found.push(SharedPrior::new(
                Expected::Slope(self.k1_slope.0 / per_1920),
                self.k1_slope.1 / per_1920,
            ));
        }
        if let Some((position_m, sigma_m)) = self.position_m {
            found.extend(
                (0..3).map(|axis| {
                    SharedPrior::new(Expected::Position(position_m, axis), sigma_m[axis])
                }),
            );
        }
        if model.crown == CrownModel::Free {
            found.push(SharedPrior::new(
                Expected::Crown(self.crown_m.0),
                self.crown_m.1,
            ));
        }
        if let Some(nominal) = model.principal_point {
            let sigma_px = self.principal_point_px * per_1920;
            found.extend(
                (0..2).map(|axis| {
                    SharedPrior::new(Expected::PrincipalPoint(nominal, axis), sigma_px)
                }),
            );
        }
        found
    }
}

// The covariance of a base whose model fixes parameters that are not exact in reality.
//
// A model without distortion, with a level pitch or with its principal point in the middle fixes
// parameters that a real camera does not have exactly. Each of them is uncertain by its prior, and
// its error propagates to all adjusted parameters.

/// The result of an adjustment, with what its covariance depends on.
pub(super) struct Adjusted<'a> {
    pub state: &'a BundleState,
    pub model: &'a BaseModel,
    pub field: &'a FieldModel,
    pub noise_scale: f64,
    pub prescribed: Prescribed,
    /// The 1-σ of a principal point about the middle, px.
    pub principal_point_px: f64,
}

impl Adjusted<'_> {
    /// The covariance of the shared parameters. `priors` gives those of the parameters that a model
    /// leaves free.
    ///
    /// Lens and crown were fixed because the clicks do not determine them: their posterior is
    /// computed as if they were free. The principal point is fixed whatever the clicks show, so its
    /// whole prior is an error that the adjustment did not compensate (a "considered" parameter;
    /// Schmidt 1966, Tapley, Schutz and Born, Statistical Orbit Determination, chapter 6).
    pub fn covariance(
        &self,
        mut bundle: Bundle<OF_BASE>,
        priors: &dyn Fn(&BaseModel) -> Vec<SharedPrior>,
    ) -> SharedCovariance {
        // Free the lens and the crown unless the user prescribed them.
        let lens = if self.prescribed.lens {
            self.model.lens
        } else {
            LensModel::K1Focal
        };
        let is_level = self.prescribed.crown || !self.field.may_be_crowned();
        let crown = if is_level {
            self.model.crown
        } else {
            CrownModel::Free
        };
        let uncertain = BaseModel {
            lens,
            crown,
            ..*self.model
        };
        bundle.free = free_parameters(&uncertain);
        bundle.priors = priors(&uncertain);
        let covariance = bundle.covariance(self.state, self.noise_scale);
        if self.model.principal_point.is_some() || self.prescribed.principal_point {
            return covariance;
        }

        // The principal point as a considered parameter: H of the parameters that are free, and the
        // coupling B of the principal point with them.
        let mut equations = keep_determined(bundle.equations(self.state));
        let held = equations
            .eliminate_blocks(0.0)
            .and_then(|(matrix, _)| matrix.try_inverse());
        let middle = Some(self.state.shared.base.principal_point);
        equations.free = free_parameters(&BaseModel {
            principal_point: middle,
            ..uncertain
        });
        let with_all = equations.eliminate_blocks(0.0);
        // Singular equations made the covariance infinite already; nothing is to be added to that.
        let (Some(inverse), Some((information, _))) = (held, with_all) else {
            return covariance;
        };
        // All other parameters change by −H⁻¹ B per px of error of the principal point.
        let mut mixed = information.fixed_columns::<2>(PRINCIPAL_POINT).into_owned();
        mixed.fixed_rows_mut::<2>(PRINCIPAL_POINT).fill(0.0);
        let mut moved: SMatrix<f64, OF_BASE, 2> = -inverse * mixed;
        moved
            .fixed_rows_mut::<2>(PRINCIPAL_POINT)
            .fill_diagonal(1.0);
        let variance =
            SMatrix::<f64, 2, 2>::from_diagonal(&Vector2::repeat(self.principal_point_px.powi(2)));
        covariance + moved * variance * moved.transpose()
    }
}
