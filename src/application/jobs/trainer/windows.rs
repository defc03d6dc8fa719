//! Which windows of videos cameras have been carried through, and from what.

use std::collections::BTreeMap;
use std::path::Path;
use touchline_calibration::calibrate::is_anchor;
use touchline_calibration::proposals::{CarriedProposal, KeyWindow};
use touchline_core::camera::Ptz;
use touchline_documents::document::{Document, Frame, FrameId, FramePtz, FrameStatus, Shared};

/// The windows of a document.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// The document as it was looked at last.
    of: Option<Document>,
    all: Vec<KeyWindow>,
    /// Whether a place in the document lies between key frames.
    between: Vec<bool>,
    /// From what cameras were carried, by the first frame of each window.
    carried: BTreeMap<FrameId, Vec<Known>>,
    /// Frames that got a camera here, and whether the document has shown it.
    given: BTreeMap<FrameId, bool>,
    /// Those of them that the forest answered, as its answer has them: what is carried is carried
    /// from that.
    answered: BTreeMap<FrameId, Shared<Frame>>,
}

/// A frame from which cameras are carried.
#[derive(Clone, Debug, PartialEq)]
struct Known {
    frame: FrameId,
    ptz: Option<Ptz>,
}

impl Windows {
    /// Updates the windows for a new state of the document; where it has lost a camera that was
    /// carried, that is done again.
    pub(super) fn look_at(&mut self, document: &Document, folder: &Path) {
        if !self
            .of
            .as_ref()
            .is_some_and(|before| has_the_same_pictures(before, document))
        {
            self.all = KeyWindow::of(document.at(folder));
            self.between = vec![false; document.frames.len()];
            for place in self.all.iter().flat_map(|window| &window.between) {
                self.between[*place] = true;
            }
        }
        self.of = Some(document.clone());
        let mut lost = Vec::new();
        self.given.retain(|id, recorded| {
            let frame = document.frames.by_id(id);
            let is_held = frame.is_some_and(|frame| frame.is_carried());
            let is_lost = *recorded && !is_held && frame.is_some_and(|frame| frame.is_open());
            if is_lost {
                lost.push(id.clone());
            }
            *recorded |= is_held;
            !is_lost && frame.is_some()
        });
        if !lost.is_empty() {
            let id_of = |place: &usize| document.frames.get(*place).map(|frame| &frame.id);
            for window in &self.all {
                if window
                    .between
                    .iter()
                    .any(|place| id_of(place).is_some_and(|id| lost.contains(id)))
                    && let Some(first) = window.keys.first().and_then(id_of)
                {
                    self.carried.remove(first);
                }
            }
        }
    }

    /// A document in which key frames are as the forest answered them, not as they were adjusted
    /// with the frames between.
    pub(super) fn with_answers(&self, mut document: Document) -> Document {
        for (id, answered) in &self.answered {
            if let Some(frame) = document.frames.by_id_mut(id)
                && frame.is_open()
                && frame.is_carried()
                && frame.revision == answered.revision
            {
                *frame = answered.clone();
            }
        }
        document
    }

    /// Whether the forest is not asked for a frame as long as cameras may be carried to it.
    pub(super) fn holds_back(&self, place: usize) -> bool {
        self.between.get(place).copied().unwrap_or(false)
    }

    /// Whether a frame has its camera from here.
    pub(super) fn has_given(&self, frame: &FrameId) -> bool {
        self.given.contains_key(frame)
    }

    /// The document shows the camera that was carried to a frame.
    pub(super) fn note_shown(&mut self, frame: &FrameId) {
        if let Some(is_shown) = self.given.get_mut(frame) {
            *is_shown = true;
        }
    }

    /// How many frames lie in windows through which cameras are to be carried, where the forest is
    /// wanted for some frames.
    pub(super) fn waiting(&self, document: &Document, wanted: impl Fn(usize) -> bool) -> usize {
        let due = self
            .all
            .iter()
            .filter(|window| self.is_due(window, document, &wanted));
        due.map(|window| window.between.len()).sum()
    }

    /// The window nearest to a place through which cameras are to be carried now; the forest is
    /// `wanted` for some frames.
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
        let distance = |window: &&KeyWindow| {
            window
                .between
                .iter()
                .map(|place| place.abs_diff(current))
                .min()
        };
        due.min_by_key(distance)
    }

    fn is_due(
        &self,
        window: &KeyWindow,
        document: &Document,
        wanted: &impl Fn(usize) -> bool,
    ) -> bool {
        let known = known(window, document);
        let Some(first) = window
            .keys
            .first()
            .and_then(|place| document.frames.get(*place))
        else {
            return false;
        };
        let is_asked = !window.keys.iter().any(|place| wanted(*place));
        is_asked
            && !known.is_empty()
            && match self.carried.get(&first.id) {
                Some(before) => *before != known,
                None => window.between.iter().any(|place| wanted(*place)),
            }
    }

    /// Stores what came of a window; those of its cameras are left that are news: not where a
    /// person decided, or had cameras carried.
    pub(super) fn enter(
        &mut self,
        window: &KeyWindow,
        document: &Document,
        carried: Vec<CarriedProposal>,
    ) -> Vec<CarriedProposal> {
        if let Some(first) = window
            .keys
            .first()
            .and_then(|place| document.frames.get(*place))
        {
            self.carried
                .insert(first.id.clone(), known(window, document));
        }
        let is_news = |carried: &CarriedProposal| {
            let frame = document.frames.by_id(&carried.frame);
            frame.is_some_and(|frame| {
                frame.is_open() && (!frame.is_carried() || self.has_given(&frame.id))
            })
        };
        let news: Vec<CarriedProposal> = carried.into_iter().filter(is_news).collect();
        let keys: Vec<&Shared<Frame>> = window
            .keys
            .iter()
            .filter_map(|place| document.frames.get(*place))
            .collect();
        for carried in &news {
            self.given.entry(carried.frame.clone()).or_insert(false);
            if let Some(key) = keys
                .iter()
                .find(|key| key.id == carried.frame && !key.is_carried())
            {
                self.answered.insert(key.id.clone(), (*key).clone());
            }
        }
        news
    }
}

/// The frames of a window from which cameras are carried: its key frames, and what people decided
/// between them. Where the forest was asked for others, that alone is no reason to carry anew.
fn known(window: &KeyWindow, document: &Document) -> Vec<Known> {
    let places = window
        .clip
        .frames
        .iter()
        .filter_map(|of_clip| of_clip.place);
    let frames = places.filter_map(|place| Some((place, document.frames.get(place)?)));
    let counts = |place: usize, frame: &Frame| !frame.is_open() || window.keys.contains(&place);
    let known = frames
        .filter(|(place, frame)| is_anchor(frame) && counts(*place, frame))
        .map(|(_, frame)| frame);
    known
        .map(|frame| Known {
            frame: frame.id.clone(),
            ptz: frame.ptz.as_ref().map(FramePtz::ptz),
        })
        .collect()
}

/// Whether two states of a document have the same frames of the same videos.
fn has_the_same_pictures(before: &Document, now: &Document) -> bool {
    let rejected = |frame: &Frame| frame.status == FrameStatus::Rejected;
    let is_same = |one: &Frame, other: &Frame| {
        one.camera == other.camera
            && one.clip == other.clip
            && one.video == other.video
            && one.image == other.image
            && rejected(one) == rejected(other)
    };
    let changed = now.frames.changed_in_place(&before.frames);
    changed.is_some_and(|changed| {
        changed
            .iter()
            .all(|at| is_same(&before.frames[*at], &now.frames[*at]))
    })
}
