//! Searches the cuts of a video: at the user's command, and automatically after a video was
//! imported.

use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::{App, Command, Effect};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_calibration::pipelines::shot_starts;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{
    Document, EditKind, FoundCuts, Frame, FrameStatus, ShotKind, Step, VideoShots,
};
use touchline_vision::media::{FrameReader, FrameRef, FrameStream, MediaError};
use touchline_vision::track::find_cuts;

/// Searches the cuts of a video.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShotSearch {
    /// The video's path as the document writes it.
    pub video: String,
    /// The file.
    pub path: PathBuf,
    /// The number of steps that could be undone when the search began. The result is inserted into
    /// the history below the steps that the user makes while the search runs.
    pub num_below: usize,
    /// The first frames of the shots that the video had when the search began: a cut among them
    /// that the user removes while the search runs does not come back.
    pub known: Vec<u64>,
}

/// The cuts of a video.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundShots {
    /// The index of the video's last frame.
    pub last: u64,
    /// The index of the first frame of every shot but the first, and the kind of its beginning.
    pub cuts: Vec<(u64, ShotKind)>,
}

impl FoundShots {
    /// The number of shots, without the transitions between them.
    fn num_shots(&self) -> usize {
        let starts = self.cuts.iter();
        starts
            .filter(|(_, kind)| *kind != ShotKind::Transition)
            .count()
            + 1
    }
}

/// The search on the open document.
#[derive(Debug, Default)]
pub struct ShotSearchState {
    slot: Slot<ShotSearch>,
}

impl ShotSearchState {
    /// The inputs of the running search.
    pub fn running(&self) -> Option<&ShotSearch> {
        self.slot.running().map(Running::operation)
    }

    /// Its progress; zero if no search is running.
    pub fn progress(&self) -> Share {
        self.slot
            .running()
            .and_then(Running::progress)
            .copied()
            .unwrap_or_default()
    }
}

// ---- The work ----

impl Operation for ShotSearch {
    /// Frames that have been examined.
    type Progress = Share;
    type Output = FoundShots;
    type Error = MediaError;

    const NAME: &'static str = "shots";

    fn run(&self, context: &Context<'_, Share>) -> Result<FoundShots, MediaError> {
        let percent = AtomicUsize::new(usize::MAX);
        let progress = Progress::new(|frames: Share| {
            context.give_way_to_window();
            // The window shows whole percents and is repainted after each report. A long match has
            // thousands of frames per percent, so only a change of the percentage is reported.
            if percent.swap(frames.percent(), Ordering::Relaxed) == frames.percent() {
                return context.check();
            }
            context.report(frames)
        });
        // A reader without the shared cache: each frame is read once and never needed again.
        self.look(&mut FrameReader::new(), &progress)
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.shot_search.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_step()
    }

    fn take_over(&self, app: &mut App, result: Result<FoundShots, Failure<MediaError>>) {
        match result {
            Ok(found) => app.mark_found_shots(self, &found),
            Err(Failure::Failed(MediaError::Stopped { .. })) => {}
            Err(failure) => {
                let text = format!("The search for cuts in {} failed: {failure}", self.video);
                app.session.notify(failure.level(), text);
            }
        }
    }
}

impl ShotSearch {
    /// Examines every frame of the video. Reports to `progress` before each.
    ///
    /// # Errors
    /// The video cannot be opened, or `progress` cancelled the search: [`MediaError::Stopped`].
    pub fn look(
        &self,
        reader: &mut FrameReader,
        progress: &Progress<'_, Share>,
    ) -> Result<FoundShots, MediaError> {
        let of = reader.video_info(&self.path)?.decoded_frames;
        let path: Arc<Path> = Arc::from(self.path.as_path());
        let frames = (0..of).map(|index| FrameRef::video(Arc::clone(&path), index));
        let stream = FrameStream::new(frames)
            .with_reader(reader)
            .with_progress(progress.part(|frames| frames));
        // A frame that cannot be decoded has its place in the sequence, so that numbers stay right.
        let cuts = find_cuts(stream.map(|frame| frame.picture.ok()));
        if progress.is_cancelled() {
            return Err(MediaError::Stopped {
                path: self.path.clone(),
            });
        }
        Ok(FoundShots {
            last: of.saturating_sub(1) as u64,
            cuts: shot_starts(&cuts),
        })
    }
}

