//! Frames for which the forest gave no answer.

use crate::document::{Frame, FrameStatus, SolutionSource};

impl Frame {
    /// Whether the forest found no answer for it, and it has not been labelled or accepted since.
    pub fn is_unanswered(&self) -> bool {
        let was_queried = self
            .solution
            .as_ref()
            .is_some_and(|solution| solution.source == Some(SolutionSource::Forest));
        self.status == FrameStatus::New
            && self.ptz.is_none()
            && self.clicks.is_empty()
            && was_queried
    }

    /// Why the forest has no answer.
    pub fn no_answer(&self) -> Option<&str> {
        let warnings = self
            .solution
            .as_ref()
            .filter(|_| self.is_unanswered())
            .map(|solution| &solution.warnings)?;
        warnings.first().map(|warning| warning.message.as_str())
    }
}

#[cfg(test)]
mod tests {
    use crate::document::{Click, FrameStatus, Solution, SolutionSource, SolutionWarning};
    use crate::testing::new_frame;
    use touchline_core::geometry::{ImagePoint, ImageSize};

    #[test]
    fn a_frame_is_unanswered_until_a_person_looks_at_it() {
        let mut frame = new_frame("x.jpg", ImageSize::new(64, 36));
        assert!(!frame.is_unanswered(), "no query was made");
        let warnings = vec![SolutionWarning::new("coverage", "3 of 30.".to_owned())];
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Forest),
            warnings,
            ..Solution::default()
        });
        assert_eq!(
            (frame.is_unanswered(), frame.no_answer()),
            (true, Some("3 of 30."))
        );
        frame
            .clicks
            .push(Click::without_name(ImagePoint::new(1.0, 1.0)));
        assert_eq!((frame.is_unanswered(), frame.no_answer()), (false, None));
        frame.clicks.clear();
        frame.status = FrameStatus::Rejected;
        assert!(!frame.is_unanswered());
    }
}
