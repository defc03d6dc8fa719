//! The camera of one picture that shows enough of a court.

use super::grid::Grid;
use super::rectangles::cameras_of_rectangles;
use super::shown_lines::{Agreement, ShownLines};
use super::{CourtFrame, adjust_to_paint, adjust_to_places};
use crate::autocalibrate::adjustment::candidates::is_symmetric_by_half_turn;
use crate::evidence::Evidence;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, median_high};
use touchline_core::solve::PlanePose;
use touchline_vision::paint::{MarkingPixels, straight_lines};

/// Maximum number of cameras that are adjusted to the lines, and of those that are weighed.
const MAX_ADJUSTED: usize = 100;
const MAX_WEIGHED: usize = 12;

/// Cameras nearer to each other than this share of the field's length are adjusted once.
const APART_SHARE: f64 = 0.05;

/// Adjustments to the lines of the picture, and to the paint itself.
const ROUNDS_ON_LINES: usize = 3;
const ROUNDS_ON_PAINT: usize = 4;

/// Cameras whose pictures of the field differ by less than this are one answer, px at 1920 px
/// width.
const SAME_PX: f64 = 10.0;

/// Number of points in each direction of the picture at which two cameras are compared.
const COMPARED: u32 = 7;

/// A picture decides for a camera of which it shows this share of the lines at least, and whose
/// score by lines is that much higher than the next one's. On pictures of three tennis courts, a
/// badminton and a pickleball court the right camera's is 1.4 to 1.9 times the best wrong one's.
const MIN_SHOWN: f64 = 0.6;
const MIN_LEAD: f64 = 1.25;

/// Minimum number of lines that it shows. Half a pickleball court can be taken for all of it by
/// five of its lines, which nothing contradicts; cameras that are right show eight and more.
const MIN_LINES: usize = 7;

/// Minimum evidence by the paint, nats. It confirms, but does not choose: on clay, cameras of lines
/// longer than there are collect more of it from scratches.
const MIN_NATS: f64 = 100.0;

/// Maximum of what speaks against a camera where it has lines, as a share of what speaks for it,
/// and of the length of lines where the field has none, as a share of what its lines show. Right
/// cameras have at most .01 and .13, wrong ones .05 to .4 of the former.
pub const MAX_CONTRADICTED: f64 = 0.04;
const MAX_FOREIGN: f64 = 0.25;

/// A camera of one picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureCamera {
    pub camera: PtzCamera,
    /// By the lines of the picture ([`Agreement::score`]).
    pub score: f64,
    /// Whether the picture alone decides for it.
    pub is_decided: bool,
}

/// A camera that was weighed.
struct Weighed {
    camera: PtzCamera,
    agreement: Agreement,
    evidence: Evidence,
}

/// The camera that explains the lines of a picture best; none where too few lines are shown.
pub fn camera_of_picture(frame: &CourtFrame, field: &FieldModel) -> Option<PictureCamera> {
    let lines = straight_lines(&frame.ground);
    let shown = ShownLines {
        field,
        grid: &Grid::of(field),
        lines: &lines,
        size: frame.ground.size(),
        lens: frame.lens,
    };
    let mut weighed = weigh_on_paint(cameras_on_lines(&shown), &shown, frame);
    weighed.sort_by(|a, b| b.agreement.score().total_cmp(&a.agreement.score()));
    let Weighed {
        camera,
        agreement,
        evidence,
    } = weighed.first()?;
    let score = agreement.score();
    let next = weighed.get(1).map_or(0.0, |next| next.agreement.score());
    let is_decided = score >= MIN_LEAD * next
        && agreement.num_lines() >= MIN_LINES
        && agreement.shown_share() >= MIN_SHOWN
        && agreement.foreign_share() <= MAX_FOREIGN
        && evidence.nats() >= MIN_NATS
        && evidence.contradicted_share() <= MAX_CONTRADICTED;
    Some(PictureCamera {
        camera: usual_of_two(camera, field),
        score,
        is_decided,
    })
}

