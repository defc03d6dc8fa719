//! Scores how well a camera's lines lie on the marking pixels of a picture, fast enough for an
//! exhaustive search.
//!
//! As in directional chamfer matching (Liu, Tuzel, Veeraraghavan, Chellappa: "Fast directional
//! chamfer matching", CVPR 2010), maps by direction are computed once and each camera only looks
//! them up. Here a map contains proximity, 1 on a marking and 0 beyond the reach, and each marking
//! is spread along its normal only. The lines are short pieces, and the map is read once for each
//! piece, at its middle.

use super::marking_pixels::{MarkingPixels, PixelContent};
use super::persistent::{DIRECTIONS, cell_at, direction_of, with_neighbours};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};

/// Side of a cell of the maps, px at 1920 px width.
const CELL_PX: f64 = 4.0;

/// Weight of a predicted line where no ground is seen (a player, the stand), relative to one on
/// bare ground: it is weaker evidence against the camera.
const HIDDEN_SHARE: f64 = 0.4;

/// The painted lines of a field as polylines of points in `base`, m. The base is the same for all
/// cameras, so the points are transformed once.
#[derive(Clone, Debug)]
pub(in crate::paint) struct Chains(Vec<Vec<Vec3>>);

impl Chains {
    /// Points of a line are at most `piece_m` apart.
    pub fn from_field(field: &FieldModel, base: &CameraBase, piece_m: f64) -> Self {
        let painted = field.lines.iter().filter(|line| line.painted);
        let chain = painted.map(|line| {
            let count = (line.paint_centre.length_m() / piece_m).ceil().max(1.0) as u32;
            // Nominal points of the rule book are placed in `world` (crown included), then in
            // `base`.
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

    /// The directions of all points, in `base`, not normalised.
    pub fn directions(&self) -> impl Iterator<Item = Vec3> {
        self.0.iter().flatten().copied()
    }
}

/// What a picture shows, as maps over a grid of cells.
#[derive(Clone, Debug)]
pub(in crate::paint) struct EvidenceMaps {
    cell_px: f64,
    columns: usize,
    rows: usize,
    /// For each direction of a normal and each cell, the proximity of the nearest marking of that
    /// direction: 1 on it, 0 out of reach.
    near: Vec<f32>,
    /// For each cell, whether it shows ground or paint.
    open: Vec<bool>,
    /// Total length of the markings, px: the number of marking pixels.
    length_px: f64,
}

impl EvidenceMaps {
    /// Maps in which a line may lie up to `reach_px` beside a marking.
    pub fn from_marking_pixels(marking_pixels: &MarkingPixels, reach_px: f64) -> Self {
        let size = marking_pixels.size();
        let cell_px = (CELL_PX * size.scale_from_1920()).max(1.0);
        let [columns, rows] =
            [size.width, size.height].map(|side_px| (f64::from(side_px) / cell_px).ceil() as usize);
        let mut near = vec![0.0_f32; DIRECTIONS * columns * rows];
        let steps = (reach_px / cell_px).round().max(1.0) as i32;
        for stroke in &marking_pixels.points {
            let direction = direction_of(stroke.normal);
            // Along the normal only: a marking does not continue beyond its end.
            for step in -steps..=steps {
                let at = stroke
                    .at
                    .translate(stroke.normal * (f64::from(step) * cell_px));
                // `contains` includes the right and the lower border, where no cell begins.
                let cell = cell_at(at, cell_px, [columns, rows]);
                let Some(cell) = cell.filter(|_| size.contains(at)) else {
                    continue;
                };
                // Falls from 1 as a parabola, so that small errors cost little.
                let value = (1.0 - (f64::from(step) / (f64::from(steps) + 1.0)).powi(2)) as f32;
                // Neighbouring directions are marked too: a look-up must not fail at the border of
                // two bins.
                for direction in with_neighbours(direction) {
                    let at = direction * columns * rows + cell;
                    near[at] = near[at].max(value);
                }
            }
        }
        // A cell is classified by its middle alone. At 1920 px width it covers 2 × 2 of the cells
        // that `classify` reads.
        let open = (0..columns * rows).map(|cell| {
            let [x, y] = [cell % columns, cell / columns].map(|at| (at as f64 + 0.5) * cell_px);
            marking_pixels.classify(ImagePoint::new(x, y)) != PixelContent::Other
        });
        Self {
            cell_px,
            columns,
            rows,
            near,
            open: open.collect(),
            length_px: marking_pixels.points.len() as f64,
        }
    }

    /// Share of the predicted lines that lie on markings, times the share of the markings that they
    /// explain, 0 to 1. The product is zero for a camera that predicts nothing and small for one
    /// that predicts lines everywhere.
    pub fn score(&self, chains: &Chains, camera: &PtzCamera) -> f64 {
        let mut sums = Sums::default();
        for chain in &chains.0 {
            // A piece counts only if both of its ends are in front of the camera and near the
            // picture.
            let mut last = None;
            for point in chain {
                let here = self.image(camera, *point);
                if let (Some(from), Some(to)) = (last, here) {
                    self.add(from, to, &mut sums);
                }
                last = here;
            }
        }
        // The length of lines on markings approximates the number of marking pixels that they
        // explain; several lines may lie on one marking, hence the limit of 1.
        let predicted = sums.hit + sums.bare + HIDDEN_SHARE * sums.hidden;
        if !(predicted > 0.0 && self.length_px > 0.0) {
            return 0.0;
        }
        sums.hit / predicted * (sums.hit / self.length_px).min(1.0)
    }

    /// The image of a direction in `base`, px. None if it lies behind the camera, beyond the fold
    /// of the lens, or more than one picture's extent outside.
    fn image(&self, camera: &PtzCamera, direction: Vec3) -> Option<ImagePoint> {
        // A piece that ends farther out and has its middle in the picture is longer than the
        // picture: the middle, at which it is classified, says little about the visible part.
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

    /// Width and height of the grid, px.
    fn extent_px(&self) -> (f64, f64) {
        (
            self.columns as f64 * self.cell_px,
            self.rows as f64 * self.cell_px,
        )
    }

    /// Adds a piece of a line, classified by the maps at its middle.
    fn add(&self, from: ImagePoint, to: ImagePoint, sums: &mut Sums) {
        let along = to.offset_from(from);
        let middle = from.translate(along * 0.5);
        let Some(cell) = cell_at(middle, self.cell_px, [self.columns, self.rows]) else {
            return;
        };
        // The normal of the piece in the picture selects the map.
        let direction = direction_of(Vec2::new(-along.y, along.x));
        let near = f64::from(self.near[direction * self.columns * self.rows + cell]);
        // A piece near the camera may be much longer than what is visible of it; the limit keeps it
        // from dominating.
        let length_px = along.norm().min(self.extent_px().1);
        // The proximity divides the length: the part that is not on a marking is a missed one.
        sums.hit += near * length_px;
        let missed = if self.open[cell] {
            &mut sums.bare
        } else {
            &mut sums.hidden
        };
        *missed += (1.0 - near) * length_px;
    }
}

/// Lengths of predicted lines in the picture, px.
#[derive(Default)]
struct Sums {
    /// On markings, weighted by proximity.
    hit: f64,
    /// On open ground without a marking.
    bare: f64,
    /// Where no ground is seen.
    hidden: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{PICTURE, camera, soccer, truth};
    use crate::paint::{GroundPicture, MarkingPixel};
    use touchline_core::geometry::ImageSize;

    #[test]
    fn the_right_camera_has_far_more_evidence_than_others() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        let maps = EvidenceMaps::from_marking_pixels(&MarkingPixels::detect(&ground), 12.0);
        let chains = Chains::from_field(&field, truth().base(), 2.0);
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

    #[test]
    fn a_marking_at_the_corner_of_the_picture_is_spread_within_it_only() {
        let size = ImageSize::new(480, 270);
        let turf = Picture::with_colour(size, [62, 110, 42, 255]);
        let mut marking_pixels = MarkingPixels::detect(&GroundPicture::new(&turf, &[]));
        marking_pixels.points = vec![MarkingPixel {
            at: ImagePoint::new(480.0, 269.5),
            normal: Vec2::new(1.0, 0.0),
            contrast_px: None,
        }];
        let maps = EvidenceMaps::from_marking_pixels(&marking_pixels, 2.0);
        // Two cells of 1 px to the left of the border, in three directions.
        let near = maps.near.iter().filter(|near| **near > 0.0);
        assert_eq!((maps.cell_px, near.count()), (1.0, 6));
    }
}
