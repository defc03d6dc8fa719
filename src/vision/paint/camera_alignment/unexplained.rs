//! Paint that a camera does not predict: ridges along rows and columns of the picture that lie away
//! from every predicted line.

use crate::paint::GroundPicture;
use crate::paint::ridges::profile::Across;
use crate::paint::ridges::ridge::RidgeFinder;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::markings::LineSample;

/// Distance between the rows and columns that are searched, px at 1920 px width.
const SPACING_PX: f64 = 40.0;

/// Length of the pieces into which a row or column is divided, px at 1920 px width. The expected
/// width of paint is constant within a piece.
const PIECE_PX: f64 = 240.0;

/// Size of the cells that a predicted line explains, with their neighbours, px at 1920 px width.
const NEAR_PX: f64 = 16.0;

/// Minimum number of ridges for a share to be given.
const MIN_RIDGES: usize = 12;

/// Share, 0 to 1, of the ridges on the playing area that none of the predicted lines explains. None
/// if there are too few ridges. `samples` lie at most 16 px apart, at 1920 px width.
pub(super) fn unexplained_share(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    samples: &[LineSample],
) -> Option<f64> {
    let scale = ground.size().scale_from_1920();
    let explained = ExplainedCells::by(samples, ground, NEAR_PX * scale);
    // The ridges have no line of their own. Any painted line may be missing, so the widest sets the
    // expected width.
    let width_m = field
        .lines
        .iter()
        .filter(|line| line.painted)
        .map(|line| line.width_m)
        .fold(0.0, f64::max);
    let (width, height) = (
        f64::from(ground.size().width),
        f64::from(ground.size().height),
    );
    let mut finder = RidgeFinder::default();
    let mut found = Vec::new();
    let (mut all, mut alone) = (0_usize, 0_usize);
    // Rows find steep lines, columns find level ones.
    for (along, length, breadth) in [
        (Vec2::new(1.0, 0.0), width, height),
        (Vec2::new(0.0, 1.0), height, width),
    ] {
        let across = Vec2::new(along.y, along.x);
        for row in middles(breadth, SPACING_PX * scale) {
            // Pieces share their ends if the side is no multiple of their length: in a picture of
            // 16 : 9 a tenth of each column belongs to two pieces, and its ridges count twice.
            for piece in middles(length, PIECE_PX * scale) {
                let at = ImagePoint::new(0.0, 0.0).translate(along * piece + across * row);
                // The middle of the piece gives its expected width; pieces whose middle shows no
                // field are skipped.
                let Some(width_px) = paint_px(camera, field, at, along, width_m) else {
                    continue;
                };
                found.clear();
                let place = Across {
                    at,
                    normal: along,
                    width_px,
                    outward: 0.0,
                };
                // Along the piece itself: its direction is the normal of the paint that is sought.
                finder.find(
                    ground,
                    &place,
                    0.5 * length.min(PIECE_PX * scale),
                    1.0,
                    &mut found,
                );
                // Only paint on the playing area counts: boards and signs beside it are not the
                // camera's to explain.
                for ridge in &found {
                    let at = place.point(ridge.offset_px);
                    if !ground.is_masked(at) && on_field(camera, field, at).is_some() {
                        all += 1;
                        alone += usize::from(!explained.at(at));
                    }
                }
            }
        }
    }
    (all >= MIN_RIDGES).then(|| alone as f64 / all as f64)
}

/// The middles of equal pieces, of about the given length, of a length.
fn middles(length: f64, piece: f64) -> impl Iterator<Item = f64> {
    let count = (length / piece).round().max(1.0);
    (0..count as u32).map(move |index| (f64::from(index) + 0.5) * length / count)
}

/// The point of the playing area that a pixel shows, m.
pub(super) fn on_field(camera: &PtzCamera, field: &FieldModel, at: ImagePoint) -> Option<Vec3> {
    let place = camera.plane_from_image(at, 0.0)?;
    (place.x.abs() <= field.length_m / 2.0 && place.y.abs() <= field.width_m / 2.0).then_some(place)
}

/// Extent, along a direction in the picture, of paint that is `width_m` wide and crosses that
/// direction at a right angle on the ground, px.
fn paint_px(
    camera: &PtzCamera,
    field: &FieldModel,
    at: ImagePoint,
    along: Vec2,
    width_m: f64,
) -> Option<f64> {
    // The mapping from ground to picture, linearised; its inverse gives metres per px.
    let here = camera
        .image_from_world_jacobian(on_field(camera, field, at)?)
        .ok()?;
    let by_ground = here.by_world.fixed_columns::<2>(0).into_owned();
    let metres_a_px = (by_ground.try_inverse()? * along).norm();
    let width_px = width_m / metres_a_px;
    width_px.is_finite().then_some(width_px)
}

/// The cells of the picture that predicted lines explain.
struct ExplainedCells {
    cell_px: f64,
    columns: usize,
    cells: Vec<bool>,
}

impl ExplainedCells {
    fn by(samples: &[LineSample], ground: &GroundPicture, near_px: f64) -> Self {
        // A coarse raster instead of distances to all samples: it is looked up for every ridge.
        let cell_px = near_px.max(1.0);
        let count = |extent: u32| (f64::from(extent) / cell_px) as usize + 1;
        let (columns, rows) = (count(ground.size().width), count(ground.size().height));
        let mut cells = vec![false; columns * rows];
        // The cell of each sample and its eight neighbours: at least `near_px` in all directions.
        for sample in samples {
            let (column, row) = (
                (sample.image.x / cell_px) as usize,
                (sample.image.y / cell_px) as usize,
            );
            for near_row in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
                for near_column in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                    cells[near_row * columns + near_column] = true;
                }
            }
        }
        Self {
            cell_px,
            columns,
            cells,
        }
    }

    /// Whether the cell of a point is explained.
    fn at(&self, at: ImagePoint) -> bool {
        let (column, row) = (
            (at.x / self.cell_px) as usize,
            (at.y / self.cell_px) as usize,
        );
        self.cells
            .get(row * self.columns + column)
            .copied()
            .unwrap_or(false)
    }
}
