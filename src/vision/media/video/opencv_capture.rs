//! The boundary to OpenCV's video reader.
//!
//! Four of its peculiarities matter (found with OpenCV 4.6 on `FFmpeg` 5.1):
//!
//! - Its frame numbers are times multiplied by the stated rate, so they are wrong for irregular
//!   times; only time stamps are used here.
//! - The last few frames, which the decoder holds back for reordering, have the time stamp 0: their
//!   time is unknown.
//! - A frame that does not decode is reported like the end. Further frames follow nevertheless,
//!   beginning with remnants of earlier ones, whose times go back.
//! - A file that it cannot read is no error; it is just not open.

use super::container::no_video_in;
use super::{Capture, StatedProperties, turned_aspect};
use crate::media::picture::byte_count;
use crate::media::{MediaError, Picture, one_line};
use opencv::core::{Mat, Vec4b, Vector};
use opencv::imgproc::{COLOR_BGR2RGBA, COLOR_GRAY2RGBA};
use opencv::prelude::*;
use opencv::videoio::{self, VideoCapture};
use std::path::{Path, PathBuf};
use touchline_core::geometry::ImageSize;

/// Number of consecutive decoding failures that are taken for the end.
const MAX_FAILURES: usize = 100;

/// An open video; its position is the last frame grabbed.
pub(super) struct OpenCvCapture {
    inner: VideoCapture,
    path: PathBuf,
    /// Whether nothing has been grabbed since it was opened, and no seek was made. Only then is a
    /// time stamp of 0 a real one.
    is_fresh: bool,
    /// The time of the last frame grabbed, s, if known.
    time_s: Option<f64>,
    /// The latest time since the start or the last seek, s.
    latest_s: f64,
    bgr: Mat,
    stated: StatedProperties,
}

impl OpenCvCapture {
    /// Opens a video through `FFmpeg`: the other readers of OpenCV print warnings and count
    /// differently.
    pub(super) fn open(path: &Path) -> Result<Self, MediaError> {
        Self::open_with(
            path,
            &[
                videoio::CAP_PROP_HW_ACCELERATION,
                videoio::VIDEO_ACCELERATION_NONE,
            ],
        )
    }

    /// Opens a video for counting its packets: [`Capture::grab`] then reads one without decoding
    /// it.
    pub(super) fn open_packets(path: &Path) -> Result<Self, MediaError> {
        Self::open_with(path, &[videoio::CAP_PROP_FORMAT, -1])
    }

    fn open_with(path: &Path, parameters: &[i32]) -> Result<Self, MediaError> {
        // FFmpeg takes a name such as `a:b.mp4` for a protocol; an absolute path is always a path.
        let absolute =
            std::path::absolute(path).map_err(|error| MediaError::from_io(path, &error))?;
        let parameters = Vector::<i32>::from_slice(parameters);
        let inner =
            VideoCapture::from_file_with_params(&absolute, videoio::CAP_FFMPEG, &parameters)
                .ok()
                .filter(|inner| inner.is_opened().unwrap_or(false))
                .ok_or_else(|| no_video_in(path))?;
        Ok(Self {
            stated: read_properties(&inner),
            inner,
            path: path.to_path_buf(),
            is_fresh: true,
            time_s: None,
            latest_s: f64::NEG_INFINITY,
            bgr: Mat::default(),
        })
    }

    /// Records the time of the frame just grabbed; false if it is not later than all before.
    fn note_time(&mut self) -> bool {
        let time_ms = self.property(videoio::CAP_PROP_POS_MSEC);
        // A time of 0 is real for the very first frame only; see the module.
        let is_known = time_ms.is_finite() && (time_ms != 0.0 || self.is_fresh);
        self.is_fresh = false;
        // Remnants after a damaged frame have times that go back; a frame of unknown time passes.
        self.time_s = is_known.then_some(time_ms / 1000.0);
        let is_new = self.time_s.is_none_or(|time_s| time_s > self.latest_s);
        self.latest_s = self
            .time_s
            .map_or(self.latest_s, |time_s| time_s.max(self.latest_s));
        is_new
    }

