//! Finds ridges of paint along the normal of a predicted line.
//!
//! On turf a ridge is brighter than the ground on both sides, has two edges at about the predicted
//! width, and has the ground's colours beside it. Its offset is the midpoint of the edges. Other
//! floors are searched by colour (`floor_ridge.rs`).

use super::floor_ridge::FloorRidgeFinder;
use super::profile::{Across, Profile, Ridge, is_like_paint, is_local_maximum};
use crate::paint::GroundPicture;
use std::ops::AddAssign;
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::LineSample;

/// Minimum contrast of paint against the brighter of its sides, grey levels.
const MIN_CONTRAST: f64 = 4.5;

/// Minimum contrast as a share of the brightness of the brighter side.
const MIN_CONTRAST_SHARE: f64 = 0.05;

/// Finds ridges. Its buffers are reused from line to line.
#[derive(Clone, Debug, Default)]
pub(in crate::paint) struct RidgeFinder {
    profile: Profile<f64>,
    contrast: Vec<f64>,
    on_floors: FloorRidgeFinder,
}

impl RidgeFinder {
    /// Appends the ridges within `reach_px` of a predicted line to `found`, in order of their
    /// offset. The profile is read every `step_px`.
    pub fn find(
        &mut self,
        ground: &GroundPicture,
        across: &Across,
        reach_px: f64,
        step_px: f64,
        found: &mut Vec<Ridge>,
    ) {
        // On floors, lines may be darker than the ground.
        if !ground.surface().is_turf() {
            self.on_floors
                .find(ground, across, reach_px, step_px, found);
            return;
        }
        // The profile extends beyond the reach, so that ridges at its ends have sides. One px of
        // the margin is searched as well: the maximum of a ridge within reach may lie there.
        let (near_px, far_px) = across.beside_px();
        let margin_px = across.margin_px();
        self.profile.read(
            ground.grey(),
            across.at,
            across.normal,
            reach_px + margin_px,
            step_px,
        );
        let profile = &self.profile;
        let expected_px = across.expected_width_px();
        // Contrast at a point: the mean of the middle 60 % of the predicted width, less the
        // brighter of the two bands beside the paint. The brighter one, because a mere step in
        // brightness must not count.
        let core = profile.places(0.3 * across.width_px);
        let (near, far) = (profile.places(near_px), profile.places(far_px));
        let searched = profile.without_margins(margin_px - 1.0);
        self.contrast.clear();
        self.contrast.extend((0..profile.len()).map(|index| {
            if !searched.contains(&index) {
                return f64::NEG_INFINITY;
            }
            let [left, right] = profile.beside(index, near, far);
            profile.mean(index, -core, core) - left.max(right)
        }));
        let reach = profile.places(0.5 * expected_px).max(1) as usize;
        let steps = profile.steps_within(0.9 * expected_px + 1.0);
        for index in searched {
            // Two limits: one in grey levels, against noise, and one relative to the brightness,
            // because the contrast of texture scales with the light.
            let contrast = self.contrast[index];
            let [left, right] = profile.beside(index, near, far);
            if !(contrast >= MIN_CONTRAST && contrast >= MIN_CONTRAST_SHARE * left.max(right)) {
                continue;
            }
            // Non-maximum suppression within half the expected width.
            if !is_local_maximum(&self.contrast, index, reach) {
                continue;
            }
            // Edges at half the contrast, each against its own side, interpolated between samples.
            // Where the sides differ, the maximum is shifted to the brighter one; the midpoint of
            // such edges is not.
            let top = profile.value(index).max(profile.mean(index, -core, core));
            let (Some(from), Some(to)) = (
                profile.falls_below(|grey| grey, index, -1, f64::midpoint(top, left), steps),
                profile.falls_below(|grey| grey, index, 1, f64::midpoint(top, right), steps),
            ) else {
                continue;
            };
            let (from_px, to_px) = (profile.offset_px(from), profile.offset_px(to));
            let ridge = Ridge {
                offset_px: f64::midpoint(from_px, to_px),
                width_px: to_px - from_px,
            };
            if is_like_paint(ground, across, &ridge, reach_px) {
                found.push(ridge);
            }
        }
    }
}

// The contrast of a line with the turf beside it, averaged over many places and pictures.
//
// Paint that is thinner than a pixel, or that an encoder has blurred, may stand out from the turf
// by less than the noise of any single picture, so that no detector of ridges finds it. A clip
// shows such a line at thousands of places, and the noise of a mean falls with the square root of
// their number: a line that is one grey level brighter than the turf is then plain to see.

/// The mean contrast of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineContrast {
    /// Sums over the places, against the turf on either side, grey levels.
    sums: [f64; 2],
    num_places: usize,
}

/// Distance of the turf that is compared from the edges of the paint, px: outside the blur of lens
/// and encoder.
const BESIDE_PX: f64 = 1.6;

