//! Gold frames: marking and choosing them, clicking them again in a blind round, and using the
//! click noise measured from that.
//!
//! In a blind round the user clicks the landmarks of gold frames again without seeing the labels.
//! The differences between clicks on the same landmark show the annotator's click noise.

use super::clicks::clamp_to_picture;
use crate::app::window_state::reclick::{Reclick, ReclickTarget};
use crate::app::window_state::session::{Level, Mode, PictureView};
use crate::app::{Action, App, Command, GoldWork, Tool};
use std::sync::LazyLock;
use touchline_calibration::calibrate::{BulkChange, ENOUGH_REPEATS, choose_gold};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{ClickNoise, EditKind, Repeat, Step, Target};

/// Shown when the user tries something that would show the label or leave the round.
pub(in crate::app::update) const IN_ROUND: &str = "A blind round is under way: end it first (Esc).";

impl App {
    /// The present blind round, if any.
    pub const fn round(&self) -> Option<&Reclick> {
        match &self.session.mode {
            Mode::ClickingAgain(round) => Some(round),
            _ => None,
        }
    }

    /// The values about gold frames and their repeats.
    pub fn gold(&self) -> &GoldWork {
        static NOTHING: LazyLock<GoldWork> = LazyLock::new(GoldWork::default);
        self.open
            .as_ref()
            .map_or(&NOTHING, |open| open.derived.last_gold())
    }

    /// Whether an action would break the present blind round. Shows a message if so.
    pub(in crate::app::update) fn breaks_round(&mut self, action: &Action) -> bool {
        let breaks = self.round().is_some() && !action.is_blind();
        if breaks {
            self.session.note(IN_ROUND);
        }
        breaks
    }

    /// Updates the values about gold frames and their repeats.
    pub(in crate::app::update) fn refresh_gold(&mut self) {
        if let Some(open) = &mut self.open {
            open.derived.gold(&open.document);
        }
    }

    /// Marks or unmarks the shown frame as gold.
    pub(in crate::app::update) fn toggle_gold(&mut self) {
        let Some(frame) = self.frame() else { return };
        let gold = !frame.gold;
        if let Some(reason) = frame.why_not_gold().filter(|_| gold) {
            self.session.note(reason);
            return;
        }
        let step = if gold {
            "Mark as gold"
        } else {
            "Remove the gold mark"
        };
        if self.begin(step) {
            if let Some(frame) = self.frame_mut() {
                frame.gold = gold;
            }
            self.commit();
        }
    }

    /// Marks references as gold that the program chooses; one step of undo.
    pub(in crate::app::update) fn choose_gold(&mut self) {
        let Some(open) = &self.open else { return };
        let chosen = choose_gold(&open.document);
        let count = match chosen.len() {
            1 => "1 frame is gold now".to_owned(),
            count => format!("{count} frames are gold now"),
        };
        if self.begin_step(Step::on_document("Choose gold frames")) {
            if let Some(open) = &mut self.open {
                for index in chosen {
                    if let Some(frame) = open.document.frames.get_mut(index) {
                        frame.gold = true;
                    }
                }
            }
            self.commit();
            let text = format!(
                "{count}. Click them again once you no longer remember the labels, tomorrow for example."
            );
            self.session
                .notify_with(Level::Info, text, [("Click again", Command::ClickAgain)]);
        }
    }

    /// Starts a blind round, or ends the present one.
    pub(in crate::app::update) fn click_again(&mut self) {
        if self.round().is_some() {
            self.end_round();
            return;
        }
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &self.open else { return };
        let round = Reclick::from_document(&open.document);
        if round.is_empty() {
            let text = "No frame is gold. Mark a few references, or let the program choose them.";
            self.session
                .notify_with(Level::Info, text, [("Choose them", Command::ChooseGold)]);
            return;
        }
        self.commit_open_step();
        // Hide whatever could show the label, and show the first frame of the round.
        self.session.points.selected = None;
        self.session.forget_placed();
        self.session.points.next_on_line = false;
        self.session.picture.tool = Tool::Point;
        self.session.picture.held = crate::app::window_state::session::HeldCommands::default();
        self.session.quality.open = false;
        self.session.picture.view = PictureView::Fit;
        self.session.mode = Mode::ClickingAgain(round);
        self.show_frame_to_repeat();
    }

