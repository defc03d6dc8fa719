//! Tracked clips as bytes.

use super::track::{ClipStop, MovedReference, TrackedClip, TrackedFrame};
use crate::calibrate::kept::{Kept, kept};
use touchline_core::solve::Loss;
use touchline_vision::track::{
    ClipCamera, ClipLens, FollowOptions, Jitter, PointTrack, PointTracks, PosePrior, PriorSource,
};

kept! {
    Jitter { pan_deg, tilt_deg, focal_px, centre_px }
    PointTrack { first, points }
    PointTracks { image_size, frames, tracks }
    FollowOptions { points, refill, longest, max_width }
    ClipLens { principal_point, distortion, focal_px }
    PosePrior { frame, ptz, information, loss, source }
    ClipStop { picture, seen, agreeing }
    MovedReference { place, ptz, raw }
    TrackedFrame {
        place, ptz, raw, uncertainty, confidence, apart_px, contradicted, length_px,
    }
    TrackedClip {
        base, frames, references, missed, unreadable, kept, stops, sigma_px, inflation, painted,
        lengths, jitter, raw_jitter,
    }
}

impl Kept for ClipCamera {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.base().write(bytes);
        self.lenses().to_vec().write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let base = Kept::read(bytes)?;
        Some(Self::with_lenses(base, Kept::read(bytes)?))
    }
}

impl Kept for Loss {
    fn write(&self, bytes: &mut Vec<u8>) {
        let (number, scale): (u8, f64) = match *self {
            Self::Squared => (0, 0.0),
            Self::Huber { k } => (1, k),
            Self::Cauchy { c } => (2, c),
            Self::GemanMcClure { c } => (3, c),
        };
        (number, scale).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (number, scale): (u8, f64) = Kept::read(bytes)?;
        match number {
            0 => Some(Self::Squared),
            1 => Some(Self::Huber { k: scale }),
            2 => Some(Self::Cauchy { c: scale }),
            3 => Some(Self::GemanMcClure { c: scale }),
            _ => None,
        }
    }
}

impl Kept for PriorSource {
    fn write(&self, bytes: &mut Vec<u8>) {
        let number: u8 = match self {
            Self::Person => 0,
            Self::Paint => 1,
            Self::Proposal => 2,
        };
        number.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        match u8::read(bytes)? {
            0 => Some(Self::Person),
            1 => Some(Self::Paint),
            2 => Some(Self::Proposal),
            _ => None,
        }
    }
}
