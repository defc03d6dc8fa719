//! Priors of a frame's pan, tilt and focal length, beside what it shares with other frames.

use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_core::solve::Loss;

/// A prior of one frame's camera in a joint adjustment: from user clicks, a forest or the painted
/// lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePrior {
    /// The frame, as an index into the frames that are adjusted.
    pub frame: usize,
    /// The mean.
    pub ptz: Ptz,
    /// The information matrix of (pan rad, tilt rad, ln f), given the base. It may be singular.
    pub information: Mat3,
    /// The robust loss, in multiples of the stated 1-σ.
    pub loss: Loss,
    /// Where it comes from.
    pub source: PriorSource,
}

/// The source of a pose prior; it decides how the prior is treated where everything else
/// contradicts it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PriorSource {
    /// User clicks.
    Person,
    /// The painted lines in the frame's picture.
    Paint,
    /// A proposal of a forest: its covariance holds for typical errors, and outliers occur.
    Proposal,
}

impl PriorSource {
    /// The loss of each source. Clicks pull less beyond 2 σ but are never ignored (Huber); paint
    /// and proposals are, if far off (Cauchy).
    const fn loss(self) -> Loss {
        match self {
            Self::Person => Loss::Huber { k: 2.0 },
            Self::Paint | Self::Proposal => Loss::Cauchy { c: 2.0 },
        }
    }
}

impl PosePrior {
    /// A prior with the loss of its source.
    pub const fn new(frame: usize, ptz: Ptz, information: Mat3, source: PriorSource) -> Self {
        Self {
            frame,
            ptz,
            information,
            loss: source.loss(),
            source,
        }
    }

    /// A prior from the covariance of (pan rad, tilt rad, focal length px). A singular covariance
    /// yields a prior without information.
    pub fn from_covariance(frame: usize, ptz: Ptz, covariance: &Mat3, source: PriorSource) -> Self {
        // A covariance without an inverse states that a parameter is exact; its information would
        // be infinite. No information is the safe reading; `adjust_clip` leaves such a prior out.
        let inverse = by_log_focal(covariance, ptz.focal_px).try_inverse();
        let information = inverse.filter(|inverse| inverse.iter().all(|value| value.is_finite()));
        Self::new(frame, ptz, information.unwrap_or_else(Mat3::zeros), source)
    }

    /// Whether the prior has any information.
    pub(super) fn is_informative(&self) -> bool {
        self.information != Mat3::zeros()
    }

    /// The offset of a camera from the mean: (pan rad, tilt rad, ln f).
    pub(super) fn offset(&self, ptz: Ptz) -> Vec3 {
        offset(self.ptz, ptz)
    }

    /// Limits a camera to the confidence region of this prior: `ptz` if it lies within `sigmas`,
    /// else the point at that Mahalanobis distance on the straight line to it. Without information,
    /// the mean.
    pub fn towards(&self, ptz: Ptz, sigmas: f64) -> Ptz {
        // A covariance that could not be inverted has no region; the camera stays at the mean.
        if !self.is_informative() {
            return self.ptz;
        }
        let by = self.offset(ptz);
        // Rounding may leave the information of an uncertain direction slightly negative.
        let far = by.dot(&(self.information * by)).max(0.0).sqrt();
        if far <= sigmas {
            ptz
        } else {
            apply_offset(self.ptz, by * (sigmas / far))
        }
    }
}

/// The difference of two cameras: (pan rad, tilt rad, ln f).
pub(super) fn offset(from: Ptz, to: Ptz) -> Vec3 {
    Vec3::new(
        to.pan.turn_from(from.pan).radians(),
        (to.tilt - from.tilt).radians(),
        (to.focal_px / from.focal_px).ln(),
    )
}

/// A camera moved by (pan rad, tilt rad, ln f).
pub(super) fn apply_offset(ptz: Ptz, by: Vec3) -> Ptz {
    Ptz {
        pan: ptz.pan + Angle::from_radians(by.x),
        tilt: ptz.tilt + Angle::from_radians(by.y),
        focal_px: ptz.focal_px * by.z.exp(),
    }
}

/// Converts a covariance of (pan rad, tilt rad, focal length px) to (pan rad, tilt rad, ln f), to
/// first order.
pub(super) fn by_log_focal(covariance: &Mat3, focal_px: f64) -> Mat3 {
    // J Σ Jᵀ, with d ln f = df / f.
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 1.0 / focal_px));
    scale * covariance * scale
}

/// The reverse of [`by_log_focal`].
pub(super) fn by_focal_px(covariance: &Mat3, focal_px: f64) -> Mat3 {
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
        let prior = PosePrior::from_covariance(0, ptz, &covariance, PriorSource::Person);
        let near = Ptz::from_degrees(-179.99, -10.0, 2000.0);
        assert_eq!(prior.towards(near, 1.0), near);
        let stopped = prior.towards(Ptz::from_degrees(-179.65, -10.0, 2000.0), 1.0);
        assert!(
            (stopped.pan.turn_from(ptz.pan).degrees() - 0.1).abs() < 1e-9,
            "{stopped:?}"
        );
    }

    #[test]
    fn information_that_rounding_made_negative_gives_a_camera() {
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let information = Mat3::from_diagonal(&Vec3::new(1e6, -1e-9, 1e6));
        let prior = PosePrior::new(0, ptz, information, PriorSource::Person);
        let tilted = Ptz::from_degrees(3.0, -9.0, 2000.0);
        assert_eq!(prior.towards(tilted, 1.0), tilted);
    }

    #[test]
    fn a_covariance_without_an_inverse_says_nothing() {
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let prior = PosePrior::from_covariance(0, ptz, &Mat3::zeros(), PriorSource::Paint);
        assert!(!prior.is_informative());
        assert_eq!(
            prior.towards(Ptz::from_degrees(4.0, -10.0, 2000.0), 1.0),
            ptz
        );
    }
}
