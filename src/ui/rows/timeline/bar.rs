//! All frames of the document on one line: a click or a drag goes there, with Shift it selects the
//! frames up to there, and the handle of a cut moves it.

use super::super::menu;
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{
    Color32, Context, CursorIcon, Id, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke,
    Ui, WidgetInfo, pos2, vec2,
};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_application::app::place::time_code;
use touchline_application::app::review::percent;
use touchline_application::app::selection::{Selecting, runs_of};
use touchline_application::app::session::status_label;
use touchline_application::app::{
    Action, App, Command, EditAction, Navigation, OpenProject, ViewAction,
};
use touchline_application::scene::timeline::{Timeline, TimelineCut, TimelineSource};
use touchline_documents::document::{FrameStatus, ShotKind};

/// Distance within which the pointer grabs the handle of a cut, points.
const HOLD: f32 = 5.0;
/// Height of the row with the handles of the cuts, points.
const HANDLES: f32 = 7.0;
/// Height of the row that shows which frames are decoded, points.
const DECODED: f32 = 2.0;
/// The thickness of the edges around selected frames, points.
const SELECTED_EDGE: f32 = 2.0;
/// Height of the strip that shows what the paint says about suggestions, points.
const PAINT: f32 = 4.0;
/// Height of the band of doubt at its greatest, points.
const DOUBT: f32 = 8.0;

/// The last summary, with the inputs that it was computed from.
#[derive(Clone)]
struct CachedTimeline {
    /// Document, video and number of parts.
    of: (PathBuf, String, usize),
    /// Version of the document.
    version: u64,
    source: TimelineSource,
    timeline: Arc<Timeline>,
}

/// Shows the bar.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(open) = panel.app.open() else { return };
    let size = vec2(ui.available_width(), ui.available_height() - 6.0);
    let (area, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Timeline"));
    let timeline = cached_timeline(ui.ctx(), panel.app, open, area.width() as usize);
    let bar = Bar {
        area,
        timeline: &timeline,
    };
    let held = hold(panel, ui, &response, &bar);
    bar.paint(panel, ui, held);
    cut_menu(panel, &response);
    tooltip(panel.app, open, response, &bar);
}

/// The summary of the open document. If only a few frames have changed, only their parts are
/// computed again.
fn cached_timeline(ctx: &Context, app: &App, open: &OpenProject, parts: usize) -> Arc<Timeline> {
    let video = app
        .frame()
        .and_then(|frame| frame.video.as_ref())
        .map(|video| video.path.clone())
        .unwrap_or_default();
    // The version changes with every edit. The frames that differ are then found by comparing the
    // two states of the document, which share what is equal.
    let (of, version) = ((open.file.clone(), video, parts), open.document.version());
    let memory = Id::unique("timeline");
    let known = ctx
        .data(|data| data.get_temp::<CachedTimeline>(memory))
        .filter(|known| known.of == of);
    if let Some(known) = known.as_ref().filter(|known| known.version == version) {
        return Arc::clone(&known.timeline);
    }
    // Only what has changed is computed again, if the same video is shown in as many parts.
    let followed =
        known.and_then(|known| known.timeline.follow_changes(&open.document, &known.source));
    let timeline =
        Arc::new(followed.unwrap_or_else(|| Timeline::from_document(&open.document, &of.1, parts)));
    let source = TimelineSource::from_document(&open.document);
    ctx.data_mut(|data| {
        data.insert_temp(
            memory,
            CachedTimeline {
                of,
                version,
                source,
                timeline: Arc::clone(&timeline),
            },
        )
    });
    timeline
}

/// A cut that the pointer drags, and the frame below the pointer.
#[derive(Clone, Copy)]
struct DraggedCut {
    cut: TimelineCut,
    over: usize,
}

