//! Marking pixels of a picture, found without any camera: thin and long, brighter than the ground
//! on both sides, or, on an indoor floor, darker.
//!
//! # Method
//!
//! 1. The brightness is blurred, and the Hessian of every pixel near the ground is computed. A
//!    pixel is a marking pixel where the brightness has a maximum along the eigenvector of the
//!    strongest curvature (Steger: "An unbiased detector of curvilinear structures", PAMI 20,
//!    1998), and where the ground on both sides differs enough from it.
//! 2. On bright paint the centre is measured again, as the midpoint of the two edges, because the
//!    maximum is biased where the two sides differ in brightness.
//! 3. Marking pixels are joined to connected components. Short components are dropped, and on turf
//!    so are those with the colour of lighter turf, or as bright as its light stripes.

use super::GroundPicture;
use super::ground_area::{GroundArea, parts};
use super::profile::Profile;
use super::turf_levels::{TurfExcess, TurfLevels};
use crate::media::{GreyPicture, Picture};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

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

/// Minimum extent of a connected component, px at 1920 px width, without the pixels that dilation
/// adds at its ends.
const MIN_LENGTH_PX: f64 = 28.0;

/// Lower limit of the minimum extent in small pictures, px. The blur has a fixed width and makes
/// the grain of the turf into components of about this extent at any resolution.
const GRAIN_PX: f64 = 20.0;

/// A marking pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokePoint {
    /// Centre of the marking, px.
    pub at: ImagePoint,
    /// Unit vector across the marking, in the picture.
    pub normal: Vec2,
    /// Diagonal of the bounding box of the connected component that the pixel belongs to, px.
    pub length_px: f64,
}

/// The marking pixels of a picture, and where it shows ground.
#[derive(Clone, Debug)]
pub struct MarkingPixels {
    /// Marking pixels, row by row.
    pub points: Vec<StrokePoint>,
    cells: Cells,
}

/// What a picture shows at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A marking within a few px.
    Stroke,
    /// Ground without paint.
    Ground,
    /// Neither: a player, a board, a graphic, or a point outside the picture.
    Other,
}

impl MarkingPixels {
    /// Detects the markings of a picture.
    #[must_use]
    pub fn of(ground: &GroundPicture) -> Self {
        let size = ground.size();
        let area = GroundArea::of(ground);
        let mut cells = Cells::new(size);
        // A cell lies in the ground area if its first pixel does: the area is made of 8 px blocks.
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                if area.holds(column * CELL_PX, row * CELL_PX) {
                    cells.flags[row * cells.columns + column] |= GROUND;
                }
            }
        }
        let ridges = ridges(ground, &area);
        let points = long_ones(&ridges, size, ground.surface().is_turf());
        for point in &points {
            cells.mark_stroke(point.at);
        }
        Self { points, cells }
    }

    /// What the picture shows at a point, px.
    #[must_use]
    pub fn shown(&self, at: ImagePoint) -> Shown {
        match self.cells.at(at) {
            flags if flags & STROKE != 0 => Shown::Stroke,
            flags if flags & GROUND != 0 => Shown::Ground,
            _ => Shown::Other,
        }
    }

    /// Width and height of the picture, px.
    #[must_use]
    pub const fn size(&self) -> ImageSize {
        self.cells.size
    }
}

/// The centre of a marking found in one pixel.
struct RidgePixel {
    index: usize,
    at: ImagePoint,
    normal: Vec2,
    colours: Colours,
    /// Against the turf around it; on turf alone.
    excess: TurfExcess,
}

/// Sums of red, green and blue over marking pixels: on the marking, and on the ground beside it.
#[derive(Clone, Copy, Debug, Default)]
struct Colours {
    stroke: [f64; 3],
    ground: [f64; 3],
    /// Number of pixels.
    pixels: f64,
}

