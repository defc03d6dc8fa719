//! The boundary to OpenCV's SIFT. Its pixel convention is converted here and known nowhere else.

use super::{DESCRIPTOR_BYTES, Keypoint};
use crate::media::GreyPicture;
use opencv::core::{KeyPoint, Mat, Ptr, Vector, no_array};
use opencv::features2d::SIFT;
use opencv::prelude::*;
use std::sync::Once;
use touchline_core::geometry::ImagePoint;

/// From OpenCV's keypoints to corner coordinates, px: half a pixel for the convention, less the
/// bias of a quarter that its SIFT has.
const CORNER_FROM_OPENCV: f64 = 0.25;

/// Minimum shorter side, px. Smaller pictures give no features: OpenCV's pyramid needs some pixels.
const MIN_SIDE_PX: u32 = 12;

/// Layers per octave, contrast threshold, edge threshold and σ of the first layer: OpenCV's
/// defaults, from Lowe's paper.
const LAYERS: i32 = 3;
const CONTRAST: f64 = 0.04;
const EDGE: f64 = 10.0;
const SIGMA: f64 = 1.6;

/// SIFT's constructor, whose arguments OpenCV's versions differ in: the trait is implemented for
/// both, and the compiler takes the one that exists.
trait SiftConstructor<Arguments> {
    /// A detector of at most `limit` keypoints.
    fn detector(self, limit: i32) -> opencv::Result<Ptr<SIFT>>;
}

/// The arguments of OpenCV up to 4.7.
type Plain = (i32, i32, f64, f64, f64);
/// The arguments of OpenCV from 4.8 on.
type WithPreciseUpscale = (i32, i32, f64, f64, f64, bool);

impl<F: Fn(i32, i32, f64, f64, f64) -> opencv::Result<Ptr<SIFT>>> SiftConstructor<Plain> for F {
    fn detector(self, limit: i32) -> opencv::Result<Ptr<SIFT>> {
        self(limit, LAYERS, CONTRAST, EDGE, SIGMA)
    }
}

impl<F: Fn(i32, i32, f64, f64, f64, bool) -> opencv::Result<Ptr<SIFT>>>
    SiftConstructor<WithPreciseUpscale> for F
{
    fn detector(self, limit: i32) -> opencv::Result<Ptr<SIFT>> {
        // Without the precise upscale, as in earlier versions: [`CORNER_FROM_OPENCV`] is for it,
        // and forests of all versions serve each other.
        self(limit, LAYERS, CONTRAST, EDGE, SIGMA, false)
    }
}

/// Disables OpenCV's own threads. Frames are processed in parallel, so its threads would compete
/// with them.
pub(super) fn use_one_thread() {
    static ONE_THREAD: Once = Once::new();
    ONE_THREAD.call_once(|| {
        // A failure leaves OpenCV's default, which is only slower.
        let _ = opencv::core::set_num_threads(1);
    });
}

/// The strongest `limit` SIFT keypoints of a grey picture, in its px, corner convention, with their
/// descriptors in OpenCV's numbers (0 to 255).
pub(super) fn sift(
    grey: &GreyPicture,
    limit: u32,
) -> opencv::Result<Vec<(Keypoint, [f32; DESCRIPTOR_BYTES])>> {
    let (width, height) = (grey.size.width, grey.size.height);
    if limit == 0 || width.min(height) < MIN_SIDE_PX {
        return Ok(Vec::new());
    }
    use_one_thread();
    // A view of the grey values, not a copy. SIFT itself keeps the strongest `limit`.
    let image = Mat::new_rows_cols_with_bytes::<u8>(height as i32, width as i32, &grey.values)?;
    let mut sift = SIFT::create.detector(limit.min(i32::MAX as u32) as i32)?;
    let mut keypoints = Vector::<KeyPoint>::new();
    let mut descriptors = Mat::default();
    sift.detect_and_compute(&image, &no_array(), &mut keypoints, &mut descriptors, false)?;
    if keypoints.is_empty() {
        return Ok(Vec::new());
    }
    // One row of 128 numbers for each keypoint.
    let (rows, _) = descriptors
        .data_typed::<f32>()?
        .as_chunks::<DESCRIPTOR_BYTES>();
    Ok(keypoints
        .iter()
        .zip(rows)
        .map(|(found, values)| {
            let at = found.pt();
            let point = ImagePoint::new(
                f64::from(at.x) + CORNER_FROM_OPENCV,
                f64::from(at.y) + CORNER_FROM_OPENCV,
            );
            (
                Keypoint {
                    point,
                    size_px: found.size(),
                    strength: found.response(),
                },
                *values,
            )
        })
        .collect())
}
