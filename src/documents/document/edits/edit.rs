//! The changes between two states of a document, as the journal stores them: whole frames by their
//! ids, cameras and fields.

use crate::document::text::write::OWN_KEYS;
use crate::document::{
    Camera, Document, EditMismatch, Extra, FieldSpec, Frame, FrameId, Frames, Shared, Shot,
    StoredClickNoise,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// One edit: a name and what it changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Edit {
    /// In words: "Move centre mark".
    pub name: String,
    /// Its kind, for undo and redo.
    #[serde(default, skip_serializing_if = "EditKind::is_no_step")]
    pub kind: EditKind,
    /// The changes, in the order in which they are applied.
    pub changes: Vec<Change>,
}

/// The kind of an edit, for undo and redo.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EditKind {
    /// Not an undo step. No step before it can be undone.
    #[default]
    NoStep,
    /// An undo step with the edit's name.
    Step {
        /// The frame it concerns, as [`crate::document::Step::frame`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frame: Option<FrameId>,
    },
    /// A continuation of the previous step, such as a repeated arrow key.
    Continued,
    /// The last step, undone.
    Undone,
    /// The redo of the step that was undone last.
    Redone,
}

impl EditKind {
    const fn is_no_step(&self) -> bool {
        matches!(self, Self::NoStep)
    }
}

/// A part of the document that changed, with its new value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// A frame.
    Frame {
        /// Which.
        id: FrameId,
        /// The revision that was changed.
        revision: u64,
        /// Its new state.
        frame: Shared<Frame>,
    },
    /// Frames that are removed.
    Remove(Vec<FrameId>),
    /// Frames that are added.
    Insert {
        /// The frame behind which they are inserted; none for the beginning.
        after: Option<FrameId>,
        /// Which.
        frames: Vec<Shared<Frame>>,
    },
    /// All frames in a new order.
    Order(Vec<FrameId>),
    /// The cameras.
    Cameras(Vec<Shared<Camera>>),
    /// The field.
    Field(FieldSpec),
    /// The other contents of the document.
    Rest {
        /// The conventions.
        conventions: Map<String, Value>,
        /// Its click noise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        click_noise: Option<StoredClickNoise>,
        /// Its shots.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        shots: Vec<Shot>,
        /// Unknown keys.
        extra: Extra,
    },
}

impl Edit {
    /// The edit from `before` to `after`; frames that both share are not compared.
    pub fn between(before: &Document, after: &Document, name: &str) -> Self {
        let mut changes = Vec::new();
        if before.field != after.field {
            changes.push(Change::Field(after.field.clone()));
        }
        if before.cameras != after.cameras {
            changes.push(Change::Cameras(after.cameras.clone()));
        }
        let rest = Change::rest(after);
        if Change::rest(before) != rest {
            changes.push(rest);
        }
        frame_changes(&before.frames, &after.frames, &mut changes);
        Self {
            name: name.to_owned(),
            kind: EditKind::NoStep,
            changes,
        }
    }

    /// The same edit with another kind.
    #[must_use]
    pub fn with_kind(self, kind: EditKind) -> Self {
        Self { kind, ..self }
    }

    /// Whether it changes nothing.
    pub const fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Applies the changes.
    ///
    /// # Errors
    /// A frame does not exist, or has another revision than the edited one. The document is then
    /// unchanged.
    pub fn apply(self, document: &mut Document) -> Result<(), EditMismatch> {
        apply_all(self.changes, document)
    }
}

/// Applies changes in order, or none of them if one does not fit.
pub(super) fn apply_all(changes: Vec<Change>, document: &mut Document) -> Result<(), EditMismatch> {
    // The copy for the case of a misfit is cheap: it shares cameras and frames with the document.
    let before = document.clone();
    for change in changes {
        if let Err(mismatch) = change.apply(document) {
            *document = before;
            return Err(mismatch);
        }
    }
    Ok(())
}

impl Change {
    /// The contents of a document other than its frames, cameras and field.
    fn rest(document: &Document) -> Self {
        Self::Rest {
            conventions: document.conventions.clone(),
            click_noise: document.click_noise.clone(),
            shots: document.shots.clone(),
            extra: document.extra.clone(),
        }
    }

    /// A frame that differs from its known state.
    fn between_frames(known: &Frame, frame: &Shared<Frame>) -> Self {
        Self::Frame {
            id: known.id.clone(),
            revision: known.revision,
            frame: frame.clone(),
        }
    }

