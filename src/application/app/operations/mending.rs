//! Mending the cameras that another program gave for the frames of a video: one step of undo, whose
//! cameras are one batch of suggestions.

use crate::app::operation::{AsItWas, Context, Failure, Operation, Slot};
use crate::app::operations::{OperationStep, UnderWay};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::path::PathBuf;
use touchline_calibration::pipelines::{MendError, MendEvent, MendOptions, Mended, Tally, mend};
use touchline_core::geometry::pluralise;
use touchline_documents::document::Document;

/// Fewer cameras have no place in common.
const MIN_CAMERAS: usize = 3;

/// The name of the step of undo, and of its batch of suggestions.
const STEP: &str = "Mend the imported cameras";

/// Mends the imported cameras of a document.
pub struct Mending {
    document: Document,
    /// The folder from which the document's relative paths start.
    folder: PathBuf,
    options: MendOptions,
}

/// The mended document, and what became of each camera.
#[derive(Clone)]
pub struct MendedDocument {
    document: Document,
    mended: Mended,
}

/// The mending under way.
#[derive(Debug, Default)]
pub(in crate::app) struct MendingState {
    slot: Slot<Mending>,
    /// The options for the cameras that were imported last.
    pub(super) options: MendOptions,
}

// ---- The work ----

impl Operation for Mending {
    type Progress = OperationStep;
    type Output = MendedDocument;
    type Error = MendError;

    const NAME: &'static str = "mend cameras";

    fn run(&self, context: &Context<'_, OperationStep>) -> Result<MendedDocument, MendError> {
        let mut reader = context.open_reader();
        let mut document = self.document.clone();
        let steps = context.progress();
        let progress = steps.part(|event: MendEvent| step_of(&event));
        let mended = mend(
            &mut document,
            &self.folder,
            &mut *reader,
            &self.options,
            &progress,
        )?;
        Ok(MendedDocument { document, mended })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.mending.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(&self, app: &mut App, result: Result<MendedDocument, Failure<MendError>>) {
        match result {
            Ok(mended) => app.take_mended(self, mended),
            Err(failure) => {
                let text = format!("The cameras were not mended: {failure}.");
                app.session.notify(failure.level(), text);
            }
        }
    }
}

fn step_of(event: &MendEvent) -> OperationStep {
    let (step, share) = match event {
        MendEvent::Cuts(done) => ("Looking for cuts", Some(done)),
        MendEvent::Sampling(done) => ("Comparing a sample with the painted lines", Some(done)),
        MendEvent::Aligning(_, done) => ("Aligning all frames to the painted lines", Some(done)),
        MendEvent::Checking(done) => ("Checking doubtful frames", Some(done)),
        MendEvent::Places(_) => ("Comparing a sample with the painted lines", None),
        MendEvent::Tracking(_) => ("Tracking the frames that do not fit", None),
    };
    OperationStep::new(step, share.map(|share| share.fraction()))
}

// ---- In the application ----

impl App {
    /// Why a command of the mending is not available; none if it is.
    pub(in crate::app) fn why_not_mending(&self, command: Command) -> Option<&'static str> {
        let is_running = self.operations.mending.slot.is_running();
        if command == Command::StopMending {
            return (!is_running).then_some("No cameras are being mended.");
        }
        let open = self.open.as_ref()?;
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot follow points.");
        }
        if is_running {
            return Some("The cameras are being mended already.");
        }
        let few = open.counts().imported < MIN_CAMERAS;
        few.then_some("Too few frames have imported cameras: 3 or more are needed.")
    }

    /// Carries out a command of the mending.
    pub(in crate::app) fn mending_command(&mut self, command: Command) {
        match command {
            Command::MendCameras => self.mend_cameras(),
            Command::StopMending if self.operations.mending.slot.cancel() => {
                let text = "Mending was stopped; nothing was changed.";
                self.session.note(text);
            }
            _ => {}
        }
    }

    fn mend_cameras(&mut self) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let options = self.operations.mending.options.clone();
        self.session.retract(Command::MendCameras);
        self.start(Mending {
            document,
            folder,
            options,
        });
    }

    /// Takes over mended cameras as one step of undo.
    fn take_mended(
        &mut self,
        mending: &Mending,
        MendedDocument { document, mended }: MendedDocument,
    ) {
        let Some(open) = &self.open else { return };
        let (then, now) = (&mending.document, &open.document);
        let Some(merged) = (AsItWas { then, now }).join(&document, AsItWas::position_if_unchanged)
        else {
            let text = "A camera or the field changed in the meantime; the mended cameras were \
                        discarded.";
            self.session
                .notify_with(Level::Info, text, [("Mend again", Command::MendCameras)]);
            return;
        };
        if !self.take_joined(STEP, merged) {
            return;
        }
        let tally = mended.tally();
        let level = if tally.left > 0 {
            Level::Warning
        } else {
            Level::Info
        };
        let offers = [("Review", Command::ReviewPanel), ("Undo", Command::Undo)];
        self.session
            .notify_with(level, describe_mended(&mended, &tally), offers);
    }
}

// ---- Words ----

impl MendingState {
    /// Whether cameras are being mended.
    pub(super) const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// The mending under way, with how far it has come.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let job = "Mending the imported cameras";
        let running = self.slot.running()?;
        Some(UnderWay::from_running(running, job, Command::StopMending))
    }
}

