//! Small pictures that explain numbers: maps over the field or over pan and tilt, a panorama of
//! paint, thumbnails with the field's lines, and plots. Several panels show them. They draw with
//! egui alone, from values that the application derived.

pub mod coverage_map;
pub mod field_map;
pub mod miniature;
pub mod paint_map;
pub mod plot;
