//! What the painted lines say about a proposed camera, and how that enters its confidence.

use super::{Answer, NoProposal, Proposal, read_picture};
use crate::camera::PtzCamera;
use crate::document::{DocumentAt, Fields, Frame, FrameStatus};
use crate::field::FieldError;
use crate::media::{FrameReader, Picture, ReadFrames};
use crate::paint::{GroundPicture, LineCheck, LineVerdict, check_lines};
use rayon::prelude::*;

/// References whose paint is looked at.
const REFERENCES: usize = 5;

/// However sure the features are, the paint decides: of the logarithm of their odds at most this counts.
const FEATURES_AT_MOST: f64 = 1.0;

/// Without references, the paint is ignored if it supports fewer than this share of the answers,
const LEAST_SUPPORTED: f64 = 0.1;

/// of at least this many.
const ENOUGH_ANSWERS: usize = 10;

/// What the painted lines of a document's pictures may say.
#[derive(Clone, Debug)]
pub struct LineEvidence {
    fields: Fields,
    /// Whether the paint bears out references; none where there is none to ask.
    proven: Option<bool>,
}

impl LineEvidence {
    /// Asks the paint about some references first: where it bears none of them out, the field's lines are not those of the
    /// pictures, or cannot be seen, and it is not asked further.
    ///
    /// # Errors
    /// A field of the document is not valid.
    pub fn of(at: DocumentAt<'_>, reader: &mut dyn ReadFrames) -> Result<Self, FieldError> {
        let fields = Fields::of(at)?;
        let mut evidence = Self { fields, proven: None };
        let solved = |frame: &&Frame| frame.status == FrameStatus::Reference && frame.ptz.is_some();
        let references: Vec<&Frame> = at.document.frames.iter().map(|frame| &**frame).filter(solved).collect();
        for frame in references.iter().step_by(references.len().div_ceil(REFERENCES).max(1)) {
            let (Some(camera), Ok(picture)) = (at.document.pointed(frame), read_picture(reader, frame, at.folder))
            else {
                continue;
            };
            let check = evidence.check(at, frame, &camera, &picture);
            if can_say(&check) {
                let supports = check.verdict() == LineVerdict::Supports;
                evidence.proven = Some(evidence.proven.unwrap_or(false) || supports);
            }
        }
        Ok(evidence)
    }

    fn check(&self, at: DocumentAt<'_>, frame: &Frame, camera: &PtzCamera, picture: &Picture) -> LineCheck {
        let ground = GroundPicture::new(picture, &at.document.masks_of(frame));
        check_lines(&ground, self.fields.of_frame(at.document, frame), camera)
    }

    /// Asks the paint about the answers: it enters their confidence, and those that fall below `min_confidence` are answers no
    /// more. Pictures that cannot be read change nothing.
    pub fn judge(
        &self,
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        proposals: &mut [Proposal],
        min_confidence: f64,
    ) {
        if self.proven == Some(false) {
            return;
        }
        // Videos are read one frame after the other, images side by side.
        for proposal in proposals.iter_mut() {
            if at.document.frames.by_id(&proposal.frame).is_some_and(|frame| frame.image.is_none()) {
                self.ask(at, reader, proposal);
            }
        }
        proposals.par_iter_mut().for_each(|proposal| {
            if at.document.frames.by_id(&proposal.frame).is_some_and(|frame| frame.image.is_some()) {
                self.ask(at, &mut FrameReader::new(), proposal);
            }
        });
        if self.proven.is_none() && supports_hardly_any(proposals) {
            return;
        }
        for proposal in proposals {
            if let Ok(answer) = &mut proposal.outcome
                && let Some(contradicted) = weigh(answer, min_confidence)
            {
                proposal.outcome = Err(contradicted);
            }
        }
    }

