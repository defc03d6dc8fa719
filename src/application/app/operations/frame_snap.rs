//! Aligns the camera of the shown frame to the painted lines of its picture (*snap*), or searches
//! it from the lines alone if the frame has none.

use crate::app::operation::{AsItWas, Context, Failure, Operation, Running, Slot, WorkError};
use crate::app::operations::UnderWay;
use crate::app::{App, Command};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::{camera_on_paint, record_found_by_paint, record_snapped};
use touchline_calibration::proposals::{Finder, SuggestionUpdate, read_picture};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_documents::document::{Document, Frame, FrameId, FrameStatus, Shared};
use touchline_vision::paint::{FindOptions, Snapped};

/// Aligns a frame's camera to the painted lines, or searches it from them.
#[derive(Debug)]
pub struct FrameSnap {
    document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    /// The frame when the work started.
    frame: Shared<Frame>,
    /// The field that the frame shows.
    field: Arc<FieldModel>,
    /// Whether to search without a starting camera.
    from_scratch: bool,
}

/// A camera that agrees with the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraOnPaint {
    /// The base with which it was aligned.
    base: CameraBase,
    /// Pan, tilt and focal length, and their evidence.
    found: Snapped,
}

/// The running alignment, and the cameras of frames before their alignment.
#[derive(Debug, Default)]
pub struct FrameSnapState {
    slot: Slot<FrameSnap>,
    /// The cameras of frames before they were aligned, for comparison.
    before: BTreeMap<FrameId, PtzCamera>,
}

// ---- The work ----

impl Operation for FrameSnap {
    /// The share of a search that is done, 0 to 1.
    type Progress = f64;
    type Output = Box<CameraOnPaint>;
    type Error = WorkError;

    const NAME: &'static str = "snap";

    fn run(&self, context: &Context<'_, f64>) -> Result<Box<CameraOnPaint>, WorkError> {
        let picture = read_picture(&mut *context.open_reader(), &self.frame, &self.folder)?;
        let how = (&FindOptions::default(), self.from_scratch);
        let (base, found) = camera_on_paint(
            &self.document,
            &self.frame,
            &self.field,
            &picture,
            how,
            &context.progress(),
        )?;
        Ok(Box::new(CameraOnPaint { base, found }))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.frame_snap.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(&self, app: &mut App, result: Result<Box<CameraOnPaint>, Failure<WorkError>>) {
        match result {
            Ok(found) => app.take_camera_on_paint(self, &found),
            Err(failure) => {
                let what = if self.from_scratch {
                    "No camera found"
                } else {
                    "Not snapped"
                };
                app.session
                    .notify(failure.level(), format!("{what}: {failure}."));
            }
        }
    }
}

// ---- In the application ----

impl FrameSnapState {
    /// The running request.
    pub const fn running(&self) -> Option<&Running<FrameSnap>> {
        self.slot.running()
    }

    /// The running request, if it is a search without a starting camera.
    fn search(&self) -> Option<&Running<FrameSnap>> {
        self.slot
            .running()
            .filter(|running| running.operation().from_scratch)
    }
}

impl App {
    /// Why a command about the painted lines is not available. None if it is.
    pub(in crate::app) fn why_not_frame_snap(&self, command: Command) -> Option<&'static str> {
        match command {
            Command::Snap => self.why_not_snap(),
            Command::SearchLines => self.why_not_search_lines(),
            Command::StopSearch if self.operations.frame_snap.search().is_none() => {
                Some("No lines are being searched.")
            }
            _ => None,
        }
    }

