//! Whether a frame is an earlier state of another version of it.

use crate::document::{Frame, FrameStatus};

impl Frame {
    /// Whether it may be an earlier state of `later`: it has fewer edits, and all of the user's
    /// work in it is in `later`, too. Suggestions must have been removed from both.
    pub(in crate::document) fn is_earlier_state_of(&self, later: &Self) -> bool {
        let is_decided = matches!(self.status, FrameStatus::Reference | FrameStatus::Rejected);
        // A camera from clicks follows from them; any other was set.
        let has_own_camera = self.ptz.is_some() && !self.is_solved_by_clicks();
        self.revision < later.revision
            && self.camera == later.camera
            && (!is_decided || (self.status, self.reason) == (later.status, later.reason))
            && (!has_own_camera || self.ptz == later.ptz)
            && is_kept(self.comment.as_ref(), later.comment.as_ref())
            && is_kept(self.lens.as_ref(), later.lens.as_ref())
            && self.clicks.iter().all(|click| later.clicks.contains(click))
            && self.masks.iter().all(|mask| later.masks.contains(mask))
            && self
                .repeats
                .iter()
                .all(|repeat| later.repeats.contains(repeat))
            && (!self.has_chosen_uses() || self.uses() == later.uses())
    }
}

/// Whether a value that was set, if it was, is still the same.
fn is_kept<T: PartialEq>(earlier: Option<&T>, later: Option<&T>) -> bool {
    earlier.is_none() || earlier == later
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Click;
    use crate::testing::new_frame;
    use touchline_core::geometry::{ImagePoint, ImageSize};

    #[test]
    fn an_earlier_state_has_fewer_edits_and_nothing_that_the_later_one_lacks() {
        let first = new_frame("a.jpg", ImageSize::new(64, 48));
        let click = Click::without_name(ImagePoint::new(1.0, 2.0));
        let with_click = Frame {
            revision: 1,
            clicks: vec![click],
            status: FrameStatus::Draft,
            ..first.clone()
        };
        let accepted = Frame {
            revision: 2,
            status: FrameStatus::Reference,
            ..with_click.clone()
        };
        assert!(first.is_earlier_state_of(&with_click));
        assert!(with_click.is_earlier_state_of(&accepted));
        assert!(!accepted.is_earlier_state_of(&with_click));
        let forked = Frame {
            comment: Some("from elsewhere".to_owned()),
            ..with_click
        };
        assert!(!forked.is_earlier_state_of(&accepted));
        let rejected = Frame {
            status: FrameStatus::Rejected,
            ..forked
        };
        assert!(!rejected.is_earlier_state_of(&accepted));
    }
}
