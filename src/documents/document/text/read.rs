//! Reads a document from bytes, with errors that name the place and the problem.

use crate::document::model::document::conventions;
use crate::document::model::frames::DuplicateId;
use crate::document::{
    Camera, DOCUMENT_VERSION, Document, Extra, FORMAT_NAME, FieldSpec, Frame, FrameId, Frames,
    Shared, Shot, StoredClickNoise,
};
use serde::Deserialize;
use serde_json::{Map, Value};
use serde_path_to_error::Segment;
use thiserror::Error;
use touchline_core::files::plain;

/// Why bytes are not a valid document.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReadError {
    /// The file is empty.
    #[error("the file is empty; a document is expected")]
    Empty,
    /// The text is not UTF-8.
    #[error("not UTF-8 text (byte {offset}); a document is a JSON file")]
    NotUtf8 {
        /// The first byte that is not.
        offset: usize,
    },
    /// The bytes are those of another kind of file.
    #[error("it is {what}, and a document is a JSON file; {remedy}")]
    OtherKind {
        /// What it is.
        what: &'static str,
        /// What to do with it.
        remedy: &'static str,
    },
    /// The text is not JSON.
    #[error("not valid JSON: {message} at line {line} column {column}")]
    NotJson {
        /// The parser's message.
        message: String,
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
    },
    /// It is JSON, but not a document.
    #[error(
        "not a touchline document: `format` is {found}, expected {:?}",
        FORMAT_NAME
    )]
    NotADocument {
        /// What `format` is.
        found: String,
    },
    /// The `version` is not a positive whole number.
    #[error("`version` is {found}, expected a whole number from 1 on")]
    NoVersion {
        /// What `version` is.
        found: String,
    },
    /// A newer program wrote it.
    #[error(
        "the document has version {found}, this program reads up to {}; update touchline to open it",
        DOCUMENT_VERSION
    )]
    NewerVersion {
        /// The document's version.
        found: u64,
    },
    /// Two frames have the same id, so that an edit would be ambiguous.
    #[error(
        "frames[{second}].id: {id} is also the id of frames[{first}]; take the key `id` away from one of the two, which then gets an id of its own"
    )]
    DuplicateFrameId {
        /// The id.
        id: FrameId,
        /// The later frame's position.
        second: usize,
        /// The earlier one's.
        first: usize,
    },
    /// Lists and objects are nested too deeply.
    #[error(
        "lists and objects lie more than {MAX_DEPTH} deep within each other at line {line}; flatten what is there"
    )]
    TooDeep {
        /// The line, from 1.
        line: usize,
    },
    /// A key is missing or has an unexpected value.
    #[error("{place}: {message} at line {line} column {column}")]
    Schema {
        /// Which key: `frames[3].status (images/0003.jpg)`.
        place: String,
        /// What is wrong with it.
        message: String,
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
    },
}

/// The error that bytes are those of a video, a picture or an archive; none where they are not.
fn other_kind(bytes: &[u8]) -> Option<ReadError> {
    const NEW: &str = "`touchline new FOLDER --frames IT --field SPORT` makes a project of it";
    // The first bytes of MP4 and MOV (behind a length), Matroska, AVI; JPEG, PNG; zip.
    let is_video = bytes.get(4..8) == Some(b"ftyp")
        || bytes.starts_with(&[0x1a, 0x45, 0xdf, 0xa3])
        || bytes.starts_with(b"RIFF");
    let (what, remedy) = if is_video {
        ("a video", NEW)
    } else if bytes.starts_with(&[0xff, 0xd8, 0xff]) || bytes.starts_with(b"\x89PNG") {
        (
            "a picture",
            "`touchline new FOLDER --frames ITS_FOLDER --field SPORT` makes a project of pictures",
        )
    } else if bytes.starts_with(b"PK\x03\x04") {
        ("a zip archive", "unpack it and give what it holds")
    } else {
        return None;
    };
    Some(ReadError::OtherKind { what, remedy })
}

/// Reads a document.
///
/// # Errors
/// Each names the place and the problem there; nothing is guessed.
pub fn document_from_bytes(bytes: &[u8]) -> Result<Document, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        other_kind(bytes).unwrap_or(ReadError::NotUtf8 {
            offset: error.valid_up_to(),
        })
    })?;
    // Some editors put a byte order mark before UTF-8.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim_ascii().is_empty() {
        return Err(ReadError::Empty);
    }
    // Depth is checked on the bytes, before the parser follows them down.
    refuse_depth(text)?;
    // A valid document is parsed once, straight into its types. Only a text that fails is parsed
    // again, as plain values, to find out why.
    match serde_json::from_str::<DocumentJson>(text) {
        Ok(json) => {
            check_header(&json.format, &json.version)?;
            json.document()
        }
        Err(error) => Err(explain(text, &error)),
    }
}

/// Maximum nesting depth of lists and objects. The parser's limit is 128; journals nest edited
/// values a few levels deeper, and must be readable, too.
const MAX_DEPTH: usize = 100;

/// Rejects a text whose lists and objects are nested too deeply.
fn refuse_depth(text: &str) -> Result<(), ReadError> {
    // Brackets within strings do not count. Bytes suffice: in UTF-8 no part of a longer character
    // looks like one of these. Closing brackets too many are left to the parser.
    let (mut depth, mut is_quoted, mut is_escaped) = (0_usize, false, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' if is_quoted => is_escaped = true,
            b'"' => is_quoted = !is_quoted,
            b'[' | b'{' if !is_quoted => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Err(ReadError::TooDeep {
                        line: text[..at].matches('\n').count() + 1,
                    });
                }
            }
            b']' | b'}' if !is_quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    Ok(())
}

