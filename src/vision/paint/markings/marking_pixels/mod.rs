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
//!    so are those with the colour of lighter turf, or as bright as its light stripes.

mod ridges;

use self::ridges::RidgePixel;
use crate::media::Picture;
use crate::paint::GroundPicture;
use crate::paint::turf::ground_area::{GroundArea, parts};
use crate::paint::turf::turf_levels::TurfExcess;
use ridges::ridges;
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

impl MarkingPixels {
    /// Detects the markings of a picture.
    pub fn detect(ground: &GroundPicture) -> Self {
        let size = ground.size();
        let area = GroundArea::detect(ground);
        let mut cells = Cells::new(size);
        // A cell lies in the ground area if its first pixel does: the area is made of 8 px blocks.
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                if area.holds(column * CELL_PX, row * CELL_PX) {
                    cells.flags[row * cells.columns + column] |= GROUND;
                }
            }
        }
        // Ridges are pixels; which of them are paint is decided for whole components.
        let ridges = ridges(ground, &area);
        let points = long_ones(&ridges, size, ground.surface().is_turf());
        for point in &points {
            cells.mark_stroke(point.at);
        }
        Self { points, cells }
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

// Connected components of marking pixels, and which of them are paint.
//
// One pixel says too little: its colour is noisy, and the grain of the turf can look like paint.
// A component has a length, and its pixels together have a colour and a brightness that can be
// tested.

/// Minimum extent of a connected component, px at 1920 px width, without the pixels that dilation
/// adds at its ends.
const MIN_LENGTH_PX: f64 = 28.0;

/// Lower limit of the minimum extent in small pictures, px. The blur has a fixed width and makes
/// the grain of the turf into components of about this extent at any resolution.
const GRAIN_PX: f64 = 20.0;

/// A connected component of marking pixels, with sums over them.
#[derive(Clone, Copy, Debug, Default)]
struct Component {
    /// Diagonal of its bounding box, px.
    length_px: f64,
    colours: Colours,
    excess: TurfExcess,
}

impl Component {
    /// Whether it is turf that is lighter than the turf beside it. Where the colours do not say,
    /// the brightness of the turf around decides.
    fn is_turf(&self) -> bool {
        self.colours.are_of_brighter_turf()
            || (!self.colours.are_whiter() && self.excess.is_light_turf())
    }
}

/// The marking pixels of components that are long enough; on turf without components of lighter
/// turf.
fn long_ones(ridges: &[RidgePixel], size: ImageSize, is_turf: bool) -> Vec<MarkingPixel> {
    let (width, height) = (size.width as usize, size.height as usize);
    // Dilating by one pixel joins pixels across gaps of up to two pixels. A thin or worn line
    // breaks up into such pieces, and each alone would be too short.
    let mut set = vec![false; width * height];
    for ridge in ridges {
        let (x, y) = (ridge.index % width, ridge.index / width);
        for y in y.saturating_sub(1)..(y + 2).min(height) {
            set[y * width + x.saturating_sub(1)..y * width + (x + 2).min(width)].fill(true);
        }
    }
    // The component of each pixel, and the extent of each component: the diagonal of its bounding
    // box, px, which for a straight line is its length. A component is never empty.
    let mut of_part = vec![0_usize; width * height];
    let mut components: Vec<Component> = Vec::new();
    for part in parts(&set, width) {
        let length = extent(part.iter().map(|index| index % width))
            .hypot(extent(part.iter().map(|index| index / width)));
        for index in part {
            of_part[index] = components.len();
        }
        components.push(Component {
            length_px: f64::from(length),
            ..Component::default()
        });
    }
    // Colours are summed over whole components; the colour of one pixel is too noisy to decide.
    for ridge in ridges {
        let component = &mut components[of_part[ridge.index]];
        component.colours.add(&ridge.colours);
        component.excess.add(&ridge.excess);
    }
    // Dilation adds one pixel at each end.
    let least_px = (MIN_LENGTH_PX * size.scale_from_1920()).max(GRAIN_PX) + 2.0;
    let is_paint: Vec<bool> = components
        .iter()
        .map(|component| component.length_px > least_px && !(is_turf && component.is_turf()))
        .collect();
    let painted = ridges.iter().filter(|ridge| is_paint[of_part[ridge.index]]);
    painted
        .map(|ridge| MarkingPixel {
            at: ridge.at,
            normal: ridge.normal,
            contrast_px: ridge.contrast_px,
        })
        .collect()
}

/// The difference of the largest and the smallest of some coordinates.
fn extent(coordinates: impl Iterator<Item = usize>) -> f32 {
    let (least, most) = coordinates.fold((usize::MAX, 0), |(least, most), at| {
        (least.min(at), most.max(at))
    });
    (most - least) as f32
}

// The colours of a marking and of the ground beside it, which tell paint from lighter turf.
//
// A mowing stripe that is seen from far away is as thin as paint, and brighter than the turf
// beside it. Its colour differs: a stripe adds the turf's own green to the ground, while paint
// adds white or yellow.

