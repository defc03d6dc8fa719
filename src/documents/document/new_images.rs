//! Images that came to the folders of a document, or went, since it was made.

use super::paths::resolve_path;
use super::{Camera, CameraId, Document, Frame, FrameId, Shared};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_vision::media::{self, MediaError};

/// How the folders of a document's images differ from what the document has of them.
#[derive(Debug, Default)]
pub struct FolderChanges {
    /// Images that the document lacks.
    new: Vec<NewRun>,
    /// New images that cannot be read, by path, with the reason.
    pub left_out: Vec<(String, MediaError)>,
    /// The number of images of the document that its folders lack.
    pub gone: usize,
}

/// New images that follow one another in their folder.
#[derive(Debug)]
struct NewRun {
    /// The frame of the image before them; none at the beginning of the folder.
    after: Option<FrameId>,
    frames: Vec<Frame>,
}

/// A folder that frames of a document are in.
#[derive(Default)]
struct KnownFolder {
    /// The frames by the names of their files.
    frames: BTreeMap<OsString, FrameId>,
    /// The path of one of them, as the document writes it.
    written: String,
}

impl FolderChanges {
    /// Compares the folders in which a document's images are with the document, whose own folder is
    /// `folder`. New images are read for their size and SHA-256; each is reported to `progress`.
    ///
    /// A document that has every n-th image of a folder is a sample and stays one.
    pub fn find(document: &Document, folder: &Path, progress: &Progress<'_, ()>) -> Self {
        let mut changes = Self::default();
        for (path, known) in known_folders(document, folder) {
            // A folder that is gone, or has other images by now, is another matter: each frame
            // lacks its picture.
            let Ok(listing) = media::list_images(&path) else {
                continue;
            };
            let name_at = |position: &usize| listing.images[*position].file_name();
            let is_known = |position: &usize| {
                name_at(position).is_some_and(|name| known.frames.contains_key(name))
            };
            let positions: Vec<usize> = (0..listing.images.len()).filter(is_known).collect();
            if positions.is_empty() {
                continue;
            }
            changes.gone += known.frames.len() - positions.len();
            if !is_sample(&positions) {
                changes.add_new(&known, &listing.images, progress);
            }
        }
        changes
    }

    /// The number of images that came.
    pub fn count(&self) -> usize {
        self.new.iter().map(|run| run.frames.len()).sum()
    }

    /// Adds the frames of the images of a folder that are not known.
    fn add_new(&mut self, known: &KnownFolder, images: &[PathBuf], progress: &Progress<'_, ()>) {
        let of = |path: &PathBuf| known.frames.get(path.file_name().unwrap_or_default());
        // Each new image with the last known one before it.
        let mut after = None;
        let new: Vec<(Option<FrameId>, &PathBuf)> = images
            .iter()
            .filter_map(|path| match of(path) {
                Some(id) => {
                    after = Some(id.clone());
                    None
                }
                None => Some((after.clone(), path)),
            })
            .collect();
        let read = new.into_par_iter().map(|(after, path)| {
            let read =
                media::image_size(path).and_then(|size| Ok((size, media::sha256_of_file(path)?)));
            progress
                .report(())
                .is_continue()
                .then_some((after, path, read))
        });
        for (after, path, read) in read.while_some().collect::<Vec<_>>() {
            let (size, sha256) = match read {
                Ok(read) => read,
                Err(error) => {
                    self.left_out.push((path.display().to_string(), error));
                    continue;
                }
            };
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let image = match known.written.rsplit_once('/') {
                Some((folder, _)) => format!("{folder}/{name}"),
                None => name.into_owned(),
            };
            let frame = Frame {
                sha256: Some(sha256),
                ..Frame::from_image(&image, CameraId::from("main"), size)
            };
            match self.new.last_mut().filter(|run| run.after == after) {
                Some(run) => run.frames.push(frame),
                None => self.new.push(NewRun {
                    after,
                    frames: vec![frame],
                }),
            }
        }
    }
}

impl Document {
    /// Adds the images that came, each behind the one before it in its folder and with the camera
    /// of that one. Frames that it has by now are left alone. Returns the number of frames added.
    pub fn add_images(&mut self, changes: &FolderChanges) -> usize {
        let before = self.frames.len();
        for NewRun { after, frames } in &changes.new {
            let place = after.as_ref().and_then(|id| self.frames.position_of(id));
            let neighbour = self.frames.get(place.unwrap_or(0));
            let neighbour = neighbour.map(|frame| frame.camera.clone());
            let mut added: Vec<Shared<Frame>> = Vec::new();
            for frame in frames {
                if self.frames.by_id(&frame.id).is_none() {
                    let camera = self.camera_for_size(neighbour.as_ref(), frame.image_size);
                    let frame = frame.clone();
                    added.push(Frame { camera, ..frame }.into());
                }
            }
            self.frames
                .insert_all(place.map_or(0, |place| place + 1), added);
        }
        self.frames.len() - before
    }

