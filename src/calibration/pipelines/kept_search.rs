//! The answer of a search for a camera, as it is kept.

use super::no_camera::NoCamera;
use crate::autocalibrate::AutocalibrationProgress;
use crate::calibrate::AutocalibratedCamera;
use crate::calibrate::kept::{Kept, kept};
use std::sync::Arc;
use touchline_documents::document::Document;

/// How a search ended, and its answer if it had one.
pub(super) type KeptSearch = (SearchEnd, Option<KeptAnswer>);

/// How a search for a camera ended, whatever its answer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct SearchEnd {
    /// The number of its stages: each searches one kind of places from one number of frames, at
    /// about the same cost.
    pub stages: usize,
    /// Indices in the document of the sampled frames that match each other and were searched.
    pub searched: Vec<usize>,
    /// Indices in the document of the sampled frames that match none of these.
    pub others: Vec<usize>,
    /// Of those that were searched, the frames whose paint lies on the lines of the best camera,
    /// found or not.
    pub agreeing: Vec<usize>,
    /// Which of those that were searched match each other, by their places in `searched`, and how
    /// many of their points do.
    pub links: Vec<([usize; 2], usize)>,
}

kept! {
    SearchEnd { stages, searched, others, agreeing, links }
}

impl SearchEnd {
    /// Notes what a step of the search says.
    pub fn note(&mut self, step: &AutocalibrationProgress) {
        match step {
            AutocalibrationProgress::Gathering => self.stages += 1,
            AutocalibrationProgress::Matched {
                frames,
                others,
                links,
            } => {
                self.searched.clone_from(frames);
                self.others.clone_from(others);
                self.links.clone_from(links);
            }
            _ => {}
        }
    }

    /// Notes the frames that agree with the best camera of the answer.
    pub fn note_best(&mut self, best: Option<&AutocalibratedCamera>) {
        let frames = best.into_iter().flat_map(|best| &best.frames);
        let aligned = frames.filter(|frame| frame.snapped.is_some());
        self.agreeing = aligned.map(|frame| frame.index).collect();
    }
}

/// What is kept of an answer: the camera, or what is said where there is none.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeptAnswer {
    Found(Arc<AutocalibratedCamera>),
    NoCamera {
        message: String,
        asks_for_clicks: bool,
    },
}

impl KeptAnswer {
    /// What is kept of an answer to a search in the frames of a document.
    pub fn from_answer(
        answer: &Result<Arc<AutocalibratedCamera>, NoCamera>,
        document: &Document,
    ) -> Self {
        match answer {
            Ok(found) => Self::Found(Arc::clone(found)),
            Err(why) => Self::NoCamera {
                message: why.describe(document),
                asks_for_clicks: why.asks_for_clicks(),
            },
        }
    }

    /// The answer.
    pub fn into_answer(self) -> Result<Arc<AutocalibratedCamera>, NoCamera> {
        match self {
            Self::Found(found) => Ok(found),
            Self::NoCamera {
                message,
                asks_for_clicks,
            } => Err(NoCamera::Before {
                message,
                asks_for_clicks,
            }),
        }
    }
}

impl Kept for KeptAnswer {
    fn write(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Found(found) => {
                0_u8.write(bytes);
                found.write(bytes);
            }
            Self::NoCamera {
                message,
                asks_for_clicks,
            } => {
                1_u8.write(bytes);
                message.write(bytes);
                asks_for_clicks.write(bytes);
            }
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        match u8::read(bytes)? {
            0 => Some(Self::Found(Arc::new(Kept::read(bytes)?))),
            1 => Some(Self::NoCamera {
                message: Kept::read(bytes)?,
                asks_for_clicks: Kept::read(bytes)?,
            }),
            _ => None,
        }
    }
}
