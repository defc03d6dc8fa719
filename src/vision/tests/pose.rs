//! Pose from candidate rays: exact where it can be, within the noise where it cannot, and by name
//! where there is none.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::rotation::{angle_between, q_pan, q_tilt};
use touchline_core::geometry::{ImagePoint, ImageSize, quantile};
use touchline_core::testing::seeded::{normal, rng};
use touchline_core::testing::{TestBase, base_at};
use touchline_vision::relocalize::{
    NotFound, Pose, PoseOptions, RayCandidate, RayMatches, pose_from_candidates,
};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn base(k1: f64) -> CameraBase {
    let base = base_at([0.0, -60.0, 18.0], SIZE);
    base.bent(k1)
}

fn random_ptz(rng: &mut Pcg64Mcg) -> Ptz {
    let (pan, tilt) = (rng.random_range(-40.0..40.0), rng.random_range(-20.0..-5.0));
    Ptz::from_degrees(pan, tilt, rng.random_range(1500.0..5000.0))
}

fn candidate(ray: PanTilt) -> RayCandidate {
    RayCandidate {
        ray,
        squared_distance: 0.1,
    }
}

fn anywhere(rng: &mut Pcg64Mcg) -> PanTilt {
    PanTilt::from_degrees(rng.random_range(-60.0..60.0), rng.random_range(-35.0..5.0))
}

fn point(rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(rng.random_range(0.0..1280.0), rng.random_range(0.0..720.0))
}

/// Points with noise in px; a share of them has rays that have nothing to do with them.
fn noisy(
    camera: &PtzCamera,
    count: usize,
    outliers: f64,
    sigma_px: f64,
    rng: &mut Pcg64Mcg,
) -> RayMatches {
    let mut matches = RayMatches::new();
    for i in 0..count {
        let at = point(rng);
        let outlier = (i as f64) < outliers * count as f64;
        let ray = if outlier {
            anywhere(rng)
        } else {
            camera.ray_from_image(at).unwrap()
        };
        let noisy = ImagePoint::new(at.x + sigma_px * normal(rng), at.y + sigma_px * normal(rng));
        matches.push(noisy, &[candidate(ray)]);
    }
    matches
}

fn rotation_error_deg(a: Ptz, b: Ptz) -> f64 {
    let turned = |ptz: Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
    angle_between(&turned(a), &turned(b)).degrees()
}

fn pose_of(matches: &RayMatches, k1: f64) -> Result<Pose, NotFound> {
    pose_from_candidates(matches, &base(k1), SIZE, &PoseOptions::default())
}

#[test]
fn exact_rays_give_the_exact_camera() {
    let mut rng = rng("exact_rays_give_the_exact_camera");
    for k1 in [0.0, -0.1, 0.2] {
        for _ in 0..10 {
            let camera = PtzCamera::new(base(k1), random_ptz(&mut rng));
            let pose = pose_of(&noisy(&camera, 60, 0.0, 0.0, &mut rng), k1).unwrap();
            assert!(
                rotation_error_deg(pose.ptz, camera.ptz()) < 1e-8,
                "k1 {k1}: {pose:?}"
            );
            assert!(
                (pose.ptz.focal_px - camera.ptz().focal_px).abs() < 1e-5,
                "k1 {k1}: {pose:?}"
            );
            assert_eq!(pose.inliers.len(), 60);
            assert!(pose.confidence > 0.95);
        }
    }
}

/// What two-point RANSAC with exact rays and a last refinement over all inliers reaches with 200
/// points and 1 px of noise: share of outliers, share of frames within 1°, median errors of
/// rotation (deg) and focal length (px).
const EXACT_METHOD: [(f64, f64, f64, f64); 4] = [
    (0.0, 1.0, 0.0020, 0.50),
    (0.5, 1.0, 0.0029, 0.71),
    (0.8, 1.0, 0.0044, 1.0),
    (0.9, 0.977, 0.0067, 1.3),
];

#[test]
fn outliers_are_survived_as_well_as_with_the_exact_method_and_the_covariance_is_honest() {
    let mut rng = rng("outliers_are_survived_and_the_covariance_is_honest");
    for (outliers, share, rotation_deg, focal_px) in EXACT_METHOD {
        let (mut covered, frames) = (0, 40);
        let (mut rotations, mut focals) = (Vec::new(), Vec::new());
        for _ in 0..frames {
            let camera = PtzCamera::new(base(0.0), random_ptz(&mut rng));
            let Ok(pose) = pose_of(&noisy(&camera, 200, outliers, 1.0, &mut rng), 0.0) else {
                continue;
            };
            rotations.push(rotation_error_deg(pose.ptz, camera.ptz()));
            let sigma = pose.covariance.diagonal().map(f64::sqrt);
            let error = (pose.ptz.focal_px - camera.ptz().focal_px).abs();
            covered += usize::from(error < 2.6 * sigma.z);
            focals.push(error);
        }
        let right = rotations
            .iter()
            .filter(|degrees: &&f64| **degrees < 1.0)
            .count();
        let [rotation, focal] = [rotations, focals].map(|mut errors| {
            errors.sort_by(f64::total_cmp);
            quantile(&errors, 0.5)
        });
        println!(
            "{outliers}: {right} of {frames}, {rotation:.4}°, {focal:.2} px, {covered} within 2.6 sigma"
        );
        assert!(
            right as f64 >= share * frames as f64 - 0.5,
            "{outliers}: {right} of {frames} right"
        );
        assert!(
            rotation <= rotation_deg && focal <= focal_px,
            "{outliers}: {rotation}°, {focal} px"
        );
        assert!(
            covered >= frames * 9 / 10,
            "{outliers}: {covered} of {frames} within 2.6 sigma"
        );
    }
}

