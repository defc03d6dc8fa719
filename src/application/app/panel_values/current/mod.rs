//! Values derived for the shown frame: its solution, camera, verdict and preview. They are
//! recomputed when the document, the shown frame or the point that is being placed changes, and
//! never stored.

mod name_ranking;
#[cfg(test)]
mod tests;

use super::proposed_base::WithProposal;
use crate::app::OpenProject;
use crate::app::review::disagrees;
use crate::app::window_state::session::{Mode, Session};
use crate::scene::next_click::{NextClick, next_clicks};
pub(in crate::app) use name_ranking::rank_names;
use std::sync::Arc;
use touchline_calibration::calibrate::{
    BaseReadiness, BetterCamera, CalibrationError, Disagreement, EstimatedBase, calibrate,
    camera_alone, observations,
};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::{
    ClickResidual, FrameSolution, GOOD_CORNER_SIGMA_PX, IdentityFinding, Judgement, Verdict,
    WarningCode, judge,
};
use touchline_documents::document::{Click, Frame, Solution, SolutionSource};
use touchline_vision::relocalize::CERTAIN;

/// The shown frame with all values derived for it.
#[derive(Debug, Default)]
pub struct Current {
    /// The field of the frame's camera.
    pub field: Option<Result<Arc<FieldModel>, FieldError>>,
    /// The base of the frame's camera, if it has one.
    pub base: Option<CameraBase>,
    /// The solution from the clicks. None if there is nothing to solve, or the camera does not come
    /// from clicks (set by hand, or aligned to paint).
    pub solution: Option<Result<FrameSolution, CalibrationError>>,
    /// Distances of the clicks from a camera that does not come from them: aligned to paint,
    /// proposed, set by hand.
    pub residuals: Vec<ClickResidual>,
    /// The verdict and its reason; none without a solution.
    pub judgement: Option<Judgement>,
    /// The frame's camera, which the overlay draws; none for a suggestion that failed, see
    /// [`Frame::is_hopeless`].
    pub camera: Option<PtzCamera>,
    /// The camera that would result from the point that is being placed or named. While the camera
    /// has no base: the camera from four landmarks of this frame alone. Drawn dashed.
    pub preview: Option<PtzCamera>,
    /// The frame with the estimated base that waits for a decision, if there is one.
    pub proposal: Option<WithProposal>,
    /// The further clicks that would reduce the uncertainty most, best first.
    pub next_clicks: Vec<NextClick>,
    /// Whether the camera was set by hand; the clicks are then not solved.
    pub by_hand: bool,
    /// The indices of clicks that the other clicks or the estimate of the base contradict,
    /// ascending.
    pub disputed: Vec<usize>,
    /// Another camera of the document that fits the clicks, if the frame's own does not.
    pub better_camera: Option<BetterCamera>,
    /// The camera that another program gave for the frame, if mending replaced it.
    pub as_imported: Option<PtzCamera>,
    /// The disagreement with the neighbouring frames, if it exceeds the limit of [`disagrees`].
    pub off_neighbours: Option<Disagreement>,
    /// The data available for an estimate of the camera's base.
    pub readiness: BaseReadiness,
    basis: Basis,
}

/// The inputs of [`Current`]. A part whose inputs are unchanged is not recomputed.
#[derive(Debug, Default)]
struct Basis {
    /// The index of the frame and the version of the document; none at first.
    shown: Option<(usize, u64)>,
    /// The click of the preview.
    trial: Option<Trial>,
    /// The base of the proposal.
    proposed: Option<Arc<EstimatedBase>>,
}

/// A click that is being placed or named, as the preview solves it.
#[derive(Clone, Debug, PartialEq)]
struct Trial {
    click: Click,
    /// The index of the click that it replaces; none while it is being placed.
    replaced: Option<usize>,
}

/// The solution of a frame's clicks that was just recorded in the document, so that [`Current`]
/// need not compute it again.
#[derive(Debug)]
pub(in crate::app) struct FreshSolve {
    /// The index of the frame.
    pub frame: usize,
    /// The version of the document after the solution was recorded.
    pub version: u64,
    pub result: Result<FrameSolution, CalibrationError>,
}

impl Current {
    /// Recomputes whatever has outdated inputs: the values of the shown frame, the preview, the
    /// proposal.
    pub(in crate::app) fn refresh(
        &mut self,
        open: Option<&mut OpenProject>,
        session: &Session,
        fresh: Option<FreshSolve>,
        proposed: Option<&Arc<EstimatedBase>>,
    ) {
        let Some(open) = open else {
            *self = Self::default();
            return;
        };
        // Three parts with inputs of their own: a pointer that moves changes only the preview, and
        // a drag changes the frame many times a second.
        let shown = (session.frame, open.document.version());
        let changed = self.basis.shown != Some(shown);
        if changed {
            let fresh = fresh
                .filter(|fresh| (fresh.frame, fresh.version) == shown)
                .map(|fresh| fresh.result);
            *self = Self::compute(open, session.frame, fresh);
            self.basis.shown = Some(shown);
        }
        // Without a base the preview depends on the frame alone, not on the point that is being
        // placed.
        let trial = self
            .base
            .and_then(|_| trial(session, open.frame(session.frame)?));
        if changed || trial != self.basis.trial {
            self.preview = self.preview_camera(open, session.frame, trial.as_ref());
            self.basis.trial = trial;
        }
        // A different estimate is a different allocation.
        let is_same = proposed.map(Arc::as_ptr) == self.basis.proposed.as_ref().map(Arc::as_ptr);
        if changed || !is_same {
            self.proposal =
                proposed.and_then(|found| WithProposal::derive(open, session.frame, found));
            self.basis.proposed = proposed.cloned();
        }
    }

