//! The common state of a document that went on and of a version that another person made of it.
//!
//! A merge of three versions needs the state from which both sides started. A package records what
//! it was given ([`package_record`](super::package_record)); of other versions only the revisions
//! of frames show whether the document went on since they were copied.
//!
//! | of a frame, a camera, the field | the version has | the common state is |
//! |---|---|---|
//! | the version left it alone | the document's | the document's |
//! | only the version changed it | its own | the document's |
//! | both changed it, one state is an earlier one of the other | the later one | the document's |
//! | both changed it | its own | none, which makes it a conflict |

use super::package_record::{Given, Part, hash_of_camera, hash_of_frame};
use crate::document::{Camera, CameraId, Document, FieldSpec, Frame};
use serde_json::Map;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use strum::VariantArray as _;

/// What recognises the pictures of two frames wherever their files lie, where both have it: the
/// SHA-256 of the images, else the identities of the videos.
fn picture_ids<'a>(one: &'a Frame, other: &'a Frame) -> Option<[&'a str; 2]> {
    let video_of = |frame: &'a Frame| frame.video.as_ref()?.file_id.as_deref();
    let images = one.sha256.as_deref().zip(other.sha256.as_deref());
    let (one, other) = images.or_else(|| video_of(one).zip(video_of(other)))?;
    Some([one, other])
}

/// Whether two frames are known to be of different pictures.
pub(super) fn has_other_picture(one: &Frame, other: &Frame) -> bool {
    picture_ids(one, other).is_some_and(|[one, other]| !one.eq_ignore_ascii_case(other))
}

/// Frames of a version whose pictures are other ones than those of the document under their ids.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherPictures {
    /// The number of these frames.
    pub count: usize,
    /// The number of frames of which both pictures are known.
    pub known: usize,
    /// The name of the first one.
    pub first: String,
}

impl OtherPictures {
    /// Compares the pictures of a version with those of a document; none if most of them are the
    /// same. A few that were replaced do not make it a version of another match.
    pub(super) fn find(base: &Document, version: &Document) -> Option<Self> {
        let pairs = version.frames.iter().filter_map(|theirs| {
            let ours = base.frames.by_id(&theirs.id)?;
            picture_ids(ours, theirs).map(|_| (ours, theirs))
        });
        let (mut others, mut known) = (Vec::new(), 0);
        for (ours, theirs) in pairs {
            known += 1;
            if has_other_picture(ours, theirs) {
                others.push(ours);
            }
        }
        let first = others.first()?.name();
        let count = others.len();
        (2 * count > known).then_some(Self {
            count,
            known,
            first,
        })
    }
}

/// Another person's version of a document as a whole document, and the state that both have in
/// common: the first argument of [`merge`](crate::document::merge).
#[derive(Clone, Debug, PartialEq)]
pub struct Restored {
    /// The common state.
    pub common: Document,
    /// The version.
    pub version: Document,
    /// The frames of the version, on the cameras and the field that they were solved with there.
    pub own: Document,
}

impl Restored {
    /// A version that started from `base` as it is.
    pub(super) fn new(base: &Document, version: Document) -> Self {
        Self {
            common: base.clone(),
            own: version.clone(),
            version,
        }
    }

    /// The version as a side of a merge: its frames that were solved in it, on its own cameras and
    /// field. What it took from the document was solved there.
    pub fn side(&self) -> Document {
        let frames = self.version.frames.iter().filter(|frame| {
            let own = self.own.frames.by_id(&frame.id);
            own.is_some_and(|own| (&own.clicks, &own.ptz) == (&frame.clicks, &frame.ptz))
        });
        Document {
            frames: frames.cloned().collect(),
            ..self.own.clone()
        }
    }

    /// The number of frames of the document that the version lacks and that stay nevertheless,
    /// because the owner worked in them.
    pub fn missing_frames(&self, base: &Document) -> usize {
        let kept = base.frames.iter().filter(|frame| {
            let is_in = |document: &Document| document.frames.by_id(&frame.id).is_some();
            !is_in(&self.version) && !is_in(&self.common)
        });
        kept.count()
    }

    /// Leaves a part in which the version differs without a common state, so that a merge names it.
    fn dispute(&mut self, part: Part) {
        if part.hash(&self.version) == part.hash(&self.common) {
            return;
        }
        match part {
            // No template has this name.
            Part::Field => self.common.field = FieldSpec::new(""),
            Part::Shots => self.common.shots.clear(),
            Part::ClickNoise => self.common.click_noise = None,
            Part::Conventions => self.common.conventions = Map::new(),
            Part::Extra => self.common.extra = Map::new().into(),
        }
    }

    fn dispute_camera(&mut self, id: &CameraId) {
        if self.version.camera(id) == self.common.camera(id) {
            return;
        }
        self.common.cameras.retain(|camera| camera.id != *id);
    }

    /// Takes a part of `base` into the version.
    fn take(&mut self, part: Part, base: &Document) {
        let version = &mut self.version;
        match part {
            Part::Field => version.field.clone_from(&base.field),
            Part::Shots => version.shots.clone_from(&base.shots),
            Part::ClickNoise => version.click_noise.clone_from(&base.click_noise),
            Part::Conventions => version.conventions.clone_from(&base.conventions),
            Part::Extra => version.extra.clone_from(&base.extra),
        }
    }

