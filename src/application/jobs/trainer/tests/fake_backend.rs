//! The backend that the test controls: each piece of work waits until the test says how it ends.

use crate::app::TrainerActivity;
use crate::jobs::trainer::backend::{Backend, ForestAccuracy, TrainedModel};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender};
use touchline_calibration::proposals::{
    Answer, FrameRequest, KeyWindow, LearnError, LeftOutBy, Proposal, Quality, Suspect, Timings,
    TrackedProposal, TrainingSet, UsedFeatures,
};
use touchline_core::camera::{PanTilt, Ptz};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::Document;
use touchline_vision::features::{DESCRIPTOR_BYTES, Descriptor, FeatureOptions};
use touchline_vision::relocalize::{
    CameraForest, ForestModel, Samples, SeenRange, TrainOptions, train,
};

/// A piece of work that the backend has begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum BackendCall {
    Recall,
    Learn(Vec<usize>),
    Propose(Vec<usize>),
    /// The key frames.
    Carry(Vec<usize>),
    Measure,
}

/// How the work ends.
pub(super) enum ScriptedEnd {
    Well,
    Fail,
    Panic,
    /// Runs until its watch ends it.
    Stopped,
}

pub(super) struct FakeBackend {
    pub(super) begun: Sender<BackendCall>,
    pub(super) orders: Receiver<ScriptedEnd>,
    pub(super) confidence: f64,
}

impl FakeBackend {
    fn begin(&self, what: BackendCall) -> ScriptedEnd {
        // When the test has dropped the controller, the work succeeds.
        self.begun.send(what).unwrap_or_default();
        self.orders.recv().unwrap_or(ScriptedEnd::Well)
    }
}

impl Backend for FakeBackend {
    fn recall(&mut self, _: &TrainingSet) -> Result<Option<ForestModel>, String> {
        match self.begin(BackendCall::Recall) {
            ScriptedEnd::Well => Ok(Some(model())),
            ScriptedEnd::Fail => Err("it is damaged".to_owned()),
            ScriptedEnd::Panic => panic!("the shelf fell"),
            ScriptedEnd::Stopped => Ok(None),
        }
    }

    fn learn(
        &mut self,
        _: &Document,
        training_frames: &[usize],
        _: &TrainingSet,
        progress: &Progress<'_, TrainerActivity>,
    ) -> Result<Option<TrainedModel>, String> {
        match self.begin(BackendCall::Learn(training_frames.to_vec())) {
            ScriptedEnd::Well => Ok(Some(TrainedModel {
                model: model(),
                features: 1,
                failed: Vec::new(),
            })),
            ScriptedEnd::Fail => Err(no_features()),
            ScriptedEnd::Panic => panic!("the saw broke"),
            ScriptedEnd::Stopped => {
                until_stopped(&|| {
                    progress.report(TrainerActivity::Training(Share { done: 1, of: 2 }))
                });
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
        match self.begin(BackendCall::Propose(frames.to_vec())) {
            ScriptedEnd::Panic => panic!("the forest burns"),
            ScriptedEnd::Stopped => {
                until_stopped(&|| progress.report(0));
                Vec::new()
            }
            ScriptedEnd::Well | ScriptedEnd::Fail => frames
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
        match self.begin(BackendCall::Carry(window.keys.clone())) {
            ScriptedEnd::Well => {
                let all = window.clip.frames.iter().filter_map(|frame| frame.place);
                Some(
                    all.map(|place| {
                        TrackedProposal::at_pan(document, place, place as f64, generation)
                    })
                    .collect(),
                )
            }
            ScriptedEnd::Fail => Some(Vec::new()),
            ScriptedEnd::Panic => panic!("the rope snapped"),
            ScriptedEnd::Stopped => {
                until_stopped(&|| progress.report(0));
                None
            }
        }
    }

    fn measure(
        &mut self,
        document: &Document,
        _: &[usize],
        progress: &Progress<'_, TrainerActivity>,
    ) -> Option<ForestAccuracy> {
        match self.begin(BackendCall::Measure) {
            ScriptedEnd::Well => {
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
                Some(ForestAccuracy {
                    quality: Some(quality),
                    suspects,
                })
            }
            ScriptedEnd::Fail => Some(ForestAccuracy {
                quality: None,
                suspects: Vec::new(),
            }),
            ScriptedEnd::Panic => panic!("the check failed"),
            ScriptedEnd::Stopped => {
                until_stopped(&|| {
                    progress.report(TrainerActivity::Measuring(Share { done: 0, of: 2 }))
                });
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

pub(super) fn no_features() -> String {
    let stopped = touchline_vision::relocalize::Stopped::NoSamples { frames: 1 };
    LearnError::from(stopped).to_string()
}

fn until_stopped(tell: &dyn Fn() -> ControlFlow<()>) {
    while tell().is_continue() {
        std::thread::yield_now();
    }
}

pub(super) fn model() -> ForestModel {
    let mut samples = Samples::new();
    samples.add_frame([(
        Descriptor([9; DESCRIPTOR_BYTES]),
        PanTilt::from_degrees(1.0, -9.0),
    )]);
    let forest = train(&samples, &TrainOptions::default(), &Progress::default()).unwrap();
    let seen = SeenRange::from_cameras(&[Ptz::from_degrees(1.0, -9.0, 900.0)]).unwrap();
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

pub(super) fn proposal(
    document: &Document,
    frame: usize,
    generation: u64,
    confidence: f64,
) -> Proposal {
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