/// Each level is the mean of points at these distances along the line, px.
const ALONG_PX: [f64; 3] = [-2.0, 0.0, 2.0];

/// Contrasts are limited to this range on either side of zero, grey levels, so that no player on a
/// line outweighs the line.
const MAX_CONTRAST: f64 = 6.0;

impl LineContrast {
    /// Adds a place: a sample of a line, moved by `offset_px` along its normal. `scale` multiplies
    /// the distance of the turf from the paint; it is above 1 in pictures in which the blur is
    /// wider. Places with anything but ground on either side do not count.
    pub fn add(&mut self, ground: &GroundPicture, sample: &LineSample, offset_px: f64, scale: f64) {
        let along = Vec2::new(-sample.normal.y, sample.normal.x);
        let middle = sample.image.translate(sample.normal * offset_px);
        let beside = sample.normal * (0.5 * sample.width_px + BESIDE_PX * scale);
        let sides = [middle.translate(beside), middle.translate(-beside)];
        let is_covered = |at: &ImagePoint| !ground.is_ground(*at) || ground.is_masked(*at);
        if sides.iter().any(is_covered) {
            return;
        }
        let [on_line, one, other] = [middle, sides[0], sides[1]].map(|at| {
            let levels = ALONG_PX.map(|by_px| ground.grey().at(at.translate(along * by_px)));
            levels.iter().sum::<f64>() / levels.len() as f64
        });
        // Each side by itself, where `ridge.rs` takes the brighter one at once: the brighter of two
        // noisy sides is biased, and a mean over many places would keep that bias.
        for (sum, side) in self.sums.iter_mut().zip([one, other]) {
            *sum += (on_line - side).clamp(-MAX_CONTRAST, MAX_CONTRAST);
        }
        self.num_places += 1;
    }

    /// The number of places.
    pub const fn num_places(&self) -> usize {
        self.num_places
    }

    /// The mean over all places, against the side that is brighter in the mean, grey levels. It is
    /// positive for paint alone: an edge, or a slope of the light, is darker than one of its sides
    /// wherever it is measured. None without places.
    pub fn mean(&self) -> Option<f64> {
        let [one, other] = self.sums;
        (self.num_places > 0).then(|| one.min(other) / self.num_places as f64)
    }
}

impl AddAssign for LineContrast {
    fn add_assign(&mut self, other: Self) {
        for (sum, other) in self.sums.iter_mut().zip(other.sums) {
            *sum += other;
        }
        self.num_places += other.num_places;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};

    const TURF: f64 = 90.0;

    /// Turf whose brightness across the picture is given in grey levels at columns (px), sampled
    /// four times a pixel.
    fn turf(brightness: impl Fn(f64) -> f64) -> GroundPicture {
        let size = ImageSize::new(160, 48);
        let row = (0..size.width).flat_map(|column| {
            let at = |sub: u32| brightness(f64::from(column) + (f64::from(sub) + 0.5) / 4.0);
            let grey = (0..4).map(at).sum::<f64>() / 4.0;
            let white = ((grey - TURF) / 100.0).clamp(0.0, 1.0);
            // Green where it is dark, white where it is bright.
            let tone =
                |green: f64| (grey * (green * (1.0 - white) + white)).clamp(0.0, 255.0) as u8;
            [tone(0.7), tone(1.2), tone(0.5), 255]
        });
        let row: Vec<u8> = row.collect();
        GroundPicture::new(
            &Picture::new(size, row.repeat(size.height as usize)).unwrap(),
            &[],
        )
    }

    fn ridges(ground: &GroundPicture, width_px: f64, outward: f64) -> Vec<Ridge> {
        let across = Across {
            at: ImagePoint::new(80.0, 24.0),
            normal: Vec2::new(1.0, 0.0),
            width_px,
            outward,
        };
        let mut found = Vec::new();
        RidgeFinder::default().find(ground, &across, 30.0, 0.5, &mut found);
        found
    }

    /// Paint between two columns with the blur of a lens.
    fn stroke(x: f64, from: f64, to: f64) -> f64 {
        let edge = |at: f64| 1.0 / (1.0 + (-(x - at) / 0.5).exp());
        TURF + 110.0 * (edge(from) - edge(to))
    }

    #[test]
    fn paint_is_found_to_a_tenth_of_a_pixel_whatever_its_width() {
        for width_px in [1.0, 2.0, 4.0, 7.0] {
            for shift in [-11.3, 0.0, 0.25, 0.5, 8.8] {
                let (from, to) = (80.0 + shift - width_px / 2.0, 80.0 + shift + width_px / 2.0);
                let found = ridges(&turf(|x| stroke(x, from, to)), width_px, 0.0);
                assert_eq!(found.len(), 1, "{width_px} px wide at {shift}: {found:?}");
                assert!(
                    (found[0].offset_px - shift).abs() < 0.1,
                    "{width_px} px wide at {shift}: {found:?}"
                );
                assert!(
                    (-0.2..1.6).contains(&(found[0].width_px - width_px)),
                    "{width_px} px wide: {found:?}"
                );
            }
        }
    }

