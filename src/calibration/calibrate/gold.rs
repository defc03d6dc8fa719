//! Chooses the references that the annotator clicks again, blind, to measure the click noise.

use std::collections::BTreeSet;
use touchline_core::field::LandmarkId;
use touchline_core::geometry::Angle;
use touchline_documents::document::{Document, Frame};

/// Number of gold frames: with three landmarks each, one round suffices for an estimate of the
/// noise.
const CHOSEN: usize = 6;

/// Chooses references as gold frames, by their indices, until there are six with those that are
/// gold already.
///
/// Greedy: the next frame is the one that adds most landmarks not yet among the gold frames, and
/// among equals the one whose pan is farthest from all their pans.
pub fn choose_gold(document: &Document) -> Vec<usize> {
    let gold: Vec<&Frame> = document
        .frames
        .iter()
        .map(|frame| &**frame)
        .filter(|frame| frame.gold)
        .collect();
    let mut pans: Vec<Angle> = gold.iter().map(|frame| pan_or_zero(frame)).collect();
    let mut repeated: BTreeSet<&LandmarkId> = gold
        .into_iter()
        .flat_map(Frame::landmarks_to_repeat)
        .collect();
    let mut open: Vec<(usize, &Frame)> = document
        .frames
        .iter()
        .enumerate()
        .map(|(index, frame)| (index, &**frame))
        .filter(|(_, frame)| !frame.gold && frame.why_not_gold().is_none())
        .collect();
    let mut chosen = Vec::new();
    // A greedy choice: to find the frames that have the most landmarks together is a set cover
    // problem.
    while pans.len() < CHOSEN && !open.is_empty() {
        // `max_by` returns the last of equal elements: reversed, that is the first frame.
        let best = (0..open.len()).rev().max_by(|a, b| {
            let [a, b] = [*a, *b].map(|at| gain(open[at].1, &repeated, &pans));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let Some(best) = best else { break };
        let (index, frame) = open.remove(best);
        repeated.extend(frame.landmarks_to_repeat());
        pans.push(pan_or_zero(frame));
        chosen.push(index);
    }
    chosen.sort_unstable();
    chosen
}

/// What a frame adds to the gold frames: the number of its landmarks that are not yet `repeated`,
/// and the distance of its pan from the nearest of theirs, rad (infinite without one).
fn gain(frame: &Frame, repeated: &BTreeSet<&LandmarkId>, pans: &[Angle]) -> (usize, f64) {
    let new_landmarks: BTreeSet<&LandmarkId> = frame
        .landmarks_to_repeat()
        .filter(|id| !repeated.contains(id))
        .collect();
    let apart = pans
        .iter()
        .map(|other| pan_or_zero(frame).turn_from(*other).abs().radians());
    (new_landmarks.len(), apart.fold(f64::INFINITY, f64::min))
}

fn pan_or_zero(frame: &Frame) -> Angle {
    frame.ptz.as_ref().map_or(Angle::ZERO, |ptz| ptz.ptz().pan)
}

/// Whether [`choose_gold`] would choose any frame, given the numbers of gold frames and of others
/// that could be gold (see [`Frame::why_not_gold`]).
pub const fn can_choose_gold(gold: usize, others: usize) -> bool {
    gold < CHOSEN && others > 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::FrameStatus;
    use touchline_documents::testing::reference;
    use touchline_documents::testing::soccer_document;

    #[test]
    fn chosen_frames_spread_over_landmarks_and_pan() {
        let mut document = soccer_document();
        let mut draft = reference(90.0, &["halfway_far"]);
        draft.status = FrameStatus::Draft;
        let frames = [
            reference(0.0, &["centre_mark"]),
            reference(0.1, &["centre_mark", "halfway_far"]),
            reference(25.0, &["centre_mark"]),
            reference(-30.0, &["penalty_mark_left"]),
            reference(1.0, &[]),
            draft,
        ];
        document.frames.extend(frames.into_iter().map(Into::into));
        assert_eq!(choose_gold(&document), [0, 1, 2, 3]);
        for index in 0..20 {
            document
                .frames
                .push(reference(-29.0 + 0.1 * f64::from(index), &["penalty_mark_left"]).into());
        }
        let chosen = choose_gold(&document);
        assert_eq!(chosen.len(), CHOSEN);
        assert!(chosen.contains(&1) && chosen.contains(&2), "{chosen:?}");
        document.frames[2].gold = true;
        document.frames[3].gold = true;
        assert!(!choose_gold(&document).contains(&2));
        assert_eq!(choose_gold(&document).len(), CHOSEN - 2);
        let can_choose = |document: &Document| {
            let could = |frame: &Frame| !frame.gold && frame.why_not_gold().is_none();
            let count = |wanted: fn(&Frame) -> bool| {
                document.frames.iter().filter(|frame| wanted(frame)).count()
            };
            can_choose_gold(count(|frame| frame.gold), count(could))
        };
        for index in choose_gold(&document) {
            assert!(can_choose(&document));
            document.frames[index].gold = true;
        }
        assert!(!can_choose(&document) && choose_gold(&document).is_empty());
    }
}
