//! Plays the video, accepts what was played, and goes to a frame number or a time.

use super::App;
use crate::app::Command;
use crate::app::playing::frame_earlier;
use crate::app::window_state::place::FrameOrTime;
use crate::app::window_state::session::{Level, Mode};
use touchline_core::geometry::pluralise;
use touchline_documents::document::FrameStatus;

/// How long it takes to see that lines are off and to press a key, s. Reactions that choose between
/// two answers take 0.4 to 0.6 s.
const REACTION_S: f64 = 0.6;

impl App {
    /// Plays or pauses the video. At the end, starts from the first frame.
    pub(super) fn toggle_playing(&mut self) {
        if self.session.video.playing {
            self.pause();
            return;
        }
        let last = self
            .open
            .as_ref()
            .map_or(0, |open| open.document.frames.len().saturating_sub(1));
        if self.session.frame == last {
            self.go_to(0);
        }
        let here = self.session.frame;
        let video = &mut self.session.video;
        video.playing = self.session.mode == Mode::Idle;
        // After a pause it goes on.
        video.played = video.played.filter(|(_, to)| *to == here);
    }

    /// Shows the frame that is due in the playing video.
    pub(super) fn play_to(&mut self, frame: usize) {
        let from = self
            .session
            .video
            .played
            .map_or(self.session.frame, |(from, _)| from);
        self.go_to(frame);
        self.session.video.played = Some((from, self.session.frame));
    }

    /// Pauses the video, and offers to accept what was played.
    pub(super) fn pause(&mut self) {
        self.session.video.playing = false;
        let watched = self.watched_suggestions(usize::MAX).len();
        if watched > 0 {
            let text = format!("{} played.", pluralise(watched, "suggestion"));
            let button = ("Accept them", Command::AcceptPlayed);
            self.session.notify_with(Level::Info, text, [button]);
        }
    }

    /// Accepts the suggestions that were played.
    pub(super) fn accept_played(&mut self) {
        let frames = self.watched_suggestions(usize::MAX);
        self.accept_watched(&frames);
    }

    /// Stops where lines begin to be off: the suggestions that were played before are accepted, and
    /// the first frame after them is shown. While the video plays, that is as much earlier as a
    /// person takes to press the key.
    pub(super) fn stop_at_wrong(&mut self) {
        let wrong = match &self.open {
            Some(open) if self.session.video.playing => {
                let earlier_s = REACTION_S * self.session.video.speed.0;
                frame_earlier(open, self.session.frame, earlier_s)
            }
            _ => self.session.frame,
        };
        self.session.video.playing = false;
        // Elsewhere it says nothing of what was played.
        let mut frames = Vec::new();
        if let Some((from, to)) = self.session.video.played
            && (from..=to).contains(&wrong)
        {
            frames = self.watched_suggestions(wrong);
        }
        self.go_to(wrong);
        self.accept_watched(&frames);
    }

    /// Whether suggestions were played since the video was started, or since a jump in it.
    pub(super) fn has_watched(&self) -> bool {
        self.session
            .video
            .played
            .is_some_and(|(from, to)| (from..=to).any(|it| self.can_watch(it)))
    }

    /// The suggestions that were played, up to a frame and without it.
    fn watched_suggestions(&self, end: usize) -> Vec<usize> {
        let Some((from, to)) = self.session.video.played else {
            return Vec::new();
        };
        (from..end.min(to + 1))
            .filter(|it| self.can_watch(*it))
            .collect()
    }

    /// Whether a frame has a suggestion that can be accepted by looking at it.
    fn can_watch(&self, index: usize) -> bool {
        let frame = self.open.as_ref().and_then(|open| open.frame(index));
        frame.is_some_and(|frame| {
            frame.status == FrameStatus::Suggested
                && frame.ptz.is_some()
                && frame.unnamed_click().is_none()
        })
    }

    fn accept_watched(&mut self, frames: &[usize]) {
        if frames.is_empty() {
            let none = "No suggestion was played up to here.";
            self.session.note(none);
            return;
        }
        if self.accept_together(frames, "suggestion", true) {
            self.session.video.played = None;
            self.session.retract(Command::AcceptPlayed);
        }
    }

