//! Labelling frames with a forest: it is trained on references, it proposes cameras for other
//! frames, these are checked against the painted lines, and the document records them.
//!
//! | step | function |
//! |---|---|
//! | train | [`learn_forest`] |
//! | propose, check | [`propose_on_lines`] |
//! | propose, check, record | [`label_frames`] |
//!
//! Features are extracted coarse to fine: half the width takes a quarter of the time, and in most
//! frames it leaves no doubt. [`propose_on_lines`] decides where it does, for all its callers.
//!
//! The trainer of the window calls the first two: it keeps forests and answers over many edits, and
//! shows suggestions beside the document. The command line calls the last one, on a document that
//! it writes to a file.

use crate::proposals::{
    FeatureStore, FrameFeatures, FramePictures, FrameWithFeatures, LearnError, LearnOptions,
    LineEvidence, NoProposal, PictureError, Proposal, ReferenceSamples, Resolution,
    TrainingSampleError, learn, propose, study,
};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, panic_message};
use touchline_documents::document::{Document, DocumentAt, Frame, FrameStatus};
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{
    CERTAIN, ForestModel, RelocalizeOptions, Stopped, TrainProgress,
};

/// Number of frames between two checks for cancellation. Answers up to the check are kept.
const BATCH_FRAMES: usize = 16;

/// Progress of learning.
#[derive(Clone, Copy, Debug)]
pub enum LearningProgress {
    /// Features of references are extracted.
    Features {
        /// Number of references done.
        done: usize,
        /// Total number of references.
        of: usize,
    },
    /// The forest is trained.
    Training(TrainProgress),
}

/// A forest and its training samples.
#[derive(Debug)]
pub struct LearntForest {
    /// The forest.
    pub model: ForestModel,
    /// The samples of its references, and the references that gave none.
    pub studied: ReferenceSamples,
}

/// Why no forest could be trained.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LearnForestError {
    /// No reference gives a training sample.
    #[error("No reference can be used for training. {frame}: {first}")]
    NoneUsable {
        /// The name of the first of them.
        frame: String,
        /// The reason for that one.
        first: TrainingSampleError,
    },
    /// Training failed.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

/// Trains a forest on the training frames of a document. None if `progress` cancelled it.
///
/// # Errors
/// No reference gives a training sample, or the document's cameras cannot be serialised.
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
        // Cancellation is the caller's wish and no error.
        Err(LearnError::Stopped(Stopped::Cancelled)) => Ok(None),
        Err(error) => Err(explain_failure(error, pictures.document, studied)),
    }
}

/// The error to report. If there are no samples, the reason of the first failed reference explains
/// more.
fn explain_failure(
    error: LearnError,
    document: &Document,
    studied: ReferenceSamples,
) -> LearnForestError {
    let is_without_samples = matches!(error, LearnError::Stopped(Stopped::NoSamples { .. }));
    match studied.failed.into_iter().next() {
        Some((index, first)) if is_without_samples => LearnForestError::NoneUsable {
            frame: document.frames[index].name(),
            first,
        },
        _ => error.into(),
    }
}

/// The forest to query, and its options.
#[derive(Clone, Debug)]
pub struct ForestRequest<'a> {
    /// The forest.
    pub model: &'a ForestModel,
    /// Its generation, which proposals carry; 0 if there is only one forest.
    pub generation: u64,
    /// How a frame's camera is estimated, and the confidence that it needs.
    pub options: RelocalizeOptions,
}

