//! What a canvas shows, from the bottom up.

use crate::scene::PictureLook;
use crate::scene::drawing::Drawing;
use crate::scene::uncertainty::HeatMap;
use std::sync::Arc;
use touchline_vision::media;

/// The identity of a picture's pixels: equal keys mean equal pixels, so that they are uploaded
/// once.
///
/// The caller makes it from what it knows, such as a frame's number and a generation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PictureKey(pub u64);

/// A picture, with its top-left corner at the origin.
#[derive(Clone, Debug)]
pub struct PictureLayer {
    /// What its pixels are known by.
    pub key: PictureKey,
    /// sRGB bytes; shown as they are, in gamma space.
    pub pixels: media::Picture,
    /// How bright it is; darker lets lines stand out.
    pub look: PictureLook,
}

/// One layer of a canvas.
#[derive(Clone, Debug)]
pub enum Layer {
    /// A frame.
    Picture(PictureLayer),
    /// Colours over a frame that say how far the lines are to be trusted, at an opacity from 0 to
    /// 1.
    Heat(Arc<HeatMap>, f32),
    /// Lines, areas and markers over it.
    Drawing(Arc<Drawing>),
}
