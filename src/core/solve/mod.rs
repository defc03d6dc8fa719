//! From observations to parameters, with one problem per file.
//!
//! An [`Observation`] is a click on a landmark or on a line. Clicks, priors and other measurements
//! are [`Residual`]s, and every fit is a [`Problem`]: [`minimise`] iterates to a minimum,
//! [`gauss_newton_step`] takes one step for each scale of a robust loss that shrinks.
//! [`FrameSolution`] is the pan, tilt and focal length of a frame with a known base, with
//! covariance, checks and warnings.
//!
//! | room | subject |
//! |---|---|
//! | `optimiser` | least squares, without knowing a camera |
//! | `observations` | what was seen: clicks on landmarks and lines |
//! | `priors` | what is known before anything was seen |
//! | `initial_cameras` | where a refinement starts |
//! | `outcome` | the result, and how far it is to be trusted |
//! | `frame.rs`, `refine.rs`, `base`, `from_lines` | the problems: one frame, and a camera's base |
//! | `identity` | which name a click has |
//!
//! Frames, signs and units: [`crate::conventions`].

pub mod base;
mod error;
#[cfg(test)]
mod fixtures;
mod frame;
pub mod from_lines;
mod identity;
mod identity_finding;
mod initial_cameras;
mod observations;
mod optimiser;
mod outcome;
mod priors;
mod refine;
mod warning;

pub use error::{ObservationError, SolveError};
pub use frame::solve_frame;
pub use identity_finding::{Evidence, IdentityFinding, IdentityKind, Name, Rename};
pub use initial_cameras::plane_pose::PlanePoseError;
pub use observations::observation::Observation;
pub use observations::shape::{ObservedShape, ShapeJacobian};
pub use observations::world_curve::WorldCurve;
pub use optimiser::least_squares::{Equations, Problem};
pub use optimiser::loss::Loss;
pub use outcome::covariance::{CornerSigma, Uncertainty};
pub use outcome::solution::{Candidate, CheckResult, ClickResidual, FrameSolution};
pub use outcome::verdict::Verdict;
pub use priors::motion_prior::{Motion, MotionPrior, PtzRanges, PtzStep};
pub use priors::prior::{PtzPrior, SolveContext};
pub use refine::{Refined, refine};
pub use warning::{Warning, WarningCode};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    identity::check_identity,
    initial_cameras::one_point::{OnePointError, pan_tilt_from_one_point, pan_tilt_from_one_ray},
    initial_cameras::plane_pose::{PlanePose, pose_from_plane},
    initial_cameras::two_point::{
        MIN_RAY_ANGLE_DEG, MIN_SEPARATION_PX, OneOrTwo, TwoPointError, focal_from_two_rays,
        solve_two_points,
    },
    optimiser::dense::DenseEquations,
    optimiser::graduated::gauss_newton_step,
    optimiser::least_squares::{BlockEquations, Minimum, NO_VALUE_SIGMAS, Stopping, minimise},
    optimiser::residual::{Linearised, Residual},
    outcome::covariance::{
        GroundError, UNSTATED_PX, covariance_in_radians, covariance_of_four_points,
    },
    outcome::verdict::{
        CHECK_MISFIT, GOOD_CORNER_SIGMA_PX, Judgement, RIGHT_PX, judge, probability_right,
    },
    refine::refine_until,
    warning::UnknownWarningCode,
};
