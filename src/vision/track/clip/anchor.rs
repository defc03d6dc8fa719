//! What is known of a frame's camera beside its points.

use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_core::solve::Loss;

/// What is known of a frame's camera before points are followed: from a person's clicks, a forest or the painted lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The frame, by its place in the clip.
    pub frame: usize,
    /// Its camera.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px), the base taken as exact.
    pub covariance: Mat3,
    /// Who says so.
    pub by: AnchorSource,
}

/// Where an anchor comes from: how far it holds where followed points contradict it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnchorSource {
    /// A person's clicks.
    Person,
    /// The painted lines of the frame's picture.
    Paint,
    /// An answer that is as exact as it states only in the middle: a forest's.
    Proposal,
}

/// What holds may be contradicted by this many sigmas before it pulls less.
const HOLDING: Loss = Loss::Huber { k: 2.0 };

/// What does not hold pulls less and less where the others contradict it.
const YIELDING: Loss = Loss::Cauchy { c: 2.0 };

impl Anchor {
    /// How a contradiction counts, in multiples of the stated 1-σ.
    pub(super) fn loss(&self) -> Loss {
        match self.by {
            AnchorSource::Person => HOLDING,
            AnchorSource::Paint | AnchorSource::Proposal => YIELDING,
        }
    }

    /// How far a camera is from this one, (pan rad, tilt rad, log of the focal length).
    pub(super) fn offset(&self, ptz: Ptz) -> Vec3 {
        offset(self.ptz, ptz)
    }

    /// A camera, or where the way to it leaves what is known by so many sigmas.
    #[must_use]
    pub fn towards(&self, ptz: Ptz, sigmas: f64) -> Ptz {
        let by = self.offset(ptz);
        let Some(information) = self.information() else { return self.ptz };
        let far = by.dot(&(information * by)).sqrt();
        if far <= sigmas { ptz } else { moved(self.ptz, by * (sigmas / far)) }
    }

    /// The inverse of the covariance, in (pan rad, tilt rad, log of the focal length); none where it has none.
    pub(super) fn information(&self) -> Option<Mat3> {
        by_log_focal(&self.covariance, self.ptz.focal_px).try_inverse().filter(|it| it.iter().all(|v| v.is_finite()))
    }
}

/// From one camera to another: pan rad, tilt rad, log of the focal length.
pub(in crate::track) fn offset(from: Ptz, to: Ptz) -> Vec3 {
    Vec3::new(to.pan.turn_from(from.pan).radians(), (to.tilt - from.tilt).radians(), (to.focal_px / from.focal_px).ln())
}

/// A camera moved by (pan rad, tilt rad, log of the focal length).
pub(super) fn moved(ptz: Ptz, by: Vec3) -> Ptz {
    Ptz {
        pan: ptz.pan + Angle::from_radians(by.x),
        tilt: ptz.tilt + Angle::from_radians(by.y),
        focal_px: ptz.focal_px * by.z.exp(),
    }
}

/// A covariance of (pan rad, tilt rad, focal length px) with the logarithm of the focal length instead.
pub(super) fn by_log_focal(covariance: &Mat3, focal_px: f64) -> Mat3 {
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 1.0 / focal_px));
    scale * covariance * scale
}

/// The reverse of [`by_log_focal`].
pub(in crate::track) fn by_focal_px(covariance: &Mat3, focal_px: f64) -> Mat3 {
    by_log_focal(covariance, 1.0 / focal_px)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_the_way_to_another_camera_it_stops_at_its_sigma() {
        let sigma = 0.1f64.to_radians();
        let covariance = Mat3::from_diagonal(&Vec3::new(sigma * sigma, sigma * sigma, 25.0));
        let ptz = Ptz::from_degrees(179.95, -10.0, 2000.0);
        let anchor = Anchor { frame: 0, ptz, covariance, by: AnchorSource::Person };
        let near = Ptz::from_degrees(-179.99, -10.0, 2000.0);
        assert_eq!(anchor.towards(near, 1.0), near);
        let stopped = anchor.towards(Ptz::from_degrees(-179.65, -10.0, 2000.0), 1.0);
        assert!((stopped.pan.turn_from(ptz.pan).degrees() - 0.1).abs() < 1e-9, "{stopped:?}");
    }
}
