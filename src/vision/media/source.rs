//! The source of a project's frames, references to single frames, and the images of a folder.

use super::{CountProgress, MediaError, Notice, Video, VideoInfo, image_size};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::UNIX_EPOCH;
use touchline_core::progress::Progress;

/// One frame: an image file, or a frame of a video by its index among the decoded frames.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FrameRef {
    /// An image file.
    Image(Arc<Path>),
    /// A frame of a video.
    Video {
        /// The video's file.
        path: Arc<Path>,
        /// Index among the decoded frames, from 0; not the container's count.
        index: usize,
    },
}

impl FrameRef {
    /// The frame of an image file.
    pub fn image(path: impl Into<Arc<Path>>) -> Self {
        Self::Image(path.into())
    }

    /// Frame `index`, from 0, of a video.
    pub fn video(path: impl Into<Arc<Path>>, index: usize) -> Self {
        Self::Video {
            path: path.into(),
            index,
        }
    }

    /// The file that contains the frame.
    pub fn path(&self) -> &Path {
        match self {
            Self::Image(path) | Self::Video { path, .. } => path,
        }
    }

    /// A substitute for the hash of a video's frame: path, length and modification time of the
    /// file, because hashing a match takes minutes. `None` for an image, and if the file cannot be
    /// accessed.
    pub fn video_identity(&self) -> Option<String> {
        let Self::Video { path, index } = self else {
            return None;
        };
        // The canonical path, so that two names of one file have one identity.
        let metadata = std::fs::metadata(path).ok()?;
        let modified = metadata.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        let path = path.canonicalize().ok()?;
        Some(format!(
            "{}|{}|{}|{index}",
            path.display(),
            metadata.len(),
            modified.as_nanos()
        ))
    }
}

impl fmt::Display for FrameRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(path) => write!(f, "{}", path.display()),
            Self::Video { path, index } => write!(f, "{} frame {index}", path.display()),
        }
    }
}

/// The frames of a project: the images of a folder, or a video.
#[derive(Clone, Debug)]
pub enum FrameSource {
    /// The images of a folder, in natural order, or a single image.
    Folder(FolderListing),
    /// A video.
    Video(VideoInfo),
}

impl FrameSource {
    /// Opens a folder of images, a single image or a video. Blocks while a video's frames are
    /// counted.
    ///
    /// # Errors
    /// Those of [`list_images`], [`image_size`] and [`Video::open`]; [`MediaError::NameNotUtf8`].
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        Self::open_with_progress(path, &Progress::default())
    }

    /// Opens as [`FrameSource::open`] does; `progress` receives reports while the frames of a video
    /// are counted, and may cancel.
    ///
    /// # Errors
    /// As [`FrameSource::open`]; [`MediaError::Stopped`] when `progress` cancelled it.
    pub fn open_with_progress(
        path: &Path,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Self, MediaError> {
        if path.is_dir() {
            Ok(Self::Folder(list_images(path)?))
        } else if !has_utf8_name(path) {
            Err(MediaError::NameNotUtf8 {
                path: path.to_path_buf(),
            })
        } else if has_image_extension(path) {
            // Reading the header reports a missing or damaged file here, not when it is first
            // shown.
            image_size(path)?;
            Ok(vec![path.to_path_buf()].into())
        } else {
            Ok(Self::Video(
                Video::open_with_progress(path, progress)?.info().clone(),
            ))
        }
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        match self {
            Self::Folder(listing) => listing.images.len(),
            Self::Video(info) => info.decoded_frames,
        }
    }

    /// Whether there is no frame at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The frame at an index, from 0; `None` beyond the last.
    pub fn frame(&self, index: usize) -> Option<FrameRef> {
        match self {
            Self::Folder(listing) => listing
                .images
                .get(index)
                .map(|path| FrameRef::image(path.as_path())),
            Self::Video(info) => (index < info.decoded_frames).then(|| FrameRef::Video {
                path: Arc::clone(&info.path),
                index,
            }),
        }
    }

    /// Remarks for the user about the source.
    pub fn notices(&self) -> &[Notice] {
        match self {
            Self::Folder(listing) => &listing.notices,
            Self::Video(info) => &info.notices,
        }
    }
}

/// Images in the order given.
impl From<Vec<PathBuf>> for FrameSource {
    fn from(images: Vec<PathBuf>) -> Self {
        Self::Folder(FolderListing {
            images,
            notices: Vec::new(),
        })
    }
}

/// File name extensions of images in lower case; case is ignored.
pub const IMAGE_EXTENSIONS: [&str; 7] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "webp"];

/// The images of a folder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FolderListing {
    /// The image files, `folder` included in their paths, in natural order: `frame9.png` before
    /// `frame10.png`.
    pub images: Vec<PathBuf>,
    /// Images left out, with the reason.
    pub notices: Vec<Notice>,
}

