//! From pointer events to actions: place and drag clicks, zoom, pan, draw masks.
//!
//! Events are read one by one, so that a press and its release within one frame of the window are
//! both seen. What the pointer holds is state of the window ([`DragTarget`]); the clicks themselves
//! belong to the application and change only by [`PointerAction`]s.

mod reading;
#[cfg(test)]
mod tests;

use crate::ui::drawing::placement::Placement;
use egui::{Event, Modifiers, PointerButton, Pos2};
use reading::Reading;
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, Tool};
use touchline_application::scene::drawn_element::{DrawnElement, ElementReach};
use touchline_core::geometry::{ImagePoint, PixelBox};

/// Distance within which a press grabs a click, points.
pub const REACH_PT: f32 = 8.0;

/// The distance within which a press grabs a drawn line, points: a short one, because lines are
/// long and points are placed beside them.
const LINE_REACH_PT: f32 = 4.0;

/// A press that moves less than this is a click and no drag, points. Otherwise the tremor of a hand
/// would move points.
const SLACK_PT: f32 = 2.0;

/// Factor on the pointer's movement while Shift is down.
const FINE: f64 = 0.1;

/// The state on which the meaning of an event depends.
pub struct Surroundings<'a> {
    /// Where the picture is on the screen.
    pub placement: Placement,
    /// The frame's clicks, px of the picture; none in a blind round.
    pub clicks: &'a [ImagePoint],
    /// The mode of the application.
    pub mode: &'a Mode,
    /// The pointer's position as the application knows it, px of the picture.
    pub hover: Option<ImagePoint>,
    /// Whether there is a picture on which points can be placed.
    pub ready: bool,
    /// What a press does.
    pub tool: Tool,
    /// Whether the space bar is down: then dragging moves the picture.
    pub space: bool,
    /// Whether a screen position is over the picture and not covered.
    pub is_free: &'a dyn Fn(Pos2) -> bool,
    /// The landmark or line that is drawn at a point of the picture and can be dragged.
    pub drawn_at: &'a dyn Fn(ImagePoint) -> Option<DrawnElement>,
}

/// How near a drawn landmark or line has to be to the pointer.
pub fn element_reach(placement: &Placement) -> ElementReach {
    let in_picture = |points: f32| {
        placement
            .image_from_screen_vector(egui::vec2(points, 0.0))
            .norm()
    };
    ElementReach {
        landmark_px: in_picture(REACH_PT),
        line_px: in_picture(LINE_REACH_PT),
    }
}

/// The pointer over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointer {
    /// What it holds.
    pub hold: DragTarget,
    /// Its last position on the screen, also outside the picture.
    at: Option<Pos2>,
}

impl Pointer {
    /// The actions of the events of one frame of the window, in their order.
    pub fn read(
        &mut self,
        events: &[Event],
        modifiers: Modifiers,
        around: &Surroundings<'_>,
    ) -> Vec<Action> {
        let mut reading = Reading {
            pointer: self,
            around,
            placement: around.placement,
            actions: Vec::new(),
        };
        // The application may have ended the drag (Escape, another frame). Then the pointer lets
        // go, too, or the next movement would drag a click that is no longer there, and the release
        // would add a mask that was cancelled.
        let is_held = match around.mode {
            Mode::Dragging { .. } => true,
            Mode::ClickingAgain(round) => round.held.is_some(),
            _ => false,
        };
        let goes_on = match reading.pointer.hold {
            DragTarget::Click { .. } => is_held,
            DragTarget::Mask { .. } => around.tool == Tool::Mask,
            DragTarget::Nothing | DragTarget::Picture(_) => true,
        };
        if !goes_on {
            reading.pointer.hold = DragTarget::Nothing;
        }
        for event in events {
            reading.event(event, modifiers);
        }
        reading.hover();
        reading.actions
    }
}

/// Index of the click that a press at a screen position grabs. Once a name is chosen, a press
/// places it, even near another point, and grabs none.
pub fn click_to_grab(
    mode: &Mode,
    placement: &Placement,
    clicks: &[ImagePoint],
    at: Pos2,
) -> Option<usize> {
    match mode {
        Mode::Placing(_) => None,
        _ => click_at(placement, clicks, at),
    }
}

/// Index of the nearest click within [`REACH_PT`] of a screen position.
fn click_at(placement: &Placement, clicks: &[ImagePoint], at: Pos2) -> Option<usize> {
    clicks
        .iter()
        .map(|click| placement.screen_from_image(*click).distance(at))
        .enumerate()
        .filter(|(_, distance)| *distance <= REACH_PT)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index)
}

/// What the pointer holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DragTarget {
    #[default]
    Nothing,
    /// A click of the frame, existing or new.
    Click {
        /// Where the click is, px of the picture. It keeps its offset from the pointer.
        at: ImagePoint,
        /// Where the pointer went down.
        pressed: Pos2,
        /// Whether the pointer has moved far enough for a drag.
        moving: bool,
    },
    Picture(PointerButton),
    /// A mask that is being drawn.
    Mask {
        /// The corner where it began, px of the picture.
        from: ImagePoint,
        /// The corner under the pointer, px of the picture.
        to: ImagePoint,
        /// Whether the mask is for every frame of the camera.
        of_camera: bool,
    },
}

impl DragTarget {
    /// The mask that is being drawn, and whether it is for every frame of the camera.
    pub fn mask(&self) -> Option<(bool, PixelBox)> {
        let Self::Mask {
            from,
            to,
            of_camera,
        } = self
        else {
            return None;
        };
        // The corners may have been drawn in any direction; a box has its upper left corner and
        // positive sides.
        let (x, y) = (from.x.min(to.x), from.y.min(to.y));
        Some((
            *of_camera,
            PixelBox {
                x,
                y,
                width: (from.x - to.x).abs(),
                height: (from.y - to.y).abs(),
            },
        ))
    }
}
