//! Hash and length of a match's frames, kept beside them.
//!
//! Hashing a match of several gigabytes takes seconds to minutes, and counting its frames, too.
//! Both are written into a small file beside the video or folder (`match.mp4.touchline-hash`), with
//! the names, sizes and times of the files that they are of. As long as these are the same, nothing
//! is read again. The file may be deleted at any time; where it cannot be written, each run hashes
//! anew.

use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use thiserror::Error;
use touchline_documents::document::generator;
use touchline_documents::store::write_atomically;
use touchline_vision::media::{FrameSource, MediaError, sha256_of_bytes, sha256_of_file};

/// What is appended to the name of a video or folder for its kept hash.
const SUFFIX: &str = ".touchline-hash";

/// A file that changed less than this before it was hashed is hashed again the next time: a second
/// change within the clock's tick would not be noticed.
const SETTLED: Duration = Duration::from_secs(2);

/// Maximum size of a kept hash's file, bytes.
const MAX_BYTES: u64 = 1 << 16;

/// The content and length of a match's frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceState {
    /// SHA-256 of the video; for a folder, of its images' names and hashes.
    pub sha256: String,
    /// Number of frames.
    pub num_frames: usize,
    /// Frames a second; none for images.
    pub fps: Option<f64>,
}

/// Why frames could not be examined.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SourceError {
    /// They cannot be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// There is none.
    #[error("{} holds no image", path.display())]
    Empty {
        /// The folder.
        path: PathBuf,
    },
    /// The system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The name of the file is not UTF-8, which a document requires.
    #[error("{}: a document cannot name it, for its name is not UTF-8; rename it", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
    },
}

/// What is kept beside the frames.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    /// The program that counted the frames; another one may count differently.
    program: String,
    /// A hash of the files' names, sizes and times.
    files: String,
    state: SourceState,
}

/// Hash and length of a video, a folder of images or an image: what is kept beside it if that is
/// still true, else measured, and then kept.
///
/// # Errors
/// The frames cannot be read, or there is none.
pub fn examine_source(path: &Path) -> Result<SourceState, SourceError> {
    // Names, sizes and times are read before the contents and again after them. A change in between
    // then shows, and the hash is not kept.
    let kept_at = kept_path(path);
    let files = files_of(path)?;
    if let Some(kept) = read_kept(&kept_at)
        && kept.files == files.hash
        && kept.program == generator()
    {
        return Ok(kept.state);
    }
    let source = FrameSource::open(path)?;
    if source.is_empty() {
        return Err(SourceError::Empty {
            path: path.to_path_buf(),
        });
    }
    let (sha256, fps) = match &source {
        FrameSource::Folder(listing) => (hash_of_images(&listing.images)?, None),
        FrameSource::Video(info) => (sha256_of_file(path)?, Some(info.fps)),
    };
    let state = SourceState {
        sha256,
        num_frames: source.len(),
        fps,
    };
    // A time in the future, of a clock that is wrong, never counts as settled.
    let is_settled = SystemTime::now()
        .duration_since(files.newest)
        .is_ok_and(|age| age > SETTLED);
    if is_settled && files_of(path).is_ok_and(|now| now.hash == files.hash) {
        let kept = Kept {
            program: generator(),
            files: files.hash,
            state: state.clone(),
        };
        if let Ok(text) = serde_json::to_string(&kept) {
            // A folder that refuses it costs time, no more.
            let _ = write_atomically(&kept_at, text.as_bytes());
        }
    }
    Ok(state)
}

/// The folder that holds a match's video or folder of images, absolute and without links, and the
/// name of the video or folder in it. Frames of parts are named relative to this folder, so that
/// their bytes do not depend on where a machine has it.
///
/// # Errors
/// There is no such file or folder, or its name is not UTF-8.
pub fn place_of_source(path: &Path) -> Result<(PathBuf, String), SourceError> {
    let real = fs::canonicalize(path).map_err(|source| SourceError::Io {
        path: path.to_path_buf(),
        source,
    })?;
    let name = real.file_name().and_then(|name| name.to_str());
    let (Some(folder), Some(name)) = (real.parent(), name) else {
        return Err(SourceError::NotUtf8 { path: real });
    };
    Ok((folder.to_path_buf(), name.to_owned()))
}

