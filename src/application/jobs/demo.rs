//! The user's own copy of the demo match.

use super::JobError;
use super::drawn_match::{DrawnPicture, MatchOrder, draw_match};
use super::opening::user_projects;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_core::progress::Progress;
use touchline_documents::store::{Location, PROJECT_FILE, Store, write_atomically};
use touchline_vision::media::MediaError;

/// The folder of the user's copy of the demo match. If there is none yet, it is copied from the one
/// that came with the program, or else drawn.
///
/// # Errors
/// The copy cannot be written, or `progress` cancelled it.
pub fn fresh_copy(progress: &Progress<'_, String>) -> Result<PathBuf, JobError> {
    let own = user_projects().ok_or(JobError::NoUserFolder)?.join("demo");
    if own.join(PROJECT_FILE).exists() {
        return Ok(own);
    }
    match find_demo_folder() {
        Some(folder) => copy_folder(&folder, &own).map_err(JobError::io(&own))?,
        None => draw(&MatchOrder::demo(), &own, progress)?,
    }
    Ok(own)
}

/// Draws a match into a folder. The project file is written last; without it the match counts as
/// incomplete and is drawn again.
fn draw(
    order: &MatchOrder,
    folder: &Path,
    progress: &Progress<'_, String>,
) -> Result<(), JobError> {
    std::fs::create_dir_all(folder.join("images")).map_err(JobError::io(folder))?;
    let drawn = draw_match(order, &mut |picture: DrawnPicture| {
        let file = folder.join(&picture.image);
        std::fs::write(&file, &picture.jpeg).map_err(JobError::io(&file))?;
        let step = format!(
            "Drawing the demo match: {} of {} frames…",
            picture.index + 1,
            picture.of
        );
        match progress.report(step) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(JobError::from(MediaError::Stopped {
                path: folder.to_path_buf(),
            })),
        }
    })?;
    Store::create(&Location::for_new_document(folder)?, &drawn.project)?;
    Ok(())
}

/// The folder of the demo: beside an installed program, or in the source tree where it was built.
fn find_demo_folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    // `bin` and `share` of an installation are siblings; `target/release` lies two folders below
    // the source tree.
    let beside = program.ancestors().skip(1).take(4);
    beside
        .flat_map(|folder| {
            [
                folder.join("share/touchline/demo"),
                folder.join("projects/demo"),
            ]
        })
        .find(|folder| folder.join(PROJECT_FILE).exists())
}

/// Copies a match. The project file is copied last, and is there whole or not at all; without it
/// the copy counts as incomplete and is repeated.
fn copy_folder(from: &Path, to: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    let mut entries = std::fs::read_dir(from)?.collect::<std::io::Result<Vec<_>>>()?;
    // `false` sorts before `true`: the project file comes after everything else.
    entries.sort_by_key(|entry| (entry.file_name() == PROJECT_FILE, entry.file_name()));
    for entry in entries {
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            write_atomically(&target, &std::fs::read(entry.path())?)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_copy_that_is_interrupted_is_no_project() {
        let place = tempfile::tempdir().unwrap();
        let (from, to) = (place.path().join("from"), place.path().join("to"));
        std::fs::create_dir_all(from.join("zz")).unwrap();
        std::fs::write(from.join(PROJECT_FILE), "{}").unwrap();
        std::fs::write(from.join("zz/1.jpg"), "picture").unwrap();
        std::fs::write(from.join("a.txt"), "first").unwrap();
        // A file with the name of the picture folder makes the copy fail there.
        std::fs::create_dir(&to).unwrap();
        std::fs::write(to.join("zz"), "in the way").unwrap();
        assert!(copy_folder(&from, &to).is_err());
        assert!(to.join("a.txt").exists() && !to.join(PROJECT_FILE).exists());
        std::fs::remove_file(to.join("zz")).unwrap();
        copy_folder(&from, &to).unwrap();
        assert!(to.join(PROJECT_FILE).exists() && to.join("zz/1.jpg").exists());
    }

    #[test]
    fn without_a_demo_beside_the_program_one_is_drawn_that_opens_and_can_be_stopped() {
        let place = tempfile::tempdir().unwrap();
        let order = MatchOrder {
            frames: 3,
            image_size: ImageSize::new(320, 180),
            ..MatchOrder::demo()
        };
        let stopped = draw(
            &order,
            place.path(),
            &Progress::new(|_| ControlFlow::Break(())),
        );
        assert!(
            matches!(stopped, Err(JobError::Media(MediaError::Stopped { .. }))),
            "{stopped:?}"
        );
        assert!(!place.path().join(PROJECT_FILE).exists());
        let messages = std::sync::Mutex::new(Vec::new());
        let progress = Progress::new(|text| {
            messages.lock().unwrap().push(text);
            ControlFlow::Continue(())
        });
        draw(&order, place.path(), &progress).unwrap();
        drop(progress);
        assert_eq!(
            messages.into_inner().unwrap().last().unwrap(),
            "Drawing the demo match: 3 of 3 frames…"
        );
        let (_, document, _) = touchline_documents::store::read(place.path()).unwrap();
        assert_eq!(document.frames.len(), 3);
        for frame in &document.frames {
            let file = frame.image_path(place.path()).unwrap();
            assert_eq!(
                touchline_vision::media::sha256_of_file(&file).ok(),
                frame.sha256
            );
        }
    }
}
