//! Compares the cameras of all frames with the painted lines of their pictures, in the background
//! between edits. The results are kept beside the document; acceptance of a frame writes its result
//! into the document.

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

/// Maximum number of frames examined after an action to find those that lack a check, so that
/// actions on a long match stay quick.
const LOOKED_THROUGH: usize = 64;

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
    /// The field that the frame shows; none if it is invalid.
    field: Option<Arc<FieldModel>>,
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
        // Frames without a result are kept too, so that they are not checked again until their
        // camera changes.
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
    /// The line check of a frame's camera, if it is known.
    #[must_use]
    pub fn paint_says(&self, frame: usize) -> Option<PaintSays> {
        let open = self.open.as_ref()?;
        self.operations.line_checks.of(open, open.frame(frame)?)
    }

    /// Whether the line check contradicts a frame's camera.
    #[must_use]
    pub fn is_contradicted(&self, frame: usize) -> bool {
        self.paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts)
    }

    /// Starts the next batch of checks, if any frame lacks one and no step of undo is open. A
    /// running batch is not replaced; the next one starts when it has ended.
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

    /// Writes the line check of the shown frame's camera into the frame's solution, within an open
    /// step.
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

/// The line check of a camera, as the window shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintSays {
    /// The verdict.
    pub verdict: LineVerdict,
    /// Number of samples on the lines with paint nearby.
    pub found: usize,
    /// Number of samples on the lines where nothing hides the ground.
    pub open: usize,
    /// Median distance of the paint from the lines, px; none if no paint was found.
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

    /// The verdict in three words.
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
    /// Numbers of known cameras that are contradicted and supported. Counted incrementally, because
    /// every thumbnail that is drawn needs them.
    contradicted: usize,
    supported: usize,
    /// The index at which the search for unchecked frames continues.
    cursor: usize,
}

impl LineChecks {
    /// The line check of a frame's camera, if it is known. A check that the document records takes
    /// precedence.
    fn of(&self, open: &OpenProject, frame: &Frame) -> Option<PaintSays> {
        let recorded = frame
            .solution
            .as_ref()
            .and_then(|solution| solution.line_check.as_ref());
        let says = match recorded {
            Some(evidence) => PaintSays::recorded(evidence),
            None => PaintSays::of(&self.fresh(open, frame)?),
        };
        // A recorded warning takes precedence, because whoever found the camera may know more about
        // the paint than this single check, for instance from neighbouring frames or a measured
        // length of the field.
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

    /// The check of a frame's present camera that the document does not record yet.
    fn fresh(&self, open: &OpenProject, frame: &Frame) -> Option<LineCheck> {
        let known = self.known.get(&frame.id)?;
        (Some(known.camera) == open.document.pointed(frame))
            .then_some(known.check)
            .flatten()
    }

    const fn is_informative(&self) -> bool {
        self.contradicted < CONTRADICTED_ALONE || self.supported > 0
    }

    /// Stores a check in place of the frame's earlier one, and updates the counts.
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

    /// The frames to check next: the shown frame alone if it lacks a check, otherwise up to
    /// [`BATCH`] others in turn. Empty if none is found.
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

    /// The inputs of a frame's check, if the frame has a camera and lacks a check of it.
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
