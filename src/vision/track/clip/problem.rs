//! The least-squares problem of a clip: every point is one direction, seen by all frames that show it.

use super::anchor::{Anchor, moved};
use super::camera::KNOWN_FOCAL_SIGMA;
use super::equations::{ClipEquations, ClipStep, PointEquations};
use nalgebra::{Matrix2x3, Matrix3x2};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};
use touchline_core::solve::{Loss, Problem};

/// A point as the frames show it: frames by their rows.
pub(super) struct Seen {
    pub sightings: Vec<(usize, ImagePoint)>,
}

/// The problem; a row is a frame that takes part.
pub(super) struct Clip<'a> {
    /// The camera of each row at the origin, so that it sees directions in `base`.
    pub bases: Vec<CameraBase>,
    pub points: &'a [Seen],
    /// The anchors with their rows and the inverse of their covariances.
    pub anchors: Vec<(usize, Anchor, Mat3)>,
    /// The focal length of each row where it is known, px.
    pub known_focal_px: Vec<Option<f64>>,
    /// The first column of each row.
    pub first: &'a [usize],
    /// 1-σ of a followed point in each row, px.
    pub sigma_px: Vec<f64>,
    pub loss: Loss,
}

#[derive(Clone, Debug)]
pub(super) struct ClipState {
    pub ptz: Vec<Ptz>,
    /// Unit, `base`.
    pub directions: Vec<Vec3>,
}

/// Two directions perpendicular to one and to each other.
pub(super) fn across(direction: Vec3) -> Matrix3x2<f64> {
    // The ray never looks straight up or down, so the vertical is never along it.
    let sideways = Vec3::y().cross(&direction).normalize();
    Matrix3x2::from_columns(&[sideways, direction.cross(&sideways)])
}

impl Clip<'_> {
    /// The camera of each row.
    pub fn cameras(&self, ptz: &[Ptz]) -> Vec<PtzCamera> {
        self.bases.iter().zip(ptz).map(|(base, ptz)| PtzCamera::new(*base, *ptz)).collect()
    }

    /// The distance of each sighting from where the state puts it, px, in the points' order; none beyond the lens.
    pub fn residuals<'s>(&'s self, at: &'s ClipState) -> impl Iterator<Item = (usize, Option<Vec2>)> + 's {
        let cameras = self.cameras(&at.ptz);
        self.points.iter().zip(&at.directions).flat_map(move |(point, direction)| {
            let off = |(row, image): &(usize, ImagePoint)| {
                let here = cameras[*row].image_from_direction_jacobian(*direction).ok();
                (*row, here.map(|here| here.point.offset_from(*image)))
            };
            point.sightings.iter().map(off).collect::<Vec<_>>()
        })
    }

    fn point_equations(&self, cameras: &[PtzCamera], point: &Seen, direction: Vec3) -> PointEquations {
        let tangent = across(direction);
        let mut equations = PointEquations::with_room(point.sightings.len());
        for &(row, image) in &point.sightings {
            let precision = self.sigma_px[row].powi(-2);
            let camera = &cameras[row];
            let Ok(here) = camera.image_from_direction_jacobian(direction) else {
                equations.beyond_the_lens(self.loss);
                continue;
            };
            let value = here.point.offset_from(image);
            let mut by_frame: Matrix2x3<f64> = here.by_ptz;
            by_frame.column_mut(2).scale_mut(camera.ptz().focal_px);
            equations.add(row, value, &by_frame, &(here.by_direction * tangent), precision, self.loss);
        }
        equations
    }
}

impl Problem for Clip<'_> {
    type State = ClipState;
    type Equations = ClipEquations;

    fn equations(&self, at: &ClipState) -> ClipEquations {
        let cameras = self.cameras(&at.ptz);
        let points: Vec<PointEquations> = self
            .points
            .par_iter()
            .zip(&at.directions)
            .map(|(point, direction)| self.point_equations(&cameras, point, *direction))
            .collect();
        let mut equations = ClipEquations::new(self.first.to_vec(), points);
        for (row, anchor, information) in &self.anchors {
            equations.add_anchor(*row, &anchor.offset(at.ptz[*row]), information, anchor.loss());
        }
        // A focal length that is known is one more measurement, which outweighs all points and has no loss to escape by.
        let information = Mat3::from_diagonal(&Vec3::new(0.0, 0.0, KNOWN_FOCAL_SIGMA.powi(-2)));
        for (row, known_px) in self.known_focal_px.iter().enumerate() {
            let Some(known_px) = known_px else { continue };
            let offset = Vec3::new(0.0, 0.0, (at.ptz[row].focal_px / known_px).ln());
            equations.add_anchor(row, &offset, &information, Loss::Squared);
        }
        equations
    }

    fn stepped(&self, from: &ClipState, step: &ClipStep) -> ClipState {
        let ptz = from.ptz.iter().zip(&step.frames).map(|(ptz, by)| moved(*ptz, *by)).collect();
        let turned = |(direction, by): (&Vec3, &Vec2)| (direction + across(*direction) * by).normalize();
        ClipState { ptz, directions: from.directions.iter().zip(&step.directions).map(turned).collect() }
    }
}
