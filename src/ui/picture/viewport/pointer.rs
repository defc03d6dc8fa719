//! From pointer events to actions: place and drag clicks, zoom, pan, draw masks.
//!
//! Events are read one by one, so that a press and its release within one frame of the window are
//! both seen. What the pointer holds is state of the window ([`DragTarget`]); the clicks themselves
//! belong to the application and change only by [`PointerAction`]s.

use super::wheel::Gesture;
use crate::ui::drawing::placement::Placement;
use egui::{Event, Modifiers, PointerButton, Pos2};
use touchline_application::app::session::{Mode, PictureView};
use touchline_application::app::{Action, EditAction, PointerAction, Tool, ViewAction};
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

/// What the pointer holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DragTarget {
    /// Nothing.
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
    /// The picture, by this button.
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

/// The reading of one frame's events.
struct Reading<'a> {
    pointer: &'a mut Pointer,
    around: &'a Surroundings<'a>,
    /// Where the picture is. Zooming and panning change it between two events.
    placement: Placement,
    actions: Vec<Action>,
}

impl Reading<'_> {
    /// Reads one event.
    fn event(&mut self, event: &Event, modifiers: Modifiers) {
        match event {
            Event::PointerMoved(to) => self.handle_move(*to, modifiers),
            Event::PointerButton {
                pos,
                button,
                pressed,
                modifiers,
            } => {
                self.handle_move(*pos, *modifiers);
                if *pressed {
                    self.handle_press(*pos, *button, *modifiers);
                } else {
                    self.handle_release(*button, *modifiers);
                }
            }
            // A drag continues when the pointer comes back, so its position is kept.
            Event::PointerGone if self.pointer.hold == DragTarget::Nothing => {
                self.pointer.at = None;
            }
            // If the button goes up over another window, no event arrives. So the loss of the focus
            // ends a drag.
            Event::WindowFocused(false) => self.let_go(Modifiers::NONE),
            _ => {
                if let Some(gesture) = Gesture::from_event(event) {
                    self.gesture(gesture);
                }
            }
        }
    }

    /// Decides what a press grabs: the picture, a corner of a new mask, or a click.
    fn handle_press(&mut self, at: Pos2, button: PointerButton, modifiers: Modifiers) {
        if self.pointer.hold != DragTarget::Nothing || !(self.around.is_free)(at) {
            return;
        }
        match button {
            // The picture can be moved even while its pixels are still loading.
            PointerButton::Middle => self.pointer.hold = DragTarget::Picture(button),
            PointerButton::Primary if self.around.space => {
                self.pointer.hold = DragTarget::Picture(button);
            }
            PointerButton::Primary if self.around.ready => {
                let in_image = self.placement.image_from_screen(at);
                if self.around.tool == Tool::Mask {
                    let corner = self.within_picture(in_image);
                    self.pointer.hold = DragTarget::Mask {
                        from: corner,
                        to: corner,
                        of_camera: modifiers.shift,
                    };
                    return;
                }
                let (mode, clicks) = (self.around.mode, self.around.clicks);
                let on = click_to_grab(mode, &self.placement, clicks, at);
                let drawn = match on {
                    None => (self.around.drawn_at)(in_image),
                    Some(_) => None,
                };
                // The tool that places nothing grabs the picture. The application learns of the
                // press all the same: it ends the selection.
                let is_placing = matches!(mode, Mode::Placing(_));
                if self.around.tool == Tool::Select && on.is_none() && !is_placing {
                    self.pointer.hold = DragTarget::Picture(button);
                    self.actions
                        .push(Action::Pointer(PointerAction::Press { at: in_image, on }));
                    return;
                }
                // What is held keeps its distance from the pointer: a click, or what is drawn.
                let held = on
                    .and_then(|on| self.around.clicks.get(on))
                    .copied()
                    .or(drawn.as_ref().map(|drawn| drawn.image))
                    .unwrap_or(in_image);
                self.pointer.hold = DragTarget::Click {
                    at: held,
                    pressed: at,
                    moving: false,
                };
                self.actions.push(Action::Pointer(match drawn {
                    Some(drawn) => PointerAction::Grab {
                        at: in_image,
                        element: drawn.target,
                    },
                    None => PointerAction::Press { at: in_image, on },
                }));
            }
            _ => {}
        }
    }

    /// Moves what the pointer holds.
    fn handle_move(&mut self, to: Pos2, modifiers: Modifiers) {
        // Movements add up in px of the picture, so that a change from coarse to fine (Shift)
        // within a drag does not make the click jump.
        let from = self.pointer.at.replace(to).unwrap_or(to);
        match self.pointer.hold {
            DragTarget::Nothing => {}
            DragTarget::Click {
                at,
                pressed,
                moving,
            } => {
                // A drag begins when the pointer leaves the slack. Its first step is measured from
                // where the button went down, so that the click does not lag behind.
                let began = !moving && to.distance(pressed) > SLACK_PT;
                if !moving && !began {
                    return;
                }
                let along = self
                    .placement
                    .image_from_screen_vector(to - if began { pressed } else { from });
                let at = at.translate(along * if modifiers.shift { FINE } else { 1.0 });
                self.pointer.hold = DragTarget::Click {
                    at,
                    pressed,
                    moving: true,
                };
                // Only the last position of a frame of the window counts.
                if let Some(Action::Pointer(PointerAction::Drag(_))) = self.actions.last() {
                    self.actions.pop();
                }
                self.actions.push(Action::Pointer(PointerAction::Drag(at)));
            }
            DragTarget::Picture(_) => self.show(self.placement.pan_by(to - from)),
            DragTarget::Mask {
                from, of_camera, ..
            } => {
                let to = self.within_picture(self.placement.image_from_screen(to));
                self.pointer.hold = DragTarget::Mask {
                    from,
                    to,
                    of_camera,
                };
            }
        }
    }

    /// Lets go if this is the button that grabbed.
    fn handle_release(&mut self, button: PointerButton, modifiers: Modifiers) {
        let ends = match self.pointer.hold {
            DragTarget::Nothing => false,
            DragTarget::Picture(held) => held == button,
            DragTarget::Click { .. } | DragTarget::Mask { .. } => button == PointerButton::Primary,
        };
        if ends {
            self.let_go(modifiers);
        }
    }

    /// Lets go. Alt at that moment keeps the click where it is, without snapping.
    fn let_go(&mut self, modifiers: Modifiers) {
        let held = std::mem::take(&mut self.pointer.hold);
        if let DragTarget::Click { .. } = held {
            self.actions.push(Action::Pointer(if modifiers.alt {
                PointerAction::ReleaseExactly
            } else {
                PointerAction::Release
            }));
        }
        // A box without an extent, from a mere click, is for the application to refuse.
        if let Some((of_camera, mask)) = held.mask() {
            self.actions
                .push(Action::Edit(EditAction::AddMask { of_camera, mask }));
        }
    }

    /// Zooms around the pointer, or pans.
    fn gesture(&mut self, gesture: Gesture) {
        let Some(at) = self.pointer.at.filter(|at| (self.around.is_free)(*at)) else {
            return;
        };
        self.show(match gesture {
            Gesture::Zoom(factor) => self.placement.zoom_at(factor, at),
            Gesture::Pan(along) => self.placement.pan_by(along),
        });
    }

    /// Changes the view, at once for the events that follow in this frame of the window.
    fn show(&mut self, view: PictureView) {
        self.placement = self.placement.showing(view);
        self.actions.push(Action::View(ViewAction::Picture(view)));
    }

    /// Reports the position under the pointer, in px of the picture, if it has changed. Outside the
    /// picture, or where something covers it, there is none; during a drag the cover does not
    /// count.
    fn hover(&mut self) {
        let hovered = self
            .pointer
            .at
            .filter(|at| self.pointer.hold != DragTarget::Nothing || (self.around.is_free)(*at))
            .map(|at| self.placement.image_from_screen(at))
            .filter(|at| self.placement.image_size.contains(*at));
        if hovered != self.around.hover {
            self.actions
                .push(Action::Pointer(PointerAction::Hover(hovered)));
        }
    }

    /// The nearest position within the picture.
    fn within_picture(&self, at: ImagePoint) -> ImagePoint {
        let size = self.placement.image_size;
        ImagePoint::new(
            at.x.clamp(0.0, f64::from(size.width)),
            at.y.clamp(0.0, f64::from(size.height)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Rect, pos2, vec2};
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    /// A ring is drawn at (800, 600) and can be grabbed within 16 px.
    fn drawn_ring(at: ImagePoint) -> Option<DrawnElement> {
        let image = ImagePoint::new(800.0, 600.0);
        (image.distance_px(at) <= 16.0).then(|| DrawnElement {
            target: touchline_documents::document::Target::Landmark("centre_mark".into()),
            image,
        })
    }

    /// At half size: two px of the picture per point.
    fn read(
        pointer: &mut Pointer,
        events: &[Event],
        modifiers: Modifiers,
        mode: &Mode,
    ) -> Vec<Action> {
        read_with(Tool::Point, pointer, events, modifiers, mode)
    }

    fn read_with(
        tool: Tool,
        pointer: &mut Pointer,
        events: &[Event],
        modifiers: Modifiers,
        mode: &Mode,
    ) -> Vec<Action> {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(960.0, 540.0));
        let around = Surroundings {
            placement: Placement::new(rect, 1.0, SIZE, PictureView::Fit),
            clicks: &[ImagePoint::new(400.0, 400.0), ImagePoint::new(410.0, 400.0)],
            mode,
            hover: None,
            ready: true,
            tool,
            space: false,
            is_free: &|at| rect.contains(at),
            drawn_at: &drawn_ring,
        };
        let mut actions = pointer.read(events, modifiers, &around);
        actions.retain(|action| !matches!(action, Action::Pointer(PointerAction::Hover(_))));
        actions
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    const DRAGGING: Mode = Mode::Dragging {
        click: 0,
        placed: false,
    };

    #[test]
    fn a_press_and_its_release_in_one_frame_are_both_seen() {
        let at = pos2(100.25, 50.5);
        let actions = read(
            &mut Pointer::default(),
            &[button(at, true), button(at, false)],
            Modifiers::NONE,
            &Mode::Idle,
        );
        let press = Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(200.5, 101.0),
            on: None,
        });
        assert_eq!(actions, [press, Action::Pointer(PointerAction::Release)]);
    }

    #[test]
    fn the_tool_that_selects_takes_hold_of_points_and_else_of_the_picture() {
        let held = |at: Pos2, mode: &Mode| {
            let mut pointer = Pointer::default();
            let press = [button(at, true)];
            read_with(Tool::Select, &mut pointer, &press, Modifiers::NONE, mode);
            pointer.hold
        };
        let picture = DragTarget::Picture(PointerButton::Primary);
        assert_eq!(held(pos2(100.0, 50.0), &Mode::Idle), picture);
        let on_click = held(pos2(201.0, 203.0), &Mode::Idle);
        assert!(matches!(on_click, DragTarget::Click { .. }), "{on_click:?}");
        // A name that was chosen first is placed.
        let placing = Mode::Placing(touchline_documents::document::Target::Landmark("x".into()));
        let placed = held(pos2(100.0, 50.0), &placing);
        assert!(matches!(placed, DragTarget::Click { .. }), "{placed:?}");
    }

    #[test]
    fn a_press_grabs_the_nearest_click_and_small_movements_do_not_drag_it() {
        let mut pointer = Pointer::default();
        let events = [
            button(pos2(201.0, 203.0), true),
            Event::PointerMoved(pos2(202.0, 204.0)),
        ];
        let actions = read(&mut pointer, &events, Modifiers::NONE, &Mode::Idle);
        assert_eq!(
            actions,
            [Action::Pointer(PointerAction::Press {
                at: ImagePoint::new(402.0, 406.0),
                on: Some(0)
            })]
        );
        let actions = read(
            &mut pointer,
            &[button(pos2(202.0, 204.0), false)],
            Modifiers::NONE,
            &DRAGGING,
        );
        assert_eq!(actions, [Action::Pointer(PointerAction::Release)]);
    }

    #[test]
    fn a_dragged_click_keeps_its_distance_from_the_pointer_and_shift_is_fine() {
        let mut pointer = Pointer::default();
        read(
            &mut pointer,
            &[button(pos2(201.0, 203.0), true)],
            Modifiers::NONE,
            &Mode::Idle,
        );
        let moves = [
            Event::PointerMoved(pos2(210.0, 203.0)),
            Event::PointerMoved(pos2(221.0, 213.0)),
        ];
        let actions = read(&mut pointer, &moves, Modifiers::NONE, &DRAGGING);
        assert_eq!(
            actions,
            [Action::Pointer(PointerAction::Drag(ImagePoint::new(
                440.0, 420.0
            )))],
            "one drag a frame of the window"
        );
        let actions = read(
            &mut pointer,
            &[Event::PointerMoved(pos2(231.0, 213.0))],
            Modifiers::SHIFT,
            &DRAGGING,
        );
        assert_eq!(
            actions,
            [Action::Pointer(PointerAction::Drag(ImagePoint::new(
                442.0, 420.0
            )))]
        );
    }

    #[test]
    fn a_drawn_ring_is_grabbed_and_keeps_its_distance_from_the_pointer() {
        let mut pointer = Pointer::default();
        let pressed = [button(pos2(403.0, 304.0), true)];
        let grab = PointerAction::Grab {
            at: ImagePoint::new(806.0, 608.0),
            element: touchline_documents::document::Target::Landmark("centre_mark".into()),
        };
        assert_eq!(
            read(&mut pointer, &pressed, Modifiers::NONE, &Mode::Idle),
            [Action::Pointer(grab)]
        );
        let moved = [Event::PointerMoved(pos2(413.0, 304.0))];
        let drag = PointerAction::Drag(ImagePoint::new(820.0, 600.0));
        assert_eq!(
            read(&mut pointer, &moved, Modifiers::NONE, &DRAGGING),
            [Action::Pointer(drag)]
        );
    }

    #[test]
    fn alt_at_the_release_keeps_the_point_where_it_is() {
        let mut pointer = Pointer::default();
        let at = pos2(100.0, 50.0);
        read(
            &mut pointer,
            &[button(at, true)],
            Modifiers::NONE,
            &Mode::Idle,
        );
        let released = Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed: false,
            modifiers: Modifiers::ALT,
        };
        assert_eq!(
            read(&mut pointer, &[released], Modifiers::ALT, &DRAGGING),
            [Action::Pointer(PointerAction::ReleaseExactly)]
        );
    }

    #[test]
    fn a_drag_that_was_cancelled_lets_go() {
        let mut pointer = Pointer::default();
        read(
            &mut pointer,
            &[button(pos2(200.0, 200.0), true)],
            Modifiers::NONE,
            &Mode::Idle,
        );
        let moves = [
            Event::PointerMoved(pos2(300.0, 203.0)),
            button(pos2(300.0, 203.0), false),
        ];
        assert_eq!(read(&mut pointer, &moves, Modifiers::NONE, &Mode::Idle), []);
    }

    #[test]
    fn a_mask_is_cancelled_with_its_tool() {
        let mut pointer = Pointer::default();
        let begun = [
            button(pos2(200.0, 200.0), true),
            Event::PointerMoved(pos2(300.0, 260.0)),
        ];
        let released = [button(pos2(300.0, 260.0), false)];
        let (none, idle) = (Modifiers::NONE, &Mode::Idle);
        read_with(Tool::Mask, &mut pointer, &begun, none, idle);
        let actions = read_with(Tool::Point, &mut pointer, &released, none, idle);
        assert_eq!(actions, []);
        read_with(Tool::Mask, &mut pointer, &begun, none, idle);
        let actions = read_with(Tool::Mask, &mut pointer, &released, none, idle);
        let adds = matches!(actions[..], [Action::Edit(EditAction::AddMask { .. })]);
        assert!(adds, "{actions:?}");
    }

    #[test]
    fn with_a_chosen_name_a_click_near_another_point_places_a_new_one() {
        let mode = Mode::Placing(touchline_documents::document::Target::Landmark(
            "centre_mark".into(),
        ));
        let actions = read(
            &mut Pointer::default(),
            &[button(pos2(200.0, 200.0), true)],
            Modifiers::NONE,
            &mode,
        );
        assert_eq!(
            actions,
            [Action::Pointer(PointerAction::Press {
                at: ImagePoint::new(400.0, 400.0),
                on: None
            })]
        );
    }

    #[test]
    fn a_middle_drag_moves_the_picture_and_leaves_points_alone() {
        let mut pointer = Pointer::default();
        let middle = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Middle,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let events = [
            middle(pos2(200.0, 200.0), true),
            Event::PointerMoved(pos2(260.0, 200.0)),
            middle(pos2(260.0, 200.0), false),
        ];
        let actions = read(&mut pointer, &events, Modifiers::NONE, &Mode::Idle);
        assert!(
            actions
                .iter()
                .all(|action| matches!(action, Action::View(ViewAction::Picture(_)))),
            "{actions:?}"
        );
        assert_eq!(pointer.hold, DragTarget::Nothing);
    }
}
