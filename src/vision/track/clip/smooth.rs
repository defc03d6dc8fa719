//! Smoothing: the cameras of a clip as one motion, by a fixed-interval Kalman smoother (Rauch,
//! Tung, Striebel: "Maximum likelihood estimates of linear dynamic systems", AIAA J. 3, 1965).
//!
//! Pan, tilt and the logarithm of the focal length follow a constant-velocity model each: the rate
//! performs a random walk. The variance of that walk and the scale of the measurement noise are
//! those of maximum likelihood for the clip.

use super::super::pose_problem::{apply_offset, by_log_focal, offset};
use nalgebra::{Matrix6, Vector6};
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Mat3, Vec3};

/// Options of [`smooth()`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothOptions {
    /// A frame that a person accepted moves by at most this many of its 1-σ. Default: 1.
    pub reference_sigmas: f64,
}

impl Default for SmoothOptions {
    fn default() -> Self {
        Self {
            reference_sigmas: 1.0,
        }
    }
}

/// A frame before smoothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnsmoothedFrame {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px).
    pub covariance: Mat3,
    /// Whether a person accepted it.
    pub is_reference: bool,
}

/// Smooths consecutive frames; returns one camera per frame. Fewer than five frames are returned
/// unchanged.
pub fn smooth(frames: &[UnsmoothedFrame], options: &SmoothOptions) -> Vec<Ptz> {
    let Some(first) = frames.first().map(|frame| frame.ptz) else {
        return Vec::new();
    };
    if frames.len() < MIN_FRAMES {
        return frames.iter().map(|frame| frame.ptz).collect();
    }
    // Accumulate (pan rad, tilt rad, ln f) from frame to frame, relative to the first: pan then
    // does not wrap if the camera rotates by more than half a circle.
    let steps = frames.windows(2).map(|two| offset(two[0].ptz, two[1].ptz));
    let seen: Vec<Vec3> = std::iter::once(Vec3::zeros())
        .chain(steps.scan(Vec3::zeros(), |at, step| {
            *at += step;
            Some(*at)
        }))
        .collect();
    let scatter: Vec<Mat3> = frames
        .iter()
        .map(|frame| by_log_focal(&frame.covariance, frame.ptz.focal_px))
        .collect();
    // Noise parameters per axis by maximum likelihood, correlations between the axes ignored: in
    // one dimension the filter is a few products, and the search runs it a few hundred times.
    let axes = [0, 1, 2].map(|axis| {
        let values: Vec<f64> = seen.iter().map(|at| at[axis]).collect();
        let variances: Vec<f64> = scatter
            .iter()
            .map(|scatter| scatter[(axis, axis)])
            .collect();
        Motion::likeliest(&values, &variances)
    });
    // Smooth the three axes together. A reference that moves too far has its measurement covariance
    // divided by ten, and the smoother runs again.
    let share = Mat3::from_diagonal(&Vec3::from(axes.map(|axis| axis.scatter.sqrt())));
    let unrest = Vec3::from(axes.map(|axis| axis.unrest));
    let mut weights = vec![1.0; frames.len()];
    let mut smoothed = Vec::new();
    for _ in 0..TRIES {
        let measured: Vec<Mat3> = scatter
            .iter()
            .zip(&weights)
            .map(|(scatter, weight)| share * scatter * share * *weight)
            .collect();
        smoothed = smoothed_offsets(&seen, &measured, &unrest);
        let mut moved_too_far = false;
        for place in (0..frames.len()).filter(|&place| frames[place].is_reference) {
            // Mahalanobis distance in the stated covariance, not in the one that the fit has
            // scaled. A reference of singular covariance is not checked.
            let by = smoothed[place] - seen[place];
            let sigmas = scatter[place]
                .try_inverse()
                .map_or(0.0, |inverse| by.dot(&(inverse * by)).sqrt());
            if sigmas > options.reference_sigmas {
                weights[place] *= 0.1;
                moved_too_far = true;
            }
        }
        if !moved_too_far {
            break;
        }
    }
    smoothed
        .into_iter()
        .map(|by| apply_offset(first, by))
        .collect()
}

/// Minimum number of frames to smooth.
const MIN_FRAMES: usize = 5;

/// Maximum number of runs in which references gain weight.
const TRIES: usize = 8;

/// Lower bound of both parameters of the search, which are logarithms.
const LEAST_LOG: f64 = -15.0;

/// The noise model of one axis.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Variance of the change of the rate from one frame to the next.
    unrest: f64,
    /// Measurement variance as a multiple of the stated variance.
    scatter: f64,
}

