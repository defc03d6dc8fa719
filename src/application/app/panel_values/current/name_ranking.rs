//! The ranking of names for the point that is being named, from what the frame's neighbours, its
//! own clicks and other shots say. The lists are gathered here; `naming` weighs them.

use crate::app::OpenProject;
use crate::app::window_state::corner_looks::CornerLooks;
use crate::app::window_state::naming::{self, NamingScene, NeighbourClick, TakenName};
use crate::app::window_state::session::Naming;
use touchline_calibration::calibrate::{calibrate, camera_alone, observations, solved_neighbours};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_documents::document::{Frame, FramePtz};

/// Number of solved frames of other shots, on either side, that serve as examples of where a camera
/// usually looks.
const NUM_OF_OTHER_SHOTS: usize = 20;

/// Number of labelled frames, on either side, that serve as examples of where names were clicked.
const REMEMBERED_FRAMES: usize = 3;

/// Ranks the possible names of a click. `contradicted` says that paint contradicts the frame's
/// camera, although the document does not record that yet. `looks` is how the clicked spot looks,
/// once that is known.
pub(in crate::app) fn rank_names(
    open: &mut OpenProject,
    frame_index: usize,
    click: usize,
    lines: bool,
    contradicted: bool,
    looks: Option<CornerLooks>,
) -> Option<Naming> {
    let field = open.field_of(frame_index).ok()?;
    let frame = open.document.frames.get(frame_index)?;
    let at = frame.clicks.get(click)?.image;
    // The other clicks of the frame, without the click itself and without check clicks.
    let mut others = frame.clone();
    others.clicks.remove(click);
    others.clicks.retain(|other| !other.check);
    let base = open
        .document
        .camera_of(frame)
        .and_then(|camera| camera.base_for(frame));
    // A click that the field lacks makes the observations invalid; the name is then ranked without
    // the other clicks.
    let neighbours = solved_neighbours(&open.document, frame_index);
    let named = observations(&others, &field).unwrap_or_default();
    // The frame's camera. First from the other clicks. If none of them is named, the proposed
    // camera or the one set by hand, unless it is doubtful. Without a base, from landmarks alone.
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
        other_shots: &ptz_in_other_shots(open, frame_index),
        neighbour_clicks: &neighbour_clicks(open, frame_index),
        looks: looks.as_ref(),
    };
    let candidates = naming::candidates(&scene, at, lines);
    Some(Naming {
        click,
        candidates,
        looks,
        refines: false,
        typed: String::new(),
        lines,
        highlighted: 0,
    })
}

/// The camera of a frame that comes from a proposal or was set by hand.
fn as_proposed_or_by_hand(frame: &Frame) -> Option<Ptz> {
    let proposed = frame.proposed_camera().map(|proposed| proposed.ptz);
    proposed.as_ref().or(frame.ptz.as_ref()).map(FramePtz::ptz)
}

/// The cameras of the nearest solved frames in other shots of the same camera.
fn ptz_in_other_shots(open: &OpenProject, frame_index: usize) -> Vec<Ptz> {
    let Some(frame) = open.frame(frame_index) else {
        return Vec::new();
    };
    nearest_on_both_sides(open, frame_index, NUM_OF_OTHER_SHOTS, |other| {
        vouches_in_other_shot(other, frame)
    })
    .into_iter()
    .filter_map(|at| Some(open.frame(at)?.ptz.as_ref()?.ptz()))
    .collect()
}

/// The indices of the nearest frames for which `wanted` is true: up to `most` before a frame, and
/// up to `most` after it.
fn nearest_on_both_sides(
    open: &OpenProject,
    frame_index: usize,
    most: usize,
    wanted: impl Fn(&Frame) -> bool,
) -> Vec<usize> {
    let mut found = Vec::new();
    for forward in [false, true] {
        let mut at = frame_index;
        for _ in 0..most {
            let Some(next) = open.find(at, forward, &wanted) else {
                break;
            };
            at = next;
            found.push(at);
        }
    }
    found
}

/// Whether a frame has a camera to go by and is in another shot of the same camera as `frame`.
fn vouches_in_other_shot(other: &Frame, frame: &Frame) -> bool {
    let is_elsewhere = other.camera == frame.camera && other.clip != frame.clip;
    is_elsewhere && other.ptz.is_some() && other.vouches()
}

/// The names of the frame's clicks other than `except`.
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

/// The named clicks of the nearest labelled frames of the same camera.
fn neighbour_clicks(open: &OpenProject, frame_index: usize) -> Vec<NeighbourClick> {
    let Some(frame) = open.frame(frame_index) else {
        return Vec::new();
    };
    let labelled = nearest_on_both_sides(open, frame_index, REMEMBERED_FRAMES, |other| {
        other.camera == frame.camera && !other.clicks.is_empty()
    });
    let frames = labelled.into_iter().filter_map(|at| open.frame(at));
    frames
        .flat_map(|frame| &frame.clicks)
        .filter_map(|click| {
            Some(NeighbourClick {
                target: click.target.clone()?,
                image: click.image,
            })
        })
        .collect()
}
