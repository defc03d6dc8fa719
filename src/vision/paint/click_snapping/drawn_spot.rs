//! The template of a point marking as a camera sees it, blurred, and the least-squares problem that
//! aligns it with a picture.

use super::lines_through;
use nalgebra::{Matrix2, RowVector4, Vector1, Vector4};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{Vec2, Vec3};
use touchline_core::solve::{BlockEquations, Linearised, Loss, Problem, Residual};

/// Minimum diameter of a marking along its short axis, px. Smaller ones drown in noise.
const NARROWEST_PX: f64 = 1.1;

/// Maximum diameter of a marking, px at 1920 px width. No user means a click on a larger one.
const WIDEST_PX: f64 = 80.0;

/// Standard deviation of the blur by optics, compression and the area of a pixel, px.
const BLUR_PX: f64 = 0.8;

/// Margin of the template around the marking, px.
const AROUND_PX: f64 = 4.0;

/// Samples of the template per px and axis.
const FINE: f64 = 4.0;

/// The share, 0 to 1, of each point around a marking's centre that paint covers: the marking and
/// the lines through it.
pub(super) struct Shape {
    /// Half the extent in x and y, px.
    pub half: [i32; 2],
    /// Ground from picture, linearised at the landmark, m/px.
    pub metres_a_px: Matrix2<f64>,
    columns: usize,
    /// Coverage, row by row, [`FINE`] samples per px, centred on the marking.
    covers: Vec<f32>,
}

impl Shape {
    /// The template of a marking of this diameter at a landmark; `scale` is the width of the
    /// picture by 1920 px. None if the camera does not see the landmark, or if the marking would be
    /// too small or too large in the picture.
    pub fn render(
        field: &FieldModel,
        camera: &PtzCamera,
        landmark: &Landmark,
        diameter_m: f64,
        scale: f64,
    ) -> Option<Self> {
        // The mapping from ground to picture is linearised at the landmark: a marking is small.
        let here = camera
            .image_from_world_jacobian(field.landmark_in_world(landmark))
            .ok()?;
        let px_a_metre: Matrix2<f64> = here.by_world.fixed_columns::<2>(0).into_owned();
        let metres_a_px = px_a_metre.try_inverse()?;
        if !px_a_metre.iter().all(|value| value.is_finite()) {
            return None;
        }
        // A circle of radius r becomes the ellipse J·(r e). Its half extent along an axis is r
        // times the norm of that row of J, its shortest half axis r times the smallest singular
        // value.
        let radius_m = 0.5 * diameter_m;
        let narrow_px = 2.0 * radius_m * px_a_metre.svd(false, false).singular_values.min();
        let [half_x, half_y] = [0, 1].map(|axis| radius_m * px_a_metre.row(axis).norm());
        if !(narrow_px >= NARROWEST_PX && half_x.max(half_y) <= 0.5 * WIDEST_PX * scale) {
            return None;
        }
        let half = [half_x, half_y].map(|half| (half + AROUND_PX).ceil() as i32);
        let lines = lines_through(field, landmark);
        // A margin for the blur and for offsets between pixels. The number of cells is odd, so that
        // one lies on the centre of the marking.
        let cells = half.map(|half| 2 * ((f64::from(half) + 4.0) * FINE) as usize + 1);
        let at = |cell: usize, cells: usize| (cell as f64 - (cells / 2) as f64) / FINE;
        // Sharp template: a sample is covered if its point on the ground lies within the marking or
        // within half a line's width of the centre of a line.
        let covered = |index: usize| {
            let px = Vec2::new(
                at(index % cells[0], cells[0]),
                at(index / cells[0], cells[1]),
            );
            let metres = metres_a_px * px;
            let world = landmark.nominal_m + Vec3::new(metres.x, metres.y, 0.0);
            let on_line = |line: &usize| {
                let line = &field.lines[*line];
                line.paint_centre.distance_m(world) <= 0.5 * line.width_m
            };
            f32::from(u8::from(
                metres.norm() <= radius_m || lines.iter().any(on_line),
            ))
        };
        let sharp: Vec<f32> = (0..cells[0] * cells[1]).map(covered).collect();
        Some(Self {
            half,
            metres_a_px,
            columns: cells[0],
            covers: gaussian_blur(&sharp, cells[0]),
        })
    }

