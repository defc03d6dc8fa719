//! Masks on the picture: boxes that are excluded from feature detection, each with its scope and a delete button.

use super::Panel;
use super::labels::{PlateStyle, plate};
use super::placement::Placement;
use crate::app::{Action, App};
use crate::geometry::{ImagePoint, PixelBox};
use egui::{Align2, Color32, FontId, Id, Rect, Role, Sense, Stroke, Vec2, WidgetInfo, vec2};

/// The side of a cross, points.
const CROSS: f32 = 18.0;

/// A shown mask: whether it belongs to the camera, and its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownMask {
    /// For every frame of the camera, else for this frame only.
    pub of_camera: bool,
    /// Its index.
    pub index: usize,
    /// The box, px.
    pub pixel_box: PixelBox,
}

/// The masks of the shown frame, the camera's first; none unless masks are shown.
pub fn shown(app: &App) -> Vec<ShownMask> {
    if !app.session.masks {
        return Vec::new();
    }
    let camera = app.camera_id().and_then(|id| app.open()?.document.camera(id));
    let of_camera = camera.map(|camera| camera.masks.as_slice()).unwrap_or_default();
    let of_frame = app.frame().map(|frame| frame.masks.as_slice()).unwrap_or_default();
    let listed = |masks: &[PixelBox], of_camera| -> Vec<ShownMask> {
        let numbered = masks.iter().enumerate();
        numbered.map(|(index, pixel_box)| ShownMask { of_camera, index, pixel_box: *pixel_box }).collect()
    };
    [listed(of_camera, true), listed(of_frame, false)].concat()
}

impl ShownMask {
    /// Where the mask lies on the screen.
    fn on_screen(&self, placement: &Placement) -> Rect {
        let PixelBox { x, y, width, height } = self.pixel_box;
        let corner = |x, y| placement.screen_from_image(ImagePoint::new(x, y));
        Rect::from_min_max(corner(x, y), corner(x + width, y + height))
    }

    /// Where its cross lies on the screen.
    pub fn cross(&self, placement: &Placement) -> Rect {
        let corner = self.on_screen(placement).intersect(placement.rect).right_top();
        Rect::from_center_size(corner + vec2(-CROSS, CROSS) / 2.0, Vec2::splat(CROSS))
    }
}

/// Shows the scope of each mask and its delete button.
pub fn show(panel: &mut Panel<'_>, ui: &egui::Ui, placement: &Placement) {
    let painter = ui.painter_at(placement.rect);
    for mask in shown(panel.app) {
        let whole = mask.on_screen(placement);
        if !whole.intersects(placement.rect) {
            continue;
        }
        let (what, name) = if mask.of_camera { ("every frame", "camera") } else { ("this frame", "frame") };
        let at = whole.intersect(placement.rect).left_bottom() + vec2(8.0, -10.0);
        let behind = Color32::from_black_alpha(150);
        plate(
            &painter,
            at,
            Align2::LEFT_CENTER,
            what,
            PlateStyle::new(FontId::proportional(11.0), Color32::from_gray(225), behind),
        );
        let rect = mask.cross(placement);
        let id = Id::NULL.with(("mask", mask.of_camera, mask.index));
        let response = ui.interact(rect, id, Sense::click()).on_hover_text("Delete this mask.");
        let label = format!("Delete {name} mask {}", mask.index + 1);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        let fill = if response.hovered() { Color32::from_rgb(190, 60, 60) } else { Color32::from_black_alpha(170) };
        painter.rect_filled(rect.shrink(1.0), 3.0, fill);
        let arm = rect.shrink(6.0);
        let stroke = Stroke::new(1.5, Color32::WHITE);
        painter.line_segment([arm.left_top(), arm.right_bottom()], stroke);
        painter.line_segment([arm.right_top(), arm.left_bottom()], stroke);
        if response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        if response.clicked() {
            panel.actions.push(Action::RemoveMask { of_camera: mask.of_camera, index: mask.index });
        }
    }
}
