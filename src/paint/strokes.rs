//! Painted strokes of a picture, found without any camera: thin and long, brighter than the ground on both sides, or darker where
//! that is a floor.
//!
//! The middle of a stroke is where the blurred brightness, cut across the direction in which it bends most, has its maximum
//! (Steger, "An unbiased detector of curvilinear structures", PAMI 1998).

use super::GroundPicture;
use super::ground_area::{GroundArea, parts};
use crate::geometry::{ImagePoint, ImageSize, Vec2};
use crate::media::GreyPicture;

/// How far beside a stroke the ground is compared with it, px: the nearest suits thin lines, the farthest those near the
/// camera.
const SIDES_PX: [f64; 3] = [4.0, 8.0, 14.0];

/// Paint is brighter than the ground on both sides by at least this many grey levels, and by this share.
const MIN_CONTRAST: f64 = 4.5;
const MIN_CONTRAST_SHARE: f64 = 0.045;

/// The ground is asked for its colour this far beside a stroke, px; one of them is enough.
const COLOURS_PX: [f64; 3] = [8.0, 10.0, 12.0];

/// The picture is blurred with this standard deviation before its curvature is taken, px.
const BLUR_PX: f32 = 2.0;

/// The brightness of the blurred picture bends at least as much across a stroke, grey levels / px².
const MIN_BEND: f32 = 0.25;

/// Along a stroke it bends at most by this share of that.
const MAX_BEND_ALONG: f32 = 0.6;

/// A stroke is at least this long, px at 1920 px width, but for the pixels that its ends add.
const MIN_LENGTH_PX: f64 = 28.0;

/// In smaller pictures it is at least this long, px: the blur draws out the grain of the ground to shorter strokes.
const GRAIN_PX: f64 = 20.0;

/// A place on a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokePoint {
    /// The middle of the stroke, px of the picture.
    pub at: ImagePoint,
    /// The unit vector across the stroke.
    pub normal: Vec2,
    /// How long the stroke is from end to end, px.
    pub length_px: f64,
}

/// The strokes of a picture, and where it shows ground.
#[derive(Clone, Debug)]
pub struct Strokes {
    /// Places on strokes, row by row.
    pub points: Vec<StrokePoint>,
    cells: Cells,
}

/// What a picture shows at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A stroke, within a few px.
    Stroke,
    /// Ground without paint.
    Ground,
    /// Something else, or nothing: it lies outside.
    Other,
}

impl Strokes {
    /// The strokes of a picture.
    #[must_use]
    pub fn of(ground: &GroundPicture) -> Self {
        let size = ground.size();
        let area = GroundArea::of(ground);
        let mut cells = Cells::new(size);
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                if area.holds(column * CELL_PX, row * CELL_PX) {
                    cells.flags[row * cells.columns + column] |= GROUND;
                }
            }
        }
        let ridges = ridges(ground, &area);
        let points = long_ones(&ridges, size);
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

    /// Columns and rows of the picture.
    #[must_use]
    pub const fn size(&self) -> ImageSize {
        self.cells.size
    }
}

/// The middle of a stroke in one pixel.
struct RidgePixel {
    index: usize,
    at: ImagePoint,
    normal: Vec2,
}

/// Whether a stroke is brighter than the ground or darker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tone {
    Bright,
    Dark,
}

impl Tone {
    /// By which the brightness is multiplied so that strokes are bright.
    const fn sign(self) -> f32 {
        match self {
            Self::Bright => 1.0,
            Self::Dark => -1.0,
        }
    }
}

/// The middles of all strokes, row by row.
fn ridges(ground: &GroundPicture, area: &GroundArea) -> Vec<RidgePixel> {
    let (width, height) = (ground.size().width as usize, ground.size().height as usize);
    let smooth = blurred(ground.grey());
    let tones: &[Tone] = if ground.surface().is_turf() { &[Tone::Bright] } else { &[Tone::Bright, Tone::Dark] };
    let mut found = Vec::new();
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            if !area.is_near(x, y) {
                continue;
            }
            let index = y * width + x;
            for tone in tones {
                let Some((normal, beside_px)) = bend(&smooth, index, width, *tone) else { continue };
                let at = ImagePoint::new(x as f64 + 0.5, y as f64 + 0.5).moved(normal * beside_px);
                if contrasts(ground.grey(), at, normal, *tone) && has_ground_beside(area, at, normal) {
                    found.push(RidgePixel { index, at, normal });
                }
            }
        }
    }
    found
}

