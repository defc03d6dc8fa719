//! Finds references with labels that contradict those of others.

use crate::proposals::{FramePictures, ReferenceSamples, TrainingSample, study};
use std::cmp::Reverse;
use touchline_core::geometry::{Angle, AngleRange};
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FrameId};
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{ContradictionOptions, Reference, contradictions, suspects};

/// Number of references, neighbours in pan, that are compared at a time; the features of no more
/// are in memory. References far apart in pan share no view and cannot contradict each other.
const MAX_REFERENCES: usize = 100;

/// A reference to check: without these, no label would contradict another.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// Id of the frame.
    pub frame: FrameId,
    /// Number of references that contradict it.
    pub contradicted_by: usize,
    /// Largest distance of its overlay from where they place it, px at 1920 px width.
    pub disagreement_px: f64,
}

/// The training frames to check, the most contradicted first. Each reference is a step of progress.
/// None if `progress` cancelled it.
pub fn find_suspects(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    training_frames: &[usize],
    progress: &Progress<'_, ()>,
) -> Option<Vec<Suspect>> {
    let document = pictures.document;
    let mut found = Vec::new();
    for camera in &document.cameras {
        let of_camera = training_frames
            .iter()
            .map(|&index| (index, &*document.frames[index]))
            .filter(|(_, frame)| frame.camera == camera.id)
            .filter_map(|(index, frame)| Some((document.ptz_camera(frame)?.ptz().pan, index)));
        // Sort by pan along the smallest range that contains all, so that no neighbours are
        // separated at ±180°.
        let (pans, of_camera): (Vec<Angle>, Vec<usize>) = of_camera.unzip();
        let of_camera: Vec<usize> = AngleRange::along_smallest(&pans)
            .into_iter()
            .map(|place| of_camera[place])
            .collect();
        // The last references of one group and the first ones of the next are not compared. That
        // keeps the time linear and bounds the memory.
        for together in of_camera.chunks(MAX_REFERENCES) {
            let ReferenceSamples {
                training_samples, ..
            } = study(pictures, reader, together, progress)?;
            found.extend(suspects_among(document, &training_samples));
        }
    }
    found.sort_by_key(|(index, suspect)| (Reverse(suspect.contradicted_by), *index));
    Some(found.into_iter().map(|(_, suspect)| suspect).collect())
}

/// The suspects among references, each with its index in the document.
fn suspects_among(
    document: &Document,
    training_samples: &[TrainingSample],
) -> Vec<(usize, Suspect)> {
    let pointed = training_samples.iter().filter_map(|sample| {
        let camera = document.ptz_camera(document.frames.get(sample.frame)?)?;
        Some((
            sample.frame,
            Reference {
                features: &sample.fine.features,
                camera,
            },
        ))
    });
    let (frames, references): (Vec<usize>, Vec<Reference>) = pointed.unzip();
    // Contradictions come in descending order, so the first one of a reference is its largest.
    let found = contradictions(&references, &ContradictionOptions::default());
    let suspects = suspects(&found).into_iter().map(|index| {
        let mut against = found
            .iter()
            .filter(|contradiction| contradiction.references.contains(&index))
            .peekable();
        let disagreement_px = against
            .peek()
            .map_or(0.0, |greatest| greatest.disagreement_px);
        let frame = document.frames[frames[index]].id.clone();
        (
            frames[index],
            Suspect {
                frame,
                contradicted_by: against.count(),
                disagreement_px,
            },
        )
    });
    suspects.collect()
}
