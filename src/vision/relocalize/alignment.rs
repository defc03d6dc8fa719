//! Joint adjustment of the labels of references.
//!
//! Clicks determine where a reference looks to a few pixels; common features of two pictures
//! determine their relative pan, tilt and zoom to a few tenths of a pixel. All labels of a camera
//! are therefore adjusted together. Let `δᵢ` be the correction of label i in (pan, tilt, focal
//! length), and `Λᵢ` its covariance by clicks. The adjustment minimises
//!
//! `Σ δᵢᵀ Λᵢ⁻¹ δᵢ + Σ (rᵢⱼ − δⱼ + Tᵢⱼ δᵢ)ᵀ Cᵢⱼ⁻¹ (rᵢⱼ − δⱼ + Tᵢⱼ δᵢ)`
//!
//! where `rᵢⱼ` is the offset of j from its label according to the rays of i, and `Tᵢⱼ` is its
//! derivative by the label of i. `Cᵢⱼ` is the covariance by features, plus what small errors of
//! lens and base add with the rotation between the two (measured on real matches). Neighbours that
//! disagree by more than clicks can explain take no part: those labels need to be checked by the
//! user.
//!
//! Annotators click more or less accurately than assumed, and lens and base are known more or less
//! well. So both `Λᵢ` and `Cᵢⱼ` are scaled by an estimated variance factor: χ² after the adjustment
//! over its redundancy (Förstner's estimate of variance components).

use super::confidence::FromReference;
use super::labels::jacobian_by_reference;
use super::reference_pairs::{Reference, pairs, pose_from_reference};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, Mat3, Vec3};
use touchline_core::solve::covariance_in_radians;

/// The label of a reference: the uncertainty of its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// Covariance of (pan rad, tilt rad, focal px), given the base.
    pub covariance: Mat3,
    /// How well its clicks fit. `None` if the label does not come from clicks; its covariance is
    /// then not rescaled.
    pub misfit: Option<Misfit>,
}

/// How well the clicks of a label fit its camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Σ (distance / σ)².
    pub chi_squared: f64,
    /// The expected value of that if clicks scatter as assumed: their redundancy.
    pub expected: f64,
}

/// Maximum number of references that are adjusted together, neighbours by pan: the work grows with
/// the cube.
const MAX_REFERENCES: usize = 100;

/// Number of nearest neighbours, by viewing direction, with which every reference is compared.
const NEIGHBOURS: usize = 4;

/// Number of features of each reference that are compared, the strongest.
const FEATURES: usize = 300;

/// Neighbours take no part if they disagree by more than this many 1-σ of their expected
/// disagreement.
const MOST_SIGMAS: f64 = 4.0;

/// Minimum 1-σ of the overlay as determined by the features of another picture, px at 1920 px
/// width.
const LEAST_PX: f64 = 0.3;

/// Additional 1-σ of the overlay per rotation by the width of the picture, px at 1920 px width:
/// over the whole picture, and at its left and right edges by the focal length (see
/// [`super::Evidence`]).
const PER_TURN_PX: [f64; 2] = [11.0, 17.0];

/// Weight of the assumption that both variance factors are 1, as a number of redundant equations.
const SUPPOSED: f64 = 12.0;

/// The χ² of one reference's clicks is capped at this multiple of its expectation: an outlier is
/// not scatter.
const MOST_OF_ONE: f64 = 9.0;

/// Maximum correction of a label: rad, and as a share of the focal length.
const MOST_TURN: f64 = 0.1;
const MOST_FOCAL: f64 = 0.3;

/// Number of rounds of adjusting labels and estimating variance factors.
const ROUNDS: usize = 4;

/// Adjusts the labels of references to each other. Returns each reference's camera and the
/// covariance of its (pan rad, tilt rad, focal px), given the base. If a group's problem has no
/// solution, its labels stay as they are.
pub fn adjust_labels(references: &[Reference], labels: &[Label]) -> Vec<(Ptz, Mat3)> {
    let pans: Vec<Angle> = references
        .iter()
        .map(|reference| reference.camera.ptz().pan)
        .collect();
    // Split the references into groups of neighbours by pan, beginning at the largest gap.
    let order = AngleRange::along_smallest(&pans);
    let mut groups: Vec<Group> = order
        .chunks(MAX_REFERENCES)
        .map(|members| Group::from_members(members, references))
        .collect();
    let mut scatter = Scatter {
        clicks: 1.0,
        relative_poses: 1.0,
    };
    // Alternate: adjust with the current variance factors, then estimate these over all groups from
    // χ² and redundancy. The prior term keeps them finite where little is redundant.
    for _ in 0..ROUNDS {
        scatter = adjust_groups(&mut groups, labels, scatter);
    }
    let mut found: Vec<(Ptz, Mat3)> = references
        .iter()
        .zip(labels)
        .map(|(reference, label)| (reference.camera.ptz(), label.covariance))
        .collect();
    // Apply the corrections.
    for group in groups.iter().filter(|group| group.is_adjusted) {
        for (place, &member) in group.members.iter().enumerate() {
            let by = group.correction(place);
            let ptz = found[member].0;
            // A pan beside ±180° may leave the range by its correction; tilts are far from there.
            let pan = (ptz.pan + Angle::from_radians(by.x)).wrap();
            let tilt = ptz.tilt + Angle::from_radians(by.y);
            found[member] = (
                Ptz::new(pan, tilt, ptz.focal_px + by.z),
                group.covariance(place, place),
            );
        }
    }
    found
}

