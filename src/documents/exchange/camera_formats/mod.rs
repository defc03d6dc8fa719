//! The formats of cameras, one a file or folder, with reading and writing side by side. The pixels,
//! units and axes of a format are described at the top of its file and converted there and nowhere
//! else. The formats know neither documents nor each other, except where one is a variant of
//! another. `registry.rs` lists them for the rest of the program.

pub mod broadtrack;
pub mod cdf;
pub mod chan;
pub mod colmap;
pub mod csv_table;
pub mod deepsport;
pub mod fifa;
pub mod freed;
pub mod homography_files;
pub mod lens_table;
pub mod opencv_yaml;
pub mod opentrackio;
pub mod soccernet;
pub mod usda;
