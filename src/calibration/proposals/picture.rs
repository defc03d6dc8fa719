//! The picture of a document's frame.

use std::path::Path;
use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::Frame;
use touchline_vision::features::FeatureError;
use touchline_vision::media::{MediaError, Picture, ReadFrames};

/// Why a frame's picture, or its features, could not be had.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The frame names no file.
    #[error("the frame has neither an image nor a video to show")]
    None,
    /// The file or one of its frames could not be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// It is another picture than the document's.
    #[error(
        "{picture} is {} × {} px, but the document says {} × {} px: it is not the frame that was labelled",
        .actual.width, .actual.height, .stated.width, .stated.height
    )]
    Size {
        /// The file, and its frame.
        picture: String,
        /// As it is, px.
        actual: ImageSize,
        /// As the document has it, px.
        stated: ImageSize,
    },
    /// No features could be looked for.
    #[error(transparent)]
    Features(#[from] FeatureError),
}

/// The pixels of a frame: its image file, else its video's frame. `folder` is the document's.
///
/// # Errors
/// The frame has no picture, it cannot be read, or it is not as large as the document says.
pub fn read_picture(reader: &mut dyn ReadFrames, frame: &Frame, folder: &Path) -> Result<Picture, PictureError> {
    let source = frame.picture_source(folder).ok_or(PictureError::None)?;
    let picture = reader.read(&source)?;
    check_size(frame, &source.to_string(), picture.size())?;
    Ok(picture)
}

/// Whether a picture is as large as the document says.
pub(super) fn check_size(frame: &Frame, picture: &str, actual: ImageSize) -> Result<(), PictureError> {
    if actual == frame.image_size {
        return Ok(());
    }
    Err(PictureError::Size { picture: picture.to_owned(), actual, stated: frame.image_size })
}
