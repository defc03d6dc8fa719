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
    NameDispute, agreement,
};
pub use agreement_tables::{
    agreement_by_frame, agreement_by_landmark, agreement_json, agreement_tables,
};
pub use evaluation::{
    Evaluation, EvaluationError, FrameGroup, FrameResult, FrameScores, GroupKind, Measure,
    Unscored, evaluate,
};
pub use evaluation_tables::{evaluation_report, evaluation_tables, frame_scores};
pub use ground::{FrameOnGround, GroundComparison, GroundError, compare_on_ground};
