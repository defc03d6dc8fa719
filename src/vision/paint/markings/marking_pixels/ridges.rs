//! Ridges of brightness: the pixels on the centre of something thin with ground beside it.
//!
//! A ridge is found in the blurred picture, where a thin marking is one smooth maximum. Its
//! contrast and its centre are measured in the picture itself, because the blur lowers the contrast
//! of thin lines and draws their centre to the brighter side. Whether a ridge is paint is not
//! decided here.

use super::stroke_colours::Colours;
use crate::media::GreyPicture;
use crate::paint::GroundPicture;
use crate::paint::ridges::profile::Profile;
use crate::paint::turf::ground_area::GroundArea;
use crate::paint::turf::turf_levels::{TurfExcess, TurfLevels};
use touchline_core::geometry::{ImagePoint, Vec2};

/// Distances from the centre at which the ground is compared with a marking, px. The smallest suits
/// thin lines, the largest the wide lines near the camera.
const SIDES_PX: [f64; 3] = [4.0, 8.0, 14.0];

/// Minimum contrast of paint against the brighter side: the larger of this many grey levels and
/// [`MIN_CONTRAST_SHARE`] of that side's brightness.
const MIN_CONTRAST: f64 = 4.5;
const MIN_CONTRAST_SHARE: f64 = 0.045;

/// Distances from the centre at which the ground's colour is tested, px. One match per side is
/// enough.
const COLOURS_PX: [f64; 3] = [8.0, 10.0, 12.0];

/// Standard deviation of the Gaussian blur before the Hessian is taken, px.
const BLUR_PX: f32 = 2.0;

/// Minimum curvature of the blurred brightness across a marking, grey levels / px².
const MIN_BEND: f32 = 0.25;

/// Maximum curvature along a marking, as a share of the curvature across it. Blobs exceed it.
const MAX_BEND_ALONG: f32 = 0.6;

/// Minimum slope of the blurred brightness on a border, grey levels / px, and minimum step between
/// its sides, grey levels.
const MIN_SLOPE: f64 = 2.5;
const MIN_STEP: f64 = 15.0;

/// Where the sides of a border are measured, px, and the most by which they change between these
/// places, as a share of the step.
const BORDER_SIDES_PX: [f64; 2] = [4.0, 8.0];
const MAX_UNEVEN: f64 = 0.4;

/// Half the width over which the contrast of a marking is summed, px. A far line, a fraction of a
/// pixel wide, is blurred over 3 to 6 px.
const SUMMED_PX: f64 = 5.0;

/// The centre of a marking found in one pixel.
pub(super) struct RidgePixel {
    pub index: usize,
    pub at: ImagePoint,
    pub normal: Vec2,
    /// As [`super::MarkingPixel::contrast_px`].
    pub contrast_px: Option<f64>,
    pub colours: Colours,
    /// Against the turf around it; on turf alone.
    pub excess: TurfExcess,
}

/// How a marking differs from what is beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Brighter than the ground on both sides.
    Bright,
    /// Darker than both.
    Dark,
    /// The border of two even areas, one brighter than the other, as of a court and its surround.
    Border,
}

/// Where a pixel shows a ridge or a border.
#[derive(Clone, Copy)]
struct Crest {
    at: ImagePoint,
    /// Unit vector across it.
    normal: Vec2,
    /// How far beside it the ground differs from it, px.
    side_px: f64,
}

/// The crests of a picture.
///
/// A crest is the maximum of the blurred brightness across a marking, or the steepest place of a
/// border. What is ground plays no part yet.
pub struct Crests<'a> {
    grey: &'a GreyPicture,
    /// The blurred brightness.
    smooth: Vec<f32>,
}

impl<'a> Crests<'a> {
    /// Blurs a picture.
    pub fn new(ground: &'a GroundPicture) -> Self {
        Self {
            grey: ground.grey(),
            smooth: gaussian_blur(ground.grey()),
        }
    }

    /// The crests of a tone in the whole picture, whatever the ground is: their centres, px, and
    /// the unit vectors across them.
    pub fn anywhere(&self, tone: Tone) -> Vec<(ImagePoint, Vec2)> {
        let size = self.grey.size;
        let (width, height) = (size.width as usize, size.height as usize);
        let inner = (1..height.saturating_sub(1))
            .flat_map(|y| (1..width.saturating_sub(1)).map(move |x| (x, y)));
        inner
            .filter_map(|(x, y)| {
                let crest = self.at_pixel(x, y, tone)?;
                Some((crest.at, crest.normal))
            })
            .collect()
    }

