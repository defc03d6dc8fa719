//! The evidence of painted lines for or against a proposed camera.
//!
//! The lines of a frame's picture are compared with those that the camera predicts. The result
//! enters the confidence of the proposal, can reject it, and can replace it by a camera that is
//! aligned to the paint.

use crate::calibrate::may_replace;
use crate::proposals::{Answer, FramePicture, NoProposal, PictureStream, Proposal, read_picture};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldError;
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{DocumentAt, Fields, Frame, FramePtz, FrameStatus};
use touchline_vision::media::{FrameReader, Picture, ReadFrames};
use touchline_vision::paint::{
    GroundPicture, LineCheck, SnapOptions, Snapped, check_lines, overlays_apart_px, snap,
};
use touchline_vision::relocalize::{Evidence, FromReference, NotFound};

/// Number of references that are checked against the paint.
const REFERENCES: usize = 5;

/// Upper limit for the log odds of the features' agreement: however confident they are, the paint
/// decides.
const FEATURES_AT_MOST: f64 = 1.0;

/// 1-σ of the overlay per median distance of paint across the lines: the median of |x| of a normal
/// distribution is 0.674 σ, and the overlay has two components: √2 / 0.674.
const SIGMAS_PER_MEDIAN: f64 = 2.1;

/// An aligned camera is the same answer as the one that it started from if their overlays are no
/// farther apart than this, px at 1920 px width.
const BESIDE_PX: f64 = 30.0;

/// Without references, the paint is ignored if it supports less than this share of the answers …
const LEAST_SUPPORTED: f64 = 0.1;

/// … of at least this many.
const ENOUGH_ANSWERS: usize = 10;

/// The check of proposed cameras against the painted lines of a document's pictures.
#[derive(Clone, Debug)]
pub struct LineEvidence {
    fields: Fields,
    /// Whether the paint supports any of the references; none if no reference can be checked.
    proven: Option<bool>,
    /// Whether answers that the paint does not contradict are aligned to it.
    snapping: bool,
}

impl LineEvidence {
    /// Checks some references first. If the paint supports none of them, the lines of the field are
    /// not those of the pictures, or cannot be seen, and no answer is checked. With `snapping`,
    /// answers that the paint does not contradict are aligned to it.
    ///
    /// # Errors
    /// A field of the document is not valid.
    pub fn from_document(
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        snapping: bool,
    ) -> Result<Self, FieldError> {
        let fields = Fields::from_document(at)?;
        let mut evidence = Self {
            fields,
            proven: None,
            snapping,
        };
        let references: Vec<usize> = (0..at.document.frames.len())
            .filter(|&index| {
                let frame = &at.document.frames[index];
                frame.status == FrameStatus::Reference && frame.ptz.is_some()
            })
            .collect();
        let pictures =
            PictureStream::new(at, subsample(references, REFERENCES)).with_reader(reader);
        // One supported reference suffices. References with too few unoccluded samples decide
        // nothing.
        for FramePicture { frame, picture, .. } in pictures {
            let (Some(camera), Ok(picture)) = (at.document.ptz_camera(frame), picture) else {
                continue;
            };
            let check = check_lines(
                &ground(at, frame, &picture),
                evidence.fields.for_frame(at.document, frame),
                &camera,
            );
            if check.can_say() {
                let supports = check.verdict() == LineVerdict::Supports;
                evidence.proven = Some(evidence.proven.unwrap_or(false) || supports);
            }
        }
        Ok(evidence)
    }

