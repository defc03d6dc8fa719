//! The details of a frame: uncertainties, residuals, the second root, the base, every warning. They
//! are collapsed by default.

use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{replace_remembered, show_button};
use crate::ui::controls::{symbol, theme};
use egui::{Button, Grid, Label, RichText, Role, Sense, Ui, WidgetInfo, pos2, vec2};
use touchline_application::app::camera_text::CameraText;
use touchline_application::app::review::percent;
use touchline_application::app::{App, Command, EditAction, SettingsAction};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{Solution, Target};

/// Shows the heading that expands and collapses the details, and the details if expanded.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let open = panel.app.settings.details;
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), theme::LIST_ROW), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, open, "Details"));
    // The heading with its triangle.
    let colour = if response.hovered() {
        ui.palette().strong
    } else {
        ui.palette().weak
    };
    let sign =
        egui::Rect::from_center_size(pos2(rect.left() + 6.0, rect.center().y), vec2(12.0, 12.0));
    symbol::paint(
        ui.painter(),
        if open {
            Symbol::Unfolded
        } else {
            Symbol::Folded
        },
        sign,
        colour,
    );
    ui.painter().text(
        pos2(rect.left() + 18.0, rect.center().y),
        egui::Align2::LEFT_CENTER,
        "Details",
        egui::FontId::proportional(theme::BODY),
        colour,
    );
    let response = response.on_hover_text("Uncertainties, residuals, the camera, every warning.");
    if response.clicked() {
        panel.set(SettingsAction::Details(!open));
    }
    // Details that open in the lower half would be out of view.
    if has_just_unfolded(ui, open) && rect.top() > ui.clip_rect().center().y {
        response.scroll_to_me(Some(egui::Align::TOP));
    }
    if !open {
        return;
    }
    let app = panel.app;
    let shown = app.shown_values();
    // An estimated base gives no advice about the next click: it is not applied yet.
    if let Some(solved) = shown.click_solution() {
        uncertainty(ui, solved);
        evidence(ui, solved);
        residuals(ui, solved);
        if !shown.is_estimated {
            next_clicks(panel, ui);
            other_root(panel, ui, solved);
        }
        warnings(
            ui,
            solved
                .warnings
                .iter()
                .map(|warning| warning.message.as_str()),
        );
    // Nothing was solved here, but the document records an earlier solution.
    } else if let Some(solution) = app
        .frame()
        .filter(|_| !shown.is_estimated)
        .and_then(|frame| frame.solution.as_ref())
    {
        show_recorded_solution(ui, solution);
    }
    camera(app, ui);
}

/// Whether the details were collapsed in the previous frame of the window.
fn has_just_unfolded(ui: &Ui, open: bool) -> bool {
    // When the window has just opened, nothing was collapsed before: `before` is none.
    let memory = egui::Id::unique("details are shown");
    replace_remembered(ui, memory, open) == Some(false) && open
}

/// Maximum width of a value, points.
const VALUE: f32 = 172.0;

/// A row of a grid: name and value, with a tooltip.
fn pair(ui: &mut Ui, name: &str, value: impl Into<String>, tip: &str) {
    theme::weak(ui, name).on_hover_text(tip);
    // A long value must not widen the panel.
    let value = Label::new(RichText::new(value.into()).color(ui.palette().text)).truncate();
    ui.scope(|ui| {
        ui.set_max_width(VALUE.min(ui.max_rect().width()));
        ui.add(value).on_hover_text(tip);
    });
    ui.end_row();
}

/// A grid of names and values.
fn grid(ui: &mut Ui, name: &str, rows: impl FnOnce(&mut Ui)) {
    Grid::new(name)
        .num_columns(2)
        .min_col_width(92.0)
        .spacing([8.0, 2.0])
        .show(ui, rows);
}

