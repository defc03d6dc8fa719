//! Three-way merge of two versions of a document: each frame and camera that only one side changed
//! is taken from that side.
//!
//! Only the users' work is merged. The program's suggestions are removed first and added to the
//! result in untouched frames, so that a suggestion never conflicts with a label.

use crate::document::{Camera, CameraId, Document, Frame, FrameId, Shared, Suggestion};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// The result of a merge.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The document with the changes of both.
    pub document: Document,
    /// The names of what both sides changed differently; our version was kept.
    pub conflicts: Vec<String>,
}

/// Merges our and their version of `base`, frame by frame and camera by camera. The order is
/// theirs; each frame that only we added is inserted behind its predecessor in our order.
pub fn merge(base: &Document, ours: &Document, theirs: &Document) -> Merged {
    merge_by([base, ours, theirs], |_, _| false)
}

/// Merges as [`merge`] does, but of a frame that both sides changed the one with more edits stays.
pub(crate) fn merge_newer(base: &Document, ours: &Document, theirs: &Document) -> Merged {
    merge_by([base, ours, theirs], |ours, theirs| {
        theirs.revision > ours.revision
    })
}

/// Merges, and decides by `is_theirs_kept` which side of a frame stays that both changed.
fn merge_by(
    [base, ours, theirs]: [&Document; 3],
    is_theirs_kept: fn(&Frame, &Frame) -> bool,
) -> Merged {
    // Only people's work is compared: a suggestion that one side replaced is no conflict.
    let edits = [base, ours, theirs].map(Document::without_suggestions);
    let mut merged = merge_edits(edits.each_ref(), is_theirs_kept);
    show_suggestions(&mut merged.document, [ours, theirs]);
    merged
}

/// Joins what a command made of a document that it `read` with what other programs made of it
/// meanwhile. A frame that is `now` as it was read takes the result. What others changed since
/// stays, and is named if the command changed it, too; a frame with fewer edits than when it was
/// read is an earlier state and no change.
///
/// None if cameras, field or anything else beside the frames are not the same in all three: angles
/// that belong to another base or field mean nothing in this one.
pub(crate) fn join_result(read: &Document, result: &Document, now: &Document) -> Option<Merged> {
    if ![result, now]
        .into_iter()
        .all(|other| read.same_beside_frames(other))
    {
        return None;
    }
    let mut now = now.clone();
    for position in 0..now.frames.len() {
        let frame = &now.frames[position];
        let Some(known) = read.frames.by_id(&frame.id) else {
            continue;
        };
        if frame.revision < known.revision {
            now.frames[position] = known.without_suggestion().into();
        } else if frame == known && frame.shows_suggestion() {
            // A suggestion that was there at the reading gives way to that of the result.
            now.frames[position] = frame.without_suggestion().into();
        }
    }
    Some(merge(read, &now, result))
}

/// Merges documents without suggestions.
fn merge_edits(
    [base, ours, theirs]: [&Document; 3],
    is_theirs_kept: fn(&Frame, &Frame) -> bool,
) -> Merged {
    let mut conflicts = Vec::new();
    let frames = join(
        [
            &frames_by_id(base),
            &frames_by_id(ours),
            &frames_by_id(theirs),
        ],
        |one, other| one.has_content_of(other),
        |ours, theirs| {
            conflicts.push(ours.name());
            is_theirs_kept(ours, theirs)
        },
    );
    let cameras = join(
        [
            &cameras_by_id(base),
            &cameras_by_id(ours),
            &cameras_by_id(theirs),
        ],
        PartialEq::eq,
        |camera, _| {
            conflicts.push(format!("camera {}", camera.id));
            false
        },
    );
    let field = choose_whole(
        "the field",
        [&base.field, &ours.field, &theirs.field],
        &mut conflicts,
    );
    let click_noise = choose_whole(
        "the click noise",
        [&base.click_noise, &ours.click_noise, &theirs.click_noise],
        &mut conflicts,
    );
    let shots = choose_whole(
        "the shots",
        [&base.shots, &ours.shots, &theirs.shots],
        &mut conflicts,
    );
    let mut document = Document {
        generator: theirs.generator.clone(),
        conventions: join_maps(
            [&base.conventions, &ours.conventions, &theirs.conventions],
            &mut conflicts,
        ),
        field: field.clone(),
        cameras,
        frames: frames.into_iter().collect(),
        click_noise: click_noise.clone(),
        shots: shots.clone(),
        extra: join_maps([&base.extra, &ours.extra, &theirs.extra], &mut conflicts).into(),
    };
    raise_revisions(&mut document, [ours, theirs]);
    Merged {
        document,
        conflicts,
    }
}

