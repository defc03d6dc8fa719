//! Pictures that are drawn, with everything about them that is known.

use super::{KnownFrame, KnownPicture};
use crate::{ExperimentError, ExperimentOptions};
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, RgbImage};
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_vision::features::{FeatureOptions, Features, extract};
use touchline_vision::media::{FrameReader, MediaError, Picture};
use touchline_vision::synthetic::{Moment, PathStep, ShootOptions, Stadium};

/// A picture that is to be drawn.
pub(super) struct Order<'a> {
    pub scene: &'a Stadium,
    pub moment: Moment,
    pub camera: PtzCamera,
    pub step: PathStep,
    /// Chooses its noise, with the seed.
    pub number: usize,
    /// Brightness beside what varies from frame to frame, stops.
    pub exposure_ev: f64,
    pub shoot: &'a ShootOptions,
    pub size: ImageSize,
    pub seed: u64,
}

/// Whether features on players and graphics are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Players {
    /// As a program has them that knows nothing of players.
    Kept,
    /// As a detector of players would leave them out.
    Masked,
}

/// The size of drawn pictures.
pub(super) fn picture_size(options: &ExperimentOptions) -> ImageSize {
    if options.quick {
        ImageSize::new(640, 360)
    } else {
        ImageSize::new(1280, 720)
    }
}

/// Draws the pictures, and finds their features.
pub(super) fn take(
    orders: &[Order<'_>],
    players: Players,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<KnownFrame>, ExperimentError> {
    let one = |order: &Order<'_>| {
        let mut options = order
            .shoot
            .frame(order.number, &order.step, order.size, order.seed);
        options.exposure_ev += order.exposure_ev;
        let drawn = order
            .scene
            .at(&order.moment)
            .render(&order.camera, order.size, &options);
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
        // Features are those of the JPEG file, as a user's would be.
        let decoded = as_picture(known.picture(&mut FrameReader::new())?)?;
        known.features = extract(&decoded, known.used_masks(), &FeatureOptions::default())?;
        progress();
        Ok(known)
    };
    orders.par_iter().map(one).collect()
}

/// A picture as the detectors take it.
///
/// # Errors
/// It has no pixels.
pub fn as_picture(image: RgbImage) -> Result<Picture, MediaError> {
    let rgba = DynamicImage::from(image).into_rgba8();
    Picture::new(ImageSize::new(rgba.width(), rgba.height()), rgba.into_raw())
}
