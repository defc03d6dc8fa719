//! What a dataset may be told.

use crate::document::FrameStatus;
use crate::exchange::options::FrameChoice;

/// Which frames a dataset holds, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetOptions {
    /// Which frames. By default those that a person accepted.
    pub frames: FrameChoice,
    /// Where the pictures come from.
    pub pictures: Pictures,
    /// How pictures are written that are decoded first.
    pub picture_format: PictureFormat,
    /// Pictures without lens distortion as well, with a `dataset.json` of their own.
    pub undistorted: bool,
    /// Pictures from outside of the project's folder are taken too.
    pub outside: bool,
    /// How frames are divided; none: not at all.
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

/// Where the pictures of a dataset come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pictures {
    /// Image files are copied byte for byte; frames that only a video has are decoded.
    #[default]
    Copied,
    /// The same with hard links in place of copies: nothing is stored twice, and both names are one
    /// file.
    Linked,
    /// Every frame is decoded, from its video where it has one, and written anew.
    Extracted,
    /// There are none; `dataset.json` names the files where they lie.
    Left,
}

impl Pictures {
    /// Every choice.
    pub const ALL: [Self; 4] = [Self::Copied, Self::Linked, Self::Extracted, Self::Left];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Copied => "copy",
            Self::Linked => "link",
            Self::Extracted => "extract",
            Self::Left => "none",
        }
    }
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
    /// Every format.
    pub const ALL: [Self; 2] = [Self::Png, Self::Jpeg];

    /// The ending of its files.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
        }
    }

    /// How many bytes a pixel of a broadcast picture takes, about.
    pub(super) const fn bytes_per_px(self) -> f64 {
        match self {
            Self::Png => 1.5,
            Self::Jpeg => 0.4,
        }
    }
}

/// How frames are divided for training, validation and test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Splitting {
    /// The shares of training, validation and test; they count by their ratio.
    pub shares: [u32; 3],
    /// What is never split.
    pub by: SplitBy,
    /// Another seed gives another split.
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

/// What a split never divides. Single frames are no choice: neighbours show the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SplitBy {
    /// A shot of a camera.
    #[default]
    Clip,
    /// All of a camera.
    Camera,
    /// All of a video, or of a folder of images.
    Match,
}

impl SplitBy {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Clip, Self::Camera, Self::Match];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip",
            Self::Camera => "camera",
            Self::Match => "match",
        }
    }
}
