//! Pose from candidate rays: the camera that most features agree on and its uncertainty, or the
//! reason why there is none (section 3.3 of the paper).
//!
//! # Problem
//!
//! A forest gives each feature of a picture up to five rays (pan and tilt) on which similar
//! features were seen. Most rays are wrong: players, repeated boards, chance. Find the pan, tilt
//! and focal length for which as many features as possible lie on one of their rays.
//!
//! # Method
//!
//! 1. **Consensus** (`consensus.rs`): RANSAC with the exact two-point solver. Pairs are drawn first
//!    from the features most similar to a reference (PROSAC: Chum and Matas, CVPR 2005), and far
//!    from each other, because a near pair hardly determines the focal length. Two points give four
//!    equations for three unknowns; a hypothesis that does not reproject both is rejected. The rest
//!    is scored by MSAC (Torr and Zisserman, 2000) over 400 features, and abandoned early if it
//!    falls behind. A new best hypothesis is refined over its inliers (Chum, Matas and Kittler,
//!    DAGM 2003).
//! 2. **Refinement over all features** ([`pose_from_candidates`]): candidates are assigned again,
//!    the noise is estimated from the median distance, and the camera is adjusted with a Cauchy
//!    loss of 95 % efficiency.
//! 3. **Covariance**. Features in one cell of the picture share the errors of their references and
//!    count as one: the covariance is inflated by the number of features per occupied cell of a 32
//!    × 18 grid.
//! 4. **Labels and base** ([`Pose::with_uncertainty`]). The steps above work in `base`, the frame of the
//!    rays. The uncertainty of the references' labels is added by `labels.rs`, that of the base by
//!    `Uncertainty`.
//! 5. **Probability** (`confidence.rs`): an answer less probable than required is rejected with a
//!    reason ([`NotFound`]).
//!
//! # Robustness
//!
//! Robust against 90 % of wrong candidates; against a board with any number of features (it is
//! narrow, and narrow evidence determines the camera badly); and against burnt-in graphics, which
//! are excluded beforehand (`features::burnt_in`).

use super::consensus::{Consensus, MIN_INLIERS, PoseOptions, SHORT_STEP, find_consensus};
use super::labels::label_covariance;
use super::not_found::NotFound;
use super::{Evidence, FromReference, RayMatches, SeenRange};
use crate::features::count_cells;
use nalgebra::SMatrix;
use serde::Serialize;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{self, ImagePoint, ImageSize, Mat3, Vec2, median_high, subsample};
use touchline_core::score::median_rayleigh;
use touchline_core::solve::{Loss, Observation, Uncertainty, covariance_in_radians, refine_until};

/// The camera that a picture's features agree on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pose {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Covariance of (pan deg, tilt deg, focal px). From [`pose_from_candidates`] it is that of the
    /// features alone, close ones counted as one; after relocalization it includes labels and base.
    #[serde(serialize_with = "geometry::rows")]
    pub covariance: Mat3,
    /// The same, given the base.
    #[serde(serialize_with = "geometry::rows")]
    pub own_covariance: Mat3,
    /// 1-σ of the overlay at the worst corner of the picture, px, by `covariance`.
    pub worst_corner_sigma_px: f64,
    /// The same for the covariance of the features alone.
    pub features_sigma_px: f64,
    /// The same for the covariance of features and labels, given the base.
    pub labelled_sigma_px: f64,
    /// Rotation and zoom relative to the nearest reference, if references are known.
    pub from_reference: FromReference,
    /// Upper bound of the stated probability, from answers about references left out of the
    /// training.
    pub at_most: f64,
    /// Root mean square distance of the inliers, px.
    pub rms_px: f64,
    /// The inliers, as indices into the matches.
    pub inliers: Vec<usize>,
    /// Number of cells of a 32 × 18 grid that contain an inlier: the many features of one board
    /// occupy few.
    pub places: usize,
    /// The smaller principal standard deviation of the inliers' positions, px at 1920 px width. A
    /// row of boards is long and narrow.
    pub breadth_px: f64,
    /// The probability that the overlay is right within 10 px at 1920 px width.
    pub confidence: f64,
    /// Number of hypotheses tried.
    pub hypotheses: usize,
}

impl Pose {
    /// The evidence for the pose in a picture of this size.
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

