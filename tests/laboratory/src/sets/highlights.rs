//! Synthetic sequences in the setting of the paper's highlights (table 2).
//!
//! One camera is low behind a corner, at the base of the published sequence. There are four
//! sequences of two games, each with the ranges of pan, tilt and focal length of the table.
//! Spectators move from frame to frame; between sequences some spectators, boards and the exposure
//! change. Players are visible and not masked. [`Scenery`] holds how much of this changes, and how
//! the pictures are taken.

use super::drawn::{Order, Players, picture_size, take};
use super::{FrameSet, SetKind, Split};
use crate::report::paper::{SEQUENCE_FRAMES, Sequence, TABLE_2};
use crate::report::statistics::range_of;
use crate::setting::{FIELD_YD, SIZE, base, field_of_yards, normal, rng};
use crate::{ExperimentError, ExperimentOptions};
use rand::RngExt;
use std::f64::consts::TAU;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::geometry::ImageSize;
use touchline::synthetic::{
    CameraMotion, Moment, PathStep, Preset, ShootOptions, StadiumOptions, stadium,
};

/// Time between the frames of a sequence, between the starts of sequences, and to the second game,
/// s.
const STEP_S: f64 = 0.8;
const SEQUENCE_EVERY_S: f64 = 90.0;
const SECOND_GAME_S: f64 = 5000.0;
/// The first two sequences are of one game, the others of another.
const SEQUENCES_OF_FIRST_GAME: usize = 2;

/// What the drawn highlights assume and the paper does not state. The experiment `assumptions`
/// measures how the results move with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenery {
    /// Shares of seats with another spectator: from sequence to sequence, and from game to game.
    pub people_changed: [f64; 2],
    /// Shares of boards that are drawn again: from sequence to sequence, and from game to game.
    pub boards_changed: [f64; 2],
    /// How much spectators move from frame to frame ([`Moment::restlessness`]).
    pub restlessness: f64,
    /// 1-σ of the exposure between sequences, stops.
    pub exposure_sigma_ev: f64,
    /// How each picture is taken: shutter, focus, noise, compression.
    pub shoot: ShootOptions,
}

impl Scenery {
    /// The scenery of all experiments but `assumptions`, with the light, the lens and, if the
    /// preset is `hard`, the pictures of a preset.
    pub fn new(preset: Preset) -> Self {
        Self {
            people_changed: [0.1, 0.9],
            boards_changed: [0.25, 0.6],
            restlessness: 1.0,
            exposure_sigma_ev: 0.35,
            shoot: broadcast(preset),
        }
    }
}

impl Default for Scenery {
    fn default() -> Self {
        Self::new(Preset::Paper)
    }
}

/// Draws the four sequences of table 2. Each is tested with the other three as references.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn highlights(
    options: &ExperimentOptions,
    preset: Preset,
    seed: u64,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    highlights_in(options, &Scenery::new(preset), 1, seed, progress)
}