/// Lists the images directly in a folder, by their extensions. Hidden files (with a leading dot)
/// and subfolders are ignored.
///
/// # Errors
/// The folder is missing, is not a folder or cannot be read.
pub fn list_images(folder: &Path) -> Result<FolderListing, MediaError> {
    let metadata =
        std::fs::metadata(folder).map_err(|error| MediaError::from_io(folder, &error))?;
    if !metadata.is_dir() {
        return Err(MediaError::NotAFolder {
            path: folder.to_path_buf(),
        });
    }
    let mut listing = FolderListing::default();
    for entry in std::fs::read_dir(folder).map_err(|error| MediaError::from_io(folder, &error))? {
        let path = entry
            .map_err(|error| MediaError::from_io(folder, &error))?
            .path();
        // Hidden files are ignored because macOS puts a `._` file beside each image on disks of
        // other systems. The kind comes last, since only it needs a call of the system.
        if !has_image_extension(&path) || is_hidden(&path) || path.is_dir() {
            continue;
        }
        if has_utf8_name(&path) {
            listing.images.push(path);
        } else {
            listing.notices.push(Notice::NameNotUtf8 { path });
        }
    }
    // Names that are equal in natural order ("1.png", "01.png") still need a definite order.
    listing
        .images
        .sort_by(|a, b| alphanumeric_sort::compare_path(a, b).then_with(|| a.cmp(b)));
    Ok(listing)
}

/// Whether a name has an image's extension.
pub fn has_image_extension(path: &Path) -> bool {
    path.extension().is_some_and(|extension| {
        IMAGE_EXTENSIONS
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Whether a document can keep the name of a file.
pub(super) fn has_utf8_name(path: &Path) -> bool {
    path.file_name().is_none_or(|name| name.to_str().is_some())
}

fn is_hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_and_a_single_image() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["10.png", "9.png"] {
            image::RgbImage::new(2, 2)
                .save(folder.path().join(name))
                .unwrap();
        }
        let source = FrameSource::open(folder.path()).unwrap();
        assert_eq!(source.len(), 2);
        assert_eq!(
            source.frame(0),
            Some(FrameRef::image(folder.path().join("9.png")))
        );
        assert_eq!(source.frame(2), None);
        let single = FrameSource::open(&folder.path().join("10.png")).unwrap();
        assert_eq!(
            (single.len(), single.is_empty(), single.notices()),
            (1, false, [].as_slice())
        );
        let missing = folder.path().join("11.png");
        assert_eq!(
            FrameSource::open(&missing).unwrap_err(),
            MediaError::Missing { path: missing }
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_of_a_name_that_no_document_keeps_is_refused() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        for name in [&b"\xff.png"[..], &b"\xff.mp4"[..]] {
            let path = folder.path().join(std::ffi::OsStr::from_bytes(name));
            std::fs::write(&path, "").unwrap();
            assert_eq!(
                FrameSource::open(&path).unwrap_err(),
                MediaError::NameNotUtf8 { path }
            );
        }
    }

    fn names(listing: &FolderListing) -> Vec<String> {
        listing
            .images
            .iter()
            .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn natural_order_and_only_images() {
        let folder = tempfile::tempdir().unwrap();
        for name in [
            "f10.png",
            "f9.PNG",
            "f1.jpeg",
            "._f1.jpeg",
            "notes.txt",
            "f2",
            "f02.webp",
            "f2.webp",
            "a.tiff",
        ] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("folder.png")).unwrap();
        let listing = list_images(folder.path()).unwrap();
        assert_eq!(
            names(&listing),
            [
                "a.tiff", "f1.jpeg", "f2.webp", "f02.webp", "f9.PNG", "f10.png"
            ]
        );
        assert!(listing.notices.is_empty());
    }

    #[test]
    fn a_file_and_nothing_are_not_folders() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.png");
        std::fs::write(&file, "x").unwrap();
        assert_eq!(
            list_images(&file).unwrap_err(),
            MediaError::NotAFolder { path: file }
        );
        let nothing = folder.path().join("nothing");
        assert_eq!(
            list_images(&nothing).unwrap_err(),
            MediaError::Missing { path: nothing }
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_name_that_is_not_utf8_is_left_out_and_said() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("é.png"), "").unwrap();
        std::fs::write(
            folder.path().join(std::ffi::OsStr::from_bytes(b"\xff.png")),
            "",
        )
        .unwrap();
        let listing = list_images(folder.path()).unwrap();
        assert_eq!(names(&listing), ["é.png"]);
        assert_eq!(
            listing.notices[0].to_string(),
            "\u{fffd}.png: left out, its name is not UTF-8. Rename the file to use it."
        );
    }
}
