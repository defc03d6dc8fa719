//! The joint adjustment of frames with a known base: pan, tilt and focal length of each, from
//! points tracked through consecutive frames, from matches between pairs of frames, and from priors
//! of single frames.
//!
//! A tracked point is one direction, which is adjusted with all frames that show it. A match has no
//! direction of its own: its residual is the difference of the directions in which two frames see
//! it. Frames of a clip share points; frames sampled from a match of sport share pairwise matches.

use super::ViewGraphEdge;
use super::edge_residual::{MatchJacobian, View};
use super::pose_equations::{PairResidual, PointEquations, PoseEquations, PoseStep};
use super::pose_prior::{PosePrior, apply_offset};
use nalgebra::{Matrix2x3, Matrix3x2};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};
use touchline_core::solve::{Loss, Problem};

/// 1-σ of a known focal length, relative. A thousandth of a px is 4e-7 of 2400 px; no corner of the
/// picture moves by as much.
pub(super) const KNOWN_FOCAL_SIGMA: f64 = 1e-6;

/// A frame after the joint adjustment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustedFrame {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px), given the base.
    pub covariance: Mat3,
}

/// The observations of a point: row of the frame, and pixel.
pub(super) struct PointObservations {
    pub sightings: Vec<(usize, ImagePoint)>,
}

/// Pairwise matches; `first` and `second` of a [`ViewGraphEdge`] are rows.
#[derive(Clone, Copy)]
pub(super) struct PairwiseMatches<'a> {
    pub edges: &'a [ViewGraphEdge],
    /// 1-σ of a match, px.
    pub sigma_px: f64,
    pub loss: Loss,
}

/// The problem; each frame that takes part is a row.
pub(super) struct PoseProblem<'a> {
    /// The base of each row, at the origin, so that its camera projects directions of `base`.
    pub bases: Vec<CameraBase>,
    pub points: &'a [PointObservations],
    pub matches: Option<PairwiseMatches<'a>>,
    /// Priors of single frames; `frame` of each is a row.
    pub priors: Vec<PosePrior>,
    /// The focal length of each row if it is known, px.
    pub known_focal_px: Vec<Option<f64>>,
    /// The first column of each row's envelope.
    pub first: &'a [usize],
    /// 1-σ of a tracked point in each row, px.
    pub sigma_px: Vec<f64>,
    pub loss: Loss,
}

#[derive(Clone, Debug)]
pub(super) struct PoseState {
    pub ptz: Vec<Ptz>,
    /// Unit, `base`.
    pub directions: Vec<Vec3>,
}

/// An orthonormal basis of the tangent plane of a unit direction.
pub(super) fn across(direction: Vec3) -> Matrix3x2<f64> {
    // y is the vertical of `base`; no ray is vertical, so the cross product does not vanish.
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

    /// The residual of each observation, projected minus observed, px, with its row and in the
    /// order of the points; `None` beyond the fold of the lens.
    pub fn residuals<'s>(
        &'s self,
        at: &'s PoseState,
    ) -> impl Iterator<Item = (usize, Option<Vec2>)> + 's {
        let cameras = self.cameras(&at.ptz);
        self.points
            .iter()
            .zip(&at.directions)
            .flat_map(move |(point, direction)| {
                let offsets = point.sightings.iter().map(|(row, image)| {
                    let here = cameras[*row].image_from_direction_jacobian(*direction).ok();
                    (*row, here.map(|here| here.point.offset_from(*image)))
                });
                offsets.collect::<Vec<_>>()
            })
    }

    /// Adds the residuals of pairwise matches; a match beyond the fold of a lens has none.
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
            .map(|(base, ptz)| View::from_camera(base, *ptz))
            .collect();
        for edge in matches.edges {
            let rows = [edge.first, edge.second];
            let (views, lenses) = (
                rows.map(|row| &views[row]),
                rows.map(|row| &self.bases[row].distortion),
            );
            // One residual per match; its derivatives are columns for (pan, tilt, ln f). The
            // derivatives by the lens are not used: the base is known here.
            let precision = matches.sigma_px.powi(-2);
            for &(first, second) in &edge.matches {
                let Some(seen) = MatchJacobian::new(views, lenses, [first, second]) else {
                    equations.add_without_value(matches.loss);
                    continue;
                };
                let by_frame = seen
                    .by_frame
                    .map(|by| Mat3::from_columns(&[by.pan, by.tilt, by.log_focal]));
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

    /// The part of the normal equations of one tracked point.
    fn point_equations(
        &self,
        cameras: &[PtzCamera],
        point: &PointObservations,
        direction: Vec3,
    ) -> PointEquations {
        // A direction has two degrees of freedom: steps in its tangent plane.
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
            // ∂/∂(ln f) = f ∂/∂f.
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
        // Points are independent of each other and their blocks are the bulk of the work. Results
        // are collected in the order of the points, so sums do not depend on the number of threads.
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
        // A known focal length is one more measurement of ln f. It outweighs all points, and a
        // squared loss keeps it from being rejected.
        let information = Mat3::from_diagonal(&Vec3::new(0.0, 0.0, KNOWN_FOCAL_SIGMA.powi(-2)));
        for (row, known_px) in self.known_focal_px.iter().enumerate() {
            let Some(known_px) = known_px else { continue };
            let offset = Vec3::new(0.0, 0.0, (at.ptz[row].focal_px / known_px).ln());
            equations.add_prior(row, &offset, &information, Loss::Squared);
        }
        equations
    }

    fn apply_step(&self, from: &PoseState, step: &PoseStep) -> PoseState {
        let ptz = from
            .ptz
            .iter()
            .zip(&step.frames)
            .map(|(ptz, by)| apply_offset(*ptz, *by))
            .collect();
        // Move each direction in its tangent plane and project it back to the sphere.
        let directions = from
            .directions
            .iter()
            .zip(&step.directions)
            .map(|(direction, by)| (direction + across(*direction) * by).normalize())
            .collect();
        PoseState { ptz, directions }
    }
}