/// Reads the pointer. A dragged cut is moved when the button goes up; a press anywhere else shows
/// the frame at once.
fn hold(panel: &mut Panel<'_>, ui: &Ui, response: &Response, bar: &Bar<'_>) -> Option<DraggedCut> {
    let memory = Id::unique("held cut");
    let at = response
        .interact_pointer_pos()
        .or_else(|| response.hover_pos());
    let near = at.and_then(|at| bar.cut_near(at));
    if near.is_some() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    // The handle is looked up where the button went down: by now the pointer has moved on. A drag
    // that begins elsewhere forgets a handle that an earlier one left behind.
    if response.drag_started() {
        let origin = ui.input(|input| input.pointer.press_origin());
        let taken = origin.and_then(|origin| bar.cut_near(origin));
        ui.data_mut(|data| {
            data.remove::<TimelineCut>(memory);
            if let Some(cut) = taken {
                data.insert_temp(memory, cut);
            }
        });
    }
    // A drag may have ended behind another page; the handle that it left behind counts no more.
    let is_dragging = response.dragged() || response.drag_stopped();
    let cut = ui
        .data(|data| data.get_temp::<TimelineCut>(memory))
        .filter(|_| is_dragging);
    let over = at.map(|at| bar.frame_at(at))?;
    let Some(cut) = cut else {
        // A quick click goes down and up within one frame of the window, so it never appears as
        // down.
        let pressed = response.is_pointer_button_down_on() || response.clicked();
        if pressed && near.is_none() {
            go_or_select(panel, ui, over);
        } else {
            ui.data_mut(|data| data.remove::<StretchEnd>(stretch_memory()));
        }
        return None;
    };
    // The button goes up: the cut moves to the frame below the pointer.
    if response.drag_stopped() {
        ui.data_mut(|data| data.remove::<TimelineCut>(memory));
        // Cuts are stored by frame numbers of the video, not by positions in the document.
        let number = panel
            .app
            .open()
            .and_then(|open| Some(open.frame(over)?.video.as_ref()?.frame_index));
        if let Some(to) = number.filter(|_| over != cut.position) {
            panel.edit(EditAction::MoveCut {
                cut: cut.frame_index,
                to,
            });
        }
        return None;
    }
    ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    Some(DraggedCut { cut, over })
}

/// The frame up to which frames were selected last, while the button is down.
#[derive(Clone, Copy, PartialEq, Eq)]
struct StretchEnd(usize);

fn stretch_memory() -> Id {
    Id::unique("end of the selected stretch")
}

/// The pointer is down over a frame: shows it; with Shift selects the frames from the shown one to
/// it.
fn go_or_select(panel: &mut Panel<'_>, ui: &Ui, over: usize) {
    let end = ui.data(|data| data.get_temp::<StretchEnd>(stretch_memory()));
    // A drag that began with Shift stays one: the key may be let go before the button.
    if ui.input(|input| input.modifiers.shift) || end.is_some() {
        if end != Some(StretchEnd(over)) {
            ui.data_mut(|data| data.insert_temp(stretch_memory(), StretchEnd(over)));
            panel.actions.extend([
                Action::View(ViewAction::Pause),
                Action::Navigate(Navigation::SelectFrame {
                    frame: over,
                    how: Selecting::Range,
                }),
            ]);
        }
        return;
    }
    // An action only if it changes something: the button may stay down over one frame for long.
    let session = &panel.app.session;
    let (is_other, any_selected) = (over != session.frame, !session.frames_selected.is_empty());
    if any_selected {
        panel.view(ViewAction::SelectNoFrames);
    }
    if is_other {
        panel.actions.extend([
            Action::View(ViewAction::Pause),
            Action::Navigate(Navigation::GoTo(over)),
        ]);
    }
}

/// The commands on cuts and places.
fn cut_menu(panel: &mut Panel<'_>, response: &Response) {
    let commands = [
        Command::AddCut,
        Command::MoveCutHere,
        Command::RemoveCut,
        Command::FindShots,
        Command::GoToPlace,
    ];
    response.context_menu(|ui| menu::entries(panel, ui, &commands));
}

/// Describes the frame below the pointer, and the cut if it is on a handle.
fn tooltip(app: &App, open: &OpenProject, response: Response, bar: &Bar<'_>) {
    let Some(at) = response.hover_pos() else {
        return;
    };
    // At the pointer, because the bar is as wide as the window.
    let position = bar.frame_at(at);
    let Some(frame) = open.frame(position) else {
        return;
    };
    let cut = bar.cut_near(at);
    response.on_hover_ui_at_pointer(|ui| {
        let time = frame
            .video
            .as_ref()
            .and_then(|video| video.pts_s)
            .map(time_code)
            .unwrap_or_default();
        theme::strong(
            ui,
            format!("Frame {} · {time}", open.frame_number(position)),
        );
        let shot = frame
            .clip
            .as_ref()
            .map(|clip| format!(" · shot {clip}"))
            .unwrap_or_default();
        ui.label(format!("{}{shot}", status_label(frame.status)));
        let confidence = frame.confidence();
        if let Some(confidence) = confidence.filter(|_| frame.status == FrameStatus::Suggested) {
            ui.label(format!("Confidence {}", percent(confidence)));
        }
        if let Some(cut) = cut {
            theme::weak(ui, describe_cut(cut.kind));
        }
        if app.shots().is_none() && app.operations.shot_search.running().is_none() {
            theme::weak(ui, "Right-click: cuts");
        }
    });
}

