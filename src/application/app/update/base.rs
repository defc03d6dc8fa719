//! Estimating a camera's base, reviewing the result, applying it.

use super::App;
use crate::app::Command;
use crate::app::base::{BaseWork, EstimateFailure, EstimateProgress, Estimating};
use crate::app::effect::Effect;
use crate::app::session::{Level, SidePanel};
use std::sync::Arc;
use touchline_calibration::calibrate::{
    BaseReadiness, BulkChange, EstimatedBase, LANDMARKS_ALONE, describe_size, next_for_base,
};
use touchline_core::field::{FieldModel, Symmetry};
use touchline_core::geometry::counted;
use touchline_core::solve::Name;
use touchline_documents::document::{Click, Frame, Step, Target};

impl App {
    /// What the frames of the shown frame's camera say about its base.
    #[must_use]
    pub const fn base_readiness(&self) -> BaseReadiness {
        self.current.readiness
    }

    /// Has the base estimated in the background, and the field's size with it.
    pub(super) fn estimate_base(&mut self, with_size: bool) {
        let ready = self.base_readiness();
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else { return };
        if ready.wide == 0 && self.current.base.is_none() {
            self.session.notify(Level::Info, format!("Not enough points yet. {}", ready.describe()));
            return;
        }
        let with_paint = self.settings.base_on_paint;
        self.effects.push(Effect::EstimateBase {
            with_size,
            with_paint,
            document: open.document.clone(),
            folder: open.folder.clone(),
            camera,
        });
        let paint = if with_paint { ", painted lines" } else { "" };
        let from = format!("{}, {}{paint}", counted(ready.frames, "frame"), counted(ready.clicks, "click"));
        self.session.base = BaseWork::Estimating(Estimating { from, progress: None });
        self.session.panel = SidePanel::Camera;
    }

    /// Goes to the frame whose points would tell most about the base of the shown frame's camera.
    pub(super) fn show_for_base(&mut self) {
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else { return };
        let Some(field) = self.current.field() else { return };
        let offer = [("Estimate the base", Command::EstimateBase)];
        let Some(next) = next_for_base(&open.document, &camera, field) else {
            let text =
                "Every frame of this camera that shows enough of the field has its points. Estimate the base again.";
            self.session.notify_with(Level::Info, text, offer);
            return;
        };
        self.go_to(next);
        let text = format!(
            "Click {LANDMARKS_ALONE} or more landmarks here, spread over the picture; then estimate the base again."
        );
        self.session.notify_with(Level::Info, text, offer);
    }

    /// Gives up what is being estimated or what was found.
    pub(super) fn drop_base(&mut self) {
        if matches!(self.session.base, BaseWork::Estimating(_)) {
            self.effects.push(Effect::CancelEstimate);
        }
        if !matches!(self.session.base, BaseWork::Applied(_)) {
            self.session.base = BaseWork::Idle;
        }
    }

    pub(super) fn base_progress(&mut self, progress: EstimateProgress) {
        if let BaseWork::Estimating(estimating) = &mut self.session.base
            && estimating.progress.is_none_or(|before| progress.is_later_than(before))
        {
            estimating.progress = Some(progress);
        }
    }

    pub(super) fn base_estimated(&mut self, found: Result<Box<EstimatedBase>, EstimateFailure>) {
        if !matches!(self.session.base, BaseWork::Estimating(_)) {
            return;
        }
        match found {
            Ok(found) => {
                let text = describe(&found);
                self.session.retract(Command::EstimateBase);
                self.session.base = BaseWork::Proposed(found.into());
                self.session.notify(Level::Info, text);
            }
            Err(failure) => {
                self.session.base = BaseWork::Idle;
                self.session.notify(Level::Warning, format!("No base: {failure}."));
            }
        }
    }

    /// Takes over what was found: one step of undo.
    pub(super) fn use_base(&mut self) {
        if let BaseWork::Proposed(found) = &self.session.base {
            let change = BulkChange::Base(Arc::clone(found));
            self.change_in_bulk(Step::on_document("Estimate base"), change, Self::tell_base_used);
        }
    }

    /// What follows in the window from a base that was taken over.
    fn tell_base_used(&mut self, change: &BulkChange) {
        let BulkChange::Base(found) = change else { return };
        self.session.retract(Command::UseEstimatedBase);
        self.session.retract(Command::EstimateBase);
        self.session.base = BaseWork::Applied(Arc::clone(found));
        self.tell_assumed_size();
    }

    /// A frame takes part in the estimation, or does not.
    pub(super) fn use_for_base(&mut self, index: usize, used: bool) {
        let Some(frame) = self.open.as_ref().and_then(|open| open.frame(index)) else { return };
        if frame.use_for_base == used {
            return;
        }
        let name = if used { "Put frame back" } else { "Leave frame out" };
        if self.begin_step(self.step_at(name, index)) {
            if let Some(frame) = self.open.as_mut().and_then(|open| open.document.frames.get_mut(index)) {
                frame.use_for_base = used;
            }
            self.commit();
        }
    }

    /// Mirrors the names of a frame's clicks: left and right, near and far, or both.
    pub(super) fn mirror_names(&mut self, index: usize, symmetry: Symmetry) {
        self.go_to(index);
        let Some(Ok(field)) = self.open.as_mut().map(|open| open.field_of(index)) else { return };
        if self.begin("Mirror names") {
            if let Some(frame) = self.frame_mut() {
                mirror(frame, &field, symmetry);
            }
            self.clicks_changed();
            self.commit();
            if let BaseWork::Proposed(found) | BaseWork::Applied(found) = &mut self.session.base {
                Arc::make_mut(found).estimate.mirrored.retain(|mirrored| mirrored.frame != index);
            }
        }
    }

    /// Tells once that the frames now suffice.
    pub(super) fn tell_when_enough(&mut self, before: BaseReadiness) {
        if self.current.base.is_none() && !before.is_enough() && self.base_readiness().is_enough() {
            let text = "These frames are enough to estimate the base.";
            self.session.notify_with(Level::Info, text, [("Estimate the base", Command::EstimateBase)]);
        }
    }
}

/// The outcome in one sentence, with what it was before.
fn describe(found: &EstimatedBase) -> String {
    let estimate = &found.estimate;
    let frames = estimate.frames.iter().flatten().count();
    let before = estimate
        .previous_median_px
        .filter(|px| px.is_finite())
        .map(|px| format!(" (currently {px:.1} px); hold B for the current base"))
        .unwrap_or_default();
    let one_view = estimate.one_view().map_or_else(String::new, |reason| format!(" But {reason}."));
    let sizes: Vec<String> = found.sizes.iter().map(describe_size).collect();
    let sizes = if sizes.is_empty() { String::new() } else { format!(" Field {}.", sizes.join(", ")) };
    let paint = found.on_paint.as_ref().map_or_else(String::new, |on_paint| on_paint.seen.describe());
    format!(
        "Base estimated from {}: median error {:.1} px{before}.{paint}{sizes}{one_view}",
        counted(frames, "frame"),
        estimate.median_px
    )
}

fn mirror(frame: &mut Frame, field: &FieldModel, symmetry: Symmetry) {
    for Click { target, .. } in &mut frame.clicks {
        let element = target.as_ref().and_then(|target| target.element(field));
        let twin = element.and_then(|element| Name::of(element.twin(symmetry, field)?, field));
        if let Some(twin) = &twin {
            *target = Some(Target::from(twin));
        }
    }
}
