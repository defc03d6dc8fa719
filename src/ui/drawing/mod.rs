//! Pictures on the screen: where a picture is shown, how its px become points, the place that the
//! renderer draws, and labels in the window's own font. Everything that shows a frame builds on
//! this. Input by pointer or key is not handled here.

pub mod canvas;
pub mod labels;
pub mod pictures;
pub mod placement;
