//! The functions behind each kind of action; they dispatch its variants.

use super::App;
use crate::app::action::{DiskReport, EditAction, Navigation, PointerAction, ViewAction};
use crate::app::trainer::TrainerReport;
use crate::app::window_state::session::{Dialog, Level};

impl App {
    /// Handles the pointer over the picture.
    pub(super) fn point(&mut self, action: PointerAction) {
        match action {
            PointerAction::Hover(at) => self.session.points.hover = at,
            PointerAction::Press { at, on } => {
                self.session.video.playing = false;
                self.press(at, on);
            }
            PointerAction::Grab { at, element } => {
                self.session.video.playing = false;
                self.grab(at, element);
            }
            PointerAction::Drag(to) => self.drag(to),
            PointerAction::Release => self.release(false),
            PointerAction::ReleaseExactly => self.release(true),
        }
    }

    /// Changes how something is displayed.
    pub(super) fn show(&mut self, action: ViewAction) {
        match action {
            ViewAction::Picture(view) => self.session.picture.view = view,
            ViewAction::FitScale(scale) => self.session.picture.fit_scale = scale,
            ViewAction::SelectNoFrames => self.session.frames_selected.clear(),
            ViewAction::SetFilter(filter) => self.session.filter = filter,
            ViewAction::HoldReview(held) => self.session.review.held = held,
            ViewAction::SetReviewOrder(order) => self.session.review.order = order,
            ViewAction::SetReviewThreshold(threshold) => {
                self.session.review.threshold = threshold.clamp(0.0, 1.0);
            }
            ViewAction::SetWithDisagreeing(with) => self.session.review.with_disagreeing = with,
            ViewAction::SetOnePerShot(one) => self.session.review.one_per_shot = one,
            ViewAction::TickSuggestion { frame, ticked } => self.tick_suggestion(frame, ticked),
            ViewAction::SetQualityCamera(camera) => self.set_quality_camera(camera),
            ViewAction::SetTimeAxis(axis) => self.set_time_axis(axis),
            ViewAction::ShowSpan(span) => self.show_span(span),
            ViewAction::CloseDialog => self.close_dialog(),
            ViewAction::ShowGuidePage(page) => self.show_guide_page(page),
            ViewAction::DismissNotice(id) => self
                .session
                .messages
                .notices
                .retain(|notice| notice.id != id),
            ViewAction::Notify(level, text) => self.session.notify(level, text),
            ViewAction::TypePath(question) => self.session.dialog = Some(Dialog::Path(question)),
            ViewAction::ReadFailedTemplatesAgain => self.read_failed_templates_again(),
            ViewAction::SetSpeed(speed) => self.session.video.speed = speed,
            ViewAction::Pause => self.session.video.playing = false,
        }
    }

    /// Shows another frame or click, or handles the list of names.
    pub(super) fn navigate(&mut self, action: Navigation) {
        match action {
            Navigation::Select(click) => self.select(click),
            Navigation::TypeName(typed) => self.type_name(typed),
            Navigation::RefineName(typed) => self.refine_name(typed),
            Navigation::ConfirmName => self.session.forget_placed(),
            Navigation::HighlightName(index) => self.highlight_name(index),
            Navigation::ListLines(lines) => self.list_lines(lines),
            Navigation::GoTo(frame) => self.go_to(frame),
            Navigation::SelectFrame { frame, how } => self.select_frame(frame, how),
            Navigation::AskCamera(scope) => {
                self.session.dialog = Some(Dialog::AssignToCamera(scope));
            }
            Navigation::LookAt { frame, click } => self.look_at(frame, click),
            Navigation::GoToPlace(place) => self.go_to_place(place),
        }
    }

