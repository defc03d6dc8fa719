//! Foreign formats, one a file, import and export side by side.
//!
//! [`export()`] writes a [`Format`] in memory and reads it back before anything reaches the disk: a
//! landmark that moves by more than the format's own resolution is an error. What a format cannot
//! represent is reported with the result, in px ([`Loss`]). [`import()`] makes a document from
//! foreign files. The conventions of each format are described at the top of its file.

mod about;
mod attach;
mod authors_mat;
mod body_angles;
mod broadtrack;
mod camera_format;
mod cdf;
mod chan;
mod choose;
mod clicked_frame;
mod coco;
mod colmap;
mod csv_table;
mod cvat;
mod dataset;
mod deepsport;
mod error;
mod export;
mod export_cameras;
mod export_clicks;
mod exported;
mod fifa;
mod files;
mod format;
mod frame_camera;
mod freed;
mod gaps;
mod ground_fit;
mod held;
mod homography_files;
mod import;
mod import_cameras;
mod import_clicks;
mod imported;
mod into_document;
mod join;
mod label_studio;
mod labelme;
mod labels;
mod loss;
mod node;
mod npy;
mod npz;
mod opencv_yaml;
mod opentrackio;
mod options;
mod picture_points;
mod picture_size;
mod pictures;
mod places;
mod rate;
mod recognize;
mod registry;
mod soccernet;
mod soccernet_lines;
mod stage;
mod strict_json;
mod table;
#[cfg(test)]
mod tests;
mod timecode;
mod unreadable;
mod usda;
mod values;
mod work_packages;
mod yolo_pose;

pub use about::About;
pub use attach::{
    AttachedPair, Attachment, AttachmentCandidate, Counting, MatchedBy, NotAttached,
    plan_attachment, size_of_only_video,
};
#[cfg(any(test, feature = "testing"))]
#[doc(hidden)]
pub use authors_mat::writer as mat_writer;
pub use authors_mat::{
    AuthorsError, AuthorsFolder, AuthorsFrame, AuthorsSequence, MatError, read_authors_folder,
    read_authors_sequence,
};
pub use dataset::{
    DatasetDone, DatasetOptions, DatasetPlan, LabelOrigin, PictureFormat, Pictures, PlannedFrame,
    Split, SplitBy, Splitting, folder_for_new, plan_dataset, write_dataset,
};
pub use error::{ExchangeError, Problem};
pub use export::export;
pub use exported::Exported;
pub use files::Files;
pub use format::Format;
pub use homography_files::template_from_ground;
pub use import::import;
pub use imported::Imported;
pub use join::{JoinedImport, JoinedPair, join};
pub use loss::Loss;
pub use options::{
    ExportOptions, FrameChoice, Gaps, ImportOptions, KeypointNames, LabelMap, Pixels, PointSource,
    Recording, Rotations, Zoom,
};
pub use picture_points::{PicturePoints, read_picture_points};
pub use rate::Rate;
pub use recognize::recognize_format;
pub use timecode::Timecode;
pub use work_packages::{restore_version, write_packages};
