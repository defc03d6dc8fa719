//! Errors of imports and exports.

use super::format::Format;
use super::format_options::{Direction, FormatOption};
use crate::document::{OtherPictures, hint_for_missing};
use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::files::{NotReplaced, plain, way_out};
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_core::solve::PlanePoseError;
use touchline_vision::media::MediaError;

/// Why an import or export failed. Nothing was written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// A file or folder cannot be read.
    #[error("cannot read {}: {source}{}", path.display(), describe_missing(path, source))]
    Read {
        /// Which.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The result cannot be written.
    #[error("cannot write {}: {source}{}", path.display(), way_out(source))]
    Write {
        /// Where.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something is there already.
    #[error("{} already exists; give --force to replace it, or another -o", path.display())]
    Exists {
        /// Where.
        path: PathBuf,
    },
    /// Something other than the result's own files would be lost.
    #[error(transparent)]
    NotReplaced(#[from] NotReplaced),
    /// A file is damaged, or of another format.
    #[error("{file}: {}", plain(&problem.to_string()))]
    File {
        /// Its name, from the folder that was named.
        file: String,
        /// What is wrong with it.
        problem: Problem,
    },
    /// A folder contains no file of the format.
    #[error("{} holds no {wanted}", path.display())]
    NoFiles {
        /// The folder.
        path: PathBuf,
        /// What was looked for.
        wanted: &'static str,
    },
    /// Files are of no known format.
    #[error(
        "{}: no format is recognized; {}",
        path.display(),
        hint.unwrap_or_else(|| hint_for(path))
    )]
    UnknownFormat {
        /// The file or folder.
        path: PathBuf,
        /// What to do with it, where it is known and has no format.
        hint: Option<&'static str>,
    },
    /// Files are of several formats.
    #[error("{}: the files may be {}; give --format", path.display(), either(formats))]
    SeveralFormats {
        /// The file or folder.
        path: PathBuf,
        /// The formats.
        formats: Vec<Format>,
    },
    /// A frame occurs twice.
    #[error("{}: the frame {name:?} occurs twice; import one camera or folder at a time", path.display())]
    SameFrame {
        /// The file or folder.
        path: PathBuf,
        /// The frame.
        name: String,
    },
    /// A point lies far outside its picture.
    #[error("{}: {label:?} of {frame:?} is at ({}, {}) px, which is not a position in a picture", path.display(), number_text(*x), number_text(*y))]
    NoPlace {
        /// The file or folder.
        path: PathBuf,
        /// The frame.
        frame: String,
        /// The point's label.
        label: String,
        /// px.
        x: f64,
        /// px.
        y: f64,
    },
    /// A frame has more points than a document allows.
    #[error("{}: {frame:?} has {found} points, and a frame takes {limit}; thin them out", path.display())]
    TooManyPoints {
        /// The file or folder.
        path: PathBuf,
        /// The frame.
        frame: String,
        /// How many it has.
        found: usize,
        /// How many it may have.
        limit: usize,
    },
    /// No camera corresponds to a homography.
    #[error(
        "{}: no camera gives the homography of {frame:?} ({source}); check its direction, unit and \
         picture size. One to pixels of a drawn map must be scaled to metres first; then `import \
         --format homographies --template corner-m --size WxH` reads it",
        path.display()
    )]
    NoCamera {
        /// The file or folder.
        path: PathBuf,
        /// The frame.
        frame: String,
        /// Why.
        source: PlanePoseError,
    },
    /// A camera belongs to a picture of another aspect ratio.
    #[error(
        "{what} of {frame:?} is of a picture of {} × {} px, and its picture has {} × {}; give \
         its own pictures (--images FOLDER)",
        stated.width, stated.height, picture.width, picture.height
    )]
    OtherProportions {
        /// What is of it: "the camera".
        what: &'static str,
        /// The frame.
        frame: String,
        /// What the camera was made for.
        stated: ImageSize,
        /// The picture's.
        picture: ImageSize,
    },
    /// A picture is stretched as its labels are, and only these are to be brought back.
    #[error(
        "the picture of {frame:?} in {} is stretched to {} × {} px, too; write the pictures in \
         their own proportion with `touchline new PROJECT --frames FOLDER --stretched-from {}x{}`, \
         and give --images PROJECT/images",
        folder.display(), stretched.width, stretched.height, size.width, size.height
    )]
    StretchedPicture {
        /// The frame.
        frame: String,
        /// The folder of the pictures.
        folder: PathBuf,
        /// The size of the picture that is there.
        stretched: ImageSize,
        /// The size that it had before.
        size: ImageSize,
    },
    /// There are too many files, or they are too large together.
    #[error("{} contains more than {limit}; import a part of it", path.display())]
    TooMuch {
        /// The folder.
        path: PathBuf,
        /// What is exceeded.
        limit: &'static str,
    },
    /// The document's field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The authors' annotations cannot be read.
    #[error(transparent)]
    Authors(#[from] super::authors_mat::AuthorsError),
    /// The document cannot be written.
    #[error(transparent)]
    Document(#[from] crate::document::WriteError),
    /// A file is not a document.
    #[error("{file}: {source}")]
    NoDocument {
        /// Its name.
        file: String,
        /// What is wrong with it.
        source: crate::document::ReadError,
    },
    /// No frame is left to be written.
    #[error("no frame to export as {format}: {why}")]
    NothingToExport {
        /// The format.
        format: Format,
        /// Why each was left out.
        why: String,
    },
    /// No frame is left for a dataset.
    #[error("no frame for the dataset: {why}")]
    EmptyDataset {
        /// Why.
        why: String,
    },
    /// The target of a dataset exists and is not a dataset.
    #[error("{} contains something other than a dataset of this program; give another folder", path.display())]
    NoDatasetThere {
        /// Where.
        path: PathBuf,
    },
    /// A folder that must be empty is not.
    #[error("{} holds something already; give an empty or a new folder", path.display())]
    NotEmpty {
        /// Where.
        path: PathBuf,
    },
    /// A version of another match, which has the same names of pictures.
    #[error("{} of {} pictures are others than the document has under their names, the first is {}: it is of another match", _0.count, _0.known, _0.first)]
    OtherPictures(OtherPictures),
    /// Pictures and videos outside the project, which the user may not expect to be passed on.
    #[error("{} outside of the project, the first is {}; --outside-pictures copies them too", pluralise(*count, "file"), first.display())]
    Outside {
        /// How many files.
        count: usize,
        /// The first.
        first: PathBuf,
    },
    /// Hard links cannot cross disks.
    #[error("{} cannot be linked as {}: it lies on another disk; copy the pictures instead (--images copy)", from.display(), to.display())]
    OtherDisk {
        /// The picture.
        from: PathBuf,
        /// The link.
        to: PathBuf,
    },
    /// A picture cannot be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// A picture cannot be written.
    #[error("a picture cannot be encoded: {0}")]
    Encoding(#[from] image::ImageError),
    /// It was cancelled.
    #[error("stopped; nothing was written")]
    Stopped,
    /// Two frames would be written to the same file.
    #[error(
        "{first} and {second} would both be written as {name}; export them one camera or folder at a time"
    )]
    SameName {
        /// The place.
        name: String,
        /// One frame.
        first: String,
        /// The other.
        second: String,
    },
    /// Frames of two videos or folders would be one sequence.
    #[error(
        "{first} and {second} would be in one sequence, and {format} names neither video nor folder; \
         export them one camera or folder at a time"
    )]
    MixedSequence {
        /// The format.
        format: Format,
        /// One frame.
        first: String,
        /// The other.
        second: String,
    },
    /// A frame cannot be expressed in the format.
    #[error("{frame} cannot be written as {format}: {why}")]
    CannotHold {
        /// The frame.
        frame: String,
        /// The format.
        format: Format,
        /// The reason.
        why: String,
    },
    /// A written value reads back differently.
    #[error(
        "internal error (please report it): {frame} as {format} reads back with {what} {off_px:.3e} px away, allowed is \
         {allowed_px:.1e} px; nothing was written"
    )]
    ReadsBackElsewhere {
        /// The frame.
        frame: String,
        /// The format.
        format: Format,
        /// The landmark or click that moved most.
        what: String,
        /// How far, px.
        off_px: f64,
        /// How far the format allows, px.
        allowed_px: f64,
    },
    /// The written files read back as other frames or clicks.
    #[error(
        "internal error (please report it): {frame} as {format} does not read back as it was; nothing was written"
    )]
    ReadsBackOtherwise {
        /// The frame.
        frame: String,
        /// The format.
        format: Format,
    },
    /// The format can only be written, or only be read.
    #[error("{format} cannot be {what}; it can only be {instead}")]
    OneWay {
        /// The format.
        format: Format,
        /// What was requested: "imported".
        what: &'static str,
        /// What it can be: "exported".
        instead: &'static str,
    },
    /// An option that the format does not take.
    #[error("--{option} has no effect on {what}; it is for {}", either(takers))]
    OptionNotTaken {
        /// The format, or what else is written.
        what: String,
        /// The option.
        option: &'static str,
        /// The formats that take it.
        takers: Vec<Format>,
    },
    /// An option is needed that was not given.
    #[error("{format} does not say {what}; give {option}")]
    OptionNeeded {
        /// The format.
        format: Format,
        /// What is not known.
        what: &'static str,
        /// What to give.
        option: &'static str,
    },
    /// An export needs a value that neither the document nor an option gives.
    #[error("{format} needs {what}; give {option}")]
    ExportNeeds {
        /// The format.
        format: Format,
        /// What is not known.
        what: &'static str,
        /// What to give.
        option: &'static str,
    },
    /// Numbers of keypoints that are of another order than the map.
    #[error(
        "the label {label:?} shows that the points are numbered as another map has them, where \
         nearly all have other names; give --map {other}"
    )]
    OtherNumbering {
        /// The label.
        label: String,
        /// The name of the other map.
        other: &'static str,
    },
    /// Labels without a meaning on the field.
    #[error(
        "unknown labels {labels}; {}",
        if format.takes(FormatOption::Map, Direction::Import) {
            "give a --map file with them, or --skip-unmapped".to_owned()
        } else {
            format!("{format} has fixed names: correct these in the files, or take them out there")
        }
    )]
    Unmapped {
        /// The labels with how often each occurs.
        labels: String,
        /// The format that has them.
        format: Format,
    },
}

