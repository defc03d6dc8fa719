//! Errors of reading frames. Each names the file, the problem, and a remedy.

use std::io;
use std::path::{Path, PathBuf};
use touchline_core::files::open_named;
use touchline_core::geometry::pluralise;

/// Why a picture, a video or one of its frames could not be read.
///
/// Every message is one line: what, where, how to fix it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MediaError {
    /// Nothing exists at the path.
    #[error("{}: there is no such file; check whether it was moved or renamed", path.display())]
    Missing {
        /// The path that was to be opened.
        path: PathBuf,
    },
    /// A folder, a socket or a device where a file should be.
    #[error("{}: this is not a file; give the path of an image or a video", path.display())]
    NotAFile {
        /// The path that was to be opened.
        path: PathBuf,
    },
    /// A file where a folder should be.
    #[error("{}: this is not a folder; give the folder that holds the images", path.display())]
    NotAFolder {
        /// The path that was to be opened.
        path: PathBuf,
    },
    /// A file name that is not UTF-8, which a document cannot store.
    #[error("{}: its name is not UTF-8, which no project can keep; rename the file", path.display())]
    NameNotUtf8 {
        /// The path that was to be opened.
        path: PathBuf,
    },
    /// The operating system refuses to read it.
    #[error("{}: no permission to read it; change the permissions of the file or copy it elsewhere", path.display())]
    NoPermission {
        /// The path that was to be opened.
        path: PathBuf,
    },
    /// The operating system failed while reading.
    #[error("{}: could not be read ({reason}); check the disk or copy the file again", path.display())]
    Unreadable {
        /// The path that was to be opened.
        path: PathBuf,
        /// The operating system's message.
        reason: String,
    },
    /// Zero bytes long.
    #[error("{}: the file is empty (0 bytes); copy it again from where it came", path.display())]
    Empty {
        /// The empty file.
        path: PathBuf,
    },
    /// The first bytes belong to no image format that is read here.
    #[error("{}: not a PNG, JPEG, TIFF, BMP or WebP image; convert it to one of these", path.display())]
    NotAnImage {
        /// The file.
        path: PathBuf,
    },
    /// An image of a kind that is not supported.
    #[error("{}: this kind of image is not supported ({what}); convert it to PNG or JPEG", path.display())]
    UnsupportedImage {
        /// The file.
        path: PathBuf,
        /// The format, or the feature of it that is not supported.
        what: String,
    },
    /// The header is readable, the pixels are not.
    #[error("{}: the image is damaged ({reason}); copy it again from where it came", path.display())]
    DamagedImage {
        /// The file.
        path: PathBuf,
        /// The decoder's message.
        reason: String,
    },
    /// The picture states a size beyond the limits.
    #[error(
        "{}: states {width} × {height} px, the limit is {max_side_px} px a side and {max_megapixels} megapixels; scale it down",
        path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Stated columns.
        width: u32,
        /// Stated rows.
        height: u32,
        /// The longest side that is read, px.
        max_side_px: u32,
        /// The largest area that is read, millions of px.
        max_megapixels: u64,
    },
    /// Decoding would take more memory than the largest allowed picture.
    #[error("{}: needs more memory than a picture of {max_megapixels} megapixels; scale it down", path.display())]
    TooMuchMemory {
        /// The file.
        path: PathBuf,
        /// The largest area that is read, millions of px.
        max_megapixels: u64,
    },
    /// Nothing on this machine reads videos.
    #[error(
        "{}: a video, but the program ffmpeg that reads videos is not found; install ffmpeg and start again, or extract the frames to a folder",
        path.display()
    )]
    NoVideoSupport {
        /// The video.
        path: PathBuf,
    },
    /// The video reader failed midway.
    #[error("{}: {reader} broke down while reading it ({reason}); open the video again", path.display())]
    ReaderFailed {
        /// The video.
        path: PathBuf,
        /// The program or library that reads it.
        reader: String,
        /// The cause, as the reader reports it.
        reason: String,
    },
    /// No decoder recognises it as a video.
    #[error("{}: not a video that can be read; convert it to MP4 (H.264)", path.display())]
    NotAVideo {
        /// The file.
        path: PathBuf,
    },
    /// A video by its header, but not one frame decodes.
    #[error("{}: no frame of this video can be decoded; copy it again from where it came or convert it to MP4 (H.264)", path.display())]
    NoFrames {
        /// The video.
        path: PathBuf,
    },
    /// A frame beyond the end of the video.
    #[error(
        "{}: there is no frame {index}; the video has {}, numbered from 0",
        path.display(), pluralise(*frames, "frame")
    )]
    NoSuchFrame {
        /// The video.
        path: PathBuf,
        /// The number of the requested frame, from 0.
        index: usize,
        /// How many frames decode.
        frames: usize,
    },
    /// The frame exists, yet its data do not decode.
    #[error("{}: frame {index} cannot be decoded ({reason}); the video is damaged there, copy it again or convert it", path.display())]
    DamagedFrame {
        /// The video.
        path: PathBuf,
        /// The number of the requested frame, from 0.
        index: usize,
        /// The decoder's message.
        reason: String,
    },
    /// The caller cancelled a count.
    #[error("{}: the frames were not counted to the end; open the video again", path.display())]
    Stopped {
        /// The video.
        path: PathBuf,
    },
    /// An internal error of this program or of a library.
    #[error("{}: internal error while reading it ({message}); please report it together with the file", path.display())]
    Panicked {
        /// The file.
        path: PathBuf,
        /// The panic's message.
        message: String,
    },
    /// A buffer length that does not match the size of the picture.
    #[error("{bytes} bytes are not a picture of {width} × {height} px with 4 bytes each")]
    WrongLength {
        /// Length of the buffer.
        bytes: usize,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

impl MediaError {
    /// The error variant for what the operating system reported about `path`.
    pub(super) fn from_io(path: &Path, error: &io::Error) -> Self {
        let path = path.to_path_buf();
        match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::Missing { path },
            io::ErrorKind::PermissionDenied => Self::NoPermission { path },
            io::ErrorKind::IsADirectory => Self::NotAFile { path },
            _ => Self::Unreadable {
                path,
                reason: error.to_string(),
            },
        }
    }

    /// [`MediaError::NoVideoSupport`] for the video at `path`.
    pub(super) fn no_video_support(path: &Path) -> Self {
        Self::NoVideoSupport {
            path: path.to_path_buf(),
        }
    }
}

