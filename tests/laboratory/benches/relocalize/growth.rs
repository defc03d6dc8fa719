//! How a forest grows with its references: training, memory, prediction.
//!
//! Drawn descriptors, so that thousands of references cost no pictures: 40 000 places over a stand,
//! of which each reference sees 300 around where it looks, every byte disturbed each time.

use super::set::grown;
use super::time::{best_of_passes, threads};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::time::Instant;
use touchline::camera::PanTilt;
use touchline::features::Descriptor;
use touchline::relocalize::{PredictOptions, Samples, TrainOptions};

const PLACES: usize = 40_000;
const SEEN: usize = 300;
const PAN_DEG: f64 = 40.0;
const VIEW_DEG: f64 = 15.0;
const ASKED: usize = 20;

type DescriptorRay = (Descriptor, PanTilt);

pub fn growth() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut places: Vec<DescriptorRay> = (0..PLACES).map(|_| place(&mut rng)).collect();
    places.sort_by(|a, b| a.1.pan.radians().total_cmp(&b.1.pan.radians()));
    let asked: Vec<Vec<DescriptorRay>> = (0..ASKED).map(|_| reference(&places, &mut rng)).collect();
    let descriptors: Vec<Vec<Descriptor>> = asked
        .iter()
        .map(|frame| frame.iter().map(|place| place.0).collect())
        .collect();
    println!("\n## growth: {SEEN} features a reference, default forest\n");
    println!(
        "| references | training, both cores, s | means | memory MB | predict 1000 features, ms | rays within 0.5° of all |"
    );
    println!("|---|---|---|---|---|---|");
    for references in [30, 100, 300, 1000, 3000] {
        let mut samples = Samples::new();
        for _ in 0..references {
            samples.add_frame(reference(&places, &mut rng));
        }
        let start = Instant::now();
        let forest = threads(2).install(|| grown(&samples, &TrainOptions::default()));
        let train_s = start.elapsed().as_secs_f64();
        drop(samples);
        let frames: Vec<usize> = (0..ASKED).collect();
        let (right, ms) = best_of_passes(&frames, |frame| {
            let mut named = 0;
            forest.predict_all(
                &descriptors[frame],
                &PredictOptions::default(),
                |feature, candidates| {
                    let ray = asked[frame][feature].1;
                    named += usize::from(
                        candidates
                            .first()
                            .is_some_and(|best| best.ray.angle_to(ray).degrees() < 0.5),
                    );
                },
            );
            named
        });
        println!(
            "| {references} | {train_s:.2} | {} | {:.0} | {:.2} | {:.3} |",
            forest.means(),
            forest.memory_bytes() as f64 / 1e6,
            ms * 1000.0 / SEEN as f64,
            right.iter().sum::<usize>() as f64 / (ASKED * SEEN) as f64,
        );
    }
}

fn place(rng: &mut Pcg64Mcg) -> DescriptorRay {
    // Mostly small, a few large, about 512 in length, as SIFT is.
    let bytes = std::array::from_fn(|_| (rng.random_range(0.0..1.0f64).powi(4) * 135.0) as u8);
    let edge = PAN_DEG + VIEW_DEG;
    (
        Descriptor(bytes),
        PanTilt::from_degrees(rng.random_range(-edge..edge), rng.random_range(-25.0..0.0)),
    )
}

/// What one reference sees: a part of the places around where it looks, each disturbed.
fn reference(places: &[DescriptorRay], rng: &mut Pcg64Mcg) -> Vec<DescriptorRay> {
    let looks = rng.random_range(-PAN_DEG..PAN_DEG);
    let first = places.partition_point(|place| place.1.pan.degrees() < looks - VIEW_DEG);
    let last = places.partition_point(|place| place.1.pan.degrees() < looks + VIEW_DEG);
    (0..SEEN)
        .map(|_| {
            let (descriptor, ray) = places[rng.random_range(first..last)];
            let disturb =
                |byte: u8| (i16::from(byte) + rng.random_range(-9..=9)).clamp(0, 255) as u8;
            (Descriptor(descriptor.0.map(disturb)), ray)
        })
        .collect()
}
