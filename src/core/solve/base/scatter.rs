//! The covariance of the shared parameters when click errors are not independent.
//!
//! Users misplace a landmark in the same way in every frame, because lines are wide and pitches are
//! not painted to the centimetre. The inverse of the normal equations assumes independent errors
//! and is too small, the more so the more frames there are. So each landmark and line is assumed to
//! be displaced on the ground by a random vector common to all frames, with 1-σ τ in each
//! direction. For the clicks on a landmark, a displacement of the landmark is equivalent to an
//! opposite displacement of the camera, so the blocks of the normal equations suffice. H is the
//! normal matrix of the shared parameters after elimination of every frame's own; `N_l` and `s_l`
//! are the contributions of the clicks on landmark l to the information and the gradient of the
//! camera's x and y; `G_l` is their contribution to the columns of H for x and y:
//!
//! - the expectation of Q = Σ `s_l`ᵀ `N_l`⁻¹ `s_l` is the part of click noise s² plus τ² Σ tr
//!   `N_l`. Solving for τ² gives its moment estimator (as for random effects), which is shrunk
//!   towards the value of real pitches where there are few clicks;
//! - covariance: s² H⁻¹ + τ² H⁻¹ (Σ `G_l` `G_l`ᵀ) H⁻¹.

use crate::field::FieldElement;
use crate::solve::optimiser::least_squares::BlockEquations;
use nalgebra::{Matrix2, SMatrix, Vector2};

/// Usual displacement of landmarks as clicked, 1-σ in each direction, as a fraction of the field's
/// width: 6 cm on a soccer pitch.
const USUAL_DISPLACEMENT: f64 = 0.06 / 68.0;

/// The usual displacement of landmarks and lines on a field of this width, m.
pub fn usual_displacement_m(width_m: f64) -> f64 {
    USUAL_DISPLACEMENT * width_m
}

/// The weight of the usual displacement in the estimate, as a number of landmark directions.
const USUAL_WEIGHT: f64 = 6.0;

/// Sums over all clicks on one landmark or line.
#[derive(Clone, Debug)]
struct ElementSums<const SHARED: usize> {
    /// None for a single click on something that is not an element of the field.
    element: Option<FieldElement>,
    /// `G_l`.
    mixed: SMatrix<f64, SHARED, 2>,
    /// `N_l`.
    information: Matrix2<f64>,
    /// `s_l`.
    score: Vector2<f64>,
}

/// The clicks of an adjustment, grouped by landmark or line.
#[derive(Clone, Debug, Default)]
pub(super) struct Scatter<const SHARED: usize> {
    shown: Vec<ElementSums<SHARED>>,
    equations: usize,
    frames: usize,
    squares: f64,
}

impl<const SHARED: usize> Scatter<SHARED> {
    /// Adds a frame: its normal equations, and for each of its clicks the element, the number of
    /// equations and the click's own normal equations.
    pub fn add_frame(
        &mut self,
        frame: &BlockEquations<SHARED, 3>,
        clicks: impl Iterator<Item = (Option<FieldElement>, usize, BlockEquations<SHARED, 3>)>,
    ) {
        let Some(inverse) = frame.own_inverse() else {
            return;
        };
        // Eliminates the frame's own parameters (Schur complement).
        let gain = frame.cross * inverse;
        self.frames += 1;
        for (element, equations, block) in clicks {
            self.equations += equations;
            self.squares += block.squares;
            // The columns for x and y, with the frame's own parameters eliminated.
            let mixed = block.shared.fixed_columns::<2>(0)
                - gain * block.cross.fixed_rows::<2>(0).transpose();
            let information = block.shared.fixed_view::<2, 2>(0, 0).into_owned();
            let score = block.shared_gradient.fixed_rows::<2>(0).into_owned();
            match self
                .shown
                .iter_mut()
                .find(|known| element.is_some() && known.element == element)
            {
                Some(known) => {
                    known.mixed += mixed;
                    known.information += information;
                    known.score += score;
                }
                None => self.shown.push(ElementSums {
                    element,
                    mixed,
                    information,
                    score,
                }),
            }
        }
    }

    /// The covariance of the shared parameters, `free` of which are free, given the inverse of
    /// their normal equations and the ratio of the click variance to the stated one. `width_m` is
    /// the field's width.
    pub fn covariance(
        &self,
        inverse: &SMatrix<f64, SHARED, SHARED>,
        noise_scale: f64,
        free: usize,
        width_m: f64,
    ) -> SMatrix<f64, SHARED, SHARED> {
        // Σ G Gᵀ: each element's displacement is independent of the others', and common to all of
        // its clicks.
        let together: SMatrix<f64, SHARED, SHARED> = self
            .shown
            .iter()
            .map(|shown| shown.mixed * shown.mixed.transpose())
            .sum();
        let tau_squared = self.displacement_squared(free, usual_displacement_m(width_m).powi(2));
        inverse * noise_scale + inverse * together * inverse * tau_squared
    }

    /// τ², m²; `usual` is that of other pitches, m².
    fn displacement_squared(&self, free: usize, usual: f64) -> f64 {
        // Each observable direction of a displacement of a landmark or line: its information (an
        // eigenvalue of `N_l`) and its part of Q. A line has only one, across it.
        let mut directions: Vec<(f64, f64)> = Vec::with_capacity(2 * self.shown.len());
        for shown in &self.shown {
            let eigen = shown.information.symmetric_eigen();
            let least = 1e-6 * eigen.eigenvalues.max();
            for (value, axis) in eigen
                .eigenvalues
                .iter()
                .zip(eigen.eigenvectors.column_iter())
            {
                if *value > least {
                    directions.push((*value, axis.dot(&shown.score).powi(2) / value));
                }
            }
        }
        let (count, equations) = (directions.len() as f64, self.equations as f64);
        let q: f64 = directions.iter().map(|direction| direction.1).sum();
        let information: f64 = directions.iter().map(|direction| direction.0).sum();
        // The fitted parameters absorb part of the residuals: each frame three equations, the
        // shared parameters `free` of the directions.
        let left_by_frames = 1.0 - 3.0 * self.frames as f64 / equations;
        let left_by_shared = 1.0 - free as f64 / count;
        if !(left_by_frames > 0.0 && left_by_shared > 0.0 && equations > count) {
            return usual;
        }

        // Residuals beyond those of the directions are click noise s². τ² is the excess of Q over
        // it.
        let noise =
            ((self.squares - q) / (left_by_frames * (equations - count))).max(f64::MIN_POSITIVE);
        let found = (q / (left_by_frames * left_by_shared) - noise * count) / information;

        // Shrink towards the usual value. A direction counts fully where a usual displacement
        // exceeds its noise, and hardly where noise hides it.
        let weight: f64 = directions
            .iter()
            .map(|(value, _)| (usual / (usual + noise / value)).powi(2))
            .sum();
        let weight = weight * left_by_shared;
        (USUAL_WEIGHT * usual + weight * found.max(0.0)) / (USUAL_WEIGHT + weight)
    }
}
