//! Autocalibration in the camera panel: the button, the progress, and the choice between two
//! answers.

use super::section;
use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{Button, Label, ProgressBar, RichText, Ui};
use touchline_application::app::Command;
use touchline_application::app::operations::UnderWay;
use touchline_application::app::operations::camera_search::{SearchFollowUp, TwoCameras};
use touchline_documents::document::{Camera, FrameId};

/// Shows the state of autocalibration and what can be done. Nothing if the camera has a base and no
/// search is going on.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    let search = &panel.app.operations.camera_search;
    if let Some(under_way) = search.under_way() {
        section(ui, "FINDING THE CAMERA");
        show_progress(panel, ui, &under_way);
        return;
    }
    // What the last search left to decide or to report. The choice between two answers stays in
    // view until it is made; a report stands only where the camera has no base yet.
    match &search.left {
        SearchFollowUp::Two(two) => {
            section(ui, "TWO ANSWERS");
            show_choice(panel, ui, two);
        }
        SearchFollowUp::Abstained {
            camera: of,
            why,
            frame,
        } if *of == camera.id && camera.base().is_none() => {
            section(ui, "WITHOUT A CLICK");
            ui.add(Label::new(RichText::new(why.as_str()).color(ui.palette().caution)).wrap());
            ui.add_space(theme::SPACE);
            ui.horizontal_wrapped(|ui| {
                start(panel, ui, "Look again");
                if let Some(frame) = frame {
                    go_there(panel, ui, frame, "Go to the frame in which clicks help.");
                }
            });
        }
        _ if camera.base().is_none() => {
            section(ui, "WITHOUT A CLICK");
            let text = "Overlapping views of one camera, matched to each other, show where it stands. This takes about a minute.";
            theme::weak_text(ui, text);
            ui.add_space(theme::SPACE);
            start(panel, ui, "Find the camera automatically");
        }
        _ => {}
    }
}

/// Shows the progress of a search, and stops it.
fn show_progress(panel: &mut Panel<'_>, ui: &mut Ui, under_way: &UnderWay) {
    ui.add(Label::new(under_way.text.as_str()).wrap());
    let share = under_way.share.unwrap_or_default();
    ui.add(ProgressBar::new(share).desired_height(6.0).corner_radius(2));
    ui.add_space(theme::SPACE);
    panel.run_on_click(ui.button("Stop"), Command::StopFindCamera);
}

/// Shows two answers that the frames alone cannot distinguish. The user tries both; a click in the
/// named frame decides.
fn show_choice(panel: &mut Panel<'_>, ui: &mut Ui, two: &TwoCameras) {
    ui.add(Label::new(two.describe()).wrap());
    ui.add_space(theme::SPACE);
    ui.horizontal_wrapped(|ui| {
        panel.run_on_click(ui.button("Try the first"), Command::TryFirstCamera);
        panel.run_on_click(ui.button("Try the other"), Command::TryOtherCamera);
        // A click that decides exists only for some pairs of answers.
        if let Some(click) = &two.deciding {
            go_there(
                panel,
                ui,
                &click.frame,
                "Go to the frame whose click decides.",
            );
        }
        panel.run_on_click(ui.button("Done"), Command::StopFindCamera);
    });
}

/// Shows the button that goes to a frame, unless the frame was removed.
fn go_there(panel: &mut Panel<'_>, ui: &mut Ui, frame: &FrameId, tip: &str) {
    let open = panel.app.open();
    let Some(index) = open.and_then(|open| open.document.frames.position_of(frame)) else {
        return;
    };
    if ui.button("Go there").on_hover_text(tip).clicked() {
        panel.go_to(index);
    }
}

/// Shows the button that starts a search, disabled with the reason.
fn start(panel: &mut Panel<'_>, ui: &mut Ui, says: &str) {
    let button = Button::new(RichText::new(says).strong());
    panel.command_button(ui, button, Command::FindCamera);
}
