//! The pictures that a search asks for, and what it keeps of each.

use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_vision::features::{FeatureError, FeatureOptions, Features, extract};
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, Strokes};

/// The pictures of a document's frames, by their places in it; none where one cannot be read.
pub type PictureOfFrame<'a> = &'a mut dyn FnMut(usize) -> Option<Picture>;

/// What is kept of a frame's picture.
#[derive(Clone, Debug)]
pub(super) struct FrameTraces {
    pub features: Features,
    pub strokes: Strokes,
}

impl FrameTraces {
    /// Of a picture; nothing within `masks` (px) counts.
    ///
    /// # Errors
    /// The program was built without OpenCV, or OpenCV refused.
    pub fn of(picture: &Picture, masks: &[PixelBox]) -> Result<Self, FeatureError> {
        let options = FeatureOptions { root_sift: true, ..FeatureOptions::default() };
        let features = extract(picture, masks, &options)?;
        let strokes = Strokes::of(&GroundPicture::new(picture, masks));
        Ok(Self { features, strokes })
    }

    pub fn size(&self) -> ImageSize {
        self.strokes.size()
    }
}
