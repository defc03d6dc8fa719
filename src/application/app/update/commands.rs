//! Commands: whether each is available, and what it does.

use super::App;
use crate::app::effect::Effect;
use crate::app::transfer::TransferTab;
use crate::app::update::clicking::gold::IN_ROUND;
use crate::app::window_state::session::{Dialog, Mode, PictureView, Question, SidePanel};
use crate::app::{Chord, Command, CommandKind, CommandNeeds, Tool};
use touchline_documents::document::{EditKind, Frame, FrameStatus};

/// Factor of one press of a zoom key.
const ZOOM_STEP: f64 = 1.25;
/// Scale of "zoom to the point", physical px of the screen per px of the picture.
const POINT_SCALE: f64 = 8.0;
/// Maximum scale of the picture, physical px of the screen per px of the picture.
pub const MAX_SCALE: f64 = 32.0;

impl App {
    /// Why a command is not available. None if it is.
    pub fn why_not(&self, command: Command) -> Option<&'static str> {
        // A blind round hides the labels: only commands that keep them hidden are available.
        if self.round().is_some() {
            if !command.kind().is_blind() {
                return Some(IN_ROUND);
            }
            if command == Command::Undo {
                return None;
            }
        }
        // The quality page covers the picture.
        if self.session.quality.open && command.kind() == CommandKind::Picture {
            return Some("Close the quality page first.");
        }
        let needs = command.needs();
        if needs >= CommandNeeds::Document && self.open.is_none() {
            return Some("No document is open.");
        }
        if needs >= CommandNeeds::Frame && self.frame().is_none() {
            return Some("The document has no frames.");
        }
        if needs == CommandNeeds::Point && self.session.points.selected.is_none() {
            return Some("No point is selected.");
        }
        self.why_not_now(command)
    }

    /// Why a command is not available although what it needs is there.
    fn why_not_now(&self, command: Command) -> Option<&'static str> {
        use Command as C;
        match command {
            C::StartTour if self.session.tour.is_some() => Some("The tour is under way."),
            C::LeaveTour if self.session.tour.is_none() => Some("No tour is under way."),
            C::DismissNotices if self.session.messages.notices.is_empty() => {
                Some("There are no messages.")
            }
            C::NextMatch | C::PreviousMatch | C::QueuePanel if self.queue().is_none() => {
                Some("No queue is open.")
            }
            C::PauseTrainer | C::ShowFeatures => self.no_trainer(),
            C::Orphans if self.session.disk.orphans.is_empty() => {
                Some("No edits were set aside beside this document.")
            }
            C::Undo if !self.can_undo() => Some("There is nothing to undo."),
            C::Redo if !self.can_redo() => Some("There is nothing to redo."),
            C::NameNext if self.frame().and_then(Frame::unnamed_click).is_none() => {
                Some("Every point of this frame has a name.")
            }
            C::SkipAgain if self.round().is_none() => Some("No blind round is under way."),
            C::MarkGold => self
                .frame()
                .filter(|frame| !frame.gold)
                .and_then(Frame::why_not_gold),
            C::ChooseGold if !self.gold().can_choose => {
                Some("Every suitable reference is gold already. Accept more frames first.")
            }
            C::UseOwnNoise => self.why_not_own_noise(),
            C::UseUsualNoise => self.why_not_usual_noise(),
            C::DiscardBatch => self.why_not_discard_batch(),
            C::RemoveModelPoints => self.why_not_remove_points(),
            C::AcceptAllAbove if self.review.rows.is_empty() => Some("There are no suggestions."),
            C::NextUnanswered if self.review.advice.next.is_none() => {
                Some("No frame needs a label.")
            }
            C::UseForTraining
                if self
                    .frame()
                    .is_some_and(|frame| frame.status != FrameStatus::Reference) =>
            {
                Some("Only references are used for training.")
            }
            C::NewCameraFromChange if self.camera_change().is_none() => {
                Some("This camera fits all its frames.")
            }
            C::ConfirmFieldSize
                if self
                    .shown_field_spec()
                    .is_none_or(|spec| spec.assumed_size().is_none()) =>
            {
                Some("The field's size is confirmed already.")
            }
            C::AcceptStretch if self.stretch_size().is_none() => {
                Some("No frames are selected: click with Shift on the filmstrip or the timeline.")
            }
            C::Accept | C::AcceptAndStay | C::AcceptStretch | C::AcceptShot
                if self.session.picture.tool == Tool::Mask =>
            {
                Some("Masks are being drawn: Esc ends that first.")
            }
            C::AcceptPlayed | C::StopAtWrong if !self.has_watched() => {
                Some("No suggestion was played: P plays the video.")
            }
            C::AcceptAnyway if self.doubt().is_none() => Some("Nothing contradicts this frame."),
            C::Save
            | C::Import
            | C::ChooseSport
            | C::AssignToCamera
            | C::NewCameraFromChange
            | C::ConfirmFieldSize
            | C::AddCut
            | C::MoveCutHere
            | C::RemoveCut
            | C::ShotContent
                if self.is_read_only() =>
            {
                Some("The document is read-only.")
            }
            C::NextShot | C::PreviousShot | C::AddCut | C::MoveCutHere | C::RemoveCut
                if self.frame().is_some_and(|frame| frame.video.is_none()) =>
            {
                Some("This frame does not come from a video.")
            }
            C::ShotContent if self.shown_shot().is_none() => Some("No shots are marked."),
            C::Compare if self.current.proposal.is_some() => None,
            C::SwitchRoot if self.current.other_root().is_none() => {
                Some("Only one focal length fits these points.")
            }
            C::Compare if self.current.alternative().is_none() => {
                Some("No other solution fits these points.")
            }
            C::MendNames if self.current.other_names().is_none() => {
                Some("No other names fit these points.")
            }
            C::ShowForBase | C::Snap | C::SearchLines | C::Track
                if self.current.field().is_none() =>
            {
                Some("The field cannot be used: see the camera panel.")
            }
            // Commands of operations; all others are available.
            _ => self.why_not_operation(command),
        }
    }

    /// Whether a document is open and cannot be changed.
    pub(in crate::app) fn is_read_only(&self) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| open.read_only.is_some())
    }

    /// Whether there is something to undo: an open step, or one in the history.
    fn can_undo(&self) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| open.history.is_open() || open.history.next_undo().is_some())
    }

    fn can_redo(&self) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| open.history.next_redo().is_some())
    }

    /// Carries out a command, or shows why it is not available.
    pub(in crate::app) fn command(&mut self, command: Command) {
        use Command as C;
        // Checked here, too: a key starts a command also if its menu entry is disabled.
        if let Some(reason) = self.why_not(command) {
            self.session.note(reason);
            return;
        }
        let named_automatically = self.session.points.named_automatically;
        self.session.forget_placed();
        match command {
            // File.
            C::OpenProject => self.effects.push(Effect::Ask(Question::Project)),
            C::OpenFolder => self.effects.push(Effect::Ask(Question::Folder)),
            C::OpenVideo => self.effects.push(Effect::Ask(Question::Video)),
            C::OpenQueue => self.effects.push(Effect::Ask(Question::Queue)),
            C::NextMatch | C::PreviousMatch => self.open_next_match(command == C::NextMatch),
            C::QueuePanel => self.toggle_setting(|settings| &mut settings.queue_panel),
            C::OpenDemo => {
                self.tour_waits = false;
                self.open_demo();
            }
            C::StartTour => self.start_tour(),
            C::LeaveTour => self.leave_tour(),
            C::Orphans => self.session.dialog = Some(Dialog::Orphans),
            C::Save => self.save(),
            C::SaveAs => self.effects.push(Effect::Ask(Question::CopyTo)),
            C::Export => self.open_transfer(TransferTab::Export),
            C::ExportDataset => self.open_transfer(TransferTab::Dataset),
            C::ShowExported => self.show_exported(),
            C::StopExport => self.stop_transfer(),
            C::Import => self.open_transfer(TransferTab::Import),
            C::LoadCamera => self.effects.push(Effect::Ask(Question::CameraFrom)),
            C::Quit => self.close_requested(),
            // Points of the shown frame.
            C::Undo if self.round().is_some() => self.undo_again(),
            C::Undo => self.undo(true),
            C::Redo => self.undo(false),
            C::DeleteClick => {
                if let Some(click) = self.session.points.selected {
                    self.delete_click(click);
                }
            }
            C::RenameClick => {
                if let Some(click) = self.session.points.selected {
                    self.open_naming(click);
                }
            }
            C::NameNext => self.name_next(),
            C::PlaceOnLine => match &self.session.mode {
                Mode::Naming(naming) => self.list_lines(!naming.lines),
                _ => self.session.points.next_on_line = !self.session.points.next_on_line,
            },
            C::ToggleCheck => {
                let selected = self.session.points.selected;
                let check = selected.and_then(|click| Some(self.frame()?.clicks.get(click)?.check));
                if let (Some(click), Some(check)) = (selected, check) {
                    self.set_check(click, !check);
                }
            }
            C::NextClick => self.step_click(true),
            C::PreviousClick => self.step_click(false),
            C::Cancel => self.cancel(named_automatically),
            // Navigation and shots.
            C::NextFrame => self.step_frame(1),
            C::PreviousFrame => self.step_frame(-1),
            C::NextTenFrames => self.step_frame(10),
            C::PreviousTenFrames => self.step_frame(-10),
            C::NextNeedsMe => self.go_to_next_that_needs_me(true),
            C::PreviousNeedsMe => self.go_to_next_that_needs_me(false),
            C::NextUnanswered => self.go_to_label_next(),
            C::FirstFrame => self.go_to(0),
            C::LastFrame => self.go_to(usize::MAX),
            C::GoToPlace => self.session.dialog = Some(Dialog::GoToPlace),
            C::PlayPause => self.toggle_playing(),
            C::AcceptPlayed => self.accept_played(),
            C::StopAtWrong => self.stop_at_wrong(),
            C::NextShot => self.go_to_shot(true),
            C::PreviousShot => self.go_to_shot(false),
            C::AddCut => self.add_cut(),
            C::MoveCutHere => self.move_cut_here(),
            C::RemoveCut => self.remove_cut(),
            C::ShotContent => self.change_shot_content(),
            C::NextReference | C::PreviousReference => self.go_to_next(
                command == C::NextReference,
                |frame| frame.status == FrameStatus::Reference,
                "There is no other reference yet.",
            ),
            C::AcceptStretch => self.ask_accept_stretch(),
            C::AcceptShot => self.ask_accept_shot(),
            C::Accept if self.stretch_size().is_some() => self.ask_accept_stretch(),
            C::Accept => self.accept(false),
            C::AcceptAndStay => self.accept(true),
            C::AcceptAnyway => self.accept_anyway(),
            C::AcceptAllAbove => self.ask_accept_all(),
            C::DiscardBatch => self.discard_shown_batch(),
            C::RemoveModelPoints => self.remove_points_of_model(),
            C::UseForTraining => self.toggle_use_for_training(),
            C::MarkGold => self.toggle_gold(),
            C::ChooseGold => self.choose_gold(),
            C::ClickAgain => self.click_again(),
            C::SkipAgain => self.skip_again(),
            C::UseOwnNoise => self.use_own_noise(),
            C::UseUsualNoise => self.use_usual_noise(),
            C::Reject => self.ask_reject(false),
            C::RejectShot => self.ask_reject(true),
            C::Comment => {
                let comment = self
                    .frame()
                    .and_then(|frame| frame.comment.clone())
                    .unwrap_or_default();
                self.session.dialog = Some(Dialog::Comment(comment));
            }
            C::MendNames => self.mend_names(),
            C::SwitchRoot => self.switch_root(),
            // View. On the quality page the zoom commands apply to the time axis.
            C::ZoomIn | C::ZoomOut | C::ZoomToFit if self.session.quality.open => {
                self.zoom_time(command);
            }
            C::ZoomIn => self.zoom_by(ZOOM_STEP),
            C::ZoomOut => self.zoom_by(1.0 / ZOOM_STEP),
            C::ZoomToFit => self.session.picture.view = PictureView::Fit,
            C::ZoomToClick => self.zoom_to_click(),
            C::HideOverlay => {
                self.session.picture.held.hide_overlay = !self.session.picture.held.hide_overlay;
            }
            C::Compare => self.session.picture.held.compare = !self.session.picture.held.compare,
            C::OverlayStyle => self.session.dialog = Some(Dialog::OverlayStyle),
            C::PointTool => self.session.picture.tool = Tool::Point,
            C::SelectTool => self.session.picture.tool = Tool::Select,
            C::LineTool => self.session.picture.tool = Tool::Line,
            C::CheckTool => self.session.picture.tool = Tool::Check,
            C::ShowMasks => {
                let is_on = self.session.picture.tool == Tool::Mask;
                self.session.picture.tool = if is_on { Tool::Point } else { Tool::Mask };
            }
            C::ShowFieldMap => self.toggle_setting(|settings| &mut settings.field_map),
            C::ShowCurves => self.toggle_setting(|settings| &mut settings.curves),
            C::SnapPoints => self.toggle_setting(|settings| &mut settings.snap_points),
            C::BaseOnPaint => self.toggle_setting(|settings| &mut settings.base_on_paint),
            C::SnapSuggestions => self.toggle_setting(|settings| &mut settings.snap_suggestions),
            // Panels.
            C::CameraPanel => self.toggle_panel(SidePanel::Camera),
            C::TrainerPanel => self.toggle_panel(SidePanel::Trainer),
            C::PauseTrainer => self.pause_trainer(),
            C::ShowFeatures => self.show_features(),
            C::ReviewPanel => self.toggle_panel(SidePanel::Review),
            C::Gallery => self.toggle_gallery(),
            C::QualityPage => self.toggle_quality(),
            // Cameras and fields.
            C::AssignToCamera => self.ask_camera(),
            C::ConfirmFieldSize => self.confirm_field_size(),
            C::SelectShot => self.select_shot(),
            C::NewCameraFromChange => self.new_camera_from_change(),
            C::ShowForBase => self.show_for_base(),
            C::UseForBase => {
                let used = self.frame().is_some_and(|frame| !frame.use_for_base);
                self.use_for_base(self.session.frame, used);
            }
            C::Uncertainty => {
                self.session.picture.uncertainty = self.session.picture.uncertainty.next();
            }
            // Dialogs and help.
            C::Palette => self.session.dialog = Some(Dialog::Palette),
            C::Keys => self.session.dialog = Some(Dialog::Keys),
            C::Messages => self.session.dialog = Some(Dialog::Messages),
            C::DismissNotices => self.session.messages.notices.clear(),
            C::ChooseSport => self.session.dialog = Some(Dialog::Sport),
            C::PictureLook => self.session.dialog = Some(Dialog::PictureLook),
            C::Preferences => self.session.dialog = Some(Dialog::Preferences),
            C::Guide => self.open_guide(),
            C::About => self.session.dialog = Some(Dialog::About),
            // Commands of operations.
            C::EstimateBase
            | C::FitFieldSize
            | C::UseEstimatedBase
            | C::DropEstimatedBase
            | C::StopSolving
            | C::KeepBurntIn
            | C::ChangeBurntIn
            | C::FindCamera
            | C::StopFindCamera
            | C::FindCameras
            | C::StopFindCameras
            | C::Track
            | C::DiscardTracked
            | C::StopTracking
            | C::AddNewImages
            | C::MendCameras
            | C::StopMending
            | C::TakeLength
            | C::RefineBaseOnShot
            | C::CompareAnnotators
            | C::Snap
            | C::SearchLines
            | C::StopSearch
            | C::FindShots
            | C::StopShotSearch => self.operation_command(command),
        }
    }

    /// Starts (`down`) or ends what a command does while its key is down.
    pub(super) fn hold(&mut self, command: Command, down: bool) {
        match command {
            Command::HideOverlay => self.session.picture.held.hide_overlay = down,
            Command::Snap => self.hold_snap(down),
            Command::Compare => {
                self.session.picture.held.compare = down && self.why_not(command).is_none();
            }
            _ => {}
        }
    }

    /// Carries out Escape: ends one thing, the topmost of dialog, opening of a document, labels
    /// that wait, quality page, estimated base, masks, mode, and at last the selections.
    /// `named_automatically` is the point that was just placed and has named itself: it is taken
    /// back, with what it did to the frame.
    fn cancel(&mut self, named_automatically: Option<usize>) {
        if self.session.dialog.is_some() {
            self.close_dialog();
            return;
        }
        if self.session.disk.opening.take().is_some() {
            self.tour_waits = false;
            self.session.disk.leaving = None;
            self.effects.push(Effect::CancelOpening);
            return;
        }
        if self.open.is_none() && self.waiting_labels.take().is_some() {
            return;
        }
        if self.session.quality.open {
            self.session.quality.open = false;
            return;
        }
        if self.session.mode == Mode::Idle && self.why_not(Command::DropEstimatedBase).is_none() {
            self.drop_estimated_base();
            return;
        }
        let is_idle = self.session.mode == Mode::Idle;
        if is_idle && std::mem::take(&mut self.session.picture.tool) != Tool::Point {
            return;
        }
        match &self.session.mode {
            Mode::Dragging { .. } | Mode::Editing => self.abort(),
            Mode::Naming(naming) => {
                let (click, refines) = (naming.click, naming.refines);
                self.leave_naming();
                // The point keeps the name that it was given automatically and that the user has
                // not confirmed.
                self.session.points.named_automatically = refines.then_some(click);
                // A point without a name was placed by mistake. What the click did to the frame
                // goes with it: an accepted frame is accepted again.
                let unnamed = self.frame().and_then(|frame| frame.clicks.get(click));
                if unnamed.is_some_and(|click| click.target.is_none()) {
                    if self.is_placed_last(click) {
                        self.undo(true);
                    } else {
                        self.delete_click(click);
                    }
                }
            }
            Mode::Placing(_) | Mode::Rejecting { .. } => self.session.mode = Mode::Idle,
            Mode::ClickingAgain(_) => self.end_round(),
            Mode::Idle if named_automatically.is_some_and(|click| self.is_placed_last(click)) => {
                self.undo(true);
            }
            Mode::Idle if self.session.points.next_on_line => {
                self.session.points.next_on_line = false;
            }
            Mode::Idle if self.session.points.selected.is_none() => {
                self.session.frames_selected.clear();
            }
            Mode::Idle => self.session.points.selected = None,
        }
    }

    /// Undoes the last step (`back`) or redoes the next one. If the step belongs to another frame,
    /// only shows that frame; the second press then changes it.
    fn undo(&mut self, back: bool) {
        self.commit_open_step();
        self.session.mode = Mode::Idle;
        let Some(open) = &mut self.open else { return };
        let next = if back {
            open.history.next_undo()
        } else {
            open.history.next_redo()
        };
        let Some(step) = next.cloned() else { return };
        let word = if back { "undo" } else { "redo" };
        // On another frame, the first press only goes there, so that no change happens unseen.
        let position = step
            .frame
            .and_then(|id| open.document.frames.position_of(&id));
        if let Some(position) = position.filter(|position| *position != self.session.frame) {
            self.go_to(position);
            let text = format!(
                "The last change was here: {}. Press again to {word} it.",
                step.name
            );
            self.session.note(text);
            return;
        }
        // The frames' positions may change, so the shown and selected ones are found again by their
        // ids.
        let frames = open.document.frames.clone();
        open.undo(back);
        self.follow_frames(&frames);
        let (title, kind) = if back {
            ("Undone", EditKind::Undone)
        } else {
            ("Redone", EditKind::Redone)
        };
        self.journal(&format!("{title}: {}", step.name), kind);
        self.session.note(format!("{title}: {}.", step.name));
        self.clamp_selection();
    }

    /// Magnifies the picture by a factor around the centre of the canvas. At or below the fitting
    /// scale the whole picture is shown.
    fn zoom_by(&mut self, factor: f64) {
        let Some(size) = self.frame().map(|frame| frame.image_size) else {
            return;
        };
        let (scale, centre) = match self.session.picture.view {
            PictureView::Zoomed { scale, centre } => (scale, centre),
            PictureView::Fit => (self.session.picture.fit_scale, size.centre()),
        };
        // Below the fitting scale there would only be more space around the picture.
        let wanted = scale * factor;
        self.session.picture.view = if wanted <= self.session.picture.fit_scale {
            PictureView::Fit
        } else {
            PictureView::Zoomed {
                scale: wanted.min(MAX_SCALE),
                centre,
            }
        };
    }

    /// Magnifies the picture around the selected click.
    fn zoom_to_click(&mut self) {
        let click = self
            .session
            .points
            .selected
            .and_then(|click| self.frame()?.clicks.get(click));
        if let Some(centre) = click.map(|click| click.image) {
            self.session.picture.view = PictureView::Zoomed {
                scale: POINT_SCALE,
                centre,
            };
        }
    }

    /// Assigns a key to a command, and reports the command that loses it.
    pub(super) fn assign_key(&mut self, command: Command, chord: Chord) {
        let shown = chord.to_string();
        if let Some(loser) = self.settings.keys.assign(command, chord) {
            let text = format!(
                "{shown} is now “{}”; “{}” no longer has a key.",
                command.name(),
                loser.name()
            );
            self.session.note(text);
        }
    }
}
