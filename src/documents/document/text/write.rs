//! Serialises a document to text: the same document gives the same bytes, and a small change gives
//! a small diff.
//!
//! A value that fits on one line is written on one line (a click, a mask, a new frame); other
//! values are broken into one entry per line.

use crate::document::{DOCUMENT_VERSION, Document, FORMAT_NAME, generator};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write as _;
use thiserror::Error;

/// The maximum width of a line, bytes.
const LINE_WIDTH: usize = 120;

/// The keys of a document that have a meaning.
pub(in crate::document) const OWN_KEYS: [&str; 9] = [
    "format",
    "version",
    "generator",
    "conventions",
    "field",
    "cameras",
    FRAMES,
    "click_noise",
    "shots",
];

/// Spaces of indentation per level.
const INDENT: usize = 2;

const FRAMES: &str = "frames";

/// More frames than this never fit on one line: each has a camera, a size and a status.
const MAY_FIT_ON_LINE: usize = 2;

/// Why a document cannot be written.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// A value is not finite, or not positive where it has to be.
    #[error("{place}: {message}")]
    NotFinite {
        /// Which frame, camera or key.
        place: String,
        /// What is wrong with it.
        message: String,
    },
}

/// The text of a document, with a final newline.
///
/// # Errors
/// A number is NaN or infinite, or not positive where it has to be; the frame or camera is named.
pub fn document_to_string(document: &Document) -> Result<String, WriteError> {
    let mut root = Map::new();
    root.insert("format".to_owned(), FORMAT_NAME.into());
    root.insert("version".to_owned(), DOCUMENT_VERSION.into());
    root.insert("generator".to_owned(), generator().into());
    root.insert(
        "conventions".to_owned(),
        Value::Object(document.conventions.clone()),
    );
    root.insert(
        "field".to_owned(),
        json(&document.field, || "field".to_owned())?,
    );
    let cameras = document
        .cameras
        .iter()
        .map(|camera| json(camera, || format!("camera {}", camera.id)));
    root.insert(
        "cameras".to_owned(),
        Value::Array(cameras.collect::<Result<_, _>>()?),
    );
    // A placeholder among the keys: frames are serialised one by one, because as JSON values
    // together they would take ten times the memory of the text.
    root.insert(FRAMES.to_owned(), Value::Null);
    if let Some(noise) = &document.click_noise {
        root.insert(
            "click_noise".to_owned(),
            json(noise, || "click_noise".to_owned())?,
        );
    }
    if !document.shots.is_empty() {
        root.insert(
            "shots".to_owned(),
            json(&document.shots, || "shots".to_owned())?,
        );
    }
    // An unknown key never replaces one of the schema.
    for (key, value) in &document.extra {
        root.entry(key.as_str()).or_insert_with(|| value.clone());
    }
    let mut text = String::new();
    text.push('{');
    for (index, (key, value)) in root.iter().enumerate() {
        let used = begin_entry(index > 0, key, INDENT, &mut text);
        match key.as_str() {
            FRAMES => write_frames(document, used, &mut text)?,
            _ => write_value(value, INDENT, used, &mut text),
        }
    }
    text.push_str("\n}\n");
    #[cfg(test)]
    super::schema::tests::assert_valid(&text);
    Ok(text)
}

/// Writes the frames as [`write_value`] writes a list, `used` bytes of the line being taken.
fn write_frames(document: &Document, used: usize, text: &mut String) -> Result<(), WriteError> {
    // Few frames may fit on the line of their key, which only shows when they are written. More
    // never do, and are written one by one, each freed before the next.
    let frames = document.frames.iter().enumerate();
    let mut frames =
        frames.map(|(index, frame)| json(frame, || format!("frames[{index}] ({})", frame.name())));
    if document.frames.len() <= MAY_FIT_ON_LINE {
        let few = Value::Array(frames.collect::<Result<_, _>>()?);
        write_value(&few, INDENT, used, text);
        return Ok(());
    }
    text.push('[');
    frames.try_fold(false, |comma, frame| {
        write_item(comma, &frame?, 2 * INDENT, text);
        Ok(true)
    })?;
    new_line(false, INDENT, text);
    text.push(']');
    Ok(())
}

/// A part of the document as JSON; `place` names it in an error.
pub(in crate::document) fn json<T: Serialize>(
    value: &T,
    place: impl Fn() -> String,
) -> Result<Value, WriteError> {
    serde_json::to_value(value).map_err(|error| WriteError::NotFinite {
        place: place(),
        message: error.to_string(),
    })
}

