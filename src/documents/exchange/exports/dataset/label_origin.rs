//! Where a frame's label comes from.

use crate::document::{Frame, FrameStatus, SolutionSource};
use std::fmt;

/// Where a frame's label comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LabelOrigin {
    /// A person's clicks.
    Clicked,
    /// Aligned to the painted lines.
    Snapped,
    /// Tracked from other frames of the clip, and not reviewed.
    Tracked,
    /// The same, accepted by a person.
    TrackedAccepted,
    /// The forest's suggestion, not reviewed.
    Suggested,
    /// The same, accepted by a person.
    SuggestedAccepted,
    /// Points of another program's model, not reviewed.
    Points,
    /// The same, accepted by a person.
    PointsAccepted,
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
            Some(SolutionSource::Tracking) if accepted => Self::TrackedAccepted,
            Some(SolutionSource::Tracking) => Self::Tracked,
            Some(SolutionSource::Forest) if accepted => Self::SuggestedAccepted,
            Some(SolutionSource::Forest) => Self::Suggested,
            Some(SolutionSource::Manual) => Self::SetByHand,
            Some(SolutionSource::Interpolated) => Self::Interpolated,
            Some(SolutionSource::Points) if accepted => Self::PointsAccepted,
            Some(SolutionSource::Points) => Self::Points,
            Some(SolutionSource::Clicks) => Self::Clicked,
            None if is_clicked => Self::Clicked,
            Some(SolutionSource::Import) | None => Self::Imported,
        })
    }

    /// Its name in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Clicked => "clicked",
            Self::Snapped => "snapped",
            Self::Tracked => "tracked",
            Self::TrackedAccepted => "tracked_and_accepted",
            Self::Suggested => "suggested",
            Self::SuggestedAccepted => "suggested_and_accepted",
            Self::Points => "points",
            Self::PointsAccepted => "points_and_accepted",
            Self::Imported => "imported",
            Self::SetByHand => "set_by_hand",
            Self::Interpolated => "interpolated",
            Self::ClicksOnly => "clicks_only",
        }
    }
}

impl fmt::Display for LabelOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
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
                LabelOrigin::SuggestedAccepted,
                LabelOrigin::Suggested,
            ),
            (
                SolutionSource::Tracking,
                LabelOrigin::TrackedAccepted,
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
