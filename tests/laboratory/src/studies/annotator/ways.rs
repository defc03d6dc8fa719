//! The ways in which the simulated annotator labels the clip.

use super::clip::DrawnClip;
use crate::ExperimentError;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use touchline::autocalibrate::{AutocalibrationAnswer, camera_without_clicks};
use touchline::calibrate::{
    ClipEvidence, FrameLookup, TrackClipOptions, calibrate, clips, record_found, record_tracked,
    track_clip,
};
use touchline::document::{Camera, Document, Frame, FrameStatus};
use touchline::media::FrameReader;
use touchline::progress::Progress;
use touchline::proposals::{
    Coverage, FeatureStore, FramePictures, LearnOptions, LineEvidence, TrainingFrames,
    label_advice, learn, propose, read_picture, study,
};
use touchline::relocalize::RelocalizeOptions;

/// The result of a way of labelling.
pub struct Labelled {
    /// The document with the cameras found.
    pub document: Document,
    /// The frames that were clicked.
    pub clicked: BTreeSet<usize>,
    /// Number of clicks.
    pub clicks: usize,
}

/// The labelled clip, or the program's reason for abstaining.
pub type Outcome = Result<Labelled, String>;

/// The annotator checks a frame if the stated 1-σ of its overlay at the worst corner exceeds this,
/// px.
const DOUBTFUL_PX: f64 = 3.0;

/// Maximum share of frames that are clicked.
const MOST_CLICKED: f64 = 0.05;

/// If a frame shows too few landmarks, one of its neighbours up to this distance is clicked
/// instead.
const BESIDE: usize = 12;

/// While the forest learns, it is run on every n-th frame, because neighbours look alike. At the
/// end it is run on all.
const QUERIED_EVERY: usize = 8;

impl Labelled {
    /// The clip before the first click.
    pub fn nothing(clip: &DrawnClip) -> Self {
        Self {
            document: clip.document.clone(),
            clicked: BTreeSet::new(),
            clicks: 0,
        }
    }

    /// Clicks a frame, solves it and accepts it. False if it shows fewer than two landmarks or has
    /// no solution.
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
        // Accepted, so that it trains forests and tracking starts from it.
        clicked.record(&solved);
        clicked.status = FrameStatus::Reference;
        self.clicked.insert(frame);
        self.clicks += clicked.clicks.len();
        *self.document.frames[frame] = clicked;
        true
    }

    /// Clicks this frame, or the nearest one that shows enough. False if there is none within
    /// [`BESIDE`].
    fn click_near(&mut self, clip: &DrawnClip, frame: usize, landmarks: usize) -> bool {
        let last = self.document.frames.len() - 1;
        let beside = |by: usize| {
            [
                frame.checked_sub(by),
                Some(frame + by).filter(|at| *at <= last),
            ]
        };
        // Nearest first: the frame itself, then one before, one behind, and further out. The frame
        // itself comes twice, which does no harm.
        let near: Vec<usize> = (0..=BESIDE).flat_map(beside).flatten().collect();
        near.into_iter()
            .any(|at| !self.clicked.contains(&at) && self.click(clip, at, landmarks))
    }

    /// The frame that the program advises to label next, if the clip consisted only of the frames
    /// `places`.
    fn advised_frame(&self, clip: &DrawnClip, places: &[usize]) -> Option<usize> {
        let frames = places
            .iter()
            .map(|at| self.document.frames[*at].clone())
            .collect();
        // The advice is that of the program, on a document of the queried frames alone: the others
        // have no answer yet and would all count as doubtful.
        let some = Document {
            frames,
            ..self.document.clone()
        };
        let coverage = Coverage::measure_cameras(
            some.at(clip.folder()),
            &TrainingFrames::from_solved_frames(&some).frames,
        );
        label_advice(&some, &coverage)
            .next
            .map(|next| places[next.frame])
    }

    /// Whether the annotator has clicked the maximum share of frames.
    fn is_over(&self) -> bool {
        self.clicked.len() as f64 >= MOST_CLICKED * self.document.frames.len() as f64
    }

    /// The frame among `places` that needs a check most: one without a camera, or the one with the
    /// largest stated error above [`DOUBTFUL_PX`]. None if all are certain.
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
        // Of several frames without a camera, take the middle one: it is representative of the gap.
        let doubts: Vec<(usize, f64)> = places.into_iter().filter_map(doubt).collect();
        // Frames without a camera have an infinite doubt and are equal. The first of them would be
        // at the edge of the gap.
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