/// Gives each frame the highest revision that it has on either side, so that later readers do not
/// take it for an earlier version.
fn raise_revisions(document: &mut Document, sides: [&Document; 2]) {
    for position in 0..document.frames.len() {
        let frame = &document.frames[position];
        let known = sides
            .into_iter()
            .filter_map(|side| side.frames.by_id(&frame.id));
        let highest = known.map(|frame| frame.revision).max().unwrap_or_default();
        if frame.revision < highest {
            document.frames[position].revision = highest;
        }
    }
}

/// Adds the suggestions of either side to untouched frames, if the camera still has the base for
/// which they were made. The first side takes precedence.
pub(super) fn show_suggestions(document: &mut Document, sides: [&Document; 2]) {
    for position in 0..document.frames.len() {
        let frame = &document.frames[position];
        if !frame.is_untouched() {
            continue;
        }
        // A suggestion states angles in one base. Under another base they point elsewhere, so it is
        // dropped rather than shown.
        let base = document.camera_of(frame).and_then(Camera::base);
        let suggestions = sides
            .into_iter()
            .filter_map(|side| shown_suggestion(side, &frame.id));
        if let Some(suggestion) = suggestions
            .into_iter()
            .find(|suggestion| suggestion.base == base)
        {
            suggestion.show_in(&mut document.frames[position]);
        }
    }
}

impl Document {
    /// Shows the suggestions of another document in frames that are still untouched.
    pub fn add_suggestions_of(&mut self, other: &Self) {
        show_suggestions(self, [other, other]);
    }
}

/// The suggestion that a document shows for a frame.
fn shown_suggestion(document: &Document, id: &FrameId) -> Option<Suggestion> {
    let frame = document.frames.by_id(id)?;
    Suggestion::in_frame(
        frame,
        document.camera_of(frame).and_then(Camera::base).as_ref(),
    )
}

/// Values in their order, each with its key.
type Keyed<K, V> = Vec<(K, V)>;

/// The frames of a document by their ids.
fn frames_by_id(document: &Document) -> Keyed<FrameId, Shared<Frame>> {
    document
        .frames
        .iter()
        .map(|frame| (frame.id.clone(), frame.clone()))
        .collect()
}

/// The cameras of a document by their ids.
fn cameras_by_id(document: &Document) -> Keyed<CameraId, Shared<Camera>> {
    document
        .cameras
        .iter()
        .map(|camera| (camera.id.clone(), camera.clone()))
        .collect()
}

/// Which side's value is taken.
enum Choice {
    /// Theirs; also if both are equal or only they changed it.
    Theirs,
    /// Ours.
    Ours,
    /// Ours, and theirs is lost.
    Conflict,
}

/// Decides which side's value is taken, given the base's, ours and theirs. None means that the side
/// does not have it.
fn choose<V>([base, ours, theirs]: [Option<&V>; 3], is_same: fn(&V, &V) -> bool) -> Choice {
    // A side that equals the base has not changed the value, so the other side decides, also by a
    // removal.
    if are_same(ours, theirs, is_same) || are_same(base, ours, is_same) {
        Choice::Theirs
    } else if are_same(base, theirs, is_same) {
        Choice::Ours
    } else if ours.is_none() {
        // They changed what we removed: keep their change.
        Choice::Theirs
    } else {
        Choice::Conflict
    }
}

/// The value of the chosen side, for a part of a document that is not merged within. Adds its name
/// to the conflicts if theirs is lost.
fn choose_whole<'a, V: PartialEq>(
    name: &str,
    [base, ours, theirs]: [&'a V; 3],
    conflicts: &mut Vec<String>,
) -> &'a V {
    match choose([base, ours, theirs].map(Some), PartialEq::eq) {
        Choice::Theirs => theirs,
        Choice::Ours => ours,
        Choice::Conflict => {
            conflicts.push(name.to_owned());
            ours
        }
    }
}

fn are_same<V>(one: Option<&V>, other: Option<&V>, is_same: fn(&V, &V) -> bool) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => is_same(one, other),
        (one, other) => one.is_none() && other.is_none(),
    }
}

