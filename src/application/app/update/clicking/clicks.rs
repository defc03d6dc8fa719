//! Places, moves and removes clicks.

use crate::app::window_state::session::{Level, Mode};
use crate::app::{App, Command, Tool};
use touchline_core::geometry::{ImagePoint, ImageSize, pluralise};
use touchline_documents::document::{Click, FrameStatus, Step};

/// The name of the step of undo that places a click.
const PLACE_POINT: &str = "Place point";

impl App {
    /// Handles the pressed button at `at` (px of the picture), over the click `on` if any. During a
    /// blind round it places a blind click.
    pub(in crate::app::update) fn press(&mut self, at: ImagePoint, on: Option<usize>) {
        if self.round().is_some() {
            self.hold_again(at, true);
            return;
        }
        self.session.forget_placed();
        self.session.points.grabbed = None;
        let Some(frame) = self.frame() else { return };
        if !at.is_finite() {
            return;
        }
        // What a press means, from what is open to what lies under the pointer.
        let size = frame.image_size;
        let rejected = frame.status == FrameStatus::Rejected;
        // A press elsewhere closes an open list of names or of reasons, and does nothing else.
        if let Mode::Naming(_) = self.session.mode {
            self.leave_naming();
            if on.is_none() {
                return;
            }
        }
        if matches!(self.session.mode, Mode::Rejecting { .. }) {
            self.session.mode = Mode::Idle;
            return;
        }
        // On a click: start to drag it.
        if let Some(click) = on {
            let name = self.click_name(click);
            self.session.points.selected = Some(click);
            if self.begin(format!("Move {name}")) {
                self.session.mode = Mode::Dragging {
                    click,
                    placed: false,
                };
            }
            return;
        }
        // Beside the picture, or by a tool that places nothing: deselect.
        let tool = self.session.picture.tool;
        let places = matches!(self.session.mode, Mode::Placing(_))
            || !matches!(tool, Tool::Select | Tool::Mask);
        if !size.contains(at) || !places {
            self.session.points.selected = None;
            return;
        }
        if rejected {
            self.session
                .note("This frame is marked as not calibratable. X removes the mark.");
            return;
        }
        // On the picture: place a click, with the landmark that was chosen before, if any, and
        // start to drag it. Without a choice, it is named as soon as exactly one name is plausible.
        let placing = match std::mem::take(&mut self.session.mode) {
            Mode::Placing(target) => Some(target),
            _ => None,
        };
        let mut click = match placing {
            Some(target) => Click::new(target, at),
            None => Click::without_name(at),
        };
        click.check = tool == Tool::Check;
        // The step stays open until the button is released: the drag belongs to it.
        let (placed, named) = (click.target.is_none(), click.target.clone());
        if !self.begin(PLACE_POINT) {
            return;
        }
        let Some(frame) = self.frame_mut() else {
            return;
        };
        frame.clicks.push(click);
        let index = frame.clicks.len() - 1;
        self.session.points.selected = Some(index);
        self.session.mode = Mode::Dragging {
            click: index,
            placed,
        };
        if placed {
            self.name_if_certain(index);
        }
        self.clicks_changed();
        if let Some(target) = named {
            self.warn_of_unmarked(&target);
        }
    }

    /// Whether placing a click of the shown frame was the last step.
    pub(in crate::app::update) fn is_placed_last(&self, click: usize) -> bool {
        let (Some(open), Some(frame)) = (&self.open, self.frame()) else {
            return false;
        };
        let last = open.history.next_undo();
        last.is_some_and(|step| step.name == PLACE_POINT && step.frame.as_ref() == Some(&frame.id))
            && click + 1 == frame.clicks.len()
    }

    /// Handles the pointer moved with the button down.
    pub(in crate::app::update) fn drag(&mut self, to: ImagePoint) {
        if self.round().is_some() {
            self.hold_again(to, false);
            return;
        }
        let Mode::Dragging { click, placed } = self.session.mode else {
            return;
        };
        if let Some(element) = self.session.points.grabbed.take() {
            self.drag_grabbed(element, to);
            return;
        }
        self.move_click(click, to);
        if placed {
            self.name_if_certain(click);
        }
        self.clicks_changed();
    }