/// 1-σ of pan, tilt, focal length and of the lines at the worst corner.
fn uncertainty(ui: &mut Ui, solved: &FrameSolution) {
    theme::title(ui, "1-σ");
    grid(ui, "uncertainty", |ui| {
        pair(
            ui,
            "Pan",
            format!("±{:.3}°", solved.sigma_pan().degrees()),
            "1-σ of the pan.",
        );
        pair(
            ui,
            "Tilt",
            format!("±{:.3}°", solved.sigma_tilt().degrees()),
            "1-σ of the tilt.",
        );
        let share = 100.0 * solved.sigma_focal_px() / solved.ptz.focal_px;
        let focal = format!("±{:.1} px  ({share:.2} %)", solved.sigma_focal_px());
        pair(ui, "Focal length", focal, "1-σ of the focal length.");
        pair(
            ui,
            "Worst corner",
            solved.describe_corner(),
            "1-σ of the lines at the worst corner of the picture.",
        );
    });
    ui.add_space(theme::SPACE);
}

/// The separation of the landmarks, the quality of the fit, the distortion.
fn evidence(ui: &mut Ui, solved: &FrameSolution) {
    grid(ui, "evidence", |ui| {
        if let Some(separation) = solved.separation_px {
            let tip = "The largest distance between two landmarks. Points farther apart give a better focal length.";
            pair(ui, "Separation", format!("{separation:.0} px"), tip);
        }
        // `residuals_are_evidence` says from how many points on a fit means anything.
        let fit = match solved.misfit() {
            Some(misfit) if solved.residuals_are_evidence() => {
                format!("{:.1} px rms, {misfit:.1} × usual", solved.rms_px)
            }
            _ => "no evidence: two points always fit".to_owned(),
        };
        pair(
            ui,
            "Fit",
            fit,
            "The distances of the points from their projections.",
        );
        if !solved.lens.is_none() {
            pair(
                ui,
                "k1",
                format!("{:.4}", solved.lens.k1),
                "Radial distortion at this focal length.",
            );
        }
    });
    ui.add_space(theme::SPACE);
}

/// The residual of each point in px of the picture, and the check points. Residuals that are no
/// evidence are not shown.
fn residuals(ui: &mut Ui, solved: &FrameSolution) {
    // Check points were not fitted, so they are shown even where the other residuals prove nothing.
    if !solved.residuals_are_evidence() && solved.checks.is_empty() {
        return;
    }
    theme::title(ui, "RESIDUALS, px");
    Grid::new("residuals")
        .num_columns(4)
        .min_col_width(48.0)
        .spacing([8.0, 2.0])
        .show(ui, |ui| {
            for head in ["point", "right", "down", "1-σ"] {
                theme::small_weak(ui, head);
            }
            ui.end_row();
            for residual in &solved.residuals {
                ui.label((residual.click + 1).to_string());
                let offset = residual
                    .offset_px
                    .filter(|_| solved.residuals_are_evidence());
                for axis in 0..2 {
                    ui.label(
                        offset.map_or_else(|| "–".to_owned(), |offset| format_signed(offset[axis])),
                    );
                }
                ui.label(format!("{:.1}", residual.sigma_px));
                ui.end_row();
            }
        });
    // Check points in words below the table.
    for check in &solved.checks {
        let description = match (check.error_px, check.z_score) {
            (Some(px), Some(z)) => {
                format!("Check point {}: {px:.1} px off, {z:.1} σ", check.click + 1)
            }
            (Some(px), None) => format!("Check point {}: {px:.1} px off", check.click + 1),
            (None, _) => format!("Check point {}: out of view", check.click + 1),
        };
        ui.label(description);
    }
    ui.add_space(theme::SPACE);
}

/// A number with its sign and two digits. Without the rounding, -0.001 would be written -0.00.
fn format_signed(px: f64) -> String {
    format!("{:+.2}", if px.abs() < 0.005 { 0.0 } else { px })
}

