//! Joins what two people made of one document: each frame and camera that only one of them changed is taken from that one.

use super::{Change, Document, Edit, OldChange};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Two versions of a document joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The document with the changes of both.
    pub document: Document,
    /// What both changed differently, by name; ours was kept.
    pub conflicts: Vec<String>,
}

/// Joins what we and they made of `base`, frame by frame and camera by camera. The order is theirs; what only we added follows
/// what it follows with us.
#[must_use]
pub fn merge(base: &Document, ours: &Document, theirs: &Document) -> Merged {
    let mut conflicts = Vec::new();
    let frames = |document: &Document| -> Keyed<_, _> {
        document.frames.iter().map(|frame| (frame.id.clone(), frame.clone())).collect()
    };
    let frames = join(&frames(base), &frames(ours), &frames(theirs), |frame| conflicts.push(frame.name()));
    let cameras = |document: &Document| -> Keyed<_, _> {
        document.cameras.iter().map(|camera| (camera.id.clone(), camera.clone())).collect()
    };
    let cameras = join(&cameras(base), &cameras(ours), &cameras(theirs), |camera| {
        conflicts.push(format!("camera {}", camera.id));
    });
    let mut whole = |what: &str, choice: Choice| -> bool {
        if matches!(choice, Choice::Conflict) {
            conflicts.push(what.to_owned());
        }
        matches!(choice, Choice::Theirs)
    };
    let field = whole("the field", choose(Some(&base.field), Some(&ours.field), Some(&theirs.field)));
    let noise = choose(Some(&base.click_noise), Some(&ours.click_noise), Some(&theirs.click_noise));
    let noise = whole("the click noise", noise);
    let shots = whole("the shots", choose(Some(&base.shots), Some(&ours.shots), Some(&theirs.shots)));
    let of = |is_theirs: bool| if is_theirs { theirs } else { ours };
    let document = Document {
        generator: theirs.generator.clone(),
        conventions: join_maps(&base.conventions, &ours.conventions, &theirs.conventions, &mut conflicts),
        field: of(field).field.clone(),
        cameras,
        frames: frames.into_iter().collect(),
        click_noise: of(noise).click_noise.clone(),
        shots: of(shots).shots.clone(),
        extra: join_maps(&base.extra, &ours.extra, &theirs.extra, &mut conflicts).into(),
    };
    Merged { document, conflicts }
}

/// Puts the frames that edits hold into a document that the edits do not start from: a frame that is there is replaced,
/// another is added. What the edits removed cannot be known and stays.
#[must_use]
pub fn graft(edits: &[Edit], onto: &Document) -> Document {
    let held = edits.iter().flat_map(|edit| &edit.changes).flat_map(|change| match change {
        Change::Frame { frame, .. } | Change::Old(OldChange::Frame { frame, .. }) => std::slice::from_ref(frame),
        Change::Insert { frames, .. } | Change::Old(OldChange::Frames { insert: frames, .. }) => frames,
        Change::Remove(_) | Change::Order(_) | Change::Cameras(_) | Change::Field(_) | Change::Rest { .. } => &[],
    });
    let mut document = onto.clone();
    for frame in held {
        let same_picture = || document.frames.iter().position(|known| known.name() == frame.name());
        let place = document.frames.position_of(&frame.id).or_else(same_picture);
        match place.and_then(|place| document.frames.get_mut(place)) {
            Some(known) => {
                let (id, revision) = (known.id.clone(), known.revision);
                *known = frame.clone();
                known.id = id;
                known.revision = revision;
            }
            None => document.frames.push(frame.clone()),
        }
    }
    document.count_edits_since(onto);
    document
}

/// Values in their order, each with what tells it apart.
type Keyed<K, V> = Vec<(K, V)>;

/// Whose value is taken.
enum Choice {
    /// Theirs, which is ours too where we changed nothing.
    Theirs,
    /// Ours.
    Ours,
    /// Ours, and theirs is lost.
    Conflict,
}

fn choose<V: PartialEq>(base: Option<&V>, ours: Option<&V>, theirs: Option<&V>) -> Choice {
    if ours == theirs || base == ours {
        Choice::Theirs
    } else if base == theirs {
        Choice::Ours
    } else if ours.is_none() {
        // What they made of something that we removed stays.
        Choice::Theirs
    } else {
        Choice::Conflict
    }
}

