//! The images of a folder in natural order.

use super::{MediaError, Notice};
use std::path::{Path, PathBuf};

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
pub(super) fn has_image_extension(path: &Path) -> bool {
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
