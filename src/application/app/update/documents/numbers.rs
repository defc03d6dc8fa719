//! Edits of numbers: pan, tilt, focal length, cameras and fields.
//!
//! While the user drags a number, many edits form one step of undo: [`App::begin_edit`] opens it
//! and [`App::end_edit`] closes it. An edit outside of such a step is a step of its own. During the
//! step only the shown frame is solved again; all other frames follow at its end.

use crate::app::update::{App, solve_in_place};
use crate::app::window_state::session::{Level, Mode};
use crate::app::{Command, OpenProject};
use touchline_calibration::calibrate::{BulkChange, is_by_clicks};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_documents::document::{
    Camera, CameraId, FieldSize, FieldSpec, FramePtz, FrameStatus, Solution, SolutionSource, Step,
};

impl App {
    /// Opens a step of undo for a series of edits.
    pub(in crate::app::update) fn begin_edit(&mut self, name: &'static str) {
        if self.begin(name) {
            self.session.mode = Mode::Editing;
        }
    }

    /// Makes an edit within the present series, or as a step of its own if there is none. Returns
    /// false, with a message, if the edit cannot be made now.
    fn within_edit(&mut self, step: Step, change: impl FnOnce(&mut Self)) -> bool {
        if self.session.mode == Mode::Editing {
            change(self);
            return true;
        }
        if !self.begin_step(step) {
            return false;
        }
        change(self);
        self.session.mode = Mode::Editing;
        self.end_edit()
    }