    /// Computes the values of a frame. Solves its clicks unless `fresh` is their solution.
    fn compute(
        open: &mut OpenProject,
        index: usize,
        fresh: Option<Result<FrameSolution, CalibrationError>>,
    ) -> Self {
        let field = open.field_of(index);
        let Some(frame) = open.document.frames.get(index) else {
            return Self {
                field: Some(field),
                ..Self::default()
            };
        };
        let base = open
            .document
            .camera_of(frame)
            .and_then(|camera| camera.base_for(frame));
        // Where the camera comes from: numbers set by hand, an alignment to paint, or the clicks.
        let by_hand = frame
            .solution
            .as_ref()
            .is_some_and(|solution| solution.source == Some(SolutionSource::Manual));
        let snapped = frame.solution.as_ref().filter(|_| frame.is_snapped());
        let corner_px = open.document.overlay_sigma(frame).map(|sigma| sigma.px);
        let snapped = snapped.map(|solution| judge_snapped(solution, corner_px, frame.image_size));
        let is_by_clicks = !by_hand
            && snapped.is_none()
            && frame.clicks.iter().any(|click| click.target.is_some());
        let solution = if is_by_clicks {
            fresh.or_else(|| open.solve(index))
        } else {
            None
        };
        // Looks for a better camera only if the solve suspects another one.
        let better_camera = match &solution {
            Some(Ok(solved))
                if solved
                    .warnings
                    .iter()
                    .any(|warning| warning.code == WarningCode::OtherCamera) =>
            {
                open.better_camera(index, solved)
            }
            _ => None,
        };
        // Fetched again, because the solve above needed the document for itself.
        let Some(frame) = open.document.frames.get(index) else {
            return Self::default();
        };
        let judgement = match &solution {
            Some(Ok(solved)) => Some(judge(solved, frame.image_size)),
            _ if snapped.is_some() => snapped,
            _ if by_hand => Some(Judgement {
                verdict: Verdict::Check,
                reason: "numbers set manually".to_owned(),
            }),
            _ => None,
        };
        // A frame may have clicks that have not been solved yet, so that it has no camera recorded.
        let camera = open
            .document
            .ptz_camera(frame)
            .filter(|_| !frame.is_hopeless())
            .or_else(|| Some(PtzCamera::new(base?, solution.as_ref()?.as_ref().ok()?.ptz)));
        // Computed only with the values that they need.
        let next_clicks = match (&field, &camera, &solution) {
            (Ok(field), Some(camera), Some(Ok(solved))) => {
                next_clicks(field, camera, solved, &frame.clicks, frame.image_size)
            }
            _ => Vec::new(),
        };
        let residuals = match (&field, &camera, &solution) {
            (Ok(field), Some(camera), None) => off_camera(frame, field, camera),
            _ => Vec::new(),
        };
        let off_neighbours = open
            .derived
            .disagreements(&open.document)
            .for_frame(index)
            .filter(disagrees);
        let readiness = open.derived.lookup(&open.document).readiness(&frame.camera);
        // Clicks that the estimate of the base found wrong, and those that this solve finds wrong.
        let mut disputed = frame
            .solution
            .as_ref()
            .map(|recorded| recorded.disputed.clone())
            .unwrap_or_default();
        if let Some(Ok(solved)) = &solution {
            disputed.extend(solved.disputed_clicks());
            disputed.sort_unstable();
            disputed.dedup();
        }
        let as_imported = camera_as_imported(frame, base.as_ref());
        let field = Some(field);
        Self {
            field,
            base,
            solution,
            residuals,
            judgement,
            camera,
            next_clicks,
            by_hand,
            disputed,
            better_camera,
            as_imported,
            off_neighbours,
            readiness,
            ..Self::default()
        }
    }

    /// The camera that would result with the trial click. Without a base: the camera from the
    /// frame's own landmarks.
    fn preview_camera(
        &self,
        open: &mut OpenProject,
        index: usize,
        trial: Option<&Trial>,
    ) -> Option<PtzCamera> {
        let (field, frame) = (self.field()?, open.frame(index)?);
        let Some(base) = self.base else {
            return camera_alone(&open.document, frame, field);
        };
        // Solve a copy of the frame that has the trial click: the document changes only when the
        // user places it.
        let trial = trial?;
        let mut with = frame.clone();
        match trial.replaced {
            Some(click) => *with.clicks.get_mut(click)? = trial.click.clone(),
            None => with.clicks.push(trial.click.clone()),
        }
        let solved = calibrate(
            &open.document,
            open.derived.lookup(&open.document),
            &with,
            field,
            index,
        )
        .ok()?;
        Some(PtzCamera::new(base, solved.ptz))
    }

