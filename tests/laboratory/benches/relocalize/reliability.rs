//! What the confidence is worth: the curve that `relocalize` uses is fitted here, and tried on
//! matches it has not seen.
//!
//! Real frames: every clip of a match answered by 1 to all references of its other clips, so that
//! many answers are wrong. Drawn ones: exact rays among ever more that are chance, and a picture
//! with one advertising board repeated twenty times. Right is an overlay within 10 px at 1920 px
//! width: the median of people's clicks, or the root mean square over the picture.

use super::pose::{SIZE, base, draw_matches, normal};
use super::scouting::{MATCHES, ScoutedFrame, answer, document, unsure, usable};
use super::set::{Set, grown};
use nalgebra::{SMatrix, SVector};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchline::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline::features::FeatureOptions;
use touchline::geometry::{ImagePoint, ImageSize};
use touchline::relocalize::{
    Evidence, Pose, RayCandidate, RayMatches, TrainOptions, pose_from_candidates,
};

const TERMS: usize = Evidence::TERMS;
type Terms = SVector<f64, TERMS>;

/// An answer: where it is from, what speaks for it, and whether it is right.
struct Example {
    set: usize,
    terms: Terms,
    confidence: f64,
    right: bool,
    /// Off by more than 20 px.
    wrong: bool,
    /// What it counts in the fit: drawn ones are no sample of what happens.
    weight: f64,
}

impl Example {
    fn of(set: usize, pose: &Pose, size: ImageSize, error_px: f64) -> Self {
        Self {
            set,
            terms: Terms::from(pose.evidence(size).terms()),
            confidence: pose.confidence,
            right: error_px <= 10.0,
            wrong: error_px > 20.0,
            weight: if set < MATCHES.len() { 1.0 } else { 0.3 },
        }
    }
}

pub fn reliability(data: &Path) {
    let mut examples = real(data);
    let counted = examples.len();
    examples.extend(hard(MATCHES.len()));
    let right = examples.iter().filter(|example| example.right).count();
    println!(
        "\n## reliability: {counted} answers on real frames, {} on drawn ones, {right} of all right\n",
        examples.len() - counted
    );
    let every: Vec<&Example> = examples.iter().collect();
    println!("fitted to all: {:.3?}\n", fit_curve(&every).as_slice());
    println!(
        "| answers of | not seen in the fit: given (≥ 0.5), of the right ones, off by over 20 px | as built: the same |"
    );
    println!("|---|---|---|");
    let mut unseen = Vec::new();
    for set in 0..=MATCHES.len() {
        let others: Vec<&Example> = examples
            .iter()
            .filter(|example| example.set != set)
            .collect();
        let (curve, built) = (fit_curve(&others), |example: &Example| example.confidence);
        let own: Vec<&Example> = examples
            .iter()
            .filter(|example| example.set == set)
            .collect();
        let name = MATCHES.get(set).copied().unwrap_or("drawn");
        println!(
            "| {name} | {} | {} |",
            row(&own, |example| probability(&curve, example)),
            row(&own, built)
        );
        unseen.extend(
            own.iter()
                .map(|example| (probability(&curve, example), example.right)),
        );
    }
    println!(
        "| all | – | {} |",
        row(&every, |example| example.confidence)
    );
    let scores = |p: &dyn Fn(f64) -> f64| {
        let sum = |of: fn(f64, f64) -> f64| {
            unseen
                .iter()
                .map(|(given, right)| of(p(*given), f64::from(u8::from(*right))))
                .sum::<f64>()
                / unseen.len() as f64
        };
        let brier = sum(|p, right| (p - right).powi(2));
        let log = sum(|p, right| -(right * p + (1.0 - right) * (1.0 - p)).max(1e-12).ln());
        format!("{brier:.4}, {log:.4}")
    };
    let rate = unseen.iter().filter(|(_, right)| *right).count() as f64 / unseen.len() as f64;
    println!(
        "\nBrier and logarithmic score of what was not seen: {}; of the share of right ones: {}",
        scores(&|p| p),
        scores(&|_| rate)
    );
    println!("\n| confidence, not seen in the fit | answers | stated | right |");
    println!("|---|---|---|---|");
    for &[least, most] in [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 0.999, 1.01].array_windows() {
        let inside: Vec<&(f64, bool)> = unseen
            .iter()
            .filter(|(p, _)| (least..most).contains(p))
            .collect();
        let count = inside.len();
        let stated = inside.iter().map(|(p, _)| p).sum::<f64>() / count as f64;
        let right = inside.iter().filter(|(_, right)| *right).count() as f64 / count as f64;
        println!(
            "| {least} – {} | {count} | {stated:.4} | {right:.4} |",
            f64::min(most, 1.0)
        );
    }
}

