//! The field's length and width from the clicks, where a person asks for it.
//!
//! Both shift landmarks against each other in ways that a camera can nearly imitate, so they are
//! found after the base, with priors at what is assumed and within what the rules allow: as further
//! shared parameters of the bundle adjustment. How landmarks and lines move with them is taken from
//! fields of two sizes, whatever the template's expressions are; where they do not move in
//! proportion, the fit is repeated at the size found.

use super::adjust::{UsualView, starting};
use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState};
use super::parameters::{OF_BASE_AND_SIZE, SIZE, SIZES, Shared, free_parameters};
use super::scatter::USUAL_DISPLACEMENT;
use super::shared_prior::{Expected, SharedPrior};
use super::{AdjustOptions, BaseModel, FrameClicks};
use crate::camera::{CameraBase, Ptz};
use crate::field::{Crown, FieldElement, FieldModel};
use crate::geometry::Vec3;
use crate::solve::{Observation, ObservedShape};

/// A length of the field that may differ from what is assumed.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeParam {
    /// Its name in documents: `length_m`.
    pub name: String,
    /// What is assumed, m.
    pub assumed_m: f64,
    /// How far venues differ from it, 1-σ, m.
    pub sigma_m: f64,
    /// The smallest that the rules allow, m.
    pub min_m: f64,
    /// The largest, m.
    pub max_m: f64,
}

/// A length of the field as the clicks have it.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedSize {
    /// Its name in documents.
    pub name: String,
    /// What was assumed, m.
    pub assumed_m: f64,
    /// What was found, m.
    pub value_m: f64,
    /// Its 1-σ, m: of clicks that scatter, and of landmarks that lie off their places.
    pub sigma_m: f64,
    /// What that adds to the camera's position, 1-σ along `world` x, y, z, m. Where one end of a
    /// field is seen and not the other, its middle, the origin of `world`, is known half as well as
    /// its length, and so is everything that is told from there.
    pub position_sigma_m: Vec3,
    /// The frames do not show the length: what was assumed holds.
    pub is_open: bool,
}

/// A length that is less certain is not shown by the frames, m: where they show it, 0.04 to 0.13 m
/// is stated before any floor.
const OPEN_M: f64 = 0.5;

/// Where the fit starts: a base and its frames on the field as assumed.
#[derive(Clone, Copy, Debug)]
pub struct SizeStart<'a> {
    /// The field as assumed, with the crown of the base; the frames' clicks are of it.
    pub field: &'a FieldModel,
    /// The clicks.
    pub frames: &'a [FrameClicks],
    /// The base.
    pub base: &'a CameraBase,
    /// Pan, tilt and focal length of each frame that takes part.
    pub ptz: &'a [Option<Ptz>],
    /// What is free beside.
    pub model: &'a BaseModel,
    /// Columns of the picture: they scale the priors.
    pub image_width_px: u32,
    /// How to adjust.
    pub options: &'a AdjustOptions,
}

/// The change of size by which the movement of landmarks is measured, m.
const STEP_M: f64 = 0.2;

/// Fits at most, each at the size that the one before found.
const MAX_FITS: usize = 6;

/// A size that moves by less ends the search, m.
const ENOUGH_M: f64 = 0.005;

/// Fits the field's size; `sized` gives the field (crown as in `start`) for values of the
/// parameters in their order. None where nothing is to be fitted, where it is more than two
/// lengths, or where the clicks leave it open.
#[must_use]
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
    let shared = starting(start.field, start.base, start.image_width_px, start.model);
    let mut state = BundleState {
        shared,
        ptz: start.ptz.iter().flatten().copied().collect(),
    };
    let mut values: Vec<f64> = params
        .iter()
        .map(|param| param.assumed_m.clamp(param.min_m, param.max_m))
        .collect();
    // A size at the end of what the rules allow stays there.
    let mut held = [false; SIZES];
    for round in 1.. {
        let (bundle, shared) = fit.bundle(&values, &state.shared, held)?;
        let mut found = bundle.minimum(
            BundleState {
                shared,
                ptz: state.ptz,
            },
            start.options.max_iterations,
        );
        let mut moved_m: f64 = 0.0;
        for (size, (value, param)) in values.iter_mut().zip(params).enumerate() {
            let wanted = *value + found.state.shared.larger_m[size];
            let allowed = wanted.clamp(param.min_m, param.max_m);
            held[size] |= allowed != wanted;
            moved_m = moved_m.max((allowed - *value).abs());
            *value = allowed;
        }
        if moved_m < ENOUGH_M || round == MAX_FITS {
            found.equations.free = fit.free([false; SIZES]);
            let noise_scale = bundle.noise_scale(&found.state);
            let (information, _) = found.equations.reduced(0.0)?;
            let covariance = information.try_inverse()?;
            let of = |size: usize| {
                let variance = covariance[(SIZE + size, SIZE + size)];
                // The position that is most likely at another value of the length, m per m.
                let position_by_size =
                    Vec3::from_fn(|axis, _| covariance[(axis, SIZE + size)] / variance);
                (variance * noise_scale, position_by_size)
            };
            return fit.fitted(&values, (0..values.len()).map(of));
        }
        state = found.state;
    }
    None
}

