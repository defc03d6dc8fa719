//! Searches the pictures for burned-in graphics (score boards, logos) when a document is opened,
//! and asks the user whether to mask them.

use crate::app::effect::Effect;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::{Level, SidePanel};
use crate::app::{App, Command, Tool};
use std::convert::Infallible;
use std::path::PathBuf;
use touchline_calibration::proposals::{
    FeatureStore, FoundMask, FramePictures, WorkFolder, find_burnt_in,
};
use touchline_core::geometry::PixelBox;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, Step};
use touchline_vision::features::FeatureOptions;

/// Searches the pictures of a document for burned-in graphics.
#[derive(Debug)]
pub struct BurntInSearch {
    document: Document,
    /// The document's file. Features of its pictures are cached beside it.
    file: PathBuf,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
}

/// The search on the open document, and its result.
#[derive(Debug, Default)]
pub(in crate::app) struct BurntInState {
    slot: Slot<BurntInSearch>,
    /// Graphics for which the user has not decided.
    undecided: Vec<FoundMask>,
}

// ---- The work ----

impl Operation for BurntInSearch {
    type Progress = Infallible;
    type Output = Vec<FoundMask>;
    type Error = Infallible;

    const NAME: &'static str = "burned-in graphics";

    fn run(&self, context: &Context<'_, Infallible>) -> Result<Vec<FoundMask>, Infallible> {
        // The same cache as the trainer's, which needs some of the same pictures.
        let store = FeatureStore::on_disk(&WorkFolder::beside(&self.file));
        let (document, folder, options) =
            (&self.document, &*self.folder, FeatureOptions::default());
        let pictures = FramePictures::new(document, folder, options, &store);
        Ok(find_burnt_in(
            &pictures,
            &mut *context.open_reader(),
            &Progress::new(|()| context.check()),
        )
        .unwrap_or_default())
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.burnt_in.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Vec<FoundMask>, Failure<Infallible>>) {
        match result {
            Ok(found) => app.ask_about_burnt_in(found),
            Err(failure) => app.session.notify(failure.level(), failure.to_string()),
        }
    }
}

// ---- In the application ----

impl App {
    /// Why there is nothing for the user to decide. None if there is.
    pub(in crate::app) fn why_not_decide_burnt_in(&self) -> Option<&'static str> {
        self.operations
            .burnt_in
            .undecided
            .is_empty()
            .then_some("There are no burned-in graphics to decide about.")
    }

    /// Starts a search in the document that was just opened.
    pub(in crate::app) fn find_burnt_in(&mut self) {
        if self.no_trainer().is_some() {
            return;
        }
        let Some(open) = self
            .open
            .as_ref()
            .filter(|open| open.document.frames.len() > 1)
        else {
            return;
        };
        let (document, file, folder) = (
            (*open.document).clone(),
            open.file.clone(),
            open.folder.clone(),
        );
        self.start(BurntInSearch {
            document,
            file,
            folder,
        });
    }

    /// Asks the user whether to mask the graphics that were found.
    fn ask_about_burnt_in(&mut self, found: Vec<FoundMask>) {
        let Some(open) = &self.open else { return };
        // The user may have drawn a mask while the search ran.
        let found: Vec<FoundMask> = found
            .into_iter()
            .filter(|found| is_unmasked(&open.document, found))
            .collect();
        if found.is_empty() {
            return;
        }
        // A question that was closed does not come back; the palette still has the commands.
        let file = open.file.clone();
        self.operations.burnt_in.undecided.clone_from(&found);
        self.effects.push(Effect::SaveSettings);
        if self.settings.note_burnt_in_question(&file) {
            return;
        }
        let offers = [
            ("Ignore", Command::KeepBurntIn),
            ("Edit…", Command::ChangeBurntIn),
        ];
        self.session
            .notify_with(Level::Question, describe(&found), offers);
    }

    /// Makes the graphics masks of their cameras; one step of undo.
    pub(in crate::app) fn keep_burnt_in(&mut self) {
        let found = std::mem::take(&mut self.operations.burnt_in.undecided);
        self.session.retract(Command::KeepBurntIn);
        self.change_masks(
            Step::on_document("Mask burned-in graphics"),
            |document, _| {
                for found in &found {
                    found.mask_in(document);
                }
            },
        );
    }

    /// Does the same, and opens the masks for editing.
    pub(in crate::app) fn change_burnt_in(&mut self) {
        self.keep_burnt_in();
        self.session.picture.tool = Tool::Mask;
        self.session.panel = SidePanel::Camera;
    }

    /// The boxes of undecided graphics in the shown frame, while the question is shown.
    pub fn masks_in_question(&self) -> Vec<PixelBox> {
        let Some(frame) = self
            .frame()
            .filter(|_| self.session.offers(Command::KeepBurntIn))
        else {
            return Vec::new();
        };
        self.operations
            .burnt_in
            .undecided
            .iter()
            .filter(|found| found.camera == frame.camera && found.mask.covers(frame))
            .map(|found| found.mask.pixel_box)
            .collect()
    }
}

/// Whether the document has the camera of a graphic, and no mask that covers the centre of the
/// graphic.
fn is_unmasked(document: &Document, found: &FoundMask) -> bool {
    let Some(camera) = document.camera(&found.camera) else {
        return false;
    };
    // A mask of any size over the centre counts as one of the graphic.
    let ranged = camera.ranged_masks.iter().map(|mask| &mask.pixel_box);
    !camera
        .masks
        .iter()
        .chain(ranged)
        .any(|known| known.contains(found.mask.pixel_box.centre()))
}

// ---- Words ----

/// The question to the user.
fn describe(found: &[FoundMask]) -> String {
    match found {
        [one] => {
            let PixelBox {
                x,
                y,
                width,
                height,
            } = one.mask.pixel_box;
            let size = format!("{width:.0} × {height:.0} px at {x:.0}, {y:.0}");
            format!("An area looks burned in ({size}). Ignore it from now on?")
        }
        more => format!(
            "{} areas look burned in. Ignore them from now on?",
            more.len()
        ),
    }
}
