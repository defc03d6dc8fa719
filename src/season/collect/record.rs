//! The record of a collected season: what was written there, and from which frames.
//!
//! Other files may lie in the folder under the same names, and a person may edit those of the
//! program. A file is the program's own only while its bytes are those that the record states, and
//! a project is untouched only while its document is the one that was written. Contents are
//! recorded before they are written, so that a collection that is killed leaves nothing that looks
//! like a person's.

use super::CollectError;
use crate::plan::PlannedMatch;
use crate::season_file::{QUEUE_FILE, RECORD_FILE, TABLE_FILES};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use touchline_core::files::read_named_text;
use touchline_documents::document::{Document, document_to_string};
use touchline_documents::store::{PROJECT_FILE, write_atomically};
use touchline_vision::media::{sha256_of_bytes, sha256_of_file};

/// The value of `format` in every record.
const FORMAT: &str = "touchline collected season";
/// The version of records that this program writes and reads.
const VERSION: u64 = 1;
/// Maximum size of a record, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// What was written into the folder of a season.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    format: String,
    version: u64,
    /// SHA-256 of each file beside the matches; of two contents while one replaces the other.
    files: BTreeMap<String, BTreeSet<String>>,
    /// The matches by the names of their folders, those that are no longer in the plan included.
    matches: BTreeMap<String, RecordedMatch>,
}

/// A match that was collected.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordedMatch {
    /// The hash of its frames, as in the plan.
    frames_sha256: String,
    /// SHA-256 of its document as written; of two while one replaces the other.
    documents: BTreeSet<String>,
}

impl Record {
    /// Reads the record of a folder, and refuses a folder in which a file of a person would be
    /// replaced.
    ///
    /// # Errors
    /// The folder holds other things than a collected season, or a file that is not as it was
    /// written.
    pub(super) fn from_folder(output: &Path) -> Result<Self, CollectError> {
        let path = output.join(RECORD_FILE);
        let text = match read_named_text(&path, MAX_BYTES) {
            Ok(text) => Some(text),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(source) => return Err(CollectError::from_io("read", &path, source)),
        };
        let record = match text {
            Some(text) => serde_json::from_str(&text)
                .ok()
                .filter(|record: &Self| record.format == FORMAT && record.version == VERSION)
                .ok_or(CollectError::OtherFile { path })?,
            None => Self::new(),
        };
        for name in [QUEUE_FILE].iter().chain(&TABLE_FILES) {
            let path = output.join(name);
            if path.exists() && !record.is_own(name, &path) {
                return Err(CollectError::OtherFile { path });
            }
        }
        Ok(record)
    }

    fn new() -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            files: BTreeMap::new(),
            matches: BTreeMap::new(),
        }
    }

    /// Whether a file is as it was written.
    fn is_own(&self, name: &str, path: &Path) -> bool {
        let known = self.files.get(name);
        let hash = sha256_of_file(path);
        hash.is_ok_and(|hash| known.is_some_and(|known| known.contains(&hash)))
    }

    /// Writes a file beside the matches.
    pub(super) fn write_file(
        &mut self,
        output: &Path,
        name: &str,
        text: &str,
    ) -> Result<(), CollectError> {
        let hash = sha256_of_bytes(text.as_bytes());
        let known = self.files.entry(name.to_owned()).or_default();
        known.insert(hash.clone());
        self.write(output)?;
        let path = output.join(name);
        write_atomically(&path, text.as_bytes())
            .map_err(|source| CollectError::from_io("write", &path, source))?;
        self.files.insert(name.to_owned(), BTreeSet::from([hash]));
        Ok(())
    }

    /// Records that the project in a folder is that of a match.
    pub(super) fn remember(&mut self, folder: &str, planned: &PlannedMatch) {
        let recorded = self.matches.entry(folder.to_owned()).or_default();
        recorded.frames_sha256.clone_from(&planned.frames_sha256);
    }

    /// Records the document of a match that is about to be written.
    pub(super) fn announce(
        &mut self,
        output: &Path,
        folder: &str,
        document: &Document,
    ) -> Result<(), CollectError> {
        let recorded = self.matches.entry(folder.to_owned()).or_default();
        recorded.documents.extend(hash_of(document));
        self.write(output)
    }

    /// Records that the document of a match is on the disk, which the record's file states from its
    /// next writing on.
    pub(super) fn confirm(&mut self, folder: &str, document: &Document) {
        if let Some(recorded) = self.matches.get_mut(folder) {
            recorded.documents = hash_of(document).into_iter().collect();
        }
    }

    /// Writes the record.
    pub(super) fn write(&self, output: &Path) -> Result<(), CollectError> {
        let path = output.join(RECORD_FILE);
        // Texts and numbers always become JSON.
        let text = serde_json::to_string_pretty(self).unwrap_or_default() + "\n";
        write_atomically(&path, text.as_bytes())
            .map_err(|source| CollectError::from_io("write", &path, source))
    }

    /// Whether a document is as it was written, whatever its folder was called then.
    pub(super) fn is_untouched(&self, document: &Document) -> bool {
        let hash = hash_of(document);
        let mut written = self.matches.values().map(|recorded| &recorded.documents);
        hash.is_some_and(|hash| written.any(|documents| documents.contains(&hash)))
    }

    /// The folder of a match: that of its name, unless its frames were collected under a name that
    /// the plan no longer has.
    pub(super) fn folder_of(
        &self,
        output: &Path,
        planned: &PlannedMatch,
        in_plan: &BTreeSet<&str>,
    ) -> String {
        let is_collected = |folder: &str| project_in(output, folder).exists();
        let earlier = self.matches.iter().find(|(folder, recorded)| {
            recorded.frames_sha256 == planned.frames_sha256
                && !in_plan.contains(folder.as_str())
                && is_collected(folder)
        });
        match earlier {
            Some((folder, _)) if !is_collected(&planned.name) => folder.clone(),
            _ => planned.name.clone(),
        }
    }

    /// Why the project in the folder of a match is not that of the match; none if it is.
    pub(super) fn why_foreign(
        &self,
        folder: &str,
        planned: &PlannedMatch,
        is_video: bool,
    ) -> Option<String> {
        // A folder that was renamed as its match was is known by the frames. A folder of images may
        // grow; each of them has a hash of its own.
        let of_frames = |recorded: &RecordedMatch| recorded.frames_sha256 == planned.frames_sha256;
        if self.matches.values().any(of_frames) {
            return None;
        }
        match self.matches.get(folder) {
            Some(_) if is_video => Some(format!(
                "{} is another video than when it was collected; move its folder away to collect \
                 it anew",
                planned.frames_name
            )),
            Some(_) => None,
            None => Some("it was not collected here; move its folder away".to_owned()),
        }
    }

    /// The folders of matches that are in use by no match of the plan.
    pub(super) fn folders_beside(&self, output: &Path, used: &BTreeSet<String>) -> Vec<String> {
        let beside = self.matches.keys().filter(|folder| !used.contains(*folder));
        beside
            .filter(|folder| project_in(output, folder).exists())
            .cloned()
            .collect()
    }
}

/// The project in a match's folder.
fn project_in(output: &Path, folder: &str) -> PathBuf {
    output.join(folder).join(PROJECT_FILE)
}

/// The hash of a document as it is written; none of one that cannot be.
fn hash_of(document: &Document) -> Option<String> {
    let text = document_to_string(document).ok()?;
    Some(sha256_of_bytes(text.as_bytes()))
}
