//! Mending the cameras that another program gave for the frames of a video: one step of undo, whose
//! cameras are one batch of suggestions.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::operations::UnderWay;
use crate::app::session::Level;
use crate::app::{App, Command};
use std::path::PathBuf;
use touchline_calibration::pipelines::{MendError, MendEvent, MendOptions, Mended, Tally, mend};
use touchline_core::geometry::counted;
use touchline_core::progress::Share;
use touchline_documents::document::{Document, Step};

/// Fewer cameras have no place in common.
const FEWEST: usize = 3;

/// The name of the step of undo, and of its batch of suggestions.
const STEP: &str = "Mend the imported cameras";

/// Mends the imported cameras of a document.
pub struct Mending {
    document: Document,
    /// The folder from which the document's relative paths start.
    folder: PathBuf,
    /// The revision of the open document when the work began.
    revision: u64,
}

/// The mended document, and what became of each camera.
pub struct MendedDocument {
    document: Document,
    mended: Mended,
}

/// The mending under way.
#[derive(Debug, Default)]
pub(in crate::app) struct MendingState {
    slot: Slot<Mending>,
}

/// A step of mending, and how far it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MendingProgress {
    /// What is being done.
    step: &'static str,
    /// The share that is done, 0 to 1; none if it is unknown.
    share: Option<f32>,
}

// ---- The work ----

impl Operation for Mending {
    type Progress = MendingProgress;
    type Output = MendedDocument;
    type Error = MendError;

    const NAME: &'static str = "mend cameras";

