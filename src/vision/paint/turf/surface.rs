//! The colours of a picture's ground, turf or floor, in any light.
//!
//! # Method
//!
//! A colour is represented by its chromaticity, the shares of red and green in the sum of the three
//! channels, so that light and shade have one colour. The chromaticities of a subsample of pixels
//! are counted in a histogram of 64 × 64 bins. The ground is the most common bin and everything
//! connected to it through bins that are common enough. This assumes only that the ground is the
//! most common colour.
//!
//! Floors have painted areas (keys, circles) of other colours. They are found by position: their
//! pixels lie between pieces of floor in a column of the picture. Turf has none.
//!
//! Where it is known which pixels show the field, the ground is the most common colour of these,
//! and the colours around the field are areas, too ([`Surface::with_floor`]).

use crate::media::Picture;

/// Bins of the histogram of chromaticities, per axis.
const BINS: usize = 64;

/// The range of the shares of red and green that the bins cover. Colours outside fall into the
/// outermost bins.
const SHARES: (f64, f64) = (0.12, 0.60);

/// Every n-th column and row is sampled.
const STRIDE: usize = 8;

/// Minimum count of a bin of the ground, as a share of the largest count.
const LEAST_COMMON: f64 = 0.03;

/// The same for the ground's most common colours, which hardly anything outside the field has.
const LEAST_COMMON_BARE: f64 = 0.08;

/// Pixels with a smaller sum of the three channels have no reliable chromaticity: there one grey
/// level changes a share by 1/36, which is nearly four bins.
const DARK: u32 = 36;

/// Ground is turf if its share of green exceeds those of red and of blue by this.
const GREEN: f64 = 0.01;

/// Maximum number of colours of painted areas.
const MOST_AREAS: usize = 3;

/// Minimum size of an area, in pixels between pieces of floor, as a share of the floor's pixels.
const LEAST_AREA: f64 = 0.03;

/// Minimum share of the pixels that show the field which have the floor's colours.
const LEAST_FLOOR: f64 = 0.4;

/// Minimum count of a bin of an area, as a share of the area's largest count.
const LEAST_COMMON_AREA: f64 = 0.12;

/// A bin is grey, such as white paint, if its shares of red and green are this near to a third.
/// Grey bins belong to no area.
const GREY: f64 = 0.025;

/// In a column, the floor begins and ends at runs of this many samples of which at most one is not
/// floor. Single samples may be skin.
const RUN: usize = 4;

/// The colours of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// For each bin, whether it belongs to the ground.
    of_ground: Vec<bool>,
    /// Whether the bin is one of the ground's most common colours.
    of_bare_ground: Vec<bool>,
    /// Whether the bin belongs to a painted area: a key, a circle, the surroundings of a court. All
    /// false on turf.
    of_areas: Vec<bool>,
    is_turf: bool,
}

/// The part of the ground that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::paint) enum GroundPart {
    /// Turf, or the floor's own colour.
    Bare,
    /// An area painted on a floor.
    Area,
}

/// The share at the centre of a bin, along one axis.
fn share_of(step: usize) -> f64 {
    SHARES.0 + (step as f64 + 0.5) / BINS as f64 * (SHARES.1 - SHARES.0)
}

/// The bin of a colour. None if it is too dark.
fn bin([red, green, blue]: [u8; 3]) -> Option<usize> {
    let sum = u32::from(red) + u32::from(green) + u32::from(blue);
    if sum < DARK {
        return None;
    }
    // The shares of red and green; blue's is the rest.
    let [red, green] = [red, green].map(|channel| {
        let share = f64::from(channel) / f64::from(sum);
        let at = (share - SHARES.0) / (SHARES.1 - SHARES.0) * BINS as f64;
        (at.max(0.0) as usize).min(BINS - 1)
    });
    Some(red * BINS + green)
}

impl Surface {
    /// The colours of a picture's ground.
    pub fn from_picture(picture: &Picture) -> Self {
        let bins = Bins::from_picture(picture);
        // Histogram, smoothed so that a sparse histogram stays connected.
        let mut counts = vec![0_f64; BINS * BINS];
        for bin in bins.rows.iter().flatten().flatten() {
            counts[*bin] += 1.0;
        }
        let counts = smooth_histogram(&counts);
        let peak = peak_of(&counts);
        // Two limits: the wide one for the ground beside paint, in all its shades; the narrow one,
        // with colours that hardly anything else has, for the extent of the field
        // (`ground_area.rs`).
        let of_ground = flood_fill_from_peak(&counts, LEAST_COMMON);
        let of_bare_ground = flood_fill_from_peak(&counts, LEAST_COMMON_BARE);
        let sum = sum_in(&counts, &of_ground);
        let is_turf = is_green(peak);
        let of_areas = if is_turf {
            vec![false; BINS * BINS]
        } else {
            bins.areas(&of_ground, sum)
        };
        Self {
            of_ground,
            of_bare_ground,
            of_areas,
            is_turf,
        }
    }

