//! The filmstrip: frames by shot with thumbnail, status and warnings. Only frames in view become
//! widgets, so that the strip of a long video costs no more than that of a short one.

mod fold;
mod item;
mod strip;

use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{ComboBox, Id, Layout, Rect, RichText, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};
use strip::{Strip, StripCell};
use touchline_application::app::ViewAction;
use touchline_application::app::session::Filter;
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::FrameStatus;

/// Width of the column with the filter, points.
const COLUMN: f32 = 116.0;
/// Height of the list of filters, points: all of them.
const LIST: f32 = 320.0;
/// Width of a thumbnail divided by its height.
const ASPECT: f32 = 16.0 / 9.0;

/// Shows the filter at the left, and the frames.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let area = ui.max_rect();
    let column = Rect::from_min_size(area.min, vec2(COLUMN, area.height())).shrink2(vec2(8.0, 6.0));
    ui.scope_builder(
        UiBuilder::new()
            .max_rect(column)
            .layout(Layout::top_down(egui::Align::Min)),
        |ui| {
            filter(panel, ui);
        },
    );
    let frames = Rect::from_min_max(pos2(area.left() + COLUMN, area.top()), area.max);
    ui.scope_builder(UiBuilder::new().max_rect(frames), |ui| {
        strip_of_frames(panel, ui);
    });
}

/// Shows the filter with the number of frames of each kind, and how many are done.
fn filter(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(open) = panel
        .app
        .open()
        .filter(|open| !open.document.frames.is_empty())
    else {
        return;
    };
    let counts = open.counts();
    let chosen = panel.app.session.filter;
    let shown = ComboBox::from_id_salt("filter")
        .width(ui.available_width())
        .height(LIST)
        .selected_text(RichText::new(chosen.label()).color(ui.palette().strong))
        .show_ui(ui, |ui| {
            for filter in Filter::ALL {
                let row = egui::Button::selectable(filter == chosen, filter.label()).right_text(
                    RichText::new(counts.count_matching(filter).to_string())
                        .color(ui.palette().weak),
                );
                if ui.add(row).clicked() {
                    panel.view(ViewAction::SetFilter(filter));
                    ui.close();
                }
            }
        });
    shown
        .response
        .accessible_name("Frames shown")
        .on_hover_text(
            "Which frames the filmstrip shows. The letters below them: N new, D draft with points, \
             S suggested, R accepted as a reference, X not calibratable.",
        );
    // How far the work is.
    let references = counts.count_with_status(FrameStatus::Reference);
    ui.label(RichText::new(pluralise(references, "reference")).small())
        .on_hover_text("Frames that you have accepted.");
    let reasons = counts.describe_to_do();
    let needed = match counts.to_do {
        0 => "all done".to_owned(),
        needed => format!("{} to do", thousands(needed)),
    };
    let tip = "Frames that are neither accepted nor marked as not calibratable";
    theme::small_weak(ui, needed).on_hover_text(
        reasons.map_or_else(|| format!("{tip}."), |reasons| format!("{tip}: {reasons}.")),
    );
}

/// Shows the frames in view, and remembers where they are.
fn strip_of_frames(panel: &mut Panel<'_>, ui: &mut Ui) {
    let app = panel.app;
    let Some(open) = app.open() else { return };
    let height = ui.available_height();
    // The height of the panel gives the size of a cell: a thumbnail with status bar and caption
    // below it.
    // 26 points are the margin of 8, the status bar and the caption.
    let item = vec2(((height - 26.0) * ASPECT).round(), height - 8.0);
    let strip = Strip::get_or_lay_out(ui, open, app.session.filter, app.session.frame, item.x);
    if strip.cells.is_empty() {
        ui.centered_and_justified(|ui| {
            let none = format!("No frame is “{}”.", app.session.filter.label());
            theme::weak(ui, none);
        });
        return;
    }
    // Where to scroll, from what the strip showed before.
    let memory = Id::unique(("filmstrip shows", &open.file));
    let before = ui.data(|data| data.get_temp::<PreviousStripView>(memory));
    let mut area = ScrollArea::horizontal().auto_shrink(false);
    if let Some(offset) = offset(
        app.session.frame,
        app.session.filter,
        &strip,
        before,
        ui.available_width(),
    ) {
        area = area.horizontal_scroll_offset(offset);
    }
    // The cells in view. The whole strip is allocated first, because the scroll bar needs its
    // width; only the cells within the viewport are drawn and can be clicked.
    let scrolled = area.show_viewport(ui, |ui, viewport| {
        let origin = ui.max_rect().min;
        let (whole, _) = ui.allocate_exact_size(vec2(strip.width(), height - 2.0), Sense::hover());
        ui.set_clip_rect(ui.clip_rect().intersect(whole));
        let place = |at: usize| Rect::from_min_size(origin + vec2(strip.left_end(at), 4.0), item);
        for at in strip.within(viewport.left(), viewport.right()) {
            if let Some(shot) = strip.shot_beginning_at(at) {
                item::separator(ui, place(at), shot);
            }
            match strip.cells[at] {
                StripCell::Frame(frame) => item::show(panel, ui, frame, place(at)),
                StripCell::Unanswered {
                    first,
                    last,
                    middle,
                    count,
                } => fold::show(panel, ui, (first, last), middle, count, place(at)),
            }
        }
    });
    // Remembered for the next frame of the window.
    let offset = scrolled.state.clamped_offset().x;
    let anchor = strip.first_from(offset);
    let shown = PreviousStripView {
        frame: app.session.frame,
        filter: app.session.filter,
        offset,
        anchor: strip
            .cells
            .get(anchor)
            .map(|cell| (cell.first(), strip.left_end(anchor))),
    };
    ui.data_mut(|data| data.insert_temp(memory, shown));
}

/// What the strip showed in the previous frame of the window.
#[derive(Clone, Copy, Debug)]
struct PreviousStripView {
    frame: usize,
    filter: Filter,
    /// How far it was scrolled, points.
    offset: f32,
    /// The first frame of the first cell that began in view, and the left end of that cell in the
    /// strip, points.
    anchor: Option<(usize, f32)>,
}

/// Where to scroll to, points; `None` if the strip stays.
///
/// If the shown frame or the filter has changed, the frame is scrolled into view. If cells fold or
/// unfold before the visible ones, the visible ones keep their places on the screen.
fn offset(
    frame: usize,
    filter: Filter,
    strip: &Strip,
    before: Option<PreviousStripView>,
    width: f32,
) -> Option<f32> {
    // With another filter the strip is a new one.
    let before = before.filter(|before| before.filter == filter);
    // The offset at which the anchor keeps its place on the screen.
    let kept = before.and_then(|before| {
        let (anchor, left) = before.anchor?;
        Some(before.offset + strip.left_end(strip.place_of(anchor)?) - left)
    });
    if before.is_some_and(|before| before.frame == frame) {
        return kept.filter(|kept| before.is_some_and(|before| before.offset != *kept));
    }
    let offset = kept.or(before.map(|before| before.offset)).unwrap_or(0.0);
    Some(strip.offset_showing(strip.place_of(frame)?, offset, width))
}
