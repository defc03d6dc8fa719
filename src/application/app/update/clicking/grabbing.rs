//! Grabbing a drawn landmark or line and dragging it to where the picture shows it.
//!
//! The press alone places a point, as everywhere on the picture. With the first movement that point
//! is given up, and the drawn landmark or line itself follows the pointer as a click with its name.
//! The frame is solved with each movement, so that the whole overlay follows.

use crate::app::window_state::session::Mode;
use crate::app::{App, Tool};
use crate::scene::drawn_element::{DrawnElement, ElementReach, element_at};
use crate::scene::overlay::OverlayScene;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, FrameStatus, Target};

impl App {
    /// The landmark or line that a drag from a point of the picture would move; none where none is
    /// drawn within reach, or something else has been begun.
    pub fn grabbable(&self, at: ImagePoint, reach: ElementReach) -> Option<DrawnElement> {
        let frame = self.frame().filter(|_| self.can_grab())?;
        let style = self.overlay_style();
        let scene = OverlayScene {
            camera: Some(self.current.camera.as_ref()?),
            clicks: &frame.clicks,
            ..OverlayScene::new(self.current.field()?, frame.image_size, &style)
        };
        element_at(&scene, at, reach)
    }

    /// Whether the drawn lines are those of the frame's own camera, and nothing has been begun that
    /// gives a press another meaning.
    fn can_grab(&self) -> bool {
        let (session, held) = (&self.session, self.session.picture.held);
        let shows_own_camera = !(held.hide_overlay || held.compare || held.before_snap)
            && self.current.base.is_some()
            && self.current.proposal.is_none();
        let is_rejected = self
            .frame()
            .is_some_and(|frame| frame.status == FrameStatus::Rejected);
        shows_own_camera
            && session.mode == Mode::Idle
            && session.picture.tool == Tool::Point
            && !session.points.next_on_line
            && !is_rejected
            && !self.is_read_only()
    }

    /// The button went down on a drawn landmark or line: a point is placed. It is given up when
    /// the pointer moves.
    pub(in crate::app::update) fn grab(&mut self, at: ImagePoint, element: Target) {
        // A press that placed no point grabs nothing.
        self.press(at, None);
        if matches!(self.session.mode, Mode::Dragging { placed: true, .. }) {
            self.session.points.grabbed = Some(element);
        }
    }

    /// The pointer has moved with a landmark or line: it becomes a click there, in a step of undo
    /// that begins now.
    pub(super) fn drag_grabbed(&mut self, element: Target, to: ImagePoint) {
        // The point that the press placed was not meant.
        self.abort();
        let step = format!("Move {}", self.label(&element));
        if !self.begin(step) {
            return;
        }
        let Some(frame) = self.frame_mut() else {
            return;
        };
        // One click does not determine a camera: the present one is its prior.
        frame.keep_camera_as_prior();
        frame.clicks.push(Click::new(element, to));
        let click = frame.clicks.len() - 1;
        self.session.points.selected = Some(click);
        self.session.mode = Mode::Dragging {
            click,
            placed: false,
        };
        self.move_click(click, to);
        self.clicks_changed();
    }
}
