//! What follows from the document and the session for the frame that is shown: derived, never
//! stored.

use super::OpenProject;
use super::naming::{self, NamingScene, NeighbourClick, TakenName};
use super::proposed_base::WithProposal;
use super::review::disagrees;
use super::session::{Mode, Naming, Session};
use crate::scene::next_click::{NextClick, next_clicks};
use std::sync::Arc;
use touchline_calibration::calibrate::{
    BaseReadiness, BetterCamera, CalibrationError, Disagreement, EstimatedBase, calibrate,
    camera_alone, observations, solved_neighbours,
};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::{
    ClickResidual, FrameSolution, GOOD_CORNER_SIGMA_PX, IdentityFinding, Judgement, Verdict,
    WarningCode, judge,
};
use touchline_documents::document::{Click, Frame, FramePtz, Solution, SolutionSource};
use touchline_vision::relocalize::CERTAIN;

/// How many solved frames of other shots, on either side, tell where a camera usually looks.
const ELSEWHERE: usize = 20;
/// How many labelled frames around are asked what was clicked there.
const REMEMBERED_FRAMES: usize = 3;

/// The shown frame, solved.
#[derive(Debug, Default)]
pub struct Current {
    /// The field of the frame's camera.
    pub field: Option<Result<Arc<FieldModel>, FieldError>>,
    /// The base of the frame's camera, if known.
    pub base: Option<CameraBase>,
    /// What the clicks say; none if there is nothing to solve yet.
    pub solution: Option<Result<FrameSolution, CalibrationError>>,
    /// Where the clicks lie as seen from a camera that does not come from them: snapped, proposed,
    /// set manually.
    pub residuals: Vec<ClickResidual>,
    /// One word and its reason; none without a solution.
    pub judgement: Option<Judgement>,
    /// The camera as the frame has it pointed, unless it is a suggestion that does not hold: what
    /// the overlay draws.
    pub camera: Option<PtzCamera>,
    /// The camera as it would be with what is being placed or named; while no base is known, the
    /// camera that four landmarks of this frame give by themselves. Drawn dashed.
    pub preview: Option<PtzCamera>,
    /// The frame with an estimated base that waits for a decision.
    pub proposal: Option<WithProposal>,
    /// Where a further click would gain most, the best first.
    pub next_clicks: Vec<NextClick>,
    /// Numbers by hand hold, and not what the clicks say.
    pub by_hand: bool,
    /// The clicks that something contradicts: the other clicks, or the estimate of the base; in
    /// order.
    pub disputed: Vec<usize>,
    /// Another camera of the document, which fits the clicks where the frame's own does not.
    pub better_camera: Option<BetterCamera>,
    /// How the frame lies to its neighbours, where it disagrees with them.
    pub off_neighbours: Option<Disagreement>,
    /// What the frames of this camera say about its base.
    pub readiness: BaseReadiness,
    basis: Basis,
}

/// What [`Current`] was derived from: what has not changed is not derived again.
#[derive(Debug, Default)]
struct Basis {
    /// The frame's place and the document's version; none before anything was derived.
    shown: Option<(usize, u64)>,
    /// The click that the preview is for.
    trial: Option<Trial>,
    /// The base that the proposal shows.
    proposed: Option<Arc<EstimatedBase>>,
}

/// A click that is being placed or named, as the preview has it.
#[derive(Clone, Debug, PartialEq)]
struct Trial {
    click: Click,
    /// The click of the frame that it stands for; none while it is being placed.
    replaced: Option<usize>,
}

/// What a frame's clicks gave when they were solved to be recorded: it need not be found again.
#[derive(Debug)]
pub(super) struct FreshSolve {
    /// Which frame.
    pub frame: usize,
    /// The document's version once it was recorded.
    pub version: u64,
    /// What the clicks gave.
    pub result: Result<FrameSolution, CalibrationError>,
}

impl Current {
    /// Derives what has changed since the last time: the shown frame, what is being placed, what is
    /// proposed.
    pub(super) fn refresh(
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
        let shown = (session.frame, open.document.version());
        let changed = self.basis.shown != Some(shown);
        if changed {
            let fresh = fresh
                .filter(|fresh| (fresh.frame, fresh.version) == shown)
                .map(|fresh| fresh.result);
            *self = Self::of_frame(open, session.frame, fresh);
            self.basis.shown = Some(shown);
        }
        // Without a base the preview is the frame's own, whatever is being placed.
        let trial = self
            .base
            .and_then(|_| trial(session, open.frame(session.frame)?));
        if changed || trial != self.basis.trial {
            self.preview = self.previewed(open, session.frame, trial.as_ref());
            self.basis.trial = trial;
        }
        let same = match (proposed, &self.basis.proposed) {
            (Some(now), Some(before)) => Arc::ptr_eq(now, before),
            (now, before) => now.is_none() && before.is_none(),
        };
        if changed || !same {
            self.proposal =
                proposed.and_then(|found| WithProposal::derive(open, session.frame, found));
            self.basis.proposed = proposed.cloned();
        }
    }

