//! A placed point moved to the painted spot that its landmark names: a penalty mark, a face-off spot, the mark in the middle of a
//! halfway line.
//!
//! The spot, and the lines through it, are drawn as the camera sees them, blurred, and laid over the picture where they explain
//! most of it. Another place that explains nearly as much, or paint of another shape, gives no result.

use super::GroundPicture;
use super::placed_point::{LINE_SIGMA_PX, PointSnapOptions, SnappedPoint, lines_through};
use nalgebra::{Matrix2, Matrix4, Vector4};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};

/// Spots are painted as large as the rule says times one of these.
const SIZES: [f64; 4] = [0.7, 0.85, 1.0, 1.3];

/// A spot covers at least this many pixels across its narrow side, px; smaller ones are noise.
const NARROWEST_PX: f64 = 1.1;

/// A spot larger than this is none that a click is meant to hit, px at 1920 px width.
const WIDEST_PX: f64 = 80.0;

/// The standard deviation of the blur of optics, compression and the pixels themselves, px.
const BLUR_PX: f64 = 0.8;

/// The picture is compared this far around the spot, px.
const AROUND_PX: f64 = 4.0;

/// The places at which a spot is drawn before it is blurred, a px.
const FINE: f64 = 4.0;

/// The spot stands out from the ground by at least this, grey levels.
const MIN_CONTRAST: f64 = 8.0;

/// At least this share of the squares about the mean is the drawn spot's.
const MIN_EXPLAINED: f64 = 0.7;

/// A little beside the best place, px at 1920 px width, the drawn spot leaves so many times the squares.
const BESIDE_PX: f64 = 3.0;
const MUCH_WORSE: f64 = 1.6;

/// Another spot within reach explains at most this share of what the best one does.
const RIVAL: f64 = 0.6;

/// Another spot is at least this many diameters away, on the ground.
const ANOTHER: f64 = 1.2;

/// This share of what surrounds the spot has the ground's colours.
const ON_GROUND: f64 = 0.7;

/// The noise of a picture is at least this, grey levels.
const LEAST_NOISE: f64 = 1.5;

/// Neighbouring pixels err together: as if only this share of them were seen.
const INDEPENDENT: f64 = 0.25;

/// How often the place is refined.
const STEPS: usize = 6;

/// Moves a placed point to the spot that is painted around a landmark; none where it has none, or where the picture does not
/// show it for certain. `camera` need not be exact: its scale and the direction it looks in are taken from it.
pub(super) fn snap_spot(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    landmark: &Landmark,
    placed: ImagePoint,
    options: &PointSnapOptions,
) -> Option<SnappedPoint> {
    let scale = ground.size().scale_from_1920();
    let diameter_m = landmark.spot_diameter_m?;
    let shapes = SIZES.into_iter().filter_map(|size| Shape::of(field, camera, landmark, size * diameter_m, scale));
    let reach = (options.reach_px * scale).ceil() as i32;
    let looked: Vec<Look> = shapes.map(|shape| Look::of(ground, placed, shape, reach)).collect();
    let all = || looked.iter().flat_map(|look| look.fits.iter().map(move |fit| (look, fit)));
    let (look, best) = all().max_by(|a, b| a.1.explained.total_cmp(&b.1.explained))?;
    let another = |fit: &Fit| (look.shape.metres_a_px * (fit.shift - best.shift)).norm() > ANOTHER * diameter_m;
    let is_alone = lines_through(field, landmark).is_empty();
    if is_alone && all().any(|(_, fit)| another(fit) && fit.explained > RIVAL * best.explained) {
        return None;
    }
    let refined = look.refined(ground, best, BESIDE_PX * scale.max(0.5))?;
    let (shift, sigma_px) = (refined.shift, refined.sigma_px.hypot(LINE_SIGMA_PX * scale));
    let is_paint = refined.contrast.abs() >= MIN_CONTRAST
        && (refined.contrast > 0.0 || !ground.surface().is_turf())
        && refined.explained >= MIN_EXPLAINED
        && look.lies_on_ground(ground, shift);
    let is_certain = shift.norm() <= options.reach_px * scale && sigma_px <= options.max_sigma_px * scale;
    (is_paint && is_certain).then(|| SnappedPoint { image: placed.moved(shift), sigma_px })
}

/// A spot and the lines through it as a camera sees them: how much of it covers each place around its middle.
struct Shape {
    /// Half of its extent in each direction, px.
    half: [i32; 2],
    /// From the picture to the ground.
    metres_a_px: Matrix2<f64>,
    columns: usize,
    /// Rows of values between 0 and 1, [`FINE`] a px, around the middle.
    covers: Vec<f32>,
}

