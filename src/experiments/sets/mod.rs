//! Frames with known cameras and their features, split into training and test frames.

mod documents;
mod drawn;
mod highlights;
mod motion;
mod published;
mod worldcup;

pub use documents::{OwnDocument, OwnDocuments, of_own};
pub use drawn::as_picture;
pub use highlights::{frames_a_sequence, highlights};
pub use motion::{MOTION_FILE, RealMotion, motion};
pub use published::{PublishedKind, published, published_folder};
pub use worldcup::{frames_a_game, worldcup};

use super::ExperimentError;
use image::{ImageFormat, RgbImage};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::PixelBox;
use touchline_vision::features::Features;
use touchline_vision::media::{FrameReader, FrameRef};

/// A frame whose camera is known.
#[derive(Clone, Debug)]
pub struct KnownFrame {
    /// What people call it.
    pub name: String,
    /// What its document warns of: the codes.
    pub warnings: String,
    /// Its true camera.
    pub truth: PtzCamera,
    /// Its features; on players and graphics as well unless it is masked.
    pub features: Features,
    /// Its field.
    pub field: FieldModel,
    /// Where its picture is.
    pub picture: KnownPicture,
    /// Where players and graphics are, px.
    pub masks: Vec<PixelBox>,
    /// Whether features on them are left out.
    pub is_masked: bool,
}

/// Where the picture of a frame is.
#[derive(Clone, Debug)]
pub enum KnownPicture {
    /// Here: a JPEG file that was drawn.
    Drawn(Vec<u8>),
    /// In an image file or a video of the user's own.
    File(FrameRef),
}

impl KnownFrame {
    /// The masks that its features keep off.
    pub fn used_masks(&self) -> &[PixelBox] {
        if self.is_masked { &self.masks } else { &[] }
    }

    /// Its picture.
    ///
    /// # Errors
    /// It cannot be read or decoded.
    pub fn picture(&self, reader: &mut FrameReader) -> Result<RgbImage, ExperimentError> {
        match &self.picture {
            KnownPicture::Drawn(jpeg) => {
                Ok(image::load_from_memory_with_format(jpeg, ImageFormat::Jpeg)?.into_rgb8())
            }
            KnownPicture::File(source) => {
                let picture = reader.read(source)?;
                let size = picture.size();
                Ok(RgbImage::from_fn(size.width, size.height, |x, y| {
                    let at = 4 * (y as usize * size.width as usize + x as usize);
                    let rgba = picture.rgba();
                    image::Rgb([rgba[at], rgba[at + 1], rgba[at + 2]])
                }))
            }
        }
    }
}

/// Frames, and how they are split.
#[derive(Clone, Debug)]
pub struct FrameSet {
    /// What kind of frames they are.
    pub kind: SetKind,
    /// The seed that it was drawn with, and with which forests are trained on it.
    pub seed: u64,
    /// What it is, in words: "drawn, …" where it is drawn.
    pub title: String,
    /// How the frames are split, as a sentence.
    pub protocol: String,
    /// The frames.
    pub frames: Vec<KnownFrame>,
    /// Training and test frames; the frames of one split are of one camera.
    pub splits: Vec<Split>,
}

/// What kind of frames a set holds: tables of different kinds never share a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// Drawn by this program; the truth is exact.
    Drawn,
    /// The authors' published frames and cameras.
    Published,
    /// A user's own frames; the truth is what the documents hold.
    Own,
}

impl SetKind {
    /// What stands in headings.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Drawn => "drawn",
            Self::Published => "the authors' published data",
            Self::Own => "own frames",
        }
    }
}

/// Training frames and test frames.
#[derive(Clone, Debug)]
pub struct Split {
    /// Its name: that of what is asked. Splits of one name are reported together.
    pub name: String,
    /// Frames used for training.
    pub training_frames: Vec<usize>,
    /// Frames used for testing.
    pub asked: Vec<usize>,
}

impl FrameSet {
    /// A heading that says what kind of frames it is about, so that a drawn set is not mistaken for
    /// a real one.
    pub fn heading(&self, words: &str) -> String {
        format!("{words} ({})", self.kind.describe())
    }

    /// The same without the features on players and graphics, as with a detector of players.
    pub fn masked(&self) -> Self {
        let mut set = self.clone();
        for frame in set.frames.iter_mut().filter(|frame| !frame.is_masked) {
            let features = std::mem::take(&mut frame.features);
            let each = features.keypoints.into_iter().zip(features.descriptors);
            let kept = each.filter(|(keypoint, _)| {
                !frame.masks.iter().any(|mask| mask.contains(keypoint.point))
            });
            let (keypoints, descriptors) = kept.unzip();
            frame.features = Features {
                image_size: features.image_size,
                keypoints,
                descriptors,
            };
            frame.is_masked = true;
        }
        set
    }

    /// The names of the splits, each once, in their order.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for split in &self.splits {
            if !names.contains(&split.name.as_str()) {
                names.push(&split.name);
            }
        }
        names
    }
}
