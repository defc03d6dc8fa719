//! The formats of annotation tools, one a file, with reading and writing side by side. They store
//! clicks rather than cameras: points with labels in pictures. [`clicked_frame`] is the interface
//! that each implements, and [`labels`] says which landmark or line of the field a label of another
//! tool means. `registry.rs` lists the formats for the rest of the program.

pub mod clicked_frame;
pub mod coco;
pub mod cvat;
pub mod label_studio;
pub mod labelme;
pub mod labels;
pub mod point_sigma;
pub mod points_table;
pub mod soccernet_lines;
pub mod soccernet_pictures;
pub mod yolo_pose;
