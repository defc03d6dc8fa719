//! Estimation of the field's length and width from the clicks, on the user's request.
//!
//! A change of either displaces the landmarks in a way that a change of the camera nearly
//! compensates. They are therefore estimated after the base, as further shared parameters of the
//! bundle adjustment, with priors at the usual values and within the limits of the rules. The
//! derivatives of landmarks and lines by the size are finite differences between fields of two
//! sizes, whatever the template's expressions are. Where the landmarks do not move linearly, the
//! fit is repeated at the size found.

use super::adjust::starting;
use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState};
use super::parameters::{OF_BASE, OF_BASE_AND_SIZE, SIZE, SIZES, Shared, free_parameters};
use super::priors::UsualView;
use super::shared_prior::{Expected, SharedPrior};
use super::{AdjustOptions, BaseModel, FrameClicks};
use crate::camera::{CameraBase, Ptz, SizeError};
use crate::field::{Crown, FieldModel};
use crate::geometry::{ImageSize, Vec3};
use crate::solve::{Observation, ObservedShape};
use nalgebra::SMatrix;

/// A length of the field that may differ from the assumed value.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeParam {
    /// Its name in documents: `length_m`.
    pub name: String,
    /// The assumed value, m.
    pub assumed_m: f64,
    /// The usual value, the mean of the prior, m. It does not follow a value that was fitted before:
    /// repeated fits would then walk away where the frames show little.
    pub usual_m: f64,
    /// The 1-σ of venues around the usual value, m.
    pub sigma_m: f64,
    /// The smallest that the rules allow, m.
    pub min_m: f64,
    /// The largest, m.
    pub max_m: f64,
}

/// A length of the field as estimated from the clicks.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedSize {
    /// Its name in documents.
    pub name: String,
    /// The assumed value, m.
    pub assumed_m: f64,
    /// The estimate, m.
    pub value_m: f64,
    /// The error of the estimate, from click noise and from landmarks that are painted off their
    /// nominal positions, and what goes with it. If only one end of a field is seen, the
    /// uncertainty of its length moves the middle of the field, which is the origin of `world`, by
    /// half, and with it all coordinates.
    pub error: SizeError,
    /// Whether the frames do not determine the length ([`SizeParam::is_open_at`]), so that the
    /// assumed value should be kept.
    pub is_open: bool,
}

impl SizeParam {
    /// Whether observations that leave a length this uncertain (1-σ, m) do not determine it: they
    /// have not halved the uncertainty of the rules. A share and not a number of metres, because the
    /// rules leave a soccer pitch 30 m and a rink 3 m.
    pub fn is_open_at(&self, sigma_m: f64) -> bool {
        sigma_m > OPEN_SHARE * self.sigma_m
    }

    /// The length where no frame shows it.
    pub fn unseen(&self) -> FittedSize {
        FittedSize {
            name: self.name.clone(),
            assumed_m: self.assumed_m,
            value_m: self.assumed_m,
            error: SizeError::alone(self.sigma_m),
            is_open: true,
        }
    }
}

/// The posterior σ of a length that the frames do not determine, at least, as a share of the prior's.
const OPEN_SHARE: f64 = 0.5;

impl FittedSize {
    /// The axis of `world` along which it lies: 0 for the length, 1 for the width.
    pub fn axis(&self) -> usize {
        usize::from(self.name != "length_m")
    }

    /// Raises the 1-σ to cover an error that the fit did not see.
    pub const fn cover_error(&mut self, error_m: f64) {
        self.error.sigma_m = self.error.sigma_m.max(error_m);
    }

    /// The position that belongs to another value of the length, by the regression of the one on the
    /// other: where one end alone is seen, the camera stays with that end.
    pub fn position_shift_m(&self, value_m: f64) -> Vec3 {
        self.error.base_by_m.fixed_rows::<3>(0) * (value_m - self.value_m)
    }

