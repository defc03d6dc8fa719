//! The painted lines of a clip's frames as pose priors.

use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_core::markings::LineVerdict;
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, SnapOptions, check_lines, snap};
use touchline_vision::track::{PosePrior, PriorSource};

/// A picture of a clip with the pixels that are not searched.
pub(super) struct MaskedPicture {
    pub picture: Picture,
    pub masks: Vec<PixelBox>,
}

/// The verdict of a picture's paint on a camera.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PaintAlignmentOutcome {
    /// The camera could be aligned to the paint: here.
    Snapped(PosePrior),
    /// The paint is not where the camera projects it.
    Contradicts,
    /// The paint is not decisive.
    Open,
}

/// Paint is searched within this distance of where the points put it, px at 1920 px width.
const REACH_PX: f64 = 16.0;

/// Reduces the weight of priors whose errors are common.
///
/// Frames that show the same part of the field have the same error if they rely on the same source:
/// unevenness of the paint stays in place, and all answers of a forest repeat the errors of the
/// references that it was trained on. Together such frames contain no more information than one of
/// them, so the information of each is divided by the number of frames that show what it shows.
/// People's click errors are independent in each frame.
pub(super) fn share_alike(anchors: &mut [PosePrior], size: ImageSize) {
    for source in [PriorSource::Paint, PriorSource::Proposal] {
        share_alike_of(source, anchors, size);
    }
}

fn share_alike_of(source: PriorSource, anchors: &mut [PosePrior], size: ImageSize) {
    let cameras: Vec<Ptz> = anchors
        .iter()
        .filter(|it| it.source == source)
        .map(|anchor| anchor.ptz)
        .collect();
    // Every frame is compared with every other one. In half a match without a cut that is billions
    // of pairs, so the frames are divided among the threads.
    let of_source = anchors
        .par_iter_mut()
        .filter(|anchor| anchor.source == source);
    of_source.for_each(|anchor| {
        // A sum of overlaps, not a count: it changes smoothly with the cameras and includes the
        // frame itself (1).
        let alike: f64 = cameras
            .iter()
            .map(|other| overlap(anchor.ptz, *other, size))
            .sum();
        anchor.information /= alike.max(1.0);
    });
}

/// The share of a camera's picture that another one shows at nearly the same scale: 1 for the same
/// camera, 0 from a factor of two in focal length.
fn overlap(one: Ptz, other: Ptz, size: ImageSize) -> f64 {
    let across = other.pan.turn_from(one.pan).radians() * one.tilt.radians().cos();
    // Each factor falls linearly from 1 to 0: displacement in x by one picture width, in y by one
    // height, and a zoom by the factor two.
    let apart = [
        across / f64::from(size.width),
        (other.tilt - one.tilt).radians() / f64::from(size.height),
    ];
    let shares = apart.map(|by| (1.0 - by.abs() * one.focal_px).max(0.0));
    let shown = shares[0] * shares[1];
    // Most pairs of a long clip show different parts, which needs no logarithm.
    if shown == 0.0 {
        return 0.0;
    }
    let zoom = (other.focal_px / one.focal_px).ln().abs() / std::f64::consts::LN_2;
    shown * (1.0 - zoom).max(0.0)
}

impl PaintAlignmentOutcome {
    /// The verdict of the paint of a frame's picture on a camera.
    pub fn from_picture(
        MaskedPicture { picture, masks }: &MaskedPicture,
        field: &FieldModel,
        base: &CameraBase,
        (frame, ptz): (usize, Ptz),
    ) -> Self {
        // Clicks take no part: they are in the clip's priors already.
        let ground = GroundPicture::new(picture, masks);
        let options = SnapOptions {
            reach_px: REACH_PX,
            ..SnapOptions::default()
        };
        if let Ok(snapped) = snap(&ground, field, base, ptz, &[], &options) {
            let covariance = &snapped.uncertainty.clicks;
            return Self::Snapped(PosePrior::from_covariance(
                frame,
                snapped.ptz,
                covariance,
                PriorSource::Paint,
            ));
        }
        // Paint that cannot be aligned to may still show that the camera is wrong.
        let check = check_lines(&ground, field, &PtzCamera::new(*base, ptz));
        if check.verdict() == LineVerdict::Contradicts {
            Self::Contradicts
        } else {
            Self::Open
        }
    }
}
