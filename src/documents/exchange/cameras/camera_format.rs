//! The interface of camera formats.

use super::frame_camera::FrameCamera;
use super::into_document::{Exactness, View, document_of};
use super::picture_size::SizeSource;
use crate::document::{Document, FieldSpec};
use crate::exchange::error::ExchangeResult;
use crate::exchange::files::{Files, base_name};
use crate::exchange::format::About;
use crate::exchange::options::{ExportOptions, ImportOptions};
use crate::exchange::rate::Rate;
use crate::exchange::timecode::Timecode;
use std::path::Path;
use touchline_core::field::FieldModel;

/// The maximum error of a landmark in a format that keeps all digits, px.
pub const EXACT_PX: f64 = 1e-6;

/// What a format needs beside the frames when it writes them.
pub struct WriteContext<'a> {
    /// How.
    pub options: &'a ExportOptions,
    /// The field that they show.
    pub field: &'a FieldModel,
    /// The frame rate, where it is known and the same for all frames.
    pub rate: Option<Rate>,
}

impl WriteContext<'_> {
    /// The timecode of a frame, where its number and the rate are known.
    pub fn timecode(&self, frame: &FrameCamera) -> Option<Timecode> {
        Some(Timecode::from_start(
            self.options.start,
            frame.frame_index?,
            self.rate_of(frame)?,
        ))
    }

    /// The frame rate of a frame's video, where it is known.
    pub fn rate_of(&self, frame: &FrameCamera) -> Option<Rate> {
        self.options.rate.or(frame.rate)
    }

    /// The note that lengths are for a nominal sensor, where its width is not known.
    pub fn sensor_width_note(&self, nominal_mm: f64) -> Option<String> {
        self.options.sensor_width_mm.is_none().then(|| {
            format!(
                "the sensor's width is not known; lengths in mm are for a nominal {nominal_mm} mm (--sensor-mm)"
            )
        })
    }
}

/// What a format writes as one sequence of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceScope {
    /// All frames of the export.
    All,
    /// The frames of each camera.
    Camera,
    /// The frames of each camera that have no picture of their own.
    CameraWithoutImages,
}

/// A frame as a format stores it, or why the format cannot.
pub type HeldFrame = Result<FrameCamera, String>;

/// A format that stores a camera or a homography for each frame.
pub trait CameraFormat: Sync {
    /// The frame as the format stores it, under the name with which it will be read back: as it is
    /// and under the name of its files, unless the format says otherwise.
    ///
    /// # Errors
    /// The format cannot store the frame at all; the reason in words.
    fn hold(&self, frame: &FrameCamera, _index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        Ok(frame.with_name(stem_of(frame)))
    }

    /// The maximum error of a landmark due to the precision of the format, px.
    fn resolution_px(&self, _held: &FrameCamera) -> f64 {
        EXACT_PX
    }

    /// The source of the picture size of frames that were read.
    fn size_source(&self) -> SizeSource {
        SizeSource::Stated
    }

    /// The tolerances within which its frames agree on a common base.
    fn exactness(&self) -> Exactness {
        Exactness::default()
    }

    /// The document of its frames.
    fn document(&self, field: FieldSpec, frames: &[View]) -> Document {
        document_of(field, frames, self.exactness())
    }

    /// What its files name neither the video nor the folder of, so that its frames must be of one.
    fn sequence(&self) -> Option<SequenceScope> {
        None
    }

    /// Notes for the user about these frames in this format.
    fn notes(&self, _frames: &[FrameCamera], _context: &WriteContext<'_>) -> Vec<String> {
        Vec::new()
    }

    /// The files of the frames as stored by [`Self::hold`]; none for a format that is only read.
    ///
    /// # Errors
    /// A value cannot be written.
    fn write(&self, _held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
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
    /// A file is damaged.
    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>>;

    /// The contents of its files that are not read, in words.
    fn unread(&self, _files: &Files) -> Vec<String> {
        Vec::new()
    }

    /// The options with which an export is read back.
    fn reading(&self, held: &[FrameCamera], options: &ExportOptions) -> ImportOptions {
        // What a file of this format does not state, an export knows: its own size, zoom and
        // sensor.
        ImportOptions {
            size: held.first().and_then(|frame| frame.size),
            zoom: Some(options.zoom.clone()),
            sensor_width_mm: options.sensor_width_mm,
            ..ImportOptions::default()
        }
    }
}

/// The name of a frame's files: the one that they came under, else its image's without the ending,
/// or the video's with the frame's number.
pub fn stem_of(frame: &FrameCamera) -> String {
    // A document that came from elsewhere may state any name; a folder in it would lead out of the
    // export.
    if let Some(name) = &frame.labels_name {
        return base_name(name).to_owned();
    }
    match (&frame.image, frame.frame_index) {
        (Some(image), _) => file_stem(image),
        (None, Some(index)) => {
            // A frame of a video is named `match.mp4#412`; the part before the number is the video.
            let name = frame
                .name
                .rsplit_once('#')
                .map_or(frame.name.as_str(), |(video, _)| video);
            format!("{}_{index:06}", file_stem(name))
        }
        (None, None) => file_stem(&frame.name),
    }
}

/// The file name of a path without its ending.
pub fn file_stem(path: &str) -> String {
    Path::new(base_name(path))
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The file name of a frame's picture.
pub fn file_name_of(frame: &FrameCamera) -> String {
    match &frame.image {
        Some(image) => base_name(image).to_owned(),
        None => format!("{}.jpg", stem_of(frame)),
    }
}

/// Whether a name has this ending, in any case.
pub fn has_ending(name: &str, ending: &str) -> bool {
    Path::new(name)
        .extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::super::frame_camera::FrameProjection;
    use super::*;

    #[test]
    fn a_stated_name_of_files_leads_out_of_no_folder() {
        let mut frame = FrameCamera::new("b.jpg", None, FrameProjection::Nothing);
        assert_eq!(stem_of(&frame), "b");
        for name in ["../../a", "..\\a", "/etc/a"] {
            frame.labels_name = Some(name.to_owned());
            assert_eq!(stem_of(&frame), "a");
        }
    }
}
