//! The trainer with a backend that the test controls: it reports each piece of work that it begins
//! and continues when the test lets it.

use super::answer_cache::{AnswerCache, Asking};
use super::backend::{Backend, Learnt, Measured};
use super::error::TrainerError;
use super::kept_forest::KeptForestError;
use super::{Trainer, TrainerOptions, TrainerReport};
use crate::app::{AnswerKey, Doing, TrainerOrder, TrainerStatus};
use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use touchline_calibration::pipelines::LearnForestError;
use touchline_calibration::proposals::{
    Answer, FrameRequest, KeyWindow, LearnError, LeftOutBy, NoProposal, Proposal, Quality,
    RefusedForests, Suspect, Timings, TrackedProposal, TrainingSet, UsedFeatures,
};
use touchline_core::camera::{BaseAngles, CameraBase, PanTilt, Ptz};
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{
    Camera, Document, FieldSpec, Frame, FrameId, FramePtz, FrameStatus, VideoFrame,
};
use touchline_vision::features::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions};
use touchline_vision::relocalize::{
    CameraForest, ForestModel, Samples, SeenRange, TrainOptions, train,
};

const SIZE: ImageSize = ImageSize::new(64, 36);

/// A piece of work that the backend has begun.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Begun {
    Recall,
    Learn(Vec<usize>),
    Propose(Vec<usize>),
    /// The key frames.
    Carry(Vec<usize>),
    Measure,
}

/// How the work ends.
enum Let {
    Well,
    Fail,
    Panic,
    /// Runs until its watch ends it.
    Stopped,
}

struct StandIn {
    begun: Sender<Begun>,
    orders: Receiver<Let>,
    confidence: f64,
}

impl StandIn {
    fn begin(&self, what: Begun) -> Let {
        // When the test has dropped the controller, the work succeeds.
        self.begun.send(what).unwrap_or_default();
        self.orders.recv().unwrap_or(Let::Well)
    }
}

fn no_features() -> TrainerError {
    let stopped = touchline_vision::relocalize::Stopped::NoSamples { frames: 1 };
    LearnForestError::from(LearnError::from(stopped)).into()
}

fn until_stopped(tell: &dyn Fn() -> ControlFlow<()>) {
    while tell().is_continue() {
        std::thread::yield_now();
    }
}

fn model() -> ForestModel {
    let mut samples = Samples::new();
    samples.add_frame([(
        Descriptor([9; DESCRIPTOR_BYTES]),
        PanTilt::from_degrees(1.0, -9.0),
    )]);
    let forest = train(&samples, &TrainOptions::default(), &Progress::default()).unwrap();
    let seen = SeenRange::of(&[Ptz::from_degrees(1.0, -9.0, 900.0)]).unwrap();
    let cameras = vec![CameraForest {
        camera: "main".to_owned(),
        seen,
        forest,
    }];
    ForestModel {
        document: String::new(),
        features: FeatureOptions::default(),
        cameras,
    }
}

impl Backend for StandIn {
    fn recall(&mut self, _: &TrainingSet) -> Result<Option<ForestModel>, TrainerError> {
        match self.begin(Begun::Recall) {
            Let::Well => Ok(Some(model())),
            Let::Fail => Err(KeptForestError::from(io::Error::other("it is damaged")).into()),
            Let::Panic | Let::Stopped => Ok(None),
        }
    }

    fn learn(
        &mut self,
        _: &Document,
        training_frames: &[usize],
        _: &TrainingSet,
        progress: &Progress<'_, Doing>,
    ) -> Result<Option<Learnt>, TrainerError> {
        match self.begin(Begun::Learn(training_frames.to_vec())) {
            Let::Well => Ok(Some(Learnt {
                model: model(),
                features: 1,
                failed: Vec::new(),
            })),
            Let::Fail => Err(no_features()),
            Let::Panic => panic!("the saw broke"),
            Let::Stopped => {
                until_stopped(&|| progress.report(Doing::Training(Share { done: 1, of: 2 })));
                Ok(None)
            }
        }
    }

