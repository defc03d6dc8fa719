//! Lines with a wrong name.
//!
//! The fit is robust, so a line with a wrong name hardly moves the camera that the others
//! determine. Under that camera its points lie far from the line that it names, and near another
//! one of the field. Distances are from the line as it ends on the field: the goal area's side at
//! the left end lies on the same straight line as that at the right end.
//!
//! Where more than a third of the lines are far off, the names may all be of the mirrored field, as
//! when left and right are exchanged: then the picture is solved again with each of the mirrored
//! sets of names. The half turn is not tried. A half turn of names and camera changes nothing in
//! the picture, so no line can tell; the answer is for the names as given.

use super::hypotheses::{FittedPicture, fit_picture};
use super::{FromLinesOptions, LinePicture, names};
use crate::camera::PtzCamera;
use crate::field::{Curve, FieldElement, FieldModel, Symmetry};
use crate::geometry::{ImagePoint, mean};
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::{
    Evidence, IdentityFinding, IdentityKind, Name, Observation, ObservedShape, Rename, WorldCurve,
};

/// A line whose points are farther off on average is in doubt, sigmas of a drawn point.
const FAR_SIGMAS: f64 = 10.0;

/// Another name has to bring them this near on average, sigmas of a drawn point.
const NEAR_SIGMAS: f64 = 4.0;

/// Names may be mirrored where more than this share of the lines is far off.
const MANY_SHARE: f64 = 1.0 / 3.0;

/// Another name for a drawn line.
#[derive(Clone, Debug)]
pub(super) struct NewName {
    /// Indices of the line's observations.
    pub indices: Vec<usize>,
    /// What the line is named.
    named: FieldElement,
    /// The line that its points are on.
    pub element: FieldElement,
    /// The mean distance of its points, as named and with the new name, px.
    pub as_named_px: f64,
    pub renamed_px: f64,
}

/// The mean distance of a line's points from the part of a curve that exists on the field, px;
/// infinite where the camera shows nothing of it.
fn mean_distance_px(camera: &PtzCamera, curve: &WorldCurve, points: &[ImagePoint]) -> f64 {
    // A polyline, because the solver's distance is from the line extended beyond its ends.
    const PIECES: u32 = 48;
    let projected: Vec<ImagePoint> = (0..=PIECES)
        .filter_map(|step| {
            let at = curve.point_at(f64::from(step) / f64::from(PIECES));
            camera.image_from_world(at).ok()
        })
        .collect();
    let distances: Vec<f64> = points
        .iter()
        .map(|point| point.distance_from_polyline_px(&projected))
        .collect();
    mean(&distances).unwrap_or(f64::INFINITY)
}

/// The mean distance of a line's points from the line that it names, px; infinite where the camera
/// does not show that.
fn as_named_px(camera: &PtzCamera, line: &DrawnLine) -> f64 {
    mean_distance_px(camera, &line.curve, &line.points)
}

/// Whether so many lines are far from where they are named that the names may be mirrored.
pub(super) fn many_are_far(camera: &PtzCamera, lines: &[DrawnLine]) -> bool {
    let far = lines
        .iter()
        .filter(|line| as_named_px(camera, line) > FAR_SIGMAS * line.sigma_px);
    far.count() as f64 > MANY_SHARE * lines.len() as f64
}

