//! Checks in the background, when a document is opened, whether the pictures on disk are those that
//! were labelled.
//!
//! A different picture under the same file name shows another moment: its lines are elsewhere, and
//! a correct label becomes wrong. The check compares what the document states: SHA-256, size, what a
//! video is recognised by, and number and time in it.

use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::window_state::session::Level;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::{Fault, PictureCheck};
use touchline_documents::document::{Document, Frame, FrameId, VideoFrame};

/// Compares the pictures with what the document states about them.
#[derive(Debug)]
pub struct PictureComparison {
    document: Document,
    folder: PathBuf,
    /// The index of the shown frame, which is checked first.
    shown: usize,
}

/// What a frame states about its picture.
#[derive(Clone, Debug, PartialEq)]
struct PictureIdentity {
    image: Option<String>,
    video: Option<VideoFrame>,
    sha256: Option<String>,
}

impl PictureIdentity {
    fn by(frame: &Frame) -> Self {
        Self {
            image: frame.image.clone(),
            video: frame.video.clone(),
            sha256: frame.sha256.clone(),
        }
    }

    /// Whether the frame states anything that can be compared.
    fn is_comparable(frame: &Frame) -> bool {
        frame.sha256.is_some()
            || frame
                .video
                .as_ref()
                .is_some_and(|video| video.pts_s.is_some() || video.file_id.is_some())
    }
}

/// A frame with a picture that differs from what the frame states.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherPicture {
    /// What the frame stated when it was checked. The result is valid while it states the same.
    stated: PictureIdentity,
    /// The difference, as text.
    says: String,
}

type OtherPictures = BTreeMap<FrameId, OtherPicture>;

/// The check on the open document, and its result.
#[derive(Debug, Default)]
pub(in crate::app) struct PictureComparisonState {
    slot: Slot<PictureComparison>,
    found: Arc<OtherPictures>,
}

impl Operation for PictureComparison {
    type Progress = Arc<OtherPictures>;
    type Output = Arc<OtherPictures>;
    type Error = Infallible;

    const NAME: &'static str = "picture check";

    fn run(&self, context: &Context<'_, Self::Progress>) -> Result<Self::Output, Infallible> {
        let check = PictureCheck::open(self.document.at(&self.folder));
        let count = self.document.frames.len();
        let mut found = OtherPictures::new();
        let mut next_report = 1;
        for index in (0..count).map(|step| (self.shown + step) % count) {
            if context.check().is_break() {
                break;
            }
            let Some(frame) = self
                .document
                .frames
                .get(index)
                .filter(|frame| PictureIdentity::is_comparable(frame))
            else {
                continue;
            };
            // Each check reads a file or seeks in a video.
            context.give_way_to_window();
            if let Some(fault) = check
                .faults(index)
                .iter()
                .find(|fault| is_of_another_picture(fault))
            {
                found.insert(
                    frame.id.clone(),
                    OtherPicture {
                        stated: PictureIdentity::by(frame),
                        says: fault.to_string(),
                    },
                );
                // The warning over a frame appears at once. Each report is a copy of all, so that
                // of many the reports get rarer. Whether to go on is checked above.
                if found.len() >= next_report {
                    next_report = found.len() + found.len() / 16 + 1;
                    let _ = context.report(Arc::new(found.clone()));
                }
            }
        }
        Ok(Arc::new(found))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.picture_comparison.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Self::Output, Failure<Infallible>>) {
        match result {
            Ok(found) => {
                let first = self
                    .document
                    .frames
                    .iter()
                    .find(|frame| found.contains_key(&frame.id));
                if let Some(first) = first {
                    let (name, text) = (first.name(), "not the pictures that were labelled");
                    let text = match found.len() {
                        1 => format!("The picture of {name} is not the one that was labelled."),
                        count => format!("{count} frames show {text}, the first is {name}."),
                    };
                    app.session.warn(text);
                }
                app.operations.picture_comparison.found = found;
            }
            Err(failure) => app.session.notify(Level::Error, failure.to_string()),
        }
    }
}

/// Whether a fault means that the picture is a different one. A missing picture is not included;
/// the window reports it elsewhere.
const fn is_of_another_picture(fault: &Fault) -> bool {
    matches!(
        fault,
        Fault::PictureChanged { .. }
            | Fault::PictureSize { .. }
            | Fault::VideoChanged { .. }
            | Fault::VideoTime { .. }
            | Fault::NoSuchVideoFrame { .. }
    )
}

impl App {
    /// How the picture of a frame differs from the one that was labelled, if that is known.
    pub fn other_picture(&self, index: usize) -> Option<&str> {
        let frame = self.open.as_ref()?.frame(index)?;
        let state = &self.operations.picture_comparison;
        let found = state
            .slot
            .running()
            .and_then(Running::progress)
            .unwrap_or(&state.found);
        let other = found.get(&frame.id)?;
        (other.stated == PictureIdentity::by(frame)).then_some(other.says.as_str())
    }

    /// Starts the check of the document that was just opened.
    pub(in crate::app) fn compare_pictures(&mut self) {
        let Some(open) = &self.open else { return };
        if !open
            .document
            .frames
            .iter()
            .any(|frame| PictureIdentity::is_comparable(frame))
        {
            return;
        }
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(PictureComparison {
            document,
            folder,
            shown: self.session.frame,
        });
    }
}
