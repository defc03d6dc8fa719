//! Paint that stays where it is while a camera turns: what many frames show in one direction is
//! drawn on the ground; players, boards that change and shadows are not there twice.

use super::strokes::{Shown, StrokePoint, Strokes};
use rayon::prelude::*;
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, Vec3, subsample};

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

/// Places on strokes that enough of the frames show in one direction. `frames` are pictures of one
/// camera in one place, with what was found in them.
#[must_use]
pub fn persistent_paint(frames: &[(PtzCamera, Strokes)]) -> Vec<PersistentPoint> {
    let needed = needed(frames.len());
    let of_frame = |frame: usize| -> Vec<PersistentPoint> {
        let (camera, strokes) = &frames[frame];
        let others = others_of(frames, frame);
        let keep = |stroke: &StrokePoint| {
            let direction = camera
                .world_direction_from_image(stroke.at)
                .ok()?
                .try_normalize(0.0)?;
            let (mut seen, mut painted) = (1_usize, 1_usize);
            for &other in &others {
                match shown(&frames[other], camera.base().position_m + direction) {
                    Shown::Stroke => (seen, painted) = (seen + 1, painted + 1),
                    Shown::Ground => seen += 1,
                    Shown::Other => {}
                }
            }
            let stays = painted >= needed && painted as f64 >= MIN_SHARE * seen as f64;
            stays.then_some(PersistentPoint {
                direction,
                frame,
                stroke: *stroke,
            })
        };
        subsample(&strokes.points, ASKED).filter_map(keep).collect()
    };
    (0..frames.len())
        .into_par_iter()
        .flat_map_iter(of_frame)
        .collect()
}

/// How many of so many frames have to show paint in a direction, and ground, for what they show
/// there to count.
const fn needed(frames: usize) -> usize {
    match frames {
        0..=2 => 1,
        3..=5 => 2,
        _ => 3,
    }
}

/// What a frame shows where the camera sees a point of `world`.
fn shown((camera, strokes): &(PtzCamera, Strokes), point_in_world: Vec3) -> Shown {
    camera
        .image_from_world(point_in_world)
        .map_or(Shown::Other, |image| strokes.shown(image))
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

/// The directions in which so many of the frames show ground that [`persistent_paint`] would find
/// paint there: a grid over pan and tilt.
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
        /// Places of a frame that are looked at in each row: the widest views leave no cell out.
        const ACROSS: usize = 320;
        let (columns, rows) = (
            (360.0 / SEEN_CELL_DEG) as usize,
            (90.0 / SEEN_CELL_DEG) as usize,
        );
        let cells_of = |(camera, strokes): &(PtzCamera, Strokes)| -> BTreeSet<usize> {
            let size = strokes.size();
            let step = f64::from(size.width) / ACROSS as f64;
            let places = (0..ACROSS * (f64::from(size.height) / step) as usize).map(|place| {
                let [column, row] =
                    [place % ACROSS, place / ACROSS].map(|at| (at as f64 + 0.5) * step);
                ImagePoint::new(column, row)
            });
            let is_ground = |at: &ImagePoint| strokes.shown(*at) != Shown::Other;
            let cell = |at| Self::cell(columns, rows, camera.world_direction_from_image(at).ok()?);
            places.filter(is_ground).filter_map(cell).collect()
        };
        let of_frames: Vec<BTreeSet<usize>> = frames.par_iter().map(cells_of).collect();
        let mut counts = vec![0_usize; columns * rows];
        for cell in of_frames.into_iter().flatten() {
            counts[cell] += 1;
        }
        let needed = needed(frames.len());
        Self {
            columns,
            rows,
            seen: counts.into_iter().map(|count| count >= needed).collect(),
        }
    }

    /// The cell of a direction below the horizon.
    fn cell(columns: usize, rows: usize, direction: Vec3) -> Option<usize> {
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
    #[must_use]
    pub fn holds(&self, direction: Vec3) -> bool {
        Self::cell(self.columns, self.rows, direction).is_some_and(|cell| self.seen[cell])
    }
}
