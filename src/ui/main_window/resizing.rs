//! Edges of panels that can be dragged. The size is stored in the settings when the button goes up;
//! a double click restores the default.

use crate::ui::controls::theme::Themed as _;
use egui::{Context, CursorIcon, Id, Rect, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

/// Distance from an edge within which the pointer grabs it, points.
const REACH: f32 = 5.0;

/// An edge that can be dragged.
pub struct Edge {
    /// Distinguishes the edges.
    pub id: &'static str,
    /// Its accessible name.
    pub name: &'static str,
    /// Whether the panel is to the right of the edge; otherwise it is below.
    pub panel_is_right: bool,
    /// Minimum and maximum size of the panel, points.
    pub range: [f32; 2],
}

/// What the pointer did to the size of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resized {
    /// Nothing that is to be stored.
    No,
    /// A drag ended with this size, points.
    To(f32),
    /// A double click restored the default.
    Default,
}

impl Edge {
    /// The size of the panel, points, within the range: the one of the present drag, else the
    /// stored one, else the default.
    pub fn size(&self, ctx: &Context, remembered: Option<f32>, default: f32) -> f32 {
        let live = ctx.data(|data| data.get_temp::<f32>(Id::unique(self.id)));
        let [least, most] = self.range;
        live.or(remembered)
            .unwrap_or(default)
            .clamp(least, most.max(least))
            .round()
    }

    /// Reads the pointer on the edge of the panel, which takes the rectangle `panel`.
    pub fn read(&self, ui: &Ui, panel: Rect) -> Resized {
        // The grip is within the panel. Beside it is the picture, where a press would place a
        // point.
        let (edge, grip) = if self.panel_is_right {
            let edge = [panel.left_top(), panel.left_bottom()];
            (
                edge,
                Rect::from_min_max(edge[0] + vec2(0.5, 0.0), edge[1] + vec2(REACH, 0.0)),
            )
        } else {
            let edge = [panel.left_top(), panel.right_top()];
            (
                edge,
                Rect::from_min_max(edge[0] + vec2(0.0, 0.5), edge[1] + vec2(0.0, REACH)),
            )
        };
        let memory = Id::unique(self.id);
        let response = ui.interact(grip, memory.with("edge"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Splitter, true, self.name));
        if response.hovered() || response.dragged() {
            ui.ctx().set_cursor_icon(if self.panel_is_right {
                CursorIcon::ResizeHorizontal
            } else {
                CursorIcon::ResizeVertical
            });
            ui.painter()
                .line_segment(edge, Stroke::new(2.0, ui.palette().accent));
        }
        // A double click restores the default.
        if response.double_clicked() {
            ui.data_mut(|data| data.remove::<f32>(memory));
            return Resized::Default;
        }
        let size = if self.panel_is_right {
            panel.width()
        } else {
            panel.height()
        };
        // The size follows the pointer during the drag and is stored at its end.
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            let wanted = if self.panel_is_right {
                panel.right() - at.x
            } else {
                panel.bottom() - at.y
            };
            ui.data_mut(|data| data.insert_temp(memory, wanted));
            ui.ctx().request_repaint();
        } else if response.drag_stopped() {
            ui.data_mut(|data| data.remove::<f32>(memory));
            return Resized::To(size);
        }
        Resized::No
    }
}
