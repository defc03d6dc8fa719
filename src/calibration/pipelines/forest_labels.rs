//! Frames labelled by a forest: it learns from references, it proposes cameras for other frames,
//! the painted lines judge them, and the document records them.
//!
//! | step | function |
//! |---|---|
//! | learn | [`learn_forest`] |
//! | propose, judge | [`propose_on_lines`] |
//! | propose, judge, record | [`label_frames`] |
//!
//! The trainer of the window calls the first two: it keeps forests and answers over many edits, and
//! shows suggestions beside the document. The command line calls the last one, on a document that
//! it writes to a file.

use crate::proposals::{
    FeatureStore, FramePictures, LearnError, LearnOptions, LineEvidence, NoProposal, Proposal,
    Studied, TrainingSampleError, learn, propose, study,
};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, panic_message};
use touchline_documents::document::Document;
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{ForestModel, RelocalizeOptions, Stopped, TrainProgress};

/// An end that is asked for takes effect after at most this many frames. Their answers are kept.
const BATCH_FRAMES: usize = 16;

/// How far learning has come.
#[derive(Clone, Copy, Debug)]
pub enum LearningProgress {
    /// Features of references are extracted.
    Features {
        /// References done.
        done: usize,
        /// References in all.
        of: usize,
    },
    /// The forest is trained.
    Training(TrainProgress),
}

/// A forest and what it learnt from.
#[derive(Debug)]
pub struct LearntForest {
    /// The forest.
    pub model: ForestModel,
    /// The samples of its references, and the references that gave none.
    pub studied: Studied,
}

/// Why there is no forest.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LearnForestError {
    /// No reference gives a training sample.
    #[error("No reference can be used for training. {frame}: {first}")]
    NoneUsable {
        /// The name of the first of them.
        frame: String,
        /// Why that one does not.
        first: TrainingSampleError,
    },
    /// It cannot be trained.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

/// Trains a forest on the training frames of a document. None if `progress` cancelled it.
///
/// # Errors
/// There is nothing to learn from, or the document's cameras cannot be written down.
pub fn learn_forest(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    training_frames: &[usize],
    options: &LearnOptions,
    progress: &Progress<'_, LearningProgress>,
) -> Result<Option<LearntForest>, LearnForestError> {
    let num_done = AtomicUsize::new(0);
    let counted = progress.part(|()| {
        let done = num_done.fetch_add(1, Ordering::Relaxed) + 1;
        LearningProgress::Features {
            done,
            of: training_frames.len(),
        }
    });
    let studied = study(pictures, reader, training_frames, &counted);
    let Some(studied) = studied else {
        return Ok(None);
    };
    match learn(
        pictures.document,
        &studied,
        options,
        &progress.part(LearningProgress::Training),
    ) {
        Ok(model) => Ok(Some(LearntForest { model, studied })),
        Err(LearnError::Stopped(Stopped::Asked)) => Ok(None),
        Err(error) => Err(explain_failure(error, pictures.document, studied)),
    }
}

/// Why nothing could be learnt: the first reference that gave no sample says more than that there
/// is none.
fn explain_failure(error: LearnError, document: &Document, studied: Studied) -> LearnForestError {
    let is_without_samples = matches!(error, LearnError::Stopped(Stopped::NoSamples { .. }));
    match studied.failed.into_iter().next() {
        Some((index, first)) if is_without_samples => LearnForestError::NoneUsable {
            frame: document.frames[index].name(),
            first,
        },
        _ => error.into(),
    }
}

/// The forest that is asked, and how.
#[derive(Clone, Debug)]
pub struct ForestRequest<'a> {
    /// The forest.
    pub model: &'a ForestModel,
    /// Its generation, for proposals that outlive it. 0 where there is only one.
    pub generation: u64,
    /// How a frame's camera is sought, and the confidence that it needs.
    pub options: RelocalizeOptions,
}

/// What the forest proposes for some frames, all judged together by the painted lines if there is
/// evidence of them. Proposals are in the order of `frames`, and fewer if `progress` cancelled it.
/// A panic becomes the answer of its frame.
pub fn propose_on_lines(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    forest: &ForestRequest<'_>,
    evidence: Option<&LineEvidence>,
    progress: &Progress<'_, usize>,
) -> Vec<Proposal> {
    let mut proposals = propose_in_batches(pictures, reader, frames, forest, progress);
    if let Some(evidence) = evidence {
        let at = pictures.document.at(pictures.folder);
        evidence.judge(
            at,
            reader,
            &mut proposals,
            forest.options.pose.min_confidence,
        );
    }
    proposals
}

fn propose_in_batches(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    forest: &ForestRequest<'_>,
    progress: &Progress<'_, usize>,
) -> Vec<Proposal> {
    let num_done = AtomicUsize::new(0);
    // Whether it is cancelled already.
    let _ = progress.report(0);
    let mut proposals = Vec::with_capacity(frames.len());
    for batch in frames.chunks(BATCH_FRAMES) {
        if progress.is_cancelled() {
            break;
        }
        let of_batch = pictures.each(reader, batch, |index, _, features| {
            let ask = || {
                propose(
                    pictures.document,
                    index,
                    features,
                    (forest.model, forest.generation),
                    &forest.options,
                )
            };
            let proposal = catch_unwind(AssertUnwindSafe(ask)).unwrap_or_else(|panic| {
                let message = panic_message(panic.as_ref());
                let reason = NoProposal::Panicked { message };
                Proposal::without_answer(pictures.document, index, forest.generation, reason)
            });
            // The answers of a batch are kept: a break takes effect before the next one.
            let _ = progress.report(num_done.fetch_add(1, Ordering::Relaxed) + 1);
            ControlFlow::Continue(proposal)
        });
        proposals.extend(of_batch.unwrap_or_default());
    }
    proposals
}

/// Where the pictures of a document lie, and where their features are kept.
#[derive(Clone, Copy)]
pub struct PictureFiles<'a> {
    /// Where the document's relative paths start.
    pub folder: &'a Path,
    /// Features that were found before.
    pub store: &'a FeatureStore,
}

/// Asks a forest for frames of a document and records its answers there, as suggestions. With
/// `snap`, answers are pulled onto the painted lines where these decide. Returns the proposals, for
/// their reasons; fewer than `frames` if `progress` cancelled it. One that is not recorded, because
/// the frame keeps a better camera, is [`NoProposal::NoBetter`].
///
/// # Errors
/// A field of the document is not valid.
pub fn label_frames(
    document: &mut Document,
    files: PictureFiles<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    forest: &ForestRequest<'_>,
    snap: bool,
    progress: &Progress<'_, usize>,
) -> Result<Vec<Proposal>, FieldError> {
    let PictureFiles { folder, store } = files;
    let evidence = LineEvidence::of(document.at(folder), reader, snap)?;
    let pictures = FramePictures {
        document,
        folder,
        options: forest.model.features,
        store,
    };
    let mut proposals =
        propose_on_lines(&pictures, reader, frames, forest, Some(&evidence), progress);
    for proposal in &mut proposals {
        let Some(frame) = document.frames.by_id_mut(&proposal.frame) else {
            continue;
        };
        if proposal.may_replace_camera_of(frame) {
            proposal.record(frame);
        } else if proposal.outcome.is_ok() {
            proposal.outcome = Err(NoProposal::NoBetter);
        }
    }
    Ok(proposals)
}