    /// The ground where pixels of these colours show the field: the most common of them is the
    /// floor, others may be areas painted on it, and the ground that was known before surrounds it.
    /// None if most of the pixels have no common colour.
    pub(in crate::paint) fn with_floor(&self, colours: &[[u8; 3]]) -> Option<Self> {
        let mut counts = vec![0_f64; BINS * BINS];
        for bin in colours.iter().filter_map(|colour| bin(*colour)) {
            counts[bin] += 1.0;
        }
        let counts = smooth_histogram(&counts);
        let of_ground = flood_fill_from_peak(&counts, LEAST_COMMON);
        let floor = sum_in(&counts, &of_ground);
        if !(floor >= LEAST_FLOOR * colours.len() as f64 && floor > 0.0) {
            return None;
        }
        // What else is common on the field is painted on it, unless it is grey like paint.
        let beside = counts.iter().enumerate();
        let beside = beside.map(|(bin, count)| {
            let is_other = !of_ground[bin] && !is_grey(bin);
            if is_other { *count } else { 0.0 }
        });
        let mut of_areas = areas_among(beside.collect(), &of_ground, floor);
        for (bin, is_area) in of_areas.iter_mut().enumerate() {
            *is_area |= (self.of_ground[bin] || self.of_areas[bin]) && !of_ground[bin];
        }
        Some(Self {
            of_bare_ground: flood_fill_from_peak(&counts, LEAST_COMMON_BARE),
            of_ground,
            of_areas,
            is_turf: is_green(peak_of(&counts)),
        })
    }

    /// Whether a colour belongs to the ground or to an area painted on it.
    pub fn holds(&self, colour: [u8; 3]) -> bool {
        self.part(colour).is_some()
    }

    /// The part of the ground that a colour belongs to. None if it is not the ground's.
    pub(in crate::paint) fn part(&self, colour: [u8; 3]) -> Option<GroundPart> {
        let bin = bin(colour)?;
        match (self.of_ground[bin], self.of_areas[bin]) {
            (true, _) => Some(GroundPart::Bare),
            (false, true) => Some(GroundPart::Area),
            (false, false) => None,
        }
    }

    /// Whether a colour is one of the ground's most common ones or belongs to a painted area.
    pub(super) fn is_common(&self, colour: [u8; 3]) -> bool {
        bin(colour).is_some_and(|bin| self.of_bare_ground[bin] || self.of_areas[bin])
    }

    /// Whether the ground is green. Lines on turf are lighter than it; lines on other floors may be
    /// darker or of another hue.
    pub const fn is_turf(&self) -> bool {
        self.is_turf
    }
}

/// The bins of the sampled pixels, row by row. None for dark pixels.
struct Bins {
    rows: Vec<Vec<Option<usize>>>,
}

impl Bins {
    fn from_picture(picture: &Picture) -> Self {
        let width = picture.size().width as usize;
        let rows = picture
            .rgba()
            .chunks_exact((4 * width).max(4))
            .step_by(STRIDE);
        let of_row = |row: &[u8]| {
            let pixels = row.as_chunks::<4>().0.iter().step_by(STRIDE);
            pixels
                .map(|pixel| bin([pixel[0], pixel[1], pixel[2]]))
                .collect()
        };
        Self {
            rows: rows.map(of_row).collect(),
        }
    }

    /// The bins of areas painted on a floor of `floor` sampled pixels.
    ///
    /// Position decides, because colour cannot: stands and boards may have the colours of areas,
    /// but they do not lie between two pieces of floor in a column of the picture.
    fn areas(&self, of_ground: &[bool], floor: f64) -> Vec<bool> {
        let mut between = vec![0_f64; BINS * BINS];
        for column in 0..self.rows.first().map_or(0, Vec::len) {
            // A column shows floor from its first run of floor samples to its last. With a single
            // run nothing lies in between.
            let mut starts = (0..(self.rows.len() + 1).saturating_sub(RUN))
                .filter(|row| self.is_run_of_floor(*row, column, of_ground));
            let (Some(first), last) = (starts.next(), starts.next_back()) else {
                continue;
            };
            // Whatever is in between and neither floor nor grey is counted. People are, too, but
            // they have many colours, none of them common.
            for row in first..last.unwrap_or(first) {
                if let Some(bin) =
                    self.rows[row][column].filter(|bin| !of_ground[*bin] && !is_grey(*bin))
                {
                    between[bin] += 1.0;
                }
            }
        }
        areas_among(smooth_histogram(&between), of_ground, floor)
    }

    /// Whether [`RUN`] samples of a column, from a row on, are floor, with one exception at most.
    fn is_run_of_floor(&self, row: usize, column: usize, of_ground: &[bool]) -> bool {
        let samples = self.rows[row..row + RUN].iter();
        let floor = samples.filter(|row| row[column].is_some_and(|bin| of_ground[bin]));
        floor.count() + 1 >= RUN
    }
}

