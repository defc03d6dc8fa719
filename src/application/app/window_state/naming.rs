//! Which landmark or line a click probably shows: every name that the field has, ranked.
//!
//! # Evidence for a landmark
//!
//! The strongest evidence in a frame decides:
//!
//! | known | how a name is ranked |
//! |---|---|
//! | the frame's camera, from its other clicks | by the distance of the click from where this camera sees the landmark |
//! | the base, and another named click | the name is tried as the second point of a two-point solve, and the camera that results is compared with the neighbouring frames', else with other shots', else with an ordinary broadcast view |
//! | the base, and a neighbouring frame's camera | by its distance, beyond 40 px by looks as well |
//! | the base, and cameras of other shots | by the smallest distance, and by looks likewise |
//! | clicks in neighbouring frames | by the distance from where the same name was clicked |
//! | the base, and paint around the click | by how the landmark looks (`corner_looks.rs`) |
//! | none of these | by how precisely a landmark can be clicked |
//!
//! # Scores
//!
//! 0 is a perfect name and 1 the limit up to which a name is plausible. Only the frame's own camera
//! and cameras of neighbouring frames can make a name plausible. The names of one list are ranked
//! by one kind of evidence, except landmarks that no other shot shows: these fall back to clicks in
//! neighbouring frames.

use super::corner_looks::CornerLooks;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{Angle, AngleRange, ImagePoint, ImageSize, Vec3};
use touchline_core::markings::{self, MarkingOptions, MarkingPolyline};
use touchline_core::solve::{Observation, PtzRanges, SolveContext, solve_frame};
use touchline_documents::document::Target;

/// Distance from the click at which a name has the score 1, px at 1920 px width.
const NEAR_PX: f64 = 16.0;

/// Scores at which weaker evidence starts.
const OTHER_SHOTS_MOTION: f64 = 1.0;
const NEIGHBOUR_DISTANCE: f64 = 2.0;
const OTHER_SHOTS_DISTANCE: f64 = 4.0;
const LOOKS: f64 = 500.0;
const NO_EVIDENCE: f64 = 1e3;
const NO_EVIDENCE_FOR_LINE: f64 = 1e6;

/// Beyond this distance from where another frame's camera sees a landmark, in units of
/// [`NEAR_PX`], that camera has moved: 40 px at 1920 px width.
const MOVED: f64 = 2.5;

/// A painted line more or less, compared with a distance that is larger by the factor e.
const LIKENESS_WEIGHT: f64 = 2.0;

/// A name is unambiguous if the score of the next one is this many times higher.
const UNAMBIGUOUS_RATIO: f64 = 3.0;

/// Better scores count as this one there: a name that fits perfectly is not infinitely better than
/// the next.
const BEST_SCORE: f64 = 0.33;

/// A possible name of a click.
#[derive(Clone, Debug, PartialEq)]
pub struct NameCandidate {
    /// The landmark or line.
    pub target: Target,
    pub label: String,
    /// Its short code, for typing.
    pub code: String,
    /// Distance of the click from where the frame's camera, or a neighbour's, projects it, px. None
    /// if there is neither.
    pub distance_px: Option<f64>,
    /// The frame's camera if this name is right; none if it is unknown yet.
    pub ptz: Option<Ptz>,
    /// The index of another click of the frame that has this name already.
    pub in_use: Option<usize>,
    /// Whether it is listed only when typed: no paint marks it, and the camera has no base yet.
    pub hidden: bool,
    score: f64,
    plausible: bool,
}

/// The context of a click that needs a name.
pub struct NamingScene<'a> {
    pub field: &'a FieldModel,
    /// The frame's size.
    pub image_size: ImageSize,
    /// The camera's base, if known.
    pub base: Option<&'a CameraBase>,
    /// The frame's camera from its other clicks, if they suffice.
    pub camera: Option<&'a PtzCamera>,
    /// The other named clicks of the frame.
    pub named: &'a [Observation],
    /// Names that other clicks of this frame have already.
    pub taken: &'a [TakenName],
    /// Cameras of the neighbouring frames, nearest first.
    pub neighbours: &'a [Ptz],
    /// Cameras of solved frames in other shots: where this camera usually looks.
    pub other_shots: &'a [Ptz],
    /// Named clicks of the nearest labelled frames.
    pub neighbour_clicks: &'a [NeighbourClick],
    /// How the clicked spot looks, if the picture was looked at.
    pub looks: Option<&'a CornerLooks>,
}

