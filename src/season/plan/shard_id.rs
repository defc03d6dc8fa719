//! The names of shards: hashes of what goes in.

use serde::Serialize;
use touchline_documents::document::FieldSpec;
use touchline_vision::media::sha256_of_bytes;

/// What the bytes of a find shard depend on, in this order.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct FindInput<'a> {
    /// The program that makes them.
    pub(super) program: &'a str,
    /// The class of the machine.
    pub(super) processor: &'a str,
    /// The name of the video or folder, by which the part names its frames.
    pub(super) frames_name: &'a str,
    /// The hash of the video or of the folder's images.
    pub(super) frames_sha256: &'a str,
    /// Number of frames: decoders may differ in it.
    pub(super) num_frames: usize,
    /// The field.
    pub(super) field: &'a FieldSpec,
    /// The hash of the project.
    pub(super) project: Option<&'a str>,
    /// The hash of the forest.
    pub(super) forest: Option<&'a str>,
    /// Maximum number of frames from which each camera is found.
    pub(super) look_at: usize,
}

/// What the bytes of a label shard depend on. The part of its find shard is named by all the rest.
#[derive(Serialize)]
struct LabelInput<'a> {
    find: &'a str,
    first: usize,
    last: usize,
}

impl FindInput<'_> {
    /// The id of the shard: the SHA-256 of everything that goes into it.
    pub(super) fn id(&self) -> String {
        hash_of("find", self)
    }
}

/// The id of the shard that labels frames `first` to `last`, both included, with the cameras of the
/// find shard `find`.
pub(super) fn label_id(find: &str, first: usize, last: usize) -> String {
    hash_of("label", &LabelInput { find, first, last })
}

fn hash_of(kind: &str, input: &impl Serialize) -> String {
    // Plain structures of texts and finite numbers always become JSON, with their keys in the order
    // of the fields, so the same input gives the same text.
    let text = serde_json::to_string(input).unwrap_or_default();
    // The kind keeps a find shard and a label shard apart, whatever goes into them.
    sha256_of_bytes(format!("{kind} {text}").as_bytes())
}