    fn propose(
        &mut self,
        document: &Document,
        frames: &[usize],
        (_, generation): (&ForestModel, u64),
        _: bool,
        progress: &Progress<'_, usize>,
    ) -> Vec<Proposal> {
        match self.begin(Begun::Propose(frames.to_vec())) {
            Let::Panic => panic!("the forest burns"),
            Let::Stopped => {
                until_stopped(&|| progress.report(0));
                Vec::new()
            }
            Let::Well | Let::Fail => frames
                .iter()
                .map(|&index| proposal(document, index, generation, self.confidence))
                .collect(),
        }
    }

    fn carry(
        &mut self,
        document: &Document,
        window: &KeyWindow,
        generation: u64,
        progress: &Progress<'_, usize>,
    ) -> Option<Vec<TrackedProposal>> {
        match self.begin(Begun::Carry(window.keys.clone())) {
            Let::Well => {
                let all = window.clip.frames.iter().filter_map(|frame| frame.place);
                Some(
                    all.map(|place| {
                        TrackedProposal::at_pan(document, place, place as f64, generation)
                    })
                    .collect(),
                )
            }
            Let::Fail => Some(Vec::new()),
            Let::Panic => panic!("the rope snapped"),
            Let::Stopped => {
                until_stopped(&|| progress.report(0));
                None
            }
        }
    }

    fn measure(
        &mut self,
        document: &Document,
        _: &[usize],
        progress: &Progress<'_, Doing>,
    ) -> Option<Measured> {
        match self.begin(Begun::Measure) {
            Let::Well => {
                let quality = Quality {
                    left_out_by: LeftOutBy::Shot,
                    groups: 1,
                    tested: Vec::new(),
                };
                let suspects = vec![Suspect {
                    frame: document.frames[0].id.clone(),
                    contradicted_by: 1,
                    disagreement_px: 40.0,
                }];
                Some(Measured {
                    quality: Some(quality),
                    suspects,
                })
            }
            Let::Fail => Some(Measured {
                quality: None,
                suspects: Vec::new(),
            }),
            Let::Panic => panic!("the check failed"),
            Let::Stopped => {
                until_stopped(&|| progress.report(Doing::Measuring(Share { done: 0, of: 2 })));
                None
            }
        }
    }

    fn features(
        &mut self,
        document: &Document,
        frame: usize,
        _: &ForestModel,
    ) -> Option<UsedFeatures> {
        Some(UsedFeatures {
            frame: document.frames[frame].id.clone(),
            features: Vec::new(),
        })
    }

    fn not_kept(&self) -> Option<String> {
        None
    }

    fn folder(&self) -> &Path {
        Path::new("/match")
    }
}

fn proposal(document: &Document, frame: usize, generation: u64, confidence: f64) -> Proposal {
    let answer = Answer::at_pan(frame as f64, confidence);
    let frame = &document.frames[frame];
    let request = FrameRequest::from_frame(document, frame);
    Proposal {
        frame: frame.id.clone(),
        request,
        generation,
        outcome: Ok(answer),
        timings: Timings::default(),
    }
}

/// The test's control over the backend.
struct Controller {
    trainer: Option<Trainer>,
    begun: Receiver<Begun>,
    go: Sender<Let>,
    woken: Receiver<()>,
    status: TrainerStatus,
    proposals: Vec<Proposal>,
    tracked: Vec<TrackedProposal>,
    features: Vec<FrameId>,
}

impl Controller {
    fn start(confidence: f64) -> Self {
        let (begin, begun) = channel();
        let (go, orders) = channel();
        let (wake, woken) = channel();
        let options = TrainerOptions {
            settle: Duration::ZERO,
            gather: Duration::ZERO,
            threads: Some(1),
        };
        let make = move |_| StandIn {
            begun: begin,
            orders,
            confidence,
        };
        let trainer = Trainer::start_with(
            options,
            Arc::new(move || wake.send(()).unwrap_or_default()),
            make,
        )
        .unwrap();
        let (status, proposals) = (TrainerStatus::default(), Vec::new());
        let (tracked, features) = (Vec::new(), Vec::new());
        Self {
            trainer: Some(trainer),
            begun,
            go,
            woken,
            status,
            proposals,
            tracked,
            features,
        }
    }

