//! Marking pixels of a picture, found without any camera: thin and long, brighter than the ground
//! on both sides, or, on an indoor floor, darker.
//!
//! # Method
//!
//! 1. The brightness is blurred, and the Hessian of every pixel near the ground is computed. A
//!    pixel is a marking pixel where the brightness has a maximum along the eigenvector of the
//!    strongest curvature (Steger: "An unbiased detector of curvilinear structures", PAMI 20,
//!    1998), and where the ground on both sides differs enough from it (`ridges.rs`).
//! 2. On bright paint the centre is measured again, as the midpoint of the two edges, because the
//!    maximum is biased where the two sides differ in brightness (`ridges.rs`).
//! 3. Marking pixels are joined to connected components. Short components are dropped, and on turf
//!    so are those with the colour of lighter turf, or as bright as its light stripes
//!    (`components.rs`, `stroke_colours.rs`).

mod components;
mod ridges;
mod stroke_colours;

use crate::paint::GroundPicture;
use crate::paint::camera_alignment::ground_on_field::ground_on_field;
use crate::paint::turf::ground_area::GroundArea;
use components::long_ones;
pub(super) use ridges::Crests;
pub use ridges::Tone;
use ridges::ridges;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

/// A marking pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkingPixel {
    /// Centre of the marking, px.
    pub at: ImagePoint,
    /// Unit vector across the marking, in the picture.
    pub normal: Vec2,
    /// On turf, the brightness above that of the turf beside it, summed across the marking, grey
    /// levels × px. A blur does not change it: it is the contrast of the paint times the width of
    /// the line, for lines up to some 4 px wide. None on floors.
    pub contrast_px: Option<f64>,
}

/// The marking pixels of a picture, and where it shows ground.
#[derive(Clone, Debug)]
pub struct MarkingPixels {
    /// Marking pixels, row by row.
    pub points: Vec<MarkingPixel>,
    cells: Cells,
}

/// What a picture shows at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelContent {
    /// A marking within a few px.
    Stroke,
    /// Ground without paint.
    Ground,
    /// Neither: a player, a board, a graphic, or a point outside the picture.
    Other,
}

/// Minimum extent of a connected component, px at 1920 px width.
const MIN_LENGTH_PX: f64 = 28.0;

/// The same on the floor of a court, where at 28 px a right camera explains .3 to .7 of the paint
/// of two basketball courts, a hard court and clay, and at 100 px .6 to .8.
const MIN_LENGTH_ON_COURT_PX: f64 = 100.0;

impl MarkingPixels {
    /// Detects the markings of a picture.
    pub fn detect(ground: &GroundPicture) -> Self {
        // Paint on turf is always lighter. Lines of indoor floors may be dark.
        let tones: &[Tone] = if ground.surface().is_turf() {
            &[Tone::Bright]
        } else {
            &[Tone::Bright, Tone::Dark]
        };
        SearchedPicture::new(ground).markings(tones, MIN_LENGTH_PX)
    }

    /// Detects the lines of a court where a camera shows it, once for each of some tones. Its
    /// ground is what is smooth inside the field, whatever the rest of the picture is. Seams,
    /// scratches and letters are shorter than lines.
    pub fn on_court<const N: usize>(
        ground: &GroundPicture,
        field: &FieldModel,
        camera: &PtzCamera,
        tones: [Tone; N],
    ) -> [Self; N] {
        let ground = ground_on_field(ground, field, camera);
        let searched = SearchedPicture::new(&ground);
        tones.map(|tone| searched.markings(&[tone], MIN_LENGTH_ON_COURT_PX))
    }

    /// What the picture shows at a point, px.
    pub fn classify(&self, at: ImagePoint) -> PixelContent {
        match self.cells.at(at) {
            flags if flags & STROKE != 0 => PixelContent::Stroke,
            flags if flags & GROUND != 0 => PixelContent::Ground,
            _ => PixelContent::Other,
        }
    }

    /// Width and height of the picture, px.
    pub const fn size(&self) -> ImageSize {
        self.cells.size
    }
}

/// A picture with what the search for markings of any tone needs.
struct SearchedPicture<'a> {
    ground: &'a GroundPicture,
    area: GroundArea,
    crests: Crests<'a>,
    /// Without markings.
    cells: Cells,
}

impl<'a> SearchedPicture<'a> {
    fn new(ground: &'a GroundPicture) -> Self {
        let area = GroundArea::detect(ground);
        let mut cells = Cells::new(ground.size());
        // A cell lies in the ground area if its first pixel does: the area is made of 8 px blocks.
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                if area.holds(column * CELL_PX, row * CELL_PX) {
                    cells.flags[row * cells.columns + column] |= GROUND;
                }
            }
        }
        Self {
            ground,
            area,
            crests: Crests::new(ground),
            cells,
        }
    }

    /// The markings of some tones that are long enough, px at 1920 px width.
    fn markings(&self, tones: &[Tone], min_length_px: f64) -> MarkingPixels {
        let (size, is_turf) = (self.ground.size(), self.ground.surface().is_turf());
        // Ridges are pixels; which of them are paint is decided for whole components.
        let ridges = ridges(self.ground, &self.area, &self.crests, tones);
        let points = long_ones(&ridges, size, min_length_px, is_turf);
        let mut cells = self.cells.clone();
        for point in &points {
            cells.mark_stroke(point.at);
        }
        MarkingPixels { points, cells }
    }
}