    /// The crest of a tone in a pixel that is not one of the outermost.
    fn at_pixel(&self, x: usize, y: usize, tone: Tone) -> Option<Crest> {
        let (grey, width) = (self.grey, self.grey.size.width as usize);
        let sign = match tone {
            Tone::Bright => 1.0,
            Tone::Dark => -1.0,
            Tone::Border => return border_at(grey, &self.smooth, x, y),
        };
        // Sub-pixel maximum of the blurred brightness along the normal.
        let (normal, beside_px) = bend(&self.smooth, y * width + x, width, sign)?;
        let at = ImagePoint::new(x as f64 + 0.5, y as f64 + 0.5).translate(normal * beside_px);
        let at = match tone {
            Tone::Bright => brightest(grey, at, normal),
            _ => at,
        };
        // The contrast is measured in the unblurred picture: the blur lowers that of thin lines.
        let side_px = contrasts(grey, at, normal, tone)?;
        Some(Crest {
            at,
            normal,
            side_px,
        })
    }
}

/// The marking pixels of some tones on the ground area, row by row.
pub(super) fn ridges(
    ground: &GroundPicture,
    area: &GroundArea,
    crests: &Crests,
    tones: &[Tone],
) -> Vec<RidgePixel> {
    let (width, height) = (ground.size().width as usize, ground.size().height as usize);
    let is_turf = ground.surface().is_turf();
    let levels = is_turf.then(|| TurfLevels::measure(ground, area));
    // The tests of a pixel are in the order of their cost. The first, a few sums over neighbours,
    // leaves few of all pixels. The outermost pixels have no Hessian.
    let mut found = Vec::new();
    let mut profile = Profile::default();
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            if !area.is_near(x, y) {
                continue;
            }
            let index = y * width + x;
            for tone in tones {
                let Some(Crest {
                    at,
                    normal,
                    side_px,
                }) = crests.at_pixel(x, y, *tone)
                else {
                    continue;
                };
                if !has_ground_beside(area, at, normal) {
                    continue;
                }
                // With the distance of the ground known, the centre is measured again from both
                // edges.
                let at = match tone {
                    Tone::Bright => between_edges(&mut profile, ground.grey(), at, normal, side_px),
                    Tone::Dark | Tone::Border => at,
                };
                let level = ground.grey().at(at);
                let excess = levels.as_ref().map(|levels| levels.excess(x, y, level));
                let contrast_px =
                    is_turf.then(|| sum_contrast(&mut profile, ground.grey(), at, normal));
                found.push(RidgePixel {
                    index,
                    at,
                    normal,
                    contrast_px,
                    colours: Colours::at(ground.picture(), at, normal, side_px),
                    excess: excess.unwrap_or_default(),
                });
            }
        }
    }
    found
}

/// The border of two even areas in a pixel.
///
/// As in Canny 1986 a maximum of the blurred gradient along itself. A line is none, as both its
/// sides are alike; neither is the outline of a crowd or of letters, where these are not even.
fn border_at(grey: &GreyPicture, smooth: &[f32], x: usize, y: usize) -> Option<Crest> {
    let (width, height) = (grey.size.width as usize, grey.size.height as usize);
    if x < 2 || y < 2 || x + 2 >= width || y + 2 >= height {
        return None;
    }
    let steepest = gradient(smooth, y * width + x, width);
    let slope = steepest.norm();
    if slope < MIN_SLOPE {
        return None;
    }
    // Against the neighbours along the gradient; a parabola gives the place between them.
    let normal = steepest / slope;
    let [before, behind] = [-1.0, 1.0].map(|step| {
        let [x, y] = [x as f64 + step * normal.x, y as f64 + step * normal.y].map(f64::round);
        gradient(smooth, y as usize * width + x as usize, width).dot(&normal)
    });
    if before > slope || behind >= slope {
        return None;
    }
    let beside_px = 0.5 * (behind - before) / (2.0 * slope - before - behind);
    let at = ImagePoint::new(x as f64 + 0.5, y as f64 + 0.5).translate(normal * beside_px);
    let [near, far] = BORDER_SIDES_PX;
    let [darker_far, darker, brighter, brighter_far] =
        [-far, -near, near, far].map(|across| grey.at(at.translate(normal * across)));
    let step = brighter - darker;
    let uneven = (brighter_far - brighter)
        .abs()
        .max((darker_far - darker).abs());
    let is_border = step >= MIN_STEP && uneven <= MAX_UNEVEN * step;
    is_border.then_some(Crest {
        at,
        normal,
        side_px: near,
    })
}

