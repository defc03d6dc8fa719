//! Reads a document from bytes, with errors that name the place and the problem.

use crate::document::model::document::conventions;
use crate::document::model::frames::DuplicateId;
use crate::document::{
    Camera, DOCUMENT_VERSION, Document, Extra, FORMAT_NAME, FieldSpec, Frame, FrameId, Frames,
    Shared, Shot, StoredClickNoise,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
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
    let (place, message) =
        place(&value).unwrap_or_else(|| ("the document".to_owned(), message_of(error)));
    ReadError::Schema {
        place: plain(&place),
        message: plain(&message),
        line: error.line(),
        column: error.column(),
    }
}

/// The place and message of the first violation of the schema.
fn place(document: &Value) -> Option<(String, String)> {
    // In the order of the schema. A failure elsewhere, such as a missing list, has no place here,
    // and the caller reports the parser's message for the document as a whole.
    document
        .get("field")
        .and_then(|field| find_failure(field, "field", &misfit::<FieldSpec>))
        .or_else(|| violation_in::<Camera>(document, "cameras", Some("id")))
        .or_else(|| violation_in::<Frame>(document, "frames", Some("image")))
        .or_else(|| violation_in::<Shot>(document, "shots", None))
}

/// The first violation in one of the document's lists. `name` is the key that names an element.
fn violation_in<T: DeserializeOwned>(
    document: &Value,
    list: &str,
    name: Option<&str>,
) -> Option<(String, String)> {
    elements(document, list).find_map(|(index, element)| {
        let (place, message) = find_failure(element, &format!("{list}[{index}]"), &misfit::<T>)?;
        Some((place_with_name(place, element, name), message))
    })
}

/// Why a value is no `T`; none if it is one.
fn misfit<T: DeserializeOwned>(value: &Value) -> Option<String> {
    T::deserialize(value).err().map(|error| error.to_string())
}

fn elements<'a>(document: &'a Value, key: &str) -> impl Iterator<Item = (usize, &'a Value)> {
    document
        .get(key)
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .enumerate()
}

fn place_with_name(place: String, value: &Value, key: Option<&str>) -> String {
    match key.and_then(|key| value.get(key)?.as_str()) {
        Some(name) => format!("{place} ({name})"),
        None => place,
    }
}

/// Maximum number of values inspected to locate an error. A file may have any number; beyond the
/// limit, the place known so far is reported.
const MOST_LOOKS: usize = 1_000_000;

/// The place and message of a failure within a value; none if it is valid.
fn find_failure(
    value: &Value,
    place: &str,
    fails: &dyn Fn(&Value) -> Option<String>,
) -> Option<(String, String)> {
    let mut looks = MOST_LOOKS;
    descend(
        &Part {
            value,
            place,
            around: 0,
        },
        &mut looks,
        fails,
    )
}

/// A part of a value that fails.
struct Part<'a> {
    value: &'a Value,
    place: &'a str,
    /// The number of other values that are inspected together with it.
    around: usize,
}

/// Follows a failure down to the key whose removal changes the error.
///
/// The types of inner values are not known here. So `fails` always reads the outermost type, a
/// camera or a frame, with an inner value exchanged, and the messages of two readings are compared.
/// This finds the place for any type without a word about it here, at the price of a copy of the
/// object for each key: hence the budget `looks`.
fn descend(
    part: &Part,
    looks: &mut usize,
    fails: &dyn Fn(&Value) -> Option<String>,
) -> Option<(String, String)> {
    let &Part {
        value,
        place,
        around,
    } = part;
    let message = fails(value)?;
    match value {
        Value::Object(map) => {
            let size = count(value);
            for (index, (key, inner)) in map.iter().enumerate() {
                if !may_inspect(around + size, looks) {
                    break;
                }
                // The key is at fault if the error changes when it is removed.
                let mut without = map.clone();
                without.shift_remove(key);
                if fails(&Value::Object(without.clone())).as_ref() == Some(&message) {
                    continue;
                }
                // The inner value returns to its old index: the order of keys decides which of
                // several errors is reported first.
                let with = |inner: &Value| {
                    let mut map = without.clone();
                    map.shift_insert(index, key.clone(), inner.clone());
                    fails(&Value::Object(map))
                };
                // The value as a whole may be wrong, such as a list that is too long.
                let within = format!("{place}.{key}");
                let part = Part {
                    value: inner,
                    place: &within,
                    around: around + size - count(inner),
                };
                return descend(&part, looks, &with).or(Some((within, message)));
            }
        }
        // A list of objects is followed into the first one that fails by itself. A list of numbers,
        // such as a point, is reported as a whole.
        Value::Array(items) if items.iter().all(Value::is_object) => {
            let alone = |inner: &Value| fails(&Value::Array(vec![inner.clone()]));
            for (index, inner) in items.iter().enumerate() {
                if !may_inspect(around + count(inner), looks) {
                    break;
                }
                if alone(inner).is_some() {
                    let within = format!("{place}[{index}]");
                    return descend(
                        &Part {
                            value: inner,
                            place: &within,
                            around,
                        },
                        looks,
                        &alone,
                    );
                }
            }
        }
        _ => {}
    }
    Some((place.to_owned(), message))
}

/// Whether this many more values may be inspected. They are subtracted from those left.
fn may_inspect(values: usize, looks: &mut usize) -> bool {
    // What exceeds the budget also ends it, so that no smaller value is inspected afterwards.
    let left = looks.checked_sub(values);
    *looks = left.unwrap_or(0);
    left.is_some()
}

/// The number of values in a value, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(map) => map.values().map(count).sum(),
        _ => 0,
    }
}
