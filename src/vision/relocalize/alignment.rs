//! References whose labels are made to fit each other.
//!
//! Clicks tell where a reference looks to a few pixels; what two pictures share tells where one
//! looks as seen from the other to a few tenths of a pixel. All labels of a camera are therefore
//! adjusted together. With the correction `δᵢ` of the label (pan, tilt, focal length) of reference
//! i, of the covariance `Λᵢ` by its clicks, the least squares problem is
//!
//! `Σ δᵢᵀ Λᵢ⁻¹ δᵢ + Σ (rᵢⱼ − δⱼ + Tᵢⱼ δᵢ)ᵀ Cᵢⱼ⁻¹ (rᵢⱼ − δⱼ + Tᵢⱼ δᵢ)`
//!
//! where `rᵢⱼ` is how far j looks from its label by the rays of i, and `Tᵢⱼ` how that moves with
//! the label of i. `Cᵢⱼ` is what features leave open, and what a lens and a base that are not quite
//! right make of a turn between the two (measured on real matches). Neighbours that disagree by
//! more than clicks can explain take no part: their labels are for a person to look at.
//!
//! How far clicks scatter is learnt on the way, as a person's clicks may be better or worse than is
//! taken for granted, and how well neighbours are seen from each other as well, as lenses and bases
//! are known more or less well: χ² of each after the adjustment, over what is surplus (Förstner's
//! estimate of variance components), scales `Λᵢ` and `Cᵢⱼ`.

use super::confidence::FromReference;
use super::labels::moved_by_label;
use super::reference_pairs::{Reference, pairs, seen_from};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, Mat3, Vec3};
use touchline_core::solve::covariance_in_radians;

/// What is known of where a reference looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// Covariance of (pan rad, tilt rad, focal px), if the base is exact.
    pub covariance: Mat3,
    /// How well its clicks fit; none where it rests on no clicks: then its covariance is taken as
    /// it is.
    pub misfit: Option<Misfit>,
}

/// How well the clicks of a label fit its camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Σ (distance / σ)².
    pub chi_squared: f64,
    /// What that is on average where clicks scatter as they are taken to.
    pub expected: f64,
}

/// At most so many references, next to each other by pan, are adjusted together: the work grows
/// with the cube.
const TOGETHER: usize = 100;

/// Every reference is compared with as many that look nearest to where it looks.
const NEIGHBOURS: usize = 4;

/// Features compared of each, the strongest.
const FEATURES: usize = 300;

/// Neighbours that disagree by more, in 1-σ of what they may disagree by, take no part.
const MOST_SIGMAS: f64 = 4.0;

/// 1-σ by which an overlay is off at least by what features of another picture tell, px at 1920 px
/// width.
const LEAST_PX: f64 = 0.3;

/// 1-σ by which it is off more where the camera turned by the width of its picture, px at 1920 px
/// width: all over the picture, and by the focal length at its left and right edge (see
/// [`super::Evidence`]).
const PER_TURN_PX: [f64; 2] = [11.0, 17.0];

/// What is known of either's scatter before any is seen: as much as so many surplus equations tell.
const SUPPOSED: f64 = 12.0;

/// The clicks of one reference count by no more than this multiple of what is expected of them: a
/// wrong one is no scatter.
const MOST_OF_ONE: f64 = 9.0;

/// No label is corrected by more: a turn, rad, and a share of the focal length.
const MOST_TURN: f64 = 0.1;
const MOST_FOCAL: f64 = 0.3;

/// Rounds of adjusting and learning the scatter.
const ROUNDS: usize = 4;

