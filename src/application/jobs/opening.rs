//! Opens the path that a user names: a project, a dataset, a folder of frames, or a video.

use super::JobError;
use crate::app::Opened;
use crate::app::session::Level;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FieldSpec, document_from_frames};
use touchline_documents::store::{
    self, Access, Location, PROJECT_FILE, PROJECT_SUFFIX, Store, orphans, read,
};
use touchline_season::queue::project_beside;
use touchline_vision::media::{CountProgress, FrameSource, MediaError, sha256_of_bytes};

/// Maximum number of frames of a new project; beyond it every n-th is used. A match of 90 minutes
/// at 25 Hz has 135,000.
const MOST_FRAMES: usize = 20_000;
/// Progress is reported each time this many frames have been read.
const REPORT_EVERY: usize = 50;
/// The field of a project that is created for frames.
const DEFAULT_FIELD: &str = "soccer";

/// An opened document, and the store that writes it.
#[derive(Debug)]
pub struct Ready {
    /// The document, for the application.
    pub opened: Opened,
    /// The store, for the saver. `None` if the document is read-only.
    pub store: Option<Store>,
}

/// Opens a project, a dataset, a folder of frames or a video.
///
/// Frames without a project get one: beside them or, if that cannot be written, in the user's data
/// folder. `held` is the document that this window has open; it is not opened again. `progress`
/// receives texts for the user.
///
/// # Errors
/// The path does not exist, cannot be read, or is open in this window; a project cannot be created;
/// `progress` cancelled the opening.
pub fn open_anything(
    path: &Path,
    held: Option<&Location>,
    progress: &Progress<'_, String>,
) -> Result<Ready, JobError> {
    if !path.exists() {
        return Err(JobError::Missing {
            path: path.to_path_buf(),
        });
    }
    // A project or dataset opens as it is.
    let is_document = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        || path.join(PROJECT_FILE).exists();
    if is_document {
        return open_document(path, held, Vec::new());
    }
    // Frames open with the project that an earlier call has created for them.
    let path = std::fs::canonicalize(path).map_err(JobError::io(path))?;
    if let Some(folder) = find_project(&path) {
        return open_document(&folder, held, Vec::new());
    }
    // Otherwise read all frames and create a project.
    let counting =
        progress.part(|step: CountProgress| format!("Counting frames: {}…", step.counted));
    let source = FrameSource::open_with_progress(&path, &counting)?;
    let every = NonZeroUsize::new(source.len().div_ceil(MOST_FRAMES)).unwrap_or(NonZeroUsize::MIN);
    let used = source.len().div_ceil(every.get());
    let mut refused = None;
    // Try each folder, the better one first, until one can be written. The document is made anew
    // for each, because its paths are relative to the folder.
    for folder in project_folders(&path) {
        let made = document_from_frames(
            &source,
            &folder,
            FieldSpec::new(DEFAULT_FIELD),
            every,
            &reading_progress(progress, used),
        );
        // A cancelled reading gives the frames until then, which must not become a project.
        if progress
            .report("Writing the project…".to_owned())
            .is_break()
        {
            return Err(MediaError::Stopped { path }.into());
        }
        let said = source.notices().iter().map(ToString::to_string);
        let left_out = made
            .left_out
            .iter()
            .map(|(name, error)| format!("Left out: {name}: {error}"));
        let mut notices: Vec<_> = said
            .chain(left_out)
            .map(|text| (Level::Warning, text))
            .collect();
        if made.document.frames.is_empty() {
            return Err(JobError::NoFrames {
                path,
                reason: notices.pop().map(|(_, text)| text),
            });
        }
        if every > NonZeroUsize::MIN {
            let text = format!("There are {} frames: one in {every} is used.", source.len());
            notices.push((Level::Warning, text));
        }
        refuse_unwritable(&made.document, &folder)?;
        match write_project(&folder, &made.document) {
            Ok(()) => {
                notices.push((
                    Level::Info,
                    format!("The project is kept in {}.", folder.display()),
                ));
                let mut ready = open_document(&folder, held, notices)?;
                ready.opened.is_new = true;
                return Ok(ready);
            }
            Err(error) => refused = Some(error),
        }
    }
    Err(refused.unwrap_or(JobError::NoPlace { path }))
}

