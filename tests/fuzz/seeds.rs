//! Writes the files that corpora begin with and that are no text:
//! `cargo run --bin seeds -- corpus`.

use touchline::progress::Progress;
use std::fs;
use std::path::Path;
use touchline::camera::PanTilt;
use touchline::features::{DESCRIPTOR_BYTES, Descriptor, FeatureCache, FeatureKey, FeatureOptions, Features, Keypoint};
use touchline::geometry::{ImagePoint, ImageSize};
use touchline::relocalize::{CameraForest, ForestModel, Samples, SeenRange, TrainOptions, train};
use touchline_fuzz::mat_writer::{CAMERA, frame, sequence};
use touchline_fuzz::samples::{Sample, formats};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> Result<()> {
    let corpus = std::env::args().nth(1).ok_or("which folder?")?;
    let corpus = Path::new(&corpus);
    for target in ["importers", "mat", "forest", "features"] {
        fs::create_dir_all(corpus.join(target))?;
    }
    for (index, format) in formats().enumerate() {
        let sample = Sample::of(format);
        let bytes = [&[index as u8], sample.bytes(sample.main())].concat();
        fs::write(corpus.join("importers").join(format.name()), bytes)?;
    }
    for (name, compressed) in [("plain", false), ("compressed", true)] {
        let bytes = sequence(vec![frame("1.jpg", CAMERA), frame("2.jpg", CAMERA)], compressed);
        fs::write(corpus.join("mat").join(name), bytes)?;
    }
    fs::write(corpus.join("forest/two-trees"), forest()?)?;
    features(&corpus.join("features"))
}

fn descriptor(seed: u8) -> Descriptor {
    let mut bytes = [0; DESCRIPTOR_BYTES];
    bytes.iter_mut().zip(0_u8..).for_each(|(byte, at)| *byte = seed.wrapping_mul(at) % 64);
    Descriptor(bytes)
}

fn forest() -> Result<Vec<u8>> {
    let mut samples = Samples::new();
    let sample = |index: u8| (descriptor(index), PanTilt::from_degrees(f64::from(index), -f64::from(index)));
    samples.add_frame((1..7).map(sample));
    let options = TrainOptions { trees: 2, leaf_samples: 2, ..TrainOptions::default() };
    let forest = train(&samples, &options, &Progress::default()).map_err(|_| "it was stopped")?;
    let cameras = [PanTilt::from_degrees(1.0, -2.0)].map(|at| touchline::camera::Ptz {
        pan: at.pan,
        tilt: at.tilt,
        focal_px: 2000.0,
    });
    let seen = SeenRange::of(&cameras).ok_or("no camera")?.with_labels(vec![touchline::geometry::Mat3::identity()]);
    let camera = CameraForest { camera: "main".to_owned(), seen, forest };
    let model = ForestModel { document: "{}".to_owned(), features: FeatureOptions::default(), cameras: vec![camera] };
    Ok(model.to_bytes())
}

fn features(folder: &Path) -> Result<()> {
    let keypoint = |x| Keypoint { point: ImagePoint::new(x, 2.0), size_px: 2.5, strength: 0.01 };
    let features = Features {
        image_size: ImageSize::new(64, 48),
        keypoints: vec![keypoint(1.0), keypoint(3.0)],
        descriptors: vec![descriptor(1), descriptor(2)],
    };
    FeatureCache::new(folder, 1 << 20).put(&FeatureKey::new("two", &FeatureOptions::default(), &[]), &features)?;
    Ok(())
}