    /// Shows the frame with a number, or the one at a time of the shown frame's video. If there is
    /// none, the nearest.
    pub(super) fn go_to_place(&mut self, place: FrameOrTime) {
        let Some(open) = &self.open else { return };
        let frame = match place {
            FrameOrTime::Frame(wanted) => {
                // A document may have every n-th frame of a video only.
                let nearest = open
                    .frame_numbers_in_video(self.session.frame)
                    .min_by_key(|(_, number)| number.abs_diff(wanted));
                if let Some((_, number)) = nearest.filter(|(_, number)| *number != wanted) {
                    let text = format!("There is no frame {wanted}: the nearest one is {number}.");
                    self.session.note(text);
                }
                nearest.map(|(position, _)| position)
            }
            // Only frames of the shown frame's video; if that has none, of any video.
            FrameOrTime::Time(wanted_s) => {
                let video = self.frame().and_then(|frame| frame.video.as_ref());
                let timed =
                    open.document
                        .frames
                        .iter()
                        .enumerate()
                        .filter_map(|(position, frame)| {
                            let of = frame
                                .video
                                .as_ref()
                                .filter(|of| video.is_none_or(|video| video.path == of.path))?;
                            Some((position, of.pts_s?))
                        });
                timed
                    .min_by(|(_, a), (_, b)| (a - wanted_s).abs().total_cmp(&(b - wanted_s).abs()))
                    .map(|(at, _)| at)
            }
        };
        self.session.dialog = None;
        match frame {
            Some(frame) => self.go_to(frame),
            None => self
                .session
                .note("These frames have no times: type the number of a frame."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, ViewAction};
    use crate::testing::proposed::suggestions;

    /// Suggestions at 25 frames a second; frame 30 has none.
    fn app() -> App {
        let mut confidences = [Some(0.9); 60];
        confidences[30] = None;
        App::with_document(suggestions(&confidences))
    }

    fn run(app: &mut App, command: Command) {
        app.update(Action::Command(command));
    }

    /// Plays from a frame to another one.
    fn play(app: &mut App, from: usize, to: usize) {
        app.go_to(from);
        run(app, Command::PlayPause);
        for frame in from + 1..=to {
            app.update(Action::View(ViewAction::PlayTo(frame)));
        }
    }

    fn accepted(app: &App) -> Vec<usize> {
        let frames = app.open().unwrap().document.frames.iter().enumerate();
        frames
            .filter(|(_, frame)| frame.status == FrameStatus::Reference)
            .map(|(index, _)| index)
            .collect()
    }

    #[test]
    fn what_was_played_is_accepted_and_nothing_else() {
        let mut app = app();
        assert!(app.why_not(Command::AcceptPlayed).is_some());
        play(&mut app, 25, 35);
        run(&mut app, Command::PlayPause);
        assert!(app.session.offers(Command::AcceptPlayed));
        run(&mut app, Command::AcceptPlayed);
        let expected: Vec<usize> = (25..=35).filter(|at| *at != 30).collect();
        assert_eq!(accepted(&app), expected);
        assert!(!app.session.offers(Command::AcceptPlayed));
        run(&mut app, Command::Undo);
        assert!(accepted(&app).is_empty());
    }

    #[test]
    fn a_jump_in_a_playing_video_begins_anew_and_a_pause_does_not() {
        let mut app = app();
        play(&mut app, 0, 5);
        app.go_to(20);
        app.update(Action::View(ViewAction::PlayTo(21)));
        run(&mut app, Command::PlayPause);
        run(&mut app, Command::PlayPause);
        app.update(Action::View(ViewAction::PlayTo(22)));
        run(&mut app, Command::AcceptPlayed);
        assert_eq!(accepted(&app), [20, 21, 22]);
    }

    /// At twice the speed a person presses the key 1.2 s of the video late: 30 frames.
    #[test]
    fn frames_that_went_by_before_the_key_was_pressed_wait() {
        let mut app = app();
        app.session.video.speed.0 = 2.0;
        play(&mut app, 0, 50);
        run(&mut app, Command::StopAtWrong);
        assert_eq!((app.session.frame, app.session.video.playing), (20, false));
        assert_eq!(accepted(&app), (0..20).collect::<Vec<_>>());
        // While it stands still, the shown frame is the first that is wrong.
        play(&mut app, 40, 50);
        run(&mut app, Command::PlayPause);
        app.go_to(45);
        run(&mut app, Command::StopAtWrong);
        assert_eq!((app.session.frame, accepted(&app).len()), (45, 25));
        // Elsewhere nothing was seen.
        play(&mut app, 45, 48);
        run(&mut app, Command::PlayPause);
        app.go_to(55);
        run(&mut app, Command::StopAtWrong);
        assert_eq!(accepted(&app).len(), 25);
    }
}
