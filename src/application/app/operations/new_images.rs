//! Images that came to the folders of the document since it was made: looked for when it is opened,
//! and added at the user's command.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::convert::Infallible;
use std::path::PathBuf;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FolderChanges, Step};

/// Looks for images that came to the folders of a document, or went.
#[derive(Debug)]
pub struct NewImages {
    document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
}

/// The search on the open document, and what it found.
#[derive(Debug, Default)]
pub(in crate::app) struct NewImagesState {
    slot: Slot<NewImages>,
    found: FolderChanges,
}

impl Operation for NewImages {
    type Progress = Infallible;
    type Output = FolderChanges;
    type Error = Infallible;

    const NAME: &'static str = "new images";

    fn run(&self, context: &Context<'_, Infallible>) -> Result<FolderChanges, Infallible> {
        let progress = Progress::new(|()| {
            context.give_way_to_window();
            context.check()
        });
        Ok(FolderChanges::find(&self.document, &self.folder, &progress))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.new_images.slot
    }

    fn take_over(&self, app: &mut App, result: Result<FolderChanges, Failure<Infallible>>) {
        match result {
            Ok(found) => app.offer_new_images(found),
            Err(failure) => app.session.notify(Level::Error, failure.to_string()),
        }
    }
}

impl App {
    /// Starts a search in the document that was just opened.
    pub(in crate::app) fn look_for_new_images(&mut self) {
        let Some(open) = self.open.as_ref().filter(|open| open.read_only.is_none()) else {
            return;
        };
        let mut frames = open.document.frames.iter();
        if frames.any(|frame| frame.video.is_none()) {
            let (document, folder) = ((*open.document).clone(), open.folder.clone());
            self.start(NewImages { document, folder });
        }
    }

    fn offer_new_images(&mut self, found: FolderChanges) {
        if found.gone > 0 {
            let text = format!(
                "{} not in the folder any more; the labels stay.",
                images_that(found.gone, "is", "are")
            );
            self.session.note(text);
        }
        if found.count() > 0 {
            let text = format!(
                "{} to the folder since the project was made.",
                images_that(found.count(), "has come", "have come")
            );
            let offers = [("Add", Command::AddNewImages)];
            self.session.notify_with(Level::Question, text, offers);
        }
        self.operations.new_images.found = found;
    }

    /// Why there is nothing to add. None if there is.
    pub(in crate::app) fn why_not_add_images(&self) -> Option<&'static str> {
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        let none = self.operations.new_images.found.count() == 0;
        none.then_some("No images have come to the folder since the project was opened last.")
    }

    /// Adds the images that came; one step of undo.
    pub(in crate::app) fn add_new_images(&mut self) {
        self.session.retract(Command::AddNewImages);
        let found = std::mem::take(&mut self.operations.new_images.found);
        if !self.begin_step(Step::on_document("Add new images")) {
            return;
        }
        let Some(open) = &mut self.open else { return };
        let before = open.document.frames.clone();
        let added = open.document.add_images(&found);
        self.follow_frames(&before);
        self.close_step();
        for (name, error) in &found.left_out {
            let text = format!("Left out: {name}: {error}");
            self.session.warn(text);
        }
        let text = format!("{} added.", pluralise(added, "frame"));
        let offers = [("Undo", Command::Undo)];
        self.session.notify_with(Level::Info, text, offers);
    }
}

/// A number of images with its verb.
fn images_that(images: usize, one: &str, many: &str) -> String {
    let verb = if images == 1 { one } else { many };
    format!("{} {verb}", pluralise(images, "image"))
}
