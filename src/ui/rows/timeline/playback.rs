//! Playing a video: the frame that is due is shown as if the user had gone there, with its overlay.

use crate::ui::Panel;
use egui::{Context, Id};
use std::collections::BTreeSet;
use std::time::Duration;
use touchline_application::app::playing::PlayClock;
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, ViewAction};

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
        panel.actions.push(Action::View(ViewAction::Pause));
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
        panel.go_to(due);
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