    fn tell(&self, order: TrainerOrder) {
        self.trainer.as_ref().unwrap().tell(order);
    }

    fn document(&self, document: &Document) {
        self.tell(TrainerOrder::Document(Box::new(document.clone())));
    }

    /// Waits for the next piece of work, checks it, and lets it end.
    fn expect(&self, begun: &Begun, answer: Let) {
        assert_eq!(self.begun.recv().unwrap(), *begun);
        self.go.send(answer).unwrap();
    }

    fn poll(&mut self) {
        for report in self.trainer.as_ref().unwrap().poll() {
            match report {
                TrainerReport::Status(status) => self.status = *status,
                TrainerReport::Proposals(proposals) => self.proposals.extend(proposals),
                TrainerReport::Tracked(tracked) => self.tracked.extend(tracked),
                TrainerReport::Features(used) => self.features.push(used.frame),
                TrainerReport::Broken { message } => panic!("{message}"),
            }
        }
    }

    /// Polls after each wake until the status is as wanted.
    fn until(&mut self, wanted: impl Fn(&TrainerStatus) -> bool) {
        self.poll();
        while !wanted(&self.status) {
            self.woken.recv().unwrap();
            self.poll();
        }
    }

    fn until_idle(&mut self) {
        self.until(|status| status.doing == Doing::Nothing && status.forest.is_some());
    }

    /// Checks that no other work has begun.
    fn nothing_begun(&self) {
        assert_eq!(self.begun.try_recv().ok(), None);
    }
}

/// A document of which the first few frames are references.
fn document(references: usize, others: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut main = Camera::new("main".into(), SIZE);
    let level = BaseAngles::default().base_from_world();
    main.set_base(&CameraBase::new(
        Vec3::new(0.0, -66.0, 18.0),
        level,
        SIZE.centre(),
    ));
    document.cameras.push(main.into());
    for index in 0..references + others {
        let mut frame = Frame::from_image(&format!("{index}.jpg"), "main".into(), SIZE);
        if index < references {
            accept(&mut frame, index as f64);
        }
        document.frames.push(frame.into());
    }
    document
}

fn accept(frame: &mut Frame, pan_deg: f64) {
    frame.status = FrameStatus::Reference;
    frame.ptz = Some(FramePtz::new(Ptz::from_degrees(pan_deg, -9.0, 900.0), None));
}

#[test]
fn references_are_learnt_then_frames_are_proposed_then_it_is_measured() {
    let mut controller = Controller::start(0.95);
    let all = document(2, 28);
    controller.tell(TrainerOrder::Frame(all.frames[6].id.clone()));
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    controller.expect(&Begun::Learn(vec![0, 1]), Let::Well);
    for near in [
        vec![6, 5, 7, 4],
        vec![8, 3, 9, 2],
        vec![10, 11, 12, 13],
        vec![14],
    ] {
        controller.expect(&Begun::Propose(near), Let::Well);
    }
    controller.expect(&Begun::Measure, Let::Well);
    for far in [15..19, 19..23, 23..27, 27..30] {
        controller.expect(&Begun::Propose(far.collect()), Let::Well);
    }
    controller.until_idle();
    assert_eq!(
        (
            controller.status.references,
            controller.status.training_frames,
            controller.status.answered
        ),
        (2, 2, 28)
    );
    assert_eq!(controller.status.forest.unwrap().generation, 1);
    assert!(controller.status.quality.is_some());
    assert_eq!(controller.status.suspects[0].frame, all.frames[0].id);
    assert_eq!(controller.proposals.len(), 28);
    assert!(
        controller
            .proposals
            .iter()
            .all(|proposal| proposal.generation == 1)
    );
}

