//! The list of the frame's points, one row each: number, name, residual, and buttons.

use crate::ui::Panel;
use crate::ui::controls::symbol::Symbol;
use crate::ui::controls::theme::{Palette, Themed as _};
use crate::ui::controls::{replace_remembered, symbol, theme};
use crate::ui::drawing::labels::{self, lay_out_within};
use crate::ui::rows::menu;
use egui::{
    Align, Align2, Color32, CornerRadius, FontId, Layout, Rect, Role, ScrollArea, Sense, Ui,
    UiBuilder, WidgetInfo, pos2, vec2,
};
use touchline_application::app::{Action, App, Command, EditAction, Navigation};
use touchline_application::scene::overlay::{CHECK, click_colour};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{Click, ClickOrigin};

/// Width of the column of residuals, points.
const RESIDUAL: f32 = 50.0;

/// What stands beside the heading, once for all points, where residuals are no evidence.
const NO_EVIDENCE: &str = "no evidence";
const WHY_NO_EVIDENCE: &str = "Two points can always be fitted, so their residual proves nothing.";

/// The commands in the context menu of a point.
const MENU: [Command; 4] = [
    Command::RenameClick,
    Command::ToggleCheck,
    Command::ZoomToClick,
    Command::DeleteClick,
];

/// Shows the list. It takes at most `room` points of height and scrolls beyond that.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, room: f32) {
    ui.horizontal(|ui| {
        let count = panel.app.frame().map_or(0, |frame| frame.clicks.len());
        let heading = if count == 0 {
            "POINTS".to_owned()
        } else {
            format!("POINTS  {count}")
        };
        theme::title(ui, &heading);
        if count > 0 && !residuals_are_evidence(panel.app) {
            theme::weak(ui, NO_EVIDENCE).on_hover_text(WHY_NO_EVIDENCE);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            on_line_switch(panel, ui);
        });
    });
    // The list has room for four rows even if it is empty, so that what is below it stays in place
    // while the first points are clicked.
    let height = room.max(4.0 * theme::LIST_ROW);
    ScrollArea::vertical()
        .id_salt("points")
        .max_height(height)
        .min_scrolled_height(height)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.set_min_height(4.0 * theme::LIST_ROW);
            let clicks = panel
                .app
                .frame()
                .map(|frame| frame.clicks.clone())
                .unwrap_or_default();
            if clicks.is_empty() {
                ui.add_space(theme::SPACE);
                let says = if panel.app.current().base.is_some() {
                    "Two points that you can name are enough."
                } else {
                    "Points that you click in the picture are listed here."
                };
                theme::weak(ui, says);
            }
            // Scrolls to the selected point once; later the user may scroll away.
            let session = &panel.app.session;
            let into_view = is_newly_selected(ui, (session.frame, session.points.selected));
            for (index, click) in clicks.iter().enumerate() {
                row(panel, ui, index, click, into_view);
            }
        });
}

/// The switch that makes the next click a point on a line.
fn on_line_switch(panel: &mut Panel<'_>, ui: &mut Ui) {
    let command = Command::PlaceOnLine;
    let on = panel.app.session.points.next_on_line;
    let palette = ui.palette();
    let response = symbol::toggle(ui, Symbol::OnLine, command.name(), on, palette.accent);
    panel.run_on_click(response, command);
}