/// The gradient of the blurred brightness in a pixel that is not at the border, grey levels / px.
fn gradient(smooth: &[f32], index: usize, width: usize) -> Vec2 {
    let across = smooth[index + 1] - smooth[index - 1];
    let down = smooth[index + width] - smooth[index - width];
    0.5 * Vec2::new(f64::from(across), f64::from(down))
}

/// The normal of a ridge at a pixel, and the signed distance from the pixel's centre along it to
/// the maximum, px. None where the curvature is not that of a line, or where the maximum lies in
/// another pixel.
///
/// As in Steger 1998: n is the eigenvector of the Hessian H with the most negative eigenvalue, and
/// the maximum along n lies at t = −(n·∇I) / (nᵀ H n).
fn bend(smooth: &[f32], index: usize, width: usize, sign: f32) -> Option<(Vec2, f64)> {
    // The index does not wrap: the caller leaves out the outermost pixels.
    let at =
        |dx: isize, dy: isize| sign * smooth[index.wrapping_add_signed(dy * width as isize + dx)];
    let (centre, left, right, above, below) = (at(0, 0), at(-1, 0), at(1, 0), at(0, -1), at(0, 1));
    let (xx, yy) = (left - 2.0 * centre + right, above - 2.0 * centre + below);
    // Early exit without a square root. The conditions on both eigenvalues below imply this bound
    // on their sum, the trace.
    if xx + yy > -MIN_BEND * (1.0 - MAX_BEND_ALONG) {
        return None;
    }
    // Gradient and mixed derivative by central differences, then the eigenvalues of the symmetric 2
    // × 2 Hessian.
    let (x, y) = (0.5 * (right - left), 0.5 * (below - above));
    let xy = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
    let (mean, spread) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (across, along) = (mean - spread, mean + spread);
    if across > -MIN_BEND || along.abs() > MAX_BEND_ALONG * across.abs() {
        return None;
    }
    // atan2 / 2 is the angle of the eigenvector of `along`, the larger eigenvalue; the normal is
    // perpendicular to it.
    let turn = 0.5 * (2.0 * xy).atan2(xx - yy) + std::f32::consts::FRAC_PI_2;
    let (normal_y, normal_x) = turn.sin_cos();
    let beside = -(x * normal_x + y * normal_y) / across;
    // A little more than half a pixel, so that no maximum is lost between two neighbours.
    let within = (beside * normal_x).abs() <= 0.6 && (beside * normal_y).abs() <= 0.6;
    within.then(|| {
        (
            Vec2::new(f64::from(normal_x), f64::from(normal_y)),
            f64::from(beside),
        )
    })
}

/// Moves a point to the brightest unblurred value within 1.5 px along the normal. Where a mowing
/// stripe ends, 1 px wide paint lies beside the maximum of the blurred brightness.
fn brightest(grey: &GreyPicture, at: ImagePoint, normal: Vec2) -> ImagePoint {
    const STEP_PX: f64 = 0.5;
    const STEPS: i32 = 3;
    // From near to far, so that of equally bright points the nearest wins.
    let beside = (0..=STEPS)
        .flat_map(|step| [step, -step])
        .map(|step| at.translate(normal * (STEP_PX * f64::from(step))));
    let with_grey = beside.map(|at| (grey.at(at), at));
    with_grey
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map_or(at, |(_, at)| at)
}

/// The midpoint of the two edges of bright paint, with ground `side_px` beside it.
///
/// Mowing stripes often end at painted lines. The maximum of the blurred brightness is then shifted
/// to the brighter side, by 1.5 px for paint 1 px wide. The edges are not: each is taken halfway
/// between the brightness of the paint and that of its own side.
fn between_edges(
    profile: &mut Profile<f64>,
    grey: &GreyPicture,
    at: ImagePoint,
    normal: Vec2,
    side_px: f64,
) -> ImagePoint {
    const STEP_PX: f64 = 0.5;
    /// Maximum distance of the brightest point from the starting point, px.
    const BESIDE_PX: f64 = 3.0;
    profile.read(grey, at, normal, 2.0 * side_px, STEP_PX);
    let middle = profile.len() / 2;
    let (side, beside) = (
        profile.places(side_px),
        profile.places(BESIDE_PX).unsigned_abs(),
    );
    // Peak of the unblurred profile.
    let near = middle.saturating_sub(beside)..=(middle + beside).min(profile.len() - 1);
    let Some(brightest) =
        near.max_by(|one, other| profile.value(*one).total_cmp(&profile.value(*other)))
    else {
        return at;
    };
    // Each side has a brightness of its own, averaged from one to two times `side_px` away.
    let (before, behind) = (
        profile.mean(middle, -2 * side, -side),
        profile.mean(middle, side, 2 * side),
    );
    // An edge is where the profile falls to half the contrast against that side.
    // Without both edges the point stays where it is.
    let top = profile.value(brightest);
    let steps = profile.steps_within(2.0 * side_px);
    let [from, to] = [(-1, before), (1, behind)].map(|(direction, ground)| {
        let half = f64::midpoint(top, ground);
        profile.falls_below(|grey| grey, brightest, direction, half, steps)
    });
    match (from, to) {
        (Some(from), Some(to)) => at.translate(normal * profile.offset_px(f64::midpoint(from, to))),
        _ => at,
    }
}

