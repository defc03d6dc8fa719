//! What is known of a tied frame beside its ties.

use super::clip::anchor::offset;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Mat3, Vec3};
use touchline_core::solve::{DenseEquations, Loss};

/// What a frame's own picture says of its camera: as much as it shows, which may leave a direction open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// The frame, by its place among those that are tied.
    pub frame: usize,
    /// Its camera.
    pub ptz: Ptz,
    /// The information on (pan rad, tilt rad, log of the focal length), the base taken as exact.
    pub information: Mat3,
    /// How a contradiction counts, in multiples of the stated 1-σ.
    pub loss: Loss,
}

impl Hold {
    /// Adds it to the equations of frames whose parameters begin at `first`.
    pub(super) fn add(&self, at: Ptz, first: usize, equations: &mut DenseEquations) {
        let eigen = self.information.symmetric_eigen();
        // The root of the information whitens the offset.
        let root =
            Mat3::from_fn(|row, column| eigen.eigenvalues[row].max(0.0).sqrt() * eigen.eigenvectors[(column, row)]);
        let value: Vec3 = root * offset(self.ptz, at);
        let by: [(usize, Vec3); 3] = std::array::from_fn(|axis| (first + axis, root.column(axis).into_owned()));
        equations.add(&value, 1.0, &by, self.loss);
    }
}