#[test]
fn a_burst_is_one_change_and_added_references_let_a_training_end() {
    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 0));
    controller.expect(&Begun::Recall, Let::Stopped);
    assert_eq!(controller.begun.recv().unwrap(), Begun::Learn(vec![0]));
    for references in 2..=6 {
        controller.document(&document(references, 0));
    }
    controller.go.send(Let::Well).unwrap();
    controller.expect(&Begun::Learn((0..6).collect()), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    assert_eq!(controller.status.forest.unwrap().generation, 2);
    controller.nothing_begun();
}

#[test]
fn a_withdrawn_reference_stops_the_training_and_its_answers_are_queried_again() {
    let mut controller = Controller::start(0.99);
    let mut all = document(3, 2);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    assert_eq!(
        controller.begun.recv().unwrap(),
        Begun::Learn(vec![0, 1, 2])
    );
    all.frames[1].status = FrameStatus::Draft;
    controller.document(&all);
    controller.go.send(Let::Stopped).unwrap();
    controller.expect(&Begun::Learn(vec![0, 2]), Let::Well);
    controller.expect(&Begun::Propose(vec![3, 4]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();

    // Certain answers stay when a reference is added, and are queried again when one is withdrawn.
    for (index, proposal) in controller.proposals.drain(..).enumerate() {
        proposal.record(&mut all.frames[3 + index]);
    }
    accept(&mut all.frames[1], 1.5);
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 1, 2]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    all.frames[0].ptz.as_mut().unwrap().pan_deg = 0.25;
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 1, 2]), Let::Well);
    controller.expect(&Begun::Propose(vec![3, 4]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);

    controller.until_idle();
    assert_eq!(controller.status.suspects.len(), 1);
    for index in 0..3 {
        all.frames[index].status = FrameStatus::New;
    }
    controller.document(&all);
    controller.until(|status| status.references == 0);
    assert_eq!(
        (controller.status.forest, &controller.status.quality),
        (None, &None)
    );
    controller.nothing_begun();
}

#[test]
fn a_better_forest_is_queried_again_for_doubtful_answers() {
    let controller = Controller::start(0.6);
    let mut all = document(2, 1);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    controller.expect(&Begun::Learn(vec![0, 1]), Let::Well);
    controller.expect(&Begun::Propose(vec![2]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    all.frames.push(document(3, 0).frames[2].clone());
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 1, 3]), Let::Well);
    controller.expect(&Begun::Propose(vec![2]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
}

#[test]
fn every_stage_can_be_paused_and_taken_up_again() {
    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 1));
    controller.expect(&Begun::Recall, Let::Stopped);
    for stage in [
        Begun::Learn(vec![0]),
        Begun::Propose(vec![1]),
        Begun::Measure,
    ] {
        controller.expect(&stage, Let::Stopped);
        controller.until(|status| status.doing != Doing::Paused);
        controller.tell(TrainerOrder::Pause(true));
        controller.until(|status| status.doing == Doing::Paused);
        controller.nothing_begun();
        controller.tell(TrainerOrder::Pause(false));
        controller.expect(&stage, Let::Well);
    }
    controller.until_idle();
}

/// Consecutive frames of a video; the first is a reference.
fn video(frames: usize) -> Document {
    let mut all = document(1, frames - 1);
    for index in 0..frames {
        all.frames[index].image = None;
        all.frames[index].video = Some(VideoFrame::new("match.mp4", index as u64, None));
    }
    all
}

