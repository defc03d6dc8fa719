//! The pan-tilt forest from outside: the same bytes on any number of threads, stopping, damaged
//! files.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::camera::PanTilt;
use touchline_core::geometry::Angle;
use touchline_core::progress::Progress;
use touchline_core::testing::seeded::rng;
use touchline_vision::features::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions};
use touchline_vision::relocalize::{
    CameraForest, FOREST_VERSION, Forest, ForestFileError, ForestModel, PredictOptions, Samples,
    Search, SeenRange, Stopped, TrainOptions, TrainProgress, train, train_without,
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

fn disturb(descriptor: &Descriptor, by: i16, rng: &mut Pcg64Mcg) -> Descriptor {
    Descriptor(
        descriptor
            .0
            .map(|byte| (i16::from(byte) + rng.random_range(-by..=by)).clamp(0, 255) as u8),
    )
}

/// Scene points: what each looks like and where it is.
fn scene(points: usize, rng: &mut Pcg64Mcg) -> Vec<(Descriptor, PanTilt)> {
    (0..points)
        .map(|_| {
            let ray =
                PanTilt::from_degrees(rng.random_range(-40.0..40.0), rng.random_range(-25.0..0.0));
            (descriptor(rng), ray)
        })
        .collect()
}

/// Every frame sees every point, a little different.
fn samples(scene: &[(Descriptor, PanTilt)], frames: usize, rng: &mut Pcg64Mcg) -> Samples {
    let mut samples = Samples::new();
    for _ in 0..frames {
        samples.add_frame(
            scene
                .iter()
                .map(|(descriptor, ray)| (disturb(descriptor, 5, rng), *ray)),
        );
    }
    samples
}

fn train_on(samples: &Samples, options: &TrainOptions) -> Forest {
    train(samples, options, &Progress::default()).unwrap()
}

fn model(forest: Forest) -> ForestModel {
    let seen = SeenRange {
        pan_deg: -40.0..=40.0,
        tilt_deg: -20.0..=-5.0,
        focal_px: 1500.0..=4000.0,
        references: 3,
        cameras: Vec::new(),
        labels: vec![
            touchline_core::geometry::Mat3::new(
                4.0, 1.0, 2.0, 1.0, 5.0, 3.0, 2.0, 3.0, 6.0
            );
            3
        ],
        shown: touchline_vision::relocalize::CertainAnswerCounts {
            certain: 8,
            right: 7,
        },
    };
    let cameras = vec![CameraForest {
        camera: "main".to_owned(),
        seen,
        forest,
    }];
    ForestModel {
        document: "{}".to_owned(),
        features: FeatureOptions::default(),
        cameras,
    }
}

#[test]
fn a_disturbed_descriptor_finds_its_ray() {
    let mut rng = rng("a_disturbed_descriptor_finds_its_ray");
    let scene = scene(2000, &mut rng);
    let forest = train_on(&samples(&scene, 3, &mut rng), &TrainOptions::default());
    assert_eq!(forest.trees(), 3);
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    for (leaves_per_tree, share) in [(1, 0.9), (4, 0.98)] {
        let options = PredictOptions {
            leaves_per_tree,
            ..PredictOptions::default()
        };
        let mut found = 0;
        for (descriptor, ray) in &scene {
            forest.predict(
                &disturb(descriptor, 5, &mut rng),
                &options,
                &mut search,
                &mut candidates,
            );
            assert!(candidates.is_sorted_by(|a, b| a.squared_distance <= b.squared_distance));
            assert!(candidates.len() <= 5);
            found += usize::from(
                candidates
                    .first()
                    .is_some_and(|best| best.ray.angle_to(*ray).degrees() < 0.01),
            );
        }
        assert!(
            f64::from(found as u32) > share * 2000.0,
            "{leaves_per_tree} leaves: {found} of 2000"
        );
    }
    forest.predict(
        &Descriptor([0; DESCRIPTOR_BYTES]),
        &PredictOptions::default(),
        &mut search,
        &mut candidates,
    );
    assert!(candidates.is_empty(), "nothing looks like this");
}

#[test]
fn descriptors_predicted_together_get_what_each_gets_alone() {
    let mut rng = rng("descriptors_predicted_together_get_what_each_gets_alone");
    let scene = scene(500, &mut rng);
    let forest = train_on(
        &samples(&scene, 2, &mut rng),
        &TrainOptions {
            leaf_samples: 8,
            ..TrainOptions::default()
        },
    );
    // Some more than full groups, outliers among them.
    let mut descriptors: Vec<Descriptor> = scene
        .iter()
        .take(67)
        .map(|(known, _)| disturb(known, 20, &mut rng))
        .collect();
    descriptors.insert(5, Descriptor([0; DESCRIPTOR_BYTES]));
    let (mut search, mut alone) = (Search::default(), Vec::new());
    for leaves_per_tree in [1, 3] {
        let options = PredictOptions {
            leaves_per_tree,
            ..PredictOptions::default()
        };
        let (mut next, mut found) = (0, 0);
        forest.predict_all(&descriptors, &options, |number, together| {
            assert_eq!(number, next);
            forest.predict(&descriptors[number], &options, &mut search, &mut alone);
            assert_eq!(
                together, alone,
                "descriptor {number}, {leaves_per_tree} leaves"
            );
            (next, found) = (next + 1, found + usize::from(!together.is_empty()));
        });
        assert_eq!(next, descriptors.len());
        assert!(found > 20, "{found} found");
    }
    forest.predict_all(&[], &PredictOptions::default(), |number, _| {
        panic!("{number} was not requested")
    });
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let mut rng = rng("the_same_seed_gives_the_same_bytes_on_any_number_of_threads");
    let samples = samples(&scene(1500, &mut rng), 4, &mut rng);
    let options = TrainOptions {
        frames_per_tree: Some(3),
        ..TrainOptions::default()
    };
    let bytes = |threads: usize, options: &TrainOptions| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        model(pool.install(|| train_on(&samples, options))).to_bytes()
    };
    let one = bytes(1, &options);
    assert!(one == bytes(4, &options), "four threads");
    assert!(
        one != bytes(1, &TrainOptions { seed: 1, ..options }),
        "another seed"
    );
}

