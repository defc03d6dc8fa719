//! The file of a plan.

use crate::season_file::is_folder_name;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{folder_of, read_named_text};
use touchline_documents::document::FieldSpec;
use touchline_vision::media::sha256_of_bytes;

/// The value of `format` in every plan.
const FORMAT: &str = "touchline plan";
/// The version of plans that this program writes and reads.
const VERSION: u64 = 1;
/// Maximum size of a plan, bytes: ten thousand matches have 200 MB.
const MAX_BYTES: u64 = 2 << 30;

/// The shards of a season.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    format: String,
    version: u64,
    /// The program that made it and that may do its shards: "touchline 0.1.0".
    pub program: String,
    /// The processor class of the machines that may do its shards, or
    /// [`ANY`](crate::processor::ANY).
    pub processor: String,
    /// The matches, in the order of the season file.
    pub matches: Vec<PlannedMatch>,
}

/// A match of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedMatch {
    pub name: String,
    /// The path of its video or folder, relative to the plan's folder unless it is absolute.
    pub frames: String,
    /// The name of the video or folder, which names its frames in parts.
    pub frames_name: String,
    /// SHA-256 of the video, or of the folder's images.
    pub frames_sha256: String,
    /// Number of frames.
    pub num_frames: usize,
    /// The field; of a project, its own is used.
    pub field: FieldSpec,
    /// The project that has its cameras.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<PlannedFile>,
    /// The forest trained from the project.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forest: Option<PlannedFile>,
    /// Maximum number of frames from which each camera is found.
    pub look_at: usize,
    /// The id of its find shard.
    pub find: String,
    /// Its label shards, by frames.
    pub labels: Vec<LabelShard>,
}

/// A file that goes into a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedFile {
    /// Its path, relative to the plan's folder unless it is absolute.
    pub path: String,
    /// SHA-256 of its content.
    pub sha256: String,
}

/// A shard that labels a range of a match's frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LabelShard {
    /// Its id.
    pub shard: String,
    /// Number of its first frame, from 0.
    pub first: usize,
    /// Number of its last frame.
    pub last: usize,
}

/// A shard and its match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShardOfPlan<'a> {
    pub of_match: &'a PlannedMatch,
    /// The frames to label; none for the match's find shard.
    pub label: Option<&'a LabelShard>,
}

impl ShardOfPlan<'_> {
    /// The shard in words, for messages: `north-south, frames 0 to 1499`.
    pub fn describe(&self) -> String {
        let name = &self.of_match.name;
        match self.label {
            None => format!("{name}, cameras"),
            Some(LabelShard { first, last, .. }) => format!("{name}, frames {first} to {last}"),
        }
    }
}

/// Why a plan cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The plan.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    #[error("{} is not a plan: {reason}; make one with touchline plan", path.display())]
    NotAPlan {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A shard's name is not that of what goes into it.
    #[error(
        "{} was edited: a shard of {name} is not named by what goes into it; make the plan again",
        path.display()
    )]
    Edited {
        /// The plan.
        path: PathBuf,
        /// The match.
        name: String,
    },
}

impl Plan {
    /// A plan without matches.
    pub(super) fn new(program: String, processor: String) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            program,
            processor,
            matches: Vec::new(),
        }
    }

    /// Reads a plan and checks the names of its matches, and that every shard is named by what goes
    /// into it.
    ///
    /// # Errors
    /// It cannot be read, is not a plan, or was edited.
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        let text = read_named_text(path, MAX_BYTES).map_err(|source| PlanError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        let refuse = |reason| PlanError::NotAPlan {
            path: path.to_path_buf(),
            reason,
        };
        let plan: Self = serde_json::from_str(&text).map_err(|error| refuse(error.to_string()))?;
        // Strictly this version: a field that another one added may decide about a shard's bytes.
        if plan.format != FORMAT {
            return Err(refuse(format!("`format` is {:?}", plan.format)));
        }
        if plan.version != VERSION {
            return Err(refuse(format!("it has version {}", plan.version)));
        }
        // Ids do not cover the names, which become folders of the collected season: none may lead
        // out of it, and no two matches may share one.
        let mut names = BTreeSet::new();
        for PlannedMatch { name, .. } in &plan.matches {
            if !is_folder_name(name) {
                return Err(refuse(format!("{name:?} cannot be the name of a match")));
            }
            if !names.insert(name.to_lowercase()) {
                return Err(refuse(format!("{name:?} is the name of two matches")));
            }
        }
        let edited = plan
            .matches
            .iter()
            .find(|planned| !plan.has_true_ids(planned));
        match edited {
            Some(edited) => Err(PlanError::Edited {
                path: path.to_path_buf(),
                name: edited.name.clone(),
            }),
            None => Ok(plan),
        }
    }

    /// Its file: JSON.
    ///
    /// # Errors
    /// Never in practice: texts and finite numbers become JSON.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok(text)
    }

    /// Names the shards of a match by what goes into them.
    pub(super) fn name_shards(&self, planned: &mut PlannedMatch) {
        planned.find = self.find_id(planned);
        for label in &mut planned.labels {
            label.shard = label_id(&planned.find, label.first, label.last);
        }
    }

    fn find_id(&self, planned: &PlannedMatch) -> String {
        let input = FindInput {
            program: &self.program,
            processor: &self.processor,
            frames_name: &planned.frames_name,
            frames_sha256: &planned.frames_sha256,
            num_frames: planned.num_frames,
            field: &planned.field,
            project: planned.project.as_ref().map(|file| file.sha256.as_str()),
            forest: planned.forest.as_ref().map(|file| file.sha256.as_str()),
            look_at: planned.look_at,
        };
        input.id()
    }

    fn has_true_ids(&self, planned: &PlannedMatch) -> bool {
        // Ranges are hashed as they stand, so ids alone do not show that a range is one of the
        // match.
        planned.find == self.find_id(planned)
            && planned.labels.iter().all(|label| {
                label.shard == label_id(&planned.find, label.first, label.last)
                    && label.first <= label.last
                    && label.last < planned.num_frames
            })
    }

    pub fn shard(&self, id: &str) -> Option<ShardOfPlan<'_>> {
        self.matches.iter().find_map(|of_match| {
            if of_match.find == id {
                return Some(ShardOfPlan {
                    of_match,
                    label: None,
                });
            }
            let label = of_match.labels.iter().find(|label| label.shard == id)?;
            Some(ShardOfPlan {
                of_match,
                label: Some(label),
            })
        })
    }

    /// The ids of all shards: those that find cameras first, for the others need them.
    pub fn shard_ids(&self) -> impl Iterator<Item = &str> {
        let finds = self.matches.iter().map(|planned| planned.find.as_str());
        let labels = self.matches.iter().flat_map(|planned| &planned.labels);
        finds.chain(labels.map(|label| label.shard.as_str()))
    }
}

/// The path of a file of a plan at `plan`. An absolute one stays as it is.
pub(crate) fn path_in_plan(plan: &Path, path: &str) -> PathBuf {
    folder_of(plan).join(path)
}

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
