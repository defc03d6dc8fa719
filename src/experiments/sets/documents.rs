//! A user's own frames: a document that teaches, and one that is asked.

use super::{FrameSet, KnownFrame, Split};
use crate::experiments::ExperimentError;
use crate::features::FeatureOptions;
use crate::media::FrameReader;
use crate::project::{Document, FrameStatus};
use crate::proposals::{FeatureStore, FramePictures};
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Two documents with the folders that their paths start from.
#[derive(Clone, Debug)]
pub struct OwnDocuments {
    /// Its solved frames teach.
    pub train: (Document, PathBuf),
    /// Its solved frames are asked; what they hold is the truth.
    pub test: (Document, PathBuf),
}

/// The frames of both, split by camera: frames of a camera are asked of those of the camera of the same name.
///
/// # Errors
/// A field is not valid, or a picture cannot be read.
pub fn of_documents(own: &OwnDocuments, progress: &(dyn Fn() + Sync)) -> Result<FrameSet, ExperimentError> {
    let (mut frames, mut cameras) = (Vec::new(), Vec::new());
    let mut taught = 0;
    for (document, folder) in [&own.train, &own.test] {
        let store = FeatureStore::in_memory();
        let pictures = FramePictures { document, folder, options: FeatureOptions::default(), store: &store };
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
        for (index, features) in found.unwrap_or_default() {
            let frame = &*document.frames[index];
            let Some(truth) = document.pointed(frame) else { continue };
            let features = features.map_err(|source| ExperimentError::Picture { frame: frame.name(), source })?;
            let field = document.field_of(frame).model(folder)?;
            let features = (*features.features).clone();
            frames.push(KnownFrame { truth, features, field, jpeg: None, masks: Vec::new() });
            cameras.push(frame.camera.as_str().to_owned());
        }
        if taught == 0 {
            taught = frames.len();
        }
    }
    let mut names = cameras.clone();
    names.sort();
    names.dedup();
    let of_camera = |name: &String, range: std::ops::Range<usize>| range.filter(|&i| cameras[i] == *name).collect();
    let splits: Vec<Split> = names
        .iter()
        .map(|name| Split {
            name: format!("camera {name}"),
            teachers: of_camera(name, 0..taught),
            asked: of_camera(name, taught..frames.len()),
        })
        .filter(|split: &Split| !split.teachers.is_empty() && !split.asked.is_empty())
        .collect();
    if splits.is_empty() {
        return Err(ExperimentError::NothingInCommon);
    }
    let title = format!("own frames, {taught} that teach and {} that are asked", frames.len() - taught);
    let teaching = "The frames of one document are asked of those of the other, camera by camera.";
    Ok(FrameSet { title, teaching, frames, splits })
}