#[test]
fn in_a_video_the_forest_answers_key_frames_and_the_rest_is_tracked() {
    let mut controller = Controller::start(0.95);
    let mut all = video(61);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Well);
    controller.expect(&Begun::Propose(vec![1, 2, 3, 4]), Let::Well);
    controller.expect(&Begun::Propose(vec![5, 6, 7, 8]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.expect(&Begun::Propose(vec![25, 50, 60]), Let::Well);
    let keys = Begun::Carry(vec![0, 25, 50, 60]);
    controller.expect(&keys, Let::Stopped);
    controller.until(|status| matches!(status.doing, Doing::Carrying(Share { of: 57, .. })));
    controller.tell(TrainerOrder::Pause(true));
    controller.until(|status| status.doing == Doing::Paused);
    controller.tell(TrainerOrder::Pause(false));
    controller.expect(&keys, Let::Well);
    controller.until_idle();
    // Tracking also adjusts key frames that the forest answered, but not the user's reference.
    assert_eq!(controller.tracked.len(), 60);
    controller.nothing_begun();

    // A document that shows all cameras, and a shown frame near the other end, cause no more work.
    for proposal in controller.proposals.drain(..) {
        proposal.record(all.frames.by_id_mut(&proposal.frame).unwrap());
    }
    for tracked in controller.tracked.drain(..) {
        tracked.record(all.frames.by_id_mut(&tracked.frame).unwrap());
    }
    controller.document(&all);
    controller.tell(TrainerOrder::Frame(all.frames[40].id.clone()));
    controller.until_idle();
    controller.nothing_begun();

    // Another reference between the key frames: the whole window is propagated again.
    accept(&mut all.frames[30], 30.5);
    all.frames[30].solution = None;
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 30]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.expect(&keys, Let::Well);
    while controller.tracked.is_empty() {
        controller.woken.recv().unwrap();
        controller.poll();
    }
    assert_eq!(controller.tracked.len(), 59);
}

#[test]
fn frames_that_tracking_does_not_reach_are_queried() {
    let mut controller = Controller::start(0.95);
    controller.document(&video(31));
    controller.expect(&Begun::Recall, Let::Well);
    for near in [vec![1, 2, 3, 4], vec![5, 6, 7, 8]] {
        controller.expect(&Begun::Propose(near), Let::Well);
    }
    controller.expect(&Begun::Measure, Let::Well);
    controller.expect(&Begun::Propose(vec![25, 30]), Let::Well);
    controller.expect(&Begun::Carry(vec![0, 25, 30]), Let::Panic);
    for left in [9..13, 13..17, 17..21, 21..25, 26..30] {
        controller.expect(&Begun::Propose(left.collect()), Let::Well);
    }
    controller.until_idle();
    assert_eq!(controller.tracked, []);
    assert!(
        controller
            .status
            .trouble
            .as_ref()
            .is_some_and(|trouble| trouble.contains("carrying"))
    );
}

#[test]
fn features_are_shown_while_they_are_wanted_and_follow_the_shown_frame() {
    let mut controller = Controller::start(0.95);
    let all = document(1, 1);
    let [first, second] = [0, 1].map(|position| all.frames[position].id.clone());
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Well);
    controller.expect(&Begun::Propose(vec![1]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    controller.tell(TrainerOrder::Features(true));
    controller.woken.recv().unwrap();
    controller.tell(TrainerOrder::Frame(second.clone()));
    while controller.features.last() != Some(&second) {
        controller.woken.recv().unwrap();
        controller.poll();
    }
    assert!(
        controller.features == [first, second.clone()] || controller.features == [second],
        "{:?}",
        controller.features
    );
    controller.nothing_begun();
}

#[test]
fn references_wait_for_the_base_of_their_camera() {
    let mut controller = Controller::start(0.95);
    let known = document(2, 0);
    let mut all = known.clone();
    all.cameras[0].position_m = None;
    controller.document(&all);
    controller.until(|status| status.references == 2);
    assert_eq!(
        (
            controller.status.training_frames,
            &controller.status.trouble
        ),
        (0, &None)
    );
    controller.nothing_begun();
    controller.document(&known);
    controller.expect(&Begun::Recall, Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    assert_eq!(controller.status.training_frames, 2);
}

#[test]
fn every_stage_ends_when_the_trainer_is_dropped() {
    for stages in 0..3 {
        let mut controller = Controller::start(0.95);
        controller.document(&document(1, 1));
        controller.expect(&Begun::Recall, Let::Stopped);
        let all = [
            Begun::Learn(vec![0]),
            Begun::Propose(vec![1]),
            Begun::Measure,
        ];
        for (number, stage) in all.into_iter().take(stages + 1).enumerate() {
            controller.expect(
                &stage,
                if number == stages {
                    Let::Stopped
                } else {
                    Let::Well
                },
            );
        }
        drop(controller.trainer.take());
    }
}

#[test]
fn a_panic_is_shown_and_work_goes_on() {
    let mut controller = Controller::start(0.95);
    let mut all = document(1, 1);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    controller.expect(&Begun::Learn(vec![0]), Let::Panic);
    controller.until(|status| status.trouble.is_some());
    assert!(
        controller
            .status
            .trouble
            .as_ref()
            .unwrap()
            .contains("while learning (please report it): the saw broke"),
        "{:?}",
        controller.status
    );
    // Training is not repeated with the same references unless the user pauses and resumes.
    all.frames[1].comment = Some("rain".to_owned());
    controller.document(&all);
    controller.until(|status| status.doing == Doing::Nothing);
    controller.nothing_begun();
    controller.tell(TrainerOrder::Pause(true));
    controller.until(|status| status.doing == Doing::Paused);
    controller.tell(TrainerOrder::Pause(false));
    controller.expect(&Begun::Learn(vec![0]), Let::Fail);
    controller.until(|status| status.trouble == Some(no_features().to_string()));
    all.frames.push(document(2, 0).frames[1].clone());
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 2]), Let::Well);
    controller.expect(&Begun::Propose(vec![1]), Let::Panic);
    controller.expect(&Begun::Measure, Let::Panic);
    controller.until(|status| {
        status
            .trouble
            .as_ref()
            .is_some_and(|trouble| trouble.contains("the check failed"))
    });
    controller.until_idle();
    let [failed] = &controller.proposals[..] else {
        panic!("{:?}", controller.proposals)
    };
    assert_eq!(
        failed.outcome,
        Err(NoProposal::Panicked {
            message: "the forest burns".to_owned()
        })
    );
}