/// A name that another click of the frame has.
pub struct TakenName {
    /// The name.
    pub target: Target,
    /// The index of that click.
    pub click: usize,
}

/// A named click of another frame.
pub struct NeighbourClick {
    /// Its name.
    pub target: Target,
    /// Where it was placed, px.
    pub image: ImagePoint,
}

/// How well a name fits, by the evidence that decided.
struct Ranking {
    score: f64,
    plausible: bool,
    distance_px: Option<f64>,
    ptz: Option<Ptz>,
}

impl Ranking {
    /// By evidence that can make no name plausible.
    fn implausible(score: f64) -> Self {
        Self {
            score,
            plausible: false,
            distance_px: None,
            ptz: None,
        }
    }
}

/// Every name that a click at `at` may get, best first: landmarks, or with `lines` the lines.
pub fn candidates(scene: &NamingScene<'_>, at: ImagePoint, lines: bool) -> Vec<NameCandidate> {
    let mut found = if lines {
        line_candidates(scene, at)
    } else {
        landmark_candidates(scene, at)
    };
    found.sort_by(|a, b| {
        b.plausible
            .cmp(&a.plausible)
            .then(a.score.total_cmp(&b.score))
    });
    found
}

/// The best candidate, if it is the only plausible one and clearly better than the next.
pub fn unambiguous(candidates: &[NameCandidate]) -> Option<&NameCandidate> {
    let best = candidates.first().filter(|best| best.plausible)?;
    let Some(next) = candidates.get(1) else {
        return Some(best);
    };
    let is_clear = !next.plausible && next.score > UNAMBIGUOUS_RATIO * best.score.max(BEST_SCORE);
    is_clear.then_some(best)
}

/// How a candidate matches what was typed, best first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum TextMatch {
    WholeCode,
    BeginningOfCode,
    BeginningsOfWords,
}

/// The candidates whose code or label matches what was typed, the best matches first. While nothing
/// is typed: all but names in use and hidden ones.
pub fn filter_by_text<'a>(candidates: &'a [NameCandidate], typed: &str) -> Vec<&'a NameCandidate> {
    let typed = typed.trim().to_lowercase();
    if typed.is_empty() {
        return candidates
            .iter()
            .filter(|candidate| candidate.in_use.is_none() && !candidate.hidden)
            .collect();
    }
    let mut matches: Vec<(TextMatch, &NameCandidate)> = candidates
        .iter()
        .filter_map(|candidate| Some((match_text(candidate, &typed)?, candidate)))
        .collect();
    // A stable sort: equal matches stay ranked by score.
    matches.sort_by_key(|(text_match, _)| *text_match);
    matches
        .into_iter()
        .map(|(_, candidate)| candidate)
        .collect()
}

/// `typed` is in lower case.
fn match_text(candidate: &NameCandidate, typed: &str) -> Option<TextMatch> {
    let code = candidate.code.to_lowercase();
    if code == typed {
        return Some(TextMatch::WholeCode);
    }
    if code.starts_with(typed) {
        return Some(TextMatch::BeginningOfCode);
    }
    let label = candidate.label.to_lowercase();
    typed
        .split_whitespace()
        .all(|typed_word| has_word_beginning_with(&label, typed_word))
        .then_some(TextMatch::BeginningsOfWords)
}

/// Whether a word of `text` begins with `beginning`.
fn has_word_beginning_with(text: &str, beginning: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric())
        .any(|word| word.starts_with(beginning))
}

