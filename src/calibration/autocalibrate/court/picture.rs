//! The camera of one picture that shows enough of a court.

use super::grid::Grid;
use super::rectangles::cameras_of_rectangles;
use super::shown_lines::{Agreement, ShownLines};
use super::toned_markings::{TonedMarkings, weigh_tones};
use super::{CourtFrame, TriedLens, adjust_to_paint, adjust_to_places};
use crate::autocalibrate::adjustment::candidates::is_symmetric_by_half_turn;
use crate::evidence::Evidence;
use touchline_core::camera::{PtzCamera, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, median_high};
use touchline_core::solve::PlanePose;

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

/// Maximum of what speaks against a camera where it has lines, as a share of what speaks for it.
/// Right cameras have at most .07, wrong ones of as much evidence .04 to 1.
pub const MAX_CONTRADICTED: f64 = 0.04;

/// A picture decides by its lines for a camera of which it shows this share of them at least, whose
/// score is that much higher than the next one's, and which leaves no more foreign length, as a
/// share of what its lines show. On pictures of three tennis courts, a badminton and a pickleball
/// court the right camera's score is 1.4 to 1.9 times the best wrong one's.
const MIN_SHOWN: f64 = 0.6;
const MIN_LEAD: f64 = 1.25;
const MAX_FOREIGN: f64 = 0.25;

/// Minimum number of lines that it shows. Half a pickleball court can be taken for all of it by
/// five of its lines, which nothing contradicts; cameras that are right show eight and more.
const MIN_LINES: usize = 7;

/// Minimum evidence by the paint that confirms this, nats. On clay, cameras of lines longer than
/// there are collect more of it from scratches than the right one has.
const MIN_NATS: f64 = 100.0;

/// A picture decides by its evidence alone where this is as large, nats, and that much larger than
/// that of any other camera that is hardly contradicted. Wood has seams that leave no score by
/// lines: on ten pictures of two basketball courts right cameras have 476 to 654 nats, and the best
/// wrong one of any picture 233; on courts whose lines are clear no wrong one has such a lead.
const MIN_NATS_ALONE: f64 = 350.0;
const MIN_LEAD_IN_NATS: f64 = 2.0;
const MAX_CONTRADICTED_OF_OTHER: f64 = 0.1;

/// A camera that is first by lines and by evidence decides, too, where the product of both leads is
/// as large as the first of these; with the second it is preferred, and another picture may agree.
/// From the side, the long lines along a tennis court leave its right camera leads of 1.14 to 1.23,
/// and of 1.2 to 1.4 in evidence; the largest product of a wrong one was 1.29.
const MIN_LEADS_TOGETHER: f64 = 1.58;
const MIN_LEADS_TO_AGREE: f64 = 1.25;

/// Pictures agree on a camera where each alone has it at the same place, within this share of its
/// distance from the middle of the field, and shows the ground this far from where the other does,
/// px at 1920 px width. A wrong camera has another focal length, with which each direction of view
/// gives another place.
const SAME_PLACE_SHARE: f64 = 0.02;
const OTHER_VIEW_PX: f64 = 200.0;

/// How sure one picture is of its camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// It says nothing.
    None,
    /// It prefers the camera to others, and another picture may agree.
    Preferred,
    /// It decides alone.
    Decided,
}

/// A camera of one picture.
#[derive(Clone, Copy, Debug)]
pub struct PictureCamera {
    pub camera: PtzCamera,
    /// Its evidence.
    pub nats: f64,
    pub certainty: Certainty,
}

impl PictureCamera {
    /// Whether the picture decides, alone or as one of the others, which shows something else, has
    /// the same place on its own.
    pub fn is_decided(&self, others: &[Option<Self>], size: ImageSize) -> bool {
        // Two pictures of one view err alike: only another view is a second witness.
        let agrees = |other: &Self| {
            let place_m = self.camera.base().position_m;
            let off_m = (other.camera.base().position_m - place_m).norm();
            other.certainty != Certainty::None
                && off_m <= SAME_PLACE_SHARE * place_m.norm()
                && apart_px(&self.camera, &other.camera, size) >= OTHER_VIEW_PX
        };
        match self.certainty {
            Certainty::None => false,
            Certainty::Preferred => others.iter().flatten().any(agrees),
            Certainty::Decided => true,
        }
    }
}

/// A camera that was weighed.
struct Weighed {
    camera: PtzCamera,
    agreement: Agreement,
    evidence: Evidence,
}

impl Weighed {
    /// Whether its score by lines decides, where the next best is `next`.
    fn leads_by_lines(&self, next: Option<&Self>) -> bool {
        let next = next.map_or(0.0, |next| next.agreement.score());
        self.agreement.score() >= MIN_LEAD * next
            && self.agreement.num_lines() >= MIN_LINES
            && self.agreement.shown_share() >= MIN_SHOWN
            && self.agreement.foreign_share() <= MAX_FOREIGN
            && self.evidence.nats() >= MIN_NATS
            && self.evidence.contradicted_share() <= MAX_CONTRADICTED
    }

