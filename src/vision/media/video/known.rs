//! A cache of video surveys within the process. A survey stays valid while its file does not
//! change, and several threads of the program open the same video.

use super::CountProgress;
use super::backend::VideoBackend;
use super::survey::{Survey, SurveyedVideo};
use crate::media::MediaError;
use crate::media::error::open_file;
use std::fs::Metadata;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use touchline_core::progress::Progress;

/// Number of surveys kept.
const REMEMBERED: usize = 32;

/// Number of bytes by which the beginning of a file is recognised.
const HEAD_BYTES: u64 = 1 << 14;

/// Surveys, each of a file in one state.
type Examinations = Vec<(FileState, Arc<Examination>)>;

/// Surveys of the videos opened last, the latest at the end.
static KNOWN: LazyLock<Mutex<Examinations>> = LazyLock::new(Mutex::default);
/// Interval at which a thread that waits for another's survey reports progress and checks for
/// cancellation.
const REPORT_INTERVAL: Duration = Duration::from_millis(50);

/// The survey of one video: the first thread that needs it performs it, others wait meanwhile.
#[derive(Default)]
struct Examination {
    state: Mutex<State>,
    changed: Condvar,
}

/// The state of a survey.
#[derive(Default)]
enum State {
    /// Not begun, or abandoned.
    #[default]
    Open,
    /// In progress on some thread, with its latest count.
    UnderWay(Option<CountProgress>),
    /// Finished, with its result.
    Done(SurveyedVideo),
}

impl Examination {
    /// The finished survey, waiting for it if another thread performs it; `None` if the caller has
    /// to perform it.
    fn find_or_start(
        &self,
        path: &Path,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Option<SurveyedVideo>, MediaError> {
        // Waits with a timeout instead of until `changed`, so that progress and cancellation are
        // served meanwhile; a spurious wake-up only goes round once more.
        loop {
            let mut state = lock(&self.state);
            match &*state {
                State::Done(video) => return Ok(Some(video.clone())),
                State::Open => {
                    *state = State::UnderWay(None);
                    return Ok(None);
                }
                State::UnderWay(_) => {}
            }
            let (state, _) = self
                .changed
                .wait_timeout(state, REPORT_INTERVAL)
                .unwrap_or_else(PoisonError::into_inner);
            // Copy the count and release the lock before reporting: the callback may take long.
            let counted = if let State::UnderWay(counted) = &*state {
                counted.clone()
            } else {
                None
            };
            drop(state);
            // A survey of a constant rate may have counted nothing yet.
            let is_cancelled = counted.map_or_else(
                || progress.is_cancelled(),
                |counted| progress.report(counted).is_break(),
            );
            if is_cancelled {
                return Err(MediaError::Stopped {
                    path: path.to_path_buf(),
                });
            }
        }
    }
}

/// A guard of a survey in progress. If it is dropped without a result, the survey is open again for
/// the next thread.
struct SurveyGuard<'a> {
    examination: &'a Examination,
    found: Option<SurveyedVideo>,
}

impl Drop for SurveyGuard<'_> {
    fn drop(&mut self) {
        *lock(&self.examination.state) = self.found.take().map_or(State::Open, State::Done);
        self.examination.changed.notify_all();
    }
}

/// A file's identity and state at some time.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct FileState {
    path: PathBuf,
    /// The numbers of its device and of the file on it; zeros on Windows, which replaces no file
    /// that is open.
    file: [u64; 2],
    bytes: u64,
    modified: SystemTime,
    /// Its first bytes.
    head: Vec<u8>,
    /// The backend: another one may report other times.
    backend: VideoBackend,
}

impl FileState {
    /// `None` if the system does not provide length or time, or the file cannot be read.
    pub(super) fn read(path: &Path, backend: VideoBackend) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self {
            path: path.to_path_buf(),
            file: file_numbers(&metadata),
            bytes: metadata.len(),
            modified: metadata.modified().ok()?,
            head: read_head(path)?,
            backend,
        })
    }

    /// Whether another file has taken the place of this one since, or other content. A recording
    /// that has only grown still has the frames that it had; to survey it again for each of them
    /// would take very long. A file that is missing is not replaced.
    pub(super) fn is_replaced(&self) -> bool {
        let Ok(now) = std::fs::metadata(&self.path) else {
            return false;
        };
        let is_same_file = file_numbers(&now) == self.file;
        if is_same_file
            && now.len() == self.bytes
            && now.modified().is_ok_and(|at| at == self.modified)
        {
            return false;
        }
        // A copy over the file leaves the same file, too, and may be longer; a recording that has
        // grown begins as it did.
        let has_grown = is_same_file && now.len() > self.bytes && self.begins_as_before();
        !has_grown
    }

    /// Whether the file begins as it did; true if it cannot be read.
    fn begins_as_before(&self) -> bool {
        let now = read_head(&self.path);
        now.is_none_or(|head| head.starts_with(&self.head))
    }
}

