//! Comparison of two documents of the same frames: an estimate with the truth, or two annotators
//! with each other.

mod agreement;
mod agreement_tables;
mod evaluation;
mod evaluation_tables;
mod ground;
mod matching;

pub use agreement::{
    Agreement, CameraAgreement, ClickPair, FrameAgreement, LandmarkAgreement, LoneFrame,
    NameDispute,
};
pub use evaluation::{
    Evaluation, EvaluationError, FrameGroup, FrameResult, FrameScores, GroupKind, Measure, evaluate,
};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    agreement::agreement,
    agreement_tables::{
        agreement_by_frame, agreement_by_landmark, agreement_json, agreement_tables,
    },
    evaluation::Unscored,
    evaluation_tables::{evaluation_report, evaluation_tables, frame_scores},
    ground::{FrameOnGround, GroundComparison, GroundError, compare_on_ground},
};
