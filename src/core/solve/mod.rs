//! From observations to parameters, with one problem per file.
//!
//! An [`Observation`] is a click on a landmark or on a line. Clicks, priors and other measurements
//! are [`Residual`]s, and every fit is a [`Problem`]: [`minimise`] iterates to a minimum,
//! [`gauss_newton_step`] takes one step for each scale of a robust loss that shrinks.
//! [`FrameSolution`] is the pan, tilt and focal length of a frame with a known base, with
//! covariance, checks and warnings.
//!
//! Frames, signs and units: [`crate::conventions`].

pub mod base;
mod checks;
mod context;
mod covariance;
mod crossings;
mod dense;
mod derivatives;
mod drawn_line;
mod error;
#[cfg(test)]
mod fixtures;
mod focal_sweep;
mod frame;
pub mod from_lines;
mod graduated;
mod identity;
mod identity_finding;
mod least_squares;
mod line;
mod line_pairs;
mod loss;
mod motion_prior;
mod observation;
mod one_point;
mod plane_pose;
mod prior;
mod ptz_ranges;
mod refine;
mod residual;
mod shape;
mod shared_columns;
mod solution;
mod starts;
mod two_point;
mod verdict;
mod warning;
mod world_curve;

pub use context::SolveContext;
pub use covariance::{CornerSigma, Uncertainty, covariance_in_radians, covariance_of_four_points};
pub use dense::DenseEquations;
pub use derivatives::{DerivativeError, check_derivatives};
pub use error::{ObservationError, SolveError};
pub use frame::solve_frame;
pub use graduated::gauss_newton_step;
pub use identity::check_identity;
pub use identity_finding::{Evidence, IdentityFinding, IdentityKind, Name, Rename};
pub use least_squares::{
    BlockEquations, Equations, Minimum, NO_VALUE_SIGMAS, Problem, Stopping, minimise,
};
pub use loss::Loss;
pub use motion_prior::{Motion, MotionPrior, PtzStep};
pub use observation::Observation;
pub use one_point::{OnePointError, pan_tilt_from_one_point, pan_tilt_from_one_ray};
pub use plane_pose::{PlanePose, PlanePoseError, pose_from_plane};
pub use prior::PtzPrior;
pub use ptz_ranges::PtzRanges;
pub use refine::{Refined, refine, refine_until};
pub use residual::{Linearised, Residual};
pub use shape::{ObservedShape, ShapeJacobian};
pub use solution::{Candidate, CheckResult, ClickResidual, FrameSolution};
pub use two_point::{
    MIN_RAY_ANGLE_DEG, MIN_SEPARATION_PX, OneOrTwo, TwoPointError, focal_from_two_rays,
    solve_two_points,
};
pub use verdict::{CHECK_MISFIT, GOOD_CORNER_SIGMA_PX, Judgement, Verdict, judge};
pub use warning::{UnknownWarningCode, Warning, WarningCode};
pub use world_curve::WorldCurve;
