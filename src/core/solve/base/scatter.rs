//! How far the shared parameters are to be trusted when clicks do not err independently.
//!
//! People miss a landmark in the same way in every frame: paint is wide, and grounds are not
//! painted to the centimetre. The inverse of the normal equations knows nothing of that and
//! promises too much, the more frames the more. So each landmark and line is taken to lie off its
//! place on the ground by a displacement that all frames share, each direction of size τ. To its
//! clicks a landmark that lies off is a camera that stands off, so nothing but the normal equations
//! is needed: with H those of the shared parameters after every frame's own are eliminated, `N_l`
//! and `s_l` what the clicks on landmark l contribute to the camera's x and y, and `G_l` how these
//! two mix with all the others:
//!
//! - Q = Σ `s_l`ᵀ `N_l`⁻¹ `s_l` is as large as click noise s² makes it, and larger by τ² Σ tr
//!   `N_l`: that gives τ² (the moment estimator of random effects), drawn towards what real grounds
//!   have where the clicks are too few to tell;
//! - covariance: s² H⁻¹ + τ² H⁻¹ (Σ `G_l` `G_l`ᵀ) H⁻¹.

use crate::field::FieldElement;
use crate::solve::least_squares::BlockEquations;
use nalgebra::{Matrix2, SMatrix, Vector2};

/// How far landmarks lie off their places as people click them, 1-σ in each direction, as a share
/// of the field's width: 6 cm on a soccer pitch.
pub(super) const USUAL_DISPLACEMENT: f64 = 0.06 / 68.0;

/// How many directions of landmarks that is worth.
const USUAL_WEIGHT: f64 = 6.0;

/// What all clicks on one landmark or line have in common.
#[derive(Clone, Debug)]
struct Shown<const SHARED: usize> {
    /// None: a single click on something that is no part of the field.
    element: Option<FieldElement>,
    /// `G_l`.
    mixed: SMatrix<f64, SHARED, 2>,
    /// `N_l`.
    information: Matrix2<f64>,
    /// `s_l`.
    score: Vector2<f64>,
}

/// The clicks of an adjustment, gathered by what they show.
#[derive(Clone, Debug, Default)]
pub(super) struct Scatter<const SHARED: usize> {
    shown: Vec<Shown<SHARED>>,
    equations: usize,
    frames: usize,
    squares: f64,
}

impl<const SHARED: usize> Scatter<SHARED> {
    /// Adds a frame: its equations, and of each of its clicks what it is on, how many equations it
    /// gives, and those.
    pub fn add_frame(
        &mut self,
        frame: &BlockEquations<SHARED, 3>,
        clicks: impl Iterator<Item = (Option<FieldElement>, usize, BlockEquations<SHARED, 3>)>,
    ) {
        let Some(inverse) = frame.own.try_inverse() else {
            return;
        };
        let gain = frame.cross * inverse;
        self.frames += 1;
        for (element, equations, block) in clicks {
            self.equations += equations;
            self.squares += block.squares;
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
                None => self.shown.push(Shown {
                    element,
                    mixed,
                    information,
                    score,
                }),
            }
        }
    }

    /// The covariance of the shared parameters, `free` of which are free, given the inverse of
    /// their normal equations and by how much clicks scatter more than stated. `width_m` is the
    /// field's.
    pub fn covariance(
        &self,
        inverse: &SMatrix<f64, SHARED, SHARED>,
        noise_scale: f64,
        free: usize,
        width_m: f64,
    ) -> SMatrix<f64, SHARED, SHARED> {
        let together: SMatrix<f64, SHARED, SHARED> = self
            .shown
            .iter()
            .map(|shown| shown.mixed * shown.mixed.transpose())
            .sum();
        let tau_squared = self.displacement_squared(free, (USUAL_DISPLACEMENT * width_m).powi(2));
        inverse * noise_scale + inverse * together * inverse * tau_squared
    }

    /// τ², m²; `usual` is what it is elsewhere.
    fn displacement_squared(&self, free: usize, usual: f64) -> f64 {
        // Each direction in which a landmark can be seen to lie off: its information, and its share
        // of Q.
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
        // What frames and shared parameters have already taken up.
        let left_by_frames = 1.0 - 3.0 * self.frames as f64 / equations;
        let left_by_shared = 1.0 - free as f64 / count;
        if !(left_by_frames > 0.0 && left_by_shared > 0.0 && equations > count) {
            return usual;
        }
        let noise =
            ((self.squares - q) / (left_by_frames * (equations - count))).max(f64::MIN_POSITIVE);
        let found = (q / (left_by_frames * left_by_shared) - noise * count) / information;
        let weight: f64 = directions
            .iter()
            .map(|(value, _)| (usual / (usual + noise / value)).powi(2))
            .sum();
        let weight = weight * left_by_shared;
        (USUAL_WEIGHT * usual + weight * found.max(0.0)) / (USUAL_WEIGHT + weight)
    }
}
