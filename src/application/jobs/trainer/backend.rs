//! The operations of the trainer on forests and frames, as a trait so that tests can replace them.

use super::super::shared_pictures::{SharedPictures, SharedReader};
use super::mailbox::TrainerMailbox;
use crate::app::operation::WorkError;
use crate::app::{TrainerActivity, UnusableReference};
use serde_json::Value;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_calibration::calibrate::{
    ClipEvidence, ClipProgress, TrackClipError, TrackClipOptions, track_clip,
};
use touchline_calibration::pipelines::{
    ForestRequest, LearningProgress, LearntForest, learn_forest, propose_on_lines,
};
use touchline_calibration::proposals::{
    FeatureStore, FramePictures, KeyWindow, LearnOptions, LineEvidence, Proposal, Quality, Suspect,
    TrackedProposal, TrainingSet, UsedFeatures, WorkFolder, find_suspects, measure,
};
use touchline_core::files::read_regular;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{Document, Fields, document_from_bytes, document_to_string};
use touchline_documents::store::write_atomically;
use touchline_vision::features::FeatureOptions;
use touchline_vision::media::FrameReader;
use touchline_vision::relocalize::{ForestModel, RelocalizeOptions, TrainProgress};

/// The operations of the trainer. Long ones end early when their progress answers `Break`.
pub(super) trait Backend {
    /// The stored forest of an earlier run, if it was trained on exactly this training set.
    ///
    /// # Errors
    /// The file exists, but cannot be used.
    fn recall(&mut self, training_set: &TrainingSet) -> Result<Option<ForestModel>, String>;

    /// Trains a forest on some frames of the document. `None` if `progress` ended it.
    ///
    /// # Errors
    /// No forest can be trained.
    fn learn(
        &mut self,
        document: &Document,
        training_frames: &[usize],
        training_set: &TrainingSet,
        progress: &Progress<'_, TrainerActivity>,
    ) -> Result<Option<TrainedModel>, String>;

    /// Proposes cameras for some frames, with `snapping` aligned to the painted lines. Returns
    /// fewer proposals than `frames` if `progress`, which receives the number of finished frames,
    /// ended the work early.
    fn propose(
        &mut self,
        document: &Document,
        frames: &[usize],
        forest: (&ForestModel, u64),
        snapping: bool,
        progress: &Progress<'_, usize>,
    ) -> Vec<Proposal>;

    /// Propagates cameras through a window of a video, from its key frames. `None` if `progress`,
    /// which receives the number of finished pictures, ended it.
    fn carry(
        &mut self,
        document: &Document,
        window: &KeyWindow,
        generation: u64,
        progress: &Progress<'_, usize>,
    ) -> Option<Vec<TrackedProposal>>;

    /// Measures the accuracy of a forest that is trained on these frames, and finds those that
    /// contradict others. `None` if `progress` ended it.
    fn measure(
        &mut self,
        document: &Document,
        training_frames: &[usize],
        progress: &Progress<'_, TrainerActivity>,
    ) -> Option<ForestAccuracy>;

    /// How a forest uses the features of a frame. `None` if the frame cannot be read.
    fn features(
        &mut self,
        document: &Document,
        frame: usize,
        model: &ForestModel,
    ) -> Option<UsedFeatures>;

    /// Why features or forest are not stored on disk, if they are not.
    fn not_kept(&self) -> Option<String>;

    /// The folder of the document, from which its paths start.
    fn folder(&self) -> &Path;
}

/// A newly trained forest.
pub(super) struct TrainedModel {
    pub(super) model: ForestModel,
    /// Number of features it was trained on.
    pub(super) features: usize,
    /// Training frames that could not be used.
    pub(super) failed: Vec<UnusableReference>,
}

/// The accuracy of a forest, and suspicious references.
pub(super) struct ForestAccuracy {
    /// The accuracy. `None` if no reference can be left out.
    pub(super) quality: Option<Quality>,
    /// References that contradict others.
    pub(super) suspects: Vec<Suspect>,
}

/// The backend of the program: stores features and forest beside the document.
pub(super) struct ForestBackend {
    folder: PathBuf,
    place: WorkFolder,
    store: FeatureStore,
    reader: SharedReader,
    options: LearnOptions,
    relocalizing: RelocalizeOptions,
    /// Why the forest could not be stored, if it could not.
    forest_refused: Option<String>,
}