    /// Handles the released button. With `exactly` the point stays there, even if its landmark is
    /// painted nearby.
    pub(in crate::app::update) fn release(&mut self, exactly: bool) {
        if self.round().is_some() {
            self.release_again();
            return;
        }
        let Mode::Dragging { click, placed } = self.session.mode else {
            return;
        };
        self.session.mode = Mode::Idle;
        self.session.points.grabbed = None;
        let revision = self.open.as_ref().map(|open| open.revision);
        self.commit();
        // The revision tells whether the step changed anything.
        let moved = self.open.as_ref().map(|open| open.revision) != revision;
        if moved {
            self.snap_later(click, exactly);
            self.track_doubtful_neighbours();
        }
        let unnamed = self
            .frame()
            .and_then(|frame| frame.clicks.get(click))
            .is_some_and(|click| click.target.is_none());
        if unnamed {
            self.open_naming(click);
        } else if placed {
            // As after a choice from the list: only this point was to be on a line.
            self.session.points.next_on_line = false;
            self.session.points.named_automatically = Some(click);
        }
    }

    /// Moves a click to a point, clamped to the picture. The click no longer counts as aligned to
    /// paint.
    pub(super) fn move_click(&mut self, click: usize, to: ImagePoint) {
        let Some(frame) = self.frame_mut() else {
            return;
        };
        let size = frame.image_size;
        if let Some(click) = frame.clicks.get_mut(click)
            && to.is_finite()
        {
            click.take_over();
            click.image = clamp_to_picture(to, size);
            click.snapped_sigma_px = None;
        }
    }

    /// Selects a click, or none.
    pub(in crate::app::update) fn select(&mut self, click: Option<usize>) {
        self.session.points.selected = click;
        self.clamp_selection();
    }

    /// Moves the selected click. While the key is `held` down, all movements form one step of undo.
    pub(in crate::app::update) fn nudge(&mut self, dx_px: f64, dy_px: f64, held: bool) {
        let Some(click) = self.session.points.selected else {
            return;
        };
        let Some(at) = self
            .frame()
            .and_then(|frame| frame.clicks.get(click))
            .map(|click| click.image)
        else {
            return;
        };
        let name = self.click_name(click);
        let step = self.step_at(format!("Nudge {name}"), self.session.frame);
        // A key that repeats reopens its own last step, so that one undo takes all of it back.
        let resumed = held && self.open.as_mut().is_some_and(|open| open.resume(&step));
        if resumed || self.begin_step(step) {
            // The user has seen the name and moved on to the position.
            self.session.points.named_automatically = None;
            self.move_click(click, ImagePoint::new(at.x + dx_px, at.y + dy_px));
            self.clicks_changed();
            self.commit();
        }
    }

    /// Removes a click; one step of undo.
    pub(in crate::app::update) fn delete_click(&mut self, click: usize) {
        if self.frame().is_none_or(|frame| click >= frame.clicks.len()) {
            return;
        }
        let name = self.click_name(click);
        self.session.mode = Mode::Idle;
        self.session.forget_placed();
        if self.begin(format!("Delete {name}")) {
            if let Some(frame) = self.frame_mut() {
                frame.refuse_clicks(|place, _| place == click);
            }
            self.session.points.selected = None;
            self.clicks_changed();
            self.commit();
        }
    }

    /// Makes a click a check click, which is held out of the solve, or a normal one; one step of
    /// undo.
    pub(in crate::app::update) fn set_check(&mut self, click: usize, check: bool) {
        let name = self.click_name(click);
        let step = if check {
            format!("Make {name} a check point")
        } else {
            format!("Use {name}")
        };
        if self.begin(step) {
            if let Some(click) = self
                .frame_mut()
                .and_then(|frame| frame.clicks.get_mut(click))
            {
                click.check = check;
            }
            self.clicks_changed();
            self.commit();
        }
    }

    /// Selects the next or previous click of the frame, cyclically.
    pub(in crate::app::update) fn step_click(&mut self, forward: bool) {
        let count = self.frame().map_or(0, |frame| frame.clicks.len());
        if count == 0 {
            return;
        }
        self.session.points.selected = Some(match (self.session.points.selected, forward) {
            (None, true) => 0,
            (None, false) => count - 1,
            (Some(click), true) => (click + 1) % count,
            (Some(click), false) => (click + count - 1) % count,
        });
    }

    /// The name of a click in messages and in the history: its label, or "point".
    pub(super) fn click_name(&self, click: usize) -> String {
        let target = self
            .frame()
            .and_then(|frame| frame.clicks.get(click))
            .and_then(|click| click.target.as_ref());
        target.map_or_else(|| "point".to_owned(), |target| self.label(target))
    }
}

/// The point of a picture, its border included, that is nearest to `at`. `at` must be finite.
pub(super) fn clamp_to_picture(at: ImagePoint, size: ImageSize) -> ImagePoint {
    ImagePoint::new(
        at.x.clamp(0.0, f64::from(size.width)),
        at.y.clamp(0.0, f64::from(size.height)),
    )
}