    /// Why the shown frame cannot be aligned. None if it can.
    fn why_not_snap(&self) -> Option<&'static str> {
        self.why_no_paint().or_else(|| {
            self.current
                .camera
                .is_none()
                .then_some("There is no camera to snap yet: click two points first.")
        })
    }

    /// Why the shown frame's camera cannot be searched. None if it can.
    fn why_not_search_lines(&self) -> Option<&'static str> {
        let frame = self.frame()?;
        let document = &self.open.as_ref()?.document;
        let base = document
            .camera_of(frame)
            .and_then(|camera| camera.base_for(frame));
        self.why_no_paint()
            .or_else(|| {
                self.current
                    .camera
                    .is_some()
                    .then_some("This frame has a camera: snap it.")
            })
            .or_else(|| base.is_none().then_some("Its camera has no base yet."))
    }

    /// Why the painted lines of the shown frame cannot be used now. None if they can.
    fn why_no_paint(&self) -> Option<&'static str> {
        let frame = self.frame()?;
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if frame.status == FrameStatus::Rejected {
            return Some("This frame is marked as not calibratable.");
        }
        self.operations
            .frame_snap
            .slot
            .is_running()
            .then_some("The lines are being searched.")
    }

    /// Carries out a command about the painted lines.
    pub(in crate::app) fn frame_snap_command(&mut self, command: Command) {
        match command {
            Command::Snap => self.snap(false),
            Command::SearchLines => self.snap(true),
            Command::StopSearch => {
                self.operations.frame_snap.slot.cancel();
                self.session
                    .note("The search was stopped; nothing was changed.");
            }
            _ => {}
        }
    }

    /// Starts an alignment of the shown frame, or a search `from_scratch`.
    fn snap(&mut self, from_scratch: bool) {
        let Some(field) = self.current.field().cloned() else {
            return;
        };
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let Some(frame) = open.document.frames.get(self.session.frame).cloned() else {
            return;
        };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(FrameSnap {
            document,
            folder,
            frame,
            field,
            from_scratch,
        });
    }

    /// Takes over an aligned camera, unless the frame, its base or its field has changed since the
    /// work started.
    ///
    /// A camera that was searched for a frame without users' work becomes a suggestion. Anything
    /// else is one step of undo.
    fn take_camera_on_paint(&mut self, request: &FrameSnap, found: &CameraOnPaint) {
        // The position may have changed, the frame must not.
        let position = self.open.as_ref().and_then(|open| {
            let since = AsItWas {
                then: &request.document,
                now: &open.document,
            };
            let position = since.position_if_unchanged(&request.frame.id)?;
            since
                .has_base_and_field(&request.frame.camera)
                .then_some(position)
        });
        let Some(position) = position else {
            let text = "The frame, its base or its field changed in the meantime; the camera on \
                        the painted lines was discarded.";
            self.session.note(text);
            return;
        };
        // A result for an untouched frame is a suggestion,
        if request.from_scratch && request.frame.is_open() {
            self.suggest_camera_on_paint(position, found);
            return;
        }
        // any other one a step of undo.
        let before = self
            .open
            .as_ref()
            .and_then(|open| open.document.ptz_camera(&request.frame));
        let step = if request.from_scratch {
            "Search the painted lines"
        } else {
            "Snap to the painted lines"
        };
        if !self.begin_step(self.step_at(step, position)) {
            return;
        }
        if let Some(frame) = self.frame_mut_at(position) {
            let record = if request.from_scratch {
                record_found_by_paint
            } else {
                record_snapped
            };
            record(frame, &found.base, &found.found);
            if request.frame.shows_suggestion() && frame.status == FrameStatus::Suggested {
                // Who aligns it has begun to work on it.
                frame.status = FrameStatus::Draft;
            }
        }
        self.commit();
        if let Some(before) = before {
            let hint = self.settings.keys.with_key(Command::Snap, |key| {
                format!(" Hold {key} to see it before.")
            });
            let text = describe_snap(&before, found, &request.frame, &hint);
            self.operations
                .frame_snap
                .before
                .insert(request.frame.id.clone(), before);
            self.session.note(text);
        } else if request.from_scratch {
            let samples = found.found.samples;
            self.session.note(format!(
                "Found from {samples} points on painted lines. Check it before you accept."
            ));
        }
    }

    /// Makes a camera that was found from the lines alone a suggestion for its frame, which users
    /// have not changed.
    fn suggest_camera_on_paint(
        &mut self,
        position: usize,
        CameraOnPaint { base, found }: &CameraOnPaint,
    ) {
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &mut self.open else { return };
        let suggestion = SuggestionUpdate::from_recorded(&open.document, position, |frame| {
            record_found_by_paint(frame, base, found);
        });
        let Some(suggestion) = suggestion else {
            return;
        };
        let batch = open.project.open_batch(Finder::Command {
            name: Command::SearchLines.name().to_owned(),
        });
        let step = self.step_at(Command::SearchLines.name(), position);
        let Some(open) = &mut self.open else { return };
        if let Some(edit) = open.suggest_as_step(step, batch, &[suggestion]) {
            self.journal_edit(edit);
        }
        let samples = found.samples;
        let text = format!(
            "Suggested from {samples} points on painted lines. Check it before you accept it."
        );
        self.session.note(text);
    }

    /// The shown frame's camera before its alignment, if the frame is aligned and that camera is
    /// known.
    pub fn before_snap(&self) -> Option<&PtzCamera> {
        let frame = self.frame().filter(|frame| frame.is_snapped())?;
        self.operations.frame_snap.before.get(&frame.id)
    }

    /// Shows the earlier camera while the key is down. If the frame is not aligned yet, aligns it.
    pub(in crate::app) fn hold_snap(&mut self, down: bool) {
        if down && self.before_snap().is_none() {
            self.command(Command::Snap);
        } else {
            self.session.picture.held.before_snap = down;
        }
    }
}

// ---- Words ----

impl FrameSnapState {
    /// Whether the painted lines of a frame are being searched.
    pub(super) fn is_searching(&self, frame: &Frame) -> bool {
        self.search()
            .is_some_and(|search| search.operation().frame.id == frame.id)
    }

    /// The running search with its progress, for the status row. An alignment takes too little time
    /// to be shown.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let search = self.search()?;
        let share = search.progress().map(|share| *share as f32);
        let step = search.operation().frame.name();
        let job = "Searching the painted lines";
        Some(UnderWay::new(job, step, Command::StopSearch).with_share(share))
    }
}

