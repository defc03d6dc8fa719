//! What was found out about the videos opened before: it holds for as long as their files do not
//! change, and most videos are opened by several threads of one program.

use super::backend::{VideoBackend, open_capture};
use super::survey::Survey;
use super::{CountProgress, VideoInfo};
use crate::media::MediaError;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use touchline_core::progress::Progress;

/// How many videos are remembered.
const REMEMBERED: usize = 32;

/// Examinations, each of a file as it was.
type Examinations = Vec<(FileState, Arc<Examination>)>;

/// Those of the videos that were asked for last, the latest at the end.
static KNOWN: LazyLock<Mutex<Examinations>> = LazyLock::new(Mutex::default);
/// How often someone who waits for another's examination is told how far that has come, and may
/// give up.
const TOLD_EVERY: Duration = Duration::from_millis(50);

/// The examination of one video: whoever asks for it first does it, others who ask meanwhile wait.
#[derive(Default)]
struct Examination {
    state: Mutex<State>,
    changed: Condvar,
}

/// How far an examination has come.
#[derive(Default)]
enum State {
    /// Nobody has begun, or whoever had begun gave up.
    #[default]
    Open,
    /// Somebody is at it, and has counted so far.
    UnderWay(Option<CountProgress>),
    /// What was found, and the run-up of a jump.
    Done(VideoInfo, usize),
}

impl Examination {
    /// What was found; none where it is for the caller to find out.
    fn found_or_begun(
        &self,
        path: &Path,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Option<(VideoInfo, usize)>, MediaError> {
        loop {
            let mut state = lock(&self.state);
            match &*state {
                State::Done(info, preroll) => return Ok(Some((info.clone(), *preroll))),
                State::Open => {
                    *state = State::UnderWay(None);
                    return Ok(None);
                }
                State::UnderWay(_) => {}
            }
            let (state, _) = self
                .changed
                .wait_timeout(state, TOLD_EVERY)
                .unwrap_or_else(PoisonError::into_inner);
            let counted = if let State::UnderWay(counted) = &*state {
                counted.clone()
            } else {
                None
            };
            drop(state);
            if counted.is_some_and(|counted| progress.report(counted).is_break()) {
                return Err(MediaError::Stopped {
                    path: path.to_path_buf(),
                });
            }
        }
    }
}

/// A begun examination. It is open again where it ends without having found anything.
struct Begun<'a> {
    examination: &'a Examination,
    found: Option<(VideoInfo, usize)>,
}

impl Drop for Begun<'_> {
    fn drop(&mut self) {
        *lock(&self.examination.state) = self
            .found
            .take()
            .map_or(State::Open, |(info, preroll)| State::Done(info, preroll));
        self.examination.changed.notify_all();
    }
}

/// A file as it is at some time.
#[derive(Clone, PartialEq, Eq)]
struct FileState {
    path: PathBuf,
    bytes: u64,
    modified: SystemTime,
    /// What it is read with: another backend may know other times.
    backend: VideoBackend,
}

impl FileState {
    /// None where the system does not tell.
    fn of(path: &Path, backend: VideoBackend) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self {
            path: path.to_path_buf(),
            bytes: metadata.len(),
            modified: metadata.modified().ok()?,
            backend,
        })
    }
}

/// A video as it was surveyed before, opened anew; else surveyed by `survey`, which is called once
/// at a time for a file. `progress` hears of it now and then, also while another thread surveys it,
/// and may cancel that.
pub(super) fn known_or(
    path: &Path,
    backend: VideoBackend,
    progress: &Progress<'_, CountProgress>,
    survey: impl FnOnce(&Progress<'_, CountProgress>) -> Result<Survey, MediaError>,
) -> Result<Survey, MediaError> {
    let Some(file) = FileState::of(path, backend) else {
        return survey(progress);
    };
    let examination = examination(file);
    if let Some((info, preroll)) = examination.found_or_begun(path, progress)? {
        return Ok(Survey {
            info,
            preroll,
            capture: open_capture(path, backend)?,
        });
    }
    let mut begun = Begun {
        examination: &examination,
        found: None,
    };
    let found = survey(&progress.part(|counted: CountProgress| {
        *lock(&examination.state) = State::UnderWay(Some(counted.clone()));
        counted
    }))?;
    begun.found = Some((found.info.clone(), found.preroll));
    Ok(found)
}

/// Where what is known of a file is kept.
fn examination(file: FileState) -> Arc<Examination> {
    let mut all = lock(&KNOWN);
    let of_file = match all.iter().position(|(known, _)| *known == file) {
        Some(at) => all.remove(at),
        None => (file, Arc::default()),
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