/// Clicks one frame in the middle and tracks its camera through the clip. While a frame is
/// doubtful, clicks the worst one and tracks again.
///
/// # Errors
/// A picture cannot be read.
pub fn click_and_track(clip: &DrawnClip) -> Result<Labelled, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    labelled.click_near(clip, clip.truth.len() / 2, 4);
    // What was measured in the pictures is used again by each pass.
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

/// Tracks the known cameras through the clip, and records the results.
fn carry(
    clip: &DrawnClip,
    labelled: &mut Labelled,
    evidence: &mut ClipEvidence,
) -> Result<(), ExperimentError> {
    let (mut reader, options) = (FrameReader::new(), TrackClipOptions::default());
    let at = labelled.document.at(clip.folder());
    // The clip is one shot of one camera.
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

/// No click at all: autocalibration estimates the base from the pictures, then the cameras are
/// tracked. Doubtful frames are not checked.
///
/// # Errors
/// A picture cannot be read.
pub fn no_click(clip: &DrawnClip) -> Result<Outcome, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    // Delete the base that the other ways know.
    let camera = labelled.document.cameras[0].id.clone();
    let unknown = Camera::new(camera.clone(), labelled.document.cameras[0].image_size);
    labelled.document.cameras[0] = unknown.into();
    let mut reader = FrameReader::new();
    // Pictures are read by a copy, because the answer is written into the document. It shares the
    // frames.
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
        AutocalibrationAnswer::Abstained { why, .. } => Ok(Err(why.to_string())),
    }
}

/// Number of frames that autocalibration samples.
const LOOK_AT: usize = 40;

/// Trains a forest. Labels frames one by one where the program advises it, until the forest is
/// certain of every sampled frame; then runs it on all.
///
/// # Errors
/// A picture cannot be read.
pub fn forest(clip: &DrawnClip, is_snapped: bool) -> Result<Labelled, ExperimentError> {
    let mut labelled = Labelled::nothing(clip);
    labelled.click_near(clip, clip.truth.len() / 2, 4);
    // Features of a picture are found once, although each round needs them.
    let store = FeatureStore::in_memory();
    loop {
        // Clicked frames are among those that the advice counts as references.
        let meanwhile =
            |at: &usize| at.is_multiple_of(QUERIED_EVERY) || labelled.clicked.contains(at);
        let queried: Vec<usize> = (0..clip.truth.len()).filter(meanwhile).collect();
        propose_some(clip, &mut labelled, &queried, &store, is_snapped)?;
        let Some(next) = labelled
            .advised_frame(clip, &queried)
            .or_else(|| labelled.most_doubtful(queried))
        else {
            break;
        };
        if labelled.is_over() || !labelled.click_near(clip, next, 4) {
            break;
        }
    }
    let all: Vec<usize> = (0..clip.truth.len()).collect();
    // All frames at the end. While the forest learnt, only some were queried.
    propose_some(clip, &mut labelled, &all, &store, is_snapped)?;
    Ok(labelled)
}

/// Trains a forest on the labelled frames and runs it on the open ones among `places`. The line
/// check judges its proposals; with `is_snapped`, they are aligned to the paint first.
fn propose_some(
    clip: &DrawnClip,
    labelled: &mut Labelled,
    places: &[usize],
    store: &FeatureStore,
    is_snapped: bool,
) -> Result<(), ExperimentError> {
    // Training and answers see the document as it is at the beginning of the round.
    let before = labelled.document.clone();
    let options = LearnOptions::default();
    let pictures = FramePictures {
        document: &before,
        folder: clip.folder(),
        options: options.features,
        store,
    };
    let mut reader = FrameReader::new();
    // Train a forest on all frames labelled so far.
    let training = TrainingFrames::from_document(&before, false);
    let studied = study(
        &pictures,
        &mut reader,
        &training.frames,
        &Progress::default(),
    )
    .unwrap_or_default();
    let model = learn(&before, &studied, &options, &Progress::default())
        .map_err(|error| wrong(clip, &error))?;
    // Run it on frames that the annotator has not decided on.
    let open: Vec<usize> = places
        .iter()
        .copied()
        .filter(|at| before.frames[*at].is_open())
        .collect();
    let asking = RelocalizeOptions::default();
    let proposals = pictures.each(&mut reader, &open, |frame, _, found| {
        ControlFlow::Continue(propose(&before, frame, found, (&model, 0), &asking))
    });
    // None would mean that it was cancelled, and the function above never does that.
    let mut proposals = proposals.unwrap_or_default();
    // Check the proposals against the painted lines, and record those that remain.
    let at = before.at(clip.folder());
    let evidence = LineEvidence::from_document(at, &mut reader, is_snapped)?;
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
