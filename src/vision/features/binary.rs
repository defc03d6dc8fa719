//! ORB and AKAZE, used only for comparison with SIFT, and the boundary to OpenCV's detectors.

#[cfg(feature = "opencv")]
use super::spread::spread_unmasked;
use super::{DESCRIPTOR_BYTES, Descriptor, FeatureError, Keypoint};
use crate::media::Picture;
use touchline_core::geometry::{ImageSize, PixelBox};

/// Maximum length of a descriptor, in words of 64 bits.
const WORDS: usize = 8;

/// A kind of binary features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryKind {
    /// Rublee et al. 2011: FAST corners, 256 comparisons of brightness.
    Orb,
    /// Alcantarilla et al. 2013: blobs of a nonlinear scale space, 486 comparisons.
    Akaze,
}

/// A descriptor of bits, compared by Hamming distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinaryDescriptor {
    bits: [u64; WORDS],
}

impl BinaryDescriptor {
    /// A descriptor from at most 64 bytes, least significant bit first.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        let mut words = [0u64; WORDS];
        for (at, byte) in bytes.iter().enumerate().take(8 * WORDS) {
            words[at / 8] |= u64::from(*byte) << (8 * (at % 8));
        }
        Self { bits: words }
    }

    /// 128 of its bits as bytes, so that one forest serves all kinds of features.
    ///
    /// Of ORB the first 128 bits are taken, which its authors found to vary most; of AKAZE every
    /// 3.8th. A set bit has the value 40, so that a quarter of the bits differing, 32 · 40² / 512²,
    /// is about the gate on SIFT's squared distances (0.2).
    pub fn as_bytes(&self, kind: BinaryKind) -> Descriptor {
        const SET: u8 = 40;
        let step = match kind {
            BinaryKind::Orb => 1.0,
            BinaryKind::Akaze => f64::from(kind.bits()) / DESCRIPTOR_BYTES as f64,
        };
        Descriptor(std::array::from_fn(|at| {
            let bit = (at as f64 * step) as usize;
            if self.bits[bit / 64] >> (bit % 64) & 1 == 1 {
                SET
            } else {
                0
            }
        }))
    }

    /// Hamming distance: the number of bits that differ.
    pub fn distance(&self, other: &Self) -> u32 {
        self.bits
            .iter()
            .zip(&other.bits)
            .map(|(a, b)| (a ^ b).count_ones())
            .sum()
    }
}

impl BinaryKind {
    /// Number of bits of a descriptor.
    pub const fn bits(self) -> u32 {
        match self {
            Self::Orb => 256,
            Self::Akaze => 486,
        }
    }
}

/// The binary features of a picture, the strongest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryFeatures {
    /// The size of the picture, px.
    pub image_size: ImageSize,
    /// Positions, sizes and strengths.
    pub keypoints: Vec<Keypoint>,
    /// One descriptor for each keypoint.
    pub descriptors: Vec<BinaryDescriptor>,
}

/// At most `max_count` binary features of a picture whose centres lie in none of the `masks` (px),
/// spread over it as [`extract`](super::extract) spreads SIFT.
///
/// # Errors
/// The program was built without OpenCV, or OpenCV reported an error.
#[cfg(feature = "opencv")]
pub fn extract_binary(
    picture: &Picture,
    masks: &[PixelBox],
    kind: BinaryKind,
    max_count: usize,
) -> Result<BinaryFeatures, FeatureError> {
    let image_size = picture.size();
    // A surplus, so that masks and spreading can choose.
    let limit = max_count.saturating_mul(3);
    let found = opencv_calls::detect(&crate::media::grey_reduced(picture, 1), kind, limit)
        .map_err(|error| FeatureError::from_opencv(&error, image_size))?;
    let (keypoints, descriptors) = spread_unmasked(found, masks, image_size, max_count);
    Ok(BinaryFeatures {
        image_size,
        keypoints,
        descriptors,
    })
}

/// Without OpenCV there are no binary features.
///
/// # Errors
/// Always [`FeatureError::WithoutOpenCv`].
#[cfg(not(feature = "opencv"))]
pub fn extract_binary(
    _picture: &Picture,
    _masks: &[PixelBox],
    _kind: BinaryKind,
    _max_count: usize,
) -> Result<BinaryFeatures, FeatureError> {
    Err(FeatureError::WithoutOpenCv)
}

#[cfg(feature = "opencv")]
pub(super) mod opencv_calls {
    use super::{BinaryDescriptor, BinaryKind};
    use crate::features::Keypoint;
    use crate::media::GreyPicture;
    use opencv::core::{KeyPoint, Mat, Ptr, Vector, no_array};
    use opencv::features2d::{AKAZE, ORB, ORB_ScoreType};
    use opencv::prelude::*;
    use touchline_core::geometry::ImagePoint;

    /// OpenCV's keypoints count from the first pixel's centre; in corner coordinates it is at 0.5
    /// px.
    const CORNER_FROM_OPENCV: f64 = 0.5;

    /// Factor between levels of ORB's pyramid. OpenCV multiplies a level's coordinates by its scale
    /// without regard to the half pixel, so the half pixel grows with the level.
    const ORB_SCALE: f32 = 1.2;

    /// Minimum shorter side, px. Smaller pictures give no features, because the patches are larger.
    const MIN_SIDE_PX: u32 = 64;

