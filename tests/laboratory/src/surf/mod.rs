//! Upright SURF, only for the comparison with SIFT: the paper says beside table 4 what SURF costs.
//!
//! Written from its publication: H. Bay, A. Ess, T. Tuytelaars, L. Van Gool, "Speeded-Up Robust
//! Features (SURF)", Computer Vision and Image Understanding 110, 2008. OpenCV has it among its
//! non-free modules only, so users of this program have none.
//!
//! | step | where |
//! |---|---|
//! | sums of grey values over boxes, in four look-ups | `integral.rs` |
//! | blobs: maxima of the Hessian's determinant over place and scale | `blobs.rs` |
//! | 64 numbers that describe a blob's surroundings | `description.rs` |
//!
//! Upright: no orientation is assigned. A camera on a tripod does not roll, and the publication
//! finds the upright version better where that is so.

mod blobs;
mod description;
mod integral;

pub use description::SQUARED_SCALE;

use blobs::{Blob, find_blobs};
use description::describe;
use integral::Integral;
use touchline::features::{FeatureOptions, Features, Keypoint};
use touchline::geometry::{ImagePoint, PixelBox};
use touchline::media::Picture;

/// The strongest `most` SURF features of a picture whose centres lie in none of the `masks` (px).
/// Equally strong ones are in order of their position, row by row.
///
/// Wide pictures are reduced as for SIFT. Squared distances of the descriptors are
/// [`SQUARED_SCALE`] of those of unit descriptors.
pub fn extract_surf(picture: &Picture, masks: &[PixelBox], most: usize) -> Features {
    let image_size = picture.size();
    let widest = FeatureOptions::default().max_width_px;
    let factor = image_size.width.div_ceil(widest).max(1);
    let grey = Integral::from_picture(picture, factor);
    // In the corner convention a reduced picture differs from the full one by a factor alone.
    let full_px = f64::from(factor);
    let in_picture = |blob: &Blob| ImagePoint::new(blob.x * full_px, blob.y * full_px);
    let mut blobs = find_blobs(&grey);
    blobs.retain(|blob| !masks.iter().any(|mask| mask.contains(in_picture(blob))));
    blobs.sort_by(|a, b| {
        let by_strength = b.strength.total_cmp(&a.strength);
        by_strength
            .then(a.y.total_cmp(&b.y))
            .then(a.x.total_cmp(&b.x))
    });
    // Lazily: only the features that are taken are described. A blob without a description takes no
    // place.
    let described = blobs.iter().filter_map(|blob| {
        let keypoint = Keypoint {
            point: in_picture(blob),
            // Twice the scale, as OpenCV states the size of SIFT's keypoints.
            size_px: (2.0 * blob.scale * full_px) as f32,
            strength: blob.strength as f32,
        };
        Some((keypoint, describe(&grey, blob)?))
    });
    let (keypoints, descriptors) = described.take(most).unzip();
    Features {
        image_size,
        keypoints,
        descriptors,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline::features::Descriptor;
    use touchline::geometry::ImageSize;

    /// The scale at which a Gaussian of standard deviation 1 is found. With Gaussian derivatives it
    /// would be 1; with boxes of lobe l it is that of the largest (3 Φ(l/2) − Φ(3l/2)) Φ(5l/6) / l²,
    /// where Φ(a) is the Gaussian's integral from −a to a.
    const SCALE_OF_GAUSSIAN: f64 = 0.714;

    /// A grey picture, from the value at each pixel's centre in corner coordinates.
    fn picture(width: u32, height: u32, grey: impl Fn(f64, f64) -> f64) -> Picture {
        let mut rgba = Vec::new();
        for row in 0..height {
            for column in 0..width {
                let value = grey(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let value = value.round().clamp(0.0, 255.0) as u8;
                rgba.extend([value, value, value, 255]);
            }
        }
        Picture::new(ImageSize::new(width, height), rgba).unwrap()
    }

    /// A blob: a Gaussian of this standard deviation.
    fn gaussian(x: f64, y: f64, [middle_x, middle_y]: [f64; 2], sigma: f64) -> f64 {
        let squared = (x - middle_x).powi(2) + (y - middle_y).powi(2);
        (-squared / (2.0 * sigma * sigma)).exp()
    }

    /// Blobs of many sizes, bright and dark, at places without pattern. `gain` scales the contrast.
    fn texture(x: f64, y: f64, gain: f64, brightness: f64) -> f64 {
        let blobs = (0..60u32).map(|number| {
            let draw = |salt: u32| {
                let mixed = (number * 7 + salt).wrapping_mul(2_654_435_761);
                f64::from(mixed >> 8) / f64::from(1u32 << 24)
            };
            let middle = [200.0 * draw(1), 160.0 * draw(2)];
            let height = if number % 2 == 0 { 60.0 } else { -60.0 };
            height * gaussian(x, y, middle, 2.0 + 6.0 * draw(3))
        });
        brightness + gain * blobs.sum::<f64>()
    }

    #[test]
    fn a_blob_is_found_at_its_centre_and_scale() {
        for (middle, sigma) in [
            ([80.5, 60.5], 3.0),
            ([80.0, 60.0], 5.0),
            ([77.3, 61.9], 4.0),
            ([90.2, 88.7], 10.0),
        ] {
            let picture = picture(180, 160, |x, y| {
                40.0 + 180.0 * gaussian(x, y, middle, sigma)
            });
            let found = extract_surf(&picture, &[], 10);
            let strongest = found.keypoints[0];
            let away = strongest
                .point
                .distance_px(ImagePoint::new(middle[0], middle[1]));
            assert!(away < 0.1 * sigma, "{middle:?} {sigma}: {strongest:?}");
            let ratio = f64::from(strongest.size_px) / (2.0 * sigma);
            assert!((ratio - SCALE_OF_GAUSSIAN).abs() < 0.05, "{sigma}: {ratio}");
        }
    }

    #[test]
    fn features_of_a_shifted_picture_match() {
        // 16 px: a whole number of steps of every octave.
        let shift = 16.0;
        let one = extract_surf(
            &picture(200, 160, |x, y| texture(x, y, 1.0, 128.0)),
            &[],
            40,
        );
        let shifted = picture(200, 160, |x, y| texture(x + shift, y, 1.0, 128.0));
        let other = extract_surf(&shifted, &[], 1000);
        assert_eq!(one.image_size, ImageSize::new(200, 160));
        // Features whose surroundings are inside both pictures.
        let inside = |keypoint: &Keypoint| {
            let reach = 7.0 * f64::from(keypoint.size_px);
            let point = keypoint.point;
            point.x - shift - reach > 0.0 && point.x + reach < 200.0
        };
        let mut compared = 0;
        for (keypoint, descriptor) in one.keypoints.iter().zip(&one.descriptors) {
            if !inside(keypoint) {
                continue;
            }
            let distance = |other: &Descriptor| descriptor.squared_distance(other) / SQUARED_SCALE;
            let nearest = (0..other.len())
                .min_by(|&a, &b| {
                    let [a, b] = [a, b].map(|at| distance(&other.descriptors[at]));
                    a.total_cmp(&b)
                })
                .unwrap();
            let expected = ImagePoint::new(keypoint.point.x - shift, keypoint.point.y);
            assert!(
                other.keypoints[nearest].point.distance_px(expected) < 0.01,
                "{keypoint:?}"
            );
            assert!(distance(&other.descriptors[nearest]) < 0.01, "{keypoint:?}");
            compared += 1;
        }
        assert!(compared >= 5, "{compared} features are compared");
    }

    #[test]
    fn brightness_and_contrast_leave_descriptors_as_they_are() {
        let one = extract_surf(
            &picture(200, 160, |x, y| texture(x, y, 0.9, 128.0)),
            &[],
            20,
        );
        let other = extract_surf(
            &picture(200, 160, |x, y| texture(x, y, 0.5, 110.0)),
            &[],
            60,
        );
        let mut compared = 0;
        for (keypoint, descriptor) in one.keypoints.iter().zip(&one.descriptors) {
            let same = other
                .keypoints
                .iter()
                .position(|other| other.point.distance_px(keypoint.point) < 0.3);
            let Some(same) = same else { continue };
            let squared = descriptor.squared_distance(&other.descriptors[same]) / SQUARED_SCALE;
            assert!(squared < 0.02, "{keypoint:?}: {squared}");
            compared += 1;
        }
        assert!(
            compared >= 15,
            "{compared} of {} are found again",
            one.len()
        );
    }

    #[test]
    fn masked_features_are_left_out_and_the_strongest_are_kept() {
        let picture = picture(200, 160, |x, y| texture(x, y, 1.0, 128.0));
        let all = extract_surf(&picture, &[], 1000);
        assert!(all.keypoints.is_sorted_by(|a, b| a.strength >= b.strength));
        let few = extract_surf(&picture, &[], 5);
        assert_eq!((&few.keypoints[..], few.len()), (&all.keypoints[..5], 5));
        let left = PixelBox {
            x: 0.0,
            y: 0.0,
            width: 100.0,
            height: 160.0,
        };
        let open = extract_surf(&picture, &[left], 1000);
        let right = all
            .keypoints
            .iter()
            .filter(|keypoint| keypoint.point.x >= 100.0);
        assert!(open.len() < all.len() && open.keypoints.iter().eq(right));
    }

    #[test]
    fn wide_pictures_are_reduced_and_positions_are_those_of_the_full_picture() {
        let middle = [900.0, 70.0];
        let wide = picture(1400, 140, |x, y| 40.0 + 180.0 * gaussian(x, y, middle, 8.0));
        let strongest = extract_surf(&wide, &[], 1).keypoints[0];
        assert!(
            strongest.point.distance_px(ImagePoint::new(900.0, 70.0)) < 1.0,
            "{strongest:?}"
        );
        let expected = 16.0 * SCALE_OF_GAUSSIAN;
        assert!(
            (f64::from(strongest.size_px) - expected).abs() < 1.0,
            "{strongest:?}"
        );
    }

    #[test]
    fn small_and_even_pictures_have_no_features() {
        for (width, height) in [
            (0, 0),
            (1, 1),
            (3, 200),
            (200, 8),
            (9, 9),
            (21, 21),
            (30, 30),
        ] {
            let even = Picture::with_colour(ImageSize::new(width, height), [90, 120, 60, 255]);
            assert!(
                extract_surf(&even, &[], 10).is_empty(),
                "{width} × {height}"
            );
            let wild = picture(width, height, |x, y| 255.0 * (7.0 * x * y).sin().abs());
            assert!(extract_surf(&wild, &[], 10).len() <= 10);
        }
        assert!(
            extract_surf(
                &Picture::with_colour(ImageSize::new(300, 200), [9; 4]),
                &[],
                10
            )
            .is_empty()
        );
    }
}
