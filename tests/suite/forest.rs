//! The pan-tilt forest from outside: the same bytes on any number of threads, stopping, damaged files.

use crate::seeded::rng;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline::camera::PanTilt;
use touchline::features::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions};
use touchline::relocalize::{
    CameraForest, Forest, ForestFileError, ForestModel, PredictOptions, Samples, Search, SeenRange, Stopped,
    TrainOptions, train,
};

fn descriptor(rng: &mut Pcg64Mcg) -> Descriptor {
    let mut bytes = [0u8; DESCRIPTOR_BYTES];
    for byte in &mut bytes {
        // Mostly small, a few large, about 512 in length.
        let value: f64 = rng.random_range(0.0..1.0);
        *byte = (value.powi(4) * 135.0) as u8;
    }
    Descriptor(bytes)
}

fn disturbed(descriptor: &Descriptor, by: i16, rng: &mut Pcg64Mcg) -> Descriptor {
    Descriptor(descriptor.0.map(|byte| (i16::from(byte) + rng.random_range(-by..=by)).clamp(0, 255) as u8))
}

/// Scene points: what each looks like and where it is.
fn scene(points: usize, rng: &mut Pcg64Mcg) -> Vec<(Descriptor, PanTilt)> {
    (0..points)
        .map(|_| {
            let ray = PanTilt::from_degrees(rng.random_range(-40.0..40.0), rng.random_range(-25.0..0.0));
            (descriptor(rng), ray)
        })
        .collect()
}

/// Every frame sees every point, a little different.
fn samples(scene: &[(Descriptor, PanTilt)], frames: usize, rng: &mut Pcg64Mcg) -> Samples {
    let mut samples = Samples::new();
    for _ in 0..frames {
        samples.add_frame(scene.iter().map(|(descriptor, ray)| (disturbed(descriptor, 5, rng), *ray)));
    }
    samples
}

fn trained(samples: &Samples, options: &TrainOptions) -> Forest {
    train(samples, options, &|_| ControlFlow::Continue(())).unwrap()
}

fn model(forest: Forest) -> ForestModel {
    let seen = SeenRange { pan_deg: -40.0..=40.0, tilt_deg: -20.0..=-5.0, focal_px: 1500.0..=4000.0, references: 3 };
    let cameras = vec![CameraForest { camera: "main".to_owned(), seen, forest }];
    ForestModel { document: "{}".to_owned(), features: FeatureOptions::default(), cameras }
}

#[test]
fn a_disturbed_descriptor_finds_its_ray() {
    let mut rng = rng("a_disturbed_descriptor_finds_its_ray");
    let scene = scene(2000, &mut rng);
    let forest = trained(&samples(&scene, 3, &mut rng), &TrainOptions::default());
    assert_eq!(forest.trees(), 5);
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    let mut found = 0;
    for (descriptor, ray) in &scene {
        forest.predict(&disturbed(descriptor, 5, &mut rng), &PredictOptions::default(), &mut search, &mut candidates);
        assert!(candidates.is_sorted_by(|a, b| a.squared_distance <= b.squared_distance));
        assert!(candidates.len() <= 5);
        found += usize::from(candidates.first().is_some_and(|best| best.ray.angle_to(*ray).degrees() < 0.01));
    }
    assert!(found > 1950, "{found} of 2000");
    forest.predict(&Descriptor([0; DESCRIPTOR_BYTES]), &PredictOptions::default(), &mut search, &mut candidates);
    assert!(candidates.is_empty(), "nothing looks like this");
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let mut rng = rng("the_same_seed_gives_the_same_bytes_on_any_number_of_threads");
    let samples = samples(&scene(1500, &mut rng), 4, &mut rng);
    let options = TrainOptions { frames_per_tree: Some(3), ..TrainOptions::default() };
    let bytes = |threads: usize, options: &TrainOptions| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        model(pool.install(|| trained(&samples, options))).to_bytes()
    };
    let one = bytes(1, &options);
    assert!(one == bytes(4, &options), "four threads");
    assert!(one != bytes(1, &TrainOptions { seed: 1, ..options }), "another seed");
}

