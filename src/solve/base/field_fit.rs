//! The field's length and width from the clicks, where a person asks for it.
//!
//! Both shift landmarks against each other in ways that a camera can nearly imitate, so they are found after the base, with
//! priors at what is assumed and within what the rules allow. Newton's method on the adjusted cost as a function of the one
//! or two numbers, by differences: every evaluation is a bundle adjustment that starts where the last one ended, and any
//! template will do, whatever its expressions.

use super::adjust::adjust_base;
use super::scatter::USUAL_DISPLACEMENT;
use super::{AdjustOptions, BaseModel, FrameClicks};
use crate::camera::{CameraBase, Ptz};
use crate::field::FieldModel;
use crate::solve::{Observation, Target, WorldCurve};
use nalgebra::{DMatrix, DVector};

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
}

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

/// Steps of the differences, m.
const STEP_M: f64 = 0.2;

/// Newton steps at most, and the longest of them, m.
const MAX_STEPS: usize = 6;
const MAX_STEP_M: f64 = 4.0;

/// A shorter step ends the search, m.
const ENOUGH_M: f64 = 0.005;

/// Fits the field's size; `sized` gives the field (crown as in `start`) for values of the parameters in their order. None
/// where nothing is to be fitted, or where the clicks leave it open.
#[must_use]
pub fn fit_field_size(
    sized: &dyn Fn(&[f64]) -> Option<FieldModel>,
    params: &[SizeParam],
    start: &SizeStart<'_>,
) -> Option<Vec<FittedSize>> {
    if params.is_empty() {
        return None;
    }
    let shown: Vec<Vec<Option<Shown>>> = start
        .frames
        .iter()
        .map(|frame| frame.observations.iter().map(|click| Shown::of(click, start.field)).collect())
        .collect();
    let mut search =
        Search { sized, params, start, shown, base: *start.base, ptz: start.ptz.to_vec(), noise_scale: 1.0 };
    let mut values: Vec<f64> = params.iter().map(|param| param.assumed_m.clamp(param.min_m, param.max_m)).collect();
    let mut cost = search.cost(&values, true)?;
    for _ in 0..MAX_STEPS {
        let (gradient, curvature) = search.slopes(&values, cost)?;
        let newton = -curvature.cholesky()?.solve(&gradient);
        let mut step = newton.map(|step| step.clamp(-MAX_STEP_M, MAX_STEP_M));
        let found = (0..5).find_map(|_| {
            let next: Vec<f64> = values
                .iter()
                .zip(step.iter())
                .zip(params)
                .map(|((value, step), param)| (value + step).clamp(param.min_m, param.max_m))
                .collect();
            step *= 0.5;
            search.cost(&next, false).filter(|next_cost| *next_cost <= cost).map(|_| next)
        });
        let Some(next) = found else { break };
        let moved = next.iter().zip(&values).map(|(next, value)| (next - value).abs()).fold(0.0, f64::max);
        cost = search.cost(&next, true)?;
        values = next;
        if moved < ENOUGH_M {
            break;
        }
    }
    let (_, curvature) = search.slopes(&values, cost)?;
    // The cost is a sum of squares: half its curvature is the information.
    let covariance = (curvature * 0.5).try_inverse()? * search.noise_scale;
    let displaced = search.displaced(&values)?;
    let fitted = |(index, param): (usize, &SizeParam)| {
        let variance = covariance[(index, index)] + displaced[index];
        (variance.is_finite() && variance > 0.0).then(|| FittedSize {
            name: param.name.clone(),
            assumed_m: param.assumed_m,
            value_m: values[index],
            sigma_m: variance.sqrt(),
        })
    };
    params.iter().enumerate().map(fitted).collect()
}

/// What a click shows, by its place in the field's lists: the same in a field of another size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Landmark(usize),
    Line(usize),
}

impl Shown {
    fn of(click: &Observation, field: &FieldModel) -> Option<Self> {
        const SAME_PLACE_M: f64 = 1e-6;
        match click.target {
            Target::Landmark(at) => {
                let here = |landmark: &_| (field.landmark_in_world(landmark) - at).norm() < SAME_PLACE_M;
                field.landmarks.iter().position(here).map(Self::Landmark)
            }
            Target::Line(curve) => field.lines.iter().position(|line| line.curve == *curve.nominal()).map(Self::Line),
        }
    }

