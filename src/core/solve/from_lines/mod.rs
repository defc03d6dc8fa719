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
//! | step | file | proof against |
//! |---|---|---|
//! | 1. Points grouped by line, straight lines fitted | `drawn_line.rs` | coinciding points, lines of one point |
//! | 2. Crossings as landmarks for starts; drawn ends on another line as observations of the field line's end | `crossings.rs` | lines that cross at a shallow angle |
//! | 3. Starts: the homography of the ground lines; two crossings at 124 places around the field; points of two lines where nothing crosses | `starts.rs`, `plane.rs` | any place of the camera, single wrong names |
//! | 4. The best eight that differ are fitted with a wide loss, the best three with a narrow one; the lowest cost wins | `fit.rs` | wrong minima, wrong names |
//! | 5. Priors of place, focal length, lens, roll, principal point | `priors.rs` | views that leave distance and focal length open |
//! | 6. Lines far from where they are named; mirrored names | `names.rs` | names that are exchanged |
//! | 7. Covariance with the scatter of this picture | `uncertainty.rs` | careless drawing |
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

mod crossings;
mod drawn_line;
mod error;
mod fit;
mod names;
mod plane;
mod priors;
mod starts;
#[cfg(test)]
mod tests;
mod uncertainty;

pub use error::FromLinesError;
pub use priors::PicturePriors;

use super::base::CrownModel;
use super::starts::camera_distance;
use super::{Evidence, IdentityFinding, IdentityKind, Loss, Observation, Uncertainty};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{Curve, FieldModel};
use crate::geometry::{ImageSize, Vec3, median};
use drawn_line::DrawnLine;
use fit::{Fitted, PictureFit, PictureState, starting_state};

/// A picture with what was drawn in it.
#[derive(Clone, Copy, Debug)]
pub struct LinePicture<'a> {
    /// The field of the lines.
    pub field: &'a FieldModel,
    /// Points on named lines, and landmarks if there are any; those that are held out are not used.
    pub observations: &'a [Observation],
    /// The size of the picture.
    pub image_size: ImageSize,
}

/// How the camera of a picture is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FromLinesOptions {
    /// What is usual of such cameras.
    pub priors: PicturePriors,
    /// Whether the crown of the pitch is estimated, too, in place of the field's.
    pub fits_crown: bool,
}

/// The camera of one picture.
#[derive(Clone, Debug, PartialEq)]
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
    #[must_use]
    pub fn camera(&self) -> PtzCamera {
        PtzCamera::new(self.base, self.ptz)
    }
}

/// Unknowns that the lines have to determine: position, rotation, focal length.
const NEEDED_EQUATIONS: usize = 7;

/// Equations of a conic: a circle with more points gives no more.
const CONIC_EQUATIONS: usize = 5;

/// The losses of the fit: first wide, so that starts that are off converge; then one under which a
/// line that is twenty sigmas off has little influence.
const FIRST_LOSS: Loss = Loss::Cauchy { c: 6.0 };
const FINAL_LOSS: Loss = Loss::Cauchy { c: 4.0 };

/// The camera of one picture from the lines that were drawn in it.
///
/// # Errors
/// Points that are not finite, too few lines or parallel ones, or lines that no camera explains.
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
    explains_half(&fitted)?;
    let found = uncertainty::state_uncertainty(
        picture,
        &fitted.observations,
        &fitted.found.state,
        options,
    )?;
    Ok(CameraFromLines { identity, ..found })
}