#[test]
fn options_shape_the_forest() {
    let mut rng = rng("options_shape_the_forest");
    let samples = samples(&scene(300, &mut rng), 4, &mut rng);
    // Deep enough for every sample to have a leaf of its own.
    let options = TrainOptions { max_depth: 60, ..TrainOptions::default() };
    assert_eq!(trained(&samples, &options).leaves(), 5 * 1200);
    assert_eq!(trained(&samples, &TrainOptions { frames_per_tree: Some(1), ..options }).leaves(), 5 * 300);
    let shallow = trained(&samples, &TrainOptions { trees: 2, max_depth: 3, ..options });
    assert!(shallow.trees() == 2 && shallow.leaves() <= 16);
    assert!(shallow.mixed_leaves(0.01) > shallow.leaves() / 2, "far rays share leaves, and they say so");
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    shallow.predict(&scene(1, &mut rng)[0].0, &PredictOptions::default(), &mut search, &mut candidates);
    assert!(candidates.is_empty(), "mixed leaves are no match");
    let zero = TrainOptions {
        trees: 0,
        max_depth: 0,
        dimensions: 0,
        thresholds: 0,
        min_leaf: 0,
        node_samples: 0,
        frames_per_tree: Some(0),
        seed: 0,
    };
    assert_eq!(trained(&samples, &zero).leaves(), 1);
    let large_leaves = TrainOptions { min_leaf: 3, ..options };
    assert!(trained(&samples, &large_leaves).leaves() <= 5 * 400);
}

#[test]
fn one_sample_and_many_equal_ones_are_a_leaf() {
    let mut rng = rng("one_sample_and_many_equal_ones_are_a_leaf");
    let point = scene(1, &mut rng)[0];
    let mut samples = Samples::new();
    samples.add_frame([point]);
    assert_eq!(trained(&samples, &TrainOptions::default()).leaves(), 5);
    for _ in 0..50 {
        samples.add_frame([point]);
    }
    let forest = trained(&samples, &TrainOptions::default());
    assert_eq!((forest.leaves(), forest.mixed_leaves(1e-6)), (5, 0));
}

#[test]
fn training_can_be_stopped_and_counts_honestly() {
    let mut rng = rng("training_can_be_stopped_and_counts_honestly");
    let samples = samples(&scene(2000, &mut rng), 2, &mut rng);
    let most = AtomicUsize::new(0);
    let watch = |progress: touchline::relocalize::TrainProgress| {
        most.fetch_max(progress.placed, Ordering::Relaxed);
        assert_eq!(progress.total, 20_000);
        ControlFlow::Continue(())
    };
    train(&samples, &TrainOptions::default(), &watch).unwrap();
    assert_eq!(most.load(Ordering::Relaxed), 20_000);
    let stopped = train(&samples, &TrainOptions::default(), &|_| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap_err(), Stopped::Asked);
    let mut nothing = Samples::new();
    nothing.add_frame([]);
    let error = train(&nothing, &TrainOptions::default(), &|_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(error.to_string(), "1 references give no features to learn from");
}

#[test]
fn a_file_comes_back_and_damage_is_named() {
    let mut rng = rng("a_file_comes_back_and_damage_is_named");
    let forest =
        trained(&samples(&scene(40, &mut rng), 2, &mut rng), &TrainOptions { trees: 2, ..TrainOptions::default() });
    let model = model(forest);
    let bytes = model.to_bytes();
    assert_eq!(ForestModel::from_bytes(&bytes).unwrap(), model);
    assert_eq!(ForestModel::from_bytes(b"{\"format\": \"touchline\"}").unwrap_err(), ForestFileError::NotAForest);
    assert_eq!(ForestModel::from_bytes(&[]).unwrap_err(), ForestFileError::NotAForest);
    let mut newer = bytes.clone();
    newer[8] = 2;
    assert_eq!(ForestModel::from_bytes(&newer).unwrap_err(), ForestFileError::Newer { version: 2, newest: 1 });
    for length in (8..bytes.len()).step_by(97) {
        let error = ForestModel::from_bytes(&bytes[..length]).unwrap_err();
        assert!(matches!(error, ForestFileError::Damaged { .. }), "{length} bytes: {error}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(ForestModel::from_bytes(&longer).is_err());
    for _ in 0..300 {
        let mut altered = bytes.clone();
        let at = rng.random_range(12..altered.len());
        altered[at] ^= 1 << rng.random_range(0..8);
        assert!(matches!(ForestModel::from_bytes(&altered), Err(ForestFileError::Damaged { .. })), "byte {at}");
    }
}

#[test]
fn a_forged_file_with_a_fitting_checksum_never_panics_or_loops() {
    let mut rng = rng("a_forged_file_with_a_fitting_checksum_never_panics_or_loops");
    let scene = scene(60, &mut rng);
    let forest = trained(&samples(&scene, 1, &mut rng), &TrainOptions { trees: 1, ..TrainOptions::default() });
    let bytes = model(forest).to_bytes();
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    for _ in 0..2000 {
        let mut forged = bytes.clone();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(24..forged.len().min(900));
            forged[at] = rng.random();
        }
        let checksum = crc32fast::hash(&forged[24..]);
        forged[20..24].copy_from_slice(&checksum.to_le_bytes());
        if let Ok(model) = ForestModel::from_bytes(&forged) {
            for camera in &model.cameras {
                camera.forest.predict(&scene[0].0, &PredictOptions::default(), &mut search, &mut candidates);
            }
        }
    }
}