    #[test]
    fn stripes_shadows_boards_and_players_are_no_paint() {
        let stripe = ridges(
            &turf(|x| if x < 83.0 { TURF } else { TURF * 1.4 }),
            3.0,
            0.0,
        );
        let shadow = ridges(
            &turf(|x| {
                if (78.0..82.0).contains(&x) {
                    TURF * 0.5
                } else {
                    TURF
                }
            }),
            3.0,
            0.0,
        );
        let board = ridges(
            &turf(|x| if x > 84.0 { TURF + 120.0 } else { TURF }),
            3.0,
            0.0,
        );
        let player = ridges(&turf(|x| stroke(x, 70.0, 88.0)), 3.0, 0.0);
        let faint = ridges(
            &turf(|x| {
                if (79.0..81.0).contains(&x) {
                    TURF + 3.0
                } else {
                    TURF
                }
            }),
            2.0,
            0.0,
        );
        for (what, found) in [
            ("stripe", stripe),
            ("shadow", shadow),
            ("board", board),
            ("player", player),
            ("faint", faint),
        ] {
            assert!(found.is_empty(), "{what}: {found:?}");
        }
    }

    #[test]
    fn two_lines_are_two_ridges_in_order() {
        let found = ridges(
            &turf(|x| stroke(x, 69.0, 71.0) + stroke(x, 91.0, 93.0) - TURF),
            2.0,
            0.0,
        );
        let offsets: Vec<f64> = found.iter().map(|ridge| ridge.offset_px.round()).collect();
        assert_eq!(offsets, [-10.0, 12.0]);
    }

    #[test]
    fn ground_may_end_beyond_the_paint_only_where_the_playing_area_ends() {
        // A touchline with the dark foot of a board right behind it.
        let size = ImageSize::new(160, 48);
        let row = (0..size.width).flat_map(|column| match column {
            0..79 => [60_u8, 110, 40, 255],
            79..82 => [220, 225, 215, 255],
            _ => [20, 20, 60, 255],
        });
        let row: Vec<u8> = row.collect();
        let ground = GroundPicture::new(&Picture::new(size, row.repeat(48)).unwrap(), &[]);
        assert_eq!(ridges(&ground, 3.0, 1.0).len(), 1);
        assert!(ridges(&ground, 3.0, 0.0).is_empty() && ridges(&ground, 3.0, -1.0).is_empty());
    }

    const SIZE: ImageSize = ImageSize {
        width: 81,
        height: 41,
    };
    const MIDDLE: u32 = SIZE.width / 2;

    /// The highest contrast within 1.5 px of the middle column of turf whose columns have some
    /// brightness.
    fn highest_contrast(brightness: impl Fn(u32) -> u8) -> f64 {
        let columns = (0..SIZE.width).map(|column| {
            let green = brightness(column);
            [green / 2, green, green / 2, 255]
        });
        let row: Vec<u8> = columns.flatten().collect();
        let picture = Picture::new(SIZE, row.repeat(SIZE.height as usize)).unwrap();
        let ground = GroundPicture::new(&picture, &[]);
        let sample = LineSample {
            line: 0,
            at: Vec3::zeros(),
            image: ImagePoint::new(40.5, 20.5),
            normal: Vec2::x(),
            width_px: 0.5,
            outward: 0.0,
        };
        let contrast_at = |offset_px: f64| {
            let mut contrast = LineContrast::default();
            contrast.add(&ground, &sample, offset_px, 1.0);
            contrast.mean().expect("all of it is turf")
        };
        let offsets_px = (-3..=3).map(|step| 0.5 * f64::from(step));
        offsets_px.map(contrast_at).fold(f64::MIN, f64::max)
    }

    #[test]
    fn an_edge_or_a_slope_of_the_light_is_no_line() {
        let edge = highest_contrast(|column| if column < MIDDLE { 110 } else { 122 });
        assert!(edge <= 0.0, "{edge}");
        let slope = highest_contrast(|column| 80 + column as u8);
        assert!(slope < 0.0, "{slope}");
        assert!(highest_contrast(|_| 120) <= 0.0);
    }

    #[test]
    fn a_line_along_an_edge_is_a_line() {
        let contrast = highest_contrast(|column| match column.cmp(&MIDDLE) {
            std::cmp::Ordering::Less => 110,
            std::cmp::Ordering::Equal => 126,
            std::cmp::Ordering::Greater => 122,
        });
        assert!(contrast > 1.0, "{contrast}");
    }

    #[test]
    fn without_places_there_is_no_contrast() {
        assert_eq!(LineContrast::default().mean(), None);
    }
}
