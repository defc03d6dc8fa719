//! What a work package records of the state in which it was given away: the ids of its frames, and
//! of each frame, camera and other part a hash. By these, whoever joins the package knows what the
//! person changed, and what the owner changed meanwhile.

use crate::document::{Camera, CameraId, Document, Frame, FrameId};
use serde::Serialize;
use serde_json::{Map, Value, json};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use strum::VariantArray as _;
use touchline_core::geometry::hex;

/// The key under which a package has its record.
pub(super) const KEY: &str = "package";

/// The length of a hash in the record, hexadecimal digits: 128 bits.
const HASH_DIGITS: usize = 32;

/// A part of a document beside its cameras and frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr, strum::VariantArray)]
#[strum(serialize_all = "snake_case")]
pub(super) enum Part {
    Field,
    Shots,
    ClickNoise,
    Conventions,
    Extra,
}

impl Part {
    /// The hash of this part of a document.
    pub(super) fn hash(self, document: &Document) -> String {
        match self {
            Self::Field => hash_of(&document.field),
            Self::Shots => hash_of(&document.shots),
            Self::ClickNoise => hash_of(&document.click_noise),
            Self::Conventions => hash_of(&document.conventions),
            // The record itself is no content.
            Self::Extra => {
                let entries = document.extra.iter().filter(|(key, _)| *key != KEY);
                hash_of(&entries.collect::<Vec<_>>())
            }
        }
    }
}

/// The hash of a camera.
pub(super) fn hash_of_camera(camera: &Camera) -> String {
    hash_of(camera)
}

/// The hash of a frame's content: what people did in it, and the hash of its picture. The place of
/// its picture is left out, because a package has copies; a suggestion is, because the
/// program makes it again.
pub(super) fn hash_of_frame(frame: &Frame) -> String {
    hash_of(&Frame {
        revision: 0,
        image: None,
        video: None,
        ..frame.without_suggestion()
    })
}

fn hash_of(value: &impl Serialize) -> String {
    // What cannot be serialised cannot be in a document either.
    let text = serde_json::to_vec(value).unwrap_or_default();
    let mut digits = hex(&Sha256::digest(text));
    digits.truncate(HASH_DIGITS);
    digits
}

/// The record of a package.
#[derive(Clone, Debug, Default)]
pub(super) struct PackageRecord {
    /// The ids of its initial frames.
    pub frames: BTreeSet<FrameId>,
    /// The state of its parts; none in packages of earlier versions of the program.
    pub given: Option<Given>,
}

/// The hashes of the parts of a package as it was given away.
#[derive(Clone, Debug, Default)]
pub(super) struct Given {
    pub frames: BTreeMap<FrameId, String>,
    pub cameras: BTreeMap<CameraId, String>,
    parts: Map<String, Value>,
}

impl Given {
    /// Whether a part of a document is as it was given away.
    pub(super) fn is_same(&self, part: Part, document: &Document) -> bool {
        let given = self.parts.get(<&str>::from(part)).and_then(Value::as_str);
        given == Some(part.hash(document).as_str())
    }
}

impl PackageRecord {
    /// The record that describes a package which is given away as it is.
    pub(super) fn to_json(package: &Document) -> Value {
        let ids: BTreeSet<&str> = package
            .frames
            .iter()
            .map(|frame| frame.id.as_str())
            .collect();
        let frames = package.frames.iter().map(|frame| {
            let state = json!({ "revision": frame.revision, "sha256": hash_of_frame(frame) });
            (frame.id.as_str().to_owned(), state)
        });
        let cameras = package.cameras.iter().map(|camera| {
            let hash = Value::from(hash_of_camera(camera));
            (camera.id.as_str().to_owned(), hash)
        });
        let mut given: Map<String, Value> = Part::VARIANTS
            .iter()
            .map(|part| (<&str>::from(part).to_owned(), part.hash(package).into()))
            .collect();
        given.insert("cameras".to_owned(), Value::Object(cameras.collect()));
        given.insert("frames".to_owned(), Value::Object(frames.collect()));
        json!({ "frames": ids, "given": given })
    }

    /// Reads the record of a document; none if it is no package.
    pub(super) fn read(document: &Document) -> Option<Self> {
        let record = document.extra.get(KEY)?;
        let ids = record.get("frames")?.as_array()?.iter();
        let frames = ids.filter_map(Value::as_str).map(FrameId::from).collect();
        Some(Self {
            frames,
            given: record.get("given").and_then(read_given),
        })
    }
}

fn read_given(given: &Value) -> Option<Given> {
    let frames = given.get("frames")?.as_object()?.iter();
    let cameras = given.get("cameras")?.as_object()?.iter();
    Some(Given {
        frames: frames
            .filter_map(|(id, state)| {
                let hash = state.get("sha256")?.as_str()?;
                Some((FrameId::from(id.as_str()), hash.to_owned()))
            })
            .collect(),
        cameras: cameras
            .filter_map(|(id, hash)| Some((CameraId::from(id.as_str()), hash.as_str()?.to_owned())))
            .collect(),
        parts: given.as_object()?.clone(),
    })
}
