//! Homographies of the ground, whatever file they are in: the one that a frame is written with, its
//! inverse and scale, and the shift between conventions of pixels.
//!
//! A homography has neither distortion nor points off the ground. Where a camera has a distortion
//! or its field a crown, the homography that fits best over the visible pitch is taken.

use crate::exchange::cameras::camera_format::{HeldFrame, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::ground_fit::fit_image_from_ground;
use crate::exchange::cameras::held::parts;
use crate::exchange::error::Problem;
use crate::exchange::options::Pixels;
use touchline_core::geometry::Mat3;

/// The map from another pixel convention to ours, with the origin at the corner.
pub(super) fn corner_from(pixels: Pixels) -> Mat3 {
    let shift = pixels.to_corner_px();
    Mat3::new(1.0, 0.0, shift, 0.0, 1.0, shift, 0.0, 0.0, 1.0)
}

/// Scaled so that the last entry is one, where it is not zero.
pub(super) fn normalise_homography(h: Mat3) -> Mat3 {
    if h[(2, 2)] == 0.0 { h } else { h / h[(2, 2)] }
}

/// The inverse of a homography; an overflow counts as singular, too.
pub(super) fn inverse(h: &Mat3, what: &str) -> Result<Mat3, Problem> {
    h.try_inverse()
        .filter(|inverse| inverse.iter().all(|entry| entry.is_finite()))
        .ok_or_else(|| Problem::Singular(what.to_owned()))
}

/// The homography of the camera's undistorted picture if the options ask for that, else of its
/// picture as it is. Exact without distortion and crown, else fitted.
pub(super) fn hold(frame: &FrameCamera, name: String, context: &WriteContext<'_>) -> HeldFrame {
    let (pinhole, size) = parts(frame)?;
    // Without distortion and crown the homography is exact: K [r₁ r₂ t]. Else fit it.
    let ideal = Pinhole {
        lens: pinhole.lens.without_distortion(),
        ..pinhole
    };
    // The homography is of one picture: the one that is on disk, or the one without distortion that
    // the user makes of it.
    let shown_by = if context.options.undistorted {
        ideal
    } else {
        pinhole
    };
    let shown = if shown_by.lens.is_none() && context.field.crown_m == 0.0 {
        ideal.image_from_ground()
    } else {
        let fitted = fit_image_from_ground(&shown_by, size, context.field);
        fitted.ok_or("it shows too little of the pitch for a homography")?
    };
    if shown.try_inverse().is_none() {
        return Err("the ground is seen edge-on".to_owned());
    }
    Ok(FrameCamera {
        name,
        shown: FrameProjection::Ground(shown),
        ..frame.clone()
    })
}

/// Nine numbers by rows.
pub(super) fn matrix(values: &[f64]) -> Result<Mat3, Problem> {
    if values.len() == 9 {
        return Ok(Mat3::from_row_slice(values));
    }
    Err(Problem::wrong_count(
        "the homography (numbers)",
        9,
        values.len(),
    ))
}
