//! Drawn frames with exact truth.

use super::set::{Set, grown, quantile, rotation_error_deg};
use super::time::{best_of_passes, threads};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;
use touchline::features::{FeatureOptions, extract};
use touchline::media::load_image;
use touchline::relocalize::{
    Forest, ForestModel, Pose, PoseOptions, PredictOptions, RelocalizeOptions, TrainOptions,
    candidates_of, pose_from_candidates, relocalize,
};

fn sets(data: &Path) -> (Set, Set) {
    let of = |file: &str| {
        Set::of(
            &data.join("rendered").join(file),
            &FeatureOptions::default(),
        )
    };
    (of("train.json"), of("test-truth.json"))
}

/// Rays and cameras, and what they cost, by forest and leaves examined.
pub fn accuracy(data: &Path) {
    let (training_frames, tests) = sets(data);
    let (samples, seen) = training_frames.samples(&training_frames.all(), usize::MAX);
    println!(
        "\n## rendered: {} references, {} samples\n",
        samples.frames(),
        samples.len()
    );
    println!(
        "| forest | leaves per tree | rays within 0.5° of all / of gated | predict + pose, ms | found | rotation error \
         median / 90 % (deg) | focal error median / 90 % (px) |"
    );
    println!("|---|---|---|---|---|---|---|");
    let more_trees = TrainOptions {
        trees: 5,
        ..TrainOptions::default()
    };
    let forests = [
        ("published", TrainOptions::from_paper(), vec![1, 4, 16]),
        (
            "default: 3 trees",
            TrainOptions::default(),
            vec![1, 2, 4, 8],
        ),
        ("5 trees", more_trees, vec![1, 4]),
        (
            "5 trees of 30 references",
            TrainOptions {
                frames_per_tree: Some(30),
                ..more_trees
            },
            vec![1, 4],
        ),
    ];
    for (name, options, leaves) in forests {
        let forest = grown(&samples, &options);
        for leaves_per_tree in leaves {
            let options = PredictOptions {
                leaves_per_tree,
                ..PredictOptions::default()
            };
            let frames = tests.all();
            let predict = |frame: usize| candidates_of(&tests.features[frame], &forest, &options);
            let (matches, predict_ms) = best_of_passes(&frames, predict);
            let pose = PoseOptions {
                ranges: Some(seen.plausible()),
                ..PoseOptions::default()
            };
            let solve = |frame: usize| {
                pose_from_candidates(
                    &matches[frame],
                    &tests.base(frame),
                    tests.features[frame].image_size,
                    &pose,
                )
                .ok()
            };
            let (poses, pose_ms): (Vec<Option<Pose>>, f64) = best_of_passes(&frames, solve);
            let found = || {
                poses
                    .iter()
                    .enumerate()
                    .filter_map(|(frame, pose)| Some((frame, pose.as_ref()?.ptz)))
            };
            let mut turned: Vec<f64> = found()
                .map(|(frame, ptz)| rotation_error_deg(ptz, tests.truth(frame)))
                .collect();
            let mut focal: Vec<f64> = found()
                .map(|(frame, ptz)| (ptz.focal_px - tests.truth(frame).focal_px).abs())
                .collect();
            println!(
                "| {name} | {leaves_per_tree} | {} | {predict_ms:.2} + {pose_ms:.2} | {}/{} | {:.5} / {:.5} | {:.3} / {:.3} |",
                rays_within(&forest, &tests, &options),
                turned.len(),
                poses.len(),
                quantile(&mut turned, 0.5),
                quantile(&mut turned, 0.9),
                quantile(&mut focal, 0.5),
                quantile(&mut focal, 0.9),
            );
        }
    }
}

/// The share of features whose likeliest ray is within half a degree of the truth, of all features
/// and of those with rays.
fn rays_within(forest: &Forest, tests: &Set, options: &PredictOptions) -> String {
    let (mut all, mut gated, mut right) = (0u32, 0u32, 0u32);
    for (frame, features) in tests.features.iter().enumerate() {
        let camera = tests
            .document
            .ptz_camera(&tests.document.frames[frame])
            .unwrap();
        forest.predict_all(&features.descriptors, options, |feature, candidates| {
            all += 1;
            let Some(best) = candidates.first() else {
                return;
            };
            gated += 1;
            let ray = camera
                .ray_from_image(features.keypoints[feature].point)
                .unwrap();
            right += u32::from(ray.angle_to(best.ray).degrees() < 0.5);
        });
    }
    format!(
        "{:.3} / {:.3}",
        f64::from(right) / f64::from(all),
        f64::from(right) / f64::from(gated)
    )
}

