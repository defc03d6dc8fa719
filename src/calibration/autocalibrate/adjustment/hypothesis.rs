//! A hypothesis: a base for the camera with the frames around it, from the joint adjustment to the
//! answer.
//!
//! The search scores poses by the hundred thousand, so it keeps them light
//! ([`crate::autocalibrate::search::pose_score::ScoredPose`]). The few that are adjusted with all frames become
//! hypotheses. Each later stage takes a hypothesis and returns it refined: the size of the field
//! (`candidates.rs`), the frames (`align.rs`), the base once more (`refine.rs`).

use super::evidence::doubts_of;
use super::evidence::measure_evidence;
use super::joint::{FrameObservations, JointStart, adjust_jointly};
use crate::autocalibrate::Doubt;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::{FramesAtScale, MatchedFrames};
use crate::calibrate::kept::kept;
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame};
use std::sync::Arc;
use touchline_core::camera::Ptz;
use touchline_core::geometry::Vec3;
use touchline_vision::track::{PosePrior, fill_missing_cameras};

/// A move of a hypothesis is taken if its evidence rises by this, nats: single stretches of lines
/// come and go with less.
pub const MIN_GAIN_NATS: f64 = 2.0;

/// A base for the camera, and the frames around it. Frames are numbered as in [`MatchedFrames`].
#[derive(Clone)]
pub struct Hypothesis {
    /// The camera as it would be answered, as far as it is refined.
    pub camera: AutocalibratedCamera,
    /// The camera of each frame from the joint adjustment; none for frames with too little paint.
    pub ptz: Vec<Option<Ptz>>,
    /// The pose prior of each frame from its own paint.
    pub paint_priors: Vec<PosePrior>,
    /// The frames at the focal scale where the search found the pose.
    pub frames: Arc<FramesAtScale>,
}

/// A hypothesis as it is kept, without its frames.
pub struct KeptHypothesis {
    camera: AutocalibratedCamera,
    ptz: Vec<Option<Ptz>>,
    paint_priors: Vec<PosePrior>,
}

kept! {
    KeptHypothesis { camera, ptz, paint_priors }
}

impl From<Hypothesis> for KeptHypothesis {
    fn from(hypothesis: Hypothesis) -> Self {
        Self {
            camera: hypothesis.camera,
            ptz: hypothesis.ptz,
            paint_priors: hypothesis.paint_priors,
        }
    }
}

impl KeptHypothesis {
    /// The hypothesis with its frames.
    pub fn into_hypothesis(self, frames: &Arc<FramesAtScale>) -> Hypothesis {
        Hypothesis {
            camera: self.camera,
            ptz: self.ptz,
            paint_priors: self.paint_priors,
            frames: Arc::clone(frames),
        }
    }
}

impl Hypothesis {
    /// Adjusts the base and all frames jointly to the paint, and measures the evidence for the
    /// result. None if too few frames show paint near the lines.
    pub fn adjust(
        start: &JointStart,
        size_prior: Option<&FieldPrior>,
        frames: &Arc<FramesAtScale>,
        matched: &MatchedFrames,
    ) -> Option<Self> {
        let paint = &frames.paint;
        let observed = FrameObservations {
            paint,
            matches: &matched.matches,
            image_size: matched.image_size,
            lens: &matched.lens,
        };
        let joint = adjust_jointly(start, size_prior, &observed)?;
        let evidence = measure_evidence(&joint, paint, &matched.marking_pixels);
        let paint_priors = joint.paint_priors();
        let camera = AutocalibratedCamera {
            base: joint.base,
            field: joint.field,
            sizes: joint.sizes,
            frames: unaligned_frames(&joint.ptz, matched),
            others: matched.others.clone(),
            paint: Vec::new(),
            evidence,
        };
        Some(Self {
            camera,
            ptz: joint.ptz,
            paint_priors,
            frames: Arc::clone(frames),
        })
    }

    /// Adjusts a base and its frames, and repeats that from the result while the evidence rises by
    /// [`MIN_GAIN_NATS`].
    ///
    /// Paint is assigned to lines once per round, with the base of the moment. A frame that was
    /// assigned to the wrong lines, or dropped because it lay near none, gets a second chance from
    /// the better base and field size.
    pub fn adjust_repeatedly(
        start: &JointStart,
        size_prior: Option<&FieldPrior>,
        frames: &Arc<FramesAtScale>,
        matched: &MatchedFrames,
    ) -> Option<Self> {
        const MAX_PASSES: usize = 4;
        let mut best = Self::adjust(start, size_prior, frames, matched)?;
        for _ in 1..MAX_PASSES {
            match best.adjust_again(size_prior, matched) {
                Some(next) if next.nats() > best.nats() + MIN_GAIN_NATS => best = next,
                _ => break,
            }
        }
        Some(best)
    }

    /// Adjusts it once more, from its own result.
    fn adjust_again(
        &self,
        size_prior: Option<&FieldPrior>,
        matched: &MatchedFrames,
    ) -> Option<Self> {
        let start = JointStart::from_hypothesis(self, matched)?;
        Self::adjust(&start, size_prior, &self.frames, matched)
    }

    /// Adjusts it until the camera and the size of the field stand still, where the document states
    /// no size.
    ///
    /// The length of a field and the distance of a camera behind its goal compensate each other
    /// nearly, so an adjustment ends before it has gone all the way along that valley, and the
    /// score is as good as the same from one pass to the next. Drawn clip 27 of the bowl, where the
    /// far goal line is a tenth of a pixel wide: the length goes from 106.7 to 109.2 m in six
    /// passes (108.9 m is right), and the score from 0.534 to 0.538.
    pub fn settle(&mut self, field_prior: &FieldPrior, matched: &MatchedFrames) {
        const MAX_PASSES: usize = 6;
        const STILL_M: f64 = 0.1;
        for _ in 0..MAX_PASSES {
            let next = self
                .adjust_again(Some(field_prior), matched)
                .filter(|next| next.nats() + MIN_GAIN_NATS >= self.nats());
            let Some(next) = next else {
                return;
            };
            let moved_m = (next.position_m() - self.position_m()).norm();
            *self = next;
            if moved_m < STILL_M {
                return;
            }
        }
    }

