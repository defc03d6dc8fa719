//! Nonlinear least squares, without knowing a camera: residuals, robust losses, and damped
//! Gauss–Newton steps over them. Problems elsewhere say what is measured and by which parameters.
//! No start is chosen here.

pub mod dense;
pub mod graduated;
pub mod least_squares;
pub mod loss;
pub mod residual;