    /// Changes the document.
    pub(super) fn edit(&mut self, action: EditAction) {
        match action {
            EditAction::Nudge { dx_px, dy_px, held } => self.nudge(dx_px, dy_px, held),
            EditAction::TakeName(index) => self.take_name(index),
            EditAction::Pick(target) => self.pick(target),
            EditAction::Name { click, target } => self.name_click(click, target),
            EditAction::DeleteClick(click) => self.delete_click(click),
            EditAction::SetCheck { click, check } => self.set_check(click, check),
            EditAction::AssignToCamera { scope, camera } => self.assign_to_camera(scope, &camera),
            EditAction::RejectAs(reason) => self.reject_as(reason),
            EditAction::SetComment(comment) => self.set_comment(&comment),
            EditAction::AddMask { of_camera, mask } => self.add_mask(of_camera, mask),
            EditAction::ScopeMask { list, index, scope } => self.scope_mask(list, index, scope),
            EditAction::RemoveMask { list, index } => self.remove_mask(list, index),
            EditAction::Begin(name) => self.begin_edit(name),
            EditAction::Ptz(ptz) => self.edit_ptz(ptz),
            EditAction::Camera(camera) => {
                self.edit_camera(*camera);
            }
            EditAction::Field(field) => {
                self.edit_field(field);
            }
            EditAction::End => {
                self.end_edit();
            }
            EditAction::Abort => self.abort(),
            EditAction::SolveAgain => self.solve_again(),
            EditAction::AcceptAll => self.accept_all(),
            EditAction::DiscardBatch(batch) => self.discard_batch(batch),
            EditAction::SetUseForTraining { frame, used } => self.set_use_for_training(frame, used),
            EditAction::UseForBase { frame, used } => self.use_for_base(frame, used),
            EditAction::MirrorNames { frame, symmetry } => self.mirror_names(frame, symmetry),
            EditAction::ChooseSport(template) => self.choose_sport(&template),
            EditAction::MoveCut { cut, to } => self.move_cut(cut, to),
        }
    }

    /// Handles a report from the disk.
    pub(super) fn take_from_disk(&mut self, action: DiskReport) {
        match action {
            DiskReport::Progress(text) => {
                if self.session.disk.opening.is_some() {
                    self.session.disk.opening = Some(text);
                }
            }
            DiskReport::AlreadyOpen(file) => {
                self.session.disk.opening = None;
                if self.tour_waits {
                    self.begin_waiting_tour();
                } else {
                    self.session
                        .notify(Level::Info, format!("{} is already open.", file.display()));
                }
            }
            DiskReport::Failed(message) => {
                self.session.disk.opening = None;
                self.tour_waits = false;
                self.session.notify(Level::Error, message);
            }
            DiskReport::TemplateRead { of, name, template } => {
                self.template_read(&of, &name, template);
            }
            DiskReport::CameraLoaded(camera) => self.camera_loaded(&camera),
            DiskReport::Saved {
                revision,
                at,
                document,
            } => self.handle_save(revision, at, document),
            DiskReport::SaveFailed(message) => self.save_failed(message),
            DiskReport::Copied {
                of,
                revision,
                folder,
            } => {
                // A copy of a document that was closed since says nothing of the open one.
                if self.open.as_ref().is_some_and(|open| open.file == of) {
                    let copied = &mut self.session.disk.copied;
                    *copied = (*copied).max(Some(revision));
                }
                self.session
                    .notify(Level::Info, format!("Copy written: {}", folder.display()));
            }
            DiskReport::ChangedOutside { path, own } => self.handle_outside_change(path, own),
            DiskReport::Outside(outside) => self.merge_outside(&outside),
            DiskReport::OrphanRead { orphan, edits } => self.merge_orphan(orphan, &edits),
            DiskReport::OrphanSaved { document } => {
                self.session.notify(
                    Level::Info,
                    format!(
                        "The edits were saved as a separate document: {}",
                        document.display()
                    ),
                );
            }
            DiskReport::OrphanPutAway { orphan, renamed } => {
                self.orphan_put_away(&orphan, &renamed);
            }
        }
    }

    /// Handles a report from the background trainer.
    pub(super) fn take_from_trainer(&mut self, action: TrainerReport) {
        match action {
            TrainerReport::Proposals(proposals) => self.take_proposals(&proposals),
            TrainerReport::Tracked(tracked) => self.take_tracked(&tracked),
            TrainerReport::Status(status) => self.trainer_reported(*status),
            TrainerReport::Features(used) => self.session.trainer.features = Some(*used),
            TrainerReport::Broken { message } => {
                let text =
                    format!("The trainer stopped: internal error (please report it): {message}");
                self.session.notify(Level::Error, text);
            }
        }
    }
}
