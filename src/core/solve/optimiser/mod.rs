//! Nonlinear least squares, without knowing a camera: residuals, robust losses, and damped
//! Gauss–Newton steps over them. Problems elsewhere say what is measured and by which parameters.
//! The check of Jacobians for their tests is here, too. No start is chosen here.

pub mod dense;
pub mod least_squares;
pub mod loss;
