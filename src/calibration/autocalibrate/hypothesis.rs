//! A hypothesis: a base for the camera with the frames around it, from the joint adjustment to the answer.
//!
//! The search scores poses by the hundred thousand, so it keeps them light ([`super::search::ScoredPose`]). The few that are adjusted
//! with all frames become hypotheses. Each later stage takes a hypothesis and returns it refined: the size of the field
//! (`candidates.rs`), the frames (`align.rs`), the base once more (`refine.rs`).

use super::Doubt;
use super::evidence::doubts_of;
use super::evidence::measure_evidence;
use super::field_prior::FieldPrior;
use super::joint::{FrameObservations, JointStart, adjust_jointly};
use super::matched_frames::{FramesAtScale, MatchedFrames};
use crate::calibrate::{UnclickedCamera, UnclickedFrame};
use std::sync::Arc;
use touchline_core::camera::Ptz;
use touchline_core::geometry::Vec3;
use touchline_vision::track::{Hold, filled};

/// A base for the camera, and the frames around it. Frames are numbered as in [`MatchedFrames`].
#[derive(Clone)]
pub(super) struct Hypothesis {
    /// The answer, as far as it is refined.
    pub camera: UnclickedCamera,
    /// Of each frame, by the paint of all frames; none for frames that show too little.
    pub ptz: Vec<Option<Ptz>>,
    /// What each frame's own paint says of its camera.
    pub paint_priors: Vec<Hold>,
    /// The frames at the focal scale where the search found the pose.
    pub frames: Arc<FramesAtScale>,
}

impl Hypothesis {
    /// Adjusts the base and all frames jointly to the paint, and measures the evidence for the result. None if too few frames show paint
    /// near the lines.
    pub fn adjust(
        start: &JointStart,
        size_prior: Option<&FieldPrior>,
        frames: &Arc<FramesAtScale>,
        matched: &MatchedFrames,
    ) -> Option<Self> {
        let paint = &frames.paint;
        let observed = FrameObservations { paint, matches: &matched.matches, image_size: matched.image_size };
        let joint = adjust_jointly(start, size_prior, &observed)?;
        let evidence = measure_evidence(&joint, paint, &matched.strokes);
        let paint_priors = joint.paint_priors();
        let placed =
            matched.indices.iter().zip(&joint.ptz).filter_map(|(&index, ptz)| {
                Some(UnclickedFrame { index, ptz: (*ptz)?, uncertainty: None, snapped: None })
            });
        let camera = UnclickedCamera {
            base: joint.base,
            field: joint.field,
            sizes: joint.sizes,
            frames: placed.collect(),
            others: matched.others.clone(),
            paint: Vec::new(),
            evidence,
        };
        Some(Self { camera, ptz: joint.ptz, paint_priors, frames: Arc::clone(frames) })
    }

    /// How much of paint and lines belongs together, 0 to 1.
    pub fn score(&self) -> f64 {
        self.camera.evidence.score()
    }

    /// Where the camera stands, m.
    pub const fn position_m(&self) -> Vec3 {
        self.camera.base.position_m
    }

    /// What speaks against it, by its evidence.
    pub fn doubts(&self) -> Vec<Doubt> {
        doubts_of(&self.camera.evidence, &self.camera.base)
    }

    /// The cameras of all frames: those without paint of their own are placed by their matches with the others. None if no frame
    /// has a camera.
    pub fn all_ptz(&self, matched: &MatchedFrames) -> Option<Vec<Ptz>> {
        filled(&self.ptz, &self.frames.rotations.ptz, &matched.matches)
    }
}
