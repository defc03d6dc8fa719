//! Cameras as formats exchange them, between a document and any one format. A
//! [`frame_camera::FrameCamera`] has one rotation, one centre and one lens;
//! [`camera_format::CameraFormat`] is the interface that each format of cameras implements. Beside
//! them is what several such formats need: angles of bodies, pictures of another size,
//! homographies, frames that cannot be read, and the way back into a document. A convention that
//! one format alone has belongs to that format.

pub mod body_angles;
pub mod calibration_matrix;
pub mod camera_format;
pub mod common_base;
pub mod frame_camera;
pub mod ground_fit;
pub mod held;
pub mod into_document;
pub mod one_place;
pub mod picture_size;
pub mod unreadable;