    /// Solves a frame, unless it has just been.
    fn of_frame(
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
        let by_hand = frame
            .solution
            .as_ref()
            .is_some_and(|solution| solution.source == Some(SolutionSource::Manual));
        let snapped = frame.solution.as_ref().filter(|_| frame.is_snapped());
        let snapped = snapped.map(|solution| judge_snapped(solution, frame.image_size));
        let asked = !by_hand
            && snapped.is_none()
            && frame.clicks.iter().any(|click| click.target.is_some());
        let solution = if asked {
            fresh.or_else(|| open.solve(index))
        } else {
            None
        };
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
        // A document may hold clicks that nobody has solved yet.
        let from_clicks = || Some(PtzCamera::new(base?, solution.as_ref()?.as_ref().ok()?.ptz));
        let pointed = open
            .document
            .pointed(frame)
            .filter(|_| !frame.is_hopeless());
        let camera = pointed.or_else(from_clicks);
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
            .of_frame(index)
            .filter(disagrees);
        let readiness = open.derived.lookup(&open.document).readiness(&frame.camera);
        let mut disputed = frame
            .solution
            .as_ref()
            .map(|recorded| recorded.disputed.clone())
            .unwrap_or_default();
        if let Some(Ok(solved)) = &solution {
            disputed.extend(solved.disputed());
            disputed.sort_unstable();
            disputed.dedup();
        }
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
            off_neighbours,
            readiness,
            ..Self::default()
        }
    }

    /// The frame's camera with a click that is being placed or named; without a base, what its own
    /// landmarks show.
    fn previewed(
        &self,
        open: &mut OpenProject,
        index: usize,
        trial: Option<&Trial>,
    ) -> Option<PtzCamera> {
        let (field, frame) = (self.field()?, open.frame(index)?);
        let Some(base) = self.base else {
            return camera_alone(&open.document, frame, field);
        };
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

    /// The field, if its template and parameters are valid.
    #[must_use]
    pub fn field(&self) -> Option<&Arc<FieldModel>> {
        self.field.as_ref()?.as_ref().ok()
    }

    /// What the clicks say, if they give a camera.
    #[must_use]
    pub fn solved(&self) -> Option<&FrameSolution> {
        self.solution.as_ref()?.as_ref().ok()
    }

    /// Where a click lies as seen from the frame's camera; none for check clicks of a solution from
    /// clicks, which
    /// [`FrameSolution::checks`] has.
    #[must_use]
    pub fn residual(&self, click: usize) -> Option<&ClickResidual> {
        let residuals = self
            .solved()
            .map_or(&self.residuals, |solved| &solved.residuals);
        residuals.iter().find(|residual| residual.click == click)
    }

    /// The frame's camera; while no base is known, the one that its own landmarks show.
    #[must_use]
    pub fn rough_camera(&self) -> Option<PtzCamera> {
        self.camera.or(self.preview.filter(|_| self.base.is_none()))
    }

    /// Names that fit the clicks better, or as well.
    #[must_use]
    pub fn other_names(&self) -> Option<&IdentityFinding> {
        self.solved()?.identity.as_ref()
    }

    /// The camera to compare with: under other names, or with the other focal length.
    #[must_use]
    pub fn alternative(&self) -> Option<PtzCamera> {
        let ptz = self
            .other_names()
            .map(|found| found.ptz)
            .or_else(|| self.other_root())?;
        Some(PtzCamera::new(self.base?, ptz))
    }

    /// The other camera that fits two clicks as well, if there is one.
    #[must_use]
    pub fn other_root(&self) -> Option<Ptz> {
        self.solved()?
            .alternatives
            .first()
            .filter(|other| other.plausible)
            .map(|other| other.ptz)
    }
}

/// The verdict on a camera that lies on the painted lines: they bear it out, or it would not have
/// been taken. Where it states how certain it is that word decides: the worst corner of a picture
/// may lie far from every line.
fn judge_snapped(solution: &Solution, size: ImageSize) -> Judgement {
    let corner_px = solution.worst_corner_sigma_px.unwrap_or(f64::INFINITY);
    let is_good = match solution.confidence {
        Some(confidence) => confidence >= CERTAIN,
        None => corner_px <= GOOD_CORNER_SIGMA_PX * size.scale_from_1920(),
    };
    let samples = solution.samples.unwrap_or(0);
    let rms = solution
        .rms_px
        .map(|px| format!(" to {px:.1} px"))
        .unwrap_or_default();
    let reason =
        format!("worst corner ±{corner_px:.1} px; {samples} points on painted lines fit{rms}");
    Judgement {
        verdict: if is_good {
            Verdict::Good
        } else {
            Verdict::Check
        },
        reason,
    }
}

