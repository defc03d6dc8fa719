//! Frames with clicks as exchange formats store them, and the interface of click formats.

use crate::document::Click;
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::cameras::unreadable::describe_unreadable;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, base_name};
use crate::exchange::format::About;
use crate::exchange::options::{ExportOptions, ImportOptions, LabelMap};
use crate::exchange::syntax::node::safe_path;
use crate::exchange::syntax::values::shorten;
use std::cell::RefCell;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

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
    /// What moves in it, px, where the options ask for it.
    pub masks: Vec<PixelBox>,
}

impl LabelledFrame {
    /// A frame with its marks, without masks.
    pub fn new(name: &str, image: Option<String>, size: ImageSize, marks: Vec<Mark>) -> Self {
        Self {
            name: name.to_owned(),
            image,
            size,
            marks,
            masks: Vec::new(),
        }
    }
}

/// A point with a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its label in the tool.
    pub label: String,
    /// px, corner convention.
    pub image: ImagePoint,
    /// The probability that a model states of it.
    pub probability: Option<f64>,
    /// 1-σ of it in each direction that a model states, px.
    pub sigma_px: Option<f64>,
}

impl Mark {
    /// A point of which only the place is known.
    pub const fn new(label: String, image: ImagePoint) -> Self {
        Self {
            label,
            image,
            probability: None,
            sigma_px: None,
        }
    }

    /// The same with the probability that a model states.
    ///
    /// # Errors
    /// It is none.
    pub fn with_probability(self, probability: f64) -> Result<Self, Problem> {
        /// Peaks of heat maps that are written as probabilities exceed 1 by a little.
        const MOST: f64 = 1.1;
        if !(0.0..=MOST).contains(&probability) {
            return Err(Problem::out_of_range(
                format!("the probability of {:?}", shorten(&self.label)),
                probability,
                "between 0 and 1; files of labels are imported without --points",
            ));
        }
        Ok(Self {
            probability: Some(probability.min(1.0)),
            ..self
        })
    }
}

/// What the third number of a keypoint is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThirdNumber {
    /// Whether the point is labelled and visible: 0, 1 or 2.
    Visibility,
    /// The probability that a model states.
    Probability,
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
pub fn size_needed(image: &str) -> Problem {
    let what = format!("the size of {:?}", shorten(image));
    Problem::option_needed(what, "--size WIDTHxHEIGHT or --images FOLDER")
}

/// The path of a picture from the folder of pictures. Where the user gave that folder, a path that
/// leads out of it means the file of its name in there: tools write where the picture lay on their
/// own disk.
///
/// # Errors
/// It leads elsewhere.
pub fn picture_path(name: &str, options: &ImportOptions) -> Result<String, Problem> {
    match safe_path(name) {
        Err(Problem::LeavesFolder(path)) => {
            let unified = name.replace('\\', "/");
            let file = base_name(&unified);
            if options.images.is_some() && safe_path(file).is_ok() {
                return Ok(file.to_owned());
            }
            Err(Problem::PictureElsewhere(path))
        }
        path => path,
    }
}

/// How labels are read.
pub struct LabelReading<'a> {
    /// The options of the import.
    pub options: &'a ImportOptions,
    /// The sizes of pictures that are there.
    pub sizes: &'a Sizes<'a>,
}

/// Reads the labels of a format: how, and what could not be read so far.
pub struct LabelReader<'a> {
    /// The options of the import.
    pub options: &'a ImportOptions,
    /// The sizes of pictures that are there.
    pub sizes: &'a Sizes<'a>,
    unread: RefCell<UnreadLabels>,
}

/// Labels that cannot be read beside others that can: a damaged file of a folder, or one picture of
/// a file.
#[derive(Default)]
pub struct UnreadLabels {
    /// The first of them.
    first: Vec<UnreadLabel>,
    count: usize,
}

/// As many are kept with what is wrong; a file of nothing else may have millions.
const MAX_KEPT: usize = 100;

/// A picture or file whose labels cannot be read.
struct UnreadLabel {
    file: String,
    /// The picture within the file; none where the file is of one.
    picture: Option<String>,
    problem: Problem,
}

impl LabelReader<'_> {
    /// What was read of a file, or of a picture within it. A problem is kept.
    pub fn keep<T>(
        &self,
        file: &str,
        picture: Option<&str>,
        read: Result<T, Problem>,
    ) -> Option<T> {
        read.map_err(|problem| {
            let mut unread = self.unread.borrow_mut();
            unread.count += 1;
            if unread.first.len() < MAX_KEPT {
                unread.first.push(UnreadLabel {
                    file: file.to_owned(),
                    picture: picture.map(ToOwned::to_owned),
                    problem,
                });
            }
        })
        .ok()
    }
}

impl UnreadLabels {
    /// The line about them, beside `read` frames that were read; none where there is none.
    pub fn describe(&self, read: usize) -> Option<String> {
        let named = self.first.iter().map(|unread| {
            let name = unread.picture.as_deref().unwrap_or(&unread.file);
            (name, unread.problem.to_string())
        });
        let named: Vec<(&str, String)> = named.collect();
        describe_unreadable(&named, [self.count, read + self.count], "picture", "labels")
    }
}

/// The frames of files in a format, and what of them cannot be read.
///
/// # Errors
/// Nothing can be read, or an option is needed.
pub fn read_labels(
    format: &dyn ClickFormat,
    files: &Files,
    reading: &LabelReading<'_>,
) -> ExchangeResult<(Vec<LabelledFrame>, UnreadLabels)> {
    let reader = LabelReader {
        options: reading.options,
        sizes: reading.sizes,
        unread: RefCell::default(),
    };
    let frames = format.read(files, &reader)?;
    let mut unread = reader.unread.into_inner();
    // An option mends it for all, so that it is not the matter of one picture.
    let wants_option =
        |unread: &UnreadLabel| matches!(unread.problem, Problem::OptionNeeded { .. });
    let place = match unread.first.iter().position(wants_option) {
        Some(place) => Some(place),
        None if frames.iter().all(|frame| frame.marks.is_empty()) && unread.count > 0 => Some(0),
        None => None,
    };
    match place {
        Some(place) => {
            let UnreadLabel { file, problem, .. } = unread.first.swap_remove(place);
            Err(problem.within(&file))
        }
        None => Ok((frames, unread)),
    }
}

/// The frames of files whose pictures have one size, for tests.
#[cfg(test)]
pub fn read_alone(
    format: &dyn ClickFormat,
    files: &Files,
    options: &ImportOptions,
    size: Option<ImageSize>,
) -> ExchangeResult<Vec<LabelledFrame>> {
    let reading = LabelReading {
        options,
        sizes: &|_| size,
    };
    read_labels(format, files, &reading).map(|(frames, _)| frames)
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

    /// Whether its files have points as shares of the picture and no size of it: no, unless the
    /// format says otherwise.
    fn has_shares_alone(&self) -> bool {
        false
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
    ) -> ExchangeResult<Files> {
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

    /// The frames of its files. What cannot be read is left to `reading`; [`read_labels`] is for
    /// callers.
    ///
    /// # Errors
    /// Files are damaged as a whole.
    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>>;

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