fn join<K: Ord + Clone, V: Clone + PartialEq>(
    base: &Keyed<K, V>,
    ours: &Keyed<K, V>,
    theirs: &Keyed<K, V>,
    mut conflict: impl FnMut(&V),
) -> Vec<V> {
    let table = |values: &Keyed<K, V>| values.iter().cloned().collect::<BTreeMap<_, _>>();
    let (in_base, in_ours, in_theirs) = (table(base), table(ours), table(theirs));
    let mut take = |key: &K| {
        let (base, ours, theirs) = (in_base.get(key), in_ours.get(key), in_theirs.get(key));
        match choose(base, ours, theirs) {
            Choice::Theirs => theirs.cloned(),
            Choice::Ours => ours.cloned(),
            Choice::Conflict => {
                ours.into_iter().for_each(&mut conflict);
                ours.cloned()
            }
        }
    };
    let mut joined: Keyed<K, V> =
        theirs.iter().filter_map(|(key, _)| take(key).map(|value| (key.clone(), value))).collect();
    let mut there: BTreeSet<K> = joined.iter().map(|(key, _)| key.clone()).collect();
    for (place, (key, _)) in ours.iter().enumerate() {
        if in_theirs.contains_key(key) {
            continue;
        }
        let Some(value) = take(key) else { continue };
        let before = ours[..place].iter().rev().find(|(key, _)| there.contains(key));
        let at = before.and_then(|(before, _)| joined.iter().position(|(key, _)| key == before)).map_or(0, |at| at + 1);
        joined.insert(at, (key.clone(), value));
        there.insert(key.clone());
    }
    joined.into_iter().map(|(_, value)| value).collect()
}

type Keys = Map<String, Value>;

fn join_maps(base: &Keys, ours: &Keys, theirs: &Keys, conflicts: &mut Vec<String>) -> Keys {
    let entries = |map: &Keys| -> Keyed<String, (String, Value)> {
        map.iter().map(|(key, value)| (key.clone(), (key.clone(), value.clone()))).collect()
    };
    join(&entries(base), &entries(ours), &entries(theirs), |(key, _)| conflicts.push(key.clone())).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, FieldSpec, Frame};
    use crate::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(64, 48);

    fn document(names: &[&str]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        document.cameras.push(Camera::new("main".into(), SIZE).into());
        document.frames = names.iter().map(|name| Frame::from_image(name, "main".into(), SIZE).into()).collect();
        document
    }

    fn comment(document: &mut Document, name: &str, comment: &str) {
        let frame = document.frames.iter_mut().find(|frame| frame.name() == name).unwrap();
        frame.comment = Some(comment.to_owned());
    }

    fn told(document: &Document) -> Vec<String> {
        document.frames.iter().map(|frame| frame.name() + frame.comment.as_deref().unwrap_or_default()).collect()
    }

    #[test]
    fn the_changes_of_both_are_there() {
        let base = document(&["a", "b", "c", "d"]);
        let (mut ours, mut theirs) = (base.clone(), base.clone());
        comment(&mut ours, "b", " ours");
        comment(&mut theirs, "c", " theirs");
        ours.frames.remove(0);
        theirs.frames.remove(3);
        ours.frames.insert(2, Frame::from_image("new", "main".into(), SIZE).into());
        theirs.field.template = "futsal".to_owned();
        ours.extra.insert("note".to_owned(), "ours".into());
        theirs.cameras.push(Camera::new("second".into(), SIZE).into());
        let Merged { document, conflicts } = merge(&base, &ours, &theirs);
        assert_eq!(told(&document), ["b ours", "c theirs", "new"]);
        assert_eq!(conflicts, [""; 0]);
        assert_eq!((document.field.template.as_str(), document.cameras.len()), ("futsal", 2));
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
        let Merged { document, conflicts } = merge(&base, &ours, &theirs);
        assert_eq!(told(&document), ["a ours", "b", "c second"], "work is not lost to a removal");
        assert_eq!(conflicts, ["a"]);
        let same = merge(&base, &ours, &ours);
        assert_eq!((same.document, same.conflicts.len()), (ours, 0));
    }

    #[test]
    fn edits_of_an_unknown_document_bring_their_frames() {
        let base = document(&["a", "b"]);
        let mut ours = base.clone();
        comment(&mut ours, "b", " ours");
        ours.frames.push(Frame::from_image("new", "main".into(), SIZE).into());
        let edits = [Edit::between(&base, &ours, "Both")];
        let theirs = document(&["b", "z"]);
        assert_eq!(told(&graft(&edits, &theirs)), ["b ours", "z", "new"]);
    }
}
