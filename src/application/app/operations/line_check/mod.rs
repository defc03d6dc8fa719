//! Compares the cameras of all frames with the painted lines of their pictures, in the background
//! between edits. The results are kept beside the document; acceptance of a frame writes its result
//! into the document.

mod checks;
mod summary;

use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::Level;
pub(in crate::app) use checks::LineChecks;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
pub use summary::LineCheckSummary;
use touchline_calibration::calibrate::{check_frame, record_line_check};
use touchline_calibration::proposals::{FramePicture, PictureStream};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::markings::LineVerdict;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FrameId, FrameStatus};
use touchline_vision::paint::LineCheck;

/// Maximum number of frames examined after an action to find those that lack a check, so that
/// actions on a long match stay quick.
const LOOKED_THROUGH: usize = 64;

/// Selected frames that are looked through after each action: a person waits for them.
const SELECTED_LOOKED_THROUGH: usize = 4096;

/// Frames per batch; a batch takes about a second.
const BATCH: usize = 4;

/// If at least this many cameras are contradicted and none is supported, the lines in the pictures
/// are not the field's, and contradictions say nothing about the cameras.
const CONTRADICTED_ALONE: usize = 4;

/// Compares the cameras of a few frames with the painted lines.
pub struct LineCheckBatch {
    document: Document,
    folder: PathBuf,
    frames: Vec<FrameToCheck>,
}

/// A frame of a batch.
struct FrameToCheck {
    index: usize,
    frame: FrameId,
    camera: PtzCamera,
    /// The field that the frame shows.
    field: Arc<FieldModel>,
}

/// The line check of a frame's camera.
#[derive(Clone, Debug)]
pub struct CheckedLines {
    frame: FrameId,
    /// The camera that was checked. The result is valid for this camera only.
    camera: PtzCamera,
    /// The result; none if the picture cannot be read.
    check: Option<LineCheck>,
}

impl Operation for LineCheckBatch {
    type Progress = Infallible;
    type Output = Vec<CheckedLines>;
    type Error = Infallible;

    const NAME: &'static str = "line check";

    fn run(&self, context: &Context<'_, Infallible>) -> Result<Vec<CheckedLines>, Infallible> {
        let at = self.document.at(&self.folder);
        let mut reader = context.open_reader();
        let pictures = PictureStream::new(at, self.frames.iter().map(|to_check| to_check.index))
            .with_reader(&mut *reader)
            .with_progress(Progress::new(|_| context.check()));
        let mut checked = Vec::with_capacity(self.frames.len());
        // The stream gives one item for each index, in their order, so that the two fit.
        for (to_check, FramePicture { frame, picture, .. }) in self.frames.iter().zip(pictures) {
            let field = &to_check.field;
            let seen = picture.ok();
            let check = seen.and_then(|picture| check_frame(at.document, frame, field, &picture));
            checked.push(CheckedLines {
                frame: to_check.frame.clone(),
                camera: to_check.camera,
                check,
            });
        }
        Ok(checked)
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.line_checks.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Vec<CheckedLines>, Failure<Infallible>>) {
        let found = result.unwrap_or_else(|failure| {
            app.session.notify(Level::Error, failure.to_string());
            Vec::new()
        });
        let checks = &mut app.operations.line_checks;
        // Frames without a result are kept too, so that they are not checked again until their
        // camera changes.
        for FrameToCheck { frame, camera, .. } in &self.frames {
            checks.keep(CheckedLines {
                frame: frame.clone(),
                camera: *camera,
                check: None,
            });
        }
        let ids: Vec<FrameId> = found.iter().map(|checked| checked.frame.clone()).collect();
        for checked in found {
            checks.keep(checked);
        }
        app.report_accepted_off_paint(&ids);
    }
}

impl App {
    /// The line check of a frame's camera, if it is known.
    #[must_use]
    pub fn paint_says(&self, frame: usize) -> Option<LineCheckSummary> {
        let open = self.open.as_ref()?;
        self.operations
            .line_checks
            .frame_result(open, open.frame(frame)?)
    }

