//! Frames with their clicks as formats exchange them, and what every format of clicks does.

use super::error::{ExchangeError, Problem};
use super::files::Files;
use super::options::{ExportOptions, ImportOptions, LabelMap};
use super::values::clipped;
use crate::document::Click;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// A frame whose clicks are written.
#[derive(Clone, Debug, PartialEq)]
pub struct ClickedFrame {
    /// What the format calls it; unique.
    pub name: String,
    /// The name of its image's file.
    pub image: String,
    /// px.
    pub size: ImageSize,
    /// Named clicks.
    pub clicks: Vec<Click>,
}

/// A frame whose marks were read; what their labels mean is decided later.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledFrame {
    /// What the format calls it.
    pub name: String,
    /// The name of its image's file, where the format says it.
    pub image: Option<String>,
    /// px.
    pub size: ImageSize,
    /// In the file's order.
    pub marks: Vec<Mark>,
}

/// A point with a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What the tool calls it.
    pub label: String,
    /// px, corner convention.
    pub image: ImagePoint,
}

/// What is known beside the frames when they are written.
pub struct ClickContext<'a> {
    /// How.
    pub options: &'a ExportOptions,
    /// The field that they show.
    pub field: &'a FieldModel,
}

/// The size of the picture of a name: of its file where that is there, else as it was given.
pub type Sizes<'a> = dyn Fn(&str) -> Option<ImageSize> + 'a;

/// That nothing says how large a picture is.
#[must_use]
pub fn size_needed(image: &str) -> Problem {
    let what = format!("the size of {:?}", clipped(image));
    Problem::OptionNeeded {
        what,
        option: "--size WIDTHxHEIGHT or --images FOLDER",
    }
}

/// A format that holds points of pictures.
pub trait ClickFormat: Sync {
    /// Whether it can hold a click.
    fn holds(&self, click: &Click, context: &ClickContext<'_>) -> bool;

    /// What a frame is called when it is read again.
    fn name_of(&self, frame: &ClickedFrame) -> String;

    /// How far a click may move through the digits of the format, px.
    fn resolution_px(&self) -> f64 {
        1e-6
    }

    /// The files of the frames.
    ///
    /// # Errors
    /// A value cannot be written.
    fn write(
        &self,
        frames: &[ClickedFrame],
        context: &ClickContext<'_>,
    ) -> Result<Files, ExchangeError>;

    /// What its files are called in an error.
    fn wanted(&self) -> &'static str;

    /// Whether a file of a folder is one of its files.
    fn is_wanted(&self, name: &str) -> bool;

    /// The frames of its files.
    ///
    /// # Errors
    /// A file is damaged, or the size of a picture is needed and not known.
    fn read(
        &self,
        files: &Files,
        options: &ImportOptions,
        sizes: &Sizes<'_>,
    ) -> Result<Vec<LabelledFrame>, ExchangeError>;

    /// The meaning of labels in what this program itself writes, and of formats with classes of
    /// their own.
    fn own_labels(&self) -> LabelMap {
        LabelMap::Touchline
    }

    /// Whether labels are always the format's own, whatever map a user names.
    fn has_own_classes(&self) -> bool {
        false
    }
}