/// The progress of reading `of` frames, as texts for the user.
fn reading_progress<'p>(progress: &'p Progress<'_, String>, of: usize) -> Progress<'p, ()> {
    let read = AtomicUsize::new(0);
    Progress::new(move |()| {
        let read = read.fetch_add(1, Ordering::Relaxed) + 1;
        if read.is_multiple_of(REPORT_EVERY) {
            return progress.report(format!("Reading frames: {read} of {of}…"));
        }
        progress.check()
    })
}

/// Refuses a document in `folder` that would have to contain a path that is not UTF-8.
pub(super) fn refuse_unwritable(document: &Document, folder: &Path) -> Result<(), JobError> {
    document.unwritable_path(folder).map_or(Ok(()), |path| {
        Err(JobError::Unwritable {
            path: path.to_owned(),
        })
    })
}

fn write_project(folder: &Path, document: &Document) -> Result<(), JobError> {
    std::fs::create_dir_all(folder).map_err(JobError::io(folder))?;
    Store::create(&Location::for_new_document(folder)?, document)?;
    Ok(())
}

/// The existing project of a folder of frames or of a video. One in the user's data folder counts
/// only if its frames are these, because two matches may have the same names.
fn find_project(path: &Path) -> Option<PathBuf> {
    beside(path)
        .filter(|folder| has_project(folder))
        .or_else(|| {
            let own = own_place(&user_projects()?, path);
            (has_project(&own) && is_of_frames(&own, path)).then_some(own)
        })
}

/// Whether a folder has a project file.
fn has_project(folder: &Path) -> bool {
    folder.join(PROJECT_FILE).exists()
}

/// The folders in which the project of some frames may be created, the better one first.
fn project_folders(path: &Path) -> Vec<PathBuf> {
    beside(path)
        .into_iter()
        .chain(user_projects().map(|projects| own_place(&projects, path)))
        .collect()
}

fn beside(path: &Path) -> Option<PathBuf> {
    path.parent().map(|_| project_beside(path))
}

fn project_name(path: &Path) -> OsString {
    let mut name: OsString = path.file_name().unwrap_or_default().to_owned();
    name.push(PROJECT_SUFFIX);
    name
}

/// The folder within `projects`: the name of the frames' parent folder, so that people find it, and
/// a digest of the whole path, because cameras give their folders the same names.
fn own_place(projects: &Path, path: &Path) -> PathBuf {
    const DIGITS: usize = 12;
    let digest = sha256_of_bytes(path.as_os_str().as_encoded_bytes());
    let parent = path.parent().and_then(Path::file_name);
    let mut place = parent.map_or_else(OsString::new, ToOwned::to_owned);
    place.push("-");
    place.push(&digest[..DIGITS.min(digest.len())]);
    projects.join(place).join(project_name(path))
}

/// Whether a project has a frame from this folder or video.
fn is_of_frames(project: &Path, path: &Path) -> bool {
    let Ok((location, document, _)) = read(project) else {
        return false;
    };
    let is_below =
        |file: PathBuf| std::fs::canonicalize(file).is_ok_and(|file| file.starts_with(path));
    document.frames.iter().any(|frame| {
        let video = frame
            .video
            .as_ref()
            .map(|video| video.file_path(location.folder()));
        frame
            .image_path(location.folder())
            .into_iter()
            .chain(video)
            .any(is_below)
    })
}

/// The folder of the user's own projects.
pub(super) fn user_projects() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "touchline")?
            .data_dir()
            .join("projects"),
    )
}

