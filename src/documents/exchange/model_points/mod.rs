//! Points that another program's model found in pictures: landmarks and line ends, each with a
//! probability or a σ. They become clicks of an [origin](crate::document::ClickOrigin), which count
//! as evidence and as no person's work.
//!
//! | file | subject |
//! |---|---|
//! | `layout` | the layouts of files that are read |
//! | `pnlcalib` | the names of `PnLCalib`'s points and lines, and its files |
//! | `json_map` | a plain JSON map of pictures, labels and points |
//! | `rf_detr` | the JSON that Roboflow's `inference` writes |
//! | `scored` | COCO, YOLO and tables with a probability in place of a visibility |
//! | `outcomes` | what became of the points, for the makers of the model |

mod json_map;
pub mod layout;
pub mod outcomes;
mod pnlcalib;
mod rf_detr;
mod scored;
