//! The boundary to OpenCV's robust homographies.
//!
//! Points keep the corner convention: a homography between two pictures in the same convention
//! needs no conversion.

use super::TrackError;
#[cfg(feature = "opencv")]
use opencv::calib3d::{USAC_MAGSAC, find_homography};
#[cfg(feature = "opencv")]
use opencv::core::{Mat, Point2d, Vector};
#[cfg(feature = "opencv")]
use opencv::prelude::*;
use touchline_core::geometry::{ImagePoint, Mat3};

/// The homography with the most support within `within_px`, and a flag per pair that says whether
/// it is an inlier (MAGSAC++: Barath and others, CVPR 2020). `None` if it cannot be estimated.
#[cfg(feature = "opencv")]
pub(super) fn robust_homography(
    pairs: &[(ImagePoint, ImagePoint)],
    within_px: f64,
) -> Result<Option<(Mat3, Vec<bool>)>, TrackError> {
    // Four pairs determine a homography; with fewer OpenCV fails, which is no error here.
    if pairs.len() < 4 {
        return Ok(None);
    }
    let mut agree = Mat::default();
    let found = find_homography(
        &opencv_points(pairs.iter().map(|pair| pair.0)),
        &opencv_points(pairs.iter().map(|pair| pair.1)),
        &mut agree,
        USAC_MAGSAC,
        within_px,
    )
    .map_err(|error| TrackError::from_opencv(&error))?;
    // Without a model OpenCV returns an empty matrix, else 3 × 3 numbers, row by row.
    if found.empty() {
        return Ok(None);
    }
    let values = found
        .data_typed::<f64>()
        .map_err(|error| TrackError::from_opencv(&error))?;
    let agree = agree
        .data_typed::<u8>()
        .map_err(|error| TrackError::from_opencv(&error))?;
    Ok(Some((
        Mat3::from_row_slice(values),
        agree.iter().map(|flag| *flag != 0).collect(),
    )))
}

/// The points as OpenCV takes them, px, in the same convention.
#[cfg(feature = "opencv")]
fn opencv_points(points: impl Iterator<Item = ImagePoint>) -> Vector<Point2d> {
    points.map(|point| Point2d::new(point.x, point.y)).collect()
}

/// Always an error: the program was built without OpenCV.
#[cfg(not(feature = "opencv"))]
pub(super) fn robust_homography(
    _pairs: &[(ImagePoint, ImagePoint)],
    _within_px: f64,
) -> Result<Option<(Mat3, Vec<bool>)>, TrackError> {
    Err(TrackError::WithoutOpenCv)
}
