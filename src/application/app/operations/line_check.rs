//! What the painted lines say about the frames' cameras: found in the background between edits,
//! kept beside the document.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::session::Level;
use crate::app::{App, OpenProject};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::{LINE_CHECK, check_frame, record_line_check};
use touchline_calibration::proposals::{FramePicture, PictureStream};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::markings::LineVerdict;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, Frame, FrameId, FrameStatus, PaintEvidence};
use touchline_vision::paint::LineCheck;

/// Frames that are looked through after each action for one to check: an edit of a long match stays
/// quick.
const LOOKED_THROUGH: usize = 64;

/// Frames in one batch: there is a report every second or so.
const BATCH: usize = 4;

/// If this many cameras are contradicted and none is supported, the lines in the pictures are not
/// those of the field.
const CONTRADICTED_ALONE: usize = 4;

/// Cameras of a few frames are to be judged by the painted lines.
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
    /// The field that it shows; none where that is not valid.
    field: Option<Arc<FieldModel>>,
}

/// What the paint says about a frame's camera.
#[derive(Clone, Debug)]
pub struct CheckedLines {
    frame: FrameId,
    /// The camera that was judged.
    camera: PtzCamera,
    /// What the paint says; none where the picture cannot be read.
    check: Option<LineCheck>,
}

impl Operation for LineCheckBatch {
    type Progress = Infallible;
    type Output = Vec<CheckedLines>;
    type Error = Infallible;

    const NAME: &'static str = "line check";

    fn run(&self, context: &Context<'_, Infallible>) -> Result<Vec<CheckedLines>, Infallible> {
        let at = self.document.at(&self.folder);
        let is_there = |to_check: &&FrameToCheck| {
            to_check.index < at.document.frames.len() && to_check.field.is_some()
        };
        let frames: Vec<&FrameToCheck> = self.frames.iter().filter(is_there).collect();
        let mut reader = context.open_reader();
        let pictures = PictureStream::new(at, frames.iter().map(|to_check| to_check.index))
            .with_reader(&mut *reader)
            .with_progress(Progress::new(|_| context.check()));
        let mut checked = Vec::with_capacity(frames.len());
        for (to_check, FramePicture { frame, picture, .. }) in frames.iter().zip(pictures) {
            let seen = picture.ok().zip(to_check.field.as_ref());
            let check =
                seen.and_then(|(picture, field)| check_frame(at.document, frame, field, &picture));
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
        // Frames of which nothing was found out are not asked again as long as their cameras stay.
        for FrameToCheck { frame, camera, .. } in &self.frames {
            checks.keep(CheckedLines {
                frame: frame.clone(),
                camera: *camera,
                check: None,
            });
        }
        for checked in found {
            checks.keep(checked);
        }
    }
}

impl App {
    /// What the painted lines say about a frame's camera, where that is known.
    #[must_use]
    pub fn paint_says(&self, frame: usize) -> Option<PaintSays> {
        let open = self.open.as_ref()?;
        self.operations.line_checks.of(open, open.frame(frame)?)
    }

    /// Whether the paint is known to lie elsewhere than a frame's camera has its lines.
    #[must_use]
    pub fn is_contradicted(&self, frame: usize) -> bool {
        self.paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts)
    }

    /// Has cameras judged by the paint that nobody has judged yet, between edits. Batches do not
    /// replace each other: the next one begins when the last has come back.
    pub(in crate::app) fn check_lines(&mut self) {
        let Some(open) = self.open.as_mut().filter(|open| !open.history.is_open()) else {
            return;
        };
        if self.operations.line_checks.slot.is_running() {
            return;
        }
        let frames = self.operations.line_checks.next(open, self.session.frame);
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

    /// Writes what the paint says about the shown frame's camera into its solution, within a step.
    pub(in crate::app) fn record_paint(&mut self) {
        let Some(open) = &mut self.open else { return };
        let Some(frame) = open.frame(self.session.frame) else {
            return;
        };
        let Some(check) = self.operations.line_checks.fresh(open, frame) else {
            return;
        };
        if let Some(frame) = open.document.frames.get_mut(self.session.frame) {
            record_line_check(frame, &check);
        }
    }
}

/// What the paint says about a camera, as the window shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintSays {
    /// In a word.
    pub verdict: LineVerdict,
    /// Places of the lines with paint near by.
    pub found: usize,
    /// Places of the lines that lie open.
    pub open: usize,
    /// The median distance of the paint from the lines, px; none where none was found.
    pub offset_px: Option<f64>,
}

impl PaintSays {
    fn of(check: &LineCheck) -> Self {
        let offset_px = Some(check.offset_px).filter(|offset| offset.is_finite());
        Self {
            verdict: check.verdict(),
            found: check.found,
            open: check.found + check.bare,
            offset_px,
        }
    }

    fn recorded(evidence: &PaintEvidence) -> Self {
        let open = evidence.open();
        Self {
            verdict: evidence.verdict(),
            found: evidence.found,
            open,
            offset_px: evidence.offset_px,
        }
    }

