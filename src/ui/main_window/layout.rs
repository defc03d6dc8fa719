//! The layout of the window.
//!
//! From top to bottom: menu row, tour, picture, timeline, filmstrip, row of messages, status row.
//! The column of tools is to the left of picture, timeline and filmstrip, the side panel to their
//! right; the matches of a queue stand beside the tools. The quality page takes the place of
//! all but the column.

use super::keys;
use crate::ui::controls::theme::Themed as _;
use crate::ui::picture::{rejecting, typing, viewport};
use crate::ui::rows::{filmstrip, menu, notices, status, timeline, tools, tour};
use crate::ui::{
    Panel, camera_panel, cards, dialogs, inspector, quality, queue, reclick, review, start, trainer,
};
use egui::{
    Context, CursorIcon, Frame, Id, Margin, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use touchline_application::app::SettingsAction;
use touchline_application::app::session::SidePanel;

/// Height of the menu row, the row of messages and the status row, points.
const ROW: f32 = 24.0;
/// Width of the window from which the default sizes of the panels are larger, points.
const WIDE_WINDOW: f32 = 1800.0;

/// Minimum width of the side panel, points.
const LEAST_SIDE: f32 = 280.0;
/// Minimum size of the picture, points. It limits the sizes of the panels.
const LEAST_PICTURE: [f32; 2] = [480.0, 260.0];

/// Size of what stands around the picture beside the panels whose edges can be dragged, points: the
/// column of tools; the three rows and the timeline.
const FIXED: [f32; 2] = [tools::WIDTH, 3.0 * ROW + timeline::HEIGHT];

/// Stores the sizes of panels that were dragged, in the settings. The edges are side panel and
/// filmstrip.
fn store_panel_sizes(panel: &mut Panel<'_>, edges: [Resized; 2], remembered: [Option<f32>; 2]) {
    let side = size_to_store(edges[0], remembered[0]);
    let filmstrip = size_to_store(edges[1], remembered[1]);
    if [side, filmstrip] != remembered {
        panel.set(SettingsAction::PanelSizes { side, filmstrip });
    }
}

/// The size of a panel after the pointer was at its edge, points. `None` for the default.
fn size_to_store(resized: Resized, remembered: Option<f32>) -> Option<f32> {
    match resized {
        Resized::No => remembered,
        Resized::To(size) => Some(size),
        Resized::Default => None,
    }
}

/// Reads keys and pointer, before anything is drawn. The lists of names and of reasons come first
/// and remove the keys that they use.
pub fn read(panel: &mut Panel<'_>, ctx: &egui::Context) {
    if panel.app.session.quality.open {
        // The picture is hidden, and so are its lists of names and reasons. A button that goes up
        // over the page is not read, so the pointer lets go of the picture here.
        viewport::let_go(ctx);
        keys::read(panel.app, panel.actions, ctx);
        return;
    }
    typing::read(panel.app, panel.actions, ctx);
    rejecting::read(panel, ctx);
    keys::read(panel.app, panel.actions, ctx);
    viewport::read(panel, ctx);
}

/// Shows every panel. The actions of the user are in `panel.actions` afterwards.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let (filmstrip_height, side_width) = if ui.available_width() >= WIDE_WINDOW {
        (110.0, 380.0)
    } else {
        (92.0, 300.0)
    };
    // The side panel and the filmstrip have edges that can be dragged. Each may grow until the
    // picture has its minimum size; in a window that is smaller still, the panels keep theirs.
    let room = ui.available_size() - Vec2::from(FIXED) - Vec2::from(LEAST_PICTURE);
    let queue_width = queue::width(panel.app, room.x - LEAST_SIDE);
    let room = room - vec2(queue_width, 0.0);
    let edges = [
        Edge {
            id: "side panel",
            name: "Width of the side panel",
            panel_is_right: true,
            range: [LEAST_SIDE, room.x.min(640.0)],
        },
        Edge {
            id: "filmstrip",
            name: "Height of the filmstrip",
            panel_is_right: false,
            range: [72.0, room.y.min(260.0)],
        },
    ];
    let settings = &panel.app.settings;
    let remembered = [settings.side_width, settings.filmstrip_height];
    let side_width = edges[0].size(ui.ctx(), remembered[0], side_width);
    let filmstrip_height = edges[1].size(ui.ctx(), remembered[1], filmstrip_height);
    let row = Frame::new()
        .fill(ui.palette().panel)
        .inner_margin(Margin::symmetric(8, 0));
    let side = Frame::new().fill(ui.palette().panel);
    // egui lays panels out from the window's border inwards, in the order of these calls; the rest
    // is for the central panel.
    egui::Panel::top("menu")
        .exact_size(ROW)
        .resizable(false)
        .frame(row)
        .show(ui, |ui| menu::show(panel, ui));
    tour::show(panel, ui);
    egui::Panel::bottom("status")
        .exact_size(ROW)
        .resizable(false)
        .frame(row)
        .show(ui, |ui| status::show(panel, ui));
    egui::Panel::bottom("messages")
        .exact_size(ROW)
        .resizable(false)
        .frame(row)
        .show(ui, |ui| notices::show(panel, ui));
    let is_open = panel.app.open().is_some();
    let page = panel.app.session.quality.open;
    if is_open {
        egui::Panel::left("tools")
            .exact_size(tools::WIDTH)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| tools::show(panel, ui));
    }
    if is_open && !page && queue_width > 0.0 {
        egui::Panel::left("queue")
            .exact_size(queue_width)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| queue::show(panel, ui));
    }
    if is_open && !page {
        let side_panel = egui::Panel::right("side")
            .exact_size(side_width)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| {
                if panel.app.round().is_some() {
                    reclick::show(panel, ui);
                    return;
                }
                cards::show(panel, ui);
                match panel.app.session.panel {
                    SidePanel::Frame => inspector::show(panel, ui),
                    SidePanel::Camera => camera_panel::show(panel, ui),
                    SidePanel::Trainer => trainer::show(panel, ui),
                    SidePanel::Review => review::show(panel, ui),
                }
            });
        let strip = egui::Panel::bottom("filmstrip")
            .exact_size(filmstrip_height)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| filmstrip::show(panel, ui));
        // The edges are read after the contents of the panels, so that a press on an edge is not
        // one on a widget below it.
        let areas = [side_panel.response.rect, strip.response.rect];
        store_panel_sizes(
            panel,
            [edges[0].read(ui, areas[0]), edges[1].read(ui, areas[1])],
            remembered,
        );
        // In a low window the picture keeps its room.
        let has_room = ui.available_height() >= LEAST_PICTURE[1] + quality::CURVES;
        if panel.app.settings.curves && has_room && panel.app.round().is_none() {
            egui::Panel::bottom("curves")
                .exact_size(quality::CURVES)
                .resizable(false)
                .frame(row)
                .show(ui, |ui| quality::curves(panel, ui));
        }
        if timeline::is_wanted(panel.app) {
            egui::Panel::bottom("timeline")
                .exact_size(timeline::HEIGHT)
                .resizable(false)
                .frame(row)
                .show(ui, |ui| timeline::show(panel, ui));
        }
    }
    // The picture is laid out last, so that it takes what all the panels leave. Dialogs lie above
    // everything.
    egui::CentralPanel::no_frame().show(ui, |ui| {
        if page {
            quality::show(panel, ui);
        } else if is_open {
            viewport::show(panel, ui);
        } else {
            start::show(panel, ui);
        }
    });
    dialogs::show(panel, ui);
}

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
