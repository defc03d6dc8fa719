//! A document split into what people did and what the program suggests.

use super::{Document, Frame, Shared};

/// A document as a file has it and as readers see it, together with what people did: the same without suggestions, which is
/// what undo goes back and forth in.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitDocument {
    shown: Document,
    edited: Document,
}

impl SplitDocument {
    /// A document as a file has it.
    pub fn of(shown: Document) -> Self {
        let mut edited = shown.clone();
        for (position, frame) in shown.frames.iter().enumerate().filter(|(_, frame)| frame.shows_suggestion()) {
            edited.frames[position] = frame.without_suggestion().into();
        }
        Self { shown, edited }
    }

    /// The document, suggestions included.
    pub const fn shown(&self) -> &Document {
        &self.shown
    }

    /// What people did. No frame shows a suggestion here.
    pub const fn edited(&self) -> &Document {
        &self.edited
    }

    /// What people did, by itself.
    pub(crate) fn into_edited(self) -> Document {
        self.edited
    }

    /// What people did in a document that edits led to from this one. Frames that both share are not looked at.
    pub fn edited_of(&self, now: &Document) -> Document {
        let frames = if let Some(changed) = now.frames.changed_in_place(&self.shown.frames) {
            let mut frames = self.edited.frames.clone();
            for position in changed {
                frames[position] = without_suggestion(&now.frames[position], Some(&frames[position]));
            }
            frames
        } else {
            let known = |frame: &Frame| self.edited.frames.by_id(&frame.id);
            now.frames.iter().map(|frame| without_suggestion(frame, known(frame))).collect()
        };
        Document { frames, ..now.clone() }
    }

    /// Goes on to a document that edits led to from this one.
    pub fn go_on_to(&mut self, now: Document) {
        self.edited = self.edited_of(&now);
        self.shown = now;
    }
}

/// The frame as people left it: the handle that is known, where it is that.
fn without_suggestion(frame: &Shared<Frame>, known: Option<&Shared<Frame>>) -> Shared<Frame> {
    if !frame.shows_suggestion() {
        return frame.clone();
    }
    let without = frame.without_suggestion();
    known.filter(|known| ***known == without).cloned().unwrap_or_else(|| without.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{FieldSpec, FramePtz, FrameStatus};
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::ImageSize;

    fn suggest(frame: &mut Frame, pan_deg: f64) {
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(pan_deg, -9.0, 900.0), None));
        frame.status = FrameStatus::Suggested;
    }

    #[test]
    fn what_people_did_changes_with_their_edits_alone() {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame = |name: &str| Frame::from_image(name, "main".into(), ImageSize::new(64, 36)).into();
        document.frames.extend(["a", "b", "c"].map(frame));
        let untouched = document.clone();
        suggest(&mut document.frames[1], 1.0);
        let mut split = SplitDocument::of(document.clone());
        assert_eq!(*split.edited(), untouched);
        let handles = split.edited().frames.clone();
        suggest(&mut document.frames[1], 2.0);
        suggest(&mut document.frames[2], 3.0);
        split.go_on_to(document.clone());
        assert!(split.edited().frames.iter().zip(&handles).take(2).all(|(now, before)| now.is_same(before)));
        assert_eq!((split.edited(), split.shown()), (&untouched, &document));
        document.frames[1].status = FrameStatus::Reference;
        document.frames.remove(0);
        split.go_on_to(document.clone());
        assert_eq!(split.edited().frames[0], document.frames[0]);
        assert_eq!(split, SplitDocument::of(document));
    }
}
