//! The names of pictures in a dataset: their original names, but never a path that leaves the
//! folder.

use super::options::{PictureFormat, Pictures};
use crate::document::Frame;
use crate::exchange::cameras::camera_format::file_stem;
use crate::exchange::files::base_name;
use crate::exchange::syntax::node::safe_path;
use std::path::Path;

/// The usual folder of pictures, which is not repeated.
const IMAGES: &str = "images/";

/// The path of a frame's picture below the folder of its split: that of its image within the
/// document's folder, or the image's file name if it lies elsewhere; for a frame of a video, the
/// video's name and the frame number.
///
/// # Errors
/// The name is not a valid file name; the reason in words.
pub fn picture_name(
    frame: &Frame,
    pictures: Pictures,
    format: PictureFormat,
) -> Result<String, String> {
    let name = match (&frame.image, &frame.video) {
        (Some(image), _) => name_from_image(image),
        (None, Some(video)) => {
            let stem = file_stem(&video.path);
            format!("{stem}_{:06}.{}", video.frame_index, format.ending())
        }
        (None, None) => return Err("it has no picture".to_owned()),
    };
    // A picture that is written anew has the ending of its new format.
    let name = if pictures == Pictures::Extracted && frame.image.is_some() {
        Path::new(&name)
            .with_extension(format.ending())
            .to_string_lossy()
            .into_owned()
    } else {
        name
    };
    refuse_unusable(&name)?;
    Ok(name)
}

fn name_from_image(image: &str) -> String {
    // `a//b`, `./a` and `a` would otherwise be three names of one file.
    if let Ok(path) = safe_path(image) {
        let plain: Vec<&str> = path
            .split('/')
            .filter(|part| !part.is_empty() && *part != ".")
            .collect();
        let plain = plain.join("/");
        return plain
            .strip_prefix(IMAGES)
            .map_or_else(|| plain.clone(), ToOwned::to_owned);
    }
    base_name(image).to_owned()
}

/// Rejects a name that would leave the folder, or break the lines of a list.
fn refuse_unusable(name: &str) -> Result<(), String> {
    let leaves = safe_path(name).is_err() || name.ends_with('/');
    if leaves || name.is_empty() || name == "." {
        return Err(format!(
            "its picture's name {name:?} would leave the dataset's folder"
        ));
    }
    if name.contains(|letter: char| letter.is_control()) {
        return Err(format!(
            "its picture's name {name:?} holds control characters"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::VideoFrame;
    use touchline_core::geometry::ImageSize;

    fn named(image: &str) -> Result<String, String> {
        let frame = Frame::from_image(image, "main".into(), ImageSize::new(64, 36));
        picture_name(&frame, Pictures::Copied, PictureFormat::Png)
    }

    #[test]
    fn names_are_kept_and_nothing_leaves_the_folder() {
        for (image, name) in [
            ("images/0001.jpg", "0001.jpg"),
            ("./images//a/0001.jpg", "a/0001.jpg"),
            ("left\\0001.jpg", "left/0001.jpg"),
            ("../../other/0001.jpg", "0001.jpg"),
            ("/data/0001.jpg", "0001.jpg"),
            ("C:\\data\\0001.jpg", "0001.jpg"),
        ] {
            assert_eq!(named(image).unwrap(), name);
        }
        for (image, wanted) in [
            (
                "images/..",
                "its picture's name \"..\" would leave the dataset's folder",
            ),
            (
                "/data/",
                "its picture's name \"\" would leave the dataset's folder",
            ),
            (
                "/data/..\\..",
                "its picture's name \"..\" would leave the dataset's folder",
            ),
            (
                "a\nb.jpg",
                "its picture's name \"a\\nb.jpg\" holds control characters",
            ),
        ] {
            assert_eq!(named(image).unwrap_err(), wanted);
        }
    }

    #[test]
    fn frames_of_a_video_are_named_by_it_and_their_number() {
        let video = VideoFrame::new("../matches/final.mp4", 412, None);
        let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
        assert_eq!(
            picture_name(&frame, Pictures::Copied, PictureFormat::Jpeg).unwrap(),
            "final_000412.jpg"
        );
        let image = Frame::from_image("images/0001.tif", "main".into(), ImageSize::new(64, 36));
        assert_eq!(
            picture_name(&image, Pictures::Extracted, PictureFormat::Png).unwrap(),
            "0001.png"
        );
    }
}
