//! Which frames a camera is searched from, by the shots that a document lists.

use crate::autocalibrate::frames::sampled_frames::spread_evenly;
use std::collections::{BTreeMap, BTreeSet};
use touchline_documents::document::{Clip, Document, ShotContent, ShotKind, shots_of_frames};

/// Those of some frames that may show the field of one camera: they lie in no transition between
/// two shots, and in no shot that shows no field, unless all shots show none.
pub fn frames_of_fields(document: &Document, frames: &[usize]) -> Vec<usize> {
    let shots = shots_of_frames(document);
    let shot_of = |at: usize| shots[at].map(|shot| &document.shots[shot]);
    let all = frames.iter().copied();
    let clear: Vec<usize> = all
        .filter(|at| shot_of(*at).is_none_or(|shot| shot.kind != ShotKind::Transition))
        .collect();
    let fields = clear.iter().copied();
    let fields: Vec<usize> = fields
        .filter(|at| shot_of(*at).is_none_or(|shot| shot.content != Some(ShotContent::NoField)))
        .collect();
    if fields.is_empty() { clear } else { fields }
}

/// `count` of some frames at most, spread over the shots, and `count` at most of those with a
/// click. Ascending.
pub fn spread_over_shots_and_clicks(
    document: &Document,
    frames: &[usize],
    clicked: &[usize],
    count: usize,
) -> Vec<usize> {
    let spread = spread_over_shots(document, frames, count);
    let chosen: BTreeSet<usize> = spread
        .into_iter()
        .chain(spread_evenly(clicked, count))
        .collect();
    chosen.into_iter().collect()
}

/// `count` of some frames at most: an even spread, in which every other frame gives way to the
/// middle of a shot without one, where there are such shots. A short shot is thus not left out.
pub fn spread_over_shots(document: &Document, frames: &[usize], count: usize) -> Vec<usize> {
    let even: BTreeSet<usize> = spread_evenly(frames, count).collect();
    let mut shots: BTreeMap<Option<&Clip>, Vec<usize>> = BTreeMap::new();
    for &frame in frames {
        let clip = document.frames[frame].clip.as_ref();
        shots.entry(clip).or_default().push(frame);
    }
    let mut left_out: Vec<usize> = shots
        .values()
        .filter(|shot| !shot.iter().any(|frame| even.contains(frame)))
        .map(|shot| shot[shot.len() / 2])
        .collect();
    left_out.sort_unstable();
    let added: Vec<usize> = spread_evenly(&left_out, count / 2).collect();
    let even: Vec<usize> = even.into_iter().collect();
    let kept = spread_evenly(&even, count.saturating_sub(added.len()));
    let chosen: BTreeSet<usize> = kept.chain(added.iter().copied()).collect();
    chosen.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::cut_video;

    /// 200 frames: a long shot, a transition, a short shot, another long one.
    fn document() -> Document {
        let cuts = [
            (90, ShotKind::Transition),
            (101, ShotKind::Fade),
            (105, ShotKind::Cut),
        ];
        cut_video("a.mp4", 200, &cuts)
    }

    #[test]
    fn transitions_and_shots_without_a_field_are_left_out() {
        let mut document = document();
        let all: Vec<usize> = (0..200).collect();
        let clear = frames_of_fields(&document, &all);
        assert_eq!(clear.len(), 189);
        assert!(!clear.iter().any(|at| (90..101).contains(at)));
        document.shots[0].content = Some(ShotContent::NoField);
        assert_eq!(
            frames_of_fields(&document, &all),
            (101..200).collect::<Vec<_>>()
        );
        for shot in &mut document.shots {
            shot.content = Some(ShotContent::NoField);
        }
        assert_eq!(
            frames_of_fields(&document, &all),
            clear,
            "what is seen may be wrong"
        );
    }

    #[test]
    fn a_short_shot_gets_a_frame_and_a_single_shot_is_spread_as_before() {
        let document = document();
        let clear = frames_of_fields(&document, &(0..200).collect::<Vec<_>>());
        let chosen = spread_over_shots(&document, &clear, 6);
        assert_eq!(chosen.len(), 6);
        assert!(chosen.contains(&103), "{chosen:?}");
        let first: Vec<usize> = (0..90).collect();
        let even: Vec<usize> = spread_evenly(&first, 7).collect();
        assert_eq!(spread_over_shots(&document, &first, 7), even);
        assert_eq!(spread_over_shots(&document, &first, 0), [0; 0]);
    }
}