    /// Shows the frame of the next landmark, or ends the round if there is none.
    fn show_frame_to_repeat(&mut self) {
        match self.round().map(|round| round.target().cloned()) {
            Some(Some(ReclickTarget { frame, .. })) if frame != self.session.frame => {
                self.session.frame = frame;
                self.session.points.hover = None;
                self.session.picture.view = PictureView::Fit;
            }
            Some(None) => self.end_round(),
            _ => {}
        }
    }

    fn round_mut(&mut self) -> Option<&mut Reclick> {
        match &mut self.session.mode {
            Mode::ClickingAgain(round) => Some(round),
            _ => None,
        }
    }

    /// Handles the pressed button (`began`), or the pointer moved with it: the click follows the
    /// pointer, but stays within the picture.
    pub(super) fn hold_again(&mut self, at: ImagePoint, began: bool) {
        let Some(size) = self.frame().map(|frame| frame.image_size) else {
            return;
        };
        if !at.is_finite() || (began && !size.contains(at)) {
            return;
        }
        if let Some(round) = self
            .round_mut()
            .filter(|round| began || round.held.is_some())
        {
            round.held = Some(clamp_to_picture(at, size));
        }
    }

    /// Handles the released button: stores the click as a step of undo, and continues with the next
    /// landmark.
    pub(super) fn release_again(&mut self) {
        let Some(round) = self.round_mut() else {
            return;
        };
        let Some((at, target)) = round.held.take().zip(round.target().cloned()) else {
            return;
        };
        // The mode stays: the next landmark follows at once.
        let number = round.round;
        let step = self.step_at(self.step_again(&target), target.frame);
        if !self.begin_step(step) {
            return;
        }
        let time = self.clock.map(|clock| format!("{:.0}", clock()));
        if let Some(frame) = self.frame_mut_at(target.frame) {
            frame.repeats.push(Repeat {
                at: time,
                ..Repeat::new(target.landmark, at, number)
            });
        }
        self.commit();
        if let Some(round) = self.round_mut() {
            round.take_click();
        }
        self.show_frame_to_repeat();
    }

    /// Skips the present landmark.
    pub(in crate::app::update) fn skip_again(&mut self) {
        if let Some(round) = self.round_mut() {
            round.skip();
            self.show_frame_to_repeat();
        }
    }

    /// Undoes the last click of the round, and asks for the same landmark again.
    pub(in crate::app::update) fn undo_again(&mut self) {
        let Some(round) = self.round_mut() else {
            return;
        };
        if round.held.take().is_some() {
            return;
        }
        if round.clicked_count() == 0 {
            self.session.note("No points have been clicked again yet.");
            return;
        }
        round.go_back();
        let (target, number) = (round.target().cloned(), round.round);
        if let Some(target) = target {
            self.take_back_again(&target, number);
        }
        self.show_frame_to_repeat();
    }

    /// Removes the click of a landmark in this round. This is an undo if the click is the last step
    /// in the history, otherwise a new step.
    fn take_back_again(&mut self, target: &ReclickTarget, round: u32) {
        let step = self.step_at(self.step_again(target), target.frame);
        let Some(open) = &mut self.open else { return };
        // If the user has made other steps since, they must not be undone for this.
        if open
            .history
            .next_undo()
            .is_some_and(|last| last.is_alike(&step))
        {
            open.undo(true);
            self.journal(&format!("Undone: {}", step.name), EditKind::Undone);
            return;
        }
        let name = format!("Take back: {}", step.name);
        if !self.begin_step(self.step_at(name, target.frame)) {
            return;
        }
        if let Some(frame) = self.frame_mut_at(target.frame) {
            let last = frame
                .repeats
                .iter()
                .rposition(|repeat| repeat.landmark == target.landmark && repeat.round == round);
            if let Some(last) = last {
                frame.repeats.remove(last);
            }
        }
        self.commit();
    }