    /// What its leads by both say where it is first by lines and by evidence.
    fn certainty_by_both(&self, by_lines: Option<&Self>, by_evidence: Option<&Self>) -> Certainty {
        // A camera without a rival leads by any factor.
        let next_score = by_lines.map_or(0.0, |next| next.agreement.score().max(0.0));
        let next_nats = by_evidence.map_or(0.0, |next| next.evidence.nats().max(0.0));
        let (score, nats) = (self.agreement.score(), self.evidence.nats());
        let leads = |least: f64| score * nats >= least * next_score * next_nats;
        let is_likely = self.agreement.shown_share() >= MIN_SHOWN
            && nats >= MIN_NATS
            && self.evidence.contradicted_share() <= MAX_CONTRADICTED;
        let is_clear = self.agreement.num_lines() >= MIN_LINES
            && self.agreement.foreign_share() <= MAX_FOREIGN
            && nats >= MIN_NATS_ALONE;
        if is_likely && is_clear && leads(MIN_LEADS_TOGETHER) {
            Certainty::Decided
        } else if is_likely && leads(MIN_LEADS_TO_AGREE) {
            Certainty::Preferred
        } else {
            Certainty::None
        }
    }

    /// Whether its evidence decides, where the next best by it is `next`.
    fn leads_by_evidence(&self, next: Option<&Self>) -> bool {
        let next = next.map_or(0.0, |next| next.evidence.nats());
        self.evidence.nats() >= MIN_NATS_ALONE.max(MIN_LEAD_IN_NATS * next)
            && self.evidence.contradicted_share() <= MAX_CONTRADICTED
    }
}

/// The camera with a lens that explains a picture best; none where too few lines are shown.
pub fn camera_of_picture(
    frame: &CourtFrame,
    field: &FieldModel,
    lens: &StatedLens,
) -> Option<PictureCamera> {
    let shown = ShownLines {
        field,
        grid: &Grid::of(field),
        lines: &frame.lines,
        even: &frame.even,
        size: frame.ground.size(),
        lens: *lens,
    };
    let mut weighed = weigh_on_paint(cameras_on_lines(&shown), &shown, frame);
    weighed.sort_by(|a, b| b.agreement.score().total_cmp(&a.agreement.score()));
    let by_lines = weighed.first()?;
    let mut by_evidence: Vec<&Weighed> = weighed
        .iter()
        .filter(|one| one.evidence.contradicted_share() <= MAX_CONTRADICTED_OF_OTHER)
        .collect();
    by_evidence.sort_by(|a, b| b.evidence.nats().total_cmp(&a.evidence.nats()));
    let evident = by_evidence.first().copied();
    let next_evident = by_evidence.get(1).copied();
    // Lines and evidence are nearly independent, so leads in both multiply.
    let is_first_by_both = evident.is_some_and(|evident| std::ptr::eq(evident, by_lines));
    let (best, certainty) = match evident {
        _ if by_lines.leads_by_lines(weighed.get(1)) => (by_lines, Certainty::Decided),
        Some(best) if best.leads_by_evidence(next_evident) => (best, Certainty::Decided),
        _ if is_first_by_both => {
            let certainty = by_lines.certainty_by_both(weighed.get(1), next_evident);
            (by_lines, certainty)
        }
        _ => (by_lines, Certainty::None),
    };
    Some(PictureCamera {
        camera: usual_of_two(&best.camera, field),
        nats: best.evidence.nats(),
        certainty,
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
        let mut camera = pose.camera(shown.principal_point(), shown.lens.without_distortion());
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
    // One picture does not tell the principal point from the tilt.
    let lens = TriedLens {
        stated: shown.lens,
        is_guess: false,
    };
    let mut weighed: Vec<Weighed> = Vec::new();
    for mut camera in cameras {
        if weighed.len() == MAX_WEIGHED {
            break;
        }
        for _ in 0..ROUNDS_ON_PAINT {
            camera =
                adjust_to_paint(field, &[(frame, camera)], &lens).map_or(camera, |found| found[0]);
        }
        if weighed.iter().any(|other| is_same(&camera, &other.camera)) {
            continue;
        }
        let Some(agreement) = shown.compare(&pose_of(&camera)) else {
            continue;
        };
        let markings = TonedMarkings::detect(ground, field, &camera);
        weighed.push(Weighed {
            camera,
            agreement,
            evidence: weigh_tones(field, &[(camera, markings)]),
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

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::testing::turned_base;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// What a picture says of a camera beside a court.
    fn preferred(x_m: f64, pan_deg: f64) -> PictureCamera {
        let base = turned_base([x_m, -24.0, 9.0], [0.0, 0.0, 0.0], SIZE);
        PictureCamera {
            camera: PtzCamera::new(base, Ptz::from_degrees(pan_deg, -18.0, 1200.0)),
            nats: 500.0,
            certainty: Certainty::Preferred,
        }
    }

    #[test]
    fn pictures_that_show_different_views_from_one_place_decide_together() {
        let one = preferred(0.0, 0.0);
        let decided = |other: PictureCamera| one.is_decided(&[Some(one), Some(other), None], SIZE);
        assert!(decided(preferred(0.1, 12.0)));
        assert!(!decided(preferred(0.0, 1.0)), "the same view once more");
        assert!(!decided(preferred(2.0, 12.0)), "another place");
        let certainty = Certainty::None;
        let undecided = PictureCamera {
            certainty,
            ..preferred(0.1, 12.0)
        };
        assert!(!decided(undecided), "a picture that says nothing");
        assert!(!undecided.is_decided(&[Some(one)], SIZE));
    }
}