impl Shape {
    fn of(field: &FieldModel, camera: &PtzCamera, landmark: &Landmark, diameter_m: f64, scale: f64) -> Option<Self> {
        let here = camera.image_from_world_jacobian(field.landmark_in_world(landmark)).ok()?;
        let px_a_metre: Matrix2<f64> = here.by_world.fixed_columns::<2>(0).into_owned();
        let metres_a_px = px_a_metre.try_inverse()?;
        if !px_a_metre.iter().all(|value| value.is_finite()) {
            return None;
        }
        // The extents of an ellipse along the picture's axes, and its narrow side.
        let radius_m = 0.5 * diameter_m;
        let extent = |axis: usize| radius_m * px_a_metre.row(axis).norm();
        let narrow_px = 2.0 * radius_m * px_a_metre.svd(false, false).singular_values.min();
        let (half_x, half_y) = (extent(0), extent(1));
        if !(narrow_px >= NARROWEST_PX && half_x.max(half_y) <= 0.5 * WIDEST_PX * scale) {
            return None;
        }
        let half = [half_x, half_y].map(|half| (half + AROUND_PX).ceil() as i32);
        let lines = lines_through(field, landmark);
        // A margin for the blur and for places between pixels.
        let cells = half.map(|half| 2 * ((f64::from(half) + 4.0) * FINE) as usize + 1);
        let at = |cell: usize, cells: usize| (cell as f64 - (cells / 2) as f64) / FINE;
        let covered = |index: usize| {
            let px = Vec2::new(at(index % cells[0], cells[0]), at(index / cells[0], cells[1]));
            let metres = metres_a_px * px;
            let world = landmark.nominal_m + Vec3::new(metres.x, metres.y, 0.0);
            let on_line = |line: &usize| {
                let line = &field.lines[*line];
                line.paint_centre.distance_m(world) <= 0.5 * line.width_m
            };
            f32::from(u8::from(metres.norm() <= radius_m || lines.iter().any(on_line)))
        };
        let sharp: Vec<f32> = (0..cells[0] * cells[1]).map(covered).collect();
        Some(Self { half, metres_a_px, columns: cells[0], covers: blurred(&sharp, cells[0]) })
    }

    /// How much of a place is covered, `off` from the spot's middle.
    fn covers(&self, off: Vec2) -> f64 {
        let rows = self.covers.len() / self.columns;
        let x = (off.x * FINE + (self.columns / 2) as f64).clamp(0.0, (self.columns - 2) as f64);
        let y = (off.y * FINE + (rows / 2) as f64).clamp(0.0, (rows - 2) as f64);
        let (column, row) = (x as usize, y as usize);
        let (share_x, share_y) = (x - column as f64, y - row as f64);
        let value = |row: usize, column: usize| f64::from(self.covers[row * self.columns + column]);
        let along = |row: usize| value(row, column) * (1.0 - share_x) + value(row, column + 1) * share_x;
        along(row) * (1.0 - share_y) + along(row + 1) * share_y
    }
}

/// Blurred by [`BLUR_PX`]; outside lies what lies at the border.
fn blurred(sharp: &[f32], columns: usize) -> Vec<f32> {
    let sigma = BLUR_PX * FINE;
    let reach = (3.0 * sigma).ceil() as isize;
    let weights: Vec<f32> = (-reach..=reach).map(|at| (-0.5 * (at as f64 / sigma).powi(2)).exp() as f32).collect();
    let sum: f32 = weights.iter().sum();
    let rows = sharp.len() / columns;
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
            let weighed = weights.iter().zip(-reach..=reach).map(|(weight, by)| weight * value(row, column, by));
            weighed.sum::<f32>() / sum
        };
        (0..of.len()).map(blurred).collect()
    };
    pass(&pass(sharp, true), false)
}

/// A shape laid over a picture at every place within reach.
struct Look {
    placed: ImagePoint,
    shape: Shape,
    fits: Vec<Fit>,
}

/// A shape at one place.
#[derive(Clone, Copy, Debug)]
struct Fit {
    shift: Vec2,
    /// The squares about the mean that it explains.
    explained: f64,
}

/// How much of some pixels a shape explains.
struct Explained {
    contrast: f64,
    /// Squares about the mean that it explains, and all.
    squares: f64,
    about_mean: f64,
}

/// A shape where it leaves the least squares.
struct Refined {
    shift: Vec2,
    sigma_px: f64,
    contrast: f64,
    explained: f64,
}

impl Look {
    fn of(ground: &GroundPicture, placed: ImagePoint, shape: Shape, reach: i32) -> Self {
        let mut look = Self { placed, shape, fits: Vec::new() };
        for row in -reach..=reach {
            for column in -reach..=reach {
                let shift = Vec2::new(f64::from(column), f64::from(row));
                let whole = look.pixels(ground, shift);
                if let Some(seen) = look.is_whole(&whole).then(|| look.explained(&whole, Vec2::zeros())) {
                    // On turf paint is bright.
                    let explained = if seen.contrast > 0.0 || !ground.surface().is_turf() { seen.squares } else { 0.0 };
                    look.fits.push(Fit { shift, explained });
                }
            }
        }
        look
    }

