//! The panel of the background trainer: what it is doing, its references, the forest with its
//! accuracy, the proposals, and where references are missing.

mod accuracy;

use super::Panel;
use super::controls::theme::Themed as _;
use super::maps::coverage_map::{CoverageMap, label_next, missing};
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::section;
use crate::ui::controls::{Heading, symbol, theme};
use crate::ui::rows::menu::file_name;
use egui::{
    Button, Checkbox, Color32, Frame, Grid, Label, Margin, ProgressBar, RichText, ScrollArea,
    Sense, Stroke, Ui,
};
use touchline_application::app::{
    Command, EditAction, ForestFacts, TrainerActivity, TrainerStatus, UnusableReference,
    describe_left,
};
use touchline_calibration::proposals::{Coverage, LeftOut, Quality, Suspect, WRONG_PX};
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::{FrameId, FrameStatus};

/// Maximum number of references in each of the lists of contradicting and unusable ones.
const FAILED_SHOWN: usize = 5;

/// Shows the panel; the reason, if there is no trainer.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    heading(panel, ui);
    let inside = Frame::new().inner_margin(Margin {
        left: 8,
        right: 12,
        top: 4,
        bottom: 12,
    });
    if let Some(reason) = panel.app.no_trainer() {
        inside.show(ui, |ui| theme::weak_text(ui, reason));
        return;
    }
    // A copy, because the parts below borrow the panel mutably.
    let status = panel.app.session.trainer.status.clone();
    ScrollArea::vertical().id_salt("trainer panel").auto_shrink(false).show(ui, |ui| {
        inside.show(ui, |ui| {
            ui.set_width(ui.available_width());
            doing(panel, ui, &status);
            references(panel, ui, &status);
            if let Some(facts) = status.forest {
                forest(ui, facts);
                proposals(panel, ui, &status);
            }
            if let Some(coverage) = find_coverage(panel, &status.coverage) {
                section(ui, "WHERE REFERENCES LOOK");
                show_map(panel, ui, coverage, status.quality.as_deref());
            }
            if let Some(quality) = &status.quality {
                section(ui, "ACCURACY");
                accuracy::show(panel, ui, quality);
            } else if status.forest.is_some() && !matches!(status.doing, TrainerActivity::Measuring(_)) {
                section(ui, "ACCURACY");
                let text = "Available once references from two shots, or a few seconds apart, are accepted.";
                theme::weak_text(ui, text);
            }
        });
    });
}

/// Shows the title and the close button.
fn heading(panel: &mut Panel<'_>, ui: &mut Ui) {
    let heading = Heading {
        title: "Trainer",
        command: Command::TrainerPanel,
        closes: "trainer panel",
        behind: "frame",
    };
    heading.show(panel, ui, |_, _| {}, |_, _| {});
}

/// Shows the present work with its progress, the pause button, and problems.
fn doing(panel: &mut Panel<'_>, ui: &mut Ui, status: &TrainerStatus) {
    let said = match status.doing {
        TrainerActivity::Nothing if status.references == 0 => {
            "Waiting for the first reference.".to_owned()
        }
        TrainerActivity::Nothing => "Up to date: every frame that can be answered is.".to_owned(),
        doing => match status.left {
            Some(left) => format!("{}, {}.", doing.describe(), describe_left(left)),
            None => format!("{}.", doing.describe()),
        },
    };
    ui.add(Label::new(said).wrap());
    if let Some(share) = status.doing.share() {
        ui.add(
            ProgressBar::new(share.fraction())
                .desired_height(6.0)
                .corner_radius(2),
        );
    }
    ui.add_space(theme::SPACE);
    // The button is shown even while nothing is to be done: a pause lasts until it is ended.
    let paused = panel.app.session.trainer.paused;
    let says = if paused { "Resume" } else { "Pause" };
    panel.run_on_click(ui.button(says), Command::PauseTrainer);
    // Problems of the training, and of storing its result.
    if let Some(trouble) = &status.trouble {
        let palette = ui.palette();
        remark(ui, Symbol::Warning, palette.caution, trouble);
    }
    if let Some(reason) = &status.not_kept {
        let text = format!("Forest and features are only kept in memory: {reason}");
        let palette = ui.palette();
        remark(ui, Symbol::Info, palette.weak, &text);
    }
}

