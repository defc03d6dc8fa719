//! What follows from the document and the session for the frame that is shown: derived, never stored.

use super::OpenProject;
use super::base::WithProposal;
use super::naming::{self, NamingScene};
use super::next_click::{NextClick, next_clicks};
use super::session::{Mode, Naming, Session};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{FieldError, FieldModel};
use crate::geometry::ImagePoint;
use crate::project::{
    CalibrationError, Click, Frame, FramePtz, SolutionSource, Target, calibrate, camera_alone, observations,
    solved_neighbours,
};
use crate::solve::{FrameSolution, Judgement, Verdict, judge};
use std::sync::Arc;

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
    /// One word and its reason; none without a solution.
    pub judgement: Option<Judgement>,
    /// The camera as the frame has it pointed: what the overlay draws.
    pub camera: Option<PtzCamera>,
    /// The camera as it would be with what is being placed or named; while no base is known, the camera that four landmarks
    /// of this frame give by themselves. Drawn dashed.
    pub preview: Option<PtzCamera>,
    /// The frame with an estimated base that waits for a decision.
    pub proposal: Option<WithProposal>,
    /// Where a further click would gain most, the best first.
    pub next_clicks: Vec<NextClick>,
    /// Numbers by hand hold, and not what the clicks say.
    pub by_hand: bool,
}

