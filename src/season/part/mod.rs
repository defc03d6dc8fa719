//! The file that a shard writes: `PARTS/ID.part`.
//!
//! ```text
//! {"format": "touchline part", "version": 1, "shard": ID, …, "sha256": …}\n
//! about (JSON) | document (JSON) | forest (bytes)
//! ```
//!
//! The first line states the shard, the lengths of what follows and its SHA-256, so that a part
//! that is cut off, damaged or of another shard is seen as such and never used. A part is written
//! under a temporary name, flushed and renamed, and never replaces one that is there: two processes
//! that do one shard may both finish, and whoever comes second finds the same bytes.
//!
//! The part does not name a plan. Its shard is named by everything that goes in, so the part is
//! that of every plan that has the shard: a season that grows by a match keeps what was done.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{read_named, way_out};
use touchline_documents::document::{
    Document, ReadError, WriteError, document_from_bytes, document_to_string,
};
use touchline_documents::store::write_new;
use touchline_vision::media::sha256_of_bytes;

/// The value of `format` in every part.
const FORMAT: &str = "touchline part";
/// The version of parts that this program writes and reads.
const VERSION: u64 = 1;
/// The ending of a part's name.
const ENDING: &str = "part";
/// The ending of the file beside a part that states what it cost.
const COST_ENDING: &str = "cost";
/// Maximum size of a part, bytes.
const MAX_BYTES: u64 = 4 << 30;
/// Maximum length of the first line, bytes.
const MAX_HEADER_BYTES: usize = 4096;
/// How a file that may be of use elsewhere is mended.
const MOVE_AWAY: &str = "move it away and run this shard again";
/// How a file that is of no use is mended.
const DELETE: &str = "delete it and run its shard again";
/// What to do about two machines of one class with different arithmetic.
const REPORT: &str = "the two machines differ although their class is the same: please report it";

/// The result of a shard.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What is not in the document.
    pub about: AboutPart,
    /// Field, cameras, and frames with their suggestions; paths are relative to the folder that
    /// holds the match's video or folder of images.
    pub document: Document,
    /// Of a find shard: the forest that label shards query; empty if none could be trained.
    pub forest: Vec<u8>,
}

/// What a part states beside its document.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AboutPart {
    /// Why there is no camera or no forest, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Which camera took which frames, in the order of the frames; of a find shard.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cameras_of_frames: Vec<CameraRun>,
}

/// A run of frames of one camera: it ends where the next one begins.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraRun {
    /// Number of the first frame, from 0.
    pub first: usize,
    pub camera: String,
}

/// What a shard cost: stated beside its part, because it differs from run to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Time of all processors, s; none where the system does not state it.
    pub cpu_s: Option<f64>,
    /// Time by the clock, s.
    pub wall_s: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    format: String,
    version: u64,
    shard: String,
    about_bytes: usize,
    document_bytes: usize,
    forest_bytes: usize,
    sha256: String,
}

/// Why a part cannot be used or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PartError {
    /// It is not there.
    #[error("there is no {}", path.display())]
    Missing {
        /// The part.
        path: PathBuf,
    },
    /// The system refused.
    #[error("cannot {action} {}: {source}{}", path.display(), way_out(source))]
    Io {
        /// The attempted action.
        action: &'static str,
        /// The part.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// It has no first line that states a part.
    #[error(
        "{} is not a part, or one that another version wrote; {MOVE_AWAY}",
        path.display()
    )]
    NotAPart {
        /// The file.
        path: PathBuf,
    },
    /// It states another shard than its name.
    #[error(
        "{} is the part of another shard, {found}, of this or another plan; {MOVE_AWAY}",
        path.display()
    )]
    OtherShard {
        /// The file.
        path: PathBuf,
        /// The shard that it states.
        found: String,
    },
    /// It is shorter or longer than it states.
    #[error(
        "{} is cut off: it has {found} of {stated} bytes; {DELETE}",
        path.display()
    )]
    CutOff {
        /// The file.
        path: PathBuf,
        /// Number of bytes that there are.
        found: usize,
        /// Number of bytes that it states.
        stated: usize,
    },
    /// Its bytes are not those that were written.
    #[error("{} is damaged: its checksum is wrong; {DELETE}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// Its document cannot be read, although its bytes are those that were written.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ReadError,
    },
    /// A part cannot be serialised.
    #[error("the part of {shard} was not written: {source}")]
    Write {
        shard: String,
        /// Why.
        source: WriteError,
    },
    /// There is another part of this shard with other bytes.
    #[error(
        "{} was made by another process meanwhile, with other bytes, and stays; {REPORT}",
        path.display()
    )]
    Differs {
        /// The part.
        path: PathBuf,
    },
}