fn write_value(value: &Value, indent: usize, used: usize, text: &mut String) {
    // One line is tried first and taken back if it is too long. The trial ends soon after the width
    // of a line, so that it costs little however large the value is.
    let start = text.len();
    // One byte is left for the comma that follows.
    if !on_one_line(value, start + LINE_WIDTH.saturating_sub(used + 1), text) {
        text.truncate(start);
        broken(value, indent, text);
    }
}

/// Writes a value on one line. False if the text grows beyond `limit` bytes: the writing then stops
/// within the value, and the caller removes what is there.
fn on_one_line(value: &Value, limit: usize, text: &mut String) -> bool {
    match value {
        Value::Array(items) => {
            text.push('[');
            for (index, item) in items.iter().enumerate() {
                text.push_str(if index > 0 { ", " } else { "" });
                if !on_one_line(item, limit, text) {
                    return false;
                }
            }
            text.push(']');
        }
        Value::Object(map) if map.is_empty() => text.push_str("{}"),
        Value::Object(map) => {
            for (index, (key, item)) in map.iter().enumerate() {
                text.push_str(if index > 0 { ", " } else { "{ " });
                push_string(key, text);
                text.push_str(": ");
                if !on_one_line(item, limit, text) {
                    return false;
                }
            }
            text.push_str(" }");
        }
        plain => push(plain, text),
    }
    text.len() <= limit
}

/// Writes a value with each entry on a line of its own; plain values as they are.
fn broken(value: &Value, indent: usize, text: &mut String) {
    match value {
        Value::Array(items) if !items.is_empty() => {
            text.push('[');
            for (index, item) in items.iter().enumerate() {
                write_item(index > 0, item, indent + INDENT, text);
            }
            new_line(false, indent, text);
            text.push(']');
        }
        Value::Object(map) if !map.is_empty() => {
            text.push('{');
            for (index, (key, item)) in map.iter().enumerate() {
                let used = begin_entry(index > 0, key, indent + INDENT, text);
                write_value(item, indent + INDENT, used, text);
            }
            new_line(false, indent, text);
            text.push('}');
        }
        other => {
            on_one_line(other, usize::MAX, text);
        }
    }
}

/// Writes an entry of a list on a line of its own.
fn write_item(comma: bool, item: &Value, indent: usize, text: &mut String) {
    new_line(comma, indent, text);
    write_value(item, indent, indent, text);
}

/// Begins an entry of an object on a line of its own, up to its value; how many bytes of that line
/// are taken.
fn begin_entry(comma: bool, key: &str, indent: usize, text: &mut String) -> usize {
    new_line(comma, indent, text);
    let start = text.len();
    push_string(key, text);
    text.push_str(": ");
    indent + text.len() - start
}

fn new_line(comma: bool, indent: usize, text: &mut String) {
    text.push_str(if comma { ",\n" } else { "\n" });
    text.extend(std::iter::repeat_n(' ', indent));
}

fn push_string(string: &str, text: &mut String) {
    push(&Value::from(string), text);
}

fn push(value: &Value, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = write!(text, "{value}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, Frame, FramePtz};
    use crate::testing::soccer_document;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn frames_are_laid_out_like_every_other_list() {
        let size = ImageSize::new(9, 9);
        for count in 0..5 {
            let mut document = soccer_document();
            document.cameras.push(Camera::new("c".into(), size).into());
            for index in 0..count {
                let mut frame = Frame::from_image(&index.to_string(), "c".into(), size);
                // The last one fits on no line.
                let ptz =
                    touchline_core::camera::Ptz::from_degrees(1.0 / 3.0, 2.0 / 3.0, 1000.0 / 3.0);
                frame.ptz = (index == 3).then(|| FramePtz::new(ptz, None));
                document.frames.push(frame.into());
            }
            let text = document_to_string(&document).unwrap();
            let mut again = String::new();
            broken(&serde_json::from_str(&text).unwrap(), 0, &mut again);
            assert_eq!(text, again + "\n", "{count} frames");
        }
    }

    #[test]
    fn a_frame_with_a_number_that_a_document_cannot_hold_is_named() {
        let mut document = soccer_document();
        for index in 0..4 {
            let mut frame = Frame::from_image(&index.to_string(), "c".into(), ImageSize::new(9, 9));
            let ptz = touchline_core::camera::Ptz::from_degrees(1.0, 2.0, 900.0);
            frame.ptz = Some(FramePtz::new(ptz, None));
            document.frames.push(frame.into());
        }
        // The last two can be written, but not be read again.
        for focal_px in [f64::NAN, f64::INFINITY, 0.0, -900.0] {
            if let Some(ptz) = &mut document.frames[2].ptz {
                ptz.focal_px = focal_px;
            }
            let error = document_to_string(&document).unwrap_err().to_string();
            assert!(error.starts_with("frames[2] (2): "), "{error}");
        }
    }
}
