//! The joint uncertainty of the parameters that all frames of a camera share.
//!
//! Position, rotation, lens, crown of the pitch and principal point are estimated in one
//! adjustment, and their errors compensate each other: a position estimated too far away, for
//! example, comes with a pitch estimated too steep, and the pictures hardly show either error. So
//! the errors have one joint covariance, which is only ever changed as a whole. If the σ of one
//! parameter were raised and its correlations kept, errors that cancelled before would add up.

use super::shared_parameters::{
    BaseCorrelation, GAUGE, SHARED_COLUMNS, SHARED_PARAMETERS, SIZE_COLUMN, SharedCovariance,
    SharedError, place,
};
use super::size_error::SizeError;
use crate::geometry::{Mat3, Vec2, Vec3};
use nalgebra::{DMatrix, Matrix3, SMatrix};
use serde::Serialize;

/// The index of k₁ among the shared parameters ([`super::SHARED_PARAMETERS`]).
const K1: usize = 5;

/// 1-σ of the shared parameters, with their correlations; zero means exactly known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BaseSigma {
    /// Of the position, along world x, y, z, m.
    pub position_m: Vec3,
    /// Of the base rotation, about world x, y, z (z is the pan gauge), rad.
    #[serde(rename = "rotation_rad")]
    pub rotation: Vec3,
    /// Of k₁ at the focal length at which the lens's curve has its value.
    pub k1: f64,
    /// Of the change of k₁ per 1000 px of focal length.
    pub k1_per_1000_px: f64,
    /// Of the height of the pitch's crown, m.
    pub crown_m: f64,
    /// The width of the pitch that is crowned, m; needed where `crown_m` is not zero.
    pub crown_width_m: f64,
    /// Of the principal point, px.
    pub principal_point_px: Vec2,
    /// The correlations of these errors.
    pub correlation: BaseCorrelation,
    /// Of the field's length and width. All others are given these, so that it is enough to leave
    /// them out once the size is known.
    #[serde(skip)]
    pub size: [SizeError; 2],
}

impl BaseSigma {
    /// From a joint covariance of the shared parameters; `crown_width_m` is the width of the pitch
    /// whose crown is among them.
    pub fn from_covariance(covariance: &SharedCovariance, crown_width_m: f64) -> Self {
        // `max` alone would make a variance that is not a number zero, which means exactly known.
        let deviation = covariance.diagonal().map(|variance| {
            if variance.is_nan() {
                f64::INFINITY
            } else {
                variance.max(0.0).sqrt()
            }
        });
        Self {
            position_m: deviation.fixed_rows::<3>(0).into_owned(),
            rotation: Vec3::new(deviation[3], deviation[4], 0.0),
            k1: deviation[5],
            k1_per_1000_px: deviation[6],
            crown_m: deviation[7],
            crown_width_m,
            principal_point_px: deviation.fixed_rows::<2>(8).into_owned(),
            correlation: BaseCorrelation::of_covariance(covariance, &deviation),
            size: [SizeError::default(); 2],
        }
    }

    /// The joint covariance of the shared parameters.
    pub fn covariance(&self) -> SharedCovariance {
        let (deviation, correlation) = (self.deviations(), self.correlation.matrix());
        SharedCovariance::from_fn(|row, column| {
            let (one, other) = (deviation[row], deviation[column]);
            // An unknown parameter has an infinite variance and no correlations; ∞ · 0 would be
            // NaN.
            if row == column {
                one * one
            } else if one.is_finite() && other.is_finite() {
                correlation[(row, column)] * one * other
            } else {
                0.0
            }
        })
    }

