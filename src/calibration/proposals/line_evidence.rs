//! What the painted lines say about a proposed camera, how that enters its confidence, and the
//! camera pulled onto them.

use super::{Answer, FramePicture, NoProposal, PictureStream, Proposal, read_picture};
use crate::calibrate::may_replace;
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldError;
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::markings::{FEWEST_OPEN, LineVerdict};
use touchline_documents::document::{DocumentAt, Fields, Frame, FramePtz, FrameStatus};
use touchline_vision::media::{FrameReader, Picture, ReadFrames};
use touchline_vision::paint::{
    GroundPicture, LineCheck, SnapOptions, Snapped, check_lines, overlays_apart_px, snap,
};
use touchline_vision::relocalize::{Evidence, FromReference, NotFound};

/// References whose paint is looked at.
const REFERENCES: usize = 5;

/// However sure the features are, the paint decides: of the logarithm of their odds at most this
/// counts.
const FEATURES_AT_MOST: f64 = 1.0;

/// What a median distance of paint across the lines says of the overlay's 1-σ: half of a normal
/// distribution lies within .674 σ of one component, and the length has two of them.
const SIGMAS_PER_MEDIAN: f64 = 2.1;

/// An answer that lies no farther beside the paint is the one that it is pulled to, px at 1920 px
/// width.
const BESIDE_PX: f64 = 30.0;

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
    /// Whether answers that the paint does not contradict are snapped to it.
    snapping: bool,
}

impl LineEvidence {
    /// Asks the paint about some references first: where it bears none of them out, the field's
    /// lines are not those of the pictures, or cannot be seen, and it is not asked further. With
    /// `snapping`, answers that it does not contradict are pulled onto it.
    ///
    /// # Errors
    /// A field of the document is not valid.
    pub fn of(
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        snapping: bool,
    ) -> Result<Self, FieldError> {
        let fields = Fields::of(at)?;
        let mut evidence = Self {
            fields,
            proven: None,
            snapping,
        };
        let is_solved =
            |frame: &Frame| frame.status == FrameStatus::Reference && frame.ptz.is_some();
        let references: Vec<usize> = (0..at.document.frames.len())
            .filter(|&index| is_solved(&at.document.frames[index]))
            .collect();
        let pictures =
            PictureStream::new(at, subsample(references, REFERENCES)).with_reader(reader);
        for FramePicture { frame, picture, .. } in pictures {
            let (Some(camera), Ok(picture)) = (at.document.pointed(frame), picture) else {
                continue;
            };
            let check = check_lines(
                &ground(at, frame, &picture),
                evidence.fields.of_frame(at.document, frame),
                &camera,
            );
            if can_say(&check) {
                let supports = check.verdict() == LineVerdict::Supports;
                evidence.proven = Some(evidence.proven.unwrap_or(false) || supports);
            }
        }
        Ok(evidence)
    }

    /// Asks the paint about the answers: it enters their confidence, and those that fall below
    /// `min_confidence` are answers no more, unless they are snapped to it and it then bears them
    /// out. The others are snapped where that is wanted and the paint decides. Pictures that cannot
    /// be read change nothing.
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
        let mut found: Vec<Option<PaintAnswer>> = vec![None; proposals.len()];
        // Videos are read one frame after the other, images side by side.
        for (proposal, found) in proposals.iter_mut().zip(&mut found) {
            if at
                .document
                .frames
                .by_id(&proposal.frame)
                .is_some_and(|frame| frame.image.is_none())
            {
                *found = self.ask(at, reader, proposal);
            }
        }
        proposals
            .par_iter_mut()
            .zip(&mut found)
            .for_each(|(proposal, found)| {
                if at
                    .document
                    .frames
                    .by_id(&proposal.frame)
                    .is_some_and(|frame| frame.image.is_some())
                {
                    *found = self.ask(at, &mut FrameReader::new(), proposal);
                }
            });
        if self.proven.is_none() && supports_hardly_any(proposals) {
            return;
        }
        for (proposal, found) in proposals.iter_mut().zip(found) {
            let PaintAnswer { snapped, earlier } = found.unwrap_or_default();
            let scale = at
                .document
                .frames
                .by_id(&proposal.frame)
                .map_or(1.0, |frame| frame.image_size.scale_from_1920());
            let Ok(answer) = &mut proposal.outcome else {
                continue;
            };
            let refused = weigh(answer, scale, min_confidence);
            let is_better = |snapped: &mut Answer| {
                let stands = weigh(snapped, scale, min_confidence).is_none();
                stands
                    && (refused.is_none()
                        || is_borne_out(snapped, answer, proposal.asked.base.as_ref(), scale))
            };
            if let Some(snapped) =
                snapped.and_then(|mut snapped| is_better(&mut snapped).then_some(snapped))
            {
                *answer = snapped;
            } else if let Some(refused) = refused {
                proposal.outcome = Err(refused);
                continue;
            }
            let now = answer.line_check.as_ref();
            if earlier
                .zip(now)
                .is_some_and(|(earlier, now)| !may_replace(&earlier, now))
            {
                proposal.outcome = Err(NoProposal::NoBetter);
            }
        }
    }

    /// Has the paint judge an answer, and an earlier one that no forest gave.
    fn ask(
        &self,
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        proposal: &mut Proposal,
    ) -> Option<PaintAnswer> {
        let frame = at.document.frames.by_id(&proposal.frame)?;
        let (answer, base) = (proposal.outcome.as_mut().ok()?, proposal.asked.base?);
        let picture = read_picture(reader, frame, at.folder).ok()?;
        let (ground, field) = (
            ground(at, frame, &picture),
            self.fields.of_frame(at.document, frame),
        );
        let start = answer.ptz.ptz();
        answer.line_check = Some(check_lines(&ground, field, &PtzCamera::new(base, start)));
        let earlier = at
            .document
            .pointed(frame)
            .filter(|_| frame.is_answered_without_forest());
        let earlier = earlier.map(|earlier| check_lines(&ground, field, &earlier));
        // Where the paint does not decide, the answer stays as the forest gave it.
        let snapped = self
            .snapping
            .then(|| snap(&ground, field, &base, start, &[], &SnapOptions::default()).ok())
            .flatten();
        let snapped = snapped.map(|snapped| on_paint(answer, &base, &snapped, frame.image_size));
        Some(PaintAnswer { snapped, earlier })
    }
}