/// References as they look when their labels fit each other, with what is known of them then: the
/// covariance of (pan rad, tilt rad, focal px), if the base is exact. Labels that leave the problem
/// without a solution stay as they are.
#[must_use]
pub fn aligned(references: &[Reference], labels: &[Label]) -> Vec<(Ptz, Mat3)> {
    let pans: Vec<Angle> = references
        .iter()
        .map(|reference| reference.camera.ptz().pan)
        .collect();
    let order = AngleRange::along_smallest(&pans);
    let mut groups: Vec<Group> = order
        .chunks(TOGETHER)
        .map(|members| Group::of(members, references))
        .collect();
    let mut scatter = Scatter {
        clicks: 1.0,
        ties: 1.0,
    };
    for _ in 0..ROUNDS {
        let supposed = Misfit {
            chi_squared: SUPPOSED,
            expected: SUPPOSED,
        };
        let (mut of_clicks, mut of_ties) = (supposed, supposed);
        for group in &mut groups {
            group.adjust(labels, scatter);
            of_clicks = of_clicks + group.misfit_of_clicks(labels, scatter);
            of_ties = of_ties + group.misfit_of_ties(labels, scatter);
        }
        scatter = Scatter {
            clicks: of_clicks.chi_squared / of_clicks.expected,
            ties: of_ties.chi_squared / of_ties.expected,
        };
    }
    let mut found: Vec<(Ptz, Mat3)> = references
        .iter()
        .zip(labels)
        .map(|(reference, label)| (reference.camera.ptz(), label.covariance))
        .collect();
    for group in groups.iter().filter(|group| group.is_adjusted) {
        for (place, &member) in group.members.iter().enumerate() {
            let by = group.correction(place);
            let ptz = found[member].0;
            let pan = (ptz.pan + Angle::from_radians(by.x)).wrapped();
            let tilt = ptz.tilt + Angle::from_radians(by.y);
            found[member] = (
                Ptz {
                    pan,
                    tilt,
                    focal_px: ptz.focal_px + by.z,
                },
                group.covariance(place, place),
            );
        }
    }
    found
}

/// The squares of how much farther clicks, and neighbours as seen from each other, scatter than
/// they are taken to.
#[derive(Clone, Copy)]
struct Scatter {
    clicks: f64,
    ties: f64,
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

/// A neighbour as seen from another reference, both by their places in a group.
struct Tie {
    places: [usize; 2],
    /// `r`, (rad, rad, px).
    off: Vec3,
    /// `T`.
    moved: Mat3,
    /// `C`.
    covariance: Mat3,
}

/// References that are adjusted together.
struct Group {
    /// Their places among all.
    members: Vec<usize>,
    /// Their focal lengths by their labels, px.
    focal_px: Vec<f64>,
    ties: Vec<Tie>,
    /// Their corrections, (rad, rad, px) after each other, and the covariance of those.
    corrections: DVector<f64>,
    covariance: DMatrix<f64>,
    /// The problem has a solution.
    is_adjusted: bool,
}

impl Tie {
    /// Where the second looks as seen from the first; none where the pictures do not tell.
    fn of(places: [usize; 2], references: &[Reference]) -> Option<Self> {
        let [first, second] = places.map(|place| &references[place]);
        let told = seen_from(first, second, FEATURES)?;
        let (one, other) = (first.camera.ptz(), second.camera.ptz());
        let pan = told.ptz.pan.turn_from(other.pan).radians();
        let off = Vec3::new(
            pan,
            (told.ptz.tilt - other.tilt).radians(),
            told.ptz.focal_px - other.focal_px,
        );
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
        let covariance = covariance_in_radians(&told.own_covariance) + by_turn;
        Some(Self {
            places,
            off,
            moved: moved_by_label(&other, &one),
            covariance,
        })
    }

    /// How far the two are apart beyond what their corrections explain.
    fn left(&self, group: &Group) -> Vec3 {
        let [one, other] = self.places;
        self.off - group.correction(other) + self.moved * group.correction(one)
    }
}

impl Group {
    fn of(members: &[usize], references: &[Reference]) -> Self {
        let together: Vec<Reference> = members.iter().map(|&member| references[member]).collect();
        let ties = pairs(&together, NEIGHBOURS)
            .par_iter()
            .filter_map(|pair| Tie::of(*pair, &together))
            .collect();
        let size = 3 * members.len();
        Self {
            members: members.to_vec(),
            focal_px: together
                .iter()
                .map(|reference| reference.camera.ptz().focal_px)
                .collect(),
            ties,
            corrections: DVector::zeros(size),
            covariance: DMatrix::zeros(size, size),
            is_adjusted: false,
        }
    }

