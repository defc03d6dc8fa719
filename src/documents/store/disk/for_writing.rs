//! Reading a document in order to write it: the lock is held from the reading to the writing, and
//! the file is replaced only if it is still the one that was read, or if the result can be joined
//! with what it has become.

use super::{Access, Opened, Recovery, Store, open};
use crate::document::{Document, EditKind, History, Merged, document_to_string, join_result};
use crate::store::atomic::write_new_as;
use crate::store::{Location, StoreError};
use std::path::Path;

/// A document that was read in order to be written. No other instance of this program can write it
/// until this is dropped.
#[derive(Debug)]
pub struct OpenForWriting {
    /// The document's location.
    pub location: Location,
    /// The document as it was read, including the edits of its journal.
    pub document: Document,
    /// What was recovered from the journal.
    pub recovery: Recovery,
    history: History<Document>,
    store: Store,
}

/// Reads a document in order to write it, and locks it until then.
///
/// # Errors
/// There is no document, it cannot be read, it is open in another program, or it is
/// write-protected.
pub fn open_for_writing(path: &Path) -> Result<OpenForWriting, StoreError> {
    let Opened {
        location,
        document,
        history,
        access,
        recovery,
    } = open(path)?;
    match access {
        Access::Writable(store) => Ok(OpenForWriting {
            location,
            document,
            recovery,
            history,
            store,
        }),
        Access::ReadOnly(reason) => Err(StoreError::ReadOnly {
            path: location.file().to_path_buf(),
            reason,
        }),
    }
}

impl OpenForWriting {
    /// Writes what became of the document. The edits of the journal that was read are in it, so
    /// that the journal ends. Where there are steps to undo, this is one more, called `name`.
    ///
    /// Programs that do not respect the lock may have changed the file meanwhile. Then frames that
    /// are as they were read take the result, and all others stay; the names of frames whose
    /// result was left out are returned.
    ///
    /// # Errors
    /// It cannot be written, or cannot be joined with what the file has become. The result is then
    /// kept beside the file.
    pub fn commit(mut self, result: &Document, name: &str) -> Result<Vec<String>, StoreError> {
        // Before it is compared: a file that is replaced after that is another one below.
        let on_disk = self.store.hash_on_disk()?;
        let (document, history, conflicts) = match self.store.since() {
            Ok(None) => {
                let history = self.followed_history(result, name);
                (result.clone(), history, Vec::new())
            }
            Ok(Some(outside)) => match join_result(&self.document, result, &outside.theirs) {
                // The steps start from the document that was read, which is in no file any more.
                Some(Merged {
                    document,
                    conflicts,
                }) => (document, Some(History::default()), conflicts),
                None => return Err(self.write_beside(result)),
            },
            // What cannot be read cannot be joined.
            Err(_) => return Err(self.write_beside(result)),
        };
        match self
            .store
            .write(&document, history.as_ref(), on_disk.as_ref())
        {
            Err(StoreError::ChangedOutside { .. }) => Err(self.write_beside(result)),
            written => written.map(|()| conflicts),
        }
    }

    /// The steps that can be undone, with the one to the result; none if there are none.
    fn followed_history(&self, result: &Document, name: &str) -> Option<History<Document>> {
        if self.history.is_empty() {
            return None;
        }
        let mut history = self.history.clone();
        let [before, after] = [&self.document, result].map(Document::without_suggestions);
        let step = EditKind::Step { frame: None };
        history.follow([&before, &after], Vec::new(), name.to_owned(), step);
        Some(history)
    }