/// What the paint of a frame says beside its check of the answer.
#[derive(Clone, Default)]
struct PaintAnswer {
    /// The answer pulled onto the paint, where that is wanted and the paint decides.
    snapped: Option<Answer>,
    /// The check of a camera that the frame has and that no forest proposed.
    earlier: Option<LineCheck>,
}

/// An answer pulled onto the paint: which of the matches are right does not change, but the camera
/// is known as the paint has it.
fn on_paint(
    answer: &Answer,
    base: &CameraBase,
    snapped: &Snapped,
    image_size: ImageSize,
) -> Answer {
    let camera = PtzCamera::new(*base, snapped.ptz);
    let worst_corner_sigma_px = snapped
        .uncertainty
        .worst_corner_sigma_px(&camera, image_size);
    // The paint says where the camera is, however far the references are, and whatever the base
    // leaves open.
    let by_paint = snapped.uncertainty.with_exact_base();
    let labelled_sigma_px =
        by_paint.worst_corner_sigma_px(&camera, image_size) / image_size.scale_from_1920();
    let evidence = Evidence {
        labelled_sigma_px,
        from_reference: FromReference::default(),
        ..answer.evidence
    };
    Answer {
        ptz: FramePtz::new(
            snapped.ptz,
            Some(camera.lens()).filter(|lens| !lens.is_none()),
        ),
        covariance: snapped.uncertainty.ptz_covariance_deg(),
        own_covariance: snapped.uncertainty.own_covariance_deg(),
        rms_px: snapped.rms_px,
        worst_corner_sigma_px,
        evidence,
        line_check: Some(snapped.check),
        samples: Some(snapped.samples),
        ..answer.clone()
    }
}

/// Whether the paint bears out an answer that was pulled onto it from so near that it is the same
/// answer.
fn is_borne_out(snapped: &Answer, answer: &Answer, base: Option<&CameraBase>, scale: f64) -> bool {
    let (Some(base), Some(check)) = (base, &snapped.line_check) else {
        return false;
    };
    let size = ImageSize::new(
        (1920.0 * scale).round() as u32,
        (1080.0 * scale).round() as u32,
    );
    let apart_px = overlays_apart_px(
        &PtzCamera::new(*base, answer.ptz.ptz()),
        snapped.ptz.ptz(),
        size,
    );
    check.verdict() == LineVerdict::Supports && apart_px <= BESIDE_PX * scale
}

fn ground(at: DocumentAt<'_>, frame: &Frame, picture: &Picture) -> GroundPicture {
    GroundPicture::new(picture, &at.document.masks_of(frame))
}

/// Whether enough of the lines lies open.
fn can_say(check: &LineCheck) -> bool {
    check.found + check.bare >= FEWEST_OPEN
}

fn supports_hardly_any(proposals: &[Proposal]) -> bool {
    let checks = proposals
        .iter()
        .filter_map(|proposal| proposal.outcome.as_ref().ok()?.line_check.as_ref());
    let (mut asked, mut supported) = (0_usize, 0_usize);
    for check in checks.filter(|check| can_say(check)) {
        asked += 1;
        supported += usize::from(check.verdict() == LineVerdict::Supports);
    }
    asked >= ENOUGH_ANSWERS && (supported as f64) < LEAST_SUPPORTED * asked as f64
}