    /// Sets pan, tilt and focal length of the shown frame by hand.
    pub(in crate::app::update) fn edit_ptz(&mut self, ptz: Ptz) {
        if !ptz.is_finite() {
            return;
        }
        let step = self.step_at("Set numbers manually", self.session.frame);
        self.within_edit(step, |app| {
            let base = app.current.base;
            let Some(frame) = app.frame_mut() else { return };
            // A lens that varies with the focal length is evaluated at the new focal length. Any
            // other lens stays.
            let lens = match (base, &frame.ptz) {
                (Some(base), _) if base.distortion.slope_per_px() != 0.0 => {
                    Some(PtzCamera::new(base, ptz).lens())
                }
                (_, Some(before)) => before.lens(),
                _ => None,
            };
            frame.keep_imported();
            let extra = frame.ptz.take().map(|ptz| ptz.extra).unwrap_or_default();
            frame.ptz = Some(FramePtz {
                extra,
                ..FramePtz::new(ptz, lens)
            });
            // As after a solve, what other programs stated stays.
            let Solution {
                extra, imported, ..
            } = frame.solution.take().unwrap_or_default();
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Manual),
                imported,
                extra,
                ..Solution::default()
            });
            if frame.status != FrameStatus::Rejected {
                frame.status = FrameStatus::Draft;
            }
        });
    }

    /// Changes a camera. Returns false, with a message, if that is impossible now.
    pub(in crate::app::update) fn edit_camera(&mut self, camera: Camera) -> bool {
        if camera.position_m.is_some() != camera.base_from_world.is_some()
            && self.session.mode != Mode::Editing
        {
            self.session
                .note("A base needs both a position and a rotation.");
        }
        let step = Step::on_document("Change camera");
        self.within_edit(step, |app| {
            let Some(open) = &mut app.open else { return };
            if let Some(known) = open.document.camera_mut(&camera.id) {
                *known = camera;
            }
            // The shown frame is solved at once, so that its lines follow the number; the others
            // when the edit ends.
            solve_if_by_clicks(open, app.session.frame);
        })
    }

    /// Changes the field of the shown frame: its camera's own, or the document's. Returns false,
    /// with a message, if that is impossible now.
    pub(in crate::app::update) fn edit_field(&mut self, field: FieldSpec) -> bool {
        self.within_edit(Step::on_document("Change field"), |app| {
            let shown = app.session.frame;
            let Some(open) = &mut app.open else { return };
            let camera = open.frame(shown).map(|frame| frame.camera.clone());
            open.document.state_field(camera.as_ref(), field);
            solve_if_by_clicks(open, shown);
        })
    }

    /// Ends a series of edits: [`Self::commit_edits`].
    pub(in crate::app::update) fn end_edit(&mut self) -> bool {
        if self.session.mode != Mode::Editing {
            return true;
        }
        self.session.mode = Mode::Idle;
        self.commit_edits()
    }

    /// Commits the open step. If a camera or the field changed in it, solves all frames from clicks
    /// again. Returns false, with a message, if that is impossible now; the step is then undone.
    pub(in crate::app::update) fn commit_edits(&mut self) -> bool {
        // `history.before` is the document at the beginning of the step.
        let changed = self.open.as_ref().and_then(|open| {
            let before = open.history.before()?;
            let same_field = before.field.is_same_field(&open.document.field);
            (before.cameras != open.document.cameras || !same_field).then(|| open.document.clone())
        });
        let step = self
            .open
            .as_ref()
            .and_then(|open| open.history.open_step().cloned());
        if let (Some(numbers), Some(step)) = (changed, step) {
            // The step is aborted and made again as a bulk change, which starts from the document
            // before the edit: the new solution of the shown frame is a part of it.
            self.abort();
            self.change_in_bulk(step, BulkChange::Numbers(Box::new(numbers)), |_, _| ())
        } else {
            self.commit();
            true
        }
    }

    /// Confirms the size of the shown frame's field; one step of undo.
    pub(in crate::app::update) fn confirm_field_size(&mut self) {
        let Some(spec) = self.shown_field_spec().cloned() else {
            return;
        };
        if spec.assumed_size().is_none()
            || !self.begin_step(Step::on_document("Confirm field size"))
        {
            return;
        }
        self.session.mode = Mode::Editing;
        self.edit_field(FieldSpec {
            size: Some(FieldSize::Confirmed),
            ..spec
        });
        if self.end_edit() {
            self.session.retract(Command::ConfirmFieldSize);
        }
    }

    /// The specification of the shown frame's field, or the document's if there is no frame.
    pub fn shown_field_spec(&self) -> Option<&FieldSpec> {
        let open = self.open.as_ref()?;
        Some(
            self.frame()
                .map_or(&open.document.field, |frame| open.document.field_of(frame)),
        )
    }

    /// Reports that the size of the field is assumed, if it is, with a button to confirm it.
    pub(in crate::app) fn report_assumed_size(&mut self) {
        if let Some(text) = self
            .shown_field_spec()
            .and_then(FieldSpec::describe_assumed_size)
        {
            self.session
                .notify_with(Level::Info, text, [("Confirm", Command::ConfirmFieldSize)]);
        }
    }

    /// Solves the shown frame from its clicks again, in place of numbers set by hand.
    pub(in crate::app::update) fn solve_again(&mut self) {
        if self.begin("Solve again") {
            if let Some(frame) = self.frame_mut() {
                frame.solution = None;
            }
            self.clicks_changed();
            self.commit();
        }
    }

    /// Uses the other focal length that fits two clicks.
    pub(in crate::app::update) fn switch_root(&mut self) {
        let Some(other) = self.current.other_root() else {
            self.session
                .note("Only one focal length fits these points.");
            return;
        };
        self.edit_ptz(other);
    }

    /// Copies the base of another document's camera to the shown frame's camera, and solves its
    /// frames with it.
    pub(in crate::app::update) fn camera_loaded(&mut self, loaded: &Camera) {
        let Some(known) = self.frame().map(|frame| frame.camera.clone()) else {
            return;
        };
        let Some(camera) = self
            .open
            .as_ref()
            .and_then(|open| open.document.camera(&known))
        else {
            return;
        };
        let Some(adopted) = adopt(camera, loaded) else {
            self.session
                .warn(format!("Camera {:?} has no base.", loaded.id.as_str()));
            return;
        };
        if self.edit_camera(adopted) {
            self.session
                .note(format!("Camera base loaded from {:?}.", loaded.id.as_str()));
        }
    }

    /// The camera of the shown frame.
    pub fn camera_id(&self) -> Option<&CameraId> {
        self.frame().map(|frame| &frame.camera)
    }
}

