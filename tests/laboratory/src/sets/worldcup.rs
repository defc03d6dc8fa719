//! Synthetic games in the setting of the paper's World Cup data (table 3).
//!
//! The paper states the games and their numbers of frames, not their cameras. These come from
//! published homographies of the World Cup 2014, the paper's own source. One of the paper's two
//! games is among them; the other's place is taken by a third game.

use super::drawn::{Order, Players, picture_size, take};
use super::highlights::{broadcast, scene_seed};
use super::{FrameSet, SetKind, Split};
use crate::report::paper::TABLE_3;
use crate::report::statistics::range_of;
use crate::setting::SIZE;
use crate::{ExperimentError, ExperimentOptions};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::synthetic::{
    CameraMotion, Moment, PathStep, Preset, ShootOptions, StadiumOptions, camera_path, stadium,
};

/// Time between the frames of a game, s.
const STEP_S: f64 = 7.0;
/// Number of consecutive frames with the same boards, and the shares of boards and spectators that
/// then change.
const BOARDS_EVERY: usize = 8;
const CHANGED_BOARDS: f64 = 0.25;
const CHANGED_PEOPLE: f64 = 0.1;

/// The main camera of a real game, which stands still, and the ranges of its frames.
#[derive(Clone, Copy, Debug)]
struct RealCamera {
    /// Its name in the description of the set.
    name: &'static str,
    /// Its position from the centre mark: along the field, across, up, m. Its pan axis is upright.
    position_m: [f64; 3],
    /// The least and the greatest pan and tilt, degrees.
    pan_deg: [f64; 2],
    tilt_deg: [f64; 2],
    /// The least and the greatest focal length, px at 1280 px width.
    focal_px: [f64; 2],
}

/// Two games of the 209 homographies that were published for training (Homayounfar, Fidler,
/// Urtasun, CVPR 2017; those published for testing were not looked at), in the order of the
/// games of table 3.
///
/// A game is a run of consecutive frames that one position explains. Its position and the pan, tilt
/// and focal length of its frames were fitted together to the pixels that show the field, on a grid
/// of 16 × 9 (soft L1 at 3 px; square pixels, principal point in the middle, no distortion). The
/// homographies were made from people's clicks: even a camera of its own fits one only to 2.4 px
/// (median of the 42) and 3.3 px (of the 21).
///
/// | frames | residual (rms of a frame, px) | positions from the odd and the even frames alone |
/// |---|---|---|
/// | 16 to 57: 42, as many as the paper has of BRA–MEX, which the picture of frame 16 shows | median 5.1, 40 within 10 | 0.3 m apart |
/// | 99 to 119: 21 of a game that the data does not name | median 6.6, 18 within 10 | 0.6 m apart |
///
/// * *Level*: a pan axis free to lean makes the medians 5.1 and 6.4 px, which is no evidence of one.
/// * *Field*: 105 × 68 m, the tournament's size and the program's default. The template's 115 × 74
///   yards (105.2 × 67.7 m) give the same positions within 0.5 m, and rms residuals over all points
///   1 % to 2 % larger.
/// * *Ranges*: those of the frames within 10 px.
const CAMERAS: [RealCamera; 2] = [
    RealCamera {
        name: "that of BRA–MEX",
        position_m: [-0.10, -89.51, 20.04],
        pan_deg: [-34.5, 26.6],
        tilt_deg: [-13.3, -8.4],
        focal_px: [1981.0, 5177.0],
    },
    RealCamera {
        name: "for BRA–NED that of another game",
        position_m: [-0.12, -80.78, 19.18],
        pan_deg: [-35.2, 32.7],
        tilt_deg: [-14.5, -11.3],
        focal_px: [2190.0, 4076.0],
    },
];