fn kept_path(path: &Path) -> PathBuf {
    // By its components: behind a final separator the suffix would name a file in the folder.
    let mut name = path.components().as_path().as_os_str().to_owned();
    name.push(SUFFIX);
    PathBuf::from(name)
}

fn read_kept(path: &Path) -> Option<Kept> {
    let bytes = touchline_core::files::read_named(path, MAX_BYTES).ok()?;
    serde_json::from_slice(&bytes).ok()
}

/// The state of the files of a source, without their contents.
struct Files {
    hash: String,
    newest: SystemTime,
}

fn files_of(path: &Path) -> Result<Files, SourceError> {
    let images = if path.is_dir() {
        touchline_vision::media::list_images(path)?.images
    } else {
        vec![path.to_path_buf()]
    };
    let mut text = String::new();
    let mut newest = UNIX_EPOCH;
    for image in images {
        let metadata = fs::metadata(&image).and_then(|metadata| {
            let modified = metadata.modified()?;
            Ok((metadata.len(), modified))
        });
        let (bytes, modified) = metadata.map_err(|source| SourceError::Io {
            path: image.clone(),
            source,
        })?;
        // The zero bytes separate the parts: no name contains one. A time before 1970 counts as
        // 1970, which still gives the same text for the same file.
        let since = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
        let name = image.file_name().unwrap_or_default().to_string_lossy();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name}\0{bytes}\0{}", since.as_nanos());
        newest = newest.max(modified);
    }
    Ok(Files {
        hash: sha256_of_bytes(text.as_bytes()),
        newest,
    })
}

/// The hash of a folder's images by their names and contents, in the order of the listing.
fn hash_of_images(images: &[PathBuf]) -> Result<String, MediaError> {
    let mut text = String::new();
    for image in images {
        let name = image.file_name().unwrap_or_default().to_string_lossy();
        let _ = writeln!(text, "{name}\0{}", sha256_of_file(image)?);
    }
    Ok(sha256_of_bytes(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    fn set_age(path: &Path, seconds: u64) {
        let file = File::options().write(true).open(path).unwrap();
        let modified = SystemTime::now() - Duration::from_secs(seconds);
        file.set_modified(modified).unwrap();
    }

    #[test]
    fn a_kept_hash_lies_beside_a_folder_with_a_final_separator() {
        for folder in ["season/images", "season/images/", "season/images/."] {
            let kept = kept_path(Path::new(folder));
            assert_eq!(kept, Path::new("season/images.touchline-hash"), "{folder}");
        }
    }

    #[test]
    fn a_kept_hash_is_used_until_a_file_changes() {
        let folder = tempfile::tempdir().unwrap();
        let images = folder.path().join("images");
        fs::create_dir(&images).unwrap();
        for name in ["1.png", "2.png"] {
            image::RgbImage::new(8, 8).save(images.join(name)).unwrap();
        }
        let kept = folder.path().join("images.touchline-hash");
        let state = examine_source(&images).unwrap();
        assert_eq!((state.num_frames, state.fps), (2, None));
        assert!(!kept.exists(), "the files changed just now");

        for name in ["1.png", "2.png"] {
            set_age(&images.join(name), 10);
        }
        assert_eq!(examine_source(&images).unwrap(), state);
        let text = fs::read_to_string(&kept).unwrap();
        let marked = text.replace(&state.sha256, "kept");
        fs::write(&kept, marked).unwrap();
        assert_eq!(examine_source(&images).unwrap().sha256, "kept");

        image::RgbImage::new(9, 9)
            .save(images.join("2.png"))
            .unwrap();
        let changed = examine_source(&images).unwrap();
        assert!(![&state.sha256, "kept"].contains(&changed.sha256.as_str()));
    }
}
