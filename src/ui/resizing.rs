//! Edges of panels that can be dragged. A size is remembered in the settings once the edge is let
//! go; a double click gives the default back.

use super::theme::Themed as _;
use egui::{Context, CursorIcon, Id, Rect, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

/// How near to an edge the pointer takes hold of it, points.
const REACH: f32 = 5.0;

/// An edge that is dragged.
pub struct Edge {
    /// Tells edges apart.
    pub id: &'static str,
    /// Its accessible name.
    pub name: &'static str,
    /// The panel lies to the right of the edge and not below it.
    pub panel_is_right: bool,
    /// The smallest and largest size of the panel, points.
    pub range: [f32; 2],
}

/// What became of a panel's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resized {
    /// It is as it was.
    No,
    /// It is this, points.
    To(f32),
    /// It is the default.
    Default,
}

impl Edge {
    /// The panel's size while its edge is dragged, else as it is remembered, else the default;
    /// within the range.
    pub fn size(&self, ctx: &Context, remembered: Option<f32>, default: f32) -> f32 {
        let live = ctx.data(|data| data.get_temp::<f32>(Id::unique(self.id)));
        let [least, most] = self.range;
        live.or(remembered)
            .unwrap_or(default)
            .clamp(least, most.max(least))
            .round()
    }

    /// Reads the pointer on the edge of a panel that takes `panel`.
    pub fn read(&self, ui: &Ui, panel: Rect) -> Resized {
        // Within the panel: beside it lies the picture, where a press places a point.
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
        if response.double_clicked() {
            ui.data_mut(|data| data.remove::<f32>(memory));
            return Resized::Default;
        }
        let size = if self.panel_is_right {
            panel.width()
        } else {
            panel.height()
        };
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