    /// Coverage at `off` from the marking's centre, px; bilinear between samples.
    pub fn covers(&self, off: Vec2) -> f64 {
        // The last cell but one is the limit, so that there is a next one to interpolate to.
        // Outside the template its border, where nothing or a line is painted, continues.
        let rows = self.covers.len() / self.columns;
        let x = (off.x * FINE + (self.columns / 2) as f64).clamp(0.0, (self.columns - 2) as f64);
        let y = (off.y * FINE + (rows / 2) as f64).clamp(0.0, (rows - 2) as f64);
        let (column, row) = (x as usize, y as usize);
        let (share_x, share_y) = (x - column as f64, y - row as f64);
        let value = |row: usize, column: usize| f64::from(self.covers[row * self.columns + column]);
        let along =
            |row: usize| value(row, column) * (1.0 - share_x) + value(row, column + 1) * share_x;
        along(row) * (1.0 - share_y) + along(row + 1) * share_y
    }
}

/// Convolution with a Gaussian of [`BLUR_PX`], truncated at 3 σ, rows and columns separately; the
/// border is repeated outside.
fn gaussian_blur(sharp: &[f32], columns: usize) -> Vec<f32> {
    // The marking is rendered once and read at every pixel and offset. So the blur is applied to
    // the table, which is finer than the pixels, and not to each comparison.
    let sigma = BLUR_PX * FINE;
    let reach = (3.0 * sigma).ceil() as isize;
    let weights: Vec<f32> = (-reach..=reach)
        .map(|at| (-0.5 * (at as f64 / sigma).powi(2)).exp() as f32)
        .collect();
    let sum: f32 = weights.iter().sum();
    let rows = sharp.len() / columns;
    // One pass along rows, one along columns: a Gaussian is separable.
    let pass = |of: &[f32], along_rows: bool| -> Vec<f32> {
        let value = |row: usize, column: usize, by: isize| {
            let moved = |at: usize, count: usize| at.saturating_add_signed(by).min(count - 1);
            if along_rows {
                of[row * columns + moved(column, columns)]
            } else {
                of[moved(row, rows) * columns + column]
            }
        };
        let blurred = |index: usize| {
            let (row, column) = (index / columns, index % columns);
            let weighed = weights
                .iter()
                .zip(-reach..=reach)
                .map(|(weight, by)| weight * value(row, column, by));
            weighed.sum::<f32>() / sum
        };
        (0..of.len()).map(blurred).collect()
    };
    pass(&pass(sharp, true), false)
}

/// Maximum step of one iteration along an axis, px.
const MAX_STEP_PX: f64 = 1.0;

/// A template drawn over a picture: grey level = level + contrast · coverage.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnSpot {
    /// Offset from the centre of the pixels, px.
    pub by: Vec2,
    pub contrast: f64,
    /// Grey level where nothing is covered.
    pub level: f64,
}

/// Least squares of a template's offset, contrast and level over the grey levels of some pixels.
pub(super) struct SpotProblem<'a> {
    pub shape: &'a Shape,
    /// Position relative to the centre, px, and grey level of each pixel.
    pub pixels: &'a [(Vec2, f64)],
}