    fn apply(self, document: &mut Document) -> Result<(), EditMismatch> {
        match self {
            Self::Frame {
                id,
                revision,
                frame,
            } => {
                // The revision shows whether the frame is still the one that was edited: the same
                // edit may arrive twice, and other edits may have come before it. A new state under
                // another id would leave two frames with one id.
                let Some(place) = document.frames.by_id_mut(&id) else {
                    return Err(EditMismatch::NoFrame { id });
                };
                if place.revision != revision {
                    return Err(EditMismatch::Revision {
                        id,
                        made_on: revision,
                        found: place.revision,
                    });
                }
                if frame.id != id {
                    return Err(EditMismatch::OtherFrame {
                        id,
                        found: frame.id.clone(),
                    });
                }
                *place = frame;
            }
            Self::Remove(ids) => {
                let gone: BTreeSet<FrameId> = ids.into_iter().collect();
                if let Some(id) = gone.iter().find(|id| document.frames.by_id(id).is_none()) {
                    return Err(EditMismatch::NoFrame { id: id.clone() });
                }
                document.frames.retain(|frame| !gone.contains(&frame.id));
            }
            Self::Insert { after, frames } => insert(document, after, frames)?,
            Self::Order(ids) => {
                let (ordered, frames) = (ids.len(), document.frames.len());
                // Each frame exactly once: one that is named twice would get a new id when it is
                // collected the second time.
                let is_each_once =
                    ordered == frames && ids.iter().collect::<BTreeSet<_>>().len() == frames;
                let in_order = ids.iter().map(|id| document.frames.by_id(id).cloned());
                document.frames = in_order
                    .collect::<Option<Frames>>()
                    .filter(|_| is_each_once)
                    .ok_or(EditMismatch::Order { ordered, frames })?;
            }
            Self::Cameras(cameras) => document.cameras = cameras,
            Self::Field(field) => document.field = field,
            Self::Rest {
                conventions,
                click_noise,
                shots,
                mut extra,
            } => {
                // No program writes such keys there; written back as unknown keys they would
                // replace the document's own.
                extra.retain(|key, _| !OWN_KEYS.contains(&key.as_str()));
                document.conventions = conventions;
                document.click_noise = click_noise;
                document.shots = shots;
                document.extra = extra;
            }
        }
        Ok(())
    }
}

fn insert(
    document: &mut Document,
    after: Option<FrameId>,
    frames: Vec<Shared<Frame>>,
) -> Result<(), EditMismatch> {
    if let Some(present) = frames
        .iter()
        .find(|frame| document.frames.by_id(&frame.id).is_some())
    {
        return Err(EditMismatch::Present {
            id: present.id.clone(),
        });
    }
    let at = match after {
        None => 0,
        Some(id) => {
            document
                .frames
                .position_of(&id)
                .ok_or(EditMismatch::NoFrame { id })?
                + 1
        }
    };
    document.frames.insert_all(at, frames);
    Ok(())
}

impl Document {
    /// Raises the revision of each frame that differs from an earlier state. Frames that undo
    /// restored count as edited, too.
    pub fn count_edits_since(&mut self, before: &Self) {
        for position in self.frames.differences(&before.frames) {
            let Some(frame) = self.frames.get(position) else {
                continue;
            };
            // A frame that others pushed to another position is found by its id. One without an
            // earlier state is new and has no edit to count.
            let known = before
                .frames
                .get(position)
                .filter(|known| known.id == frame.id);
            let Some(known) = known.or_else(|| before.frames.by_id(&frame.id)) else {
                continue;
            };
            // A higher revision has counted this edit already. A lower one comes from undo, whose
            // state must not look like the one that it replaces.
            if frame.revision <= known.revision && frame != known {
                let revision = known.next_revision();
                self.frames[position].revision = revision;
            }
        }
    }
}

