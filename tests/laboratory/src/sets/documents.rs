//! A user's own frames: documents for training and one for testing, or the clips of each document
//! tested against each other.

use super::{FrameSet, KnownFrame, KnownPicture, SetKind, Split};
use crate::ExperimentError;
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use touchline::document::{Document, FrameStatus, Solution};
use touchline::features::FeatureOptions;
use touchline::media::FrameReader;
use touchline::proposals::{FeatureStore, FramePictures};

/// A document and the folder to which its paths refer.
#[derive(Clone, Debug)]
pub struct OwnDocument {
    /// Its name in reports.
    pub name: String,
    /// The document. The cameras of its solved frames are the ground truth.
    pub document: Document,
    /// The folder to which its relative paths refer.
    pub folder: PathBuf,
}

/// A user's own documents.
#[derive(Clone, Debug)]
pub struct OwnDocuments {
    /// Documents with training frames: all that are solved.
    pub train: Vec<OwnDocument>,
    /// The document with the test frames. If none, each clip of a training document is tested
    /// against the other clips of its camera.
    pub test: Option<OwnDocument>,
}

impl OwnDocuments {
    /// Number of frames of all documents.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.train
            .iter()
            .chain(&self.test)
            .map(|own| own.document.frames.len())
            .sum()
    }
}

/// Reads the frames of all documents and splits them by camera.
///
/// # Errors
/// A field is not valid, a picture cannot be read, or no frame can be tested against another.
pub fn read_own_documents(
    own: &OwnDocuments,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    match &own.test {
        Some(test) => split_by_document(&own.train, test, progress),
        None => split_by_clip(&own.train, progress),
    }
}

/// The solved frames of documents, with the camera and the clip of each.
#[derive(Default)]
pub(super) struct Gathered {
    pub frames: Vec<KnownFrame>,
    cameras: Vec<String>,
    clips: Vec<String>,
}