#[test]
fn without_some_frames_it_is_the_forest_of_the_others() {
    let mut rng = rng("without_some_frames_it_is_the_forest_of_the_others");
    let scene = scene(700, &mut rng);
    let pictures: Vec<Vec<(Descriptor, PanTilt)>> = (0..5)
        .map(|_| {
            scene
                .iter()
                .map(|(descriptor, ray)| (disturb(descriptor, 5, &mut rng), *ray))
                .collect()
        })
        .collect();
    let of = |frames: &[usize]| {
        let mut samples = Samples::new();
        for frame in frames {
            samples.add_frame(pictures[*frame].iter().copied());
        }
        samples
    };
    for options in [TrainOptions::default(), TrainOptions::from_paper()] {
        let options = TrainOptions {
            frames_per_tree: options.frames_per_tree.map(|_| 2),
            ..options
        };
        let without = train_without(
            &of(&[0, 1, 2, 3, 4]),
            &BTreeSet::from([1, 3]),
            &options,
            &Progress::default(),
        )
        .unwrap();
        assert!(model(without).to_bytes() == model(train_on(&of(&[0, 2, 4]), &options)).to_bytes());
    }
    let none = train_without(
        &of(&[0, 1]),
        &BTreeSet::from([0, 1]),
        &TrainOptions::default(),
        &Progress::default(),
    );
    assert_eq!(none, Err(Stopped::NoSamples { frames: 2 }));
}

