//! What the ground of a picture looks like: the colours of its turf or wood, whatever the light.

use crate::media::Picture;

/// Shares of red and of green in a colour's brightness are told apart in this many steps each.
const BINS: usize = 64;

/// The shares of red and green that the bins cover; colours outside fall into the outermost bin.
const SHARES: (f64, f64) = (0.12, 0.60);

/// One column and one row in this many is looked at.
const STRIDE: usize = 8;

/// A colour belongs to the ground if it is at least this common, as a share of the most common one,
/// and its neighbours connect it to that one.
const LEAST_COMMON: f64 = 0.03;

/// The same for its most common colours alone, which hardly anything beside the field has.
const LEAST_COMMON_BARE: f64 = 0.08;

/// Darker pixels than this (sum of three channels) have no colour worth the name.
const DARK: u32 = 36;

/// Ground is turf if its share of green exceeds those of red and blue by this.
const GREEN: f64 = 0.01;

/// Areas painted on a floor: at most this many colours,
const MOST_AREAS: usize = 3;

/// each at least this common between pieces of the floor, as a share of the floor itself;
const LEAST_AREA: f64 = 0.03;

/// their colours are at least this common, as a share of the most common one of the area.
const LEAST_COMMON_AREA: f64 = 0.12;

/// Greys, white paint among them, are no area: their shares are this near to a third.
const GREY: f64 = 0.025;

/// The floor begins and ends in a column of the picture where all but one of so many pixels looked
/// at are of it: single ones may be skin.
const RUN: usize = 4;

/// The colours of the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    of_ground: Vec<bool>,
    /// The bins of its most common colours.
    of_bare_ground: Vec<bool>,
    /// The bins of areas painted on it: keys, circles, what surrounds a court. Turf has none.
    of_areas: Vec<bool>,
    is_turf: bool,
    share: f64,
}

/// What a pixel of the ground belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GroundPart {
    /// Turf, or the floor's own colour.
    Bare,
    /// An area painted on a floor.
    Area,
}

/// The share in the middle of a bin, along one axis.
fn share_of(step: usize) -> f64 {
    SHARES.0 + (step as f64 + 0.5) / BINS as f64 * (SHARES.1 - SHARES.0)
}

/// The bin of a colour; none where it is too dark to have one.
fn bin([red, green, blue]: [u8; 3]) -> Option<usize> {
    let sum = u32::from(red) + u32::from(green) + u32::from(blue);
    if sum < DARK {
        return None;
    }
    let step = |channel: u8| {
        let share = f64::from(channel) / f64::from(sum);
        let at = (share - SHARES.0) / (SHARES.1 - SHARES.0) * BINS as f64;
        (at.max(0.0) as usize).min(BINS - 1)
    };
    Some(step(red) * BINS + step(green))
}

impl Surface {
    /// The ground of a picture: its most common colour and what is continuous with it.
    ///
    /// Colours are shares of red, green and blue, so that stripes of light and shade are one
    /// colour.
    #[must_use]
    pub fn of(picture: &Picture) -> Self {
        let bins = Bins::of(picture);
        let mut counts = vec![0_f64; BINS * BINS];
        for bin in bins.rows.iter().flatten().flatten() {
            counts[*bin] += 1.0;
        }
        let counts = blurred(&counts);
        let peak = peak_of(&counts);
        let of_ground = connected_to_the_peak(&counts, LEAST_COMMON);
        let of_bare_ground = connected_to_the_peak(&counts, LEAST_COMMON_BARE);
        let sum: f64 = counts
            .iter()
            .zip(&of_ground)
            .filter(|(_, of)| **of)
            .map(|(count, _)| count)
            .sum();
        let all = bins.rows.iter().map(Vec::len).sum::<usize>() as f64;
        let (red, green) = (share_of(peak / BINS), share_of(peak % BINS));
        let is_turf = green - red.max(1.0 - red - green) > GREEN;
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
            share: sum / all.max(1.0),
        }
    }

    /// Whether a colour is one of the ground's, or of an area that is painted on it.
    #[must_use]
    pub fn holds(&self, colour: [u8; 3]) -> bool {
        self.part(colour).is_some()
    }

    /// What a colour belongs to; none where it is not the ground's.
    #[must_use]
    pub(super) fn part(&self, colour: [u8; 3]) -> Option<GroundPart> {
        let bin = bin(colour)?;
        match (self.of_ground[bin], self.of_areas[bin]) {
            (true, _) => Some(GroundPart::Bare),
            (false, true) => Some(GroundPart::Area),
            (false, false) => None,
        }
    }

    /// Whether a colour is one of the ground's most common ones, or of an area that is painted on
    /// it.
    #[must_use]
    pub(super) fn is_common(&self, colour: [u8; 3]) -> bool {
        bin(colour).is_some_and(|bin| self.of_bare_ground[bin] || self.of_areas[bin])
    }

    /// Whether the ground is green: its lines are brighter than it. Those of other floors may be
    /// darker, or of another colour.
    #[must_use]
    pub const fn is_turf(&self) -> bool {
        self.is_turf
    }

    /// The share of the picture that has the ground's colours, from 0 to 1.
    #[must_use]
    pub const fn share(&self) -> f64 {
        self.share
    }
}