/// Draws every `stride`-th frame of the four sequences, in another scenery. A frame has the same
/// number, camera, players and noise with any stride and in any scenery.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn highlights_in(
    options: &ExperimentOptions,
    scenery: &Scenery,
    stride: usize,
    seed: u64,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let frames = frames_a_sequence(options);
    let size = picture_size(options);
    let shoot = scenery.shoot;
    let [people_in_sequence, people_in_game] = scenery.people_changed;
    let [boards_in_sequence, boards_in_game] = scenery.boards_changed;
    let first = stadium(&StadiumOptions {
        daylight: shoot.daylight,
        ..StadiumOptions::new(field_of_yards(FIELD_YD)?, scene_seed(seed, 0))
    });
    // The second game is in the same stadium, with most spectators and boards replaced.
    let second = first.at(&Moment {
        occasion: scene_seed(seed, 1),
        people_changed: people_in_game,
        boards_changed: boards_in_game,
        ..Moment::default()
    });
    let base = paper_base(&shoot, size);
    let mut orders = Vec::new();
    for (number, stated) in TABLE_2.iter().enumerate() {
        // A generator for each sequence, so that its path does not depend on the others.
        let mut draw = rng(seed, [90, number as u64]);
        let exposure_ev = scenery.exposure_sigma_ev * normal(&mut draw);
        let of_second = number >= SEQUENCES_OF_FIRST_GAME;
        let begins_s =
            SEQUENCE_EVERY_S * number as f64 + if of_second { SECOND_GAME_S } else { 0.0 };
        let path = Path::from_sequence(stated, size, &mut draw);
        for frame in (0..frames).step_by(stride) {
            // The share of the sequence, 0 at its first frame and 1 at its last, whatever their
            // number.
            let step = path.step(frame as f64 / (frames - 1) as f64, begins_s);
            let of_all = number * frames + frame;
            orders.push(Order {
                scene: if of_second { &second } else { &first },
                moment: Moment {
                    occasion: number as u64,
                    people_changed: people_in_sequence,
                    boards_changed: boards_in_sequence,
                    // Each frame has its own instant, at which spectators sit otherwise.
                    instant: seed.wrapping_mul(1_000).wrapping_add(of_all as u64),
                    restlessness: scenery.restlessness,
                },
                camera: PtzCamera::new(base, step.ptz),
                step,
                number: of_all,
                exposure_ev,
                shoot: &shoot,
                size,
                seed,
            });
        }
    }
    let sequences = TABLE_2.len();
    let frames = frames.div_ceil(stride);
    // Orders were made sequence by sequence, so that a sequence is a range of indices.
    let frames_of = |sequence: usize| sequence * frames..(sequence + 1) * frames;
    let split = |sequence: usize| Split {
        name: format!("sequence {}", sequence + 1),
        training_frames: (0..sequences * frames)
            .filter(|frame| !frames_of(sequence).contains(frame))
            .collect(),
        test_frames: frames_of(sequence).collect(),
    };
    Ok(FrameSet {
        kind: SetKind::Drawn,
        seed,
        title: format!(
            "drawn, {sequences} sequences of {frames} frames, {} × {} px",
            size.width, size.height
        ),
        protocol: "Leave one sequence out: each is tested against the frames of the other three."
            .to_owned(),
        frames: take(&orders, Players::Kept, progress)?,
        splits: (0..sequences).map(split).collect(),
    })
}

/// Number of frames of a synthetic sequence.
pub fn frames_a_sequence(options: &ExperimentOptions) -> usize {
    options.full_or_quick(SEQUENCE_FRAMES, 6)
}

/// The seed of a scene. Scenes of neighbouring seeds differ.
pub(super) const fn scene_seed(seed: u64, scene: u64) -> u64 {
    seed.wrapping_mul(1_000).wrapping_add(11 + 100 * scene)
}

/// The look of broadcast frames of the paper's time: motion blur, slight defocus, noise and strong
/// compression. The preset `hard` has a look of its own.
pub(super) fn broadcast(preset: Preset) -> ShootOptions {
    let shoot = ShootOptions {
        step_s: STEP_S,
        ..preset.shoot()
    };
    match preset {
        Preset::Hard => shoot,
        _ => ShootOptions {
            shutter_s: 1.0 / 200.0,
            defocus_px_at_1280: 0.8,
            exposure_sigma_ev: 0.1,
            noise_levels: 2.5,
            jpeg_quality: 60,
            ..shoot
        },
    }
}

/// The paper's base for pictures of another size, with the lens of a preset.
fn paper_base(shoot: &ShootOptions, size: ImageSize) -> CameraBase {
    let distortion = shoot.main_camera(size).distortion;
    CameraBase {
        principal_point: size.centre(),
        distortion,
        ..base()
    }
}

/// The camera's motion during a sequence: smooth, with exactly the ranges of table 2.
struct Path {
    range: [[f64; 2]; 3],
    /// Phases of three waves, for each of pan, tilt and focal length.
    phases: [[f64; 3]; 3],
    /// Minimum and maximum of the sum of waves during the sequence.
    reach: [[f64; 2]; 3],
}

/// Amplitudes of the waves, and the number of periods of the slowest one in a sequence.
const AMPLITUDES: [f64; 3] = [1.0, 0.5, 0.25];
const SLOWEST: f64 = 0.8;
/// Number of times at which the minimum and maximum are evaluated.
const SAMPLES: usize = 29;