    /// The name of the step that clicks a landmark again. Undo recognises the step by it.
    fn step_again(&self, target: &ReclickTarget) -> String {
        let target = Target::Landmark(target.landmark.clone());
        format!("Click {} again", self.label(&target))
    }

    /// Ends the round. Clicks of the round are kept.
    pub(in crate::app::update) fn end_round(&mut self) {
        let Some(clicked) = self.round().map(Reclick::clicked_count) else {
            return;
        };
        self.session.mode = Mode::Idle;
        self.refresh_gold();
        let (text, button) = self.describe_round(clicked);
        self.session.notify_with(Level::Info, text, button);
    }

    /// The result of a round as text, and the command on its button.
    fn describe_round(&self, clicked: usize) -> (String, Option<(&'static str, Command)>) {
        let own = &self.gold().own;
        let clicked = match clicked {
            0 => return ("Nothing was clicked again.".to_owned(), None),
            1 => "1 blind click is kept".to_owned(),
            clicked => format!("{clicked} blind clicks are kept"),
        };
        match &own.noise {
            Some(noise) if own.click_noise.is_some() => {
                let [low, high] = noise.interval_95;
                let text = format!(
                    "{clicked}. Your click noise is {:.2} px (95 %: {low:.2} to {high:.2}).",
                    noise.sigma
                );
                let is_available = self.why_not(Command::UseOwnNoise).is_none();
                (
                    text,
                    is_available.then_some(("Use it", Command::UseOwnNoise)),
                )
            }
            _ => (
                format!(
                    "{clicked}; after {} more your click noise can be used.",
                    own.missing().max(1)
                ),
                None,
            ),
        }
    }

    /// The annotator's click noise, if the document uses it.
    fn click_noise_in_use(&self) -> Option<ClickNoise> {
        self.open
            .as_ref()
            .and_then(|open| open.document.click_noise_in_use())
    }

    /// Why the annotator's click noise cannot be used. None if it can.
    pub(in crate::app::update) fn why_not_own_noise(&self) -> Option<&'static str> {
        /// Shown while there are too few repeats.
        const TOO_FEW: &str = "At least 12 blind clicks of gold frames are needed.";
        const { assert!(ENOUGH_REPEATS == 12, "the message names the number") };
        match &self.gold().own.click_noise {
            None => Some(TOO_FEW),
            Some(noise) if self.click_noise_in_use().as_ref() == Some(noise) => {
                Some("Your points already use it.")
            }
            Some(_) => None,
        }
    }

    /// Why the usual click noise cannot be used. None if it can.
    pub(in crate::app::update) fn why_not_usual_noise(&self) -> Option<&'static str> {
        self.click_noise_in_use()
            .is_none()
            .then_some("Your points already use the usual click noise.")
    }

    /// Weights the clicks by the annotator's own click noise as measured so far.
    pub(in crate::app::update) fn use_own_noise(&mut self) {
        if let Some(noise) = self.gold().own.click_noise.clone() {
            self.weight_clicks("Use my click noise", &noise);
        }
    }

    /// Weights the clicks by the usual click noise again. The annotator's stays in the document,
    /// unused.
    pub(in crate::app::update) fn use_usual_noise(&mut self) {
        if let Some(noise) = self.click_noise_in_use() {
            self.weight_clicks(
                "Use the usual click noise",
                &ClickNoise {
                    in_use: false,
                    ..noise
                },
            );
        }
    }

    /// Stores a click noise and solves all frames from clicks again; one step of undo.
    fn weight_clicks(&mut self, step: &'static str, noise: &ClickNoise) {
        let Some(open) = &self.open else { return };
        let mut numbers = open.document.clone();
        if let Err(error) = numbers.set_click_noise(noise) {
            self.session
                .warn(format!("The click noise cannot be stored: {error}."));
            return;
        }
        if self.change_in_bulk(
            Step::on_document(step),
            BulkChange::Numbers(Box::new(numbers)),
            |_, _| (),
        ) {
            self.session.retract(Command::UseOwnNoise);
        }
    }
}
