//! The normal equations of a clip: three numbers a frame, two a point; the points are eliminated (Schur complement).

use super::envelope::{CholeskyFactor, Envelope};
use nalgebra::{Matrix2, Matrix2x3, Matrix3x2};
use touchline_core::geometry::{Mat3, Vec2, Vec3};
use touchline_core::solve::{Equations, Loss, NO_VALUE_SIGMAS};

/// What the sightings of one point say.
#[derive(Clone, Debug)]
pub(super) struct PointEquations {
    /// For each frame that shows it: the frame's row, its own block and gradient, and its block with the point's.
    frames: Vec<(usize, Mat3, Vec3, Matrix3x2<f64>)>,
    point: Matrix2<f64>,
    gradient: Vec2,
    cost: f64,
}

impl PointEquations {
    pub fn with_room(sightings: usize) -> Self {
        let frames = Vec::with_capacity(sightings);
        Self { frames, point: Matrix2::zeros(), gradient: Vec2::zeros(), cost: 0.0 }
    }

    pub fn beyond_the_lens(&mut self, loss: Loss) {
        self.cost += loss.of(NO_VALUE_SIGMAS * NO_VALUE_SIGMAS).0;
    }

    /// Adds a sighting: how far off it is, and how that changes.
    pub fn add(
        &mut self,
        row: usize,
        value: Vec2,
        by_frame: &Matrix2x3<f64>,
        by_point: &Matrix2<f64>,
        precision: f64,
        loss: Loss,
    ) {
        let (cost, weight) = loss.of(value.norm_squared() * precision);
        self.cost += cost;
        let frame_weighted = by_frame.transpose() * (weight * precision);
        let point_weighted = by_point.transpose() * (weight * precision);
        self.frames.push((row, frame_weighted * by_frame, frame_weighted * value, frame_weighted * by_point));
        self.point += point_weighted * by_point;
        self.gradient += point_weighted * value;
    }

    /// The inverse of its own block; none where nothing determines the point.
    fn inverse(&self, damping: f64) -> Option<Matrix2<f64>> {
        let mut point = self.point;
        point[(0, 0)] *= 1.0 + damping;
        point[(1, 1)] *= 1.0 + damping;
        point.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()))
    }
}

/// The equations of all frames and points.
#[derive(Clone, Debug)]
pub(super) struct ClipEquations {
    first: Vec<usize>,
    /// The frames' blocks and gradients, of the anchors alone.
    anchors: Vec<(Mat3, Vec3)>,
    points: Vec<PointEquations>,
    cost: f64,
}

/// A change of all frames and points.
pub(super) struct ClipStep {
    /// Pan rad, tilt rad, log of the focal length.
    pub frames: Vec<Vec3>,
    /// Along the two directions across the point's.
    pub directions: Vec<Vec2>,
}

impl ClipEquations {
    pub fn new(first: Vec<usize>, points: Vec<PointEquations>) -> Self {
        let cost = points.iter().map(|point| point.cost).sum();
        let anchors = vec![(Mat3::zeros(), Vec3::zeros()); first.len()];
        Self { first, anchors, points, cost }
    }

    /// Adds what is known of a frame beside its points.
    pub fn add_anchor(&mut self, row: usize, offset: &Vec3, information: &Mat3, loss: Loss) {
        let by_information = information * offset;
        let (cost, weight) = loss.of(offset.dot(&by_information));
        self.cost += cost;
        let (block, gradient) = &mut self.anchors[row];
        *block += information * weight;
        *gradient += by_information * weight;
    }

    /// The frames' equations without the points: a factor and the gradient.
    fn reduced(&self, damping: f64) -> Option<(CholeskyFactor, Vec<Vec3>)> {
        let mut matrix = Envelope::zeros(&self.first);
        let mut gradient: Vec<Vec3> = self.anchors.iter().map(|(_, gradient)| *gradient).collect();
        for (row, (block, _)) in self.anchors.iter().enumerate() {
            *matrix.block_mut(row, row) += block;
        }
        for (row, block, own, _) in self.points.iter().flat_map(|point| &point.frames) {
            *matrix.block_mut(*row, *row) += block;
            gradient[*row] += own;
        }
        for row in 0..matrix.len() {
            let block = matrix.block_mut(row, row);
            for at in 0..3 {
                block[(at, at)] *= 1.0 + damping;
            }
        }
        for point in &self.points {
            let Some(inverse) = point.inverse(damping) else { continue };
            for (place, (row, _, _, cross)) in point.frames.iter().enumerate() {
                let gain = cross * inverse;
                gradient[*row] -= gain * point.gradient;
                for (other, _, _, other_cross) in &point.frames[..=place] {
                    *matrix.block_mut(*row, *other) -= gain * other_cross.transpose();
                }
            }
        }
        Some((matrix.cholesky()?, gradient))
    }

    /// The covariance of each frame's (pan rad, tilt rad, log of the focal length); none where something is left open.
    pub fn covariances(&self) -> Option<Vec<Mat3>> {
        Some(self.reduced(0.0)?.0.diagonal_blocks_of_inverse())
    }
}

impl Equations for ClipEquations {
    type Step = ClipStep;

    fn cost(&self) -> f64 {
        self.cost
    }

    fn step(&self, damping: f64) -> Option<ClipStep> {
        let (factor, gradient) = self.reduced(damping)?;
        let frames: Vec<Vec3> = factor.solve(&gradient).into_iter().map(|step| -step).collect();
        let direction = |point: &PointEquations| {
            let Some(inverse) = point.inverse(damping) else { return Vec2::zeros() };
            let along = point.frames.iter().map(|(row, _, _, cross)| cross.transpose() * frames[*row]);
            -(inverse * (point.gradient + along.sum::<Vec2>()))
        };
        let directions = self.points.iter().map(direction).collect();
        Some(ClipStep { frames, directions })
    }

    fn length(step: &ClipStep) -> f64 {
        step.frames.iter().map(Vec3::norm).fold(0.0, f64::max)
    }
}
