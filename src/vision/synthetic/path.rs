//! How a camera operator follows the play.

use super::Stadium;
use super::courts::Setting;
use super::options::{CameraMotion, FrameOptions, ShootOptions, scale_from_1280};
use super::play::Play;
use super::texture::{hash, smooth_walk, sub_seed, unit};
use touchline_core::camera::{BaseAngles, CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImageSize, Vec3};

/// One moment of a camera's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathStep {
    /// The time since kick-off, s.
    pub time_s: f64,
    /// Where the camera points, exactly.
    pub ptz: Ptz,
    /// How it moves at that moment.
    pub motion: CameraMotion,
}

/// The path of an operator who follows the ball of `stadium`'s match with the camera `base`:
/// smooth, a little late, with the play in the lower middle of the picture, zooming in when the
/// play is quiet.
pub fn camera_path(
    stadium: &Stadium,
    base: &CameraBase,
    image_size: ImageSize,
    shoot: &ShootOptions,
    frames: usize,
) -> Vec<PathStep> {
    let operator = Operator::new(stadium, base, image_size, shoot.focal_px_at_1280, 0);
    let still = shoot
        .is_still
        .then(|| whole_field(base, stadium.field(), image_size));
    (0..frames)
        .map(|index| operator.step(index as f64 * shoot.step_s, still))
        .collect()
}

/// How much of the picture the field takes when it is shown whole.
const WHOLE_FIELD_SHARE: f64 = 0.88;

/// Where a camera points that shows the whole field.
pub(super) fn whole_field(base: &CameraBase, field: &FieldModel, image_size: ImageSize) -> Ptz {
    // Towards the middle of the field, with the focal length at which the corner that lies farthest
    // out is still in the picture.
    let aim = PanTilt::from_direction(base.base_from_world_point(Vec3::zeros()));
    let ahead = PtzCamera::new(*base, Ptz::new(aim.pan, aim.tilt, 1.0));
    let half = [
        0.5 * f64::from(image_size.width),
        0.5 * f64::from(image_size.height),
    ];
    // The largest focal length with which every corner of the field lies in the picture.
    let mut focal_px = f64::INFINITY;
    for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let corner = Vec3::new(0.5 * x * field.length_m, 0.5 * y * field.width_m, 0.0);
        let seen = ahead.cam_from_world_point(corner);
        // x / z = half / f at the border of the picture, for either axis.
        for (half, along) in [(half[0], seen.x), (half[1], seen.y)] {
            focal_px = focal_px.min(half * (seen.z / along).abs());
        }
    }
    Ptz::new(aim.pan, aim.tilt, WHOLE_FIELD_SHARE * focal_px)
}

impl ShootOptions {
    /// How frame number `index` of a sequence is taken: exposure and focus vary from frame to
    /// frame, each by a draw of its own from `seed`.
    pub fn frame(
        &self,
        index: usize,
        step: &PathStep,
        image_size: ImageSize,
        seed: u64,
    ) -> FrameOptions {
        let draw = hash(sub_seed(seed, 0xF2A3), index as i32, 0);
        // The sum of twelve uniform draws is as good as normal for an exposure.
        let normal: f64 = (0..12)
            .map(|i| f64::from(unit(hash(draw, i, 1))))
            .sum::<f64>()
            - 6.0;
        FrameOptions {
            time_s: step.time_s,
            motion: step.motion,
            shutter_s: self.shutter_s,
            defocus_px: self.defocus_px_at_1280
                * scale_from_1280(image_size)
                * f64::from(unit(hash(draw, 2, 2))),
            exposure_ev: self.exposure_sigma_ev * normal,
            vignetting: self.vignetting,
            noise_levels: self.noise_levels,
            noise_seed: u64::from(hash(draw, 3, 3)),
            ..FrameOptions::default()
        }
    }
}

/// The focal lengths of a camera beside a court, as multiples of the one that shows it whole.
const COURT_ZOOM: [f64; 2] = [1.3, 2.8];

impl ShootOptions {
    /// The camera of a setting, and how it takes the court: with the light of the place, and with
    /// focal lengths that fit it. Those of the stadium are the preset's.
    pub fn in_setting(
        &self,
        setting: Setting,
        field: &FieldModel,
        image_size: ImageSize,
        seed: u64,
    ) -> (CameraBase, Self) {
        let base = self.main_camera(image_size);
        let Some([x, y, z]) = setting.camera_m(seed) else {
            return (base, *self);
        };
        let position_m = Vec3::new(x, y, z);
        let angles = BaseAngles {
            heading: Angle::from_radians((-x).atan2(-y)),
            pitch: Angle::from_degrees(-0.3),
            roll: Angle::from_degrees(0.25),
        };
        let base = CameraBase {
            position_m,
            base_from_world: angles.base_from_world(),
            ..base
        };
        let whole_px = whole_field(&base, field, image_size).focal_px / scale_from_1280(image_size);
        let shoot = Self {
            daylight: setting.scene().daylight(self.daylight),
            focal_px_at_1280: COURT_ZOOM.map(|zoom| zoom * whole_px),
            ..*self
        };
        (base, shoot)
    }
}

/// Who points a camera at the play.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    play: Play,
    base: CameraBase,
    seed: u32,
    focal_px: [f64; 2],
    half_height_px: f64,
}