/// The bins of areas painted on a floor of `floor` pixels, from the smoothed counts of what may be
/// one.
///
/// The most common colour, with what is connected to it, is an area; then the next. Taking the
/// counts of an area away leaves the peak of the next one. Smoothing has spread counts into bins of
/// the ground; these stay ground.
fn areas_among(mut left: Vec<f64>, of_ground: &[bool], floor: f64) -> Vec<bool> {
    let mut areas = vec![false; BINS * BINS];
    for _ in 0..MOST_AREAS {
        let area = flood_fill_from_peak(&left, LEAST_COMMON_AREA);
        let mut sum = 0.0;
        for (count, _) in left.iter_mut().zip(&area).filter(|(_, of)| **of) {
            sum += std::mem::take(count);
        }
        if !(sum >= LEAST_AREA * floor && sum > 0.0) {
            break;
        }
        for (bin, is_area) in areas.iter_mut().enumerate() {
            *is_area |= area[bin] && !of_ground[bin];
        }
    }
    areas
}

/// Whether the bin's chromaticity is that of turf: floors are of other colours.
fn is_green(bin: usize) -> bool {
    let (red, green) = (share_of(bin / BINS), share_of(bin % BINS));
    green - red.max(1.0 - red - green) > GREEN
}

/// The sum of the counts of some bins.
fn sum_in(counts: &[f64], of: &[bool]) -> f64 {
    let counts = counts.iter().zip(of).filter(|(_, of)| **of);
    counts.map(|(count, _)| count).sum()
}

/// Whether the bin's chromaticity is near that of grey.
fn is_grey(bin: usize) -> bool {
    let mut shares = [bin / BINS, bin % BINS].into_iter().map(share_of);
    shares.all(|share| (share - 1.0 / 3.0).abs() < GREY)
}

/// The most common bin.
fn peak_of(counts: &[f64]) -> usize {
    (0..counts.len())
        .max_by(|a, b| counts[*a].total_cmp(&counts[*b]))
        .unwrap_or(0)
}

/// Every count averaged with its eight neighbours; neighbours outside count as empty.
fn smooth_histogram(counts: &[f64]) -> Vec<f64> {
    (0..BINS * BINS)
        .map(|bin| bins_around(bin).map(|bin| counts[bin]).sum::<f64>() / 9.0)
        .collect()
}

/// A bin and its up to eight neighbours, row by row.
fn bins_around(bin: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (bin / BINS, bin % BINS);
    let columns = column.saturating_sub(1)..=(column + 1).min(BINS - 1);
    (row.saturating_sub(1)..=(row + 1).min(BINS - 1))
        .flat_map(move |row| columns.clone().map(move |column| row * BINS + column))
}

/// Flood fill from the most common bin through bins with more than `least_common` of its count,
/// diagonals included.
fn flood_fill_from_peak(counts: &[f64], least_common: f64) -> Vec<bool> {
    let mut reached = vec![false; counts.len()];
    let peak = peak_of(counts);
    let least = counts[peak] * least_common;
    // Bins are tested when they leave the stack; neighbours are pushed without a test.
    let mut open = vec![peak];
    while let Some(bin) = open.pop() {
        if reached[bin] || !(counts[bin] > least) {
            continue;
        }
        reached[bin] = true;
        open.extend(bins_around(bin));
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    /// A picture of vertical bands of equal width.
    fn bands(colours: &[[u8; 3]]) -> Picture {
        let size = ImageSize::new(40 * colours.len() as u32, 80);
        let row = colours
            .iter()
            .flat_map(|[red, green, blue]| [*red, *green, *blue, 255].repeat(40));
        Picture::new(size, row.collect::<Vec<u8>>().repeat(80)).unwrap()
    }

    #[test]
    fn stripes_of_light_and_shade_are_one_ground_and_paint_and_shirts_are_not() {
        let turf = [
            [60, 110, 40],
            [90, 165, 60],
            [45, 82, 30],
            [60, 110, 40],
            [90, 165, 60],
        ];
        let mut colours = turf.to_vec();
        colours.extend([[230, 235, 225], [190, 30, 40]]);
        let surface = Surface::from_picture(&bands(&colours));
        assert!(turf.iter().all(|colour| surface.holds(*colour)));
        assert!(
            !surface.holds([230, 235, 225])
                && !surface.holds([190, 30, 40])
                && !surface.holds([2, 4, 1])
        );
    }

    #[test]
    fn a_picture_without_pixels_or_light_has_no_ground() {
        for size in [ImageSize::new(0, 0), ImageSize::new(64, 64)] {
            let none = Surface::from_picture(&Picture::with_colour(size, [3, 3, 3, 255]));
            assert!(!none.holds([60, 110, 40]), "{size:?}");
        }
    }
}