/// The required keys; a file without the first two is not a document.
#[cfg(feature = "schema")]
const REQUIRED: [&str; 5] = ["format", "version", "field", "cameras", "frames"];

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(title = "touchline document", extend("required" = REQUIRED)))]
pub(super) struct DocumentJson {
    /// Always `touchline`.
    #[cfg_attr(feature = "schema", schemars(with = "String", extend("const" = FORMAT_NAME)))]
    #[serde(default)]
    format: Value,
    /// The version of the schema; a newer one than the program knows is refused.
    #[cfg_attr(feature = "schema", schemars(with = "u64", range(min = 1, max = DOCUMENT_VERSION)))]
    #[serde(default)]
    version: Value,
    /// The program that wrote it.
    #[serde(default)]
    generator: String,
    /// World, image, rotation and angles in words.
    #[serde(default = "conventions")]
    conventions: Map<String, Value>,
    /// The field, unless a camera has its own.
    field: FieldSpec,
    /// The cameras.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Camera>"))]
    cameras: Vec<Shared<Camera>>,
    /// The frames, in the order in which a person steps through them.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Frame>"))]
    frames: Vec<Shared<Frame>>,
    /// The annotator's own click noise.
    #[serde(default)]
    click_noise: Option<StoredClickNoise>,
    /// The shots of its videos.
    #[serde(default)]
    shots: Vec<Shot>,
    /// Unknown keys.
    #[serde(flatten)]
    extra: Extra,
}

impl DocumentJson {
    fn document(self) -> Result<Document, ReadError> {
        let Self {
            generator,
            conventions,
            field,
            cameras,
            frames,
            click_noise,
            shots,
            extra,
            ..
        } = self;
        let frames = Frames::read(frames).map_err(|DuplicateId { id, second, first }| {
            ReadError::DuplicateFrameId { id, second, first }
        })?;
        Ok(Document {
            generator,
            conventions,
            field,
            cameras,
            frames,
            click_noise,
            shots,
            extra,
        })
    }
}

fn check_header(format: &Value, version: &Value) -> Result<(), ReadError> {
    if format.as_str() != Some(FORMAT_NAME) {
        return Err(ReadError::NotADocument {
            found: describe_value(format),
        });
    }
    match version.as_u64() {
        Some(1..=DOCUMENT_VERSION) => Ok(()),
        Some(found) if found > DOCUMENT_VERSION => Err(ReadError::NewerVersion { found }),
        _ => Err(ReadError::NoVersion {
            found: describe_value(version),
        }),
    }
}

/// A JSON value for a message, shortened.
fn describe_value(value: &Value) -> String {
    match value {
        Value::Null => "missing".to_owned(),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        other => {
            let text = plain(&other.to_string());
            if text.chars().count() > 40 {
                text.chars().take(40).chain(['…']).collect()
            } else {
                text
            }
        }
    }
}

/// The message of a JSON error without its position.
fn message_of(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rfind(" at line ")
        .map_or(text.as_str(), |end| &text[..end])
        .to_owned()
}

/// The parser's message about a text that is not JSON.
fn syntax_message(error: &serde_json::Error) -> String {
    match message_of(error) {
        message if message == "expected value" => {
            "expected a value (JSON has no NaN and no Infinity)".to_owned()
        }
        message => message,
    }
}

/// Explains why a text could not be read, the most informative reason first.
fn explain(text: &str, error: &serde_json::Error) -> ReadError {
    // Syntax first, for nothing can be said of a text that is not JSON. Then the header: of another
    // program's file, or a newer version's, the first unexpected key would say nothing. Only then
    // the place in the document.
    let value = match serde_json::from_str::<Value>(text) {
        Ok(value) => value,
        Err(syntax) => {
            return ReadError::NotJson {
                message: syntax_message(&syntax),
                line: syntax.line(),
                column: syntax.column(),
            };
        }
    };
    // Of a key that is missing, or of a value that is no object, indexing gives null.
    if let Err(header) = check_header(&value["format"], &value["version"]) {
        return header;
    }
    ReadError::Schema {
        place: plain(&place(text, &value)),
        message: plain(&message_of(error)),
        line: error.line(),
        column: error.column(),
    }
}

/// The place of the first violation of the schema: its keys, and the name of its camera or frame.
fn place(text: &str, document: &Value) -> String {
    let reader = &mut serde_json::Deserializer::from_str(text);
    let Err(error) = serde_path_to_error::deserialize::<_, DocumentJson>(reader) else {
        return "the document".to_owned();
    };
    // A list of numbers, such as a point, is at fault as a whole; a list of objects is followed to
    // the one that is.
    let (mut place, mut name, mut value) = (String::new(), None, Some(document));
    for segment in error.path() {
        match segment {
            Segment::Map { key } => {
                if !place.is_empty() {
                    place.push('.');
                }
                place.push_str(key);
                value = value.and_then(|value| value.get(key));
            }
            Segment::Seq { index } if name.is_none() || value.is_some_and(is_list_of_objects) => {
                place = format!("{place}[{index}]");
                value = value.and_then(|value| value.get(index));
                name = name.or(value);
            }
            _ => break,
        }
    }
    let name = name.and_then(|element| element.get("image").or_else(|| element.get("id")));
    match name.and_then(Value::as_str) {
        _ if place.is_empty() => "the document".to_owned(),
        Some(name) => format!("{place} ({name})"),
        None => place,
    }
}

fn is_list_of_objects(value: &Value) -> bool {
    let items = value.as_array();
    items.is_some_and(|items| items.iter().all(Value::is_object))
}
