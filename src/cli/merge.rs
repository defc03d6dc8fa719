//! `touchline merge`: joins several people's versions of one document.

use super::Outcome;
use crate::cli::terminal::document::{Destination, DocumentOutput, Loaded};
use crate::cli::terminal::messages::Messages;
use anyhow::Context as _;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use touchline_calibration::calibrate::{SolvedAfterMerge, solve_after_merge};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Document, Merged, Restored, merge as merge_documents};
use touchline_documents::exchange::restore_version;
use touchline_documents::store;

/// Joins what several people made of one document.
///
/// A frame or camera that one of them changed is taken from that one. What two of them changed
/// differently is listed, exit 1: the first one's stays, and each other's frames are written, with
/// its cameras, to a document of its own beside the result (….conflicts.json,
/// ….conflicts2.json and so on). Frames that were solved on another base or field than the result
/// has are solved again. Packages of `touchline split` are taken as they come back: BASE may have
/// gone on since, and what was done in it counts as a change, too. A version of another match is
/// refused.
#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// The document that all of them started from, or what has become of it since.
    #[arg(value_name = "BASE")]
    base: PathBuf,
    /// What each of them made of it, or of a package of it.
    #[arg(value_name = "VERSION", required = true, num_args = 1..)]
    versions: Vec<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
}

/// Merges the versions one after the other and writes the result. [`Outcome::SomeFailed`] if two
/// versions conflict, or if frames cannot be solved on the merged base.
///
/// # Errors
/// A document cannot be read, or the result cannot be written.
pub fn merge(args: &MergeArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let mut inputs = vec![args.base.as_path()];
    inputs.extend(args.versions.iter().map(PathBuf::as_path));
    let output = args.output.reserve("merge", &inputs, messages)?;
    let Loaded {
        location,
        document: base,
    } = output.read(&args.base)?;
    let folder = location.folder();
    // The base is the result so far; every version is merged into it. Suggestions of the versions
    // come first, so that those of the base are put back at the end.
    let mut merged = base.without_suggestions();
    let mut sides = Vec::with_capacity(args.versions.len() + 1);
    let mut not_taken = ConflictingVersions::default();
    for path in &args.versions {
        let restored = read_version(&base, folder, path, &output)?;
        let side = restored.side();
        let missing = restored.missing_frames(&base);
        if missing > 0 {
            messages.note(&format!(
                "{} lacks {} in which work was done since; what was done stays",
                path.display(),
                pluralise(missing, "frame")
            ));
        }
        let Restored {
            common, version, ..
        } = restored;
        let Merged {
            document,
            conflicts,
        } = merge_documents(&common, &merged, &version);
        for conflict in &conflicts {
            messages.frame_failed(
                conflict,
                &format!(
                    "{} has it otherwise; what came before it stays",
                    path.display()
                ),
            );
        }
        not_taken.add(&version, &document, conflicts);
        merged = document;
        sides.push(side);
    }
    merged.add_suggestions_of(&base);
    sides.push(base);
    // Only after all versions are merged: a frame that is solved again would look like a change of
    // the versions so far, and conflict with the work of those that follow.
    let is_solved = solve_on_merged_base(&mut merged, &sides, folder, messages);
    drop(sides);
    let frames = merged.frames.len();
    output.write(merged, folder)?;
    messages.note(&format!(
        "{} of {} versions, {}",
        pluralise(frames, "frame"),
        args.versions.len(),
        pluralise(not_taken.names.len(), "conflict")
    ));
    // Write what was not taken beside the result, so that nothing is lost.
    if not_taken.documents.is_empty() {
        return Ok(Outcome::from_failure(!is_solved));
    }
    if let Some(output) = &args.output.output {
        let mut written = Vec::new();
        for (index, document) in not_taken.documents.into_iter().enumerate() {
            let beside = beside(output, index + 1);
            written.push(beside.display().to_string());
            let beside = DocumentOutput {
                output: Some(beside),
                force: args.output.force,
            };
            let beside = beside.reserve("merge", &[], messages)?;
            beside.write(document, folder)?;
        }
        messages.note(&format!(
            "the other versions of what two changed are in {}",
            written.join(", ")
        ));
    } else {
        messages.note("the other versions of what two changed are written only with -o");
    }
    Ok(Outcome::SomeFailed)
}

/// Solves the frames again that come from a version with another base or field than the merged
/// document has, and reports their numbers. False if they cannot be solved, which is reported, too.
fn solve_on_merged_base(
    merged: &mut Document,
    sides: &[Document],
    folder: &Path,
    messages: Messages,
) -> bool {
    let is_same = sides
        .iter()
        .all(|side| side.cameras == merged.cameras && side.field == merged.field);
    if is_same {
        return true;
    }
    let before = merged.clone();
    let sides: Vec<&Document> = sides.iter().collect();
    let solved = solve_after_merge(merged, &sides, folder);
    merged.count_edits_since(&before);
    match solved {
        Ok(SolvedAfterMerge {
            solved,
            refitted,
            withdrawn,
        }) => {
            if solved + refitted + withdrawn > 0 {
                messages.note(&format!(
                    "on the merged base or field: {} solved again, {refitted} fitted to where \
                     their lines were, {} withdrawn",
                    pluralise(solved, "frame"),
                    pluralise(withdrawn, "suggestion")
                ));
            }
            true
        }
        Err(error) => {
            messages.note(&format!(
                "frames of another base or field were not solved again: {error}; mend the field, \
                 then run touchline solve"
            ));
            false
        }
    }
}