impl Motion {
    /// The parameters of maximum likelihood.
    ///
    /// A grid over both logarithms, then a pattern search whose step halves from 0.75 to 0.05: the
    /// likelihood has plateaus, and the filter has no simple derivative.
    fn likeliest(values: &[f64], variances: &[f64]) -> Self {
        // The unrest is searched relative to the variance of a measurement, so that the grid serves
        // clips of every precision: from e⁻¹⁵ to e⁹ of it, and the scatter from e⁻¹⁰ to e³.
        let typical = variances.iter().sum::<f64>() / variances.len() as f64;
        let mut best = ([0.0, 0.0], f64::INFINITY);
        for unrest in -10..=6 {
            for scatter in -10..=3 {
                let log = [1.5 * f64::from(unrest), f64::from(scatter)];
                let value = Self::from_logs(log, typical).surprise(values, variances);
                if value < best.1 {
                    best = (log, value);
                }
            }
        }
        let mut step = 0.75;
        while step > 0.05 {
            let around = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
            // The likelihood of a clip without any scatter has no maximum: it rises as the
            // parameters go to zero. The lower bound ends the search.
            let tried = around.map(|by| {
                let log = [0, 1].map(|at| (best.0[at] + by[at]).max(LEAST_LOG));
                let value = Self::from_logs(log, typical).surprise(values, variances);
                (log, value)
            });
            match tried
                .into_iter()
                .filter(|(_, value)| *value < best.1)
                .min_by(|a, b| a.1.total_cmp(&b.1))
            {
                Some(better) => best = better,
                None => step *= 0.5,
            }
        }
        Self::from_logs(best.0, typical)
    }

    /// The model with given logarithms of both parameters; that of the unrest is relative to
    /// `typical_variance`.
    fn from_logs([unrest, scatter]: [f64; 2], typical_variance: f64) -> Self {
        Self {
            unrest: typical_variance * unrest.exp(),
            scatter: scatter.exp(),
        }
    }

    /// −2 ln L up to a constant, by the innovations of a Kalman filter (prediction error
    /// decomposition; Schweppe: "Evaluation of likelihood functions for Gaussian signals", IEEE
    /// Trans. Information Theory 11, 1965): Σ ln Sₖ + eₖ²/Sₖ.
    fn surprise(self, values: &[f64], variances: &[f64]) -> f64 {
        // Mean squared step: how fast the camera moves, without regard to the direction.
        let speed = values
            .windows(2)
            .map(|two| (two[1] - two[0]).powi(2))
            .sum::<f64>()
            / values.len() as f64;
        let (mut at, mut moves) = (values[0], 0.0);
        // Filter covariance [[place, both], [both, pace]] of (position, rate). The rate is
        // initially almost unknown: ten mean squared steps. The first measurement starts the
        // filter, with the variance that the model gives every measurement, and is no innovation.
        let mut place = self.scatter * variances[0];
        let (mut both, mut pace) = (0.0, 10.0 * speed + self.unrest);
        let mut surprise = 0.0;
        for (value, variance) in values.iter().zip(variances).skip(1) {
            // Prediction P ← F P Fᵀ + Q with F = [[1, 1], [0, 1]] and Q = q [[1/3, 1/2], [1/2, 1]],
            // the rate being a Wiener process sampled once per frame (q is `unrest`).
            at += moves;
            place += 2.0 * both + pace + self.unrest / 3.0;
            both += pace + self.unrest / 2.0;
            pace += self.unrest;
            // Innovation `off` and its variance, then the Kalman update. The order of the last
            // three lines matters: each uses values from before the update.
            let spread = place + self.scatter * variance;
            let off = value - at;
            surprise += spread.ln() + off * off / spread;
            let (gain, pace_gain) = (place / spread, both / spread);
            at += gain * off;
            moves += pace_gain * off;
            pace -= pace_gain * both;
            both -= gain * both;
            place -= gain * place;
        }
        surprise
    }
}

