//! Which landmark or line a click probably shows.
//!
//! Candidates are ranked by the frame's solution where there is one; else by solving with each candidate as the second
//! point and comparing the camera with the frames around, or with where it looked in other shots; else by where those
//! frames would put the landmarks; else by what was clicked near here in the frames around.

use crate::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use crate::document::Target;
use crate::field::FieldModel;
use crate::geometry::{Angle, AngleRange, ImagePoint, ImageSize, Vec3};
use crate::markings::{self, MarkingOptions};
use crate::solve::{Observation, PtzRanges, SolveContext, solve_frame};

/// A name that is this near (px at 1920 px width) by the frame's own solution is plausible.
const NEAR_PX: f64 = 16.0;
/// A frame's neighbours vouch for a name whose camera differs by less than this (see [`motion`]).
const NEAR_MOTION: f64 = 1.0;
/// A name is certain if the next one is this many times farther off.
const CLEARLY: f64 = 3.0;

/// A name that a click may get.
#[derive(Clone, Debug, PartialEq)]
pub struct NameCandidate {
    /// What it shows.
    pub target: Target,
    /// What a person reads.
    pub label: String,
    /// What a person types.
    pub code: String,
    /// How far from the click this lies by the frame's solution, or by its neighbours', px; none where neither says.
    pub distance_px: Option<f64>,
    /// The frame's camera if this name is right; none where it cannot be told yet.
    pub ptz: Option<Ptz>,
    /// The other click of the frame that has this name already.
    pub in_use: Option<usize>,
    /// Nothing painted marks it and no camera is known yet: it is only offered to whoever types it.
    pub hidden: bool,
    score: f64,
    plausible: bool,
}

/// What is known of the frame when a click asks for its name.
pub struct NamingScene<'a> {
    /// The field.
    pub field: &'a FieldModel,
    /// The frame's size.
    pub image_size: ImageSize,
    /// The camera's base, if known.
    pub base: Option<&'a CameraBase>,
    /// The frame's camera from its other clicks, if they suffice.
    pub camera: Option<&'a PtzCamera>,
    /// The other named clicks of the frame.
    pub named: &'a [Observation],
    /// Names that other clicks of this frame have.
    pub taken: &'a [(Target, usize)],
    /// Cameras of the frames around, nearest first.
    pub neighbours: &'a [Ptz],
    /// Cameras of solved frames in other shots: where this camera usually looks.
    pub elsewhere: &'a [Ptz],
    /// Clicks of the nearest labelled frames.
    pub neighbour_clicks: &'a [(Target, ImagePoint)],
}

/// Every name that a click at `at` may get, best first: landmarks, or with `lines` the lines.
#[must_use]
pub fn candidates(scene: &NamingScene<'_>, at: ImagePoint, lines: bool) -> Vec<NameCandidate> {
    let mut found = if lines { line_candidates(scene, at) } else { landmark_candidates(scene, at) };
    found.sort_by(|a, b| b.plausible.cmp(&a.plausible).then(a.score.total_cmp(&b.score)));
    found
}

/// The one name that is plausible, if there is just one.
#[must_use]
pub fn certain(candidates: &[NameCandidate]) -> Option<&NameCandidate> {
    let best = candidates.first().filter(|best| best.plausible)?;
    let clear = candidates.get(1).is_none_or(|next| !next.plausible && next.score > CLEARLY * best.score.max(0.33));
    clear.then_some(best)
}

