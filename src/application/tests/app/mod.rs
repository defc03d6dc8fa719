//! The application by actions, without a window: place, name, drag, undo, accept, reject.

mod documents;
mod frames;
mod names;
mod points;

use crate::bench::Bench;
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, EditAction, Navigation};
use touchline_application::testing::{base, landmark_in};
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::{SIZE, TestBase, soccer};
use touchline_documents::document::{Camera, Clip, Document, Frame, Target};
use touchline_documents::testing::{new_frame, soccer_document};

/// The truth of frame `index`: a slow pan.
fn truth(index: usize) -> PtzCamera {
    base().aim(-4.0 + 0.6 * index as f64, -14.0, 2300.0)
}

fn document(frames: usize, with_base: bool) -> Document {
    let mut document = soccer_document();
    let mut camera = Camera::new("main".into(), SIZE);
    if with_base {
        camera.set_base(&base());
    }
    document.cameras.push(camera.into());
    for index in 0..frames {
        let mut frame = new_frame(&format!("images/{index:04}.jpg"), SIZE);
        frame.clip = Some(Clip::Number(i64::from(index >= 4)));
        document.frames.push(frame.into());
    }
    document
}

impl Bench {
    /// Where a landmark is in the shown frame, by the truth.
    fn image_of(&self, landmark: &str) -> ImagePoint {
        landmark_in(&truth(self.app.session.frame), landmark)
    }

    /// Clicks a landmark and names it by its code where the list asks for it.
    fn place(&mut self, landmark: &str) {
        self.click(self.image_of(landmark));
        if let Mode::Naming(_) = self.app.session.mode {
            let code = soccer().landmark(landmark).unwrap().code.clone();
            self.act(Action::Navigate(Navigation::TypeName(code)));
            self.act(Action::Edit(EditAction::TakeName(0)));
        }
        let named = self.frame().clicks.last().unwrap().target.clone();
        assert_eq!(named, Some(Target::Landmark(landmark.into())));
    }

    fn frame(&self) -> &Frame {
        self.app.frame().unwrap()
    }

    fn ptz_error(&self) -> f64 {
        let (found, truth) = (
            self.frame().ptz.as_ref().unwrap().ptz(),
            truth(self.app.session.frame).ptz(),
        );
        (found.pan - truth.pan).abs().degrees()
            + (found.tilt - truth.tilt).abs().degrees()
            + (found.focal_px - truth.focal_px).abs()
    }
}
