//! A broadcast of the drawn match: several cameras, the shots that a director takes from them, and
//! the pictures of every frame.
//!
//! Hard by intent: all shots have one turf, boards change while the match goes on, one camera
//! leans, and another one stands beside the main camera and has nearly its view.

mod director;
mod transition;

pub use director::{BROADCAST_FPS, BroadcastShot, ShotSubject};
pub use transition::TransitionStyle;

use crate::synthetic::options::{FrameOptions, Graphics, Moment, ShootOptions, StadiumOptions};
use crate::synthetic::path::{Operator, PathStep, motion_at};
use crate::synthetic::texture::{hash, sub_seed, unit};
use crate::synthetic::{Stadium, stadium};
use director::plan_shots;
use image::RgbImage;
use std::ops::RangeInclusive;
use touchline_core::camera::{BaseAngles, CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImageSize, Vec3};

/// What a broadcast is; the same options give the same pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BroadcastOptions {
    /// Chooses the stadium, the match, the cameras' places and the shots.
    pub seed: u64,
    /// The number of frames, 25 a second.
    pub frames: usize,
    /// The number of cameras in the stands, in [`Broadcast::CAMERAS`].
    pub cameras: usize,
    /// The size of the frames, px.
    pub image_size: ImageSize,
    /// Lens, light and sensor; each camera has focal lengths of its own.
    pub shoot: ShootOptions,
}

