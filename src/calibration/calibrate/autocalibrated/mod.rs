//! The result of autocalibration on its way into a document, which may have been edited meanwhile.
//! The search is in the room `autocalibrate`; here its camera, frames and evidence are recorded.

pub mod autocalibrated_camera;
pub mod found_camera;
pub mod record_found;