    /// The 1-σ that its own adds to the camera's position along `world` x, y, z, m.
    pub fn position_sigma_m(&self) -> Vec3 {
        self.position_shift_m(self.value_m + self.error.sigma_m)
    }
}

/// The start of the fit: a base and its frames on a field.
#[derive(Clone, Copy, Debug)]
pub struct SizeStart<'a> {
    /// The field, with the crown of the base and the size that the fit starts from; the frames'
    /// clicks are of it.
    pub field: &'a FieldModel,
    /// The clicks.
    pub frames: &'a [FrameClicks],
    /// The base.
    pub base: &'a CameraBase,
    /// Pan, tilt and focal length of each frame; frames without are left out.
    pub ptz: &'a [Option<Ptz>],
    /// Which other parameters are free.
    pub model: &'a BaseModel,
    /// The size of the pictures; the priors scale with it.
    pub image_size: ImageSize,
    /// How to adjust.
    pub options: &'a AdjustOptions,
}

/// The step of the finite differences by the size, m.
const STEP_M: f64 = 0.2;

/// Maximum number of fits; each linearises at the size that the previous one found.
const MAX_FITS: usize = 6;

/// The search ends when every size changes by less than this, m.
const ENOUGH_M: f64 = 0.005;

/// Fits the field's size. `sized` builds the field (with the crown of `start`) for values of the
/// parameters in their order. None where there are no parameters or more than two, or where the
/// clicks do not determine the system.
pub fn fit_field_size(
    sized: &dyn Fn(&[f64]) -> Option<FieldModel>,
    params: &[SizeParam],
    start: &SizeStart<'_>,
) -> Option<Vec<FittedSize>> {
    if params.is_empty() || params.len() > SIZES {
        return None;
    }
    let fit = SizeFit {
        sized,
        params,
        start,
    };
    let shared = starting(start.field, start.base, start.image_size, start.model);
    let mut state = BundleState {
        shared,
        ptz: start.ptz.iter().flatten().copied().collect(),
    };
    // The fit starts from the size that the frames were adjusted at.
    let begin = |param: &SizeParam| start.field.params.get(&param.name).copied();
    let mut values: Vec<f64> = params
        .iter()
        .map(|param| (begin(param).unwrap_or(param.assumed_m)).clamp(param.min_m, param.max_m))
        .collect();
    // A size that reaches a limit of the rules is fixed there (active set).
    let mut held = [false; SIZES];
    for round in 1.. {
        // One bundle adjustment, linearised at the current size.
        let (mut bundle, shared) = fit.bundle(&values, &state.shared, held)?;
        let found = bundle.minimum(
            BundleState {
                shared,
                ptz: state.ptz,
            },
            start.options.max_iterations,
        );

        // Move to the size found, within the limits.
        let mut moved_m: f64 = 0.0;
        for (size, (value, param)) in values.iter_mut().zip(params).enumerate() {
            let wanted = *value + found.state.shared.larger_m[size];
            let allowed = wanted.clamp(param.min_m, param.max_m);
            held[size] |= allowed != wanted;
            moved_m = moved_m.max((allowed - *value).abs());
            *value = allowed;
        }

        // Converged, or out of rounds. For the covariance, sizes at a limit are free again: the
        // limit is no information about how well the clicks determine the size.
        if moved_m < ENOUGH_M || round == MAX_FITS {
            bundle.free = fit.free([false; SIZES]);
            let noise_scale = bundle.noise_scale(&found.state);
            return fit.fitted_sizes(&values, &bundle.covariance(&found.state, noise_scale));
        }
        state = found.state;
    }
    None
}

/// The inputs that all fits have in common.
struct SizeFit<'a> {
    sized: &'a dyn Fn(&[f64]) -> Option<FieldModel>,
    params: &'a [SizeParam],
    start: &'a SizeStart<'a>,
}

