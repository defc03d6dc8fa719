//! The controls that several panels use: rows with bars, headings, number fields, symbols, and the
//! theme with its colours and sizes. A control knows no panel. Maps and plots are in `maps`.

pub mod bar;
pub mod number;
pub mod symbol;
pub mod theme;

use self::symbol::Symbol;
use self::theme::Themed as _;
use super::{Panel, key_in_brackets};
use egui::{Align, Button, Context, Frame, Id, Layout, Margin, RichText, Ui, Widget, WidgetText};
use std::any::Any;
use touchline_application::app::Command;

/// A title, and at the right end a button that closes the panel or page.
pub struct Heading<'a> {
    pub title: &'a str,
    /// The command that shows and closes the panel or page.
    pub command: Command,
    /// The panel or page in the name of the button: "trainer panel".
    pub closes: &'a str,
    /// What is shown once it is closed: "frame".
    pub behind: &'a str,
}

impl Heading<'_> {
    /// Shows the heading. `beside` adds to the right of the title, `at_end` to the left of the
    /// button.
    pub fn show(
        &self,
        panel: &mut Panel<'_>,
        ui: &mut Ui,
        beside: impl FnOnce(&mut Panel<'_>, &mut Ui),
        at_end: impl FnOnce(&mut Panel<'_>, &mut Ui),
    ) {
        Frame::new()
            .inner_margin(Margin::symmetric(8, 6))
            .show(ui, |ui| {
                ui.horizontal(|ui| {
                    let title = RichText::new(self.title).heading();
                    ui.label(title.color(ui.palette().strong));
                    beside(panel, ui);
                    // From right to left, so that the close button keeps its place whatever
                    // `at_end` adds.
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        let name = format!("Close the {}", self.closes);
                        let weak = ui.palette().weak;
                        let close = symbol::button(ui, Symbol::Cross, &name, weak);
                        let key = key_in_brackets(&panel.app.settings.keys, self.command);
                        let tip = format!("Back to the {}.{key}", self.behind);
                        if close.on_hover_text(tip).clicked() {
                            panel.run(self.command);
                        }
                        at_end(panel, ui);
                    });
                });
            });
    }
}

/// Shows a button with a tooltip. Returns whether it was clicked.
pub fn show_button(ui: &mut Ui, button: impl Widget, tip: impl Into<WidgetText>) -> bool {
    ui.add(button).on_hover_text(tip).clicked()
}

/// Remembers a value for the next frame of the window. Returns the one from before.
pub fn replace_remembered<T: 'static + Any + Clone + Send + Sync>(
    ctx: &Context,
    memory: Id,
    now: T,
) -> Option<T> {
    ctx.data_mut(|data| {
        let before = data.get_temp(memory);
        data.insert_temp(memory, now);
        before
    })
}

/// Shows the rows of a list with a unique name, of which the first few stand alone until the user
/// unfolds it with the button `all`.
pub fn show_folded(
    ui: &mut Ui,
    name: &str,
    (length, first): (usize, usize),
    all: &str,
    mut show_row: impl FnMut(&mut Ui, usize),
) {
    let memory = Id::unique(name);
    let is_open = ui.data(|data| data.get_temp::<bool>(memory).unwrap_or(false));
    let shown = if is_open { length } else { length.min(first) };
    for row in 0..shown {
        show_row(ui, row);
    }
    let says = if is_open { "Fewer" } else { all };
    let button = Button::new(RichText::new(says).small()).frame(false);
    if length > first && ui.add(button).clicked() {
        ui.data_mut(|data| data.insert_temp(memory, !is_open));
    }
}