    fn target(self, field: &FieldModel) -> Option<Target> {
        match self {
            Self::Landmark(index) => {
                field.landmarks.get(index).map(|landmark| Target::Landmark(field.landmark_in_world(landmark)))
            }
            Self::Line(index) => {
                field.lines.get(index).map(|line| Target::Line(WorldCurve::on_field(field, line.curve)))
            }
        }
    }
}

struct Search<'a> {
    sized: &'a dyn Fn(&[f64]) -> Option<FieldModel>,
    params: &'a [SizeParam],
    start: &'a SizeStart<'a>,
    shown: Vec<Vec<Option<Shown>>>,
    base: CameraBase,
    ptz: Vec<Option<Ptz>>,
    noise_scale: f64,
}

impl Search<'_> {
    /// The adjusted cost at a size, the priors included; `keep` takes the adjusted base over as the next start.
    fn cost(&mut self, values: &[f64], keep: bool) -> Option<f64> {
        let field = (self.sized)(values)?;
        let frames: Vec<FrameClicks> = self
            .start
            .frames
            .iter()
            .zip(&self.shown)
            .map(|(frame, shown)| {
                let moved = |(click, shown): (&Observation, &Option<Shown>)| {
                    Some(Observation { target: (*shown)?.target(&field)?, ..*click })
                };
                let observations = frame.observations.iter().zip(shown).filter_map(moved).collect();
                FrameClicks { observations, start: frame.start }
            })
            .collect();
        let (model, options) = (self.start.model, self.start.options);
        let adjusted = adjust_base(&field, &frames, &self.base, &self.ptz, self.start.image_width_px, model, options);
        if keep {
            (self.base, self.ptz, self.noise_scale) = (adjusted.base, adjusted.ptz, adjusted.noise_scale);
        }
        let priors = values.iter().zip(self.params);
        let prior: f64 = priors.map(|(value, param)| ((value - param.assumed_m) / param.sigma_m).powi(2)).sum();
        Some(adjusted.cost + prior).filter(|cost| cost.is_finite())
    }

    /// Gradient and curvature of the cost, by differences.
    fn slopes(&mut self, values: &[f64], cost: f64) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let count = values.len();
        let mut at = |moves: &[(usize, f64)]| {
            let mut moved = values.to_vec();
            for &(index, by) in moves {
                moved[index] += by;
            }
            self.cost(&moved, false)
        };
        let (mut gradient, mut curvature) = (DVector::zeros(count), DMatrix::zeros(count, count));
        let mut forward = vec![0.0; count];
        for index in 0..count {
            let (above, below) = (at(&[(index, STEP_M)])?, at(&[(index, -STEP_M)])?);
            forward[index] = above;
            gradient[index] = (above - below) / (2.0 * STEP_M);
            curvature[(index, index)] = (above - 2.0 * cost + below) / (STEP_M * STEP_M);
        }
        for one in 0..count {
            for two in one + 1..count {
                let both = at(&[(one, STEP_M), (two, STEP_M)])?;
                let mixed = (both - forward[one] - forward[two] + cost) / (STEP_M * STEP_M);
                (curvature[(one, two)], curvature[(two, one)]) = (mixed, mixed);
            }
        }
        Some((gradient, curvature))
    }

    /// The variance of each length, m², because the landmarks that move with it lie off their places.
    fn displaced(&self, values: &[f64]) -> Option<Vec<f64>> {
        let field = (self.sized)(values)?;
        let mut clicked: Vec<usize> = self
            .shown
            .iter()
            .flatten()
            .filter_map(|shown| if let Some(Shown::Landmark(index)) = shown { Some(*index) } else { None })
            .collect();
        clicked.sort_unstable();
        clicked.dedup();
        let variance = (USUAL_DISPLACEMENT * field.width_m).powi(2);
        let of = |index: usize| {
            let mut moved = values.to_vec();
            moved[index] += STEP_M;
            let larger = (self.sized)(&moved)?;
            let slopes = clicked.iter().map(|&landmark| {
                let by = larger.landmarks[landmark].nominal_m - field.landmarks[landmark].nominal_m;
                by.norm_squared() / (STEP_M * STEP_M)
            });
            Some(variance / slopes.sum::<f64>().max(f64::MIN_POSITIVE))
        };
        (0..values.len()).map(of).collect()
    }
}
