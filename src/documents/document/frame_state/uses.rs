//! The uses of a frame: training of the forest, and estimation of its camera's base.

use crate::document::{Frame, FrameStatus, PaintEvidence, SolutionSource, Target};
use std::collections::BTreeMap;
use touchline_core::markings::LineVerdict;
use touchline_core::solve::Verdict;

/// A suggestion with a lower confidence is more likely wrong than right.
const LIKELY: f64 = 0.5;

/// A suggestion with a lower confidence counts as failed and is not drawn.
const HOLDS: f64 = 0.1;

impl Frame {
    /// The probability that its camera is right; none unless the camera is the program's and the
    /// user has neither accepted nor corrected it.
    pub fn suggestion_confidence(&self) -> Option<f64> {
        let is_open = self.is_suggestion() && self.status == FrameStatus::Suggested;
        self.solution.as_ref().filter(|_| is_open)?.confidence
    }

    /// The probability that a suggestion is right, where it is more likely wrong.
    pub fn unlikely(&self) -> Option<f64> {
        self.suggestion_confidence()
            .filter(|confidence| *confidence < LIKELY)
    }

    /// Why a suggestion is more likely wrong than right, where that is recorded.
    pub fn why_unlikely(&self) -> Option<&str> {
        self.unlikely()?;
        self.solution
            .as_ref()?
            .warnings
            .first()
            .map(|warning| warning.message.as_str())
    }

    /// The recorded evidence of the paint about its camera.
    fn paint_evidence(&self) -> Option<&PaintEvidence> {
        let solution = self.solution.as_ref().filter(|_| self.ptz.is_some())?;
        solution.line_check.as_ref()
    }

    /// What the paint said about its camera, where that is recorded.
    pub fn paint_verdict(&self) -> Option<LineVerdict> {
        self.paint_evidence().map(PaintEvidence::verdict)
    }

    /// The recorded evidence of the paint, if it contradicts the camera.
    pub fn contradicting_paint(&self) -> Option<&PaintEvidence> {
        self.paint_evidence()
            .filter(|evidence| evidence.verdict() == LineVerdict::Contradicts)
    }

    /// Whether it is a suggestion that the paint of its picture does not support.
    pub fn is_suggested_off_paint(&self) -> bool {
        self.status == FrameStatus::Suggested && self.paint_verdict() != Some(LineVerdict::Supports)
    }

    /// How far mending moved the camera that another program gave the frame, px; infinitely far if
    /// that camera was impossible. None if it has none.
    pub fn shift_by_mending_px(&self) -> Option<f64> {
        let imported = self.solution.as_ref()?.imported.as_ref()?;
        if imported.fault.is_some() {
            return Some(f64::INFINITY);
        }
        imported.moved_px
    }

    /// The recorded evidence of the paint, if it contradicts a camera that the user accepted.
    pub fn evidence_against_acceptance(&self) -> Option<&PaintEvidence> {
        self.contradicting_paint()
            .filter(|_| self.status == FrameStatus::Reference)
    }

    /// Whether its camera may be used as evidence for other frames: the user confirmed it, or it is
    /// a suggestion that is at least as likely right as wrong and not contradicted by paint.
    pub fn vouches(&self) -> bool {
        // Of a suggestion without a confidence, such as an imported camera, the paint decides.
        self.status != FrameStatus::Suggested
            || (self.unlikely().is_none() && self.contradicting_paint().is_none())
    }

    /// Whether its camera is a failed suggestion.
    pub fn is_hopeless(&self) -> bool {
        self.suggestion_confidence()
            .is_some_and(|confidence| confidence < HOLDS)
    }

    /// The source of its camera, or of the result that there is none.
    pub fn source(&self) -> Option<SolutionSource> {
        self.solution.as_ref()?.source
    }

    /// The probability that its camera is right, where the solution states one.
    pub fn confidence(&self) -> Option<f64> {
        self.solution.as_ref()?.confidence
    }

    /// Whether its camera was proposed by the program rather than clicked, aligned to paint by the
    /// user, imported or set manually.
    pub fn is_suggestion(&self) -> bool {
        self.ptz.is_some()
            && matches!(
                self.source(),
                Some(SolutionSource::Forest | SolutionSource::Tracking)
            )
    }

    /// Whether its camera was tracked from its neighbours in a clip.
    pub fn is_tracked(&self) -> bool {
        self.ptz.is_some() && self.source() == Some(SolutionSource::Tracking)
    }

    /// Whether it has a camera from another source than the forest; then the forest is not run for
    /// it.
    pub fn is_answered_without_forest(&self) -> bool {
        self.ptz.is_some() && self.source() != Some(SolutionSource::Forest)
    }

    /// The first of its clicks that has no name.
    pub fn unnamed_click(&self) -> Option<usize> {
        self.clicks.iter().position(|click| click.target.is_none())
    }

    /// Whether its camera was aligned to the painted lines and not corrected by a click since.
    pub fn is_snapped(&self) -> bool {
        self.solution.as_ref().is_some_and(|solution| {
            solution.source == Some(SolutionSource::Markings) && solution.proposed.is_none()
        })
    }

    /// Whether its camera is the forest's, aligned to the painted lines before the user saw it.
    pub fn is_snapped_proposal(&self) -> bool {
        self.is_suggestion()
            && self
                .solution
                .as_ref()
                .is_some_and(|solution| solution.samples.is_some())
    }

    /// Whether its camera came from another program and is neither mended nor decided on.
    pub fn has_imported_camera(&self) -> bool {
        self.is_open() && self.ptz.is_some() && self.source() == Some(SolutionSource::Import)
    }