/// Where a folder of parts has the part of a shard.
pub fn part_path(parts: &Path, shard: &str) -> PathBuf {
    parts.join(format!("{shard}.{ENDING}"))
}

/// The shard that a file in a folder of parts is named after; none if it is no part.
pub fn shard_of_path(path: &Path) -> Option<&str> {
    let is_part = path.extension().is_some_and(|ending| ending == ENDING);
    is_part.then(|| path.file_stem()?.to_str()).flatten()
}

impl Part {
    /// Writes the part of a shard into a folder of parts, whole or not at all. If another process
    /// has written it meanwhile, with the same bytes, nothing is done.
    ///
    /// # Errors
    /// It cannot be written, or there is one with other bytes.
    pub fn write(&self, parts: &Path, shard: &str) -> Result<(), PartError> {
        let bytes = self.to_bytes(shard)?;
        let path = part_path(parts, shard);
        match write_new(&path, &bytes) {
            Ok(()) => Ok(()),
            // Another process was faster. The same bytes are the expected case; other bytes show
            // that the processor class does not determine them.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                let there = read_bytes(&path)?;
                if there == bytes {
                    Ok(())
                } else {
                    Err(PartError::Differs { path })
                }
            }
            Err(source) => Err(PartError::Io {
                action: "write",
                path,
                source,
            }),
        }
    }

    fn to_bytes(&self, shard: &str) -> Result<Vec<u8>, PartError> {
        let document = document_to_string(&self.document).map_err(|source| PartError::Write {
            shard: shard.to_owned(),
            source,
        })?;
        // Structures of texts and whole numbers always become JSON, here and below.
        let about = serde_json::to_string(&self.about).unwrap_or_default();
        let mut body = Vec::with_capacity(about.len() + document.len() + self.forest.len());
        for section in [about.as_bytes(), document.as_bytes(), &self.forest] {
            body.extend_from_slice(section);
        }
        let header = Header {
            format: FORMAT.to_owned(),
            version: VERSION,
            shard: shard.to_owned(),
            about_bytes: about.len(),
            document_bytes: document.len(),
            forest_bytes: self.forest.len(),
            sha256: sha256_of_bytes(&body),
        };
        let mut bytes = serde_json::to_string(&header)
            .unwrap_or_default()
            .into_bytes();
        bytes.push(b'\n');
        bytes.append(&mut body);
        Ok(bytes)
    }

    /// Reads the part of a shard.
    ///
    /// # Errors
    /// [`PartError::Missing`] if it is not there; else it cannot be read, or is not the whole part
    /// of this shard.
    pub fn read(parts: &Path, shard: &str) -> Result<Self, PartError> {
        let path = part_path(parts, shard);
        let bytes = read_bytes(&path)?;
        let sections = Sections::split(&path, &bytes, shard)?;
        let about = serde_json::from_slice(sections.about)
            .map_err(|_| PartError::NotAPart { path: path.clone() })?;
        let document =
            document_from_bytes(sections.document).map_err(|source| PartError::Read {
                path: path.clone(),
                source,
            })?;
        Ok(Self {
            about,
            document,
            forest: sections.forest.to_vec(),
        })
    }
}