/// The bins of the pixels that are looked at, row by row.
struct Bins {
    rows: Vec<Vec<Option<usize>>>,
}

impl Bins {
    fn of(picture: &Picture) -> Self {
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

    /// The bins of areas painted on a floor of `floor` pixels: common colours that lie, in a column
    /// of the picture, between pieces of it.
    fn areas(&self, of_ground: &[bool], floor: f64) -> Vec<bool> {
        let mut between = vec![0_f64; BINS * BINS];
        for column in 0..self.rows.first().map_or(0, Vec::len) {
            let of_floor = |row: usize| self.rows[row][column].is_some_and(|bin| of_ground[bin]);
            let runs =
                |row: &usize| (*row..*row + RUN).filter(|row| of_floor(*row)).count() + 1 >= RUN;
            let mut starts = (0..(self.rows.len() + 1).saturating_sub(RUN)).filter(runs);
            let (Some(first), last) = (starts.next(), starts.next_back()) else {
                continue;
            };
            for row in first..last.unwrap_or(first) {
                if let Some(bin) =
                    self.rows[row][column].filter(|bin| !of_ground[*bin] && !is_grey(*bin))
                {
                    between[bin] += 1.0;
                }
            }
        }
        let mut left = blurred(&between);
        let mut areas = vec![false; BINS * BINS];
        for _ in 0..MOST_AREAS {
            let area = connected_to_the_peak(&left, LEAST_COMMON_AREA);
            let mut sum = 0.0;
            for (count, _) in left.iter_mut().zip(&area).filter(|(_, of)| **of) {
                sum += std::mem::take(count);
            }
            if !(sum >= LEAST_AREA * floor && sum > 0.0) {
                break;
            }
            for (bin, _) in area
                .iter()
                .enumerate()
                .filter(|(bin, of)| **of && !of_ground[*bin])
            {
                areas[bin] = true;
            }
        }
        areas
    }
}

fn is_grey(bin: usize) -> bool {
    let off = |step: usize| (share_of(step) - 1.0 / 3.0).abs();
    off(bin / BINS) < GREY && off(bin % BINS) < GREY
}

/// The most common bin.
fn peak_of(counts: &[f64]) -> usize {
    (0..counts.len())
        .max_by(|a, b| counts[*a].total_cmp(&counts[*b]))
        .unwrap_or(0)
}

/// Every count averaged with its eight neighbours.
fn blurred(counts: &[f64]) -> Vec<f64> {
    let at = |row: usize, column: usize| {
        let mut sum = 0.0;
        for r in row.saturating_sub(1)..=(row + 1).min(BINS - 1) {
            for c in column.saturating_sub(1)..=(column + 1).min(BINS - 1) {
                sum += counts[r * BINS + c];
            }
        }
        sum / 9.0
    };
    (0..BINS * BINS)
        .map(|index| at(index / BINS, index % BINS))
        .collect()
}

/// The bins that are common enough and reached from the most common one over such bins.
fn connected_to_the_peak(counts: &[f64], least_common: f64) -> Vec<bool> {
    let mut reached = vec![false; counts.len()];
    let peak = peak_of(counts);
    let least = counts[peak] * least_common;
    let mut open = vec![peak];
    while let Some(bin) = open.pop() {
        if reached[bin] || !(counts[bin] > least) {
            continue;
        }
        reached[bin] = true;
        let (row, column) = (bin / BINS, bin % BINS);
        for r in row.saturating_sub(1)..=(row + 1).min(BINS - 1) {
            for c in column.saturating_sub(1)..=(column + 1).min(BINS - 1) {
                open.push(r * BINS + c);
            }
        }
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
        let surface = Surface::of(&bands(&colours));
        assert!(turf.iter().all(|colour| surface.holds(*colour)));
        assert!(
            !surface.holds([230, 235, 225])
                && !surface.holds([190, 30, 40])
                && !surface.holds([2, 4, 1])
        );
        assert!(
            (surface.share() - 5.0 / 7.0).abs() < 0.15,
            "{}",
            surface.share()
        );
    }

    #[test]
    fn a_picture_without_pixels_or_light_has_no_ground() {
        let none = Surface::of(&Picture::filled(ImageSize::new(0, 0), [0, 0, 0, 255]));
        assert!(none.share() == 0.0 && !none.holds([60, 110, 40]));
        assert!(
            Surface::of(&Picture::filled(ImageSize::new(64, 64), [3, 3, 3, 255])).share() == 0.0
        );
    }
}
