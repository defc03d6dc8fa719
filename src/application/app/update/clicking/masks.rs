//! Masks: boxes in which no features are detected. They belong to a frame, to a camera, or to a
//! camera with a range of frames.

use crate::app::App;
use crate::app::window_state::choices::{MaskList, MaskScope, Scope};
use touchline_core::geometry::PixelBox;
use touchline_documents::document::{Document, Extra, MaskSource, RangedMask, Step};

/// Minimum size of a drawn mask, px. A smaller box is an accidental drag.
const SMALLEST_MASK_PX: f64 = 3.0;

impl App {
    /// Adds a mask to the shown frame or to its camera; one step of undo.
    pub(in crate::app::update) fn add_mask(&mut self, of_camera: bool, mask: PixelBox) {
        if !(mask.width >= SMALLEST_MASK_PX && mask.height >= SMALLEST_MASK_PX) {
            return;
        }
        let step = if of_camera {
            Step::on_document("Draw mask")
        } else {
            self.step_at("Draw mask", self.session.frame)
        };
        self.change_masks(step, |document, shown| {
            let frame = &mut document.frames[shown];
            if !of_camera {
                frame.masks.push(mask);
                return;
            }
            let camera = frame.camera.clone();
            if let Some(camera) = document.camera_mut(&camera) {
                camera.masks.push(mask);
            }
        });
    }

    /// Removes a mask of the shown frame; one step of undo.
    pub(in crate::app::update) fn remove_mask(&mut self, list: MaskList, index: usize) {
        let step = match list {
            MaskList::Frame => self.step_at("Remove mask", self.session.frame),
            MaskList::Camera | MaskList::Ranged => Step::on_document("Remove mask"),
        };
        self.change_masks(step, |document, shown| {
            take_mask(document, shown, list, index);
        });
    }

    /// Why a mask of the shown frame cannot be extended or restricted to a scope. None if it can.
    pub fn why_not_scope(&self, scope: MaskScope) -> Option<&'static str> {
        let of_video = self.frame().is_some_and(|frame| frame.video.is_some());
        match scope {
            MaskScope::Shot if self.frame().is_none_or(|frame| frame.clip.is_none()) => {
                Some("This frame belongs to no shot.")
            }
            MaskScope::Selected if self.session.frames_selected.is_empty() => {
                Some("No frames are selected: Shift-click the filmstrip.")
            }
            MaskScope::FromHere | MaskScope::UpToHere if !of_video => {
                Some("Images have no order in time: select frames on the filmstrip instead.")
            }
            _ => None,
        }
    }

    /// Changes the frames that a mask covers; one step of undo.
    pub(in crate::app::update) fn scope_mask(
        &mut self,
        list: MaskList,
        index: usize,
        scope: MaskScope,
    ) {
        if let Some(reason) = self.why_not_scope(scope) {
            self.session.note(reason);
            return;
        }
        let Some(open) = &self.open else { return };
        let frames = match scope {
            MaskScope::Shot => Scope::Shot.frames(open, &self.session),
            MaskScope::Selected => Scope::Selected.frames(open, &self.session),
            MaskScope::All | MaskScope::FromHere | MaskScope::UpToHere | MaskScope::Frame => {
                vec![self.session.frame]
            }
        };
        self.change_masks(
            Step::on_document("Change frames of mask"),
            |document, shown| {
                if let Some(mask) = take_mask(document, shown, list, index) {
                    put_mask(document, shown, mask, scope, &frames);
                }
            },
        );
    }

    /// Changes masks as one step of undo. `change` gets the document and the index of the shown
    /// frame.
    pub(in crate::app) fn change_masks(
        &mut self,
        step: Step,
        change: impl FnOnce(&mut Document, usize),
    ) {
        let shown = self.session.frame;
        if self.frame().is_none() || !self.begin_step(step) {
            return;
        }
        if let Some(open) = &mut self.open {
            change(&mut open.document, shown);
        }
        self.commit();
    }
}

/// Removes a mask from its list and returns it.
fn take_mask(
    document: &mut Document,
    shown: usize,
    list: MaskList,
    index: usize,
) -> Option<RangedMask> {
    let frame = document.frames.get_mut(shown)?;
    if list == MaskList::Frame {
        return (index < frame.masks.len()).then(|| mask_by_hand(frame.masks.remove(index)));
    }
    let camera = frame.camera.clone();
    let camera = document.camera_mut(&camera)?;
    match list {
        MaskList::Camera => {
            (index < camera.masks.len()).then(|| mask_by_hand(camera.masks.remove(index)))
        }
        MaskList::Ranged => {
            (index < camera.ranged_masks.len()).then(|| camera.ranged_masks.remove(index))
        }
        MaskList::Frame => None,
    }
}

/// A mask for all frames that a user drew.
fn mask_by_hand(pixel_box: PixelBox) -> RangedMask {
    RangedMask {
        pixel_box,
        from: None,
        to: None,
        source: MaskSource::ByHand,
        extra: Extra::new(),
    }
}

/// Adds a mask for some frames: to the camera with a range of frames if all belong to the shown
/// frame's camera and video, otherwise to each of the frames.
fn put_mask(
    document: &mut Document,
    shown: usize,
    mask: RangedMask,
    scope: MaskScope,
    frames: &[usize],
) {
    let Some(frame) = document.frames.get(shown) else {
        return;
    };
    let (here, camera) = (frame.video_frame_index(), frame.camera.clone());
    let shown_video = frame.video_path();
    // The first and last frame of the range; none for a mask of single frames. A range that the
    // mask has already is cut at the shown frame.
    let range = match scope {
        MaskScope::All => Some((None, None)),
        MaskScope::Frame => None,
        MaskScope::FromHere => Some((here, mask.to.filter(|to| Some(*to) >= here))),
        MaskScope::UpToHere => Some((mask.from.filter(|from| Some(*from) <= here), here)),
        // A range covers one video of one camera. Still images have no numbers, and frames that are
        // selected beyond the shown video or camera are outside of it: each gets the mask for
        // itself.
        MaskScope::Shot | MaskScope::Selected => {
            let numbers: Option<Vec<u64>> = frames
                .iter()
                .map(|&index| {
                    let frame = document.frames.get(index)?;
                    let is_of_range = frame.camera == camera && frame.video_path() == shown_video;
                    frame.video_frame_index().filter(|_| is_of_range)
                })
                .collect();
            numbers.map(|numbers| (numbers.iter().min().copied(), numbers.iter().max().copied()))
        }
    };
    let Some((from, to)) = range else {
        for &index in frames {
            if let Some(frame) = document.frames.get_mut(index) {
                frame.masks.push(mask.pixel_box);
            }
        }
        return;
    };
    let Some(camera) = document.camera_mut(&camera) else {
        return;
    };
    // A mask for all frames that says nothing else belongs to the plain list.
    if (from, to, mask.source) == (None, None, MaskSource::ByHand) && mask.extra.is_empty() {
        camera.masks.push(mask.pixel_box);
    } else {
        camera.ranged_masks.push(RangedMask { from, to, ..mask });
    }
}