/// The proposals of a forest for some frames, checked together against the painted lines if
/// `evidence` is given. A frame is looked at coarsely first; where the answer is not certain, or is
/// not after the check, fine features are extracted and the forest is queried again. Proposals are
/// in the order of `frames`, and fewer if `progress` cancelled it. A panic becomes the answer of
/// its frame.
pub fn propose_on_lines(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    forest: &ForestRequest<'_>,
    evidence: Option<&LineEvidence>,
    progress: &Progress<'_, usize>,
) -> Vec<Proposal> {
    let (resolutions, mut proposals): (Vec<Resolution>, Vec<Proposal>) =
        propose_in_batches(pictures, reader, frames, forest, progress)
            .into_iter()
            .map(|found| (found.resolution, found.proposal))
            .unzip();
    let Some(evidence) = evidence else {
        return proposals;
    };
    let at = pictures.document.at(pictures.folder);
    let min_confidence = forest.options.pose.min_confidence;
    let has_say = evidence.judge(at, reader, &mut proposals, min_confidence);
    // Answers by coarse features that are no longer certain are replaced by those by fine ones.
    // There is an answer for every frame up to the cancellation and in the same order, so the
    // places of `proposals` are those of `frames`.
    let doubtful: Vec<usize> = (0..proposals.len())
        .filter(|&place| resolutions[place] == Resolution::Coarse && needs_fine(&proposals[place]))
        .collect();
    let again: Vec<usize> = doubtful.iter().map(|&place| frames[place]).collect();
    let again = pictures.each(reader, &again, |index, _, features| {
        progress.check()?;
        ControlFlow::Continue(propose_or_report(pictures, forest, index, features))
    });
    // If it is cancelled, the answers stay as doubtful as they are.
    let mut again = again.unwrap_or_default();
    // The few doubtful answers alone would not show whether the paint is evidence. All of them
    // together have decided that above.
    if has_say {
        evidence
            .with_lines_as_evidence()
            .judge(at, reader, &mut again, min_confidence);
    }
    for (place, fine) in doubtful.into_iter().zip(again) {
        proposals[place] = fine.after(&proposals[place]);
    }
    proposals
}

/// A proposal, and the resolution of the features that it is from.
struct ByResolution {
    proposal: Proposal,
    resolution: Resolution,
}

/// Whether a proposal by coarse features is to be replaced by one by fine ones.
fn needs_fine(proposal: &Proposal) -> bool {
    match &proposal.outcome {
        Ok(answer) => answer.confidence < CERTAIN,
        Err(reason) => matches!(
            reason,
            NoProposal::NotFound(_) | NoProposal::Contradicted { .. } | NoProposal::NoBetter
        ),
    }
}

/// Queries the forest for a frame. A panic becomes its answer, for it must not end the others.
fn propose_or_report(
    pictures: &FramePictures<'_>,
    forest: &ForestRequest<'_>,
    index: usize,
    features: Result<FrameFeatures, PictureError>,
) -> Proposal {
    let (document, generation) = (pictures.document, forest.generation);
    let model = (forest.model, generation);
    // The query only reads what it is given, so a panic leaves nothing half changed behind it.
    let proposal = catch_unwind(AssertUnwindSafe(|| {
        propose(document, index, features, model, &forest.options)
    }));
    proposal.unwrap_or_else(|panic| {
        let message = panic_message(panic.as_ref());
        let reason = NoProposal::Panicked { message };
        Proposal::without_answer(document, index, generation, reason)
    })
}

fn propose_in_batches(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    forest: &ForestRequest<'_>,
    progress: &Progress<'_, usize>,
) -> Vec<ByResolution> {
    let num_done = AtomicUsize::new(0);
    // Checks whether the job is cancelled already.
    let _ = progress.report(0);
    let mut proposals = Vec::with_capacity(frames.len());
    for batch in frames.chunks(BATCH_FRAMES) {
        if progress.is_cancelled() {
            break;
        }
        let of_batch = pictures.each_coarse_to_fine(
            reader,
            batch,
            |look: FrameWithFeatures<'_, ByResolution>| {
                let is_first = look.earlier.is_none();
                let proposed = propose_by_look(pictures, forest, look);
                if is_first {
                    // The answers of a batch are kept: a break takes effect before the next one.
                    let _ = progress.report(num_done.fetch_add(1, Ordering::Relaxed) + 1);
                }
                ControlFlow::Continue(proposed)
            },
            |found: &ByResolution| needs_fine(&found.proposal),
        );
        proposals.extend(of_batch.unwrap_or_default());
    }
    proposals
}

