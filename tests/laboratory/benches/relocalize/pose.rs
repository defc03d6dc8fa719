//! The pose stage alone.

use super::set::{quantile, rotation_error_deg};
use super::time::seconds;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchline::camera::{BaseAngles, CameraBase, PanTilt, Ptz, PtzCamera};
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::relocalize::{Pose, PoseOptions, RayCandidate, RayMatches, pose_from_candidates};
use touchline::store::read;

pub const SIZE: ImageSize = ImageSize::new(1280, 720);
const FRAMES: usize = 1000;
const POINTS: usize = 200;

/// Exact rays, pixels with noise of 1 px, and a share of rays that have nothing to do with their
/// pixels; none is told from another by its distance.
pub fn exact() {
    println!(
        "\n## pose from exact rays: {FRAMES} frames of {POINTS} points, 1 px of noise, every answer counted\n"
    );
    println!(
        "| outliers | within 1° | rotation error median (deg) | focal error median (px) | ms | pairs, median | in the default's answers: share, wrong |"
    );
    println!("|---|---|---|---|---|---|---|");
    let base = base();
    for share in [0.0, 0.5, 0.8, 0.9] {
        let mut rng = Pcg64Mcg::seed_from_u64((share * 10.0) as u64);
        let frames: Vec<(Ptz, RayMatches)> = (0..FRAMES)
            .map(|_| draw_matches(&base, share, &mut rng))
            .collect();
        // Whatever is found, however unsure.
        let any = PoseOptions {
            min_confidence: 0.0,
            ..PoseOptions::default()
        };
        let (poses, time_s) = seconds(|| -> Vec<Option<Pose>> {
            frames
                .iter()
                .map(|(_, matches)| pose_from_candidates(matches, &base, SIZE, &any).ok())
                .collect()
        });
        let found = || {
            poses
                .iter()
                .zip(&frames)
                .filter_map(|(pose, (truth, _))| Some((pose.as_ref()?, *truth)))
        };
        let mut turned: Vec<f64> = found()
            .map(|(pose, truth)| rotation_error_deg(pose.ptz, truth))
            .collect();
        let mut focal: Vec<f64> = found()
            .map(|(pose, truth)| (pose.ptz.focal_px - truth.focal_px).abs())
            .collect();
        let mut pairs: Vec<f64> = found().map(|(pose, _)| pose.hypotheses as f64).collect();
        let within = turned.iter().filter(|degrees| **degrees < 1.0).count() as f64 / FRAMES as f64;
        let given: Vec<bool> = found()
            .filter(|(pose, _)| pose.confidence >= PoseOptions::default().min_confidence)
            .map(|(pose, truth)| rotation_error_deg(pose.ptz, truth) < 1.0)
            .collect();
        println!(
            "| {:.0} % | {within:.3} | {:.4} | {:.2} | {:.2} | {:.0} | {:.3}, {} |",
            100.0 * share,
            quantile(&mut turned, 0.5),
            quantile(&mut focal, 0.5),
            time_s * 1e3 / FRAMES as f64,
            quantile(&mut pairs, 0.5),
            given.len() as f64 / FRAMES as f64,
            given.iter().filter(|right| !**right).count(),
        );
    }
}

pub fn base() -> CameraBase {
    let level = BaseAngles::default().base_from_world();
    CameraBase::new(Vec3::new(0.0, -60.0, 18.0), level, SIZE.centre())
}

pub fn draw_matches(base: &CameraBase, outliers: f64, rng: &mut Pcg64Mcg) -> (Ptz, RayMatches) {
    let (pan, tilt) = (rng.random_range(-40.0..40.0), rng.random_range(-20.0..-5.0));
    let camera = PtzCamera::new(
        *base,
        Ptz::from_degrees(pan, tilt, rng.random_range(1500.0..5000.0)),
    );
    let mut matches = RayMatches::new();
    for i in 0..POINTS {
        let at = ImagePoint::new(rng.random_range(0.0..1280.0), rng.random_range(0.0..720.0));
        let outlier = (i as f64) < outliers * POINTS as f64;
        let ray = if outlier {
            PanTilt::from_degrees(rng.random_range(-60.0..60.0), rng.random_range(-35.0..5.0))
        } else {
            camera.ray_from_image(at).unwrap()
        };
        let noisy = ImagePoint::new(at.x + normal(rng), at.y + normal(rng));
        matches.push(
            noisy,
            &[RayCandidate {
                ray,
                squared_distance: 0.1,
            }],
        );
    }
    (camera.ptz(), matches)
}

/// A standard normal number (Box and Muller).
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    let (one, other): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - one).ln()).sqrt() * (std::f64::consts::TAU * other).cos()
}

/// The authors' approximate candidate rays.
pub fn candidates(data: &Path) {
    let document = read(&data.join("rendered/train.json")).unwrap().1;
    let base = CameraBase {
        principal_point: ImagePoint::new(640.5, 360.5),
        ..document.cameras[0].base().unwrap()
    };
    let frames: Vec<(Ptz, RayMatches)> = (0..30)
        .map(|number| authors(&data.join(format!("rendered/candidates/{number:05}.txt"))))
        .collect();
    let (poses, time_s) = seconds(|| -> Vec<Option<Pose>> {
        let options = PoseOptions::default();
        frames
            .iter()
            .map(|(_, matches)| pose_from_candidates(matches, &base, SIZE, &options).ok())
            .collect()
    });
    let found = || {
        poses
            .iter()
            .zip(&frames)
            .filter_map(|(pose, (truth, _))| Some((pose.as_ref()?.ptz, *truth)))
    };
    let mut turned: Vec<f64> = found()
        .map(|(ptz, truth)| rotation_error_deg(ptz, truth))
        .collect();
    let mut focal: Vec<f64> = found()
        .map(|(ptz, truth)| (ptz.focal_px - truth.focal_px).abs())
        .collect();
    println!("\n## candidates: {} of 30 found\n", turned.len());
    println!(
        "rotation error {:.4} / {:.4} deg, focal error {:.2} / {:.2} px (median / 90 %), {:.2} ms a frame",
        quantile(&mut turned, 0.5),
        quantile(&mut turned, 0.9),
        quantile(&mut focal, 0.5),
        quantile(&mut focal, 0.9),
        time_s * 1e3 / 30.0,
    );
}

fn authors(path: &Path) -> (Ptz, RayMatches) {
    let text = std::fs::read_to_string(path).unwrap();
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();
    let mut matches = RayMatches::new();
    let mut at = 4;
    while at < numbers.len() {
        let point = ImagePoint::new(numbers[at] + 0.5, numbers[at + 1] + 0.5);
        let count = numbers[at + 2] as usize;
        let rays = numbers[at + 3..at + 3 + 2 * count]
            .as_chunks::<2>()
            .0
            .iter();
        let rays: Vec<RayCandidate> = rays
            .map(|[pan, tilt]| RayCandidate {
                ray: PanTilt::from_degrees(*pan, *tilt),
                squared_distance: 0.1,
            })
            .collect();
        matches.push(point, &rays);
        at += 3 + 2 * count;
    }
    (
        Ptz::from_degrees(numbers[0], numbers[1], numbers[2]),
        matches,
    )
}
