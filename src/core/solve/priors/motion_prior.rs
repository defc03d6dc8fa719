//! The usual pan, tilt and focal length of a camera and its usual speed, known from its other
//! frames.
//!
//! A camera that fits a frame's clicks can still be wrong. Two clicks named from the wrong side of
//! the field, for example, can fit exactly; only the sudden change of the camera's direction
//! reveals them.

use crate::camera::Ptz;
use crate::geometry::{Angle, AngleRange, ImageSize};
use crate::solve::{Warning, WarningCode};
use std::ops::RangeInclusive;

/// The usual ranges and motion of a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionPrior {
    /// The ranges of pan, tilt and focal length of the accepted frames; none while there are too
    /// few.
    pub seen: Option<PtzRanges>,
    /// The camera in the nearest solved frame and its usual motion since; none where that is not
    /// known.
    pub motion: Option<Motion>,
}

/// The camera in the nearest solved frame of the shot, and its usual motion from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Pan, tilt and focal length in that frame.
    pub from: Ptz,
    /// The distance to that frame in frames, at least 1.
    pub frames: u64,
    /// The 90 % quantile of the camera's moves over this many frames.
    pub usual: PtzStep,
}

/// A change of pan, tilt and focal length, each without its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PtzStep {
    /// Of the pan.
    pub pan: Angle,
    /// Of the tilt.
    pub tilt: Angle,
    /// Of the focal length, as the logarithm of the ratio.
    pub log_focal: f64,
}

impl PtzStep {
    /// No change.
    pub const ZERO: Self = Self {
        pan: Angle::ZERO,
        tilt: Angle::ZERO,
        log_focal: 0.0,
    };

    /// The absolute change from one camera to another.
    pub fn between(from: &Ptz, to: &Ptz) -> Self {
        Self {
            pan: to.pan.turn_from(from.pan).abs(),
            tilt: (to.tilt - from.tilt).abs(),
            log_focal: (to.focal_px / from.focal_px).ln().abs(),
        }
    }

    /// In degrees, degrees and the logarithm.
    const fn values(&self) -> [f64; 3] {
        [self.pan.degrees(), self.tilt.degrees(), self.log_focal]
    }
}

/// A move larger than this many usual moves is a jump.
const JUMP: f64 = 3.0;

/// Smaller moves are never a jump: degrees, degrees, log f.
const NO_JUMP: [f64; 3] = [0.3, 0.2, 0.03];

/// The margin around the ranges of the accepted frames that is still usual: at least [`MARGIN`]
/// (degrees, degrees, log f), or [`MARGIN_SHARE`] of their width if that is larger.
const MARGIN: [f64; 3] = [15.0, 4.0, 0.5];
const MARGIN_SHARE: f64 = 0.5;

/// The χ² of a camera that exceeds a limit by 100 % of it; at most twice that.
const SURPRISE: f64 = 25.0;

/// A parameter outside its usual limit.
struct Odd {
    /// Which: pan, tilt, focal length.
    which: usize,
    /// The excess over the limit, as a fraction of the limit.
    excess: f64,
}

impl MotionPrior {
    /// The cost of a camera under this prior in units of χ²: 0 within the usual limits, 25 at twice
    /// a limit, 50 at most. `slack` is the uncertainty of the camera due to click noise; the limits
    /// are extended by it.
    pub fn surprise(&self, ptz: &Ptz, slack: &PtzStep) -> f64 {
        // The larger of both counts, not their sum, because both may describe the same deviation.
        let odd = [self.jump(ptz, slack), self.elsewhere(ptz, slack)];
        odd.into_iter()
            .flatten()
            .map(|odd| SURPRISE * odd.excess.min(2.0))
            .fold(0.0, f64::max)
    }

    /// The parameter with the largest jump from the nearest frame, if there is one.
    fn jump(&self, ptz: &Ptz, slack: &PtzStep) -> Option<Odd> {
        // The uncertainty of the camera itself widens the limit: a jump within it may be noise.
        let motion = self.motion.as_ref()?;
        let (moved, usual) = (
            PtzStep::between(&motion.from, ptz).values(),
            motion.usual.values(),
        );
        largest((0..3).map(|which| {
            let limit = (JUMP * usual[which]).max(NO_JUMP[which]) + slack.values()[which];
            Odd {
                which,
                excess: moved[which] / limit - 1.0,
            }
        }))
    }