fn row(examples: &[&Example], confidence: impl Fn(&Example) -> f64) -> String {
    let given: Vec<&&Example> = examples
        .iter()
        .filter(|example| confidence(example) >= 0.5)
        .collect();
    let right = examples
        .iter()
        .filter(|example| example.right)
        .count()
        .max(1);
    let kept = given.iter().filter(|example| example.right).count();
    let wrong = given.iter().filter(|example| example.wrong).count();
    let share = 100.0 / given.len().max(1) as f64;
    format!(
        "{}, {:.1} %, {wrong} ({:.2} %)",
        given.len(),
        100.0 * kept as f64 / right as f64,
        wrong as f64 * share
    )
}

fn real(data: &Path) -> Vec<Example> {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut examples = Vec::new();
    for (number, name) in MATCHES.iter().enumerate() {
        let folder = data.join(format!("scouting-{name}"));
        let set = Set::from_document(document(data, name), &folder, &FeatureOptions::default());
        let field = set.document.field.model(&folder).unwrap();
        let usable = usable(&set);
        for references in [1, 1, 1, 2, 2, 3, 5, 8, usize::MAX] {
            let mut clips: Vec<_> = usable
                .iter()
                .map(|&i| set.document.frames[i].clip.clone())
                .collect();
            clips.sort();
            clips.dedup();
            for clip in clips {
                let (asked, mut training_frames): (Vec<usize>, Vec<usize>) = usable
                    .iter()
                    .copied()
                    .partition(|&i| set.document.frames[i].clip == clip);
                training_frames.shuffle(&mut rng);
                training_frames.truncate(references);
                let (samples, seen) = set.samples(&training_frames, usize::MAX);
                let forest = grown(&samples, &TrainOptions::default());
                for frame in asked {
                    let found = answer(&set, frame, (&forest, &seen), &field, &unsure());
                    let ScoutedFrame {
                        relocalized,
                        error_px,
                        ..
                    } = &found;
                    if let Ok(pose) = &relocalized.pose {
                        let size = set.features[frame].image_size;
                        examples.push(Example::of(number, pose, size, *error_px));
                    }
                }
            }
        }
    }
    examples
}

/// Drawn answers: chance among few that agree, and boards.
fn hard(set: usize) -> Vec<Example> {
    let base = base();
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let mut examples = Vec::new();
    for i in 0..900 {
        let (truth, matches) = match i % 9 {
            0 => draw_matches(&base, 0.9, &mut rng),
            1 => draw_matches(&base, 0.95, &mut rng),
            2 => draw_matches(&base, 0.97, &mut rng),
            3 => draw_matches(&base, 1.0, &mut rng),
            4 => boards(&base, true, &mut rng),
            5 => boards(&base, false, &mut rng),
            _ => chance(&mut rng),
        };
        if let Ok(pose) = pose_from_candidates(&matches, &base, SIZE, &unsure().pose) {
            examples.push(Example::of(
                set,
                &pose,
                SIZE,
                overlay_error_px(&base, truth, pose.ptz),
            ));
        }
    }
    examples
}

/// Up to a thousand features with up to four candidates each, none of them right.
fn chance(rng: &mut Pcg64Mcg) -> (Ptz, RayMatches) {
    let (features, candidates) = (rng.random_range(200..1000), rng.random_range(1..=4));
    let mut matches = RayMatches::new();
    for _ in 0..features {
        let at = ImagePoint::new(rng.random_range(0.0..1280.0), rng.random_range(0.0..720.0));
        let anywhere = |rng: &mut Pcg64Mcg| {
            let ray =
                PanTilt::from_degrees(rng.random_range(-60.0..60.0), rng.random_range(-35.0..5.0));
            RayCandidate {
                ray,
                squared_distance: 0.1,
            }
        };
        let rays: Vec<RayCandidate> = (0..candidates).map(|_| anywhere(rng)).collect();
        matches.push(at, &rays);
    }
    (Ptz::from_degrees(0.0, -10.0, 3000.0), matches)
}