    fn retrieve_picture(&mut self) -> opencv::Result<Option<Picture>> {
        if !self.inner.retrieve_def(&mut self.bgr)? || self.bgr.empty() {
            return Ok(None);
        }
        let (rows, columns) = (self.bgr.rows(), self.bgr.cols());
        let size = ImageSize::new(columns.unsigned_abs(), rows.unsigned_abs());
        let Some(bytes) = byte_count(size) else {
            return Ok(None);
        };
        // The target is a view of `rgba`, so that OpenCV converts into the picture's own memory; it
        // ends before the picture takes it.
        let mut rgba = vec![0; bytes];
        {
            let code = if self.bgr.channels() == 1 {
                COLOR_GRAY2RGBA
            } else {
                COLOR_BGR2RGBA
            };
            let mut target = Mat::new_rows_cols_with_bytes_mut::<Vec4b>(rows, columns, &mut rgba)?;
            opencv::imgproc::cvt_color_def(&self.bgr, &mut target, code)?;
        }
        Ok(Picture::new(size, rgba).ok())
    }

    fn damaged_frame_error(&self, index: usize, reason: &str) -> MediaError {
        MediaError::DamagedFrame {
            path: self.path.clone(),
            index,
            reason: one_line(reason),
        }
    }

    fn property(&self, id: i32) -> f64 {
        property(&self.inner, id)
    }
}

impl Capture for OpenCvCapture {
    fn stated_properties(&self) -> &StatedProperties {
        &self.stated
    }

    fn grab(&mut self) -> Result<bool, MediaError> {
        // OpenCV reports a damaged frame as it reports the end; only many failures in a row are the
        // end.
        Ok((0..MAX_FAILURES).any(|_| self.inner.grab().unwrap_or(false) && self.note_time()))
    }

    fn time_s(&self) -> Option<f64> {
        self.time_s
    }

    fn restart(&mut self) -> Result<(), MediaError> {
        *self = Self::open(&self.path)?;
        Ok(())
    }

    fn jump_near(&mut self, time_s: f64) {
        let number = (time_s * self.stated.fps).round().max(0.0);
        // After a failed seek the reader is somewhere else, which the next time stamp shows.
        let _ = self.inner.set(videoio::CAP_PROP_POS_FRAMES, number);
        self.is_fresh = false;
        self.latest_s = f64::NEG_INFINITY;
    }

    fn picture(&mut self, index: usize) -> Result<Picture, MediaError> {
        match self.retrieve_picture() {
            Ok(Some(picture)) => Ok(picture),
            Ok(None) => Err(self.damaged_frame_error(index, "the decoder gave no picture")),
            Err(error) => Err(self.damaged_frame_error(index, &error.message)),
        }
    }
}

/// The properties that the container states, as reported by OpenCV.
fn read_properties(inner: &VideoCapture) -> StatedProperties {
    let [width, height] = [
        videoio::CAP_PROP_FRAME_WIDTH,
        videoio::CAP_PROP_FRAME_HEIGHT,
    ]
    .map(|id| property(inner, id).max(0.0) as u32);
    let fps = property(inner, videoio::CAP_PROP_FPS);
    let frames = property(inner, videoio::CAP_PROP_FRAME_COUNT);
    let (across, down) = (
        property(inner, videoio::CAP_PROP_SAR_NUM),
        property(inner, videoio::CAP_PROP_SAR_DEN),
    );
    let rotation_deg =
        (property(inner, videoio::CAP_PROP_ORIENTATION_META) as i64).rem_euclid(360) as u32;
    StatedProperties {
        size: ImageSize::new(width, height),
        rotation_deg,
        fps: positive(fps).unwrap_or(25.0),
        frames: positive(frames).map_or(0, |frames| frames as usize),
        pixel_aspect: if across > 0.0 && down > 0.0 {
            turned_aspect(across / down, rotation_deg)
        } else {
            1.0
        },
    }
}

/// A number, unless it is infinite, NaN or not positive.
fn positive(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite() && *number > 0.0)
}

/// A property; NaN if OpenCV does not have it.
fn property(inner: &VideoCapture, id: i32) -> f64 {
    inner.get(id).unwrap_or(f64::NAN)
}
