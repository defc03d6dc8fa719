//! A camera from the lines of one picture: position, rotation, focal length and lens, without a
//! base that is known and without a landmark.
//!
//! # Problem
//!
//! Given: points that people drew on named lines of the field in one picture (straight markings,
//! circle and arcs, posts and crossbar), and landmarks if there are any. Wanted: the camera, and
//! how certain it is. Most labels of this kind are pictures of unknown cameras, each of its own:
//! nothing can be shared between them.
//!
//! # Idea
//!
//! A point on a line gives one equation, wherever along the line it is; there are no
//! correspondences to guess. Seven equations determine a pinhole camera. From a start that is
//! roughly right, least squares over all points do the rest; the start is the difficult part,
//! because parallel lines make many local minima. Where drawn lines cross there is a landmark, and
//! two landmarks and a position give pan, tilt and focal length in closed form. So only the
//! position has to be guessed, and the places around a field are few.
//!
//! # Steps
//!
//! 1. Points are grouped by line, straight lines are fitted, equations counted (`../drawn_line.rs`,). Proof against coinciding points, lines of one point, parallel lines.
//! 2. Crossings are landmarks for starts; a drawn end on another line is an observation of the
//!    field line's end (`../crossings.rs`). Proof against lines that cross at a shallow angle.
//! 3. Starts: the homography of the ground lines, two crossings at 124 places around the field,
//!    points of two lines where nothing crosses (`../line_pairs.rs`,
//!    `starts.rs`, `plane.rs`). Proof against unusual
//!    places and single wrong names.
//! 4. The best eight that differ are fitted with a wide loss, the best three with a narrow one; the
//!    lowest cost wins (`hypotheses.rs`, `fit.rs`). Proof against wrong minima and wrong names.
//! 5. Priors of place, focal length, lens, roll and principal point (`priors.rs`) decide in views
//!    that leave distance and focal length open.
//! 6. Lines far from where they are named get other names, or all of them those of the mirrored
//!    field (`names.rs`).
//! 7. The covariance follows from the scatter of this picture (`uncertainty.rs`). Proof against
//!    careless drawing.
//!
//! # What it is not proof against
//!
//! A field of another size than stated, and half of the lines with wrong names that agree with each
//! other. A half turn of all names gives a camera on the other side.
//!
//! # Figures
//!
//! `tests/benches/lines.md`: 400 broadcast pictures with lines that people drew.
//!
//! # References
//!
//! * J. Theiner, R. Ewerth: "`TVCalib`: Camera Calibration for Sports Field Registration in
//!   Soccer", WACV 2023: the same residuals from segmented lines, by gradient descent from one
//!   start for each side.
//! * R. Hartley, A. Zisserman: "Multiple View Geometry", section 4.1 (step 3).
//! * J. Chen, F. Zhu, J. J. Little: "A Two-point Method for PTZ Camera Calibration in Sports", WACV
//!   2018 (step 3).
//! * F. Magera and others: "A Universal Protocol to Benchmark Camera Calibration for Sports", 2024:
//!   how such cameras are scored.

mod fit;
mod hypotheses;
mod names;
mod plane;
mod priors;
mod starts;
#[cfg(test)]
mod tests;
mod uncertainty;

// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use priors::PicturePriors;

use super::base::CrownModel;
use super::observations::drawn_line::DrawnLine;
use super::observations::observation::landmark_observations;
use super::{IdentityFinding, Observation, Uncertainty};
use crate::camera::{CameraBase, Ptz, PtzCamera, StatedLens};
use crate::field::{Curve, FieldModel};
use crate::geometry::{ImageSize, Vec3, pluralise};
use hypotheses::fit_picture;
use names::correct_names;
use thiserror::Error;

/// A picture with what was drawn in it.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct LinePicture<'a> {
    /// The field of the lines.
    pub field: &'a FieldModel,
    /// Points on named lines, and landmarks if there are any; check clicks are not used.
    pub observations: &'a [Observation],
    /// The size of the picture.
    pub image_size: ImageSize,
    /// The lens as it is stated: a principal point is kept, a distortion is a prior.
    pub lens: StatedLens,
}

/// How the camera of a picture is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct FromLinesOptions {
    /// What is usual of such cameras.
    pub priors: PicturePriors,
    /// Whether the crown of the pitch is estimated, too, in place of the field's.
    pub fits_crown: bool,
}

impl FromLinesOptions {
    /// The crown on a field.
    const fn crown(&self, field: &FieldModel) -> CrownModel {
        if self.fits_crown {
            CrownModel::Free
        } else {
            CrownModel::Fixed(field.crown_m)
        }
    }
}

/// The camera of one picture.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct CameraFromLines {
    /// Its base in the pan gauge: position, lean, lens and principal point, with their joint
    /// uncertainty.
    pub base: CameraBase,
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The height of the crown, m: that of the field, or the estimated one.
    pub crown_m: f64,
    /// The uncertainty of pan, tilt and focal length and of the overlay.
    pub uncertainty: Uncertainty,
    /// The scatter of the drawn points as a multiple of the stated one.
    pub scatter: f64,
    /// Names that fit better than those given, if there are any: the camera is that of the new
    /// names.
    pub identity: Option<IdentityFinding>,
}

impl CameraFromLines {
    /// The camera.
    pub fn camera(&self) -> PtzCamera {
        PtzCamera::new(self.base, self.ptz)
    }
}

