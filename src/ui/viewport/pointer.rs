//! From the pointer to actions: placing and dragging points, zooming, panning, drawing masks.
//!
//! Events are read one by one, so that a press and its release within one frame of the window are both seen.

use super::placement::Placement;
use crate::app::Action;
use crate::app::session::{Mode, PictureView};
use crate::geometry::{ImagePoint, PixelBox};
use egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Vec2};

/// A click this near to the pointer is taken hold of, points.
pub const REACH_PT: f32 = 8.0;
/// A hand that moves less than this while pressing did not mean to drag, points.
const SLACK_PT: f32 = 2.0;
/// What Shift makes of the pointer's speed.
const FINE: f64 = 0.1;
/// One notch of the wheel.
const ZOOM_PER_LINE: f64 = 1.25;
/// Zooming by fingers or Ctrl: a factor of e per so many points.
const ZOOM_POINTS: f64 = 200.0;
/// Lines and pages of a wheel as points.
const POINTS_PER_LINE: f32 = 40.0;

/// What the pointer holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// Nothing.
    #[default]
    Nothing,
    /// A click of the frame.
    Click {
        /// Where the click is; it keeps its distance from the pointer.
        at: ImagePoint,
        /// Where the pointer went down, and whether it has left that place.
        pressed: Pos2,
        /// The pointer has moved enough to mean it.
        moving: bool,
    },
    /// The picture.
    Picture(PointerButton),
    /// A corner of a mask that is being drawn.
    Mask {
        /// The corner where it began.
        from: ImagePoint,
        /// The corner under the pointer.
        to: ImagePoint,
        /// For every frame of the camera.
        of_camera: bool,
    },
}

impl Hold {
    /// The mask that is being drawn.
    pub fn mask(&self) -> Option<(bool, PixelBox)> {
        let Self::Mask { from, to, of_camera } = self else { return None };
        let (x, y) = (from.x.min(to.x), from.y.min(to.y));
        Some((*of_camera, PixelBox { x, y, width: (from.x - to.x).abs(), height: (from.y - to.y).abs() }))
    }
}

/// What the pointer needs to know of the rest.
pub struct Surroundings<'a> {
    /// Where the picture lies.
    pub placement: Placement,
    /// Where the frame's clicks are.
    pub clicks: &'a [ImagePoint],
    /// What has been begun.
    pub mode: &'a Mode,
    /// Where the application has the pointer, px of the picture.
    pub hover: Option<ImagePoint>,
    /// The picture is there: points can be placed on it.
    pub ready: bool,
    /// Masks are drawn instead of points.
    pub masks: bool,
    /// The space bar is down: dragging moves the picture.
    pub space: bool,
    /// Whether a place of the screen belongs to the picture, and nothing lies over it.
    pub is_free: &'a dyn Fn(Pos2) -> bool,
}

/// The pointer over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointer {
    /// What it holds.
    pub hold: Hold,
    at: Option<Pos2>,
}

impl Pointer {
    /// Reads the events of one frame of the window.
    pub fn read(&mut self, events: &[Event], modifiers: Modifiers, around: &Surroundings<'_>) -> Vec<Action> {
        let mut reading = Reading { pointer: self, around, placement: around.placement, actions: Vec::new() };
        if matches!(reading.pointer.hold, Hold::Click { .. }) && !matches!(around.mode, Mode::Dragging { .. }) {
            reading.pointer.hold = Hold::Nothing;
        }
        for event in events {
            reading.event(event, modifiers);
        }
        reading.hover();
        reading.actions
    }
}

/// The nearest of the clicks within reach of a place of the screen.
pub fn click_at(placement: &Placement, clicks: &[ImagePoint], at: Pos2) -> Option<usize> {
    clicks
        .iter()
        .map(|click| placement.screen_from_image(*click).distance(at))
        .enumerate()
        .filter(|(_, distance)| *distance <= REACH_PT)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index)
}

struct Reading<'a> {
    pointer: &'a mut Pointer,
    around: &'a Surroundings<'a>,
    /// As it becomes while events are read.
    placement: Placement,
    actions: Vec<Action>,
}

