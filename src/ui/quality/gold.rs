//! The annotator's own click noise, from gold frames that are clicked again blind, and whether it
//! weights the clicks.
//!
//! Distances are px at 1920 px width.

use super::card;
use super::scatter::Scatter;
use crate::ui::Panel;
use crate::ui::controls::bar::Bar;
use crate::ui::controls::theme::{self};
use egui::{Button, Ui, vec2};
use touchline_application::app::Command;
use touchline_calibration::calibrate::OwnNoise;
use touchline_core::geometry::pluralise;
use touchline_documents::document::{ClickNoise, Target};

/// Maximum number of landmarks in the list.
const LANDMARKS_SHOWN: usize = 9;
/// Width of the column beside the plot, points.
const COLUMN: f32 = 330.0;

/// The text before the first blind click.
const NOTHING: &str = "How precisely do you click? Mark accepted frames as gold, or let the program choose a few, and click their \
                       points again without seeing the labels. After 12 blind clicks your own click noise can weight your points.";

/// Shows the card: a scatter plot of the blind clicks around their labels, the noise in words, σ by
/// landmark.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    card(
        panel,
        ui,
        "YOUR CLICK NOISE: GOLD FRAMES",
        beside,
        |panel, ui| {
            let app = panel.app;
            let own = &app.gold().own;
            if own.repeats == 0 {
                theme::weak_text(ui, NOTHING);
                return;
            }
            ui.horizontal_top(|ui| {
                let offsets: Vec<_> = own.offsets.iter().map(|repeat| repeat.offset_px).collect();
                // Label and blind click are both noisy, so their offset has √2 times the σ of one
                // click.
                let sigma_px = own
                    .noise
                    .map(|noise| noise.sigma * std::f64::consts::SQRT_2);
                let pointed = Scatter {
                    name: "Blind clicks around the label",
                    offsets: &offsets,
                    sigma_px,
                }
                .show(ui);
                ui.vertical(|ui| {
                    ui.set_width(COLUMN);
                    describe(panel, ui, own);
                    let under = pointed
                        .and_then(|(index, clicked)| Some((own.offsets.get(index)?, clicked)));
                    if let Some((repeat, clicked)) = under {
                        let label = app.label(&Target::Landmark(repeat.landmark.clone()));
                        let number = app
                            .open()
                            .map_or(repeat.frame as u64, |open| open.frame_number(repeat.frame));
                        let text =
                            format!("Frame {number}: {label}, {:.1} px", repeat.offset_px.norm());
                        theme::strong(ui, text);
                        if clicked {
                            panel.look_at(repeat.frame, repeat.click);
                        }
                    }
                });
                ui.vertical(|ui| {
                    ui.set_width(COLUMN.min(ui.available_width()));
                    landmarks(panel, ui, own);
                });
            });
        },
    );
}

/// Shows the commands and the number of gold frames, from right to left.
fn beside(panel: &mut Panel<'_>, ui: &mut Ui) {
    // The noise can be taken over only when there are enough blind clicks; until then its button is
    // absent, because the text of the card says how many are missing.
    let app = panel.app;
    let in_use = app
        .open()
        .is_some_and(|open| open.document.click_noise_in_use().is_some());
    let mut commands = vec![
        ("Click again…", Command::ClickAgain),
        ("Choose frames", Command::ChooseGold),
    ];
    if app.why_not(Command::UseOwnNoise).is_none() {
        commands.push((
            if in_use {
                "Update"
            } else {
                "Use it for my points"
            },
            Command::UseOwnNoise,
        ));
    }
    if in_use {
        commands.push(("Use the usual", Command::UseUsualNoise));
    }
    for (says, command) in commands {
        panel.command_button(ui, Button::new(says).small(), command);
    }
    let gold = pluralise(app.gold().frames, "gold frame");
    theme::small_weak(ui, gold);
}

