//! Why a frame cannot be solved, with the numbers.

use crate::geometry::pluralise;
use thiserror::Error;

/// Why a click is not an observation of this field.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ObservationError {
    /// The field model has no landmark of this name.
    #[error("the field {template:?} has no landmark {name:?}; `touchline fields` lists them")]
    UnknownLandmark {
        /// The name as the click gives it.
        name: String,
        /// The field's template.
        template: String,
    },
    /// The field model has no line of this name.
    #[error("the field {template:?} has no line {name:?}; `touchline fields` lists them")]
    UnknownLine {
        /// The name as the click gives it.
        name: String,
        /// The field's template.
        template: String,
    },
}

/// Why a frame has no solution. Clicks are indices into the frame's clicks, from 0; the messages
/// count from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// Too few equations for pan, tilt and focal length, wherever the clicks are.
    #[error(
        "{} for 3 unknowns: a landmark gives two, a point on a line one; click {}",
        pluralise(*.equations, "equation"),
        ["two landmarks", "a landmark"].get(*.equations).unwrap_or(&"one more")
    )]
    TooFewObservations {
        /// Equations that the clicks give.
        equations: usize,
    },
    /// A number of the base is NaN or infinite.
    #[error("the camera base is not finite: enter position and rotation again in the camera panel")]
    BaseNotFinite,
    /// A coordinate of a click or of its shape is NaN or infinite, or its sigma is not positive.
    #[error("point {} is not a finite pixel with a positive sigma: place it again", .click + 1)]
    NotFinite {
        /// The click.
        click: usize,
    },
    /// A click lies outside the picture.
    #[error("point {} at ({x:.1}, {y:.1}) lies outside the {width}×{height} px frame: move it inside", .click + 1)]
    OutsideFrame {
        /// The click.
        click: usize,
        /// Its x, px.
        x: f64,
        /// Its y, px.
        y: f64,
        /// Columns of the frame.
        width: u32,
        /// Rows of the frame.
        height: u32,
    },
    /// All landmark clicks lie at nearly the same pixel, so they do not determine the focal length.
    #[error(
        "the points are {separation_px:.2} px apart, at least {needed_px:.1} px are needed: click one farther away"
    )]
    PointsTooClose {
        /// The largest distance between two of them, px.
        separation_px: f64,
        /// What is needed, px.
        needed_px: f64,
    },
    /// Two landmarks lie on one ray of this camera (or are equal), so no picture can separate them.
    #[error(
        "points {} and {} show landmarks {angle_deg:.4}° apart as this camera sees them, {needed_deg}° are needed: \
         choose other landmarks", .clicks[0] + 1, .clicks[1] + 1
    )]
    SameRay {
        /// The two clicks.
        clicks: [usize; 2],
        /// The angle between the rays, degrees.
        angle_deg: f64,
        /// What is needed, degrees.
        needed_deg: f64,
    },
    /// A landmark at the camera's own position has no direction.
    #[error("point {} shows a landmark {distance_m:.3} m from the camera: check the camera's position", .click + 1)]
    AtCamera {
        /// The click.
        click: usize,
        /// The distance, m.
        distance_m: f64,
    },
    /// No focal length projects the two landmarks to their clicks.
    #[error(
        "no focal length fits points {} and {}: {separation_px:.0} px apart for landmarks {angle_deg:.2}° apart; check \
         their names", .clicks[0] + 1, .clicks[1] + 1
    )]
    NoRealRoot {
        /// The two clicks.
        clicks: [usize; 2],
        /// Their distance, px.
        separation_px: f64,
        /// The angle between the landmarks as the camera sees them, degrees.
        angle_deg: f64,
    },
    /// In every camera that fits the other clicks, this click's landmark or line lies behind the
    /// camera.
    #[error("point {} shows something behind the camera: check its name", .click + 1)]
    BehindCamera {
        /// The click.
        click: usize,
    },
    /// A click lies where the lens model has no image.
    #[error(
        "point {} lies beyond the fold of the lens model (k1 = {k1:.4} at focal length {focal_px:.0} px): check the \
         camera's distortion", .click + 1
    )]
    BeyondFold {
        /// The click.
        click: usize,
        /// The coefficient.
        k1: f64,
        /// The focal length at which it was tried, px.
        focal_px: f64,
    },
    /// The search ended without a camera that fits.
    #[error(
        "no camera in the plausible range fits these {observations} points: check their names and the base"
    )]
    NoFit {
        /// The number of points used.
        observations: usize,
    },
    /// The clicks fit, but do not determine all three parameters.
    #[error(
        "these points leave pan, tilt and focal length undetermined (condition {condition:.1e}): add a landmark that \
         is not on the same line"
    )]
    Undetermined {
        /// Condition number of the normal equations in (rad, rad, log f).
        condition: f64,
    },
}

impl SolveError {
    /// The clicks that the error is about; empty if it is about all of them.
    pub fn clicks(&self) -> &[usize] {
        match self {
            Self::NotFinite { click }
            | Self::OutsideFrame { click, .. }
            | Self::AtCamera { click, .. }
            | Self::BehindCamera { click }
            | Self::BeyondFold { click, .. } => std::slice::from_ref(click),
            Self::SameRay { clicks, .. } | Self::NoRealRoot { clicks, .. } => clicks,
            Self::TooFewObservations { .. }
            | Self::BaseNotFinite
            | Self::PointsTooClose { .. }
            | Self::NoFit { .. }
            | Self::Undetermined { .. } => &[],
        }
    }
}
