//! Creates a document from a folder of images or a video.

use super::paths::resolve_path;
use super::{Camera, CameraId, Document, FieldSpec, Frame, VideoFrame, path_between};
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_vision::media::{self, FrameSource, MediaError, VideoInfo};

/// The name of a new document's camera.
const CAMERA: &str = "main";

/// A document that was made from frames.
#[derive(Debug)]
pub struct NewDocument {
    /// The document.
    pub document: Document,
    /// Images that cannot be read, by name, with the reason; they are left out.
    pub left_out: Vec<(String, MediaError)>,
}

/// Creates a document from every `every`-th frame of a source, for a project in `folder`
/// (absolute): new frames, and for each picture size a camera without a base, the first one named
/// `main`.
///
/// Images are read in parallel for their size and SHA-256; each frame is reported to `progress`,
/// from any thread. If it cancels, frames are missing.
pub fn document_from_frames(
    source: &FrameSource,
    folder: &Path,
    field: FieldSpec,
    every: NonZeroUsize,
    progress: &Progress<'_, ()>,
) -> NewDocument {
    let mut made = NewDocument {
        document: Document::new(field),
        left_out: Vec::new(),
    };
    match source {
        FrameSource::Folder(listing) => {
            let images: Vec<&PathBuf> = listing.images.iter().step_by(every.get()).collect();
            // When `progress` cancels, `while_some` may leave out images before others that another
            // thread has read already. So each result has its path beside it.
            let read = images.into_par_iter().map(|path| {
                let read = media::image_size(path)
                    .and_then(|size| Ok((size, media::sha256_of_file(path)?)));
                progress.report(()).is_continue().then_some((path, read))
            });
            for (path, read) in read.while_some().collect::<Vec<_>>() {
                match read {
                    Ok((size, sha256)) => made.add_image(&relative(folder, path), size, sha256),
                    Err(error) => made.left_out.push((path.display().to_string(), error)),
                }
            }
        }
        FrameSource::Video(info) => made.add_video(info, folder, every, progress),
    }
    made
}

/// The path of a file relative to a folder, whether or not either exists.
fn relative(folder: &Path, file: &Path) -> String {
    path_between(&resolve_path(folder), &resolve_path(file))
}

impl NewDocument {
    fn add_image(&mut self, image: &str, size: ImageSize, sha256: String) {
        let camera = self.camera_of_size(size);
        self.document.frames.push(
            Frame {
                sha256: Some(sha256),
                ..Frame::from_image(image, camera, size)
            }
            .into(),
        );
    }

    fn add_video(
        &mut self,
        info: &VideoInfo,
        folder: &Path,
        every: NonZeroUsize,
        progress: &Progress<'_, ()>,
    ) {
        let camera = self.camera_of_size(info.size);
        let path = relative(folder, &info.path);
        // Without it the frames are only not compared with their video later.
        let file_id = media::video_file_id(&info.path).ok().map(Arc::from);
        for index in (0..info.decoded_frames).step_by(every.get()) {
            let video = VideoFrame {
                file_id: file_id.clone(),
                ..VideoFrame::new(&path, index as u64, info.pts_s(index))
            };
            self.document
                .frames
                .push(Frame::from_video(video, camera.clone(), info.size).into());
            if progress.report(()).is_break() {
                break;
            }
        }
    }

    /// The camera with this picture size; created if there is none yet.
    fn camera_of_size(&mut self, size: ImageSize) -> CameraId {
        let cameras = &mut self.document.cameras;
        if let Some(camera) = cameras.iter().find(|camera| camera.image_size == size) {
            return camera.id.clone();
        }
        // Sizes differ between cameras, so a size makes a name that no other camera has.
        let id = if cameras.is_empty() {
            CAMERA.to_owned()
        } else {
            format!("{CAMERA}_{}x{}", size.width, size.height)
        };
        let camera = Camera::new(id.as_str().into(), size);
        let id = camera.id.clone();
        cameras.push(camera.into());
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let every = NonZeroUsize::MIN;
        let made = document_from_frames(
            &source,
            &folder,
            FieldSpec::new("soccer"),
            every,
            &Progress::default(),
        );
        let names: Vec<_> = made
            .document
            .frames
            .iter()
            .map(|frame| frame.name())
            .collect();
        assert_eq!(
            names,
            ["../frames/9.png", "../frames/10.png", "../frames/11.png"]
        );
        let cameras: Vec<_> = made
            .document
            .cameras
            .iter()
            .map(|camera| camera.id.as_str().to_owned())
            .collect();
        assert_eq!(cameras, ["main", "main_32x18"]);
        assert_eq!(made.document.frames[0].sha256.as_ref().unwrap().len(), 64);
        assert!(
            made.left_out.len() == 1 && made.left_out[0].0.ends_with("12.png"),
            "{:?}",
            made.left_out
        );
    }
}