impl Colours {
    /// The colours at the centre of a marking and, averaged, `side_px` to both sides of it.
    fn at(picture: &Picture, at: ImagePoint, normal: Vec2, side_px: f64) -> Self {
        let colour = |at: ImagePoint| {
            let pixel = picture
                .pixel(at.x.max(0.0) as u32, at.y.max(0.0) as u32)
                .unwrap_or_default();
            [0, 1, 2].map(|channel| f64::from(pixel[channel]))
        };
        let (one, other) = (
            colour(at.moved(normal * side_px)),
            colour(at.moved(normal * -side_px)),
        );
        Self {
            stroke: colour(at),
            ground: [0, 1, 2].map(|channel| f64::midpoint(one[channel], other[channel])),
            pixels: 1.0,
        }
    }

    fn add(&mut self, other: &Self) {
        for channel in 0..3 {
            self.stroke[channel] += other.stroke[channel];
            self.ground[channel] += other.ground[channel];
        }
        self.pixels += other.pixels;
    }

    /// Whether the marking is whiter than the ground, and not only brighter: it is less green.
    ///
    /// Paint mixes with the turf of a pixel, so that brightness and greenness change in proportion,
    /// however thin the paint is. Strong compression keeps the brightness and loses the greenness.
    fn are_whiter(&self) -> bool {
        /// Minimum change of greenness, as a share of that by white paint.
        const SHARE: f64 = 0.33;
        const WHITE: f64 = 255.0;
        let mean = |colour: [f64; 3]| colour.iter().sum::<f64>() / 3.0;
        // The sums are over many pixels, so they are compared as shares of the ground's brightness.
        let ground = mean(self.ground);
        let brighter = (mean(self.stroke) - ground) / ground;
        let less_green = (greenness(self.ground) - greenness(self.stroke)) / ground;
        let pixels = self.pixels.max(1.0);
        let white = greenness(self.ground) / pixels / (WHITE - ground / pixels);
        less_green > SHARE * white * brighter
    }

    /// Whether the marking is turf that is lighter than the turf beside it, such as a mowing stripe
    /// seen from far away.
    ///
    /// Compares the colour that the marking adds to the ground. Lighter turf adds the ground's own
    /// green. White paint adds less green than red and blue, and yellow paint adds hardly any blue.
    fn are_of_brighter_turf(&self) -> bool {
        /// Minimum ratio of greenness, added colour by ground, for lighter turf. Painted lines of a
        /// drawn match have at most 0.1, mowing stripes at least 0.44.
        const GREEN: f64 = 0.35;
        /// Yellow paint has at least this much more red than blue, as a share of the colour that it
        /// adds.
        const YELLOW: f64 = 0.35;
        let added = [0, 1, 2].map(|channel| self.stroke[channel] - self.ground[channel]);
        let green = |colour: [f64; 3]| greenness(colour) / colour.iter().sum::<f64>();
        let [red, _, blue] = added;
        let all: f64 = added.iter().sum();
        all > 0.0
            && green(self.ground) > 0.0
            && green(added) > GREEN * green(self.ground)
            && (red - blue) / all < YELLOW
    }
}

/// Green less the mean of red and blue.
fn greenness([red, green, blue]: [f64; 3]) -> f64 {
    green - f64::midpoint(red, blue)
}

/// Whether a marking is brighter or darker than the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tone {
    Bright,
    Dark,
}

impl Tone {
    /// Factor that makes the marking a maximum of brightness.
    const fn sign(self) -> f32 {
        match self {
            Self::Bright => 1.0,
            Self::Dark => -1.0,
        }
    }
}

