//! The painted lines of a clip's frames as further anchors.

use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::PixelBox;
use crate::media::Picture;
use crate::paint::{GroundPicture, LineVerdict, SnapOptions, check_lines, snap};
use crate::solve::Loss;
use crate::track::Anchor;

/// What the paint of a picture says about a camera.
pub(super) enum Painted {
    /// It is here.
    Snapped(Anchor),
    /// Not where the camera puts it.
    Contradicts,
    /// Nothing certain.
    Open,
}

/// The unevenness of paint stays from frame to frame: a line pulls neighbouring frames the same way. Each counts for fewer by
/// this factor.
const ALIKE: f64 = 4.0;

/// Paint is looked for this near to where the points put it, px at 1920 px width.
const REACH_PX: f64 = 16.0;

/// What the paint of a frame's picture says.
pub(super) fn painted(
    picture: &Picture,
    masks: &[PixelBox],
    field: &FieldModel,
    base: &CameraBase,
    (frame, ptz): (usize, Ptz),
) -> Painted {
    let ground = GroundPicture::new(picture, masks);
    let options = SnapOptions { reach_px: REACH_PX, ..SnapOptions::default() };
    if let Ok(snapped) = snap(&ground, field, base, ptz, &[], &options) {
        return Painted::Snapped(Anchor {
            frame,
            ptz: snapped.ptz,
            covariance: snapped.uncertainty.clicks * ALIKE,
            loss: Loss::Cauchy { c: 2.0 },
        });
    }
    let check = check_lines(&ground, field, &PtzCamera::new(*base, ptz));
    if check.verdict() == LineVerdict::Contradicts { Painted::Contradicts } else { Painted::Open }
}