/// Shows how many references the forest is trained on, why others are not, and which of them
/// contradict each other or cannot be used.
fn references(panel: &mut Panel<'_>, ui: &mut Ui, status: &TrainerStatus) {
    section(ui, "TRAINED ON");
    let trained_on = pluralise(status.training_frames, "reference");
    ui.label(format!("{trained_on} used for training."));
    // References that are not used for training: they wait for a base, or they were withheld.
    let waiting = status
        .references
        .saturating_sub(status.training_frames + status.withheld);
    if waiting > 0 {
        let text = match waiting {
            1 => "1 reference waits for its camera's base.".to_owned(),
            count => format!(
                "{} references wait for their camera's base.",
                thousands(count)
            ),
        };
        ui.add(Label::new(RichText::new(text).color(ui.palette().caution)).wrap());
    }
    if status.withheld > 0 {
        let withheld = pluralise(status.withheld, "reference");
        let text = format!("{withheld} not used for training.");
        theme::weak(ui, text).on_hover_text(
            "Training with the forest's own proposals would add nothing new and repeat its mistakes; so would a frame whose \
             verdict is Wrong. The switch of a frame overrides this.",
        );
    }
    // The switch for the shown frame.
    let shown = panel.app.session.frame;
    let reference = panel
        .app
        .frame()
        .filter(|frame| frame.status == FrameStatus::Reference);
    if let Some(frame) = reference {
        let before = frame.is_used_for_training();
        let mut used = before;
        let tip = panel.app.settings.keys.tooltip(Command::UseForTraining);
        ui.add(Checkbox::new(&mut used, "Use this frame for training"))
            .on_hover_text(tip);
        if used != before {
            panel.edit(EditAction::SetUseForTraining { frame: shown, used });
        }
    }
    // References that contradict others, and those that cannot be used.
    for suspect in status.suspects.iter().take(FAILED_SHOWN) {
        contradicting(panel, ui, suspect);
    }
    let more = status.suspects.len().saturating_sub(FAILED_SHOWN);
    if more > 0 {
        theme::weak_text(ui, format!("{more} more that contradict others."));
    }
    for UnusableReference { frame, error } in status.failed.iter().take(FAILED_SHOWN) {
        let Some((place, name)) = place_and_name(panel, frame) else {
            continue;
        };
        let palette = ui.palette();
        remark(
            ui,
            Symbol::Warning,
            palette.caution,
            &format!("{name} cannot be used: {error}"),
        );
        if ui.add(Button::new("Go there").small()).clicked() {
            panel.go_to(place);
        }
    }
    let more = status.failed.len().saturating_sub(FAILED_SHOWN);
    if more > 0 {
        theme::weak_text(ui, format!("{more} more cannot be used."));
    }
}

/// Shows a reference with a label that contradicts those of others.
fn contradicting(panel: &mut Panel<'_>, ui: &mut Ui, suspect: &Suspect) {
    let Some((place, name)) = place_and_name(panel, &suspect.frame) else {
        return;
    };
    let others = match suspect.contradicted_by {
        1 => "another reference".to_owned(),
        count => format!("{count} others"),
    };
    let off = match suspect.disagreement_px {
        px if px.is_finite() => format!("{px:.0} px"),
        _ => "all of the picture".to_owned(),
    };
    let text = format!("{name} contradicts {others} by {off}: look at its points.");
    let palette = ui.palette();
    remark(ui, Symbol::Warning, palette.caution, &text);
    if ui.add(Button::new("Look").small()).clicked() {
        panel.go_to(place);
    }
}

/// The position of a frame in the document and the name of its file; `None` if it is no longer
/// there.
fn place_and_name(panel: &Panel<'_>, id: &FrameId) -> Option<(usize, String)> {
    let open = panel.app.open()?;
    let place = open.document.frames.position_of(id)?;
    Some((place, file_name(&open.frame(place)?.name())))
}

/// Shows the size of the forest.
fn forest(ui: &mut Ui, facts: ForestFacts) {
    section(ui, "FOREST");
    let took = facts.took.map_or_else(
        || "loaded from disk".to_owned(),
        |took| format!("{:.1} s", took.as_secs_f64()),
    );
    // A forest that was read from disk has no training time, and maybe no number of features.
    let mut rows = vec![("References", facts.references.to_string())];
    if facts.features > 0 {
        rows.push(("Features", thousands(facts.features)));
    }
    rows.extend([
        ("Trees", facts.trees.to_string()),
        ("Leaves", thousands(facts.leaves)),
        ("Training time", took),
        ("Generation", facts.generation.to_string()),
    ]);
    Grid::new("forest")
        .num_columns(2)
        .spacing([12.0, 2.0])
        .show(ui, |ui| {
            for (name, value) in rows {
                theme::weak(ui, name);
                ui.label(value);
                ui.end_row();
            }
        });
}