/// Adjusts each group with these variance factors, and estimates the next ones from the groups that
/// have a solution.
fn adjust_groups(groups: &mut [Group], labels: &[Label], scatter: Scatter) -> Scatter {
    let supposed = Misfit {
        chi_squared: SUPPOSED,
        expected: SUPPOSED,
    };
    let (mut of_clicks, mut of_poses) = (supposed, supposed);
    for group in groups {
        group.adjust(labels, scatter);
        // Without a solution the corrections are those of an earlier round, or too large to be
        // errors of labels: what is left after them is no scatter.
        if group.is_adjusted {
            of_clicks = of_clicks + group.misfit_of_clicks(labels, scatter);
            of_poses = of_poses + group.misfit_of_relative_poses(labels, scatter);
        }
    }
    Scatter {
        clicks: of_clicks.chi_squared / of_clicks.expected,
        relative_poses: of_poses.chi_squared / of_poses.expected,
    }
}

/// Variance factors of clicks and of relative poses: actual over assumed variance.
#[derive(Clone, Copy)]
struct Scatter {
    clicks: f64,
    relative_poses: f64,
}

impl std::ops::Add for Misfit {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            chi_squared: self.chi_squared + other.chi_squared,
            expected: self.expected + other.expected,
        }
    }
}

/// The pose of a reference relative to another one; both are indices into a group.
struct RelativePose {
    places: [usize; 2],
    /// `r`: (pan rad, tilt rad, focal px).
    off: Vec3,
    /// `T`.
    moved: Mat3,
    /// `C`.
    covariance: Mat3,
}

/// References that are adjusted together, and their solution.
struct Group {
    /// Their indices among all references.
    members: Vec<usize>,
    /// Their focal lengths by their labels, px.
    focal_px: Vec<f64>,
    relative_poses: Vec<RelativePose>,
    /// Their corrections, stacked (pan rad, tilt rad, focal px), and the covariance of these.
    corrections: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Whether the problem has a solution with small corrections.
    is_adjusted: bool,
}

impl RelativePose {
    /// The pose of the second relative to the first; `None` if their pictures do not determine it.
    fn estimate(places: [usize; 2], references: &[Reference]) -> Option<Self> {
        let [first, second] = places.map(|place| &references[place]);
        let answer = pose_from_reference(first, second, FEATURES)?;
        let (one, other) = (first.camera.ptz(), second.camera.ptz());
        let pan = answer.ptz.pan.turn_from(other.pan).radians();
        let off = Vec3::new(
            pan,
            (answer.ptz.tilt - other.tilt).radians(),
            answer.ptz.focal_px - other.focal_px,
        );
        // Errors of lens and base grow with the rotation between the two. In px of the overlay they
        // are a pan and tilt error over the whole picture, and a focal length error that shows at
        // the left and right edges: δx = (w/2) δf/f, so δf = 2 f δx/w. Pan is scaled by
        // 1/cos(tilt), the arc that a pan moves the axis.
        let image_size = second.features.image_size;
        let width_px = f64::from(image_size.width);
        let turn = FromReference::between(&other, &one, image_size).turn;
        let [sigma_px, edge_px] = PER_TURN_PX
            .map(|per_turn| LEAST_PX.hypot(per_turn * turn) * image_size.scale_from_1920());
        let (axis, focal_px) = (
            sigma_px / other.focal_px,
            edge_px * 2.0 * other.focal_px / width_px,
        );
        let by_turn = Mat3::from_diagonal(
            &Vec3::new(axis / other.tilt.radians().cos(), axis, focal_px)
                .map(|sigma| sigma * sigma),
        );
        let covariance = covariance_in_radians(&answer.own_covariance) + by_turn;
        Some(Self {
            places,
            off,
            moved: jacobian_by_reference(&other, &one),
            covariance,
        })
    }

    /// The residual `r − δⱼ + T δᵢ` after the corrections.
    fn residual(&self, group: &Group) -> Vec3 {
        let [one, other] = self.places;
        self.off - group.correction(other) + self.moved * group.correction(one)
    }
}

