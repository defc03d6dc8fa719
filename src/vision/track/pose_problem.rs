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
use nalgebra::{Matrix2x3, Matrix3x2};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3};
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

/// A prior of one frame's camera in a joint adjustment: from user clicks, a forest or the painted
/// lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePrior {
    /// The frame, as an index into the frames that are adjusted.
    pub frame: usize,
    /// The mean.
    pub ptz: Ptz,
    /// The information matrix of (pan rad, tilt rad, ln f), given the base. It may be singular.
    pub information: Mat3,
    /// The robust loss, in multiples of the stated 1-σ.
    pub loss: Loss,
    /// Where it comes from.
    pub source: PriorSource,
}

/// The source of a pose prior; it decides how the prior is treated where everything else
/// contradicts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PriorSource {
    /// User clicks.
    Person,
    /// The painted lines in the frame's picture.
    Paint,
    /// A proposal of a forest: its covariance holds for typical errors, and outliers occur.
    Proposal,
}

impl PriorSource {
    /// The loss of each source. Clicks pull less beyond 2 σ but are never ignored (Huber); paint
    /// and proposals are, if far off (Cauchy).
    const fn loss(self) -> Loss {
        match self {
            Self::Person => Loss::Huber { k: 2.0 },
            Self::Paint | Self::Proposal => Loss::Cauchy { c: 2.0 },
        }
    }
}

impl PosePrior {
    /// A prior with the loss of its source.
    pub const fn new(frame: usize, ptz: Ptz, information: Mat3, source: PriorSource) -> Self {
        Self {
            frame,
            ptz,
            information,
            loss: source.loss(),
            source,
        }
    }

    /// A prior from the covariance of (pan rad, tilt rad, focal length px). A singular covariance
    /// yields a prior without information.
    pub fn from_covariance(frame: usize, ptz: Ptz, covariance: &Mat3, source: PriorSource) -> Self {
        // A covariance without an inverse states that a parameter is exact; its information would
        // be infinite. No information is the safe reading; `adjust_clip` leaves such a prior out.
        let inverse = by_log_focal(covariance, ptz.focal_px).try_inverse();
        let information = inverse.filter(|inverse| inverse.iter().all(|value| value.is_finite()));
        Self::new(frame, ptz, information.unwrap_or_else(Mat3::zeros), source)
    }

    /// Whether the prior has any information.
    pub(super) fn is_informative(&self) -> bool {
        self.information != Mat3::zeros()
    }

    /// The offset of a camera from the mean: (pan rad, tilt rad, ln f).
    pub(super) fn offset(&self, ptz: Ptz) -> Vec3 {
        offset(self.ptz, ptz)
    }

    /// Limits a camera to the confidence region of this prior: `ptz` if it lies within `sigmas`,
    /// else the point at that Mahalanobis distance on the straight line to it. Without information,
    /// the mean.
    pub fn towards(&self, ptz: Ptz, sigmas: f64) -> Ptz {
        // A covariance that could not be inverted has no region; the camera stays at the mean.
        if !self.is_informative() {
            return self.ptz;
        }
        let by = self.offset(ptz);
        // Rounding may leave the information of an uncertain direction slightly negative.
        let far = by.dot(&(self.information * by)).max(0.0).sqrt();
        if far <= sigmas {
            ptz
        } else {
            apply_offset(self.ptz, by * (sigmas / far))
        }
    }
}

/// The difference of two cameras: (pan rad, tilt rad, ln f).
pub(super) fn offset(from: Ptz, to: Ptz) -> Vec3 {
    Vec3::new(
        to.pan.turn_from(from.pan).radians(),
        (to.tilt - from.tilt).radians(),
        (to.focal_px / from.focal_px).ln(),
    )
}

/// A camera moved by (pan rad, tilt rad, ln f).
pub(super) fn apply_offset(ptz: Ptz, by: Vec3) -> Ptz {
    Ptz::new(
        ptz.pan + Angle::from_radians(by.x),
        ptz.tilt + Angle::from_radians(by.y),
        ptz.focal_px * by.z.exp(),
    )
}

/// Converts a covariance of (pan rad, tilt rad, focal length px) to (pan rad, tilt rad, ln f), to
/// first order.
pub(super) fn by_log_focal(covariance: &Mat3, focal_px: f64) -> Mat3 {
    // J Σ Jᵀ, with d ln f = df / f.
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 1.0 / focal_px));
    scale * covariance * scale
}

/// The reverse of [`by_log_focal`].
pub(super) fn by_focal_px(covariance: &Mat3, focal_px: f64) -> Mat3 {
    by_log_focal(covariance, 1.0 / focal_px)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_the_way_to_another_camera_it_stops_at_its_sigma() {
        let sigma = 0.1f64.to_radians();
        let covariance = Mat3::from_diagonal(&Vec3::new(sigma * sigma, sigma * sigma, 25.0));
        let ptz = Ptz::from_degrees(179.95, -10.0, 2000.0);
        let prior = PosePrior::from_covariance(0, ptz, &covariance, PriorSource::Person);
        let near = Ptz::from_degrees(-179.99, -10.0, 2000.0);
        assert_eq!(prior.towards(near, 1.0), near);
        let stopped = prior.towards(Ptz::from_degrees(-179.65, -10.0, 2000.0), 1.0);
        assert!(
            (stopped.pan.turn_from(ptz.pan).degrees() - 0.1).abs() < 1e-9,
            "{stopped:?}"
        );
    }

    #[test]
    fn information_that_rounding_made_negative_gives_a_camera() {
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let information = Mat3::from_diagonal(&Vec3::new(1e6, -1e-9, 1e6));
        let prior = PosePrior::new(0, ptz, information, PriorSource::Person);
        let tilted = Ptz::from_degrees(3.0, -9.0, 2000.0);
        assert_eq!(prior.towards(tilted, 1.0), tilted);
    }

    #[test]
    fn a_covariance_without_an_inverse_says_nothing() {
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let prior = PosePrior::from_covariance(0, ptz, &Mat3::zeros(), PriorSource::Paint);
        assert!(!prior.is_informative());
        assert_eq!(
            prior.towards(Ptz::from_degrees(4.0, -10.0, 2000.0), 1.0),
            ptz
        );
    }
}
