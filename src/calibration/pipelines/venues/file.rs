//! The file of a venue.
//!
//! It is a forest's file: that has the cameras and the field of the document it was trained on, the
//! views and the features that recognise them, a version and a checksum. A forest that `touchline
//! train` wrote can be a venue, too; the one that is made here is smaller, and learns from frames
//! that no person has looked at if they are certain.

use super::size::{factor_between, scale_base, scale_seen};
use crate::pipelines::forest_labels::{
    LearnForestError, LearningProgress, is_certain, learn_from_frames,
};
use crate::proposals::{FeatureStore, LearnOptions};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_core::files::read_named;
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Camera, CameraId, Document, DocumentAt, FieldSpec, ReadError, document_from_bytes,
};
use touchline_vision::features::FeatureOptions;
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{CameraForest, ForestFileError, ForestModel, TrainOptions};

/// The ending of the names of venue files.
pub const VENUE_ENDING: &str = "venue";

/// Maximum size of a file that is read, bytes; `touchline train` makes forests larger than venues.
const MAX_BYTES: u64 = 1 << 30;

/// Number of frames and of their features that a venue keeps of a camera, in one tree: at most
/// about 5 MB.
const MAX_FRAMES: usize = 24;
const MAX_FEATURES: u32 = 600;
/// A camera with fewer certain frames is left out: its base rests on too little.
const MIN_FRAMES: usize = 4;

/// A venue: cameras with their bases, their field, and what recognises their pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Venue {
    /// Its name: that of the file, without the ending.
    pub name: String,
    model: ForestModel,
    /// The field and the cameras that the forest holds as text.
    document: Document,
}

/// A camera of a venue.
#[derive(Clone, Copy, Debug)]
pub(in crate::pipelines) struct VenueCamera<'a> {
    pub venue: &'a Venue,
    pub camera: &'a Camera,
    pub forest: &'a CameraForest,
}

impl Venue {
    /// Reads a venue's file.
    ///
    /// # Errors
    /// It cannot be read, is no venue, is damaged, or has no camera with a base.
    pub fn read(path: &Path) -> Result<Self, VenueError> {
        let bytes = read_named(path, MAX_BYTES).map_err(|source| VenueError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        Self::from_bytes(path, &bytes)
    }

    /// A venue from the bytes of the file at `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, VenueError> {
        let path = path.to_path_buf();
        // The checksum is that of the whole file: what is read from here on is as it was written.
        let model = match ForestModel::from_bytes(bytes) {
            Ok(model) => model,
            Err(source) => return Err(VenueError::Forest { path, source }),
        };
        let document = match document_from_bytes(model.document.as_bytes()) {
            Ok(document) => document,
            Err(source) => return Err(VenueError::Cameras { path, source }),
        };
        // The name is what messages say: a person chose it for the file.
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let venue = Self {
            name: name.into_owned(),
            model,
            document,
        };
        if venue.cameras().next().is_none() {
            return Err(VenueError::NoBase { path });
        }
        Ok(venue)
    }

    /// Its field and cameras, as a document without frames.
    pub const fn document(&self) -> &Document {
        &self.document
    }

    /// The cameras that have a base and features.
    pub(in crate::pipelines) fn cameras(&self) -> impl Iterator<Item = VenueCamera<'_>> {
        self.model.cameras.iter().filter_map(|forest| {
            let camera = self.document.camera(&forest.camera.as_str().into())?;
            camera.base()?;
            Some(VenueCamera {
                venue: self,
                camera,
                forest,
            })
        })
    }
}

impl VenueCamera<'_> {
    /// The field that it looks at.
    pub fn field(&self) -> &FieldSpec {
        self.venue.document.field_of_camera(&self.camera.id)
    }

    /// Its base in pictures of a size; none if they have other proportions than its own.
    pub fn base_in(&self, size: ImageSize) -> Option<CameraBase> {
        let factor = factor_between(self.camera.image_size, size)?;
        Some(scale_base(&self.camera.base()?, factor))
    }

    /// The forest of this camera alone, as that of a camera with another name in pictures of a
    /// size; none if they have other proportions.
    pub fn model_for(&self, name: &CameraId, size: ImageSize) -> Option<ForestModel> {
        // Features do not depend on the size of the picture; the rays that they vote for do.
        let factor = factor_between(self.camera.image_size, size)?;
        Some(ForestModel {
            document: String::new(),
            features: self.venue.model.features,
            cameras: vec![CameraForest {
                camera: name.as_str().to_owned(),
                seen: scale_seen(&self.forest.seen, factor),
                forest: self.forest.forest.clone(),
            }],
        })
    }
}

