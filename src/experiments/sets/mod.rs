//! Frames with known cameras and their features, and who teaches whom.

mod documents;
mod drawn;

pub use documents::{OwnDocuments, of_documents};
pub use drawn::{as_picture, highlights, worldcup};

use crate::camera::{Ptz, PtzCamera};
use crate::features::Features;
use crate::field::FieldModel;
use crate::geometry::PixelBox;
use crate::relocalize::{Samples, SeenRange};
use image::{ImageFormat, RgbImage};

/// A frame whose camera is known.
#[derive(Clone, Debug)]
pub struct KnownFrame {
    /// Its true camera.
    pub truth: PtzCamera,
    /// Its features, outside players and graphics.
    pub features: Features,
    /// Its field.
    pub field: FieldModel,
    /// Its picture as a JPEG file, where it was drawn.
    pub jpeg: Option<Vec<u8>>,
    /// Where players and graphics are, px.
    pub masks: Vec<PixelBox>,
}

impl KnownFrame {
    /// Its picture, where it was drawn.
    pub fn picture(&self) -> Option<RgbImage> {
        let decoded = image::load_from_memory_with_format(self.jpeg.as_ref()?, ImageFormat::Jpeg).ok()?;
        Some(decoded.into_rgb8())
    }
}

/// Frames, and how they are split.
#[derive(Clone, Debug)]
pub struct FrameSet {
    /// What it is, in words: "drawn, …" where it is drawn.
    pub title: String,
    /// Who teaches whom, in words.
    pub teaching: &'static str,
    /// The frames.
    pub frames: Vec<KnownFrame>,
    /// Who teaches whom; the frames of one split are of one camera.
    pub splits: Vec<Split>,
}

/// Frames that teach and frames that are asked.
#[derive(Clone, Debug)]
pub struct Split {
    /// Its name: that of what is asked.
    pub name: String,
    /// Frames that teach.
    pub teachers: Vec<usize>,
    /// Frames that are asked.
    pub asked: Vec<usize>,
}

impl FrameSet {
    /// What some frames teach, and where they looked; none without features.
    pub fn lessons(&self, frames: &[usize]) -> Option<(Samples, SeenRange)> {
        let mut samples = Samples::new();
        for frame in frames.iter().map(|&frame| &self.frames[frame]) {
            let rays = frame.features.keypoints.iter().map(|keypoint| frame.truth.ray_from_image(keypoint.point));
            let pairs = rays.zip(&frame.features.descriptors);
            samples.add_frame(pairs.filter_map(|(ray, descriptor)| Some((*descriptor, ray.ok()?))));
        }
        let seen: Vec<Ptz> = frames.iter().map(|&frame| self.frames[frame].truth.ptz()).collect();
        Some((samples, SeenRange::of(&seen)?))
    }
}
