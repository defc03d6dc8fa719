//! Extracts a picture's features, without masked areas and up to a maximum number.

#[cfg(feature = "opencv")]
use super::burnt_in::shared_area;
use super::descriptor::Features;
#[cfg(feature = "opencv")]
use super::spread::spread_unmasked;
#[cfg(feature = "opencv")]
use super::{BinaryKind, Descriptor, Detector, Keypoint};
use super::{FeatureError, FeatureOptions};
use crate::media::Picture;
use touchline_core::geometry::PixelBox;
#[cfg(feature = "opencv")]
use touchline_core::geometry::{ImagePoint, ImageSize};

/// Number of features requested from the detector, relative to the maximum. Masks and spreading
/// then choose among them.
#[cfg(feature = "opencv")]
const SURPLUS: u32 = 2;

/// The features of a picture whose centres lie in none of the `masks` (px of the full picture).
///
/// # Errors
/// The program was built without OpenCV, or OpenCV reported an error. A picture without texture has
/// no features, which is no error.
#[cfg(feature = "opencv")]
pub fn extract(
    picture: &Picture,
    masks: &[PixelBox],
    options: &FeatureOptions,
) -> Result<Features, FeatureError> {
    let image_size = picture.size();
    let factor = options.reduction(image_size.width);
    let grey = crate::media::grey_reduced(picture, factor);
    // Features under masks are dropped, so more are requested in proportion.
    let limit =
        f64::from(options.max_count.saturating_mul(SURPLUS)) / open_share(masks, image_size);
    let found = detect_features(&grey, limit.min(f64::from(i32::MAX)) as u32, options)
        .map_err(|error| FeatureError::from_opencv(&error, image_size))?;
    // In the corner convention a reduced picture differs from the full one by a factor alone.
    let full_px = f64::from(factor);
    let in_full = found.into_iter().map(|(reduced, descriptor)| {
        let point = ImagePoint::new(reduced.point.x * full_px, reduced.point.y * full_px);
        (
            Keypoint {
                point,
                size_px: reduced.size_px * factor as f32,
                ..reduced
            },
            descriptor,
        )
    });
    let max_count = options.max_count as usize;
    let (keypoints, descriptors) = spread_unmasked(in_full, masks, image_size, max_count);
    Ok(Features {
        image_size,
        keypoints,
        descriptors,
    })
}

/// Runs the detector: about `limit` keypoints, in px of the grey picture, and their descriptors.
#[cfg(feature = "opencv")]
fn detect_features(
    grey: &crate::media::GreyPicture,
    limit: u32,
    options: &FeatureOptions,
) -> opencv::Result<Vec<(Keypoint, Descriptor)>> {
    match options.detector {
        Detector::Sift => {
            let describe = if options.root_sift {
                Descriptor::root
            } else {
                Descriptor::plain
            };
            let found = super::sift::sift(grey, limit)?;
            Ok(found
                .into_iter()
                .map(|(keypoint, values)| (keypoint, describe(&values)))
                .collect())
        }
        Detector::Orb => bits(grey, limit, BinaryKind::Orb),
        Detector::Akaze => bits(grey, limit, BinaryKind::Akaze),
    }
}

#[cfg(feature = "opencv")]
fn bits(
    grey: &crate::media::GreyPicture,
    limit: u32,
    kind: BinaryKind,
) -> opencv::Result<Vec<(Keypoint, Descriptor)>> {
    let found = super::binary::opencv_calls::detect(grey, kind, limit as usize)?;
    Ok(found
        .into_iter()
        .map(|(keypoint, descriptor)| (keypoint, descriptor.as_bytes(kind)))
        .collect())
}

/// Share of a picture that no mask covers, at least a tenth. Overlapping masks count twice, which
/// only requests more features than needed.
#[cfg(feature = "opencv")]
fn open_share(masks: &[PixelBox], size: ImageSize) -> f64 {
    let whole = PixelBox::new(0.0, 0.0, f64::from(size.width), f64::from(size.height));
    let covered: f64 = masks.iter().map(|mask| shared_area(mask, &whole)).sum();
    (1.0 - covered / (whole.width * whole.height)).max(0.1)
}

/// The version of the OpenCV in use. None if the program was built without it.
pub fn opencv_version() -> Option<String> {
    #[cfg(feature = "opencv")]
    return opencv::core::get_version_string().ok();
    #[cfg(not(feature = "opencv"))]
    return None;
}

/// Without OpenCV there are no features.
///
/// # Errors
/// Always [`FeatureError::WithoutOpenCv`].
#[cfg(not(feature = "opencv"))]
pub fn extract(
    _picture: &Picture,
    _masks: &[PixelBox],
    _options: &FeatureOptions,
) -> Result<Features, FeatureError> {
    Err(FeatureError::WithoutOpenCv)
}