/// Lets what the paint says into the confidence of an answer: whether it bears the answer out, and
/// how far off it lies. Why it is an answer no more, if it is none. `scale` is the picture's width
/// in units of 1920 px.
fn weigh(answer: &mut Answer, scale: f64, min_confidence: f64) -> Option<NoProposal> {
    let check = answer.line_check.filter(can_say)?;
    let log_odds = |probability: f64| (probability / (1.0 - probability)).ln();
    let both = log_odds(check.score) + log_odds(answer.evidence.agreement()).min(FEATURES_AT_MOST);
    let seen_sigma_px = SIGMAS_PER_MEDIAN * check.offset_px / scale;
    let seen_sigma_px = if seen_sigma_px.is_finite() {
        seen_sigma_px
    } else {
        0.0
    };
    answer.confidence = answer
        .evidence
        .confidence_if(1.0 / (1.0 + (-both).exp()), seen_sigma_px);
    if answer.confidence >= min_confidence {
        return None;
    }
    if check.verdict() == LineVerdict::Contradicts {
        return Some(NoProposal::Contradicted {
            found: check.found,
            open: check.found + check.bare,
        });
    }
    // The paint may be a few px beside the lines, or far from deciding.
    let Answer {
        confidence,
        inliers,
        places,
        worst_corner_sigma_px,
        ..
    } = *answer;
    Some(
        NotFound::Unsure {
            confidence,
            inliers,
            places,
            worst_corner_sigma_px,
        }
        .into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::Mat3;
    use touchline_documents::document::FramePtz;

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
            emptiest: None,
            agreement: 0.5,
            score,
        });
        Answer {
            ptz: FramePtz::new(Ptz::from_degrees(0.0, -10.0, 2000.0), None),
            covariance: Mat3::identity(),
            own_covariance: Mat3::identity(),
            rms_px: 1.0,
            worst_corner_sigma_px: 1.0,
            confidence: evidence.confidence(),
            inliers: 100,
            places: 50,
            evidence,
            line_check,
            samples: None,
        }
    }

    #[test]
    fn however_certain_the_features_are_paint_that_is_elsewhere_ends_the_answer() {
        let mut certain = answer(0.2, 0.02, 200);
        assert!(certain.confidence > 0.998);
        assert_eq!(
            weigh(&mut certain, 1.0, 0.5),
            Some(NoProposal::Contradicted {
                found: 100,
                open: 200
            })
        );
        assert!(certain.confidence < 0.1, "{}", certain.confidence);
    }

    #[test]
    fn paint_that_supports_raises_a_doubtful_answer_and_keeps_a_certain_one() {
        for (features_sigma_px, least) in [(11.0, 0.97), (0.2, 0.98)] {
            let mut answer = answer(features_sigma_px, 0.97, 200);
            assert_eq!(weigh(&mut answer, 1.0, 0.5), None);
            assert!(
                answer.confidence > least && answer.confidence < 1.0,
                "{}",
                answer.confidence
            );
        }
    }

    #[test]
    fn paint_beside_the_lines_makes_an_answer_as_uncertain_as_it_is_off() {
        let confidence = |offset_px| {
            let mut answer = answer(0.2, 0.97, 200);
            answer.line_check = answer
                .line_check
                .map(|check| LineCheck { offset_px, ..check });
            weigh(&mut answer, 1.0, 0.0);
            answer.confidence
        };
        let [on, beside, off] = [1.0, 2.5, 4.0].map(confidence);
        assert!(
            on > 0.98 && beside > 0.95 && off < 0.8,
            "{on} {beside} {off}"
        );
        assert!(confidence(f64::NAN) >= on, "none was found");
    }

    #[test]
    fn an_answer_that_is_only_doubtful_is_not_said_to_be_contradicted() {
        let mut doubtful = answer(11.0, 0.6, 200);
        doubtful.line_check = doubtful.line_check.map(|check| LineCheck {
            offset_px: 9.0,
            ..check
        });
        let reason = weigh(&mut doubtful, 1.0, 0.9);
        assert!(
            matches!(reason, Some(NoProposal::NotFound(NotFound::Unsure { .. }))),
            "{reason:?}"
        );
    }

    #[test]
    fn where_too_little_is_open_the_features_decide() {
        let mut hidden = answer(4.0, 0.3, 8);
        let before = hidden.confidence;
        assert_eq!(weigh(&mut hidden, 1.0, 0.5), None);
        assert!(hidden.confidence == before && before > 0.5);
    }
}
