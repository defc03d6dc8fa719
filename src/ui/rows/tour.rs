//! The bar of the tour, below the menus: the step, what to do, and how to leave. It takes its own
//! row and covers nothing.

use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align, Button, Color32, Frame, Layout, Margin, RichText, Sense, Stroke, Ui, vec2};
use touchline_application::app::Command;
use touchline_application::app::tour::{Tour, TourStep};

/// Shows the bar during a tour.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(step) = panel.app.session.tour.as_ref().map(Tour::step) else {
        return;
    };
    let frame = Frame::new()
        .fill(ui.palette().accent_ground)
        .inner_margin(Margin::symmetric(12, 6));
    egui::Panel::top("tour")
        .resizable(false)
        .frame(frame)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                let heading = match step.number() {
                    Some(number) => {
                        format!("Step {number} of {}: {}", TourStep::ALL.len(), step.title())
                    }
                    None => step.title().to_owned(),
                };
                ui.label(RichText::new(heading).strong().color(ui.palette().strong));
                // The button that leaves the tour is always at the right end.
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    for command in buttons(step) {
                        let says = if *command == Command::LeaveTour && step == TourStep::Finished {
                            "Close"
                        } else {
                            command.name()
                        };
                        if show_button(ui, Button::new(says).small(), command.about()) {
                            panel.run(*command);
                        }
                    }
                    dots(ui, step);
                });
            });
            let text = step.text(&panel.app.settings.keys);
            theme::text(ui, text);
        });
}

/// The commands on the bar, from right to left.
const fn buttons(step: TourStep) -> &'static [Command] {
    match step {
        TourStep::Finished => &[Command::LeaveTour, Command::Guide],
        _ => &[Command::LeaveTour],
    }
}

/// Draws one dot for each step, filled if the step is done.
fn dots(ui: &mut Ui, step: TourStep) {
    // After the last step all are done.
    let done = step
        .number()
        .map_or(TourStep::ALL.len(), |number| number - 1);
    let (rect, _) = ui.allocate_exact_size(
        vec2(14.0 * TourStep::ALL.len() as f32, 16.0),
        Sense::hover(),
    );
    for place in 0..TourStep::ALL.len() {
        let at = rect.left_center() + vec2(14.0 * place as f32 + 7.0, 0.0);
        let (fill, line) = match place.cmp(&done) {
            std::cmp::Ordering::Less => (ui.palette().good, ui.palette().good),
            std::cmp::Ordering::Equal => (Color32::TRANSPARENT, ui.palette().strong),
            std::cmp::Ordering::Greater => (Color32::TRANSPARENT, ui.palette().weak),
        };
        ui.painter().circle(at, 4.0, fill, Stroke::new(1.5, line));
    }
}
