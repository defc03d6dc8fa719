//! A check of a residual's Jacobian, for the tests of whoever writes one.

use crate::solve::Residual;
use nalgebra::SVector;
use thiserror::Error;

/// Half the difference between the states that are compared, in the unit of the parameter.
const STEP: f64 = 1e-6;
/// Largest error of a derivative, relative to 1 + its own size.
const TOLERANCE: f64 = 2e-5;

/// How a residual's derivatives are wrong.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DerivativeError {
    /// The residual has no value at the state, or beside it.
    #[error("the residual has no value at the state or beside it")]
    NoValue,
    /// The value that comes with the Jacobian is not the residual's.
    #[error("the linearised value is {linearised:?}, the residual's is {value:?}")]
    Value {
        /// With the Jacobian.
        linearised: Vec<f64>,
        /// By itself.
        value: Vec<f64>,
    },
    /// A column of the Jacobian is not the central difference.
    #[error("by {group} parameter {parameter}: {analytic:?}, by differences {numeric:?}")]
    Column {
        /// "shared" or "own".
        group: &'static str,
        /// Which of the group, from 0.
        parameter: usize,
        /// In the Jacobian.
        analytic: Vec<f64>,
        /// The central difference.
        numeric: Vec<f64>,
    },
}

/// Compares a residual's Jacobian with central differences, parameter by parameter. `stepped` gives
/// the state after a step of the shared and of the block's own parameters.
///
/// # Errors
/// The first derivative that is wrong, or a value that is missing or not the same.
pub fn check_derivatives<const ROWS: usize, const SHARED: usize, const OWN: usize, R>(
    residual: &R,
    stepped: impl Fn(&SVector<f64, SHARED>, &SVector<f64, OWN>) -> R::State,
) -> Result<(), DerivativeError>
where
    R: Residual<ROWS, SHARED, OWN>,
{
    let value_after = |shared: &SVector<f64, SHARED>, own: &SVector<f64, OWN>| {
        residual
            .value(&stepped(shared, own))
            .ok_or(DerivativeError::NoValue)
    };
    // The value comes twice, alone and with the Jacobian; both have to be the same to the bit.
    let (no_shared, no_own) = (SVector::zeros(), SVector::zeros());
    let here = stepped(&no_shared, &no_own);
    let linearised = residual.linearise(&here).ok_or(DerivativeError::NoValue)?;
    let value = value_after(&no_shared, &no_own)?;
    if linearised.value != value {
        return Err(DerivativeError::Value {
            linearised: linearised.value.as_slice().to_vec(),
            value: value.as_slice().to_vec(),
        });
    }
    for parameter in 0..SHARED {
        let step = step_along(parameter);
        let difference = value_after(&step, &no_own)? - value_after(&-step, &no_own)?;
        let analytic = linearised.by_shared.column(parameter).into_owned();
        check_column("shared", parameter, &analytic, &(difference / (2.0 * STEP)))?;
    }
    for parameter in 0..OWN {
        let step = step_along(parameter);
        let difference = value_after(&no_shared, &step)? - value_after(&no_shared, &-step)?;
        let analytic = linearised.by_own.column(parameter).into_owned();
        check_column("own", parameter, &analytic, &(difference / (2.0 * STEP)))?;
    }
    Ok(())
}

/// A step of [`STEP`] of one parameter.
fn step_along<const SIZE: usize>(parameter: usize) -> SVector<f64, SIZE> {
    let mut step = SVector::zeros();
    step[parameter] = STEP;
    step
}

fn check_column<const ROWS: usize>(
    group: &'static str,
    parameter: usize,
    analytic: &SVector<f64, ROWS>,
    numeric: &SVector<f64, ROWS>,
) -> Result<(), DerivativeError> {
    // A NaN compares as wrong.
    if (analytic - numeric).norm() < TOLERANCE * (1.0 + numeric.norm()) {
        return Ok(());
    }
    Err(DerivativeError::Column {
        group,
        parameter,
        analytic: analytic.as_slice().to_vec(),
        numeric: numeric.as_slice().to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Linearised;
    use nalgebra::{Matrix1, Vector1};

    /// The square of a number, with a derivative that is `factor` times the right one.
    struct Square {
        factor: f64,
    }

    impl Residual<1, 0, 1> for Square {
        type State = f64;

        fn sigma(&self) -> f64 {
            1.0
        }

        fn value(&self, at: &f64) -> Option<Vector1<f64>> {
            (*at >= 0.0).then(|| Vector1::new(at * at))
        }

        fn linearise(&self, at: &f64) -> Option<Linearised<1, 0, 1>> {
            Some(Linearised {
                value: self.value(at)?,
                by_shared: nalgebra::SMatrix::zeros(),
                by_own: Matrix1::new(self.factor * 2.0 * at),
            })
        }
    }

    #[test]
    fn a_wrong_derivative_is_named_and_a_right_one_passes() {
        let at_3 = |_: &SVector<f64, 0>, step: &Vector1<f64>| 3.0 + step.x;
        assert_eq!(check_derivatives(&Square { factor: 1.0 }, at_3), Ok(()));
        let wrong = check_derivatives(&Square { factor: 1.001 }, at_3).unwrap_err();
        assert!(
            matches!(
                wrong,
                DerivativeError::Column {
                    group: "own",
                    parameter: 0,
                    ..
                }
            ),
            "{wrong}"
        );
        let at_the_edge = |_: &SVector<f64, 0>, step: &Vector1<f64>| step.x;
        assert_eq!(
            check_derivatives(&Square { factor: 1.0 }, at_the_edge),
            Err(DerivativeError::NoValue)
        );
    }
}
