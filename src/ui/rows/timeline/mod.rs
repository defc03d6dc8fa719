//! The timeline of a video below the picture: play and pause, speed, time, and all frames on one
//! bar.

mod bar;

use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use egui::{Align, Button, ComboBox, Context, Id, Layout, RichText, Ui, vec2};
use std::collections::BTreeSet;
use std::time::Duration;
use touchline_application::app::place::time_code;
use touchline_application::app::playing::{PlayClock, SPEEDS};
use touchline_application::app::session::Mode;
use touchline_application::app::video::PlaySpeed;
use touchline_application::app::{App, Command, ViewAction};

/// Height of the timeline, points.
pub const HEIGHT: f32 = 36.0;

/// Whether the timeline is shown: the frame is one of a video, and no blind round is going on.
pub fn is_wanted(app: &App) -> bool {
    app.frame().is_some_and(|frame| frame.video.is_some()) && app.round().is_none()
}

/// Shows the timeline, and advances the video while it plays.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    go_on(panel, ui.ctx());
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 2.0 * theme::SPACE;
        controls(panel, ui);
        bar::show(panel, ui);
    });
}

/// Shows the play button, the speed, and the time with the number of the frame; a click on these
/// goes to another.
fn controls(panel: &mut Panel<'_>, ui: &mut Ui) {
    let playing = panel.app.session.video.playing;
    let (symbol, name) = if playing {
        (Symbol::Pause, "Pause")
    } else {
        (Symbol::Play, "Play")
    };
    let palette = ui.palette();
    let button = symbol::button(ui, symbol, name, palette.text);
    panel.run_on_click(button, Command::PlayPause);
    // The speed.
    let chosen = panel.app.session.video.speed.0;
    let label = |speed: f64| format!("{speed}×");
    let combo = ComboBox::from_id_salt("speed")
        .width(52.0)
        .selected_text(label(chosen))
        .show_ui(ui, |ui| {
            for speed in SPEEDS {
                if ui.selectable_label(speed == chosen, label(speed)).clicked() {
                    panel.view(ViewAction::SetSpeed(PlaySpeed(speed)));
                }
            }
        });
    combo
        .response
        .accessible_name("Speed")
        .on_hover_text("How fast the video is played, as a multiple of its own speed.");
    // Time and number of the frame.
    let (Some(frame), Some(open)) = (panel.app.frame(), panel.app.open()) else {
        return;
    };
    let time = frame
        .video
        .as_ref()
        .and_then(|video| video.pts_s)
        .map_or_else(|| "–".to_owned(), time_code);
    let last = open.document.frames.len().saturating_sub(1);
    // Padded to the width of the largest number, so that the bar does not move from frame to frame.
    let digits = open.frame_number(last).to_string().len();
    let here = panel.app.session.frame;
    let text = format!("{time:>8}  {:>digits$}", open.frame_number(here));
    let place =
        Button::new(RichText::new(text).monospace().color(ui.palette().strong)).frame(false);
    let place = ui.add(place.min_size(vec2(0.0, 24.0))).on_hover_ui(|ui| {
        let (first, last) = open.numbers_beside(here);
        let keys = panel.app.settings.keys.tooltip(Command::GoToPlace);
        ui.label(format!("The time, and the number of the frame: from {first} to {last}, as in the document.\n{keys}"));
    });
    if place.clicked() {
        panel.run(Command::GoToPlace);
    }
}

/// Interval at which a frame that is not decoded yet is looked for again.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Shows the frame that is due, if the video plays.
pub fn go_on(panel: &mut Panel<'_>, ctx: &Context) {
    let memory = Id::unique("play clock");
    let (session, now_s) = (&panel.app.session, ctx.input(|input| input.time));
    let Some(open) = panel.app.open().filter(|_| session.video.playing) else {
        // The next start begins with a new clock.
        ctx.data_mut(|data| data.remove::<PlayClock>(memory));
        return;
    };
    let last = open.document.frames.len().saturating_sub(1);
    // Playing ends with the last frame, or when the user begins something else.
    if session.mode != Mode::Idle || session.dialog.is_some() || session.frame >= last {
        panel.view(ViewAction::Pause);
        return;
    }
    let (shown, speed) = (session.frame, session.video.speed.0);
    // If the user has gone to another frame or changed the speed, the clock starts again from here.
    let before = ctx
        .data(|data| data.get_temp::<PlayClock>(memory))
        .filter(|clock| clock.follows(shown, speed));
    let mut clock = before.unwrap_or_else(|| PlayClock::start(now_s, shown, speed));
    // The clock asks for one frame after the other; a set answers in logarithmic time.
    let decoded: BTreeSet<usize> = panel.pictures.decoded_frames().into_iter().collect();
    let due = clock.frame_at(now_s, open, |frame| decoded.contains(&frame));
    if due != shown {
        panel.view(ViewAction::PlayTo(due));
    }
    // Drawn again when the next frame is due, or soon, if it is still to be decoded.
    let wait = if decoded.contains(&(due + 1)) {
        clock.until_next_s(now_s, open)
    } else {
        LOOK_AGAIN.as_secs_f64()
    };
    ctx.request_repaint_after(Duration::from_secs_f64(wait));
    ctx.data_mut(|data| data.insert_temp(memory, clock));
}