    /// The pixels around a place: their middles, and what is seen there; those that a graphic hides are left out.
    fn pixels(&self, ground: &GroundPicture, shift: Vec2) -> Vec<(Vec2, f64)> {
        let middle = self.placed.moved(shift);
        let [half_x, half_y] = self.shape.half;
        let (left, top) = (middle.x.floor(), middle.y.floor());
        let size = ground.size();
        let offsets = (-half_y..=half_y).flat_map(|row| (-half_x..=half_x).map(move |column| (column, row)));
        let pixel = |(column, row): (i32, i32)| {
            let at = ImagePoint::new(left + f64::from(column) + 0.5, top + f64::from(row) + 0.5);
            let seen = size.contains(at) && !ground.is_masked(at);
            seen.then(|| (at.offset_from(middle), ground.grey().at(at)))
        };
        offsets.filter_map(pixel).collect()
    }

    /// Whether the picture shows all of them.
    fn is_whole(&self, pixels: &[(Vec2, f64)]) -> bool {
        let [columns, rows] = self.shape.half.map(|half| 2 * half as usize + 1);
        pixels.len() == columns * rows
    }

    /// What the shape explains of some pixels, moved by `by` from where they have their middle.
    fn explained(&self, pixels: &[(Vec2, f64)], by: Vec2) -> Explained {
        let count = pixels.len() as f64;
        let [mut covers, mut greys, mut covers_2, mut both, mut greys_2] = [0.0; 5];
        for (off, grey) in pixels {
            let here = self.shape.covers(off - by);
            (covers, greys) = (covers + here, greys + grey);
            (covers_2, both, greys_2) = (covers_2 + here * here, both + here * grey, greys_2 + grey * grey);
        }
        let of_covers = covers_2 - covers * covers / count;
        let together = both - covers * greys / count;
        let contrast = if of_covers > 0.0 { together / of_covers } else { 0.0 };
        Explained { contrast, squares: contrast * together, about_mean: greys_2 - greys * greys / count }
    }

    /// The place between pixels, its σ, and what speaks for it; none where places `beside_px` away are nearly as good.
    fn refined(&self, ground: &GroundPicture, from: &Fit, beside_px: f64) -> Option<Refined> {
        const DIRECTIONS: u32 = 16;
        const BY: f64 = 0.25;
        let seen = self.pixels(ground, from.shift);
        let count = seen.len() as f64;
        let mean = seen.iter().map(|(_, grey)| grey).sum::<f64>() / count;
        let about_mean = self.explained(&seen, Vec2::zeros()).about_mean;
        let (mut by, mut contrast, mut level) = (Vec2::zeros(), 0.0, mean);
        let mut result = None;
        for step in 0..STEPS {
            let (mut matrix, mut gradient, mut left) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
            for (off, grey) in &seen {
                let off = off - by;
                let covers = |x: f64, y: f64| self.shape.covers(off + Vec2::new(x, y));
                let slope =
                    Vec2::new(covers(BY, 0.0) - covers(-BY, 0.0), covers(0.0, BY) - covers(0.0, -BY)) / (2.0 * BY);
                let here = covers(0.0, 0.0);
                let residual = grey - level - contrast * here;
                let row = Vector4::new(-contrast * slope.x, -contrast * slope.y, here, 1.0);
                matrix += row * row.transpose();
                gradient += row * residual;
                left += residual * residual;
            }
            if step == 0 {
                // Contrast and level first: without contrast the place says nothing.
                let levels = matrix.fixed_view::<2, 2>(2, 2).into_owned().try_inverse()? * gradient.fixed_rows::<2>(2);
                (contrast, level) = (contrast + levels.x, level + levels.y);
                continue;
            }
            let inverse = matrix.try_inverse()?;
            let noise_2 = (left / count).max(LEAST_NOISE.powi(2)) / INDEPENDENT;
            let sigma_px = (noise_2 * 0.5 * (inverse[(0, 0)] + inverse[(1, 1)])).sqrt();
            let explained = if about_mean > 0.0 { 1.0 - left / about_mean } else { 0.0 };
            result = Some(Refined { shift: from.shift + by, sigma_px, contrast, explained });
            let moved = inverse * gradient;
            by += moved.fixed_rows::<2>(0).map(|by| by.clamp(-1.0, 1.0));
            (contrast, level) = (contrast + moved[2], level + moved[3]);
            if !(by.norm() <= 2.0) {
                return None;
            }
        }
        let left = |by: Vec2| {
            let explained = self.explained(&seen, by);
            explained.about_mean - explained.squares + count * LEAST_NOISE.powi(2)
        };
        let mut directions = (0..DIRECTIONS).map(|index| {
            let (y, x) = (std::f64::consts::TAU * f64::from(index) / f64::from(DIRECTIONS)).sin_cos();
            by + Vec2::new(x, y) * beside_px
        });
        let least = MUCH_WORSE * left(by);
        if directions.all(|beside| left(beside) >= least) { result } else { None }
    }