impl Reading<'_> {
    fn event(&mut self, event: &Event, modifiers: Modifiers) {
        match event {
            Event::PointerMoved(to) => self.moved(*to, modifiers),
            Event::PointerButton { pos, button, pressed, modifiers } => {
                self.moved(*pos, *modifiers);
                if *pressed {
                    self.pressed(*pos, *button, *modifiers);
                } else {
                    self.released(*button);
                }
            }
            Event::PointerGone => self.pointer.at = None,
            // Nobody says that the button went up over another window.
            Event::WindowFocused(false) => self.let_go(),
            Event::MouseWheel { unit, delta, source, modifiers, .. } => self.wheel(*unit, *delta, *source, *modifiers),
            Event::Zoom(factor) => self.zoom(f64::from(*factor)),
            _ => {}
        }
    }

    fn pressed(&mut self, at: Pos2, button: PointerButton, modifiers: Modifiers) {
        if self.pointer.hold != Hold::Nothing || !(self.around.is_free)(at) {
            return;
        }
        match button {
            PointerButton::Middle => self.pointer.hold = Hold::Picture(button),
            PointerButton::Primary if self.around.space => self.pointer.hold = Hold::Picture(button),
            PointerButton::Primary if self.around.ready => {
                let in_image = self.placement.image_from_screen(at);
                if self.around.masks {
                    let corner = self.within_picture(in_image);
                    self.pointer.hold = Hold::Mask { from: corner, to: corner, of_camera: modifiers.shift };
                    return;
                }
                // With a name in hand the next click places it, however near another point lies.
                let on = match self.around.mode {
                    Mode::Placing(_) => None,
                    _ => click_at(&self.placement, self.around.clicks, at),
                };
                let held = on.and_then(|on| self.around.clicks.get(on)).copied().unwrap_or(in_image);
                self.pointer.hold = Hold::Click { at: held, pressed: at, moving: false };
                self.actions.push(Action::Press { at: in_image, on });
            }
            _ => {}
        }
    }

    fn moved(&mut self, to: Pos2, modifiers: Modifiers) {
        let from = self.pointer.at.replace(to).unwrap_or(to);
        match self.pointer.hold {
            Hold::Nothing => {}
            Hold::Click { at, pressed, moving } => {
                let began = !moving && to.distance(pressed) > SLACK_PT;
                if !moving && !began {
                    return;
                }
                let along = self.placement.image_from_screen_vector(to - if began { pressed } else { from });
                let at = at.moved(along * if modifiers.shift { FINE } else { 1.0 });
                self.pointer.hold = Hold::Click { at, pressed, moving: true };
                // Only the last place of a frame counts.
                if let Some(Action::Drag(_)) = self.actions.last() {
                    self.actions.pop();
                }
                self.actions.push(Action::Drag(at));
            }
            Hold::Picture(_) => self.show(self.placement.panned(to - from)),
            Hold::Mask { from, of_camera, .. } => {
                let to = self.within_picture(self.placement.image_from_screen(to));
                self.pointer.hold = Hold::Mask { from, to, of_camera };
            }
        }
    }

    fn released(&mut self, button: PointerButton) {
        let ends = match self.pointer.hold {
            Hold::Nothing => false,
            Hold::Picture(held) => held == button,
            Hold::Click { .. } | Hold::Mask { .. } => button == PointerButton::Primary,
        };
        if ends {
            self.let_go();
        }
    }

    fn let_go(&mut self) {
        let held = std::mem::take(&mut self.pointer.hold);
        if let Hold::Click { .. } = held {
            self.actions.push(Action::Release);
        }
        if let Some((of_camera, mask)) = held.mask() {
            self.actions.push(Action::AddMask { of_camera, mask });
        }
    }

    /// A wheel zooms, fingers on a pad move the picture; with Ctrl both zoom.
    fn wheel(&mut self, unit: MouseWheelUnit, delta: Vec2, source: MouseWheelSource, modifiers: Modifiers) {
        let is_wheel = match source {
            MouseWheelSource::Wheel => true,
            MouseWheelSource::Trackpad | MouseWheelSource::Momentum => false,
            MouseWheelSource::Unknown => unit != MouseWheelUnit::Point,
        };
        let points = match unit {
            MouseWheelUnit::Point => delta,
            MouseWheelUnit::Line => delta * POINTS_PER_LINE,
            MouseWheelUnit::Page => Vec2::new(delta.x, delta.y.signum() * POINTS_PER_LINE),
        };
        if !self.pointer.at.is_some_and(self.around.is_free) {
            return;
        }
        if modifiers.command || modifiers.ctrl || (is_wheel && !modifiers.shift && points.y != 0.0) {
            let factor = if is_wheel {
                ZOOM_PER_LINE.powf(f64::from(points.y / POINTS_PER_LINE))
            } else {
                (f64::from(points.y) / ZOOM_POINTS).exp()
            };
            self.zoom(factor);
        } else {
            let along = if modifiers.shift && points.x == 0.0 { Vec2::new(points.y, 0.0) } else { points };
            self.show(self.placement.panned(along));
        }
    }

    fn zoom(&mut self, factor: f64) {
        if let Some(at) = self.pointer.at.filter(|at| (self.around.is_free)(*at))
            && factor.is_finite()
            && factor > 0.0
        {
            self.show(self.placement.zoomed(factor, at));
        }
    }

    fn show(&mut self, view: PictureView) {
        self.placement = self.placement.showing(view);
        self.actions.push(Action::View(view));
    }

    fn hover(&mut self) {
        let free = |at: &Pos2| self.pointer.hold != Hold::Nothing || (self.around.is_free)(*at);
        let hovered = self
            .pointer
            .at
            .filter(free)
            .map(|at| self.placement.image_from_screen(at))
            .filter(|at| self.placement.image_size.contains(*at));
        if hovered != self.around.hover {
            self.actions.push(Action::Hover(hovered));
        }
    }

    fn within_picture(&self, at: ImagePoint) -> ImagePoint {
        let size = self.placement.image_size;
        ImagePoint::new(at.x.clamp(0.0, f64::from(size.width)), at.y.clamp(0.0, f64::from(size.height)))
    }
}
