//! Pose from candidate rays: the camera that most features agree on, how well it is known, or why
//! there is none (section 3.3 of the paper).
//!
//! # Problem
//!
//! A forest gives each feature of a picture up to a few rays (pan and tilt) in which its like was
//! seen. Most are wrong: players, boards that repeat, chance. Find the pan, tilt and focal length
//! under which as many features as possible lie on one of their rays.
//!
//! # Method
//!
//! 1. **Consensus** (`consensus.rs`): RANSAC with the exact two-point solver. Pairs are drawn from
//!    the features most alike to a reference first (PROSAC: Chum and Matas, CVPR 2005) and far from
//!    each other, because a near pair hardly fixes the focal length. Two points give four equations
//!    for three unknowns; a pair whose second point does not come back is dropped. The rest is
//!    scored by MSAC (Torr and Zisserman, 2000) over 400 features, and given up early where it
//!    falls behind. A new best is refined over its own features (Chum, Matas and Kittler, DAGM
//!    2003).
//! 2. **Refinement over all features** ([`pose_from_candidates`]): candidates are chosen again, the
//!    noise is measured from the median of the distances, and the camera is adjusted with a Cauchy
//!    loss of 95 % efficiency.
//! 3. **Covariance**. Features of one place share their references' errors and count as one: the
//!    normal equations are widened by features per place, on a grid of 32 × 18.
//! 4. **Labels and base** ([`Pose::stated`]). Everything above happens in the camera's base frame,
//!    where the rays are. What the references' labels leave open is added by `labels.rs`, the
//!    base's own covariance by `Uncertainty`.
//! 5. **Probability** (`confidence.rs`): an answer below the wanted one is none, and says so
//!    ([`NotFound`]).
//!
//! # What it is proof against
//!
//! 90 % of wrong candidates; one board with any number of features (it is narrow, and what narrow
//! evidence fixes is fixed badly); a graphic that stands on the screen, which is left out before
//! (`features::burnt_in`).

use super::consensus::{Consensus, find_consensus};
use super::labels::label_covariance;
use super::pose_options::{ENOUGH, MIN_INLIERS, PoseOptions};
use super::{Evidence, FromReference, NotFound, RayMatches, SeenRange};
use serde::Serialize;
use std::collections::BTreeSet;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec2, median_high, subsample};
use touchline_core::score::median_rayleigh;
use touchline_core::solve::{Loss, Observation, Uncertainty, covariance_in_radians, refine_until};

/// The camera that a picture's features agree on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Covariance of (pan deg, tilt deg, focal px): by the features alone, close ones counted as
    /// one, and once it is stated by labels and base as well.
    #[serde(serialize_with = "geometry::rows")]
    pub covariance: Mat3,
    /// The same with the base taken as exact.
    #[serde(serialize_with = "geometry::rows")]
    pub own_covariance: Mat3,
    /// 1-σ of the overlay at the worst corner of the picture, px, by the same.
    pub worst_corner_sigma_px: f64,
    /// The same by the features alone.
    pub features_sigma_px: f64,
    /// The same by features and labels, as if the base were exact.
    pub labelled_sigma_px: f64,
    /// How far the camera turned and zoomed from the nearest reference, where references are known.
    pub from_reference: FromReference,
    /// No greater probability is stated, by what references that were left out show.
    pub at_most: f64,
    /// Root mean square of the agreeing features' distances, px.
    pub rms_px: f64,
    /// The features that agree, by their number in the matches.
    pub inliers: Vec<usize>,
    /// In how many places of the picture features agree (cells of a 32 × 18 grid): one board's many
    /// features are few places.
    pub places: usize,
    /// How far the agreeing features spread where they spread least: the smaller standard deviation
    /// of their positions, px at 1920 px width. A row of boards is long and narrow.
    pub breadth_px: f64,
    /// The probability that the overlay is right within 10 px at 1920 px width.
    pub confidence: f64,
    /// Hypotheses tried.
    pub hypotheses: usize,
}

impl Pose {
    /// What speaks for it in a picture of this size.
    #[must_use]
    pub fn evidence(&self, image_size: ImageSize) -> Evidence {
        let scale = image_size.scale_from_1920();
        Evidence {
            breadth_px: self.breadth_px,
            features_sigma_px: self.features_sigma_px / scale,
            labelled_sigma_px: self.labelled_sigma_px / scale,
            from_reference: self.from_reference,
            at_most: self.at_most,
        }
    }