/// Whether all numbers are finite and the lines determine a camera.
fn check_observations(used: &[Observation]) -> Result<(), FromLinesError> {
    let is_bad = |observation: &&Observation| {
        let Observation {
            image, sigma_px, ..
        } = observation;
        let sigma_is_good = sigma_px.is_finite() && *sigma_px > 0.0;
        !(image.is_finite() && sigma_is_good && observation.shape.is_finite())
    };
    if let Some(bad) = used.iter().find(is_bad) {
        return Err(FromLinesError::NotFinite { click: bad.click });
    }
    let lines = DrawnLine::group(used);
    let landmarks = used.len() - lines.iter().map(|line| line.points.len()).sum::<usize>();
    let of_line = |line: &DrawnLine| match line.curve.nominal() {
        Curve::Segment { .. } => line.distinct_points(2),
        Curve::Arc { .. } => line.distinct_points(CONIC_EQUATIONS),
    };
    let equations = 2 * landmarks + lines.iter().map(of_line).sum::<usize>();
    if equations < NEEDED_EQUATIONS {
        return Err(FromLinesError::TooFewLines {
            lines: lines.len() + landmarks,
            equations,
            needed: NEEDED_EQUATIONS,
        });
    }

    // Along parallel lines the camera could be moved without a change in the picture.
    let mut directions = lines
        .iter()
        .map(|line| line.segment().map(|[from, to]| (to - from).normalize()));
    let first = directions.next().flatten();
    let is_parallel = |other: Option<Vec3>| {
        first
            .zip(other)
            .is_some_and(|(one, other): (Vec3, Vec3)| one.cross(&other).norm() < 1e-3)
    };
    if landmarks == 0 && first.is_some() && directions.all(is_parallel) {
        return Err(FromLinesError::Parallel { lines: lines.len() });
    }
    Ok(())
}

/// A fitted picture: the observations of the fit, ends of lines included, and its minimum.
struct FittedPicture {
    lines: Vec<DrawnLine>,
    /// The given observations first, in their order.
    observations: Vec<Observation>,
    found: Fitted,
}

/// Starts, and the lowest of the minima that they lead to.
fn fit_picture(
    picture: &LinePicture<'_>,
    used: &[Observation],
    options: &FromLinesOptions,
) -> Result<FittedPicture, FromLinesError> {
    /// Steps of the first fit, and starts that the final one begins from, at most.
    const FIRST_STEPS: usize = 12;
    const FINAL_STARTS: usize = 3;
    const FINAL_STEPS: usize = 60;
    /// Minima of the first fit nearer to each other than this are one.
    const SAME_MINIMUM: f64 = 0.02;
    let lines = DrawnLine::group(used);
    let crossings = crossings::find_crossings(&lines, used);
    let ends = crossings::find_ends(&lines, picture.image_size);
    let few = [starts::few_per_line(&lines, used), ends.clone()].concat();
    let starts = starts::find_starts(picture, &lines, &crossings, &few, &options.priors);
    let observations = [used.to_vec(), ends].concat();

    let fit = |observations: &[Observation], from: PictureState, loss: Loss, steps: usize| {
        let crown = if options.fits_crown {
            CrownModel::Free
        } else {
            CrownModel::Fixed(picture.field.crown_m)
        };
        PictureFit::new(picture, observations, &from, crown, &options.priors, loss)
            .minimum(from, steps)
    };
    let mut first: Vec<Fitted> = starts
        .iter()
        .map(|start| {
            let from = starting_state(picture, start, options);
            fit(&few, from, FIRST_LOSS, FIRST_STEPS)
        })
        .collect();
    first.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut distinct: Vec<Fitted> = Vec::with_capacity(FINAL_STARTS);
    for candidate in first {
        let is_new =
            |other: &Fitted| camera_distance(&other.state.ptz, &candidate.state.ptz) > SAME_MINIMUM;
        if distinct.len() < FINAL_STARTS && distinct.iter().all(is_new) {
            distinct.push(candidate);
        }
    }
    let found = distinct
        .into_iter()
        .map(|candidate| fit(&observations, candidate.state, FINAL_LOSS, FINAL_STEPS))
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .ok_or(FromLinesError::NoFit {
            median_px: f64::INFINITY,
        })?;
    Ok(FittedPicture {
        lines,
        observations: on_fitted_ground(picture, observations, &found),
        found,
    })
}