/// Draws two games of 42 and 33 frames, each with its own stadium and the main camera of a real
/// game. Every other frame is used for training.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn worldcup(
    options: &ExperimentOptions,
    seed: u64,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let counts = frames_a_game(options);
    let size = picture_size(options);
    let mut set = FrameSet {
        kind: SetKind::Drawn,
        seed,
        title: format!(
            "drawn, two games of {} and {} frames, {} × {} px",
            counts[0], counts[1], size.width, size.height
        ),
        protocol: format!(
            "Every other frame of a game is used for training, the rest for testing; frames are \
             seconds apart. Each game has the main camera of a real one, estimated from \
             published homographies of the World Cup 2014: {}, {}. Pan, tilt and focal length \
             reach the ends of the ranges of its published frames.",
            CAMERAS[0].describe(),
            CAMERAS[1].describe()
        ),
        frames: Vec::new(),
        splits: Vec::new(),
    };
    for (game, (count, real)) in counts.into_iter().zip(&CAMERAS).enumerate() {
        let shoot = ShootOptions {
            step_s: STEP_S,
            focal_px_at_1280: real.focal_px,
            ..broadcast(Preset::Paper)
        };
        // Each game has its own stadium.
        let seed = scene_seed(seed, 2 + game as u64);
        let field = builtin("soccer")?.default_model()?;
        let scene = stadium(&StadiumOptions {
            daylight: shoot.daylight,
            ..StadiumOptions::new(field, seed)
        });
        let base = real.base(size);
        // The drawn operator follows the drawn play. Stretched, the path has the ranges of the real
        // camera.
        let path = real.stretch(&camera_path(&scene, &base, size, &shoot, count), size);
        let order = |(number, step): (usize, &PathStep)| Order {
            scene: &scene,
            moment: Moment {
                // Boards and some spectators change after each group of frames.
                occasion: (number / BOARDS_EVERY) as u64,
                people_changed: CHANGED_PEOPLE,
                boards_changed: CHANGED_BOARDS,
                instant: seed.wrapping_add(number as u64),
                restlessness: 1.0,
            },
            camera: PtzCamera::new(base, step.ptz),
            step: *step,
            number,
            exposure_ev: 0.0,
            shoot: &shoot,
            size,
            seed,
        };
        let orders: Vec<Order<'_>> = path.iter().enumerate().map(order).collect();
        let first = set.frames.len();
        set.frames.extend(take(&orders, Players::Kept, progress)?);
        // Frames alternate between training and testing.
        let of_game = |parity: usize| {
            (first..first + count)
                .filter(|frame| (frame - first) % 2 == parity)
                .collect()
        };
        // Named after the row of table 3 that it stands for.
        set.splits.push(Split {
            name: TABLE_3[game].0.to_owned(),
            training_frames: of_game(0),
            test_frames: of_game(1),
        });
    }
    Ok(set)
}

/// Numbers of frames of the synthetic games.
pub fn frames_a_game(options: &ExperimentOptions) -> [usize; 2] {
    if options.quick {
        [10, 8]
    } else {
        TABLE_3.map(|(_, frames, _)| frames)
    }
}

impl RealCamera {
    /// Whose it is, and where it stands.
    fn describe(&self) -> String {
        let [_, across, up] = self.position_m;
        format!(
            "{} ({:.1} m from the field's middle, {up:.1} m up)",
            self.name, -across
        )
    }

    /// Its base for pictures of this size.
    fn base(&self, size: ImageSize) -> CameraBase {
        CameraBase::new(
            Vec3::from(self.position_m),
            BaseAngles::default().base_from_world(),
            size.centre(),
        )
    }