    /// Whether the line check contradicts a frame's camera.
    #[must_use]
    pub fn is_contradicted(&self, frame: usize) -> bool {
        self.paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts)
    }

    /// What the painted lines of a frame's own picture say about its camera, where that is known.
    ///
    /// [`Self::paint_says`] leaves the verdict open where the lines contradict every camera of the
    /// document, because such lines may be those of another sport. Before a camera is accepted the
    /// picture itself counts.
    #[must_use]
    pub fn own_paint_says(&self, frame: usize) -> Option<LineCheckSummary> {
        let open = self.open.as_ref()?;
        let frame = open.frame(frame)?;
        self.operations.line_checks.picture_result(open, frame)
    }

    /// Whether accepting a frame needs a confirmation because the paint in its picture lies
    /// elsewhere. If lines contradict every camera, a confirmation is needed until a person has
    /// accepted one of them.
    pub(in crate::app) fn paint_forbids(&self, frame: usize) -> bool {
        let is_off = self
            .own_paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts);
        is_off && (self.is_contradicted(frame) || !self.has_accepted_off_paint())
    }

    fn has_accepted_off_paint(&self) -> bool {
        let Some(open) = &self.open else { return false };
        let mut frames = open.document.frames.iter();
        frames.any(|frame| frame.evidence_against_acceptance().is_some())
    }

    /// Remembers a frame that is accepted before its paint was checked. If the paint contradicts
    /// it, the user is informed later.
    pub(in crate::app) fn accept_before_check(&mut self, frame: usize) {
        if self.own_paint_says(frame).is_some() {
            return;
        }
        let Some(frame) = self.open.as_ref().and_then(|open| open.frame(frame)) else {
            return;
        };
        let id = frame.id.clone();
        self.operations.line_checks.accepted_unchecked.insert(id);
    }

    /// Says which of the frames that were accepted before their paint was looked at it contradicts.
    fn report_accepted_off_paint(&mut self, checked: &[FrameId]) {
        for id in checked {
            if !self.operations.line_checks.accepted_unchecked.remove(id) {
                continue;
            }
            let Some(open) = &self.open else { return };
            let Some(place) = open.document.frames.position_of(id) else {
                continue;
            };
            let is_reference = open
                .frame(place)
                .is_some_and(|frame| frame.status == FrameStatus::Reference);
            if is_reference && self.paint_forbids(place) {
                let number = open.frame_number(place);
                let text = format!(
                    "Frame {number} was accepted before its painted lines were checked: they lie \
                     elsewhere in the picture. Look at it again."
                );
                self.session.notify(Level::Warning, text);
            }
        }
    }

    /// Starts the next batch of checks, if any frame lacks one and no step of undo is open. A
    /// running batch is not replaced; the next one starts when it has ended.
    pub(in crate::app) fn check_lines(&mut self) {
        let Some(open) = self.open.as_mut().filter(|open| !open.history.is_open()) else {
            return;
        };
        let checks = &mut self.operations.line_checks;
        checks.follow_fields(&open.document);
        if checks.slot.is_running() {
            return;
        }
        let selected = &self.session.frames_selected;
        let frames = checks.next(open, self.session.frame, selected);
        if frames.is_empty() {
            return;
        }
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(LineCheckBatch {
            document,
            folder,
            frames,
        });
    }

    /// Writes what the paint says about a frame's camera into its solution, within a step.
    pub(in crate::app) fn record_paint_of(&mut self, place: usize) {
        let Some(open) = &mut self.open else { return };
        let Some(frame) = open.frame(place) else {
            return;
        };
        let Some(check) = self.operations.line_checks.fresh(open, frame) else {
            return;
        };
        if let Some(frame) = open.document.frames.get_mut(place) {
            record_line_check(frame, &check);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{
        Action, Command, DiskReport, EditAction, Effect, Navigation, Opened, Settings,
    };
    use std::collections::BTreeSet;
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz};
    use touchline_core::field::builtin;
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
    use touchline_documents::document::{
        Camera, FieldSpec, Frame, FramePtz, Solution, SolutionSource,
    };

    fn camera() -> PtzCamera {
        let base = CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            ImagePoint::new(960.0, 540.0),
        );
        PtzCamera::new(base, Ptz::from_degrees(0.0, -12.0, 2000.0))
    }

    /// What the paint says about a frame: 0 contradicts its camera, 1 supports it.
    fn line_check_of(frame: FrameId, score: f64) -> CheckedLines {
        let check = LineCheck {
            score,
            predicted: 200,
            found: 100,
            bare: 100,
            offset_px: 1.0,
            bias_px: 0.0,
            halves_px: 0.5,
            unexplained: None,
            emptiest: None,
            agreement: score,
        };
        CheckedLines {
            frame,
            camera: camera(),
            check: Some(check),
        }
    }

    fn checked(frame: usize, score: f64) -> CheckedLines {
        line_check_of(FrameId::from(frame.to_string().as_str()), score)
    }

    /// An application with imported cameras; nothing is known of their paint.
    fn imported(frames: usize) -> App {
        let size = ImageSize::new(1920, 1080);
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut of_document = Camera::new("main".into(), size);
        of_document.set_base(camera().base());
        document.cameras.push(of_document.into());
        for index in 0..frames {
            let mut frame = Frame::from_image(&format!("{index}.jpg"), "main".into(), size);
            frame.ptz = Some(FramePtz::new(camera().ptz(), None));
            frame.status = FrameStatus::Draft;
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Import),
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        App::with_document(document)
    }

    /// The background check comes back with what the paint says about some frames.
    fn report(app: &mut App, places: std::ops::Range<usize>, score: f64) {
        let document = app.open().unwrap().document.clone();
        let found = places
            .map(|place| {
                let frame = &document.frames[place];
                CheckedLines {
                    camera: document.ptz_camera(frame).unwrap(),
                    ..line_check_of(frame.id.clone(), score)
                }
            })
            .collect();
        let batch = LineCheckBatch {
            document: document.clone(),
            folder: PathBuf::new(),
            frames: Vec::new(),
        };
        batch.take_over(app, Ok(found));
    }

    fn status(app: &App, frame: usize) -> FrameStatus {
        app.open().unwrap().frame(frame).unwrap().status
    }

    #[test]
    fn if_every_camera_is_contradicted_a_person_must_confirm_until_one_is_accepted() {
        let mut app = imported(CONTRADICTED_ALONE + 1);
        report(&mut app, 0..CONTRADICTED_ALONE + 1, 0.0);
        assert!(
            !app.is_contradicted(0),
            "they may be lines of another sport"
        );
        app.update(Action::Command(Command::AcceptAndStay));
        assert_eq!(status(&app, 0), FrameStatus::Draft);
        assert!(app.session.offers(Command::AcceptAnyway));
        app.update(Action::Command(Command::AcceptAnyway));
        assert_eq!(status(&app, 0), FrameStatus::Reference);
        app.update(Action::Navigate(Navigation::GoTo(1)));
        app.update(Action::Command(Command::AcceptAndStay));
        assert_eq!(
            status(&app, 1),
            FrameStatus::Reference,
            "no second question"
        );
    }

    #[test]
    fn a_frame_accepted_before_its_check_is_named_when_the_paint_contradicts_it() {
        let mut app = imported(3);
        for frame in 0..2 {
            app.update(Action::Navigate(Navigation::GoTo(frame)));
            app.update(Action::Command(Command::AcceptAndStay));
            assert_eq!(status(&app, frame), FrameStatus::Reference);
        }
        report(&mut app, 1..3, 1.0);
        let warnings = |app: &App| -> Vec<String> {
            let notices = app.session.messages.notices.iter();
            notices
                .filter(|notice| notice.level == Level::Warning)
                .map(|notice| notice.text.clone())
                .collect()
        };
        assert_eq!(warnings(&app), [""; 0]);
        report(&mut app, 0..1, 0.0);
        assert_eq!(
            warnings(&app),
            [
                "Frame 0 was accepted before its painted lines were checked: they lie elsewhere in \
              the picture. Look at it again."
            ]
        );
    }

    /// Whether an action starts a check.
    fn starts_check(app: &mut App, action: Action) -> bool {
        let effects = app.update(action);
        let mut started = effects.iter().filter_map(|effect| match effect {
            Effect::Start(job) => Some(job.name()),
            _ => None,
        });
        started.any(|name| name == LineCheckBatch::NAME)
    }

    #[test]
    fn a_frame_is_checked_as_soon_as_its_field_has_been_read() {
        let mut document = imported(1).open().unwrap().document.clone();
        document.field = FieldSpec::new("own.json");
        let opened = Opened::new(document, "/match/project.json");
        let mut app = App::new(Settings::default());
        assert!(!starts_check(&mut app, Action::Opened(Box::new(opened))));
        let read = DiskReport::TemplateRead {
            of: "/match/project.json".into(),
            name: "own.json".to_owned(),
            template: Ok(Box::new(builtin("soccer").unwrap().clone())),
        };
        assert!(starts_check(&mut app, Action::Disk(read)));
    }

    #[test]
    fn a_check_holds_for_the_field_with_which_it_was_made() {
        let mut app = imported(1);
        report(&mut app, 0..1, 0.0);
        assert!(app.own_paint_says(0).is_some());
        let mut spec = app.shown_field_spec().unwrap().clone();
        spec.params.insert("length_m".to_owned(), 100.0);
        let change = Action::Edit(EditAction::Field(spec));
        assert!(starts_check(&mut app, change));
        assert_eq!(app.own_paint_says(0), None);
    }

    #[test]
    fn the_selected_frames_are_checked_before_the_others() {
        let mut app = imported(200);
        report(&mut app, 0..1, 1.0);
        let open = app.open.as_mut().unwrap();
        let selected = BTreeSet::from([120, 121, 150, 160, 170]);
        let next = app.operations.line_checks.next(open, 0, &selected);
        let places: Vec<usize> = next.iter().map(|to_check| to_check.index).collect();
        assert_eq!(places, [120, 121, 150, 160]);
    }

    #[test]
    fn lines_that_contradict_every_camera_are_ignored_until_one_is_supported() {
        let mut checks = LineChecks::default();
        for frame in 0..CONTRADICTED_ALONE {
            assert!(checks.is_informative(), "{frame}");
            checks.keep(checked(frame, 0.0));
        }
        assert!(!checks.is_informative());
        checks.keep(checked(0, 0.0));
        assert!(!checks.is_informative(), "the same frame again");
        checks.keep(checked(1, 1.0));
        assert!(
            checks.is_informative()
                && (checks.contradicted, checks.supported) == (CONTRADICTED_ALONE - 1, 1)
        );
        checks.keep(CheckedLines {
            check: None,
            ..checked(1, 1.0)
        });
        assert_eq!(
            (checks.contradicted, checks.supported),
            (CONTRADICTED_ALONE - 1, 0)
        );
    }
}
