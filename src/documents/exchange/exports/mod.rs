//! From a document to foreign files. Frames are chosen, gaps are filled or split, the files are
//! made in memory, read back, and compared with the document before anything is written. What the
//! format cannot hold is measured in px. Datasets for training and work packages for other people
//! are written here, too. How a format is written is not decided here.

mod choose;
pub mod dataset;
pub mod export;
mod export_cameras;
mod export_clicks;
pub mod exported;
mod gaps;
pub mod loss;
mod stage;
pub mod work_packages;