/// A copy of `camera` with the base of `loaded`. Numbers in px are scaled if the pictures differ in
/// size. Masks are copied if the sizes are equal and the camera has none.
fn adopt(camera: &Camera, loaded: &Camera) -> Option<Camera> {
    let mut base = loaded.base()?;
    let scale = f64::from(camera.image_size.width) / f64::from(loaded.image_size.width.max(1));
    if camera.image_size != loaded.image_size {
        // The principal point keeps its offset from the centre, also where the pictures have other
        // proportions: they are cut off or padded on both sides alike.
        let (from, to) = (loaded.image_size.centre(), camera.image_size.centre());
        base.principal_point.x = to.x + scale * (base.principal_point.x - from.x);
        base.principal_point.y = to.y + scale * (base.principal_point.y - from.y);
        // k₁ per 1000 px of focal length: pixels are in the denominator. The 1-σ of a number scales
        // as the number itself.
        base.sigma.principal_point_px *= scale;
        base.distortion.at_focal_px *= scale;
        base.distortion.per_1000_px /= scale;
        base.sigma.k1_per_1000_px /= scale;
    }
    let mut adopted = camera.clone();
    adopted.set_base(&base);
    let unmasked = adopted.masks.is_empty() && adopted.ranged_masks.is_empty();
    if unmasked && camera.image_size == loaded.image_size {
        adopted.masks.clone_from(&loaded.masks);
        adopted.ranged_masks.clone_from(&loaded.ranged_masks);
    }
    Some(adopted)
}