    /// Checks answers against the paint, which enters their confidence. An answer that falls below
    /// `min_confidence` is withdrawn, unless it was aligned to the paint and the paint then
    /// supports it. With snapping enabled, other answers are aligned as well if the paint
    /// determines the camera. Pictures that cannot be read change nothing.
    ///
    /// Returns whether the paint counts as evidence. If not, no answer is withdrawn or replaced.
    pub fn judge(
        &self,
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        proposals: &mut [Proposal],
        min_confidence: f64,
    ) -> bool {
        // References that a person accepted are on no paint: the pictures do not show the lines of
        // this field, or they cannot be seen.
        if self.proven == Some(false) {
            return false;
        }
        let mut found: Vec<Option<PaintAnswer>> = vec![None; proposals.len()];
        // Videos are read one frame after the other with the shared decoder, images in parallel.
        for (proposal, found) in proposals.iter_mut().zip(&mut found) {
            if is_of_image(at, proposal) == Some(false) {
                *found = self.ask(at, reader, proposal);
            }
        }
        proposals
            .par_iter_mut()
            .zip(&mut found)
            .for_each(|(proposal, found)| {
                if is_of_image(at, proposal) == Some(true) {
                    *found = self.ask(at, &mut FrameReader::new(), proposal);
                }
            });
        // Without references, the answers themselves show whether the pictures have the lines of
        // the field.
        if self.proven.is_none() && supports_hardly_any(proposals) {
            return false;
        }
        for (proposal, found) in proposals.iter_mut().zip(found) {
            let PaintAnswer { snapped, earlier } = found.unwrap_or_default();
            let (Some(frame), Ok(answer)) = (
                at.document.frames.by_id(&proposal.frame),
                &mut proposal.outcome,
            ) else {
                continue;
            };
            let (image_size, scale) = (frame.image_size, frame.image_size.scale_from_1920());
            // The aligned camera replaces the answer if it reaches the confidence by itself; if the
            // answer did not, it must also be supported and close to it.
            let refused = weigh(answer, scale, min_confidence);
            let base = proposal.request.base.as_ref();
            let better = snapped.and_then(|mut snapped| {
                let stands = weigh(&mut snapped, scale, min_confidence).is_none();
                let is_better = stands
                    && (refused.is_none() || is_borne_out(&snapped, answer, base, image_size));
                is_better.then_some(snapped)
            });
            if let Some(snapped) = better {
                *answer = snapped;
            } else if let Some(refused) = refused {
                proposal.outcome = Err(refused);
                continue;
            }
            // A camera that the frame has from another source stays unless the new one fits the
            // paint at least as well.
            let now = answer.line_check.as_ref();
            if earlier
                .zip(now)
                .is_some_and(|(earlier, now)| !may_replace(&earlier, now))
            {
                proposal.outcome = Err(NoProposal::NoBetter);
            }
        }
        true
    }

    /// The same check for further answers about pictures in which the paint counts as evidence: it
    /// does however few of these it supports.
    #[must_use]
    pub fn with_lines_as_evidence(&self) -> Self {
        Self {
            proven: Some(true),
            ..self.clone()
        }
    }

    /// Checks an answer, and the camera that the frame has from another source than a forest.
    fn ask(
        &self,
        at: DocumentAt<'_>,
        reader: &mut dyn ReadFrames,
        proposal: &mut Proposal,
    ) -> Option<PaintAnswer> {
        let frame = at.document.frames.by_id(&proposal.frame)?;
        let (answer, base) = (proposal.outcome.as_mut().ok()?, proposal.request.base?);
        let picture = read_picture(reader, frame, at.folder).ok()?;
        let (ground, field) = (
            ground(at, frame, &picture),
            self.fields.for_frame(at.document, frame),
        );
        let start = answer.ptz.ptz();
        // Check the answer where it is, and the earlier camera in the same picture.
        answer.line_check = Some(check_lines(&ground, field, &PtzCamera::new(base, start)));
        let earlier = at
            .document
            .ptz_camera(frame)
            .filter(|_| frame.is_answered_without_forest());
        let earlier = earlier.map(|earlier| check_lines(&ground, field, &earlier));
        // If the alignment fails, the answer stays as the forest gave it.
        let snapped = self
            .snapping
            .then(|| snap(&ground, field, &base, start, &[], &SnapOptions::default()).ok())
            .flatten();
        let snapped = snapped.map(|snapped| on_paint(answer, &base, &snapped, frame.image_size));
        Some(PaintAnswer { snapped, earlier })
    }
}