/// The contrast of a marking summed across it, grey levels × px, against a straight line between
/// the brightness of both sides. Unlike the contrast itself it does not depend on the blur.
fn sum_contrast(
    profile: &mut Profile<f64>,
    grey: &GreyPicture,
    at: ImagePoint,
    normal: Vec2,
) -> f64 {
    const STEP_PX: f64 = 0.5;
    profile.read(grey, at, normal, SUMMED_PX, STEP_PX);
    let last = profile.len() - 1;
    // The line between the sides has their mean brightness in the middle, so its slope cancels out.
    let sides = f64::midpoint(profile.value(0), profile.value(last));
    let inner = last as isize / 2 - 1;
    let sum = (2 * inner + 1) as f64 * (profile.mean(last / 2, -inner, inner) - sides);
    STEP_PX * sum
}

/// The smallest of [`SIDES_PX`] at which both sides are darker, or for dark markings brighter, than
/// the centre by the minimum contrast.
fn contrasts(grey: &GreyPicture, at: ImagePoint, normal: Vec2, tone: Tone) -> Option<f64> {
    // The nearest distance that suffices: farther away the sides may show another line.
    let here = grey.at(at);
    SIDES_PX.into_iter().find(|side_px| {
        let (one, other) = (
            grey.at(at.translate(normal * *side_px)),
            grey.at(at.translate(normal * -side_px)),
        );
        let brighter = one.max(other);
        let stands_out = match tone {
            Tone::Bright => here - brighter,
            Tone::Dark | Tone::Border => one.min(other) - here,
        };
        stands_out > MIN_CONTRAST.max(MIN_CONTRAST_SHARE * brighter)
    })
}

/// Whether both sides of a point have the ground's colour. Near the border of the ground area one
/// side is enough: a boundary line may have a board beyond it.
fn has_ground_beside(area: &GroundArea, at: ImagePoint, normal: Vec2) -> bool {
    let sides = [1.0, -1.0].into_iter().filter(|sign| {
        COLOURS_PX
            .iter()
            .any(|beside_px| area.is_of_ground(at.translate(normal * (sign * beside_px))))
    });
    match sides.count() {
        2 => true,
        1 => area.is_near_border(at),
        _ => false,
    }
}

/// The brightness convolved with a Gaussian of [`BLUR_PX`], truncated at 3 σ; the border pixels are
/// repeated outside.
fn gaussian_blur(grey: &GreyPicture) -> Vec<f32> {
    let (width, height) = (grey.size.width as usize, grey.size.height as usize);
    let reach = (3.0 * BLUR_PX).ceil() as isize;
    let weights = (-reach..=reach).map(|offset| (-0.5 * (offset as f32 / BLUR_PX).powi(2)).exp());
    let sum: f32 = weights.clone().sum();
    let kernel: Vec<f32> = weights.map(|weight| weight / sum).collect();
    // The Gaussian is separable: first along rows. The inner loop runs over contiguous memory.
    let mut across = vec![0.0_f32; width * height];
    for (row, out) in grey
        .values
        .chunks_exact(width.max(1))
        .zip(across.chunks_exact_mut(width.max(1)))
    {
        let padded: Vec<f32> = (0..width + 2 * reach as usize)
            .map(|at| f32::from(row[clamp_index(at as isize - reach, width)]))
            .collect();
        for (step, weight) in kernel.iter().enumerate() {
            for (out, value) in out.iter_mut().zip(&padded[step..]) {
                *out += weight * value;
            }
        }
    }
    // Then along columns, again a row at a time.
    let mut both = vec![0.0_f32; width * height];
    for (y, out) in both.chunks_exact_mut(width.max(1)).enumerate() {
        for (step, weight) in kernel.iter().enumerate() {
            let from = clamp_index((y + step) as isize - reach, height) * width;
            for (out, value) in out.iter_mut().zip(&across[from..from + width]) {
                *out += weight * value;
            }
        }
    }
    both
}

/// The nearest of `count` indices.
fn clamp_index(index: isize, count: usize) -> usize {
    index.clamp(0, count as isize - 1) as usize
}