/// Three-way merge of lists of keyed values. `conflict` hears of what both sides changed
/// differently, and says whether theirs stays.
fn join<K: Ord + Clone, V: Clone>(
    [base, ours, theirs]: [&Keyed<K, V>; 3],
    is_same: fn(&V, &V) -> bool,
    mut conflict: impl FnMut(&V, &V) -> bool,
) -> Vec<V> {
    let [in_base, in_ours, in_theirs]: [BTreeMap<K, V>; 3] =
        [base, ours, theirs].map(|values| values.iter().cloned().collect());
    let mut take = |key: &K| {
        let (base, ours, theirs) = (in_base.get(key), in_ours.get(key), in_theirs.get(key));
        match choose([base, ours, theirs], is_same) {
            Choice::Theirs => theirs.cloned(),
            Choice::Ours => ours.cloned(),
            Choice::Conflict => match (ours, theirs) {
                (Some(ours), Some(theirs)) if conflict(ours, theirs) => Some(theirs.clone()),
                _ => ours.cloned(),
            },
        }
    };
    // Their order first, without what the merge removes.
    let from_theirs: Keyed<K, V> = theirs
        .iter()
        .filter_map(|(key, _)| take(key).map(|value| (key.clone(), value)))
        .collect();

    // Then ours that they lack, each behind the nearest predecessor of our order that is in the
    // result. They are collected by that predecessor and inserted in one pass, because a document
    // may have added hundreds of thousands of frames.
    let there: BTreeSet<&K> = from_theirs.iter().map(|(key, _)| key).collect();
    let mut added: BTreeMap<Option<&K>, Vec<V>> = BTreeMap::new();
    let mut predecessor = None;
    for (key, _) in ours {
        if there.contains(key) {
            predecessor = Some(key);
        } else if !in_theirs.contains_key(key) {
            added.entry(predecessor).or_default().extend(take(key));
        }
    }
    let mut joined = added.remove(&None).unwrap_or_default();
    for (key, value) in &from_theirs {
        joined.push(value.clone());
        joined.extend(added.remove(&Some(key)).unwrap_or_default());
    }
    joined
}

type Keys = Map<String, Value>;

/// Three-way merge of the entries of JSON objects.
fn join_maps(sides: [&Keys; 3], conflicts: &mut Vec<String>) -> Keys {
    let [base, ours, theirs] = sides.map(entries_by_key);
    join([&base, &ours, &theirs], PartialEq::eq, |(key, _), _| {
        conflicts.push(key.clone());
        false
    })
    .into_iter()
    .collect()
}

