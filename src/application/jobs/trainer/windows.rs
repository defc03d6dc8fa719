//! Windows of videos through which cameras are propagated, and from which frames that was done.
//!
//! Consecutive frames of a video need not be queried one by one. The forest answers for key frames,
//! and tracking propagates their cameras to the frames between. A window is due when its key frames
//! have been queried and the known cameras in it differ from those of the last propagation.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use touchline_calibration::calibrate::is_anchor;
use touchline_calibration::proposals::{KeyWindow, TrackedProposal};
use touchline_core::camera::Ptz;
use touchline_documents::document::{Document, Frame, FrameId, FramePtz, FrameStatus, Shared};

/// The windows of a document, and what they have given.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// The document that was looked at last.
    of: Option<Document>,
    all: Vec<KeyWindow>,
    /// For each frame of the document: whether it lies between key frames.
    between: Vec<bool>,
    /// The known cameras of the last propagation, by the first frame of the window.
    tracked: BTreeMap<FrameId, Vec<KeyFrame>>,
    /// Frames that received a propagated camera, and whether the document has shown it.
    given: BTreeMap<FrameId, bool>,
    /// Key frames of those as the forest answered them. Propagation starts from the answers, not
    /// from cameras that it adjusted itself.
    answered: BTreeMap<FrameId, Shared<Frame>>,
}

/// A frame from which cameras are propagated.
#[derive(Clone, Debug, PartialEq)]
struct KeyFrame {
    frame: FrameId,
    ptz: Option<Ptz>,
}

impl Windows {
    /// Takes in a new state of the document. Windows that have lost a propagated camera become due
    /// again.
    pub(super) fn look_at(&mut self, document: &Document, folder: &Path) {
        // Windows depend on the videos and their frames only, so that most edits leave them as they
        // are.
        if !self
            .of
            .as_ref()
            .is_some_and(|before| has_the_same_pictures(before, document))
        {
            self.all = KeyWindow::from_document(document.at(folder));
            self.between = vec![false; document.frames.len()];
            for place in self.all.iter().flat_map(|window| &window.between) {
                self.between[*place] = true;
            }
        }
        self.of = Some(document.clone());
        // Find the frames that once showed a propagated camera, no longer do, and are undecided.
        let mut lost = BTreeSet::new();
        self.given.retain(|id, recorded| {
            let frame = document.frames.by_id(id);
            let is_held = frame.is_some_and(|frame| frame.is_tracked());
            let is_lost = *recorded && !is_held && frame.is_some_and(|frame| frame.is_open());
            if is_lost {
                lost.insert(id.clone());
            }
            *recorded |= is_held;
            !is_lost && frame.is_some()
        });
        // Forget the propagation through their windows, so that it is repeated.
        if !lost.is_empty() {
            let id_of = |place: &usize| document.frames.get(*place).map(|frame| &frame.id);
            for window in &self.all {
                if window
                    .between
                    .iter()
                    .any(|place| id_of(place).is_some_and(|id| lost.contains(id)))
                    && let Some(first) = window.keys.first().and_then(id_of)
                {
                    self.tracked.remove(first);
                }
            }
        }
    }

    /// The document with key frames as the forest answered them, not as adjusted together with the
    /// frames between.
    pub(super) fn with_answers(&self, mut document: Document) -> Document {
        for (id, answered) in &self.answered {
            if let Some(frame) = document.frames.by_id_mut(id)
                && frame.is_open()
                && frame.is_tracked()
                && frame.revision == answered.revision
            {
                *frame = answered.clone();
            }
        }
        document
    }

    /// Whether a frame lies between key frames, so that the forest is queried for it last.
    pub(super) fn holds_back(&self, place: usize) -> bool {
        self.between.get(place).copied().unwrap_or(false)
    }

    /// Whether a frame received its camera by propagation.
    pub(super) fn has_given(&self, frame: &FrameId) -> bool {
        self.given.contains_key(frame)
    }

    /// Records that the document shows the propagated camera of a frame.
    pub(super) fn note_shown(&mut self, frame: &FrameId) {
        if let Some(is_shown) = self.given.get_mut(frame) {
            *is_shown = true;
        }
    }

    /// Number of frames in windows that are due. `wanted` says whether an answer for a frame is
    /// missing.
    pub(super) fn waiting(&self, document: &Document, wanted: impl Fn(usize) -> bool) -> usize {
        let due = self
            .all
            .iter()
            .filter(|window| self.is_due(window, document, &wanted));
        due.map(|window| window.between.len()).sum()
    }