/// What is wrong with a file.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// It is empty.
    #[error("the file is empty")]
    Empty,
    /// It is larger than any file of the format.
    #[error("it is {} MiB, at most {} MiB are read", bytes.div_ceil(1 << 20), limit >> 20)]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// Its content is packed.
    #[error("a {0} archive; unpack it and give the unpacked files")]
    Archive(&'static str),
    /// It is not UTF-8 text.
    #[error("not UTF-8 text (byte {offset})")]
    NotUtf8 {
        /// The first byte that is none.
        offset: usize,
    },
    /// It is not JSON.
    #[error("not valid JSON: {0}")]
    NotJson(String),
    /// It is not XML, or contains a document type or entities.
    #[error("not valid XML: {}", plain(.0))]
    NotXml(String),
    /// It does not have the structure of the format.
    #[error("not {wanted}: {found}")]
    NotFormat {
        /// What was expected.
        wanted: &'static str,
        /// What is there.
        found: String,
    },
    /// A value is missing.
    #[error("{0} is missing")]
    Missing(String),
    /// A value is of another kind.
    #[error("{what}: {wanted} is expected, found {found}")]
    Kind {
        /// Which.
        what: String,
        /// What it should be.
        wanted: &'static str,
        /// What it is.
        found: String,
    },
    /// There are too few or too many values.
    #[error("{what}: {wanted} are expected, found {found}")]
    Count {
        /// Of what.
        what: String,
        /// How many there should be.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// A number is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(String),
    /// A number is outside its valid range.
    #[error("{what} is {}, which must be {wanted}", number_text(*value))]
    OutOfRange {
        /// Which.
        what: String,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
    /// A matrix is not a rotation.
    #[error("{what} is not a rotation: {}", if distance.is_finite() { format!("its rows are off by {distance:.1e}") } else { "it is mirrored, or not made of numbers".to_owned() })]
    NotRotation {
        /// Which.
        what: String,
        /// Its distance from a rotation; not finite for a reflection or NaN.
        distance: f64,
    },
    /// A calibration matrix with a skew, which no camera of a document has.
    #[error(
        "a skew of {} px: without it the picture is {off_px:.2} px off; up to 0.1 px is taken; \
         resample the picture to upright pixels",
        number_text(*skew_px)
    )]
    Skew {
        /// The skew.
        skew_px: f64,
        /// How far the camera without the skew is off at most, px.
        off_px: f64,
    },
    /// A matrix has no inverse.
    #[error("{0} is singular")]
    Singular(String),
    /// A name occurs twice.
    #[error("{what} {name:?} occurs twice")]
    Twice {
        /// Of what.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Something refers to an unknown name.
    #[error("{what} {name:?} is not in the file")]
    Unknown {
        /// Of what.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A path points outside the folder.
    #[error("the path {0:?} points outside the folder")]
    LeavesFolder(String),
    /// The path of a picture points outside the folder.
    #[error(
        "the picture {0:?} lies outside the folder; give --images FOLDER, where it is looked for \
         by its name"
    )]
    PictureElsewhere(String),
    /// A value that the file does not contain and an option must give.
    #[error("{what} is not known; give {option}")]
    OptionNeeded {
        /// What is not known.
        what: String,
        /// What to give.
        option: &'static str,
    },
    /// Something that this program does not support.
    #[error("{what} cannot be read: {why}")]
    Unsupported {
        /// What.
        what: String,
        /// Why, or what to do instead.
        why: &'static str,
    },
    /// The same at a packet of a stream.
    #[error("packet {packet}: {problem}")]
    Packet {
        /// The packet, from 1.
        packet: usize,
        /// What is wrong there.
        problem: Box<Problem>,
    },
    /// The same in an array of an archive.
    #[error("{array}: {problem}")]
    Array {
        /// The array's name.
        array: String,
        /// What is wrong there.
        problem: Box<Problem>,
    },
    /// The same at a frame of a sequence.
    #[error("frame {frame}: {problem}")]
    Frame {
        /// The frame, from 0.
        frame: usize,
        /// What is wrong there.
        problem: Box<Problem>,
    },
    /// The same at a line of a text.
    #[error("line {line}: {problem}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong there.
        problem: Box<Problem>,
    },
}