/// The candidates whose label or code matches what was typed: a code's beginning first, then words' beginnings. While nothing is
/// typed, names in use and hidden ones are left out.
#[must_use]
pub fn matching<'a>(candidates: &'a [NameCandidate], typed: &str) -> Vec<&'a NameCandidate> {
    let typed = typed.trim().to_lowercase();
    if typed.is_empty() {
        return candidates.iter().filter(|candidate| candidate.in_use.is_none() && !candidate.hidden).collect();
    }
    let rank = |candidate: &NameCandidate| {
        let (code, label) = (candidate.code.to_lowercase(), candidate.label.to_lowercase());
        let words_match = typed.split_whitespace().all(|typed| {
            label.split(|c: char| !c.is_alphanumeric()).any(|word| !word.is_empty() && word.starts_with(typed))
        });
        match () {
            () if code == typed => Some(0),
            () if code.starts_with(&typed) => Some(1),
            () if words_match => Some(2),
            () => None,
        }
    };
    let mut ranked: Vec<_> = candidates.iter().filter_map(|candidate| Some((rank(candidate)?, candidate))).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, candidate)| candidate).collect()
}

fn landmark_candidates(scene: &NamingScene<'_>, at: ImagePoint) -> Vec<NameCandidate> {
    let near_px = NEAR_PX * scene.image_size.scale_from_1920();
    let untold = scene.neighbours.first().zip(scene.base).map(|(ptz, base)| PtzCamera::new(*base, *ptz));
    scene
        .field
        .landmarks
        .iter()
        .map(|landmark| (landmark, Target::Landmark(landmark.id.clone())))
        .map(|(landmark, target)| {
            let in_use = scene.taken.iter().find(|(taken, _)| *taken == target).map(|(_, click)| *click);
            let world = scene.field.landmark_in_world(landmark);
            let distance = |camera: &PtzCamera| camera.image_from_world(world).ok().map(|image| image.distance_px(at));
            let mut candidate = NameCandidate {
                target,
                label: landmark.label.clone(),
                code: landmark.code.clone(),
                distance_px: None,
                ptz: None,
                in_use,
                hidden: landmark.is_unmarked && scene.base.is_none(),
                score: f64::INFINITY,
                plausible: false,
            };
            if in_use.is_some() || candidate.hidden {
                return candidate;
            }
            if let Some(camera) = scene.camera {
                candidate.distance_px = distance(camera);
                candidate.score = candidate.distance_px.map_or(f64::INFINITY, |px| px / near_px);
                candidate.plausible = candidate.score <= 1.0;
            } else if let Some(base) = scene.base.filter(|_| !scene.named.is_empty()) {
                let observation =
                    Observation::of_landmark(scene.field, landmark.id.as_str(), at, scene.image_size, usize::MAX);
                if let Some((ptz, score)) = observation.ok().and_then(|last| solve_with(scene, base, last)) {
                    candidate.ptz = Some(ptz);
                    candidate.score = score;
                    candidate.plausible = !scene.neighbours.is_empty() && score <= NEAR_MOTION;
                }
            } else if let Some(camera) = &untold {
                candidate.distance_px = distance(camera);
                candidate.score = candidate.distance_px.map_or(f64::INFINITY, |px| 2.0 + px / near_px);
            } else if let Some(px) = usual_distance_px(scene, at, world) {
                candidate.score = 4.0 + px / near_px;
            } else {
                candidate.score = remembered(scene, &candidate.target, at).unwrap_or(1e3 + landmark.click_sigma_px);
            }
            candidate
        })
        .collect()
}

fn line_candidates(scene: &NamingScene<'_>, at: ImagePoint) -> Vec<NameCandidate> {
    let near_px = NEAR_PX * scene.image_size.scale_from_1920();
    let told = scene.camera.is_some();
    let camera = scene
        .camera
        .copied()
        .or_else(|| scene.neighbours.first().zip(scene.base).map(|(ptz, base)| PtzCamera::new(*base, *ptz)));
    let drawn = camera
        .map(|camera| markings::project_lines(scene.field, &camera, scene.image_size, &MarkingOptions::default()));
    scene
        .field
        .lines
        .iter()
        .enumerate()
        .map(|(index, line)| {
            let target = Target::Line(line.id.clone());
            let distance_px = drawn.as_ref().and_then(|drawn| {
                drawn
                    .iter()
                    .filter(|marking| marking.line == index)
                    .flat_map(|marking| {
                        marking.points.windows(2).map(|ends| at.distance_from_segment_px(ends[0], ends[1]))
                    })
                    .min_by(f64::total_cmp)
            });
            let score = match distance_px {
                Some(px) => px / near_px,
                None => remembered(scene, &target, at).map_or(1e6, |score| 1e3 + score),
            };
            NameCandidate {
                plausible: told && score <= 1.0,
                target,
                label: line.label.clone(),
                code: line.code.clone(),
                distance_px,
                ptz: None,
                in_use: None,
                hidden: false,
                score,
            }
        })
        .collect()
}

