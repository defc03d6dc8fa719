//! Edits in the journals of earlier versions, with frames by their positions. They are still read,
//! but never written.

use crate::document::{Document, EditMismatch, Frame, FrameId, Shared};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A change of frames by their positions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OldChange {
    /// A frame.
    Frame {
        /// Its position in the document.
        index: usize,
        /// Its new state; its id is kept.
        frame: Shared<Frame>,
    },
    /// Frames that were added, removed or moved.
    Frames {
        /// The position of the first of them.
        at: usize,
        /// The number of frames removed.
        remove: usize,
        /// The frames added.
        insert: Vec<Shared<Frame>>,
    },
}

impl OldChange {
    pub(in crate::document) fn apply(self, document: &mut Document) -> Result<(), EditMismatch> {
        let frames = document.frames.len();
        match self {
            Self::Frame { index, mut frame } => {
                let place = document
                    .frames
                    .get_mut(index)
                    .ok_or(EditMismatch::Position { index, frames })?;
                // Such an edit states neither id nor revision: the frame keeps its id, and its
                // revision counts this edit.
                frame.id = place.id.clone();
                frame.revision = place.next_revision();
                *place = frame;
            }
            Self::Frames { at, remove, insert } => {
                let end = at.checked_add(remove).filter(|end| *end <= frames);
                let end = end.ok_or(EditMismatch::Position { index: at, frames })?;
                // What is removed goes first: a frame that comes back then finds the id of its
                // picture free.
                let gone: BTreeSet<FrameId> = document
                    .frames
                    .range(at..end)
                    .map(|frame| frame.id.clone())
                    .collect();
                document.frames.retain(|frame| !gone.contains(&frame.id));
                document.frames.insert_all(at, insert);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Edit, FieldSpec};
    use touchline_core::geometry::ImageSize;

    fn document() -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame =
            |name: &str| Frame::from_image(name, "main".into(), ImageSize::new(64, 48)).into();
        document.frames.extend(["a", "b", "c"].map(frame));
        document
    }

    /// A frame as an earlier version wrote it.
    fn written(image: &str) -> String {
        format!(
            r#"{{"image":"{image}","camera":"main","image_size_px":[64,48],"status":"draft","clicks":[]}}"#
        )
    }

    fn apply(edit: &str, document: &mut Document) -> Result<(), EditMismatch> {
        serde_json::from_str::<Edit>(edit).unwrap().apply(document)
    }

    #[test]
    fn a_frame_by_its_position_keeps_its_id() {
        let mut document = document();
        let id = document.frames[1].id.clone();
        let edit = format!(
            r#"{{"name":"Old","changes":[{{"frame":{{"index":1,"frame":{}}}}}]}}"#,
            written("b")
        );
        apply(&edit, &mut document).unwrap();
        let frame = &document.frames[1];
        assert_eq!(
            (&frame.id, frame.revision, frame.status.as_str()),
            (&id, 1, "draft")
        );
        document.frames.pop();
        document.frames.pop();
        assert_eq!(
            apply(&edit, &mut document),
            Err(EditMismatch::Position {
                index: 1,
                frames: 1
            })
        );
    }

    #[test]
    fn frames_by_their_positions_come_and_go() {
        let mut document = document();
        let insert = format!("{},{}", written("x"), written("x"));
        let edit = format!(
            r#"{{"name":"Old","changes":[{{"frames":{{"at":0,"remove":2,"insert":[{insert}]}}}}]}}"#
        );
        apply(&edit, &mut document).unwrap();
        let names: Vec<String> = document.frames.iter().map(|frame| frame.name()).collect();
        assert_eq!(names, ["x", "x", "c"]);
        assert_ne!(document.frames[0].id, document.frames[1].id);
        let far = r#"{"name":"Old","changes":[{"frames":{"at":9,"remove":0,"insert":[]}}]}"#;
        assert_eq!(
            apply(far, &mut document),
            Err(EditMismatch::Position {
                index: 9,
                frames: 3
            })
        );
    }
}
