//! Finds the pictures of imported frames.

use crate::exchange::cameras::camera_format::has_ending;
use std::path::{Path, PathBuf};
use touchline_core::geometry::ImageSize;
use touchline_vision::media;

/// Extensions that are tried if a format names a frame without the extension of its image.
const IMAGE_ENDINGS: [&str; 9] = [
    "jpg", "png", "jpeg", "JPG", "PNG", "tif", "tiff", "bmp", "webp",
];

/// The file of a named image within a folder, and its size if it exists.
#[must_use]
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
    let found = candidates.iter().find(|file| images.join(file).is_file());
    let size = found.and_then(|file| media::image_size(&images.join(file)).ok());
    // Where no picture is there, the document still names one, so that it is found when it comes:
    // with the commonest ending.
    let first = candidates.first().cloned().unwrap_or_default();
    (found.cloned().unwrap_or(first), size)
}

#[cfg(test)]
mod tests {
    use super::*;

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