/// What a kind of cut means for the user.
const fn describe_cut(kind: ShotKind) -> &'static str {
    match kind {
        ShotKind::Cut => "A cut. Drag its handle to move it.",
        ShotKind::Fade => "The end of a fade, dissolve or wipe. Drag its handle to move it.",
        ShotKind::Transition => {
            "The beginning of a fade, dissolve or wipe; its frames get no camera. Drag its handle to move it."
        }
        ShotKind::ByHand => "A cut that was marked by hand. Drag its handle to move it.",
    }
}

/// The bar in its place on the screen.
struct Bar<'a> {
    area: Rect,
    timeline: &'a Timeline,
}

impl Bar<'_> {
    /// The x of a share (0 to 1) of the timeline, points.
    fn x(&self, share: f64) -> f32 {
        self.area.left() + share as f32 * self.area.width()
    }

    /// The position in the document of the frame at a place on the screen.
    fn frame_at(&self, at: Pos2) -> usize {
        self.timeline.frame_at(f64::from(
            (at.x - self.area.left()) / self.area.width().max(1.0),
        ))
    }

    /// The cut with its handle at a place on the screen.
    fn cut_near(&self, at: Pos2) -> Option<TimelineCut> {
        // Only the row of handles: below it a press shows a frame. Handles may be nearer to each
        // other than the pointer's reach, so the nearest counts.
        if !self.area.contains(at) || at.y > self.area.top() + HANDLES {
            return None;
        }
        let distance =
            |cut: &TimelineCut| (self.x(self.timeline.beginning_of(cut.position)) - at.x).abs();
        let nearest = self
            .timeline
            .cuts
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|cut| distance(cut) <= HOLD).copied()
    }

    /// Draws, from back to front: shots, frames by status, decoded frames, cuts, the cut that is
    /// dragged, the shown frame.
    fn paint(&self, panel: &Panel<'_>, ui: &Ui, held: Option<DraggedCut>) {
        let painter = ui.painter_at(self.area.expand2(vec2(4.0, 0.0)));
        let line = Rect::from_min_max(self.area.min + vec2(0.0, HANDLES), self.area.max);
        painter.rect_filled(line, 2.0, ui.palette().raised);
        self.paint_shots(&painter, line);
        self.paint_frames(&painter, line);
        self.paint_selected(&painter, line, &panel.app.session.frames_selected);
        // A decoded frame is at least one point wide: in a long video it would vanish otherwise.
        for place in panel.pictures.decoded_frames() {
            let (left, right) = (
                self.x(self.timeline.beginning_of(place)),
                self.x(self.timeline.beginning_of(place + 1)),
            );
            let decoded = Rect::from_min_max(
                pos2(left, line.bottom() - DECODED),
                pos2(right.max(left + 1.0), line.bottom()),
            );
            painter.rect_filled(decoded, 0.0, ui.palette().accent);
        }
        // The dragged cut is drawn twice: weakly where it is stored, and in the accent colour where
        // it would go.
        for cut in &self.timeline.cuts {
            let is_held = held.is_some_and(|held| held.cut.position == cut.position);
            self.paint_cut(
                &painter,
                cut.position,
                cut.kind,
                if is_held {
                    ui.palette().line
                } else {
                    ui.palette().text
                },
            );
        }
        if let Some(held) = held {
            self.paint_cut(&painter, held.over, ShotKind::ByHand, ui.palette().accent);
        }
        let x = self.x(self.timeline.share_of(panel.app.session.frame));
        painter.vline(x, line.y_range(), Stroke::new(2.0, ui.palette().strong));
        let head = vec![
            pos2(x - 4.0, self.area.top() + 1.0),
            pos2(x + 4.0, self.area.top() + 1.0),
            pos2(x, line.top() + 1.0),
        ];
        painter.add(Shape::convex_polygon(
            head,
            ui.palette().strong,
            Stroke::NONE,
        ));
    }

    /// Draws every other shot on a lighter ground.
    fn paint_shots(&self, painter: &Painter, line: Rect) {
        let starts = self
            .timeline
            .cuts
            .iter()
            .map(|cut| self.x(self.timeline.beginning_of(cut.position)));
        // The pairs begin with the first cut, so the first shot keeps the plain ground. With an
        // even number of cuts the end of the line is left over, and the last shot is plain, too.
        let edges: Vec<f32> = starts.chain([line.right()]).collect();
        for pair in edges.chunks(2) {
            if let [from, to] = pair {
                painter.rect_filled(
                    Rect::from_x_y_ranges(*from..=*to, line.y_range()),
                    0.0,
                    painter.palette().line.gamma_multiply(0.6),
                );
            }
        }
    }

    /// Draws the status of the frames, the references last so that a single one is never hidden.
    /// The band of doubt at the bottom is higher where suggestions are less certain; the strip at
    /// the top says whether they lie on the paint.
    fn paint_frames(&self, painter: &Painter, line: Rect) {
        let colour = |status| painter.palette().status(status);
        let marks = |top: f32, bottom: f32| line.top() + top..=line.bottom() - bottom;
        for (at, part) in self.timeline.parts.iter().enumerate() {
            let [from, to] = self.timeline.span_of_part(at).map(|share| self.x(share));
            let fill = |rows: std::ops::RangeInclusive<f32>, colour: Color32| {
                painter.rect_filled(
                    Rect::from_x_y_ranges(from..=to.max(from + 1.0), rows),
                    0.0,
                    colour,
                );
            };
            // A part stands for many frames of a long video. Whatever needs attention in it is
            // drawn, in order of importance, with heights that leave all of it visible; rejected
            // frames only where nothing else is.
            if part.rejected == part.frames {
                fill(
                    marks(8.0, 8.0),
                    colour(FrameStatus::Rejected).gamma_multiply(0.7),
                );
            }
            if part.suggestions > 0 {
                fill(
                    marks(6.0, DOUBT + DECODED),
                    colour(FrameStatus::Suggested).gamma_multiply(0.8),
                );
            }
            if part.drafts > 0 {
                fill(marks(4.0, DOUBT + DECODED), colour(FrameStatus::Draft));
            }
            if part.doubt > 0.0 {
                let height = DOUBT * part.doubt as f32;
                fill(
                    line.bottom() - DECODED - height..=line.bottom() - DECODED,
                    painter.palette().bad.gamma_multiply(0.55),
                );
            }
            if let Some(verdict) = part.paint {
                let strip = line.top()..=line.top() + PAINT;
                fill(strip, theme::verdict_colour(painter.palette(), verdict));
            }
            if part.references > 0 {
                fill(marks(0.0, DECODED), colour(FrameStatus::Reference));
            }
        }
    }

    /// A band over each run of selected frames, with an edge above and below.
    fn paint_selected(&self, painter: &Painter, line: Rect, selected: &BTreeSet<usize>) {
        let accent = painter.palette().accent;
        for [first, last] in runs_of(selected.iter().copied()) {
            let left = self.x(self.timeline.beginning_of(first));
            let right = self.x(self.timeline.beginning_of(last + 1)).max(left + 1.0);
            let band = Rect::from_x_y_ranges(left..=right, line.y_range());
            painter.rect_filled(band, 0.0, accent.gamma_multiply(0.35));
            let edge = Stroke::new(SELECTED_EDGE, accent);
            painter.hline(band.x_range(), band.top() + 1.0, edge);
            painter.hline(band.x_range(), band.bottom() - 1.0, edge);
        }
    }

    /// Draws a cut with its handle. The ends of a fade are dashed.
    fn paint_cut(&self, painter: &Painter, position: usize, kind: ShotKind, colour: Color32) {
        let x = self.x(self.timeline.beginning_of(position));
        let (top, bottom) = (pos2(x, self.area.top() + 2.0), pos2(x, self.area.bottom()));
        let stroke = Stroke::new(1.0, colour);
        if matches!(kind, ShotKind::Fade | ShotKind::Transition) {
            painter.extend(Shape::dashed_line(&[top, bottom], stroke, 3.0, 3.0));
        } else {
            painter.line_segment([top, bottom], stroke);
        }
        painter.rect_filled(
            Rect::from_center_size(pos2(x, self.area.top() + 3.5), vec2(5.0, 5.0)),
            1.0,
            colour,
        );
    }
}
