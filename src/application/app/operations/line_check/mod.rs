//! Compares the cameras of all frames with the painted lines of their pictures, in the background
//! between edits. The results are kept beside the document; acceptance of a frame writes its result
//! into the document.

mod acceptance;
mod batch;
mod checks;
mod offsets;

pub(in crate::app) use checks::LineChecks;
pub use offsets::{BESIDE_PX, LineOffset};

use crate::app::App;
use batch::LineCheckBatch;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::PaintEvidence;
use touchline_vision::paint::LineCheck;

impl App {
    /// The line check of a frame's camera, if it is known.
    pub fn paint_says(&self, frame: usize) -> Option<LineCheckSummary> {
        let open = self.open.as_ref()?;
        self.operations
            .line_checks
            .frame_result(open, open.frame(frame)?)
    }

    /// Whether the line check contradicts a frame's camera.
    pub fn is_contradicted(&self, frame: usize) -> bool {
        self.paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts)
    }

    /// What the painted lines of a frame's own picture say about its camera, where that is known.
    ///
    /// [`Self::paint_says`] leaves the verdict open where the lines contradict every camera of the
    /// document, because such lines may be those of another sport. Before a camera is accepted the
    /// picture itself counts.
    pub fn own_paint_says(&self, frame: usize) -> Option<LineCheckSummary> {
        let open = self.open.as_ref()?;
        let frame = open.frame(frame)?;
        self.operations.line_checks.picture_result(open, frame)
    }

    /// How far the paint lies from the lines that a frame's camera draws, farthest first. Empty if
    /// that is not known.
    pub fn line_offsets(&self, frame: usize) -> &[LineOffset] {
        let open = self.open.as_ref();
        open.and_then(|open| {
            self.operations
                .line_checks
                .offsets(open, open.frame(frame)?)
        })
        .unwrap_or_default()
    }

    /// The line that lies beside its paint by [`BESIDE_PX`] or more, if a frame's camera has one;
    /// the farthest of them.
    pub fn line_beside_paint(&self, frame: usize) -> Option<&LineOffset> {
        let open = self.open.as_ref()?;
        self.operations
            .line_checks
            .line_beside_paint(open, open.frame(frame)?)
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
}

/// The line check of a camera, as the window shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCheckSummary {
    pub verdict: LineVerdict,
    /// Number of samples on the lines with paint nearby.
    pub found: usize,
    /// Number of samples on the lines where nothing hides the ground.
    pub open: usize,
    /// Median distance of the paint from the lines, px; none if no paint was found.
    pub offset_px: Option<f64>,
}

impl LineCheckSummary {
    fn from_check(check: &LineCheck) -> Self {
        let offset_px = Some(check.offset_px).filter(|offset| offset.is_finite());
        Self {
            verdict: check.verdict(),
            found: check.found,
            open: check.num_open(),
            offset_px,
        }
    }

    fn from_evidence(evidence: &PaintEvidence) -> Self {
        let open = evidence.open();
        Self {
            verdict: evidence.verdict(),
            found: evidence.found,
            open,
            offset_px: evidence.offset_px,
        }
    }

    /// The verdict in three words.
    pub const fn in_brief(&self) -> &'static str {
        match self.verdict {
            LineVerdict::Supports => "on painted lines",
            LineVerdict::Contradicts => "off painted lines",
            LineVerdict::CannotSay => "painted lines unclear",
        }
    }

    /// The share of the open places at which paint was found, as text: "97 %".
    fn share_found(&self) -> String {
        format!(
            "{:.0} %",
            100.0 * self.found as f64 / self.open.max(1) as f64
        )
    }

    /// One line: "on the painted lines: 0.7 px off, 97 % of the visible paint found".
    pub fn describe(&self) -> String {
        let found = self.share_found();
        match (self.verdict, self.offset_px) {
            (LineVerdict::Supports, Some(px)) => {
                format!("on the painted lines: {px:.1} px off, {found} of the visible paint found")
            }
            (LineVerdict::Supports, None) => {
                format!("on the painted lines: {found} of the visible paint found")
            }
            (LineVerdict::Contradicts, _) => {
                format!("the paint contradicts this camera ({found} found where it expects paint)")
            }
            (LineVerdict::CannotSay, Some(px)) => format!(
                "the paint neither supports nor contradicts this camera ({found} found, {px:.0} px \
                 off)"
            ),
            (LineVerdict::CannotSay, None) => {
                format!("the paint neither supports nor contradicts this camera ({found} found)")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::batch::CheckedLines;
    use super::checks::CONTRADICTED_ALONE;
    use super::*;
    use crate::app::operation::Operation;
    use crate::app::window_state::session::Level;
    use crate::app::{
        Action, Command, DiskReport, EditAction, Effect, Navigation, Opened, Settings,
    };
    use std::path::PathBuf;
    use touchline_core::camera::PtzCamera;
    use touchline_core::field::builtin;
    use touchline_core::testing::{SIZE, TestBase, base_at};
    use touchline_documents::document::{
        FieldSpec, FrameId, FramePtz, FrameStatus, SolutionSource,
    };
    use touchline_documents::testing::{match_from, new_frame, solved_by};
    use touchline_vision::paint::LineCheck;

    fn camera() -> PtzCamera {
        base_at([0.0, -60.0, 18.0], SIZE).aim(0.0, -12.0, 2000.0)
    }

    /// What the paint says about a frame: 0 contradicts its camera, 1 supports it.
    pub(super) fn line_check_of(frame: FrameId, score: f64) -> CheckedLines {
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
            offsets: Vec::new(),
        }
    }

    /// An application with imported cameras; nothing is known of their paint.
    pub(super) fn imported(frames: usize) -> App {
        let mut document = match_from(camera().base(), SIZE);
        for index in 0..frames {
            let mut frame = new_frame(&format!("{index}.jpg"), SIZE);
            frame.ptz = Some(FramePtz::new(camera().ptz(), None));
            frame.status = FrameStatus::Draft;
            frame.solution = solved_by(SolutionSource::Import);
            document.frames.push(frame.into());
        }
        App::with_document(document)
    }

    /// The background check comes back with what the paint says about some frames.
    pub(super) fn report(app: &mut App, places: std::ops::Range<usize>, score: f64) {
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
}
