//! Opens queues of matches, and looks at how far their matches have come.

use super::JobError;
use super::opening::{Ready, open_anything, open_document};
use crate::app::{QueuedFrame, ReviewQueue};
use crate::scene::match_list::MatchState;
use std::path::{Path, PathBuf};
use touchline_core::files::folder_of;
use touchline_core::progress::Progress;
use touchline_documents::store::{Location, read};
use touchline_season::queue::{Queue, QueueEntry, QueuedMatch};
use touchline_vision::media::FrameSource;

/// Opens a queue's file, or what else lies at a path.
///
/// # Errors
/// It cannot be opened.
pub(super) fn open_path(
    path: &Path,
    held: Option<&Location>,
    progress: &Progress<'_, String>,
) -> Result<Ready, JobError> {
    if Queue::is_at(path) {
        return open_queue(path, held, progress);
    }
    open_anything(path, held, progress)
}

/// Opens a queue's file, at its first match that can be opened.
///
/// # Errors
/// It is no queue, is empty, or none of its matches can be opened.
fn open_queue(
    path: &Path,
    held: Option<&Location>,
    progress: &Progress<'_, String>,
) -> Result<Ready, JobError> {
    let folder = folder_of(path);
    let queue = Queue::read(path)?;
    let matches = queue.all_matches(folder);
    let entries = queue.entries().iter();
    let frames = entries.map(|entry| queued_frame(entry, folder)).collect();
    open_first(ReviewQueue::new(matches, frames), held, progress, path)
}

/// Opens videos, folders and projects as a queue, at the first that can be opened.
///
/// # Errors
/// None of them can be opened.
pub(super) fn open_paths(
    paths: &[PathBuf],
    held: Option<&Location>,
    progress: &Progress<'_, String>,
) -> Result<Ready, JobError> {
    let matches = Queue::from_paths(paths)?.matches;
    let first = paths.first().map_or(Path::new(""), PathBuf::as_path);
    open_first(ReviewQueue::new(matches, Vec::new()), held, progress, first)
}

/// Opens a match: its project, or what it is made of.
///
/// # Errors
/// It cannot be opened.
pub(super) fn open_match(
    queued: &QueuedMatch,
    held: Option<&Location>,
    progress: &Progress<'_, String>,
) -> Result<Ready, JobError> {
    match &queued.frames {
        Some(frames) if !queued.project.exists() => open_anything(frames, held, progress),
        _ => open_document(&queued.project, held, Vec::new()),
    }
}

/// Opens the first match of a queue that can be opened, from its place on.
fn open_first(
    mut queue: ReviewQueue,
    held: Option<&Location>,
    progress: &Progress<'_, String>,
    of: &Path,
) -> Result<Ready, JobError> {
    let (first, count) = (queue.at(), queue.rows().len());
    let mut failure = None;
    for at in (first..count).chain(0..first) {
        queue.begin_opening(at);
        match open_match(&queue.rows()[at].queued, held, progress) {
            Ok(mut ready) => {
                ready.opened.queue = Some(queue);
                return Ok(ready);
            }
            Err(error) if progress.check().is_break() => return Err(error),
            // The match that is open already cannot be opened now, but has not failed.
            Err(error @ JobError::AlreadyOpen { .. }) => failure = failure.or(Some(error)),
            Err(error) => {
                queue.fail_opening(&error.to_string());
                failure = failure.or(Some(error));
            }
        }
    }
    Err(failure.unwrap_or_else(|| JobError::EmptyQueue {
        path: of.to_path_buf(),
    }))
}

/// The frame of an entry in the queue in `folder`.
fn queued_frame(entry: &QueueEntry, folder: &Path) -> QueuedFrame {
    let project = folder.join(&entry.project);
    QueuedFrame {
        project: std::fs::canonicalize(&project).unwrap_or(project),
        frame: entry.frame.clone(),
    }
}

/// How far a match has come: by its project if there is one, else by what it is made of.
pub fn look_at_match(queued: &QueuedMatch) -> MatchState {
    let mut state = match &queued.frames {
        Some(frames) if !queued.project.exists() => match FrameSource::open(frames) {
            Ok(source) if source.is_empty() => {
                MatchState::from_failure("there is no frame", frames)
            }
            Ok(source) => MatchState::from_frames(&source),
            Err(error) => MatchState::from_failure(&error.to_string(), frames),
        },
        _ => match read(&queued.project) {
            Ok((at, document, _)) => MatchState::from_document(&document, at.folder()),
            Err(error) => MatchState::from_failure(&error.to_string(), &queued.project),
        },
    };
    // A camera or accepted frames say more than how the last labelling ended.
    let is_begun = state
        .counts()
        .is_some_and(|counts| counts.cameras + counts.accepted > 0);
    if let Some(reason) = queued.failed.as_ref().filter(|_| !is_begun) {
        state.stage = MatchState::from_failure(reason, queued.source()).stage;
    }
    state
}