/// How far the centre of the picture moved, and the evidence, as text. `hint` says how to see the
/// camera before.
fn describe_snap(
    before: &PtzCamera,
    CameraOnPaint { base, found }: &CameraOnPaint,
    frame: &Frame,
    hint: &str,
) -> String {
    let after = PtzCamera::new(*base, found.ptz);
    let centre = frame.image_size.centre();
    let moved = before
        .ray_from_image(centre)
        .ok()
        .and_then(|ray| after.image_from_ray(ray).ok());
    let moved = moved
        .map(|to| format!(", {:.1} px away", to.distance_px(centre)))
        .unwrap_or_default();
    format!(
        "Snapped to {} points on painted lines (within {:.1} px){moved}.{hint}",
        found.samples, found.rms_px
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::operation::Report;
    use crate::app::panel_values::guidance::next_step;
    use crate::app::{Action, EditAction, Navigation};
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{ImageSize, Mat3, Vec3};
    use touchline_core::solve::Uncertainty;
    use touchline_core::testing::base_at;
    use touchline_documents::document::{Camera, FramePtz, SolutionSource};
    use touchline_documents::testing::{WithFrames, match_from, new_frame, solved_by};
    use touchline_vision::paint::LineCheck;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// Two frames of a camera with a base, without points.
    fn app() -> App {
        App::with_document(
            match_from(&base_at([0.0, -60.0, 18.0], SIZE), SIZE)
                .with_pictures(["a.jpg", "b.jpg"], SIZE),
        )
    }

    /// Starts a search of the painted lines of the first frame. Returns the report of its success.
    fn search(app: &mut App) -> Action {
        app.snap(true);
        let base = app.current().base.unwrap();
        let ptz = Ptz::from_degrees(0.0, -12.0, 1000.0);
        let known = Mat3::from_diagonal(&Vec3::new(1e-7, 1e-7, 4.0));
        let camera = PtzCamera::new(base, ptz);
        let check = LineCheck {
            predicted: 200,
            found: 190,
            bare: 10,
            offset_px: 0.5,
            bias_px: 0.0,
            halves_px: 0.5,
            unexplained: None,
            emptiest: None,
            agreement: 0.95,
            score: 0.99,
        };
        let found = Snapped {
            ptz,
            own_lens: None,
            samples: 190,
            rms_px: 0.5,
            halves_px: 0.5,
            uncertainty: Uncertainty::from_covariance(&camera, known, SIZE).unwrap(),
            check,
        };
        let id = app.operations.frame_snap.slot.running().unwrap().id();
        let found = Box::new(CameraOnPaint { base, found });
        Action::Report(Report::from_result::<FrameSnap>(id, Ok(found)))
    }

    fn is_suggested(app: &App) -> bool {
        app.open().unwrap().document.frames[0].status == FrameStatus::Suggested
    }

    #[test]
    fn a_camera_that_is_found_during_a_change_waits_for_its_end() {
        let mut app = app();
        let report = search(&mut app);
        app.update(Action::Navigate(Navigation::GoTo(1)));
        app.update(Action::Edit(EditAction::Begin("Change field")));
        app.update(report);
        assert!(!is_suggested(&app));
        app.update(Action::Edit(EditAction::End));
        assert!(is_suggested(&app));
    }

    #[test]
    fn a_camera_that_was_found_with_another_base_is_discarded() {
        let mut app = app();
        let report = search(&mut app);
        let mut camera = Camera::clone(&app.open().unwrap().document.cameras[0]);
        let mut base = camera.base().unwrap();
        base.position_m.y -= 5.0;
        camera.set_base(&base);
        app.update(Action::Edit(EditAction::Camera(Box::new(camera))));
        app.update(report);
        assert!(!is_suggested(&app));
        let said = &app.session.messages.notices.last().unwrap().text;
        assert!(said.contains("was discarded"), "{said}");
    }

    #[test]
    fn the_camera_before_is_mentioned_only_with_a_key_that_shows_it() {
        let size = ImageSize::new(1280, 720);
        let base = base_at([0.0, -60.0, 18.0], size);
        let ptz = Ptz::from_degrees(0.0, -10.0, 1000.0);
        let mut document = match_from(&base, size);
        let mut frame = new_frame("a.jpg", size);
        frame.ptz = Some(FramePtz::new(ptz, None));
        frame.status = FrameStatus::Draft;
        frame.solution = solved_by(SolutionSource::Markings);
        document.frames.push(frame.into());
        let mut app = App::with_document(document);
        let id = app.frame().unwrap().id.clone();
        let before = &mut app.operations.frame_snap.before;
        before.insert(id, PtzCamera::new(base, ptz));
        let text = next_step(&app).text;
        assert!(text.ends_with(" Hold S: before."), "{text}");
        let keys = &mut app.settings.keys;
        keys.assign(Command::ZoomToFit, "S".parse().unwrap());
        let text = next_step(&app).text;
        assert!(text.starts_with("Aligned to the painted lines"), "{text}");
        assert!(!text.contains("Hold"), "{text}");
    }
}