    /// The parameter farthest outside the ranges of the accepted frames, if one is outside.
    fn elsewhere(&self, ptz: &Ptz, slack: &PtzStep) -> Option<Odd> {
        // In units of the margin, so that the three parameters can be compared.
        let (seen, slack) = (self.seen.as_ref()?, slack.values());
        let (widths, distances) = (seen.widths(), seen.distances(ptz));
        largest((0..3).map(|which| {
            let margin = MARGIN[which].max(MARGIN_SHARE * widths[which]) + slack[which];
            Odd {
                which,
                excess: distances[which] / margin - 1.0,
            }
        }))
    }

    /// The warning for the user about an unusual camera.
    pub(in crate::solve) fn warning(&self, ptz: &Ptz, slack: &PtzStep) -> Option<Warning> {
        // A jump from the nearest frame says more than the range of all accepted ones.
        let message = if let (Some(odd), Some(motion)) = (self.jump(ptz, slack), &self.motion) {
            let moved = PtzStep::between(&motion.from, ptz);
            let there = if motion.frames == 1 {
                "the next frame".to_owned()
            } else {
                format!("a frame {} away", motion.frames)
            };
            let what = match odd.which {
                0 => format!("Pan differs by {:.1}", moved.pan),
                1 => format!("Tilt differs by {:.1}", moved.tilt),
                // From a logarithm of a ratio to per cent.
                _ => format!(
                    "The focal length differs by {:.0} %",
                    100.0 * moved.log_focal.exp_m1()
                ),
            };
            format!("{what} from {there}. A cut, or a wrong name?")
        } else {
            let (odd, seen) = (self.elsewhere(ptz, slack)?, self.seen.as_ref()?);
            let what = match odd.which {
                0 => format!("pan {:.1}, accepted frames have {:.1}", ptz.pan, seen.pan),
                1 => {
                    let (from, upto) = (seen.tilt.start(), seen.tilt.end());
                    format!(
                        "tilt {:.1}, accepted frames have {from:.1} to {upto:.1}",
                        ptz.tilt
                    )
                }
                _ => {
                    let (from, upto) = (seen.focal_px.start(), seen.focal_px.end());
                    format!(
                        "focal length {:.0} px, accepted frames have {from:.0} to {upto:.0}",
                        ptz.focal_px
                    )
                }
            };
            format!("Unusual camera: {what}. Check the names of the points.")
        };
        Some(Warning {
            code: WarningCode::Implausible,
            message,
            clicks: Vec::new(),
        })
    }
}

impl PtzRanges {
    /// The width of each range, in degrees, degrees and log f.
    fn widths(&self) -> [f64; 3] {
        let tilt = *self.tilt.end() - *self.tilt.start();
        [
            self.pan.width().degrees(),
            tilt.degrees(),
            (self.focal_px.end() / self.focal_px.start()).ln(),
        ]
    }

    /// The distance of a camera from each range, in degrees, degrees and log f; 0 within.
    fn distances(&self, ptz: &Ptz) -> [f64; 3] {
        let (tilts, focals) = (&self.tilt, &self.focal_px);
        [
            self.pan.distance(ptz.pan).degrees(),
            distance_from_range(
                ptz.tilt.degrees(),
                [tilts.start().degrees(), tilts.end().degrees()],
            ),
            distance_from_range(ptz.focal_px.ln(), [focals.start().ln(), focals.end().ln()]),
        ]
    }
}

/// How far a number is outside a range; 0 within.
fn distance_from_range(at: f64, [from, upto]: [f64; 2]) -> f64 {
    (from - at).max(at - upto).max(0.0)
}

/// The largest excess, if one is over the limit.
fn largest(all: impl Iterator<Item = Odd>) -> Option<Odd> {
    all.filter(|odd| odd.excess > 0.0)
        .max_by(|a, b| a.excess.total_cmp(&b.excess))
}

/// The plausible range of pan, tilt and focal length of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct PtzRanges {
    /// Pan.
    pub pan: AngleRange,
    /// Tilt.
    pub tilt: RangeInclusive<Angle>,
    /// Focal length, px of the frame.
    pub focal_px: RangeInclusive<f64>,
}

