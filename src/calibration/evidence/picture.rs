//! What one picture shows at the lines that a camera predicts, beside them, and elsewhere on the
//! field.

use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
use touchline_core::markings::{LineSample, SampleOptions, sample_lines};
use touchline_vision::paint::{MarkingPixel, MarkingPixels, PixelContent};

/// Marking pixels within this distance across a line are compared with it, px at 1920 px width.
pub const REACH_PX: f64 = 12.0;

/// How far along a line a marking pixel may lie from a sample, and the distance between samples, px
/// at 1920 px width.
const ALONG_PX: f64 = 3.0;
const SPACING_PX: f64 = 2.0 * ALONG_PX;

/// Places parallel to a line that show how often paint is where no line is: this far on both sides,
/// px at 1920 px width, so that a line's own paint is out of reach.
const BESIDE_PX: [f64; 4] = [-34.0, -22.0, 22.0, 34.0];

/// One sample in so many has its parallel places read: a rate needs fewer than a sum.
const SAMPLES_PER_BESIDE: usize = 3;

/// The least cosine between the directions of a line and of a marking pixel that may be its paint.
const MIN_COS: f64 = 0.87;

/// The side of a stretch of a line, or of a place of the ground, as a share of the diagonal of the
/// field: about 2 m on a soccer pitch.
const STRETCH_SHARE: f64 = 1.0 / 62.0;

/// Paint within this share of the field's diagonal beside the field lies on the field, too.
const RUN_OFF_SHARE: f64 = 0.06;

/// A place of the ground, in units of a stretch.
pub type GroundCell = (i32, i32);

/// A sample of a line on open ground.
pub struct SeenSample {
    /// The line, by its index in the field.
    pub line: usize,
    /// Where on the ground.
    pub cell: GroundCell,
    /// How surely paint would be seen here, 0 to 1.
    pub detectability: f64,
    /// The distance across the line to the nearest marking pixel of its direction, px at 1920 px
    /// width; none within reach.
    pub offset_px: Option<f64>,
}

/// What a picture shows with a camera.
#[derive(Default)]
pub struct SeenPicture {
    pub samples: Vec<SeenSample>,
    /// Places of open ground beside the lines, and those of them with a marking pixel in reach.
    pub num_beside: usize,
    pub num_beside_painted: usize,
    /// Marking pixels on the field: where, and whether a line explains them.
    pub paint: Vec<(GroundCell, bool)>,
}

impl SeenPicture {
    /// Compares the marking pixels of a picture with the lines of a field.
    pub fn look(field: &FieldModel, camera: &PtzCamera, marking_pixels: &MarkingPixels) -> Self {
        let size = marking_pixels.size();
        let scale = size.scale_from_1920();
        let options = SampleOptions {
            spacing_px: SPACING_PX * scale,
            border_px: SPACING_PX * scale,
        };
        let samples = sample_lines(field, camera, size, &options);
        let markings = Nearby::new(&marking_pixels.points, size, |pixel| pixel.at);
        let lines = Nearby::new(&samples, size, |sample| sample.image);
        let is_open = |at| marking_pixels.classify(at) != PixelContent::Other;
        let ground = Ground::of(field);

        let mut seen = Self::default();
        for sample in samples.iter().filter(|sample| is_open(sample.image)) {
            seen.samples.push(SeenSample {
                line: sample.line,
                cell: ground.cell(sample.at),
                detectability: sample.detectability(),
                offset_px: marking_across(&markings, sample.image, sample.normal, scale),
            });
        }
        for sample in samples.iter().step_by(SAMPLES_PER_BESIDE) {
            let beside = BESIDE_PX
                .map(|shift_px| sample.image.translate(sample.normal * (shift_px * scale)));
            // Ground that another line crosses is not bare.
            let is_bare = |at: &ImagePoint| {
                let clear_px = (REACH_PX + ALONG_PX) * scale;
                let is_clear = |line: &LineSample| line.image.distance_px(*at) > clear_px;
                size.contains(*at) && is_open(*at) && lines.around(*at).all(is_clear)
            };
            for at in beside.into_iter().filter(is_bare) {
                let painted = marking_across(&markings, at, sample.normal, scale);
                seen.num_beside += 1;
                seen.num_beside_painted += usize::from(painted.is_some());
            }
        }
        for pixel in &marking_pixels.points {
            let on_field = camera
                .plane_from_image(pixel.at, 0.0)
                .filter(|at| ground.holds(*at));
            if let Some(at) = on_field {
                seen.paint
                    .push((ground.cell(at), is_explained(pixel, &lines, scale)));
            }
        }
        seen
    }
}

