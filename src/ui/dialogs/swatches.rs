//! A row of colours for lines. Those that can be distinguished from the sport's ground with every
//! kind of colour vision come first and are underlined.

use crate::ui::controls::theme;
use crate::ui::controls::theme::Themed as _;
use egui::{
    Color32, CornerRadius, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2,
};
use touchline_application::scene::{Ground, LINE_COLOURS, LineColour};

/// Side of a colour's square, points.
const SIDE: f32 = 20.0;

/// Shows the colours, and at the end a button for any other. Returns the one that was chosen.
/// `whose` is put before the accessible names.
pub fn show(ui: &mut Ui, whose: &str, ground: Option<Ground>, chosen: [u8; 3]) -> Option<[u8; 3]> {
    // Without a known sport no colour is safe, and all are shown without an underline.
    let is_safe =
        |colour: &LineColour| ground.is_some_and(|ground| colour.safe_on.contains(&ground));
    let (safe, other): (Vec<_>, Vec<_>) = LINE_COLOURS.iter().partition(|colour| is_safe(colour));
    let mut taken = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::SPACE;
        let safe_width = safe.len() as f32 * (SIDE + theme::SPACE) - theme::SPACE;
        // The line that underlines the safe colours.
        let below = Rect::from_min_size(
            ui.cursor().left_top() + vec2(0.0, SIDE + 1.0),
            vec2(safe_width, 1.0),
        );
        for colour in safe.iter().chain(&other) {
            let tip = match (ground, is_safe(colour)) {
                (Some(_), true) => format!(
                    "{}: easy to see on the ground with every kind of colour vision.",
                    colour.name
                ),
                (Some(_), false) => format!(
                    "{}: hard to see on the ground with some kinds of colour vision.",
                    colour.name
                ),
                (None, _) => format!("{}.", colour.name),
            };
            if swatch(ui, colour, whose, chosen == colour.rgb, &tip) {
                taken = Some(colour.rgb);
            }
        }
        if !safe.is_empty() {
            ui.painter().hline(
                below.x_range(),
                below.top(),
                Stroke::new(2.0, ui.palette().good),
            );
        }
        let mut any = chosen;
        ui.color_edit_button_srgb(&mut any)
            .accessible_name(format!("{whose}Any colour"))
            .on_hover_text("Any other colour.");
        if any != chosen {
            taken = Some(any);
        }
    });
    // A click on the present colour is no choice.
    taken.filter(|taken| *taken != chosen)
}

/// Shows a colour as a button. Returns whether it was clicked.
fn swatch(ui: &mut Ui, colour: &LineColour, whose: &str, chosen: bool, tip: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    let name = format!("{whose}{}", colour.name);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    let painter = ui.painter();
    let [r, g, b] = colour.rgb;
    painter.rect_filled(
        rect.shrink(2.0),
        CornerRadius::same(3),
        Color32::from_rgb(r, g, b),
    );
    // The border makes white visible on a light ground.
    let border = Stroke::new(1.0, ui.palette().window_line);
    painter.rect_stroke(
        rect.shrink(2.0),
        CornerRadius::same(3),
        border,
        StrokeKind::Inside,
    );
    if chosen || response.hovered() || response.has_focus() {
        let line = Stroke::new(if chosen { 2.0 } else { 1.0 }, ui.palette().strong);
        painter.rect_stroke(rect, CornerRadius::same(4), line, StrokeKind::Inside);
    }
    response.on_hover_text(tip).clicked()
}
