//! Errors of many trials with many cameras.

use crate::report::statistics::mean_sd;
use touchline::camera::{AngularDistance, PtzCamera};
use touchline::report::{Cell, Table};
use touchline::score::camera_error;

/// The errors of one estimate.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Angle between the rotations from world to camera: the error that the picture shows.
    pub rotation_deg: f64,
    /// Errors of pan and tilt as numbers, with any base: the length of both, with the error of pan
    /// multiplied by the cosine of the tilt.
    pub pan_tilt_deg: f64,
    pub focal_px: f64,
}

impl Errors {
    pub fn between(truth: &PtzCamera, estimate: &PtzCamera) -> Self {
        let error = camera_error(truth, estimate);
        Self {
            rotation_deg: error.rotation.degrees(),
            pan_tilt_deg: AngularDistance::between(&truth.ptz(), &estimate.ptz())
                .turn
                .degrees(),
            focal_px: error.focal_px.abs(),
        }
    }
}

/// Errors of one method, over several cameras.
#[derive(Clone, Debug, Default)]
pub struct Collected {
    /// For each camera, its index and the mean errors of its trials.
    pub by_camera: Vec<(usize, Errors)>,
    /// Number of trials without a result.
    pub failed: usize,
}

impl Collected {
    pub fn add_camera(&mut self, camera: usize, trials: &[Option<Errors>]) {
        // The mean over the trials of one camera; cameras are the repetitions of intervals and
        // error bars, because trials of one camera are not independent of its view.
        let found: Vec<Errors> = trials.iter().flatten().copied().collect();
        self.failed += trials.len() - found.len();
        if !found.is_empty() {
            let mean =
                |of: fn(&Errors) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
            let errors = Errors {
                rotation_deg: mean(|e| e.rotation_deg),
                pan_tilt_deg: mean(|e| e.pan_tilt_deg),
                focal_px: mean(|e| e.focal_px),
            };
            self.by_camera.push((camera, errors));
        }
    }

    /// Mean and standard deviation over the cameras.
    pub fn mean_sd(&self, of: fn(&Errors) -> f64) -> [f64; 2] {
        let errors: Vec<f64> = self
            .by_camera
            .iter()
            .map(|(_, errors)| of(errors))
            .collect();
        mean_sd(&errors)
    }

    /// The mean minus and plus one standard deviation over the cameras. Errors are positive and
    /// skewed, so that the low end may be below 0, which a logarithmic axis draws as an open end.
    pub fn bar(&self, of: fn(&Errors) -> f64) -> [f64; 2] {
        let [mean, sd] = self.mean_sd(of);
        [mean - sd, mean + sd]
    }
}

/// A table with a row for each camera, noise and method: the means over the trials, with six
/// digits, as the file is kept with the program.
pub fn camera_table<'a, const N: usize>(
    noise: &str,
    methods: [&str; N],
    by_noise: impl IntoIterator<Item = (f64, &'a [Collected; N])>,
) -> Table {
    let mut table = Table::new(&[
        ("sigma", noise),
        ("method", "method"),
        ("camera", "camera"),
        ("rotation_deg", "rotation error (°)"),
        ("pan_tilt_deg", "pan and tilt (°)"),
        ("focal_px", "focal length error (px)"),
    ]);
    for (sigma, collected) in by_noise {
        for (method, collected) in methods.iter().zip(collected) {
            for (camera, errors) in &collected.by_camera {
                let numbers = [errors.rotation_deg, errors.pan_tilt_deg, errors.focal_px];
                let mut row = vec![sigma.into(), (*method).into(), (*camera).into()];
                row.extend(numbers.map(|number| Cell::Number(six_digits(number))));
                table.push(row);
            }
        }
    }
    table
}

/// Rounds to six significant digits.
fn six_digits(number: f64) -> f64 {
    // Rust writes and reads every float, infinite ones and NaN included, so that the fallback is
    // never taken.
    format!("{number:.5e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_six_digits() {
        for (number, rounded) in [
            (0.001_234_567_89, 0.001_234_57),
            (-123_456.7, -123_457.0),
            (0.0, 0.0),
            (f64::INFINITY, f64::INFINITY),
        ] {
            assert_eq!(six_digits(number), rounded);
        }
        assert!(six_digits(f64::NAN).is_nan());
    }
}
