//! Options of a dataset.

use crate::document::FrameStatus;
use crate::exchange::options::FrameChoice;
use image::ImageFormat;
use strum::{Display, EnumString, IntoStaticStr, VariantArray};

/// Which frames a dataset contains, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetOptions {
    /// The choice of frames. By default those that the user accepted.
    pub frames: FrameChoice,
    /// The source of the pictures.
    pub pictures: Pictures,
    /// The format of pictures that are decoded and written anew.
    pub picture_format: PictureFormat,
    /// Whether undistorted pictures are written as well, with their own `dataset.json`.
    pub undistorted: bool,
    /// Whether pictures from outside the project's folder are included.
    pub outside: bool,
    /// How frames are split; none: not at all.
    pub splitting: Option<Splitting>,
    /// The licence of the labels and pictures, for the card.
    pub licence: Option<String>,
}

impl Default for DatasetOptions {
    fn default() -> Self {
        Self {
            frames: FrameChoice {
                statuses: vec![FrameStatus::Reference],
                ..FrameChoice::default()
            },
            pictures: Pictures::default(),
            picture_format: PictureFormat::default(),
            undistorted: false,
            outside: false,
            splitting: None,
            licence: None,
        }
    }
}

/// The source of the pictures of a dataset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
pub enum Pictures {
    /// Image files are copied byte for byte; frames that are only in a video are decoded.
    #[default]
    #[strum(serialize = "copy")]
    Copied,
    /// Like `Copied`, but with hard links instead of copies: nothing is stored twice, and both
    /// names refer to one file.
    #[strum(serialize = "link")]
    Linked,
    /// Every frame is decoded, from its video where it has one, and written anew.
    #[strum(serialize = "extract")]
    Extracted,
    /// There are no pictures; `dataset.json` refers to the files at their original paths.
    #[strum(serialize = "none")]
    Left,
}

/// How decoded pictures are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureFormat {
    /// Without loss.
    #[default]
    Png,
    /// At quality 95.
    Jpeg,
}

impl PictureFormat {
    /// The ending of its files.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
        }
    }

    /// The same for the encoder.
    pub(super) const fn image_format(self) -> ImageFormat {
        match self {
            Self::Png => ImageFormat::Png,
            Self::Jpeg => ImageFormat::Jpeg,
        }
    }

    /// The approximate size of a pixel of a broadcast picture, bytes.
    pub(super) const fn bytes_per_px(self) -> f64 {
        match self {
            Self::Png => 1.5,
            Self::Jpeg => 0.4,
        }
    }
}

/// How frames are split into training, validation and test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Splitting {
    /// The weights of training, validation and test; only their ratios matter.
    pub shares: [u32; 3],
    /// The unit that is never divided.
    pub by: SplitBy,
    /// The seed of the shuffling.
    pub seed: u64,
}

impl Default for Splitting {
    fn default() -> Self {
        Self {
            shares: [80, 10, 10],
            by: SplitBy::default(),
            seed: 0,
        }
    }
}

/// The unit that a split never divides. Single frames are not offered, because neighbouring frames
/// are nearly equal.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Display, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "lowercase")]
pub enum SplitBy {
    /// A shot of a camera.
    #[default]
    Clip,
    /// All of a camera.
    Camera,
    /// All of a video, or of a folder of images.
    Match,
}