    /// Stretches an operator's path so that pan, tilt and the logarithm of the focal length reach
    /// exactly the ends of this camera's ranges.
    ///
    /// The drawn play alone reaches other ends: it does not take the camera so far to the sides.
    fn stretch(&self, path: &[PathStep], size: ImageSize) -> Vec<PathStep> {
        let scale = f64::from(size.width) / f64::from(SIZE.width);
        // Zoom is stretched as a ratio, by the logarithm of the focal length.
        let to_log_focal = self.focal_px.map(|focal_px| (focal_px * scale).ln());
        let pan = Stretch::new(path, |ptz| ptz.pan.degrees(), self.pan_deg);
        let tilt = Stretch::new(path, |ptz| ptz.tilt.degrees(), self.tilt_deg);
        let log_focal = Stretch::new(path, |ptz| ptz.focal_px.ln(), to_log_focal);
        path.iter()
            .map(|step| PathStep {
                time_s: step.time_s,
                ptz: Ptz::from_degrees(
                    pan.apply(step.ptz.pan.degrees()),
                    tilt.apply(step.ptz.tilt.degrees()),
                    log_focal.apply(step.ptz.focal_px.ln()).exp(),
                ),
                motion: CameraMotion {
                    // A linear map multiplies the speed by its factor; the zoom's speed is that of
                    // the logarithm.
                    pan_per_s: step.motion.pan_per_s * pan.factor,
                    tilt_per_s: step.motion.tilt_per_s * tilt.factor,
                    zoom_per_s: step.motion.zoom_per_s * log_focal.factor,
                },
            })
            .collect()
    }
}

/// The linear map of one range to another: x ↦ to + factor · (x − from).
struct Stretch {
    from: f64,
    to: f64,
    factor: f64,
}

impl Stretch {
    /// The map of the values that a path has of a quantity to a range. A path without any motion
    /// of it is moved to the range's beginning.
    fn new(path: &[PathStep], quantity: fn(&Ptz) -> f64, [low, high]: [f64; 2]) -> Self {
        let [least, greatest] = range_of(path.iter().map(|step| quantity(&step.ptz)));
        let length = greatest - least;
        Self {
            from: least,
            to: low,
            factor: if length > 0.0 {
                (high - low) / length
            } else {
                0.0
            },
        }
    }

    fn apply(&self, value: f64) -> f64 {
        self.to + self.factor * (value - self.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_camera_reaches_its_ranges_sees_the_field_and_moves_as_it_states() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let size = ImageSize::new(640, 360);
        let shoot = ShootOptions {
            step_s: 0.04,
            ..broadcast(Preset::Paper)
        };
        for (seed, real) in CAMERAS.iter().enumerate() {
            let scene = stadium(&StadiumOptions::new(field.clone(), seed as u64));
            let base = real.base(size);
            let path = real.stretch(&camera_path(&scene, &base, size, &shoot, 3000), size);
            let focal_px = real.focal_px.map(|focal_px| 0.5 * focal_px);
            for (of, [low, high]) in [
                ((|ptz| ptz.pan.degrees()) as fn(&Ptz) -> f64, real.pan_deg),
                (|ptz| ptz.tilt.degrees(), real.tilt_deg),
                (|ptz| ptz.focal_px, focal_px),
            ] {
                let [least, greatest] = range_of(path.iter().map(|step| of(&step.ptz)));
                assert!(
                    (least - low).abs() < 1e-6 && (greatest - high).abs() < 1e-6,
                    "{least} {greatest}"
                );
            }
            for pair in path.windows(2) {
                let moved = pair[1].ptz.pan.turn_from(pair[0].ptz.pan);
                let stated =
                    (pair[0].motion.pan_per_s + pair[1].motion.pan_per_s) * (0.5 * shoot.step_s);
                assert!(
                    (stated - moved).degrees().abs() < 0.05,
                    "{stated} for {moved}"
                );
                // The ray through the middle of the picture ends on the field or not far behind.
                let camera = PtzCamera::new(base, pair[0].ptz);
                let forward = camera.cam_from_world().row(2).transpose();
                let end = base.position_m - forward * (base.position_m.z / forward.z);
                assert!(end.x.abs() < 90.0 && end.y.abs() < 60.0, "{end}");
            }
        }
    }
}