#[test]
fn options_shape_the_forest() {
    let mut rng = rng("options_shape_the_forest");
    let samples = samples(&scene(300, &mut rng), 4, &mut rng);
    // Samples are only put together where their rays agree: not at all within nothing, by place
    // within a little.
    let apart = TrainOptions {
        merge_within: Angle::ZERO,
        ..TrainOptions::default()
    };
    for leaf_samples in [1, 8, 100] {
        let forest = train_on(
            &samples,
            &TrainOptions {
                leaf_samples,
                ..apart
            },
        );
        assert_eq!(
            forest.means(),
            3 * 1200,
            "all samples are held, {leaf_samples} a leaf at most"
        );
        assert!(forest.leaves() >= 3 * 1200 / leaf_samples as usize);
    }
    let frames = TrainOptions {
        frames_per_tree: Some(1),
        ..apart
    };
    assert_eq!(
        train_on(&samples, &frames).means(),
        3 * 300,
        "those of one frame"
    );
    let one_leaf = TrainOptions {
        max_depth: 0,
        ..TrainOptions::default()
    };
    let forest = train_on(&samples, &one_leaf);
    assert_eq!(
        (forest.leaves(), forest.means()),
        (3, 3 * 300),
        "each place once"
    );
    let mean = train_on(
        &samples,
        &TrainOptions {
            merge_within: Angle::from_degrees(180.0),
            ..one_leaf
        },
    );
    assert_eq!(mean.means(), 3, "one mean of everything");

    // Splits that leave each side three tenths: after three of them a leaf holds 32 samples of 8
    // places at least.
    let shallow = train_on(
        &samples,
        &TrainOptions {
            trees: 2,
            max_depth: 3,
            ..TrainOptions::default()
        },
    );
    assert_eq!((shallow.trees(), shallow.leaves()), (2, 16));
    let zero = TrainOptions {
        trees: 0,
        max_depth: 0,
        dimensions: 0,
        leaf_samples: 0,
        min_leaf: 0,
        node_samples: 0,
        frames_per_tree: Some(0),
        ..TrainOptions::from_paper()
    };
    assert_eq!(
        (
            train_on(&samples, &zero).leaves(),
            train_on(&samples, &zero).means()
        ),
        (1, 1)
    );
    let large_leaves = TrainOptions {
        min_leaf: 3,
        leaf_samples: 1,
        ..TrainOptions::default()
    };
    assert!(train_on(&samples, &large_leaves).leaves() <= 3 * 400);
}

#[test]
fn the_published_forest_is_there() {
    let mut rng = rng("the_published_forest_is_there");
    let scene = scene(300, &mut rng);
    let samples = samples(&scene, 4, &mut rng);
    let forest = train_on(
        &samples,
        &TrainOptions {
            max_depth: 200,
            ..TrainOptions::from_paper()
        },
    );
    assert_eq!(
        (forest.trees(), forest.leaves(), forest.means()),
        (5, 5 * 1200, 5 * 1200),
        "a leaf for each sample"
    );
    let mixing = train_on(
        &samples,
        &TrainOptions {
            max_depth: 1,
            ..TrainOptions::from_paper()
        },
    );
    assert_eq!(
        (mixing.leaves(), mixing.means()),
        (10, 10),
        "a mean for each leaf"
    );
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    let anything = PredictOptions {
        max_squared_distance: 2.0,
        ..PredictOptions::default()
    };
    mixing.predict(&scene[0].0, &anything, &mut search, &mut candidates);
    assert!(
        candidates.is_empty(),
        "means that mix places are no match, however near"
    );
    mixing.predict(
        &scene[0].0,
        &PredictOptions {
            max_spread: Angle::from_degrees(180.0),
            ..anything
        },
        &mut search,
        &mut candidates,
    );
    assert!(!candidates.is_empty());
}

#[test]
fn one_sample_and_many_equal_ones_are_a_leaf() {
    let mut rng = rng("one_sample_and_many_equal_ones_are_a_leaf");
    let point = scene(1, &mut rng)[0];
    let mut samples = Samples::new();
    samples.add_frame([point]);
    assert_eq!(train_on(&samples, &TrainOptions::default()).leaves(), 3);
    for _ in 0..50 {
        samples.add_frame([point]);
    }
    let forest = train_on(&samples, &TrainOptions::default());
    assert_eq!((forest.leaves(), forest.means()), (3, 3));
}