/// The marking pixels of the ground area, row by row.
fn ridges(ground: &GroundPicture, area: &GroundArea) -> Vec<RidgePixel> {
    let (width, height) = (ground.size().width as usize, ground.size().height as usize);
    let smooth = blurred(ground.grey());
    // Paint on turf is always lighter. Lines of indoor floors may be dark.
    let is_turf = ground.surface().is_turf();
    let tones: &[Tone] = if is_turf {
        &[Tone::Bright]
    } else {
        &[Tone::Bright, Tone::Dark]
    };
    let levels = is_turf.then(|| TurfLevels::of(ground, area));
    let mut found = Vec::new();
    let mut profile = Profile::default();
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            if !area.is_near(x, y) {
                continue;
            }
            let index = y * width + x;
            for tone in tones {
                // Sub-pixel maximum of the blurred brightness along the normal.
                let Some((normal, beside_px)) = bend(&smooth, index, width, *tone) else {
                    continue;
                };
                let at = ImagePoint::new(x as f64 + 0.5, y as f64 + 0.5).moved(normal * beside_px);
                let at = match tone {
                    Tone::Bright => brightest(ground.grey(), at, normal),
                    Tone::Dark => at,
                };
                // The contrast is measured in the unblurred picture: the blur lowers that of thin
                // lines.
                let Some(side_px) = contrasts(ground.grey(), at, normal, *tone) else {
                    continue;
                };
                if !has_ground_beside(area, at, normal) {
                    continue;
                }
                // With the distance of the ground known, the centre is measured again from both
                // edges.
                let at = match tone {
                    Tone::Bright => between_edges(&mut profile, ground.grey(), at, normal, side_px),
                    Tone::Dark => at,
                };
                let level = ground.grey().at(at);
                let excess = levels.as_ref().map(|levels| levels.excess(x, y, level));
                found.push(RidgePixel {
                    index,
                    at,
                    normal,
                    colours: Colours::at(ground.picture(), at, normal, side_px),
                    excess: excess.unwrap_or_default(),
                });
            }
        }
    }
    found
}

/// The normal of a ridge at a pixel, and the signed distance from the pixel's centre along it to
/// the maximum, px. None where the curvature is not that of a line, or where the maximum lies in
/// another pixel.
///
/// As in Steger 1998: n is the eigenvector of the Hessian H with the most negative eigenvalue, and
/// the maximum along n lies at t = −(n·∇I) / (nᵀ H n).
fn bend(smooth: &[f32], index: usize, width: usize, tone: Tone) -> Option<(Vec2, f64)> {
    let sign = tone.sign();
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
        .map(|step| at.moved(normal * (STEP_PX * f64::from(step))));
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
    profile: &mut Profile,
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
        near.max_by(|one, other| profile.grey(*one).total_cmp(&profile.grey(*other)))
    else {
        return at;
    };
    // Each side has a brightness of its own, averaged from one to two times `side_px` away.
    let (before, behind) = (
        profile.mean(middle, -2 * side, -side),
        profile.mean(middle, side, 2 * side),
    );
    // An edge is where the profile falls to half the contrast against that side.
    let edge = |direction: isize, ground: f64| {
        profile.falls_below(
            brightest,
            direction,
            f64::midpoint(profile.grey(brightest), ground),
            2.0 * side_px,
        )
    };
    match (edge(-1, before), edge(1, behind)) {
        (Some(from), Some(to)) => at.moved(normal * profile.offset_px(f64::midpoint(from, to))),
        _ => at,
    }
}

/// The smallest of [`SIDES_PX`] at which both sides are darker, or for dark markings brighter, than
/// the centre by the minimum contrast.
fn contrasts(grey: &GreyPicture, at: ImagePoint, normal: Vec2, tone: Tone) -> Option<f64> {
    let here = grey.at(at);
    SIDES_PX.into_iter().find(|side_px| {
        let (one, other) = (
            grey.at(at.moved(normal * *side_px)),
            grey.at(at.moved(normal * -side_px)),
        );
        let (stands_out, brighter) = match tone {
            Tone::Bright => (here - one.max(other), one.max(other)),
            Tone::Dark => (one.min(other) - here, one.max(other)),
        };
        stands_out > MIN_CONTRAST.max(MIN_CONTRAST_SHARE * brighter)
    })
}

/// Whether both sides of a point have the ground's colour. Near the border of the ground area one
/// side is enough: a boundary line may have a board beyond it.
fn has_ground_beside(area: &GroundArea, at: ImagePoint, normal: Vec2) -> bool {
    let side = |sign: f64| {
        COLOURS_PX
            .into_iter()
            .any(|beside_px| area.is_of_ground(at.moved(normal * (sign * beside_px))))
    };
    match (side(1.0), side(-1.0)) {
        (true, true) => true,
        (false, false) => false,
        _ => area.is_near_border(at),
    }
}

/// A connected component of marking pixels, with sums over them.
#[derive(Clone, Copy, Debug, Default)]
struct Component {
    /// Diagonal of its bounding box, px.
    length_px: f64,
    colours: Colours,
    excess: TurfExcess,
}

