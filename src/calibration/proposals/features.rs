//! Extracts the features of a document's frames, or takes them from the store.

use super::picture::check_size;
use super::{FeatureStore, PictureError, read_picture};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use touchline_documents::document::{Document, Frame};
use touchline_vision::features::{FeatureKey, FeatureOptions, Features, extract};
use touchline_vision::media::{FrameReader, Picture, ReadFrames, sha256_of_file};

/// The pictures of a document's frames, and how features are extracted from them.
#[derive(Clone, Copy)]
pub struct FramePictures<'a> {
    /// The document.
    pub document: &'a Document,
    /// The folder to which its relative paths refer.
    pub folder: &'a Path,
    /// Options of the feature extraction.
    pub options: FeatureOptions,
    /// The store of features extracted before.
    pub store: &'a FeatureStore,
}

/// The features of a frame.
#[derive(Clone, Debug)]
pub struct FrameFeatures {
    /// The features outside the masks of the frame and its camera.
    pub features: Arc<Features>,
    /// Time of the extraction, without reading the picture; or of the look-up.
    pub time: Duration,
    /// Whether the image file differs from the one that the document knows.
    pub changed: bool,
}

/// Number of frames per batch: at most this many pictures of a video are in memory.
const BATCH: usize = 16;

/// The state of a frame before extraction: features from the store, a picture of a video, or an
/// image file that is still to be read.
enum Found {
    Before(FrameFeatures),
    Video(Result<Picture, PictureError>, Option<FeatureKey>),
    Image,
}

