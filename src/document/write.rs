//! From a document to text: the same document gives the same bytes, and a small change gives a small difference.
//!
//! What fits on a line is written on one line (a click, a mask, a new frame); everything else is broken, one entry a line.

use super::{DOCUMENT_VERSION, Document, FORMAT_NAME, generator};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write as _;
use thiserror::Error;

/// The width that a line of the document may have, in bytes.
const LINE_WIDTH: usize = 120;

/// Why a document cannot be written.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// A value is no finite number.
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
/// A number is NaN or infinite; the frame or camera is named.
pub fn document_to_string(document: &Document) -> Result<String, WriteError> {
    let mut root = Map::new();
    root.insert("format".to_owned(), FORMAT_NAME.into());
    root.insert("version".to_owned(), DOCUMENT_VERSION.into());
    root.insert("generator".to_owned(), generator().into());
    root.insert("conventions".to_owned(), Value::Object(document.conventions.clone()));
    root.insert("field".to_owned(), json(&document.field, || "field".to_owned())?);
    let cameras = document.cameras.iter().map(|camera| json(camera, || format!("camera {}", camera.id)));
    root.insert("cameras".to_owned(), Value::Array(cameras.collect::<Result<_, _>>()?));
    let frames = document.frames.iter().enumerate();
    let frames = frames.map(|(index, frame)| json(frame, || format!("frames[{index}] ({})", frame.name())));
    root.insert("frames".to_owned(), Value::Array(frames.collect::<Result<_, _>>()?));
    if let Some(noise) = &document.click_noise {
        root.insert("click_noise".to_owned(), json(noise, || "click_noise".to_owned())?);
    }
    if !document.shots.is_empty() {
        root.insert("shots".to_owned(), json(&document.shots, || "shots".to_owned())?);
    }
    for (key, value) in &document.extra {
        root.entry(key.as_str()).or_insert_with(|| value.clone());
    }
    let mut text = String::new();
    broken(&Value::Object(root), 0, &mut text);
    text.push('\n');
    #[cfg(test)]
    super::schema::tests::assert_valid(&text);
    Ok(text)
}

/// A part of the document as JSON; `place` names it in an error.
pub(super) fn json<T: Serialize>(value: &T, place: impl Fn() -> String) -> Result<Value, WriteError> {
    serde_json::to_value(value).map_err(|error| WriteError::NotFinite { place: place(), message: error.to_string() })
}

fn write_value(value: &Value, indent: usize, used: usize, text: &mut String) {
    let start = text.len();
    // A comma follows.
    if !on_one_line(value, start + LINE_WIDTH.saturating_sub(used + 1), text) {
        text.truncate(start);
        broken(value, indent, text);
    }
}

/// Writes a value on one line, unless the text would grow beyond `limit`.
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
                new_line(index > 0, indent + 2, text);
                write_value(item, indent + 2, indent + 2, text);
            }
            new_line(false, indent, text);
            text.push(']');
        }
        Value::Object(map) if !map.is_empty() => {
            text.push('{');
            for (index, (key, item)) in map.iter().enumerate() {
                new_line(index > 0, indent + 2, text);
                let start = text.len();
                push_string(key, text);
                text.push_str(": ");
                write_value(item, indent + 2, indent + 2 + text.len() - start, text);
            }
            new_line(false, indent, text);
            text.push('}');
        }
        other => {
            on_one_line(other, usize::MAX, text);
        }
    }
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
