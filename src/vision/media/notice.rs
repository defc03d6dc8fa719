//! Remarks for the user about a source that is usable.

use std::fmt;
use std::path::{Path, PathBuf};
use touchline_core::geometry::{ImageSize, pluralise, thousands};

/// A remark about a folder or a video, shown once; the source can be used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// The container's count is not the number of frames that decode.
    FramesStated {
        /// The video.
        path: PathBuf,
        /// The number that the container states.
        stated: usize,
        /// The number that decodes.
        decoded: usize,
    },
    /// The frame rate is not constant, so the time of every frame was read.
    UnevenFrameTimes {
        /// The video.
        path: PathBuf,
        /// The rate that the container states, frames a second.
        fps: f64,
    },
    /// The frames are interlaced: two fields, taken one after the other.
    Interlaced {
        /// The video.
        path: PathBuf,
    },
    /// Seeking in the video gave other pictures than playing it, or its times go back and stand for
    /// several frames, so it is played from its start instead.
    NoJumping {
        /// The video.
        path: PathBuf,
    },
    /// The stored pixels of the video are not square; its frames are returned with pixels that are.
    PixelsNotSquare {
        /// The video.
        path: PathBuf,
        /// The size of the stored frames.
        stored: ImageSize,
        /// The size of the frames as returned.
        shown: ImageSize,
    },
    /// A file name that is not UTF-8, which a document cannot store.
    NameNotUtf8 {
        /// The file left out.
        path: PathBuf,
    },
}

/// The name of the file without its folder, for messages.
fn name(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FramesStated {
                path,
                stated,
                decoded,
            } => {
                let only = if decoded < stated { "only " } else { "" };
                write!(
                    f,
                    "{} announces {}; {only}{} can be decoded. Frames are numbered as decoded.",
                    name(path),
                    pluralise(*stated, "frame"),
                    thousands(*decoded)
                )
            }
            Self::UnevenFrameTimes { path, fps } => write!(
                f,
                "{}: the frame rate is not {fps:.3} throughout. Frames are numbered as decoded.",
                name(path)
            ),
            Self::Interlaced { path } => {
                write!(
                    f,
                    "{} is interlaced: only the first field of each picture is used, which has half of its lines.",
                    name(path)
                )
            }
            Self::NoJumping { path } => write!(
                f,
                "{}: exact seeking is not possible, so stepping back is slow. Convert it to MP4 for fast steps.",
                name(path)
            ),
            Self::PixelsNotSquare {
                path,
                stored,
                shown,
            } => write!(
                f,
                "{}: its pixels are not square. Frames of {} × {} px are used as {} × {} px, and all coordinates are of these.",
                name(path),
                stored.width,
                stored.height,
                shown.width,
                shown.height
            ),
            Self::NameNotUtf8 { path } => {
                write!(
                    f,
                    "{}: left out, its name is not UTF-8. Rename the file to use it.",
                    name(path)
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_agree_with_their_nouns() {
        for (stated, decoded, counts) in [
            (1, 2, "1 frame; 2"),
            (135_000, 134_998, "135,000 frames; only 134,998"),
        ] {
            let notice = Notice::FramesStated {
                path: PathBuf::from("videos/match.mkv"),
                stated,
                decoded,
            };
            assert_eq!(
                notice.to_string(),
                format!(
                    "match.mkv announces {counts} can be decoded. Frames are numbered as decoded."
                )
            );
        }
    }
}
