//! Masks on the picture: boxes that are excluded from feature detection. Each shows for which
//! frames it is, and a button that deletes it.

use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::drawing::labels::{PlateStyle, plate, text_width};
use crate::ui::drawing::placement::Placement;
use egui::{
    Align2, Color32, FontId, Id, Painter, Rect, Role, Sense, Stroke, Vec2, WidgetInfo, vec2,
};
use touchline_application::app::{App, EditAction, MaskList, Tool};
use touchline_core::geometry::{ImagePoint, PixelBox};

/// Side of the delete button, points.
const CROSS: f32 = 18.0;

/// A mask that is shown, and its place in the document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownMask {
    /// The list that has it.
    pub list: MaskList,
    /// Its index in that list.
    pub index: usize,
    /// The box, px of the picture.
    pub pixel_box: PixelBox,
}

/// The masks that cover the shown frame: those of the camera for every frame, those for a range of
/// frames, those of the frame. None unless masks are shown.
pub fn shown_masks(app: &App) -> Vec<ShownMask> {
    let Some(frame) = app
        .frame()
        .filter(|_| app.session.picture.tool == Tool::Mask)
    else {
        return Vec::new();
    };
    // Each mask keeps its index in its own list, by which an action names it; so masks that do not
    // cover the frame are left out after the numbering.
    let camera = app
        .camera_id()
        .and_then(|id| app.open()?.document.camera(id));
    let of_camera = camera
        .map(|camera| camera.masks.as_slice())
        .unwrap_or_default();
    let ranged = camera
        .map(|camera| camera.ranged_masks.as_slice())
        .unwrap_or_default();
    let covering = ranged
        .iter()
        .enumerate()
        .filter(|(_, mask)| mask.covers(frame));
    let ranged = covering.map(|(index, mask)| ShownMask {
        list: MaskList::Ranged,
        index,
        pixel_box: mask.pixel_box,
    });
    [
        masks_of_list(of_camera, MaskList::Camera),
        ranged.collect(),
        masks_of_list(&frame.masks, MaskList::Frame),
    ]
    .concat()
}

/// The masks of a list that all cover the frame.
fn masks_of_list(masks: &[PixelBox], list: MaskList) -> Vec<ShownMask> {
    let numbered = masks.iter().enumerate();
    numbered
        .map(|(index, pixel_box)| ShownMask {
            list,
            index,
            pixel_box: *pixel_box,
        })
        .collect()
}

impl ShownMask {
    /// Where the mask is on the screen.
    fn on_screen(&self, placement: &Placement) -> Rect {
        on_screen(&self.pixel_box, placement)
    }

    /// Where its delete button is on the screen: in the upper right corner of its visible part.
    pub fn cross(&self, placement: &Placement) -> Rect {
        // A mask may extend beyond the view; its button must not.
        let corner = self
            .on_screen(placement)
            .intersect(placement.rect)
            .right_top();
        Rect::from_center_size(corner + vec2(-CROSS, CROSS) / 2.0, Vec2::splat(CROSS))
    }
}

/// Where a box of the picture is on the screen.
fn on_screen(pixel_box: &PixelBox, placement: &Placement) -> Rect {
    let &PixelBox {
        x,
        y,
        width,
        height,
    } = pixel_box;
    let corner = |x, y| placement.screen_from_image(ImagePoint::new(x, y));
    Rect::from_min_max(corner(x, y), corner(x + width, y + height))
}

/// Writes for which frames a mask is, in its lower left corner, if it is wide enough.
fn label(painter: &Painter, mask: Rect, placement: &Placement, says: &str) {
    // The corner of the visible part: a mask may extend beyond the view.
    let shown = mask.intersect(placement.rect);
    let (font, letters) = (FontId::proportional(theme::SMALL), Color32::from_gray(225));
    if text_width(painter, says, font.clone()) + 16.0 <= shown.width() {
        let style = PlateStyle::new(font, letters, Color32::from_black_alpha(150));
        plate(
            painter,
            shown.left_bottom() + vec2(8.0, -10.0),
            Align2::LEFT_CENTER,
            says,
            style,
        );
    }
}

/// Shows for which frames each mask is, and its delete button. The boxes themselves belong to the
/// overlay.
pub fn show(panel: &mut Panel<'_>, ui: &egui::Ui, placement: &Placement) {
    let painter = ui.painter_at(placement.rect);
    // Boxes that look burnt in, about which the user is yet to decide.
    for mask in panel.app.masks_in_question() {
        let whole = on_screen(&mask, placement);
        if whole.intersects(placement.rect) {
            label(&painter, whole, placement, "looks burned in");
        }
    }
    for mask in shown_masks(panel.app) {
        let whole = mask.on_screen(placement);
        if !whole.intersects(placement.rect) {
            continue;
        }
        let (what, name) = match mask.list {
            MaskList::Camera => ("every frame", "camera"),
            MaskList::Ranged => ("some frames", "ranged"),
            MaskList::Frame => ("this frame", "frame"),
        };
        label(&painter, whole, placement, what);
        // The delete button, drawn by hand: it is on the picture, not in a layout.
        let rect = mask.cross(placement);
        let id = Id::NULL.with(("mask", mask.list, mask.index));
        let response = ui
            .interact(rect, id, Sense::click())
            .on_hover_text("Delete this mask.");
        let label = format!("Delete {name} mask {}", mask.index + 1);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        let fill = if response.hovered() {
            Color32::from_rgb(190, 60, 60)
        } else {
            Color32::from_black_alpha(170)
        };
        painter.rect_filled(rect.shrink(1.0), 3.0, fill);
        let arm = rect.shrink(6.0);
        let stroke = Stroke::new(1.5, Color32::WHITE);
        painter.line_segment([arm.left_top(), arm.right_bottom()], stroke);
        painter.line_segment([arm.right_top(), arm.left_bottom()], stroke);
        if response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
        if response.clicked() {
            panel.edit(EditAction::RemoveMask {
                list: mask.list,
                index: mask.index,
            });
        }
    }
}