impl Current {
    /// Solves the shown frame.
    pub(super) fn derive(open: Option<&mut OpenProject>, session: &Session) -> Self {
        let Some(open) = open else { return Self::default() };
        let index = session.frame;
        let field = open.field_of(index);
        let Some(frame) = open.document.frames.get(index) else {
            return Self { field: Some(field), ..Self::default() };
        };
        let base = open.document.camera_of(frame).and_then(|camera| camera.base_for(frame));
        let by_hand = frame.solution.as_ref().is_some_and(|solution| solution.source == Some(SolutionSource::Manual));
        let solution = match &field {
            Ok(field) if !by_hand && frame.clicks.iter().any(|click| click.target.is_some()) => {
                Some(calibrate(&open.document, frame, field, solved_neighbours(&open.document, index)))
            }
            _ => None,
        };
        let judgement = match &solution {
            Some(Ok(solved)) => Some(judge(solved, frame.image_size)),
            _ if by_hand => Some(Judgement { verdict: Verdict::Check, reason: "numbers set by hand".to_owned() }),
            _ => None,
        };
        // A document may hold clicks that nobody has solved yet.
        let from_clicks = || Some(PtzCamera::new(base?, solution.as_ref()?.as_ref().ok()?.ptz));
        let camera = open.document.pointed(frame).or_else(from_clicks);
        let preview = match &field {
            // Without a base the frame's own landmarks show what they can.
            Ok(field) => match &base {
                Some(base) => preview(open, session, frame, field, base),
                None => camera_alone(&open.document, frame, field),
            },
            Err(_) => None,
        };
        let found = session.base.proposed();
        let proposal = found.and_then(|found| WithProposal::derive(open, index, found));
        let next_clicks = match (&field, &camera, &solution) {
            (Ok(field), Some(camera), Some(Ok(solved))) => {
                next_clicks(field, camera, solved, &frame.clicks, frame.image_size)
            }
            _ => Vec::new(),
        };
        Self { field: Some(field), base, solution, judgement, camera, preview, proposal, next_clicks, by_hand }
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

    /// The other camera that fits two clicks as well, if there is one.
    #[must_use]
    pub fn other_root(&self) -> Option<Ptz> {
        self.solved()?.alternatives.first().filter(|other| other.plausible).map(|other| other.ptz)
    }
}

/// The frame's camera with the click that is being placed or named.
fn preview(
    open: &OpenProject,
    session: &Session,
    frame: &Frame,
    field: &FieldModel,
    base: &CameraBase,
) -> Option<PtzCamera> {
    let (click, replaced) = match &session.mode {
        Mode::Placing(target) => (Click::new(target.clone(), session.hover?), None),
        Mode::Naming(naming) => {
            let at = frame.clicks.get(naming.click)?.image;
            (Click::new(naming.chosen()?.target.clone(), at), Some(naming.click))
        }
        _ => return None,
    };
    let mut with = frame.clone();
    match replaced {
        Some(index) => *with.clicks.get_mut(index)? = click,
        None => with.clicks.push(click),
    }
    let solved = calibrate(&open.document, &with, field, solved_neighbours(&open.document, session.frame)).ok()?;
    Some(PtzCamera::new(*base, solved.ptz))
}

/// Ranks the names for a click of a frame.
pub(super) fn rank_names(open: &mut OpenProject, frame_index: usize, click: usize, lines: bool) -> Option<Naming> {
    let field = open.field_of(frame_index).ok()?;
    let frame = open.frame(frame_index)?;
    let at = frame.clicks.get(click)?.image;
    let mut others = frame.clone();
    others.clicks.remove(click);
    others.clicks.retain(|other| !other.check);
    let base = open.document.camera_of(frame).and_then(|camera| camera.base_for(frame));
    let neighbours = solved_neighbours(&open.document, frame_index);
    let named = observations(&others, &field).unwrap_or_default();
    // A frame that was proposed or set by hand has a camera too; clicks decide as soon as they can.
    let camera = calibrate(&open.document, &others, &field, neighbours.clone())
        .ok()
        .map(|solved| solved.ptz)
        .or_else(|| named.is_empty().then(|| frame.ptz.as_ref().map(FramePtz::ptz)).flatten())
        .zip(base)
        .map(|(ptz, base)| PtzCamera::new(base, ptz))
        .or_else(|| if base.is_none() { camera_alone(&open.document, &others, &field) } else { None });
    let scene = NamingScene {
        field: &field,
        image_size: frame.image_size,
        base: base.as_ref(),
        camera: camera.as_ref(),
        named: &named,
        taken: &taken_names(frame, click),
        neighbours: &neighbours,
        elsewhere: &solved_elsewhere(open, frame_index),
        neighbour_clicks: &remembered_clicks(open, frame_index),
    };
    let candidates = naming::candidates(&scene, at, lines);
    Some(Naming { click, candidates, typed: String::new(), lines, highlighted: 0 })
}

/// Where this camera looked in other shots: the solved frames nearest by number.
fn solved_elsewhere(open: &OpenProject, frame_index: usize) -> Vec<Ptz> {
    let Some(frame) = open.frame(frame_index) else { return Vec::new() };
    let wanted = |other: &Frame| other.camera == frame.camera && other.clip != frame.clip && other.ptz.is_some();
    let mut found = Vec::new();
    for forward in [false, true] {
        let mut at = frame_index;
        for _ in 0..ELSEWHERE {
            let Some(next) = open.find(at, forward, wanted) else { break };
            at = next;
            found.extend(open.frame(at).and_then(|frame| frame.ptz.as_ref()).map(FramePtz::ptz));
        }
    }
    found
}

fn taken_names(frame: &Frame, except: usize) -> Vec<Target> {
    let others = frame.clicks.iter().enumerate().filter(|(index, _)| *index != except);
    others.filter_map(|(_, click)| click.target.clone()).collect()
}

fn remembered_clicks(open: &OpenProject, frame_index: usize) -> Vec<(Target, ImagePoint)> {
    let Some(frame) = open.frame(frame_index) else { return Vec::new() };
    let labelled = |other: &Frame| other.camera == frame.camera && !other.clicks.is_empty();
    let mut clicks = Vec::new();
    for forward in [false, true] {
        let mut at = frame_index;
        for _ in 0..REMEMBERED_FRAMES {
            let Some(found) = open.find(at, forward, labelled) else { break };
            at = found;
            let named = open.frame(found).into_iter().flat_map(|frame| &frame.clicks);
            clicks.extend(named.filter_map(|click| Some((click.target.clone()?, click.image))));
        }
    }
    clicks
}