/// Shows one point. A click selects it, a double click renames it. The selected one is scrolled
/// `into_view`.
fn row(panel: &mut Panel<'_>, ui: &mut Ui, index: usize, click: &Click, into_view: bool) {
    let app = panel.app;
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), theme::LIST_ROW), Sense::click());
    let selected = app.session.points.selected == Some(index);
    if selected && into_view {
        response.scroll_to_me(None);
    }
    let name = name(app, click);
    let residual = residual(ui.palette(), app, index, click);
    response.widget_info(|| {
        let label = format!("Point {}: {name}, {}", index + 1, residual.text);
        WidgetInfo::selected(Role::Button, true, selected, label)
    });
    // Its buttons, too, hover over the row.
    let hovered = ui.rect_contains_pointer(rect);
    let ground = match (selected, hovered) {
        (true, _) => Some(ui.palette().accent_ground),
        (false, true) => Some(ui.palette().raised),
        (false, false) => None,
    };
    if let Some(ground) = ground {
        ui.painter()
            .rect_filled(rect, CornerRadius::same(4), ground);
    }
    let colour = colour(app, index, click);
    let painter = ui.painter().clone();
    let middle = rect.center().y;
    let small = FontId::proportional(theme::SMALL);
    // From left to right: number, symbol of its kind, name, residual. The buttons, which come last,
    // stand only in the row that is selected or pointed at, so that names have room.
    painter.text(
        pos2(rect.left() + 14.0, middle),
        Align2::RIGHT_CENTER,
        index + 1,
        small.clone(),
        ui.palette().weak,
    );
    let kind = if click.is_on_line() {
        Symbol::OnLine
    } else {
        Symbol::Landmark
    };
    let mark = Rect::from_center_size(pos2(rect.left() + 26.0, middle), vec2(16.0, 16.0));
    // The colours of points are chosen for pictures, so the symbol gets a ground like a picture's.
    painter.rect_filled(
        mark,
        CornerRadius::same(3),
        theme::under_colours_of_pictures(ui),
    );
    symbol::paint(&painter, kind, mark, colour);

    let has_buttons = selected || hovered;
    let buttons = if has_buttons {
        2.0 * theme::SYMBOL.x
    } else {
        0.0
    };
    let text_left = rect.left() + 38.0;
    let residual_width = if residual.is_evidence { RESIDUAL } else { 0.0 };
    let text_width = rect.right() - buttons - residual_width - 4.0 - text_left;
    let strength = if click.target.is_none() {
        ui.palette().caution
    } else {
        ui.palette().text
    };
    let font = FontId::proportional(theme::BODY);
    let mut galley = lay_out_within(&painter, name.clone(), font.clone(), strength, text_width);
    if galley.elided {
        // Names that begin alike would be cut to the same text, so the unique code goes in front.
        let text = code(app, click).map_or_else(|| name.clone(), |code| format!("{code} · {name}"));
        galley = lay_out_within(&painter, text, font, strength, text_width);
    }
    painter.galley(
        pos2(text_left, middle - galley.size().y / 2.0),
        galley,
        strength,
    );
    if residual.is_evidence {
        let right = pos2(rect.right() - buttons - 4.0, middle);
        painter.text(
            right,
            Align2::RIGHT_CENTER,
            &residual.text,
            small,
            residual.colour,
        );
    }

    // A double click reports a click as well, hence the order. A right click selects the point that
    // the commands of the menu act on.
    let response = response.on_hover_ui(|ui| tooltip(ui, app, index, click, &name));
    if response.double_clicked() {
        panel.actions.extend([
            Action::Navigate(Navigation::Select(Some(index))),
            Action::Command(Command::RenameClick),
        ]);
    } else if response.clicked() || response.secondary_clicked() {
        panel.navigate(Navigation::Select(Some(index)));
    }
    response.context_menu(|ui| menu::entries(panel, ui, &MENU));
    if !has_buttons {
        return;
    }
    // The buttons are widgets of their own on top of the row.
    let tail = Rect::from_min_max(pos2(rect.right() - buttons, rect.top()), rect.max);
    let layout = Layout::right_to_left(Align::Center);
    ui.scope_builder(UiBuilder::new().max_rect(tail).layout(layout), |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        tail_buttons(panel, ui, index, click);
    });
}

/// Whether another point was selected in the previous frame of the window, or none, or one of
/// another frame. `now` is the shown frame and its selected point.
fn is_newly_selected(ui: &Ui, now: (usize, Option<usize>)) -> bool {
    let memory = egui::Id::unique("selected point in view");
    replace_remembered(ui, memory, now) != Some(now)
}

/// The buttons at the end of a row: delete the point, make it a check point or an ordinary one.
fn tail_buttons(panel: &mut Panel<'_>, ui: &mut Ui, index: usize, click: &Click) {
    let keys = &panel.app.settings.keys;
    let palette = ui.palette();
    let delete = symbol::button(
        ui,
        Symbol::Cross,
        &format!("Delete point {}", index + 1),
        palette.weak,
    );
    let key = keys.with_key(Command::DeleteClick, |key| {
        format!(" ({key} deletes the selected one)")
    });
    if delete
        .on_hover_text(format!("Delete this point.{key}"))
        .clicked()
    {
        panel.edit(EditAction::DeleteClick(index));
    }
    let name = format!("Check point {}", index + 1);
    let on = labels::colour(CHECK);
    let check = symbol::toggle(ui, Symbol::Diamond, &name, click.check, on);
    if check
        .on_hover_text(keys.tooltip(Command::ToggleCheck))
        .clicked()
    {
        panel.edit(EditAction::SetCheck {
            click: index,
            check: !click.check,
        });
    }
}

/// The name of a point, or that it has none.
fn name(app: &App, click: &Click) -> String {
    click
        .target
        .as_ref()
        .map_or_else(|| "no name yet".to_owned(), |target| app.label(target))
}

/// The code that a user types for the point's name.
fn code<'a>(app: &'a App, click: &Click) -> Option<&'a str> {
    let field = app.current().field()?;
    click.target.as_ref()?.element(field)?.code(field)
}

/// The colour of the point in the picture.
fn colour(app: &App, index: usize, click: &Click) -> Color32 {
    let is_disputed = app.shown_values().disputed.contains(&index);
    labels::colour(click_colour(click, is_disputed))
}

