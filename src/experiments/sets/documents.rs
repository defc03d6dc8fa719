//! A user's own frames: documents for training and one for testing, or documents whose clips are
//! tested against each other.

use super::{FrameSet, KnownFrame, KnownPicture, SetKind, Split};
use crate::ExperimentError;
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use touchline_calibration::proposals::{FeatureStore, FramePictures};
use touchline_documents::document::{Document, FrameStatus, Solution};
use touchline_vision::features::FeatureOptions;
use touchline_vision::media::FrameReader;

/// A document with the folder that its paths start from.
#[derive(Clone, Debug)]
pub struct OwnDocument {
    /// What people call it.
    pub name: String,
    /// The document; what its solved frames hold is the truth.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
}

/// A user's own documents.
#[derive(Clone, Debug)]
pub struct OwnDocuments {
    /// Their solved frames are used for training.
    pub train: Vec<OwnDocument>,
    /// Its solved frames are asked; none: the clips of each document are asked of its other clips.
    pub test: Option<OwnDocument>,
}

impl OwnDocuments {
    /// How many frames they hold.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.train
            .iter()
            .chain(&self.test)
            .map(|own| own.document.frames.len())
            .sum()
    }
}

/// The frames of all documents, split by camera.
///
/// # Errors
/// A field is not valid, a picture cannot be read, or no frame could be asked of another.
pub fn of_own(
    own: &OwnDocuments,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    match &own.test {
        Some(test) => of_two(&own.train, test, progress),
        None => of_clips(&own.train, progress),
    }
}

/// The solved frames of a document, and of each its camera and its clip.
#[derive(Default)]
pub(super) struct Gathered {
    pub frames: Vec<KnownFrame>,
    cameras: Vec<String>,
    clips: Vec<String>,
}

impl Gathered {
    /// Adds the solved frames of a document with their features; where they stand.
    pub fn add(
        &mut self,
        own: &OwnDocument,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Range<usize>, ExperimentError> {
        let OwnDocument {
            document, folder, ..
        } = own;
        let store = FeatureStore::in_memory();
        let pictures = FramePictures {
            document,
            folder,
            options: FeatureOptions::default(),
            store: &store,
        };
        let solved: Vec<usize> = (0..document.frames.len())
            .filter(|&index| {
                let frame = &document.frames[index];
                frame.status != FrameStatus::Rejected && document.pointed(frame).is_some()
            })
            .collect();
        let found = pictures.each(&mut FrameReader::new(), &solved, |index, _, features| {
            progress();
            ControlFlow::Continue((index, features))
        });
        let begin = self.frames.len();
        for (index, features) in found.unwrap_or_default() {
            let frame = &*document.frames[index];
            let (Some(truth), Some(source)) =
                (document.pointed(frame), frame.picture_source(folder))
            else {
                continue;
            };
            let features = features.map_err(|source| ExperimentError::Picture {
                frame: frame.name(),
                source,
            })?;
            let warnings = frame.solution.iter().flat_map(Solution::warnings_of_frame);
            let warnings: Vec<&str> = warnings.map(|warning| warning.code.as_str()).collect();
            self.frames.push(KnownFrame {
                // Where the file lies says nothing of the frame.
                name: frame
                    .name()
                    .rsplit('/')
                    .next()
                    .unwrap_or_default()
                    .to_owned(),
                warnings: warnings.join(", "),
                truth,
                features: (*features.features).clone(),
                field: document.field_of(frame).model(folder)?,
                picture: KnownPicture::File(source),
                masks: document.masks_of(frame),
                is_masked: true,
            });
            self.cameras.push(frame.camera.as_str().to_owned());
            self.clips.push(
                frame
                    .clip
                    .as_ref()
                    .map(ToString::to_string)
                    .unwrap_or_default(),
            );
        }
        Ok(begin..self.frames.len())
    }

    /// The cameras of some frames, each once, in their order.
    pub fn cameras(&self, range: Range<usize>) -> Vec<&str> {
        each_once(range.map(|index| self.cameras[index].as_str()))
    }

    /// The clips of a camera's frames, each once, in their order.
    pub fn clips(&self, range: Range<usize>, camera: &str) -> Vec<&str> {
        let of_camera = range.filter(|&index| self.cameras[index] == camera);
        each_once(of_camera.map(|index| self.clips[index].as_str()))
    }

    /// The frames of a camera, of these clips or not of them.
    pub fn of_camera(
        &self,
        range: Range<usize>,
        camera: &str,
        clip: impl Fn(&str) -> bool,
    ) -> Vec<usize> {
        range
            .filter(|&index| self.cameras[index] == camera && clip(&self.clips[index]))
            .collect()
    }
}

fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// One document is asked of others.
fn of_two(
    train: &[OwnDocument],
    test: &OwnDocument,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let mut gathered = Gathered::default();
    for own in train {
        gathered.add(own, progress)?;
    }
    let taught = gathered.frames.len();
    let asked = gathered.add(test, progress)?;
    let splits = gathered
        .cameras(asked.clone())
        .into_iter()
        .map(|camera| Split {
            name: format!("camera {camera}"),
            training_frames: gathered.of_camera(0..taught, camera, |_| true),
            asked: gathered.of_camera(asked.clone(), camera, |_| true),
        });
    let splits: Vec<Split> = splits
        .filter(|split| !split.training_frames.is_empty() && !split.asked.is_empty())
        .collect();
    if splits.is_empty() {
        return Err(ExperimentError::NothingInCommon);
    }
    Ok(FrameSet {
        kind: SetKind::Own,
        seed: 0,
        title: format!(
            "own frames, {taught} for training and {} for testing",
            asked.len()
        ),
        protocol:
            "The frames of one document are tested against those of the other, camera by camera."
                .to_owned(),
        splits,
        frames: gathered.frames,
    })
}

/// Each clip is asked of the others of its camera.
fn of_clips(
    documents: &[OwnDocument],
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let mut gathered = Gathered::default();
    let mut splits = Vec::new();
    for own in documents {
        let range = gathered.add(own, progress)?;
        let cameras = gathered.cameras(range.clone());
        for camera in &cameras {
            let clips = gathered.clips(range.clone(), camera);
            if clips.len() < 2 {
                continue;
            }
            for clip in clips {
                let mut name = if documents.len() > 1 {
                    own.name.clone()
                } else {
                    format!("clip {clip}")
                };
                if cameras.len() > 1 {
                    name = format!("{name}, camera {camera}");
                }
                splits.push(Split {
                    name,
                    training_frames: gathered
                        .of_camera(range.clone(), camera, |other| other != clip),
                    asked: gathered.of_camera(range.clone(), camera, |other| other == clip),
                });
            }
        }
    }
    if splits.is_empty() {
        return Err(ExperimentError::OneClip);
    }
    let asked: usize = splits.iter().map(|split| split.asked.len()).sum();
    let documents = if documents.len() > 1 {
        format!("of {} documents, ", documents.len())
    } else {
        String::new()
    };
    Ok(FrameSet {
        kind: SetKind::Own,
        seed: 0,
        title: format!("own frames, {documents}{asked} in {} clips", splits.len()),
        protocol:
            "Each clip is tested against the other clips of its camera; the truth is the camera that the document holds for \
                   the frame, with the errors of the clicks that it was fitted to."
                .to_owned(),
        frames: gathered.frames,
        splits,
    })
}
