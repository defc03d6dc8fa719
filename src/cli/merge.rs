//! `touchline merge`: joins several people's versions of one document.

use super::Outcome;
use super::document::{DocumentOutput, Loaded};
use super::messages::Messages;
use anyhow::Context as _;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Document, Frames, Merged, merge as merge_documents};
use touchline_documents::exchange::restore_version;
use touchline_documents::store;

/// Extension of the file with the versions that were not taken.
const CONFLICTS: &str = "conflicts.json";

/// Joins what several people made of one document.
///
/// A frame or camera that one of them changed is taken from that one. What two of them changed
/// differently is listed, exit 1: the first one's stays, and the other's frames are written to a
/// document beside the result (….conflicts.json). Packages of `touchline split` are taken as they
/// come back.
#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// The document that all of them started from.
    #[arg(value_name = "BASE")]
    base: PathBuf,
    /// What each of them made of it, or of a package of it.
    #[arg(value_name = "VERSION", required = true, num_args = 2..)]
    versions: Vec<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
}

/// Merges the versions one after the other and writes the result. [`Outcome::SomeFailed`] if two
/// versions conflict.
///
/// # Errors
/// A document cannot be read, or the result cannot be written.
pub fn merge(args: &MergeArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded {
        location,
        document: base,
    } = Loaded::read(&args.base, messages)?;
    let folder = location.folder();
    // The first version is the result so far; every further one is merged into it.
    let mut merged: Option<Document> = None;
    let mut not_taken = ConflictingVersions::default();
    for path in &args.versions {
        let version = read_version(&base, folder, path, messages)?;
        let Some(ours) = merged.take() else {
            merged = Some(version);
            continue;
        };
        let Merged {
            document,
            conflicts,
        } = merge_documents(&base, &ours, &version);
        for conflict in &conflicts {
            messages.frame_failed(
                conflict,
                &format!(
                    "{} has it otherwise; what came before it stays",
                    path.display()
                ),
            );
        }
        not_taken.add(&version, conflicts);
        merged = Some(document);
    }
    let merged = merged.context("give at least one version")?;
    let frames = merged.frames.len();
    args.output.write(merged, folder)?;
    messages.note(&format!(
        "{} of {} versions, {}",
        pluralise(frames, "frame"),
        args.versions.len(),
        pluralise(not_taken.names.len(), "conflict")
    ));
    // Write what was not taken beside the result, so that nothing is lost.
    let Some(others) = not_taken.document else {
        return Ok(Outcome::Done);
    };
    if let Some(beside) = args.output.output.as_deref().map(beside) {
        let said = beside.display().to_string();
        DocumentOutput {
            output: Some(beside),
            force: args.output.force,
        }
        .write(others, folder)?;
        messages.note(&format!(
            "the other versions of what two changed are in {said}"
        ));
    }
    Ok(Outcome::SomeFailed)
}

/// Reads a version. Its relative paths are changed to start from the base's folder, and a package
/// gets the frames of the base that it lacks.
fn read_version(
    base: &Document,
    folder: &Path,
    path: &Path,
    messages: Messages,
) -> anyhow::Result<Document> {
    let Loaded { location, document } = Loaded::read(path, messages)?;
    let moved = restore_version(base.at(folder), &document)?;
    // Frames of the base have the base's paths already; only new frames need relocation.
    let mut relocated = moved.clone().relocate(location.folder(), folder);
    for frame in &mut relocated.frames {
        if let Some(known) = base
            .frames
            .by_id(&frame.id)
            .and_then(|_| moved.frames.by_id(&frame.id))
        {
            *frame = known.clone();
        }
    }
    Ok(Document {
        field: moved.field,
        cameras: moved.cameras,
        ..relocated
    })
}

/// The conflicting versions that were not taken.
#[derive(Default)]
struct ConflictingVersions {
    names: BTreeSet<String>,
    document: Option<Document>,
}

impl ConflictingVersions {
    fn add(&mut self, version: &Document, conflicts: Vec<String>) {
        if conflicts.is_empty() {
            return;
        }
        let frames = version
            .frames
            .iter()
            .filter(|frame| conflicts.contains(&frame.name()))
            .cloned();
        // Field and cameras are those of the first version that conflicts. Frames of later versions
        // are added to them.
        let document = self.document.get_or_insert_with(|| Document {
            frames: Frames::new(),
            ..version.clone()
        });
        document.frames.extend(frames);
        self.names.extend(conflicts);
    }
}

/// The path of the conflicts file: `merged.conflicts.json` for `merged.json`,
/// `project.conflicts.json` for a project folder.
fn beside(output: &Path) -> PathBuf {
    let file = if output.is_dir() {
        output.join(store::PROJECT_FILE)
    } else {
        output.to_path_buf()
    };
    file.with_extension(CONFLICTS)
}

#[cfg(test)]
mod tests {
    use super::beside;
    use std::path::Path;

    #[test]
    fn the_other_versions_lie_beside_the_result() {
        assert_eq!(
            beside(Path::new("out/merged.json")),
            Path::new("out/merged.conflicts.json")
        );
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(
            beside(folder.path()),
            folder.path().join("project.conflicts.json")
        );
    }
}