/// Reads a version, and the state that it has in common with the base. Its relative paths are
/// changed to start from the base's folder, and a package gets the frames of the base that it lacks.
fn read_version(
    base: &Document,
    folder: &Path,
    path: &Path,
    output: &Destination,
) -> anyhow::Result<Restored> {
    let Loaded { location, document } = output.read(path)?;
    let restored =
        restore_version(base.at(folder), &document).with_context(|| path.display().to_string())?;
    let moved = restored.version;
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
        // Of suggestions only those that were made in the version are its own.
        let ours = base.frames.by_id(&frame.id);
        if frame.shows_suggestion() && ours.is_some_and(|ours| ours == frame) {
            *frame = frame.without_suggestion().into();
        }
    }
    Ok(Restored {
        common: restored.common,
        own: restored.own,
        version: Document {
            field: moved.field,
            cameras: moved.cameras,
            ..relocated
        },
    })
}

/// The conflicting versions that were not taken.
#[derive(Default)]
struct ConflictingVersions {
    names: BTreeSet<String>,
    /// For each version with conflicts a document of its frames that were not taken.
    documents: Vec<Document>,
}

impl ConflictingVersions {
    /// Adds the conflicts of a version, given what it was merged to.
    fn add(&mut self, version: &Document, merged: &Document, conflicts: Vec<String>) {
        if conflicts.is_empty() {
            return;
        }
        let conflicts: BTreeSet<String> = conflicts.into_iter().collect();
        // A conflict has the name of the frame that stays, which may have another picture.
        let frames = version.frames.iter().filter(|frame| {
            let stays = merged.frames.by_id(&frame.id);
            stays.is_some_and(|stays| conflicts.contains(&stays.name()))
        });
        // Each version has a document of its own: its frames' angles are in the bases of its
        // cameras, and its cameras, its field and its other parts may be in conflict, too.
        self.documents.push(Document {
            frames: frames.cloned().collect(),
            ..version.clone()
        });
        self.names.extend(conflicts);
    }
}

/// The path of a conflicts file, numbered from 1: `merged.conflicts.json` for `merged.json`,
/// `project.conflicts.json` for a project folder, then `merged.conflicts2.json` and so on.
fn beside(output: &Path, number: usize) -> PathBuf {
    let file = if output.is_dir() {
        output.join(store::PROJECT_FILE)
    } else {
        output.to_path_buf()
    };
    match number {
        1 => file.with_extension("conflicts.json"),
        _ => file.with_extension(format!("conflicts{number}.json")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::SIZE;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::{WithFrames, soccer_document};

    #[test]
    fn the_other_versions_lie_beside_the_result() {
        let merged = Path::new("out/merged.json");
        assert_eq!(beside(merged, 1), Path::new("out/merged.conflicts.json"));
        assert_eq!(beside(merged, 2), Path::new("out/merged.conflicts2.json"));
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(
            beside(folder.path(), 1),
            folder.path().join("project.conflicts.json")
        );
    }

    /// A version that has its own position of the camera and its own comment on a frame.
    fn version(x_m: f64, comment: &str) -> Document {
        let mut document = soccer_document();
        let mut camera = Camera::new("main".into(), SIZE);
        camera.position_m = Some(Vec3::new(x_m, -60.0, 18.0));
        document.cameras.push(camera.into());
        document = document.with_pictures(["a.jpg", "b.jpg"], SIZE);
        document.frames[0].comment = Some(comment.to_owned());
        document
    }

    #[test]
    fn every_version_that_was_not_taken_keeps_its_cameras_and_frames() {
        let (base, first) = (version(0.0, "base"), version(1.0, "first"));
        let mut not_taken = ConflictingVersions::default();
        let mut merged = first.clone();
        for other in [version(2.0, "second"), version(3.0, "third")] {
            let joined = merge_documents(&base, &merged, &other);
            not_taken.add(&other, &joined.document, joined.conflicts);
            merged = joined.document;
        }
        assert_eq!(merged, first);
        let names: Vec<&str> = not_taken.names.iter().map(String::as_str).collect();
        assert_eq!(names, ["a.jpg", "camera main"]);
        let kept = not_taken.documents.iter().map(|document| {
            let [camera, frame] = [document.cameras.len(), document.frames.len()];
            let x_m = document.cameras[0].position_m.unwrap().x;
            (camera, frame, x_m, document.frames[0].comment.clone())
        });
        assert_eq!(
            kept.collect::<Vec<_>>(),
            [
                (1, 1, 2.0, Some("second".to_owned())),
                (1, 1, 3.0, Some("third".to_owned()))
            ]
        );
    }

    #[test]
    fn a_frame_whose_picture_lies_elsewhere_is_kept_when_it_was_not_taken() {
        let (base, mut other) = (version(0.0, "base"), version(0.0, "second"));
        other.frames[0].image = Some("elsewhere/a.jpg".to_owned());
        let joined = merge_documents(&base, &version(0.0, "first"), &other);
        let mut not_taken = ConflictingVersions::default();
        not_taken.add(&other, &joined.document, joined.conflicts);
        assert_eq!(not_taken.documents[0].frames[0], other.frames[0]);
    }
}