impl ForestBackend {
    /// The backend of the document at `file`. Frames among `pictures` are not decoded again.
    pub(super) fn new(file: &Path, mailbox: Arc<TrainerMailbox>, pictures: SharedPictures) -> Self {
        let place = WorkFolder::beside(file);
        // Counting the frames of a long video ends when the document is closed.
        let counting = Progress::new(move |_| {
            mailbox
                .peek(|_| ())
                .map_or(ControlFlow::Break(()), ControlFlow::Continue)
        });
        Self {
            folder: file.parent().map(Path::to_path_buf).unwrap_or_default(),
            store: FeatureStore::on_disk(&place),
            place,
            reader: SharedReader::new(Box::new(FrameReader::with_progress(counting)), pictures),
            options: LearnOptions::default(),
            relocalizing: RelocalizeOptions::default(),
            forest_refused: None,
        }
    }
}

impl Backend for ForestBackend {
    fn recall(&mut self, training_set: &TrainingSet) -> Result<Option<ForestModel>, String> {
        load_forest(&self.place, training_set, &self.options.features)
            .map_err(|error| format!("The stored forest is trained again: {error}"))
    }

    fn learn(
        &mut self,
        document: &Document,
        training_frames: &[usize],
        training_set: &TrainingSet,
        progress: &Progress<'_, TrainerActivity>,
    ) -> Result<Option<TrainedModel>, String> {
        let pictures =
            FramePictures::new(document, &self.folder, self.options.features, &self.store);
        let learning = progress.part(doing_of);
        let learnt = learn_forest(
            &pictures,
            &mut self.reader,
            training_frames,
            &self.options,
            &learning,
        )
        .map_err(|error| error.to_string())?;
        let Some(LearntForest { mut model, studied }) = learnt else {
            return Ok(None);
        };
        // A forest that cannot be stored still answers; the window shows why it was not stored.
        self.forest_refused = keep_forest(&self.place, &mut model, training_set)
            .err()
            .map(|error| error.to_string());
        let features = studied
            .training_samples
            .iter()
            .map(|sample| sample.fine.rays.len())
            .sum();
        let failed = studied
            .failed
            .into_iter()
            .map(|(index, error)| UnusableReference {
                frame: document.frames[index].id.clone(),
                error,
            });
        Ok(Some(TrainedModel {
            model,
            features,
            failed: failed.collect(),
        }))
    }

    fn propose(
        &mut self,
        document: &Document,
        frames: &[usize],
        (model, generation): (&ForestModel, u64),
        snapping: bool,
        progress: &Progress<'_, usize>,
    ) -> Vec<Proposal> {
        let pictures = FramePictures::new(document, &self.folder, model.features, &self.store);
        let forest = ForestRequest {
            model,
            generation,
            options: self.relocalizing.clone(),
        };
        // An invalid field is reported when the document is opened; without it lines are no
        // evidence.
        let evidence =
            LineEvidence::from_document(document.at(&self.folder), &mut self.reader, snapping).ok();
        let mut made = Vec::with_capacity(frames.len());
        // In small batches, so that a pause takes effect soon.
        // A batch gives each thread one frame.
        for few in frames.chunks(rayon::current_num_threads()) {
            if progress.report(made.len()).is_break() {
                break;
            }
            let evidence = evidence.as_ref();
            let mut proposals = propose_on_lines(
                &pictures,
                &mut self.reader,
                few,
                &forest,
                evidence,
                &Progress::default(),
            );
            made.append(&mut proposals);
        }
        made
    }

    fn carry(
        &mut self,
        document: &Document,
        window: &KeyWindow,
        generation: u64,
        progress: &Progress<'_, usize>,
    ) -> Option<Vec<TrackedProposal>> {
        let at = document.at(&self.folder);
        let first = window
            .keys
            .first()
            .and_then(|place| document.frames.get(*place));
        // An invalid field is reported when the document is opened.
        let Some((first, fields)) = first.zip(Fields::from_document(at).ok()) else {
            return Some(Vec::new());
        };
        let pictures = window.clip.frames.len();
        // Progress counts following the points as the first half and reading the paint as the
        // second.
        let of_clip = progress.part(|step| match step {
            ClipProgress::Following(done, _) => done / 2,
            ClipProgress::Painting(done, of) => pictures / 2 + pictures * done / (2 * of.max(1)),
            ClipProgress::Adjusting => pictures / 2,
        });
        let (field, options) = (
            fields.for_frame(document, first),
            TrackClipOptions::default(),
        );
        let mut evidence = ClipEvidence::default();
        match track_clip(
            at,
            &window.clip,
            field,
            &mut self.reader,
            &options,
            &mut evidence,
            &of_clip,
        ) {
            Ok(clip) => {
                let tracked = clip.frames.iter();
                Some(
                    tracked
                        .filter_map(|tracked| {
                            TrackedProposal::from_tracked_frame(
                                document, &clip, tracked, generation,
                            )
                        })
                        .collect(),
                )
            }
            Err(TrackClipError::Stopped) => None,
            // The window gives no camera; the forest is queried for these frames instead.
            Err(_) => Some(Vec::new()),
        }
    }