    /// In three words.
    #[must_use]
    pub const fn in_brief(&self) -> &'static str {
        match self.verdict {
            LineVerdict::Supports => "on painted lines",
            LineVerdict::Contradicts => "off painted lines",
            LineVerdict::CannotSay => "painted lines unclear",
        }
    }

    /// One line: "on the painted lines (0.8 px at 212 of 230 open places)".
    #[must_use]
    pub fn describe(&self) -> String {
        let Self { found, open, .. } = self;
        match (self.verdict, self.offset_px) {
            (LineVerdict::Supports, Some(px)) => {
                format!("on the painted lines ({px:.1} px at {found} of {open} open places)")
            }
            (LineVerdict::Supports, None) => {
                format!("on the painted lines ({found} of {open} open places)")
            }
            (LineVerdict::Contradicts, _) => {
                format!("the painted lines are elsewhere (paint at {found} of {open} open places)")
            }
            (LineVerdict::CannotSay, _) => {
                format!("the painted lines do not decide (paint at {found} of {open} open places)")
            }
        }
    }
}

/// The line checks of the open document.
#[derive(Debug, Default)]
pub(in crate::app) struct LineChecks {
    slot: Slot<LineCheckBatch>,
    known: BTreeMap<FrameId, CheckedLines>,
    /// How many of the known cameras are contradicted, and how many supported: asked for each
    /// thumbnail that is drawn.
    contradicted: usize,
    supported: usize,
    /// The index of the frame where the search for frames to check goes on.
    cursor: usize,
}

impl LineChecks {
    /// What the paint says about a frame's camera, where that is known.
    fn of(&self, open: &OpenProject, frame: &Frame) -> Option<PaintSays> {
        let recorded = frame
            .solution
            .as_ref()
            .and_then(|solution| solution.line_check.as_ref());
        let says = match recorded {
            Some(evidence) => PaintSays::recorded(evidence),
            None => PaintSays::of(&self.fresh(open, frame)?),
        };
        // Who found the camera may know more of the paint than this one look: that the field is of
        // another length, or the frames beside.
        let is_warned = frame
            .solution
            .iter()
            .flat_map(|solution| &solution.warnings)
            .any(|it| it.code == LINE_CHECK);
        let verdict = match says.verdict {
            _ if is_warned => LineVerdict::Contradicts,
            verdict if self.is_informative() => verdict,
            _ => LineVerdict::CannotSay,
        };
        Some(PaintSays { verdict, ..says })
    }

    /// What was found about a frame's camera and is not in the document yet.
    fn fresh(&self, open: &OpenProject, frame: &Frame) -> Option<LineCheck> {
        let known = self.known.get(&frame.id)?;
        (Some(known.camera) == open.document.pointed(frame))
            .then_some(known.check)
            .flatten()
    }

    const fn is_informative(&self) -> bool {
        self.contradicted < CONTRADICTED_ALONE || self.supported > 0
    }

    /// Keeps what was found about a camera, in place of what was known of its frame.
    fn keep(&mut self, checked: CheckedLines) {
        let verdict = |checked: &CheckedLines| checked.check.map(|check| check.verdict());
        let now = verdict(&checked);
        let before = self
            .known
            .insert(checked.frame.clone(), checked)
            .as_ref()
            .and_then(verdict);
        for (of, count) in [
            (LineVerdict::Contradicts, &mut self.contradicted),
            (LineVerdict::Supports, &mut self.supported),
        ] {
            *count += usize::from(now == Some(of));
            *count -= usize::from(before == Some(of));
        }
    }

    /// The frames to be judged next: the shown one alone and first, then others in turn; none if
    /// all are known.
    fn next(&mut self, open: &mut OpenProject, shown: usize) -> Vec<FrameToCheck> {
        let count = open.document.frames.len();
        let mut wanted: Vec<FrameToCheck> = self.lacking(open, shown).into_iter().collect();
        if wanted.is_empty() {
            for _ in 0..LOOKED_THROUGH.min(count) {
                self.cursor = (self.cursor + 1) % count;
                wanted.extend(self.lacking(open, self.cursor));
                if wanted.len() == BATCH {
                    break;
                }
            }
        }
        wanted
    }

    /// A solved frame of which it is not known what the paint says.
    fn lacking(&self, open: &mut OpenProject, index: usize) -> Option<FrameToCheck> {
        let frame = open.frame(index)?;
        let recorded = frame
            .solution
            .as_ref()
            .is_some_and(|solution| solution.line_check.is_some());
        if frame.status == FrameStatus::Rejected || recorded {
            return None;
        }
        let camera = open.document.pointed(frame)?;
        if self
            .known
            .get(&frame.id)
            .is_some_and(|known| known.camera == camera)
        {
            return None;
        }
        let frame = frame.id.clone();
        Some(FrameToCheck {
            index,
            frame,
            camera,
            field: open.field_of(index).ok(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz};
    use touchline_core::geometry::{ImagePoint, Vec3};

    fn checked(frame: usize, score: f64) -> CheckedLines {
        let base = CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            ImagePoint::new(960.0, 540.0),
        );
        let camera = PtzCamera::new(base, Ptz::from_degrees(0.0, -12.0, 2000.0));
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
            frame: FrameId::from(frame.to_string().as_str()),
            camera,
            check: Some(check),
        }
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