/// Solves a frame again if its camera comes from clicks, or would if there were a base.
fn solve_if_by_clicks(open: &mut OpenProject, index: usize) {
    if open.frame(index).is_some_and(is_by_clicks) {
        solve_in_place(open, index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::operation::Report;
    use crate::app::operations::transfer::{TransferWrite, Written};
    use crate::app::{Action, DiskReport, EditAction, Effect, Opened, Question};
    use touchline_core::camera::{BaseAngles, CameraBase};
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
    use touchline_core::testing::{SIZE, TestBase, base_at, soccer};
    use touchline_documents::document::Click;
    use touchline_documents::testing::{WithFrames, new_frame, soccer_document};

    fn app(own_field: bool) -> App {
        let mut document = soccer_document();
        let mut camera = Camera::new("main".into(), SIZE);
        camera.field = own_field.then(|| FieldSpec::new("basketball_fiba"));
        document.cameras.push(camera.into());
        App::with_document(document.with_pictures(["a.jpg"], SIZE))
    }

    /// A camera of another document, with a base.
    fn loaded_camera() -> Camera {
        let mut base = base_at([0.0, -60.0, 15.0], ImagePoint::new(970.0, 530.0));
        base.distortion.at_focal_px = 2000.0;
        base.distortion.per_1000_px = 0.2;
        base.sigma.principal_point_px = Vec2::new(8.0, 4.0);
        base.sigma.k1_per_1000_px = 0.03;
        let mut loaded = Camera::new("other".into(), ImageSize::new(1920, 1080));
        loaded.set_base(&base);
        loaded
    }

    #[test]
    fn the_size_of_the_shown_field_is_confirmed_in_one_step() {
        for own_field in [false, true] {
            let mut app = app(own_field);
            let effects = app.update(Action::Answer(Question::DatasetTo, "/match/set".into()));
            let job = effects.into_iter().find_map(|effect| match effect {
                Effect::Start(job) => job.operation::<TransferWrite>().is_some().then_some(job),
                _ => None,
            });
            let written = {
                let (says, to) = ("written".to_owned(), "/elsewhere/match.json".into());
                Report::from_result::<TransferWrite>(job.unwrap().id(), Ok(Written { says, to }))
            };
            app.update(Action::Report(written));
            let offers = |app: &App| {
                app.session
                    .messages
                    .notices
                    .iter()
                    .filter(|notice| notice.offers(Command::ConfirmFieldSize))
                    .count()
            };
            assert_eq!(offers(&app), 1, "{:?}", app.session.messages.notices);
            app.update(Action::Command(Command::ConfirmFieldSize));
            assert_eq!(
                (app.shown_field_spec().unwrap().assumed_size(), offers(&app)),
                (None, 0)
            );
            assert!(app.why_not(Command::ConfirmFieldSize).is_some());
            let document = &app.open().unwrap().document;
            assert_eq!(
                document.field.size.is_none(),
                own_field,
                "only the field that is shown"
            );
            app.update(Action::Command(Command::Undo));
            assert!(app.shown_field_spec().unwrap().assumed_size().is_some());
        }
    }

    #[test]
    fn a_base_for_pictures_of_half_the_size_keeps_its_relative_errors() {
        let camera = Camera::new("main".into(), ImageSize::new(960, 540));
        let adopted = adopt(&camera, &loaded_camera()).unwrap().base().unwrap();
        assert_eq!(adopted.principal_point, ImagePoint::new(485.0, 265.0));
        assert_eq!(adopted.sigma.principal_point_px, Vec2::new(4.0, 2.0));
        assert_eq!(
            (adopted.distortion.per_1000_px, adopted.sigma.k1_per_1000_px),
            (0.4, 0.06)
        );
    }

    #[test]
    fn in_pictures_of_other_proportions_the_principal_point_stays_at_the_centre() {
        let camera = Camera::new("main".into(), ImageSize::new(960, 720));
        let adopted = adopt(&camera, &loaded_camera()).unwrap().base().unwrap();
        assert_eq!(adopted.principal_point, ImagePoint::new(485.0, 355.0));
    }

    #[test]
    fn whatever_ends_an_edit_of_a_camera_all_its_frames_are_solved_again() {
        let size = ImageSize::new(1280, 720);
        let level = BaseAngles::default().base_from_world();
        let base = CameraBase::new(Vec3::new(0.0, -60.0, 18.0), level, size.centre());
        let pointed = base.aim(0.0, -12.0, 1000.0);
        let field = soccer();
        let mut document = soccer_document();
        let mut camera = Camera::new("main".into(), size);
        camera.set_base(&base);
        document.cameras.push(camera.clone().into());
        for name in ["a.jpg", "b.jpg"] {
            let mut frame = new_frame(name, size);
            for id in ["centre_mark", "halfway_far"] {
                let world = field.landmark_in_world(field.landmark(id).unwrap());
                let at = pointed.image_from_world(world).unwrap();
                frame.clicks.push(Click::landmark(id.into(), at));
            }
            document.frames.push(frame.into());
        }
        let mut app = App::with_document(document);
        app.update(Action::Edit(EditAction::Begin("Change camera")));
        let farther = Vec3::new(0.0, -70.0, 18.0);
        camera.set_base(&CameraBase::new(farther, level, size.centre()));
        app.update(Action::Edit(EditAction::Camera(Box::new(camera))));
        app.update(Action::Command(Command::Save));
        assert_eq!(app.session.mode, Mode::Idle);
        let frames = app.open().unwrap().document.frames.iter();
        let focal_px: Vec<f64> = frames
            .map(|frame| frame.ptz.as_ref().unwrap().focal_px)
            .collect();
        assert!(focal_px[1] > 1050.0, "{focal_px:?}");
        assert!((focal_px[0] - focal_px[1]).abs() < 1e-6, "{focal_px:?}");
        app.update(Action::Command(Command::Undo));
        let base_now = app.open().unwrap().document.cameras[0].base().unwrap();
        assert_eq!(base_now.position_m, base.position_m);
    }

    #[test]
    fn numbers_set_by_hand_leave_what_other_programs_stated() {
        let mut document = (*app(false).open().unwrap().document).clone();
        let mut solution = Solution::default();
        solution.extra.insert("reviewer".to_owned(), "b".into());
        document.frames[0].solution = Some(solution);
        let mut app = App::with_document(document);
        let ptz = Ptz::from_degrees(1.0, -9.0, 2000.0);
        app.update(Action::Edit(EditAction::Ptz(ptz)));
        let solution = app.frame().unwrap().solution.clone().unwrap();
        assert_eq!(solution.source, Some(SolutionSource::Manual));
        assert!(solution.extra.contains_key("reviewer"));
    }

    #[test]
    fn no_camera_is_said_to_be_loaded_into_a_read_only_document() {
        for read_only in [false, true] {
            let mut app = app(false);
            let document = (*app.open().unwrap().document).clone();
            let mut opened = Opened::new(document, "/match/project.json");
            opened.read_only = read_only.then(|| "locked".to_owned());
            app.update(Action::Opened(Box::new(opened)));
            let report = DiskReport::CameraLoaded(Box::new(loaded_camera()));
            app.update(Action::Disk(report));
            let notices = &app.session.messages.notices;
            let is_said = notices
                .iter()
                .any(|notice| notice.text.starts_with("Camera base loaded"));
            assert_ne!(is_said, read_only, "{notices:?}");
        }
    }

    #[test]
    fn a_number_changes_the_field_that_the_camera_looks_at() {
        let mut app = app(true);
        let mut spec = app.shown_field_spec().unwrap().clone();
        spec.params.insert("length_m".to_owned(), 26.0);
        app.update(Action::Edit(EditAction::Field(spec.clone())));
        let document = &app.open().unwrap().document;
        assert_eq!(
            (
                document.cameras[0].field.as_ref(),
                document.field.params.len()
            ),
            (Some(&spec), 0)
        );
    }
}
