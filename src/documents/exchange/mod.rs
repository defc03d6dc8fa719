//! Foreign formats, one a file, import and export side by side.
//!
//! | room | subject |
//! |---|---|
//! | `camera_formats`, `click_formats` | the formats themselves, each a file or folder |
//! | `cameras` | what formats of cameras have in common |
//! | `syntax` | JSON, tables and arrays, below any format |
//! | `imports`, `exports` | from foreign files to a document, and back |
//!
//! [`export()`] writes a [`Format`] in memory and reads it back before anything reaches the disk: a
//! landmark that moves by more than the format's own resolution is an error. What a format cannot
//! represent is reported with the result, in px ([`Loss`]). [`import()`] makes a document from
//! foreign files. The conventions of each format are described at the top of its file.

mod authors_mat;
mod camera_formats;
mod cameras;
mod click_formats;
mod error;
mod exports;
mod files;
mod format;
mod format_options;
mod imports;
mod model_points;
mod options;
mod rate;
mod registry;
mod syntax;
#[cfg(test)]
mod tests;
mod timecode;

pub use authors_mat::AuthorsError;
pub use error::{ExchangeError, Problem};
pub use exports::export::export;
pub use exports::exported::Exported;
pub use exports::loss::Loss;
pub use files::Files;
pub use format::{About, Format};
pub use format_options::{Direction, FormatOption};
pub use imports::import::import;
pub use imports::imported::Imported;
pub use options::{
    ExportOptions, FrameChoice, Gaps, GroundPlan, HomographyOptions, ImportOptions, KeypointNames,
    LabelMap, MatrixDirection, Pixels, PointModel, PointSource, Recording, Rotations, Zoom,
};
pub use rate::Rate;
pub use timecode::Timecode;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    authors_mat::{
        AuthorsFolder, AuthorsFrame, AuthorsSequence, MatError, read_authors_folder,
        read_authors_sequence,
    },
    camera_formats::homography_files::template_from_ground,
    click_formats::point_sigma::sigma_by_probability_px,
    exports::dataset::{
        DatasetDone, DatasetOptions, DatasetPlan, LabelOrigin, PictureFormat, Pictures,
        PlannedFrame, Split, SplitBy, Splitting, encode_picture, folder_for_new, plan_dataset,
        write_dataset,
    },
    exports::work_packages::{restore_version, write_packages},
    imports::attach::{
        AttachedPair, Attachment, AttachmentCandidate, Counting, MatchedBy, NotAttached,
        plan_attachment, size_of_only_video,
    },
    imports::join::{JoinedImport, JoinedPair, join},
    imports::picture_points::{PicturePoints, read_picture_points},
    imports::recognize::recognize_format,
    model_points::layout::{PointLayout, import_points},
    model_points::outcomes::{PointOutcome, point_outcomes},
};