impl Component {
    /// Whether it is turf that is lighter than the turf beside it. Where the colours do not say,
    /// the brightness of the turf around decides.
    fn is_turf(&self) -> bool {
        self.colours.are_of_brighter_turf()
            || (!self.colours.are_whiter() && self.excess.is_light_turf())
    }
}

/// The marking pixels of components that are long enough; on turf without components of lighter
/// turf.
fn long_ones(ridges: &[RidgePixel], size: ImageSize, is_turf: bool) -> Vec<StrokePoint> {
    let (width, height) = (size.width as usize, size.height as usize);
    // Dilating by one pixel joins pixels across gaps of up to two pixels.
    let mut set = vec![false; width * height];
    for ridge in ridges {
        let (x, y) = (ridge.index % width, ridge.index / width);
        for y in y.saturating_sub(1)..(y + 2).min(height) {
            set[y * width + x.saturating_sub(1)..y * width + (x + 2).min(width)].fill(true);
        }
    }
    // Extent of each connected component: the diagonal of its bounding box, px.
    let mut of_part = vec![0_usize; width * height];
    let mut components: Vec<Component> = Vec::new();
    for part in parts(&set, width) {
        let extent = |of: &dyn Fn(usize) -> usize| {
            let (least, most) = part
                .iter()
                .map(|&index| of(index))
                .fold((usize::MAX, 0), |(least, most), at| {
                    (least.min(at), most.max(at))
                });
            (most - least) as f32
        };
        let length = extent(&|index| index % width).hypot(extent(&|index| index / width));
        for index in part {
            of_part[index] = components.len();
        }
        components.push(Component {
            length_px: f64::from(length),
            ..Component::default()
        });
    }
    // Colours are summed over whole components; the colour of one pixel is too noisy to decide.
    for ridge in ridges {
        let component = &mut components[of_part[ridge.index]];
        component.colours.add(&ridge.colours);
        component.excess.add(&ridge.excess);
    }
    // Dilation adds one pixel at each end.
    let least_px = (MIN_LENGTH_PX * size.scale_from_1920()).max(GRAIN_PX) + 2.0;
    let is_paint: Vec<bool> = components
        .iter()
        .map(|component| component.length_px > least_px && !(is_turf && component.is_turf()))
        .collect();
    let painted = ridges.iter().filter(|ridge| is_paint[of_part[ridge.index]]);
    painted
        .map(|ridge| StrokePoint {
            at: ridge.at,
            normal: ridge.normal,
            length_px: components[of_part[ridge.index]].length_px,
        })
        .collect()
}

/// The brightness convolved with a Gaussian of [`BLUR_PX`], truncated at 3 σ; the border pixels are
/// repeated outside.
fn blurred(grey: &GreyPicture) -> Vec<f32> {
    let (width, height) = (grey.size.width as usize, grey.size.height as usize);
    let reach = (3.0 * BLUR_PX).ceil() as isize;
    let weight = |offset: isize| (-0.5 * (offset as f32 / BLUR_PX).powi(2)).exp();
    let sum: f32 = (-reach..=reach).map(weight).sum();
    let kernel: Vec<f32> = (-reach..=reach)
        .map(|offset| weight(offset) / sum)
        .collect();
    let clamped = |at: usize, step: usize, last: usize| {
        (at as isize + step as isize - reach).clamp(0, last as isize) as usize
    };
    // The Gaussian is separable: first along rows. The inner loop runs over contiguous memory.
    let mut across = vec![0.0_f32; width * height];
    for (row, out) in grey
        .values
        .chunks_exact(width.max(1))
        .zip(across.chunks_exact_mut(width.max(1)))
    {
        let padded: Vec<f32> = (0..width + 2 * reach as usize)
            .map(|at| f32::from(row[clamped(at, 0, width - 1)]))
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
            let from = clamped(y, step, height - 1) * width;
            for (out, value) in out.iter_mut().zip(&across[from..from + width]) {
                *out += weight * value;
            }
        }
    }
    both
}

/// Side of a cell, px.
const CELL_PX: usize = 2;
const GROUND: u8 = 1;
const STROKE: u8 = 2;

