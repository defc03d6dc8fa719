//! The results of line checks, and which frame is checked next. Results count only for the camera
//! and the field with which they were made.

use super::LineCheckSummary;
use super::batch::{CheckedLines, FrameToCheck, LineCheckBatch};
use super::offsets::{BESIDE_PX, LineOffset};
use crate::app::OpenProject;
use crate::app::operation::Slot;
use std::collections::{BTreeMap, BTreeSet};
use touchline_calibration::calibrate::LINE_CHECK;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{Document, FieldSpec, Frame, FrameId, FrameStatus};
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
pub(super) const CONTRADICTED_ALONE: usize = 4;

/// The line checks of the open document.
#[derive(Debug, Default)]
pub(in crate::app) struct LineChecks {
    pub(super) slot: Slot<LineCheckBatch>,
    known: BTreeMap<FrameId, CheckedLines>,
    /// The fields of the document for which they are known.
    fields: Vec<FieldSpec>,
    /// Numbers of known cameras that are contradicted and supported. Counted incrementally, because
    /// every thumbnail that is drawn needs them.
    contradicted: usize,
    supported: usize,
    /// The index at which the search for unchecked frames continues.
    cursor: usize,
    /// Frames that were accepted before their paint was looked at.
    pub(super) accepted_unchecked: BTreeSet<FrameId>,
}

/// Whether the camera's own warnings say that the paint contradicts it. Who found the camera may
/// know more of the paint than this one look: that the field is of another length, or the frames
/// beside.
fn is_warned(frame: &Frame) -> bool {
    frame
        .solution
        .iter()
        .flat_map(|solution| &solution.warnings)
        .any(|warning| warning.code == LINE_CHECK)
}

impl LineChecks {
    /// The line check of a frame's camera, if it is known. A check that the document records takes
    /// precedence.
    pub(super) fn frame_result(
        &self,
        open: &OpenProject,
        frame: &Frame,
    ) -> Option<LineCheckSummary> {
        let says = self.picture_result(open, frame)?;
        // Where lines contradict every camera they may be those of another sport. A warning of the
        // camera's own is evidence of another kind.
        let verdict = match says.verdict {
            // On the whole the paint is there, but one line lies beside it.
            LineVerdict::Supports if self.line_beside_paint(open, frame).is_some() => {
                LineVerdict::CannotSay
            }
            verdict if self.is_informative() || is_warned(frame) => verdict,
            _ => LineVerdict::CannotSay,
        };
        // One number everywhere: the line that is farthest from its paint, where lines are known.
        let farthest = self.offsets(open, frame).and_then(<[LineOffset]>::first);
        let offset_px = farthest.map_or(says.offset_px, |line| Some(line.offset_px.abs()));
        Some(LineCheckSummary {
            verdict,
            offset_px,
            ..says
        })
    }

    /// What the paint of a frame's own picture says, whatever is found in the other frames.
    pub(super) fn picture_result(
        &self,
        open: &OpenProject,
        frame: &Frame,
    ) -> Option<LineCheckSummary> {
        let recorded = frame
            .solution
            .as_ref()
            .and_then(|solution| solution.line_check.as_ref());
        let says = match recorded {
            Some(evidence) => LineCheckSummary::from_evidence(evidence),
            None => LineCheckSummary::from_check(&self.fresh(open, frame)?),
        };
        let verdict = if is_warned(frame) {
            LineVerdict::Contradicts
        } else {
            says.verdict
        };
        Some(LineCheckSummary { verdict, ..says })
    }

    /// The check of a frame's present camera that the document does not record yet.
    pub(super) fn fresh(&self, open: &OpenProject, frame: &Frame) -> Option<LineCheck> {
        let known = self.known.get(&frame.id)?;
        (Some(known.camera) == open.document.ptz_camera(frame))
            .then_some(known.check)
            .flatten()
    }

    /// How far the paint lies from the lines of a frame's present camera, if that is known.
    pub(super) fn offsets(&self, open: &OpenProject, frame: &Frame) -> Option<&[LineOffset]> {
        let known = self.known.get(&frame.id)?;
        let is_present = Some(known.camera) == open.document.ptz_camera(frame);
        is_present.then_some(&known.offsets)
    }

