//! The annotation format of the two-point method's authors: MATLAB files of sequences beside
//! folders of images.
//!
//! A file `seq1_anno.mat` holds `annotation`, an array of structures (`image_name`; `camera`:
//! principal point, focal length, rotation vector, centre; `ptz`: pan, tilt in degrees, focal
//! length in px), and `meta` (`cc`: the centre, m; `base_rotation`: a rotation vector; `seq`,
//! `base_dir`, `logo_bbox`). Its images lie in a folder `seq1` beside it. A model of the field
//! (`model_size`: width and length in yards) lies in a folder `util`.
//!
//! Their world begins at the field's corner that is near and left from the main side, x along the
//! length, y across, z up; the rotation is the same `Q_tilt · Q_pan · base_from_world` as here, the
//! principal point counts from the first pixel's centre.
//!
//! | what | where |
//! |---|---|
//! | one file | [`read_authors_sequence`] |
//! | a folder of them as a document | [`read_authors_folder`] |

mod folder;
mod mat_file;
mod mat_value;
mod sequence;
#[cfg(test)]
mod tests;
#[cfg(test)]
#[allow(
    clippy::unwrap_used,
    clippy::must_use_candidate,
    clippy::missing_panics_doc,
    reason = "for tests alone"
)]
pub mod writer;

pub use folder::{AuthorsFolder, read_authors_folder};
pub use mat_file::MatError;
pub use sequence::{AuthorsFrame, AuthorsSequence, read_authors_sequence};

use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// The format.
pub const ABOUT: About = About {
    name: "authors-mat",
    title: "the two-point method's MATLAB files",
    conventions: "corner of the field, yards and metres, Rodrigues",
    users: "the two-point method's authors",
    loses: None,
    file: None,
    files: "MATLAB files (.mat)",
    endings: &["mat"],
    export_options: &[],
    import_options: &[FormatOption::EachOwnCamera],
};

/// Why the authors' files cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AuthorsError {
    /// A file or folder cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is no MAT file, or a damaged one.
    #[error("{}: {source}", path.display())]
    Mat {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MatError,
    },
    /// Something that the authors write is not there.
    #[error("{}: missing: {what}; the file is not one of the published annotations", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What is wanted.
        what: String,
    },
    /// The full camera of a frame is not the base turned by its pan and tilt.
    #[error(
        "{}: the camera of {image} is {turn_deg:.3}° and {apart_m:.3} m away from the base turned by its pan and tilt",
        path.display()
    )]
    Disagrees {
        /// The file.
        path: PathBuf,
        /// The frame.
        image: String,
        /// The angle between the two rotations, degrees.
        turn_deg: f64,
        /// The distance between the two centres, m.
        apart_m: f64,
    },
    /// The principal point of a frame is not that of the first frame.
    #[error(
        "{}: the principal point of {image} is {off_px:.1} px away from that of the first frame; \
         put frames of another camera into a file of their own",
        path.display()
    )]
    OtherPrincipalPoint {
        /// The file.
        path: PathBuf,
        /// The frame.
        image: String,
        /// The distance between the two principal points, px.
        off_px: f64,
    },
    /// A folder holds no annotations.
    #[error("{} holds no MATLAB file with annotations (such as seq1_anno.mat)", folder.display())]
    NoSequences {
        /// The folder.
        folder: PathBuf,
    },
}
