//! Relative rotations of the frames at any focal scale.
//!
//! Matches determine the rotations well once the focal scale is given, but the scale itself badly.
//! So rotations are adjusted at several scales and interpolated between them. The residuals at
//! these scales also say how well the matches determine the scale.

use touchline_core::camera::{FocalCurve, Ptz};
use touchline_core::geometry::{Mat3, Vec3};
use touchline_vision::track::RelativeRotations;

/// The matches determine the focal scale as this many independent ones would. There are many more,
/// but they share errors: many lie on one player, or err together because the lens deviates from
/// its model.
const INDEPENDENT_MATCHES: f64 = 200.0;

/// Bounds of the 1-σ of the log focal scale from matches.
const SIGMA: [f64; 2] = [0.003, 0.1];

/// The rotations of the frames at several focal scales.
pub struct RotationsByFocalScale {
    /// Pairs of log focal scale and rotations, by ascending scale.
    levels: Vec<(f64, RelativeRotations)>,
}

/// An estimate of the log focal scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocalScale {
    pub log_scale: f64,
    /// 1-σ.
    pub sigma: f64,
}

impl FocalScale {
    /// An estimate that says hardly anything.
    pub fn unknown(log_scale: f64) -> Self {
        Self {
            log_scale,
            sigma: SIGMA[1],
        }
    }
}

impl RotationsByFocalScale {
    /// From rotations and their focal scales, in per cent of the scale that fits the matches best.
    pub fn new(levels: impl IntoIterator<Item = (u32, RelativeRotations)>) -> Self {
        let mut levels: Vec<(f64, RelativeRotations)> = levels
            .into_iter()
            .map(|(percent, rotations)| ((f64::from(percent) / 100.0).ln(), rotations))
            .collect();
        levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { levels }
    }

    /// The rotations at a log focal scale, which is clamped to the range that was adjusted. None if
    /// nothing was.
    pub fn at(&self, log_scale: f64) -> Option<RelativeRotations> {
        let (first, last) = (self.levels.first()?, self.levels.last()?);
        let log_scale = log_scale.clamp(first.0, last.0);
        let above = self.levels.iter().position(|level| level.0 >= log_scale)?;
        let (to, to_rotations) = &self.levels[above];
        let Some((from, from_rotations)) = above.checked_sub(1).map(|below| &self.levels[below])
        else {
            return Some(to_rotations.clone());
        };
        let share = (log_scale - from) / (to - from);
        Some(interpolate_rotations(from_rotations, to_rotations, share))
    }

    /// The focal scale that fits the matches best, with its 1-σ; unknown with fewer than three
    /// levels.
    ///
    /// With N independent matches the squared residual r² of the adjustment at log scale s, and its
    /// smallest value r₀², give χ²(s) = N (r(s)² / r₀² − 1). A parabola a + b s + c s² through the
    /// three levels around the best has its minimum at −b / 2c, and χ² rises by 1 at a distance of
    /// 1/√c from it, which is the 1-σ.
    pub fn focal_scale_from_matches(&self) -> FocalScale {
        let [least, most] = SIGMA;
        let unknown = FocalScale::unknown(0.0);
        let best = (0..self.levels.len()).min_by(|a, b| {
            let [a, b] = [a, b].map(|level| self.levels[*level].1.residual_px);
            a.total_cmp(&b)
        });
        let Some(best) = best.filter(|_| self.levels.len() >= 3) else {
            return unknown;
        };
        let begin = best.saturating_sub(1).min(self.levels.len() - 3);
        let best_px = self.levels[best].1.residual_px;
        // The parabola by its Vandermonde matrix; s is the log scale. Without a positive curvature
        // the matches say nothing.
        let three = &self.levels[begin..begin + 3];
        let powers = Mat3::from_fn(|row, column| three[row].0.powi(column as i32));
        let chi = Vec3::from_fn(|row, _| {
            INDEPENDENT_MATCHES * ((three[row].1.residual_px / best_px).powi(2) - 1.0)
        });
        let Some(parabola) = powers
            .try_inverse()
            .map(|inverse| inverse * chi)
            .filter(|by| by[2] > 0.0)
        else {
            return unknown;
        };
        // Never beyond the three levels: a minimum outside of them is extrapolated.
        let lowest = (-0.5 * parabola[1] / parabola[2]).clamp(three[0].0, three[2].0);
        FocalScale {
            log_scale: lowest,
            sigma: parabola[2].sqrt().recip().clamp(least, most),
        }
    }
}