impl Group {
    fn from_members(members: &[usize], references: &[Reference]) -> Self {
        let together: Vec<Reference> = members.iter().map(|&member| references[member]).collect();
        // Pictures are matched once, with the labels as they are. The corrections are small, so the
        // derivative T accounts for them in every round.
        let relative_poses = pairs(&together, NEIGHBOURS)
            .par_iter()
            .filter_map(|pair| RelativePose::estimate(*pair, &together))
            .collect();
        let size = 3 * members.len();
        Self {
            members: members.to_vec(),
            focal_px: together
                .iter()
                .map(|reference| reference.camera.ptz().focal_px)
                .collect(),
            relative_poses,
            corrections: DVector::zeros(size),
            covariance: DMatrix::zeros(size, size),
            is_adjusted: false,
        }
    }

    /// The relative poses whose offset is within [`MOST_SIGMAS`] of its covariance, that of both
    /// labels included.
    fn inliers(&self, labels: &[Label], scatter: Scatter) -> Vec<&RelativePose> {
        self.relative_poses
            .iter()
            .filter(|pose| self.is_inlier(pose, labels, scatter))
            .collect()
    }

    /// Whether the offset of a relative pose is within [`MOST_SIGMAS`] of its covariance.
    fn is_inlier(&self, pose: &RelativePose, labels: &[Label], scatter: Scatter) -> bool {
        // Mahalanobis distance of the offset under C + T Λᵢ Tᵀ + Λⱼ, with both variance factors.
        let [one, other] = pose
            .places
            .map(|place| labels[self.members[place]].scaled_covariance(scatter));
        let all = pose.covariance * scatter.relative_poses
            + pose.moved * one * pose.moved.transpose()
            + other;
        all.try_inverse()
            .is_some_and(|inverse| pose.off.dot(&(inverse * pose.off)) <= MOST_SIGMAS * MOST_SIGMAS)
    }

    /// Solves the least squares problem for given variance factors.
    fn adjust(&mut self, labels: &[Label], scatter: Scatter) {
        let size = 3 * self.members.len();
        let (mut normal, mut right) = (
            DMatrix::<f64>::zeros(size, size),
            DVector::<f64>::zeros(size),
        );
        for (place, &member) in self.members.iter().enumerate() {
            // The prior of each label. A singular covariance has no information matrix: that label
            // gets no prior, and the factorisation below fails unless its neighbours determine it.
            let information = labels[member].scaled_covariance(scatter).try_inverse();
            add_block(
                &mut normal,
                [place, place],
                information.unwrap_or_else(Mat3::zeros),
            );
        }
        // The normal equations of each relative pose: the residual has the derivative −I by δⱼ and
        // T by δᵢ.
        for pose in self.inliers(labels, scatter) {
            let ([one, other], moved) = (pose.places, pose.moved);
            let Some(weight) = (pose.covariance * scatter.relative_poses).try_inverse() else {
                continue;
            };
            add_block(&mut normal, [other, other], weight);
            add_block(&mut normal, [one, one], moved.transpose() * weight * moved);
            add_block(&mut normal, [other, one], -weight * moved);
            add_block(&mut normal, [one, other], -moved.transpose() * weight);
            let mut of_other = right.fixed_rows_mut::<3>(3 * other);
            of_other += weight * pose.off;
            let mut of_one = right.fixed_rows_mut::<3>(3 * one);
            of_one -= moved.transpose() * weight * pose.off;
        }
        // Scale the unknowns by their own σ, so that radians and px do not spoil the condition of
        // the factorisation.
        let sigmas = normal
            .diagonal()
            .map(|information| information.max(f64::MIN_POSITIVE).sqrt().recip());
        let scale = DMatrix::from_diagonal(&sigmas);
        self.is_adjusted = false;
        let Some(factor) = (&scale * normal * &scale).cholesky() else {
            return;
        };
        self.covariance = &scale * factor.inverse() * &scale;
        self.corrections = &self.covariance * right;
        self.is_adjusted = (0..self.members.len()).all(|place| self.is_small(place));
    }

    /// χ² of all clicks after the adjustment, in the assumed σ, and its redundancy.
    ///
    /// The label stands for the clicks: its misfit from the fit of the camera, plus the squared
    /// correction. A label adds three observations; the trace of adjusted times prior information
    /// is the part of them that the correction uses up (redundancy numbers; Förstner).
    fn misfit_of_clicks(&self, labels: &[Label], scatter: Scatter) -> Misfit {
        self.members
            .iter()
            .enumerate()
            .filter_map(|(place, &member)| self.misfit_of_label(place, &labels[member], scatter))
            .fold(Misfit::default(), |sum, one| sum + one)
    }

