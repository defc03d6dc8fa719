//! What is drawn over a picture or a map, as plain data.
//!
//! | module | draws |
//! |---|---|
//! | [`drawing`] | the types: strokes, areas, markers, labels |
//! | [`overlay`] | the field's lines, landmarks and clicks over a frame |
//! | [`uncertainty`] | 1-σ of the lines, as a band or a heat map |
//! | [`next_click`] | the landmarks that are worth clicking next |
//! | [`field_map`] | the field from above |
//! | [`paint_map`] | paint and lines over pan and tilt |
//! | [`match_list`] | the matches of a queue as rows of a list |
//! | [`shot_list`] | the shots of a document as rows of a table |
//! | [`timeline`] | the frames of a document on one line |
//!
//! The functions are pure: from a field, a camera and clicks to data. They know neither widgets nor
//! the graphics card. `render` draws the result, on screen or off.

pub mod drawing;
pub mod drawn_element;
pub mod field_map;
mod line_colours;
pub mod match_list;
pub mod next_click;
pub mod overlay;
pub mod paint_map;
pub mod shot_list;
mod style;
pub mod timeline;
pub mod uncertainty;

pub use line_colours::{Ground, LINE_COLOURS, LineColour, SPORTS, Sport};
pub use style::{OverlayStyle, PictureLook};