/// What became of the cameras, in a few sentences.
fn describe_mended(mended: &Mended, tally: &Tally) -> String {
    let mut text = format!(
        "{}: {} impossible, {} mirrored. {} as they came, {} mended on the painted lines, {} by \
         their neighbours, {} left for you.",
        pluralise(tally.came, "camera"),
        tally.impossible,
        tally.mirrored,
        tally.as_they_came,
        tally.aligned,
        tally.tracked,
        tally.left
    );
    let common = mended.common.iter().map(ToString::to_string);
    let not_aligned = mended.not_aligned.iter().map(ToString::to_string);
    for remark in common.chain(not_aligned) {
        text += " Also, ";
        text += &remark;
        text.push('.');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, Navigation};
    use touchline_calibration::pipelines::{GivenCamera, MendedFrame, Outcome};
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::base_at;
    use touchline_documents::document::{
        Camera, CameraId, Clip, Frame, FrameStatus, SolutionSource,
    };
    use touchline_documents::testing::{answered_by, ptz_at, soccer_document, solved_by};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// An application with four frames that have an imported camera each, and the same document
    /// with one camera for all of them.
    fn app() -> (App, Document) {
        let mut document = soccer_document();
        for index in 0..4 {
            let id = CameraId::from(format!("main-{index}").as_str());
            let mut camera = Camera::new(id.clone(), SIZE);
            camera.set_base(&base_at([0.1 * f64::from(index), -62.0, 17.0], SIZE));
            document.cameras.push(camera.into());
            let mut frame = Frame::from_image(&format!("{index}.jpg"), id, SIZE);
            frame.ptz = ptz_at(1.0, -12.0, 1800.0);
            frame.status = FrameStatus::Suggested;
            frame.solution = solved_by(SolutionSource::Import);
            document.frames.push(frame.into());
        }
        let app = App::with_document(document.clone());
        let mut mended = document;
        mended.cameras.truncate(1);
        let mut base = mended.cameras[0].base().unwrap();
        base.position_m.x = 0.15;
        mended.cameras[0].set_base(&base);
        for index in 0..4 {
            let frame = &mut mended.frames[index];
            frame.camera = CameraId::from("main-0");
            frame.ptz = ptz_at(1.2, -12.1, 1790.0);
            frame.solution = answered_by(SolutionSource::Markings, Some(0.99));
        }
        (app, mended)
    }

    /// The mending of the document that is open now.
    fn mending(app: &App) -> Mending {
        let open = app.open().unwrap();
        Mending {
            document: (*open.document).clone(),
            folder: open.folder.clone(),
            options: MendOptions::default(),
        }
    }

    fn take(app: &mut App, document: Document, mending: &Mending) {
        let frames = document.frames.iter().map(|frame| MendedFrame {
            id: frame.id.clone(),
            given: GivenCamera::Missing,
            outcome: Outcome::Aligned,
            moved_px: Some(4.0),
        });
        let mended = Mended {
            frames: frames.collect(),
            places: Vec::new(),
            common: Vec::new(),
            not_aligned: Vec::new(),
        };
        app.take_mended(mending, MendedDocument { document, mended });
    }

    #[test]
    fn mended_cameras_are_one_step_of_undo() {
        let (mut app, mended) = app();
        assert_eq!(app.why_not(Command::MendCameras), None);
        let before = (*app.open().unwrap().document).clone();
        let mending = mending(&app);
        take(&mut app, mended, &mending);
        let now = (*app.open().unwrap().document).clone();
        assert_eq!(now.cameras.len(), 1);
        assert!(now.frames.iter().all(|frame| frame.is_snapped()));
        app.update(Action::Command(Command::Undo));
        let undone = (*app.open().unwrap().document).clone();
        assert_eq!(undone.cameras, before.cameras);
        let camera = |document: &Document, index: usize| document.frames[index].ptz.clone();
        assert!((0..4).all(|index| camera(&undone, index) == camera(&before, index)));
    }

    #[test]
    fn a_frame_that_changed_meanwhile_keeps_its_camera_and_its_base() {
        let (mut app, mended) = app();
        let mending = mending(&app);
        app.update(Action::Navigate(Navigation::GoTo(0)));
        app.update(Action::Command(Command::Accept));
        // Another part of a frame does not matter: the shot that the search for cuts wrote.
        app.open.as_mut().unwrap().document.frames[1].clip = Some(Clip::Number(1));
        let accepted = (*app.open().unwrap().document.frames[0]).clone();
        assert!(!accepted.is_open());
        let base = app.open().unwrap().document.cameras[0].base();
        take(&mut app, mended, &mending);
        let now = (*app.open().unwrap().document).clone();
        assert_eq!(now.frames[0].ptz, accepted.ptz);
        assert_eq!(now.frames[0].status, accepted.status);
        assert_eq!(now.camera(&now.frames[0].camera).unwrap().base(), base);
        assert!((1..4).all(|index| now.frames[index].is_snapped()));
        assert_eq!(now.frames[1].clip, Some(Clip::Number(1)));
        assert_ne!(now.frames[1].camera, now.frames[0].camera);
    }

    #[test]
    fn what_was_mended_for_other_cameras_is_discarded() {
        let (mut app, mended) = app();
        let mut mending = mending(&app);
        mending.document.cameras[2].image_size = ImageSize::new(640, 360);
        let before = (*app.open().unwrap().document).clone();
        take(&mut app, mended, &mending);
        assert_eq!(*app.open().unwrap().document, before);
        assert!(app.session.offers(Command::MendCameras));
    }

    #[test]
    fn without_imported_cameras_there_is_nothing_to_mend() {
        let (mut app, mended) = app();
        let mending = mending(&app);
        take(&mut app, mended, &mending);
        app.update(Action::Navigate(Navigation::GoTo(1)));
        assert!(app.why_not(Command::MendCameras).is_some());
        assert!(app.why_not(Command::StopMending).is_some());
    }
}
