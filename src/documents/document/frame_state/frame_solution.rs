//! A frame's camera: the result of a solve, and the program's proposal before the user corrected
//! it.

use crate::document::{
    BetterName, Document, Frame, FramePtz, FrameStatus, ImportedCamera, Proposed, Solution,
    SolutionSource, SolutionWarning, Target,
};
use touchline_core::camera::{Ptz, Radial};
use touchline_core::solve::{FrameSolution, Uncertainty, covariance_of_four_points, judge};

/// This many equations determine a camera without a proposal.
pub const ENOUGH_EQUATIONS: usize = 3;

impl Frame {
    /// Whether its camera comes from its own clicks, of a person or of a model.
    pub fn is_solved_by_clicks(&self) -> bool {
        self.solution.as_ref().is_some_and(|solution| {
            matches!(
                solution.source,
                Some(SolutionSource::Clicks | SolutionSource::Points)
            )
        })
    }

    /// What a camera from its clicks has as its source.
    pub fn source_of_clicks(&self) -> SolutionSource {
        if self.has_points_of_models_alone() {
            SolutionSource::Points
        } else {
            SolutionSource::Clicks
        }
    }

    /// Whether its named clicks determine a camera by themselves: a landmark gives two equations, a
    /// line one.
    fn clicks_decide(&self) -> bool {
        let used = self.clicks.iter().filter(|click| !click.check);
        let targets = used.filter_map(|click| click.target.as_ref());
        targets.map(Target::equations).sum::<usize>() >= ENOUGH_EQUATIONS
    }

    /// Sets pan, tilt, focal length and the lens at this focal length, on the base of its camera.
    /// Other keys of the document are kept, and an imported camera beside the base on record.
    pub fn point(&mut self, ptz: Ptz, lens: Radial) {
        self.keep_imported();
        let before = self.ptz.take();
        // A lens without distortion is stated only where the frame stated one before, so that
        // frames of a pinhole camera get no `k1` key.
        let recorded = before.as_ref().is_some_and(|before| before.k1.is_some());
        let lens = (!lens.is_none() || recorded).then_some(lens);
        let extra = before.map(|before| before.extra).unwrap_or_default();
        self.ptz = Some(FramePtz {
            extra,
            ..FramePtz::new(ptz, lens)
        });
    }

    /// Whether it has a camera of which neither a σ nor a probability is stated.
    pub fn is_uncertainty_unstated(&self) -> bool {
        let is_stated = self.solution.as_ref().is_some_and(|known| {
            known.covariance.is_some()
                || known.worst_corner_sigma_px.is_some()
                || known.confidence.is_some()
        });
        self.ptz.is_some() && !is_stated
    }

    /// Moves an imported camera that stands beside the base of its camera to the record, before
    /// `ptz` is replaced.
    pub fn keep_imported(&mut self) {
        if let Some(came) = self.ptz.as_mut().and_then(|ptz| ptz.imported.take()) {
            let solution = self.solution.get_or_insert_default();
            solution.imported.get_or_insert(*came);
        }
    }

    /// Takes the record of the camera that another program gave it, which outlives the cameras that
    /// replace each other until a person decides.
    pub fn take_imported(&mut self) -> Option<ImportedCamera> {
        self.solution.as_mut()?.imported.take()
    }

    /// Stores the result of a solve.
    pub fn record(&mut self, solved: &FrameSolution) {
        // The proposal is read before `point` replaces the camera that it may be. Clicks that
        // determine a camera by themselves are its source; fewer only correct the proposal, which
        // stays the source.
        let proposed = self.proposed_camera();
        let by_clicks = self.clicks_decide();
        let source = proposed
            .as_ref()
            .filter(|_| !by_clicks)
            .map_or_else(|| self.source_of_clicks(), |proposed| proposed.source);
        // What a model's points give is a suggestion until a person accepts it.
        if self.status == FrameStatus::New && self.has_points_of_models_alone() {
            self.status = FrameStatus::Suggested;
        }
        self.point(solved.ptz, solved.lens);
        // Only what other programs stated outlives a solve. Confidence, timings, samples and line
        // check belong to the camera that is replaced.
        let Solution {
            extra, imported, ..
        } = self.solution.take().unwrap_or_default();
        self.solution = Some(Solution {
            covariance: Some(solved.covariance),
            own_covariance: Some(solved.uncertainty.own_covariance_deg()),
            rms_px: solved.residuals_are_evidence().then_some(solved.rms_px),
            worst_corner_sigma_px: solved.corner_sigma_px_if_known(),
            ground: None,
            source: Some(source),
            confidence: None,
            timings_ms: None,
            samples: None,
            line_check: None,
            proposed,
            imported,
            verdict: Some(judge(solved, self.image_size).verdict),
            disputed: solved.disputed_clicks(),
            warnings: solved
                .warnings
                .iter()
                .enumerate()
                .map(|(place, warning)| SolutionWarning {
                    clicks: warning.clicks.clone(),
                    // `FrameSolution::with_identity` puts the warning about names first.
                    renames: solved
                        .identity
                        .iter()
                        .filter(|_| place == 0)
                        .flat_map(BetterName::all)
                        .collect(),
                    ..SolutionWarning::new(warning.code.as_str(), warning.message.clone())
                })
                .collect(),
            extra,
        });
    }