/// What a picture shows, as one byte of flags for each cell of [`CELL_PX`].
#[derive(Clone, Debug)]
struct Cells {
    size: ImageSize,
    columns: usize,
    rows: usize,
    flags: Vec<u8>,
}

impl Cells {
    fn new(size: ImageSize) -> Self {
        let (columns, rows) = (
            (size.width as usize).div_ceil(CELL_PX),
            (size.height as usize).div_ceil(CELL_PX),
        );
        Self {
            size,
            columns,
            rows,
            flags: vec![0; columns * rows],
        }
    }

    fn at(&self, at: ImagePoint) -> u8 {
        if !self.size.contains(at) {
            return 0;
        }
        let (column, row) = (at.x as usize / CELL_PX, at.y as usize / CELL_PX);
        self.flags[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }

    /// Marks the 5 × 5 cells around a marking pixel.
    fn mark_stroke(&mut self, at: ImagePoint) {
        const REACH: usize = 2;
        let (column, row) = (at.x as usize / CELL_PX, at.y as usize / CELL_PX);
        for row in row.saturating_sub(REACH)..(row + REACH + 1).min(self.rows) {
            for column in column.saturating_sub(REACH)..(column + REACH + 1).min(self.columns) {
                self.flags[row * self.columns + column] |= STROKE;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawn::{PICTURE, SIZE, soccer, truth};
    use super::*;
    use std::collections::BTreeSet;
    use touchline_core::geometry::{Vec3, median};
    use touchline_core::markings::{SampleOptions, sample_lines};

    #[test]
    fn marking_pixels_are_the_painted_lines_and_nothing_else() {
        let (field, camera) = (soccer(), truth());
        let marking_pixels = MarkingPixels::of(&GroundPicture::new(&PICTURE, &[]));
        let samples = sample_lines(
            &field,
            &camera,
            SIZE,
            &SampleOptions {
                spacing_px: 4.0,
                border_px: 20.0,
            },
        );
        let seen = samples
            .iter()
            .filter(|sample| marking_pixels.shown(sample.image) == Shown::Stroke)
            .count();
        assert!(
            seen as f64 > 0.85 * samples.len() as f64,
            "{seen} of {}",
            samples.len()
        );
        // The mowing stripes go on behind the field, where they are as thin as paint.
        let on_field =
            |at: &Vec3| at.x.abs() < 0.5 * field.length_m && at.y.abs() < 0.4 * field.width_m;
        let from_paint_m = |at: Vec3| {
            let lines = field.lines.iter().filter(|line| line.painted);
            lines
                .map(|line| line.paint_centre.distance_m(at))
                .fold(f64::INFINITY, f64::min)
        };
        let places = marking_pixels
            .points
            .iter()
            .filter_map(|point| camera.plane_from_image(point.at, 0.0))
            .filter(on_field);
        let distances_m: Vec<f64> = places.map(from_paint_m).collect();
        let right = distances_m
            .iter()
            .filter(|distance_m| **distance_m < 0.4)
            .count();
        assert!(
            right as f64 > 0.9 * distances_m.len() as f64,
            "{right} of {}",
            distances_m.len()
        );
        assert_eq!(
            marking_pixels.shown(ImagePoint::new(-3.0, 5.0)),
            Shown::Other
        );
    }

    /// Turf in two stripes of mowing with a painted line between them through the middle of the
    /// picture, and the normal of the line.
    fn line_between_stripes(
        angle_deg: f64,
        width_px: f64,
        stripes: [f64; 2],
    ) -> (GroundPicture, ImagePoint, Vec2) {
        let size = ImageSize::new(160, 120);
        let (middle, normal) = (
            ImagePoint::new(80.3, 60.1),
            Vec2::new(angle_deg.to_radians().cos(), angle_deg.to_radians().sin()),
        );
        // An edge with the blur of a lens.
        let beyond = |off_px: f64| 1.0 / (1.0 + (-off_px / 0.4).exp());
        let green = |x: u32, y: u32| {
            let off_px = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
                .offset_from(middle)
                .dot(&normal);
            let paint = beyond(off_px + 0.5 * width_px) - beyond(off_px - 0.5 * width_px);
            let ground = stripes[0] + (stripes[1] - stripes[0]) * beyond(off_px);
            (ground, paint)
        };
        let pixels = (0..size.height)
            .flat_map(|y| (0..size.width).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let (ground, paint) = green(x, y);
                let channel = |share: f64| (ground * share * (1.0 - paint) + 220.0 * paint) as u8;
                [channel(0.6), channel(1.2), channel(0.4), 255]
            });
        (
            GroundPicture::new(&Picture::new(size, pixels.collect()).unwrap(), &[]),
            middle,
            normal,
        )
    }

    #[test]
    fn the_middle_of_a_stroke_stays_where_a_stripe_of_mowing_ends_there() {
        for angle_deg in [0.0, 25.0, 90.0, 160.0] {
            for width_px in [1.2, 2.5, 5.0, 9.0] {
                for stripes in [[85.0, 85.0], [80.0, 105.0], [105.0, 80.0]] {
                    let (ground, middle, normal) =
                        line_between_stripes(angle_deg, width_px, stripes);
                    let points = MarkingPixels::of(&ground).points;
                    assert!(
                        points.len() > 40,
                        "{angle_deg}°, {width_px} px, {stripes:?}: {} places",
                        points.len()
                    );
                    let mut off_px: Vec<f64> = points
                        .iter()
                        .map(|point| point.at.offset_from(middle).dot(&normal))
                        .collect();
                    let median_px = median(&mut off_px).unwrap();
                    assert!(
                        median_px.abs() < 0.2,
                        "{angle_deg}°, {width_px} px, {stripes:?}: {median_px:.2} px off"
                    );
                }
            }
        }
    }

    #[test]
    fn a_thin_stroke_has_no_gaps_where_a_stripe_of_mowing_ends_there() {
        for angle_deg in [82.0, 86.0, 98.0] {
            for width_px in [0.5, 0.8, 1.2] {
                for stripes in [[80.0, 100.0], [100.0, 75.0], [125.0, 90.0]] {
                    let (ground, ..) = line_between_stripes(angle_deg, width_px, stripes);
                    let columns: BTreeSet<u32> = MarkingPixels::of(&ground)
                        .points
                        .iter()
                        .map(|point| point.at.x as u32)
                        .collect();
                    let missing = (15..145).filter(|column| !columns.contains(column)).count();
                    assert!(
                        missing < 10,
                        "{angle_deg}°, {width_px} px, {stripes:?}: no place in {missing} columns"
                    );
                }
            }
        }
    }

    #[test]
    fn a_bright_stripe_of_mowing_is_no_stroke_and_white_and_yellow_paint_are() {
        let size = ImageSize::new(160, 120);
        let marking_pixels_of = |colour: [f64; 3]| {
            let pixels = (0..size.height * size.width).flat_map(|pixel| {
                let off_px = f64::from(pixel / size.width) + 0.5 - 60.3;
                let share = (2.5 - off_px.abs()).clamp(0.0, 1.0);
                let channel =
                    |at: usize| ([54.0, 96.0, 40.0][at] * (1.0 - share) + colour[at] * share) as u8;
                [channel(0), channel(1), channel(2), 255]
            });
            MarkingPixels::of(&GroundPicture::new(
                &Picture::new(size, pixels.collect()).unwrap(),
                &[],
            ))
            .points
            .len()
        };
        assert_eq!(marking_pixels_of([75.0, 130.0, 55.0]), 0, "brighter turf");
        for paint in [
            [120.0, 150.0, 110.0],
            [220.0, 220.0, 210.0],
            [210.0, 200.0, 50.0],
            [90.0, 120.0, 90.0],
        ] {
            assert!(marking_pixels_of(paint) > 100, "{paint:?}");
        }
    }

    #[test]
    fn a_picture_without_pixels_or_paint_has_no_marking_pixels() {
        for size in [
            ImageSize::new(0, 0),
            ImageSize::new(3, 2),
            ImageSize::new(200, 100),
        ] {
            let picture = Picture::filled(size, [60, 110, 40, 255]);
            assert!(
                MarkingPixels::of(&GroundPicture::new(&picture, &[]))
                    .points
                    .is_empty(),
                "{size:?}"
            );
        }
    }
}
