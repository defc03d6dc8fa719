//! Drawn clips of cameras anywhere in the bowl, as people share them: clean, re-encoded at 360p, and
//! filmed off a screen.
//!
//! A clip is 5 to 15 s of an operator who follows the play, as 30 frames of it. Nothing is known of
//! the camera: it may stand on either side, behind a goal, in a corner or low on a mast, and roll
//! by up to 4°. `ffmpeg` encodes the two worse qualities.

use super::answers::{Measured, Tally, Way, answer, judge_answer, two_clicked};
use super::drawing::{SIZE, document};
use super::gate::Rate;
use super::matches::{Answered, soccer};
use super::scaled_camera::scaled_camera;
use image::RgbImage;
use image::imageops::{self, FilterType};
use std::fs;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};
use touchline::autocalibrate::{Abstention, AutocalibrationAnswer};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::{CameraId, FieldSpec, Frame};
use touchline::field::FieldModel;
use touchline::geometry::{Angle, ImageSize, Vec3};
use touchline::synthetic::{
    FrameOptions, Graphics, Preset, ShootOptions, StadiumOptions, camera_path, stadium,
};

/// Target: 21 right of 30 without a click, none wrong.
pub const RATE: Rate = Rate::never_wrong(30);

const FRAMES: usize = 30;

/// Where a camera stands.
#[derive(Clone, Copy, Debug)]
enum BowlPosition {
    MainStand,
    OtherSide,
    BehindGoal,
    Corner,
    LowMast,
}

/// What happened to a clip before it was shared.
#[derive(Clone, Copy, Debug)]
enum Quality {
    Clean,
    Reencoded360,
    OffScreen,
}

struct DrawnClip {
    place: BowlPosition,
    quality: Quality,
    field: FieldModel,
    base: CameraBase,
    shoot: ShootOptions,
    seed: u64,
}

impl DrawnClip {
    /// The clip of a number: everything spread evenly over what is possible (Weyl sequences of
    /// square roots of primes).
    fn of(number: usize) -> Self {
        let spread = |prime: f64, from: f64, to: f64| {
            from + (to - from) * ((number as f64 + 0.5) * prime.sqrt()).fract()
        };
        let sign = |prime: f64| {
            if spread(prime, -1.0, 1.0) < 0.0 {
                -1.0
            } else {
                1.0
            }
        };
        let place = [
            BowlPosition::MainStand,
            BowlPosition::OtherSide,
            BowlPosition::BehindGoal,
            BowlPosition::Corner,
            BowlPosition::LowMast,
        ][number % 5];
        let quality = [Quality::Clean, Quality::Reencoded360, Quality::OffScreen][number / 5 % 3];
        let field = soccer(
            spread(2.0, 100.0, 110.0),
            spread(3.0, 64.0, 72.0),
            spread(5.0, 0.0, 0.3),
        );
        let (half_length, half_width) = (0.5 * field.length_m, 0.5 * field.width_m);
        let along = spread(11.0, -0.6, 0.6) * half_length;
        let behind_m = spread(7.0, 10.0, 55.0);
        // Farther away stands higher, as seats do.
        let on_stand_m = 4.0 + behind_m * spread(13.0, 0.2, 0.6);
        let position_m = match place {
            BowlPosition::MainStand => Vec3::new(along, -half_width - behind_m, on_stand_m),
            BowlPosition::OtherSide => Vec3::new(along, half_width + behind_m, on_stand_m),
            BowlPosition::BehindGoal => Vec3::new(
                sign(17.0) * (half_length + behind_m),
                spread(11.0, -20.0, 20.0),
                on_stand_m,
            ),
            BowlPosition::Corner => Vec3::new(
                sign(17.0) * (half_length + 0.5 * behind_m),
                sign(19.0) * (half_width + 0.5 * behind_m),
                on_stand_m,
            ),
            BowlPosition::LowMast => Vec3::new(
                sign(17.0) * spread(11.0, 0.0, 1.05) * half_length,
                -half_width - spread(7.0, 4.0, 15.0),
                spread(13.0, 3.0, 8.0),
            ),
        };
        let preset = [Preset::Easy, Preset::Paper, Preset::Hard][number % 3];
        let mut shoot = ShootOptions {
            step_s: spread(23.0, 5.0, 15.0) / FRAMES as f64,
            ..preset.shoot()
        };
        // Who stands near looks with a wide lens.
        let middle_m = position_m.norm();
        let [short, long] = shoot.focal_px_at_1280;
        let nearer = (middle_m / 75.0).clamp(0.5, 1.3);
        shoot.focal_px_at_1280 = [short * nearer, long * nearer];
        let angles = BaseAngles {
            heading: Angle::from_radians((-position_m.x).atan2(-position_m.y)),
            pitch: Angle::ZERO,
            roll: Angle::from_degrees(spread(29.0, -4.0, 4.0)),
        };
        let base = CameraBase {
            position_m,
            base_from_world: angles.base_from_world(),
            ..shoot.main_camera(SIZE)
        };
        let seed = 5000 + number as u64;
        Self {
            place,
            quality,
            field,
            base,
            shoot,
            seed,
        }
    }

