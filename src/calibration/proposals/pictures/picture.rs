//! Reading the pictures of a document's frames.

use std::path::Path;
use std::vec;
use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{DocumentAt, Frame};
use touchline_vision::features::FeatureError;
use touchline_vision::media::{
    FrameRef, FrameStream, MediaError, Picture, ReadFrames, StreamedFrame,
};

/// Why a frame's picture, or its features, are not available.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The frame names no file.
    #[error("the frame has neither an image nor a video to show")]
    None,
    /// The file or one of its frames could not be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// Its size is not the one that the document states.
    #[error(
        "{picture} is {} × {} px, but the document says {} × {} px: it is not the frame that was labelled",
        .actual.width, .actual.height, .stated.width, .stated.height
    )]
    Size {
        /// The file, and its frame.
        picture: String,
        /// Actual size, px.
        actual: ImageSize,
        /// Size in the document, px.
        stated: ImageSize,
    },
    /// Feature extraction failed.
    #[error(transparent)]
    Features(#[from] FeatureError),
}

/// Reads the picture of a frame, from its image file or otherwise its video. `folder` is the folder
/// to which the document's relative paths refer.
///
/// # Errors
/// The frame has no picture, it cannot be read, or its size is not the one in the document.
pub fn read_picture(
    reader: &mut dyn ReadFrames,
    frame: &Frame,
    folder: &Path,
) -> Result<Picture, PictureError> {
    let source = frame.picture_source(folder).ok_or(PictureError::None)?;
    let picture = reader.read(&source)?;
    check_size(frame, &source.to_string(), picture.size())?;
    Ok(picture)
}

/// Reads the pictures of some frames of a document one after the other, each as [`read_picture`]
/// does. A picture that cannot be read is an item with an error. See [`FrameStream`].
#[derive(Debug)]
pub struct PictureStream<'a> {
    /// The frames still to come, with their sources.
    frames: vec::IntoIter<(usize, &'a Frame, Option<FrameRef>)>,
    /// The pictures of those frames that have a source.
    stream: FrameStream<'a, vec::IntoIter<FrameRef>>,
}

/// The picture of a frame, or why there is none.
#[derive(Debug)]
pub struct FramePicture<'a> {
    /// The frame's index in the document.
    pub index: usize,
    /// The frame.
    pub frame: &'a Frame,
    /// Its picture.
    pub picture: Result<Picture, PictureError>,
}

impl<'a> PictureStream<'a> {
    /// Streams the pictures of the frames with these indices. Nothing is read yet.
    pub fn new(at: DocumentAt<'a>, indices: impl IntoIterator<Item = usize>) -> Self {
        let frames: Vec<_> = indices
            .into_iter()
            .map(|index| {
                let frame = &*at.document.frames[index];
                (index, frame, frame.picture_source(at.folder))
            })
            .collect();
        let sources: Vec<FrameRef> = frames
            .iter()
            .filter_map(|(.., source)| source.clone())
            .collect();
        Self {
            frames: frames.into_iter(),
            stream: FrameStream::new(sources),
        }
    }

    /// Reads with a decoder that the caller uses elsewhere as well.
    #[must_use]
    pub fn with_reader(self, reader: &'a mut dyn ReadFrames) -> Self {
        Self {
            stream: self.stream.with_reader(reader),
            ..self
        }
    }

    /// Reports progress before each picture, and ends if that is cancelled.
    #[must_use]
    pub fn with_progress(self, progress: Progress<'a, Share>) -> Self {
        Self {
            stream: self.stream.with_progress(progress),
            ..self
        }
    }
}

impl<'a> Iterator for PictureStream<'a> {
    type Item = FramePicture<'a>;

    fn next(&mut self) -> Option<FramePicture<'a>> {
        let (index, frame, source) = self.frames.next()?;
        if source.is_none() {
            return Some(FramePicture {
                index,
                frame,
                picture: Err(PictureError::None),
            });
        }
        // Frames without a source are not in the stream, so the two sequences stay in step.
        let StreamedFrame { source, picture } = self.stream.next()?;
        let picture = picture.map_err(PictureError::from).and_then(|picture| {
            check_size(frame, &source.to_string(), picture.size())?;
            Ok(picture)
        });
        Some(FramePicture {
            index,
            frame,
            picture,
        })
    }
}

/// Checks that a picture has the size that the document states.
pub(super) fn check_size(
    frame: &Frame,
    picture: &str,
    actual: ImageSize,
) -> Result<(), PictureError> {
    if actual == frame.image_size {
        return Ok(());
    }
    Err(PictureError::Size {
        picture: picture.to_owned(),
        actual,
        stated: frame.image_size,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use touchline_documents::document::Document;
    use touchline_documents::testing::{a_match, new_frame};
    use touchline_vision::media::FrameReader;

    const SIZE: ImageSize = ImageSize::new(6, 4);

    /// Four frames: without a picture, with one, with one of another size, with one that is
    /// missing.
    fn document(folder: &Path) -> Document {
        let mut document = a_match(SIZE);
        image::RgbImage::new(SIZE.width, SIZE.height)
            .save(folder.join("right.png"))
            .unwrap();
        image::RgbImage::new(9, 9)
            .save(folder.join("other.png"))
            .unwrap();
        for name in ["none.png", "right.png", "other.png", "missing.png"] {
            document.frames.push(new_frame(name, SIZE).into());
        }
        document.frames[0].image = None;
        document
    }

    #[test]
    fn a_stream_gives_for_each_frame_what_reading_it_alone_gives() {
        let folder = tempfile::tempdir().unwrap();
        let document = document(folder.path());
        let streamed: Vec<FramePicture<'_>> =
            PictureStream::new(document.at(folder.path()), [1, 0, 3, 2, 1]).collect();
        assert_eq!(
            streamed
                .iter()
                .map(|picture| picture.index)
                .collect::<Vec<_>>(),
            [1, 0, 3, 2, 1]
        );
        for FramePicture { frame, picture, .. } in streamed {
            assert_eq!(
                picture,
                read_picture(&mut FrameReader::new(), frame, folder.path())
            );
        }
    }

    #[test]
    fn a_cancelled_stream_ends() {
        let folder = tempfile::tempdir().unwrap();
        let document = document(folder.path());
        let progress = Progress::new(|Share { done, .. }| {
            if done < 1 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        let stream = PictureStream::new(document.at(folder.path()), 0..4).with_progress(progress);
        assert_eq!(
            stream.map(|picture| picture.index).collect::<Vec<_>>(),
            [0, 1]
        );
    }
}
