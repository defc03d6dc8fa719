//! What tests of every crate that knows documents begin with: a match, its frames, what is known of
//! them.
#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    reason = "for tests alone"
)]

use crate::document::{
    Camera, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, ShotContent, ShotKind,
    Solution, SolutionSource, VideoFrame, VideoShots, document_from_bytes, document_to_string,
};
use std::fs;
use std::path::Path;
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::SIZE;

/// The size of pictures that are never looked at, px.
pub const SMALL: ImageSize = ImageSize::new(64, 48);

/// A document of a soccer field without cameras and frames.
pub fn soccer_document() -> Document {
    Document::new(FieldSpec::new("soccer"))
}

/// A document of a soccer field and the camera `main`, of which only the size of its pictures is
/// known.
pub fn a_match(image_size: ImageSize) -> Document {
    let mut document = soccer_document();
    let camera = Camera::new("main".into(), image_size);
    document.cameras.push(camera.into());
    document
}

/// The same with the camera's base.
pub fn match_from(base: &CameraBase, image_size: ImageSize) -> Document {
    let mut document = a_match(image_size);
    document.cameras[0].set_base(base);
    document
}

/// Adding frames to a document.
pub trait WithFrames {
    /// With these frames behind those that it has.
    #[must_use]
    fn with_frames(self, frames: impl IntoIterator<Item = Frame>) -> Self;

    /// With a new frame for each picture.
    #[must_use]
    fn with_pictures<Name: AsRef<str>>(
        self,
        names: impl IntoIterator<Item = Name>,
        image_size: ImageSize,
    ) -> Self;

    /// With so many new frames: `0.jpg`, `1.jpg` and so on.
    #[must_use]
    fn with_numbered(self, count: usize, image_size: ImageSize) -> Self;
}

impl WithFrames for Document {
    fn with_frames(mut self, frames: impl IntoIterator<Item = Frame>) -> Self {
        self.frames.extend(frames.into_iter().map(Into::into));
        self
    }

    fn with_pictures<Name: AsRef<str>>(
        self,
        names: impl IntoIterator<Item = Name>,
        image_size: ImageSize,
    ) -> Self {
        let names = names.into_iter();
        self.with_frames(names.map(|name| new_frame(name.as_ref(), image_size)))
    }

    fn with_numbered(self, count: usize, image_size: ImageSize) -> Self {
        self.with_pictures((0..count).map(|index| format!("{index}.jpg")), image_size)
    }
}

/// A frame of the camera `main` in which nothing is done.
pub fn new_frame(picture: &str, image_size: ImageSize) -> Frame {
    Frame::from_image(picture, "main".into(), image_size)
}

/// The same of a video at 25 frames per second.
pub fn new_video_frame(path: &str, index: u64, image_size: ImageSize) -> Frame {
    let video = VideoFrame::new(path, index, Some(index as f64 / 25.0));
    Frame::from_video(video, "main".into(), image_size)
}

/// A video of a soccer match with so many frames, cut where its shots begin.
pub fn cut_video(path: &str, frames: u64, cuts: &[(u64, ShotKind)]) -> Document {
    let mut document = soccer_document();
    for index in 0..frames {
        let frame = new_video_frame(path, index, SMALL);
        document.frames.push(frame.into());
    }
    VideoShots::from_cuts(&document, path, frames - 1, cuts).write(&mut document);
    document
}

/// A broadcast of twenty frames: six of a field with certain cameras but for the last one, three of
/// a dissolve, five of a close-up, six of a field without a camera.
pub fn broadcast() -> Document {
    let cuts = [
        (6, ShotKind::Transition),
        (9, ShotKind::Fade),
        (14, ShotKind::Cut),
    ];
    let mut document = cut_video("a.mp4", 20, &cuts);
    document.shots[2].content = Some(ShotContent::NoField);
    for index in 0..6 {
        let frame = &mut document.frames[index];
        frame.ptz = ptz_at(0.0, -9.0, 90.0);
        let confidence = if index == 5 { 0.5 } else { 0.99 };
        frame.solution = answered_by(SolutionSource::Forest, Some(confidence));
    }
    document
}

/// Where a frame looks, degrees and px.
pub fn ptz_at(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> Option<FramePtz> {
    let ptz = Ptz::from_degrees(pan_deg, tilt_deg, focal_px);
    Some(FramePtz::new(ptz, None))
}

/// What is known of a frame whose camera came from here.
pub fn solved_by(source: SolutionSource) -> Option<Solution> {
    answered_by(source, None)
}

/// The same with a confidence.
pub fn answered_by(source: SolutionSource, confidence: Option<f64>) -> Option<Solution> {
    Some(Solution {
        source: Some(source),
        confidence,
        ..Solution::default()
    })
}

/// An accepted frame that looks there, with a click on each landmark.
pub fn reference(pan_deg: f64, landmarks: &[&str]) -> Frame {
    let mut frame = new_frame("a.jpg", SIZE);
    frame.status = FrameStatus::Reference;
    frame.ptz = ptz_at(pan_deg, -10.0, 2000.0);
    frame.clicks = landmarks
        .iter()
        .map(|id| Click::landmark((*id).into(), ImagePoint::new(9.0, 9.0)))
        .collect();
    frame
}

/// A document of one camera with a new frame for each name.
pub fn document(names: &[&str]) -> Document {
    a_match(SMALL).with_pictures(names, SMALL)
}

/// The name of each frame, and its comment behind it.
pub fn names_and_comments(document: &Document) -> Vec<String> {
    let frames = document.frames.iter();
    frames
        .map(|frame| frame.name() + frame.comment.as_deref().unwrap_or_default())
        .collect()
}

/// Reads a document that must be whole.
pub fn load(file: impl AsRef<Path>) -> Document {
    document_from_bytes(&fs::read(file).unwrap()).unwrap()
}

/// Writes a document into a file.
pub fn save(file: impl AsRef<Path>, document: &Document) {
    fs::write(file, document_to_string(document).unwrap()).unwrap();
}