/// Rotations between those at two focal scales, at a share of the way from the one to the other.
///
/// Between two scales everything is linear in the log scale; focal lengths are interpolated as
/// logarithms, pans the short way round.
fn interpolate_rotations(
    from: &RelativeRotations,
    to: &RelativeRotations,
    share: f64,
) -> RelativeRotations {
    let ptz = from
        .ptz
        .iter()
        .zip(&to.ptz)
        .map(|(from, to)| {
            Ptz::new(
                from.pan + (to.pan - from.pan).wrap() * share,
                from.tilt + (to.tilt - from.tilt) * share,
                interpolate(from.focal_px.ln(), to.focal_px.ln(), share).exp(),
            )
        })
        .collect();
    let lens = FocalCurve {
        value: interpolate(from.lens.value, to.lens.value, share),
        per_1000_px: interpolate(from.lens.per_1000_px, to.lens.per_1000_px, share),
        ..from.lens
    };
    RelativeRotations {
        ptz,
        lens,
        principal_point: from.principal_point,
        residual_px: interpolate(from.residual_px, to.residual_px, share),
    }
}

/// The number at a share of the way from one to another.
fn interpolate(from: f64, to: f64, share: f64) -> f64 {
    from + share * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    /// The rotations of two frames at a focal scale: the longer the lens, the smaller the angles.
    fn rotations(percent: u32, residual_px: f64) -> (u32, RelativeRotations) {
        let scale = f64::from(percent) / 100.0;
        let ptz = |pan_deg: f64| Ptz::from_degrees(pan_deg / scale, -9.0, 1000.0 * scale);
        let lens = FocalCurve {
            value: scale,
            ..FocalCurve::NONE
        };
        (
            percent,
            RelativeRotations {
                ptz: vec![ptz(-20.0), ptz(20.0)],
                lens,
                principal_point: ImageSize::new(1280, 720).centre(),
                residual_px,
            },
        )
    }

    #[test]
    fn between_two_scales_everything_is_between() {
        let levels = RotationsByFocalScale::new([
            rotations(100, 0.3),
            rotations(110, 0.4),
            rotations(90, 0.5),
        ]);
        let between = levels
            .at(f64::midpoint(1.0_f64.ln(), 1.1_f64.ln()))
            .unwrap();
        assert!((between.ptz[0].focal_px - 1000.0 * 1.1_f64.sqrt()).abs() < 1e-9);
        assert!((between.ptz[1].pan.degrees() - f64::midpoint(20.0, 20.0 / 1.1)).abs() < 1e-9);
        assert!((between.lens.value - 1.05).abs() < 1e-12);
        let there = levels.at(0.0).unwrap();
        assert!(
            (there.ptz[0].focal_px - 1000.0).abs() < 1e-9
                && (there.residual_px - 0.3).abs() < 1e-12,
            "{there:?}"
        );
        assert_eq!(
            levels.at(-3.0).unwrap(),
            rotations(90, 0.5).1,
            "no farther than what was adjusted"
        );
        assert!(RotationsByFocalScale::new([]).at(0.0).is_none());
    }

    #[test]
    fn the_scale_lies_where_the_edges_fit_best_and_is_the_surer_the_worse_they_fit_beside_it() {
        // Squared residuals with their minimum at a scale of 1.02.
        let fitting = |steepness: f64| {
            let residual_px = |percent: u32| {
                let off = (f64::from(percent) / 100.0).ln() - 1.02_f64.ln();
                (0.09 + steepness * off * off).sqrt()
            };
            RotationsByFocalScale::new(
                [88, 94, 100, 106, 113].map(|percent| rotations(percent, residual_px(percent))),
            )
            .focal_scale_from_matches()
        };
        let (sure, doubtful) = (fitting(100.0), fitting(1.0));
        assert!((sure.log_scale - 1.02_f64.ln()).abs() < 1e-6, "{sure:?}");
        assert!(
            (doubtful.log_scale - 1.02_f64.ln()).abs() < 1e-6,
            "{doubtful:?}"
        );
        assert!(
            sure.sigma < doubtful.sigma && doubtful.sigma <= SIGMA[1],
            "{sure:?}, {doubtful:?}"
        );
        let flat =
            RotationsByFocalScale::new([94, 100, 106].map(|percent| rotations(percent, 0.3)))
                .focal_scale_from_matches();
        assert_eq!(flat, FocalScale::unknown(0.0));
        let two = RotationsByFocalScale::new([rotations(100, 0.3), rotations(106, 0.5)])
            .focal_scale_from_matches();
        assert_eq!(two.sigma, SIGMA[1], "two scales say nothing");
    }
}