#[test]
fn a_feature_counts_by_its_best_candidate() {
    let mut rng = rng("a_feature_counts_by_its_best_candidate");
    let camera = PtzCamera::new(base(0.0), random_ptz(&mut rng));
    let mut matches = RayMatches::new();
    for _ in 0..80 {
        let at = point(&mut rng);
        let mut candidates = [
            anywhere(&mut rng),
            camera.ray_from_image(at).unwrap(),
            anywhere(&mut rng),
        ]
        .map(candidate);
        candidates[0].squared_distance = 0.05;
        matches.push(at, &candidates);
    }
    let pose = pose_of(&matches, 0.0).unwrap();
    assert_eq!(pose.inliers.len(), 80);
    assert!(rotation_error_deg(pose.ptz, camera.ptz()) < 1e-8);
}

#[test]
fn a_board_repeated_twenty_times_is_not_mistaken_for_a_camera() {
    let mut rng = rng("a_board_repeated_twenty_times_is_not_mistaken_for_a_camera");
    let (mut wrong, mut found_among_them) = (0, 0);
    for _ in 0..30 {
        let camera = PtzCamera::new(base(0.0), random_ptz(&mut rng));
        let mut matches = RayMatches::new();
        // One board of 33 features in a patch of 21 × 8 px says consistently that it is another of
        // its kind.
        let (x, y) = (
            rng.random_range(200.0..1000.0),
            rng.random_range(200.0..500.0),
        );
        let elsewhere = PtzCamera::new(base(0.0), random_ptz(&mut rng));
        for _ in 0..33 {
            let at = ImagePoint::new(
                x + rng.random_range(0.0..21.0),
                y + rng.random_range(0.0..8.0),
            );
            matches.push(at, &[candidate(elsewhere.ray_from_image(at).unwrap())]);
        }
        // Twenty copies stand along the picture; each feature takes one of them for another.
        for copy in 0..20 {
            let other = rng.random_range(0..20);
            for part in 0..4 {
                let at =
                    ImagePoint::new(40.0 + 60.0 * f64::from(copy) + 9.0 * f64::from(part), 300.0);
                let seen = ImagePoint::new(
                    40.0 + 60.0 * f64::from(other) + 9.0 * f64::from(part),
                    300.0,
                );
                matches.push(at, &[candidate(camera.ray_from_image(seen).unwrap())]);
            }
        }
        for _ in 0..40 {
            matches.push(point(&mut rng), &[candidate(anywhere(&mut rng))]);
        }
        let is_right = |pose: &Pose| rotation_error_deg(pose.ptz, camera.ptz()) < 0.5;
        wrong += usize::from(
            pose_of(&matches, 0.0).is_ok_and(|pose| pose.confidence > 0.9 && !is_right(&pose)),
        );
        // Sixty right features among them are enough.
        for _ in 0..60 {
            let at = point(&mut rng);
            matches.push(at, &[candidate(camera.ray_from_image(at).unwrap())]);
        }
        found_among_them += usize::from(pose_of(&matches, 0.0).is_ok_and(|pose| is_right(&pose)));
    }
    assert_eq!((wrong, found_among_them), (0, 30));
}

#[test]
fn what_cannot_be_answered_is_named() {
    let mut rng = rng("what_cannot_be_answered_is_named");
    assert_eq!(
        pose_of(&RayMatches::new(), 0.0).unwrap_err(),
        NotFound::FewMatches {
            matched: 0,
            needed: 6
        }
    );
    let mut without = RayMatches::new();
    without.push(SIZE.centre(), &[]);
    assert!(without.is_empty());
    let mut wrong = 0;
    for _ in 0..40 {
        let mut chance = RayMatches::new();
        for _ in 0..300 {
            let rays = [anywhere(&mut rng), anywhere(&mut rng), anywhere(&mut rng)].map(candidate);
            chance.push(point(&mut rng), &rays);
        }
        match pose_of(&chance, 0.0) {
            Ok(pose) => wrong += usize::from(pose.confidence > 0.9),
            Err(reason) => assert_eq!(reason.code(), "few_inliers", "{reason}"),
        }
    }
    assert_eq!(wrong, 0, "chance agrees on nothing");
    let mut same = RayMatches::new();
    for _ in 0..50 {
        same.push(SIZE.centre(), &[candidate(PanTilt::default())]);
    }
    assert!(
        matches!(
            pose_of(&same, 0.0),
            Err(NotFound::NoAgreement { agreeing: 0, .. })
        ),
        "all in one place"
    );
}

#[test]
fn the_same_seed_gives_the_same_pose() {
    let mut rng = rng("the_same_seed_gives_the_same_pose");
    let camera = PtzCamera::new(base(0.1), random_ptz(&mut rng));
    let matches = noisy(&camera, 150, 0.6, 1.0, &mut rng);
    assert_eq!(pose_of(&matches, 0.1), pose_of(&matches, 0.1));
}
