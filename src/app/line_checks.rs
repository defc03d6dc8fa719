//! What the painted lines say about the frames' cameras: found in the background, beside the document.

use super::OpenProject;
use super::paint_orders::CheckedLines;
use crate::camera::PtzCamera;
use crate::document::{Frame, FrameId, FrameStatus, PaintEvidence};
use crate::paint::{LineCheck, LineVerdict};
use std::collections::BTreeMap;

/// As many frames are looked through after each action: an edit of a long match stays quick.
const LOOKED_THROUGH: usize = 64;

/// As many are judged in one order: a report every second or so.
const IN_ORDER: usize = 4;

/// If this many cameras are contradicted and none is supported, the lines in the pictures are not those of the field.
const CONTRADICTED_ALONE: usize = 4;

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
        Self { verdict: check.verdict(), found: check.found, open: check.found + check.bare, offset_px }
    }

    fn recorded(evidence: &PaintEvidence) -> Self {
        let open = evidence.found + evidence.bare;
        let verdict = LineVerdict::of(evidence.score, open);
        Self { verdict, found: evidence.found, open, offset_px: evidence.offset_px }
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
            (LineVerdict::Supports, None) => format!("on the painted lines ({found} of {open} open places)"),
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
pub(super) struct LineChecks {
    known: BTreeMap<FrameId, CheckedLines>,
    /// How many of the known cameras are contradicted, and how many supported: asked for each thumbnail that is drawn.
    contradicted: usize,
    supported: usize,
    /// The order under way, and what it is about.
    under_way: Option<(u64, Vec<(FrameId, PtzCamera)>)>,
    tickets: u64,
    /// Where the search for frames goes on.
    place: usize,
}

impl LineChecks {
    /// The checks of another document: reports of orders before are passed over.
    pub(super) fn for_another(&self) -> Self {
        Self { tickets: self.tickets, ..Self::default() }
    }

    /// What the paint says about a frame's camera, where that is known.
    pub(super) fn of(&self, open: &OpenProject, frame: &Frame) -> Option<PaintSays> {
        let recorded = frame.solution.as_ref().and_then(|solution| solution.line_check.as_ref());
        let says = match recorded {
            Some(evidence) => PaintSays::recorded(evidence),
            None => PaintSays::of(&self.fresh(open, frame)?),
        };
        let verdict = if self.is_informative() { says.verdict } else { LineVerdict::CannotSay };
        Some(PaintSays { verdict, ..says })
    }

    /// What was found about a frame's camera and is not in the document yet.
    pub(super) fn fresh(&self, open: &OpenProject, frame: &Frame) -> Option<LineCheck> {
        let known = self.known.get(&frame.id)?;
        (Some(known.camera) == open.document.pointed(frame)).then_some(known.check).flatten()
    }

    const fn is_informative(&self) -> bool {
        self.contradicted < CONTRADICTED_ALONE || self.supported > 0
    }

    /// Keeps what was found about a camera, in place of what was known of its frame.
    fn keep(&mut self, checked: CheckedLines) {
        let verdict = |checked: &CheckedLines| checked.check.map(|check| check.verdict());
        let now = verdict(&checked);
        let before = self.known.insert(checked.frame.clone(), checked).as_ref().and_then(verdict);
        for (of, count) in
            [(LineVerdict::Contradicts, &mut self.contradicted), (LineVerdict::Supports, &mut self.supported)]
        {
            *count += usize::from(now == Some(of));
            *count -= usize::from(before == Some(of));
        }
    }

    /// The frames to be judged next, the shown one alone and first; none while an order is under way.
    pub(super) fn next(&mut self, open: &OpenProject, shown: usize) -> Option<(u64, Vec<usize>)> {
        if self.under_way.is_some() {
            return None;
        }
        let count = open.document.frames.len();
        let mut wanted: Vec<(usize, FrameId, PtzCamera)> = self.lacking(open, shown).into_iter().collect();
        if wanted.is_empty() {
            for _ in 0..LOOKED_THROUGH.min(count) {
                self.place = (self.place + 1) % count;
                wanted.extend(self.lacking(open, self.place));
                if wanted.len() == IN_ORDER {
                    break;
                }
            }
        }
        if wanted.is_empty() {
            return None;
        }
        self.tickets += 1;
        let places = wanted.iter().map(|(index, ..)| *index).collect();
        self.under_way = Some((self.tickets, wanted.into_iter().map(|(_, id, camera)| (id, camera)).collect()));
        Some((self.tickets, places))
    }

    /// A solved frame of which it is not known what the paint says.
    fn lacking(&self, open: &OpenProject, index: usize) -> Option<(usize, FrameId, PtzCamera)> {
        let frame = open.frame(index)?;
        let recorded = frame.solution.as_ref().is_some_and(|solution| solution.line_check.is_some());
        if frame.status == FrameStatus::Rejected || recorded {
            return None;
        }
        let camera = open.document.pointed(frame)?;
        let known = self.known.get(&frame.id).is_some_and(|known| known.camera == camera);
        (!known).then(|| (index, frame.id.clone(), camera))
    }

    /// Takes a report in. Frames that the order was about and that nothing was found out of are not asked again.
    pub(super) fn take(&mut self, ticket: u64, found: Vec<CheckedLines>) {
        let Some((_, asked)) = self.under_way.take_if(|(known, _)| *known == ticket) else { return };
        for (frame, camera) in asked {
            self.keep(CheckedLines { frame, camera, check: None });
        }
        for checked in found {
            self.keep(checked);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase, Ptz};
    use crate::geometry::{ImagePoint, Vec3};

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
            agreement: score,
        };
        CheckedLines { frame: FrameId::from(frame.to_string().as_str()), camera, check: Some(check) }
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
        assert!(checks.is_informative() && (checks.contradicted, checks.supported) == (CONTRADICTED_ALONE - 1, 1));
        checks.keep(CheckedLines { check: None, ..checked(1, 1.0) });
        assert_eq!((checks.contradicted, checks.supported), (CONTRADICTED_ALONE - 1, 0));
    }
}