impl App {
    /// The model whose points the shown frame has: that of the first of them.
    fn shown_model(&self) -> Option<&str> {
        let mut clicks = self.frame()?.clicks.iter();
        clicks.find_map(|click| Some(click.model_origin()?.model()))
    }

    /// Why there are no points of a model to remove. None if there are.
    pub(in crate::app::update) fn why_not_remove_points(&self) -> Option<&'static str> {
        let none = self.shown_model().is_none();
        none.then_some("This frame has no points of another program's model.")
    }

    /// Removes the points of the shown frame's model from all frames, with the cameras that rest on
    /// them alone; one step of undo.
    pub(in crate::app::update) fn remove_points_of_model(&mut self) {
        let Some(model) = self.shown_model().map(ToOwned::to_owned) else {
            return;
        };
        self.session.mode = Mode::Idle;
        self.session.forget_placed();
        if !self.begin_step(Step::on_document(format!("Remove the points of {model}"))) {
            return;
        }
        let is_meant = |click: &Click| {
            let origin = click.origin.as_ref();
            origin.is_some_and(|origin| origin.model() == model)
        };
        let frames = self
            .open
            .as_ref()
            .map_or(0, |open| open.document.frames.len());
        let mut removed = 0;
        for index in 0..frames {
            // A frame is copied when it is borrowed to be changed.
            let has_some = self.open.as_ref().and_then(|open| open.frame(index));
            let has_some = has_some.is_some_and(|frame| {
                frame
                    .clicks
                    .iter()
                    .chain(&frame.refused_points)
                    .any(is_meant)
            });
            if has_some && let Some(frame) = self.frame_mut_at(index) {
                removed += frame.remove_points_of(Some(&model));
            }
        }
        self.session.points.selected = None;
        self.commit();
        let text = format!("{} of {model} removed.", pluralise(removed, "point"));
        self.session
            .notify_with(Level::Info, text, [("Undo", Command::Undo)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, Command, EditAction, Effect, Navigation, PointerAction};
    use touchline_core::testing::SIZE;
    use touchline_documents::document::Frame;
    use touchline_documents::testing::{a_match, new_frame};

    /// A frame with one click.
    fn app(at: ImagePoint) -> App {
        let mut document = a_match(SIZE);
        let mut frame = Frame {
            status: FrameStatus::Draft,
            ..new_frame("a.jpg", SIZE)
        };
        frame.clicks.push(Click::landmark("centre_mark".into(), at));
        document.frames.push(frame.into());
        App::with_document(document)
    }

    fn image(app: &App) -> ImagePoint {
        app.frame().unwrap().clicks[0].image
    }

    #[test]
    fn a_drag_ends_with_its_step() {
        let at = ImagePoint::new(500.0, 400.0);
        let mut app = app(at);
        let drag_to = |x| Action::Pointer(PointerAction::Drag(ImagePoint::new(x, 400.0)));
        app.update(Action::Pointer(PointerAction::Press { at, on: Some(0) }));
        app.update(drag_to(520.0));
        app.update(Action::Command(Command::Save));
        app.update(drag_to(700.0));
        app.update(Action::Pointer(PointerAction::Release));
        assert_eq!(image(&app), ImagePoint::new(520.0, 400.0));
        app.update(Action::Command(Command::Undo));
        assert_eq!(image(&app), at);
    }

    #[test]
    fn a_held_arrow_key_is_one_step_and_each_edit_is_journalled() {
        let at = ImagePoint::new(500.0, 400.0);
        let mut app = app(at);
        app.update(Action::Navigate(Navigation::Select(Some(0))));
        let nudge = |app: &mut App, dx_px: f64, held: bool| {
            let effects = app.update(Action::Edit(EditAction::Nudge {
                dx_px,
                dy_px: 0.0,
                held,
            }));
            assert!(
                effects
                    .iter()
                    .any(|effect| matches!(effect, Effect::Journal { .. })),
                "{dx_px}"
            );
        };
        nudge(&mut app, 1.0, false);
        for _ in 0..5 {
            nudge(&mut app, 1.0, true);
        }
        nudge(&mut app, 1.0, false);
        assert!((image(&app).x - 507.0).abs() < 1e-9);
        app.update(Action::Command(Command::Undo));
        assert!((image(&app).x - 506.0).abs() < 1e-9);
        app.update(Action::Command(Command::Undo));
        assert_eq!(image(&app), at);
        // There and back with the key held down: this is no step, but the journal must record it.
        nudge(&mut app, 1.0, false);
        nudge(&mut app, -1.0, true);
        assert!(app.open().unwrap().history.next_undo().is_none());
    }
}
