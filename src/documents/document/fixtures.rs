//! What tests of several rooms begin with.

use super::{Camera, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus};
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

/// The size of the pictures of [`document`], px.
pub const SMALL: ImageSize = ImageSize::new(64, 48);

/// A document of one camera with a new frame for each name.
pub fn document(names: &[&str]) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    document
        .cameras
        .push(Camera::new("main".into(), SMALL).into());
    document.frames = names
        .iter()
        .map(|name| Frame::from_image(name, "main".into(), SMALL).into())
        .collect();
    document
}

/// The name of each frame, and its comment behind it.
pub fn names_and_comments(document: &Document) -> Vec<String> {
    document
        .frames
        .iter()
        .map(|frame| frame.name() + frame.comment.as_deref().unwrap_or_default())
        .collect()
}