/// All landmarks of the field, ranked as names of a click.
fn landmark_candidates(scene: &NamingScene<'_>, at: ImagePoint) -> Vec<NameCandidate> {
    let mut candidates = Vec::with_capacity(scene.field.landmarks.len());
    for landmark in &scene.field.landmarks {
        let target = Target::Landmark(landmark.id.clone());
        let in_use = scene
            .taken
            .iter()
            .find(|taken| taken.target == target)
            .map(|taken| taken.click);
        let hidden = landmark.is_unmarked && scene.base.is_none();
        // Names that cannot be taken as they stand go last, without the cost of a solve.
        let ranking = if in_use.is_some() || hidden {
            Ranking::implausible(f64::INFINITY)
        } else {
            rank_landmark(scene, landmark, at)
        };
        candidates.push(NameCandidate {
            target,
            label: landmark.label.clone(),
            code: landmark.code.clone(),
            distance_px: ranking.distance_px,
            ptz: ranking.ptz,
            in_use,
            hidden,
            score: ranking.score,
            plausible: ranking.plausible,
        });
    }
    candidates
}

/// Ranks a landmark by the strongest evidence in the frame (see the table of the module).
fn rank_landmark(scene: &NamingScene<'_>, landmark: &Landmark, at: ImagePoint) -> Ranking {
    let near_px = NEAR_PX * scene.image_size.scale_from_1920();
    let at_in_world = scene.field.landmark_in_world(landmark);

    if let Some(camera) = scene.camera {
        let distance_px = distance_px(camera, at_in_world, at);
        let score = distance_px.map_or(f64::INFINITY, |px| px / near_px);
        return Ranking {
            score,
            plausible: score <= 1.0,
            distance_px,
            ptz: None,
        };
    }
    if let Some(base) = scene.base.filter(|_| !scene.named.is_empty()) {
        return rank_as_second_point(scene, base, landmark, at);
    }
    if let Some(camera) = neighbour_camera(scene) {
        let distance_px = distance_px(&camera, at_in_world, at);
        let score = distance_px.map_or(f64::INFINITY, |px| {
            NEIGHBOUR_DISTANCE + score_by_distance(scene, landmark, at, px / near_px)
        });
        return Ranking {
            distance_px,
            ..Ranking::implausible(score)
        };
    }
    if let Some(px) = distance_in_other_shots_px(scene, at_in_world, at) {
        let score = score_by_distance(scene, landmark, at, px / near_px);
        return Ranking::implausible(OTHER_SHOTS_DISTANCE + score);
    }
    let target = Target::Landmark(landmark.id.clone());
    let score = score_by_neighbour_clicks(scene, &target, at)
        .or_else(|| Some(LOOKS + unlikeness(scene, landmark, at)?))
        .unwrap_or(NO_EVIDENCE + landmark.click_sigma_px);
    Ranking::implausible(score)
}

/// Ranks a landmark by where another frame's camera sees it, `apart` times [`NEAR_PX`] away. What
/// is far away there says less than how the clicked spot looks: the camera has moved meanwhile.
fn score_by_distance(
    scene: &NamingScene<'_>,
    landmark: &Landmark,
    at: ImagePoint,
    apart: f64,
) -> f64 {
    match unlikeness(scene, landmark, at).filter(|_| apart > MOVED) {
        Some(unlike) => MOVED + LIKENESS_WEIGHT * unlike + (apart / MOVED).ln(),
        None => apart,
    }
}

/// How unlike the clicked spot a landmark looks from the base. Of those that look alike, the one
/// that can be clicked more precisely is the likelier choice.
fn unlikeness(scene: &NamingScene<'_>, landmark: &Landmark, at: ImagePoint) -> Option<f64> {
    let (looks, base) = (scene.looks?, scene.base?);
    let unlike = looks.unlikeness(scene.field, landmark, base, scene.image_size, at)?;
    Some(unlike + 1e-3 * landmark.click_sigma_px)
}