/// Shows how many proposals there are, whether they are aligned to the paint, and where to label
/// next.
fn proposals(panel: &mut Panel<'_>, ui: &mut Ui, status: &TrainerStatus) {
    section(ui, "PROPOSALS");
    let cameras = pluralise(status.answered, "camera");
    // Cameras that the forest proposed, and those that were tracked from frame to frame.
    let tracked = panel.app.open().map_or(0, |open| open.counts().tracked);
    ui.horizontal_wrapped(|ui| {
        ui.label(match tracked {
            0 => format!("{cameras} proposed."),
            tracked => format!(
                "{cameras} proposed, {} tracked from frame to frame.",
                thousands(tracked)
            ),
        });
        if status.answered + tracked > 0 {
            panel.run_on_click(ui.add(Button::new("Review").small()), Command::ReviewPanel);
        }
    });
    let before = panel.app.settings.snap_suggestions;
    let mut snapped = before;
    let tip = panel.app.settings.keys.tooltip(Command::SnapSuggestions);
    ui.add(Checkbox::new(
        &mut snapped,
        "Snap them to the painted lines",
    ))
    .on_hover_text(tip);
    if snapped != before {
        panel.run(Command::SnapSuggestions);
    }
    let advice = &panel.app.review().advice;
    if let Some(text) = panel.app.where_to_label() {
        ui.add(Label::new(text).wrap());
        if advice.next.is_some() {
            let there = ui.add(Button::new("Go there").small());
            panel.run_on_click(there, Command::NextUnanswered);
        }
    }
}

fn remark(ui: &mut Ui, sign: Symbol, colour: Color32, text: &str) {
    ui.add_space(theme::SPACE);
    ui.horizontal_top(|ui| {
        symbol::show(ui, sign, colour);
        ui.add(Label::new(text).wrap());
    });
}

/// Height of the map, points.
const HEIGHT: f32 = 84.0;

/// The map of the shown frame's camera; `None` if that camera has no reference.
pub fn find_coverage<'a>(panel: &Panel<'_>, maps: &'a [Coverage]) -> Option<&'a Coverage> {
    let frame = panel.app.frame()?;
    maps.iter().find(|map| map.camera == frame.camera)
}

/// Shows the map. Dots are references that were left out of the training; an outline is the shown
/// frame; a pointer at the top shows where a label helps most.
pub fn show_map(panel: &Panel<'_>, ui: &mut Ui, coverage: &Coverage, quality: Option<&Quality>) {
    let map = CoverageMap::show(ui, coverage, HEIGHT, Sense::hover());
    let app = panel.app;
    if let (Some(camera), Some(frame)) = (&app.current().camera, app.frame()) {
        map.outline(camera, frame.image_size);
    }
    for tested in quality.into_iter().flat_map(|quality| &quality.tested) {
        dot(&map, tested);
    }
    if let Some(pan_deg) = label_next(panel, coverage) {
        map.pointer(pan_deg);
    }
    let tip = "Pan to the right, tilt upwards. Blue: seen by references, the brighter the more. Red: field not seen by any. \
               Dots: references that were left out and found again (green), found wrong (red) or not found (ring). Outline: \
               the shown frame. Pointer from above: where a label helps most.";
    map.response.clone().on_hover_text(tip);
    map.borders(ui);
    ui.add(Label::new(missing(coverage)).wrap());
}

/// Draws a reference that was left out: filled if found, in another colour if found in a wrong
/// place, a ring if not found.
fn dot(map: &CoverageMap<'_>, tested: &LeftOut) {
    let at = map.at(tested.pan_deg, tested.tilt_deg);
    match tested.found {
        Some(found) if found.error_px <= WRONG_PX => {
            map.painter
                .circle_filled(at, 3.0, map.painter.palette().good)
        }
        Some(_) => map
            .painter
            .circle_filled(at, 3.5, map.painter.palette().bad),
        None => map
            .painter
            .circle_stroke(at, 3.0, Stroke::new(1.5, map.painter.palette().caution)),
    };
}