impl Path {
    fn from_sequence(stated: &Sequence, size: ImageSize, draw: &mut rand_pcg::Pcg64Mcg) -> Self {
        let scale = f64::from(size.width) / f64::from(SIZE.width);
        // Three waves for each of pan, tilt and focal length. Their sum is scaled to the range
        // afterwards.
        let phases = std::array::from_fn(|_| std::array::from_fn(|_| draw.random_range(0.0..TAU)));
        let reach = std::array::from_fn(|axis| {
            let at = (0..SAMPLES)
                .map(|sample| waves(&phases[axis], sample as f64 / (SAMPLES - 1) as f64));
            range_of(at)
        });
        Self {
            range: [
                stated.pan_deg,
                stated.tilt_deg,
                // Logarithmic, so that a zoom is as fast at the long end as at the short one.
                stated.focal_px.map(|f| (f * scale).ln()),
            ],
            phases,
            reach,
        }
    }

    /// Pan, tilt and focal length after a share of the sequence. The sum of waves is scaled to the
    /// range; focal length is interpolated logarithmically.
    fn ptz(&self, share: f64) -> Ptz {
        let [pan, tilt, log_focal] = std::array::from_fn(|axis| {
            let ([low, high], [from, to]) = (self.reach[axis], self.range[axis]);
            // Beyond the sequence's ends, which the speed at its ends needs, the range is exceeded
            // a little.
            from + (to - from) * (waves(&self.phases[axis], share) - low) / (high - low)
        });
        Ptz::from_degrees(pan, tilt, log_focal.exp())
    }

    /// The same with time and speed. The speed is a central difference.
    fn step(&self, share: f64, begins_s: f64) -> PathStep {
        let lasts_s = STEP_S * (SAMPLES - 1) as f64;
        let ahead = 1e-3;
        let (ptz, before, after) = (
            self.ptz(share),
            self.ptz(share - ahead),
            self.ptz(share + ahead),
        );
        let per_s = 0.5 / (ahead * lasts_s);
        let motion = CameraMotion {
            pan_per_s: after.pan.turn_from(before.pan) * per_s,
            tilt_per_s: (after.tilt - before.tilt) * per_s,
            zoom_per_s: (after.focal_px / before.focal_px).ln() * per_s,
        };
        PathStep {
            time_s: begins_s + share * lasts_s,
            ptz,
            motion,
        }
    }
}

/// The sum of three waves after a share of the sequence.
fn waves(phases: &[f64; 3], share: f64) -> f64 {
    let each = AMPLITUDES.iter().zip(phases).enumerate();
    each.map(|(wave, (amplitude, phase))| {
        amplitude * (TAU * SLOWEST * (wave + 1) as f64 * share + phase).sin()
    })
    .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_the_range_that_the_table_states_and_the_motion_of_its_steps() {
        for (number, stated) in TABLE_2.iter().enumerate() {
            let path = Path::from_sequence(stated, SIZE, &mut rng(7, [1, number as u64]));
            let steps: Vec<PathStep> = (0..SAMPLES)
                .map(|at| path.step(at as f64 / (SAMPLES - 1) as f64, 0.0))
                .collect();
            for (of, [from, to]) in [
                ((|ptz| ptz.pan.degrees()) as fn(&Ptz) -> f64, stated.pan_deg),
                (|ptz| ptz.tilt.degrees(), stated.tilt_deg),
                (|ptz| ptz.focal_px, stated.focal_px),
            ] {
                let [least, greatest] = range_of(steps.iter().map(|step| of(&step.ptz)));
                assert!(
                    (least - from).abs() < 1e-6 && (greatest - to).abs() < 1e-6,
                    "{least} {greatest}"
                );
            }
            for pair in steps.windows(2) {
                let mean = (pair[0].motion.pan_per_s + pair[1].motion.pan_per_s) * (0.5 * STEP_S);
                let moved = pair[1].ptz.pan.turn_from(pair[0].ptz.pan);
                assert!(
                    (mean - moved).degrees().abs() < 0.1 * (1.0 + moved.degrees().abs()),
                    "{mean} {moved}"
                );
            }
        }
    }
}
