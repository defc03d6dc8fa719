//! Finds the pictures of imported frames.

use crate::document::Document;
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::error::ExchangeError;
use crate::exchange::syntax::values::shorten;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use touchline_core::geometry::ImageSize;
use touchline_vision::media;

/// Extensions that are tried if a format names a frame without the extension of its image.
const IMAGE_ENDINGS: [&str; 9] = [
    "jpg", "png", "jpeg", "JPG", "PNG", "tif", "tiff", "bmp", "webp",
];

/// The file of a named image within a folder, and its size if it exists. Where the folder has no
/// such path, it may be the one that the path begins with: `0001.jpg` is `images/0001.jpg`.
pub fn image_of(named: &str, images: &Path) -> (PathBuf, Option<ImageSize>) {
    // SoccerNet, WC14 and YOLO name a frame without the ending of its picture. A name may have dots
    // of its own, so that only known endings count as one.
    let candidates: Vec<PathBuf> = if IMAGE_ENDINGS.iter().any(|ending| has_ending(named, ending)) {
        vec![PathBuf::from(named)]
    } else {
        IMAGE_ENDINGS
            .iter()
            .map(|ending| PathBuf::from(format!("{named}.{ending}")))
            .collect()
    };
    let shorter = |levels: usize| {
        let files = candidates.iter();
        files.map(move |file| file.iter().skip(levels).collect::<PathBuf>())
    };
    let levels = Path::new(named).iter().count();
    let found = (0..levels)
        .flat_map(shorter)
        .find(|file| images.join(file).is_file());
    let found = found.as_ref();
    let size = found.and_then(|file| media::image_size(&images.join(file)).ok());
    // Where no picture is there, the document still names one, so that it is found when it comes:
    // with the commonest ending.
    let first = candidates.first().cloned().unwrap_or_default();
    (found.cloned().unwrap_or(first), size)
}

/// Refuses two frames of one picture: without the folders in their names, left/1.jpg and right/1.jpg
/// are the same.
///
/// # Errors
/// Two frames have the same image; it is named.
pub fn refuse_shared_pictures(document: &Document, path: &Path) -> Result<(), ExchangeError> {
    let mut seen = BTreeSet::new();
    for frame in &document.frames {
        if let Some(image) = &frame.image
            && !seen.insert(image)
        {
            return Err(ExchangeError::SameFrame {
                path: path.to_path_buf(),
                name: shorten(image),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_found_without_the_folders_that_its_name_begins_with() {
        let folder = tempfile::tempdir().unwrap();
        let size = ImageSize::new(4, 2);
        let write = |name: &str| {
            let path = folder.path().join(name);
            image::RgbImage::new(4, 2).save(path).unwrap();
        };
        write("0001.png");
        for named in [
            "images/0001.png",
            "images/0001",
            "set/images/0001.png",
            "0001",
        ] {
            let found = image_of(named, folder.path());
            assert_eq!(found, (PathBuf::from("0001.png"), Some(size)), "{named}");
        }
        std::fs::create_dir(folder.path().join("images")).unwrap();
        write("images/0001.png");
        let found = image_of("images/0001", folder.path());
        assert_eq!(found.0, PathBuf::from("images/0001.png"));
    }

    #[test]
    fn a_picture_of_any_kind_keeps_its_ending() {
        for name in ["0001.webp", "0001.TIFF", "a.b.jpg"] {
            let found = image_of(name, Path::new("/no/pictures"));
            assert_eq!(found, (PathBuf::from(name), None));
        }
        let bare = image_of("frame.17", Path::new("/no/pictures"));
        assert_eq!(bare.0, PathBuf::from("frame.17.jpg"));
    }
}
