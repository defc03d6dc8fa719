//! Frames with clicks as exchange formats store them, and the interface of click formats.

use crate::document::Click;
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::options::{ExportOptions, ImportOptions, LabelMap};
use crate::exchange::syntax::values::shorten;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// A frame whose clicks are written.
#[derive(Clone, Debug, PartialEq)]
pub struct ClickedFrame {
    /// Its name in the format; unique.
    pub name: String,
    /// The name of its image's file.
    pub image: String,
    /// px.
    pub size: ImageSize,
    /// Named clicks.
    pub clicks: Vec<Click>,
}

/// A frame with marks that were read; their labels are interpreted later.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledFrame {
    /// Its name in the format.
    pub name: String,
    /// The file name of its image, where the format states it.
    pub image: Option<String>,
    /// px.
    pub size: ImageSize,
    /// In the file's order.
    pub marks: Vec<Mark>,
}

/// A point with a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its label in the tool.
    pub label: String,
    /// px, corner convention.
    pub image: ImagePoint,
}

/// What a format needs beside the frames when it writes them.
pub struct ClickContext<'a> {
    /// How.
    pub options: &'a ExportOptions,
    /// The field that they show.
    pub field: &'a FieldModel,
}

/// The size of a picture by name, of its file; none where it does not exist. Formats take the size
/// of the options then, which is not that of the picture itself.
pub type Sizes<'a> = dyn Fn(&str) -> Option<ImageSize> + 'a;

/// The size of a picture: its own, which its file or the labels state, or that of the options.
///
/// # Errors
/// None of them is known.
pub fn size_or_option(
    image: &str,
    own: Option<ImageSize>,
    options: &ImportOptions,
) -> Result<ImageSize, Problem> {
    own.or(options.size).ok_or_else(|| size_needed(image))
}

/// The error about a picture of unknown size.
#[must_use]
pub fn size_needed(image: &str) -> Problem {
    let what = format!("the size of {:?}", shorten(image));
    Problem::OptionNeeded {
        what,
        option: "--size WIDTHxHEIGHT or --images FOLDER",
    }
}

/// A format that stores points of pictures.
pub trait ClickFormat: Sync {
    /// Whether it can store a click: any, unless the format says otherwise.
    fn holds(&self, _click: &Click, _context: &ClickContext<'_>) -> bool {
        true
    }

    /// Whether it can store points outside of the picture: yes, unless the format says otherwise.
    fn holds_outside(&self) -> bool {
        true
    }

    /// Whether it can store several clicks on one landmark: yes, unless the format says otherwise.
    fn holds_repeated_landmarks(&self) -> bool {
        true
    }

    /// The name of a frame when it is read back: its picture's, unless the format says otherwise.
    fn name_of(&self, frame: &ClickedFrame) -> String {
        frame.image.clone()
    }

    /// The maximum error of a click due to the precision of the format, px.
    fn resolution_px(&self) -> f64 {
        1e-6
    }

    /// The files of the frames; none for a format that is only read.
    ///
    /// # Errors
    /// A value cannot be written.
    fn write(
        &self,
        _frames: &[ClickedFrame],
        _context: &ClickContext<'_>,
    ) -> Result<Files, ExchangeError> {
        Ok(Files::default())
    }

    /// What it is.
    fn about(&self) -> About;

    /// Whether a file of a folder is one of its files: by the ending, unless the format says
    /// otherwise.
    fn is_wanted(&self, name: &str) -> bool {
        let mut endings = self.about().endings.iter();
        endings.any(|ending| has_ending(name, ending))
    }

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

    /// Whether labels are always the format's own, whatever map the user chose.
    fn has_own_classes(&self) -> bool {
        false
    }
}
