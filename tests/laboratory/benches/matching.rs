//! Nearest neighbours of descriptors, as the experiments' baselines compute them, compared with
//! OpenCV's brute force. Both run on one thread.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a bench says what failed by failing"
)]

use divan::Bencher;
use opencv::core::{DMatch, Mat, NORM_L2, Vector, set_num_threads};
use opencv::features2d::BFMatcher;
use opencv::prelude::*;
use touchline::features::Descriptor;
use touchline_laboratory::{DescriptorRows, nearest};

/// Numbers of features in a picture.
const COUNTS: [usize; 2] = [500, 1500];

fn main() {
    set_num_threads(1).unwrap();
    let [query, reference] = descriptors(COUNTS[0]);
    let ours = nearest(
        &DescriptorRows::from_descriptors(&query),
        &DescriptorRows::from_descriptors(&reference),
    );
    let theirs = brute_force(&matrix(&query), &matrix(&reference));
    for (ours, theirs) in ours.iter().zip(theirs) {
        assert_eq!(
            ours.feature as i32,
            theirs.get(0).unwrap().train_idx,
            "both find the same neighbours"
        );
    }
    divan::main();
}

/// Random descriptors of two pictures. Large entries are rare, as in SIFT.
fn descriptors(count: usize) -> [Vec<Descriptor>; 2] {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut value = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 40) as f32 / 16_777_216.0).powi(4)
    };
    [(); 2].map(|()| {
        (0..count)
            .map(|_| Descriptor::root(&std::array::from_fn(|_| value())))
            .collect()
    })
}

fn matrix(descriptors: &[Descriptor]) -> Mat {
    let rows: Vec<[f32; 128]> = descriptors
        .iter()
        .map(|descriptor| descriptor.0.map(f32::from))
        .collect();
    Mat::from_slice_2d(&rows).unwrap()
}

fn brute_force(query: &Mat, reference: &Mat) -> Vector<Vector<DMatch>> {
    let matcher = BFMatcher::new(NORM_L2, false).unwrap();
    let mut matches = Vector::new();
    matcher
        .knn_train_match_def(query, reference, &mut matches, 2)
        .unwrap();
    matches
}

#[divan::bench(args = COUNTS)]
fn matrix_product(bencher: Bencher<'_, '_>, count: usize) {
    let [query, reference] =
        descriptors(count).map(|descriptors| DescriptorRows::from_descriptors(&descriptors));
    bencher.bench(|| nearest(&query, &reference));
}

#[divan::bench(args = COUNTS)]
fn opencv_brute_force(bencher: Bencher<'_, '_>, count: usize) {
    let [query, reference] = descriptors(count).map(|descriptors| matrix(&descriptors));
    bencher.bench_local(|| brute_force(&query, &reference));
}