    /// How likely it is by the paint of its pictures, nats ([`crate::evidence`]).
    pub const fn nats(&self) -> f64 {
        self.camera.evidence.nats
    }

    /// The position of the camera in `world`, m.
    pub const fn position_m(&self) -> Vec3 {
        self.camera.base.position_m
    }

    /// The reasons to reject it, from its evidence.
    pub fn doubts(&self) -> Vec<Doubt> {
        doubts_of(&self.camera)
    }

    /// The cameras of all frames: those without paint of their own are placed by their matches with
    /// the others. None if no frame has a camera.
    pub fn all_ptz(&self, matched: &MatchedFrames) -> Option<Vec<Ptz>> {
        fill_missing_cameras(&self.ptz, &self.frames.rotations.ptz, &matched.matches)
    }
}

/// The frames that have a camera, with their indices in the document, none of them aligned. The
/// others get a camera in the alignment.
pub fn unaligned_frames(ptz: &[Option<Ptz>], matched: &MatchedFrames) -> Vec<AutocalibratedFrame> {
    let frames = matched.indices.iter().zip(ptz);
    let placed = frames.filter_map(|(&index, ptz)| {
        Some(AutocalibratedFrame {
            index,
            ptz: (*ptz)?,
            uncertainty: None,
            snapped: None,
            unaligned_score: None,
        })
    });
    placed.collect()
}

impl JointStart {
    /// From the result of an adjustment. Frames that it dropped are placed by their matches with
    /// the frames that it kept.
    pub fn from_hypothesis(hypothesis: &Hypothesis, matched: &MatchedFrames) -> Option<Self> {
        let ptz = hypothesis.all_ptz(matched)?.into_iter().map(Some).collect();
        let camera = &hypothesis.camera;
        Some(Self {
            field: camera.field.clone(),
            base: camera.base,
            ptz,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        base, frames_at_scale, hypothesis, matched_views, matched_views_with_pixels, paint, ptz,
        soccer,
    };

    #[test]
    fn base_and_frames_are_found_again_from_beside() {
        let (field, matched) = (soccer().assumed, matched_views());
        let mut start_base = base();
        start_base.position_m += Vec3::new(0.3, -0.4, 0.1);
        let start = JointStart {
            field: field.clone(),
            base: start_base,
            ptz: ptz().into_iter().map(Some).collect(),
        };
        let found = Hypothesis::adjust(&start, None, &frames_at_scale(&field), &matched).unwrap();
        let off_m = (found.position_m() - base().position_m).norm();
        assert!(off_m < 0.1, "{off_m:.3} m");
        let indices: Vec<usize> = found
            .camera
            .frames
            .iter()
            .map(|frame| frame.index)
            .collect();
        assert_eq!(indices, matched.indices);
        assert_eq!(found.paint_priors.len(), ptz().len());
        assert!(
            found.camera.evidence.residual_px < 0.5,
            "{}",
            found.camera.evidence.residual_px
        );
        assert!(
            found.camera.evidence.explained > 0.95,
            "{}",
            found.camera.evidence.explained
        );
    }

    /// On a field that is taken for 3 m too long, the camera stands still where it is right.
    #[test]
    fn camera_and_size_settle_together() {
        let prior = soccer();
        let matched = matched_views_with_pixels(&prior.assumed, &[0, 1, 2, 3, 4, 5, 6]);
        let mut settled = hypothesis(&prior.assumed);
        settled.camera.field = prior.with_lengths(&[108.0, 68.0]).unwrap();
        settled.camera.base.position_m.x += 1.0;
        settled.settle(&prior, &matched);
        let off_m = (settled.position_m() - base().position_m).norm();
        assert!(off_m < 0.2, "{off_m:.2} m");
        let length_m = settled.camera.field.length_m;
        assert!((length_m - 105.0).abs() < 0.2, "{length_m:.2} m");
    }

    #[test]
    fn without_paint_there_is_no_hypothesis() {
        let (field, matched) = (soccer().assumed, matched_views());
        let mut bare = Arc::into_inner(frames_at_scale(&field)).unwrap();
        bare.paint.iter_mut().for_each(Vec::clear);
        let start = JointStart {
            field,
            base: base(),
            ptz: ptz().into_iter().map(Some).collect(),
        };
        assert!(Hypothesis::adjust(&start, None, &Arc::new(bare), &matched).is_none());
    }

    #[test]
    fn the_fixture_shows_lines_in_every_frame() {
        let field = soccer().assumed;
        assert!(ptz().into_iter().all(|ptz| paint(&field, ptz).len() > 40));
    }

    #[test]
    fn all_frames_have_a_camera_if_one_has() {
        let (matched, mut hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        hypothesis.ptz[1..].fill(None);
        let all = hypothesis.all_ptz(&matched).unwrap();
        for (found, truth) in all.iter().zip(ptz()) {
            assert!((found.pan - truth.pan).degrees().abs() < 1e-6, "{found:?}");
            assert!((found.focal_px - truth.focal_px).abs() < 1e-6, "{found:?}");
        }
        hypothesis.ptz[0] = None;
        assert!(hypothesis.all_ptz(&matched).is_none());
    }
}
