//! Own versions: the document of this program, kept beside a document that another program changed
//! meanwhile, so that both can be merged later. It is written as `project.json.mine-N`, and the
//! common base of both versions as `project.json.mine-N.base`.
//!
//! The journal cannot replace it: it contains only the edits since the document was last written
//! whole, and starts from a version that is no longer on disk.

use super::atomic::{file_name, with_suffix, write_atomically, write_new_as};
use super::journal::{DocumentHash, hash_of};
use super::{Location, Orphan, OrphanEdits, StoreError};
use crate::document::{Change, Document, Edit, Frames, document_from_bytes, document_to_string};
use std::fs;
use std::path::{Path, PathBuf};
use touchline_core::files::read_regular;

/// The word between the document's name and the number.
const WORD: &str = "mine";
/// The suffix of the common base.
const BASE: &str = ".base";

/// The own version, as written beside the document.
#[derive(Debug)]
pub(super) struct OwnVersion {
    orphan: Orphan,
    hash: DocumentHash,
    /// Whether it contains all edits of the journal.
    pub is_whole: bool,
}

impl OwnVersion {
    /// Writes the own version. Replaces the `earlier` one if its file still exists. None if `own`
    /// has no edit that `base` lacks.
    pub fn write(
        earlier: Option<&Self>,
        location: &Location,
        base: &Document,
        own: &Document,
    ) -> Result<Option<Self>, StoreError> {
        let edits = names_of_edits(base, own);
        if edits.is_empty() {
            return Ok(None);
        }
        // The user may have put the earlier file away meanwhile. Both texts are made before either
        // file is written, so that a document that cannot be serialised leaves the earlier version
        // as it is.
        let path = earlier
            .map(|earlier| earlier.orphan.path.clone())
            .filter(|path| path.exists());
        let texts = document_to_string(own).and_then(|text| Ok((text, document_to_string(base)?)));
        let (text, base_text) =
            texts.map_err(|source| StoreError::from_write(location.file(), source))?;
        let io = |source| StoreError::from_io("write", location.file(), source);
        let path = match path {
            Some(path) => {
                write_atomically(&path, text.as_bytes()).map_err(io)?;
                path
            }
            None => write_new_as(location.file(), WORD, "", text.as_bytes()).map_err(io)?,
        };
        write_atomically(&base_of(&path), base_text.as_bytes()).map_err(io)?;
        Ok(Some(Self {
            orphan: Orphan { path, edits },
            hash: hash_of(text.as_bytes()),
            is_whole: true,
        }))
    }

    /// Its entry in the list of orphans.
    pub fn as_orphan(&self) -> Orphan {
        self.orphan.clone()
    }

    /// The hash of its file.
    pub const fn hash(&self) -> &DocumentHash {
        &self.hash
    }

    /// Deletes the files, after the document was written with its edits.
    pub fn remove(self) {
        for path in [base_of(&self.orphan.path), self.orphan.path] {
            if let Err(error) = fs::remove_file(&path) {
                log::warn!("{}: {error}", path.display());
            }
        }
    }
}

/// Whether a file beside a document is an own version.
pub(super) fn is_own_version(location: &Location, path: &Path) -> bool {
    let prefix = format!("{}.{WORD}-", file_name(location.file()));
    let name = file_name(path);
    name.strip_prefix(&prefix)
        .is_some_and(|number| number.parse::<u32>().is_ok())
}

/// Reads an own version as a single edit from its base. Without the base file, the edit starts from
/// a document without frames and cameras.
pub(super) fn read_own_version(path: &Path) -> Result<OrphanEdits, StoreError> {
    let own = read_version(path)?;
    let base = read_version(&base_of(path)).ok();
    let edit = Edit::between(
        base.as_ref().unwrap_or(&without_frames(&own)),
        &own,
        "Everything",
    );
    Ok(OrphanEdits {
        base,
        edits: vec![edit],
    })
}

