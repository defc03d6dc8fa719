//! Homographies between a plane and its picture.

use super::{Mat3, Vec2, Vec3};
use nalgebra::{SMatrix, SVector, SymmetricEigen};
use thiserror::Error;

/// Minimum second smallest eigenvalue, as a fraction of the largest. Points nearly on one line have
/// a second solution, whose eigenvalue vanishes too.
const MIN_SECOND_EIGENVALUE: f64 = 1e-9;

/// Why point pairs give no homography.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HomographyError {
    /// Fewer than four pairs.
    #[error("{pairs} pairs of points, four are needed")]
    TooFewPairs {
        /// How many there are.
        pairs: usize,
    },
    /// The points lie on one line, or all but one do.
    #[error("the points lie on one line (second eigenvalue {share:.1e} of the largest)")]
    Degenerate {
        /// The second smallest eigenvalue as a share of the largest.
        share: f64,
    },
}

/// The homography that takes `from` to `to`, by the normalised direct linear transform (Hartley and
/// Zisserman, Multiple View Geometry, algorithm 4.2): exact for exact pairs, a start for refinement
/// otherwise.
///
/// # Errors
/// Fewer than four pairs, or points on one line.
pub fn homography(pairs: &[(Vec2, Vec2)]) -> Result<Mat3, HomographyError> {
    if pairs.len() < 4 {
        return Err(HomographyError::TooFewPairs { pairs: pairs.len() });
    }
    // The equations A h = 0 are summed as Aᵀ A, which is 9 × 9 whatever the number of pairs is.
    // This squares their condition number, so both sides are normalised first.
    let from_normal = normalisation(pairs.iter().map(|pair| pair.0));
    let to_normal = normalisation(pairs.iter().map(|pair| pair.1));
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (from, to) in pairs {
        // q × (H p) = 0 gives two independent equations in the nine entries of H.
        let p = from_normal * Vec3::new(from.x, from.y, 1.0);
        let q = to_normal * Vec3::new(to.x, to.y, 1.0);
        let rows = [
            [0.0, 0.0, 0.0, -p.x, -p.y, -1.0, q.y * p.x, q.y * p.y, q.y],
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
        ];
        for row in rows.map(SVector::from) {
            normal += row * row.transpose();
        }
    }

    let h = only_null_vector(&normal, MIN_SECOND_EIGENVALUE)?;

    // Undo the normalisation of both sides: H = T_to⁻¹ H_normalised T_from.
    let normalised = Mat3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    let back = to_normal
        .try_inverse()
        .ok_or(HomographyError::Degenerate { share: 0.0 })?;
    Ok(back * normalised * from_normal)
}

/// The unit vector that solves nine homogeneous equations A h = 0 best: the eigenvector of
/// `normal`, Aᵀ A, with the smallest eigenvalue.
///
/// # Errors
/// The second smallest eigenvalue is at most this share of the largest: there is another solution.
pub(crate) fn only_null_vector(
    normal: &SMatrix<f64, 9, 9>,
    min_second_share: f64,
) -> Result<SVector<f64, 9>, HomographyError> {
    // nalgebra does not sort eigenvalues. A matrix with NaN has a share of NaN, which the
    // comparison below rejects.
    let eigen = SymmetricEigen::new(*normal);
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let share = eigen.eigenvalues[order[1]] / eigen.eigenvalues[order[8]];
    if share > min_second_share {
        Ok(eigen.eigenvectors.column(order[0]).into_owned())
    } else {
        Err(HomographyError::Degenerate { share })
    }
}

/// The similarity that moves the points' centroid to the origin and scales their mean distance to
/// √2, which conditions the equations (Hartley 1997).
fn normalisation(points: impl Iterator<Item = Vec2> + Clone) -> Mat3 {
    let count = points.clone().count() as f64;
    let mean = points.clone().fold(Vec2::zeros(), |sum, point| sum + point) / count;
    let spread = points.map(|point| (point - mean).norm()).sum::<f64>() / count;
    // Coinciding points have no spread; unscaled, they reach the check of the second eigenvalue.
    let scale = if spread > 0.0 {
        std::f64::consts::SQRT_2 / spread
    } else {
        1.0
    };
    Mat3::new(
        scale,
        0.0,
        -scale * mean.x,
        0.0,
        scale,
        -scale * mean.y,
        0.0,
        0.0,
        1.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(h: &Mat3, point: Vec2) -> Vec2 {
        let q = h * Vec3::new(point.x, point.y, 1.0);
        q.xy() / q.z
    }

    #[test]
    fn exact_pairs_come_back() {
        let truth = Mat3::new(12.0, -3.0, 960.0, 0.4, -7.0, 500.0, 1e-4, -4e-3, 1.0);
        let points = [
            [-20.0, 3.0],
            [15.0, -30.0],
            [40.0, 25.0],
            [0.0, 10.0],
            [33.0, -2.0],
        ];
        let pairs: Vec<(Vec2, Vec2)> = points
            .map(|[x, y]| Vec2::new(x, y))
            .map(|point| (point, apply(&truth, point)))
            .to_vec();
        for pairs in [&pairs[..4], &pairs[..]] {
            let found = homography(pairs).unwrap();
            for (from, to) in pairs {
                assert!((apply(&found, *from) - to).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn degenerate_pairs_are_named() {
        let line: Vec<(Vec2, Vec2)> = (0..6)
            .map(f64::from)
            .map(|x| (Vec2::new(x, 2.0 * x), Vec2::new(30.0 * x, 5.0 * x)))
            .collect();
        assert!(matches!(
            homography(&line),
            Err(HomographyError::Degenerate { .. })
        ));
        assert_eq!(
            homography(&line[..3]),
            Err(HomographyError::TooFewPairs { pairs: 3 })
        );
        let same = vec![(Vec2::new(1.0, 1.0), Vec2::new(2.0, 2.0)); 5];
        assert!(matches!(
            homography(&same),
            Err(HomographyError::Degenerate { .. })
        ));
    }
}
