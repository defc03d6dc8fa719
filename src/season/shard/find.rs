//! A find shard: the cameras of a match, and the forest that its label shards query.
//!
//! Without a project the cameras are found without a click, as by `touchline calibrate`, and the
//! forest is trained on the frames that were found and lie on their own paint. With a project its
//! cameras are taken as they are, and the forest is the given one or trained on its references.
//!
//! The base is not refined on the paint of all frames, which `touchline calibrate` does at the end:
//! no shard sees them all, and windows must share one base.

use super::frames::runs_of;
use super::{ShardError, ShardEvent, Work};
use crate::part::{AboutPart, Part};
use crate::plan::{PlannedFile, hash_of_project, path_in_plan};
use touchline_calibration::pipelines::{
    LabelMatchError, LearnForestError, LearntForest, MatchEvent, MatchLabels, MatchOptions,
    label_match, learn_forest, learn_from_found,
};
use touchline_calibration::proposals::{
    FeatureStore, FramePictures, LearnError, LearnOptions, TrainingFrames, adopt_bases,
};
use touchline_core::files::read_named;
use touchline_documents::document::{Document, document_from_bytes};
use touchline_documents::store;
use touchline_vision::media::{FrameReader, sha256_of_bytes};
use touchline_vision::relocalize::{ForestModel, Stopped};

/// Maximum size of a forest's file, bytes.
const MAX_FOREST_BYTES: u64 = 8 << 30;