    /// The covariance of the position, m².
    pub fn position_covariance(&self) -> Mat3 {
        self.covariance().fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// 1-σ of each shared parameter.
    fn deviations(&self) -> SharedError {
        SharedError::from([
            self.position_m.x,
            self.position_m.y,
            self.position_m.z,
            self.rotation.x,
            self.rotation.y,
            self.k1,
            self.k1_per_1000_px,
            self.crown_m,
            self.principal_point_px.x,
            self.principal_point_px.y,
        ])
    }

    /// Whether lens, crown, principal point and the size of the field are taken as exact.
    pub fn is_of_pose_alone(&self) -> bool {
        let deviations = self.deviations();
        let of_size = self.size.iter().map(|size| size.sigma_m);
        let others = deviations.iter().skip(GAUGE).copied().chain(of_size);
        others.into_iter().all(|deviation| deviation == 0.0)
    }

    /// The same with one more error, independent of those so far: C + e eᵀ.
    #[must_use]
    pub fn with_error(&self, error: &SharedError) -> Self {
        self.with_covariance(&(self.covariance() + error * error.transpose()))
    }

    /// The same for a frame that uses a k₁ of its own, known to `k1`, in place of the shared lens,
    /// whose error does not touch such a frame.
    #[must_use]
    pub fn with_own_k1(&self, k1: f64) -> Self {
        let without = Self {
            k1: 0.0,
            k1_per_1000_px: 0.0,
            ..*self
        };
        if k1 == 0.0 {
            return without;
        }
        let mut error = SharedError::zeros();
        error[K1] = k1;
        without.with_error(&error)
    }

    /// The same for a frame that uses an exact principal point of its own.
    #[must_use]
    pub fn with_own_principal_point(&self) -> Self {
        Self {
            principal_point_px: Vec2::zeros(),
            ..*self
        }
    }

    /// The same with another covariance.
    fn with_covariance(&self, covariance: &SharedCovariance) -> Self {
        let mut changed = Self::from_covariance(covariance, self.crown_width_m);
        changed.rotation.z = self.rotation.z;
        changed.size = self.size;
        changed
    }

    /// The most likely error of all shared parameters, given an error of the position (m): the
    /// conditional mean `C_xp C_pp⁻¹ e` of the joint Gaussian (`C_pp`: covariance of the position,
    /// `C_xp`: of all parameters with it), so that rotation and lens follow the position as they
    /// are correlated with it. Where the position is exactly known, nothing else changes.
    pub fn following_position(&self, error_m: Vec3) -> SharedError {
        let covariance = self.covariance();
        let of_position: Matrix3<f64> = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let mut error = SharedError::zeros();
        if of_position.iter().all(|value| value.is_finite()) {
            // The pseudo-inverse, because the position may be exactly known along some directions.
            let eigen = of_position.symmetric_eigen();
            let least = 1e-12 * eigen.eigenvalues.max();
            let inverse = eigen
                .eigenvalues
                .map(|value| if value > least { value.recip() } else { 0.0 });
            let inverse = Matrix3::from_diagonal(&inverse);
            let cause = eigen.eigenvectors * inverse * eigen.eigenvectors.transpose() * error_m;
            error = covariance.fixed_columns::<3>(0) * cause;
        }
        error.fixed_rows_mut::<3>(0).copy_from(&error_m);
        error
    }

    /// The same with a position σ of at least `least_m` along its most uncertain direction, and all
    /// other parameters raised consistently ([`Self::following_position`]). An error common to all
    /// frames shows where the frames constrain the position least.
    #[must_use]
    pub fn with_position_error_of(&self, least_m: f64) -> Self {
        let of_position = self.position_covariance();
        if !of_position.iter().all(|value| value.is_finite()) {
            return *self;
        }
        let eigen = of_position.symmetric_eigen();
        // One more independent error along that direction, of the variance that is missing there.
        let weakest = eigen.eigenvalues.imax();
        let missing = least_m * least_m - eigen.eigenvalues[weakest];
        if missing <= 0.0 {
            return *self;
        }
        let along_m: Vec3 = eigen.eigenvectors.column(weakest) * missing.sqrt();
        self.with_error(&self.following_position(along_m))
    }

    /// The smallest covariance that is at least this one and at least `other` in every direction:
    /// each direction in which `other` is larger is raised to it, with all correlations. Parameters
    /// that are exactly known here stay so.
    #[must_use]
    pub fn covering(&self, other: &SharedCovariance) -> Self {
        let mut covariance = self.covariance();
        let uncertain: Vec<usize> = (0..SHARED_PARAMETERS)
            .filter(|at| covariance[(*at, *at)] > 0.0)
            .collect();
        // Without a Cholesky factor (a singular covariance), the sum is a valid, larger bound.
        let own = part_of_covariance(&covariance, &uncertain);
        let other = part_of_covariance(other, &uncertain);
        let raised = raise_to(&own, &other).unwrap_or_else(|| &own + &other);
        for (row, &to_row) in uncertain.iter().enumerate() {
            for (column, &to_column) in uncertain.iter().enumerate() {
                covariance[(to_row, to_column)] = raised[(row, column)];
            }
        }
        self.with_covariance(&covariance)
    }

    /// A matrix L with L Lᵀ = the covariance of position (m), rotation vector in `world` (rad, the
    /// gauge included), k₁, its slope, crown (m), principal point (px), length and width of the
    /// field (m). Its columns before those of the size are lower triangular.
    pub(crate) fn root(&self) -> SMatrix<f64, SHARED_COLUMNS, SHARED_COLUMNS> {
        let (correlation, deviation) = (self.correlation.matrix(), self.deviations());
        let mut root = SMatrix::<f64, SHARED_COLUMNS, SHARED_COLUMNS>::zeros();
        // Cholesky factor of the correlation matrix, which may be semidefinite: a parameter that is
        // fully determined by the earlier ones has a pivot of zero, and its column stays zero
        // instead of being divided by the pivot.
        for column in 0..SHARED_PARAMETERS {
            let own =
                correlation[(column, column)] - product_of_earlier_columns(&root, column, column);
            root[(place(column), place(column))] = own.max(0.0).sqrt();
            for row in column + 1..SHARED_PARAMETERS {
                let shared =
                    correlation[(row, column)] - product_of_earlier_columns(&root, row, column);
                root[(place(row), place(column))] = if own > 1e-12 {
                    shared / own.sqrt()
                } else {
                    0.0
                };
            }
        }
        for (row, sigma) in deviation.iter().enumerate() {
            // Scale the rows by σ. An unknown parameter has an infinite σ, and its zeros must stay
            // zero; ∞ · 0 would be NaN.
            root.row_mut(place(row))
                .iter_mut()
                .filter(|entry| **entry != 0.0)
                .for_each(|entry| *entry *= sigma);
        }
        root[(GAUGE, GAUGE)] = self.rotation.z;
        // An error of the size is independent of all errors so far, and brings its own of each.
        for (axis, size) in self.size.iter().enumerate() {
            let column = SIZE_COLUMN + axis;
            root[(column, column)] = size.sigma_m;
            for (parameter, by_m) in size.base_by_m.iter().enumerate() {
                root[(place(parameter), column)] = by_m * size.sigma_m;
            }
        }
        root
    }
}

/// The covariance of some of the shared parameters, given by their indices.
fn part_of_covariance(covariance: &SharedCovariance, parameters: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(parameters.len(), parameters.len(), |row, column| {
        covariance[(parameters[row], parameters[column])]
    })
}

/// Σ `L_rk L_ck` over the columns k before column c of a Cholesky factor L: what these explain of
/// the entry (r, c).
fn product_of_earlier_columns(
    root: &SMatrix<f64, SHARED_COLUMNS, SHARED_COLUMNS>,
    row: usize,
    column: usize,
) -> f64 {
    (0..column)
        .map(|before| root[(place(row), place(before))] * root[(place(column), place(before))])
        .sum()
}

/// The smallest covariance that is at least `own` and at least `other` in every direction. In
/// coordinates in which `own` is the identity, each eigenvalue of `other` above 1 replaces that 1.
/// None where `own` has no Cholesky factor.
fn raise_to(own: &DMatrix<f64>, other: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    // Factorise in units of each parameter's own σ: metres, radians and px make the matrix badly
    // scaled.
    let sigmas = own.diagonal().map(f64::sqrt);
    let scale = DMatrix::from_diagonal(&sigmas.map(f64::recip));
    let factor = (&scale * own * &scale).cholesky()?.l();
    let inverse = factor.clone().try_inverse()? * &scale;
    let eigen = (&inverse * other * inverse.transpose()).symmetric_eigen();
    // Raise `own` along each eigenvector with a larger eigenvalue, transformed back.
    let mut raised = own.clone();
    let back = DMatrix::from_diagonal(&sigmas) * factor * &eigen.eigenvectors;
    for (column, value) in eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, value)| **value > 1.0)
    {
        raised += back.column(column) * back.column(column).transpose() * (value - 1.0);
    }
    raised
        .iter()
        .all(|value| value.is_finite())
        .then_some(raised)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH_M: f64 = 68.0;

    fn covariance() -> SharedCovariance {
        let mixed = SharedCovariance::from_fn(|row, column| {
            ((3 * row + 5 * column + row * column) % 11) as f64 - 4.5
        });
        let sigmas =
            SharedError::from_row_slice(&[0.1, 0.3, 0.2, 1e-3, 2e-3, 0.03, 0.05, 0.04, 12.0, 9.0]);
        let scale = SharedCovariance::from_diagonal(&sigmas);
        scale * (mixed * mixed.transpose() + SharedCovariance::identity()) * scale
    }

    /// The root without the column of the gauge, times its transpose.
    fn from_root(sigma: &BaseSigma) -> SharedCovariance {
        let whole = sigma.root() * sigma.root().transpose();
        SharedCovariance::from_fn(|row, column| whole[(place(row), place(column))])
    }

    fn assert_alike(found: &SharedCovariance, expected: &SharedCovariance, what: &str) {
        for (row, column) in
            (0..SHARED_PARAMETERS).flat_map(|row| (0..SHARED_PARAMETERS).map(move |it| (row, it)))
        {
            let scale = (expected[(row, row)] * expected[(column, column)]).sqrt();
            let off = (found[(row, column)] - expected[(row, column)]).abs();
            assert!(
                off < 1e-9 * scale,
                "{what} {row} {column}: {off} of {scale}"
            );
        }
    }

    #[test]
    fn a_covariance_comes_back_from_its_sigmas_and_from_its_root() {
        let sigma = BaseSigma::from_covariance(&covariance(), WIDTH_M);
        assert_alike(&sigma.covariance(), &covariance(), "sigmas");
        assert_alike(&from_root(&sigma), &covariance(), "root");
        assert_eq!(
            sigma.root().row(GAUGE).amax(),
            0.0,
            "the pan gauge is exact"
        );
    }

    #[test]
    fn one_more_error_adds_its_covariance() {
        let sigma = BaseSigma::from_covariance(&covariance(), WIDTH_M);
        let mut error = SharedError::zeros();
        (error[0], error[1], error[6]) = (0.6, -0.2, 0.1);
        assert_alike(
            &sigma.with_error(&error).covariance(),
            &(covariance() + error * error.transpose()),
            "error",
        );
        let unknown = SharedCovariance::from_diagonal_element(f64::INFINITY);
        let unknown = BaseSigma::from_covariance(&unknown, WIDTH_M).with_error(&error);
        assert_eq!(unknown.position_m.x, f64::INFINITY);
    }

    #[test]
    fn rotation_and_lens_follow_an_error_of_the_position_as_they_go_with_it() {
        // One cause for all parameters: whoever knows the position's error knows the others'.
        let cause =
            SharedError::from_row_slice(&[0.1, 0.4, -0.2, 1e-3, 2e-4, 0.02, 0.01, 0.03, 5.0, -3.0]);
        let noise = SharedCovariance::from_diagonal(&cause.map(|by| (1e-4 * by).powi(2)));
        let sigma = BaseSigma::from_covariance(&(cause * cause.transpose() + noise), WIDTH_M);
        let following = sigma.following_position(Vec3::new(0.2, 0.8, -0.4));
        for (found, by) in following.iter().zip(&cause) {
            assert!((found - 2.0 * by).abs() < 1e-3 * by.abs(), "{following}");
        }
        let exact = BaseSigma::default().following_position(Vec3::x());
        assert_eq!((exact[0], exact.norm()), (1.0, 1.0));
    }

    #[test]
    fn the_position_is_made_uncertain_where_it_is_least_held_and_nowhere_else() {
        let cause =
            SharedError::from_row_slice(&[0.0, 0.1, 0.0, 2e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let rest = SharedError::from_row_slice(&[
            1e-3, 1e-3, 1e-3, 1e-6, 1e-5, 0.01, 0.01, 0.01, 1.0, 1.0,
        ]);
        let covariance =
            cause * cause.transpose() + SharedCovariance::from_diagonal(&rest.component_mul(&rest));
        let sigma = BaseSigma::from_covariance(&covariance, WIDTH_M);
        let wider = sigma.with_position_error_of(0.3);
        assert!(
            (wider.position_m.y - 0.3).abs() < 1e-6 && wider.position_m.x < 2e-3,
            "{wider:?}"
        );
        // The view hardly changes: the rotation goes along.
        assert!(
            (wider.rotation.x / wider.position_m.y - 0.02).abs() < 1e-4,
            "{wider:?}"
        );
        assert!(wider.correlation.matrix()[(3, 1)] > 0.999, "{wider:?}");
        assert_eq!(sigma.with_position_error_of(0.05), sigma);
    }

    #[test]
    fn what_covers_two_covariances_is_at_least_each_and_no_more_than_their_sum() {
        let sigma = BaseSigma::from_covariance(&covariance(), WIDTH_M);
        assert_alike(
            &sigma.covering(&(covariance() * 0.9)).covariance(),
            &covariance(),
            "smaller",
        );
        assert_alike(
            &sigma.covering(&(covariance() * 4.0)).covariance(),
            &(covariance() * 4.0),
            "larger",
        );
        let error =
            SharedError::from_row_slice(&[0.9, 0.4, -0.2, 1e-3, 2e-2, 0.2, 0.01, 0.03, 50.0, -3.0]);
        let other = error * error.transpose();
        let covering = sigma.covering(&other).covariance();
        let direction = covariance().try_inverse().unwrap() * error;
        let along = |of: &SharedCovariance| direction.dot(&(of * direction));
        assert!(
            (along(&covering) / along(&other) - 1.0).abs() < 1e-6,
            "{} {}",
            along(&covering),
            along(&other)
        );
        let sum = covariance() + other;
        assert!(
            covering
                .diagonal()
                .iter()
                .zip(&sum.diagonal())
                .all(|(covering, sum)| covering <= sum)
        );
    }

    #[test]
    fn a_parameter_that_is_exact_stays_exact() {
        let mut covariance = covariance();
        covariance.row_mut(7).fill(0.0);
        covariance.column_mut(7).fill(0.0);
        let sigma = BaseSigma::from_covariance(&covariance, WIDTH_M).covering(&(covariance * 9.0));
        assert_eq!(sigma.crown_m, 0.0);
        assert!((sigma.k1 - 3.0 * covariance[(5, 5)].sqrt()).abs() < 1e-9);
    }

    #[test]
    fn errors_of_one_cause_have_a_root() {
        let one =
            SharedError::from_row_slice(&[1.0, 2.0, 3.0, 0.1, -0.2, 0.3, 0.1, 0.2, 5.0, -7.0]);
        let sigma = BaseSigma::from_covariance(&(one * one.transpose()), WIDTH_M);
        let found = from_root(&sigma);
        assert!((found - one * one.transpose()).amax() < 1e-9, "{found}");
    }

    #[test]
    fn what_is_not_known_at_all_goes_with_nothing() {
        let sigma = BaseSigma::from_covariance(
            &SharedCovariance::from_diagonal_element(f64::INFINITY),
            WIDTH_M,
        );
        assert_eq!(
            (sigma.position_m.x, sigma.correlation),
            (f64::INFINITY, BaseCorrelation::NONE)
        );
        assert_eq!(BaseSigma::default().root().amax(), 0.0);
        let not_a_number = BaseSigma::from_covariance(&SharedCovariance::repeat(f64::NAN), WIDTH_M);
        assert_eq!(not_a_number, sigma);
    }
}
