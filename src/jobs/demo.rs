//! A copy of the demo match for a user to try things on.

use super::JobError;
use super::opening::user_projects;
use crate::store::PROJECT_FILE;
use std::path::{Path, PathBuf};

/// The user's copy of the demo match; made when there is none yet.
///
/// # Errors
/// The demo is not to be found, or cannot be copied.
pub fn fresh_copy() -> Result<PathBuf, JobError> {
    let own = user_projects().ok_or(JobError::NoUserFolder)?.join("demo");
    if own.join(PROJECT_FILE).exists() {
        return Ok(own);
    }
    let delivered = delivered().ok_or(JobError::NoDemo)?;
    copy_folder(&delivered, &own).map_err(JobError::io(&own))?;
    Ok(own)
}

/// Where the demo lies: beside an installed program, or in the source tree it was built in.
fn delivered() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let beside = program.ancestors().skip(1).take(4);
    beside
        .flat_map(|folder| [folder.join("share/touchline/demo"), folder.join("projects/demo")])
        .find(|folder| folder.join(PROJECT_FILE).exists())
}

fn copy_folder(from: &Path, to: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            std::fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