/// One board stands twenty times along the picture, and its features take it for any of its copies;
/// another of 33 features in a patch of 21 × 8 px says consistently that it is elsewhere. Where
/// `hidden`, next to nothing else is known.
fn boards(base: &CameraBase, hidden: bool, rng: &mut Pcg64Mcg) -> (Ptz, RayMatches) {
    let (truth, mut matches) = draw_matches(base, if hidden { 1.0 } else { 0.9 }, rng);
    let (camera, (elsewhere, _)) = (PtzCamera::new(*base, truth), draw_matches(base, 1.0, rng));
    let other = PtzCamera::new(*base, elsewhere);
    let mut add = |at: ImagePoint, seen: ImagePoint, camera: &PtzCamera, rng: &mut Pcg64Mcg| {
        let at = ImagePoint::new(at.x + 0.5 * normal(rng), at.y + 0.5 * normal(rng));
        let ray = camera.ray_from_image(seen).unwrap();
        matches.push(
            at,
            &[RayCandidate {
                ray,
                squared_distance: 0.05,
            }],
        );
    };
    let row_y = rng.random_range(150.0..450.0);
    for copy in 0..20 {
        // All take themselves for the next but some, or each for another.
        let taken = if rng.random_bool(0.5) {
            (copy + 3) % 20
        } else {
            rng.random_range(0..20)
        };
        for part in 0..4 {
            let place = |copy: u32| {
                ImagePoint::new(40.0 + 60.0 * f64::from(copy) + 9.0 * f64::from(part), row_y)
            };
            add(place(copy), place(taken), &camera, rng);
        }
    }
    let corner = ImagePoint::new(
        rng.random_range(100.0..1100.0),
        rng.random_range(100.0..600.0),
    );
    for _ in 0..33 {
        let at = ImagePoint::new(
            corner.x + rng.random_range(0.0..21.0),
            corner.y + rng.random_range(0.0..8.0),
        );
        add(at, at, &other, rng);
    }
    (truth, matches)
}

/// The root mean square over the picture of how far an overlay is off, px at 1920 px width.
fn overlay_error_px(base: &CameraBase, truth: Ptz, ptz: Ptz) -> f64 {
    let (truth, camera) = (PtzCamera::new(*base, truth), PtzCamera::new(*base, ptz));
    let grid = (0..15).map(|i| ImagePoint::new(f64::from(i % 5) * 320.0, f64::from(i / 5) * 360.0));
    let squares = grid.map(|at| {
        let image = camera.image_from_ray(truth.ray_from_image(at).unwrap());
        image.map_or(f64::INFINITY, |image| image.distance_px(at).powi(2))
    });
    (squares.sum::<f64>() / 15.0).sqrt() / SIZE.scale_from_1920()
}

fn probability(curve: &Terms, example: &Example) -> f64 {
    1.0 / (1.0 + (-curve.dot(&example.terms)).exp())
}

/// The logistic curve of greatest likelihood, held back a little (Newton's method).
fn fit_curve(examples: &[&Example]) -> Terms {
    let mut curve = Terms::zeros();
    for _ in 0..50 {
        let mut gradient = -curve * 0.1;
        let mut hessian = SMatrix::<f64, TERMS, TERMS>::identity() * 0.1;
        for example in examples {
            let p = probability(&curve, example);
            gradient += example.terms * (f64::from(u8::from(example.right)) - p) * example.weight;
            hessian += example.terms
                * example.terms.transpose()
                * ((p * (1.0 - p)).max(1e-6) * example.weight);
        }
        let step = hessian.try_inverse().unwrap() * gradient;
        curve += step * (1.0 / step.norm().max(1.0)).max(0.2);
    }
    curve
}
