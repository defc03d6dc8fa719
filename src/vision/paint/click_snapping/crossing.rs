//! Where painted lines cross: the least-squares problem over the ridges of each line.
//!
//! The camera predicts each line's direction within a few degrees, and its position hardly at all.
//! The unknowns are the landmark's shift t from the placed point, and for each line a rotation α
//! and an offset d of its own, both with priors: paint is not quite straight and not quite where
//! the rules put it. At a sample with the unit normal n, at the signed distance s along the line
//! from the landmark, the line's offset is
//!
//! ```text
//! o(t, α, d) = n·t + s α + d
//! ```
//!
//! This is linear in all unknowns, so each step ([`gauss_newton_step`]) is exact but for the
//! pairing: a sample may show several ridges, and the one nearest to its line is chosen anew at
//! each step.
//!
//! [`gauss_newton_step`]: touchline_core::solve::gauss_newton_step

use super::LINE_SIGMA_PX;
use crate::paint::ridges::profile::Ridge;
use nalgebra::{Matrix2, SMatrix, SVector, Vector1};
use touchline_core::geometry::Vec2;
use touchline_core::solve::{BlockEquations, Linearised, Loss, Problem, Residual};

/// 1-σ of a line's direction in the picture, as the camera predicts it, rad.
const DIRECTION_SIGMA: f64 = 0.06;

/// 1-σ of a single ridge's offset, px at 1920 px width.
const RIDGE_SIGMA_PX: f64 = 0.6;

/// Minimum sine of the angle at which two lines cross.
const LEAST_CROSSING: f64 = 0.15;

/// Maximum number of lines that meet at a landmark.
pub(super) const MOST_LINES: usize = 3;

/// Shift of the landmark, then rotation and offset of each line.
const PARAMETERS: usize = 2 + 2 * MOST_LINES;

/// The landmark's shift, px, then the rotation, rad, and the offset, px, of each line.
pub(super) type CrossingState = SVector<f64, PARAMETERS>;

/// A sample of a line at which paint is seen.
pub(super) struct PaintedSample {
    pub normal: Vec2,
    /// Signed distance of the sample from the landmark along the line, px.
    pub along_px: f64,
    pub ridges: Vec<Ridge>,
}

/// What is seen of one line.
pub(super) struct CrossingLine {
    pub places: Vec<PaintedSample>,
    /// Number of samples with ridges, or with open ground and no ridge.
    pub open: usize,
    /// The offset at the landmark that most samples agree on, px.
    pub offset_px: f64,
    /// The line's unit normal at the landmark.
    pub normal: Vec2,
}

impl CrossingLine {
    /// The offset of a sample's ridge that is nearest to `offset_px`.
    pub fn nearest(place: &PaintedSample, offset_px: f64) -> Option<f64> {
        let offsets = place.ridges.iter().map(|ridge| ridge.offset_px);
        offsets.min_by(|a, b| (a - offset_px).abs().total_cmp(&(b - offset_px).abs()))
    }
}

/// The crossing problem under one scale of the robust loss.
pub(super) struct CrossingAtScale<'a> {
    courses: &'a [CrossingLine],
    ridge_sigma_px: f64,
    line_sigma_px: f64,
    loss: Loss,
}

impl<'a> CrossingAtScale<'a> {
    /// `scale` is the width of the picture by 1920 px; the scale of the loss is in px at 1920 px
    /// width, and so is [`RIDGE_SIGMA_PX`]: their quotient, in σ, is the same at all widths.
    pub fn new(courses: &'a [CrossingLine], loss_scale_px: f64, scale: f64) -> Self {
        Self {
            courses,
            ridge_sigma_px: RIDGE_SIGMA_PX * scale,
            line_sigma_px: LINE_SIGMA_PX * scale,
            loss: Loss::GemanMcClure {
                c: loss_scale_px / RIDGE_SIGMA_PX,
            },
        }
    }
}

impl Problem for CrossingAtScale<'_> {
    type State = CrossingState;
    type Equations = BlockEquations<0, PARAMETERS>;

    fn equations(&self, state: &CrossingState) -> BlockEquations<0, PARAMETERS> {
        let mut equations = BlockEquations::zero();
        // Priors on all lines, present or not: they keep the matrix regular. A shift t of the
        // landmark and the offsets n·t of its lines move the paint alike; the priors decide for the
        // shift and leave their 1-σ in its covariance.
        for line in 0..MOST_LINES {
            let sigmas = [DIRECTION_SIGMA, self.line_sigma_px];
            for (parameter, sigma) in (2 + 2 * line..).zip(sigmas) {
                equations.add(&LinePrior { parameter, sigma }, state, self.loss);
            }
        }
        // Each sample of a line contributes the ridge nearest to where the state puts the line.
        for (line, course) in self.courses.iter().enumerate() {
            for place in &course.places {
                let ridge = NearestRidge {
                    place,
                    line,
                    sigma_px: self.ridge_sigma_px,
                };
                equations.add(&ridge, state, self.loss);
            }
        }
        equations
    }

    fn apply_step(&self, from: &CrossingState, step: &CrossingState) -> CrossingState {
        from + step
    }
}