    /// Whether it has neither clicks nor a decision of the user, so that the program may suggest
    /// its camera.
    pub fn is_open(&self) -> bool {
        self.clicks.is_empty() && matches!(self.status, FrameStatus::New | FrameStatus::Suggested)
    }

    /// Its status while it is neither accepted nor rejected.
    pub fn undecided_status(&self) -> FrameStatus {
        let is_by_models = self.has_points_of_models_alone();
        let is_unclicked = is_by_models || self.clicks.is_empty();
        match (is_unclicked, self.ptz.is_some()) {
            (true, true) if is_by_models => FrameStatus::Suggested,
            (true, true) if self.is_suggestion() || self.is_snapped() => FrameStatus::Suggested,
            (true, false) => FrameStatus::New,
            _ => FrameStatus::Draft,
        }
    }

    /// Whether the verdict on its clicks was Wrong when it was solved.
    pub fn is_judged_wrong(&self) -> bool {
        self.solution
            .as_ref()
            .is_some_and(|solution| solution.verdict == Some(Verdict::Wrong))
    }

    /// Whether the forest is trained with it. By default references are used, but neither accepted
    /// suggestions nor frames with the verdict Wrong; the user can override each.
    pub fn is_used_for_training(&self) -> bool {
        self.status == FrameStatus::Reference
            && self.use_for_training.unwrap_or(self.trains_by_default())
    }

    /// Sets whether the forest is trained with it once it is a reference.
    pub fn set_use_for_training(&mut self, used: bool) {
        // A choice that equals the default is not stored, so that it follows the default if a later
        // solve changes it.
        self.use_for_training = (used != self.trains_by_default()).then_some(used);
    }

    fn trains_by_default(&self) -> bool {
        !self.is_suggestion() && !self.is_judged_wrong()
    }

    /// Whether its clicks are used to estimate its camera's base: not if the frame is rejected or
    /// was left out.
    pub fn is_used_for_base(&self) -> bool {
        self.status != FrameStatus::Rejected && self.use_for_base
    }

    /// The number of clicks that name a landmark and are not check points.
    pub fn landmark_clicks(&self) -> usize {
        self.clicks
            .iter()
            .filter(|click| !click.check && matches!(click.target, Some(Target::Landmark(_))))
            .count()
    }

    /// The number of lines with two or more clicks that are not check points.
    pub fn clicked_line_count(&self) -> usize {
        // One click leaves a line's direction open, so only lines with two count.
        let mut clicks_on = BTreeMap::new();
        for click in self.clicks.iter().filter(|click| !click.check) {
            if let Some(Target::Line(line)) = &click.target {
                *clicks_on.entry(line).or_insert(0) += 1;
            }
        }
        clicks_on
            .into_values()
            .filter(|clicks| *clicks >= 2)
            .count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{new_frame, ptz_at, solved_by};
    use touchline_core::geometry::ImageSize;

    fn reference(source: SolutionSource) -> Frame {
        let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
        frame.ptz = ptz_at(1.0, -9.0, 900.0);
        frame.solution = solved_by(source);
        frame.status = FrameStatus::Reference;
        frame
    }

    #[test]
    fn a_suggestion_speaks_for_others_while_it_is_likely_and_a_person_always() {
        let off = PaintEvidence {
            score: 0.01,
            found: 3,
            bare: 80,
            predicted: 90,
            ..PaintEvidence::default()
        };
        for (confidence, line_check, speaks) in [
            (Some(0.6), None, true),
            (Some(0.4), None, false),
            (Some(0.6), Some(off.clone()), false),
            (None, None, true),
            (None, Some(off), false),
        ] {
            let accepted = reference(SolutionSource::Forest);
            let mut suggested = Frame {
                status: FrameStatus::Suggested,
                ..accepted.clone()
            };
            let solution = suggested.solution.as_mut().unwrap();
            (solution.confidence, solution.line_check) = (confidence, line_check);
            assert_eq!(
                (suggested.vouches(), accepted.vouches()),
                (speaks, true),
                "{confidence:?}"
            );
        }
    }

    #[test]
    fn a_frame_with_the_verdict_wrong_is_no_training_frame_unless_a_person_says_so() {
        for (verdict, by_itself) in [
            (Verdict::Good, true),
            (Verdict::Check, true),
            (Verdict::Wrong, false),
        ] {
            let mut frame = reference(SolutionSource::Clicks);
            frame.solution.as_mut().unwrap().verdict = Some(verdict);
            assert_eq!(frame.is_used_for_training(), by_itself, "{verdict}");
            frame.set_use_for_training(!by_itself);
            assert_eq!(frame.is_used_for_training(), !by_itself, "{verdict}");
        }
    }

    #[test]
    fn accepted_suggestions_are_labels_unless_a_person_says_otherwise() {
        for (source, by_itself) in [
            (SolutionSource::Clicks, true),
            (SolutionSource::Markings, true),
            (SolutionSource::Import, true),
            (SolutionSource::Forest, false),
            (SolutionSource::Tracking, false),
        ] {
            let mut frame = reference(source);
            let before = frame.clone();
            assert_eq!(frame.is_used_for_training(), by_itself, "{source:?}");
            frame.set_use_for_training(!by_itself);
            assert_eq!(frame.is_used_for_training(), !by_itself, "{source:?}");
            frame.set_use_for_training(by_itself);
            assert_eq!(frame, before, "a default leaves no key");
            frame.status = FrameStatus::Suggested;
            assert!(!frame.is_used_for_training(), "no person has accepted it");
        }
    }
}
