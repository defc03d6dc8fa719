//! The functions behind each kind of action; they dispatch its variants.

use super::{App, Settings};
use crate::app::action::{
    DiskReport, EditAction, Navigation, PointerAction, SettingsAction, ViewAction,
};
use crate::app::effect::Effect;
use crate::app::operation::{Job, Operation, Report};
use crate::app::settings::{PICTURE_MEMORY_MIB, text_size_within_limits};
use crate::app::trainer::TrainerReport;
use crate::app::window_state::session::{Dialog, Level, Mode};
use crate::scene::OverlayStyle;

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
            ViewAction::SelectFrames(frames) => self.select_frames(frames),
            ViewAction::SetFilter(filter) => self.session.filter = filter,
            ViewAction::HoldReview(held) => self.session.review.held = held,
            ViewAction::SetReviewOrder(order) => self.session.review.order = order,
            ViewAction::SetReviewThreshold(threshold) => {
                self.session.review.threshold = threshold.clamp(0.0, 1.0);
            }
            ViewAction::SetWithDisagreeing(with) => self.session.review.with_disagreeing = with,
            ViewAction::SetOnePerShot(one) => self.session.review.one_per_shot = one,
            ViewAction::ListShots(shots) => self.session.review.shots.is_shown = shots,
            ViewAction::SetShotOrder(order) => self.session.review.shots.order = order,
            ViewAction::ListFieldsOnly(only) => self.session.review.shots.fields_only = only,
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
            ViewAction::EditFieldTemplate(copied) => self.edit_field_template(copied.as_deref()),
            ViewAction::ChangeFieldTemplate(change) => self.change_field_draft(change),
            ViewAction::SetSpeed(speed) => self.session.video.speed = speed,
            ViewAction::PlayTo(frame) => self.play_to(frame),
            ViewAction::Pause => self.pause(),
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
            Navigation::LookAtClick(looks) => self.look_at_click(looks),
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
            EditAction::AcceptSelected => self.accept_selected(),
            EditAction::RejectSelected(reason) => self.reject_selected(reason),
            EditAction::DiscardBatch(batch) => self.discard_batch(batch),
            EditAction::SetUseForTraining { frame, used } => self.set_use_for_training(frame, used),
            EditAction::UseForBase { frame, used } => self.use_for_base(frame, used),
            EditAction::MirrorNames { frame, symmetry } => self.mirror_names(frame, symmetry),
            EditAction::ChooseSport(template) => self.choose_sport(&template),
            EditAction::SaveFieldTemplate => self.save_field_template(),
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
                        .note(format!("{} is already open.", file.display()));
                }
            }
            DiskReport::MatchSeen { project, state } => self.take_match_state(&project, *state),
            DiskReport::Failed(message) => {
                if self.session.disk.opening.take().is_some() {
                    self.match_failed(&message);
                }
                self.tour_waits = false;
                self.session.notify(Level::Error, message);
            }
            DiskReport::TemplateRead { of, name, template } => {
                self.template_read(&of, &name, template);
            }
            DiskReport::TemplateText { of, name, text } => {
                self.field_template_text(&of, name, text);
            }
            DiskReport::TemplateWritten { of, name, template } => {
                self.field_template_written(&of, &name, template);
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
                    .note(format!("Copy written: {}", folder.display()));
            }
            DiskReport::ChangedOutside { path, own } => self.handle_outside_change(path, own),
            DiskReport::Outside(outside) => self.merge_outside(&outside),
            DiskReport::OrphanRead { orphan, edits } => self.merge_orphan(orphan, &edits),
            DiskReport::OrphanSaved { document } => {
                self.session.note(format!(
                    "The edits were saved as a separate document: {}",
                    document.display()
                ));
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

impl App {
    /// The style of the lines over the shown frame.
    pub fn overlay_style(&self) -> OverlayStyle {
        let template = self
            .shown_field_spec()
            .map(|spec| spec.template.as_str())
            .unwrap_or_default();
        self.settings.overlay_of(template)
    }

    /// Switches a setting on or off.
    pub(super) fn toggle_setting(&mut self, switch_of: fn(&mut Settings) -> &mut bool) {
        let switch = switch_of(&mut self.settings);
        *switch = !*switch;
        self.effects.push(Effect::SaveSettings);
    }

    /// Changes a setting. Values outside their range are clamped.
    pub(super) fn set_setting(&mut self, action: SettingsAction) {
        let settings = &mut self.settings;
        match action {
            SettingsAction::OverlayStyle(style) => settings.overlay = style,
            SettingsAction::Theme(theme) => settings.theme = theme,
            SettingsAction::LineColour(sport, colour) => settings.set_line_colour(sport, colour),
            SettingsAction::Loupe(loupe) => settings.loupe = loupe.within_limits(),
            SettingsAction::PictureMemory(mib) => {
                settings.picture_memory_mib =
                    mib.clamp(*PICTURE_MEMORY_MIB.start(), *PICTURE_MEMORY_MIB.end());
            }
            SettingsAction::PictureLook(look) => settings.picture = look.within_limits(),
            SettingsAction::TextSize(size) => settings.text_size = text_size_within_limits(size),
            SettingsAction::PanelSizes { side, filmstrip } => {
                settings.side_width = side;
                settings.filmstrip_height = filmstrip;
            }
            SettingsAction::AssignKey(command, chord) => self.assign_key(command, chord),
            SettingsAction::ResetKeys => settings.keys.reset(),
            SettingsAction::Details(shown) => settings.details = shown,
        }
        self.effects.push(Effect::SaveSettings);
    }
}

impl App {
    /// Starts an operation. Cancels a running one of the same kind.
    pub(in crate::app) fn start<O: Operation>(&mut self, operation: O) {
        let (running, job) = Job::new(self.last_request.advance(), operation);
        O::slot(self).replace(running);
        self.effects.push(Effect::Start(job));
    }

    /// Applies a report, or keeps it for later if its operation must wait.
    pub(super) fn receive(&mut self, report: Report) {
        let waits = report.apply(self);
        self.waiting_reports.extend(waits);
    }

    /// Tries the kept reports again; those that still must wait are kept again.
    pub(in crate::app) fn deliver_waiting_reports(&mut self) {
        for report in std::mem::take(&mut self.waiting_reports) {
            self.receive(report);
        }
    }

    /// Whether a step of undo is open (as during a drag), or no document is.
    pub(in crate::app) fn is_amid_step(&self) -> bool {
        self.open.as_ref().is_none_or(|open| open.history.is_open())
    }

    /// Whether the user is in the middle of a change, or a change of many frames is being computed.
    /// Results that change the document wait for its end.
    pub(in crate::app) fn is_amid_change(&self) -> bool {
        self.session.mode != Mode::Idle
            || self.operations.bulk_solve.is_running()
            || self.is_amid_step()
    }
}

#[cfg(test)]
mod tests {
    use super::super::App;
    use crate::app::operation::probe::Probe;
    use crate::app::operation::{Breakdown, Failure, Job, Report, RequestId};
    use crate::app::{Action, Effect, Opened, Settings, ViewAction};
    use touchline_documents::testing::soccer_document;

    fn opened() -> Action {
        Action::Opened(Box::new(Opened::new(
            soccer_document(),
            "/match/project.json",
        )))
    }

    fn app() -> App {
        let mut app = App::new(Settings::default());
        app.update(opened());
        app
    }

    /// Starts a probe as a command would.
    fn start(app: &mut App) -> Job {
        let Effect::Start(job) = app.start_probe(Probe::from_steps([])) else {
            panic!("nothing was started")
        };
        job
    }

    fn end(id: RequestId, output: u32) -> Action {
        Action::Report(Report::from_result::<Probe>(id, Ok(output)))
    }

    #[test]
    fn a_request_is_followed_to_its_end_and_taken_over_once() {
        let mut app = app();
        let job = start(&mut app);
        app.update(Action::Report(Report::from_progress::<Probe>(job.id(), 40)));
        assert_eq!(
            app.operations.probe.slot.running().unwrap().progress(),
            Some(&40)
        );
        app.update(end(job.id(), 7));
        assert!(!app.operations.probe.slot.is_running());
        app.update(end(job.id(), 8));
        assert_eq!(
            app.operations.probe.taken,
            [Ok(7)],
            "the second report is of nothing"
        );
    }

    #[test]
    fn a_newer_request_of_the_kind_cancels_the_one_before() {
        let mut app = app();
        let (first, second) = (start(&mut app), start(&mut app));
        assert!(first.is_cancelled() && !second.is_cancelled() && first.id() < second.id());
        app.update(Action::Report(Report::from_progress::<Probe>(
            first.id(),
            40,
        )));
        app.update(end(first.id(), 1));
        assert!(app.operations.probe.taken.is_empty());
        assert_eq!(
            app.operations.probe.slot.running().unwrap().progress(),
            None,
            "of another request"
        );
        app.update(end(second.id(), 2));
        assert_eq!(app.operations.probe.taken, [Ok(2)]);
    }

    #[test]
    fn another_document_cancels_whatever_runs_and_numbers_go_on() {
        let mut app = app();
        let before = start(&mut app);
        app.update(opened());
        assert!(before.is_cancelled());
        let after = start(&mut app);
        assert!(before.id() < after.id());
        app.update(end(before.id(), 1));
        assert!(
            app.operations.probe.taken.is_empty(),
            "a late report of the document before"
        );
        drop(app);
        assert!(after.is_cancelled(), "its result is no longer needed");
    }

    #[test]
    fn a_result_waits_while_it_must_and_can_still_be_cancelled() {
        let mut app = app();
        let job = start(&mut app);
        app.operations.probe.must_wait = true;
        app.update(end(job.id(), 1));
        assert!(app.operations.probe.taken.is_empty() && app.operations.probe.slot.is_running());
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert!(app.operations.probe.taken.is_empty());
        app.operations.probe.must_wait = false;
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert_eq!(app.operations.probe.taken, [Ok(1)]);

        let job = start(&mut app);
        app.operations.probe.must_wait = true;
        app.update(end(job.id(), 2));
        assert!(app.operations.probe.slot.cancel());
        app.operations.probe.must_wait = false;
        app.update(Action::View(ViewAction::SelectNoFrames));
        assert_eq!(
            (app.operations.probe.taken.len(), app.waiting_reports.len()),
            (1, 0)
        );
    }

    #[test]
    fn a_failure_of_the_program_is_louder_than_one_of_the_work() {
        use crate::app::window_state::session::Level;
        let panicked: Failure<&str> = Failure::Broken(Breakdown::Panicked("a bug".to_owned()));
        assert_eq!(
            panicked.to_string(),
            "internal error (please report it): a bug"
        );
        assert_eq!(
            (panicked.level(), Failure::Failed("no paint").level()),
            (Level::Error, Level::Warning)
        );
        assert_eq!(Failure::Failed("no paint").to_string(), "no paint");
    }
}