/// A venue that was made of a document.
#[derive(Debug)]
pub struct NewVenue {
    /// What its file holds.
    pub model: ForestModel,
    /// The cameras that are in it.
    pub cameras: Vec<CameraId>,
    /// The cameras that are not, for want of a base or of certain frames.
    pub left_out: Vec<CameraId>,
}

/// Makes a venue of a document's cameras that have a base and certain frames: references, and
/// frames whose confidence is as high. None if `progress` cancelled it.
///
/// # Errors
/// No camera has a base and enough certain frames, or these give no features.
pub fn make_venue(
    at: DocumentAt<'_>,
    reader: &mut dyn ReadFrames,
    store: &FeatureStore,
    progress: &Progress<'_, LearningProgress>,
) -> Result<Option<NewVenue>, VenueError> {
    let mut document = at.document.clone();
    // What belongs to one match does not belong to the venue.
    document.shots.clear();
    let (mut cameras, mut left_out, mut learnt) = (Vec::new(), Vec::new(), Vec::new());
    for camera in at.document.used_cameras() {
        let certain = certain_frames(at.document, &camera);
        let has_base = at.document.camera(&camera).and_then(Camera::base).is_some();
        // Spread over the camera's frames, so that all that it showed can be recognised.
        if has_base && certain.len() >= MIN_FRAMES {
            learnt.extend(subsample(certain, MAX_FRAMES));
            cameras.push(camera);
        } else {
            left_out.push(camera);
        }
    }
    if cameras.is_empty() {
        return Err(VenueError::NothingCertain);
    }
    // The forest's document has the kept cameras alone: what is read from it has a base.
    document
        .cameras
        .retain(|camera| cameras.contains(&camera.id));
    learnt.sort_unstable();
    // One tree: it is asked for a direction to begin with, not for a camera.
    let options = LearnOptions {
        features: FeatureOptions {
            max_count: MAX_FEATURES,
            ..FeatureOptions::default()
        },
        train: TrainOptions {
            trees: 1,
            ..TrainOptions::default()
        },
    };
    let at = document.at(at.folder);
    let forest = learn_from_frames(at, &learnt, reader, store, &options, progress)?;
    Ok(forest.map(|forest| NewVenue {
        model: forest.model,
        cameras,
        left_out,
    }))
}

/// The frames of a camera whose pose is certain.
fn certain_frames(document: &Document, camera: &CameraId) -> Vec<usize> {
    let of_camera = document.frames.iter().enumerate();
    of_camera
        .filter(|(_, frame)| frame.camera == *camera && is_certain(frame))
        .map(|(index, _)| index)
        .collect()
}

/// Why a venue cannot be made or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VenueError {
    /// Its file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file is no forest, of another version, or damaged.
    #[error(
        "{}: no venue can be read from it ({source}); `touchline venue` writes one",
        path.display()
    )]
    Forest {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ForestFileError,
    },
    /// Its cameras cannot be read.
    #[error(
        "{}: its cameras cannot be read: {source}; `touchline venue` writes it again",
        path.display()
    )]
    Cameras {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        source: ReadError,
    },
    /// None of its cameras has a base.
    #[error("{}: none of its cameras has a base; make it of a calibrated project", path.display())]
    NoBase {
        /// The file.
        path: PathBuf,
    },
    /// No camera is certain enough to be kept.
    #[error(
        "no camera has a base and {MIN_FRAMES} frames that are accepted or certain; calibrate the \
         project first, or accept frames in it"
    )]
    NothingCertain,
    /// Nothing can be learnt from the certain frames.
    #[error(transparent)]
    Learn(#[from] LearnForestError),
}
