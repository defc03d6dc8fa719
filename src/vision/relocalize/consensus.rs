//! Two-point RANSAC on exact rays.
//!
//! Pairs are drawn first from the features most similar to a reference (as PROSAC does: Chum and
//! Matas, CVPR 2005). Distant pairs are preferred, because near ones hardly determine the focal
//! length. Two points give four equations for three unknowns: a hypothesis that does not reproject
//! both is rejected at once. The others are scored over all features, each by its best candidate,
//! and abandoned early if they fall far behind; a new best is refined over its inliers (Chum,
//! Matas, Kittler, DAGM 2003).

use super::RayMatches;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_core::solve::{Loss, PtzRanges, refine_until, solve_two_points};

/// The result of the search, not refined over all features.
pub(super) struct Consensus {
    /// The best camera; `None` if no pair of features gave one.
    pub ptz: Option<Ptz>,
    /// Number of inliers among the features scored.
    pub agreeing: usize,
    /// Number of pairs tried.
    pub hypotheses: usize,
}

/// Size of the pool from which the first pairs are drawn.
const FIRST_FEATURES: usize = 24;
/// The pool grows linearly and contains all features after at most this many pairs.
const GROWTH: usize = 300;
/// Minimum distance of a pair, as a share of the picture's width, and the number of draws to find a
/// distant one.
const MIN_SEPARATION: f64 = 0.1;
const DRAWS: usize = 6;
/// Probability that a feature is drawn with its most likely candidate.
const FIRST_CANDIDATE: f64 = 0.7;
/// Minimum number of pairs.
const MIN_HYPOTHESES: usize = 16;
/// A hypothesis is scored in blocks of features and abandoned if it has less than this share of the
/// score expected of the best so far.
const BLOCK: usize = 48;
const FAR_BEHIND: f64 = 0.3;
/// Number of features that score hypotheses, drawn once: more do not discriminate better.
const SCORED_FEATURES: usize = 400;
/// Maximum number of features that a new best is refined over.
const LOCAL_FEATURES: usize = 80;

/// Finds the camera that most features agree on. `base` is at the origin: the world is the base's
/// own frame.
pub(super) fn find_consensus(
    matches: &RayMatches,
    base: &CameraBase,
    image_size: ImageSize,
    options: &PoseOptions,
) -> Consensus {
    let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
    // Two orders of the features: pairs are drawn from the most similar ones, hypotheses are scored
    // by an unbiased sample in random order, of which every block is typical.
    let order = matches.by_distance();
    let mut shuffled = shuffled_indices(matches.len(), &mut rng);
    shuffled.truncate(SCORED_FEATURES);
    let agreement_px = options.agreement_px * image_size.scale_from_1920();
    let min_separation_px = MIN_SEPARATION * f64::from(image_size.width);
    let mut best = Best {
        ptz: None,
        score: 0.0,
        agreeing: 0,
    };
    let (mut hypotheses, mut wanted) = (0, options.max_hypotheses);
    while hypotheses < wanted {
        // Draw a pair from the growing pool, and a candidate ray for each of its features.
        hypotheses += 1;
        let pool = (FIRST_FEATURES + order.len() * hypotheses / GROWTH).min(order.len());
        let Some(pair) = draw_pair(matches, &order[..pool], min_separation_px, &mut rng) else {
            continue;
        };
        let rays = pair.map(|feature| draw_candidate(matches.rays(feature), &mut rng));
        let pixels = pair.map(|feature| matches.point(feature));
        let Ok(solutions) = solve_two_points(base, rays, pixels) else {
            continue;
        };
        // Up to two roots of the focal length. Cheap checks come first: the allowed ranges, then
        // reprojection of the pair.
        for ptz in solutions.iter() {
            if !options.allows(&ptz, image_size) {
                continue;
            }
            let camera = PtzCamera::new(*base, ptz);
            let reprojects = rays.into_iter().zip(pixels).all(|(ray, pixel)| {
                camera
                    .image_from_world(ray)
                    .is_ok_and(|image| image.distance_px(pixel) <= agreement_px)
            });
            if !reprojects {
                continue;
            }
            let Some((score, agreeing)) =
                score(matches, &camera, &shuffled, agreement_px, best.score)
            else {
                continue;
            };
            if score <= best.score {
                continue;
            }
            // Local optimisation of each new best, then a new estimate of the number of pairs
            // needed.
            best = Best {
                ptz: Some(ptz),
                score,
                agreeing,
            };
            // Fewer inliers are chance, and refinement over them is wasted.
            if agreeing >= MIN_INLIERS {
                best.improve(matches, base, &shuffled, agreement_px);
            }
            wanted = enough(best.agreeing as f64 / shuffled.len() as f64, options);
        }
    }
    Consensus {
        ptz: best.ptz,
        agreeing: best.agreeing,
        hypotheses,
    }
}

struct Best {
    ptz: Option<Ptz>,
    score: f64,
    agreeing: usize,
}

impl Best {
    /// Refines over inliers and keeps the result if its score is higher.
    fn improve(
        &mut self,
        matches: &RayMatches,
        base: &CameraBase,
        order: &[usize],
        agreement_px: f64,
    ) {
        let Some(start) = self.ptz else { return };
        let camera = PtzCamera::new(*base, start);
        let near = order
            .iter()
            .copied()
            .filter(|&feature| {
                matches
                    .nearest(&camera, feature)
                    .is_some_and(|(squared, _)| squared <= agreement_px * agreement_px)
            })
            .take(LOCAL_FEATURES);
        // The noise is not known yet. A third of the threshold as σ makes the Cauchy loss weigh an
        // inlier at the threshold by 1 / (1 + 3²), a tenth of the weight of an exact one.
        let observations = matches.observations(&camera, near, agreement_px / 3.0);
        let ptz = refine_until(
            base,
            start,
            &observations,
            Loss::Cauchy { c: 1.0 },
            None,
            SHORT_STEP,
        )
        .ptz;
        let refined = PtzCamera::new(*base, ptz);
        if let Some((score, agreeing)) = score(matches, &refined, order, agreement_px, self.score)
            && score > self.score
        {
            *self = Self {
                ptz: Some(ptz),
                score,
                agreeing,
            };
        }
    }
}

