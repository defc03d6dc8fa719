//! Reads the events of one frame of the window in their order: presses, moves and releases become
//! drags, and drags become actions.

use super::super::wheel::Gesture;
use super::{DragTarget, FINE, Pointer, SLACK_PT, Surroundings, click_to_grab};
use crate::ui::drawing::placement::Placement;
use egui::{Event, Modifiers, PointerButton, Pos2};
use touchline_application::app::session::{Mode, PictureView};
use touchline_application::app::{Action, EditAction, PointerAction, Tool, ViewAction};
use touchline_core::geometry::ImagePoint;

/// The reading of one frame's events.
pub(super) struct Reading<'a> {
    pub(super) pointer: &'a mut Pointer,
    pub(super) around: &'a Surroundings<'a>,
    /// Where the picture is. Zooming and panning change it between two events.
    pub(super) placement: Placement,
    pub(super) actions: Vec<Action>,
}

impl Reading<'_> {
    /// Reads one event.
    pub(super) fn event(&mut self, event: &Event, modifiers: Modifiers) {
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
    pub(super) fn hover(&mut self) {
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