/// Results for a frame besides the check of the answer.
#[derive(Clone, Default)]
struct PaintAnswer {
    /// The answer aligned to the paint, if alignment is enabled and converges.
    snapped: Option<Answer>,
    /// The check of a camera that the frame has and that no forest proposed.
    earlier: Option<LineCheck>,
}

/// An answer aligned to the paint. Its inliers stay those of the answer; camera and covariance are
/// those of the alignment.
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
    // The alignment measures the camera in this frame, so neither the labels of the references nor
    // the error of the base count against it.
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

/// Whether the paint supports an aligned answer that lies within [`BESIDE_PX`] of the original, so
/// that it counts as the same answer.
fn is_borne_out(
    snapped: &Answer,
    answer: &Answer,
    base: Option<&CameraBase>,
    image_size: ImageSize,
) -> bool {
    let (Some(base), Some(check)) = (base, &snapped.line_check) else {
        return false;
    };
    let apart_px = overlays_apart_px(
        &PtzCamera::new(*base, answer.ptz.ptz()),
        snapped.ptz.ptz(),
        image_size,
    );
    check.verdict() == LineVerdict::Supports && apart_px <= BESIDE_PX * image_size.scale_from_1920()
}

/// Whether the picture of a proposal's frame is an image file; none if the document has no such
/// frame.
fn is_of_image(at: DocumentAt<'_>, proposal: &Proposal) -> Option<bool> {
    let frame = at.document.frames.by_id(&proposal.frame)?;
    Some(frame.image.is_some())
}

/// The picture of a frame, without its masked pixels.
fn ground(at: DocumentAt<'_>, frame: &Frame, picture: &Picture) -> GroundPicture {
    GroundPicture::new(picture, &at.document.masks_of(frame))
}

/// Whether the paint supports hardly any of the answers. Then the pictures do not show the field's
/// lines, and the paint is no evidence about a single answer.
fn supports_hardly_any(proposals: &[Proposal]) -> bool {
    let checks = proposals
        .iter()
        .filter_map(|proposal| proposal.outcome.as_ref().ok()?.line_check.as_ref());
    let (mut request, mut supported) = (0_usize, 0_usize);
    for check in checks.filter(|check| check.can_say()) {
        request += 1;
        supported += usize::from(check.verdict() == LineVerdict::Supports);
    }
    request >= ENOUGH_ANSWERS && (supported as f64) < LEAST_SUPPORTED * request as f64
}

/// Updates the confidence of an answer with the paint: how well it supports the answer, and how far
/// off it lies. Returns why the answer is withdrawn, if its confidence is too low. `scale` is the
/// width of the picture in units of 1920 px.
fn weigh(answer: &mut Answer, scale: f64, min_confidence: f64) -> Option<NoProposal> {
    let check = answer.line_check.filter(LineCheck::can_say)?;
    // Paint and features are taken as independent evidence, so their log odds add up.
    let log_odds = |probability: f64| (probability / (1.0 - probability)).ln();
    let both = log_odds(check.score) + log_odds(answer.evidence.agreement()).min(FEATURES_AT_MOST);
    // The distance of the paint from the lines as a σ; without any found paint it says nothing.
    let seen_sigma_px = SIGMAS_PER_MEDIAN * check.offset_px / scale;
    let seen_sigma_px = if seen_sigma_px.is_finite() {
        seen_sigma_px
    } else {
        0.0
    };
    // The logistic function makes a probability of the log odds.
    answer.confidence = answer
        .evidence
        .confidence_if(1.0 / (1.0 + (-both).exp()), seen_sigma_px);
    if answer.confidence >= min_confidence {
        return None;
    }
    if check.verdict() == LineVerdict::Contradicts {
        return Some(NoProposal::Contradicted {
            found: check.found,
            open: check.num_open(),
        });
    }
    // The paint does not contradict the answer, but may lie a few px beside it or be too sparse.
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