/// The entries of a JSON object. Each value has its key beside it, to name it in a conflict.
fn entries_by_key(map: &Keys) -> Keyed<String, (String, Value)> {
    map.iter()
        .map(|(key, value)| (key.clone(), (key.clone(), value.clone())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, FrameStatus};
    use crate::testing::{SMALL, document, names_and_comments};
    use crate::testing::{new_frame, ptz_at};
    use touchline_core::geometry::ImagePoint;
    use touchline_core::testing::base_at;

    fn comment(document: &mut Document, name: &str, comment: &str) {
        let frame = document
            .frames
            .iter_mut()
            .find(|frame| frame.name() == name)
            .unwrap();
        frame.comment = Some(comment.to_owned());
    }

    #[test]
    fn the_changes_of_both_are_there() {
        let base = document(&["a", "b", "c", "d"]);
        let (mut ours, mut theirs) = (base.clone(), base.clone());
        comment(&mut ours, "b", " ours");
        comment(&mut theirs, "c", " theirs");
        ours.frames.remove(0);
        theirs.frames.remove(3);
        ours.frames.insert(2, new_frame("new", SMALL).into());
        theirs.field.template = "futsal".to_owned();
        ours.extra.insert("note".to_owned(), "ours".into());
        theirs
            .cameras
            .push(Camera::new("second".into(), SMALL).into());
        let Merged {
            document,
            conflicts,
        } = merge(&base, &ours, &theirs);
        assert_eq!(names_and_comments(&document), ["b ours", "c theirs", "new"]);
        assert_eq!(conflicts, [""; 0]);
        assert_eq!(
            (document.field.template.as_str(), document.cameras.len()),
            ("futsal", 2)
        );
        assert_eq!(document.extra["note"], "ours");
    }

    #[test]
    fn what_both_changed_is_named_and_ours_stays() {
        let base = document(&["a", "b", "c"]);
        let (mut ours, mut theirs) = (base.clone(), base.clone());
        comment(&mut ours, "a", " ours");
        comment(&mut theirs, "a", " theirs");
        ours.frames.remove(2);
        theirs.frames[2].comment = Some(" second".to_owned());
        let Merged {
            document,
            conflicts,
        } = merge(&base, &ours, &theirs);
        assert_eq!(
            names_and_comments(&document),
            ["a ours", "b", "c second"],
            "work is not lost to a removal"
        );
        assert_eq!(conflicts, ["a"]);
        let same = merge(&base, &ours, &ours);
        assert_eq!((same.document, same.conflicts.len()), (ours, 0));
    }

    fn suggest(document: &mut Document, name: &str, pan_deg: f64) {
        let frame = document
            .frames
            .iter_mut()
            .find(|frame| frame.name() == name)
            .unwrap();
        frame.ptz = ptz_at(pan_deg, -9.0, 900.0);
        frame.status = FrameStatus::Suggested;
    }

    #[test]
    fn what_is_suggested_never_beats_what_a_person_did() {
        let base = document(&["a", "b", "c", "d"]);
        let (mut ours, mut theirs) = (base.clone(), base.clone());
        suggest(&mut ours, "a", 1.0);
        suggest(&mut ours, "b", 1.0);
        suggest(&mut theirs, "b", 2.0);
        suggest(&mut theirs, "c", 2.0);
        suggest(&mut theirs, "d", 2.0);
        let accepted = theirs.frames.iter_mut().next().unwrap();
        accepted
            .clicks
            .push(Click::without_name(ImagePoint::new(1.0, 1.0)));
        accepted.status = FrameStatus::Reference;
        comment(&mut ours, "d", " ours");
        let Merged {
            document,
            conflicts,
        } = merge(&base, &ours, &theirs);
        assert_eq!(conflicts, [""; 0], "no frame was changed on both sides");
        let statuses: Vec<FrameStatus> = document.frames.iter().map(|frame| frame.status).collect();
        assert_eq!(
            statuses,
            [
                FrameStatus::Reference,
                FrameStatus::Suggested,
                FrameStatus::Suggested,
                FrameStatus::Suggested
            ]
        );
        let pan_deg = |at: usize| document.frames[at].ptz.as_ref().map(|ptz| ptz.pan_deg);
        assert_eq!(
            [pan_deg(0), pan_deg(1), pan_deg(2)],
            [None, Some(1.0), Some(2.0)]
        );
        assert_eq!(
            document.frames[3].comment.as_deref(),
            Some(" ours"),
            "a suggestion replaces no comment"
        );
    }

    #[test]
    fn what_is_suggested_for_another_base_is_left_out() {
        let base = document(&["a"]);
        let (mut ours, theirs) = (base.clone(), base.clone());
        suggest(&mut ours, "a", 1.0);
        let mut moved = theirs;
        moved.cameras[0].set_base(&base_at([0.0, -60.0, 18.0], SMALL));
        assert_eq!(
            merge(&base, &ours, &moved).document.frames[0].status,
            FrameStatus::New
        );
    }

    #[test]
    fn frames_that_we_added_follow_their_predecessors_in_the_order_of_theirs() {
        let base = document(&["a", "b", "c"]);
        let mut ours = document(&["x", "a", "p", "b", "q", "c", "r"]);
        comment(&mut ours, "p", "!");
        let theirs = document(&["c", "d", "a"]);
        let Merged {
            document,
            conflicts,
        } = merge(&base, &ours, &theirs);
        assert_eq!(
            names_and_comments(&document),
            ["x", "c", "r", "d", "a", "p!", "q"]
        );
        assert_eq!(conflicts, [""; 0]);
    }

    #[test]
    fn a_count_of_edits_is_no_change_and_never_goes_back() {
        let base = document(&["a"]);
        let (mut ours, mut theirs) = (base.clone(), base.clone());
        ours.frames[0].revision = 5;
        comment(&mut theirs, "a", " theirs");
        theirs.frames[0].revision = 1;
        let Merged {
            document,
            conflicts,
        } = merge(&base, &ours, &theirs);
        assert_eq!(
            (names_and_comments(&document), conflicts.len()),
            (vec!["a theirs".to_owned()], 0)
        );
        assert_eq!(document.frames[0].revision, 5);
    }
}