    /// The size of the shared pictures.
    fn size(&self) -> ImageSize {
        match self.quality {
            Quality::Clean | Quality::OffScreen => SIZE,
            Quality::Reencoded360 => ImageSize::new(640, 360),
        }
    }

    /// Draws the clip into a folder that lacks it; the cameras of the shared pictures.
    fn draw(&self, folder: &Path) -> Vec<PtzCamera> {
        let options = StadiumOptions {
            daylight: self.shoot.daylight,
            ..StadiumOptions::new(self.field.clone(), self.seed)
        };
        let scene = stadium(&options);
        let path = camera_path(&scene, &self.base, SIZE, &self.shoot, FRAMES);
        let is_drawn = folder.join(format!("{FRAMES:04}.jpg")).exists();
        let mut pictures = Vec::new();
        if !is_drawn {
            fs::create_dir_all(folder).unwrap();
            for (index, step) in path.iter().enumerate() {
                let camera = PtzCamera::new(self.base, step.ptz);
                let options = FrameOptions {
                    graphics: Graphics {
                        watermark: true,
                        ..Graphics::default()
                    },
                    ..self.shoot.frame(index, step, SIZE, self.seed)
                };
                let drawn = scene.render(&camera, SIZE, &options).image;
                pictures.push(self.share(drawn, index));
            }
            encode(&pictures, self.quality, folder);
        }
        path.iter().map(|step| self.as_shared(step.ptz)).collect()
    }

    /// The camera of a shared picture.
    fn as_shared(&self, ptz: Ptz) -> PtzCamera {
        let (scale, corner) = match self.quality {
            Quality::Clean => (1.0, [0.0, 0.0]),
            Quality::Reencoded360 => (2.0 / 3.0, [0.0, 0.0]),
            Quality::OffScreen => (SCREEN_SHARE, SCREEN_CORNER_PX),
        };
        scaled_camera(&PtzCamera::new(self.base, ptz), scale, corner)
    }

    /// What is shared of a drawn picture, before it is encoded.
    fn share(&self, drawn: RgbImage, index: usize) -> RgbImage {
        match self.quality {
            Quality::Clean => drawn,
            Quality::Reencoded360 => imageops::resize(&drawn, 640, 360, FilterType::Triangle),
            Quality::OffScreen => filmed_off_screen(&drawn, index),
        }
    }
}

/// A screen fills this share of a picture that is filmed off it, and begins at this pixel.
const SCREEN_SHARE: f64 = 0.9;
const SCREEN_CORNER_PX: [f64; 2] = [44.0, 17.0];

/// A picture filmed off a screen: smaller and not quite in the middle, soft, pale, with a moiré that
/// drifts and a brightness that flickers.
fn filmed_off_screen(drawn: &RgbImage, index: usize) -> RgbImage {
    let (width, height) = drawn.dimensions();
    let screen = imageops::resize(
        drawn,
        (f64::from(width) * SCREEN_SHARE) as u32,
        (f64::from(height) * SCREEN_SHARE) as u32,
        FilterType::Triangle,
    );
    let mut filmed = RgbImage::from_pixel(width, height, image::Rgb([24, 22, 26]));
    let [left, top] = SCREEN_CORNER_PX.map(|px| px as i64);
    imageops::replace(&mut filmed, &screen, left, top);
    let mut filmed = imageops::blur(&filmed, 1.1);
    let flicker = 1.0 + 0.06 * (1.7 * index as f32).sin();
    for (x, y, pixel) in filmed.enumerate_pixels_mut() {
        let phase = 0.9 * x as f32 + 0.23 * y as f32 + 0.8 * index as f32;
        let moire = 1.0 + 0.03 * phase.sin();
        pixel.0 = pixel
            .0
            .map(|level| (28.0 + 0.78 * f32::from(level) * flicker * moire) as u8);
    }
    filmed
}

