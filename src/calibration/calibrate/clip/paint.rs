//! The painted lines of a clip's frames as further anchors.

use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_core::markings::LineVerdict;
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, SnapOptions, check_lines, snap};
use touchline_vision::track::{PosePrior, PriorSource};

/// A picture of a clip with what covers it.
pub(super) struct MaskedPicture {
    pub picture: Picture,
    pub masks: Vec<PixelBox>,
}

/// What the paint of a picture says about a camera.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Painted {
    /// It is here.
    Snapped(PosePrior),
    /// Not where the camera puts it.
    Contradicts,
    /// Nothing certain.
    Open,
}

/// Paint is looked for this near to where the points put it, px at 1920 px width.
const REACH_PX: f64 = 16.0;

/// Frames that show the same err by the same where one source speaks for them: the unevenness of
/// paint stays, and all answers of a forest repeat the errors of the references that they were read
/// off. Together they say no more than one of them, so each counts for less by as many as show what
/// it shows. What people clicked errs by itself in each frame.
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
    for anchor in anchors.iter_mut().filter(|anchor| anchor.source == source) {
        let alike: f64 = cameras
            .iter()
            .map(|other| overlap(anchor.ptz, *other, size))
            .sum();
        anchor.information /= alike.max(1.0);
    }
}

/// How much of what a camera sees another one sees as large: 1 for the same camera.
fn overlap(one: Ptz, other: Ptz, size: ImageSize) -> f64 {
    let across = other.pan.turn_from(one.pan).radians() * one.tilt.radians().cos();
    let apart = [
        across / f64::from(size.width),
        (other.tilt - one.tilt).radians() / f64::from(size.height),
    ];
    let zoom = (other.focal_px / one.focal_px).ln().abs() / std::f64::consts::LN_2;
    let shares = apart.map(|by| (1.0 - by.abs() * one.focal_px).max(0.0));
    shares[0] * shares[1] * (1.0 - zoom).max(0.0)
}

impl Painted {
    /// What the paint of a frame's picture says about a camera.
    pub fn from_picture(
        MaskedPicture { picture, masks }: &MaskedPicture,
        field: &FieldModel,
        base: &CameraBase,
        (frame, ptz): (usize, Ptz),
    ) -> Self {
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
        let check = check_lines(&ground, field, &PtzCamera::new(*base, ptz));
        if check.verdict() == LineVerdict::Contradicts {
            Self::Contradicts
        } else {
            Self::Open
        }
    }
}
