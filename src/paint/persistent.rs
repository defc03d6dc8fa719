//! Paint that stays where it is while a camera turns: what many frames show in one direction is drawn on the ground; players,
//! boards that change and shadows are not there twice.

use super::strokes::{Shown, StrokePoint, Strokes};
use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, Vec3};
use rayon::prelude::*;

/// The share of the frames showing ground in a direction that have to show paint there.
const MIN_SHARE: f64 = 0.3;

/// Places of a frame that are asked of the other frames, at most.
const ASKED: usize = 2500;

/// How many other frames a place is looked up in, at most.
const MAX_FRAMES: usize = 60;

/// The side of the cells of [`SeenGround`], degrees.
const SEEN_CELL_DEG: f64 = 0.25;

/// A place on a stroke that stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersistentPoint {
    /// The direction of the camera's ray in `world`, unit.
    pub direction: Vec3,
    /// The frame that shows it, by its place among those given.
    pub frame: usize,
    /// The stroke's place there.
    pub stroke: StrokePoint,
}

/// Places on strokes that enough of the frames show in one direction. `frames` are pictures of one camera in one place, with
/// what was found in them.
#[must_use]
pub fn persistent_paint(frames: &[(PtzCamera, Strokes)]) -> Vec<PersistentPoint> {
    let needed = match frames.len() {
        0..=2 => 1,
        3..=5 => 2,
        _ => 3,
    };
    let of_frame = |frame: usize| -> Vec<PersistentPoint> {
        let (camera, strokes) = &frames[frame];
        let others = others_of(frames, frame);
        let every = strokes.points.len().div_ceil(ASKED).max(1);
        let keep = |stroke: &StrokePoint| {
            let direction = camera.world_direction_from_image(stroke.at).ok()?.try_normalize(0.0)?;
            let (mut seen, mut painted) = (1_usize, 1_usize);
            for &other in &others {
                match shown(&frames[other], camera.base().position_m + direction) {
                    Shown::Stroke => (seen, painted) = (seen + 1, painted + 1),
                    Shown::Ground => seen += 1,
                    Shown::Other => {}
                }
            }
            let stays = painted >= needed && painted as f64 >= MIN_SHARE * seen as f64;
            stays.then_some(PersistentPoint { direction, frame, stroke: *stroke })
        };
        strokes.points.iter().step_by(every).filter_map(keep).collect()
    };
    (0..frames.len()).into_par_iter().flat_map_iter(of_frame).collect()
}

/// What a frame shows where the camera sees a point of `world`.
fn shown((camera, strokes): &(PtzCamera, Strokes), point_in_world: Vec3) -> Shown {
    camera.image_from_world(point_in_world).map_or(Shown::Other, |image| strokes.shown(image))
}

/// The frames that look where a frame looks, the nearest first.
fn others_of(frames: &[(PtzCamera, Strokes)], frame: usize) -> Vec<usize> {
    let ahead = |of: &PtzCamera| of.cam_from_world().row(2).transpose();
    let here = ahead(&frames[frame].0);
    let mut others: Vec<(usize, f64)> = (0..frames.len())
        .filter(|other| *other != frame)
        .map(|other| (other, 1.0 - here.dot(&ahead(&frames[other].0))))
        .collect();
    others.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    others.truncate(MAX_FRAMES);
    others.into_iter().map(|(other, _)| other).collect()
}

/// The directions in which any of the frames shows ground: a grid over pan and tilt.
#[derive(Clone, Debug)]
pub struct SeenGround {
    columns: usize,
    rows: usize,
    seen: Vec<bool>,
}

impl SeenGround {
    /// Of frames of one camera in one place.
    #[must_use]
    pub fn of(frames: &[(PtzCamera, Strokes)]) -> Self {
        let (columns, rows) = ((360.0 / SEEN_CELL_DEG) as usize, (90.0 / SEEN_CELL_DEG) as usize);
        let mut seen = vec![false; columns * rows];
        for frame in frames {
            let size = frame.1.size();
            let step = f64::from(size.width) / 160.0;
            let (across, down) = (160, (f64::from(size.height) / step) as usize);
            for cell in 0..across * down {
                let at = ImagePoint::new(
                    (cell % across) as f64 * step + step / 2.0,
                    (cell / across) as f64 * step + step / 2.0,
                );
                if frame.1.shown(at) == Shown::Other {
                    continue;
                }
                if let Some(cell) =
                    frame.0.world_direction_from_image(at).ok().and_then(|d| Self::cell(columns, rows, d))
                {
                    seen[cell] = true;
                }
            }
        }
        Self { columns, rows, seen }
    }

    /// The cell of a direction below the horizon.
    fn cell(columns: usize, rows: usize, direction: Vec3) -> Option<usize> {
        let down = (-direction.z).atan2(direction.x.hypot(direction.y)).to_degrees();
        let pan = direction.x.atan2(direction.y).to_degrees() + 180.0;
        if !(down > 0.0) {
            return None;
        }
        let column = (pan / SEEN_CELL_DEG) as usize % columns;
        let row = ((down / SEEN_CELL_DEG) as usize).min(rows - 1);
        Some(row * columns + column)
    }

    /// Whether any frame shows ground in a direction of `world`.
    #[must_use]
    pub fn holds(&self, direction: Vec3) -> bool {
        Self::cell(self.columns, self.rows, direction).is_some_and(|cell| self.seen[cell])
    }
}
