//! The types of the schema: what a document holds, key by key, in the document's own units. A file
//! is one kind of thing: a camera, a frame, a click, a solution. The containers that undo states
//! share are here, and so are the adapters between JSON and the types. Reading and writing a whole
//! text is in `text`; what the records of a frame mean together is in `frame_state`.

pub mod adapters;
pub mod camera;
pub mod camera_id;
pub mod click;
pub mod click_noise;
pub mod click_origin;
pub mod document;
pub mod extra;
pub mod field_spec;
pub mod frame;
pub mod frame_id;
pub mod frame_lens;
pub mod frames;
mod frames_version;
pub mod ground;
pub mod imported_camera;
pub mod mask;
pub mod repeat;
pub mod shared;
pub mod shot;
pub mod size_sigma;
pub mod solution;