/// Collects the changes of frames: those that changed, those removed, those added, and, if the
/// order differs, the new order of all.
fn frame_changes(before: &Frames, after: &Frames, changes: &mut Vec<Change>) {
    let differ = after.differences(before);
    // The usual case: frames changed in place.
    if before.len() == after.len()
        && differ
            .iter()
            .all(|&position| before[position].id == after[position].id)
    {
        changes.extend(
            differ
                .into_iter()
                .map(|position| Change::between_frames(&before[position], &after[position])),
        );
        return;
    }

    // Otherwise in the order in which edits are applied: changed frames, removed frames, runs of
    // added frames with their predecessor, and the new order if kept frames moved.
    let known: BTreeMap<&FrameId, &Shared<Frame>> =
        before.iter().map(|frame| (&frame.id, frame)).collect();
    let kept: BTreeSet<&FrameId> = after
        .iter()
        .map(|frame| &frame.id)
        .filter(|id| known.contains_key(id))
        .collect();
    for frame in after {
        if let Some(known) = known.get(&frame.id).filter(|known| **known != frame) {
            changes.push(Change::between_frames(known, frame));
        }
    }
    let gone: Vec<FrameId> = before
        .iter()
        .map(|frame| &frame.id)
        .filter(|id| !kept.contains(id))
        .cloned()
        .collect();
    if !gone.is_empty() {
        changes.push(Change::Remove(gone));
    }
    let is_moved = kept_order(before, &kept) != kept_order(after, &kept);
    // A run of added frames names the frame before it, which is there when the run is applied:
    // either it stays, or it ends an earlier run. `last` is that frame, `coming` the open run.
    let mut last: Option<&FrameId> = None;
    let mut coming: Option<(Option<FrameId>, Vec<Shared<Frame>>)> = None;
    for frame in after {
        if kept.contains(&frame.id) {
            changes.extend(
                coming
                    .take()
                    .map(|(after, frames)| Change::Insert { after, frames }),
            );
        } else {
            coming
                .get_or_insert_with(|| (last.cloned(), Vec::new()))
                .1
                .push(frame.clone());
        }
        last = Some(&frame.id);
    }
    changes.extend(coming.map(|(after, frames)| Change::Insert { after, frames }));
    if is_moved {
        changes.push(Change::Order(
            after.iter().map(|frame| frame.id.clone()).collect(),
        ));
    }
}