/// The variance of a length, m², and how the camera's position goes with it, m per m.
type Known = (f64, Vec3);

/// What does not change from one fit to the next.
struct SizeFit<'a> {
    sized: &'a dyn Fn(&[f64]) -> Option<FieldModel>,
    params: &'a [SizeParam],
    start: &'a SizeStart<'a>,
}

impl SizeFit<'_> {
    /// The field at some size with one length changed by up to [`STEP_M`] within what the rules
    /// allow, and by how much.
    fn changed(&self, values: &[f64], size: usize) -> Option<(FieldModel, f64)> {
        let by_m = if values[size] + STEP_M <= self.params[size].max_m {
            STEP_M
        } else {
            -STEP_M
        };
        let mut changed = values.to_vec();
        changed[size] += by_m;
        Some(((self.sized)(&changed)?, by_m))
    }

    /// The parameters that are free, sizes that are held left out.
    fn free(&self, held: [bool; SIZES]) -> [bool; OF_BASE_AND_SIZE] {
        let mut free = free_parameters(self.start.model);
        for size in 0..self.params.len() {
            free[SIZE + size] = !held[size];
        }
        free
    }

    /// The adjustment with the clicks on a field of some size, and its start: `shared` there.
    fn bundle(
        &self,
        values: &[f64],
        shared: &Shared,
        held: [bool; SIZES],
    ) -> Option<(Bundle<OF_BASE_AND_SIZE>, Shared)> {
        let start = self.start;
        let field = (self.sized)(values)?;
        let changed: Vec<(FieldModel, f64)> = (0..values.len())
            .map(|size| self.changed(values, size))
            .collect::<Option<_>>()?;
        let crown = Crown {
            width_m: field.width_m,
            ..shared.crown
        };
        let mut shared = Shared::new(&shared.base, crown);
        for (size, (larger, by_m)) in changed.iter().enumerate() {
            shared.width_by_size[size] = (larger.width_m - field.width_m) / by_m;
        }
        // Clicks on something that is no part of the field say nothing about its size.
        let on_field = |click: &Observation| {
            let element = click.element?;
            let sized = BaseClick::new(&click.renamed(&field, element)?, field.crown());
            changed
                .iter()
                .enumerate()
                .try_fold(sized, |sized, (size, (larger, by_m))| {
                    let shape = ObservedShape::of_element(larger, element)?
                        .recrowned(larger.crown(), Crown::FLAT);
                    Some(sized.growing(size, &shape, *by_m))
                })
        };
        let solved = start
            .frames
            .iter()
            .zip(start.ptz)
            .filter(|(_, ptz)| ptz.is_some());
        let frames = solved
            .map(|(frame, _)| frame.used().filter_map(on_field).collect())
            .collect();
        let view = UsualView::from_frames(
            start.base,
            &start.ptz.iter().flatten().copied().collect::<Vec<_>>(),
        );
        let mut priors = start
            .options
            .priors
            .of_model(start.model, start.image_width_px, &view);
        priors.extend(
            self.params
                .iter()
                .zip(values)
                .enumerate()
                .map(|(size, (param, value))| SharedPrior {
                    of: Expected::Larger(param.assumed_m - value, size),
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

    /// The sizes with their sigmas: the variances of clicks that scatter, each with how the
    /// position goes with the length, and of landmarks that lie off their places.
    fn fitted(
        &self,
        values: &[f64],
        variances: impl Iterator<Item = Known>,
    ) -> Option<Vec<FittedSize>> {
        let displaced = self.displaced(values)?;
        let known = variances.zip(displaced);
        let of = |((param, value), ((variance, position_by_size), displaced)): (
            (&SizeParam, &f64),
            (Known, f64),
        )| {
            // What is seen leaves a length no less certain than it was before.
            let sigma_m = (variance + displaced).sqrt().min(param.sigma_m);
            (variance.is_finite() && variance > 0.0).then(|| FittedSize {
                name: param.name.clone(),
                assumed_m: param.assumed_m,
                value_m: *value,
                sigma_m,
                position_sigma_m: position_by_size * sigma_m,
                is_open: sigma_m > OPEN_M,
            })
        };
        self.params.iter().zip(values).zip(known).map(of).collect()
    }

    /// The variance of each length, m², because the landmarks and lines that move with it lie off
    /// their places.
    fn displaced(&self, values: &[f64]) -> Option<Vec<f64>> {
        let field = (self.sized)(values)?;
        let clicks = self
            .start
            .frames
            .iter()
            .flat_map(|frame| &frame.observations);
        let mut clicked: Vec<FieldElement> = clicks.filter_map(|click| click.element).collect();
        clicked.sort_unstable();
        clicked.dedup();
        let variance = (USUAL_DISPLACEMENT * field.width_m).powi(2);
        let of = |size: usize| {
            let (changed, by_m) = self.changed(values, size)?;
            let slopes = clicked.iter().filter_map(|&element| {
                let by = nominal_m(&changed, element)? - nominal_m(&field, element)?;
                Some(by.norm_squared() / (by_m * by_m))
            });
            Some(variance / slopes.sum::<f64>().max(f64::MIN_POSITIVE))
        };
        (0..values.len()).map(of).collect()
    }
}
/// Where a landmark is, or the middle of a line, on flat ground, m.
fn nominal_m(field: &FieldModel, element: FieldElement) -> Option<Vec3> {
    Some(match element {
        FieldElement::Landmark(index) => field.landmarks.get(index)?.nominal_m,
        FieldElement::Line(index) => field.lines.get(index)?.curve.point_at(0.5),
        FieldElement::Paint(index) => field.lines.get(index)?.paint_centre.point_at(0.5),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, PtzCamera};
    use crate::field::builtin;
    use crate::geometry::ImageSize;
    use crate::solve::base::{CrownModel, LensModel};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// The sizes that the landmarks seen at some pans say, where the field is assumed as it is.
    fn sizes(pans_deg: &[f64]) -> Vec<FittedSize> {
        let template = builtin("soccer").unwrap();
        let field = template.default_model().unwrap();
        let base = CameraBase::new(
            Vec3::new(-8.0, -64.0, 17.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        );
        let ptz: Vec<Option<Ptz>> = pans_deg
            .iter()
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
                    Observation::of_landmark(&field, landmark.id.as_str(), image, SIZE, number)
                        .unwrap()
                })
            };
            FrameClicks {
                observations: field.landmarks.iter().enumerate().filter_map(of).collect(),
                start: None,
            }
        };
        let frames: Vec<FrameClicks> = ptz.iter().map(seen).collect();
        let params: Vec<SizeParam> = [
            ("length_m", 105.0, 2.5, 90.0, 120.0),
            ("width_m", 68.0, 3.75, 45.0, 90.0),
        ]
        .map(|(name, assumed_m, sigma_m, min_m, max_m)| SizeParam {
            name: name.to_owned(),
            assumed_m,
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
            image_width_px: SIZE.width,
            options: &AdjustOptions::default(),
        };
        fit_field_size(&sized, &params, &start).unwrap()
    }

    #[test]
    fn with_one_end_alone_the_position_is_known_half_as_well_as_the_length() {
        let one_end = sizes(&[42.0, 46.0, 50.0]);
        assert!(one_end[0].sigma_m > 2.4, "{one_end:?}");
        let along = one_end[0].position_sigma_m;
        assert!(
            (along.x - 0.5 * one_end[0].sigma_m).abs() < 0.02 && along.yz().norm() < 0.02,
            "{along}"
        );
    }

    #[test]
    fn with_the_centre_alone_the_length_is_open_and_the_position_is_not() {
        let centre = sizes(&[4.0, 7.0, 10.0]);
        // Nothing is seen that moves with the length: it stays as well known as it was assumed to
        // be.
        assert!(
            (centre[0].sigma_m - 2.5).abs() < 0.1 && centre[0].position_sigma_m.norm() < 0.1,
            "{centre:?}"
        );
    }

    #[test]
    fn with_both_ends_the_length_adds_little_to_the_position() {
        let both = sizes(&[-42.0, -25.0, -8.0, 8.0, 25.0, 42.0]);
        assert!(
            both[0].sigma_m < 0.3 && both[0].position_sigma_m.norm() < 0.15,
            "{both:?}"
        );
    }
}