/// Ranks a landmark by the camera that results if it is the second point of the frame: a wrong name
/// usually gives a camera far from those of the neighbouring frames.
fn rank_as_second_point(
    scene: &NamingScene<'_>,
    base: &CameraBase,
    landmark: &Landmark,
    at: ImagePoint,
) -> Ranking {
    let id = landmark.id.as_str();
    // The trial click gets an index behind the others, so that none has two positions.
    let last = scene.named.iter().map(|named| named.click).max();
    let next = last.map_or(0, |last| last + 1);
    let second = Observation::from_landmark(scene.field, id, at, scene.image_size, next).ok();
    let Some((ptz, score)) = second.and_then(|second| solve_with_second_point(scene, base, second))
    else {
        return Ranking::implausible(f64::INFINITY);
    };
    let plausible = !scene.neighbours.is_empty() && score <= 1.0;
    Ranking {
        score,
        plausible,
        distance_px: None,
        ptz: Some(ptz),
    }
}

/// The camera if the frame has `second` as a click, with its score.
fn solve_with_second_point(
    scene: &NamingScene<'_>,
    base: &CameraBase,
    second: Observation,
) -> Option<(Ptz, f64)> {
    let observations: Vec<_> = scene.named.iter().copied().chain([second]).collect();
    let context = SolveContext {
        neighbours: scene.neighbours.to_vec(),
        ..SolveContext::new(scene.image_size)
    };
    let solved = solve_frame(base, &observations, &context).ok()?;

    // How far the camera would have moved since the best known one. If none is known, compare with
    // an ordinary view of a broadcast; a camera outside of the ranges that any view has scores as
    // if there were no evidence.
    let motion_from = |other: &Ptz| motion_between(other, &solved.ptz, scene.image_size);
    let score = if let Some(neighbour) = scene.neighbours.first() {
        motion_from(neighbour)
    } else if !scene.other_shots.is_empty() {
        let least_motion = scene
            .other_shots
            .iter()
            .map(motion_from)
            .min_by(f64::total_cmp);
        OTHER_SHOTS_MOTION + least_motion.unwrap_or(f64::INFINITY)
    } else if PtzRanges::for_size(scene.image_size).contains(&solved.ptz) {
        OTHER_SHOTS_MOTION + distance_from_broadcast_view(&solved.ptz, base, scene.image_size)
    } else {
        NO_EVIDENCE
    };
    // More than two clicks are over-determined. A misfit of 1 is their usual noise.
    let excess_misfit = solved
        .misfit()
        .map_or(0.0, |misfit| (misfit - 1.0).max(0.0));
    Some((solved.ptz, score + excess_misfit))
}

/// All lines of the field, ranked as names of a click by its distance from them.
fn line_candidates(scene: &NamingScene<'_>, at: ImagePoint) -> Vec<NameCandidate> {
    let near_px = NEAR_PX * scene.image_size.scale_from_1920();
    // Without a camera of its own the frame borrows a neighbour's: that orders the lines, but makes
    // none plausible.
    let camera = scene.camera.copied().or_else(|| neighbour_camera(scene));
    let projected = camera.map_or_else(Vec::new, |camera| {
        markings::project_lines(
            scene.field,
            &camera,
            scene.image_size,
            &MarkingOptions::default(),
        )
    });

    let mut candidates = Vec::with_capacity(scene.field.lines.len());
    for (index, line) in scene.field.lines.iter().enumerate() {
        let target = Target::Line(line.id.clone());
        let distance_px = distance_from_line_px(&projected, index, at);
        let score = if let Some(px) = distance_px {
            px / near_px
        } else if let Some(score) = score_by_neighbour_clicks(scene, &target, at) {
            NO_EVIDENCE + score
        } else {
            NO_EVIDENCE_FOR_LINE
        };
        candidates.push(NameCandidate {
            target,
            label: line.label.clone(),
            code: line.code.clone(),
            distance_px,
            ptz: None,
            // Several clicks may be on one line.
            in_use: None,
            hidden: false,
            score,
            plausible: scene.camera.is_some() && score <= 1.0,
        });
    }
    candidates
}