/// Queries the forest for a frame with these features. Fine features answer after coarse ones.
fn propose_by_look(
    pictures: &FramePictures<'_>,
    forest: &ForestRequest<'_>,
    look: FrameWithFeatures<'_, ByResolution>,
) -> ByResolution {
    // Where no features could be extracted, finer ones would fail as well.
    let resolution = look
        .found
        .as_ref()
        .map_or(Resolution::Fine, |features| features.resolution);
    let mut proposal = propose_or_report(pictures, forest, look.index, look.found);
    if let Some(earlier) = &look.earlier {
        proposal = proposal.after(&earlier.proposal);
    }
    ByResolution {
        proposal,
        resolution,
    }
}

/// The folders of a document's pictures and of their features.
#[derive(Clone, Copy)]
pub struct PictureFiles<'a> {
    /// The folder to which the document's relative paths refer.
    pub folder: &'a Path,
    /// The store of features extracted before.
    pub store: &'a FeatureStore,
}

/// Queries a forest for frames of a document and records its answers as suggestions. With `snap`,
/// answers are aligned to the painted lines if these decide. Returns the proposals, for their
/// reasons; fewer than `frames` if `progress` cancelled it. A proposal that is not recorded,
/// because the frame has a better camera, is [`NoProposal::NoBetter`].
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
    // The references are checked before any answer is recorded, on the document as it was given.
    let evidence = LineEvidence::from_document(document.at(folder), reader, snap)?;
    let pictures = FramePictures::new(document, folder, forest.model.features, store);
    let mut proposals =
        propose_on_lines(&pictures, reader, frames, forest, Some(&evidence), progress);
    // Record the answers. A frame may have a better camera from another source.
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

/// Trains a forest on frames of a document, as if the user had accepted them; in the document they
/// stay what they are. None if `progress` cancelled it.
///
/// # Errors
/// No frame gives a training sample, or the document's cameras cannot be serialised.
pub(super) fn learn_from_frames(
    at: DocumentAt<'_>,
    frames: &[usize],
    reader: &mut dyn ReadFrames,
    store: &FeatureStore,
    options: &LearnOptions,
    progress: &Progress<'_, LearningProgress>,
) -> Result<Option<LearntForest>, LearnForestError> {
    // Training uses references, so mark these frames as such in a copy.
    let mut accepted = at.document.clone();
    for &index in frames {
        accepted.frames[index].status = FrameStatus::Reference;
    }
    let pictures = FramePictures::new(&accepted, at.folder, options.features, store);
    learn_forest(&pictures, reader, frames, options, progress)
}

/// Whether a frame's camera is known, or found with certainty.
pub(super) fn is_certain(frame: &Frame) -> bool {
    let solution = frame.solution.as_ref();
    let confidence = solution.and_then(|solution| solution.confidence);
    // What a person accepted is certain without a number.
    frame.ptz.is_some()
        && (frame.status == FrameStatus::Reference
            || confidence.is_some_and(|confidence| confidence >= CERTAIN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proposals::Answer;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::{new_frame, soccer_document};
    use touchline_vision::relocalize::NotFound;

    #[test]
    fn fine_features_are_for_doubts_that_they_may_end() {
        let size = ImageSize::new(1280, 720);
        let mut document = soccer_document();
        let camera = Camera::new("main".into(), size);
        document.cameras.push(camera.into());
        let frame = new_frame("a.png", size);
        document.frames.push(frame.into());
        let needs = |outcome| {
            let proposal = Proposal::without_answer(&document, 0, 0, NoProposal::NoBetter);
            needs_fine(&Proposal {
                outcome,
                ..proposal
            })
        };
        assert!(!needs(Ok(Answer::at_pan(0.0, CERTAIN))));
        assert!(needs(Ok(Answer::at_pan(0.0, CERTAIN - 0.01))));
        let unsure = NotFound::FewMatches {
            matched: 3,
            needed: 6,
        };
        assert!(needs(Err(unsure.into())));
        assert!(needs(Err(NoProposal::Contradicted { found: 1, open: 30 })));
        let camera = "main".to_owned();
        assert!(!needs(Err(NoProposal::NoBase { camera })));
        assert!(needs(Err(NoProposal::NoBetter)));
    }
}
