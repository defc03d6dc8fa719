//! Two documents of the same frames against each other: an estimate against the truth, and two annotators.

mod agreement;
mod evaluation;
mod matching;

pub use agreement::{
    Agreement, CameraAgreement, ClickPair, FrameAgreement, LandmarkAgreement, LoneFrame, NameDispute, agreement,
};
pub use evaluation::{
    Evaluation, EvaluationError, FrameGroup, FrameResult, FrameScores, GroupKind, Measure, Unscored, evaluate,
};
