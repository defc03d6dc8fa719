//! The main button: it makes the frame a reference, or opens the sheet for the selected frames;
//! while an estimated base waits for a decision it takes that base.

use crate::ui::Panel;
use crate::ui::controls::symbol::{self, Symbol};
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Button, CornerRadius, FontId, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, Vec2,
    WidgetInfo, vec2,
};
use touchline_application::app::Command;
use touchline_core::geometry::pluralise;
use touchline_documents::document::FrameStatus;

/// Height of the button, points.
const HEIGHT: f32 = 44.0;
/// Width of the button that discards an estimated base, points.
const DISCARD: f32 = 84.0;

/// Shows the button, disabled with the reason if the frame cannot be accepted.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    if panel.app.decides_about_base() {
        base(panel, ui);
        return;
    }
    if let Some(count) = panel.app.stretch_size() {
        stretch(panel, ui, count);
        return;
    }
    // An accepted frame keeps the button: Enter on it goes on to the next frame.
    let why_not = panel.app.unacceptable();
    let accepted = panel
        .app
        .frame()
        .is_some_and(|frame| frame.status == FrameStatus::Reference);
    let says = if accepted { "Accepted" } else { "Accept" };
    ui.add_enabled_ui(why_not.is_none(), |ui| {
        let look = if accepted {
            AcceptButtonState::Done
        } else {
            AcceptButtonState::ToDo
        };
        let response = button(ui, says, Some(Symbol::Return), look, ui.available_width());
        let keys = &panel.app.settings.keys;
        let stay = keys.tooltip(Command::AcceptAndStay);
        let response = response.on_hover_text(format!("{}\n{stay}", keys.tooltip(Command::Accept)));
        let response = match &why_not {
            Some(reason) => response.on_disabled_hover_text(reason),
            None => response,
        };
        if response.clicked() {
            panel.run(Command::Accept);
        }
    });
}

/// The button while frames are selected: it counts those that can be accepted.
fn stretch(panel: &mut Panel<'_>, ui: &mut Ui, count: usize) {
    let says = format!("Accept {}…", pluralise(count, "selected frame"));
    let response = button(
        ui,
        &says,
        Some(Symbol::Return),
        AcceptButtonState::ToDo,
        ui.available_width(),
    );
    let about = Command::AcceptStretch.about();
    if response.on_hover_text(about).clicked() {
        panel.run(Command::AcceptStretch);
    }
}

/// Shows the decision about an estimated base. It is taken or discarded here only.
fn base(panel: &mut Panel<'_>, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - DISCARD - ui.spacing().item_spacing.x;
        let take = button(ui, "Use this base", None, AcceptButtonState::ToDo, width);
        panel.run_on_click(take, Command::UseEstimatedBase);
        let discard = ui.add(Button::new("Discard").min_size(vec2(DISCARD, HEIGHT)));
        panel.run_on_click(discard, Command::DropEstimatedBase);
    });
}

/// Whether the button's action has been done already.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AcceptButtonState {
    ToDo,
    Done,
}

/// A large button with a word and an optional symbol, centred together.
fn button(
    ui: &mut Ui,
    says: &str,
    sign: Option<Symbol>,
    look: AcceptButtonState,
    width: f32,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click());
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, says));
    // Colours by state. A button that is done only invites again under the pointer.
    let (ground, text) = match (
        enabled,
        response.is_pointer_button_down_on(),
        response.hovered(),
    ) {
        (false, ..) => (ui.palette().raised, ui.palette().weak),
        _ if look == AcceptButtonState::Done && !response.hovered() => {
            (ui.palette().raised, ui.palette().good)
        }
        (_, true, _) | (_, _, true) => (ui.palette().accent_hovered, ui.palette().on_accent),
        _ => (ui.palette().accent, ui.palette().on_accent),
    };
    let painter = ui.painter();
    painter.rect_filled(rect, CornerRadius::same(6), ground);
    if response.has_focus() {
        painter.rect_stroke(
            rect,
            CornerRadius::same(6),
            Stroke::new(2.0, ui.palette().strong),
            StrokeKind::Inside,
        );
    }
    // Word and symbol are centred together: the symbol with its gap takes 24 points, so the word
    // goes to the left by half of that.
    let galley = painter.layout_no_wrap(says.to_owned(), FontId::proportional(theme::TITLE), text);
    let beside = if sign.is_some() {
        vec2(12.0, 0.0)
    } else {
        Vec2::ZERO
    };
    let word = Rect::from_center_size(rect.center() - beside, galley.size());
    painter.galley(word.min, galley, text);
    if let Some(sign) = sign {
        let place = Rect::from_center_size(word.right_center() + vec2(16.0, 0.0), vec2(16.0, 16.0));
        symbol::paint(painter, sign, place, text);
    }
    response
}
