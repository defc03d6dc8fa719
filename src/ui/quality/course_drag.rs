//! The shown frame's point of a curve, dragged up or down to correct its pan, tilt or focal length.
//!
//! Only the shown frame's points can be dragged, so that moving the time axis changes no camera by
//! accident. A drag is one step of undo, as in the number fields.

use super::course_plots::CoursePlots;
use crate::ui::Panel;
use crate::ui::inspector::{TILT_DEG, focal_range_px};
use egui::{CursorIcon, Pos2, Ui};
use touchline_application::app::quality::{Course, CoursePoint, Quantity};
use touchline_application::app::session::Mode;
use touchline_application::app::{App, EditAction};
use touchline_core::camera::Ptz;
use touchline_core::geometry::Angle;

/// Distance from a point within which a press takes hold of it, points of the screen.
const REACH: f32 = 10.0;
/// How much slower a drag with Shift is.
const FINE: f64 = 0.1;

/// What is dragged. The scale is that at the press: it must not run away with the point that
/// stretches it.
#[derive(Clone, Copy)]
struct Grabbed {
    quantity: Quantity,
    /// Units of the quantity for one point of the screen.
    per_point: f64,
}

impl CoursePlots {
    /// Reads a drag of one of the shown frame's points. Returns whether the pointer is on one or
    /// drags one, so that it means nothing else.
    pub(super) fn drag_point(&self, panel: &mut Panel<'_>, ui: &Ui, course: &Course) -> bool {
        let memory = self.response.id.with("grabbed");
        let mut grabbed = ui.data(|data| data.get_temp::<Grabbed>(memory));
        let under = self
            .response
            .hover_pos()
            .and_then(|at| self.handle_at(panel.app, course, at));
        let begins = self.response.drag_started();
        if begins {
            let pressed = ui.input(|input| input.pointer.press_origin());
            grabbed = pressed.and_then(|at| self.handle_at(panel.app, course, at));
            match grabbed {
                Some(grabbed) => {
                    ui.data_mut(|data| data.insert_temp(memory, grabbed));
                    panel.edit(EditAction::Begin(grabbed.quantity.edit_step()));
                }
                None => ui.data_mut(|data| data.remove::<Grabbed>(memory)),
            }
        }
        if let Some(grabbed) = grabbed {
            // Escape has aborted the step although the button is still down.
            let abandoned = !begins && panel.app.session.mode != Mode::Editing;
            let speed = ui.input(|input| if input.modifiers.shift { FINE } else { 1.0 });
            let by = -f64::from(self.response.drag_delta().y) * grabbed.per_point * speed;
            if !abandoned
                && by != 0.0
                && let Some(ptz) = shift_camera(panel.app, grabbed.quantity, by)
            {
                panel.edit(EditAction::Ptz(ptz));
            }
            if self.response.drag_stopped() || !self.response.dragged() {
                ui.data_mut(|data| data.remove::<Grabbed>(memory));
                if !abandoned {
                    panel.edit(EditAction::End);
                }
            }
        }
        let taken = grabbed.is_some() || under.is_some() && !self.response.dragged();
        if taken {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeVertical);
        }
        taken
    }

    /// The shown frame's points, where its camera can be changed.
    pub(super) fn handles<'a>(&self, app: &App, course: &'a Course) -> Option<&'a CoursePoint> {
        let editable = app.current().base.is_some() && !app.shown_values().is_estimated;
        let mut points = course.within(self.span).iter();
        points.find(|point| editable && point.frame == app.session.frame)
    }

    /// The shown frame's point at a place of the screen.
    fn handle_at(&self, app: &App, course: &Course, at: Pos2) -> Option<Grabbed> {
        let point = self.handles(app, course)?;
        let mut plots = Quantity::ALL.into_iter().zip(&self.plots);
        plots.find_map(|(quantity, plot)| {
            let place = plot.at(point.at, point.value(quantity));
            let per_point = (plot.y[1] - plot.y[0]) / f64::from(plot.area.height().max(1.0));
            (place.distance(at) <= REACH).then_some(Grabbed {
                quantity,
                per_point,
            })
        })
    }
}

/// The shown frame's pan, tilt and focal length with one of them changed by degrees or px.
fn shift_camera(app: &App, quantity: Quantity, by: f64) -> Option<Ptz> {
    let frame = app.frame()?;
    let mut ptz = app.shown_values().camera?.ptz();
    match quantity {
        Quantity::Pan => ptz.pan = Angle::from_degrees(ptz.pan.degrees() + by).wrap(),
        Quantity::Tilt => {
            let tilt_deg = ptz.tilt.degrees() + by;
            ptz.tilt = Angle::from_degrees(tilt_deg.clamp(*TILT_DEG.start(), *TILT_DEG.end()));
        }
        Quantity::Focal => {
            let range = focal_range_px(f64::from(frame.image_size.width));
            ptz.focal_px = (ptz.focal_px + by).clamp(*range.start(), *range.end());
        }
    }
    Some(ptz)
}
