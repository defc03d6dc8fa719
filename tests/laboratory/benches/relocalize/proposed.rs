//! Frames answered as the program answers them: references learnt, every frame proposed, the paint
//! as a second opinion.

use touchline::media::ReadFrames;
use touchline::pipelines::{ForestRequest, propose_on_lines};
use touchline::progress::Progress;
use touchline::proposals::{
    FramePictures, LearnError, LearnOptions, LineEvidence, Proposal, learn, study,
};
use touchline::relocalize::RelocalizeOptions;

/// The proposals for some frames by others that are references; an error where these teach nothing.
pub fn propose_all(
    pictures: &FramePictures,
    reader: &mut dyn ReadFrames,
    evidence: &LineEvidence,
    references: &[usize],
    asked: &[usize],
) -> Result<Vec<Proposal>, LearnError> {
    let document = pictures.document;
    let studied = study(pictures, reader, references, &Progress::default()).unwrap();
    let model = learn(
        document,
        &studied,
        &LearnOptions::default(),
        &Progress::default(),
    )?;
    let forest = ForestRequest {
        model: &model,
        generation: 0,
        options: RelocalizeOptions::default(),
    };
    Ok(propose_on_lines(
        pictures,
        reader,
        asked,
        &forest,
        Some(evidence),
        &Progress::default(),
    ))
}