    fn ask(&self, at: DocumentAt<'_>, reader: &mut dyn ReadFrames, proposal: &mut Proposal) {
        let Some(frame) = at.document.frames.by_id(&proposal.frame) else { return };
        let (Ok(answer), Some(base)) = (&mut proposal.outcome, proposal.asked.base) else { return };
        let Ok(picture) = read_picture(reader, frame, at.folder) else { return };
        let camera = PtzCamera::new(base, answer.ptz.ptz());
        answer.line_check = Some(self.check(at, frame, &camera, &picture));
    }
}

/// Whether enough of the lines lies open.
fn can_say(check: &LineCheck) -> bool {
    check.found + check.bare >= LineCheck::FEWEST_OPEN
}

fn supports_hardly_any(proposals: &[Proposal]) -> bool {
    let checks = proposals.iter().filter_map(|proposal| proposal.outcome.as_ref().ok()?.line_check.as_ref());
    let (mut asked, mut supported) = (0_usize, 0_usize);
    for check in checks.filter(|check| can_say(check)) {
        asked += 1;
        supported += usize::from(check.verdict() == LineVerdict::Supports);
    }
    asked >= ENOUGH_ANSWERS && (supported as f64) < LEAST_SUPPORTED * asked as f64
}

/// Lets what the paint says into the confidence of an answer; why it is an answer no more, if it is none.
fn weigh(answer: &mut Answer, min_confidence: f64) -> Option<NoProposal> {
    let check = answer.line_check.filter(can_say)?;
    let log_odds = |probability: f64| (probability / (1.0 - probability)).ln();
    let both = log_odds(check.score) + log_odds(answer.evidence.agreement()).min(FEATURES_AT_MOST);
    answer.confidence = answer.evidence.confidence_if(1.0 / (1.0 + (-both).exp()));
    let contradicted = NoProposal::Contradicted { found: check.found, open: check.found + check.bare };
    (!(answer.confidence >= min_confidence)).then_some(contradicted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ptz;
    use crate::document::FramePtz;
    use crate::geometry::Mat3;
    use crate::relocalize::{Evidence, FromReference};

    /// An answer from features that are good to this many px.
    fn answer(features_sigma_px: f64, score: f64, open: usize) -> Answer {
        let evidence = Evidence {
            breadth_px: 100.0,
            features_sigma_px,
            labelled_sigma_px: 1.0,
            from_reference: FromReference::default(),
            at_most: 1.0,
        };
        let line_check = Some(LineCheck {
            predicted: open,
            found: open / 2,
            bare: open - open / 2,
            offset_px: 1.0,
            bias_px: 0.0,
            halves_px: 1.0,
            unexplained: None,
            agreement: 0.5,
            score,
        });
        Answer {
            ptz: FramePtz::new(Ptz::from_degrees(0.0, -10.0, 2000.0), None),
            covariance: Mat3::identity(),
            rms_px: 1.0,
            worst_corner_sigma_px: 1.0,
            confidence: evidence.confidence(),
            inliers: 100,
            places: 50,
            evidence,
            line_check,
        }
    }

    #[test]
    fn however_certain_the_features_are_paint_that_is_elsewhere_ends_the_answer() {
        let mut certain = answer(0.2, 0.02, 200);
        assert!(certain.confidence > 0.998);
        assert_eq!(weigh(&mut certain, 0.5), Some(NoProposal::Contradicted { found: 100, open: 200 }));
        assert!(certain.confidence < 0.1, "{}", certain.confidence);
    }

    #[test]
    fn paint_that_supports_raises_a_doubtful_answer_and_keeps_a_certain_one() {
        for (features_sigma_px, least) in [(11.0, 0.97), (0.2, 0.98)] {
            let mut answer = answer(features_sigma_px, 0.97, 200);
            assert_eq!(weigh(&mut answer, 0.5), None);
            assert!(answer.confidence > least && answer.confidence < 1.0, "{}", answer.confidence);
        }
    }

    #[test]
    fn where_too_little_is_open_the_features_decide() {
        let mut hidden = answer(4.0, 0.3, 8);
        let before = hidden.confidence;
        assert_eq!(weigh(&mut hidden, 0.5), None);
        assert!(hidden.confidence == before && before > 0.5);
    }
}
