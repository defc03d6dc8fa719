//! Persistent paint: markings that many frames of a rotating camera show in the same direction.
//!
//! A camera that only rotates and zooms sees every static point in one fixed direction. Markings
//! that recur in a direction are painted on the ground; players, changing boards and moving shadows
//! do not recur.

use super::marking_pixels::{MarkingPixel, MarkingPixels, PixelContent};
use rayon::prelude::*;
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3, subsample};

/// Minimum share of the frames with markings in a direction, among those that show ground there.
const MIN_SHARE: f64 = 0.3;

/// Maximum number of marking pixels per frame that are tested.
const MAX_TESTED: usize = 2500;

/// Maximum number of other frames in which a marking pixel is searched.
const MAX_FRAMES: usize = 60;

/// Side of a cell of [`GroundDirections`] in pan and in the angle below the horizon, degrees.
const SEEN_CELL_DEG: f64 = 0.25;

/// A marking pixel that recurs in other frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersistentPoint {
    /// Unit direction of the camera's ray, in `world`.
    pub direction: Vec3,
    /// Index of the frame that shows it.
    pub frame: usize,
    /// The marking pixel in that frame.
    pub stroke: MarkingPixel,
}

/// The marking pixels that enough frames show in one direction. `frames` are the cameras and
/// markings of pictures from one position.
pub fn persistent_paint(frames: &[(PtzCamera, MarkingPixels)]) -> Vec<PersistentPoint> {
    // Every marking pixel is projected into the other frames. A raster of directions, as for a
    // panorama, would round all of them to its cells. Frames are independent of each other, and
    // `collect` keeps their order.
    (0..frames.len())
        .into_par_iter()
        .flat_map_iter(|frame| {
            let others = others_of(frames, frame);
            subsample(&frames[frame].1.points, MAX_TESTED)
                .filter_map(|stroke| persistent_point(frames, frame, &others, stroke))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A marking pixel of a frame with its direction, if enough of the other frames show it.
fn persistent_point(
    frames: &[(PtzCamera, MarkingPixels)],
    frame: usize,
    others: &[usize],
    stroke: &MarkingPixel,
) -> Option<PersistentPoint> {
    let camera = &frames[frame].0;
    let direction = camera
        .world_direction_from_image(stroke.at)
        .ok()?
        .try_normalize(0.0)?;
    // All cameras have one position, so that any point in the direction will do; this one is 1 m
    // away. The frame itself shows the marking. The other frames show it, or ground, or neither and
    // are then not counted.
    let point_in_world = camera.base().position_m + direction;
    let (mut seen, mut painted) = (1_usize, 1_usize);
    for &other in others {
        match classify_world_point(&frames[other], point_in_world) {
            PixelContent::Stroke => (seen, painted) = (seen + 1, painted + 1),
            PixelContent::Ground => seen += 1,
            PixelContent::Other => {}
        }
    }
    // The absolute minimum guards against chance in directions that few frames show.
    let stays = painted >= min_frames(frames.len()) && painted as f64 >= MIN_SHARE * seen as f64;
    stays.then_some(PersistentPoint {
        direction,
        frame,
        stroke: *stroke,
    })
}

/// Minimum number of frames that must show paint, or ground, in a direction, for a set of this many
/// frames.
const fn min_frames(frames: usize) -> usize {
    match frames {
        0..=2 => 1,
        3..=5 => 2,
        _ => 3,
    }
}

/// What a frame shows at a point of `world`.
fn classify_world_point(
    (camera, marking_pixels): &(PtzCamera, MarkingPixels),
    point_in_world: Vec3,
) -> PixelContent {
    camera
        .image_from_world(point_in_world)
        .map_or(PixelContent::Other, |image| marking_pixels.classify(image))
}

/// The indices of the other frames, those with the nearest optical axes first, at most
/// [`MAX_FRAMES`].
fn others_of(frames: &[(PtzCamera, MarkingPixels)], frame: usize) -> Vec<usize> {
    let here = optical_axis(&frames[frame].0);
    let mut others: Vec<(usize, f64)> = (0..frames.len())
        .filter(|other| *other != frame)
        .map(|other| (other, 1.0 - here.dot(&optical_axis(&frames[other].0))))
        .collect();
    // Equal ones are ordered by index, so that the result is the same in every run.
    others.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    others.truncate(MAX_FRAMES);
    others.into_iter().map(|(other, _)| other).collect()
}

/// The direction of the optical axis in `world`, unit: the third row of `cam_from_world`.
fn optical_axis(camera: &PtzCamera) -> Vec3 {
    camera.cam_from_world().row(2).transpose()
}

/// The directions in which enough frames show ground for [`persistent_paint`] to find paint: a grid
/// over pan and the angle below the horizon, in `world`.
#[derive(Clone, Debug)]
pub struct GroundDirections {
    columns: usize,
    rows: usize,
    seen: Vec<bool>,
}

impl GroundDirections {
    /// Builds the grid from frames of one camera at one position.
    pub fn from_frames(frames: &[(PtzCamera, MarkingPixels)]) -> Self {
        /// Samples per row of a frame, enough that the widest views skip no cell.
        const ACROSS: usize = 320;
        let (columns, rows) = (
            (360.0 / SEEN_CELL_DEG) as usize,
            (90.0 / SEEN_CELL_DEG) as usize,
        );
        // The cells that a frame shows, each once, however many samples hit it.
        let of_frames: Vec<BTreeSet<usize>> = frames
            .par_iter()
            .map(|(camera, marking_pixels)| {
                let size = marking_pixels.size();
                let step = f64::from(size.width) / ACROSS as f64;
                let places = (0..ACROSS * (f64::from(size.height) / step) as usize).map(|place| {
                    let [x, y] =
                        [place % ACROSS, place / ACROSS].map(|at| (at as f64 + 0.5) * step);
                    ImagePoint::new(x, y)
                });
                places
                    .filter(|at| marking_pixels.classify(*at) != PixelContent::Other)
                    .filter_map(|at| {
                        Self::cell(columns, rows, camera.world_direction_from_image(at).ok()?)
                    })
                    .collect::<BTreeSet<usize>>()
            })
            .collect();
        // Number of frames that show ground in each cell.
        let mut counts = vec![0_usize; columns * rows];
        for cell in of_frames.into_iter().flatten() {
            counts[cell] += 1;
        }
        let needed = min_frames(frames.len());
        Self {
            columns,
            rows,
            seen: counts.into_iter().map(|count| count >= needed).collect(),
        }
    }

    /// The cell of a direction below the horizon. None above it.
    fn cell(columns: usize, rows: usize, direction: Vec3) -> Option<usize> {
        // z is up, and pan is measured from +y, as in the conventions.
        let down = (-direction.z)
            .atan2(direction.x.hypot(direction.y))
            .to_degrees();
        let pan = direction.x.atan2(direction.y).to_degrees() + 180.0;
        if !(down > 0.0) {
            return None;
        }
        let column = (pan / SEEN_CELL_DEG) as usize % columns;
        let row = ((down / SEEN_CELL_DEG) as usize).min(rows - 1);
        Some(row * columns + column)
    }

    /// Whether enough frames show ground in a direction of `world`.
    pub fn holds(&self, direction: Vec3) -> bool {
        Self::cell(self.columns, self.rows, direction).is_some_and(|cell| self.seen[cell])
    }
}

/// Number of bins over half a turn: a line and its reverse have one direction.
pub(in crate::paint) const DIRECTIONS: usize = 8;

/// The bin of a normal, counted from x towards y. Bin 0 is centred on the x axis.
pub(super) fn direction_of(normal: Vec2) -> usize {
    // atan2 spans a whole turn, −8 to 8 steps. The remainder maps opposite normals to one bin.
    let steps =
        (normal.y.atan2(normal.x) / std::f64::consts::PI * DIRECTIONS as f64).round() as i32;
    steps.rem_euclid(DIRECTIONS as i32) as usize
}

/// A direction and its two neighbours.
pub(super) fn with_neighbours(direction: usize) -> [usize; 3] {
    [DIRECTIONS - 1, 0, 1].map(|turn| (direction + turn) % DIRECTIONS)
}

/// The index, row by row from the top, of the cell that contains a point. None outside a grid of
/// this many columns and rows of square cells.
pub(super) fn cell_at(at: ImagePoint, cell_px: f64, [columns, rows]: [usize; 2]) -> Option<usize> {
    // Compared as floats: as an integer, a small negative number is 0. A point on the right border
    // has the column `columns`; its index would be that of a cell of the next row.
    let (column, row) = ((at.x / cell_px).floor(), (at.y / cell_px).floor());
    let inside = column >= 0.0 && row >= 0.0 && column < columns as f64 && row < rows as f64;
    inside.then(|| row as usize * columns + column as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_and_its_opposite_are_one_direction() {
        for step in 0..32 {
            let (y, x) = (f64::from(step) * 0.2 + 0.05).sin_cos();
            let direction = direction_of(Vec2::new(x, y));
            assert_eq!(direction, direction_of(Vec2::new(-x, -y)));
            assert!(with_neighbours(direction).contains(&direction));
        }
        assert_eq!(
            (
                direction_of(Vec2::new(1.0, 0.01)),
                direction_of(Vec2::new(0.0, 1.0))
            ),
            (0, 4)
        );
        assert_eq!(with_neighbours(0), [7, 0, 1]);
    }

    #[test]
    fn only_points_within_the_grid_have_a_cell() {
        let cell = |x: f64, y: f64| cell_at(ImagePoint::new(x, y), 4.0, [3, 2]);
        assert_eq!((cell(0.0, 0.0), cell(11.9, 7.9)), (Some(0), Some(5)));
        for (x, y) in [(12.0, 0.0), (0.0, 8.0), (-0.1, 0.0), (f64::NAN, 0.0)] {
            assert_eq!(cell(x, y), None, "{x}, {y}");
        }
    }
}
