//! The wgpu layers: frame picture, anti-aliased lines, points; on screen and off.

mod layer;
mod view;

pub use layer::{Layer, Picture, PictureKey};
pub use view::View;