/// What is read or written of foreign formats.
pub(super) type ExchangeResult<T> = Result<T, ExchangeError>;

impl Problem {
    /// A number is outside its valid range.
    pub(super) fn out_of_range(what: impl Into<String>, value: f64, wanted: &'static str) -> Self {
        let what = what.into();
        Self::OutOfRange {
            what,
            value,
            wanted,
        }
    }

    /// There are too few or too many values.
    pub(super) fn wrong_count(what: impl Into<String>, wanted: usize, found: usize) -> Self {
        let what = what.into();
        Self::Count {
            what,
            wanted,
            found,
        }
    }

    /// It does not have the structure of the format.
    pub(super) fn not_format(wanted: &'static str, found: impl Into<String>) -> Self {
        let found = found.into();
        Self::NotFormat { wanted, found }
    }

    /// A name occurs twice.
    pub(super) fn twice(what: &'static str, name: impl Into<String>) -> Self {
        let name = name.into();
        Self::Twice { what, name }
    }

    /// A value that the file does not contain and an option must give.
    pub(super) fn option_needed(what: impl Into<String>, option: &'static str) -> Self {
        let what = what.into();
        Self::OptionNeeded { what, option }
    }

    /// Something that this program does not support; `why` may say what to do instead.
    pub(super) fn not_supported(what: impl Into<String>, why: &'static str) -> Self {
        let what = what.into();
        Self::Unsupported { what, why }
    }

