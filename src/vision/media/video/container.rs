//! The kind of a video's container, recognised by the first bytes of the file. It decides how much
//! of what the container states can be believed, and whether a seek needs a run-up. Text is refused
//! here, before a backend reads it.

use crate::media::MediaError;
use crate::media::error::open_file;
use std::io::Read;
use std::path::Path;

/// The kind of container, by the first bytes of the file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Container {
    /// MP4 and `QuickTime`: state the exact number of stored frames and their average rate.
    Mp4,
    /// Matroska, `WebM` and AVI: have an index of key frames; rate and length are nominal.
    Indexed,
    /// Transport streams and similar: no index.
    Stream,
}

/// Recognises the container by its first bytes. Text is rejected: `FFmpeg` would render it as a
/// video, or follow the list of files and addresses in it.
pub(super) fn container_of(path: &Path) -> Result<Container, MediaError> {
    let mut head = Vec::new();
    open_file(path)?
        .take(64)
        .read_to_end(&mut head)
        .map_err(|error| MediaError::from_io(path, &error))?;
    let is_text = head
        .iter()
        .all(|&byte| byte >= b' ' || byte.is_ascii_whitespace());
    if is_text && !head.starts_with(b"YUV4MPEG2 ") {
        return Err(MediaError::NotAVideo {
            path: path.to_path_buf(),
        });
    }
    Ok(match (head.get(..4), head.get(4..8), head.get(8..12)) {
        (_, Some(b"ftyp" | b"moov" | b"mdat" | b"free" | b"wide" | b"skip"), _) => Container::Mp4,
        (Some(b"\x1a\x45\xdf\xa3"), ..) | (Some(b"RIFF"), _, Some(b"AVI ")) => Container::Indexed,
        _ => Container::Stream,
    })
}
