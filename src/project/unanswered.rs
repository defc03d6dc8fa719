//! Frames that the forest was asked for in vain, and which of them is worth a person's clicks.

use super::{Document, Frame, FrameStatus, SolutionSource, shots};
use crate::geometry::Angle;
use std::collections::BTreeMap;

/// Gaps in pan are told apart by this much, degrees.
const BIN_DEG: f64 = 10.0;
/// A frame with a solved neighbour on one side only looks as that one does if it is no farther away.
const BESIDE: usize = 2;

/// What the forest has no answer for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unanswered {
    /// How many frames.
    pub frames: usize,
    /// The one to label next; none where every frame has its answer.
    pub label_next: Option<LabelNext>,
}

/// A frame whose label answers many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelNext {
    /// Its place in the document.
    pub frame: usize,
    /// Where it probably looks, by the frames around it, degrees; none where these do not tell.
    pub pan_deg: Option<f64>,
}

impl Frame {
    /// Whether the forest was asked for it in vain, and nobody has looked at it since.
    #[must_use]
    pub fn is_unanswered(&self) -> bool {
        let asked = self.solution.as_ref().is_some_and(|solution| solution.source == Some(SolutionSource::Forest));
        self.status == FrameStatus::New && self.ptz.is_none() && self.clicks.is_empty() && asked
    }

    /// Whether a label could help: its picture can be read.
    fn is_unanswered_by_view(&self) -> bool {
        let warnings = self.solution.iter().flat_map(|solution| &solution.warnings);
        self.is_unanswered() && warnings.map(|warning| warning.code.as_str()).all(|code| code != "picture")
    }

    /// Why the forest has no answer.
    #[must_use]
    pub fn no_answer(&self) -> Option<&str> {
        let warnings = self.solution.as_ref().filter(|_| self.is_unanswered()).map(|solution| &solution.warnings)?;
        warnings.first().map(|warning| warning.message.as_str())
    }
}

/// Counts the frames without an answer and picks the one to label: in the middle of those that look the same way, where most
/// do.
#[must_use]
pub fn unanswered(document: &Document) -> Unanswered {
    let frames = document.frames.iter().filter(|frame| frame.is_unanswered()).count();
    if frames == 0 {
        return Unanswered::default();
    }
    let mut by_pan: BTreeMap<i64, Vec<(usize, f64)>> = BTreeMap::new();
    let mut blind: Vec<usize> = Vec::new();
    for shot in shots(document) {
        let can_be_labelled = |&index: &usize| document.frames[index].is_unanswered_by_view();
        let here: Vec<usize> = shot.iter().copied().filter(can_be_labelled).collect();
        let pans = pans_of(document, &shot);
        let mut unknown = Vec::new();
        for index in here {
            match pan_between(&pans, index) {
                Some(pan_deg) => by_pan.entry((pan_deg / BIN_DEG).round() as i64).or_default().push((index, pan_deg)),
                None => unknown.push(index),
            }
        }
        if unknown.len() > blind.len() {
            blind = unknown;
        }
    }
    // Of equally large gaps the leftmost: nothing depends on the order of the frames.
    let largest = by_pan.into_values().rev().max_by_key(Vec::len);
    let label_next = match largest {
        Some(gap) if gap.len() >= blind.len() => {
            gap.get(gap.len() / 2).map(|&(frame, pan_deg)| LabelNext { frame, pan_deg: Some(pan_deg) })
        }
        _ => blind.get(blind.len() / 2).map(|&frame| LabelNext { frame, pan_deg: None }),
    };
    Unanswered { frames, label_next }
}

/// Where the solved frames of a shot look, by place.
fn pans_of(document: &Document, shot: &[usize]) -> Vec<(usize, f64)> {
    let solved = |&index: &usize| {
        let frame = &*document.frames[index];
        let ptz = frame.ptz.as_ref().filter(|_| frame.status != FrameStatus::Rejected)?;
        Some((index, ptz.pan_deg))
    };
    shot.iter().filter_map(solved).collect()
}

/// Where a frame probably looks: on the way between its solved neighbours, or as the only one beside it does.
fn pan_between(pans: &[(usize, f64)], index: usize) -> Option<f64> {
    let next = pans.partition_point(|&(solved, _)| solved < index);
    let before = next.checked_sub(1).and_then(|before| pans.get(before));
    match (before, pans.get(next)) {
        (Some(&(from, pan_from)), Some(&(to, pan_to))) => {
            let share = (index - from) as f64 / (to - from) as f64;
            let turn = Angle::from_degrees(pan_to - pan_from).wrapped().degrees();
            Some(Angle::from_degrees(pan_from + share * turn).wrapped().degrees())
        }
        (Some(&(beside, pan_deg)), None) | (None, Some(&(beside, pan_deg))) => {
            (beside.abs_diff(index) <= BESIDE).then_some(pan_deg)
        }
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ptz;
    use crate::geometry::ImageSize;
    use crate::project::{Clip, FieldSpec, FramePtz, Solution, SolutionWarning};

    /// Frames of shots: solved at a pan, or asked for in vain.
    fn document(frames: &[(i64, Option<f64>)]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for &(clip, pan_deg) in frames {
            let mut frame = Frame::from_image("x.jpg", "main".into(), ImageSize::new(64, 36));
            frame.clip = Some(Clip::Number(clip));
            let mut solution = Solution { source: Some(SolutionSource::Forest), ..Solution::default() };
            match pan_deg {
                Some(pan_deg) => {
                    frame.ptz = Some(FramePtz::new(Ptz::from_degrees(pan_deg, -9.0, 900.0), None));
                    frame.status = FrameStatus::Suggested;
                }
                None => solution.warnings.push(SolutionWarning::new("coverage", "3 of 30.".to_owned())),
            }
            frame.solution = Some(solution);
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn the_largest_gap_is_named_by_its_pan() {
        let frames =
            [(1, Some(0.0)), (1, None), (1, Some(2.0)), (2, Some(38.0)), (2, None), (2, None), (2, Some(41.0))];
        let document = document(&frames);
        let found = unanswered(&document);
        assert_eq!(found.frames, 3);
        let next = found.label_next.unwrap();
        assert_eq!(next.frame, 5);
        assert!((next.pan_deg.unwrap() - 40.0).abs() < 1e-9, "{next:?}");
        assert_eq!(document.frames[1].no_answer(), Some("3 of 30."));
        assert_eq!(document.frames[0].no_answer(), None);
    }

    #[test]
    fn far_from_the_only_solved_frame_nobody_knows_where_a_frame_looks() {
        let mut frames = vec![(1, Some(5.0))];
        frames.extend([(1, None); 9]);
        assert_eq!(unanswered(&document(&frames)).label_next, Some(LabelNext { frame: 6, pan_deg: None }));
        assert_eq!(unanswered(&document(&frames[..3])).label_next.unwrap().pan_deg, Some(5.0));
    }

    #[test]
    fn a_shot_without_any_answer_has_no_pan_and_a_clicked_frame_is_none_of_these() {
        let mut document = document(&[(1, Some(0.0)), (2, None), (2, None), (2, None)]);
        assert_eq!(unanswered(&document).label_next, Some(LabelNext { frame: 2, pan_deg: None }));
        document.frames[1].status = FrameStatus::Rejected;
        document.frames[2].status = FrameStatus::Draft;
        document.frames[3].solution = None;
        assert_eq!(unanswered(&document), Unanswered::default());
    }
}