#[test]
fn training_can_be_stopped_and_counts_honestly() {
    let mut rng = rng("training_can_be_stopped_and_counts_honestly");
    let samples = samples(&scene(2000, &mut rng), 2, &mut rng);
    let most = AtomicUsize::new(0);
    let counted = Progress::new(|progress: TrainProgress| {
        most.fetch_max(progress.placed, Ordering::Relaxed);
        assert_eq!(progress.total, 12_000);
        ControlFlow::Continue(())
    });
    train(&samples, &TrainOptions::default(), &counted).unwrap();
    assert_eq!(most.load(Ordering::Relaxed), 12_000);
    let stopped = train(
        &samples,
        &TrainOptions::default(),
        &Progress::new(|_| ControlFlow::Break(())),
    );
    assert_eq!(stopped.unwrap_err(), Stopped::Cancelled);
    let mut nothing = Samples::new();
    nothing.add_frame([]);
    let error = train(&nothing, &TrainOptions::default(), &Progress::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no features to learn from in 1 reference; label frames that show the stadium"
    );
}

#[test]
fn a_file_comes_back_and_damage_is_named() {
    let mut rng = rng("a_file_comes_back_and_damage_is_named");
    let forest = train_on(
        &samples(&scene(40, &mut rng), 2, &mut rng),
        &TrainOptions {
            trees: 2,
            ..TrainOptions::default()
        },
    );
    let model = model(forest);
    let bytes = model.to_bytes();
    assert_eq!(ForestModel::from_bytes(&bytes).unwrap(), model);
    assert_eq!(
        ForestModel::from_bytes(b"{\"format\": \"touchline\"}").unwrap_err(),
        ForestFileError::NotAForest
    );
    assert_eq!(
        ForestModel::from_bytes(&[]).unwrap_err(),
        ForestFileError::NotAForest
    );
    let mut newer = bytes.clone();
    newer[8] = FOREST_VERSION as u8 + 1;
    assert_eq!(
        ForestModel::from_bytes(&newer).unwrap_err(),
        ForestFileError::Newer {
            version: FOREST_VERSION + 1,
            newest: FOREST_VERSION
        }
    );
    newer[8] = FOREST_VERSION as u8 - 1;
    assert_eq!(
        ForestModel::from_bytes(&newer).unwrap_err(),
        ForestFileError::Older {
            version: FOREST_VERSION - 1
        }
    );
    for length in (8..bytes.len()).step_by(97) {
        let error = ForestModel::from_bytes(&bytes[..length]).unwrap_err();
        assert!(
            matches!(error, ForestFileError::Damaged { .. }),
            "{length} bytes: {error}"
        );
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(ForestModel::from_bytes(&longer).is_err());
    for _ in 0..300 {
        let mut altered = bytes.clone();
        let at = rng.random_range(12..altered.len());
        altered[at] ^= 1 << rng.random_range(0..8);
        assert!(
            matches!(
                ForestModel::from_bytes(&altered),
                Err(ForestFileError::Damaged { .. })
            ),
            "byte {at}"
        );
    }
}

#[test]
fn a_forged_file_with_a_fitting_checksum_never_panics_or_loops() {
    let mut rng = rng("a_forged_file_with_a_fitting_checksum_never_panics_or_loops");
    let scene = scene(60, &mut rng);
    let forest = train_on(
        &samples(&scene, 1, &mut rng),
        &TrainOptions {
            trees: 1,
            ..TrainOptions::default()
        },
    );
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
                camera.forest.predict(
                    &scene[0].0,
                    &PredictOptions::default(),
                    &mut search,
                    &mut candidates,
                );
            }
        }
    }
}
