//! Where a frame's label comes from.

use crate::document::{Frame, FrameStatus, SolutionSource};

/// Where a frame's label comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display)]
#[strum(serialize_all = "snake_case")]
pub enum LabelOrigin {
    /// A person's clicks.
    Clicked,
    /// Aligned to the painted lines.
    Snapped,
    /// Tracked from other frames of the clip, and not reviewed.
    Tracked,
    /// The same, accepted by a person.
    TrackedAndAccepted,
    /// The forest's suggestion, not reviewed.
    Suggested,
    /// The same, accepted by a person.
    SuggestedAndAccepted,
    /// Points of another program's model, not reviewed.
    Points,
    /// The same, accepted by a person.
    PointsAndAccepted,
    /// A foreign file.
    Imported,
    /// Numbers set by the user.
    SetByHand,
    /// Interpolated between its neighbours.
    Interpolated,
    /// Clicks without a camera.
    ClicksOnly,
}

impl LabelOrigin {
    /// The origin of a frame's label; none where it has neither clicks nor a camera.
    pub fn from_frame(frame: &Frame) -> Option<Self> {
        let is_clicked = frame.clicks.iter().any(|click| click.target.is_some());
        if frame.ptz.is_none() {
            return is_clicked.then_some(Self::ClicksOnly);
        }
        let accepted = frame.status == FrameStatus::Reference;
        // A frame that states no source has its camera from its clicks, if it has some.
        Some(match frame.source() {
            Some(SolutionSource::Markings) => Self::Snapped,
            Some(SolutionSource::Tracking) if accepted => Self::TrackedAndAccepted,
            Some(SolutionSource::Tracking) => Self::Tracked,
            Some(SolutionSource::Forest) if accepted => Self::SuggestedAndAccepted,
            Some(SolutionSource::Forest) => Self::Suggested,
            Some(SolutionSource::Manual) => Self::SetByHand,
            Some(SolutionSource::Interpolated) => Self::Interpolated,
            Some(SolutionSource::Points) if accepted => Self::PointsAndAccepted,
            Some(SolutionSource::Points) => Self::Points,
            Some(SolutionSource::Clicks) => Self::Clicked,
            None if is_clicked => Self::Clicked,
            Some(SolutionSource::Import) | None => Self::Imported,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Solution;
    use crate::exchange::tests::{reference, with_clicks};

    #[test]
    fn a_label_says_whether_a_person_made_it_or_only_accepted_it() {
        let mut frame: Frame = (*with_clicks().frames[0]).clone();
        assert_eq!(LabelOrigin::from_frame(&frame), Some(LabelOrigin::Clicked));
        for (source, accepted, open) in [
            (
                SolutionSource::Forest,
                LabelOrigin::SuggestedAndAccepted,
                LabelOrigin::Suggested,
            ),
            (
                SolutionSource::Tracking,
                LabelOrigin::TrackedAndAccepted,
                LabelOrigin::Tracked,
            ),
            (
                SolutionSource::Markings,
                LabelOrigin::Snapped,
                LabelOrigin::Snapped,
            ),
        ] {
            frame.solution = Some(Solution {
                source: Some(source),
                ..Solution::default()
            });
            frame.status = FrameStatus::Reference;
            assert_eq!(LabelOrigin::from_frame(&frame), Some(accepted));
            frame.status = FrameStatus::Suggested;
            assert_eq!(LabelOrigin::from_frame(&frame), Some(open));
        }
        frame.ptz = None;
        assert_eq!(
            LabelOrigin::from_frame(&frame),
            Some(LabelOrigin::ClicksOnly)
        );
        frame.clicks.clear();
        assert_eq!(LabelOrigin::from_frame(&frame), None);
        assert_eq!(
            LabelOrigin::from_frame(&reference().frames[0]),
            Some(LabelOrigin::Imported),
            "the file does not say who did it"
        );
    }
}
