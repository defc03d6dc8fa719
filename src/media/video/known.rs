//! What was found out about the videos opened before: it holds for as long as their files do not change, and most videos are opened
//! by several threads of one program.

use super::VideoInfo;
use super::capture::Capture;
use super::survey::Survey;
use crate::media::MediaError;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// How many videos are remembered.
const REMEMBERED: usize = 32;

/// The videos that were asked for last, the latest at the end.
static KNOWN: LazyLock<Mutex<Vec<(FileState, Slot)>>> = LazyLock::new(Mutex::default);

/// What is known of one video: held while it is being found out, so that others who ask for it wait.
type Slot = Arc<Mutex<Option<(VideoInfo, usize)>>>;

/// A file as it is at some time.
#[derive(Clone, PartialEq, Eq)]
struct FileState {
    path: PathBuf,
    bytes: u64,
    modified: SystemTime,
}

impl FileState {
    /// None where the system does not tell.
    fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self { path: path.to_path_buf(), bytes: metadata.len(), modified: metadata.modified().ok()? })
    }
}

/// A video as it was surveyed before, opened anew; else surveyed by `survey`, which is called once at a time for a file.
pub(super) fn known_or(path: &Path, survey: impl FnOnce() -> Result<Survey, MediaError>) -> Result<Survey, MediaError> {
    let Some(state) = FileState::of(path) else { return survey() };
    let slot = slot(state);
    let mut known = lock(&slot);
    if let Some((info, preroll)) = known.as_ref() {
        return Ok(Survey { info: info.clone(), preroll: *preroll, capture: Capture::open(path)? });
    }
    let found = survey()?;
    *known = Some((found.info.clone(), found.preroll));
    Ok(found)
}

/// Where what is known of a file is kept.
fn slot(state: FileState) -> Slot {
    let mut all = lock(&KNOWN);
    let of_file = match all.iter().position(|(known, _)| *known == state) {
        Some(at) => all.remove(at),
        None => (state, Slot::default()),
    };
    if all.len() >= REMEMBERED {
        all.remove(0);
    }
    all.push_mut(of_file).1.clone()
}

/// What a thread that panicked left behind is whole: it is written at once.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