    fn measure(
        &mut self,
        document: &Document,
        training_frames: &[usize],
        progress: &Progress<'_, TrainerActivity>,
    ) -> Option<ForestAccuracy> {
        let pictures =
            FramePictures::new(document, &self.folder, self.options.features, &self.store);
        let measuring = progress.part(TrainerActivity::Measuring);
        let looking = progress.part(|()| TrainerActivity::Measuring(Share::default()));
        let suspects = find_suspects(&pictures, &mut self.reader, training_frames, &looking)?;
        let (options, relocalizing) = (&self.options, &self.relocalizing);
        let quality = measure(
            &pictures,
            &mut self.reader,
            training_frames,
            options,
            relocalizing,
            &measuring,
        );
        progress
            .check()
            .is_continue()
            .then_some(ForestAccuracy { quality, suspects })
    }

    fn features(
        &mut self,
        document: &Document,
        frame: usize,
        model: &ForestModel,
    ) -> Option<UsedFeatures> {
        let pictures = FramePictures::new(document, &self.folder, model.features, &self.store);
        let used = pictures.each(&mut self.reader, &[frame], |index, _, found| {
            let used = found.ok().map(|found| {
                UsedFeatures::from_query(document, index, &found, model, &self.relocalizing)
            });
            ControlFlow::Continue(used)
        });
        used?.pop()?
    }

    fn not_kept(&self) -> Option<String> {
        self.store.refusal().or_else(|| self.forest_refused.clone())
    }

    fn folder(&self) -> &Path {
        &self.folder
    }
}

/// Translates the progress of training for the window.
fn doing_of(progress: LearningProgress) -> TrainerActivity {
    match progress {
        LearningProgress::Features { done, of } => TrainerActivity::Features(Share { done, of }),
        LearningProgress::Training(TrainProgress { placed, total }) => {
            TrainerActivity::Training(Share::new(placed, total))
        }
    }
}

/// Key of the fingerprint of the training set, in the forest's own document.
const TAUGHT: &str = "taught";

/// Writes a forest beside its document, with the fingerprint of its training set.
///
/// # Errors
/// The folder cannot be created or written to. That is harmless: the forest can be trained again.
pub(super) fn keep_forest(
    place: &WorkFolder,
    model: &mut ForestModel,
    training_set: &TrainingSet,
) -> io::Result<()> {
    // The fingerprint is part of the document inside the forest's file, so that one atomic write
    // stores both. With a file of its own it could describe another forest.
    let mut document = document_from_bytes(model.document.as_bytes()).map_err(io::Error::other)?;
    document
        .extra
        .insert(TAUGHT.to_owned(), Value::String(training_set.fingerprint()));
    model.document = document_to_string(&document).map_err(io::Error::other)?;
    place.refuse_links()?;
    std::fs::create_dir_all(place.path())?;
    write_atomically(&place.forest(), &model.to_bytes())
}

/// The stored forest, if it was trained on exactly this training set and with these feature
/// options.
///
/// # Errors
/// The file exists, but is damaged or cannot be read.
pub(super) fn load_forest(
    place: &WorkFolder,
    training_set: &TrainingSet,
    features: &FeatureOptions,
) -> Result<Option<ForestModel>, WorkError> {
    let bytes = match read_regular(&place.forest()) {
        Ok(bytes) => bytes,
        // Nothing was stored yet, which is no failure.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("the forest cannot be read: {error}").into()),
    };
    let model = ForestModel::from_bytes(&bytes)?;
    let document = document_from_bytes(model.document.as_bytes())
        .map_err(|error| format!("the forest's document: {error}"))?;
    // A forest of other references or other features is none for this document. It is no error: the
    // trainer trains a new one and overwrites it.
    let taught = document.extra.get(TAUGHT).and_then(Value::as_str);
    let fits = taught == Some(&training_set.fingerprint()) && model.features == *features;
    Ok(fits.then_some(model))
}