/// The cameras of rectangles, each from another place and adjusted to all lines that it has in
/// common with the picture; the best by these first.
fn cameras_on_lines(shown: &ShownLines<'_>) -> Vec<PtzCamera> {
    let mut found = cameras_of_rectangles(shown, |pose| Some(shown.compare(pose)?.score()));
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    let apart_m = APART_SHARE * shown.field.length_m;
    let mut apart: Vec<PlanePose> = Vec::new();
    for (pose, _) in found {
        let is_new = |other: &PlanePose| (other.position_m - pose.position_m).norm() > apart_m;
        if apart.len() < MAX_ADJUSTED && apart.iter().all(is_new) {
            apart.push(pose);
        }
    }
    let adjust = |pose: &PlanePose| {
        let mut camera = pose.camera(shown.principal_point());
        for _ in 0..ROUNDS_ON_LINES {
            let agreement = shown.compare(&pose_of(&camera))?;
            let places = shown.observations(&agreement);
            camera = adjust_to_places(shown.field, shown.size, (&camera, &shown.lens), places)?;
        }
        Some((camera, shown.compare(&pose_of(&camera))?.score()))
    };
    let mut adjusted: Vec<(PtzCamera, f64)> = apart.iter().filter_map(adjust).collect();
    adjusted.sort_by(|a, b| b.1.total_cmp(&a.1));
    adjusted.into_iter().map(|(camera, _)| camera).collect()
}

/// Adjusts cameras to the paint and weighs them, the first ones that show the field differently.
fn weigh_on_paint(
    cameras: Vec<PtzCamera>,
    shown: &ShownLines<'_>,
    frame: &CourtFrame,
) -> Vec<Weighed> {
    let (ground, field) = (&frame.ground, shown.field);
    let is_symmetric = is_symmetric_by_half_turn(field);
    let is_same = |one: &PtzCamera, other: &PtzCamera| {
        let is_near = |other: &PtzCamera| apart_px(one, other, shown.size) < SAME_PX;
        is_near(other) || (is_symmetric && is_near(&other.after_half_turn()))
    };
    let mut weighed: Vec<Weighed> = Vec::new();
    for mut camera in cameras {
        if weighed.len() == MAX_WEIGHED {
            break;
        }
        for _ in 0..ROUNDS_ON_PAINT {
            camera = adjust_to_paint(field, &[(frame, camera)]).map_or(camera, |found| found[0]);
        }
        if weighed.iter().any(|other| is_same(&camera, &other.camera)) {
            continue;
        }
        let Some(agreement) = shown.compare(&pose_of(&camera)) else {
            continue;
        };
        let markings = MarkingPixels::bright_on_court(ground, field, &camera);
        weighed.push(Weighed {
            camera,
            agreement,
            evidence: Evidence::weigh(field, &[(camera, &markings)]),
        });
    }
    weighed
}

/// Of a camera and the one opposite, from which a symmetric field looks the same, the one on the
/// side of the main stand or behind the left end.
fn usual_of_two(camera: &PtzCamera, field: &FieldModel) -> PtzCamera {
    let at = camera.base().position_m;
    let is_at_end = at.x.abs() * field.width_m > at.y.abs() * field.length_m;
    let is_opposite = if is_at_end { at.x > 0.0 } else { at.y > 0.0 };
    if is_opposite && is_symmetric_by_half_turn(field) {
        camera.after_half_turn()
    } else {
        *camera
    }
}

fn pose_of(camera: &PtzCamera) -> PlanePose {
    PlanePose {
        position_m: camera.base().position_m,
        cam_from_world: camera.cam_from_world(),
        focal_px: camera.ptz().focal_px,
    }
}

/// How far apart two cameras show the ground, px at 1920 px width: the median over a grid of the
/// picture. Infinite where one does not see what the other shows.
fn apart_px(one: &PtzCamera, other: &PtzCamera, size: ImageSize) -> f64 {
    let distances = size.cell_centres(COMPARED, COMPARED).filter_map(|at| {
        let ground = one.plane_from_image(at, 0.0)?;
        let there = other.image_from_world(ground);
        Some(there.map_or(f64::INFINITY, |there| there.distance_px(at)))
    });
    let median_px = median_high(&mut distances.collect::<Vec<f64>>());
    median_px.map_or(f64::INFINITY, |px| px / size.scale_from_1920())
}
