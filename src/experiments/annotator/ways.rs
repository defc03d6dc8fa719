//! The ways in which the simulated annotator labels the clip.

use super::clip::DrawnClip;
use crate::ExperimentError;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use touchline_calibration::autocalibrate::{AutocalibrationAnswer, Doubt, camera_without_clicks};
use touchline_calibration::calibrate::{
    ClipEvidence, FrameLookup, TrackClipOptions, calibrate, clips, record_found, record_tracked,
    track_clip,
};
use touchline_calibration::proposals::{
    Coverage, FeatureStore, FramePictures, LearnOptions, LineEvidence, TrainingFrames,
    label_advice, learn, propose, read_picture, study,
};
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, Document, Frame, FrameStatus};
use touchline_vision::media::FrameReader;
use touchline_vision::relocalize::RelocalizeOptions;

/// What came of a way of labelling.
pub struct Labelled {
    /// The document with the cameras that were found.
    pub document: Document,
    /// Frames that the person clicked on.
    pub clicked: BTreeSet<usize>,
    /// The person's clicks.
    pub clicks: usize,
}

/// What comes of a way of labelling: the clip labelled, or in words why the program does not dare
/// to answer.
pub type Outcome = Result<Labelled, String>;

/// A person looks at a frame again where its overlay may be off by more, 1-σ at the worst corner,
/// px.
const DOUBTFUL_PX: f64 = 3.0;

/// A person clicks on no more frames than this share.
const MOST_CLICKED: f64 = 0.05;

/// Frames beside the one in doubt that may be clicked in its place.
const BESIDE: usize = 12;

/// While a person labels for the forest, one frame in this many is asked for, as its neighbours
/// look alike; all of them are in the end.
const ASKED_MEANWHILE: usize = 8;

impl Labelled {
    /// Nothing yet.
    pub fn nothing(clip: &DrawnClip) -> Self {
        Self {
            document: clip.document.clone(),
            clicked: BTreeSet::new(),
            clicks: 0,
        }
    }

    /// The person clicks a frame and accepts it; false where it does not show enough.
    fn click(&mut self, clip: &DrawnClip, frame: usize, landmarks: usize) -> bool {
        let mut clicked = Frame::clone(&clip.document.frames[frame]);
        clicked.clicks = clip.clicks(frame, landmarks);
        if clicked.clicks.len() < 2 {
            return false;
        }
        let Ok(solved) = calibrate(
            &self.document,
            &FrameLookup::default(),
            &clicked,
            &clip.field,
            frame,
        ) else {
            return false;
        };
        clicked.record(&solved);
        clicked.status = FrameStatus::Reference;
        self.clicked.insert(frame);
        self.clicks += clicked.clicks.len();
        *self.document.frames[frame] = clicked;
        true
    }

    /// The person clicks the frame, or the nearest one to it that shows enough.
    fn click_near(&mut self, clip: &DrawnClip, frame: usize, landmarks: usize) -> bool {
        let last = self.document.frames.len() - 1;
        let beside = |by: usize| {
            [
                frame.checked_sub(by),
                Some(frame + by).filter(|at| *at <= last),
            ]
        };
        let near: Vec<usize> = (0..=BESIDE).flat_map(beside).flatten().collect();
        near.into_iter()
            .any(|at| !self.clicked.contains(&at) && self.click(clip, at, landmarks))
    }

    /// Where the program advises to label next, in the clip as if it had the frames at some places
    /// alone.
    fn advised(&self, clip: &DrawnClip, places: &[usize]) -> Option<usize> {
        let frames = places
            .iter()
            .map(|at| self.document.frames[*at].clone())
            .collect();
        let some = Document {
            frames,
            ..self.document.clone()
        };
        let coverage = Coverage::of_cameras(
            some.at(clip.folder()),
            &TrainingFrames::of_solved(&some).frames,
        );
        label_advice(&some, &coverage)
            .next
            .map(|next| places[next.frame])
    }

    fn is_over(&self) -> bool {
        self.clicked.len() as f64 >= MOST_CLICKED * self.document.frames.len() as f64
    }

    /// The frame that is most in doubt of those at some places: without a camera, or with the
    /// largest stated error beyond what a person lets pass.
    fn most_doubtful(&self, places: impl IntoIterator<Item = usize>) -> Option<usize> {
        let doubt = |at: usize| {
            let frame = &self.document.frames[at];
            let sigma = frame
                .solution
                .as_ref()
                .and_then(|solution| solution.worst_corner_sigma_px);
            let px = if frame.ptz.is_some() {
                sigma.unwrap_or(f64::INFINITY)
            } else {
                f64::INFINITY
            };
            (!self.clicked.contains(&at) && px > DOUBTFUL_PX).then_some((at, px))
        };
        // Where several are without a camera, the middle of them.
        let doubts: Vec<(usize, f64)> = places.into_iter().filter_map(doubt).collect();
        let worst = doubts.iter().map(|(_, px)| *px).fold(0.0, f64::max);
        let alike: Vec<usize> = doubts
            .iter()
            .filter(|(_, px)| *px >= worst)
            .map(|(at, _)| *at)
            .collect();
        alike.get(alike.len() / 2).copied()
    }
}

/// Two clicks on every frame.
pub fn two_clicks(clip: &DrawnClip) -> Labelled {
    let mut labelled = Labelled::nothing(clip);
    for frame in 0..clip.truth.len() {
        labelled.click(clip, frame, 2);
    }
    labelled
}