/// Opens an existing project or dataset, with the edits in its journal.
pub(super) fn open_document(
    path: &Path,
    held: Option<&Location>,
    mut notices: Vec<(Level, String)>,
) -> Result<Ready, JobError> {
    // Compare before `store::open`: this process has the lock already, so that opening the document
    // once more would give a read-only copy of it.
    let found = Location::find(path)?;
    if held.is_some_and(|held| held.is_same_document(&found)) {
        return Err(JobError::AlreadyOpen {
            file: found.file().to_path_buf(),
        });
    }
    let store::Opened {
        location,
        document,
        history,
        access,
        recovery,
    } = store::open(path)?;
    notices.extend(recovery.message().map(|text| (Level::Warning, text)));
    let (store, read_only) = match access {
        Access::Writable(store) => (Some(store), None),
        Access::ReadOnly(reason) => (None, Some(reason.to_string())),
    };
    let mut opened = Opened::new(document, location.file());
    opened.folder = location.folder().to_path_buf();
    (opened.history, opened.read_only, opened.notices) = (history, read_only, notices);
    opened.orphans = orphans(&location);
    Ok(Ready { opened, store })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    fn open(path: &Path) -> Result<Ready, JobError> {
        open_anything(path, None, &Progress::default())
    }

    #[test]
    fn frames_get_a_project_beside_them_once() {
        let root = tempfile::tempdir().unwrap();
        let frames = root.path().join("first half");
        std::fs::create_dir(&frames).unwrap();
        image::RgbImage::new(64, 36)
            .save(frames.join("1.png"))
            .unwrap();
        let ready = open(&frames).unwrap();
        assert_eq!(
            ready.opened.document().frames[0].name(),
            "../first half/1.png"
        );
        assert!(
            ready
                .opened
                .file
                .ends_with("first half.touchline/project.json"),
            "{:?}",
            ready.opened.file
        );
        assert!(
            ready
                .opened
                .notices
                .iter()
                .any(|(_, text)| text.starts_with("The project is kept in"))
        );
        drop(ready);
        let again = open(&frames).unwrap();
        assert!(
            again.opened.notices.is_empty(),
            "{:?}",
            again.opened.notices
        );
        assert!(again.store.is_some());
        let second = open(&frames).unwrap();
        assert!(
            second.store.is_none() && second.opened.read_only.is_some(),
            "two at once: the second only looks"
        );
    }

    #[test]
    fn each_attempt_counts_its_frames_from_the_first() {
        let texts = std::sync::Mutex::new(Vec::new());
        let progress = Progress::new(|text: String| {
            texts.lock().unwrap().push(text);
            ControlFlow::Continue(())
        });
        for _ in 0..2 {
            let reading = reading_progress(&progress, REPORT_EVERY + 10);
            for _ in 0..REPORT_EVERY + 10 {
                assert!(reading.report(()).is_continue());
            }
        }
        assert_eq!(*texts.lock().unwrap(), ["Reading frames: 50 of 60…"; 2]);
    }

    #[test]
    fn frames_of_two_matches_with_the_same_names_have_two_projects() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path().canonicalize().unwrap();
        let projects = root.join("projects");
        let [red, blue] = ["red", "blue"].map(|card| root.join(card).join("DCIM/clip"));
        for frames in [&red, &blue] {
            std::fs::create_dir_all(frames).unwrap();
            image::RgbImage::new(64, 36)
                .save(frames.join("1.png"))
                .unwrap();
        }
        assert_ne!(own_place(&projects, &red), own_place(&projects, &blue));
        assert_eq!(
            own_place(&projects, &red).file_name().unwrap(),
            "clip.touchline"
        );
        let project = own_place(&projects, &red);
        let source = FrameSource::open(&red).unwrap();
        let made = document_from_frames(
            &source,
            &project,
            FieldSpec::new(DEFAULT_FIELD),
            NonZeroUsize::MIN,
            &Progress::default(),
        );
        write_project(&project, &made.document).unwrap();
        assert!(is_of_frames(&project, &red) && !is_of_frames(&project, &blue));
    }

    #[test]
    fn what_cannot_be_opened_is_named() {
        let root = tempfile::tempdir().unwrap();
        let error = open(&root.path().join("none")).unwrap_err().to_string();
        assert!(error.contains("there is no such file or folder"), "{error}");
        let empty = root.path().join("empty");
        std::fs::create_dir(&empty).unwrap();
        assert!(
            open(&empty)
                .unwrap_err()
                .to_string()
                .contains("there is no frame that can be read")
        );
        assert!(
            !root.path().join("empty.touchline").exists(),
            "nothing is left behind"
        );
        let text = root.path().join("notes.json");
        std::fs::write(&text, "[1, 2]").unwrap();
        assert!(open(&text).is_err());
    }

    #[test]
    fn opening_can_be_ended_and_leaves_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let frames = root.path().join("frames");
        std::fs::create_dir(&frames).unwrap();
        image::RgbImage::new(64, 36)
            .save(frames.join("1.png"))
            .unwrap();
        assert!(open_anything(&frames, None, &Progress::new(|_| ControlFlow::Break(()))).is_err());
        assert!(!root.path().join("frames.touchline").exists());
    }
}
