//! The transform from a picture to a canvas.

use crate::scene::PictureLook;
use crate::scene::drawing::Drawing;
use crate::scene::uncertainty::HeatMap;
use std::sync::Arc;
use touchline_vision::media;

/// The transform from picture to canvas, and the size of the canvas.
///
/// `canvas = image × scale + offset_px`, both in the corner convention: (0, 0) is the top-left
/// corner, and the centre of the first pixel is (0.5, 0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Physical px of the canvas per px of the picture.
    pub scale: f32,
    /// Position of the picture's top-left corner, physical px of the canvas.
    pub offset_px: [f32; 2],
    /// Size of the canvas, physical px.
    pub size_px: [u32; 2],
    /// Physical px per point: converts sizes in points.
    pub pixels_per_point: f32,
}

impl View {
    /// A picture at its own size, one px of the canvas for each of its px.
    pub const fn one_to_one(size_px: [u32; 2]) -> Self {
        Self {
            scale: 1.0,
            offset_px: [0.0, 0.0],
            size_px,
            pixels_per_point: 1.0,
        }
    }

    /// A picture scaled to fit the canvas, centred.
    pub fn fit(picture_px: [u32; 2], size_px: [u32; 2]) -> Self {
        let [width, height] = picture_px.map(|side| side.max(1) as f32);
        let [canvas_width, canvas_height] = size_px.map(|side| side as f32);
        let scale = (canvas_width / width).min(canvas_height / height);
        let offset_px = [
            (canvas_width - width * scale) / 2.0,
            (canvas_height - height * scale) / 2.0,
        ];
        Self {
            scale,
            offset_px,
            size_px,
            pixels_per_point: 1.0,
        }
    }

    /// The point of the canvas for a point of the picture, physical px.
    pub fn canvas_from_image(&self, point: [f32; 2]) -> [f32; 2] {
        [
            point[0] * self.scale + self.offset_px[0],
            point[1] * self.scale + self.offset_px[1],
        ]
    }
}

/// The identity of a picture's pixels: equal keys mean equal pixels, so that they are uploaded
/// once. The caller chooses the keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PictureKey(pub u64);

/// A picture with its top-left corner at the origin.
#[derive(Clone, Debug)]
pub struct PictureLayer {
    /// Identifies the pixels.
    pub key: PictureKey,
    /// sRGB bytes; drawn unchanged, in gamma space.
    pub pixels: media::Picture,
    /// Brightness, contrast and gamma. A darker picture makes lines stand out.
    pub look: PictureLook,
}

/// One layer of a canvas.
#[derive(Clone, Debug)]
pub enum Layer {
    /// A frame.
    Picture(PictureLayer),
    /// A heat map of the overlay's uncertainty, and its opacity from 0 to 1.
    Heat(Arc<HeatMap>, f32),
    /// Lines, areas and markers.
    Drawing(Arc<Drawing>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fitted_picture_is_centred() {
        let view = View::fit([1920, 1080], [960, 960]);
        assert_eq!(view.scale, 0.5);
        assert_eq!(view.offset_px, [0.0, 210.0]);
        assert_eq!(view.canvas_from_image([1920.0, 1080.0]), [960.0, 750.0]);
    }
}
