//! Finding the shown frame's camera without a click: begun, stopped, and what came of it.

use super::App;
use crate::app::Command;
use crate::app::effect::Effect;
use crate::app::session::{Level, Mode, SidePanel};
use crate::app::unclicked::{
    FEWEST, Searching, TwoCameras, UnclickedFailure, UnclickedOrder, UnclickedWork, describe_abstention, describe_found,
};
use crate::calibrate::{BulkChange, DecidingLandmark, FoundCamera, UnclickedAnswer, UnclickedProgress};
use crate::document::{Step, Target};
use std::sync::Arc;

impl App {
    /// Why the shown frame's camera cannot be found without a click now; none if it can.
    pub(super) fn why_not_find_camera(&self) -> Option<&'static str> {
        let (open, camera) = (self.open.as_ref()?, self.camera_id()?);
        if open.read_only.is_some() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot find features.");
        }
        if self.session.unclicked.searching().is_some() {
            return Some("A search for the camera is running.");
        }
        if self.current.base.is_some() {
            return Some("This camera has a base already.");
        }
        let few = open.document.frames.iter().filter(|frame| frame.camera == *camera).nth(FEWEST - 1).is_none();
        few.then_some("The camera has too few frames: 3 or more that overlap are needed.")
    }

    /// Has the shown frame's camera looked for by the pictures of its frames alone.
    pub(super) fn find_camera(&mut self) {
        self.commit_open_step();
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else { return };
        self.unclicked_tickets += 1;
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let order = UnclickedOrder { ticket: self.unclicked_tickets, document, folder, camera };
        self.effects.push(Effect::FindCamera(Box::new(order.clone())));
        self.session.unclicked = UnclickedWork::Searching(Box::new(Searching { order, progress: None }));
    }

    /// Stops the search, or lets go of what it left to decide; nothing has changed.
    pub(super) fn stop_find_camera(&mut self) {
        if let UnclickedWork::Searching(_) = std::mem::take(&mut self.session.unclicked) {
            self.effects.push(Effect::CancelFindCamera);
            self.session.notify(Level::Info, "The search for the camera was stopped; nothing was changed.");
        }
    }

    pub(super) fn find_camera_progress(&mut self, ticket: u64, progress: UnclickedProgress) {
        if let UnclickedWork::Searching(searching) = &mut self.session.unclicked
            && searching.order.ticket == ticket
        {
            searching.progress = Some(progress);
        }
    }

    /// Takes the answer of a search.
    pub(super) fn camera_searched(&mut self, ticket: u64, answer: Result<Box<UnclickedAnswer>, UnclickedFailure>) {
        if self.session.unclicked.searching().is_none_or(|searching| searching.order.ticket != ticket) {
            return;
        }
        let UnclickedWork::Searching(searching) = std::mem::take(&mut self.session.unclicked) else { return };
        let order = searching.order;
        match answer.map(|answer| *answer) {
            Ok(UnclickedAnswer::Found(found)) => {
                let found = order.named(*found);
                self.session.found_camera = Some(Arc::clone(&found));
                self.session.unclicked = UnclickedWork::Found(found);
            }
            Ok(UnclickedAnswer::Two { best, other, deciding }) => {
                let label = |deciding: &DecidingLandmark| self.label(&Target::Landmark(deciding.landmark.clone()));
                let two = TwoCameras::of(&order, [*best, *other], deciding, label);
                let offers = [("Try the first", Command::TryFirstCamera), ("Try the other", Command::TryOtherCamera)];
                self.session.notify_with(Level::Warning, two.describe(), offers);
                self.session.found_camera = Some(Arc::clone(&two.cameras[0]));
                self.session.unclicked = UnclickedWork::Two(Box::new(two));
                self.session.panel = SidePanel::Camera;
            }
            Ok(UnclickedAnswer::Abstained(why)) => {
                let why = describe_abstention(&why);
                self.session.notify(Level::Warning, why.clone());
                self.session.unclicked = UnclickedWork::Abstained { camera: order.camera, why };
            }
            Err(failure) => {
                let level = match failure {
                    UnclickedFailure::Impossible { .. } => Level::Warning,
                    UnclickedFailure::Panicked { .. } => Level::Error,
                };
                self.session.notify(level, format!("The search for the camera failed: {failure}."));
            }
        }
    }

    /// Takes over a camera that was found, once nothing else is under way: a drag is not cut in two.
    pub(super) fn finish_find_camera(&mut self) {
        let is_busy = self.session.mode != Mode::Idle
            || self.session.bulk.is_some()
            || self.open.as_ref().is_none_or(|open| open.history.is_open());
        if is_busy {
            return;
        }
        self.decide_by_click();
        if !matches!(self.session.unclicked, UnclickedWork::Found(_)) {
            return;
        }
        let UnclickedWork::Found(found) = std::mem::take(&mut self.session.unclicked) else { return };
        let has_base = self.open.as_ref().and_then(|open| open.document.camera(&found.camera)?.base()).is_some();
        if has_base {
            let text = "The camera was found, but it was given a base in the meantime; the result was discarded.";
            self.session.notify(Level::Info, text);
            return;
        }
        self.use_found_camera(found);
    }

    /// Of two cameras the one for which the deciding click speaks is taken, once it is there.
    fn decide_by_click(&mut self) {
        let (UnclickedWork::Two(two), Some(open)) = (&self.session.unclicked, &self.open) else { return };
        let Some(which) = two.deciding.as_ref().and_then(|deciding| deciding.decided(&open.document)) else { return };
        let found = Arc::clone(&two.cameras[which]);
        self.session.unclicked = UnclickedWork::Idle;
        self.session.retract(Command::TryFirstCamera);
        self.session.retract(Command::TryOtherCamera);
        self.use_found_camera(found);
    }

    /// Takes over one of two cameras that explain the paint alike: one step of undo each.
    pub(super) fn try_camera(&mut self, which: usize) {
        if let UnclickedWork::Two(two) = &self.session.unclicked {
            let found = Arc::clone(&two.cameras[which]);
            self.use_found_camera(found);
        }
    }

    fn use_found_camera(&mut self, found: Arc<FoundCamera>) {
        self.session.found_camera = Some(Arc::clone(&found));
        self.change_in_bulk(Step::on_document("Find the camera"), BulkChange::Unclicked(found));
    }

    /// Tells of a camera that was found and taken over.
    pub(super) fn camera_found(&mut self, found: &FoundCamera) {
        self.session.retract(Command::FindCamera);
        self.session.retract(Command::EstimateBase);
        self.tell_assumed_size();
        let offers = [("Review", Command::ReviewPanel), ("Undo", Command::Undo)];
        self.session.notify_with(Level::Info, describe_found(&found.found), offers);
    }
}