/// Other names for the lines that are far off and lie on another line of the field.
pub(super) fn find_new_names(
    field: &FieldModel,
    camera: &PtzCamera,
    lines: &[DrawnLine],
    observations: &[Observation],
) -> Vec<NewName> {
    let off_px: Vec<f64> = lines.iter().map(|line| as_named_px(camera, line)).collect();
    // A line that is drawn where it is keeps its name; two that are exchanged may swap theirs.
    let taken: Vec<Option<FieldElement>> = lines
        .iter()
        .zip(&off_px)
        .filter(|(line, off_px)| **off_px <= FAR_SIGMAS * line.sigma_px)
        .map(|(line, _)| named_element(line, observations))
        .collect();
    let mut found = Vec::new();
    for (line, as_named_px) in lines.iter().zip(&off_px) {
        let Some(element) =
            named_element(line, observations).filter(|_| *as_named_px > FAR_SIGMAS * line.sigma_px)
        else {
            continue;
        };
        // The nearest line of the same kind that no other drawn line has.
        let fitting = element
            .alike(field)
            .filter(|other| *other != element && !taken.contains(&Some(*other)))
            .filter_map(|other| {
                let ObservedShape::Curve(curve) = ObservedShape::from_element(field, other)? else {
                    return None;
                };
                let same_kind = matches!(curve.nominal(), Curve::Arc { .. })
                    == matches!(line.curve.nominal(), Curve::Arc { .. });
                let renamed_px = mean_distance_px(camera, &curve, &line.points);
                (same_kind && renamed_px < NEAR_SIGMAS * line.sigma_px)
                    .then_some((other, renamed_px))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((other, renamed_px)) = fitting {
            found.push(NewName {
                indices: line.indices.clone(),
                named: element,
                element: other,
                as_named_px: *as_named_px,
                renamed_px,
            });
        }
    }
    found
}

/// What a drawn line is named.
fn named_element(line: &DrawnLine, observations: &[Observation]) -> Option<FieldElement> {
    // Lines are grouped from observations, so each has at least one.
    observations[line.indices[0]].element
}

/// The observations with a line's new name; none if the field has no such line.
pub(super) fn rename(
    field: &FieldModel,
    observations: &[Observation],
    names: &[NewName],
) -> Option<Vec<Observation>> {
    let mut renamed = observations.to_vec();
    for name in names {
        for &index in &name.indices {
            renamed[index] = renamed[index].with_element(field, name.element)?;
        }
    }
    Some(renamed)
}

/// All observations with the names of the mirrored field; none where the field is not symmetric.
pub(super) fn mirror(
    field: &FieldModel,
    observations: &[Observation],
    symmetry: Symmetry,
) -> Option<Vec<Observation>> {
    observations
        .iter()
        .map(|observation| {
            observation.with_element(field, observation.element?.twin(symmetry, field)?)
        })
        .collect()
}

/// What is wrong with names that are exchanged for new ones.
pub(super) fn kind_of(names: &[NewName]) -> IdentityKind {
    match names {
        [one, other] if one.named == other.element && other.named == one.element => {
            IdentityKind::Swapped
        }
        _ => IdentityKind::WrongName,
    }
}

/// The renames that lead from some observations to others of the same clicks.
pub(super) fn renames(field: &FieldModel, from: &[Observation], to: &[Observation]) -> Vec<Rename> {
    from.iter()
        .zip(to)
        .filter(|(before, after)| before.element != after.element)
        .filter_map(|(_, after)| {
            let element = after.element?;
            Some(Rename {
                click: after.click,
                name: Name::from_element(element, field)?,
                label: element.label(field)?.to_owned(),
            })
        })
        .collect()
}

/// The mirrored sets of names that are tried.
const MIRRORS: [Symmetry; 2] = [Symmetry::MirrorX, Symmetry::MirrorY];

/// A mirrored set of names has to lower the cost by this amount, and to this fraction.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// New names for single lines may raise the cost by this amount: a line that is extended to where
/// another one lies fits as well.
const MAX_RISE: f64 = 4.0;

/// A picture fitted under other names.
struct Renamed {
    fitted: FittedPicture,
    finding: IdentityFinding,
}

/// The better one of a fitted picture and the same under other names, with what was wrong.
pub(super) fn correct_names(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: FittedPicture,
    options: &FromLinesOptions,
) -> (FittedPicture, Option<IdentityFinding>) {
    // Single names first, because they change less.
    let better = rename_lines(picture, used, &as_named, options)
        .or_else(|| mirror_names(picture, used, &as_named, options));
    match better {
        Some(Renamed { fitted, finding }) => (fitted, Some(finding)),
        None => (as_named, None),
    }
}

/// New names for the lines that lie on other lines of the field.
fn rename_lines(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: &FittedPicture,
    options: &FromLinesOptions,
) -> Option<Renamed> {
    let camera = as_named.found.state.camera();
    let new_names = names::find_new_names(picture.field, &camera, &as_named.lines, used);
    if new_names.is_empty() {
        return None;
    }
    // The picture is solved again from the beginning, because the starts depend on the names.
    let observations = names::rename(picture.field, used, &new_names)?;
    let fitted = fit_picture(picture, &observations, options).ok()?;
    if fitted.found.cost > as_named.found.cost + MAX_RISE {
        return None;
    }
    let as_named_px = new_names.iter().map(|name| name.as_named_px);
    let renamed_px = new_names.iter().map(|name| name.renamed_px);
    let finding = IdentityFinding {
        kind: names::kind_of(&new_names),
        evidence: Evidence::Clicks,
        renames: names::renames(picture.field, used, &observations),
        ptz: fitted.found.state.ptz,
        as_named_px: as_named_px.fold(0.0, f64::max),
        renamed_px: renamed_px.fold(0.0, f64::max),
    };
    Some(Renamed { fitted, finding })
}

/// All names of the mirrored field, where many lines are far from where they are named.
fn mirror_names(
    picture: &LinePicture<'_>,
    used: &[Observation],
    as_named: &FittedPicture,
    options: &FromLinesOptions,
) -> Option<Renamed> {
    if !names::many_are_far(&as_named.found.state.camera(), &as_named.lines) {
        return None;
    }
    // Both conditions at once: the smaller limit is the stricter one.
    let cost = as_named.found.cost;
    let limit = (MAX_SHARE * cost).min(cost - MIN_GAIN);
    let mut best: Option<Renamed> = None;
    for symmetry in MIRRORS {
        let Some(observations) = names::mirror(picture.field, used, symmetry) else {
            continue;
        };
        let Ok(fitted) = fit_picture(picture, &observations, options) else {
            continue;
        };
        let lowest = best.as_ref().map_or(limit, |best| best.fitted.found.cost);
        if fitted.found.cost < lowest {
            let finding = IdentityFinding {
                kind: IdentityKind::Mirrored(symmetry),
                evidence: Evidence::Clicks,
                renames: names::renames(picture.field, used, &observations),
                ptz: fitted.found.state.ptz,
                as_named_px: as_named.median_px(),
                renamed_px: fitted.median_px(),
            };
            best = Some(Renamed { fitted, finding });
        }
    }
    best
}
