//! The folder of a match or a broadcast that is being drawn.

use crate::cli::terminal::output::{refuse_existing, refuse_file, write_file};
use anyhow::{Context as _, bail};
use std::fs;
use std::path::Path;
use touchline_documents::document::{Document, document_to_string};
use touchline_documents::store::PROJECT_FILE;

/// The file beside the project with the exact cameras.
pub const TRUTH_FILE: &str = "truth.json";

/// The file that marks a folder while a match is drawn in it. One that was stopped leaves it, so
/// that another run may draw over what is there.
const UNFINISHED_FILE: &str = "synth.unfinished";

/// The folder of a match that is being drawn.
pub struct DrawnFolder<'a> {
    path: &'a Path,
    force: bool,
}

impl<'a> DrawnFolder<'a> {
    /// Makes the folder and marks it as unfinished.
    ///
    /// # Errors
    /// It has other content, or something and `force` is not set, or it cannot be made.
    pub fn begin(path: &'a Path, force: bool) -> anyhow::Result<Self> {
        refuse_existing(path, force)?;
        refuse_file(path, "the match")?;
        refuse_other_project(path)?;
        fs::create_dir_all(path).with_context(|| format!("cannot make {}", path.display()))?;
        write_file(&path.join(UNFINISHED_FILE), b"", true)?;
        Ok(Self { path, force })
    }

    /// Writes the truth, in place of an earlier one.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_truth(&self, document: &Document) -> anyhow::Result<()> {
        // An earlier truth is a document, which no other file replaces: it goes first.
        let truth = self.path.join(TRUTH_FILE);
        if self.force && truth.is_file() {
            fs::remove_file(&truth)
                .with_context(|| format!("cannot replace {}", truth.display()))?;
        }
        write_file(&truth, document_to_string(document)?.as_bytes(), false)
    }

    /// Takes the mark away.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn finish(self) -> anyhow::Result<()> {
        let unfinished = self.path.join(UNFINISHED_FILE);
        fs::remove_file(&unfinished)
            .with_context(|| format!("cannot remove {}", unfinished.display()))
    }
}

/// Refuses a folder with a project that this command did not draw: pictures of a drawn match could
/// overwrite the project's.
fn refuse_other_project(folder: &Path) -> anyhow::Result<()> {
    let is_drawn = [TRUTH_FILE, UNFINISHED_FILE]
        .into_iter()
        .any(|name| folder.join(name).is_file());
    if is_drawn {
        return Ok(());
    }
    let other = [PROJECT_FILE, "images"]
        .into_iter()
        .find(|name| folder.join(name).exists());
    if let Some(name) = other {
        bail!(
            "{} holds {name}, which was not drawn by this program; give another folder",
            folder.display()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_was_stopped_may_be_drawn_over_and_a_users_pictures_may_not() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("images")).unwrap();
        let refused = refuse_other_project(folder.path()).unwrap_err().to_string();
        assert!(
            refused.contains("holds images, which was not drawn"),
            "{refused}"
        );
        // As a run leaves the folder that ended before it wrote the truth.
        fs::write(folder.path().join(UNFINISHED_FILE), "").unwrap();
        assert!(refuse_other_project(folder.path()).is_ok());
    }
}
