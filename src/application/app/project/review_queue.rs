//! The queue of several matches, and of frames of them in the order in which they are looked at.
//!
//! While a queue is open, the queue panel lists its matches, and a command leads to the next one.
//! While it has frames, *Next frame to do* and accepting go to its next frame, which may be in
//! another project: that one is then opened. Opening anything else ends the queue; going past the
//! last frame ends one that has frames.
//!
//! How far a match has come is read from its project: of the open one with each change, of the
//! others once in the background.

use crate::app::App;
use crate::app::effect::{Beside, Effect};
use crate::app::window_state::session::Opening;
use crate::scene::match_list::MatchState;
use std::path::{Path, PathBuf};
use touchline_season::queue::QueuedMatch;

/// What is said past the last frame and before the first.
const END: &str = "That was the last frame of the queue.";
const BEGINNING: &str = "This is the first frame of the queue.";
/// What is said past the last match and before the first.
const LAST_MATCH: &str = "This is the last match of the queue.";
const FIRST_MATCH: &str = "This is the first match of the queue.";

/// A frame of a review queue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QueuedFrame {
    /// The file of its project.
    pub project: PathBuf,
    /// Its id in the project.
    pub frame: String,
}

/// A match of a queue.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchRow {
    /// Where it is, with absolute paths.
    pub queued: QueuedMatch,
    /// How far it has come; none until it was looked at.
    pub state: Option<MatchState>,
}

/// A queue, and how far it was worked through.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReviewQueue {
    rows: Vec<MatchRow>,
    /// The match that was opened last, or could not be.
    at: usize,
    /// Whether that match is being opened.
    is_opening: bool,
    frames: Vec<QueuedFrame>,
    /// The frame that is looked at.
    index: usize,
    /// The version of the open document that its row shows.
    shown_version: Option<u64>,
}

impl ReviewQueue {
    /// A queue at its first frame, or else at its first match.
    pub fn new(matches: Vec<QueuedMatch>, frames: Vec<QueuedFrame>) -> Self {
        let rows = matches.into_iter();
        let rows = rows
            .map(|queued| MatchRow {
                queued,
                state: None,
            })
            .collect();
        let first: Option<&QueuedFrame> = frames.first();
        let mut queue = Self {
            rows,
            ..Self::default()
        };
        queue.at = first
            .and_then(|frame| queue.row_of(&frame.project))
            .unwrap_or(0);
        queue.frames = frames;
        queue
    }

    /// Its matches.
    pub fn rows(&self) -> &[MatchRow] {
        &self.rows
    }

    /// The place of the match that was opened last, or could not be.
    pub const fn at(&self) -> usize {
        self.at
    }

    /// Notes that the match at a place is opened next; the reason of a failure is then its own.
    pub(crate) const fn begin_opening(&mut self, at: usize) {
        (self.at, self.is_opening) = (at, true);
    }

    /// Notes why the match that is being opened cannot be.
    pub(crate) fn fail_opening(&mut self, reason: &str) {
        if !std::mem::take(&mut self.is_opening) {
            return;
        }
        if let Some(row) = self.rows.get_mut(self.at) {
            row.state = Some(MatchState::from_failure(reason, row.queued.source()));
        }
    }

    /// The frame that is being looked at; none if no frame is queued.
    fn current(&self) -> Option<&QueuedFrame> {
        self.frames.get(self.index)
    }

    /// The number of that frame, counted from 1, and of all frames; none if no frame is queued.
    fn position(&self) -> Option<(usize, usize)> {
        self.current().map(|_| (self.index + 1, self.frames.len()))
    }

    /// Goes to the next frame, or to the previous one. False if there is none.
    fn step(&mut self, forward: bool) -> bool {
        let next = step_from(self.index, forward, self.frames.len());
        self.index = next.unwrap_or(self.index);
        next.is_some()
    }

    /// The place of the match with this project.
    fn row_of(&self, project: &Path) -> Option<usize> {
        self.rows
            .iter()
            .position(|row| row.queued.project == project)
    }

    /// Notes which project was opened. False if it is none of the queue.
    fn take_opened(&mut self, file: &Path) -> bool {
        self.shown_version = None;
        let is_own = std::mem::take(&mut self.is_opening);
        let row = self.row_of(file).or_else(|| is_own.then_some(self.at));
        let Some(row) = row.filter(|row| *row < self.rows.len()) else {
            return false;
        };
        // The project of frames may lie elsewhere than beside them, where that cannot be written.
        (self.at, self.rows[row].queued.project) = (row, file.to_path_buf());
        // A match that was opened by itself begins at its first frame in the queue.
        if self.current().is_some_and(|frame| frame.project != file) {
            let mut frames = self.frames.iter();
            let first = frames.position(|frame| frame.project == file);
            self.index = first.unwrap_or(self.index);
        }
        true
    }
}

/// The next or the previous index of a list of this length; none at its end.
fn step_from(index: usize, forward: bool, length: usize) -> Option<usize> {
    let next = if forward {
        index.checked_add(1)
    } else {
        index.checked_sub(1)
    };
    next.filter(|next| *next < length)
}