impl Problem for SpotProblem<'_> {
    type State = DrawnSpot;
    type Equations = BlockEquations<0, 4>;

    fn equations(&self, spot: &DrawnSpot) -> BlockEquations<0, 4> {
        let mut equations = BlockEquations::zero();
        // All residuals have σ = 1 grey level; the caller scales the covariance by the noise it
        // measures.
        for &(off, grey) in self.pixels {
            equations.add(
                &SpotPixel {
                    shape: self.shape,
                    off,
                    grey,
                },
                spot,
                Loss::Squared,
            );
        }
        equations
    }

    fn apply_step(&self, from: &DrawnSpot, step: &Vector4<f64>) -> DrawnSpot {
        // Coverage is linear in the offset only within the blurred edge of the marking, about a px.
        // Contrast and level are linear everywhere.
        let by = step
            .fixed_rows::<2>(0)
            .map(|by| by.clamp(-MAX_STEP_PX, MAX_STEP_PX));
        DrawnSpot {
            by: from.by + by,
            contrast: from.contrast + step[2],
            level: from.level + step[3],
        }
    }
}

/// The residual of one pixel, grey levels.
struct SpotPixel<'a> {
    shape: &'a Shape,
    off: Vec2,
    grey: f64,
}

impl Residual<1, 0, 4> for SpotPixel<'_> {
    type State = DrawnSpot;

    fn sigma(&self) -> f64 {
        1.0
    }

    fn value(&self, spot: &DrawnSpot) -> Option<Vector1<f64>> {
        Some(Vector1::new(
            spot.level + spot.contrast * self.shape.covers(self.off - spot.by) - self.grey,
        ))
    }

    fn linearise(&self, spot: &DrawnSpot) -> Option<Linearised<1, 0, 4>> {
        /// Half the base of central differences. The template is a table with [`FINE`] samples per
        /// px, so the slope is taken between neighbouring samples.
        const NEIGHBOUR_PX: f64 = 1.0 / FINE;
        let off = self.off - spot.by;
        let covers = |x: f64, y: f64| self.shape.covers(off + Vec2::new(x, y));
        let slope = Vec2::new(
            covers(NEIGHBOUR_PX, 0.0) - covers(-NEIGHBOUR_PX, 0.0),
            covers(0.0, NEIGHBOUR_PX) - covers(0.0, -NEIGHBOUR_PX),
        ) / (2.0 * NEIGHBOUR_PX);
        // Columns: offset x and y, contrast, level. The template moves with the offset, hence the
        // minus.
        let by_own = RowVector4::new(
            -spot.contrast * slope.x,
            -spot.contrast * slope.y,
            covers(0.0, 0.0),
            1.0,
        );
        Some(Linearised::without_shared(self.value(spot)?, by_own))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{soccer, truth};

    #[test]
    fn a_pixel_changes_with_place_contrast_and_level_as_its_derivatives_say() {
        let field = soccer();
        let shape = Shape::render(
            &field,
            &truth(),
            field.landmark("centre_mark").unwrap(),
            1.0,
            1.0,
        )
        .unwrap();
        let spot = DrawnSpot {
            by: Vec2::new(0.3, -0.2),
            contrast: 70.0,
            level: 90.0,
        };
        let problem = SpotProblem {
            shape: &shape,
            pixels: &[],
        };
        for off in [
            Vec2::new(0.4, 1.3),
            Vec2::new(-2.1, 0.6),
            Vec2::new(3.0, -1.7),
        ] {
            let pixel = SpotPixel {
                shape: &shape,
                off,
                grey: 120.0,
            };
            let by_own = pixel.linearise(&spot).unwrap().by_own;
            // The place over the distance of the table's values, contrast and level over any.
            for (parameter, step) in [1.0 / FINE, 1.0 / FINE, 0.5, 0.5].into_iter().enumerate() {
                let by = Vector4::ith(parameter, step);
                let value =
                    |by: Vector4<f64>| pixel.value(&problem.apply_step(&spot, &by)).unwrap()[0];
                let numeric = (value(by) - value(-by)) / (2.0 * step);
                let error = (by_own[parameter] - numeric).abs();
                assert!(
                    error < 1e-9 * (1.0 + numeric.abs()),
                    "parameter {parameter} at {off:?}: {error}"
                );
            }
        }
    }
}