/// A text on one line, with single spaces between its words.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Opens a regular file with at least one byte.
pub(super) fn open_file(path: &Path) -> Result<std::fs::File, MediaError> {
    // The kind comes first, because `open_named` reports it as an error of the system. Emptiness
    // comes last, because a lack of permission is the better reason.
    let metadata = std::fs::metadata(path).map_err(|error| MediaError::from_io(path, &error))?;
    if !metadata.is_file() {
        return Err(MediaError::NotAFile {
            path: path.to_path_buf(),
        });
    }
    let file = open_named(path).map_err(|error| MediaError::from_io(path, &error))?;
    if metadata.len() == 0 {
        return Err(MediaError::Empty {
            path: path.to_path_buf(),
        });
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_refuses_is_named() {
        let message =
            |kind| MediaError::from_io(Path::new("a.png"), &io::Error::from(kind)).to_string();
        assert_eq!(
            message(io::ErrorKind::PermissionDenied),
            "a.png: no permission to read it; change the permissions of the file or copy it elsewhere"
        );
        assert_eq!(
            message(io::ErrorKind::NotFound),
            "a.png: there is no such file; check whether it was moved or renamed"
        );
        assert_eq!(
            message(io::ErrorKind::IsADirectory),
            "a.png: this is not a file; give the path of an image or a video"
        );
        assert!(message(io::ErrorKind::TimedOut).starts_with("a.png: could not be read ("));
    }

    #[test]
    fn a_video_of_one_frame_is_not_said_to_have_frames() {
        let beyond = MediaError::NoSuchFrame {
            path: PathBuf::from("a.mp4"),
            index: 1,
            frames: 1,
        };
        assert_eq!(
            beyond.to_string(),
            "a.mp4: there is no frame 1; the video has 1 frame, numbered from 0"
        );
    }
}
