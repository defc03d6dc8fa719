//! Detects that a camera's base stops fitting from some frame on, and proposes a new camera for the
//! frames from there.

use super::{AssignedFrames, FrameLookup, NewCamera, calibrate, observations};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::geometry::thousands;
use touchline_core::solve::base::{FrameClicks, base_change};
use touchline_documents::document::{Camera, CameraId, Document};

/// A change of a camera's base between two frames of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraChange {
    /// The camera.
    pub camera: CameraId,
    /// The first frame that its base no longer fits, by its index in the document.
    pub frame: usize,
    /// Median residual of the clicks before it, px.
    pub before_px: f64,
    /// Median residual of the clicks from it on, px.
    pub after_px: f64,
    /// Median residual of the same clicks with a base of their own, px.
    pub own_px: f64,
    /// The base that fits the frames from the change on.
    pub base: CameraBase,
}

impl CameraChange {
    /// The warning for the user, with the number of the frame in its document.
    pub fn describe(&self, document: &Document) -> String {
        let frame = document.frames.get(self.frame);
        let number = frame.map_or(self.frame, |frame| frame.number_at(self.frame) as usize);
        format!(
            "The camera stopped fitting at frame {} ({:.0} px before, {:.0} px since).",
            thousands(number),
            self.before_px,
            self.after_px
        )
    }

    /// The indices of the camera's frames from the change on.
    pub fn frames(&self, document: &Document) -> Vec<usize> {
        (self.frame..document.frames.len())
            .filter(|index| document.frames[*index].camera == self.camera)
            .collect()
    }

    /// The remedy: these frames assigned to a new camera, with the base that fits them.
    pub fn assignment(&self, document: &Document) -> AssignedFrames {
        AssignedFrames {
            frames: self
                .frames(document)
                .into_iter()
                .map(|index| document.frames[index].id.clone())
                .collect(),
            camera: document.free_camera_name(&self.camera),
            new: Some(NewCamera {
                like: self.camera.clone(),
                base: Some(self.base),
            }),
        }
    }
}

/// The frame from which a camera's base no longer fits, in the document's order; none if it fits
/// all. Rejected frames and those excluded from the base are ignored. `lookup` is the document's.
pub fn camera_change(
    document: &Document,
    lookup: &FrameLookup,
    camera: &CameraId,
    field: &FieldModel,
) -> Option<CameraChange> {
    let known = document.camera(camera)?;
    let base = known.base()?;
    // Each frame contributes its clicks and the camera that follows from them. Solving these is
    // what takes time, so it is done in parallel.
    let observed = lookup
        .clicked_frames(camera)
        .into_par_iter()
        .filter_map(|index| observe_frame(document, lookup, index, known, field));
    let (places, observed): (Vec<usize>, Vec<(FrameClicks, Option<Ptz>)>) = observed.unzip();
    let (clicks, pointed): (Vec<FrameClicks>, Vec<Option<Ptz>>) = observed.into_iter().unzip();
    // The test itself compares a model with one base to a model with a change of base at each frame
    // (`solve::base`).
    let found = base_change(field, &clicks, &pointed, &base)?;
    Some(CameraChange {
        camera: camera.clone(),
        frame: places[found.frame],
        before_px: found.before_px,
        after_px: found.after_px,
        own_px: found.own_px,
        base: found.base,
    })
}

/// The index of a frame of `camera`, with its clicks and the camera that follows from them. None if
/// the frame takes no part in the base, or its clicks are not valid.
fn observe_frame(
    document: &Document,
    lookup: &FrameLookup,
    index: usize,
    camera: &Camera,
    field: &FieldModel,
) -> Option<(usize, (FrameClicks, Option<Ptz>))> {
    let frame = &document.frames[index];
    // The lens and the principal point of the camera are those of one picture size.
    if frame.image_size != camera.image_size || !frame.is_used_for_base() {
        return None;
    }
    let clicks = FrameClicks {
        observations: observations(frame, field).ok()?,
        start: None,
    };
    let pointed = ptz_by_clicks(document, lookup, index, camera, field);
    Some((index, (clicks, pointed)))
}

/// Pan, tilt and focal length of a frame from its clicks; a stored solution from clicks is not
/// solved again.
fn ptz_by_clicks(
    document: &Document,
    lookup: &FrameLookup,
    index: usize,
    camera: &Camera,
    field: &FieldModel,
) -> Option<Ptz> {
    let frame = &document.frames[index];
    match camera.ptz_camera(frame) {
        Some(pointed) if frame.is_solved_by_clicks() => Some(pointed.ptz()),
        _ => calibrate(document, lookup, frame, field, index)
            .ok()
            .map(|solved| solved.ptz),
    }
}
