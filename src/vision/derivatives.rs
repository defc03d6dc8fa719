//! The Jacobians of residuals against central differences.

use nalgebra::SVector;
use touchline_core::solve::Residual;

/// Compares the derivatives of a residual with central differences, parameter by parameter.
/// `stepped` gives the state after a step; `what` is named where it fails.
pub fn assert_derivatives<const ROWS: usize, const OWN: usize, R>(
    residual: &R,
    stepped: impl Fn(&SVector<f64, OWN>) -> R::State,
    what: &str,
) where
    R: Residual<ROWS, 0, OWN>,
{
    const H: f64 = 1e-6;
    let here = stepped(&SVector::zeros());
    let linearised = residual.linearised(&here).unwrap();
    assert_eq!(Some(linearised.value), residual.value(&here), "{what}");
    for parameter in 0..OWN {
        let mut step = SVector::<f64, OWN>::zeros();
        step[parameter] = H;
        let [before, after] = [-step, step].map(|step| residual.value(&stepped(&step)).unwrap());
        let numeric = (after - before) / (2.0 * H);
        let error = (linearised.by_own.column(parameter) - numeric).norm();
        assert!(
            error < 2e-5 * (1.0 + numeric.norm()),
            "{what}, parameter {parameter}: not {numeric}"
        );
    }
}