/// The camera if the click is `last`, and how far it is from what the frames around do.
fn solve_with(scene: &NamingScene<'_>, base: &CameraBase, last: Observation) -> Option<(Ptz, f64)> {
    let observations: Vec<_> = scene.named.iter().copied().chain([last]).collect();
    let context = SolveContext { neighbours: scene.neighbours.to_vec(), ..SolveContext::new(scene.image_size) };
    let solved = solve_frame(base, &observations, &context).ok()?;
    let score = match scene.neighbours.first() {
        Some(neighbour) => motion(neighbour, &solved.ptz, scene.image_size),
        None if !scene.elsewhere.is_empty() => {
            let usual = scene.elsewhere.iter().map(|other| motion(other, &solved.ptz, scene.image_size));
            1.0 + usual.min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
        }
        None if PtzRanges::for_width(scene.image_size.width).contains(&solved.ptz) => {
            1.0 + unusual(&solved.ptz, base, scene.image_size)
        }
        None => 1e3,
    };
    Some((solved.ptz, score + solved.misfit().map_or(0.0, |misfit| (misfit - 1.0).max(0.0))))
}

/// How far one camera is from another: 1 is a third of the picture's width, or a zoom by a fifth.
fn motion(from: &Ptz, to: &Ptz, image_size: ImageSize) -> f64 {
    let third = f64::from(image_size.width) / 3.0;
    let pan = to.pan.turn_from(from.pan).radians() * from.focal_px / third;
    let tilt = to.tilt.turn_from(from.tilt).radians() * from.focal_px / third;
    let zoom = (to.focal_px / from.focal_px).ln() / 1.2_f64.ln();
    pan.hypot(2.0 * tilt).hypot(zoom)
}

/// How far a camera is from an ordinary broadcast view: pan within 60° of the field's centre, wherever the camera stands, tilt
/// between −25° and −3°, focal length 0.8 to 4 widths.
fn unusual(ptz: &Ptz, base: &CameraBase, image_size: ImageSize) -> f64 {
    let centre = PanTilt::from_direction(base.base_from_world_point(Vec3::zeros()));
    let usual = AngleRange::around(centre.pan, Angle::from_degrees(60.0));
    let beyond = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
    let widths = ptz.focal_px / f64::from(image_size.width);
    beyond(ptz.tilt.degrees(), -25.0, -3.0) / 5.0
        + usual.distance(ptz.pan).degrees() / 20.0
        + beyond(widths.ln(), 0.8_f64.ln(), 4.0_f64.ln()) * 3.0
}

/// How near this camera has put a point of the field to this place in other shots, px.
fn usual_distance_px(scene: &NamingScene<'_>, at: ImagePoint, world: Vec3) -> Option<f64> {
    let base = scene.base?;
    let images = scene.elsewhere.iter().filter_map(|ptz| PtzCamera::new(*base, *ptz).image_from_world(world).ok());
    images.map(|image| image.distance_px(at)).min_by(f64::total_cmp)
}

/// How near the same name was clicked in the frames around, px / 100.
fn remembered(scene: &NamingScene<'_>, target: &Target, at: ImagePoint) -> Option<f64> {
    scene
        .neighbour_clicks
        .iter()
        .filter(|(other, _)| other == target)
        .map(|(_, image)| image.distance_px(at) / 100.0)
        .min_by(f64::total_cmp)
}