/// Lists the landmarks that would reduce the uncertainty most. A click on one makes it the name of
/// the next point.
fn next_clicks(panel: &mut Panel<'_>, ui: &mut Ui) {
    /// Maximum number of landmarks in the list.
    const SHOWN: usize = 4;
    let next: Vec<_> = panel
        .app
        .current()
        .next_clicks
        .iter()
        .take(SHOWN)
        .cloned()
        .collect();
    if next.is_empty() {
        return;
    }
    theme::title(ui, "NEXT POINT");
    for next in next {
        let target = Target::Landmark(next.id.clone());
        let label = panel.app.label(&target);
        let tip = format!(
            "{label}: the worst corner would be ±{:.1} px, {}. Click here, then click it in the picture.",
            next.worst_corner_px,
            next.gain()
        );
        let button = Button::new(
            RichText::new(format!("{label}: {}", next.gain())).color(ui.palette().text),
        );
        if show_button(ui, button.frame(false).truncate(), tip) {
            panel.edit(EditAction::Pick(target));
        }
    }
    ui.add_space(theme::SPACE);
}

/// Offers the second root of the two-point solution, if there is one: another focal length with
/// which the points fit as well.
fn other_root(panel: &mut Panel<'_>, ui: &mut Ui, solved: &FrameSolution) {
    let Some(other) = panel.app.current().other_root() else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(format!(
            "Both {:.0} and {:.0} px fit.",
            solved.ptz.focal_px, other.focal_px
        ));
        panel.run_on_click(ui.add(Button::new("Switch").small()), Command::SwitchRoot);
    });
    ui.add_space(theme::SPACE);
}

/// Lists warnings.
fn warnings<'a>(ui: &mut Ui, messages: impl Iterator<Item = &'a str>) {
    for message in messages {
        ui.horizontal_top(|ui| {
            let palette = ui.palette();
            symbol::show(ui, Symbol::Warning, palette.caution);
            ui.add(Label::new(message).wrap());
        });
    }
    ui.add_space(theme::SPACE);
}

/// Buttons that copy the camera as text for other programs.
fn copy(app: &App, ui: &mut Ui) {
    let Some(camera) = app.shown_values().camera else {
        return;
    };
    ui.add_space(theme::SPACE);
    theme::title(ui, "COPY AS TEXT");
    ui.horizontal_wrapped(|ui| {
        for text in CameraText::ALL {
            let button = ui
                .add(Button::new(text.label()).small())
                .on_hover_text(text.about());
            if button
                .accessible_name(format!("Copy {}", text.label()))
                .clicked()
            {
                ui.ctx().copy_text(text.format(&camera));
            }
        }
    });
}

/// Shows what the document records about a solution that was not computed here.
fn show_recorded_solution(ui: &mut Ui, solution: &Solution) {
    grid(ui, "recorded", |ui| {
        if let Some(rms_px) = solution.rms_px {
            pair(
                ui,
                "Fit",
                format!("{rms_px:.1} px rms"),
                "As recorded in the document.",
            );
        }
        if let Some(confidence) = solution.confidence {
            let tip = "The probability that the lines are right within 10 px at 1920 px width.";
            pair(ui, "Confidence", percent(confidence), tip);
        }
    });
    warnings(
        ui,
        solution
            .warnings
            .iter()
            .map(|warning| warning.message.as_str()),
    );
}

/// Shows the position of the camera in the frame of the field, m, and the buttons that copy it.
fn camera(app: &App, ui: &mut Ui) {
    let Some(base) = app.shown_values().base else {
        return;
    };
    theme::title(ui, "CAMERA POSITION");
    grid(ui, "camera stands", |ui| {
        let position = base.position_m;
        pair(
            ui,
            "Height",
            format!("{:.2} m", position.z),
            "Above the field's centre.",
        );
        let place = format!("x {:.2}, y {:.2} m", position.x, position.y);
        pair(
            ui,
            "Position",
            place,
            "From the field's centre: x along its length, y away from the main camera.",
        );
    });
    copy(app, ui);
}
