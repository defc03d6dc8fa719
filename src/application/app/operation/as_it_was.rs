//! The one rule by which a result of background work joins the document of now: what is as it was
//! when the work began takes the result, and what has changed since stays.
//!
//! Work that changes the whole document has the rule in its own form: a change of many frames in
//! `BulkSolved::join`, the shots of a search in `VideoShots::from_search`, answers of the forest in
//! `Project::suggest`, an import by joining it once more with the document of now.

use std::collections::BTreeMap;
use touchline_documents::document::{Camera, CameraId, Document, Frame, FrameId, Shared};

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

    /// The present document with cameras, fields, shots and labels of a result, which was made from
    /// the earlier one. Frames that are not at a `position` any more keep what they have now, with
    /// the base that their camera has now; masks of cameras are those of now, too. None if a camera
    /// or the field changed, for which the result is then not valid.
    pub fn join(
        self,
        result: &Document,
        position: fn(Self, &FrameId) -> Option<usize>,
    ) -> Option<Document> {
        let Self { then, now } = self;
        if now.field != then.field || !self.has_cameras() {
            return None;
        }
        // Field and cameras come from the result, as the frames of one camera may have been given
        // to several. Frame by frame, its labels then replace those that are unchanged.
        let mut joined = now.clone();
        joined.field.clone_from(&result.field);
        joined.cameras.clone_from(&result.cameras);
        for camera in &mut joined.cameras {
            self.keep_masks(camera);
        }
        let takes_shots = now.shots == then.shots && result.shots != then.shots;
        if takes_shots {
            joined.shots.clone_from(&result.shots);
        }
        let mut kept = BTreeMap::new();
        for index in 0..now.frames.len() {
            let frame = &now.frames[index];
            let result = result.frames.by_id(&frame.id);
            if let Some(result) = result.filter(|_| takes_shots) {
                joined.frames[index].clip.clone_from(&result.clip);
            }
            let is_as_it_was = position(self, &frame.id).is_some();
            if let Some(result) = result.filter(|_| is_as_it_was) {
                take_labels(&mut joined.frames[index], result);
                continue;
            }
            // A frame that the user changed keeps its camera. All such frames share one copy of it.
            let id = frame.camera.clone();
            let camera = kept
                .entry(id.clone())
                .or_insert_with(|| keep_camera(&mut joined, now.camera(&id)));
            if let Some(camera) = camera {
                joined.frames[index].camera.clone_from(camera);
            }
        }
        Some(joined)
    }

    /// Whether every camera is still there and as it was, but for its masks. Others may have come.
    pub fn has_cameras(self) -> bool {
        self.then.cameras.iter().all(|then| {
            let now = self.now.camera(&then.id);
            now.is_some_and(|now| without_masks(now) == without_masks(then))
        })
    }

    /// Gives a camera of a result the masks that a person drew meanwhile. A new camera has those of
    /// the camera that its frames had.
    fn keep_masks(self, camera: &mut Shared<Camera>) {
        let mut of_frames = self.then.cameras.iter().map(|then| &**then);
        let then = match self.then.camera(&camera.id) {
            Some(then) => has_same_masks(then, camera).then_some(then),
            None => of_frames.find(|then| has_same_masks(then, camera)),
        };
        let Some(then) = then else { return };
        if let Some(now) = self
            .now
            .camera(&then.id)
            .filter(|now| !has_same_masks(now, then))
        {
            camera.masks.clone_from(&now.masks);
            camera.ranged_masks.clone_from(&now.ranged_masks);
        }
    }
}

fn has_same_masks(one: &Camera, other: &Camera) -> bool {
    one.masks == other.masks && one.ranged_masks == other.ranged_masks
}

fn without_masks(camera: &Camera) -> Camera {
    Camera {
        masks: Vec::new(),
        ranged_masks: Vec::new(),
        ..camera.clone()
    }
}

/// Gives a frame the camera of its version in a result.
fn take_labels(frame: &mut Frame, result: &Frame) {
    frame.camera.clone_from(&result.camera);
    frame.ptz.clone_from(&result.ptz);
    frame.lens.clone_from(&result.lens);
    frame.solution.clone_from(&result.solution);
    frame.status = result.status;
}

/// Keeps a camera with its present base in a document with the cameras of a result, and returns its
/// id there: its own, if the result left it as it was or removed it.
fn keep_camera(joined: &mut Document, camera: Option<&Camera>) -> Option<CameraId> {
    let camera = camera?;
    let id = match joined.camera(&camera.id) {
        Some(of_result) if of_result == camera => camera.id.clone(),
        Some(_) => joined.add_copy(camera),
        None => {
            joined.cameras.push(camera.clone().into());
            camera.id.clone()
        }
    };
    Some(id)
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
    fn a_mask_that_is_drawn_meanwhile_is_that_of_every_camera_of_the_result() {
        let size = ImageSize::new(64, 36);
        let mut then = soccer_document();
        then.cameras.push(Camera::new("main".into(), size).into());
        let mut result = then.clone();
        result
            .cameras
            .push(Camera::new("main_2".into(), size).into());
        let mut now = then.clone();
        now.cameras[0].masks.push(pixel_box(0.0, 0.0, 9.0, 9.0));
        now.cameras.push(Camera::new("side".into(), size).into());
        let pair = AsItWas {
            then: &then,
            now: &now,
        };
        let joined = pair.join(&result, AsItWas::position_if_untouched).unwrap();
        assert_eq!(joined.cameras.len(), 2);
        assert!(
            joined
                .cameras
                .iter()
                .all(|camera| camera.masks == now.cameras[0].masks)
        );

        now.cameras[0].image_size = ImageSize::new(128, 72);
        let pair = AsItWas {
            then: &then,
            now: &now,
        };
        assert!(
            pair.join(&result, AsItWas::position_if_untouched).is_none(),
            "another camera by now"
        );
    }

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