/// The direction across a stroke at a pixel, and how far along it the middle lies, px; none where that is in another pixel
/// or the picture does not bend like a stroke.
fn bend(smooth: &[f32], index: usize, width: usize, tone: Tone) -> Option<(Vec2, f64)> {
    let sign = tone.sign();
    let at = |dx: isize, dy: isize| sign * smooth[index.wrapping_add_signed(dy * width as isize + dx)];
    let (centre, left, right, above, below) = (at(0, 0), at(-1, 0), at(1, 0), at(0, -1), at(0, 1));
    let (xx, yy) = (left - 2.0 * centre + right, above - 2.0 * centre + below);
    if xx + yy > -MIN_BEND * (1.0 - MAX_BEND_ALONG) {
        return None;
    }
    let (x, y) = (0.5 * (right - left), 0.5 * (below - above));
    let xy = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
    let (mean, spread) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (across, along) = (mean - spread, mean + spread);
    if across > -MIN_BEND || along.abs() > MAX_BEND_ALONG * across.abs() {
        return None;
    }
    // The eigenvector of the greater bend.
    let turn = 0.5 * (2.0 * xy).atan2(xx - yy) + std::f32::consts::FRAC_PI_2;
    let (normal_y, normal_x) = turn.sin_cos();
    let beside = -(x * normal_x + y * normal_y) / across;
    let within = (beside * normal_x).abs() <= 0.6 && (beside * normal_y).abs() <= 0.6;
    within.then(|| (Vec2::new(f64::from(normal_x), f64::from(normal_y)), f64::from(beside)))
}

/// Whether a place is brighter than the ground on both sides, or darker.
fn contrasts(grey: &GreyPicture, at: ImagePoint, normal: Vec2, tone: Tone) -> bool {
    let here = grey.at(at);
    SIDES_PX.into_iter().any(|side_px| {
        let (one, other) = (grey.at(at.moved(normal * side_px)), grey.at(at.moved(normal * -side_px)));
        let (stands_out, brighter) = match tone {
            Tone::Bright => (here - one.max(other), one.max(other)),
            Tone::Dark => (one.min(other) - here, one.max(other)),
        };
        stands_out > MIN_CONTRAST.max(MIN_CONTRAST_SHARE * brighter)
    })
}

/// Whether the ground's colours lie on both sides of a place; on one side near the border of the ground.
fn has_ground_beside(area: &GroundArea, at: ImagePoint, normal: Vec2) -> bool {
    let side =
        |sign: f64| COLOURS_PX.into_iter().any(|beside_px| area.is_of_ground(at.moved(normal * (sign * beside_px))));
    match (side(1.0), side(-1.0)) {
        (true, true) => true,
        (false, false) => false,
        _ => area.is_near_border(at),
    }
}

/// Places on strokes that are long enough, row by row.
fn long_ones(ridges: &[RidgePixel], size: ImageSize) -> Vec<StrokePoint> {
    let (width, height) = (size.width as usize, size.height as usize);
    // Strokes are joined over gaps of two pixels.
    let mut set = vec![false; width * height];
    for ridge in ridges {
        let (x, y) = (ridge.index % width, ridge.index / width);
        for y in y.saturating_sub(1)..(y + 2).min(height) {
            set[y * width + x.saturating_sub(1)..y * width + (x + 2).min(width)].fill(true);
        }
    }
    let mut length_px = vec![0.0_f32; width * height];
    for part in parts(&set, width) {
        let extent = |of: &dyn Fn(usize) -> usize| {
            let (least, most) = part
                .iter()
                .map(|&index| of(index))
                .fold((usize::MAX, 0), |(least, most), at| (least.min(at), most.max(at)));
            (most - least) as f32
        };
        let length = extent(&|index| index % width).hypot(extent(&|index| index / width));
        for index in part {
            length_px[index] = length;
        }
    }
    let least_px = (MIN_LENGTH_PX * size.scale_from_1920()).max(GRAIN_PX) + 2.0;
    let long = ridges.iter().filter(|ridge| f64::from(length_px[ridge.index]) > least_px);
    long.map(|ridge| StrokePoint { at: ridge.at, normal: ridge.normal, length_px: f64::from(length_px[ridge.index]) })
        .collect()
}

