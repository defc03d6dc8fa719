//! No step makes an answer worse: cameras of a drawn clip, some known through a wrong lens, some
//! among boards that scroll or before a dissolve, go through the commands in random order.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use crate::drawn_clip::{drawn_clip, landmark_errors_px};
use crate::program::touchline;
use image::{Rgb, RgbImage};
use rand::seq::IndexedRandom;
use std::path::Path;
use touchline::camera::PtzCamera;
use touchline::document::{Document, Frame, FrameStatus};
use touchline::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::testing::seeded;
use touchline_documents::testing::{load, save};

/// The commands between which an annotator chooses.
const STEPS: [&str; 4] = [
    "track",
    "track --refine-base",
    "refine-base --markings",
    "snap",
];

/// Steps of each story.
const LENGTH: usize = 3;

/// What a frame is off by is measured to this, px of a frame 640 px wide: landmarks at a picture's
/// border weigh as much as those in its middle, which paint and points hold.
const NOISE_PX: f64 = 1.0;

/// Frames of the clip that stay what they are where it dissolves into another shot, and those in
/// which it does.
const BEFORE_DISSOLVE: usize = 18;
const DISSOLVING: usize = 6;

/// What a broadcast has and the field's model has not. All stories have a score bug that no mask
/// covers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Disturbance {
    /// Nothing more.
    None,
    /// Boards behind the far touchline scroll by half a metre a frame.
    Boards,
    /// The clip dissolves into another shot of another match.
    Dissolve,
}

impl Disturbance {
    /// Draws it into the clip's pictures.
    fn draw(self, folder: &Path, truth: &Document) {
        match self {
            Self::None => {}
            Self::Boards => {
                for (index, frame) in truth.frames.iter().enumerate() {
                    let path = folder.join(frame.image.as_ref().unwrap());
                    let mut picture = image::open(&path).unwrap().into_rgb8();
                    draw_boards(
                        &mut picture,
                        &truth.ptz_camera(frame).unwrap(),
                        0.5 * index as f64,
                    );
                    picture.save(&path).unwrap();
                }
            }
            Self::Dissolve => {
                let other = tempfile::tempdir().unwrap();
                draw(
                    other.path(),
                    "--frames 12 --step 0.04 --seed 9 --size 640x360 --preset easy --unmasked",
                );
                for (index, frame) in truth.frames.iter().enumerate().skip(BEFORE_DISSOLVE) {
                    let path = folder.join(frame.image.as_ref().unwrap());
                    let behind = format!("match/images/{:04}.jpg", index + 1 - BEFORE_DISSOLVE);
                    let (picture, behind) = (
                        image::open(&path).unwrap(),
                        image::open(other.path().join(behind)).unwrap(),
                    );
                    let share =
                        ((index + 1 - BEFORE_DISSOLVE) as f32 / (DISSOLVING + 1) as f32).min(1.0);
                    blend(&picture.into_rgb8(), &behind.into_rgb8(), share)
                        .save(&path)
                        .unwrap();
                }
            }
        }
    }

    /// What is known of the clip, for the frames after a dissolve are of another shot.
    fn adjust(self, document: &mut Document, truth: &Document) {
        if self == Self::Dissolve {
            let (first, last) = (document.frames[0].clone(), document.frames.len() - 1);
            let known = &mut document.frames[BEFORE_DISSOLVE - 1];
            (known.status, known.solution) = (FrameStatus::Reference, first.solution.clone());
            known.ptz.clone_from(&truth.frames[BEFORE_DISSOLVE - 1].ptz);
            let last = &mut document.frames[last];
            (last.status, last.ptz, last.solution) = (FrameStatus::New, None, None);
        }
    }

    /// The frames that still show what the truth says.
    fn frames_of_clip(self, truth: &Document) -> usize {
        if self == Self::Dissolve {
            BEFORE_DISSOLVE
        } else {
            truth.frames.len()
        }
    }
}

/// Boards of one metre behind the far touchline, in stripes of 1.5 m that stand at `offset_m` along
/// it.
fn draw_boards(picture: &mut RgbImage, camera: &PtzCamera, offset_m: f64) {
    const BEHIND_M: f64 = 37.0;
    let eye = camera.base().position_m;
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let at = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let Some(ground) = camera.plane_from_image(at, 0.0) else {
            continue;
        };
        // Where the ray to the ground behind the boards meets their plane.
        let on_board: Vec3 = eye + (ground - eye) * ((BEHIND_M - eye.y) / (ground.y - eye.y));
        if ground.y > BEHIND_M && (0.0..1.0).contains(&on_board.z) {
            let is_light = ((on_board.x + offset_m) / 1.5).rem_euclid(2.0) < 1.0;
            *pixel = if is_light {
                Rgb([235, 235, 60])
            } else {
                Rgb([20, 30, 140])
            };
        }
    }
}

/// A picture with this share of another.
fn blend(picture: &RgbImage, other: &RgbImage, share: f32) -> RgbImage {
    let mixed =
        |from: u8, to: u8| (f32::from(from) * (1.0 - share) + f32::from(to) * share).round() as u8;
    RgbImage::from_fn(picture.width(), picture.height(), |x, y| {
        let (from, to) = (picture.get_pixel(x, y).0, other.get_pixel(x, y).0);
        Rgb([
            mixed(from[0], to[0]),
            mixed(from[1], to[1]),
            mixed(from[2], to[2]),
        ])
    })
}

