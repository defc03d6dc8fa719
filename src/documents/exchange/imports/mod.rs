//! From foreign files to a document. The format is recognised, its reader gives cameras or clicks,
//! and these become frames of a new document. Imported labels are then joined with an open
//! document: their frames are matched to its pictures, or attached to the frames of its only video.
//! How a format is read is not decided here.

pub mod attach;
pub mod import;
mod import_cameras;
pub mod import_clicks;
pub mod imported;
pub mod join;
mod lookalike;
pub mod picture_points;
mod pictures;
mod places;
pub mod recognize;