impl App {
    /// Takes a queue that was opened with a document, or goes on with the one that opened it.
    pub(in crate::app) fn continue_queue(&mut self, queue: Option<ReviewQueue>) {
        let is_new = queue.is_some();
        if is_new {
            self.queue = queue;
        }
        let (Some(queue), Some(open)) = (&mut self.queue, &self.open) else {
            return;
        };
        if !queue.take_opened(&open.file) {
            self.queue = None;
            return;
        }
        if is_new {
            let rows = queue.rows.iter();
            let matches = rows.map(|row| row.queued.clone()).collect();
            self.effects
                .push(Effect::ReadBeside(Beside::Matches(matches)));
        }
        self.show_queued_frame();
    }

    /// The queue that is being worked through.
    pub const fn queue(&self) -> Option<&ReviewQueue> {
        self.queue.as_ref()
    }

    /// The number of the frame in the review queue, counted from 1, and of all its frames; none
    /// without a queue of frames.
    pub fn queue_position(&self) -> Option<(usize, usize)> {
        self.queue.as_ref().and_then(ReviewQueue::position)
    }

    /// Opens a match of the queue.
    pub(in crate::app) fn open_match(&mut self, at: usize) {
        let Some(row) = self.queue.as_ref().and_then(|queue| queue.rows.get(at)) else {
            return;
        };
        let file = self.open.as_ref().map(|open| &open.file);
        if file == Some(&row.queued.project) {
            return;
        }
        let opening = Opening::Match(Box::new(row.queued.clone()));
        self.open_instead(opening);
        if let Some(queue) = &mut self.queue {
            queue.begin_opening(at);
        }
    }

    /// Opens the next match of the queue, or the previous one.
    pub(in crate::app) fn open_next_match(&mut self, forward: bool) {
        let Some(queue) = &self.queue else { return };
        if let Some(next) = step_from(queue.at, forward, queue.rows.len()) {
            self.open_match(next);
        } else {
            let text = if forward { LAST_MATCH } else { FIRST_MATCH };
            self.session.note(text);
        }
    }

    /// Whether the queue has a match after the open one.
    pub fn has_next_match(&self) -> bool {
        let queue = self.queue.as_ref();
        queue.is_some_and(|queue| queue.at + 1 < queue.rows.len())
    }

    /// Takes in how far a match of the queue has come. That of the open one is known better.
    pub(in crate::app) fn take_match_state(&mut self, project: &Path, state: MatchState) {
        let is_open = self.open.as_ref().is_some_and(|open| open.file == project);
        let Some(queue) = self.queue.as_mut().filter(|_| !is_open) else {
            return;
        };
        if let Some(row) = queue.row_of(project) {
            queue.rows[row].state = Some(state);
        }
    }

    /// Whatever is opened next is not the match that was to be opened.
    pub(in crate::app) const fn forget_match_to_open(&mut self) {
        if let Some(queue) = &mut self.queue {
            queue.is_opening = false;
        }
    }

    /// Notes why the match that was to be opened cannot be.
    pub(in crate::app) fn match_failed(&mut self, reason: &str) {
        if let Some(queue) = &mut self.queue {
            queue.fail_opening(reason);
        }
    }

    /// Brings the row of the open match up to date.
    pub(in crate::app) fn refresh_queue(&mut self) {
        let (Some(queue), Some(open)) = (&mut self.queue, &self.open) else {
            return;
        };
        let version = open.document.version();
        if queue.shown_version.replace(version) == Some(version) {
            return;
        }
        if let Some(row) = queue.row_of(&open.file) {
            let state = MatchState::from_document(&open.document, &open.folder);
            queue.rows[row].state = Some(state);
        }
    }

    /// Goes on to the next frame of the queue. False if no frame is queued.
    pub(in crate::app) fn go_on_in_queue(&mut self, forward: bool) -> bool {
        let Some(queue) = self.queue.as_mut().filter(|queue| !queue.frames.is_empty()) else {
            return false;
        };
        let has_next = queue.step(forward);
        if !has_next {
            let text = if forward { END } else { BEGINNING };
            self.session.note(text.to_owned());
            if forward {
                self.queue = None;
            }
            return true;
        }
        // In another project the queue waits; `continue_queue` shows the frame once that is open.
        let next = queue.current().and_then(|next| queue.row_of(&next.project));
        if let Some(next) = next
            && !self.show_queued_frame()
        {
            self.open_match(next);
        }
        true
    }