impl SizeFit<'_> {
    /// The field with one length changed by ± [`STEP_M`], downwards where the upper limit of the
    /// rules is near, and the change, m.
    fn perturb_length(&self, values: &[f64], size: usize) -> Option<(FieldModel, f64)> {
        let by_m = if values[size] + STEP_M <= self.params[size].max_m {
            STEP_M
        } else {
            -STEP_M
        };
        let mut changed = values.to_vec();
        changed[size] += by_m;
        Some(((self.sized)(&changed)?, by_m))
    }

    /// The free parameters: those of the model, and the sizes that are not fixed.
    fn free(&self, held: [bool; SIZES]) -> [bool; OF_BASE_AND_SIZE] {
        let mut free = free_parameters(self.start.model);
        for size in 0..self.params.len() {
            free[SIZE + size] = !held[size];
        }
        free
    }

    /// The bundle adjustment linearised at a field of the given size, and its start: `shared` at
    /// that size.
    fn bundle(
        &self,
        values: &[f64],
        shared: &Shared,
        held: [bool; SIZES],
    ) -> Option<(Bundle<OF_BASE_AND_SIZE>, Shared)> {
        let start = self.start;
        let field = (self.sized)(values)?;
        // The field at this size, and one with each length changed.
        let changed: Vec<(FieldModel, f64)> = (0..values.len())
            .map(|size| self.perturb_length(values, size))
            .collect::<Option<_>>()?;
        let crown = Crown {
            width_m: field.width_m,
            ..shared.crown
        };
        let mut shared = Shared::new(&shared.base, crown);
        for (size, (larger, by_m)) in changed.iter().enumerate() {
            shared.width_by_size[size] = (larger.width_m - field.width_m) / by_m;
        }
        // Clicks without an element of the field, which do not depend on its size, are left out.
        let frames = self
            .solved_frames()
            .map(|frame| {
                frame
                    .used_clicks()
                    .filter_map(|click| click_with_sizes(click, &field, &changed))
                    .collect()
            })
            .collect();

        // The priors of the base, and one for each size. The parameter is the change from the
        // current value, so the prior's mean is the usual value minus the current one.
        let view = UsualView::from_frames(
            start.base,
            &start.ptz.iter().flatten().copied().collect::<Vec<_>>(),
        );
        let mut priors = start
            .options
            .priors
            .for_model(start.model, start.image_size, &view);
        priors.extend(
            self.params
                .iter()
                .zip(values)
                .enumerate()
                .map(|(size, (param, value))| SharedPrior {
                    of: Expected::Larger(param.usual_m - value, size),
                    sigma: param.sigma_m,
                }),
        );
        let bundle = Bundle {
            frames,
            priors,
            free: self.free(held),
            loss: start.options.loss,
        };
        Some((bundle, shared))
    }

    /// The frames that take part: those with a camera.
    fn solved_frames(&self) -> impl Iterator<Item = &FrameClicks> {
        let frames = self.start.frames.iter().zip(self.start.ptz);
        frames.filter_map(|(frame, ptz)| ptz.is_some().then_some(frame))
    }

    /// The sizes with their σ, from the joint covariance of all shared parameters. It has two
    /// independent parts, click noise and displaced landmarks (`scatter.rs`).
    fn fitted_sizes(
        &self,
        values: &[f64],
        covariance: &SMatrix<f64, OF_BASE_AND_SIZE, OF_BASE_AND_SIZE>,
    ) -> Option<Vec<FittedSize>> {
        let field = (self.sized)(values)?;
        let mut sizes = Vec::with_capacity(values.len());
        for (size, (param, value)) in self.params.iter().zip(values).enumerate() {
            let variance = covariance[(SIZE + size, SIZE + size)];
            if !(variance.is_finite() && variance > 0.0) {
                return None;
            }
            // Observations cannot make a length less certain than its prior.
            let sigma_m = variance.sqrt().min(param.sigma_m);
            let mut fitted = FittedSize {
                name: param.name.clone(),
                assumed_m: param.assumed_m,
                value_m: *value,
                error: SizeError::alone(sigma_m),
                is_open: param.is_open_at(sigma_m),
            };
            // The most likely change of the base per change of the length: the conditional mean of
            // the Gaussian.
            fitted.error.base_by_m = covariance.fixed_view::<OF_BASE, 1>(0, SIZE + size) / variance;
            let (changed, by_m) = self.perturb_length(values, size)?;
            let extents = moved_extents(&field, &changed, by_m, fitted.axis());
            [fitted.error.still_m, fitted.error.end_m] = extents;
            sizes.push(fitted);
        }
        Some(sizes)
    }
}