/// The distance across a line, px at 1920 px width, of the nearest marking pixel of its direction.
fn marking_across(
    markings: &Nearby<'_, MarkingPixel>,
    at: ImagePoint,
    normal: Vec2,
    scale: f64,
) -> Option<f64> {
    markings
        .around(at)
        .filter(|pixel| pixel.normal.dot(&normal).abs() >= MIN_COS)
        .filter_map(|pixel| offset_within_reach(pixel.at, at, normal, ALONG_PX, scale))
        .min_by(f64::total_cmp)
}

/// Whether a line of its direction lies in reach of a marking pixel.
fn is_explained(pixel: &MarkingPixel, lines: &Nearby<'_, LineSample>, scale: f64) -> bool {
    lines
        .around(pixel.at)
        .filter(|sample| sample.normal.dot(&pixel.normal).abs() >= MIN_COS)
        .any(|sample| {
            offset_within_reach(pixel.at, sample.image, sample.normal, SPACING_PX, scale).is_some()
        })
}

/// The distance of a point from a line across it, px at 1920 px width. None if it lies out of
/// reach, or farther along the line than `along_px`.
fn offset_within_reach(
    at: ImagePoint,
    on_line: ImagePoint,
    normal: Vec2,
    along_px: f64,
    scale: f64,
) -> Option<f64> {
    let off = at.offset_from(on_line) / scale;
    let across = off.dot(&normal);
    let along = (off - normal * across).norm();
    (across.abs() <= REACH_PX && along <= along_px).then_some(across.abs())
}

/// Things in a picture, by where they lie.
struct Nearby<'a, T> {
    /// Row by row, with an empty cell around the picture.
    cells: Vec<Vec<&'a T>>,
    columns: usize,
    cell_px: f64,
}

impl<'a, T> Nearby<'a, T> {
    fn new(things: &'a [T], size: ImageSize, at: fn(&T) -> ImagePoint) -> Self {
        let cell_px = (REACH_PX + SPACING_PX) * size.scale_from_1920();
        let [columns, rows] =
            [size.width, size.height].map(|px| (f64::from(px) / cell_px) as usize + 3);
        let mut cells = vec![Vec::new(); columns * rows];
        for thing in things {
            let [column, row] = cell_of(at(thing), cell_px);
            cells[row * columns + column].push(thing);
        }
        Self {
            cells,
            columns,
            cell_px,
        }
    }

    /// All things in reach of a point of the picture, and some beyond it.
    fn around(&self, at: ImagePoint) -> impl Iterator<Item = &'a T> {
        let [column, row] = cell_of(at, self.cell_px);
        let first_of_rows = [row - 1, row, row + 1].map(|row| row * self.columns + column - 1);
        first_of_rows
            .into_iter()
            .flat_map(|first| &self.cells[first..first + 3])
            .flatten()
            .copied()
    }
}

/// Column and row of a point of the picture, from 1 on.
fn cell_of(at: ImagePoint, cell_px: f64) -> [usize; 2] {
    [at.x, at.y].map(|px| (px / cell_px) as usize + 1)
}

/// The ground of a field, in stretches.
struct Ground {
    stretch_m: f64,
    /// Half of the length and of the width of what counts as the field, m.
    half_m: [f64; 2],
}

impl Ground {
    fn of(field: &FieldModel) -> Self {
        let diagonal_m = field.length_m.hypot(field.width_m);
        let run_off_m = RUN_OFF_SHARE * diagonal_m;
        Self {
            stretch_m: STRETCH_SHARE * diagonal_m,
            half_m: [field.length_m, field.width_m].map(|side_m| 0.5 * side_m + run_off_m),
        }
    }

    fn cell(&self, at: Vec3) -> GroundCell {
        let [x, y] = [at.x, at.y].map(|m| (m / self.stretch_m).floor() as i32);
        (x, y)
    }

    fn holds(&self, at: Vec3) -> bool {
        at.x.abs() < self.half_m[0] && at.y.abs() < self.half_m[1]
    }
}