/// Side of a cell, px.
const CELL_PX: usize = 2;
const GROUND: u8 = 1;
const STROKE: u8 = 2;

/// What a picture shows, as one byte of flags for each cell of [`CELL_PX`].
#[derive(Clone, Debug)]
struct Cells {
    size: ImageSize,
    columns: usize,
    rows: usize,
    flags: Vec<u8>,
}

impl Cells {
    fn new(size: ImageSize) -> Self {
        let (columns, rows) = (
            (size.width as usize).div_ceil(CELL_PX),
            (size.height as usize).div_ceil(CELL_PX),
        );
        Self {
            size,
            columns,
            rows,
            flags: vec![0; columns * rows],
        }
    }

    /// The flags of the cell that contains a point; none set outside the picture.
    fn at(&self, at: ImagePoint) -> u8 {
        if !self.size.contains(at) {
            return 0;
        }
        // The picture includes its right and lower border, where the last cells end.
        let (column, row) = (at.x as usize / CELL_PX, at.y as usize / CELL_PX);
        self.flags[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }

    /// Marks the 5 × 5 cells around a marking pixel: a point counts as paint within 4 to 6 px of
    /// it.
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
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{PICTURE, SIZE, soccer, truth};
    use std::collections::BTreeSet;
    use touchline_core::geometry::{Vec3, median};
    use touchline_core::markings::{SampleOptions, sample_lines};

    #[test]
    fn marking_pixels_are_the_painted_lines_and_nothing_else() {
        let (field, camera) = (soccer(), truth());
        let marking_pixels = MarkingPixels::detect(&GroundPicture::new(&PICTURE, &[]));
        let samples = sample_lines(
            &field,
            &camera,
            SIZE,
            &SampleOptions {
                spacing_px: 4.0,
                border_px: 20.0,
            },
        );
        let seen = samples
            .iter()
            .filter(|sample| marking_pixels.classify(sample.image) == PixelContent::Stroke)
            .count();
        assert!(
            seen as f64 > 0.85 * samples.len() as f64,
            "{seen} of {}",
            samples.len()
        );
        // The mowing stripes go on behind the field, where they are as thin as paint.
        let on_field =
            |at: &Vec3| at.x.abs() < 0.5 * field.length_m && at.y.abs() < 0.4 * field.width_m;
        let from_paint_m = |at: Vec3| {
            let lines = field.lines.iter().filter(|line| line.painted);
            lines
                .map(|line| line.paint_centre.distance_m(at))
                .fold(f64::INFINITY, f64::min)
        };
        let places = marking_pixels
            .points
            .iter()
            .filter_map(|point| camera.plane_from_image(point.at, 0.0))
            .filter(on_field);
        let distances_m: Vec<f64> = places.map(from_paint_m).collect();
        let right = distances_m
            .iter()
            .filter(|distance_m| **distance_m < 0.4)
            .count();
        assert!(
            right as f64 > 0.9 * distances_m.len() as f64,
            "{right} of {}",
            distances_m.len()
        );
        assert_eq!(
            marking_pixels.classify(ImagePoint::new(-3.0, 5.0)),
            PixelContent::Other
        );
    }

    /// Turf in two stripes of mowing with a painted line between them through the middle of the
    /// picture, and the normal of the line.
    fn line_between_stripes(
        angle_deg: f64,
        width_px: f64,
        stripes: [f64; 2],
    ) -> (GroundPicture, ImagePoint, Vec2) {
        let size = ImageSize::new(160, 120);
        let (middle, normal) = (
            ImagePoint::new(80.3, 60.1),
            Vec2::new(angle_deg.to_radians().cos(), angle_deg.to_radians().sin()),
        );
        // An edge with the blur of a lens.
        let beyond = |off_px: f64| 1.0 / (1.0 + (-off_px / 0.4).exp());
        let green = |x: u32, y: u32| {
            let off_px = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
                .offset_from(middle)
                .dot(&normal);
            let paint = beyond(off_px + 0.5 * width_px) - beyond(off_px - 0.5 * width_px);
            let ground = stripes[0] + (stripes[1] - stripes[0]) * beyond(off_px);
            (ground, paint)
        };
        let pixels = (0..size.height)
            .flat_map(|y| (0..size.width).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let (ground, paint) = green(x, y);
                let channel = |share: f64| (ground * share * (1.0 - paint) + 220.0 * paint) as u8;
                [channel(0.6), channel(1.2), channel(0.4), 255]
            });
        (
            GroundPicture::new(&Picture::new(size, pixels.collect()).unwrap(), &[]),
            middle,
            normal,
        )
    }

