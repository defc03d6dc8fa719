//! SIFT features of a picture: unbiased, masked, capped.
#![cfg(feature = "opencv")]

use crate::seeded::rng;
use rand::RngExt;
use touchline::features::{FeatureOptions, extract};
use touchline::geometry::{ImagePoint, ImageSize, PixelBox};
use touchline::media::Picture;

/// A picture of blurred random blobs, and the same mirrored left to right.
fn textured(width: u32, height: u32) -> (Picture, Picture) {
    let mut rng = rng("features");
    let blobs: Vec<[f32; 4]> = (0..260)
        .map(|_| {
            [
                rng.random_range(0.0..width as f32),
                rng.random_range(0.0..height as f32),
                rng.random_range(2.0..9.0),
                rng.random_range(-90.0..90.0),
            ]
        })
        .collect();
    let grey = |x: u32, y: u32| {
        let at = |&[bx, by, sigma, height]: &[f32; 4]| {
            let (dx, dy) = (x as f32 + 0.5 - bx, (y as f32 + 0.5 - by) * 1.4);
            height * (-(dx * dx + dy * dy) / (2.0 * sigma * sigma)).exp()
        };
        (128.0 + blobs.iter().map(at).sum::<f32>()).clamp(0.0, 255.0) as u8
    };
    let picture = |column: &dyn Fn(u32) -> u32| {
        let mut rgba = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let value = grey(column(x), y);
                rgba.extend([value, value, value, 255]);
            }
        }
        Picture::new(ImageSize::new(width, height), rgba).unwrap()
    };
    (picture(&|x| x), picture(&|x| width - 1 - x))
}

/// The median of x + x′ − width over keypoints of a picture and their mirror images: twice the bias to the right.
fn mirror_bias(options: &FeatureOptions) -> f64 {
    let (picture, mirrored) = textured(320, 240);
    let one = extract(&picture, &[], options).unwrap();
    let other = extract(&mirrored, &[], options).unwrap();
    let mut sums: Vec<f64> = one
        .keypoints
        .iter()
        .filter_map(|a| {
            let image = ImagePoint::new(320.0 - a.point.x, a.point.y);
            let nearest = other
                .keypoints
                .iter()
                .min_by(|b, c| b.point.distance_px(image).total_cmp(&c.point.distance_px(image)))?;
            (nearest.point.distance_px(image) < 1.5).then_some(a.point.x + nearest.point.x - 320.0)
        })
        .collect();
    assert!(sums.len() > 60, "{} pairs", sums.len());
    sums.sort_by(f64::total_cmp);
    sums[sums.len() / 2]
}

#[test]
fn a_mirrored_picture_has_its_features_mirrored() {
    let bias = mirror_bias(&FeatureOptions::default());
    assert!(bias.abs() < 0.04, "{bias} px at full size");
    let bias = mirror_bias(&FeatureOptions { max_width_px: 160, ..FeatureOptions::default() });
    assert!(bias.abs() < 0.08, "{bias} px at half size");
}

#[test]
fn masks_and_the_cap_are_kept() {
    let (picture, _) = textured(320, 240);
    let options = FeatureOptions { max_count: 20, ..FeatureOptions::default() };
    let mask = PixelBox { x: 0.0, y: 0.0, width: 160.0, height: 240.0 };
    let features = extract(&picture, &[mask], &options).unwrap();
    assert_eq!((features.len(), features.descriptors.len()), (20, 20));
    assert!(features.keypoints.iter().all(|keypoint| keypoint.point.x >= 160.0));
    let everything = PixelBox { width: 320.0, ..mask };
    assert!(extract(&picture, &[everything], &options).unwrap().is_empty());
}

#[test]
fn a_blank_picture_and_a_tiny_one_have_no_features() {
    for (width, height) in [(64, 64), (1, 1), (3, 200)] {
        let blank = Picture::filled(ImageSize::new(width, height), [80, 80, 80, 255]);
        assert!(extract(&blank, &[], &FeatureOptions::default()).unwrap().is_empty(), "{width} × {height}");
    }
    let narrow = FeatureOptions { max_width_px: 1, ..FeatureOptions::default() };
    assert!(extract(&Picture::filled(ImageSize::new(8, 2), [0; 4]), &[], &narrow).unwrap().is_empty());
}