/// Prior of a line's rotation or offset: zero within a 1-σ.
struct LinePrior {
    parameter: usize,
    sigma: f64,
}

impl Residual<1, 0, PARAMETERS> for LinePrior {
    type State = CrossingState;

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, state: &CrossingState) -> Option<Vector1<f64>> {
        Some(Vector1::new(state[self.parameter]))
    }

    fn linearise(&self, state: &CrossingState) -> Option<Linearised<1, 0, PARAMETERS>> {
        let mut by_own = SMatrix::zeros();
        by_own[self.parameter] = 1.0;
        Some(Linearised::without_shared(self.value(state)?, by_own))
    }

    /// Always squared. A robust loss would weaken the prior of a line that is far from it.
    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

/// The residual of one sample: the ridge nearest to where the state puts its line.
struct NearestRidge<'a> {
    place: &'a PaintedSample,
    line: usize,
    sigma_px: f64,
}

impl Residual<1, 0, PARAMETERS> for NearestRidge<'_> {
    type State = CrossingState;

    fn sigma(&self) -> f64 {
        self.sigma_px
    }

    fn value(&self, state: &CrossingState) -> Option<Vector1<f64>> {
        // Predicted less seen.
        Some(Vector1::new(-residual_px(self.place, self.line, state)?))
    }

    fn linearise(&self, state: &CrossingState) -> Option<Linearised<1, 0, PARAMETERS>> {
        let by_own = offset_by_state(self.place, self.line).transpose();
        Some(Linearised::without_shared(self.value(state)?, by_own))
    }
}

/// Where the two lines that cross at the widest angle meet: the solution t of n₁·t = d₁, n₂·t = d₂.
/// None if they are nearly parallel.
pub(super) fn meeting_point(courses: &[CrossingLine]) -> Option<Vec2> {
    // Of three lines the two at the widest angle: their crossing is the best conditioned. The cross
    // product of unit normals is the sine of the angle.
    let pairs = courses
        .iter()
        .enumerate()
        .flat_map(|(index, one)| courses[..index].iter().map(move |other| (one, other)));
    let (sine, one, other) = pairs
        .map(|(one, other)| (one.normal.perp(&other.normal).abs(), one, other))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    if sine < LEAST_CROSSING {
        return None;
    }
    let normals = Matrix2::from_rows(&[one.normal.transpose(), other.normal.transpose()]);
    Some(normals.try_inverse()? * Vec2::new(one.offset_px, other.offset_px))
}

/// Derivative of a line's offset at a sample by the state. The offset is linear, so it is also the
/// row that predicts it.
fn offset_by_state(place: &PaintedSample, line: usize) -> CrossingState {
    let mut by_state = CrossingState::zeros();
    // n·t + s α + d, as in the module's page.
    by_state.fixed_rows_mut::<2>(0).copy_from(&place.normal);
    by_state[2 + 2 * line] = place.along_px;
    by_state[3 + 2 * line] = 1.0;
    by_state
}

/// Signed distance from a line at a sample to the nearest ridge, px.
pub(in crate::paint) fn residual_px(
    place: &PaintedSample,
    line: usize,
    state: &CrossingState,
) -> Option<f64> {
    let expected_px = offset_by_state(place, line).dot(state);
    CrossingLine::nearest(place, expected_px).map(|offset_px| offset_px - expected_px)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::check_derivatives;

    #[test]
    fn residuals_change_with_shift_turn_and_offset_as_their_derivatives_say() {
        let ridges = vec![Ridge {
            offset_px: 2.5,
            width_px: 3.0,
        }];
        let place = PaintedSample {
            normal: Vec2::new(0.6, 0.8),
            along_px: -35.0,
            ridges,
        };
        let state = CrossingState::from_fn(|parameter, _| 0.1 * (parameter as f64 + 1.0));
        for line in 0..MOST_LINES {
            let ridge = NearestRidge {
                place: &place,
                line,
                sigma_px: 0.6,
            };
            check_derivatives(&ridge, |_, step| state + step).expect("ridge");
        }
        for parameter in 2..PARAMETERS {
            check_derivatives(
                &LinePrior {
                    parameter,
                    sigma: 0.35,
                },
                |_, step| state + step,
            )
            .expect("prior");
        }
    }

    #[test]
    fn two_lines_meet_where_their_offsets_say_and_parallel_ones_nowhere() {
        let course = |normal: Vec2, offset_px: f64| CrossingLine {
            places: Vec::new(),
            open: 0,
            offset_px,
            normal,
        };
        let upright = course(Vec2::x(), 3.0);
        let level = course(Vec2::y(), -2.0);
        let aslant = course(Vec2::new(0.99, 0.1).normalize(), 3.0);
        let meeting = meeting_point(&[upright, level]).unwrap();
        assert!((meeting - Vec2::new(3.0, -2.0)).norm() < 1e-12, "{meeting}");
        assert_eq!(meeting_point(&[course(Vec2::x(), 3.0), aslant]), None);
    }
}
