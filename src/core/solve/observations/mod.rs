//! What was seen in a picture, as observations of the field: a click on a landmark, a point of a
//! line, points that were drawn along one, and where drawn lines cross. [`shape`] has the residual
//! of each. Nothing here changes a camera; that is the optimiser's part.

pub mod crossings;
pub mod drawn_line;
mod line;
pub mod observation;
pub mod shape;
pub mod world_curve;