/// The ids of the kept frames in their order.
fn kept_order<'a>(frames: &'a Frames, kept: &BTreeSet<&FrameId>) -> Vec<&'a FrameId> {
    frames
        .iter()
        .map(|frame| &frame.id)
        .filter(|id| kept.contains(id))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{document_from_bytes, document_to_string};
    use crate::testing::{new_frame, soccer_document};
    use proptest::prelude::*;
    use touchline_core::geometry::ImageSize;

    fn document(names: &[u8]) -> Document {
        let mut document = soccer_document();
        let frame = |name: &u8| new_frame(&name.to_string(), ImageSize::new(64, 48));
        document.frames = names.iter().map(|name| frame(name).into()).collect();
        document
    }

    #[test]
    fn an_edit_holds_only_what_changed() {
        let before = document(&[1, 2, 3]);
        let mut after = before.clone();
        after.frames[1].comment = Some("rain".to_owned());
        let edit = Edit::between(&before, &after, "Comment");
        assert!(
            matches!(&edit.changes[..], [Change::Frame { id, revision: 0, .. }] if *id == before.frames[1].id)
        );
        after.frames.remove(0);
        let edit = Edit::between(&before, &after, "Remove");
        assert!(
            matches!(&edit.changes[..], [Change::Frame { .. }, Change::Remove(ids)] if *ids == [before.frames[0].id.clone()])
        );
        assert!(Edit::between(&after, &after.clone(), "Nothing").is_empty());
    }

    #[test]
    fn an_edit_that_does_not_fit_changes_nothing() {
        let mut two = document(&[1, 2]);
        let mut after = two.clone();
        after.field.template = "other".to_owned();
        after.frames[1].comment = Some("x".to_owned());
        let edit = Edit::between(&two, &after, "Both");
        let id = two.frames.pop().unwrap().id.clone();
        let before = two.clone();
        assert_eq!(edit.apply(&mut two), Err(EditMismatch::NoFrame { id }));
        assert_eq!(two, before);
    }

    #[test]
    fn a_frame_that_others_push_beyond_the_earlier_end_is_counted_as_edited() {
        let before = document(&[1, 2, 3]);
        let mut after = document(&[9, 1, 2, 3]);
        after.frames[3].comment = Some("x".to_owned());
        after.count_edits_since(&before);
        let revisions: Vec<u64> = after.frames.iter().map(|frame| frame.revision).collect();
        assert_eq!(revisions, [0, 0, 0, 1]);
        let edit = Edit::between(&before, &after, "Both");
        let mut made = before.clone();
        edit.clone().apply(&mut made).unwrap();
        assert!(matches!(
            edit.apply(&mut made),
            Err(EditMismatch::Revision { .. })
        ));
        assert_eq!(made, after);
    }

    #[test]
    fn an_edit_is_made_once() {
        let before = document(&[1, 2]);
        let mut after = before.clone();
        after.frames[1].comment = Some("x".to_owned());
        after.count_edits_since(&before);
        assert_eq!((after.frames[0].revision, after.frames[1].revision), (0, 1));
        let edit = Edit::between(&before, &after, "Comment");
        let mut made = before.clone();
        edit.clone().apply(&mut made).unwrap();
        assert_eq!(made, after);
        let id = after.frames[1].id.clone();
        assert_eq!(
            edit.apply(&mut made),
            Err(EditMismatch::Revision {
                id,
                made_on: 0,
                found: 1
            })
        );
        // What undo brings back counts as an edit of what it took back.
        let mut undone = before.clone();
        undone.count_edits_since(&after);
        assert_eq!(
            (undone.frames[1].revision, &undone.frames[1].comment),
            (2, &None)
        );
    }

    #[test]
    fn an_edit_reaches_its_frame_wherever_it_stands_now() {
        let before = document(&[1, 2, 3]);
        let mut after = before.clone();
        after.frames[2].comment = Some("x".to_owned());
        let edit = Edit::between(&before, &after, "Comment");
        let mut shorter = before.clone();
        shorter.frames.remove(0);
        edit.apply(&mut shorter).unwrap();
        assert_eq!(shorter.frames[1], after.frames[2]);
    }

    #[test]
    fn a_frame_of_the_last_revision_is_edited_once() {
        let mut before = document(&[1]);
        before.frames[0].revision = u64::MAX;
        let mut after = before.clone();
        after.frames[0].comment = Some("x".to_owned());
        after.count_edits_since(&before);
        let edit = Edit::between(&before, &after, "Comment");
        edit.clone().apply(&mut before).unwrap();
        assert!(matches!(
            edit.apply(&mut before),
            Err(EditMismatch::Revision {
                made_on: u64::MAX,
                ..
            })
        ));
    }

    #[test]
    fn a_documents_own_keys_among_the_unknown_ones_of_an_edit_are_not_written_as_the_documents() {
        for own in OWN_KEYS {
            let json = format!(
                r#"{{"name": "", "changes": [{{"rest": {{"conventions": {{}}, "extra": {{"{own}": null, "a": 1}}}}}}]}}"#
            );
            let mut edited = document(&[1]);
            serde_json::from_str::<Edit>(&json)
                .unwrap()
                .apply(&mut edited)
                .unwrap();
            let text = document_to_string(&edited).unwrap();
            let read = document_from_bytes(text.as_bytes()).unwrap();
            assert_eq!((&read.extra, read.extra.len()), (&edited.extra, 1), "{own}");
        }
        let value: serde_json::Value =
            serde_json::from_str(&document_to_string(&document(&[1])).unwrap()).unwrap();
        assert!(
            value
                .as_object()
                .unwrap()
                .keys()
                .all(|key| OWN_KEYS.contains(&key.as_str())),
            "{value}"
        );
    }

    #[test]
    fn frames_that_come_and_go_do_so_once() {
        let (before, after) = (document(&[1, 2]), document(&[3, 2]));
        let edit = Edit::between(&before, &after, "Exchange");
        let mut exchanged = before.clone();
        edit.clone().apply(&mut exchanged).unwrap();
        assert_eq!(exchanged, after);
        assert!(matches!(
            edit.apply(&mut exchanged),
            Err(EditMismatch::NoFrame { .. })
        ));
        let of = |change| Edit {
            name: String::new(),
            kind: EditKind::NoStep,
            changes: vec![change],
        };
        let only_new = of(Change::Insert {
            after: None,
            frames: vec![after.frames[0].clone()],
        });
        assert_eq!(
            only_new.apply(&mut exchanged),
            Err(EditMismatch::Present {
                id: after.frames[0].id.clone()
            })
        );
        let id = exchanged.frames[0].id.clone();
        let other = of(Change::Frame {
            id: id.clone(),
            revision: 0,
            frame: exchanged.frames[1].clone(),
        });
        let found = exchanged.frames[1].id.clone();
        assert_eq!(
            other.apply(&mut exchanged),
            Err(EditMismatch::OtherFrame { id, found }),
            "an id is no one else's"
        );
        let order = of(Change::Order(vec![after.frames[0].id.clone(); 2]));
        assert_eq!(
            order.apply(&mut exchanged),
            Err(EditMismatch::Order {
                ordered: 2,
                frames: 2
            })
        );
    }

    proptest! {
        #[test]
        fn an_edit_leads_from_one_state_to_the_other(
            from in prop::collection::vec(0u8..9, 0..12), into in prop::collection::vec(0u8..9, 0..12),
            noted in 0usize..12,
        ) {
            let (mut before, mut after) = (document(&from), document(&into));
            if let Some(frame) = after.frames.get_mut(noted) {
                frame.comment = Some("noted".to_owned());
            }
            let edit = Edit::between(&before, &after, "Any");
            let written = serde_json::to_string(&edit).unwrap();
            prop_assert_eq!(&serde_json::from_str::<Edit>(&written).unwrap(), &edit);
            edit.apply(&mut before).unwrap();
            prop_assert_eq!(before, after);
        }
    }
}