/// The first bytes of a file; `None` if it cannot be read.
fn read_head(path: &Path) -> Option<Vec<u8>> {
    let mut head = Vec::new();
    let file = open_file(path).ok()?;
    file.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    Some(head)
}

/// The numbers of [`FileState`].
#[cfg(unix)]
fn file_numbers(metadata: &Metadata) -> [u64; 2] {
    use std::os::unix::fs::MetadataExt;
    [metadata.dev(), metadata.ino()]
}

/// The numbers of [`FileState`].
#[cfg(not(unix))]
const fn file_numbers(_: &Metadata) -> [u64; 2] {
    [0; 2]
}

/// A video with its earlier survey, opened anew, or else surveyed by `survey`, which runs once at a
/// time per file. `progress` receives reports, also while another thread surveys, and may cancel.
///
/// `file` is the state of the file before this: if it changes during the survey, it has another
/// state when it is opened next, and is surveyed again.
pub(super) fn find_or_survey(
    path: &Path,
    file: Option<FileState>,
    progress: &Progress<'_, CountProgress>,
    survey: impl FnOnce(&Progress<'_, CountProgress>) -> Result<Survey, MediaError>,
) -> Result<Survey, MediaError> {
    let Some(file) = file else {
        return survey(progress);
    };
    let examination = examination(file);
    if let Some(video) = examination.find_or_start(path, progress)? {
        let capture = video.described.open(path)?;
        return Ok(Survey { video, capture });
    }
    // The guard reopens the survey if `survey` fails or panics, so that waiting threads go on.
    let mut begun = SurveyGuard {
        examination: &examination,
        found: None,
    };
    let found = survey(&progress.part(|counted: CountProgress| {
        *lock(&examination.state) = State::UnderWay(Some(counted.clone()));
        counted
    }))?;
    begun.found = Some(found.video.clone());
    Ok(found)
}

/// The cache entry of a file, moved to the end of the list.
fn examination(file: FileState) -> Arc<Examination> {
    // The list is locked only for the look-up; a survey in progress has a lock of its own. Threads
    // that wait for one keep it by their `Arc`, even if it has left the list.
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

/// The state is replaced in one assignment, so it is consistent even after a panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::ops::ControlFlow;

    #[test]
    fn a_video_is_replaced_by_other_content_and_not_by_its_own_growth() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["match.mp4", "other.mp4"].map(|name| folder.path().join(name));
        fs::write(&path, b"frames").unwrap();
        let then = FileState::read(&path, VideoBackend::Ffmpeg).unwrap();
        assert!(!then.is_replaced());
        fs::write(&path, b"frames and more").unwrap();
        assert!(!then.is_replaced(), "it has grown");
        fs::write(&path, b"less").unwrap();
        assert!(then.is_replaced(), "it is shorter");
        fs::write(&path, b"other frames and more").unwrap();
        assert!(then.is_replaced(), "it is longer and begins otherwise");
        if cfg!(unix) {
            fs::write(&other, b"frames of a longer video").unwrap();
            fs::rename(&other, &path).unwrap();
            assert!(then.is_replaced(), "it is another file");
        }
        fs::remove_file(&path).unwrap();
        assert!(!then.is_replaced(), "it is missing");
    }

    #[test]
    fn a_thread_that_waits_for_a_survey_without_a_count_can_be_cancelled() {
        let path = Path::new("match.mp4");
        let progress = Progress::new(|_: CountProgress| ControlFlow::Break(()));
        let step = CountProgress {
            path: Arc::from(path),
            counted: 0,
            stated: 0,
        };
        assert!(progress.report(step).is_break());
        let elsewhere = Examination {
            state: Mutex::new(State::UnderWay(None)),
            ..Examination::default()
        };
        let waited = elsewhere.find_or_start(path, &progress);
        assert!(matches!(waited, Err(MediaError::Stopped { .. })));
    }
}