/// The observations on the ground with the fitted crown.
fn on_fitted_ground(
    picture: &LinePicture<'_>,
    observations: Vec<Observation>,
    found: &Fitted,
) -> Vec<Observation> {
    let (from, to) = (picture.field.crown(), found.state.shared.crown);
    let moved = |observation: Observation| Observation {
        shape: observation.shape.recrowned(from, to),
        ..observation
    };
    observations.into_iter().map(moved).collect()
}

/// Tries other names where lines are far from where they are named; the better fit, with what was
/// wrong.
fn correct_names(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: FittedPicture,
    options: &FromLinesOptions,
) -> (FittedPicture, Option<IdentityFinding>) {
    /// A mirrored set of names has to lower the cost by this amount, and to this fraction.
    const MIN_GAIN: f64 = 25.0;
    const MAX_SHARE: f64 = 0.25;
    /// New names for single lines may raise it by this amount: a line that is extended to where
    /// another one lies fits as well.
    const MAX_RISE: f64 = 4.0;
    let field = picture.field;
    let camera = as_named.found.state.camera();
    let finding =
        |kind, renamed: &[Observation], fitted: &FittedPicture, off_px: [f64; 2]| IdentityFinding {
            kind,
            evidence: Evidence::Clicks,
            renames: names::renames(field, used, renamed),
            ptz: fitted.found.state.ptz,
            as_named_px: off_px[0],
            renamed_px: off_px[1],
        };

    let new_names = names::find_new_names(field, &camera, &as_named.lines, used);
    if let Some(renamed) = names::rename(field, used, &new_names).filter(|_| !new_names.is_empty())
        && let Ok(fitted) = fit_picture(picture, &renamed, options)
        && fitted.found.cost < as_named.found.cost + MAX_RISE
    {
        let off_px = [
            new_names
                .iter()
                .map(|name| name.as_named_px)
                .fold(0.0, f64::max),
            new_names
                .iter()
                .map(|name| name.renamed_px)
                .fold(0.0, f64::max),
        ];
        let found = finding(names::kind_of(&new_names), &renamed, &fitted, off_px);
        return (fitted, Some(found));
    }
    if !names::many_are_far(&camera, &as_named.lines) {
        return (as_named, None);
    }
    let mirrored = names::MIRRORS.into_iter().filter_map(|symmetry| {
        let renamed = names::mirror(field, used, symmetry)?;
        let fitted = fit_picture(picture, &renamed, options).ok()?;
        Some((symmetry, renamed, fitted))
    });
    let best = mirrored.min_by(|a, b| a.2.found.cost.total_cmp(&b.2.found.cost));
    let limit = (MAX_SHARE * as_named.found.cost).min(as_named.found.cost - MIN_GAIN);
    match best {
        Some((symmetry, renamed, fitted)) if fitted.found.cost < limit => {
            let off_px = [&as_named, &fitted].map(|fitted| median_px(fitted).unwrap_or(0.0));
            let kind = IdentityKind::Mirrored(symmetry);
            let found = finding(kind, &renamed, &fitted, off_px);
            (fitted, Some(found))
        }
        _ => (as_named, None),
    }
}

/// The median distance of the points from their lines, px.
fn median_px(fitted: &FittedPicture) -> Option<f64> {
    let camera = fitted.found.state.camera();
    let off_px =
        |observation: &Observation| observation.distance_px(&camera).unwrap_or(f64::INFINITY);
    median(&mut fitted.observations.iter().map(off_px).collect::<Vec<_>>())
}

/// Whether the camera explains at least half of the points.
fn explains_half(fitted: &FittedPicture) -> Result<(), FromLinesError> {
    /// Points farther off are not explained, sigmas of a drawn point.
    const EXPLAINED_SIGMAS: f64 = 12.0;
    let sigma_px = fitted.observations[0].sigma_px;
    match median_px(fitted) {
        Some(median_px) if median_px <= EXPLAINED_SIGMAS * sigma_px => Ok(()),
        found => Err(FromLinesError::NoFit {
            median_px: found.unwrap_or(f64::INFINITY),
        }),
    }
}
