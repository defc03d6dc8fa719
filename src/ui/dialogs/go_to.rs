//! Going to a frame by its number or by a time of the video.

use super::{has_just_opened, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Button, Context, Id, Key, RichText, TextEdit, vec2};
use touchline_application::app::place::FrameOrTime;
use touchline_application::app::{Action, Navigation, sentence};

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    let memory = Id::unique("typed place");
    let opened = has_just_opened(ctx, "place");
    let known = ctx.data_mut(|data| data.get_temp::<String>(memory));
    let mut typed = known.filter(|_| !opened).unwrap_or_default();
    let (first, last) = panel
        .app
        .open()
        .map_or((0, 0), |open| open.numbers_beside(panel.app.session.frame));
    sheet(
        panel,
        ctx,
        "Go to frame or time",
        vec2(320.0, 150.0),
        |panel, ui| {
            let place = ui.horizontal(|ui| {
                let field = TextEdit::singleline(&mut typed)
                    .hint_text("500 or 1:23.4")
                    .desired_width(210.0);
                let response = ui.add(field).accessible_name("Frame or time");
                let response = response
                    .on_hover_text("A frame's number, or minutes and seconds. Enter goes there.");
                if opened {
                    response.request_focus();
                }
                // A text field loses the focus with Enter. A text that is not a place is explained
                // below, and Enter does nothing.
                let place = typed.parse::<FrameOrTime>();
                let entered =
                    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if entered && place.is_err() {
                    // The user goes on to correct the text.
                    response.request_focus();
                }
                let go = ui.add_enabled(
                    place.is_ok(),
                    Button::new("Go").fill(ui.palette().accent_ground),
                );
                let go = go.on_hover_text("Show this frame. (Enter)");
                if let (true, Ok(place)) = (go.clicked() || entered, &place) {
                    panel
                        .actions
                        .push(Action::Navigate(Navigation::GoToPlace(*place)));
                }
                place
            });
            ui.add_space(theme::SPACE);
            // What is wrong with the text, or else which numbers there are.
            let says = match &place.inner {
                Err(error) if !typed.trim().is_empty() => {
                    RichText::new(sentence(&error.to_string())).color(ui.palette().caution)
                }
                _ => RichText::new(format!("Frames are numbered from {first} to {last}."))
                    .color(ui.palette().weak),
            };
            ui.label(says.small());
        },
    );
    ctx.data_mut(|data| data.insert_temp(memory, typed));
}
