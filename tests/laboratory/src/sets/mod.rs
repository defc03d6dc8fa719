//! Frames with known cameras and their features, split into training and test frames.

mod documents;
mod drawn;
mod highlights;
mod motion;
mod published;
mod worldcup;

pub use documents::{OwnDocument, OwnDocuments, read_own_documents};
pub use drawn::as_picture;
pub use highlights::{Scenery, frames_a_sequence, highlights, highlights_in};
pub use motion::{MOTION_FILE, RealMotion, motion};
pub use published::{PublishedKind, published_folder, read_published};
pub use worldcup::{frames_a_game, worldcup};

use super::ExperimentError;
use documents::each_once;
use image::{ImageFormat, RgbImage};
use touchline::camera::PtzCamera;
use touchline::features::Features;
use touchline::field::FieldModel;
use touchline::geometry::PixelBox;
use touchline::media::{FrameReader, FrameRef};

/// A frame with a known camera.
#[derive(Clone, Debug)]
pub struct KnownFrame {
    /// Its name in reports.
    pub name: String,
    /// The codes of the document's warnings about the frame.
    pub warnings: String,
    /// Its true camera.
    pub truth: PtzCamera,
    /// Its features. They include those on players and graphics, unless `is_masked` is set.
    pub features: Features,
    /// Its field.
    pub field: FieldModel,
    /// Its picture.
    pub picture: KnownPicture,
    /// Boxes of players and graphics, px.
    pub masks: Vec<PixelBox>,
    /// Whether features in the masks are left out.
    pub is_masked: bool,
}

/// The picture of a frame.
#[derive(Clone, Debug)]
pub enum KnownPicture {
    /// A synthetic one: the JPEG file's bytes.
    Drawn(Vec<u8>),
    /// A file: an image or a frame of a video.
    File(FrameRef),
}

impl KnownFrame {
    /// The masks, if features in them are left out.
    pub fn used_masks(&self) -> &[PixelBox] {
        if self.is_masked { &self.masks } else { &[] }
    }

    /// Reads and decodes the picture.
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

/// Frames and their splits into training and test frames.
#[derive(Clone, Debug)]
pub struct FrameSet {
    /// The kind of the frames.
    pub kind: SetKind,
    /// The seed with which it was drawn. Forests use it as well.
    pub seed: u64,
    /// A description for reports. Starts with "drawn" if it is synthetic.
    pub title: String,
    /// A sentence that says how the frames are split.
    pub protocol: String,
    /// The frames.
    pub frames: Vec<KnownFrame>,
    /// The splits. All frames of a split are of one camera.
    pub splits: Vec<Split>,
}

/// The kind of frames. Tables of different kinds are never compared in one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// Synthetic, with exact ground truth.
    Drawn,
    /// The authors' published frames and cameras.
    Published,
    /// A user's own frames. The cameras of the documents are the ground truth.
    Own,
}

impl SetKind {
    /// The kind, for headings.
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
    /// Its name: that of the test frames. Splits of the same name are reported together.
    pub name: String,
    /// Indices of the training frames.
    pub training_frames: Vec<usize>,
    /// Indices of the test frames.
    pub test_frames: Vec<usize>,
}

impl FrameSet {
    /// A heading that names the kind of frames, so that readers do not take a synthetic set for a
    /// real one.
    pub fn heading(&self, words: &str) -> String {
        format!("{words} ({})", self.kind.describe())
    }

    /// The same set without features on players and graphics, as if a detector had found these.
    pub fn without_masked_features(&self) -> Self {
        let mut set = self.clone();
        for frame in set.frames.iter_mut().filter(|frame| !frame.is_masked) {
            // Features of the whole picture, without those in masks. No others take their places,
            // as they would if the masks were known when the strongest were chosen.
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

    /// The distinct names of the splits, in order of appearance.
    pub fn names(&self) -> Vec<&str> {
        each_once(self.splits.iter().map(|split| split.name.as_str()))
    }
}