/// Number of pairs after which the probability of never having drawn a good one is
/// `miss_probability`, given the share of inliers: ln(miss) / ln(1 − good).
fn enough(share: f64, options: &PoseOptions) -> usize {
    // A pair is good if both features are inliers and both are drawn with the right candidate. The
    // clamp keeps the logarithm finite and off zero; a float too large for `usize` saturates.
    let good = (share * FIRST_CANDIDATE).powi(2).clamp(1e-9, 1.0 - 1e-9);
    let wanted = options.miss_probability.ln() / (-good).ln_1p();
    (wanted.ceil() as usize).clamp(
        MIN_HYPOTHESES.min(options.max_hypotheses),
        options.max_hypotheses,
    )
}

/// Draws two features: the first at random, the second as the most distant of some draws. `None` if
/// all are too close.
fn draw_pair(
    matches: &RayMatches,
    pool: &[usize],
    apart_px: f64,
    rng: &mut Pcg64Mcg,
) -> Option<[usize; 2]> {
    let first = pool[rng.random_range(0..pool.len())];
    let point = matches.point(first);
    let mut farthest = None::<(f64, usize)>;
    for _ in 0..DRAWS {
        let second = pool[rng.random_range(0..pool.len())];
        let distance_px = point.distance_px(matches.point(second));
        if farthest.is_none_or(|(most, _)| distance_px > most) {
            farthest = Some((distance_px, second));
        }
        // Three times the minimum, 0.3 of the width, is far enough to determine the focal length.
        if distance_px >= 3.0 * apart_px {
            break;
        }
    }
    farthest
        .filter(|(distance_px, _)| *distance_px >= apart_px)
        .map(|(_, second)| [first, second])
}

fn draw_candidate(rays: &[Vec3], rng: &mut Pcg64Mcg) -> Vec3 {
    if rays.len() == 1 || rng.random_bool(FIRST_CANDIDATE) {
        rays[0]
    } else {
        rays[rng.random_range(1..rays.len())]
    }
}

/// The sum of 1 − (distance / threshold)² over the inliers (MSAC; Torr and Zisserman, 2000), and
/// their number; `None` once the hypothesis cannot beat `best` or is far behind it.
fn score(
    matches: &RayMatches,
    camera: &PtzCamera,
    order: &[usize],
    agreement_px: f64,
    best: f64,
) -> Option<(f64, usize)> {
    let limit = agreement_px * agreement_px;
    let (mut score, mut agreeing, mut seen) = (0.0, 0, 0);
    for block in order.chunks(BLOCK) {
        for &feature in block {
            if let Some((squared, _)) = matches.nearest(camera, feature)
                && squared <= limit
            {
                score += 1.0 - squared / limit;
                agreeing += 1;
            }
        }
        seen += block.len();
        // Two bail-outs: even if all remaining features scored 1, it would not win; or it has less
        // than `FAR_BEHIND` of the score that the best has in as many features. The second may
        // reject a good hypothesis; features are shuffled, so that is rare.
        let rest = order.len() - seen;
        let expected = best * seen as f64 / order.len() as f64;
        if score + rest as f64 <= best || (rest > 0 && score + 1.0 < FAR_BEHIND * expected) {
            return None;
        }
    }
    Some((score, agreeing))
}

fn shuffled_indices(count: usize, rng: &mut Pcg64Mcg) -> Vec<usize> {
    use rand::seq::SliceRandom;
    let mut order: Vec<usize> = (0..count).collect();
    order.shuffle(rng);
    order
}

/// Refinement ends when a step in (pan rad, tilt rad, ln f) is below this: a thousandth of the
/// uncertainty that features leave.
pub(super) const SHORT_STEP: f64 = 1e-8;

/// Minimum number of inliers; fewer are chance.
pub(super) const MIN_INLIERS: usize = 6;

/// Options of the pose search.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseOptions {
    /// Inlier threshold, px at 1920 px width. Default: 6.
    pub agreement_px: f64,
    /// Allowed pan, tilt and focal length; `None` allows all that any camera could have.
    pub ranges: Option<PtzRanges>,
    /// Maximum number of hypotheses. Default: 4000; a small share of inliers needs many.
    pub max_hypotheses: usize,
    /// The search ends when the probability of having missed a better camera is below this.
    /// Default: 0.001.
    pub miss_probability: f64,
    /// Answers below this probability are "not found". Default: 0.5.
    pub min_confidence: f64,
    /// Seed of the random draws.
    pub seed: u64,
}

impl Default for PoseOptions {
    fn default() -> Self {
        Self {
            agreement_px: 6.0,
            ranges: None,
            max_hypotheses: 4000,
            miss_probability: 1e-3,
            min_confidence: 0.5,
            seed: 0,
        }
    }
}

impl PoseOptions {
    /// Whether an answer is within the allowed ranges.
    pub(super) fn allows(&self, ptz: &Ptz, image_size: ImageSize) -> bool {
        match &self.ranges {
            Some(ranges) => ranges.contains(ptz),
            None => PtzRanges::for_size(image_size).contains(ptz),
        }
    }
}