/// The camera of one picture from the lines that were drawn in it.
///
/// # Errors
/// Points that are not finite, too few lines or parallel ones, or lines that no camera explains.
#[doc(hidden)]
pub fn camera_from_lines(
    picture: &LinePicture<'_>,
    options: &FromLinesOptions,
) -> Result<CameraFromLines, FromLinesError> {
    let used: Vec<Observation> = picture
        .observations
        .iter()
        .filter(|observation| !observation.check)
        .copied()
        .collect();
    check_observations(&used)?;
    let as_named = fit_picture(picture, &used, options)?;
    let (fitted, identity) = correct_names(picture, &used, as_named, options);
    fitted.check_misfit()?;
    let found = uncertainty::state_uncertainty(
        picture,
        &fitted.observations,
        &fitted.found.state,
        options,
    )?;
    Ok(CameraFromLines { identity, ..found })
}

/// Unknowns that the lines have to determine: position, rotation, focal length.
const NEEDED_EQUATIONS: usize = 7;

/// Equations of a conic: a circle with more points gives no more.
const CONIC_EQUATIONS: usize = 5;

/// Whether all numbers are finite and the lines give enough equations.
///
/// # Errors
/// What is missing.
fn check_observations(used: &[Observation]) -> Result<(), FromLinesError> {
    if let Some(bad) = used.iter().find(|observation| !is_finite(observation)) {
        return Err(FromLinesError::NotFinite { click: bad.click });
    }
    // Counting equations is necessary, not sufficient; what it lets through and still leaves open
    // ends as `Undetermined` where the covariance is computed.
    let lines = DrawnLine::group(used);
    let landmarks = landmark_observations(used).count();
    let equations = 2 * landmarks + lines.iter().map(line_equations).sum::<usize>();
    if equations < NEEDED_EQUATIONS {
        return Err(FromLinesError::TooFewLines {
            lines: lines.len() + landmarks,
            equations,
            needed: NEEDED_EQUATIONS,
        });
    }
    if landmarks == 0 && are_parallel(&lines) {
        return Err(FromLinesError::Parallel { lines: lines.len() });
    }
    Ok(())
}

/// Whether pixel, sigma and shape are finite, and the sigma positive.
fn is_finite(observation: &Observation) -> bool {
    let Observation {
        image,
        sigma_px,
        shape,
        ..
    } = observation;
    image.is_finite() && sigma_px.is_finite() && *sigma_px > 0.0 && shape.is_finite()
}

/// How many equations the points of a line give.
fn line_equations(line: &DrawnLine) -> usize {
    // A straight line in the picture has two parameters, a conic five; further points repeat them.
    match line.curve.nominal() {
        Curve::Segment { .. } => line.distinct_points(2),
        Curve::Arc { .. } => line.distinct_points(CONIC_EQUATIONS),
    }
}

/// Whether all lines are straight and parallel to each other: along them the camera could be moved
/// without a change in the picture.
fn are_parallel(lines: &[DrawnLine]) -> bool {
    /// The sine below which directions are parallel.
    const PARALLEL: f64 = 1e-3;
    // One circle or arc makes this none: it shows where along the lines the camera stands.
    let directions: Option<Vec<Vec3>> = lines
        .iter()
        .map(|line| line.segment().map(|[from, to]| (to - from).normalize()))
        .collect();
    let Some([first, others @ ..]) = directions.as_deref() else {
        return false;
    };
    others
        .iter()
        .all(|other| first.cross(other).norm() < PARALLEL)
}

/// Why the lines of one picture give no camera. Clicks are indices into the picture's
/// observations, from 0; the messages count from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
#[doc(hidden)]
pub enum FromLinesError {
    /// A coordinate of a point or of its line is NaN or infinite, or its sigma is not positive.
    #[error("point {} is not a finite pixel with a positive sigma: place it again", .click + 1)]
    NotFinite {
        /// The click.
        click: usize,
    },
    /// Too few equations for position, rotation and focal length.
    #[error(
        "{} from {}, {needed} are needed: draw more lines (a straight one with two points gives \
         two, a circle one for each point, at most five)",
        pluralise(*.equations, "equation"), pluralise(*.lines, "line")
    )]
    TooFewLines {
        /// Lines, and landmarks, that have points.
        lines: usize,
        /// Equations that they give.
        equations: usize,
        /// Equations that are needed.
        needed: usize,
    },
    /// The lines leave the camera free to move along them.
    #[error(
        "all {lines} lines are parallel on the field: draw one that crosses them, or points on the \
         circle"
    )]
    Parallel {
        /// How many lines there are.
        lines: usize,
    },
    /// No place around the field shows the lines.
    #[error(
        "no place around the field shows these lines: check their names, and the field; draw one \
         more line"
    )]
    NoStart,
    /// The points do not determine all parameters.
    #[error("these lines leave the camera undetermined: draw one more line, away from the others")]
    Undetermined,
    /// The best-fitting camera is below the field.
    #[error(
        "the camera that fits these lines is {depth_m:.1} m below the field: check the names of \
         the lines, left and right, near and far"
    )]
    BelowGround {
        /// How deep, m.
        depth_m: f64,
    },
    /// No camera explains half of the lines.
    #[error(
        "no camera explains the lines: the best one {}. Check the names of the lines, and the \
         field",
        if median_px.is_finite() {
            format!("leaves half of the points more than {median_px:.0} px off")
        } else {
            "does not see half of the points".to_owned()
        }
    )]
    NoFit {
        /// Median distance of the points, px; infinite where most of them have no image.
        median_px: f64,
    },
}
