//! Removes the points of a model from all frames.

use crate::app::App;
use crate::app::Command;
use crate::app::window_state::session::{Level, Mode};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Click, Step};

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
