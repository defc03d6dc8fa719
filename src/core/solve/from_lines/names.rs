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

use crate::camera::PtzCamera;
use crate::field::{Curve, FieldElement, FieldModel, Symmetry};
use crate::geometry::{ImagePoint, mean};
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::{IdentityKind, Name, Observation, ObservedShape, Rename, WorldCurve};

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