    /// Shows the present frame of the queue. False if it is in another project.
    fn show_queued_frame(&mut self) -> bool {
        let queued = self.queue.as_ref().and_then(ReviewQueue::current);
        let Some((open, queued)) = self.open.as_ref().zip(queued) else {
            return false;
        };
        if open.file != queued.project {
            return false;
        }
        let frames = &open.document.frames;
        // A frame that was taken out since is passed over with the next step.
        if let Some(index) = frames
            .iter()
            .position(|frame| frame.id.as_str() == queued.frame)
        {
            self.go_to(index);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::window_state::session::SidePanel;
    use crate::app::{Action, Command, DiskReport, Opened, Settings};
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Camera, Document, FrameStatus};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    /// Three suggestions.
    fn document() -> Document {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        let camera = Camera::new("main".into(), size);
        document.cameras.push(camera.into());
        for name in ["a.jpg", "b.jpg", "c.jpg"] {
            let mut frame = new_frame(name, size);
            frame.ptz = ptz_at(0.0, -9.0, 90.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        document
    }

    fn queued(name: &str) -> QueuedMatch {
        QueuedMatch {
            name: name.to_owned(),
            project: format!("/{name}/project.json").into(),
            frames: None,
            failed: None,
        }
    }

    fn opened(app: &mut App, name: &str, queue: Option<ReviewQueue>) -> Vec<Effect> {
        let mut opened = Opened::new(document(), queued(name).project);
        opened.queue = queue;
        app.update(Action::Opened(Box::new(opened)))
    }

    /// The name of the match that the effects open.
    fn opening(effects: &[Effect]) -> Option<&str> {
        effects.iter().find_map(|effect| match effect {
            Effect::Open(Opening::Match(queued)) => Some(queued.name.as_str()),
            _ => None,
        })
    }

    /// Everything is written.
    fn end_saving(app: &mut App) -> Vec<Effect> {
        app.update(Action::Disk(DiskReport::Saved {
            revision: app.open().unwrap().revision,
            at: "12:00:00".to_owned(),
            document: Some(app.session.disk.save_requests),
        }))
    }

    #[test]
    fn accepting_goes_on_in_the_queue_also_while_the_review_panel_is_open() {
        let document = document();
        let frames = [0, 2].map(|index: usize| QueuedFrame {
            project: "/match/project.json".into(),
            frame: document.frames[index].id.as_str().to_owned(),
        });
        let queue = ReviewQueue::new(vec![queued("match")], frames.to_vec());
        let mut app = App::new(Settings::default());
        opened(&mut app, "match", Some(queue));
        app.session.panel = SidePanel::Review;
        app.update(Action::Command(Command::Accept));
        assert_eq!(app.session.frame, 2);
    }

    #[test]
    fn a_queue_of_matches_leads_from_one_to_the_next_past_one_that_fails() {
        let mut app = App::new(Settings::default());
        assert!(app.why_not(Command::NextMatch).is_some());
        let matches = ["one", "two", "three"].map(queued).to_vec();
        let effects = opened(
            &mut app,
            "one",
            Some(ReviewQueue::new(matches.clone(), Vec::new())),
        );
        assert!(effects.contains(&Effect::ReadBeside(Beside::Matches(matches))));
        let says = |app: &App, at: usize| {
            let row = &app.queue().unwrap().rows()[at];
            row.state.as_ref().map(MatchState::describe)
        };
        assert_eq!(
            says(&app, 0).as_deref(),
            Some("no camera yet"),
            "known at once"
        );
        assert_eq!(says(&app, 1), None);
        // The open match changes, and its row with it; accepting stays within it.
        app.update(Action::Command(Command::Accept));
        assert_eq!(says(&app, 0).as_deref(), Some("1 of 3 frames accepted"));
        assert_eq!((app.session.frame, app.queue_position()), (1, None));

        // Its edits are written before the next one opens.
        assert_eq!(
            opening(&app.update(Action::Command(Command::NextMatch))),
            None
        );
        assert_eq!(opening(&end_saving(&mut app)), Some("two"));
        let reason = "two: damaged".to_owned();
        app.update(Action::Disk(DiskReport::Failed(reason)));
        assert_eq!(says(&app, 1).as_deref(), Some("failed: two: damaged"));
        app.update(Action::Command(Command::NextMatch));
        assert_eq!(opening(&end_saving(&mut app)), Some("three"));
        opened(&mut app, "three", None);
        assert_eq!(app.queue().unwrap().at(), 2);
        assert!(!app.has_next_match());
        assert_eq!(
            opening(&app.update(Action::Command(Command::NextMatch))),
            None
        );
        assert_eq!(opening(&app.update(Action::OpenMatch(0))), Some("one"));
        // What was looked at in the background comes late for no match but the open one.
        let state = MatchState::from_failure("gone", Path::new("/two"));
        for project in ["two", "three"].map(|name| queued(name).project) {
            let state = Box::new(state.clone());
            app.update(Action::Disk(DiskReport::MatchSeen { project, state }));
        }
        assert_eq!(says(&app, 1).as_deref(), Some("failed: gone"));
        assert_eq!(says(&app, 2).as_deref(), Some("no camera yet"));
        // Something else is opened in place of the match.
        app.forget_match_to_open();
        opened(&mut app, "elsewhere", None);
        assert!(app.queue().is_none(), "it was not opened by the queue");
    }
}