    /// The due window nearest to the index `current`. `wanted` says whether an answer for a frame
    /// is missing.
    pub(super) fn due(
        &self,
        document: &Document,
        current: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<&KeyWindow> {
        let due = self
            .all
            .iter()
            .filter(|window| self.is_due(window, document, &wanted));
        due.min_by_key(|window| {
            let places = window.between.iter();
            places.map(|place| place.abs_diff(current)).min()
        })
    }

    /// Whether all key frames have been queried, some camera is known, and it differs from the last
    /// propagation; the first time, whether a frame between needs a camera.
    fn is_due(
        &self,
        window: &KeyWindow,
        document: &Document,
        wanted: &impl Fn(usize) -> bool,
    ) -> bool {
        let known = known_frames(window, document);
        let Some(first) = window
            .keys
            .first()
            .and_then(|place| document.frames.get(*place))
        else {
            return false;
        };
        // Wait until the forest has been queried for all key frames.
        let are_keys_answered = !window.keys.iter().any(|place| wanted(*place));
        are_keys_answered
            && !known.is_empty()
            && match self.tracked.get(&first.id) {
                Some(before) => *before != known,
                None => window.between.iter().any(|place| wanted(*place)),
            }
    }

    /// Records the result of a window. Returns the cameras that are new: not those of frames that a
    /// person decided or that the user had tracked.
    pub(super) fn enter(
        &mut self,
        window: &KeyWindow,
        document: &Document,
        tracked: Vec<TrackedProposal>,
    ) -> Vec<TrackedProposal> {
        // Remember the cameras that this result started from, also if it is empty: the window is
        // due again only when they change.
        if let Some(first) = window
            .keys
            .first()
            .and_then(|place| document.frames.get(*place))
        {
            self.tracked
                .insert(first.id.clone(), known_frames(window, document));
        }
        // Cameras from an earlier propagation are replaced; those that the user tracked stay.
        let news: Vec<TrackedProposal> = tracked
            .into_iter()
            .filter(|tracked| self.may_replace_camera(document, &tracked.frame))
            .collect();
        let keys: Vec<&Shared<Frame>> = window
            .keys
            .iter()
            .filter_map(|place| document.frames.get(*place))
            .collect();
        // Before a key frame gets its adjusted camera, store its answer for `with_answers`.
        for tracked in &news {
            self.given.entry(tracked.frame.clone()).or_insert(false);
            if let Some(key) = keys
                .iter()
                .find(|key| key.id == tracked.frame && !key.is_tracked())
            {
                self.answered.insert(key.id.clone(), (*key).clone());
            }
        }
        news
    }

    /// Whether a propagated camera may be recorded in a frame: it is undecided, and shows no camera
    /// that the user had tracked.
    fn may_replace_camera(&self, document: &Document, id: &FrameId) -> bool {
        document.frames.by_id(id).is_some_and(|frame| {
            frame.is_open() && (!frame.is_tracked() || self.has_given(&frame.id))
        })
    }
}

/// The frames from which cameras are propagated: key frames, and frames between that a person
/// decided. Answers of the forest between key frames do not count; they are no reason to repeat the
/// propagation.
fn known_frames(window: &KeyWindow, document: &Document) -> Vec<KeyFrame> {
    let places = window
        .clip
        .frames
        .iter()
        .filter_map(|of_clip| of_clip.place);
    let frames = places.filter_map(|place| Some((place, document.frames.get(place)?)));
    let known = frames.filter(|(place, frame)| {
        is_anchor(frame) && (!frame.is_open() || window.keys.contains(place))
    });
    known
        .map(|(_, frame)| KeyFrame {
            frame: frame.id.clone(),
            ptz: frame.ptz.as_ref().map(FramePtz::ptz),
        })
        .collect()
}

/// Whether two states of a document have the same frames of the same videos.
fn has_the_same_pictures(before: &Document, now: &Document) -> bool {
    let changed = now.frames.changes_in_place(&before.frames);
    changed.is_some_and(|changed| {
        changed
            .iter()
            .all(|at| shows_the_same_picture(&before.frames[*at], &now.frames[*at]))
    })
}

/// Whether two states of a frame have the same picture of the same shot, and both or neither are
/// rejected.
fn shows_the_same_picture(before: &Frame, now: &Frame) -> bool {
    before.camera == now.camera
        && before.clip == now.clip
        && before.video == now.video
        && before.image == now.image
        && (before.status == FrameStatus::Rejected) == (now.status == FrameStatus::Rejected)
}
