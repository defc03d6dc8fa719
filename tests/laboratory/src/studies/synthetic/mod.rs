//! Pan, tilt and focal length from noisy rays: figures (b), (c) and (d) of the paper, in its
//! setting.
//!
//! | figure | noise of | file |
//! |---|---|---|
//! | (b) | pixels, with the paper's eq. 2 and with the exact projection | `pixel_noise.rs` |
//! | (c), (d) | the base's position, its rotation | `wrong_base.rs` |
//!
//! The paper plots the errors of its two-point method. The estimators, and the Cramér–Rao bound,
//! which no unbiased estimate can beat, are in `methods.rs`.

mod collected;
mod methods;
mod pixel_noise;
mod wrong_base;

use crate::ExperimentOptions;
use crate::progress::{Progress, step_counter};
use crate::report::Report;
use crate::report::statistics::range_of;
use crate::setting::{Correspondence, OUTSIDE, RAYS, SIZE, base, correspondences, random_ptz, rng};
use collected::{Collected, Errors};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use touchline::camera::{Ptz, PtzCamera};

/// Runs the experiment.
pub fn run(options: &ExperimentOptions, progress: Progress) -> Report {
    let (cameras, trials) = (
        options.full_or_quick(100, 12),
        options.full_or_quick(100, 12),
    );
    // Both figures' files take the same number of cameras at each of their noise levels.
    let step = step_counter(cameras * (pixel_noise::STEPS + wrong_base::STEPS), progress);
    let setting = Setting {
        seed: options.seed,
        cameras,
        trials,
        step: &step,
    };

    let mut report = Report::new(
        "synthetic",
        "Synthetic: pan, tilt and focal length from noisy rays",
    );
    report.text(&setting.describe());
    pixel_noise::add(&setting, &mut report);
    wrong_base::add(&setting, &mut report);
    report
}

/// The parameters that all three figures share.
struct Setting<'a> {
    seed: u64,
    cameras: usize,
    trials: usize,
    step: &'a (dyn Fn() + Sync),
}

impl Setting<'_> {
    /// A random camera and its points, the same for all noise levels.
    fn camera(&self, index: usize) -> (PtzCamera, Vec<Correspondence>) {
        // Made again wherever it is needed, from the same place of the generator: the same camera
        // at every noise level, without all of them in memory.
        let mut rng = rng(self.seed, [1, index as u64]);
        let camera = PtzCamera::new(base(), random_ptz(&mut rng));
        let seen = correspondences(&camera, &mut rng);
        (camera, seen)
    }

    /// The setting for readers, with the ranges and the share of outside points that the cameras
    /// really have.
    fn describe(&self) -> String {
        let drawn: Vec<(PtzCamera, Vec<Correspondence>)> =
            (0..self.cameras).map(|index| self.camera(index)).collect();
        let parameters: [fn(&Ptz) -> f64; 3] = [
            |ptz| ptz.pan.degrees(),
            |ptz| ptz.tilt.degrees(),
            |ptz| ptz.focal_px,
        ];
        let [pan, tilt, focal] =
            parameters.map(|of| range_of(drawn.iter().map(|(camera, _)| of(&camera.ptz()))));
        let outside = drawn
            .iter()
            .flat_map(|(_, seen)| seen)
            .filter(|correspondence| !correspondence.on_field)
            .count();
        format!(
            "The paper's setting: the base of its published sequence, {} × {} px, {RAYS} rays a \
             picture. {} cameras (pan {:.0} to {:.0}°, tilt {:.0} to {:.0}°, focal length {:.0} \
             to {:.0} px), {} trials each, one seed. {:.0} % of the rays end outside the field; \
             the paper has {:.0} %, for which these pictures have no room.",
            SIZE.width,
            SIZE.height,
            self.cameras,
            pan[0],
            pan[1],
            tilt[0],
            tilt[1],
            focal[0],
            focal[1],
            self.trials,
            100.0 * outside as f64 / (self.cameras * RAYS) as f64,
            100.0 * OUTSIDE
        )
    }

    /// Runs all trials of all cameras at one noise level. `trial` returns the errors of each
    /// method; `place` seeds the noise.
    fn collect<const N: usize>(
        &self,
        place: u64,
        trial: impl Fn(&PtzCamera, &[Correspondence], &mut Pcg64Mcg) -> [Option<Errors>; N] + Sync,
    ) -> [Collected; N] {
        let of_camera = |index: usize| {
            let (camera, seen) = self.camera(index);
            let mut rng = rng(self.seed, [place, index as u64]);
            let trials: Vec<[Option<Errors>; N]> = (0..self.trials)
                .map(|_| trial(&camera, &seen, &mut rng))
                .collect();
            (self.step)();
            trials
        };
        // In parallel over the cameras. Each has a generator of its own, so that the order of
        // threads does not matter.
        let by_camera: Vec<Vec<[Option<Errors>; N]>> =
            (0..self.cameras).into_par_iter().map(of_camera).collect();
        let mut collected: [Collected; N] = std::array::from_fn(|_| Collected::default());
        for (camera, trials) in by_camera.into_iter().enumerate() {
            for (method, collected) in collected.iter_mut().enumerate() {
                let of_method: Vec<Option<Errors>> =
                    trials.iter().map(|trial| trial[method]).collect();
                collected.add_camera(camera, &of_method);
            }
        }
        collected
    }
}
