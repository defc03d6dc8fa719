//! Connected components of marking pixels, and which of them are paint.
//!
//! One pixel says too little: its colour is noisy, and the grain of the turf can look like paint.
//! A component has a length, and its pixels together have a colour and a brightness that can be
//! tested.

use super::MarkingPixel;
use super::ridges::RidgePixel;
use super::stroke_colours::Colours;
use crate::paint::turf::ground_area::parts;
use crate::paint::turf::turf_levels::TurfExcess;
use touchline_core::geometry::ImageSize;

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

/// The marking pixels of components that extend at least so far, px at 1920 px width, without the
/// pixels that dilation adds at their ends; on turf without components of lighter turf.
pub(super) fn long_ones(
    ridges: &[RidgePixel],
    size: ImageSize,
    min_length_px: f64,
    is_turf: bool,
) -> Vec<MarkingPixel> {
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
    let least_px = (min_length_px * size.scale_from_1920()).max(GRAIN_PX) + 2.0;
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
