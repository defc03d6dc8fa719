//! The one rule by which a result of background work joins the document of now: what is as it was
//! when the work began takes the result, and what has changed since stays.
//!
//! Work that changes the whole document has the rule in its own form: a change of many frames in
//! `BulkSolved::join`, the shots of a search in `VideoShots::from_search`, answers of the forest in
//! `Project::suggest`, an import by joining it once more with the document of now.

use touchline_documents::document::{Camera, CameraId, Document, Frame, FrameId};

/// The document when some work began, and as it is now.
#[derive(Clone, Copy)]
pub(in crate::app) struct AsItWas<'a> {
    pub then: &'a Document,
    pub now: &'a Document,
}

impl AsItWas<'_> {
    /// Whether a camera looks at the same field.
    pub fn has_field(self, camera: &CameraId) -> bool {
        let Self { then, now } = self;
        then.field_of_camera(camera)
            .is_same_field(now.field_of_camera(camera))
    }

    /// Whether a camera has the same base and field. Cameras of frames, and lengths, are valid for
    /// these alone.
    pub fn has_base_and_field(self, camera: &CameraId) -> bool {
        let [then, now] = [self.then, self.now].map(|of| of.camera(camera).and_then(Camera::base));
        then == now && self.has_field(camera)
    }

    /// The present position of a frame in which no person has worked since: camera, clicks, decision
    /// and solution are those of then. Suggestions, the shot, comments and masks may differ.
    pub fn position_if_untouched(self, id: &FrameId) -> Option<usize> {
        let then = self.then.frames.by_id(id)?;
        let position = self.now.frames.position_of(id)?;
        let now = &self.now.frames[position];
        let is_same = then.is_same(now)
            || has_same_labels(&then.without_suggestion(), &now.without_suggestion());
        is_same.then_some(position)
    }

    /// The same for a frame that shows the same suggestion, too, because the result replaces it.
    pub fn position_if_unchanged(self, id: &FrameId) -> Option<usize> {
        let position = self.now.frames.position_of(id)?;
        let then = self.then.frames.by_id(id)?;
        has_same_labels(then, &self.now.frames[position]).then_some(position)
    }
}

fn has_same_labels(one: &Frame, other: &Frame) -> bool {
    one.camera == other.camera
        && one.ptz == other.ptz
        && one.lens == other.lens
        && one.solution == other.solution
        && one.status == other.status
        && one.clicks == other.clicks
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::{Click, Clip, FrameStatus};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    type Change = fn(&mut Frame);

    #[test]
    fn a_frame_counts_as_it_was_unless_someone_worked_in_it() {
        let mut then = soccer_document();
        let size = ImageSize::new(64, 36);
        then.frames.push(new_frame("a.jpg", size).into());
        let id = then.frames[0].id.clone();
        let suggest = |frame: &mut Frame| {
            frame.status = FrameStatus::Suggested;
            frame.ptz = ptz_at(1.0, -9.0, 900.0);
        };
        let beside: [Change; 4] = [
            |frame| frame.clip = Some(Clip::Number(1)),
            |frame| frame.comment = Some("rain".to_owned()),
            |frame| frame.use_for_base = false,
            |frame| {
                frame.masks.push(pixel_box(0.0, 0.0, 9.0, 9.0));
            },
        ];
        let work: [Change; 4] = [
            |frame| frame.camera = "side".into(),
            |frame| {
                frame
                    .clicks
                    .push(Click::without_name(ImagePoint::new(1.0, 1.0)));
            },
            |frame| frame.status = FrameStatus::Rejected,
            |frame| frame.status = FrameStatus::Reference,
        ];
        let joins = |change: &dyn Fn(&mut Frame)| {
            let mut now = then.clone();
            change(&mut now.frames[0]);
            let pair = AsItWas {
                then: &then,
                now: &now,
            };
            [
                pair.position_if_untouched(&id),
                pair.position_if_unchanged(&id),
            ]
        };
        for change in beside {
            assert_eq!(joins(&change), [Some(0), Some(0)]);
        }
        assert_eq!(joins(&suggest), [Some(0), None]);
        for change in work {
            assert_eq!(joins(&change), [None, None]);
        }
    }
}
