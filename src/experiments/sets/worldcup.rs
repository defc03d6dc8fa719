//! Synthetic games in the setting of the paper's World Cup data (table 3).

use super::drawn::{Order, Players, picture_size, take};
use super::highlights::{broadcast, scene_seed};
use super::{FrameSet, SetKind, Split};
use crate::paper::TABLE_3;
use crate::{ExperimentError, ExperimentOptions};
use touchline_core::camera::PtzCamera;
use touchline_core::field::builtin;
use touchline_vision::synthetic::{
    Moment, PathStep, Preset, ShootOptions, StadiumOptions, camera_path, stadium,
};

/// Time between the frames of a game, s.
const STEP_S: f64 = 7.0;
/// Number of consecutive frames with the same boards, and the shares of boards and spectators that
/// then change.
const BOARDS_EVERY: usize = 8;
const CHANGED_BOARDS: f64 = 0.25;
const CHANGED_PEOPLE: f64 = 0.1;

/// Draws two games of 42 and 33 frames, each with its own stadium and main camera. Every other
/// frame is used for training.
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
    let shoot = ShootOptions {
        step_s: STEP_S,
        ..broadcast(Preset::Paper)
    };
    let mut set = FrameSet {
        kind: SetKind::Drawn,
        seed,
        title: format!(
            "drawn, two games of {} and {} frames, {} × {} px",
            counts[0], counts[1], size.width, size.height
        ),
        protocol: "Every other frame of a game is used for training, the rest for testing; frames are seconds apart."
            .to_owned(),
        frames: Vec::new(),
        splits: Vec::new(),
    };
    for (game, count) in counts.into_iter().enumerate() {
        // Each game has its own stadium.
        let seed = scene_seed(seed, 2 + game as u64);
        let field = builtin("soccer")?.default_model()?;
        let scene = stadium(&StadiumOptions {
            daylight: shoot.daylight,
            ..StadiumOptions::new(field, seed)
        });
        let base = shoot.main_camera(size);
        let path = camera_path(&scene, &base, size, &shoot, count);
        let order = |(number, step): (usize, &PathStep)| Order {
            scene: &scene,
            moment: Moment {
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
        set.splits.push(Split {
            name: format!("game {}", game + 1),
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
