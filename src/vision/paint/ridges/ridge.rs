//! Finds ridges of paint along the normal of a predicted line.
//!
//! On turf a ridge is brighter than the ground on both sides, has two edges at about the predicted
//! width, and has the ground's colours beside it. Its offset is the midpoint of the edges. Other
//! floors are searched by colour (`floor_ridge.rs`).

use super::floor_ridge::FloorRidgeFinder;
use super::profile::{Across, Profile, Ridge, is_like_paint, is_local_maximum};
use crate::paint::GroundPicture;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

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
}
