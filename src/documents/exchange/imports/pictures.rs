//! Finds the pictures of imported frames.

use crate::document::Document;
use crate::exchange::cameras::camera_format::{file_stem, has_ending};
use crate::exchange::cameras::frame_camera::FrameCamera;
use crate::exchange::error::ExchangeError;
use crate::exchange::syntax::values::shorten;
use std::collections::{BTreeMap, BTreeSet};
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

/// Gives frames that have a number and neither image nor video the video that they are of, under
/// the name of their file: one for all of them, or one a camera where the numbers of cameras
/// coincide. Says how many there are.
pub fn name_tracks(frames: &mut [FrameCamera], path: &Path) -> usize {
    let is_of_track = |frame: &FrameCamera| frame.image.is_none() && frame.video.is_none();
    let mut first_cameras: BTreeMap<u64, Option<&str>> = BTreeMap::new();
    let of_tracks = frames.iter().filter(|frame| is_of_track(frame));
    let numbered: Vec<_> = of_tracks
        .filter_map(|frame| Some((frame.frame_index?, frame.camera.as_deref())))
        .collect();
    let coincide = numbered
        .iter()
        .any(|(number, camera)| *first_cameras.entry(*number).or_insert(*camera) != *camera);
    let count = numbered.len();
    // A name with an ending is that of a file, which has no name of its own (`places::names_video`).
    let track = file_stem(&path.to_string_lossy()).replace('.', "_");
    for frame in frames {
        if is_of_track(frame) && frame.frame_index.is_some() {
            frame.video = Some(match &frame.camera {
                Some(camera) if coincide => format!("{track} {}", camera.replace('.', "_")),
                _ => track.clone(),
            });
        }
    }
    count
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
    use crate::exchange::cameras::frame_camera::FrameProjection;

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

    /// The video of each frame of a table `match.v2.csv` that states cameras and numbers alone.
    fn tracks(stated: &[(&str, u64)]) -> Vec<String> {
        let mut frames: Vec<FrameCamera> = stated
            .iter()
            .map(|(camera, number)| FrameCamera {
                camera: Some((*camera).to_owned()),
                frame_index: Some(*number),
                ..FrameCamera::new(
                    &format!("{camera}#{number}"),
                    None,
                    FrameProjection::Nothing,
                )
            })
            .collect();
        assert_eq!(
            name_tracks(&mut frames, Path::new("/a/match.v2.csv")),
            stated.len()
        );
        frames.into_iter().filter_map(|frame| frame.video).collect()
    }

    #[test]
    fn rows_without_a_picture_are_frames_of_one_video() {
        assert_eq!(tracks(&[("main", 0), ("main", 1)]), ["match_v2"; 2]);
        assert_eq!(
            tracks(&[("main", 0), ("goal", 1)]),
            ["match_v2"; 2],
            "in turn"
        );
        let at_once = tracks(&[("main", 0), ("goal.left", 0)]);
        assert_eq!(at_once, ["match_v2 main", "match_v2 goal_left"]);
        let mut pictures = [FrameCamera {
            image: Some("0001.jpg".to_owned()),
            ..FrameCamera::new("0001", None, FrameProjection::Nothing)
        }];
        assert_eq!(name_tracks(&mut pictures, Path::new("a.csv")), 0);
        assert_eq!(pictures[0].video, None);
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