/// Up to where, m from the middle, ground has landmarks that stay where they are if a field grows by
/// so many metres along an axis, and from where on they go with the end. A quarter of the gap
/// between them belongs to either, because the base may be drawn on a field of another size: open
/// lengths stay as assumed, others are rounded.
fn moved_extents(field: &FieldModel, larger: &FieldModel, by_m: f64, axis: usize) -> [f64; 2] {
    let (mut still_m, mut end_m) = (0.0_f64, f64::INFINITY);
    for (before, after) in field.landmarks.iter().zip(&larger.landmarks) {
        let (at_m, moved_m) = (before.nominal_m[axis], after.nominal_m - before.nominal_m);
        // The ends move by half of it.
        if (moved_m[axis] / by_m).abs() < 0.25 {
            still_m = still_m.max(at_m.abs());
        } else {
            end_m = end_m.min(at_m.abs());
        }
    }
    if !end_m.is_finite() {
        return [still_m, 0.0];
    }
    let margin_m = 0.25 * (end_m - still_m).max(0.0);
    [still_m + margin_m, end_m - margin_m]
}

/// A click with the derivative of its shape by each size, from the field of the current size and
/// one with each length changed, with the change, m. None for a click without an element of the
/// field.
fn click_with_sizes(
    click: &Observation,
    field: &FieldModel,
    changed: &[(FieldModel, f64)],
) -> Option<BaseClick> {
    let element = click.element?;
    let mut sized = BaseClick::new(&click.with_element(field, element)?, field.crown());
    for (size, (larger, by_m)) in changed.iter().enumerate() {
        let shape =
            ObservedShape::from_element(larger, element)?.change_crown(larger.crown(), Crown::FLAT);
        sized = sized.growing(size, &shape, *by_m);
    }
    Some(sized)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::PtzCamera;
    use crate::field::builtin;
    use crate::geometry::ImageSize;
    use crate::solve::base::{CrownModel, LensModel};
    use crate::testing::base_at;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// The sizes that the landmarks seen at some pans say, where the field is assumed as it is.
    fn sizes(pans_deg: &[f64]) -> Vec<FittedSize> {
        sizes_beside(pans_deg, &[])
    }

    /// The same, with clicks at further pans in frames that have no camera.
    fn sizes_beside(pans_deg: &[f64], without_camera_deg: &[f64]) -> Vec<FittedSize> {
        let template = builtin("soccer").unwrap();
        let field = template.default_model().unwrap();
        let base = base_at([-8.0, -64.0, 17.0], SIZE);
        let mut ptz: Vec<Option<Ptz>> = pans_deg
            .iter()
            .chain(without_camera_deg)
            .map(|pan| Some(Ptz::from_degrees(*pan, -12.0, 2800.0)))
            .collect();
        let seen = |ptz: &Option<Ptz>| {
            let camera = PtzCamera::new(base, ptz.unwrap());
            let of = |(number, landmark): (usize, &crate::field::Landmark)| {
                let image = camera
                    .image_from_world(field.landmark_in_world(landmark))
                    .ok()?;
                let seen = SIZE.contains(image) && landmark.nominal_m.z == 0.0;
                seen.then(|| {
                    Observation::from_landmark(&field, landmark.id.as_str(), image, SIZE, number)
                        .unwrap()
                })
            };
            FrameClicks {
                observations: field.landmarks.iter().enumerate().filter_map(of).collect(),
                start: None,
            }
        };
        let frames: Vec<FrameClicks> = ptz.iter().map(seen).collect();
        ptz[pans_deg.len()..].fill(None);
        let params: Vec<SizeParam> = [
            ("length_m", 105.0, 2.5, 90.0, 120.0),
            ("width_m", 68.0, 3.75, 45.0, 90.0),
        ]
        .map(|(name, assumed_m, sigma_m, min_m, max_m)| SizeParam {
            name: name.to_owned(),
            assumed_m,
            usual_m: assumed_m,
            sigma_m,
            min_m,
            max_m,
        })
        .into();
        let sized = |values: &[f64]| {
            let lengths = params
                .iter()
                .zip(values)
                .map(|(param, value)| (param.name.clone(), *value));
            template.model(&lengths.collect(), 0.0).ok()
        };
        let model = BaseModel {
            lens: LensModel::Pinhole,
            crown: CrownModel::Fixed(0.0),
            principal_point: None,
        };
        let start = SizeStart {
            field: &field,
            frames: &frames,
            base: &base,
            ptz: &ptz,
            model: &model,
            image_size: SIZE,
            options: &AdjustOptions::default(),
        };
        fit_field_size(&sized, &params, &start).unwrap()
    }

    #[test]
    fn with_one_end_alone_the_position_is_known_half_as_well_as_the_length() {
        let one_end = sizes(&[42.0, 46.0, 50.0]);
        let error = one_end[0].error;
        assert!(error.sigma_m > 2.4, "{one_end:?}");
        let along = one_end[0].position_sigma_m();
        assert!(
            (along.x - 0.5 * error.sigma_m).abs() < 0.02 && along.yz().norm() < 0.02,
            "{along}"
        );
        // The circle stays; the arc of the penalty area goes with the goal.
        assert!((9.15..20.0).contains(&error.still_m) && (20.0..32.0).contains(&error.end_m));
        assert!((20.2..33.9).contains(&one_end[1].error.end_m));
    }

    #[test]
    fn frames_without_a_camera_make_no_length_more_certain() {
        let one_end = [42.0, 46.0, 50.0];
        assert_eq!(sizes_beside(&one_end, &[-42.0, 0.0]), sizes(&one_end));
    }

    #[test]
    fn with_the_centre_alone_the_length_is_open_and_the_position_is_not() {
        let centre = sizes(&[4.0, 7.0, 10.0]);
        // Nothing is seen that moves with the length: it stays as well known as it was assumed to
        // be.
        assert!(
            (centre[0].error.sigma_m - 2.5).abs() < 0.1
                && centre[0].position_sigma_m().norm() < 0.1,
            "{centre:?}"
        );
    }

    #[test]
    fn with_both_ends_the_length_adds_little_to_the_position() {
        let both = sizes(&[-42.0, -25.0, -8.0, 8.0, 25.0, 42.0]);
        assert!(
            both[0].error.sigma_m < 0.3 && both[0].position_sigma_m().norm() < 0.15,
            "{both:?}"
        );
    }

    #[test]
    fn an_error_that_the_fit_did_not_see_widens_position_and_length_together() {
        let mut error = SizeError::alone(0.5);
        error.base_by_m[0] = 0.5;
        let mut size = FittedSize {
            name: "length_m".to_owned(),
            assumed_m: 105.0,
            value_m: 113.9,
            error,
            is_open: false,
        };
        let fitted = size.clone();
        size.cover_error(0.4);
        assert_eq!(size, fitted, "less than its own");
        size.cover_error(1.3);
        assert_eq!(size.error.sigma_m, 1.3);
        assert!((size.position_sigma_m() - Vec3::x() * 0.65).norm() < 1e-12);
    }
}
