//! `FreeD` D1: packets of 29 bytes, back to back, and the same as a table with times.
//!
//! Pan 0 looks along +y, positive to the right; tilt up; roll clockwise seen from behind; steps of
//! 1/32768° and 1/64 mm. The zoom is a raw number, here the focal length in px, in mm × 100 by the
//! sensor's width, or by a table. There is no size of picture, principal point, lens or time in it.
//! Source: Vinten Radamec manual V1.4.4, appendices A and B.

mod csv;
mod packets;
mod sample;
mod zoom;

pub use csv::FreeDCsv;
pub use packets::FreeD;

use crate::exchange::cameras::camera_format::{HeldFrame, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, Pinhole};
use crate::exchange::cameras::held::{
    OTHER_SIZE, cannot_hold, note_several_cameras, parts, plain, with,
};
use crate::exchange::error::{ExchangeError, ExchangeResult};
use crate::exchange::format::Format;
use crate::exchange::options::{ImportOptions, Zoom};
use sample::Sample;
use std::collections::BTreeSet;
use touchline_core::geometry::ImageSize;

/// What the user must state, because neither packets nor the table contain it.
#[derive(Clone, Copy)]
struct Reading<'a> {
    size: ImageSize,
    zoom: &'a Zoom,
    sensor_mm: Option<f64>,
}

impl<'a> Reading<'a> {
    fn from_options(options: &'a ImportOptions, format: Format) -> ExchangeResult<Self> {
        // Three things that no packet states; without one of them the numbers would give a camera,
        // but a wrong one.
        let size = options.size.ok_or_else(|| {
            option_needed(format, "the size of its pictures", "--size WIDTHxHEIGHT")
        })?;
        let zoom = options
            .zoom
            .as_ref()
            .ok_or_else(|| option_needed(format, "what its zoom value means", "--zoom"))?;
        if *zoom == Zoom::FocalMmX100 && options.sensor_width_mm.is_none() {
            return Err(option_needed(
                format,
                "how wide the sensor is",
                "--sensor-mm",
            ));
        }
        Ok(Self {
            size,
            zoom,
            sensor_mm: options.sensor_width_mm,
        })
    }
}

/// The error that the user must state something.
fn option_needed(format: Format, what: &'static str, option: &'static str) -> ExchangeError {
    ExchangeError::OptionNeeded {
        format,
        what,
        option,
    }
}

/// What both formats keep: a pinhole whose focal length corresponds to a whole zoom value.
fn hold(frame: &FrameCamera, index: usize, context: &WriteContext<'_>) -> HeldFrame {
    let (pinhole, size) = parts(frame)?;
    let (zoom, sensor) = (&context.options.zoom, context.options.sensor_width_mm);
    // To the raw number and back, so that the loss of a whole zoom value is measured and the file
    // compares exactly.
    let raw = zoom.raw(pinhole.focal_px, size, sensor)?;
    let focal_px = zoom
        .focal_px(raw, size, sensor)
        .map_err(|problem| problem.to_string())?;
    Ok(with(
        frame,
        format!("{index:06}"),
        Pinhole {
            focal_px,
            ..plain(&pinhole, size)
        },
    ))
}

/// The numbers of the packets of frames, which must have pictures of one size.
fn samples(
    held: &[FrameCamera],
    context: &WriteContext<'_>,
    format: Format,
) -> ExchangeResult<Vec<Sample>> {
    // A reader knows one size for the whole stream, by which it finds the middle and the focal
    // length.
    let first_size = held.first().and_then(|first| first.size);
    held.iter()
        .map(|frame| {
            sample_from_frame(frame, first_size, context)
                .map_err(|why| cannot_hold(frame, format, why))
        })
        .collect()
}

/// The numbers of the packet of a frame, or why there are none.
fn sample_from_frame(
    frame: &FrameCamera,
    first_size: Option<ImageSize>,
    context: &WriteContext<'_>,
) -> Result<Sample, String> {
    let (pinhole, size) = parts(frame)?;
    if Some(size) != first_size {
        return Err(OTHER_SIZE.to_owned());
    }
    Sample::from_pinhole(
        &pinhole,
        size,
        &context.options.zoom,
        context.options.sensor_width_mm,
    )
}

/// Notes for the user about both formats.
fn notes(frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
    let mut notes = vec![zoom_note(context)];
    notes.extend(note_several_cameras(frames));
    notes
}

fn zoom_note(context: &WriteContext<'_>) -> String {
    let meaning = match context.options.zoom {
        Zoom::FocalPx => "the focal length in whole px",
        Zoom::FocalMmX100 => "the focal length in mm × 100",
        Zoom::Table(_) => "by the given table",
    };
    format!("the zoom value is {meaning}; tell whoever reads it")
}

/// A note if a stream contains several cameras: the frames of all of them are numbered in one
/// sequence.
fn second_camera_note(ids: &BTreeSet<String>) -> Option<String> {
    (ids.len() > 1).then(|| {
        let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
        format!(
            "camera ids {} are in one stream and cannot be distinguished; import one camera at a \
             time",
            ids.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