/// The videos of a document in which no frame belongs to a shot, by name and file.
fn without_shots(document: &Document, folder: &Path) -> Vec<(String, PathBuf)> {
    let mut videos: Vec<(String, PathBuf, bool)> = Vec::new();
    for frame in &document.frames {
        let Some(video) = &frame.video else { continue };
        let is_in_shot = frame.clip.is_some();
        match videos.iter_mut().find(|(name, ..)| *name == video.path) {
            Some((.., has_shots)) => *has_shots |= is_in_shot,
            None => videos
                .extend(file_of(frame, folder).map(|file| (video.path.clone(), file, is_in_shot))),
        }
    }
    videos
        .into_iter()
        .filter(|(.., has_shots)| !has_shots)
        .map(|(name, file, _)| (name, file))
        .collect()
}

/// The file of a frame's video. None for a still image.
fn file_of(frame: &Frame, folder: &Path) -> Option<PathBuf> {
    match frame.picture_source(folder)? {
        FrameRef::Video { path, .. } => Some(path.to_path_buf()),
        FrameRef::Image(_) => None,
    }
}

// ---- In the application ----

impl App {
    /// Why a command of the search is not available. None if it is.
    pub(in crate::app) fn why_not_shot_search(&self, command: Command) -> Option<&'static str> {
        match command {
            Command::FindShots if self.is_read_only() => Some("The document is read-only."),
            Command::FindShots if self.frame().is_some_and(|frame| frame.video.is_none()) => {
                Some("This frame does not come from a video.")
            }
            Command::StopShotSearch if !self.operations.shot_search.slot.is_running() => {
                Some("No search for cuts is running.")
            }
            _ => None,
        }
    }

    /// Carries out a command of the search.
    pub(in crate::app) fn shot_search_command(&mut self, command: Command) {
        match command {
            Command::FindShots => self.find_shots(),
            Command::StopShotSearch => {
                self.operations.shot_search.slot.cancel();
            }
            _ => {}
        }
    }

    /// Starts a search in a video that was just imported: the document has no shots, and no frame
    /// has users' work.
    pub(in crate::app) fn find_shots_of_new(&mut self) {
        let Some(open) = self.open.as_ref().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let is_untouched = open
            .document
            .frames
            .iter()
            .all(|frame| matches!(frame.status, FrameStatus::New | FrameStatus::Suggested));
        if !open.document.shots.is_empty() || !is_untouched {
            return;
        }
        // One search at a time: the first video.
        if let Some((video, path)) = without_shots(&open.document, &open.folder)
            .into_iter()
            .next()
        {
            self.begin_shot_search(video, path);
        }
    }

    /// Starts a search in the shown frame's video, even if it has been searched before.
    fn find_shots(&mut self) {
        let Some((open, frame)) = self.open.as_ref().zip(self.frame()) else {
            return;
        };
        let video = frame.video_path().map(str::to_owned);
        if let Some((video, path)) = video.zip(file_of(frame, &open.folder)) {
            self.begin_shot_search(video, path);
        }
    }

    fn begin_shot_search(&mut self, video: String, path: PathBuf) {
        let Some(open) = &self.open else { return };
        let shots = VideoShots::from_document(&open.document, &video);
        let known = shots.map_or_else(Vec::new, |shots| {
            shots.starts().map(|(from, _)| from).collect()
        });
        let num_below = open.history.num_done();
        self.start(ShotSearch {
            video,
            path,
            num_below,
            known,
        });
    }

    /// Writes the found shots into the document, beneath what the user has marked meanwhile.
    fn mark_found_shots(&mut self, search: &ShotSearch, found: &FoundShots) {
        let count = found.num_shots();
        let name = if count == 1 {
            "Mark the shot".to_owned()
        } else {
            format!("Mark {count} shots")
        };
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &mut self.open else { return };
        let step = Step::on_document(name.clone());
        let mark = |document: &mut Document| {
            let found = FoundCuts {
                last: found.last,
                cuts: &found.cuts,
                known: &search.known,
            };
            VideoShots::from_search(document, &search.video, found).write(document);
        };
        // True: the shots went below the user's own steps in the history. They are then no step of
        // their own in the journal, and the document is written with its whole history.
        if open.mark_shots(mark, step, search.num_below) {
            self.journal(&name, EditKind::NoStep);
            self.effects.push(Effect::WriteDocument);
        } else {
            self.journal(&name, EditKind::Step { frame: None });
        }
        if count > 1 {
            self.session.note(describe(found));
        }
    }
}

// ---- Words ----

/// The result, as text.
fn describe(found: &FoundShots) -> String {
    let fades = found
        .cuts
        .iter()
        .filter(|(_, kind)| *kind == ShotKind::Fade)
        .count();
    let fades = match fades {
        0 => String::new(),
        1 => " One begins after a fade, dissolve or wipe; the frames of that get no camera."
            .to_owned(),
        fades => format!(
            " {fades} begin after a fade, dissolve or wipe; the frames of these get no camera."
        ),
    };
    format!("{} shots found.{fades}", found.num_shots())
}