impl FramePictures<'_> {
    /// Calls `work` with the features of some frames, in parallel and batch by batch. Returns the
    /// results in the order of the frames; none if `work` ended it. Images are read in parallel,
    /// videos one frame after the other by `reader`.
    pub fn each<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        work: impl Fn(usize, &Frame, Result<FrameFeatures, PictureError>) -> ControlFlow<(), T> + Sync,
    ) -> Option<Vec<T>> {
        let ended = AtomicBool::new(false);
        let mut made = Vec::with_capacity(frames.len());
        // Videos are decoded here in sequence; extraction, and reading of images, runs in parallel
        // after that.
        for batch in frames.chunks(BATCH) {
            let mut begun = Vec::with_capacity(batch.len());
            for &index in batch {
                let frame = &*self.document.frames[index];
                let found = if frame.image.is_some() {
                    Found::Image
                } else {
                    self.of_video(reader, frame)
                };
                begun.push((index, frame, found));
            }
            let worked = begun.into_par_iter().map(|(index, frame, found)| {
                if ended.load(Ordering::Relaxed) {
                    return None;
                }
                let worked = work(index, frame, self.features_of(frame, found));
                if worked.is_break() {
                    ended.store(true, Ordering::Relaxed);
                }
                worked.continue_value()
            });
            made.extend(worked.collect::<Option<Vec<T>>>()?);
        }
        Some(made)
    }

    /// Calls `work` with the pictures of some frames, each read once, in parallel and batch by
    /// batch. Returns the results in the order of the frames; none if `work` ended it.
    pub(super) fn each_picture<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        work: impl Fn(usize, &Frame, Result<Picture, PictureError>) -> ControlFlow<(), T> + Sync,
    ) -> Option<Vec<T>> {
        let mut made = Vec::with_capacity(frames.len());
        for batch in frames.chunks(BATCH) {
            let mut begun = Vec::with_capacity(batch.len());
            for &index in batch {
                let frame = &*self.document.frames[index];
                let of_video = frame
                    .image
                    .is_none()
                    .then(|| read_picture(reader, frame, self.folder));
                begun.push((index, frame, of_video));
            }
            let worked = begun.into_par_iter().map(|(index, frame, of_video)| {
                let picture = of_video
                    .unwrap_or_else(|| read_picture(&mut FrameReader::new(), frame, self.folder));
                work(index, frame, picture).continue_value()
            });
            made.extend(worked.collect::<Option<Vec<T>>>()?);
        }
        Some(made)
    }

    /// The features of a picture, from the store if it has them.
    pub(super) fn features_in(
        &self,
        frame: &Frame,
        picture: &Picture,
    ) -> Result<Arc<Features>, PictureError> {
        // The store's key identifies the content: the hash of an image file, or the identity of a
        // video's frame.
        let identity = match frame.image_path(self.folder) {
            Some(path) => Some(sha256_of_file(&path)?),
            None => frame
                .picture_source(self.folder)
                .and_then(|source| source.video_identity()),
        };
        let key = identity.map(|identity| self.key(frame, &identity));
        if let Some(features) = key.as_ref().and_then(|key| self.store.get(key)) {
            return Ok(features);
        }
        Ok(self.look(frame, picture, key.as_ref(), false)?.features)
    }

    /// The features of a frame, from the state that was found.
    fn features_of(&self, frame: &Frame, found: Found) -> Result<FrameFeatures, PictureError> {
        match found {
            Found::Before(features) => Ok(features),
            Found::Video(picture, key) => self.look(frame, &picture?, key.as_ref(), false),
            Found::Image => self.of_image(frame),
        }
    }

    /// The features of an image file, from the store or extracted.
    fn of_image(&self, frame: &Frame) -> Result<FrameFeatures, PictureError> {
        let path = frame.image_path(self.folder).ok_or(PictureError::None)?;
        let sha256 = sha256_of_file(&path)?;
        // Compare with the hash that the document states, if any.
        let changed = frame
            .sha256
            .as_ref()
            .is_some_and(|stated| !stated.eq_ignore_ascii_case(&sha256));
        let key = self.key(frame, &sha256);
        if let Some(before) = self.before(frame, &key, &path.to_string_lossy(), changed)? {
            return Ok(before);
        }
        // Use a separate reader, so that no decoder stays open.
        let picture = read_picture(&mut FrameReader::new(), frame, self.folder)?;
        self.look(frame, &picture, Some(&key), changed)
    }

    /// The features of a video's frame from the store, or its picture.
    fn of_video(&self, reader: &mut dyn ReadFrames, frame: &Frame) -> Found {
        let key = frame
            .picture_source(self.folder)
            .and_then(|source| source.video_identity());
        let key = key.map(|identity| self.key(frame, &identity));
        let before = key
            .as_ref()
            .map(|key| self.before(frame, key, &frame.name(), false));
        match before {
            Some(Ok(Some(before))) => Found::Before(before),
            Some(Err(error)) => Found::Video(Err(error), None),
            Some(Ok(None)) | None => Found::Video(read_picture(reader, frame, self.folder), key),
        }
    }

    /// The features in the store; none if it has none.
    fn before(
        &self,
        frame: &Frame,
        key: &FeatureKey,
        picture: &str,
        changed: bool,
    ) -> Result<Option<FrameFeatures>, PictureError> {
        let start = Instant::now();
        let Some(features) = self.store.get(key) else {
            return Ok(None);
        };
        check_size(frame, picture, features.image_size)?;
        Ok(Some(FrameFeatures {
            features,
            time: start.elapsed(),
            changed,
        }))
    }

    /// Extracts the features of a picture and stores them if they have a key.
    fn look(
        &self,
        frame: &Frame,
        picture: &Picture,
        key: Option<&FeatureKey>,
        changed: bool,
    ) -> Result<FrameFeatures, PictureError> {
        let start = Instant::now();
        let features = extract(picture, &self.document.masks_of(frame), &self.options)?;
        let time = start.elapsed();
        let features = match key {
            Some(key) => self.store.put(key, features),
            None => Arc::new(features),
        };
        Ok(FrameFeatures {
            features,
            time,
            changed,
        })
    }

    fn key(&self, frame: &Frame, picture: &str) -> FeatureKey {
        FeatureKey::new(picture, &self.options, &self.document.masks_of(frame))
    }
}