    /// Writes the result as a new file, and says so.
    fn write_beside(&self, result: &Document) -> StoreError {
        let path = self.location.file();
        let text = match document_to_string(result) {
            Ok(text) => text,
            Err(source) => return StoreError::from_write(path, source),
        };
        match write_new_as(path, "result", ".json", text.as_bytes()) {
            Ok(beside) => StoreError::WrittenBeside {
                path: path.to_path_buf(),
                beside,
            },
            Err(source) => StoreError::from_io("write", path, source),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Edit, Step};
    use crate::store::{orphans, read, write_document};
    use crate::testing::{document, names_and_comments};
    use std::fs;
    use tempfile::TempDir;

    fn commented(document: &Document, frame: usize, comment: &str) -> Document {
        let mut commented = document.clone();
        commented.frames[frame].comment = Some(comment.to_owned());
        commented.count_edits_since(document);
        commented
    }

    /// A project of two frames.
    fn project() -> (TempDir, Location) {
        let folder = tempfile::tempdir().unwrap();
        let location = Location::for_new_document(&folder.path().join("project.json")).unwrap();
        write_document(&location, &document(&["a", "b"]), false).unwrap();
        (folder, location)
    }

    fn put(location: &Location, document: &Document) {
        fs::write(location.file(), document_to_string(document).unwrap()).unwrap();
    }

    fn files(folder: &TempDir) -> Vec<String> {
        let entries = fs::read_dir(folder.path()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    #[test]
    fn a_document_is_locked_from_reading_to_writing() {
        let (folder, location) = project();
        let opened = open_for_writing(folder.path()).unwrap();
        assert!(matches!(
            open(folder.path()).unwrap().access,
            Access::ReadOnly(_)
        ));
        assert!(open_for_writing(folder.path()).is_err());
        let result = commented(&opened.document, 0, " mended");
        assert_eq!(opened.commit(&result, "Solve").unwrap(), [""; 0]);
        let now = read(folder.path()).unwrap().1;
        assert_eq!(names_and_comments(&now), ["a mended", "b"]);
        assert_eq!(files(&folder), ["project.json", "project.json.bak"]);
        // Without a result nothing stays either.
        drop(open_for_writing(location.file()).unwrap());
        assert_eq!(files(&folder), ["project.json", "project.json.bak"]);
    }

    #[test]
    fn edits_of_a_journal_that_was_read_are_written_and_not_set_aside() {
        let (folder, location) = project();
        let before = read(folder.path()).unwrap().1;
        let after = commented(&before, 1, " of a session that was killed");
        {
            let opened = open_for_writing(folder.path()).unwrap();
            let mut store = std::mem::ManuallyDrop::new(opened.store);
            store
                .append(&[Edit::between(&before, &after, "Comment")])
                .unwrap();
            // A killed process leaves its files, and the system takes its lock.
            fs::remove_file(location.lock()).unwrap();
        }
        let opened = open_for_writing(folder.path()).unwrap();
        assert_eq!(opened.recovery.edits, ["Comment"]);
        let result = commented(&opened.document, 0, " mended");
        opened.commit(&result, "Solve").unwrap();
        assert_eq!(orphans(&location), []);
        let (_, now, recovery) = read(folder.path()).unwrap();
        assert!(recovery.is_empty(), "{recovery:?}");
        assert_eq!(
            names_and_comments(&now),
            ["a mended", "b of a session that was killed"]
        );
    }

    #[test]
    fn what_another_program_wrote_meanwhile_stays() {
        let (folder, location) = project();
        let opened = open_for_writing(folder.path()).unwrap();
        let read_state = opened.document.clone();
        let result = commented(&commented(&read_state, 0, " mended"), 1, " mended");
        put(&location, &commented(&read_state, 1, " of a person"));
        assert_eq!(opened.commit(&result, "Solve").unwrap(), ["b"]);
        let now = read(folder.path()).unwrap().1;
        assert_eq!(names_and_comments(&now), ["a mended", "b of a person"]);
    }

    #[test]
    fn a_result_that_cannot_be_joined_lies_beside() {
        let (folder, location) = project();
        let opened = open_for_writing(folder.path()).unwrap();
        let mut theirs = opened.document.clone();
        theirs.field.template = "futsal".to_owned();
        put(&location, &theirs);
        let result = commented(&opened.document, 0, " mended");
        let said = opened.commit(&result, "Solve").unwrap_err().to_string();
        assert!(said.contains("project.json.result-1.json"), "{said}");
        assert_eq!(read(folder.path()).unwrap().1.field.template, "futsal");
        let beside = folder.path().join("project.json.result-1.json");
        assert_eq!(names_and_comments(&read(&beside).unwrap().1)[0], "a mended");
    }

    #[test]
    fn a_command_is_a_step_that_can_be_undone() {
        let (folder, location) = project();
        let Opened {
            document, access, ..
        } = open(folder.path()).unwrap();
        let Access::Writable(mut store) = access else {
            panic!("{access:?}")
        };
        let mut history = History::default();
        history.begin(&document, Step::on_document("Comment"));
        let first = commented(&document, 0, " one");
        history.commit(&first);
        store.save(&first, &history).unwrap();
        drop(store);
        let opened = open_for_writing(location.file()).unwrap();
        let result = commented(&opened.document, 1, " two");
        opened.commit(&result, "Solve").unwrap();
        let mut reopened = open(folder.path()).unwrap();
        assert!(reopened.recovery.is_empty(), "{:?}", reopened.recovery);
        let mut state = reopened.document.clone();
        let undone = reopened
            .history
            .undo(&mut state)
            .map(|step| step.name.clone());
        assert_eq!(undone.as_deref(), Some("Solve"));
        assert_eq!(names_and_comments(&state), ["a one", "b"]);
    }
}
