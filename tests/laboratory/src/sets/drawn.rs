//! Draws synthetic pictures with their ground truth.

use super::{KnownFrame, KnownPicture};
use crate::{ExperimentError, ExperimentOptions};
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, RgbImage};
use rayon::prelude::*;
use touchline::camera::PtzCamera;
use touchline::features::{FeatureOptions, Features, extract};
use touchline::geometry::{ImageSize, PixelBox};
use touchline::media::{FrameReader, MediaError, Picture};
use touchline::synthetic::{Moment, PathStep, ShootOptions, Stadium};

/// A picture to be drawn.
pub(super) struct Order<'a> {
    pub scene: &'a Stadium,
    pub moment: Moment,
    pub camera: PtzCamera,
    pub step: PathStep,
    /// Its number. Together with the seed it determines the noise.
    pub number: usize,
    /// Exposure in addition to that which varies from frame to frame, stops.
    pub exposure_ev: f64,
    pub shoot: &'a ShootOptions,
    pub size: ImageSize,
    pub seed: u64,
}

/// Whether features on players and graphics are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Players {
    /// Used: the program does not know where players are.
    Kept,
    /// Left out, as if a detector of players had found all of them.
    Masked,
}

/// Size of synthetic pictures.
pub(super) fn picture_size(options: &ExperimentOptions) -> ImageSize {
    if options.quick {
        ImageSize::new(640, 360)
    } else {
        ImageSize::new(1280, 720)
    }
}

/// Draws the pictures and extracts their features.
pub(super) fn take(
    orders: &[Order<'_>],
    players: Players,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<KnownFrame>, ExperimentError> {
    let one = |order: &Order<'_>| {
        let mut options = order
            .shoot
            .frame(order.number, &order.step, order.size, order.seed);
        // The exposure of the sequence, on top of that which varies from frame to frame.
        options.exposure_ev += order.exposure_ev;
        let drawn = order
            .scene
            .at(&order.moment)
            .render(&order.camera, order.size, &options);
        // Players and graphics, known exactly because they are drawn.
        let masks: Vec<PixelBox> = drawn
            .movers
            .iter()
            .map(|mover| mover.area)
            .chain(drawn.graphics.iter().copied())
            .collect();
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, order.shoot.jpeg_quality)
            .encode_image(&drawn.image)?;
        let mut known = KnownFrame {
            name: format!("drawn frame {}", order.number),
            warnings: String::new(),
            truth: order.camera,
            features: Features::default(),
            field: order.scene.field().clone(),
            picture: KnownPicture::Drawn(jpeg),
            masks,
            is_masked: players == Players::Masked,
        };
        // Extract features from the compressed picture, as with a user's file.
        let decoded = as_picture(known.picture(&mut FrameReader::new())?)?;
        known.features = extract(&decoded, known.used_masks(), &FeatureOptions::default())?;
        progress();
        Ok(known)
    };
    orders.par_iter().map(one).collect()
}

/// Converts a picture for the feature detectors.
///
/// # Errors
/// The picture has no pixels.
pub fn as_picture(image: RgbImage) -> Result<Picture, MediaError> {
    let rgba = DynamicImage::from(image).into_rgba8();
    Picture::new(ImageSize::new(rgba.width(), rgba.height()), rgba.into_raw())
}
