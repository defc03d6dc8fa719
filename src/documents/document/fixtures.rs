//! What tests of several rooms begin with.

use super::{Click, Frame, FramePtz, FrameStatus};
use touchline_core::camera::Ptz;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// An accepted frame that looks there, with a click on each landmark.
pub fn reference(pan_deg: f64, landmarks: &[&str]) -> Frame {
    let mut frame = Frame::from_image("a.jpg", "main".into(), ImageSize::new(1920, 1080));
    frame.status = FrameStatus::Reference;
    frame.ptz = Some(FramePtz::new(
        Ptz::from_degrees(pan_deg, -10.0, 2000.0),
        None,
    ));
    frame.clicks = landmarks
        .iter()
        .map(|id| Click::landmark((*id).into(), ImagePoint::new(9.0, 9.0)))
        .collect();
    frame
}