/// Whether the whole part of a shard is there.
///
/// # Errors
/// There is a file in its place that is not the whole part of this shard.
pub fn is_part_whole(parts: &Path, shard: &str) -> Result<bool, PartError> {
    let path = part_path(parts, shard);
    match read_bytes(&path) {
        Ok(bytes) => Sections::split(&path, &bytes, shard).map(|_| true),
        Err(PartError::Missing { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// The checked sections of a part's bytes.
struct Sections<'a> {
    about: &'a [u8],
    document: &'a [u8],
    forest: &'a [u8],
}

impl<'a> Sections<'a> {
    fn split(path: &Path, bytes: &'a [u8], shard: &str) -> Result<Self, PartError> {
        let not_a_part = || PartError::NotAPart {
            path: path.to_path_buf(),
        };
        // The order of the checks gives the most telling error: what is no part, then a part of
        // another shard, then one that is not whole. Only after the lengths agree is the hash worth
        // its time.
        let end = bytes
            .iter()
            .take(MAX_HEADER_BYTES)
            .position(|byte| *byte == b'\n');
        let end = end.ok_or_else(not_a_part)?;
        let header: Header = serde_json::from_slice(&bytes[..end]).map_err(|_| not_a_part())?;
        if header.format != FORMAT || header.version != VERSION {
            return Err(not_a_part());
        }
        if header.shard != shard {
            return Err(PartError::OtherShard {
                path: path.to_path_buf(),
                found: header.shard,
            });
        }
        let body = &bytes[end + 1..];
        // Lengths come from the file and may be any numbers; their sum must not overflow.
        let stated = header
            .about_bytes
            .saturating_add(header.document_bytes)
            .saturating_add(header.forest_bytes);
        if body.len() != stated {
            return Err(PartError::CutOff {
                path: path.to_path_buf(),
                found: bytes.len(),
                stated: stated.saturating_add(end + 1),
            });
        }
        if sha256_of_bytes(body) != header.sha256 {
            return Err(PartError::Damaged {
                path: path.to_path_buf(),
            });
        }
        // The lengths add up to the body's, so neither cut is beyond its end.
        let (about, rest) = body.split_at(header.about_bytes);
        let (document, forest) = rest.split_at(header.document_bytes);
        Ok(Self {
            about,
            document,
            forest,
        })
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, PartError> {
    read_named(path, MAX_BYTES).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => PartError::Missing {
            path: path.to_path_buf(),
        },
        _ => PartError::Io {
            action: "read",
            path: path.to_path_buf(),
            source,
        },
    })
}

impl Cost {
    /// States the cost of a shard beside its part. A folder that refuses it has one number less.
    pub fn write(self, parts: &Path, shard: &str) {
        if let Ok(text) = serde_json::to_string(&self) {
            let path = parts.join(format!("{shard}.{COST_ENDING}"));
            let _ = touchline_documents::store::write_atomically(&path, text.as_bytes());
        }
    }

    /// The stated cost of a shard; none if there is none.
    pub fn read(parts: &Path, shard: &str) -> Option<Self> {
        let bytes = fs::read(parts.join(format!("{shard}.{COST_ENDING}"))).ok()?;
        serde_json::from_slice(&bytes).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::soccer_document;

    fn part() -> Part {
        Part {
            about: AboutPart {
                reason: None,
                cameras_of_frames: vec![CameraRun {
                    first: 0,
                    camera: "main".to_owned(),
                }],
            },
            document: soccer_document(),
            forest: vec![0, 159, 146, 150],
        }
    }

    #[test]
    fn a_part_reads_as_it_was_written_and_a_second_writer_is_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let (parts, part) = (folder.path(), part());
        assert!(!is_part_whole(parts, "a1").unwrap());
        part.write(parts, "a1").unwrap();
        assert!(is_part_whole(parts, "a1").unwrap());
        assert_eq!(Part::read(parts, "a1").unwrap(), part);
        let bytes = fs::read(part_path(parts, "a1")).unwrap();
        part.write(parts, "a1").unwrap();
        let other = Part {
            forest: Vec::new(),
            ..part
        };
        let refusal = other.write(parts, "a1").unwrap_err();
        assert!(matches!(refusal, PartError::Differs { .. }), "{refusal}");
        assert_eq!(fs::read(part_path(parts, "a1")).unwrap(), bytes);
        assert_eq!(fs::read_dir(parts).unwrap().count(), 1);
        assert_eq!(shard_of_path(&part_path(parts, "a1")), Some("a1"));
        assert_eq!(shard_of_path(Path::new("a1.cost")), None);
    }

    #[test]
    fn no_part_that_is_not_whole_is_used() {
        let folder = tempfile::tempdir().unwrap();
        let parts = folder.path();
        part().write(parts, "a1").unwrap();
        let path = part_path(parts, "a1");
        let whole = fs::read(&path).unwrap();
        let said_of = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            let refusal = Part::read(parts, "a1").unwrap_err().to_string();
            assert_eq!(is_part_whole(parts, "a1").unwrap_err().to_string(), refusal);
            refusal
        };
        for length in 0..whole.len() {
            let refusal = said_of(&whole[..length]);
            let is_named = refusal.contains("is cut off") || refusal.contains("is not a part");
            assert!(is_named, "{length}: {refusal}");
        }
        let mut damaged = whole.clone();
        *damaged.last_mut().unwrap() ^= 1;
        assert!(said_of(&damaged).contains("is damaged"));
        let mut longer = whole;
        longer.push(0);
        assert!(said_of(&longer).contains("is cut off"));
        fs::remove_file(&path).unwrap();
        part().write(parts, "b2").unwrap();
        fs::rename(part_path(parts, "b2"), &path).unwrap();
        let refusal = Part::read(parts, "a1").unwrap_err().to_string();
        assert!(
            refusal.contains("is the part of another shard, b2,"),
            "{refusal}"
        );
    }
}