/// Its entry in the list of orphans; none if it cannot be read or has no edit that its base lacks.
pub(super) fn list_own_version(path: PathBuf) -> Option<Orphan> {
    let own = read_version(&path).ok()?;
    let edits = names_of_edits(
        &read_version(&base_of(&path)).unwrap_or_else(|_| without_frames(&own)),
        &own,
    );
    (!edits.is_empty()).then_some(Orphan { path, edits })
}

/// The path of an own version's base.
pub(super) fn base_of(path: &Path) -> PathBuf {
    with_suffix(path, BASE)
}

fn read_version(path: &Path) -> Result<Document, StoreError> {
    let bytes = read_regular(path).map_err(|source| StoreError::from_io("read", path, source))?;
    let path = path.to_path_buf();
    document_from_bytes(&bytes).map_err(|source| StoreError::Read {
        path,
        source,
        backup: None,
    })
}

/// The assumed base of an own version without a base file.
fn without_frames(own: &Document) -> Document {
    Document {
        cameras: Vec::new(),
        frames: Frames::new(),
        ..own.clone()
    }
}

/// Descriptions of the user's changes from `base` to `own`. Suggestions are left out: they are made
/// again, and are no work that could be lost.
fn names_of_edits(base: &Document, own: &Document) -> Vec<String> {
    let [base, own] = [base, own].map(Document::without_suggestions);
    let mut names = Vec::new();
    for change in &Edit::between(&base, &own, "").changes {
        match change {
            Change::Frame { frame, .. } => names.push(format!("Changes in {}", frame.name())),
            Change::Insert { frames, .. } => {
                names.extend(
                    frames
                        .iter()
                        .map(|frame| format!("New frame {}", frame.name())),
                );
            }
            Change::Remove(frames) => names.push(format!("Frames removed: {}", frames.len())),
            Change::Cameras(_) => names.push("Changes in the cameras".to_owned()),
            Change::Field(_) => names.push("Changes in the field".to_owned()),
            Change::Order(_) => names.push("Another order of the frames".to_owned()),
            Change::Rest { .. } => names.push("Changes in the document".to_owned()),
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{new_frame, soccer_document};
    use touchline_core::geometry::ImageSize;

    fn document() -> Document {
        let mut document = soccer_document();
        let frame = |name: &str| new_frame(name, ImageSize::new(64, 48)).into();
        document.frames = ["a.jpg", "b.jpg"].into_iter().map(frame).collect();
        document
    }

    #[test]
    fn what_a_window_held_is_written_once_and_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let location = Location::for_new_document(&folder.path().join("project.json")).unwrap();
        let (base, mut own) = (document(), document());
        assert!(
            OwnVersion::write(None, &location, &base, &own)
                .unwrap()
                .is_none(),
            "nothing of its own"
        );
        own.frames[1].comment = Some("mine".to_owned());
        let version = OwnVersion::write(None, &location, &base, &own)
            .unwrap()
            .unwrap();
        let path = version.as_orphan().path;
        assert!(path.ends_with("project.json.mine-1") && is_own_version(&location, &path));
        assert!(!is_own_version(&location, &base_of(&path)));
        own.frames[0].comment = Some("more".to_owned());
        let version = OwnVersion::write(Some(&version), &location, &base, &own)
            .unwrap()
            .unwrap();
        assert_eq!(version.as_orphan(), list_own_version(path.clone()).unwrap());
        assert_eq!(
            version.as_orphan().edits,
            ["Changes in a.jpg", "Changes in b.jpg"]
        );
        let read = read_own_version(&path).unwrap();
        assert_eq!(read.merge_with(&base).document.frames, own.frames);
        fs::remove_file(base_of(&path)).unwrap();
        assert_eq!(
            read_own_version(&path)
                .unwrap()
                .merge_with(&base)
                .document
                .frames[0]
                .comment,
            own.frames[0].comment
        );
        version.remove();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