/// Sums of red, green and blue over marking pixels: on the marking, and on the ground beside it.
#[derive(Clone, Copy, Debug, Default)]
struct Colours {
    stroke: [f64; 3],
    ground: [f64; 3],
    /// Number of pixels.
    pixels: f64,
}

impl Colours {
    /// The colours at the centre of a marking and, averaged, `side_px` to both sides of it.
    pub fn at(picture: &Picture, at: ImagePoint, normal: Vec2, side_px: f64) -> Self {
        // Whole pixels without interpolation: the sums over a component average their noise.
        // Outside of the picture the border pixel counts, as for the brightness.
        let size = picture.size();
        let (right, bottom) = (size.width.saturating_sub(1), size.height.saturating_sub(1));
        let [stroke, one, other] = [0.0, side_px, -side_px].map(|beside_px| {
            let at = at.translate(normal * beside_px);
            let (column, row) = (at.x.max(0.0) as u32, at.y.max(0.0) as u32);
            let pixel = picture.pixel(column.min(right), row.min(bottom));
            let [red, green, blue, _] = pixel.unwrap_or_default();
            [red, green, blue].map(f64::from)
        });
        Self {
            stroke,
            ground: [0, 1, 2].map(|channel| f64::midpoint(one[channel], other[channel])),
            pixels: 1.0,
        }
    }

    pub fn add(&mut self, other: &Self) {
        for channel in 0..3 {
            self.stroke[channel] += other.stroke[channel];
            self.ground[channel] += other.ground[channel];
        }
        self.pixels += other.pixels;
    }

    /// Whether the marking is whiter than the ground, and not only brighter: it is less green.
    ///
    /// Paint mixes with the turf of a pixel, so that brightness and greenness change in proportion,
    /// however thin the paint is. Strong compression keeps the brightness and loses the greenness.
    pub fn are_whiter(&self) -> bool {
        /// Minimum change of greenness, as a share of that by white paint.
        const SHARE: f64 = 0.33;
        const WHITE: f64 = 255.0;
        let mean = |colour: [f64; 3]| colour.iter().sum::<f64>() / 3.0;
        // The sums are over many pixels, so they are compared as shares of the ground's brightness.
        // A pixel of the share p of white paint is brighter by p (255 − ground) and less green by p
        // times the ground's greenness: `white` is the ratio of the two. On black ground all is NaN
        // or infinite, and the answer is no.
        let ground = mean(self.ground);
        let brighter = (mean(self.stroke) - ground) / ground;
        let less_green = (greenness(self.ground) - greenness(self.stroke)) / ground;
        let pixels = self.pixels.max(1.0);
        let white = greenness(self.ground) / pixels / (WHITE - ground / pixels);
        less_green > SHARE * white * brighter
    }

    /// Whether the marking is turf that is lighter than the turf beside it, such as a mowing stripe
    /// seen from far away.
    ///
    /// Compares the colour that the marking adds to the ground. Lighter turf adds the ground's own
    /// green. White paint adds less green than red and blue, and yellow paint adds hardly any blue.
    pub fn are_of_brighter_turf(&self) -> bool {
        /// Minimum ratio of greenness, added colour by ground, for lighter turf. Painted lines of a
        /// drawn match have at most 0.1, mowing stripes at least 0.44.
        const GREEN: f64 = 0.35;
        /// Yellow paint has at least this much more red than blue, as a share of the colour that it
        /// adds.
        const YELLOW: f64 = 0.35;
        // Greenness is taken as a share of the brightness, so that the ratio of the two does not
        // depend on how much is added.
        let added = [0, 1, 2].map(|channel| self.stroke[channel] - self.ground[channel]);
        let green = |colour: [f64; 3]| greenness(colour) / colour.iter().sum::<f64>();
        let [red, _, blue] = added;
        let all: f64 = added.iter().sum();
        all > 0.0
            && green(self.ground) > 0.0
            && green(added) > GREEN * green(self.ground)
            && (red - blue) / all < YELLOW
    }
}

/// Green less the mean of red and blue.
fn greenness([red, green, blue]: [f64; 3]) -> f64 {
    green - f64::midpoint(red, blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{PICTURE, SIZE, soccer, truth};
    use std::collections::BTreeSet;
    use touchline_core::geometry::{ImageSize, Vec3, median};
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

    #[test]
    fn the_ground_beside_a_marking_at_the_border_is_that_of_the_border() {
        let turf = [60, 120, 60, 255];
        let picture = Picture::with_colour(ImageSize::new(20, 20), turf);
        for at in [ImagePoint::new(2.5, 2.5), ImagePoint::new(17.5, 17.5)] {
            for normal in [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)] {
                let colours = Colours::at(&picture, at, normal, 8.0);
                assert_eq!(colours.ground, [60.0, 120.0, 60.0], "{at:?} {normal:?}");
            }
        }
    }
}