    /// Whether most of what surrounds the spot is ground.
    fn lies_on_ground(&self, ground: &GroundPicture, shift: Vec2) -> bool {
        let middle = self.placed.moved(shift);
        let bare: Vec<ImagePoint> = self
            .pixels(ground, shift)
            .into_iter()
            .filter(|(off, _)| self.shape.covers(*off) < 0.05)
            .map(|(off, _)| middle.moved(off))
            .collect();
        let of_ground = bare.iter().filter(|at| ground.is_ground(**at)).count();
        of_ground as f64 >= ON_GROUND * bare.len() as f64 && !bare.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{camera, drawn, soccer};
    use crate::paint::snap_point;
    use std::sync::LazyLock;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{ImageSize, PixelBox};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// Looks at the middle of the field and at a penalty mark, close enough to see them.
    const VIEWS: [(&str, f64, f64); 3] =
        [("centre_mark", -1.0, 2600.0), ("penalty_mark_right", 34.0, 2600.0), ("penalty_mark_left", -34.5, 2600.0)];

    fn view(pan_deg: f64, focal_px: f64) -> PtzCamera {
        let seen = camera(pan_deg, -14.0, focal_px);
        PtzCamera::new(*seen.base(), Ptz { focal_px, ..seen.ptz() })
    }

    static PICTURES: LazyLock<Vec<Picture>> =
        LazyLock::new(|| VIEWS.iter().map(|(_, pan, focal)| drawn(&soccer(), &view(*pan, *focal), SIZE)).collect());

    fn view_of(index: usize) -> (PtzCamera, ImagePoint) {
        let field = soccer();
        let (landmark, pan_deg, focal_px) = VIEWS[index];
        let camera = view(pan_deg, focal_px);
        let at = camera.image_from_world(field.landmark_in_world(field.landmark(landmark).unwrap())).unwrap();
        (camera, at)
    }

    fn snapped(index: usize, camera: &PtzCamera, placed: ImagePoint, masks: &[PixelBox]) -> Option<SnappedPoint> {
        let field = soccer();
        let landmark = field.landmark(VIEWS[index].0).unwrap();
        let ground = GroundPicture::new(&PICTURES[index], masks);
        snap_point(&ground, &field, camera, landmark, placed, &PointSnapOptions::default())
    }

    #[test]
    fn a_point_beside_a_mark_goes_to_its_middle() {
        for (index, (landmark, ..)) in VIEWS.iter().enumerate() {
            let (camera, exact) = view_of(index);
            for off_px in [Vec2::zeros(), Vec2::new(2.5, -1.5), Vec2::new(-3.0, 2.0), Vec2::new(0.5, 3.0)] {
                let found = snapped(index, &camera, exact.moved(off_px), &[]);
                let found = found.unwrap_or_else(|| panic!("{landmark} from {off_px:?}"));
                let error_px = found.image.distance_px(exact);
                assert!(error_px < 0.25, "{landmark} from {off_px:?}: {error_px} px, {found:?}");
                assert!((0.1..1.0).contains(&found.sigma_px), "{found:?}");
            }
        }
    }

    #[test]
    fn a_rough_camera_is_enough() {
        let (_, exact) = view_of(1);
        for rough in [view(31.0, 2600.0), view(34.0, 2350.0), camera(36.0, -15.5, 2700.0)] {
            let found = snapped(1, &rough, exact.moved(Vec2::new(2.0, -1.0)), &[]).unwrap();
            assert!(found.image.distance_px(exact) < 0.5, "{found:?}");
        }
    }

    #[test]
    fn without_a_mark_or_with_something_else_in_its_place_a_point_stays() {
        let (camera, exact) = view_of(1);
        assert_eq!(snapped(1, &camera, exact.moved(Vec2::new(40.0, 0.0)), &[]), None, "bare turf");
        let hidden = PixelBox { x: exact.x - 30.0, y: exact.y - 10.0, width: 60.0, height: 20.0 };
        assert_eq!(snapped(1, &camera, exact, &[hidden]), None, "a graphic");
        // The halfway line without its mark, and the mark of another place beside a line.
        let (middle, centre) = view_of(0);
        assert_eq!(snapped(0, &middle, centre.moved(Vec2::new(0.0, 60.0)), &[]), None, "a line alone");
    }
}