/// Writes pictures as they come out of a video of their quality.
fn encode(pictures: &[RgbImage], quality: Quality, folder: &Path) {
    let crf = match quality {
        Quality::Clean => "16",
        Quality::Reencoded360 | Quality::OffScreen => "32",
    };
    let scratch = tempfile::tempdir().unwrap();
    for (index, picture) in pictures.iter().enumerate() {
        picture
            .save(scratch.path().join(format!("{:04}.png", index + 1)))
            .unwrap();
    }
    let video = scratch.path().join("clip.mp4");
    let ffmpeg = |arguments: &[&str]| {
        let status = Command::new("ffmpeg")
            .args(["-hide_banner", "-loglevel", "error", "-y"])
            .args(arguments)
            .current_dir(scratch.path())
            .stdin(Stdio::null())
            .status()
            .unwrap();
        assert!(status.success(), "ffmpeg {arguments:?}");
    };
    ffmpeg(&[
        "-i",
        "%04d.png",
        "-c:v",
        "libx264",
        "-pix_fmt",
        "yuv420p",
        "-crf",
        crf,
        video.to_str().unwrap(),
    ]);
    let names = folder.canonicalize().unwrap().join("%04d.jpg");
    ffmpeg(&[
        "-i",
        video.to_str().unwrap(),
        "-q:v",
        "2",
        names.to_str().unwrap(),
    ]);
}

/// The cameras, or after half a turn of the field, which looks the same, where the answer is nearer
/// to these.
fn turn_as_answered(truth: Vec<PtzCamera>, answer: &AutocalibrationAnswer) -> Vec<PtzCamera> {
    let found = match answer {
        AutocalibrationAnswer::Found(found)
        | AutocalibrationAnswer::Abstained {
            why: Abstention::Uncertain {
                best: Some(found), ..
            },
            ..
        } => found,
        AutocalibrationAnswer::Abstained { .. } => return truth,
    };
    let at_m = found.base.position_m;
    let truth_m = truth[0].base().position_m;
    let opposite_m = truth[0].after_half_turn().base().position_m;
    if (at_m - opposite_m).norm() < (at_m - truth_m).norm() {
        truth.iter().map(PtzCamera::after_half_turn).collect()
    } else {
        truth
    }
}

/// The drawn clips; those that are not found without a click are asked again with two, in the
/// frame that the answer names.
pub fn clips(pictures: &Path, numbers: Range<usize>) -> Answered {
    println!("\n## bowl: clips of {FRAMES} frames from anywhere in the bowl\n");
    println!("| clip | field, m | camera, m | answer | s |\n|---|---|---|---|---|");
    let mut all = Answered {
        without_clicks: Tally::default(),
        two_clicks: Tally::default(),
    };
    for number in numbers {
        let clip = DrawnClip::of(number);
        let folder = pictures.join(format!("clip-{number:02}"));
        let truth = clip.draw(&folder);
        let mut document = document(FieldSpec::new("soccer"), clip.size());
        for index in 1..=FRAMES {
            let name = format!("{index:04}.jpg");
            let camera = CameraId::from(super::drawing::CAMERA);
            document
                .frames
                .push(Frame::from_image(&name, camera, clip.size()).into());
        }
        let row = |(says, seconds): (&str, f64)| {
            let at = clip.base.position_m;
            println!(
                "| {number} {:?} {:?} | {:.1} × {:.1} | ({:.1}, {:.1}, {:.1}) | {says} | {seconds:.0} |",
                clip.place, clip.quality, clip.field.length_m, clip.field.width_m, at.x, at.y, at.z
            );
        };
        let (answer_alone, seconds) = answer(&document, &folder, Way::WithoutClicks);
        let truth = turn_as_answered(truth, &answer_alone);
        let (says, tally) = judge_answer(
            &document,
            &answer_alone,
            Some((&truth, &clip.field)),
            Measured::Lines,
        );
        row((&says, seconds));
        all.without_clicks.add(&tally);
        if !matches!(answer_alone, AutocalibrationAnswer::Found(_)) {
            let frames = match &answer_alone {
                AutocalibrationAnswer::Abstained {
                    clicks: Some(wanted),
                    ..
                } => wanted.frame..wanted.frame + 1,
                _ => 0..FRAMES,
            };
            let with_clicks = two_clicked(&document, frames, &truth, &clip.field);
            let (answer, seconds) = answer(&with_clicks, &folder, Way::FewClicks);
            let (says, tally) = judge_answer(
                &with_clicks,
                &answer,
                Some((&truth, &clip.field)),
                Measured::Lines,
            );
            row((&format!("two clicks: {says}"), seconds));
            all.two_clicks.add(&tally);
        }
    }
    println!(
        "\nwithout a click: {}\nwith two clicks: {}",
        all.without_clicks, all.two_clicks
    );
    all
}
