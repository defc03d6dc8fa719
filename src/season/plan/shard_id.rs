//! The names of shards: hashes of what goes in.

use super::file::{Plan, PlannedMatch};
use serde::Serialize;
use touchline_documents::document::FieldSpec;
use touchline_vision::media::sha256_of_bytes;

/// What the bytes of a find shard depend on, in this order.
#[derive(Serialize)]
struct FindInput<'a> {
    kind: &'static str,
    program: &'a str,
    processor: &'a str,
    /// Frames are named by it in the part.
    frames_name: &'a str,
    frames_sha256: &'a str,
    num_frames: usize,
    field: &'a FieldSpec,
    project: Option<&'a str>,
    forest: Option<&'a str>,
    look_at: usize,
}

/// What the bytes of a label shard depend on. The part of its find shard is named by all the rest.
#[derive(Serialize)]
struct LabelInput<'a> {
    kind: &'static str,
    find: &'a str,
    first: usize,
    last: usize,
}

/// The name of a match's find shard: the SHA-256 of everything that goes into it.
#[must_use]
pub fn find_id(plan: &Plan, planned: &PlannedMatch) -> String {
    hash_of(&FindInput {
        kind: "find",
        program: &plan.program,
        processor: &plan.processor,
        frames_name: &planned.frames_name,
        frames_sha256: &planned.frames_sha256,
        num_frames: planned.num_frames,
        field: &planned.field,
        project: planned.project.as_ref().map(|file| file.sha256.as_str()),
        forest: planned.forest.as_ref().map(|file| file.sha256.as_str()),
        look_at: planned.look_at,
    })
}

/// The name of the shard that labels frames `first` to `last`, both included, with the cameras of
/// the find shard `find`.
#[must_use]
pub fn label_id(find: &str, first: usize, last: usize) -> String {
    hash_of(&LabelInput {
        kind: "label",
        find,
        first,
        last,
    })
}

fn hash_of(input: &impl Serialize) -> String {
    // Plain structures of texts and finite numbers always become JSON; an empty text would be
    // refused wherever a shard is looked up.
    let text = serde_json::to_string(input).unwrap_or_default();
    sha256_of_bytes(text.as_bytes())
}