    /// The same with what the references' labels and the base leave open in its covariance and 1-σ,
    /// and its confidence by that.
    pub(super) fn stated(
        mut self,
        matches: &RayMatches,
        base: &CameraBase,
        image_size: ImageSize,
        seen: &SeenRange,
    ) -> Self {
        let by_features = covariance_in_radians(&self.own_covariance);
        let by_labels =
            label_covariance((&self.ptz, &self.inliers), matches, base, image_size, seen);
        let camera = PtzCamera::new(*base, self.ptz);
        if let Ok(uncertainty) = Uncertainty::of_known(&camera, by_features + by_labels, image_size)
        {
            self.covariance = uncertainty.ptz_covariance_deg();
            self.own_covariance = uncertainty.own_covariance_deg();
            self.worst_corner_sigma_px = uncertainty.worst_corner_sigma_px(&camera, image_size);
            let exact_base = uncertainty.with_exact_base();
            self.labelled_sigma_px = exact_base.worst_corner_sigma_px(&camera, image_size);
        }
        self.from_reference = FromReference::of(&self.ptz, image_size, seen);
        self.at_most = seen.shown.at_most();
        self.confidence = self.evidence(image_size).confidence();
        self
    }

    /// The pose, if it is right with at least this probability.
    pub(super) fn if_sure(self, min_confidence: f64) -> Result<Self, NotFound> {
        if self.confidence >= min_confidence {
            return Ok(self);
        }
        let (confidence, inliers, places) = (self.confidence, self.inliers.len(), self.places);
        Err(NotFound::Unsure {
            confidence,
            inliers,
            places,
            worst_corner_sigma_px: self.worst_corner_sigma_px,
        })
    }
}

/// Columns and rows of the grid by which the places of agreeing features are counted.
const PLACES: (f64, f64) = (32.0, 18.0);

/// Rounds of choosing candidates and refining over all of them.
const ROUNDS: usize = 2;

/// Features that a round before the last is content with: it has to find the noise, and a start.
const FEATURES_AT_FIRST: usize = 200;

/// The Cauchy constant of 95 % efficiency, sigmas.
const CAUCHY: f64 = 2.3849;

/// Features beyond this do not agree once the noise is known, sigmas.
const INLIER_SIGMAS: f64 = 4.0;

/// No noise is taken to be smaller, px at 1920 px width: a keypoint's own.
const MIN_SIGMA_PX: f64 = 0.1;

/// The camera that most features agree on.
///
/// # Errors
/// By name, why there is none: see [`NotFound`].
pub fn pose_from_candidates(
    matches: &RayMatches,
    base: &CameraBase,
    image_size: ImageSize,
    options: &PoseOptions,
) -> Result<Pose, NotFound> {
    if matches.len() < MIN_INLIERS {
        return Err(NotFound::FewMatches {
            matched: matches.len(),
            needed: MIN_INLIERS,
        });
    }
    let at_base = base.at_origin();
    let found = find_consensus(matches, &at_base, image_size, options);
    let needed = MIN_INLIERS;
    let Consensus {
        ptz: Some(start),
        hypotheses,
        agreeing,
    } = found
    else {
        return Err(NotFound::NoAgreement {
            matched: matches.len(),
            agreeing: 0,
            needed,
        });
    };
    let no_agreement = |agreeing: usize| NotFound::NoAgreement {
        matched: matches.len(),
        agreeing,
        needed,
    };
    let refined = refine_over_all(matches, &at_base, start, image_size, options)
        .ok_or_else(|| no_agreement(agreeing))?;
    let Refinement {
        ptz,
        inliers,
        sigma_px,
        rms_px,
    } = refined;
    if inliers.len() < MIN_INLIERS {
        return Err(no_agreement(inliers.len()));
    }
    if !options.allows(&ptz, image_size) {
        return Err(NotFound::Implausible {
            pan: ptz.pan,
            tilt: ptz.tilt,
            focal_px: ptz.focal_px,
        });
    }
    let camera = PtzCamera::new(at_base, ptz);
    let places = places(
        inliers.iter().map(|&feature| matches.point(feature)),
        image_size,
    );
    // Features of one place share their references' errors: they count as one.
    let crowding = (inliers.len() as f64 / places as f64).sqrt();
    let observations: Vec<Observation> =
        matches.observations(&camera, inliers.iter().copied(), sigma_px * crowding);
    let uncertainty =
        Uncertainty::of(&camera, &observations, None).map_err(|_| no_agreement(inliers.len()))?;
    let worst_corner_sigma_px = uncertainty.worst_corner_sigma_px(&camera, image_size);
    let breadth_px = breadth(inliers.iter().map(|&feature| matches.point(feature)))
        / image_size.scale_from_1920();
    let mut pose = Pose {
        ptz,
        covariance: uncertainty.ptz_covariance_deg(),
        own_covariance: uncertainty.own_covariance_deg(),
        worst_corner_sigma_px,
        features_sigma_px: worst_corner_sigma_px,
        labelled_sigma_px: worst_corner_sigma_px,
        from_reference: FromReference::default(),
        at_most: 1.0,
        rms_px,
        inliers,
        places,
        breadth_px,
        confidence: 0.0,
        hypotheses,
    };
    pose.confidence = pose.evidence(image_size).confidence();
    pose.if_sure(options.min_confidence)
}