impl Work<'_> {
    pub(super) fn find_cameras(&self) -> Result<Part, ShardError> {
        match &self.of_match.project {
            None => self.find_without_click(),
            Some(project) => self.take_from_project(project),
        }
    }

    fn find_without_click(&self) -> Result<Part, ShardError> {
        let mut document = self.document_of(&self.source.frames, &self.of_match.field);
        let Some(camera) = document.cameras.first().map(|camera| camera.id.clone()) else {
            return Ok(without_camera(
                document,
                "not one image can be read".to_owned(),
            ));
        };
        let options = MatchOptions {
            sampled_frames: self.of_match.look_at,
            label_the_rest: false,
            // Each label shard sees a window of frames only; this one reads few frames of a match.
            find_shots: false,
            work: None,
            venues: Vec::new(),
        };
        let mut reader = FrameReader::new();
        let progress = self.progress.part(ShardEvent::Frames);
        let labels = label_match(
            &mut document,
            &self.source.folder,
            &camera,
            &mut reader,
            &options,
            &progress,
        );
        if progress.is_cancelled() {
            return Err(ShardError::Stopped);
        }
        // No camera is a result, too: the part states why, and the match is not searched again.
        let labelled = match labels? {
            MatchLabels::Labelled(labelled) => labelled,
            MatchLabels::NoCamera(why) => {
                let why = why.describe(&document);
                return Ok(without_camera(document, why));
            }
        };
        let store = FeatureStore::in_memory();
        let at = document.at(&self.source.folder);
        let learnt = learn_from_found(
            at,
            &labelled.cameras,
            &mut reader,
            &store,
            &progress.part(MatchEvent::Learning),
        );
        let mut part = self.with_forest(document, learnt)?;
        // The others are as they were; each label shard makes its own.
        part.document.frames.retain(|frame| frame.ptz.is_some());
        Ok(part)
    }

    fn take_from_project(&self, planned: &PlannedFile) -> Result<Part, ShardError> {
        // The project as it was planned, edits of its journal included, with its paths begun at the
        // frames' folder, so that the part's bytes do not depend on where the project lies.
        let path = path_in_plan(self.plan_path, &planned.path);
        let (location, document, _) = store::read(&path)?;
        if hash_of_project(&location, &document)? != planned.sha256 {
            return Err(ShardError::FileChanged { path });
        }
        let mut document = document.relocate(location.folder(), &self.source.folder);
        self.source.name_without_links(&mut document);
        if let Some(forest) = &self.of_match.forest {
            let forest = self.read_forest(forest, &mut document)?;
            let about = self.about(&document);
            return Ok(Part {
                about,
                document,
                forest,
            });
        }
        let training = TrainingFrames::from_solved_frames(&document).frames;
        let (options, store) = (LearnOptions::default(), FeatureStore::in_memory());
        let pictures = FramePictures::new(&document, &self.source.folder, options.features, &store);
        let progress = self.progress.part(ShardEvent::Frames);
        let learnt = learn_forest(
            &pictures,
            &mut FrameReader::new(),
            &training,
            &options,
            &progress.part(MatchEvent::Learning),
        );
        self.with_forest(document, learnt)
    }

    /// The part with the cameras of a document and its forest; without a forest, the reason.
    fn with_forest(
        &self,
        document: Document,
        learnt: Result<Option<LearntForest>, LearnForestError>,
    ) -> Result<Part, ShardError> {
        let mut about = self.about(&document);
        let forest = match learnt {
            Ok(Some(learnt)) => learnt.model.to_bytes(),
            Ok(None) => return Err(ShardError::Stopped),
            // This is a result, too: another try would end in the same way.
            Err(error) if has_nothing_to_learn_from(&error) => {
                about.reason = Some(format!("no forest could be trained: {error}"));
                Vec::new()
            }
            Err(error) => return Err(LabelMatchError::from(error).into()),
        };
        Ok(Part {
            about,
            document,
            forest,
        })
    }

    /// Which camera took which frames, by the frames of a document. Where it has none of this
    /// match, the first camera with a base took all.
    fn about(&self, document: &Document) -> AboutPart {
        let numbered = document.frames.iter().filter_map(|frame| {
            let number = self.source.number_of(frame)?;
            Some((number, frame.camera.clone()))
        });
        let mut cameras_of_frames = runs_of(numbered);
        if cameras_of_frames.is_empty() {
            let with_base = document
                .cameras
                .iter()
                .find(|camera| camera.base().is_some());
            cameras_of_frames = runs_of(with_base.map(|camera| (0, camera.id.clone())));
        }
        AboutPart {
            reason: None,
            cameras_of_frames,
        }
    }

    fn read_forest(
        &self,
        planned: &PlannedFile,
        document: &mut Document,
    ) -> Result<Vec<u8>, ShardError> {
        let path = path_in_plan(self.plan_path, &planned.path);
        let bytes = read_named(&path, MAX_FOREST_BYTES).map_err(|source| ShardError::ForestIo {
            path: path.clone(),
            source,
        })?;
        if sha256_of_bytes(&bytes) != planned.sha256 {
            return Err(ShardError::FileChanged { path });
        }
        // The forest has a copy of the cameras that it was trained with. A camera without a base
        // takes that one; another base is refused, because the rays of the forest would be wrong in
        // it.
        let what = path.display().to_string();
        let model = read_model(&bytes, &what)?;
        let of_forest = document_from_bytes(model.document.as_bytes())
            .map_err(|source| ShardError::ForestCameras { what, source })?;
        adopt_bases(document, &of_forest, &model)?;
        Ok(bytes)
    }
}

/// Whether there is no forest because no frame can be used for one: there is no reference, or none
/// of the frames found lies on its paint.
const fn has_nothing_to_learn_from(error: &LearnForestError) -> bool {
    matches!(
        error,
        LearnForestError::NoneUsable { .. }
            | LearnForestError::Learn(LearnError::Stopped(Stopped::NoSamples { .. }))
    )
}

/// A forest of a file or part.
pub(super) fn read_model(bytes: &[u8], what: &str) -> Result<ForestModel, ShardError> {
    ForestModel::from_bytes(bytes).map_err(|source| ShardError::Forest {
        what: what.to_owned(),
        source,
    })
}

/// The part of a match without a camera. Its frames keep the name of the camera that was searched.
fn without_camera(mut document: Document, reason: String) -> Part {
    let camera = document
        .cameras
        .first()
        .map(|camera| (0, camera.id.clone()));
    document.frames.retain(|_| false);
    Part {
        about: AboutPart {
            reason: Some(reason),
            cameras_of_frames: runs_of(camera),
        },
        document,
        forest: Vec::new(),
    }
}
