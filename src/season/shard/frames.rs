//! The frames of a window, and the camera of each.

use super::{OpenSource, ShardError, ShardEvent, Work};
use crate::part::CameraRun;
use crate::plan::LabelShard;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    CameraId, Document, FieldSpec, Frame, Shared, VideoFrame, document_from_frames, path_between,
    resolve_path,
};
use touchline_vision::media::{FrameRef, FrameSource, MediaError, VideoInfo, video_file_id};

impl OpenSource {
    /// Opens frames by a path without links, so that they have the names that parts have.
    pub(super) fn open(folder: PathBuf, name: String) -> Result<Self, MediaError> {
        let frames = FrameSource::open(&folder.join(&name))?;
        let mut number_of_image = BTreeMap::new();
        if let FrameSource::Folder(listing) = &frames {
            let numbered = listing.images.iter().cloned().zip(0..);
            number_of_image.extend(numbered);
        }
        let file_id = match &frames {
            FrameSource::Video(info) => video_file_id(&info.path).ok().map(Arc::from),
            FrameSource::Folder(_) => None,
        };
        Ok(Self {
            frames,
            number_of_image,
            folder,
            name,
            file_id,
        })
    }

    /// The number of a document's frame among all frames of the match; none if it is not one of
    /// them.
    pub(super) fn number_of(&self, frame: &Frame) -> Option<usize> {
        match (&self.frames, frame.picture_source(&self.folder)?) {
            (FrameSource::Video(info), FrameRef::Video { path, index }) => {
                (path == info.path && index < info.decoded_frames).then_some(index)
            }
            (FrameSource::Folder(_), FrameRef::Image(path)) => {
                self.number_of_image.get(&*path).copied()
            }
            _ => None,
        }
    }

    /// Names frames of a project that lead to the match through a link as parts name them. They
    /// would else count as other pictures, and the match's own would be labelled beside them.
    pub(super) fn name_without_links(&self, document: &mut Document) {
        for frame in &mut document.frames {
            if self.number_of(frame).is_some() {
                continue;
            }
            match frame.picture_source(&self.folder) {
                Some(FrameRef::Image(path)) => {
                    // The links of its folder alone, for an image of the match may be one itself.
                    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
                        continue;
                    };
                    let real = resolve_path(folder).join(name);
                    if self.number_of_image.contains_key(&real) {
                        frame.image = Some(path_between(&self.folder, &real));
                    }
                }
                Some(FrameRef::Video { path, .. }) => {
                    if let FrameSource::Video(info) = &self.frames
                        && resolve_path(&path) == *info.path
                        && let Some(video) = &mut frame.video
                    {
                        video.path.clone_from(&self.name);
                    }
                }
                None => {}
            }
        }
    }
}

impl Work<'_> {
    /// The frames of a window as new frames of a document: an image that cannot be read is left out
    /// and reported.
    pub(super) fn new_frames(
        &self,
        label: &LabelShard,
        field: &FieldSpec,
    ) -> Result<BTreeMap<usize, Shared<Frame>>, ShardError> {
        let numbers = label.first..=label.last;
        match &self.source.frames {
            FrameSource::Video(info) => {
                let frames =
                    numbers.map(|number| (number, self.frame_of_video(info, number).into()));
                Ok(frames.collect())
            }
            FrameSource::Folder(listing) => {
                // Numbers are found again by path, because images that cannot be read are missing.
                let images = listing.images.get(numbers).unwrap_or_default().to_vec();
                let made = self.document_of(&images.into(), field);
                if self.progress.is_cancelled() {
                    return Err(ShardError::Stopped);
                }
                let numbered = made.frames.iter().filter_map(|frame| {
                    let number = self.source.number_of(frame)?;
                    Some((number, frame.clone()))
                });
                Ok(numbered.collect())
            }
        }
    }

    fn frame_of_video(&self, info: &VideoInfo, number: usize) -> Frame {
        // `frames_of_window` fills in the camera, which it takes from the find part.
        let video = VideoFrame {
            file_id: self.source.file_id.clone(),
            ..VideoFrame::new(&self.source.name, number as u64, info.pts_s(number))
        };
        Frame::from_video(video, CameraId::from(""), info.size)
    }

    /// A document of new frames; those that cannot be read are reported.
    pub(super) fn document_of(&self, frames: &FrameSource, field: &FieldSpec) -> Document {
        let made = document_from_frames(
            frames,
            &self.source.folder,
            field.clone(),
            NonZeroUsize::MIN,
            &Progress::default(),
        );
        for (frame, error) in made.left_out {
            let _ = self.progress.report(ShardEvent::LeftOut { frame, error });
        }
        made.document
    }
}

/// Which camera took which frames: the runs of the numbered frames of a document.
pub(super) fn runs_of(frames: impl IntoIterator<Item = (usize, CameraId)>) -> Vec<CameraRun> {
    // In the order of the match, whatever the order of the document. Where the document lacks
    // frames, a run goes on to the next frame that is of another camera.
    let numbered: BTreeMap<usize, CameraId> = frames.into_iter().collect();
    let mut runs: Vec<CameraRun> = Vec::new();
    for (number, camera) in numbered {
        let camera = camera.as_str();
        if runs.last().is_none_or(|last| last.camera != camera) {
            runs.push(CameraRun {
                first: number,
                camera: camera.to_owned(),
            });
        }
    }
    runs
}

/// The camera of a frame: that of the last run that begins before it, else of the first run.
pub(super) fn camera_of(runs: &[CameraRun], number: usize) -> Option<CameraId> {
    let next = runs.partition_point(|run| run.first <= number);
    let run = runs.get(next.saturating_sub(1))?;
    Some(CameraId::from(run.camera.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::{WithFrames, soccer_document};

    #[cfg(unix)]
    #[test]
    fn frames_of_a_project_that_lead_to_the_match_through_a_link_are_of_the_match() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().canonicalize().unwrap();
        let images = folder.join("disk/north");
        std::fs::create_dir_all(&images).unwrap();
        image::RgbImage::new(8, 8)
            .save(images.join("1.png"))
            .unwrap();
        std::os::unix::fs::symlink(&images, folder.join("linked")).unwrap();
        let source = OpenSource::open(folder.join("disk"), "north".to_owned()).unwrap();
        let size = touchline_core::geometry::ImageSize::new(8, 8);
        let mut document =
            soccer_document().with_pictures(["../linked/1.png", "../other/1.png"], size);
        source.name_without_links(&mut document);
        let named = document.frames.iter().map(|frame| frame.image.as_deref());
        let named: Vec<_> = named.flatten().collect();
        assert_eq!(named, ["north/1.png", "../other/1.png"]);
        assert_eq!(source.number_of(&document.frames[0]), Some(0));
    }

    #[test]
    fn every_frame_has_the_camera_of_its_run() {
        let frames = [(9, "b"), (2, "a"), (3, "a"), (7, "b"), (12, "a")];
        let runs = runs_of(frames.map(|(number, camera)| (number, camera.into())));
        assert_eq!(runs.len(), 3);
        let camera = |number| camera_of(&runs, number).unwrap().as_str().to_owned();
        let found = [0, 2, 6, 7, 11, 12, 99].map(camera);
        assert_eq!(found, ["a", "a", "a", "b", "b", "a", "a"]);
        assert_eq!(camera_of(&[], 3), None);
    }
}