/// In how many cells of the grid points lie.
fn places(points: impl Iterator<Item = ImagePoint>, image_size: ImageSize) -> usize {
    let (width, height) = (f64::from(image_size.width), f64::from(image_size.height));
    let cell = |point: ImagePoint| {
        (
            (point.x / width * PLACES.0) as i32,
            (point.y / height * PLACES.1) as i32,
        )
    };
    points.map(cell).collect::<BTreeSet<_>>().len()
}

/// The smaller standard deviation of points, along the axis on which they spread least, px.
fn breadth(points: impl Iterator<Item = ImagePoint> + Clone) -> f64 {
    let count = points.clone().count().max(1) as f64;
    let middle = points
        .clone()
        .fold(Vec2::zeros(), |sum, at| sum + Vec2::new(at.x, at.y))
        / count;
    let spread = points
        .map(|at| Vec2::new(at.x, at.y) - middle)
        .map(|by| by * by.transpose());
    let spread = spread.fold(nalgebra::Matrix2::zeros(), |sum, one| sum + one) / count;
    let half_trace = spread.trace() / 2.0;
    (half_trace
        - (half_trace * half_trace - spread.determinant())
            .max(0.0)
            .sqrt())
    .max(0.0)
    .sqrt()
}

struct Refinement {
    ptz: Ptz,
    inliers: Vec<usize>,
    sigma_px: f64,
    rms_px: f64,
}

/// Robust refinement over all features that agree, the noise measured from them; none if too few
/// agree on the way.
fn refine_over_all(
    matches: &RayMatches,
    base: &CameraBase,
    start: Ptz,
    image_size: ImageSize,
    options: &PoseOptions,
) -> Option<Refinement> {
    let scale = image_size.scale_from_1920();
    let widest_px = options.agreement_px * scale;
    let (mut ptz, mut within_px) = (start, widest_px);
    for round in 0.. {
        let camera = PtzCamera::new(*base, ptz);
        let near: Vec<(usize, f64)> = (0..matches.len())
            .filter_map(|feature| Some((feature, matches.nearest(&camera, feature)?.0.sqrt())))
            .filter(|(_, distance_px)| *distance_px <= within_px)
            .collect();
        if near.len() < 3 {
            return None;
        }
        let mut distances: Vec<f64> = near.iter().map(|(_, distance_px)| *distance_px).collect();
        let sigma_px = (median_high(&mut distances)? / median_rayleigh()).max(MIN_SIGMA_PX * scale);
        if round == ROUNDS {
            let rms_px =
                (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt();
            let inliers = near.into_iter().map(|(feature, _)| feature).collect();
            return Some(Refinement {
                ptz,
                inliers,
                sigma_px,
                rms_px,
            });
        }
        let most = if round + 1 < ROUNDS {
            FEATURES_AT_FIRST
        } else {
            near.len()
        };
        let some = subsample(&near, most).map(|(feature, _)| *feature);
        let observations = matches.observations(&camera, some, sigma_px);
        ptz = refine_until(
            base,
            ptz,
            &observations,
            Loss::Cauchy { c: CAUCHY },
            None,
            ENOUGH,
        )
        .ptz;
        within_px = (INLIER_SIGMAS * sigma_px).min(widest_px);
    }
    None
}