/// The brightness, blurred by [`BLUR_PX`].
fn blurred(grey: &GreyPicture) -> Vec<f32> {
    let (width, height) = (grey.size.width as usize, grey.size.height as usize);
    let reach = (3.0 * BLUR_PX).ceil() as isize;
    let weight = |offset: isize| (-0.5 * (offset as f32 / BLUR_PX).powi(2)).exp();
    let sum: f32 = (-reach..=reach).map(weight).sum();
    let kernel: Vec<f32> = (-reach..=reach).map(|offset| weight(offset) / sum).collect();
    let clamped =
        |at: usize, step: usize, last: usize| (at as isize + step as isize - reach).clamp(0, last as isize) as usize;
    let mut across = vec![0.0_f32; width * height];
    for (row, out) in grey.values.chunks_exact(width.max(1)).zip(across.chunks_exact_mut(width.max(1))) {
        let padded: Vec<f32> =
            (0..width + 2 * reach as usize).map(|at| f32::from(row[clamped(at, 0, width - 1)])).collect();
        for (step, weight) in kernel.iter().enumerate() {
            for (out, value) in out.iter_mut().zip(&padded[step..]) {
                *out += weight * value;
            }
        }
    }
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

/// The side of a cell, px.
const CELL_PX: usize = 2;
const GROUND: u8 = 1;
const STROKE: u8 = 2;

/// What a picture shows, cell by cell.
#[derive(Clone, Debug)]
struct Cells {
    size: ImageSize,
    columns: usize,
    rows: usize,
    flags: Vec<u8>,
}

impl Cells {
    fn new(size: ImageSize) -> Self {
        let (columns, rows) = ((size.width as usize).div_ceil(CELL_PX), (size.height as usize).div_ceil(CELL_PX));
        Self { size, columns, rows, flags: vec![0; columns * rows] }
    }

    fn at(&self, at: ImagePoint) -> u8 {
        if !self.size.contains(at) {
            return 0;
        }
        let (column, row) = (at.x as usize / CELL_PX, at.y as usize / CELL_PX);
        self.flags[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }

    /// Marks the cells around a place on a stroke.
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
    use crate::geometry::Vec3;
    use crate::markings::{SampleOptions, sample_lines};

    #[test]
    fn strokes_are_the_painted_lines_and_nothing_else() {
        let (field, camera) = (soccer(), truth());
        let strokes = Strokes::of(&GroundPicture::new(&PICTURE, &[]));
        let samples = sample_lines(&field, &camera, SIZE, &SampleOptions { spacing_px: 4.0, border_px: 20.0 });
        let seen = samples.iter().filter(|sample| strokes.shown(sample.image) == Shown::Stroke).count();
        assert!(seen as f64 > 0.85 * samples.len() as f64, "{seen} of {}", samples.len());
        // The mowing stripes go on behind the field, where they are as thin as paint.
        let on_field = |at: &Vec3| at.x.abs() < 0.5 * field.length_m && at.y.abs() < 0.4 * field.width_m;
        let from_paint_m = |at: Vec3| {
            let lines = field.lines.iter().filter(|line| line.painted);
            lines.map(|line| line.paint_centre.distance_m(at)).fold(f64::INFINITY, f64::min)
        };
        let places = strokes.points.iter().filter_map(|point| camera.plane_from_image(point.at, 0.0)).filter(on_field);
        let distances_m: Vec<f64> = places.map(from_paint_m).collect();
        let right = distances_m.iter().filter(|distance_m| **distance_m < 0.4).count();
        assert!(right as f64 > 0.9 * distances_m.len() as f64, "{right} of {}", distances_m.len());
        assert_eq!(strokes.shown(ImagePoint::new(-3.0, 5.0)), Shown::Other);
    }

    #[test]
    fn a_picture_without_pixels_or_paint_has_no_strokes() {
        use crate::media::Picture;
        for size in [ImageSize::new(0, 0), ImageSize::new(3, 2), ImageSize::new(200, 100)] {
            let picture = Picture::filled(size, [60, 110, 40, 255]);
            assert!(Strokes::of(&GroundPicture::new(&picture, &[])).points.is_empty(), "{size:?}");
        }
    }
}