impl Gathered {
    /// Adds the solved frames of a document with their features. Returns their range of indices.
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
        // A rejected frame is no truth: a person took it out of use.
        let solved: Vec<usize> = (0..document.frames.len())
            .filter(|&index| {
                let frame = &document.frames[index];
                frame.status != FrameStatus::Rejected && document.ptz_camera(frame).is_some()
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
                // A frame without a picture cannot be tested.
                (document.ptz_camera(frame), frame.picture_source(folder))
            else {
                continue;
            };
            // One picture that cannot be read ends the experiment: a set without it would be
            // another set.
            let features = features.map_err(|source| ExperimentError::Picture {
                frame: frame.name(),
                source,
            })?;
            let warnings = frame.solution.iter().flat_map(Solution::warnings_of_frame);
            let warnings: Vec<&str> = warnings.map(|warning| warning.code.as_str()).collect();
            self.frames.push(KnownFrame {
                // The file's name without its folder, which identifies nothing.
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
                // As the program itself: masks of the document are left out of training and tests.
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

    /// The distinct cameras of some frames, in order of appearance.
    pub fn cameras(&self, range: Range<usize>) -> Vec<&str> {
        each_once(range.map(|index| self.cameras[index].as_str()))
    }

    /// The distinct clips of a camera's frames, in order of appearance.
    pub fn clips(&self, range: Range<usize>, camera: &str) -> Vec<&str> {
        let of_camera = range.filter(|&index| self.cameras[index] == camera);
        each_once(of_camera.map(|index| self.clips[index].as_str()))
    }

    /// The frames of a camera in the clips for which `clip` is true.
    pub fn frames_of_camera(
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

/// Removes repeated names, and keeps the order.
pub(super) fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// Tests the frames of one document against those of the others.
fn split_by_document(
    train: &[OwnDocument],
    test: &OwnDocument,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let mut gathered = Gathered::default();
    for own in train {
        gathered.add(own, progress)?;
    }
    // The indices below are of the training documents, those from here on of the test document.
    let taught = gathered.frames.len();
    let tested = gathered.add(test, progress)?;
    let splits = gathered
        .cameras(tested.clone())
        .into_iter()
        .map(|camera| Split {
            name: format!("camera {camera}"),
            training_frames: gathered.frames_of_camera(0..taught, camera, |_| true),
            test_frames: gathered.frames_of_camera(tested.clone(), camera, |_| true),
        });
    let splits: Vec<Split> = splits
        // A camera without frames on one side cannot be tested.
        .filter(|split| !split.training_frames.is_empty() && !split.test_frames.is_empty())
        .collect();
    if splits.is_empty() {
        return Err(ExperimentError::NothingInCommon);
    }
    // Of the cameras on both sides: the frames of others are neither trained on nor tested.
    let training: usize = splits.iter().map(|split| split.training_frames.len()).sum();
    let testing: usize = splits.iter().map(|split| split.test_frames.len()).sum();
    Ok(FrameSet {
        kind: SetKind::Own,
        seed: 0,
        title: format!("own frames, {training} for training and {testing} for testing"),
        protocol:
            "The frames of one document are tested against those of the other, camera by camera."
                .to_owned(),
        splits,
        frames: gathered.frames,
    })
}

/// Tests each clip against the other clips of its camera.
fn split_by_clip(
    documents: &[OwnDocument],
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let mut gathered = Gathered::default();
    let mut splits = Vec::new();
    for own in documents {
        let range = gathered.add(own, progress)?;
        let cameras = gathered.cameras(range.clone());
        // A camera with a single clip has nothing to be tested against.
        for camera in &cameras {
            let clips = gathered.clips(range.clone(), camera);
            if clips.len() < 2 {
                continue;
            }
            for clip in clips {
                // Several documents are reported by their names, all clips of one together.
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
                        .frames_of_camera(range.clone(), camera, |other| other != clip),
                    test_frames: gathered
                        .frames_of_camera(range.clone(), camera, |other| other == clip),
                });
            }
        }
    }
    if splits.is_empty() {
        return Err(ExperimentError::OneClip);
    }
    let tested: usize = splits.iter().map(|split| split.test_frames.len()).sum();
    let documents = if documents.len() > 1 {
        format!("of {} documents, ", documents.len())
    } else {
        String::new()
    };
    Ok(FrameSet {
        kind: SetKind::Own,
        seed: 0,
        title: format!("own frames, {documents}{tested} in {} clips", splits.len()),
        protocol:
            "Each clip is tested against the other clips of its camera; the truth is the camera that the document holds for \
                   the frame, with the errors of the clicks that it was fitted to."
                .to_owned(),
        frames: gathered.frames,
        splits,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline::camera::Ptz;
    use touchline::document::{Camera, FieldSpec, Frame, FramePtz};
    use touchline::geometry::ImageSize;

    /// A document with a solved frame of each of these cameras.
    fn own(folder: &Path, cameras: [&str; 2]) -> OwnDocument {
        let size = ImageSize::new(64, 36);
        let mut document = Document::new(FieldSpec::new("soccer"));
        for name in cameras {
            let mut camera = Camera::new(name.into(), size);
            camera.set_base(&crate::setting::base());
            document.cameras.push(camera.into());
            let picture = format!("{name}.png");
            image::RgbImage::new(size.width, size.height)
                .save(folder.join(&picture))
                .unwrap();
            let mut frame = Frame::from_image(&picture, name.into(), size);
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(50.0, -9.0, 150.0), None));
            frame.status = FrameStatus::Reference;
            document.frames.push(frame.into());
        }
        OwnDocument {
            name: String::new(),
            document,
            folder: folder.to_path_buf(),
        }
    }

    #[test]
    fn frames_of_a_camera_on_one_side_alone_are_not_counted() {
        let folder = tempfile::tempdir().unwrap();
        let documents = OwnDocuments {
            train: vec![own(folder.path(), ["main", "behind"])],
            test: Some(own(folder.path(), ["main", "beside"])),
        };
        let set = read_own_documents(&documents, &|| {}).unwrap();
        assert_eq!(set.title, "own frames, 1 for training and 1 for testing");
    }
}