/// The camera is carried from one clicked frame to all others; where that is in doubt, another
/// frame is clicked.
///
/// # Errors
/// A picture cannot be read.
pub fn carried(clip: &DrawnClip) -> Result<Labelled, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    labelled.click_near(clip, clip.truth.len() / 2, 4);
    let mut evidence = ClipEvidence::default();
    loop {
        carry(clip, &mut labelled, &mut evidence)?;
        let Some(worst) = labelled.most_doubtful(0..clip.truth.len()) else {
            return Ok(labelled);
        };
        if labelled.is_over() || !labelled.click_near(clip, worst, 4) {
            return Ok(labelled);
        }
    }
}

/// Carries the cameras that are known through the clip.
fn carry(
    clip: &DrawnClip,
    labelled: &mut Labelled,
    evidence: &mut ClipEvidence,
) -> Result<(), ExperimentError> {
    let (mut reader, options) = (FrameReader::new(), TrackClipOptions::default());
    let at = labelled.document.at(clip.folder());
    let Some(frames) = clips(at, None).into_iter().next() else {
        return Ok(());
    };
    let tracked = track_clip(
        at,
        &frames,
        &clip.field,
        &mut reader,
        &options,
        evidence,
        &Progress::default(),
    );
    let tracked = tracked.map_err(|error| wrong(clip, &error))?;
    record_tracked(&mut labelled.document, &tracked);
    Ok(())
}

/// No click at all: the camera's place as well is found from the pictures. Nobody looks at a frame
/// that is in doubt.
///
/// # Errors
/// A picture cannot be read.
pub fn no_click(clip: &DrawnClip) -> Result<Outcome, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    let camera = labelled.document.cameras[0].id.clone();
    let unknown = Camera::new(camera.clone(), labelled.document.cameras[0].image_size);
    labelled.document.cameras[0] = unknown.into();
    let mut reader = FrameReader::new();
    let document = labelled.document.clone();
    let mut picture =
        |frame: usize| read_picture(&mut reader, &document.frames[frame], clip.folder()).ok();
    let at = document.at(clip.folder());
    let answer = camera_without_clicks(at, &camera, LOOK_AT, &mut picture, &Progress::default());
    match answer.map_err(|error| wrong(clip, &error))? {
        AutocalibrationAnswer::Found(found) => {
            record_found(&mut labelled.document, &camera, &found);
            carry(clip, &mut labelled, &mut ClipEvidence::default())?;
            Ok(Ok(labelled))
        }
        AutocalibrationAnswer::Abstained(why) => Ok(Err(why.to_string())),
        AutocalibrationAnswer::Two { .. } => Ok(Err(Doubt::Rival.to_string())),
    }
}

/// Frames that are looked at where nothing is clicked.
const LOOK_AT: usize = 40;

/// Frames that teach a forest are labelled one after the other where the program advises it, until
/// it is sure of every frame that is asked for meanwhile; then all are.
///
/// # Errors
/// A picture cannot be read.
pub fn forest(clip: &DrawnClip, is_snapped: bool) -> Result<Labelled, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    labelled.click_near(clip, clip.truth.len() / 2, 4);
    let store = FeatureStore::in_memory();
    loop {
        let meanwhile =
            |at: &usize| at.is_multiple_of(ASKED_MEANWHILE) || labelled.clicked.contains(at);
        let asked: Vec<usize> = (0..clip.truth.len()).filter(meanwhile).collect();
        propose_some(clip, &mut labelled, &asked, &store, is_snapped)?;
        let Some(next) = labelled
            .advised(clip, &asked)
            .or_else(|| labelled.most_doubtful(asked))
        else {
            break;
        };
        if labelled.is_over() || !labelled.click_near(clip, next, 4) {
            break;
        }
    }
    let all: Vec<usize> = (0..clip.truth.len()).collect();
    propose_some(clip, &mut labelled, &all, &store, is_snapped)?;
    Ok(labelled)
}

/// The forest of what is labelled proposes the cameras of those frames at some places that nobody
/// has decided on.
fn propose_some(
    clip: &DrawnClip,
    labelled: &mut Labelled,
    places: &[usize],
    store: &FeatureStore,
    is_snapped: bool,
) -> Result<(), ExperimentError> {
    let before = labelled.document.clone();
    let options = LearnOptions::default();
    let pictures = FramePictures {
        document: &before,
        folder: clip.folder(),
        options: options.features,
        store,
    };
    let mut reader = FrameReader::new();
    let training = TrainingFrames::of(&before, false);
    let studied = study(
        &pictures,
        &mut reader,
        &training.frames,
        &Progress::default(),
    )
    .unwrap_or_default();
    let model = learn(&before, &studied, &options, &Progress::default())
        .map_err(|error| wrong(clip, &error))?;
    let asked: Vec<usize> = places
        .iter()
        .copied()
        .filter(|at| before.frames[*at].is_open())
        .collect();
    let asking = RelocalizeOptions::default();
    let proposals = pictures.each(&mut reader, &asked, |frame, _, found| {
        ControlFlow::Continue(propose(&before, frame, found, (&model, 0), &asking))
    });
    let mut proposals = proposals.unwrap_or_default();
    let at = before.at(clip.folder());
    let evidence = LineEvidence::of(at, &mut reader, is_snapped)?;
    evidence.judge(at, &mut reader, &mut proposals, asking.pose.min_confidence);
    for proposal in proposals {
        if let Some(frame) = labelled.document.frames.by_id_mut(&proposal.frame) {
            proposal.record(frame);
        }
    }
    Ok(())
}

fn wrong(clip: &DrawnClip, error: &dyn std::fmt::Display) -> ExperimentError {
    ExperimentError::Given {
        path: clip.folder().to_path_buf(),
        reason: error.to_string(),
    }
}