/// The Rauch–Tung–Striebel smoother over (pan, tilt, ln f) and their rates: smoothed positions,
/// given measurements `seen`, their covariances `scatter`, and the variances `unrest` of the change
/// of the rates per frame.
pub(super) fn smoothed_offsets(seen: &[Vec3], scatter: &[Mat3], unrest: &Vec3) -> Vec<Vec3> {
    // Constant-velocity model, F = [[I, I], [0, I]], with the process noise of rates that are
    // Wiener processes sampled once per frame.
    let mut turn = Matrix6::identity();
    turn.fixed_view_mut::<3, 3>(0, 3)
        .copy_from(&Mat3::identity());
    let mut noise = Matrix6::zeros();
    for axis in 0..3 {
        noise[(axis, axis)] = unrest[axis] / 3.0;
        noise[(axis, axis + 3)] = unrest[axis] / 2.0;
        noise[(axis + 3, axis)] = unrest[axis] / 2.0;
        noise[(axis + 3, axis + 3)] = unrest[axis];
    }
    // A weak start: a hundred times the covariance of the first measurement, and rates of ten times
    // the root mean squared step.
    let mut state = Vector6::zeros();
    state.fixed_rows_mut::<3>(0).copy_from(&seen[0]);
    let mut covariance = Matrix6::zeros();
    covariance
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(scatter[0] * 100.0));
    for axis in 0..3 {
        let speed = seen
            .windows(2)
            .map(|two| (two[1] - two[0])[axis].powi(2))
            .sum::<f64>()
            / seen.len() as f64;
        covariance[(axis + 3, axis + 3)] = 100.0 * (speed + unrest[axis]);
    }
    // Forward pass. For each frame, state and covariance before and after its measurement.
    let mut passes: Vec<[(Vector6<f64>, Matrix6<f64>); 2]> = Vec::with_capacity(seen.len());
    for (place, value) in seen.iter().enumerate() {
        if place > 0 {
            state = turn * state;
            covariance = turn * covariance * turn.transpose() + noise;
        }
        // A measurement without an invertible covariance is passed over: the prediction stays.
        let before = (state, covariance);
        let spread: Mat3 = covariance.fixed_view::<3, 3>(0, 0) + scatter[place];
        if let Some(inverse) = spread.try_inverse() {
            let gain = covariance.fixed_columns::<3>(0) * inverse;
            state += gain * (value - state.fixed_rows::<3>(0));
            covariance -= gain * covariance.fixed_rows::<3>(0).into_owned();
        }
        passes.push([before, (state, covariance)]);
    }
    // Backward pass: C = P Fᵀ P⁻ₖ₊₁⁻¹ and x ← xₖ + C (xₖ₊₁ − x⁻ₖ₊₁). The smoothed covariances are
    // not needed and not computed. The last frame has its filtered state already.
    let mut smoothed = vec![state.fixed_rows::<3>(0).into_owned(); seen.len()];
    for place in (0..seen.len() - 1).rev() {
        let (own, own_covariance) = passes[place][1];
        let (predicted, predicted_covariance) = passes[place + 1][0];
        let gain = predicted_covariance
            .try_inverse()
            .map(|inverse| own_covariance * turn.transpose() * inverse);
        state = gain.map_or(own, |gain| own + gain * (state - predicted));
        smoothed[place] = state.fixed_rows::<3>(0).into_owned();
    }
    smoothed
}

/// Root mean square of the second differences of consecutive cameras.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Jitter {
    /// Of the pan, degrees.
    pub pan_deg: f64,
    /// Of the tilt, degrees.
    pub tilt_deg: f64,
    /// Of the focal length, px.
    pub focal_px: f64,
    /// Of the image position of the scene at the picture's centre, px.
    pub centre_px: f64,
}