    /// Adds the uncertainty of labels and base to covariance and 1-σ, and updates the confidence.
    pub(super) fn with_uncertainty(
        mut self,
        matches: &RayMatches,
        base: &CameraBase,
        image_size: ImageSize,
        seen: &SeenRange,
    ) -> Self {
        // Errors of features and labels are independent; `Uncertainty` adds that of the base.
        let by_features = covariance_in_radians(&self.own_covariance);
        let by_labels =
            label_covariance((&self.ptz, &self.inliers), matches, base, image_size, seen);
        let camera = PtzCamera::new(*base, self.ptz);
        let own = by_features + by_labels;
        let stated = Uncertainty::from_covariance(&camera, own, image_size).ok();
        // A picture that shows too little leaves open how the camera follows an error of its base.
        // Then the camera is known given the base, and the overlay is not.
        let uncertainty = stated.unwrap_or(Uncertainty {
            clicks: own,
            by_base: SMatrix::zeros(),
            base_root: SMatrix::zeros(),
        });
        self.covariance = uncertainty.ptz_covariance_deg();
        self.own_covariance = uncertainty.own_covariance_deg();
        self.worst_corner_sigma_px = stated.map_or(f64::INFINITY, |stated| {
            stated.worst_corner_sigma_px(&camera, image_size)
        });
        // The probability is by the part given the base: an error of the base is common to all
        // frames, references included.
        let exact_base = uncertainty.with_exact_base();
        self.labelled_sigma_px = exact_base.worst_corner_sigma_px(&camera, image_size);
        self.from_reference = FromReference::from_nearest(&self.ptz, image_size, seen);
        self.at_most = seen.shown.at_most();
        self.confidence = self.evidence(image_size).confidence();
        self
    }

    /// The pose if its probability reaches `min_confidence`, else the reason for rejection.
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

/// Columns and rows of the grid whose occupied cells are counted.
const PLACES: (usize, usize) = (32, 18);

/// Rounds of assigning candidates and refining.
const ROUNDS: usize = 2;

/// Number of features used before the last round, which suffices for the noise and a start.
const FEATURES_AT_FIRST: usize = 200;

/// Scale of the Cauchy loss with 95 % efficiency for normal errors, in σ.
const CAUCHY: f64 = 2.3849;

/// Inlier threshold once the noise is known, in σ.
const INLIER_SIGMAS: f64 = 4.0;

/// Lower bound of the noise, px at 1920 px width: that of a keypoint.
const MIN_SIGMA_PX: f64 = 0.1;

/// The camera that most features agree on.
///
/// # Errors
/// [`NotFound`] names the reason why there is no pose.
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
    // Search at the origin: candidate rays are directions, so the position of the base does not
    // matter.
    let at_base = base.at_origin();
    let found = find_consensus(matches, &at_base, image_size, options);
    let Consensus {
        ptz: Some(start),
        hypotheses,
        agreeing,
    } = found
    else {
        return Err(no_agreement(matches, 0));
    };
    // Refine over all features, then apply the checks: enough inliers, and a pose within the
    // allowed ranges.
    let refined = refine_over_all(matches, &at_base, start, image_size, options)
        .ok_or_else(|| no_agreement(matches, agreeing))?;
    let Refinement {
        ptz,
        inliers,
        sigma_px,
        rms_px,
    } = refined;
    if inliers.len() < MIN_INLIERS {
        return Err(no_agreement(matches, inliers.len()));
    }
    if !options.allows(&ptz, image_size) {
        return Err(NotFound::Implausible {
            pan: ptz.pan,
            tilt: ptz.tilt,
            focal_px: ptz.focal_px,
        });
    }
    let camera = PtzCamera::new(at_base, ptz);
    let places = count_cells(
        inliers.iter().map(|&feature| matches.point(feature)),
        image_size,
        PLACES,
    );
    // Features in one cell share the errors of their references and count as one: n features in m
    // cells have their σ multiplied by √(n/m).
    let crowding = (inliers.len() as f64 / places as f64).sqrt();
    let observations: Vec<Observation> =
        matches.observations(&camera, inliers.iter().copied(), sigma_px * crowding);
    let uncertainty = Uncertainty::from_observations(&camera, &observations, None)
        .map_err(|_| no_agreement(matches, inliers.len()))?;
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

/// The reason why there is no pose if only this many features agree.
fn no_agreement(matches: &RayMatches, agreeing: usize) -> NotFound {
    NotFound::NoAgreement {
        matched: matches.len(),
        agreeing,
        needed: MIN_INLIERS,
    }
}

/// The standard deviation of points along the axis of least spread, px: the root of the smaller
/// eigenvalue of their 2 × 2 covariance, t/2 − √(t²/4 − d) with trace t and determinant d.
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
    // Rounding may make the discriminant of points on a circle, or the eigenvalue of points on a
    // line, slightly negative.
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

/// Robust refinement over all features that agree, with the noise estimated from them; `None` if
/// fewer than three agree in some round.
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
        // Assign to each feature its nearest candidate ray; keep those within the current
        // threshold.
        let near: Vec<(usize, f64)> = (0..matches.len())
            .filter_map(|feature| Some((feature, matches.nearest(&camera, feature)?.0.sqrt())))
            .filter(|(_, distance_px)| *distance_px <= within_px)
            .collect();
        if near.len() < 3 {
            return None;
        }
        let mut distances: Vec<f64> = near.iter().map(|(_, distance_px)| *distance_px).collect();
        // Distances of two-dimensional normal errors have a Rayleigh distribution; its median gives
        // σ robustly.
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
        // Adjust, and tighten the threshold to the noise. It never exceeds that of the search, so
        // that a large estimate of the noise cannot admit what the search rejected.
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
            SHORT_STEP,
        )
        .ptz;
        within_px = (INLIER_SIGMAS * sigma_px).min(widest_px);
    }
    None
}