    /// The line of a frame's present camera that lies farthest beside its paint, if it does by
    /// [`BESIDE_PX`] or more.
    pub(super) fn line_beside_paint(
        &self,
        open: &OpenProject,
        frame: &Frame,
    ) -> Option<&LineOffset> {
        let limit_px = BESIDE_PX * frame.image_size.scale_from_1920();
        let farthest = self.offsets(open, frame)?.first()?;
        (farthest.offset_px.abs() >= limit_px).then_some(farthest)
    }

    /// Forgets all checks, and the running one, if the document's fields have changed: what lies on
    /// the lines of one field may lie beside those of another.
    pub(super) fn follow_fields(&mut self, document: &Document) {
        let now: Vec<&FieldSpec> = document.fields().collect();
        let mut pairs = now.iter().zip(&self.fields);
        let is_same =
            now.len() == self.fields.len() && pairs.all(|(now, before)| now.is_same_field(before));
        if !is_same {
            *self = Self {
                fields: now.into_iter().cloned().collect(),
                cursor: self.cursor,
                accepted_unchecked: std::mem::take(&mut self.accepted_unchecked),
                ..Self::default()
            };
        }
    }

    const fn is_informative(&self) -> bool {
        self.contradicted < CONTRADICTED_ALONE || self.supported > 0
    }

    /// Stores a check in place of the frame's earlier one, and updates the counts.
    pub(super) fn keep(&mut self, checked: CheckedLines) {
        let verdict = |checked: &CheckedLines| checked.check.map(|check| check.verdict());
        // Take the earlier check of the frame out of the counts, and add this one.
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

    /// The frames to be checked next: the shown one alone and first, then the selected ones, which
    /// are about to be accepted, then the others in turn; none if all are known.
    pub(super) fn next(
        &mut self,
        open: &mut OpenProject,
        shown: usize,
        selected: &BTreeSet<usize>,
    ) -> Vec<FrameToCheck> {
        let count = open.document.frames.len();
        let mut wanted: Vec<FrameToCheck> = self.lacking(open, shown, true).into_iter().collect();
        if wanted.is_empty() {
            wanted = self.next_selected(open, selected);
        }
        // Go on where the last search ended, in a circle, so that each frame has its turn.
        if wanted.is_empty() {
            for _ in 0..LOOKED_THROUGH.min(count) {
                self.cursor = (self.cursor + 1) % count;
                wanted.extend(self.lacking(open, self.cursor, false));
                if wanted.len() == BATCH {
                    break;
                }
            }
        }
        wanted
    }

    /// The first of the selected frames to be checked.
    fn next_selected(
        &self,
        open: &mut OpenProject,
        selected: &BTreeSet<usize>,
    ) -> Vec<FrameToCheck> {
        selected
            .iter()
            .take(SELECTED_LOOKED_THROUGH)
            .filter_map(|place| self.lacking(open, *place, false))
            .take(BATCH)
            .collect()
    }

    /// The inputs of a frame's check, if the frame has a camera and lacks a check of it. None while
    /// its field is not valid, which may end: the user's own templates are read in the background.
    /// The shown frame is checked even if its document records a check, which has no single lines.
    fn lacking(
        &self,
        open: &mut OpenProject,
        index: usize,
        is_shown: bool,
    ) -> Option<FrameToCheck> {
        let frame = open.frame(index)?;
        let recorded = frame
            .solution
            .as_ref()
            .is_some_and(|solution| solution.line_check.is_some());
        if frame.status == FrameStatus::Rejected || recorded && !is_shown {
            return None;
        }
        let camera = open.document.ptz_camera(frame)?;
        if self
            .known
            .get(&frame.id)
            .is_some_and(|known| known.camera == camera)
        {
            return None;
        }
        let frame = frame.id.clone();
        let field = open.field_of(index).ok()?;
        Some(FrameToCheck {
            index,
            frame,
            camera,
            field,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{imported, line_check_of, report};
    use super::*;

    fn checked(frame: usize, score: f64) -> CheckedLines {
        line_check_of(FrameId::from(frame.to_string().as_str()), score)
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