impl PtzRanges {
    /// Any pan, tilt from straight down to 20° up, fields of view from 1.5° of the 16:9 picture that
    /// a frame is cut from to 90° along its own longer side.
    pub fn for_size(size: ImageSize) -> Self {
        let longer_px = f64::from(size.width.max(size.height));
        Self {
            pan: AngleRange::FULL,
            tilt: Angle::from_degrees(-90.0)..=Angle::from_degrees(20.0),
            focal_px: 0.5 * longer_px..=40.0 * size.reference_width_px(),
        }
    }

    /// Whether pan, tilt and focal length are all within.
    pub fn contains(&self, ptz: &Ptz) -> bool {
        self.pan.contains(ptz.pan)
            && self.tilt.contains(&ptz.tilt)
            && self.focal_px.contains(&ptz.focal_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::AngleRange;

    fn prior() -> MotionPrior {
        let degrees = |from: f64, upto: f64| Angle::from_degrees(from)..=Angle::from_degrees(upto);
        let pan = AngleRange::new(Angle::from_degrees(-30.0), Angle::from_degrees(20.0));
        let seen = PtzRanges {
            pan,
            tilt: degrees(-14.0, -8.0),
            focal_px: 1500.0..=3000.0,
        };
        let usual = PtzStep {
            pan: Angle::from_degrees(0.4),
            tilt: Angle::from_degrees(0.1),
            log_focal: 0.01,
        };
        let motion = Motion {
            from: Ptz::from_degrees(10.0, -10.0, 2000.0),
            frames: 1,
            usual,
        };
        MotionPrior {
            seen: Some(seen),
            motion: Some(motion),
        }
    }

    fn said(prior: &MotionPrior, pan_deg: f64, tilt_deg: f64, focal_px: f64) -> Option<String> {
        let ptz = Ptz::from_degrees(pan_deg, tilt_deg, focal_px);
        let warning = prior.warning(&ptz, &PtzStep::ZERO);
        assert_eq!(
            warning.is_some(),
            prior.surprise(&ptz, &PtzStep::ZERO) > 0.0
        );
        warning.map(|warning| warning.message)
    }

    #[test]
    fn a_jump_is_reported_with_the_frame_it_differs_from() {
        let prior = prior();
        assert_eq!(said(&prior, 11.1, -10.1, 2040.0), None);
        let jump = said(&prior, 16.2, -10.0, 2000.0).unwrap();
        assert_eq!(
            jump,
            "Pan differs by 6.2° from the next frame. A cut, or a wrong name?"
        );
        let zoom = said(&prior, 10.0, -10.0, 3000.0).unwrap();
        assert!(
            zoom.starts_with("The focal length differs by 50 % from the next frame"),
            "{zoom}"
        );
    }

    #[test]
    fn far_outside_of_the_accepted_frames_is_out_of_the_usual() {
        let prior = MotionPrior {
            motion: None,
            ..prior()
        };
        assert_eq!(
            said(&prior, 40.0, -10.0, 2000.0),
            None,
            "half of the span beyond is still usual"
        );
        let far = said(&prior, 80.0, -10.0, 2000.0).unwrap();
        assert!(
            far.starts_with("Unusual camera: pan 80.0°, accepted frames have -30.0° to 20.0°"),
            "{far}"
        );
        assert!(said(&prior, 0.0, -30.0, 2000.0).unwrap().contains("tilt"));
        assert!(
            said(&prior, 0.0, -10.0, 9000.0)
                .unwrap()
                .contains("focal length")
        );
        assert_eq!(
            said(&MotionPrior::default(), 170.0, -80.0, 99_999.0),
            None,
            "nothing is known"
        );
    }

    #[test]
    fn what_clicks_leave_open_is_no_jump() {
        let ptz = Ptz::from_degrees(13.0, -10.0, 2000.0);
        let slack = PtzStep {
            pan: Angle::from_degrees(2.5),
            ..PtzStep::ZERO
        };
        assert!(prior().warning(&ptz, &PtzStep::ZERO).is_some());
        assert!(prior().warning(&ptz, &slack).is_none());
    }
}
