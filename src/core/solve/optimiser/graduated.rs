//! Graduated non-convexity: a robust loss whose scale shrinks, one Gauss–Newton step for each
//! scale.
//!
//! A loss that nearly ignores large residuals has many local minima. With a coarse scale there is
//! usually one, and each finer scale starts near the minimum of the previous one (Blake and
//! Zisserman: "Visual Reconstruction", 1987). One step per scale is enough, because the minimum of
//! a coarse scale is not needed exactly.
//!
//! [`minimise`] does not do this: it takes a step only if the cost falls, and costs of two scales
//! cannot be compared. Neither can the costs before and after a step if each residual is assigned
//! to a new nearest element in between.
//!
//! [`minimise`]: super::least_squares::minimise

use super::least_squares::{Equations, Problem};

/// The parameters after one undamped Gauss–Newton step; none where the equations are singular.
#[inline]
pub fn gauss_newton_step<P: Problem>(problem: &P, from: &P::State) -> Option<P::State> {
    let step = problem.equations(from).step(0.0)?;
    Some(problem.apply_step(from, &step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::{BlockEquations, Linearised, Loss, Residual};
    use crate::testing::check_derivatives;
    use nalgebra::{Matrix1x2, SMatrix, SVector, Vector1};

    /// A line y = a + b x through points, some of which are of another line.
    struct Point {
        x: f64,
        y: f64,
    }

    impl Residual<1, 0, 2> for Point {
        type State = SVector<f64, 2>;

        fn sigma(&self) -> f64 {
            0.1
        }

        fn value(&self, at: &Self::State) -> Option<Vector1<f64>> {
            Some(Vector1::new(at[0] + at[1] * self.x - self.y))
        }

        fn linearise(&self, at: &Self::State) -> Option<Linearised<1, 0, 2>> {
            Some(Linearised {
                value: self.value(at)?,
                by_shared: SMatrix::zeros(),
                by_own: Matrix1x2::new(1.0, self.x),
            })
        }
    }

    struct Line<'a> {
        points: &'a [Point],
        loss: Loss,
    }

    impl Problem for Line<'_> {
        type State = SVector<f64, 2>;
        type Equations = BlockEquations<0, 2>;

        fn equations(&self, at: &Self::State) -> BlockEquations<0, 2> {
            let mut equations = BlockEquations::zero();
            for point in self.points {
                equations.add(point, at, self.loss);
            }
            equations
        }

        fn apply_step(&self, from: &Self::State, step: &SVector<f64, 2>) -> Self::State {
            from + step
        }
    }

    /// Two thirds of the points lie on y = 1 + 0.5 x, the others 4 above it.
    fn points() -> Vec<Point> {
        let point = |index: u32| {
            let x = f64::from(index);
            Point {
                x,
                y: 1.0 + 0.5 * x + if index % 3 == 1 { 4.0 } else { 0.0 },
            }
        };
        (0..30).map(point).collect()
    }

    #[test]
    fn one_step_solves_what_is_linear() {
        let points: Vec<Point> = points().into_iter().step_by(3).collect();
        let line = Line {
            points: &points,
            loss: Loss::Squared,
        };
        let found = gauss_newton_step(&line, &SVector::zeros()).unwrap();
        assert!(
            (found - SVector::<f64, 2>::new(1.0, 0.5)).norm() < 1e-12,
            "{found}"
        );
        check_derivatives(&points[2], |_, step| found + step).expect("a point beside a line");
    }

    #[test]
    fn a_loss_whose_scale_shrinks_leaves_the_points_of_another_line() {
        let points = points();
        // Scales in sigmas of 0.1: from ten times the distance of the other line to a twentieth of
        // it.
        let found =
            [400.0, 100.0, 20.0, 10.0, 5.0, 2.0]
                .into_iter()
                .fold(SVector::zeros(), |at, c| {
                    gauss_newton_step(
                        &Line {
                            points: &points,
                            loss: Loss::GemanMcClure { c },
                        },
                        &at,
                    )
                    .unwrap()
                });
        assert!(
            (found - SVector::<f64, 2>::new(1.0, 0.5)).norm() < 0.01,
            "{found}"
        );
    }

    #[test]
    fn what_is_left_open_has_no_step() {
        let line = Line {
            points: &[Point { x: 1.0, y: 2.0 }],
            loss: Loss::Squared,
        };
        assert_eq!(gauss_newton_step(&line, &SVector::zeros()), None);
    }
}