impl Operator {
    /// The operator of a camera with these focal lengths, px at 1280 px width; each number is
    /// another one, with hands of his own.
    pub fn new(
        stadium: &Stadium,
        base: &CameraBase,
        image_size: ImageSize,
        focal_px_at_1280: [f64; 2],
        number: u32,
    ) -> Self {
        Self {
            play: stadium.play,
            base: *base,
            seed: sub_seed(stadium.options.seed, 0xCA3E) ^ (number << 8),
            focal_px: focal_px_at_1280.map(|focal| focal * scale_from_1280(image_size)),
            half_height_px: 0.5 * f64::from(image_size.height),
        }
    }

    /// The camera's base.
    pub const fn base(&self) -> &CameraBase {
        &self.base
    }

    /// The ball as a human operator follows it: averaged over the last second and a half, slightly
    /// extrapolated.
    fn attention(&self, time_s: f64) -> Vec3 {
        // From 0.4 s ahead, which an operator foresees, to 1.4 s ago.
        let taps = 12;
        let sum: Vec3 = (0..taps)
            .map(|tap| self.play.ball(time_s + 0.4 - 0.16 * f64::from(tap)))
            .sum();
        let mean = sum / f64::from(taps);
        // The operator keeps some field on the near side and does not follow the ball to the last
        // metre.
        Vec3::new(mean.x * 0.86, mean.y * 0.7 + 1.0, 0.0)
    }

    /// A moment of the path, or of a camera that keeps still.
    fn step(&self, time_s: f64, still: Option<Ptz>) -> PathStep {
        PathStep {
            time_s,
            ptz: still.unwrap_or_else(|| self.ptz(time_s)),
            motion: still.map_or_else(
                || motion_at(|at| self.ptz(at), time_s),
                |_| CameraMotion::default(),
            ),
        }
    }

    /// Where the camera points at a time since kick-off.
    pub fn ptz(&self, time_s: f64) -> Ptz {
        let target = self.attention(time_s);
        let aim = PanTilt::from_direction(self.base.base_from_world_point(target));
        // Short and long are a factor apart, so the zoom walks on a logarithmic scale.
        let [short, long] = self.focal_px;
        let share = 0.5
            + 0.62 * smooth_walk(self.seed, time_s / 9.0)
            + 0.1 * smooth_walk(self.seed ^ 1, time_s / 2.5);
        let mut focal_px = short * (long / short).powf(share.clamp(0.0, 1.0).powf(1.4));
        // The play sits below the middle, so that the far side is in the picture.
        let distance = (target - self.base.position_m).norm();
        focal_px *= (distance / 75.0).clamp(0.85, 1.25).sqrt();
        let drop = Angle::from_radians((0.05 * self.half_height_px / focal_px).atan());
        let hand =
            |seed: u32| Angle::from_degrees(0.05 * smooth_walk(self.seed ^ seed, time_s / 0.9));
        Ptz::new(
            aim.pan + hand(7),
            aim.tilt + drop + hand(8),
            focal_px.clamp(short, long),
        )
    }
}

/// How a camera moves at a moment of its path.
pub(super) fn motion_at(ptz: impl Fn(f64) -> Ptz, time_s: f64) -> CameraMotion {
    // Central differences of the path itself, so that the motion is that of the poses.
    let step = 0.01;
    let (before, after) = (ptz(time_s - step), ptz(time_s + step));
    let per_s = 0.5 / step;
    CameraMotion {
        pan_per_s: after.pan.turn_from(before.pan) * per_s,
        tilt_per_s: (after.tilt - before.tilt) * per_s,
        zoom_per_s: (after.focal_px / before.focal_px).ln() * per_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{Preset, StadiumOptions, stadium};
    use touchline_core::testing::soccer;

    #[test]
    fn the_operator_keeps_the_ball_in_view_and_moves_smoothly() {
        let size = ImageSize::new(1280, 720);
        let scene = stadium(&StadiumOptions::new(soccer(), 21));
        let shoot = ShootOptions {
            step_s: 0.04,
            ..Preset::Paper.shoot()
        };
        let base = shoot.main_camera(size);
        let path = camera_path(&scene, &base, size, &shoot, 3000);
        let sees_ball = |step: &&PathStep| {
            let ball = scene.play.ball(step.time_s);
            PtzCamera::new(base, step.ptz)
                .image_from_world(ball)
                .is_ok_and(|image| size.contains(image))
        };
        let seen = path.iter().filter(sees_ball).count();
        assert!(seen > 2800, "the ball is in {seen} of 3000 frames");
        for pair in path.windows(2) {
            let (pan, tilt) = (
                pair[1].ptz.pan.turn_from(pair[0].ptz.pan),
                pair[1].ptz.tilt - pair[0].ptz.tilt,
            );
            assert!(
                pan.degrees().abs() < 1.0 && tilt.degrees().abs() < 0.4,
                "{pan} {tilt} at {} s",
                pair[1].time_s
            );
            // The stated motion equals the differences of the poses.
            let stated =
                (pair[0].motion.pan_per_s + pair[1].motion.pan_per_s) * (0.5 * shoot.step_s);
            assert!((stated - pan).degrees().abs() < 0.02, "{stated} for {pan}");
        }
    }
}