    /// The problem in a file.
    pub(crate) fn within(self, file: &str) -> ExchangeError {
        ExchangeError::File {
            file: file.to_owned(),
            problem: self,
        }
    }

    /// The problem at a packet, counted from 1.
    #[must_use]
    pub(crate) fn at_packet(self, packet: usize) -> Self {
        Self::Packet {
            packet,
            problem: Box::new(self),
        }
    }

    /// The problem in an array of an archive.
    #[must_use]
    pub(crate) fn at_array(self, array: &str) -> Self {
        Self::Array {
            array: array.to_owned(),
            problem: Box::new(self),
        }
    }

    /// The problem at a frame, counted from 0.
    #[must_use]
    pub(crate) fn at_frame(self, frame: usize) -> Self {
        Self::Frame {
            frame,
            problem: Box::new(self),
        }
    }

    /// The problem at a line, counted from 1.
    #[must_use]
    pub(crate) fn at_line(self, line: usize) -> Self {
        Self::Line {
            line,
            problem: Box::new(self),
        }
    }
}

/// What to do with a file of no known format.
fn hint_for(path: &Path) -> &'static str {
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        "csv" | "txt" | "tsv" => {
            "give --format, or name the columns frame, label, x and y of a table of points, with \
             commas between"
        }
        _ => "give --format",
    }
}

/// What is probably meant by a path at which nothing lies; empty where its text does not show that.
fn describe_missing(path: &Path, source: &io::Error) -> String {
    let hint = hint_for_missing(path).filter(|_| source.kind() == io::ErrorKind::NotFound);
    hint.map(|hint| format!("; {hint}")).unwrap_or_default()
}

/// The names of formats as alternatives: "a, b or c"; empty for none.
fn either(formats: &[Format]) -> String {
    let names: Vec<&str> = formats.iter().map(|format| format.name()).collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// A number for a message, without hundreds of digits.
fn number_text(value: f64) -> String {
    // `Display` writes 1e300 with 301 digits and 1e-300 with 300 zeros; within these limits a plain
    // number has at most 15 digits before the point.
    let is_plain = value == 0.0 || (1e-6..1e15).contains(&value.abs());
    if is_plain {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::{ExchangeError, Problem};

    #[test]
    fn what_a_damaged_file_says_is_obeyed_by_no_terminal() {
        let what = "dist\u{1b}[2J".to_owned();
        let problem = Problem::Kind {
            what,
            wanted: "a number",
            found: "a list".to_owned(),
        };
        let error = ExchangeError::File {
            file: "a.yml".to_owned(),
            problem,
        };
        assert_eq!(
            error.to_string(),
            r"a.yml: dist\u{1b}[2J: a number is expected, found a list"
        );
    }

    #[test]
    fn numbers_in_messages_are_short() {
        assert_eq!(
            [1e9, 0.5, 1e300, -1e-320].map(super::number_text),
            ["1000000000", "0.5", "1e300", "-1e-320"]
        );
    }
}
