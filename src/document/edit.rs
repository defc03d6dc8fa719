//! What changed between two states of a document, as the journal keeps it: whole frames, cameras and fields.

use super::{Camera, Document, Extra, FieldSpec, Frame, Shared};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

/// One edit: a name and what it changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Edit {
    /// In words: "Move centre mark".
    pub name: String,
    /// What changed, to be applied in this order.
    pub changes: Vec<Change>,
}

/// A part of the document that changed, with its new value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// A frame.
    Frame {
        /// Its place in the document.
        index: usize,
        /// What it is now.
        frame: Shared<Frame>,
    },
    /// Frames that came, went or moved.
    Frames {
        /// Where.
        at: usize,
        /// How many go.
        remove: usize,
        /// Which come.
        insert: Vec<Shared<Frame>>,
    },
    /// The cameras.
    Cameras(Vec<Shared<Camera>>),
    /// The field.
    Field(FieldSpec),
    /// The conventions and unknown keys of the document itself.
    Rest {
        /// The conventions.
        conventions: Map<String, Value>,
        /// Unknown keys.
        extra: Extra,
    },
}

/// An edit that does not fit the document it is applied to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the edit concerns frame {index}, the document has {frames} frames")]
pub struct EditMismatch {
    /// The frame it concerns.
    pub index: usize,
    /// How many frames there are.
    pub frames: usize,
}

impl Edit {
    /// What leads from `before` to `after`; frames that both share are not looked at.
    #[must_use]
    pub fn between(before: &Document, after: &Document, name: &str) -> Self {
        let mut changes = Vec::new();
        if before.field != after.field {
            changes.push(Change::Field(after.field.clone()));
        }
        if before.cameras != after.cameras {
            changes.push(Change::Cameras(after.cameras.clone()));
        }
        if before.conventions != after.conventions || before.extra != after.extra {
            changes.push(Change::Rest { conventions: after.conventions.clone(), extra: after.extra.clone() });
        }
        frame_changes(&before.frames, &after.frames, &mut changes);
        Self { name: name.to_owned(), changes }
    }

    /// Nothing changed.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Joins a later edit to this one.
    pub fn join(&mut self, later: Self) {
        self.name = later.name;
        self.changes.extend(later.changes);
    }

    /// Makes the changes.
    ///
    /// # Errors
    /// A frame is not there. The document is as it was then.
    pub fn apply(self, document: &mut Document) -> Result<(), EditMismatch> {
        let before = document.clone();
        for change in self.changes {
            if let Err(mismatch) = change.apply(document) {
                *document = before;
                return Err(mismatch);
            }
        }
        Ok(())
    }
}

impl Change {
    fn apply(self, document: &mut Document) -> Result<(), EditMismatch> {
        let frames = document.frames.len();
        match self {
            Self::Frame { index, frame } => {
                *document.frames.get_mut(index).ok_or(EditMismatch { index, frames })? = frame;
            }
            Self::Frames { at, remove, insert } => {
                let end = at.checked_add(remove).filter(|end| *end <= frames);
                let end = end.ok_or(EditMismatch { index: at, frames })?;
                document.frames.splice(at..end, insert);
            }
            Self::Cameras(cameras) => document.cameras = cameras,
            Self::Field(field) => document.field = field,
            Self::Rest { conventions, extra } => {
                document.conventions = conventions;
                document.extra = extra;
            }
        }
        Ok(())
    }
}

fn frame_changes(before: &[Shared<Frame>], after: &[Shared<Frame>], changes: &mut Vec<Change>) {
    if before.len() == after.len() {
        let pairs = before.iter().zip(after).enumerate();
        let changed = pairs.filter(|(_, (before, after))| before != after);
        changes.extend(changed.map(|(index, (_, frame))| Change::Frame { index, frame: frame.clone() }));
        return;
    }
    let shorter = before.len().min(after.len());
    let at = before.iter().zip(after).take_while(|(before, after)| before == after).count();
    let same_at_end = before.iter().rev().zip(after.iter().rev()).take(shorter - at);
    let tail = same_at_end.take_while(|(before, after)| before == after).count();
    let insert = after[at..after.len() - tail].to_vec();
    changes.push(Change::Frames { at, remove: before.len() - tail - at, insert });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ImageSize;
    use proptest::prelude::*;

    fn document(names: &[u8]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame = |name: &u8| Frame::from_image(&name.to_string(), "main".into(), ImageSize::new(64, 48));
        document.frames = names.iter().map(|name| frame(name).into()).collect();
        document
    }

    #[test]
    fn an_edit_holds_only_what_changed() {
        let before = document(&[1, 2, 3]);
        let mut after = before.clone();
        after.frames[1].comment = Some("rain".to_owned());
        let edit = Edit::between(&before, &after, "Comment");
        assert!(matches!(&edit.changes[..], [Change::Frame { index: 1, .. }]));
        after.frames.remove(0);
        let edit = Edit::between(&before, &after, "Remove");
        assert!(matches!(&edit.changes[..], [Change::Frames { at: 0, remove: 2, insert }] if insert.len() == 1));
        assert!(Edit::between(&after, &after.clone(), "Nothing").is_empty());
    }

    #[test]
    fn an_edit_that_does_not_fit_changes_nothing() {
        let mut two = document(&[1, 2]);
        let mut after = two.clone();
        after.field.template = "other".to_owned();
        after.frames[1].comment = Some("x".to_owned());
        let edit = Edit::between(&two, &after, "Both");
        two.frames.pop();
        let before = two.clone();
        assert_eq!(edit.apply(&mut two), Err(EditMismatch { index: 1, frames: 1 }));
        assert_eq!(two, before);
    }

    proptest! {
        #[test]
        fn an_edit_leads_from_one_state_to_the_other(
            from in prop::collection::vec(0u8..5, 0..12), into in prop::collection::vec(0u8..5, 0..12),
        ) {
            let (mut before, after) = (document(&from), document(&into));
            Edit::between(&before, &after, "Any").apply(&mut before).unwrap();
            prop_assert_eq!(before, after);
        }
    }
}