    /// The program's proposal, whether or not it was corrected since.
    pub fn proposed_camera(&self) -> Option<Proposed> {
        let solution = self.solution.as_ref()?;
        if let Some(kept) = &solution.proposed {
            return Some(kept.clone());
        }
        // Without a record of it, the proposal is the frame's own camera: a suggestion, or one
        // aligned to paint with too few clicks to replace it.
        let is_proposed = self.is_suggestion() || self.is_snapped() && !self.clicks_decide();
        self.camera_as_proposed(solution.source.filter(|_| is_proposed)?)
    }

    /// Its camera, in the form in which a proposal is kept.
    fn camera_as_proposed(&self, source: SolutionSource) -> Option<Proposed> {
        let solution = self.solution.as_ref();
        Some(Proposed {
            ptz: self.ptz.clone()?,
            source,
            confidence: solution.and_then(|solution| solution.confidence),
            covariance: solution.and_then(|solution| solution.covariance),
            own_covariance: solution.and_then(|solution| solution.own_covariance),
            worst_corner_sigma_px: solution.and_then(|solution| solution.worst_corner_sigma_px),
        })
    }

    /// Keeps its camera as the prior of the clicks that follow, as a proposal of the program is
    /// kept (see [`Proposed`]): a camera that was imported, say, or set by hand. A frame that is
    /// solved by its clicks, or keeps a proposal already, does not change.
    pub fn keep_camera_as_prior(&mut self) {
        if self.is_solved_by_clicks() || self.proposed_camera().is_some() {
            return;
        }
        // A camera that states no source came with the document.
        let source = self.source().unwrap_or(SolutionSource::Import);
        if let Some(kept) = self.camera_as_proposed(source) {
            self.solution.get_or_insert_default().proposed = Some(kept);
        }
    }

    /// Restores the program's proposal if the user corrected it and no click is left. True if it
    /// was restored.
    pub fn restore_proposed(&mut self) -> bool {
        let Some(solution) = &mut self.solution else {
            return false;
        };
        let Some(proposed) = solution.proposed.take() else {
            return false;
        };
        // A proposal that is the imported camera needs no record of that beside it.
        let imported = solution.imported.take();
        let imported = imported.filter(|_| proposed.ptz.imported.is_none());
        self.ptz = Some(proposed.ptz);
        // As in `record`, what other programs stated stays.
        *solution = Solution {
            covariance: proposed.covariance,
            own_covariance: proposed.own_covariance,
            worst_corner_sigma_px: proposed.worst_corner_sigma_px,
            source: Some(proposed.source),
            confidence: proposed.confidence,
            imported,
            extra: std::mem::take(&mut solution.extra),
            ..Solution::default()
        };
        true
    }
}

impl Document {
    /// States the σ of a frame's camera that is known like four points half-way to the corners,
    /// each to `sigma_px` (px at 1920 px width); the uncertainty of its base is added.
    pub fn state_uncertainty(&mut self, index: usize, sigma_px: f64) {
        let Some(frame) = self.frames.get(index) else {
            return;
        };
        let size = frame.image_size;
        let Some(camera) = self.ptz_camera(frame) else {
            return;
        };
        let own = covariance_of_four_points(&camera, size, sigma_px * size.scale_from_1920());
        // A picture that shows too little determines no camera, and has no σ.
        let Ok(known) = Uncertainty::from_covariance(&camera, own, size) else {
            return;
        };
        let Some(frame) = self.frames.get_mut(index) else {
            return;
        };
        let solution = frame.solution.get_or_insert_default();
        solution.covariance = Some(known.ptz_covariance_deg());
        solution.own_covariance = Some(known.own_covariance_deg());
        solution.worst_corner_sigma_px = known.corner_sigma_px_if_known(&camera, size);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{new_frame, ptz_at};
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_restored_camera_keeps_the_keys_of_other_programs() {
        let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
        frame.ptz = ptz_at(1.0, -9.0, 900.0);
        let mut solution = Solution {
            source: Some(SolutionSource::Import),
            ..Solution::default()
        };
        solution.extra.insert("theirs".to_owned(), 7.into());
        frame.solution = Some(solution);
        let imported = frame.clone();
        frame.keep_camera_as_prior();
        assert_ne!(frame, imported);
        assert!(frame.restore_proposed());
        assert_eq!(frame, imported);
    }
}