    /// The field of the frame's camera, if its template and parameters are valid.
    pub fn field(&self) -> Option<&Arc<FieldModel>> {
        self.field.as_ref()?.as_ref().ok()
    }

    /// The solution from the clicks, if they determine a camera.
    pub fn click_solution(&self) -> Option<&FrameSolution> {
        self.solution.as_ref()?.as_ref().ok()
    }

    /// The residual of a click. None for check clicks of a solution from clicks, which are in
    /// [`FrameSolution::checks`].
    pub fn residual(&self, click: usize) -> Option<&ClickResidual> {
        let residuals = self
            .click_solution()
            .map_or(&self.residuals, |solved| &solved.residuals);
        residuals.iter().find(|residual| residual.click == click)
    }

    /// The frame's camera; without a base, the camera from its own landmarks.
    pub fn rough_camera(&self) -> Option<PtzCamera> {
        self.camera.or(self.preview.filter(|_| self.base.is_none()))
    }

    /// Other names of the clicks that fit better, or equally well.
    pub fn other_names(&self) -> Option<&IdentityFinding> {
        self.click_solution()?.identity.as_ref()
    }

    /// The camera for comparison: from other names, with the other focal length, or as it was
    /// imported.
    pub fn alternative(&self) -> Option<PtzCamera> {
        let other = self.other_names().map(|found| found.ptz);
        match other.or_else(|| self.other_root()) {
            Some(ptz) => Some(PtzCamera::new(self.base?, ptz)),
            None => self.as_imported,
        }
    }

    /// The second solution of a two-point solve, if there is one and it is plausible.
    pub fn other_root(&self) -> Option<Ptz> {
        self.click_solution()?
            .alternatives
            .first()
            .filter(|other| other.plausible)
            .map(|other| other.ptz)
    }
}

/// The camera that a frame was imported with, on a lens like that of its present base; none if the
/// frame has no record of it.
fn camera_as_imported(frame: &Frame, base: Option<&CameraBase>) -> Option<PtzCamera> {
    let imported = frame.solution.as_ref()?.imported.as_ref()?;
    let (base, ptz) = imported.on_base_of(base?);
    Some(PtzCamera::new(base, ptz))
}

/// The verdict on a camera that is aligned to painted lines. The alignment has been checked against
/// the paint before. If a confidence is recorded, it decides: the uncertainty at the worst corner,
/// `corner_px`, may be large although the camera is right, if no line is near that corner.
fn judge_snapped(solution: &Solution, corner_px: Option<f64>, size: ImageSize) -> Judgement {
    let limit_px = GOOD_CORNER_SIGMA_PX * size.scale_from_1920();
    let is_good = match solution.confidence {
        Some(confidence) => confidence >= CERTAIN,
        None => corner_px.is_some_and(|px| px <= limit_px),
    };
    // An imported document may state none of the numbers.
    let corner = corner_px
        .map(|px| format!("worst corner ±{px:.1} px; "))
        .unwrap_or_default();
    let samples = solution
        .samples
        .map(|samples| format!("{samples} points on "))
        .unwrap_or_default();
    let rms = solution
        .rms_px
        .map(|px| format!(" to {px:.1} px"))
        .unwrap_or_default();
    Judgement {
        verdict: if is_good {
            Verdict::Good
        } else {
            Verdict::Check
        },
        reason: format!("{corner}{samples}painted lines fit{rms}"),
    }
}

/// Distances of a frame's clicks from its camera. Empty if a click names something that the field
/// lacks.
fn off_camera(frame: &Frame, field: &FieldModel, camera: &PtzCamera) -> Vec<ClickResidual> {
    let clicks = observations(frame, field).unwrap_or_default();
    clicks
        .iter()
        .map(|click| ClickResidual::from_observation(camera, click))
        .collect()
}

/// The point that is being placed or named, if it is over the picture and has a name to try.
fn trial(session: &Session, frame: &Frame) -> Option<Trial> {
    match &session.mode {
        Mode::Placing(target) => Some(Trial {
            click: Click::new(target.clone(), session.points.hover?),
            replaced: None,
        }),
        // A name that another click has would make two clicks on one landmark: no trial.
        Mode::Naming(naming) => {
            let at = frame.clicks.get(naming.click)?.image;
            let chosen = naming.chosen().filter(|chosen| chosen.in_use.is_none())?;
            let click = Click::new(chosen.target.clone(), at);
            Some(Trial {
                click,
                replaced: Some(naming.click),
            })
        }
        _ => None,
    }
}