    fn run(&self, context: &Context<'_, MendingProgress>) -> Result<MendedDocument, MendError> {
        let mut reader = context.open_reader();
        let mut document = self.document.clone();
        let steps = context.progress();
        let progress = steps.part(|event: MendEvent| MendingProgress::of_event(&event));
        let options = MendOptions::default();
        let mended = mend(
            &mut document,
            &self.folder,
            &mut *reader,
            &options,
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

impl MendingProgress {
    fn of_event(event: &MendEvent) -> Self {
        let share = |step, share: &Share| Self {
            step,
            share: Some(share.fraction()),
        };
        match event {
            MendEvent::Cuts(done) => share("Looking for cuts", done),
            MendEvent::Sampling(done) => share("Comparing a sample with the painted lines", done),
            MendEvent::Aligning(_, done) => share("Aligning all frames to the painted lines", done),
            MendEvent::Checking(done) => share("Checking doubtful frames", done),
            MendEvent::Places(_) => Self {
                step: "Comparing a sample with the painted lines",
                share: None,
            },
            MendEvent::NotAligned(..) | MendEvent::Tracking(_) => Self {
                step: "Tracking the frames that do not fit",
                share: None,
            },
        }
    }
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
        let few = open.counts().imported < FEWEST;
        few.then_some("Too few frames have imported cameras: 3 or more are needed.")
    }

    /// Carries out a command of the mending.
    pub(in crate::app) fn mending_command(&mut self, command: Command) {
        match command {
            Command::MendCameras => self.mend_cameras(),
            Command::StopMending if self.operations.mending.slot.cancel() => {
                let text = "Mending was stopped; nothing was changed.";
                self.session.notify(Level::Info, text);
            }
            _ => {}
        }
    }

    fn mend_cameras(&mut self) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let revision = open.revision;
        self.session.retract(Command::MendCameras);
        self.start(Mending {
            document,
            folder,
            revision,
        });
    }

    /// Takes over mended cameras as one step of undo.
    fn take_mended(
        &mut self,
        mending: &Mending,
        MendedDocument { document, mended }: MendedDocument,
    ) {
        let revision = self.open.as_ref().map(|open| open.revision);
        if revision != Some(mending.revision) {
            let text = "The document changed in the meantime; the mended cameras were discarded.";
            self.session
                .notify_with(Level::Info, text, [("Mend again", Command::MendCameras)]);
            return;
        }
        if !self.begin_step(Step::on_document(STEP)) {
            return;
        }
        if let Some(open) = &mut self.open {
            let Document {
                field,
                cameras,
                frames,
                ..
            } = document;
            let now = &mut open.document;
            (now.field, now.cameras, now.frames) = (field, cameras, frames);
        }
        // The frames belong to their new cameras already: they must not be turned to them again.
        self.close_step();
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
    /// The mending under way, with how far it has come.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let progress = self.slot.running()?.progress();
        let step = progress.map_or("Mending the imported cameras", |progress| progress.step);
        Some(UnderWay {
            text: format!("{step}…"),
            share: progress.and_then(|progress| progress.share),
            stop: Command::StopMending,
        })
    }
}

/// What became of the cameras, in a few sentences.
fn describe_mended(mended: &Mended, tally: &Tally) -> String {
    let mut text = format!(
        "{}: {} impossible, {} mirrored. {} as they came, {} mended on the painted lines, {} by \
         their neighbours, {} left for you.",
        counted(tally.came, "camera"),
        tally.impossible,
        tally.mirrored,
        tally.as_they_came,
        tally.aligned,
        tally.tracked,
        tally.left
    );
    for error in &mended.common {
        text += " Also, ";
        text += &error.to_string();
        text.push('.');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, Navigation, Opened, Settings};
    use touchline_calibration::pipelines::{GivenCamera, MendedFrame, Outcome};
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz};
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_documents::document::{
        Camera, CameraId, FieldSpec, Frame, FramePtz, FrameStatus, Solution, SolutionSource,
    };

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// An application with four frames that have an imported camera each, and the same document
    /// with one camera for all of them.
    fn app() -> (App, Document) {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for index in 0..4 {
            let id = CameraId::from(format!("main-{index}").as_str());
            let mut camera = Camera::new(id.clone(), SIZE);
            camera.set_base(&CameraBase::new(
                Vec3::new(0.1 * f64::from(index), -62.0, 17.0),
                BaseAngles::default().base_from_world(),
                SIZE.centre(),
            ));
            document.cameras.push(camera.into());
            let mut frame = Frame::from_image(&format!("{index}.jpg"), id, SIZE);
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(1.0, -12.0, 1800.0), None));
            frame.status = FrameStatus::Suggested;
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Import),
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        let mut app = App::new(Settings::default());
        let opened = Opened::new(document.clone(), "/match/project.json");
        app.update(Action::Opened(Box::new(opened)));
        let mut mended = document;
        mended.cameras.truncate(1);
        let mut base = mended.cameras[0].base().unwrap();
        base.position_m.x = 0.15;
        mended.cameras[0].set_base(&base);
        for index in 0..4 {
            let frame = &mut mended.frames[index];
            frame.camera = CameraId::from("main-0");
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(1.2, -12.1, 1790.0), None));
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Markings),
                confidence: Some(0.99),
                ..Solution::default()
            });
        }
        (app, mended)
    }

    fn take(app: &mut App, document: Document, revision: u64) {
        let open = app.open().unwrap();
        let mending = Mending {
            document: (*open.document).clone(),
            folder: open.folder.clone(),
            revision,
        };
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
        };
        app.take_mended(&mending, MendedDocument { document, mended });
    }

    #[test]
    fn mended_cameras_are_one_step_of_undo() {
        let (mut app, mended) = app();
        assert_eq!(app.why_not(Command::MendCameras), None);
        let before = (*app.open().unwrap().document).clone();
        let revision = app.open().unwrap().revision;
        take(&mut app, mended, revision);
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
    fn what_was_mended_for_another_state_of_the_document_is_discarded() {
        let (mut app, mended) = app();
        let before = (*app.open().unwrap().document).clone();
        let revision = app.open().unwrap().revision;
        take(&mut app, mended, revision + 1);
        assert_eq!(*app.open().unwrap().document, before);
        assert!(app.session.offers(Command::MendCameras));
    }

    #[test]
    fn without_imported_cameras_there_is_nothing_to_mend() {
        let (mut app, mended) = app();
        let revision = app.open().unwrap().revision;
        take(&mut app, mended, revision);
        app.update(Action::Navigate(Navigation::GoTo(1)));
        assert!(app.why_not(Command::MendCameras).is_some());
        assert!(app.why_not(Command::StopMending).is_some());
    }
}
