//! A label shard: the frames of one window.
//!
//! 1. Frames that the find shard looked at keep their cameras; the others begin as new.
//! 2. The forest is queried for key frames a second apart, the first and the last frame among them,
//!    and its answers are aligned to their paint; of a folder it is queried for every image.
//! 3. Frames of a video between them are tracked from those that are certain, and never across a
//!    cut.
//!
//! No camera's base and no field's size changes, because all windows of a match must share them.

use super::find::read_model;
use super::frames::camera_of;
use super::{ShardError, ShardEvent, Work};
use crate::part::{AboutPart, Part};
use crate::plan::LabelShard;
use std::collections::{BTreeMap, BTreeSet};
use touchline_calibration::calibrate::clips;
use touchline_calibration::pipelines::{
    ForestRequest, MatchEvent, PictureFiles, TrackingOptions, label_frames, track_clips,
};
use touchline_calibration::proposals::{FeatureStore, KeyWindow};
use touchline_documents::document::{Document, FieldSize, Frame, Frames, Shared};
use touchline_vision::media::{FrameReader, FrameSource};
use touchline_vision::relocalize::RelocalizeOptions;

impl Work<'_> {
    pub(super) fn label_window(
        &self,
        found: &Part,
        label: &LabelShard,
    ) -> Result<Part, ShardError> {
        let mut document = Document {
            frames: self.frames_of_window(found, label)?,
            ..found.document.clone()
        };
        // Every other size would be fitted to this window's paint. The mark is for the work alone:
        // the part has the fields of the find shard.
        for field in document.fields_mut() {
            field.size = Some(FieldSize::Fitted);
        }
        if document
            .cameras
            .iter()
            .any(|camera| camera.base().is_some())
        {
            let mut reader = FrameReader::new();
            if !found.forest.is_empty() {
                self.query_forest(&mut document, &found.forest, &mut reader)?;
            }
            if matches!(self.source.frames, FrameSource::Video(_)) {
                self.track(&mut document, &mut reader)?;
            }
        }
        if self.progress.is_cancelled() {
            return Err(ShardError::Stopped);
        }
        Ok(Part {
            about: AboutPart {
                reason: found.about.reason.clone(),
                ..AboutPart::default()
            },
            document: Document {
                frames: document.frames,
                ..found.document.clone()
            },
            forest: Vec::new(),
        })
    }

    /// The frames of a window in their order: those that the find shard has, else new ones.
    fn frames_of_window(&self, found: &Part, label: &LabelShard) -> Result<Frames, ShardError> {
        let range = label.first..=label.last;
        let known: BTreeMap<usize, &Shared<Frame>> = found
            .document
            .frames
            .iter()
            .filter_map(|frame| Some((self.source.number_of(frame)?, frame)))
            .filter(|(number, _)| range.contains(number))
            .collect();
        let mut frames = self.new_frames(label, &found.document.field)?;
        for (number, frame) in &mut frames {
            if let Some(known) = known.get(number) {
                *frame = (*known).clone();
            } else if let Some(camera) = camera_of(&found.about.cameras_of_frames, *number) {
                frame.camera = camera;
            }
        }
        Ok(frames.into_values().collect())
    }

    /// Queries the forest for key frames without a camera, or for all images.
    fn query_forest(
        &self,
        document: &mut Document,
        forest: &[u8],
        reader: &mut FrameReader,
    ) -> Result<(), ShardError> {
        let model = read_model(forest, "the forest of the match's find part")?;
        // Frames between key frames are tracked later, which is more exact than the forest. Frames
        // of a folder have none between them.
        let between: BTreeSet<usize> = KeyWindow::from_document(document.at(&self.source.folder))
            .into_iter()
            .flat_map(|window| window.between)
            .collect();
        let wanted: Vec<usize> = (0..document.frames.len())
            .filter(|index| {
                let frame = &document.frames[*index];
                frame.is_open() && frame.ptz.is_none() && !between.contains(index)
            })
            .collect();
        let request = ForestRequest {
            model: &model,
            generation: 0,
            options: RelocalizeOptions::default(),
        };
        let store = FeatureStore::in_memory();
        let files = PictureFiles {
            folder: &self.source.folder,
            store: &store,
        };
        let progress = self.progress.part(|done| {
            let of = wanted.len();
            ShardEvent::Frames(MatchEvent::Asking { done, of })
        });
        label_frames(document, files, reader, &wanted, &request, true, &progress)?;
        // Times differ from run to run, and the bytes of a part must not.
        for &index in &wanted {
            if let Some(solution) = &mut document.frames[index].solution {
                solution.timings_ms = None;
            }
        }
        Ok(())
    }

    /// Tracks the frames of a video between those that are certain.
    fn track(&self, document: &mut Document, reader: &mut FrameReader) -> Result<(), ShardError> {
        let folder = &self.source.folder;
        let clips = clips(document.at(folder), None);
        let progress = self.progress.part(ShardEvent::Frames);
        track_clips(
            document,
            folder,
            &clips,
            reader,
            &TrackingOptions::default(),
            &mut Vec::new(),
            &progress.part(MatchEvent::Tracking),
        )?;
        Ok(())
    }
}
