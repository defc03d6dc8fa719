//! A document prepared on the thread that reads it, so that opening it does not block the window.

use super::derived::Derived;
use crate::app::Versioned;
use touchline_calibration::proposals::Project;
use touchline_documents::document::Document;

/// A document split into the users' work and the suggestions, with the values that the window
/// derives from all frames. With 100,000 frames their computation takes a good part of a second.
#[derive(Clone, Debug)]
pub(in crate::app) struct Prepared {
    pub(in crate::app) project: Project,
    /// Values derived from version 0 of the document.
    pub(in crate::app) derived: Derived,
}

impl Prepared {
    pub(in crate::app) fn from_document(document: Document) -> Self {
        // The window's first update then finds both for version 0, with which it begins as well.
        let mut derived = Derived::default();
        let document = Versioned::new(document);
        derived.counts(&document);
        derived.lookup(&document);
        Self {
            project: Project::from_document(document.clone()),
            derived,
        }
    }

    /// The document with the suggestions, as a reader sees it.
    pub(in crate::app) const fn document(&self) -> &Document {
        self.project.view()
    }
}

/// Both fields follow from the document, so comparing the documents is enough.
impl PartialEq for Prepared {
    fn eq(&self, other: &Self) -> bool {
        self.document() == other.document()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::OpenProject;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::FrameStatus;
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    #[test]
    fn what_was_prepared_holds_for_the_open_document() {
        let mut document = soccer_document();
        for name in ["a.jpg", "b.jpg"] {
            let mut frame = new_frame(name, ImageSize::new(64, 36));
            (frame.status, frame.ptz) = (FrameStatus::Suggested, ptz_at(1.0, -9.0, 900.0));
            document.frames.push(frame.into());
        }
        let prepared = Prepared::from_document(document.clone());
        let mut open = OpenProject::from_prepared(
            prepared,
            "/match/project.json".into(),
            "/match".into(),
            None,
        );
        assert_eq!(*open.document, document);
        assert_eq!(
            open.counts().count_with_status(FrameStatus::Suggested),
            2,
            "counted before anybody asks"
        );
        let editions =
            |open: &mut OpenProject| open.derived.counts(&open.document).suggestions_edition();
        let before = editions(&mut open);
        open.document.frames[0].status = FrameStatus::Reference;
        assert!(
            editions(&mut open) > before,
            "and counted again once the document has changed"
        );
    }
}
