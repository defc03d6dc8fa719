//! The one adjustment of frames whose base is known: pan, tilt and focal length of each, from
//! points that frames show one after the other, from matches of pairs of frames, and from what is
//! known of single frames.
//!
//! A followed point is one direction, which is adjusted with all frames that show it. A match of
//! two frames has no direction of its own: the two see it in directions that should be the same.
//! Frames of a clip share points, frames sampled from a match share matches.

use super::Tie;
use super::pose_equations::{PairResidual, PointEquations, PoseEquations, PoseStep};
use super::pose_prior::{PosePrior, moved};
use super::tie_residual::{MatchJacobian, View};
use nalgebra::{Matrix2x3, Matrix3x2};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};
use touchline_core::solve::{Loss, Problem};

/// How exactly a known focal length is kept, as a share of it: a thousandth of a px is 4e-7 of 2400
/// px, and moves no corner by as much.
pub(super) const KNOWN_FOCAL_SIGMA: f64 = 1e-6;

/// A frame as all frames together see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustedFrame {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px), the base taken as exact.
    pub covariance: Mat3,
}

/// A point as the frames show it: frames by their rows.
pub(super) struct Seen {
    pub sightings: Vec<(usize, ImagePoint)>,
}

/// Matches of pairs of frames, by their rows.
#[derive(Clone, Copy)]
pub(super) struct PairwiseMatches<'a> {
    pub ties: &'a [Tie],
    /// 1-σ of a match, px.
    pub sigma_px: f64,
    pub loss: Loss,
}

/// The problem; a row is a frame that takes part.
pub(super) struct PoseProblem<'a> {
    /// The camera of each row at the origin, so that it sees directions in `base`.
    pub bases: Vec<CameraBase>,
    pub points: &'a [Seen],
    pub matches: Option<PairwiseMatches<'a>>,
    /// What is known of frames; each names its row.
    pub priors: Vec<PosePrior>,
    /// The focal length of each row where it is known, px.
    pub known_focal_px: Vec<Option<f64>>,
    /// The first column of each row.
    pub first: &'a [usize],
    /// 1-σ of a followed point in each row, px.
    pub sigma_px: Vec<f64>,
    pub loss: Loss,
}

#[derive(Clone, Debug)]
pub(super) struct PoseState {
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

impl PoseProblem<'_> {
    /// The camera of each row.
    pub fn cameras(&self, ptz: &[Ptz]) -> Vec<PtzCamera> {
        self.bases
            .iter()
            .zip(ptz)
            .map(|(base, ptz)| PtzCamera::new(*base, *ptz))
            .collect()
    }

    /// The distance of each sighting from where the state puts it, px, in the points' order; none
    /// beyond the lens.
    pub fn residuals<'s>(
        &'s self,
        at: &'s PoseState,
    ) -> impl Iterator<Item = (usize, Option<Vec2>)> + 's {
        let cameras = self.cameras(&at.ptz);
        self.points
            .iter()
            .zip(&at.directions)
            .flat_map(move |(point, direction)| {
                let off = |(row, image): &(usize, ImagePoint)| {
                    let here = cameras[*row].image_from_direction_jacobian(*direction).ok();
                    (*row, here.map(|here| here.point.offset_from(*image)))
                };
                point.sightings.iter().map(off).collect::<Vec<_>>()
            })
    }

    fn add_matches(
        &self,
        matches: &PairwiseMatches<'_>,
        at: &PoseState,
        equations: &mut PoseEquations,
    ) {
        let views: Vec<View> = self
            .bases
            .iter()
            .zip(&at.ptz)
            .map(|(base, ptz)| View::of_camera(base, *ptz))
            .collect();
        for tie in matches.ties {
            let rows = [tie.first, tie.second];
            let (views, lenses) = (
                rows.map(|row| &views[row]),
                rows.map(|row| &self.bases[row].distortion),
            );
            for &(first, second) in &tie.matches {
                let Some(seen) = MatchJacobian::new(views, lenses, [first, second]) else {
                    equations.add_without_value(matches.loss);
                    continue;
                };
                let by_frame = seen
                    .by_frame
                    .map(|by| Mat3::from_columns(&[by.pan, by.tilt, by.log_focal]));
                let precision = matches.sigma_px.powi(-2);
                equations.add_pair(
                    &PairResidual {
                        value: seen.value_px,
                        rows,
                        by_frame,
                        precision,
                    },
                    matches.loss,
                );
            }
        }
    }

    fn point_equations(
        &self,
        cameras: &[PtzCamera],
        point: &Seen,
        direction: Vec3,
    ) -> PointEquations {
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
            equations.add(
                row,
                value,
                &by_frame,
                &(here.by_direction * tangent),
                precision,
                self.loss,
            );
        }
        equations
    }
}

impl Problem for PoseProblem<'_> {
    type State = PoseState;
    type Equations = PoseEquations;

    fn equations(&self, at: &PoseState) -> PoseEquations {
        let cameras = self.cameras(&at.ptz);
        let points: Vec<PointEquations> = self
            .points
            .par_iter()
            .zip(&at.directions)
            .map(|(point, direction)| self.point_equations(&cameras, point, *direction))
            .collect();
        let mut equations = PoseEquations::new(self.first.to_vec(), points);
        if let Some(matches) = &self.matches {
            self.add_matches(matches, at, &mut equations);
        }
        for prior in &self.priors {
            equations.add_prior(
                prior.frame,
                &prior.offset(at.ptz[prior.frame]),
                &prior.information,
                prior.loss,
            );
        }
        // A focal length that is known is one more measurement, which outweighs all points and has
        // no loss to escape by.
        let information = Mat3::from_diagonal(&Vec3::new(0.0, 0.0, KNOWN_FOCAL_SIGMA.powi(-2)));
        for (row, known_px) in self.known_focal_px.iter().enumerate() {
            let Some(known_px) = known_px else { continue };
            let offset = Vec3::new(0.0, 0.0, (at.ptz[row].focal_px / known_px).ln());
            equations.add_prior(row, &offset, &information, Loss::Squared);
        }
        equations
    }

    fn stepped(&self, from: &PoseState, step: &PoseStep) -> PoseState {
        let ptz = from
            .ptz
            .iter()
            .zip(&step.frames)
            .map(|(ptz, by)| moved(*ptz, *by))
            .collect();
        let turned =
            |(direction, by): (&Vec3, &Vec2)| (direction + across(*direction) * by).normalize();
        PoseState {
            ptz,
            directions: from
                .directions
                .iter()
                .zip(&step.directions)
                .map(turned)
                .collect(),
        }
    }
}