    #[test]
    fn the_middle_of_a_stroke_stays_where_a_stripe_of_mowing_ends_there() {
        for angle_deg in [0.0, 25.0, 90.0, 160.0] {
            for width_px in [1.2, 2.5, 5.0, 9.0] {
                for stripes in [[85.0, 85.0], [80.0, 105.0], [105.0, 80.0]] {
                    let (ground, middle, normal) =
                        line_between_stripes(angle_deg, width_px, stripes);
                    let points = MarkingPixels::detect(&ground).points;
                    assert!(
                        points.len() > 40,
                        "{angle_deg}°, {width_px} px, {stripes:?}: {} places",
                        points.len()
                    );
                    let mut off_px: Vec<f64> = points
                        .iter()
                        .map(|point| point.at.offset_from(middle).dot(&normal))
                        .collect();
                    let median_px = median(&mut off_px).unwrap();
                    assert!(
                        median_px.abs() < 0.2,
                        "{angle_deg}°, {width_px} px, {stripes:?}: {median_px:.2} px off"
                    );
                }
            }
        }
    }

    #[test]
    fn the_summed_contrast_of_a_stroke_is_that_of_its_paint_times_its_width() {
        // White on turf of this brightness; the stripes of mowing cancel out.
        let paint = 220.0 - 79.0;
        for (width_px, stripes) in [
            (0.5, [85.0, 85.0]),
            (0.8, [75.0, 95.0]),
            (1.2, [95.0, 75.0]),
            (2.5, [85.0, 85.0]),
            (4.0, [85.0, 85.0]),
        ] {
            let (ground, ..) = line_between_stripes(86.0, width_px, stripes);
            let points = MarkingPixels::detect(&ground).points;
            let mut sums: Vec<f64> = points
                .iter()
                .filter_map(|point| point.contrast_px)
                .collect();
            let share = median(&mut sums).unwrap() / (paint * width_px);
            assert!((0.85..1.15).contains(&share), "{width_px} px: {share:.2}");
        }
    }

    #[test]
    fn a_thin_stroke_has_no_gaps_where_a_stripe_of_mowing_ends_there() {
        for angle_deg in [82.0, 86.0, 98.0] {
            for width_px in [0.5, 0.8, 1.2] {
                for stripes in [[80.0, 100.0], [100.0, 75.0], [125.0, 90.0]] {
                    let (ground, ..) = line_between_stripes(angle_deg, width_px, stripes);
                    let columns: BTreeSet<u32> = MarkingPixels::detect(&ground)
                        .points
                        .iter()
                        .map(|point| point.at.x as u32)
                        .collect();
                    let missing = (15..145).filter(|column| !columns.contains(column)).count();
                    assert!(
                        missing < 10,
                        "{angle_deg}°, {width_px} px, {stripes:?}: no place in {missing} columns"
                    );
                }
            }
        }
    }

    #[test]
    fn a_bright_stripe_of_mowing_is_no_stroke_and_white_and_yellow_paint_are() {
        let size = ImageSize::new(160, 120);
        let marking_pixels_of = |colour: [f64; 3]| {
            let pixels = (0..size.height * size.width).flat_map(|pixel| {
                let off_px = f64::from(pixel / size.width) + 0.5 - 60.3;
                let share = (2.5 - off_px.abs()).clamp(0.0, 1.0);
                let channel =
                    |at: usize| ([54.0, 96.0, 40.0][at] * (1.0 - share) + colour[at] * share) as u8;
                [channel(0), channel(1), channel(2), 255]
            });
            MarkingPixels::detect(&GroundPicture::new(
                &Picture::new(size, pixels.collect()).unwrap(),
                &[],
            ))
            .points
            .len()
        };
        assert_eq!(marking_pixels_of([75.0, 130.0, 55.0]), 0, "brighter turf");
        for paint in [
            [120.0, 150.0, 110.0],
            [220.0, 220.0, 210.0],
            [210.0, 200.0, 50.0],
            [90.0, 120.0, 90.0],
        ] {
            assert!(marking_pixels_of(paint) > 100, "{paint:?}");
        }
    }

    #[test]
    fn a_picture_without_pixels_or_paint_has_no_marking_pixels() {
        for size in [
            ImageSize::new(0, 0),
            ImageSize::new(3, 2),
            ImageSize::new(200, 100),
        ] {
            let picture = Picture::with_colour(size, [60, 110, 40, 255]);
            assert!(
                MarkingPixels::detect(&GroundPicture::new(&picture, &[]))
                    .points
                    .is_empty(),
                "{size:?}"
            );
        }
    }
}