/// Training, and the file of a forest, by the clock.
pub fn training(data: &Path) {
    let (training_frames, _) = sets(data);
    println!("\n## training, by the clock\n");
    println!(
        "| forest | samples per tree | one thread, s | both cores, s | leaves | means | file MB | write ms | read ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let five = TrainOptions {
        trees: 5,
        frames_per_tree: Some(30),
        ..TrainOptions::default()
    };
    for (name, options, features) in [
        ("published", TrainOptions::from_paper(), 485),
        ("5 trees of 30 references, 485 features each", five, 485),
        ("default", TrainOptions::default(), usize::MAX),
    ] {
        let (samples, seen) = training_frames.samples(&training_frames.all(), features);
        let timed = |count: usize| {
            let runs = (0..3).map(|_| {
                let start = Instant::now();
                let forest = threads(count).install(|| grown(&samples, &options));
                (start.elapsed().as_secs_f64(), forest)
            });
            runs.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };
        let ((one, _), (both, forest)) = (timed(1), timed(2));
        let per_tree =
            samples.len() * options.frames_per_tree.map_or(120, |count| count as usize) / 120;
        let (leaves, means) = (forest.leaves(), forest.means());
        let cameras = vec![touchline::relocalize::CameraForest {
            camera: "main".to_owned(),
            seen,
            forest,
        }];
        let model = ForestModel {
            document: "{}".to_owned(),
            features: FeatureOptions::default(),
            cameras,
        };
        let start = Instant::now();
        let bytes = model.to_bytes();
        let write_ms = start.elapsed().as_secs_f64() * 1e3;
        let read_ms = || {
            let start = Instant::now();
            assert!(ForestModel::from_bytes(&bytes).is_ok());
            start.elapsed().as_secs_f64() * 1e3
        };
        let read_ms = (0..5).map(|_| read_ms()).fold(f64::INFINITY, f64::min);
        let megabytes = bytes.len() as f64 / 1e6;
        println!(
            "| {name} | {per_tree} | {one:.3} | {both:.3} | {leaves} | {means} | {megabytes:.1} | {write_ms:.1} | {read_ms:.1} |"
        );
    }
}

/// From the JPEG file to the camera with both cores busy, beside the features alone.
pub fn whole_frames(data: &Path) {
    let (training_frames, tests) = sets(data);
    let (samples, seen) = training_frames.samples(&training_frames.all(), usize::MAX);
    let forest = grown(&samples, &TrainOptions::default());
    let options = FeatureOptions::default();
    let paths: Vec<_> = tests
        .document
        .frames
        .iter()
        .map(|frame| frame.image_path(&data.join("rendered")).unwrap())
        .collect();
    let frames: Vec<usize> = tests.all().into_iter().step_by(4).collect();
    let timed = |work: &(dyn Fn(usize) -> bool + Sync)| {
        let start = Instant::now();
        let done = threads(2).install(|| frames.par_iter().filter(|&&frame| work(frame)).count());
        (
            done,
            start.elapsed().as_secs_f64() * 1e3 / frames.len() as f64,
        )
    };
    let pictures: Vec<_> = paths.iter().map(|path| load_image(path).unwrap()).collect();
    let (_, features_ms) = timed(&|frame| extract(&pictures[frame], &[], &options).is_ok());
    let (found, whole_ms) = timed(&|frame| {
        let features = extract(&load_image(&paths[frame]).unwrap(), &[], &options).unwrap();
        relocalize(
            &features,
            &forest,
            &seen,
            &tests.base(frame),
            &RelocalizeOptions::default(),
        )
        .pose
        .is_ok()
    });
    println!("\n## whole frames, both cores busy with frames, by the clock\n");
    println!(
        "{features_ms:.1} ms a frame for SIFT alone, {whole_ms:.1} ms from the JPEG file to the camera ({:.3} of it), {found} of \
         {} found",
        whole_ms / features_ms,
        frames.len()
    );
}