/// Describes the annotator's click noise, with the numbers behind it, and which noise weights the
/// clicks at present.
fn describe(panel: &Panel<'_>, ui: &mut Ui, own: &OwnNoise) {
    let said = match &own.noise {
        Some(noise) => {
            let [low, high] = noise.interval_95;
            format!(
                "Your click noise: {:.2} px in each direction (95 %: {low:.2} to {high:.2})",
                noise.sigma
            )
        }
        None => "Too few blind clicks to estimate your click noise".to_owned(),
    };
    theme::strong_text(ui, said).on_hover_text(
        "1-σ of a single click at 1920 px width. The rings are one and two σ of the distance between two clicks.",
    );
    // Noise in each direction, and clicks that are too far off to be noise.
    let [right, down] = own
        .noise_by_axis
        .map(|noise| noise.map(|noise| format!("{:.2} px", noise.sigma)));
    let axes = right
        .zip(down)
        .map(|(right, down)| format!(": across {right}, down {down}"))
        .unwrap_or_default();
    let aside = match own.noise.map_or(0, |noise| noise.set_aside) {
        0 => String::new(),
        1 => " One is too far off to be noise and is left out.".to_owned(),
        count => format!(" {count} are too far off to be noise and are left out."),
    };
    let clicks = pluralise(own.repeats, "blind click");
    let frames = pluralise(own.frames, "frame");
    let text = format!("{clicks} in {frames}{axes}.{aside}");
    theme::text(ui, text);
    // Which noise weights the clicks at present, and how the own one compares with it.
    let used = panel
        .app
        .open()
        .and_then(|open| open.document.click_noise_in_use());
    let text = match (&used, &own.click_noise) {
        (None, None) => format!(
            "After {} more it can weight your points.",
            own.missing().max(1)
        ),
        (None, Some(noise)) => format!(
            "Your points are weighted by the usual click noise. {}",
            describe_noise(noise)
        ),
        (Some(used), _) => format!(
            "Your points are weighted by your own click noise, from {}. {}",
            pluralise(used.repeats, "blind click"),
            describe_noise(used)
        ),
    };
    let tip = "Half of the variance that a field template states for a landmark comes from clicking, half from the place: paint \
               is wide, and no field is painted to the centimetre. Your blind clicks replace the first half.";
    theme::text(ui, text).on_hover_text(tip);
}

/// Compares an annotator's click noise with the usual one, in a sentence.
fn describe_noise(noise: &ClickNoise) -> String {
    format!("Yours is {:.0} % of the usual noise.", 100.0 * noise.factor)
}

/// Shows σ of each landmark as a bar, where it is known, the most often repeated first.
fn landmarks(panel: &Panel<'_>, ui: &mut Ui, own: &OwnNoise) {
    let mut sorted: Vec<_> = own.landmarks.iter().collect();
    sorted.sort_by_key(|landmark| std::cmp::Reverse(landmark.repeats));
    let largest = sorted
        .iter()
        .filter_map(|landmark| landmark.noise)
        .map(|noise| noise.sigma)
        .fold(1e-9, f64::max);
    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
    for landmark in sorted.iter().take(LANDMARKS_SHOWN) {
        let name = panel
            .app
            .label(&Target::Landmark(landmark.landmark.clone()));
        // σ if it is known, otherwise the number of repetitions.
        let value = landmark.noise.map_or_else(
            || format!("{} ×", landmark.repeats),
            |noise| format!("{:.2} px", noise.sigma),
        );
        let share = landmark.noise.map_or(0.0, |noise| noise.sigma / largest);
        let bar = Bar {
            name: &name,
            value: &value,
            share,
            ..Bar::default()
        };
        let (_, response) = bar.show(ui);
        let tip = match landmark.noise {
            Some(noise) => {
                let [low, high] = noise.interval_95;
                format!(
                    "{name}: {:.2} px (95 %: {low:.2} to {high:.2}) from {}.",
                    noise.sigma,
                    pluralise(noise.pairs, "blind click")
                )
            }
            None => format!(
                "{name}: {}, too few for a value of its own.",
                pluralise(landmark.repeats, "blind click")
            ),
        };
        response.on_hover_text(tip);
    }
    let more = sorted.len().saturating_sub(LANDMARKS_SHOWN);
    if more > 0 {
        theme::small_weak(ui, format!("{more} more landmarks"));
    }
}
