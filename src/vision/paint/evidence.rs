//! How well the lines that a camera predicts lie on the strokes of a picture, computed fast: for
//! very many cameras.

use super::directions::{DIRECTIONS, direction_of, with_neighbours};
use super::strokes::{Shown, Strokes};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};

/// Cells of the maps, px at 1920 px width.
const CELL_PX: f64 = 4.0;

/// A line that is hidden (by players, or because there is no ground at all) counts this much of one
/// that is bare.
const HIDDEN_SHARE: f64 = 0.4;

/// The painted lines of a field as seen from one base: chains of points, as directions from the
/// camera in `base`, m.
#[derive(Clone, Debug)]
pub(super) struct Chains(Vec<Vec<Vec3>>);

impl Chains {
    /// The points of a line are at most `piece_m` apart.
    pub fn of(field: &FieldModel, base: &CameraBase, piece_m: f64) -> Self {
        let painted = field.lines.iter().filter(|line| line.painted);
        let chain = painted.map(|line| {
            let count = (line.paint_centre.length_m() / piece_m).ceil().max(1.0) as u32;
            let at = |step: u32| {
                let nominal = line
                    .paint_centre
                    .point_at(f64::from(step) / f64::from(count));
                base.base_from_world_point(field.world_from_nominal(nominal))
            };
            (0..=count).map(at).collect()
        });
        Self(chain.collect())
    }

    /// The directions of all points, in `base`.
    pub fn directions(&self) -> impl Iterator<Item = Vec3> {
        self.0.iter().flatten().copied()
    }
}

/// What a picture shows, as maps that are quickly looked up.
#[derive(Clone, Debug)]
pub(super) struct EvidenceMaps {
    cell_px: f64,
    columns: usize,
    rows: usize,
    /// For each direction of a normal, how near the nearest stroke of that direction is: 1 on it, 0
    /// out of reach.
    near: Vec<f32>,
    /// Whether a cell shows ground or paint.
    open: Vec<bool>,
    /// The length of all strokes, px.
    length_px: f64,
}

impl EvidenceMaps {
    /// The maps of a picture's strokes. A line may lie `reach_px` beside a stroke.
    pub fn of(strokes: &Strokes, reach_px: f64) -> Self {
        let size = strokes.size();
        let cell_px = (CELL_PX * size.scale_from_1920()).max(1.0);
        let count = |extent: u32| (f64::from(extent) / cell_px).ceil() as usize;
        let (columns, rows) = (count(size.width), count(size.height));
        let mut near = vec![0.0_f32; DIRECTIONS * columns * rows];
        let steps = (reach_px / cell_px).round().max(1.0) as i32;
        for stroke in &strokes.points {
            let direction = direction_of(stroke.normal);
            // Across the stroke only: a stroke does not go on beyond its end.
            for step in -steps..=steps {
                let at = stroke.at.moved(stroke.normal * (f64::from(step) * cell_px));
                if !size.contains(at) {
                    continue;
                }
                let value = (1.0 - (f64::from(step) / (f64::from(steps) + 1.0)).powi(2)) as f32;
                let cell = (at.y / cell_px) as usize * columns + (at.x / cell_px) as usize;
                for direction in with_neighbours(direction) {
                    let at = direction * columns * rows + cell;
                    near[at] = near[at].max(value);
                }
            }
        }
        let middle = |index: usize| (index as f64 + 0.5) * cell_px;
        let open = (0..columns * rows).map(|cell| {
            strokes.shown(ImagePoint::new(
                middle(cell % columns),
                middle(cell / columns),
            )) != Shown::Other
        });
        Self {
            cell_px,
            columns,
            rows,
            near,
            open: open.collect(),
            length_px: strokes.points.len() as f64,
        }
    }

    /// The share of the predicted lines that lie on strokes, 0 to 1, times the share of the strokes
    /// that they explain.
    pub fn score(&self, chains: &Chains, camera: &PtzCamera) -> f64 {
        let mut sums = Sums::default();
        for chain in &chains.0 {
            let mut last = None;
            for point in chain {
                let here = self.image(camera, *point);
                if let (Some(from), Some(to)) = (last, here) {
                    self.add(from, to, &mut sums);
                }
                last = here;
            }
        }
        let predicted = sums.hit + sums.bare + HIDDEN_SHARE * sums.hidden;
        if !(predicted > 0.0 && self.length_px > 0.0) {
            return 0.0;
        }
        sums.hit / predicted * (sums.hit / self.length_px).min(1.0)
    }

    /// The image of a direction in `base`, unless it lies far outside.
    fn image(&self, camera: &PtzCamera, direction: Vec3) -> Option<ImagePoint> {
        let (width, height) = self.extent_px();
        let image = camera
            .image_from_cam(camera.cam_from_base() * direction)
            .ok()?;
        let near = image.x > -width
            && image.x < 2.0 * width
            && image.y > -height
            && image.y < 2.0 * height;
        near.then_some(image)
    }

    fn extent_px(&self) -> (f64, f64) {
        (
            self.columns as f64 * self.cell_px,
            self.rows as f64 * self.cell_px,
        )
    }

    /// Adds a piece of a line, by what the maps show at its middle.
    fn add(&self, from: ImagePoint, to: ImagePoint, sums: &mut Sums) {
        let (width, height) = self.extent_px();
        let along = to.offset_from(from);
        let middle = from.moved(along * 0.5);
        if !(middle.x >= 0.0 && middle.x < width && middle.y >= 0.0 && middle.y < height) {
            return;
        }
        let cell =
            (middle.y / self.cell_px) as usize * self.columns + (middle.x / self.cell_px) as usize;
        let direction = direction_of(Vec2::new(-along.y, along.x));
        let near = f64::from(self.near[direction * self.columns * self.rows + cell]);
        // A piece that leaves the picture counts as far as it lies within.
        let length_px = along.norm().min(height);
        sums.hit += near * length_px;
        *(if self.open[cell] {
            &mut sums.bare
        } else {
            &mut sums.hidden
        }) += (1.0 - near) * length_px;
    }
}

/// Lengths of predicted lines, px.
#[derive(Default)]
struct Sums {
    /// On strokes.
    hit: f64,
    /// On open ground without a stroke.
    bare: f64,
    /// Where no ground is seen.
    hidden: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::GroundPicture;
    use crate::paint::drawn::{PICTURE, camera, soccer, truth};

    #[test]
    fn the_right_camera_has_far_more_evidence_than_others() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        let maps = EvidenceMaps::of(&Strokes::of(&ground), 12.0);
        let chains = Chains::of(&field, truth().base(), 2.0);
        let right = maps.score(&chains, &truth());
        assert!(right > 0.6, "{right}");
        for (pan_deg, tilt_deg, focal_px) in [
            (8.0, -14.0, 1500.0),
            (4.0, -17.0, 1500.0),
            (4.0, -14.0, 2200.0),
        ] {
            let wrong = maps.score(&chains, &camera(pan_deg, tilt_deg, focal_px));
            assert!(wrong < 0.4 * right, "{wrong}");
        }
        assert_eq!(maps.score(&chains, &camera(180.0, -14.0, 1500.0)), 0.0);
    }
}