    /// All features with OpenCV's own settings; for ORB at most `limit`, which it requires.
    pub fn detect(
        grey: &GreyPicture,
        kind: BinaryKind,
        limit: usize,
    ) -> opencv::Result<Vec<(Keypoint, BinaryDescriptor)>> {
        if grey.size.width.min(grey.size.height) < MIN_SIDE_PX {
            return Ok(Vec::new());
        }
        crate::features::sift::use_one_thread();
        let image = Mat::new_rows_cols_with_bytes::<u8>(
            grey.size.height as i32,
            grey.size.width as i32,
            &grey.values,
        )?;
        let mut keypoints = Vector::<KeyPoint>::new();
        let mut descriptors = Mat::default();
        match kind {
            BinaryKind::Orb => {
                // Limit and scale are set; the others are OpenCV's defaults, in its order: levels,
                // edge threshold, first level, points of a comparison, score, patch size, threshold
                // of FAST.
                let limit = limit.min(i32::MAX as usize) as i32;
                let mut orb: Ptr<ORB> = ORB::create(
                    limit,
                    ORB_SCALE,
                    8,
                    31,
                    0,
                    2,
                    ORB_ScoreType::HARRIS_SCORE,
                    31,
                    20,
                )?;
                orb.detect_and_compute(
                    &image,
                    &no_array(),
                    &mut keypoints,
                    &mut descriptors,
                    false,
                )?;
            }
            BinaryKind::Akaze => {
                // All defaults: versions of OpenCV differ in the number of arguments.
                let mut akaze: Ptr<AKAZE> = AKAZE::create_def()?;
                akaze.detect_and_compute(
                    &image,
                    &no_array(),
                    &mut keypoints,
                    &mut descriptors,
                    false,
                )?;
            }
        }
        // Rows of descriptors belong to keypoints by their order. The octave of ORB's keypoints is
        // the level; AKAZE gives coordinates of the full picture.
        let mut found = Vec::with_capacity(keypoints.len());
        for (row, keypoint) in keypoints.iter().enumerate() {
            let at = keypoint.pt();
            // See [`ORB_SCALE`]: ORB's offset from corner coordinates depends on the level.
            let half_px = match kind {
                BinaryKind::Orb => {
                    CORNER_FROM_OPENCV * f64::from(ORB_SCALE).powi(keypoint.octave())
                }
                BinaryKind::Akaze => CORNER_FROM_OPENCV,
            };
            let point = ImagePoint::new(f64::from(at.x) + half_px, f64::from(at.y) + half_px);
            let descriptor = BinaryDescriptor::from_bytes(descriptors.at_row::<u8>(row as i32)?);
            found.push((
                Keypoint {
                    point,
                    size_px: keypoint.size(),
                    strength: keypoint.response(),
                },
                descriptor,
            ));
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::pixel_box;

    #[test]
    fn a_quarter_of_the_bits_is_the_gate() {
        let [none, quarter] =
            [0, 0b0001_0001].map(|byte| BinaryDescriptor::from_bytes(&[byte; 64]));
        for kind in [BinaryKind::Orb, BinaryKind::Akaze] {
            let distance = none
                .as_bytes(kind)
                .squared_distance(&quarter.as_bytes(kind));
            assert!((distance - 0.2).abs() < 0.05, "{kind:?}: {distance}");
        }
    }

    #[test]
    fn bits_that_differ_are_counted() {
        let one = BinaryDescriptor::from_bytes(&[0b1010_0000, 0, 0, 0, 0, 0, 0, 0, 0xFF]);
        let other = BinaryDescriptor::from_bytes(&[0b1000_0001]);
        assert_eq!(one.distance(&other), 2 + 8);
        assert_eq!(one.distance(&one), 0);
    }

    #[cfg(feature = "opencv")]
    #[test]
    fn corners_are_found_where_they_are_and_not_under_masks() {
        // A bright square on grey: corners at 60 and 100 px.
        let size = ImageSize::new(160, 160);
        let inside = |x: u32, y: u32| (60..100).contains(&x) && (60..100).contains(&y);
        let pixels =
            (0..160).flat_map(|y| (0..160).map(move |x| if inside(x, y) { 230u8 } else { 60 }));
        let picture = Picture::new(
            size,
            pixels
                .flat_map(|value| [value, value, value, 255])
                .collect(),
        )
        .unwrap();
        for kind in [BinaryKind::Orb, BinaryKind::Akaze] {
            let found = extract_binary(&picture, &[], kind, 50).unwrap();
            assert!(
                !found.keypoints.is_empty() && found.keypoints.len() == found.descriptors.len(),
                "{kind:?}"
            );
            let middle = found.keypoints.iter().fold([0.0, 0.0], |sum, k| {
                [sum[0] + k.point.x, sum[1] + k.point.y]
            });
            let middle = middle.map(|sum| sum / found.keypoints.len() as f64);
            // The square is the same from all sides, so its features are centred on it: at 80, in
            // corner coordinates.
            assert!(
                middle.iter().all(|at| (at - 80.0).abs() < 2.0),
                "{kind:?} {middle:?}"
            );
            let left = pixel_box(0.0, 0.0, 80.0, 160.0);
            let masked = extract_binary(&picture, &[left], kind, 50).unwrap();
            assert!(
                masked
                    .keypoints
                    .iter()
                    .all(|keypoint| keypoint.point.x >= 80.0),
                "{kind:?}"
            );
        }
    }
}