    /// The part that one label contributes to [`Self::misfit_of_clicks`]; `None` if it does not
    /// come from clicks, or its covariance is singular.
    fn misfit_of_label(&self, place: usize, label: &Label, scatter: Scatter) -> Option<Misfit> {
        let (clicks, information) = (label.misfit?, label.covariance.try_inverse()?);
        let by = self.correction(place);
        // Here the information is by the assumed σ, whereas the adjusted covariance is by the
        // scaled one, so the trace is divided by the variance factor.
        let explained = (self.covariance(place, place) * information).trace() / scatter.clicks;
        let expected = clicks.expected + (3.0 - explained).max(0.0);
        let chi_squared = clicks.chi_squared + by.dot(&(information * by));
        // Capped, so that one reference with a wrong click does not inflate the factor for all.
        Some(Misfit {
            chi_squared: chi_squared.min(MOST_OF_ONE * scatter.clicks * expected),
            expected,
        })
    }

    /// The same as [`Self::misfit_of_clicks`], of the relative poses: three observations each, less
    /// what the corrections use up.
    fn misfit_of_relative_poses(&self, labels: &[Label], scatter: Scatter) -> Misfit {
        self.inliers(labels, scatter)
            .into_iter()
            .filter_map(|pose| self.misfit_of_pose(pose, scatter))
            .fold(Misfit::default(), |sum, one| sum + one)
    }

    /// The part that one relative pose contributes; `None` if its covariance is singular.
    fn misfit_of_pose(&self, pose: &RelativePose, scatter: Scatter) -> Option<Misfit> {
        let ([one, other], information) = (pose.places, pose.covariance.try_inverse()?);
        // The covariance of the adjusted observation δⱼ − T δᵢ.
        let crossed = pose.moved * self.covariance(one, other);
        let explained = pose.moved * self.covariance(one, one) * pose.moved.transpose()
            + self.covariance(other, other)
            - crossed
            - crossed.transpose();
        let left = pose.residual(self);
        let expected = (3.0 - (explained * information).trace() / scatter.relative_poses).max(0.0);
        Some(Misfit {
            chi_squared: left.dot(&(information * left)),
            expected,
        })
    }

    /// Whether a correction is small enough to be a label's error and to be linear in its effects.
    fn is_small(&self, place: usize) -> bool {
        let by = self.correction(place);
        by.x.hypot(by.y) < MOST_TURN && by.z.abs() < MOST_FOCAL * self.focal_px[place]
    }

    fn correction(&self, place: usize) -> Vec3 {
        self.corrections.fixed_rows::<3>(3 * place).into()
    }

    fn covariance(&self, row: usize, column: usize) -> Mat3 {
        self.covariance
            .fixed_view::<3, 3>(3 * row, 3 * column)
            .into()
    }
}

/// Adds a block to the normal equations, at the rows of one member and the columns of another.
fn add_block(normal: &mut DMatrix<f64>, [row, column]: [usize; 2], block: Mat3) {
    let mut view = normal.fixed_view_mut::<3, 3>(3 * row, 3 * column);
    view += block;
}

impl Label {
    /// The covariance scaled by the variance factor of clicks, if the label comes from clicks.
    fn scaled_covariance(&self, scatter: Scatter) -> Mat3 {
        if self.misfit.is_some() {
            self.covariance * scatter.clicks
        } else {
            self.covariance
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two references of which each sees the other this far off, rad, and the variance factor of
    /// their clicks after one round.
    fn factor_of_clicks(off_rad: f64) -> (bool, f64) {
        let label = Label {
            covariance: Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 100.0)),
            misfit: Some(Misfit {
                chi_squared: 60.0,
                expected: 20.0,
            }),
        };
        let pose = RelativePose {
            places: [0, 1],
            off: Vec3::new(off_rad, 0.0, 0.0),
            moved: Mat3::identity(),
            covariance: Mat3::from_diagonal(&Vec3::new(1e-6, 1e-6, 1.0)),
        };
        let group = Group {
            members: vec![0, 1],
            focal_px: vec![2000.0; 2],
            relative_poses: vec![pose],
            corrections: DVector::zeros(6),
            covariance: DMatrix::zeros(6, 6),
            is_adjusted: false,
        };
        let scatter = Scatter {
            clicks: 1.0,
            relative_poses: 1.0,
        };
        let mut groups = [group];
        let found = adjust_groups(&mut groups, &[label; 2], scatter);
        (groups[0].is_adjusted, found.clicks)
    }

    #[test]
    fn a_group_without_a_solution_says_nothing_about_scatter() {
        let (is_adjusted, factor) = factor_of_clicks(0.01);
        assert!(is_adjusted && factor > 1.5, "{factor}");
        // Half of a radian for each is no error of a label.
        assert_eq!(factor_of_clicks(1.0), (false, 1.0));
    }
}