/// A camera of the stands: its name, where it usually stands, `world`, m, and its focal lengths, px
/// at 1280 px width.
type Place = (&'static str, [f64; 3], [f64; 2]);

/// The cameras of a broadcast; one with fewer has the first of them.
const PLACES: [Place; 7] = [
    ("main", [1.5, -66.0, 18.0], [1250.0, 3400.0]),
    ("left_16m", [-36.0, -62.0, 17.0], [1250.0, 3400.0]),
    ("right_16m", [36.0, -62.0, 17.0], [1250.0, 3400.0]),
    ("beside_main", [4.5, -65.0, 16.0], [1250.0, 3800.0]),
    ("behind_goal", [-79.0, 2.0, 13.0], [1100.0, 2800.0]),
    ("opposite", [-6.0, 63.0, 14.0], [1250.0, 3200.0]),
    ("high", [0.5, -58.0, 31.0], [1000.0, 1800.0]),
];
/// The camera beside the pitch, which takes players and spectators.
const PITCHSIDE: &str = "pitchside";
/// Share of their distance by which places differ from stadium to stadium.
const PLACE_SPREAD: f64 = 0.05;
/// How much each camera leans, and the one that leans visibly.
const ROLL_DEG: f64 = 0.25;
const LEAN_DEG: f64 = 2.0;

/// Frames after which boards change, and the share that does.
const BOARDS_FRAMES: usize = 200;
const BOARDS_CHANGED: f64 = 0.6;
/// Frames after which spectators move.
const CROWD_FRAMES: usize = 8;

/// Height of a player in a close-up, from the waist up, in heights of the picture; his height and
/// that of his chest, m.
const CLOSE_UP_SHARE: f64 = 1.6;
const PLAYER_M: f64 = 1.8;
const CHEST_M: f64 = 1.3;
/// Distance within which players are shown in close-ups, m.
const NEAR_M: f64 = 40.0;
/// Focal length for spectators, px at 1280 px width; where in the stands opposite it points, beyond
/// the touchline and up, m; and how fast it pans along them, m/s.
const CROWD_FOCAL_PX: f64 = 3600.0;
const CROWD_AT_M: [f64; 2] = [22.0, 11.0];
const CROWD_PAN_M_PER_S: f64 = 1.2;

/// A drawn broadcast.
#[derive(Clone, Debug)]
pub struct Broadcast {
    options: BroadcastOptions,
    stadium: Stadium,
    /// Those of the stands, and last the one beside the pitch.
    cameras: Vec<(&'static str, Operator)>,
    shots: Vec<BroadcastShot>,
}

impl Broadcast {
    /// How many cameras a broadcast may have in the stands.
    pub const CAMERAS: RangeInclusive<usize> = 3..=PLACES.len();

    /// Plans a broadcast of a match on a field. A number of cameras out of range is brought into
    /// it.
    pub fn new(options: &BroadcastOptions, field: FieldModel) -> Self {
        let stadium = stadium(&StadiumOptions {
            daylight: options.shoot.daylight,
            ..StadiumOptions::new(field, options.seed)
        });
        let count = options
            .cameras
            .clamp(*Self::CAMERAS.start(), *Self::CAMERAS.end());
        let seed = sub_seed(options.seed, 0xB0AD);
        // One camera leans as no level tripod does; which one is drawn.
        let leaning = hash(seed, 1, 1) as usize % count;
        // Beside the touchline, at the height of a shoulder.
        let beside = Vec3::new(-8.0, -0.5 * stadium.field().width_m - 3.2, 1.6);
        let pitchside = [beside.x, beside.y, beside.z];
        let places =
            PLACES[..count]
                .iter()
                .copied()
                .chain([(PITCHSIDE, pitchside, [CROWD_FOCAL_PX; 2])]);
        let cameras = places.enumerate().map(|(index, (name, place, focal_px))| {
            let roll_deg = if index == leaning { LEAN_DEG } else { ROLL_DEG };
            let base = camera_base(options, place, roll_deg);
            let operator =
                Operator::new(&stadium, &base, options.image_size, focal_px, index as u32);
            (name, operator)
        });
        let cameras: Vec<_> = cameras.collect();
        Self {
            options: *options,
            shots: plan_shots(seed, options.frames, count, &stadium.play),
            stadium,
            cameras,
        }
    }

    /// The names and bases of its cameras; [`BroadcastShot::camera`] is an index into them.
    pub fn cameras(&self) -> impl Iterator<Item = (&'static str, &CameraBase)> {
        self.cameras
            .iter()
            .map(|(name, camera)| (*name, camera.base()))
    }

    /// Its shots, in order.
    pub fn shots(&self) -> &[BroadcastShot] {
        &self.shots
    }

    /// The exact camera of a shot in one of the frames in which it is seen.
    pub fn camera(&self, shot: &BroadcastShot, frame: usize) -> PtzCamera {
        let (_, operator) = &self.cameras[shot.camera];
        PtzCamera::new(
            *operator.base(),
            self.ptz(shot, operator, shot.time_s(frame)),
        )
    }

    /// The picture of a frame; black beyond the last.
    pub fn draw(&self, frame: usize) -> RgbImage {
        let size = self.options.image_size;
        // The shots follow each other without gaps, each with its transition before it: the one
        // that is
        // seen is the last whose transition has begun.
        let behind = self
            .shots
            .partition_point(|shot| shot.transition_frames.start <= frame);
        let (before, seen) = self.shots.split_at(behind.saturating_sub(1));
        let Some(shot) = seen.first().filter(|shot| frame < shot.frames.end) else {
            return RgbImage::new(size.width, size.height);
        };
        let picture = self.picture(shot, frame);
        match before.last() {
            Some(last) if shot.transition_frames.contains(&frame) => {
                // Neither end of a transition is a picture of one shot alone, so its shares lie
                // within 0 and 1.
                let since = frame - shot.transition_frames.start;
                let share = (since + 1) as f64 / (shot.transition_frames.len() + 1) as f64;
                let before = self.picture(last, frame);
                let style: TransitionStyle = shot.transition;
                style.mix(&before, &picture, share, &self.stadium.kits)
            }
            _ => picture,
        }
    }

    /// The picture of a shot alone.
    fn picture(&self, shot: &BroadcastShot, frame: usize) -> RgbImage {
        let BroadcastOptions {
            seed,
            image_size,
            shoot,
            ..
        } = self.options;
        let (_, operator) = &self.cameras[shot.camera];
        let time_s = shot.time_s(frame);
        let step = PathStep {
            time_s,
            ptz: self.ptz(shot, operator, time_s),
            // Blur comes from the motion at this moment, in a replay as it was recorded.
            motion: motion_at(|time_s| self.ptz(shot, operator, time_s), time_s),
        };
        let is_replay = shot.subject == ShotSubject::Replay;
        let options = FrameOptions {
            graphics: Graphics {
                // The match's own graphics leave the screen for a replay, which has a mark of its
                // own.
                score_bug: !is_replay,
                watermark: is_replay,
                lower_third: shot.lower_third,
                ..Graphics::NONE
            },
            ..shoot.frame(frame, &step, image_size, seed)
        };
        // Boards and spectators change in the studio's time, not in that of the replay.
        let stadium = self.stadium.at(&Moment {
            occasion: (frame / BOARDS_FRAMES) as u64,
            boards_changed: BOARDS_CHANGED,
            instant: (frame / CROWD_FRAMES) as u64,
            restlessness: 0.4,
            ..Moment::default()
        });
        let camera = PtzCamera::new(*operator.base(), step.ptz);
        stadium.render(&camera, image_size, &options).image
    }

    /// Where the camera of a shot points at a time since kick-off.
    fn ptz(&self, shot: &BroadcastShot, operator: &Operator, time_s: f64) -> Ptz {
        match shot.subject {
            ShotSubject::Play | ShotSubject::Replay => operator.ptz(time_s),
            ShotSubject::CloseUp => self.close_up(shot, operator.base(), time_s),
            ShotSubject::Crowd => self.crowd(shot, operator.base(), time_s),
        }
    }

    /// Follows whoever runs least of those near the camera: a director shows a player after the
    /// event, not in a sprint.
    fn close_up(&self, shot: &BroadcastShot, base: &CameraBase, time_s: f64) -> Ptz {
        let at = base.position_m;
        let place_of = |[x, y]: [f64; 2]| Vec3::new(x, y, CHEST_M);
        // Unrest is the sum of the speeds at four moments of the shot, m/s, with a metre beyond the
        // range as bad as one metre a second.
        let moments = [0.0, 1.0, 2.0, 3.0].map(|s| self.stadium.play.people(shot.start_s + s));
        let unrest = |index: &usize| -> f64 {
            let people = moments.iter().map(|people| &people[*index]);
            let speeds = people.map(|person| person.velocity[0].hypot(person.velocity[1]));
            let distance_m = (place_of(moments[0][*index].place) - at).norm();
            speeds.sum::<f64>() + (distance_m - NEAR_M).max(0.0)
        };
        let all = 0..moments[0].len();
        let index = all
            .min_by(|a, b| unrest(a).total_cmp(&unrest(b)))
            .unwrap_or(0);
        // A hand that is a little late and smooths the stride.
        let taps = [-0.5, -0.3, -0.1, 0.1].map(|tap| self.stadium.play.people(time_s + tap));
        let places = taps.iter().filter_map(|people| people.get(index));
        let aim = places.map(|person| place_of(person.place)).sum::<Vec3>() / taps.len() as f64;
        // The focal length at which a player of this height has that height in the picture.
        let height_px = CLOSE_UP_SHARE * f64::from(self.options.image_size.height);
        aim_at(base, aim, height_px * (aim - at).norm() / PLAYER_M)
    }

    /// Pans along the stand opposite.
    fn crowd(&self, shot: &BroadcastShot, base: &CameraBase, time_s: f64) -> Ptz {
        // Anywhere along the middle 60 m of the stand.
        let start_m = 60.0 * f64::from(unit(hash(0xC40D, shot.frames.start as i32, 0))) - 30.0;
        let [beyond_m, up_m] = CROWD_AT_M;
        let aim = Vec3::new(
            start_m + CROWD_PAN_M_PER_S * (time_s - shot.start_s),
            0.5 * self.stadium.field().width_m + beyond_m,
            up_m,
        );
        let scale = crate::synthetic::options::scale_from_1280(self.options.image_size);
        aim_at(base, aim, CROWD_FOCAL_PX * scale)
    }
}

/// The base of a camera near its usual place, which looks towards the centre mark.
fn camera_base(options: &BroadcastOptions, place: [f64; 3], roll_deg: f64) -> CameraBase {
    let seed = sub_seed(options.seed, 0xB0AE);
    // Sideways a place is exact, so that cameras side by side keep their distance.
    let [away, up] = [1, 2].map(|axis| {
        1.0 + PLACE_SPREAD * (2.0 * f64::from(unit(hash(seed, axis, place[0] as i32))) - 1.0)
    });
    // The pitch leaves room for a camera beside it at one place alone.
    let away = if place[2] < 2.0 { 1.0 } else { away };
    let position_m = Vec3::new(place[0], place[1] * away, place[2] * up);
    let angles = BaseAngles {
        // Pan 0° points to the centre mark.
        heading: Angle::from_radians((-position_m.x).atan2(-position_m.y)),
        pitch: Angle::from_degrees(-0.3),
        roll: Angle::from_degrees(roll_deg),
    };
    CameraBase {
        position_m,
        base_from_world: angles.base_from_world(),
        ..options.shoot.main_camera(options.image_size)
    }
}

/// A camera that points at a place.
fn aim_at(base: &CameraBase, aim: Vec3, focal_px: f64) -> Ptz {
    let PanTilt { pan, tilt } = PanTilt::from_direction(base.base_from_world_point(aim));
    Ptz::new(pan, tilt, focal_px)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Preset;
    use touchline_core::testing::soccer;

    fn broadcast(seed: u64, frames: usize) -> Broadcast {
        let options = BroadcastOptions {
            seed,
            frames,
            cameras: 7,
            image_size: ImageSize::new(128, 72),
            shoot: Preset::Paper.shoot(),
        };
        Broadcast::new(&options, soccer())
    }

    fn difference(one: &RgbImage, other: &RgbImage) -> f64 {
        let pairs = one.iter().zip(other.iter());
        pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / one.len() as f64
    }

    #[test]
    fn every_shot_of_the_match_has_the_ball_in_view() {
        let drawn = broadcast(4, 3000);
        let size = drawn.options.image_size;
        let shots = drawn.shots().iter();
        for shot in shots.filter(|shot| shot.subject.shows_field()) {
            let is_seen = |frame: &usize| {
                let ball = drawn.stadium.play.ball(shot.time_s(*frame));
                let image = drawn.camera(shot, *frame).image_from_world(ball);
                image.is_ok_and(|image| size.contains(image))
            };
            let seen = shot.frames.clone().filter(is_seen).count();
            assert!(4 * seen > 3 * shot.frames.len(), "{seen} of {shot:?}");
        }
    }

    #[test]
    fn pictures_change_at_cuts_and_the_same_options_draw_the_same() {
        let drawn = broadcast(4, 1200);
        let cut = drawn.shots().iter().skip(1);
        let cut = cut.filter(|shot| shot.transition == TransitionStyle::Cut);
        let start = cut.map(|shot| shot.frames.start).next().unwrap();
        let [earlier, before, after] = [2, 1, 0].map(|back| drawn.draw(start - back));
        assert!(difference(&before, &after) > 4.0 * difference(&earlier, &before));
        assert_eq!(after, broadcast(4, 1200).draw(start));
        // Beyond the end.
        assert!(drawn.draw(1200).iter().all(|level| *level == 0));
    }
}
