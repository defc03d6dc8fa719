//! Extracts the features of a document's frames, or takes them from the store.
//!
//! They are extracted at two resolutions; `batches.rs` has what is done with them.

use super::picture::check_size;
use crate::proposals::{FeatureStore, PictureError, read_picture};
use std::path::Path;
use std::sync::Arc;
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

impl<'a> FramePictures<'a> {
    /// The pictures of a document whose relative paths refer to `folder`.
    pub const fn new(
        document: &'a Document,
        folder: &'a Path,
        options: FeatureOptions,
        store: &'a FeatureStore,
    ) -> Self {
        Self {
            document,
            folder,
            options,
            store,
        }
    }
}

/// The resolution at which a frame's features are extracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// That of a quick first look ([`FeatureOptions::coarse`]).
    Coarse,
    /// That of the options.
    Fine,
}

/// The features of a frame.
#[derive(Clone, Debug)]
pub struct FrameFeatures {
    /// Their resolution.
    pub resolution: Resolution,
    /// The features outside the masks of the frame and its camera.
    pub features: Arc<Features>,
    /// Time of the extraction, without reading the picture; or of the look-up.
    pub time: Duration,
    /// Whether the image file differs from the one that the document knows.
    pub changed: bool,
}

/// Pictures of image files are kept for a second look up to this size, bytes: 4K. Larger ones are
/// read again, so that a batch of them does not fill the memory.
const KEPT_BYTES: usize = 36 << 20;

/// The state of a frame before extraction: features from the store, a picture of a video, or an
/// image file with its picture if that is read.
pub(in crate::proposals) enum ExtractionInput {
    Before(FrameFeatures),
    Video(Result<Picture, PictureError>, Option<FeatureKey>),
    Image(Option<Picture>),
}

impl FramePictures<'_> {
    /// The features of a picture, from the store if it has them.
    pub(in crate::proposals) fn features_in(
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
        let fine = Resolution::Fine;
        let key = identity.map(|identity| self.key(frame, fine, &identity));
        if let Some(features) = key.as_ref().and_then(|key| self.store.get(key)) {
            return Ok(features);
        }
        let key = key.as_ref();
        Ok(self.look(frame, fine, picture, key, false)?.features)
    }

    /// What there is of a frame: its features in the store, or its picture if it is of a video.
    /// `picture` is the picture if it was read before.
    pub(in crate::proposals) fn begin(
        &self,
        reader: &mut dyn ReadFrames,
        frame: &Frame,
        resolution: Resolution,
        picture: Option<Picture>,
    ) -> ExtractionInput {
        if frame.image.is_some() {
            return ExtractionInput::Image(picture);
        }
        // A video is identified by its file and the number of the frame, because hashing it would
        // read all of it. One that cannot be identified is decoded each time.
        let key = frame
            .picture_source(self.folder)
            .and_then(|source| source.video_identity());
        let key = key.map(|identity| self.key(frame, resolution, &identity));
        let before = key
            .as_ref()
            .map(|key| self.before(frame, resolution, key, &frame.name(), false));
        match before {
            Some(Ok(Some(before))) => ExtractionInput::Before(before),
            Some(Err(error)) => ExtractionInput::Video(Err(error), None),
            Some(Ok(None)) | None => {
                let picture = picture.map_or_else(|| read_picture(reader, frame, self.folder), Ok);
                ExtractionInput::Video(picture, key)
            }
        }
    }

    /// The features of a frame, from the state that was found, and its picture if it was read.
    pub(super) fn features_of(
        &self,
        frame: &Frame,
        resolution: Resolution,
        found: ExtractionInput,
    ) -> (Result<FrameFeatures, PictureError>, Option<Picture>) {
        match found {
            ExtractionInput::Before(features) => (Ok(features), None),
            ExtractionInput::Video(Err(error), _) => (Err(error), None),
            ExtractionInput::Video(Ok(picture), key) => {
                let features = self.look(frame, resolution, &picture, key.as_ref(), false);
                (features, Some(picture))
            }
            ExtractionInput::Image(mut picture) => {
                let features = self.features_of_image(frame, resolution, &mut picture);
                (
                    features,
                    picture.filter(|picture| picture.bytes() <= KEPT_BYTES),
                )
            }
        }
    }

    /// The features of an image file, from the store or extracted. `picture` is its picture if it
    /// is read, before or here.
    fn features_of_image(
        &self,
        frame: &Frame,
        resolution: Resolution,
        picture: &mut Option<Picture>,
    ) -> Result<FrameFeatures, PictureError> {
        // The file is hashed even if the document states a hash: features of another picture under
        // the same name would be wrong without a sign.
        let path = frame.image_path(self.folder).ok_or(PictureError::None)?;
        let sha256 = sha256_of_file(&path)?;
        // Compare with the hash that the document states, if any.
        let changed = frame
            .sha256
            .as_ref()
            .is_some_and(|stated| !stated.eq_ignore_ascii_case(&sha256));
        let key = self.key(frame, resolution, &sha256);
        let name = path.to_string_lossy();
        if let Some(before) = self.before(frame, resolution, &key, &name, changed)? {
            return Ok(before);
        }
        // Use a separate reader, so that no decoder stays open.
        let read = match picture.take() {
            Some(picture) => picture,
            None => read_picture(&mut FrameReader::new(), frame, self.folder)?,
        };
        self.look(frame, resolution, picture.insert(read), Some(&key), changed)
    }

    /// The features in the store; none if it has none.
    fn before(
        &self,
        frame: &Frame,
        resolution: Resolution,
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
            resolution,
            features,
            time: start.elapsed(),
            changed,
        }))
    }

    /// Extracts the features of a picture and stores them if they have a key.
    fn look(
        &self,
        frame: &Frame,
        resolution: Resolution,
        picture: &Picture,
        key: Option<&FeatureKey>,
        changed: bool,
    ) -> Result<FrameFeatures, PictureError> {
        let start = Instant::now();
        let features = extract(
            picture,
            &self.document.masks_of(frame),
            &self.options_at(frame, resolution),
        )?;
        let time = start.elapsed();
        // Several threads may extract the same features; the store keeps the first.
        let features = match key {
            Some(key) => self.store.put(key, features),
            None => Arc::new(features),
        };
        Ok(FrameFeatures {
            resolution,
            features,
            time,
            changed,
        })
    }

    fn key(&self, frame: &Frame, resolution: Resolution, picture: &str) -> FeatureKey {
        FeatureKey::new(
            picture,
            &self.options_at(frame, resolution),
            &self.document.masks_of(frame),
        )
    }

    fn options_at(&self, frame: &Frame, resolution: Resolution) -> FeatureOptions {
        match resolution {
            Resolution::Coarse => self.options.coarse(frame.image_size.width),
            Resolution::Fine => None,
        }
        .unwrap_or(self.options)
    }
}