/// Where the clicks of a frame lie as seen from its camera; nothing where one names what the field
/// lacks.
fn off_camera(frame: &Frame, field: &FieldModel, camera: &PtzCamera) -> Vec<ClickResidual> {
    let clicks = observations(frame, field).unwrap_or_default();
    clicks
        .iter()
        .map(|click| ClickResidual::of(camera, click))
        .collect()
}

/// What is being placed or named, if it is on the picture and has a name to try.
fn trial(session: &Session, frame: &Frame) -> Option<Trial> {
    match &session.mode {
        Mode::Placing(target) => Some(Trial {
            click: Click::new(target.clone(), session.points.hover?),
            replaced: None,
        }),
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

/// Ranks the names for a click of a frame. `contradicted`: paint that is not recorded yet speaks
/// against the frame's camera.
pub(super) fn rank_names(
    open: &mut OpenProject,
    frame_index: usize,
    click: usize,
    lines: bool,
    contradicted: bool,
) -> Option<Naming> {
    let field = open.field_of(frame_index).ok()?;
    let frame = open.document.frames.get(frame_index)?;
    let at = frame.clicks.get(click)?.image;
    let mut others = frame.clone();
    others.clicks.remove(click);
    others.clicks.retain(|other| !other.check);
    let base = open
        .document
        .camera_of(frame)
        .and_then(|camera| camera.base_for(frame));
    let neighbours = solved_neighbours(&open.document, frame_index);
    let named = observations(&others, &field).unwrap_or_default();
    // A frame that was proposed or set by hand has a camera too; clicks decide as soon as they can.
    let camera = calibrate(
        &open.document,
        open.derived.lookup(&open.document),
        &others,
        &field,
        frame_index,
    )
    .ok()
    .map(|solved| solved.ptz)
    .or_else(|| {
        as_proposed_or_by_hand(frame)
            .filter(|_| named.is_empty() && frame.vouches() && !contradicted)
    })
    .zip(base)
    .map(|(ptz, base)| PtzCamera::new(base, ptz))
    .or_else(|| {
        if base.is_none() {
            camera_alone(&open.document, &others, &field)
        } else {
            None
        }
    });
    let scene = NamingScene {
        field: &field,
        image_size: frame.image_size,
        base: base.as_ref(),
        camera: camera.as_ref(),
        named: &named,
        taken: &taken_names(frame, click),
        neighbours: &neighbours,
        other_shots: &solved_elsewhere(open, frame_index),
        neighbour_clicks: &remembered_clicks(open, frame_index),
    };
    let candidates = naming::candidates(&scene, at, lines);
    Some(Naming {
        click,
        candidates,
        refines: false,
        typed: String::new(),
        lines,
        highlighted: 0,
    })
}

/// The camera of a frame that does not come from its clicks.
fn as_proposed_or_by_hand(frame: &Frame) -> Option<Ptz> {
    let proposed = frame.proposed().map(|proposed| proposed.ptz);
    proposed.as_ref().or(frame.ptz.as_ref()).map(FramePtz::ptz)
}

/// Where this camera looked in other shots: the solved frames nearest by number.
fn solved_elsewhere(open: &OpenProject, frame_index: usize) -> Vec<Ptz> {
    let Some(frame) = open.frame(frame_index) else {
        return Vec::new();
    };
    let is_elsewhere = |other: &Frame| other.camera == frame.camera && other.clip != frame.clip;
    let wanted = |other: &Frame| is_elsewhere(other) && other.ptz.is_some() && other.vouches();
    let mut found = Vec::new();
    for forward in [false, true] {
        let mut at = frame_index;
        for _ in 0..ELSEWHERE {
            let Some(next) = open.find(at, forward, wanted) else {
                break;
            };
            at = next;
            found.extend(
                open.frame(at)
                    .and_then(|frame| frame.ptz.as_ref())
                    .map(FramePtz::ptz),
            );
        }
    }
    found
}

fn taken_names(frame: &Frame, except: usize) -> Vec<TakenName> {
    let others = frame
        .clicks
        .iter()
        .enumerate()
        .filter(|(index, _)| *index != except);
    others
        .filter_map(|(index, click)| {
            Some(TakenName {
                target: click.target.clone()?,
                click: index,
            })
        })
        .collect()
}

fn remembered_clicks(open: &OpenProject, frame_index: usize) -> Vec<NeighbourClick> {
    let Some(frame) = open.frame(frame_index) else {
        return Vec::new();
    };
    let labelled = |other: &Frame| other.camera == frame.camera && !other.clicks.is_empty();
    let mut clicks = Vec::new();
    for forward in [false, true] {
        let mut at = frame_index;
        for _ in 0..REMEMBERED_FRAMES {
            let Some(found) = open.find(at, forward, labelled) else {
                break;
            };
            at = found;
            let named = open
                .frame(found)
                .into_iter()
                .flat_map(|frame| &frame.clicks);
            let neighbour_click = |click: &Click| {
                Some(NeighbourClick {
                    target: click.target.clone()?,
                    image: click.image,
                })
            };
            clicks.extend(named.filter_map(neighbour_click));
        }
    }
    clicks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, App, Opened, Settings};
    use touchline_core::camera::BaseAngles;
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
    use touchline_documents::document::{Camera, Document, FieldSpec, Target};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn pointed() -> PtzCamera {
        let base = CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        );
        PtzCamera::new(base, Ptz::from_degrees(0.0, -12.0, 1000.0))
    }

    fn image_of(landmark: &str) -> ImagePoint {
        let field = touchline_core::field::builtin("soccer")
            .unwrap()
            .default_model()
            .unwrap();
        pointed()
            .image_from_world(field.landmark_in_world(field.landmark(landmark).unwrap()))
            .unwrap()
    }

    /// A frame with two clicks, solved.
    fn project() -> OpenProject {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(pointed().base());
        document.cameras.push(camera.into());
        let mut frame = Frame::from_image("0.jpg", "main".into(), SIZE);
        frame.clicks = ["centre_mark", "halfway_far"]
            .map(|id| Click::landmark(id.into(), image_of(id)))
            .into_iter()
            .collect();
        document.frames.push(frame.into());
        OpenProject::new(
            document,
            "/match/project.json".into(),
            "/match".into(),
            None,
        )
    }

    /// Whether the frame is solved anew by a refresh: a mark left in what was derived is gone then.
    fn derives(current: &mut Current, open: &mut OpenProject, session: &Session) -> bool {
        current.readiness.left_out = 99;
        current.refresh(Some(open), session, None, None);
        current.readiness.left_out != 99
    }

    #[test]
    fn only_what_changed_is_derived_again() {
        let (mut open, mut session, mut current) =
            (project(), Session::default(), Current::default());
        assert!(derives(&mut current, &mut open, &session));
        assert!(current.solved().is_some());
        session.points.hover = Some(SIZE.centre());
        session.picture.fit_scale = 0.5;
        session.points.selected = Some(1);
        assert!(
            !derives(&mut current, &mut open, &session),
            "nothing that the frame's camera rests on has changed"
        );
        open.document.frames[0].clicks[0].check = true;
        assert!(derives(&mut current, &mut open, &session));
        assert!(current.solved().is_none(), "one click is not enough");
    }

    #[test]
    fn the_preview_follows_the_pointer_and_the_frame_stays_solved() {
        let (mut open, mut session, mut current) =
            (project(), Session::default(), Current::default());
        current.refresh(Some(&mut open), &session, None, None);
        session.mode = Mode::Placing(Target::Landmark("centre_circle_left".into()));
        session.points.hover = Some(image_of("centre_circle_left"));
        assert!(!derives(&mut current, &mut open, &session));
        let first = current.preview.unwrap().ptz();
        session.points.hover = session
            .points
            .hover
            .map(|at| ImagePoint::new(at.x + 20.0, at.y));
        assert!(!derives(&mut current, &mut open, &session));
        assert_ne!(current.preview.unwrap().ptz(), first);
        session.points.hover = None;
        current.refresh(Some(&mut open), &session, None, None);
        assert!(current.preview.is_none());
    }

    #[test]
    fn what_was_just_solved_is_not_solved_again() {
        let (mut open, session, mut current) = (project(), Session::default(), Current::default());
        let given = Err(CalibrationError::UnknownCamera {
            camera: "told".to_owned(),
        });
        let fresh = |version| FreshSolve {
            frame: 0,
            version,
            result: given.clone(),
        };
        let version = open.document.version();
        current.refresh(Some(&mut open), &session, Some(fresh(version)), None);
        assert_eq!(
            current
                .solution
                .as_ref()
                .and_then(|solution| solution.as_ref().err()),
            given.as_ref().err()
        );
        open.document.frames[0].comment = Some("rain".to_owned());
        current.refresh(Some(&mut open), &session, Some(fresh(version)), None);
        assert!(current.solved().is_some(), "the document has changed since");
    }

    #[test]
    fn another_document_is_derived_although_its_version_is_the_same() {
        let mut app = App::new(Settings::default());
        let mut empty = project().document.clone();
        empty.frames[0].clicks.clear();
        for (document, solved) in [(project().document.clone(), true), (empty, false)] {
            app.update(Action::Opened(Box::new(Opened::new(
                document,
                "/match/project.json",
            ))));
            assert_eq!(app.current().solved().is_some(), solved);
        }
    }
}
