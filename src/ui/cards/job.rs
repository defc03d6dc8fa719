//! The card of running work: its name, the present step, how far that is, the time that it still
//! takes, *Stop* at a fixed place, and, during a search for a camera, a map of what it sees.

use crate::ui::Panel;
use crate::ui::controls::theme::Themed as _;
use crate::ui::maps::paint_map;
use egui::{Align, Id, Label, Layout, ProgressBar, RichText, Ui, vec2};
use std::time::Duration;
use touchline_application::app::operations::UnderWay;
use touchline_application::app::{Command, describe_left};

/// Minimum time from which a pace is estimated, s.
const PACED_S: f64 = 4.0;
/// Height of the row with the name and *Stop*, points.
const ROW: f32 = 22.0;
/// Height of the bar, points.
const BAR: f32 = 6.0;
/// Height of the map, points.
const MAP: f32 = 120.0;

/// When a step was first seen, and how far it was then.
#[derive(Clone)]
struct StepBegin {
    /// The words of the step, which stay while its numbers change.
    words: String,
    share: f32,
    at_s: f64,
}

/// Shows the work. The card has the same height at every step, so that nothing below it moves,
/// until the map of a search comes, which then stays.
pub(super) fn show(panel: &mut Panel<'_>, ui: &mut Ui, under_way: &UnderWay) {
    let UnderWay {
        job,
        step,
        share,
        stop,
        panorama,
    } = under_way;
    // The button first, from the right: a longer name is cut, and the button stays in its place.
    let row = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
        let says = if *stop == Command::PauseTrainer {
            "Pause"
        } else {
            "Stop"
        };
        panel.run_on_click(ui.button(says), *stop);
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let job = RichText::new(job).strong().color(ui.palette().strong);
            ui.add(Label::new(job).truncate());
        });
    });
    // Without a share, the bar is full and animated.
    let bar = ProgressBar::new(share.unwrap_or(1.0)).animate(share.is_none());
    ui.add(bar.desired_height(BAR).corner_radius(2));
    small_line(ui, step);
    small_line(ui, &describe_pace(ui, under_way));
    if let Some(panorama) = panorama {
        let size = vec2(ui.available_width(), MAP);
        paint_map::show_searched(ui, panorama, size);
    }
}

/// A line of small text that is cut, never wrapped.
fn small_line(ui: &mut Ui, text: &str) {
    let line = RichText::new(text).small().color(ui.palette().text);
    ui.add(Label::new(line).truncate());
}

/// The share of the present step that is done, and the time that the rest of it takes at the pace
/// so far.
fn describe_pace(ui: &Ui, under_way: &UnderWay) -> String {
    let Some(share) = under_way.share else {
        return "Its length is not known.".to_owned();
    };
    let words = words_of_step(&under_way.step);
    let now_s = ui.input(|input| input.time);
    let begin = ui.data_mut(|data| {
        let fresh = || StepBegin {
            words: words.clone(),
            share,
            at_s: now_s,
        };
        let memory = Id::unique(("pace of", &under_way.job));
        let begin = data.get_temp_mut_or_insert_with(memory, fresh);
        // The same step begins again at a smaller share.
        if share < begin.share || begin.words != words {
            *begin = fresh();
        }
        begin.clone()
    });
    let percent = (100.0 * share).floor();
    match time_left_s(&begin, share, now_s) {
        Some(left) => format!("{percent:.0} %, {} of this step", describe_left(left)),
        None => format!("{percent:.0} % of this step"),
    }
}

/// A step without its numbers, which change while it goes on.
fn words_of_step(step: &str) -> String {
    let words = step.split_whitespace();
    let words = words.filter(|word| !word.starts_with(|first: char| first.is_ascii_digit()));
    words.collect::<Vec<_>>().join(" ")
}

/// The time until a step is done at the pace since it was first seen. None while that is not known.
fn time_left_s(begin: &StepBegin, share: f32, now_s: f64) -> Option<Duration> {
    let (done, elapsed_s) = (f64::from(share - begin.share), now_s - begin.at_s);
    let is_paced = done > 0.0 && elapsed_s >= PACED_S;
    is_paced.then(|| Duration::from_secs_f64(elapsed_s * f64::from(1.0 - share).max(0.0) / done))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_pace_of_the_step() {
        let begin = StepBegin {
            words: words_of_step("Tracking 12 of 97 frames."),
            share: 0.25,
            at_s: 10.0,
        };
        let left = |share, now_s| time_left_s(&begin, share, now_s);
        assert_eq!(left(0.5, 20.0), Some(Duration::from_secs(20)));
        assert_eq!(left(0.5, 12.0), None, "two seconds are no pace");
        assert_eq!(begin.words, words_of_step("Tracking 13 of 97 frames."));
        assert_eq!(left(0.25, 60.0), None, "nothing was done");
    }
}
