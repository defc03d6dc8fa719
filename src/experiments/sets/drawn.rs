//! Drawn sequences like the paper's two sets.

use super::{FrameSet, KnownFrame, KnownPicture, SetKind, Split};
use crate::camera::PtzCamera;
use crate::experiments::{ExperimentError, ExperimentOptions};
use crate::features::{FeatureOptions, Features, extract};
use crate::field::builtin;
use crate::geometry::{ImageSize, PixelBox};
use crate::media::{FrameReader, MediaError, Picture};
use crate::synthetic::{PathStep, Preset, ShootOptions, Stadium, StadiumOptions, camera_path, stadium};
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, RgbImage};
use rayon::prelude::*;

/// Seconds between the frames of a sequence like the paper's highlights, and from the start of one to that of the next.
const HIGHLIGHTS_STEP_S: f64 = 0.8;
const HIGHLIGHTS_EVERY_S: f64 = 90.0;
/// Seconds between the frames of a game like the World Cup's.
const WORLDCUP_STEP_S: f64 = 7.0;

/// A picture and everything about it that is known.
pub(super) struct Order<'a> {
    pub scene: &'a Stadium,
    pub camera: PtzCamera,
    pub step: PathStep,
    pub number: usize,
    pub shoot: &'a ShootOptions,
    pub size: ImageSize,
    pub seed: u64,
}

/// Four sequences of 29 frames of one match from one camera; each is asked of the other three.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn highlights(
    options: &ExperimentOptions,
    preset: Preset,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let (sequences, frames) = (options.sized(4, 3), options.sized(29, 5));
    let size = picture_size(options);
    let shoot = ShootOptions { step_s: HIGHLIGHTS_STEP_S, ..preset.shoot() };
    let scene = drawn_stadium(&shoot, options.seed.wrapping_add(11))?;
    let base = shoot.main_camera(size);
    let every = (HIGHLIGHTS_EVERY_S / HIGHLIGHTS_STEP_S) as usize;
    let path = camera_path(&scene, &base, size, &shoot, every * sequences);
    let stride = options.sized(1, 6);
    let orders: Vec<Order<'_>> = (0..sequences)
        .flat_map(|sequence| (0..frames).map(move |frame| sequence * every + frame * stride))
        .map(|number| Order {
            scene: &scene,
            camera: PtzCamera::new(base, path[number].ptz),
            step: path[number],
            number,
            shoot: &shoot,
            size,
            seed: options.seed,
        })
        .collect();
    let frames_of = |sequence: usize| sequence * frames..(sequence + 1) * frames;
    let split = |sequence: usize| Split {
        name: format!("sequence {}", sequence + 1),
        training_frames: (0..sequences * frames).filter(|frame| !frames_of(sequence).contains(frame)).collect(),
        asked: frames_of(sequence).collect(),
    };
    Ok(FrameSet {
        kind: SetKind::Drawn,
        title: format!("drawn, {sequences} sequences of {frames} frames, {} × {} px", size.width, size.height),
        protocol: "Each sequence is tested against the frames of all others.".to_owned(),
        frames: take(&orders, progress)?,
        splits: (0..sequences).map(split).collect(),
    })
}

/// Two games of 42 and 33 frames, each by its own camera; every other frame is used for training.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn worldcup(options: &ExperimentOptions, progress: &(dyn Fn() + Sync)) -> Result<FrameSet, ExperimentError> {
    let counts = if options.quick { [8, 6] } else { [42, 33] };
    let size = picture_size(options);
    let shoot = ShootOptions { step_s: WORLDCUP_STEP_S, ..Preset::Paper.shoot() };
    let mut set = FrameSet {
        kind: SetKind::Drawn,
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
        let seed = options.seed.wrapping_add(23 + game as u64);
        let scene = drawn_stadium(&shoot, seed)?;
        let base = shoot.main_camera(size);
        let path = camera_path(&scene, &base, size, &shoot, count);
        let orders: Vec<Order<'_>> = path
            .iter()
            .enumerate()
            .map(|(number, step)| Order {
                scene: &scene,
                camera: PtzCamera::new(base, step.ptz),
                step: *step,
                number,
                shoot: &shoot,
                size,
                seed,
            })
            .collect();
        let first = set.frames.len();
        set.frames.extend(take(&orders, progress)?);
        let of_game = |parity: usize| (first..first + count).filter(|frame| (frame - first) % 2 == parity).collect();
        set.splits.push(Split { name: format!("game {}", game + 1), training_frames: of_game(0), asked: of_game(1) });
    }
    Ok(set)
}

pub(super) fn picture_size(options: &ExperimentOptions) -> ImageSize {
    if options.quick { ImageSize::new(640, 360) } else { ImageSize::new(1280, 720) }
}

fn drawn_stadium(shoot: &ShootOptions, seed: u64) -> Result<Stadium, ExperimentError> {
    let field = builtin("soccer")?.default_model()?;
    Ok(stadium(&StadiumOptions { daylight: shoot.daylight, ..StadiumOptions::new(field, seed) }))
}

/// Draws the pictures, and finds their features: outside players and the score graphic, as a detector of players would leave
/// them out.
pub(super) fn take(orders: &[Order<'_>], progress: &(dyn Fn() + Sync)) -> Result<Vec<KnownFrame>, ExperimentError> {
    let one = |order: &Order<'_>| {
        let options = order.shoot.frame(order.number, &order.step, order.size, order.seed);
        let drawn = order.scene.render(&order.camera, order.size, &options);
        let masks: Vec<PixelBox> =
            drawn.movers.iter().map(|mover| mover.area).chain(drawn.graphics.iter().copied()).collect();
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, order.shoot.jpeg_quality).encode_image(&drawn.image)?;
        let field = order.scene.field().clone();
        let picture = KnownPicture::Drawn(jpeg);
        let mut known = KnownFrame {
            name: format!("drawn frame {}", order.number),
            warnings: String::new(),
            truth: order.camera,
            features: Features::default(),
            field,
            picture,
            masks,
        };
        // Features are those of the JPEG file, as a user's would be.
        let decoded = as_picture(known.picture(&mut FrameReader::new())?)?;
        known.features = extract(&decoded, &known.masks, &FeatureOptions::default())?;
        progress();
        Ok(known)
    };
    orders.par_iter().map(one).collect()
}

/// A decoded image as a picture.
pub fn as_picture(image: RgbImage) -> Result<Picture, MediaError> {
    let rgba = DynamicImage::from(image).into_rgba8();
    Picture::new(ImageSize::new(rgba.width(), rgba.height()), rgba.into_raw())
}