/// How the lens of the document differs from the one that drew the pictures.
#[derive(Clone, Copy, Debug)]
enum Lens {
    /// Not at all.
    Right,
    /// Its distortion by 2 % of the distance to the middle, at the corner.
    Bent,
    /// Its principal point by 50 px of a frame 1920 px wide.
    OffCentre,
}

impl Lens {
    fn apply(self, document: &mut Document) {
        let camera = document.cameras[0].id.clone();
        let mut base = document.camera(&camera).unwrap().base().unwrap();
        match self {
            Self::Right => {}
            Self::Bent => {
                let focal_px = document.frames[0].ptz.as_ref().unwrap().focal_px;
                let corner = base.principal_point.offset_from(ImagePoint::new(0.0, 0.0));
                base.distortion.value += 0.02 * (focal_px / corner.norm()).powi(2);
            }
            Self::OffCentre => {
                base.principal_point = base.principal_point.translate(Vec2::new(50.0, 0.0) / 3.0);
            }
        }
        document.camera_mut(&camera).unwrap().set_base(&base);
    }
}

fn confidence(frame: &Frame) -> Option<f64> {
    frame.solution.as_ref()?.confidence
}

fn has_reason(frame: &Frame) -> bool {
    frame
        .solution
        .as_ref()
        .is_some_and(|solution| !solution.warnings.is_empty())
}

/// The middle one of a frame's landmark errors, px.
fn off_px(document: &Document, truth: &Document, frame: usize) -> Option<f64> {
    let mut errors = landmark_errors_px(document, truth, frame)?;
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied()
}

#[test]
fn no_step_makes_a_camera_worse_than_it_states_nor_doubts_it_without_a_reason() {
    let stories =
        std::env::var("TOUCHLINE_STORIES").map_or(1, |count| count.parse::<usize>().unwrap());
    let mut rng = seeded::rng("no_step_makes_a_camera_worse");
    for disturbance in [
        Disturbance::None,
        Disturbance::Boards,
        Disturbance::Dissolve,
    ] {
        let place = tempfile::tempdir().unwrap();
        let truth = drawn_clip(place.path());
        let folder = place.path().join("match");
        disturbance.draw(&folder, &truth);
        let lenses: &[Lens] = match disturbance {
            Disturbance::None => &[Lens::Bent, Lens::OffCentre],
            Disturbance::Boards => &[Lens::OffCentre],
            Disturbance::Dissolve => &[Lens::Right],
        };
        for lens in std::iter::repeat_n(lenses, stories).flatten() {
            let mut start = load(folder.join("ask.json"));
            lens.apply(&mut start);
            disturbance.adjust(&mut start, &truth);
            let story = format!("{disturbance:?}, {lens:?}");
            let steps: Vec<&str> = (0..LENGTH)
                .map(|_| *STEPS.choose(&mut rng).unwrap())
                .collect();
            run_story(&folder, start, &steps, &story, |before, after, story| {
                for index in 0..disturbance.frames_of_clip(&truth) {
                    compare((before, after), &truth, index, story);
                }
                for index in disturbance.frames_of_clip(&truth) + DISSOLVING..truth.frames.len() {
                    let frame = &after.frames[index];
                    assert!(
                        confidence(frame).is_none_or(|now| now < 0.9),
                        "{story}: frame {index} is of another shot"
                    );
                }
            });
        }
    }
}

/// Takes steps one after the other, and has each compared with what was there before.
fn run_story(
    folder: &Path,
    start: Document,
    steps: &[&str],
    start_of_story: &str,
    compare: impl Fn(&Document, &Document, &str),
) {
    let (mut before, mut story) = (start, start_of_story.to_owned());
    for step in steps {
        story = format!("{story}; {step}");
        let (command, options) = step.split_once(' ').unwrap_or((step, ""));
        save(folder.join("before.json"), &before);
        let ran = touchline(
            folder,
            &format!("{command} before.json {options} -o after.json --force"),
        );
        if ran.code == 2 {
            // It says why it cannot, and nothing is written.
            continue;
        }
        let after = load(folder.join("after.json"));
        compare(&before, &after, &story);
        before = after;
    }
}

/// Whether a step left a frame's camera as good as it was.
fn compare((before, after): (&Document, &Document), truth: &Document, index: usize, story: &str) {
    let (was, is) = (&before.frames[index], &after.frames[index]);
    let (Some(was_px), Some(is_px)) = (off_px(before, truth, index), off_px(after, truth, index))
    else {
        return;
    };
    let stated_px = is
        .solution
        .as_ref()
        .and_then(|solution| solution.worst_corner_sigma_px)
        .unwrap_or(0.0);
    assert!(
        is_px <= was_px + NOISE_PX.max(stated_px),
        "{story}: frame {index} went from {was_px} to {is_px} px"
    );
    if confidence(was).is_some_and(|confidence| confidence >= 0.9)
        && confidence(is).is_some_and(|now| now < 0.5)
    {
        assert!(
            has_reason(is),
            "{story}: frame {index} is doubted without a reason"
        );
    }
}
