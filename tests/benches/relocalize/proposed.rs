//! Frames answered as the program answers them: references learnt, every frame proposed, the paint
//! as a second opinion.

use std::ops::ControlFlow;
use touchline::media::ReadFrames;
use touchline::progress::Progress;
use touchline::proposals::{
    FramePictures, LearnError, LearnOptions, LineEvidence, Proposal, learn, propose, study,
};
use touchline::relocalize::RelocalizeOptions;

/// The proposals for some frames by others that are references; an error where these teach nothing.
pub fn proposed(
    pictures: &FramePictures,
    reader: &mut dyn ReadFrames,
    evidence: &LineEvidence,
    references: &[usize],
    asked: &[usize],
) -> Result<Vec<Proposal>, LearnError> {
    let (document, options) = (pictures.document, RelocalizeOptions::default());
    let studied = study(pictures, reader, references, &Progress::default()).unwrap();
    let model = learn(
        document,
        &studied,
        &LearnOptions::default(),
        &Progress::default(),
    )?;
    let proposals = pictures.each(reader, asked, |index, _, found| {
        ControlFlow::Continue(propose(document, index, found, (&model, 0), &options))
    });
    let mut proposals = proposals.unwrap();
    evidence.judge(
        document.at(pictures.folder),
        reader,
        &mut proposals,
        options.pose.min_confidence,
    );
    Ok(proposals)
}
