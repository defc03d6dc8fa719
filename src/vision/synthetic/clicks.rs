//! Clicks as a careful annotator would place them on a drawn frame.

use super::texture::{hash, sub_seed, unit};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, LandmarkId, LineId};
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox, Vec2, Vec3};

/// What a drawn click shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClickTarget {
    /// A landmark.
    Landmark(LandmarkId),
    /// A point somewhere on a line.
    Line(LineId),
}

/// A click with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct SyntheticClick {
    /// What it shows.
    pub target: ClickTarget,
    /// Where it was placed, px.
    pub image: ImagePoint,
}

/// How an annotator clicks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClickOptions {
    /// How many landmarks are clicked at most.
    pub landmarks: usize,
    /// How many further clicks go on lines.
    pub lines: usize,
    /// 1-σ of a click along x and along y, px.
    pub sigma_px: f64,
    /// Chooses landmarks and noise.
    pub seed: u64,
}

/// A click this near to the frame's border is not placed, px.
const BORDER_PX: f64 = 12.0;
/// Landmarks with more click noise than this are not clicked, px at 1920 px width.
const CLEAR_SIGMA_PX: f64 = 3.0;

/// The clicks of one frame: landmarks in view, clear of `hidden` (players, the score graphic), the
/// first at random and each next one far from those before; then points on lines.
pub fn generate_clicks(
    field: &FieldModel,
    camera: &PtzCamera,
    image_size: ImageSize,
    hidden: &[PixelBox],
    options: &ClickOptions,
) -> Vec<SyntheticClick> {
    let seed = sub_seed(options.seed, 0xC11C);
    let seen = |point_in_world: Vec3| {
        let image = camera.image_from_world(point_in_world).ok()?;
        let (width, height) = (f64::from(image_size.width), f64::from(image_size.height));
        let inside = (BORDER_PX..width - BORDER_PX).contains(&image.x)
            && (BORDER_PX..height - BORDER_PX).contains(&image.y);
        (inside && !hidden.iter().any(|area| area.contains(image))).then_some(image)
    };
    let mut candidates: Vec<(&LandmarkId, ImagePoint)> = field
        .landmarks
        .iter()
        .filter(|landmark| landmark.click_sigma_px <= CLEAR_SIGMA_PX)
        .filter_map(|landmark| Some((&landmark.id, seen(field.landmark_in_world(landmark))?)))
        .collect();
    // Distances are measured between exact positions, so that the choice of landmarks does not
    // depend on the noise. The first has no distance, and the random factor alone chooses it.
    let mut clicks = Vec::with_capacity(options.landmarks + options.lines);
    let mut placed: Vec<ImagePoint> = Vec::new();
    while clicks.len() < options.landmarks && !candidates.is_empty() {
        // People prefer points far from the clicks so far, but not strictly: a random factor models
        // that.
        let worth = |index: usize, image: ImagePoint| {
            let distance = placed
                .iter()
                .map(|other| other.distance_px(image))
                .fold(f64::INFINITY, f64::min);
            distance.min(f64::from(image_size.width))
                * (0.5 + f64::from(unit(hash(seed, index as i32, clicks.len() as i32))))
        };
        let best = (0..candidates.len())
            .max_by(|a, b| worth(*a, candidates[*a].1).total_cmp(&worth(*b, candidates[*b].1)));
        let Some(best) = best else { break };
        let (id, exact) = candidates.swap_remove(best);
        placed.push(exact);
        let image = exact.translate(scatter(seed, clicks.len()) * options.sigma_px);
        clicks.push(SyntheticClick {
            target: ClickTarget::Landmark(id.clone()),
            image,
        });
    }
    // Points on lines: one per line, away from its ends, by rejection. The number of attempts is
    // bounded, because too few lines may be in view.
    let painted: Vec<_> = field
        .lines
        .iter()
        .filter(|line| line.painted && line.curve.length_m() > 5.0)
        .collect();
    for attempt in 0..60 * options.lines {
        if clicks.len() >= placed.len() + options.lines || painted.is_empty() {
            break;
        }
        let draw = hash(seed, attempt as i32, 77);
        let line = painted[draw as usize % painted.len()];
        let point = field.world_from_nominal(
            line.curve
                .point_at(0.15 + 0.7 * f64::from(unit(hash(draw, 1, 2)))),
        );
        let known = clicks
            .iter()
            .any(|click| matches!(&click.target, ClickTarget::Line(id) if *id == line.id));
        let Some(exact) = seen(point).filter(|_| !known) else {
            continue;
        };
        let image = exact.translate(scatter(seed, 100 + attempt) * options.sigma_px);
        clicks.push(SyntheticClick {
            target: ClickTarget::Line(line.id.clone()),
            image,
        });
    }
    clicks
}

/// Two draws from the standard normal distribution.
fn scatter(seed: u32, index: usize) -> Vec2 {
    // Box and Muller's transform; the lower bound keeps the logarithm finite.
    let draw = hash(seed, index as i32, 9);
    let radius = (-2.0 * f64::from(unit(draw).max(1e-7)).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * f64::from(unit(hash(draw, 5, 6)))).sin_cos();
    Vec2::new(radius * cos, radius * sin)
}