/// The text about a point's residual, and its colour.
struct Residual {
    text: String,
    colour: Color32,
    /// Whether the row shows it. One that proves nothing is named once, beside the heading.
    is_evidence: bool,
}

impl Residual {
    fn quiet(text: &str, palette: &Palette) -> Self {
        Self {
            text: text.to_owned(),
            colour: palette.weak,
            is_evidence: true,
        }
    }

    /// A distance, emphasised beyond the limit.
    fn distance(px: f64, limit_px: f64, palette: &Palette) -> Self {
        Self {
            text: format!("{px:.1} px"),
            colour: if px > limit_px {
                palette.caution
            } else {
                palette.text
            },
            is_evidence: true,
        }
    }
}

/// Whether what the shown frame's points are off says anything about its camera.
fn residuals_are_evidence(app: &App) -> bool {
    let solution = app.shown_values().click_solution();
    solution.is_none_or(FrameSolution::residuals_are_evidence)
}

/// Describes the residual of a point.
///
/// | point | text |
/// |---|---|
/// | without a name | nothing |
/// | check point | distance in px, and in σ of its prediction where that is known |
/// | without a projection | "out of view" |
/// | of a frame in which residuals are no evidence | "no evidence" |
/// | any other | distance in px, emphasised beyond 3 σ |
fn residual(palette: &Palette, app: &App, index: usize, click: &Click) -> Residual {
    if click.target.is_none() {
        return Residual::quiet("", palette);
    }
    let solved = app.shown_values().click_solution();
    // A check point was not fitted, so its error is evidence even in a frame of two clicks.
    if let Some(solved) = solved.filter(|_| click.check) {
        let Some(check) = solved.checks.iter().find(|check| check.click == index) else {
            return Residual::quiet("–", palette);
        };
        // The σ of a prediction contains the click noise and the uncertainty of the camera. The
        // limit is in σ, so the one in px is chosen to be passed or kept accordingly.
        return match (check.error_px, check.z_score) {
            (Some(px), Some(z)) => Residual {
                text: format!("{px:.1} px  {z:.1} σ"),
                ..Residual::distance(px, if z > 3.0 { 0.0 } else { px }, palette)
            },
            (Some(px), None) => Residual::distance(px, px, palette),
            (None, _) => Residual::quiet("out of view", palette),
        };
    }
    let Some(residual) = app.shown_values().residual(index) else {
        return Residual::quiet("–", palette);
    };
    match residual.distance_px() {
        None => Residual::quiet("out of view", palette),
        Some(_) if !residuals_are_evidence(app) => Residual {
            is_evidence: false,
            ..Residual::quiet(NO_EVIDENCE, palette)
        },
        Some(px) => Residual::distance(px, 3.0 * residual.sigma_px, palette),
    }
}

/// The tooltip of a point: name, position in px, and what is special about it.
fn tooltip(ui: &mut Ui, app: &App, index: usize, click: &Click, name: &str) {
    theme::strong(ui, format!("{}  {name}", index + 1));
    ui.label(format!("x {:.2}, y {:.2} px", click.image.x, click.image.y));
    if let Some(sigma_px) = click.snapped_sigma_px {
        ui.label(format!(
            "Snapped to the paint, known to ±{sigma_px:.1} px. Hold Alt while releasing to keep a point as placed."
        ));
    }
    if let Some(origin) = &click.origin {
        ui.label(describe_origin(origin));
    }
    if click.check {
        ui.label("Check point: left out of the solve, its error is shown.");
    } else if !residuals_are_evidence(app) {
        ui.label(WHY_NO_EVIDENCE);
    }
    let keys = &app.settings.keys;
    let key = keys.with_key(Command::RenameClick, |key| format!(" or press {key}"));
    let rename = format!("Double-click{key} to rename it.");
    theme::weak(ui, rename);
}

/// What a model says of a point, or that a person moved or renamed it.
fn describe_origin(origin: &ClickOrigin) -> String {
    let model = origin.model();
    if origin.given.is_some() {
        return format!("From {model}, moved or renamed by you.");
    }
    let probability = origin
        .probability
        .map(|probability| format!(" with a probability of {:.0} %", 100.0 * probability));
    let sigma = origin
        .sigma_px
        .map(|sigma_px| format!(", known to ±{sigma_px:.1} px"));
    format!(
        "Found by {model}{}{}. No person has looked at it: move or rename it, or accept the frame.",
        probability.unwrap_or_default(),
        sigma.unwrap_or_default()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_scrolled_to_whenever_it_becomes_the_selected_one() {
        let mut found = Vec::new();
        let mut output = egui::Context::default().run_ui(egui::RawInput::default(), |ui| {
            let two = Some(2);
            let shown = [(0, two), (0, two), (0, None), (0, two), (1, two)];
            found = shown.map(|now| is_newly_selected(ui, now)).to_vec();
        });
        output.textures_delta.clear();
        assert_eq!(found, [true, false, true, true, true]);
    }
}
