//! The layers of a canvas, from bottom to top.

use crate::scene::PictureLook;
use crate::scene::drawing::Drawing;
use crate::scene::uncertainty::HeatMap;
use std::sync::Arc;
use touchline_vision::media;

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
