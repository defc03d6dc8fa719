//! A clip of two cameras with a close-up between them, and cameras given for all of its frames.

use crate::drawing::{Drawn, SIZE, Shot, draw, shots};
use std::ops::Range;
use std::path::Path;
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::FieldSpec;
use touchline::field::builtin;
use touchline::geometry::Vec3;
use touchline::synthetic::{Preset, ShootOptions, StadiumOptions, stadium};

/// The frames of each shot: the main camera, a close-up, the second camera, the main camera.
const SHOTS: [Range<usize>; 4] = [0..60, 60..90, 90..150, 150..200];

/// The frames of the close-up, in which no line is seen.
pub const CLOSE_UP: Range<usize> = 60..90;

/// The clip with its true cameras. The second camera stands on the other half of the same stand,
/// 12 m higher.
pub fn mixed_clip(folder: &Path, seed: u64) -> Drawn {
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let scene = stadium(&StadiumOptions::new(field, seed));
    // The exposure of the hard preset changes from picture to picture, as that of stills does: in a
    // video these would be cuts.
    let shoot = ShootOptions {
        step_s: 0.04,
        distortion_at_1280: Preset::Hard.shoot().distortion_at_1280,
        ..Preset::Paper.shoot()
    };
    let main = shoot.main_camera(SIZE);
    let second = CameraBase {
        position_m: Vec3::new(24.0, -70.0, 30.0),
        base_from_world: BaseAngles::default().base_from_world(),
        ..main
    };
    let of = |base: &CameraBase| shots(&scene, base, &shoot, SHOTS[3].end, seed);
    let (mut taken, by_second) = (of(&main), of(&second));
    taken[SHOTS[2].clone()].clone_from_slice(&by_second[SHOTS[2].clone()]);
    // The close-up: grass and a player or two, between the markings of the far half.
    for (index, shot) in taken[CLOSE_UP].iter_mut().enumerate() {
        let pan = -9.0 + 0.01 * index as f64;
        let ptz = Ptz::from_degrees(pan, -12.4, 14_000.0);
        *shot = Shot {
            camera: PtzCamera::new(main, ptz),
            options: shot.options,
        };
    }
    draw(folder, &[(&scene, &taken)], 75, FieldSpec::new("soccer"))
}
