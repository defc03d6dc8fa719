//! What is drawn over a picture or a map, as plain data: overlay, uncertainty, field map, next
//! click.
//!
//! A [`drawing`] knows neither widgets nor the graphics card; `render` draws it, on the screen or
//! off it.

pub mod drawing;
pub mod field_map;
mod line_colours;
pub mod next_click;
pub mod overlay;
pub mod paint_map;
mod style;
pub mod timeline;
pub mod uncertainty;

pub use line_colours::{Ground, LINE_COLOURS, LineColour, SPORTS, Sport};
pub use style::{OverlayStyle, PictureLook};