impl Jitter {
    /// Of cameras in frame order. A missing frame interrupts the sequence; `None` without three
    /// consecutive cameras.
    pub fn measure(cameras: &[Option<Ptz>]) -> Option<Self> {
        let (mut squares, mut count) = ([0.0; 4], 0.0);
        for three in cameras.windows(3) {
            let [Some(a), Some(b), Some(c)] = three else {
                continue;
            };
            // Second differences. At the picture's centre a pan moves the image by f cos(tilt) per
            // radian, a tilt by f.
            let pan = (c.pan.turn_from(b.pan) - b.pan.turn_from(a.pan)).degrees();
            let tilt = (c.tilt - b.tilt - (b.tilt - a.tilt)).degrees();
            let focal = c.focal_px - 2.0 * b.focal_px + a.focal_px;
            let centre =
                b.focal_px * (pan.to_radians() * b.tilt.radians().cos()).hypot(tilt.to_radians());
            // A steady turn has no second difference; what is left is noise and acceleration.
            for (sum, value) in squares.iter_mut().zip([pan, tilt, focal, centre]) {
                *sum += value * value;
            }
            count += 1.0;
        }
        // Without three consecutive cameras this is 0/0; the result below is then `None`.
        let [pan_deg, tilt_deg, focal_px, centre_px] = squares.map(|sum: f64| (sum / count).sqrt());
        (count > 0.0).then_some(Self {
            pan_deg,
            tilt_deg,
            focal_px,
            centre_px,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::clip::Jitter;

    /// A camera that rests, pans and rests again, off by a pattern that repeats nowhere.
    fn frames(off_deg: f64) -> (Vec<Ptz>, Vec<UnsmoothedFrame>) {
        let pan = |at: usize| 8.0 / (1.0 + (-(at as f64 - 60.0) / 8.0).exp());
        let truth: Vec<Ptz> = (0..120)
            .map(|at| Ptz::from_degrees(pan(at), -11.0, 2500.0))
            .collect();
        let seen: Vec<_> = truth
            .iter()
            .enumerate()
            .map(|(at, ptz)| {
                let noise = off_deg * (1.3 * ((at * at * 31 + at * 17) % 1009) as f64).sin();
                let sigma = off_deg.to_radians();
                let covariance = Mat3::from_diagonal(&Vec3::new(sigma * sigma, sigma * sigma, 1.0));
                let ptz = Ptz::from_degrees(
                    ptz.pan.degrees() + noise,
                    ptz.tilt.degrees() - 0.7 * noise,
                    ptz.focal_px,
                );
                UnsmoothedFrame {
                    ptz,
                    covariance,
                    is_reference: at == 60,
                }
            })
            .collect();
        (truth, seen)
    }

    #[test]
    fn a_jittering_clip_becomes_smooth_and_comes_nearer_to_the_truth() {
        let (truth, seen) = frames(0.01);
        let smoothed = smooth(&seen, &SmoothOptions::default());
        let some = |all: &[Ptz]| all.iter().copied().map(Some).collect::<Vec<_>>();
        let raw: Vec<Ptz> = seen.iter().map(|frame| frame.ptz).collect();
        let [before, after, exact] =
            [&raw, &smoothed, &truth].map(|all| Jitter::measure(&some(all)).unwrap().pan_deg);
        assert!(
            after < 0.4 * before && after < exact + 0.1 * before,
            "{before} {after} {exact}"
        );
        let off = |all: &[Ptz]| {
            let squares = all
                .iter()
                .zip(&truth)
                .map(|(a, b)| (a.pan - b.pan).degrees().powi(2));
            (squares.sum::<f64>() / truth.len() as f64).sqrt()
        };
        assert!(
            off(&smoothed) < 0.7 * off(&raw),
            "{} {}",
            off(&raw),
            off(&smoothed)
        );
    }

    #[test]
    fn a_scatter_is_as_likely_as_variances_that_are_as_many_times_larger() {
        let values = [0.0, 1.0, 1.5, 3.0, 3.5];
        let stated = [2.0, 1.0, 0.5, 1.0, 1.0];
        let scaled = stated.map(|variance| 4.0 * variance);
        let [one, other] = [(4.0, stated), (1.0, scaled)].map(|(scatter, variances)| {
            let unrest = 0.1;
            Motion { unrest, scatter }.surprise(&values, &variances)
        });
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }

    #[test]
    fn a_reference_stays_within_its_sigma() {
        let (_, mut seen) = frames(0.01);
        seen[60].ptz.pan = seen[60].ptz.pan + touchline_core::geometry::Angle::from_degrees(0.2);
        seen[60].covariance *= 0.01;
        let smoothed = smooth(&seen, &SmoothOptions::default());
        let off = (smoothed[60].pan - seen[60].ptz.pan).degrees().abs();
        assert!(off <= 0.001 * 1.001, "{off}");
    }

    #[test]
    fn a_few_frames_stay_as_they_are() {
        let (_, seen) = frames(0.01);
        let few = smooth(&seen[..3], &SmoothOptions::default());
        assert!(
            few.iter()
                .zip(&seen)
                .all(|(smooth, seen)| *smooth == seen.ptz)
        );
        assert!(smooth(&[], &SmoothOptions::default()).is_empty());
    }

    #[test]
    fn an_even_motion_has_none_and_a_jerk_is_measured() {
        let even: Vec<_> = (0..9)
            .map(|at| Some(Ptz::from_degrees(0.1 * f64::from(at), -10.0, 2000.0)))
            .collect();
        let none = Jitter::measure(&even).unwrap();
        assert!(none.pan_deg < 1e-12 && none.centre_px < 1e-9, "{none:?}");
        let mut jerk = even.clone();
        jerk[4] = Some(Ptz::from_degrees(0.5, -10.0, 2000.0));
        let jerk = Jitter::measure(&jerk).unwrap();
        // 0.1 − 2 · 0.1 + 0.1: second differences of 0.1, −0.2 and 0.1 among seven.
        assert!(
            (jerk.pan_deg - (0.06_f64 / 7.0).sqrt()).abs() < 1e-9,
            "{jerk:?}"
        );
        assert!(
            (jerk.centre_px / jerk.pan_deg - 2000.0 * 1f64.to_radians() * 10f64.to_radians().cos())
                .abs()
                < 1e-6
        );
        let mut gap = even;
        gap[2] = None;
        assert!(Jitter::measure(&gap[..5]).is_none() && Jitter::measure(&gap).is_some());
    }
}
