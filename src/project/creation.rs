//! A new document from a folder of images or a video.

use super::{Camera, CameraId, Document, FieldSpec, Frame, VideoFrame, path_between};
use crate::geometry::ImageSize;
use crate::media::{FolderListing, FrameSource, MediaError, VideoInfo, image_size, sha256_of_file};
use rayon::prelude::*;
use std::path::Path;
use thiserror::Error;

/// The first camera's name.
const FIRST_CAMERA: &str = "main";

/// Why no document can be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CreationError {
    /// There is nothing to label.
    #[error("{path} holds no image that can be read; PNG, JPEG, TIFF, BMP and WebP files and videos are")]
    NoFrames {
        /// The folder or video.
        path: String,
    },
}

/// A new document, and what a person should know about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Created {
    /// The document: one camera for each size of picture, every frame new.
    pub document: Document,
    /// Images that were left out, a video shorter than it says.
    pub notices: Vec<String>,
}

/// Makes a document of the frames of a source. `folder` is where the document will lie: paths are relative to it.
///
/// Images are read only as far as their size, and hashed; both in parallel. What cannot be read is left out and named.
///
/// # Errors
/// There is no frame.
pub fn new_document(
    source: &FrameSource,
    path: &Path,
    folder: &Path,
    field: FieldSpec,
) -> Result<Created, CreationError> {
    let mut created =
        Created { document: Document::new(field), notices: source.notices().iter().map(ToString::to_string).collect() };
    match source {
        FrameSource::Folder(listing) => add_images(&mut created, listing, folder),
        FrameSource::Video(info) => add_video(&mut created, info, folder),
    }
    if created.document.frames.is_empty() {
        return Err(CreationError::NoFrames { path: path.display().to_string() });
    }
    Ok(created)
}

fn add_images(created: &mut Created, listing: &FolderListing, folder: &Path) {
    let read: Vec<Result<(ImageSize, String), MediaError>> =
        listing.images.par_iter().map(|path| Ok((image_size(path)?, sha256_of_file(path)?))).collect();
    for (path, read) in listing.images.iter().zip(read) {
        match read {
            Ok((size, sha256)) => {
                let camera = camera_for(&mut created.document, size);
                let mut frame = Frame::from_image(&path_between(folder, path), camera, size);
                frame.sha256 = Some(sha256);
                created.document.frames.push(frame.into());
            }
            Err(error) => created.notices.push(format!("Left out: {error}")),
        }
    }
}

fn add_video(created: &mut Created, info: &VideoInfo, folder: &Path) {
    let path = path_between(folder, &info.path);
    let camera = camera_for(&mut created.document, info.size);
    created.document.frames = (0..info.decoded_frames)
        .map(|index| {
            let video = VideoFrame::new(&path, index as u64, info.pts_s(index));
            Frame::from_video(video, camera.clone(), info.size).into()
        })
        .collect();
}

/// The camera whose pictures have this size, made if there is none: "main", then "main-1280x720".
fn camera_for(document: &mut Document, size: ImageSize) -> CameraId {
    if let Some(camera) = document.cameras.iter().find(|camera| camera.image_size == size) {
        return camera.id.clone();
    }
    let id: CameraId = if document.cameras.is_empty() {
        FIRST_CAMERA.into()
    } else {
        format!("{FIRST_CAMERA}-{}x{}", size.width, size.height).as_str().into()
    };
    document.cameras.push(Camera::new(id.clone(), size).into());
    id
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::FrameSource;

    fn write_png(path: &Path, width: u32, height: u32) {
        image::RgbImage::new(width, height).save(path).unwrap();
    }

    #[test]
    fn a_folder_becomes_a_document_with_relative_paths_and_a_camera_for_each_size() {
        let root = tempfile::tempdir().unwrap();
        let frames = root.path().join("frames");
        std::fs::create_dir(&frames).unwrap();
        write_png(&frames.join("9.png"), 64, 36);
        write_png(&frames.join("10.png"), 64, 36);
        write_png(&frames.join("11.png"), 32, 18);
        std::fs::write(frames.join("12.png"), "no image").unwrap();
        let source = FrameSource::open(&frames).unwrap();
        let folder = root.path().join("project");
        let created = new_document(&source, &frames, &folder, FieldSpec::new("soccer")).unwrap();
        let names: Vec<_> = created.document.frames.iter().map(|frame| frame.name()).collect();
        assert_eq!(names, ["../frames/9.png", "../frames/10.png", "../frames/11.png"]);
        let cameras: Vec<_> = created.document.cameras.iter().map(|camera| camera.id.as_str().to_owned()).collect();
        assert_eq!(cameras, ["main", "main-32x18"]);
        assert_eq!(created.document.frames[0].sha256.as_ref().unwrap().len(), 64);
        assert!(created.notices.len() == 1 && created.notices[0].contains("12.png"), "{:?}", created.notices);
    }

    #[test]
    fn a_folder_without_images_is_named() {
        let root = tempfile::tempdir().unwrap();
        let source = FrameSource::open(root.path()).unwrap();
        let error = new_document(&source, root.path(), root.path(), FieldSpec::new("soccer")).unwrap_err();
        assert!(error.to_string().contains("holds no image that can be read"), "{error}");
    }
}
