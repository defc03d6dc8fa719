//! The frames that a search without clicks has not looked at: a video's are carried from those it has, images are asked of a
//! forest that learns from them.

use super::messages::Messages;
use super::track::track_and_report;
use std::ops::ControlFlow;
use std::path::Path;
use touchline_calibration::calibrate::UnclickedCamera;
use touchline_calibration::pipelines::TrackingOptions;
use touchline_calibration::proposals::{
    FeatureStore, FramePictures, LearnOptions, LineEvidence, learn, propose, study,
};
use touchline_documents::document::{Document, FrameStatus};
use touchline_vision::media::FrameReader;
use touchline_vision::relocalize::{PoseOptions, RelocalizeOptions};

/// Answers the frames of a document that have no camera yet, from those of the cameras `found`; how many it answered and how many
/// stay without.
///
/// # Errors
/// The field is not valid, or a video's frame cannot be read.
pub fn answer_the_rest(
    document: &mut Document,
    folder: &Path,
    found: &[UnclickedCamera],
    messages: Messages,
) -> anyhow::Result<(usize, usize)> {
    let without = |document: &Document| document.frames.iter().filter(|frame| frame.ptz.is_none()).count();
    let open = without(document);
    if open == 0 {
        return Ok((0, 0));
    }
    if document.frames.iter().any(|frame| frame.video.is_some()) {
        let options = TrackingOptions { refine_base: true, ..TrackingOptions::default() };
        track_and_report(document, folder, None, &options, &|| false, messages)?;
    } else {
        relocalize(document, folder, found, messages)?;
    }
    let still = without(document);
    Ok((open - still, still))
}

/// Asks a forest for the images without a camera. It learns from those that agree with their own painted lines, as if a person had
/// accepted them; the document keeps them as suggestions.
fn relocalize(
    document: &mut Document,
    folder: &Path,
    found: &[UnclickedCamera],
    messages: Messages,
) -> anyhow::Result<()> {
    let mut taught = document.clone();
    let frames = found.iter().flat_map(|found| &found.frames);
    let mut sure: Vec<usize> = frames.filter(|frame| frame.snapped.is_some()).map(|frame| frame.index).collect();
    sure.sort_unstable();
    for &index in &sure {
        taught.frames[index].status = FrameStatus::Reference;
    }
    let options = LearnOptions::default();
    let store = FeatureStore::in_memory();
    let pictures = FramePictures { document: &taught, folder, options: options.features, store: &store };
    let mut reader = FrameReader::new();
    let bar = messages.progress(sure.len(), "Learning from the frames found");
    let studied = study(&pictures, &mut reader, &sure, &|| {
        bar.inc(1);
        ControlFlow::Continue(())
    });
    let model = learn(&taught, &studied.unwrap_or_default(), &options, &|_| ControlFlow::Continue(()));
    bar.finish_and_clear();
    let model = model?;
    let asked: Vec<usize> = (0..document.frames.len()).filter(|&index| document.frames[index].ptz.is_none()).collect();
    let bar = messages.progress(asked.len(), "Asking for the other frames");
    let relocalizing = RelocalizeOptions::default();
    let proposals = pictures.each(&mut reader, &asked, |index, _, features| {
        bar.inc(1);
        ControlFlow::Continue(propose(&taught, index, features, (&model, 0), &relocalizing))
    });
    bar.finish_and_clear();
    let mut proposals = proposals.unwrap_or_default();
    let at = document.at(folder);
    LineEvidence::of(at, &mut reader, true)?.judge(
        at,
        &mut reader,
        &mut proposals,
        PoseOptions::default().min_confidence,
    );
    for proposal in proposals {
        let Some(frame) = document.frames.by_id_mut(&proposal.frame) else { continue };
        proposal.record(frame);
    }
    Ok(())
}