/// Distance of a click from a line as a camera projects it, px; none if the line is outside the
/// picture.
fn distance_from_line_px(
    projected: &[MarkingPolyline],
    line: usize,
    click: ImagePoint,
) -> Option<f64> {
    let parts = projected.iter().filter(|marking| marking.line == line);
    let segments = parts.flat_map(|marking| marking.points.windows(2));
    segments
        .map(|ends| click.distance_from_segment_px(ends[0], ends[1]))
        .min_by(f64::total_cmp)
}

/// The camera of the nearest neighbouring frame, as a guess of this frame's.
fn neighbour_camera(scene: &NamingScene<'_>) -> Option<PtzCamera> {
    Some(PtzCamera::new(*scene.base?, *scene.neighbours.first()?))
}

/// Distance of a click from where a camera projects a point, px; none if it does not see the point.
fn distance_px(camera: &PtzCamera, point_in_world: Vec3, click: ImagePoint) -> Option<f64> {
    Some(
        camera
            .image_from_world(point_in_world)
            .ok()?
            .distance_px(click),
    )
}

/// Smallest distance of a click from where cameras of other shots project a point, px.
fn distance_in_other_shots_px(
    scene: &NamingScene<'_>,
    point_in_world: Vec3,
    click: ImagePoint,
) -> Option<f64> {
    let base = scene.base?;
    let cameras = scene
        .other_shots
        .iter()
        .map(|ptz| PtzCamera::new(*base, *ptz));
    cameras
        .filter_map(|camera| distance_px(&camera, point_in_world, click))
        .min_by(f64::total_cmp)
}

/// Smallest distance of a click from clicks with the same name in neighbouring frames, in units of
/// 100 px.
fn score_by_neighbour_clicks(
    scene: &NamingScene<'_>,
    target: &Target,
    click: ImagePoint,
) -> Option<f64> {
    let same_name = scene
        .neighbour_clicks
        .iter()
        .filter(|other| other.target == *target);
    same_name
        .map(|other| other.image.distance_px(click) / 100.0)
        .min_by(f64::total_cmp)
}

/// How far one camera is from another. 1 is a pan by a third of the picture's width, a tilt by a
/// sixth of it, or a zoom by a fifth; up to there a neighbouring frame vouches for a camera.
fn motion_between(from: &Ptz, to: &Ptz, image_size: ImageSize) -> f64 {
    let third_px = f64::from(image_size.width) / 3.0;
    // A turn by a small angle moves the picture by that angle times the focal length, px. 1.2 is
    // the zoom by a fifth.
    let pan = to.pan.turn_from(from.pan).radians() * from.focal_px / third_px;
    let tilt = to.tilt.turn_from(from.tilt).radians() * from.focal_px / third_px;
    let zoom = (to.focal_px / from.focal_px).ln() / 1.2_f64.ln();
    pan.hypot(2.0 * tilt).hypot(zoom)
}

/// How far a camera is from an ordinary broadcast view: pan within 60° of the field's centre,
/// wherever the camera stands, tilt between −25° and −3°, focal length 0.8 to 4 picture widths.
/// Zero within; beyond, 1 is 20° of pan, 5° of tilt, or a factor of 1.4.
fn distance_from_broadcast_view(ptz: &Ptz, base: &CameraBase, image_size: ImageSize) -> f64 {
    let field_centre = PanTilt::from_direction(base.base_from_world_point(Vec3::zeros()));
    let usual_pan = AngleRange::around(field_centre.pan, Angle::from_degrees(60.0));
    // Zooms multiply, so that the focal length is compared by its logarithm: ln 1.4 ≈ 1/3.
    let focal_widths = ptz.focal_px / f64::from(image_size.width);
    distance_from_range(ptz.tilt.degrees(), -25.0, -3.0) / 5.0
        + usual_pan.distance(ptz.pan).degrees() / 20.0
        + distance_from_range(focal_widths.ln(), 0.8_f64.ln(), 4.0_f64.ln()) * 3.0
}

fn distance_from_range(value: f64, low: f64, high: f64) -> f64 {
    (low - value).max(value - high).max(0.0)
}
