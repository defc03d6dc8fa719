//! A picture prepared for the search for paint.

use super::surface::GroundPart;
use crate::media::{GreyPicture, Picture, grey_reduced};
use crate::paint::Surface;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// A picture with its brightness, the colours of its ground, and boxes to be ignored.
#[derive(Clone, Debug)]
pub struct GroundPicture {
    picture: Picture,
    grey: GreyPicture,
    surface: Surface,
    masks: Vec<PixelBox>,
}

impl GroundPicture {
    /// Prepares a picture. Pixels within `masks` (px) show no ground: graphics, score bugs.
    pub fn new(picture: &Picture, masks: &[PixelBox]) -> Self {
        Self {
            picture: picture.clone(),
            grey: grey_reduced(picture, 1),
            surface: Surface::from_picture(picture),
            masks: masks.to_vec(),
        }
    }

    /// The same picture with another ground.
    pub(in crate::paint) fn with_surface(&self, surface: Surface) -> Self {
        Self {
            surface,
            ..self.clone()
        }
    }

    /// Width and height, px.
    pub const fn size(&self) -> ImageSize {
        self.picture.size()
    }

    /// The colours of the ground.
    pub const fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The picture in colour.
    pub(in crate::paint) const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The brightness at full resolution.
    pub(in crate::paint) const fn grey(&self) -> &GreyPicture {
        &self.grey
    }

    /// Whether the pixel at a point has one of the ground's colours. False outside the picture.
    pub fn is_ground(&self, at: ImagePoint) -> bool {
        self.part(at).is_some()
    }

    /// The part of the ground that the pixel at a point belongs to. None outside the picture.
    pub(in crate::paint) fn part(&self, at: ImagePoint) -> Option<GroundPart> {
        // As an integer, a negative number or NaN would be 0, a pixel of the picture.
        if !(at.x >= 0.0 && at.y >= 0.0) {
            return None;
        }
        let [red, green, blue, _] = self.picture.pixel(at.x as u32, at.y as u32)?;
        self.surface.part([red, green, blue])
    }

    /// The boxes to be ignored, px.
    pub(in crate::paint) fn masks(&self) -> &[PixelBox] {
        &self.masks
    }

    /// Whether a point lies in one of the masks.
    pub fn is_masked(&self, at: ImagePoint) -> bool {
        self.masks.iter().any(|mask| mask.contains(at))
    }
}