#[test]
fn the_forest_of_an_earlier_session_serves_and_a_damaged_one_is_made_again() {
    let mut controller = Controller::start(0.95);
    let mut all = document(1, 2);
    // A certain proposal of an earlier run is not queried again.
    proposal(&document(1, 2), 1, 1, 0.97).record(&mut all.frames[1]);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Well);
    controller.expect(&Begun::Propose(vec![2]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    assert_eq!(controller.status.forest.unwrap().took, None);

    let mut controller = Controller::start(0.95);
    controller.document(&document(1, 0));
    controller.expect(&Begun::Recall, Let::Fail);
    controller.expect(&Begun::Learn(vec![0]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    assert_eq!(controller.status.trouble, None, "it has been mended");
}

#[test]
fn whether_proposals_are_snapped_can_be_changed_and_then_all_are_queried_again() {
    let mut controller = Controller::start(0.99);
    controller.tell(TrainerOrder::Snap(true));
    let mut all = document(2, 2);
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    controller.expect(&Begun::Learn(vec![0, 1]), Let::Well);
    controller.expect(&Begun::Propose(vec![2, 3]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    let mut said = controller.proposals.clone();
    said[0].outcome.as_mut().unwrap().samples = Some(80);
    for (index, proposal) in said.iter().enumerate() {
        proposal.record(&mut all.frames[2 + index]);
    }
    controller.document(&all);
    controller.tell(TrainerOrder::Snap(false));
    controller.expect(&Begun::Propose(vec![2, 3]), Let::Well);
    controller.until_idle();
    controller.nothing_begun();

    // In another run only the frame that is not snapped is queried.
    let controller = Controller::start(0.99);
    controller.tell(TrainerOrder::Snap(true));
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Well);
    controller.expect(&Begun::Propose(vec![3]), Let::Well);
}

/// A query without snapping.
const fn by(generation: u64) -> Asking {
    Asking {
        generation,
        snapping: false,
    }
}

#[test]
fn frames_whose_answer_the_document_lost_are_queried_again() {
    let (mut all, forest, mut answer_cache) = (document(1, 3), model(), AnswerCache::default());
    let wanted = |answer_cache: &AnswerCache, document: &Document, generation| -> Vec<usize> {
        (0..4)
            .filter(|&index| answer_cache.wants(document, index, &forest, by(generation)))
            .collect()
    };
    assert_eq!(wanted(&answer_cache, &all, 1), [1, 2, 3]);
    for index in 1..4 {
        let said = proposal(&all, index, 1, if index == 3 { 0.6 } else { 0.95 });
        answer_cache.enter(&said, by(1));
        answer_cache.look_at(&all);
        assert_eq!(
            wanted(&answer_cache, &all, 1).len(),
            3 - index,
            "answered, though not yet in the document"
        );
        said.record(&mut all.frames[index]);
    }
    answer_cache.look_at(&all);
    assert_eq!(
        (
            wanted(&answer_cache, &all, 1),
            wanted(&answer_cache, &all, 2)
        ),
        (vec![], vec![3])
    );
    assert_eq!(
        (
            answer_cache.answered(&all),
            answer_cache.unanswered(&all),
            answer_cache.given_by(by(1))
        ),
        (3, 0, 3)
    );

    let mut undone = all.clone();
    undone.frames[1] = document(1, 3).frames[1].clone();
    answer_cache.look_at(&undone);
    assert_eq!(wanted(&answer_cache, &undone, 1), [1]);
    let mut moved = all.clone();
    moved.cameras[0].position_m = Some(Vec3::new(0.0, -60.0, 18.0));
    let mut answer_cache = AnswerCache::default();
    answer_cache.enter(&proposal(&all, 2, 1, 0.95), by(1));
    answer_cache.look_at(&moved);
    // With another base, everything that the forest was trained on is different.
    answer_cache.trust_from(2);
    assert!(
        answer_cache.wants(&moved, 2, &forest, by(2)),
        "an answer for another base is none"
    );
}

#[test]
fn a_forest_whose_answers_were_discarded_is_not_queried_for_them_again() {
    let mut controller = Controller::start(0.6);
    let mut all = document(2, 2);
    let refused = |generation| RefusedForests {
        frames: vec![document(2, 2).frames[2].id.clone()],
        generation,
    };
    controller.document(&all);
    controller.expect(&Begun::Recall, Let::Stopped);
    controller.expect(&Begun::Learn(vec![0, 1]), Let::Well);
    controller.expect(&Begun::Propose(vec![2, 3]), Let::Well);
    controller.expect(&Begun::Measure, Let::Well);
    controller.until_idle();
    let key = |proposal: &Proposal| AnswerKey {
        frame: proposal.frame.clone(),
        revision: proposal.request.revision,
        generation: proposal.generation,
        is_tracked: false,
    };
    controller.tell(TrainerOrder::Shown(
        controller.proposals.iter().map(key).collect(),
    ));
    controller.tell(TrainerOrder::Refused(refused(1)));
    // The document has lost both answers, of which only one was discarded.
    controller.document(&all);
    controller.expect(&Begun::Propose(vec![3]), Let::Well);
    controller.until_idle();
    controller.nothing_begun();

    // A newer forest is queried.
    all.frames.push(document(3, 0).frames[2].clone());
    controller.document(&all);
    controller.expect(&Begun::Learn(vec![0, 1, 4]), Let::Well);
    controller.expect(&Begun::Propose(vec![2, 3]), Let::Well);
}

#[test]
fn a_forest_that_goes_on_under_another_number_is_still_refused() {
    let (all, forest, mut answer_cache) = (document(1, 2), model(), AnswerCache::default());
    answer_cache.refuse(RefusedForests {
        frames: vec![all.frames[1].id.clone()],
        generation: 0,
    });
    answer_cache.keep_refusing(0, 1);
    let wants = |answer_cache: &AnswerCache, index, generation| {
        answer_cache.wants(&all, index, &forest, by(generation))
    };
    assert!(!wants(&answer_cache, 1, 1) && wants(&answer_cache, 2, 1));
    assert!(wants(&answer_cache, 1, 2));
    answer_cache.refuse(RefusedForests {
        frames: vec![all.frames[2].id.clone()],
        generation: 0,
    });
    assert!(
        !wants(&answer_cache, 2, 1),
        "refused by the number that it had before"
    );
}