    /// Compares the frames of a package with what it was given.
    pub(super) fn settle_frames(&mut self, base: &Document, given: &Given) {
        let mut disputed = BTreeSet::new();
        for (id, hash) in &given.frames {
            let Some(ours) = base.frames.by_id(id) else {
                // The owner removed it. What the person did in it comes back, and nothing else.
                self.version
                    .frames
                    .retain(|frame| frame.id != *id || hash_of_frame(frame) != *hash);
                continue;
            };
            let is_ours_given = hash_of_frame(ours) == *hash;
            let Some(theirs) = self.version.frames.by_id_mut(id) else {
                if !is_ours_given {
                    disputed.insert(id);
                }
                continue;
            };
            if is_ours_given {
                continue;
            }
            let (mine, edited) = (ours.without_suggestion(), theirs.without_suggestion());
            if edited.has_content_of(&mine) {
                continue;
            }
            if hash_of_frame(theirs) == *hash || edited.is_earlier_state_of(&mine) {
                *theirs = ours.clone();
            } else if !mine.is_earlier_state_of(&edited) {
                disputed.insert(id);
            }
        }
        self.common
            .frames
            .retain(|frame| !disputed.contains(&frame.id));
    }

    /// Compares cameras, field and the other parts of a package with what it was given.
    pub(super) fn settle_parts(&mut self, base: &Document, package: &Document, given: &Given) {
        for (id, hash) in &given.cameras {
            let ours = base.cameras.iter().find(|camera| camera.id == *id);
            let is_given = |camera: &Camera| hash_of_camera(camera) == *hash;
            let is_left_alone = package.camera(id).is_some_and(is_given);
            if is_left_alone {
                let cameras = &mut self.version.cameras;
                match (ours, cameras.iter_mut().find(|camera| camera.id == *id)) {
                    (Some(ours), Some(theirs)) => theirs.clone_from(ours),
                    _ => cameras.retain(|camera| camera.id != *id),
                }
            } else if !ours.is_some_and(|ours| is_given(ours)) {
                self.dispute_camera(id);
            }
        }
        for camera in &base.cameras {
            if given.cameras.contains_key(&camera.id) {
                continue;
            }
            // The owner added it since.
            if self.version.camera(&camera.id).is_none() {
                self.version.cameras.push(camera.clone());
            } else {
                self.dispute_camera(&camera.id);
            }
        }
        for part in [
            Part::Field,
            Part::ClickNoise,
            Part::Conventions,
            Part::Extra,
        ] {
            if given.is_same(part, package) {
                self.take(part, base);
            } else if !given.is_same(part, base) {
                self.dispute(part);
            }
        }
    }

    /// Settles the shots: `ours` are those of the document that a package of these frames gets now.
    pub(super) fn settle_shots(
        &mut self,
        base: &Document,
        ours: &Document,
        package: &Document,
        given: &Given,
    ) {
        if given.is_same(Part::Shots, package) {
            self.take(Part::Shots, base);
        } else if !given.is_same(Part::Shots, ours) {
            self.dispute(Part::Shots);
        }
    }

    /// Settles a version that records nothing: a copy of the document, or a package of an earlier
    /// version of the program. Where frames have fewer edits in it than in `base`, the document went
    /// on since, and nothing that differs can be taken for a change of the version alone.
    pub(super) fn settle_by_revisions(&mut self, base: &Document) {
        let mut went_on = false;
        // Frames without common state, and those of which that depends on the others.
        let (mut disputed, mut with_more_edits) = (BTreeSet::new(), BTreeSet::new());
        for ours in &base.frames {
            let Some(theirs) = self.version.frames.by_id(&ours.id) else {
                // It was removed there, or added here since: work is not lost to the difference.
                if !ours.without_suggestion().is_untouched() {
                    disputed.insert(ours.id.clone());
                }
                continue;
            };
            if theirs.has_content_of(ours) {
                continue;
            }
            let (mine, edited) = (ours.without_suggestion(), theirs.without_suggestion());
            if edited.has_content_of(&mine) {
                continue;
            }
            match edited.revision.cmp(&mine.revision) {
                Ordering::Less => {
                    went_on = true;
                    if !edited.is_earlier_state_of(&mine) {
                        disputed.insert(ours.id.clone());
                    } else if let Some(theirs) = self.version.frames.by_id_mut(&ours.id) {
                        theirs.clone_from(ours);
                    }
                }
                // Both were edited as often, so that neither is the state before the other. Programs
                // that count no edits leave 0.
                Ordering::Equal if mine.revision > 0 => {
                    disputed.insert(ours.id.clone());
                }
                Ordering::Greater if mine.revision > 0 && !mine.is_earlier_state_of(&edited) => {
                    with_more_edits.insert(ours.id.clone());
                }
                Ordering::Equal | Ordering::Greater => {}
            }
        }
        if went_on {
            disputed.extend(with_more_edits);
            self.dispute_rest(base);
        }
        self.common
            .frames
            .retain(|frame| !disputed.contains(&frame.id));
    }

    /// Disputes frames with another picture than the document has.
    pub(super) fn dispute_other_pictures(&mut self) {
        let version = &self.version;
        self.common.frames.retain(|frame| {
            let theirs = version.frames.by_id(&frame.id);
            !theirs.is_some_and(|theirs| has_other_picture(frame, theirs))
        });
    }

    /// Disputes all that differs beside the frames of a version that is older than the document,
    /// and what it lacks.
    fn dispute_rest(&mut self, base: &Document) {
        let version = &self.version;
        self.common
            .frames
            .retain(|frame| version.frames.by_id(&frame.id).is_some());
        for camera in &base.cameras {
            let theirs = self.version.cameras.iter_mut();
            match theirs.into_iter().find(|theirs| theirs.id == camera.id) {
                Some(theirs) if theirs.base().is_none() && camera.base().is_some() => {
                    theirs.clone_from(camera);
                }
                Some(theirs) if theirs == camera => {}
                Some(_) | None => self.dispute_camera(&camera.id),
            }
        }
        for part in Part::VARIANTS {
            self.dispute(*part);
        }
    }
}