    /// The ties that clicks can explain.
    fn believed(&self, labels: &[Label], scatter: Scatter) -> Vec<&Tie> {
        let known = |place: usize| labels[self.members[place]].scattered(scatter);
        let is_believed = |tie: &&Tie| {
            let [one, other] = tie.places.map(known);
            let all =
                tie.covariance * scatter.ties + tie.moved * one * tie.moved.transpose() + other;
            all.try_inverse().is_some_and(|inverse| {
                tie.off.dot(&(inverse * tie.off)) <= MOST_SIGMAS * MOST_SIGMAS
            })
        };
        self.ties.iter().filter(is_believed).collect()
    }

    /// Solves the least squares problem where clicks and ties scatter by so much.
    fn adjust(&mut self, labels: &[Label], scatter: Scatter) {
        let size = 3 * self.members.len();
        let (mut normal, mut right) = (
            DMatrix::<f64>::zeros(size, size),
            DVector::<f64>::zeros(size),
        );
        let mut add = |[row, column]: [usize; 2], block: Mat3| {
            let mut view = normal.fixed_view_mut::<3, 3>(3 * row, 3 * column);
            view += block;
        };
        for (place, &member) in self.members.iter().enumerate() {
            add(
                [place, place],
                labels[member]
                    .scattered(scatter)
                    .try_inverse()
                    .unwrap_or_else(Mat3::zeros),
            );
        }
        for tie in self.believed(labels, scatter) {
            let ([one, other], moved) = (tie.places, tie.moved);
            let Some(weight) = (tie.covariance * scatter.ties).try_inverse() else {
                continue;
            };
            add([other, other], weight);
            add([one, one], moved.transpose() * weight * moved);
            add([other, one], -weight * moved);
            add([one, other], -moved.transpose() * weight);
            let mut of_other = right.fixed_rows_mut::<3>(3 * other);
            of_other += weight * tie.off;
            let mut of_one = right.fixed_rows_mut::<3>(3 * one);
            of_one -= moved.transpose() * weight * tie.off;
        }
        // In units of each number's own σ, so that radians and px do not spoil the factorisation.
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

    /// χ² of all clicks after the adjustment, in the σ that they are taken to have.
    fn misfit_of_clicks(&self, labels: &[Label], scatter: Scatter) -> Misfit {
        let of_reference = |(place, &member): (usize, &usize)| {
            let (clicks, information) = (
                labels[member].misfit?,
                labels[member].covariance.try_inverse()?,
            );
            let by = self.correction(place);
            let explained = (self.covariance(place, place) * information).trace() / scatter.clicks;
            let expected = clicks.expected + (3.0 - explained).max(0.0);
            let chi_squared = clicks.chi_squared + by.dot(&(information * by));
            Some(Misfit {
                chi_squared: chi_squared.min(MOST_OF_ONE * scatter.clicks * expected),
                expected,
            })
        };
        self.members
            .iter()
            .enumerate()
            .filter_map(of_reference)
            .fold(Misfit::default(), |sum, one| sum + one)
    }

    /// The same of the ties.
    fn misfit_of_ties(&self, labels: &[Label], scatter: Scatter) -> Misfit {
        let of_tie = |tie: &Tie| {
            let ([one, other], information) = (tie.places, tie.covariance.try_inverse()?);
            let crossed = tie.moved * self.covariance(one, other);
            let explained = tie.moved * self.covariance(one, one) * tie.moved.transpose()
                + self.covariance(other, other)
                - crossed
                - crossed.transpose();
            let left = tie.left(self);
            let expected = (3.0 - (explained * information).trace() / scatter.ties).max(0.0);
            Some(Misfit {
                chi_squared: left.dot(&(information * left)),
                expected,
            })
        };
        self.believed(labels, scatter)
            .into_iter()
            .filter_map(of_tie)
            .fold(Misfit::default(), |sum, one| sum + one)
    }

    /// Whether a correction is as small as a label's error can be: what is linear here is that
    /// nowhere else.
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

impl Label {
    /// The covariance where clicks scatter by a multiple of what they are taken to.
    fn scattered(&self, scatter: Scatter) -> Mat3 {
        if self.misfit.is_some() {
            self.covariance * scatter.clicks
        } else {
            self.covariance
        }
    }
}