    /// The preferred camera if its pictures have this size, else one whose pictures do; created if
    /// there is none.
    fn camera_for_size(&mut self, preferred: Option<&CameraId>, size: ImageSize) -> CameraId {
        let preferred = preferred.and_then(|id| self.camera(id));
        let others = self.cameras.iter().map(|camera| &**camera);
        let mut known = preferred.into_iter().chain(others);
        if let Some(camera) = known.find(|camera| camera.image_size == size) {
            return camera.id.clone();
        }
        let id = self.free_camera_name(&"main".into());
        self.cameras.push(Camera::new(id.clone(), size).into());
        id
    }
}

/// The folders of a document's still images.
fn known_folders(document: &Document, folder: &Path) -> BTreeMap<PathBuf, KnownFolder> {
    let mut folders: BTreeMap<PathBuf, KnownFolder> = BTreeMap::new();
    for frame in document.frames.iter().filter(|frame| frame.video.is_none()) {
        let (Some(path), Some(written)) = (frame.image_path(folder), &frame.image) else {
            continue;
        };
        let path = resolve_path(&path);
        let (Some(parent), Some(name)) = (path.parent(), path.file_name()) else {
            continue;
        };
        let known = folders.entry(parent.to_path_buf()).or_default();
        known.frames.insert(name.to_owned(), frame.id.clone());
        known.written.clone_from(written);
    }
    folders
}

/// Whether these positions in a folder are every n-th, n at least 2. Two positions say nothing.
fn is_sample(positions: &[usize]) -> bool {
    const MIN_POSITIONS: usize = 3;
    let steps: BTreeSet<usize> = positions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    positions.len() >= MIN_POSITIONS
        && steps.len() == 1
        && steps.first().is_some_and(|step| *step > 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{FieldSpec, document_from_frames};
    use std::num::NonZeroUsize;
    use touchline_vision::media::FrameSource;

    fn write(folder: &Path, names: &[&str]) {
        for name in names {
            image::RgbImage::new(64, 36)
                .save(folder.join(name))
                .unwrap();
        }
    }

    fn made_of(frames: &Path, folder: &Path, every: usize) -> Document {
        let source = FrameSource::open(frames).unwrap();
        let (field, every) = (FieldSpec::new("soccer"), NonZeroUsize::new(every).unwrap());
        document_from_frames(&source, folder, field, every, &Progress::default()).document
    }

    fn names(document: &Document) -> Vec<String> {
        let name = |frame: &Shared<Frame>| frame.name().rsplit('/').next().unwrap().to_owned();
        document.frames.iter().map(name).collect()
    }

    #[test]
    fn images_that_came_take_their_places_and_those_that_went_stay() {
        let root = tempfile::tempdir().unwrap();
        let (frames, project) = (root.path().join("frames"), root.path().join("project"));
        std::fs::create_dir(&frames).unwrap();
        std::fs::create_dir(&project).unwrap();
        write(&frames, &["2.png", "4.png", "5.png"]);
        let mut document = made_of(&frames, &project, 1);
        document.frames[1].camera = "side".into();
        document
            .cameras
            .push(Camera::new("side".into(), ImageSize::new(64, 36)).into());
        let find =
            |document: &Document| FolderChanges::find(document, &project, &Progress::default());
        let none = find(&document);
        assert_eq!((none.count(), none.gone), (0, 0));
        write(&frames, &["1.png", "3.png", "6.png", "10.png"]);
        std::fs::write(frames.join("7.png"), "no image").unwrap();
        std::fs::remove_file(frames.join("5.png")).unwrap();
        let changes = find(&document);
        assert_eq!((changes.count(), changes.gone), (4, 1));
        assert!(changes.left_out.len() == 1 && changes.left_out[0].0.ends_with("7.png"));
        let known = document.clone();
        assert_eq!(document.add_images(&changes), 4);
        let all = [
            "1.png", "2.png", "3.png", "4.png", "6.png", "10.png", "5.png",
        ];
        assert_eq!(names(&document), all);
        let cameras: Vec<_> = document
            .frames
            .iter()
            .map(|frame| frame.camera.as_str())
            .collect();
        assert_eq!(cameras[3..6], ["side"; 3]);
        assert_eq!(cameras[..3], ["main"; 3]);
        assert_eq!(document.add_images(&changes), 0, "they are there now");
        for frame in &known.frames {
            assert_eq!(document.frames.by_id(&frame.id), Some(frame));
        }
    }

    #[test]
    fn every_second_image_of_a_folder_is_a_sample() {
        let root = tempfile::tempdir().unwrap();
        write(root.path(), &["1.png", "2.png", "3.png", "4.png", "5.png"]);
        let document = made_of(root.path(), root.path(), 2);
        assert_eq!(document.frames.len(), 3);
        let changes = FolderChanges::find(&document, root.path(), &Progress::default());
        assert_eq!(changes.count(), 0);
    }
}
