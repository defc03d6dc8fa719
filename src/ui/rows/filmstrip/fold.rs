//! A cell of the filmstrip that stands for a run of frames without an answer from the forest.

use super::item::{BAR, CAPTION};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::pictures::WHOLE;
use egui::{
    Align2, Color32, CornerRadius, FontId, Id, Rect, Role, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};
use touchline_application::app::Navigation;
use touchline_application::app::selection::Selecting;

/// Offset between the sheets of the stack, points.
const SHEET: f32 = 3.0;

/// Shows the cell as a stack of sheets with the number of frames. A click shows the `middle` frame,
/// which splits the run.
///
/// `(first, last)` are positions in the document; a filter may hide some frames between them.
pub fn show(
    panel: &mut Panel<'_>,
    ui: &Ui,
    (first, last): (usize, usize),
    middle: usize,
    count: usize,
    place: Rect,
) {
    let response = ui.interact(place, Id::unique(("filmstrip fold", first)), Sense::click());
    let Some(open) = panel.app.open() else { return };
    let (from, to) = (open.frame_number(first), open.frame_number(last));
    let said = format!("{count} frames without an answer, {from} to {to}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &said));
    let painter = ui.painter();
    let picture = Rect::from_min_max(
        place.min,
        pos2(place.right(), place.bottom() - CAPTION - BAR - 2.0),
    );
    let top = Rect::from_min_max(
        picture.min + vec2(0.0, 2.0 * SHEET),
        picture.max - vec2(2.0 * SHEET, 0.0),
    );
    // Three sheets from back to front: the rear ones stand out to the upper right.
    for sheet in [2.0, 1.0, 0.0] {
        let shape = top.translate(vec2(SHEET * sheet, -SHEET * sheet));
        painter.rect_filled(shape, CornerRadius::same(3), theme::ON_PICTURE.raised);
        painter.rect_stroke(
            shape,
            CornerRadius::same(3),
            Stroke::new(1.0, ui.palette().line),
            StrokeKind::Inside,
        );
    }
    // Dark, so that the number in front of it is legible.
    if let Some(texture) = panel.pictures.thumbnail(open, middle) {
        painter.image(texture.id(), top.shrink(1.0), WHOLE, Color32::from_gray(70));
    }
    painter.text(
        top.center(),
        Align2::CENTER_CENTER,
        count,
        FontId::proportional(theme::TITLE),
        theme::ON_PICTURE.strong,
    );
    let below = top.center() + vec2(0.0, 16.0);
    painter.text(
        below,
        Align2::CENTER_CENTER,
        "no answer",
        FontId::proportional(theme::SMALL),
        theme::ON_PICTURE.text,
    );
    // The range of frame numbers below, where other cells have their number.
    let line = place.bottom() - CAPTION / 2.0;
    let numbers = format!("{from}–{to}");
    painter.text(
        pos2(place.left() + 1.0, line),
        Align2::LEFT_CENTER,
        numbers,
        FontId::proportional(theme::SMALL),
        ui.palette().weak,
    );
    if response.hovered() || response.has_focus() {
        painter.rect_stroke(
            top.expand(1.0),
            CornerRadius::same(4),
            Stroke::new(1.0, ui.palette().weak),
            StrokeKind::Outside,
        );
    }
    let tip = format!(
        "{said}. The forest does not recognise them. A label on one of them may answer the others."
    );
    if response.on_hover_text(tip).clicked() {
        let navigation = if ui.input(|input| input.modifiers.shift) {
            // The range goes from the shown frame to the far end of the run, so that all of it is
            // selected. The shown frame is within the run only if the filter hides it.
            let is_before = last < panel.app.session.frame;
            Navigation::SelectFrame {
                frame: if is_before { first } else { last },
                how: Selecting::Range,
            }
        } else {
            Navigation::GoTo(middle)
        };
        panel.navigate(navigation);
    }
}
