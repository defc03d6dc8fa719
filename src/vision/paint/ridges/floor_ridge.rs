//! Ridges of lines on floors of wood, plastic or ice.
//!
//! Such a line may be brighter or darker than the floor or of another hue, and the floor may differ
//! on its two sides, because painted areas often end at lines. Brightness alone is therefore not
//! enough.
//!
//! # Method
//!
//! The contrast of a point is the distance of its colour from the segment between the colours of
//! its two sides (colour space: `colours.rs`). A plain border between two areas, blurred, has only
//! colours on that segment, so its contrast is zero. Local maxima of the contrast are candidates.
//! Their edges are measured along the colour direction in which the line stands out. If the sides
//! differ in that direction, a blurred stripe of known width is fitted instead.

use super::colours::{Colour, ColourProfile};
use super::profile::{Across, Ridge, is_like_paint, is_local_maximum};
use crate::paint::GroundPicture;
use touchline_core::geometry::{Mat3, Vec3};

/// Minimum distance of a line's colour from all mixtures of its sides' colours, grey levels.
const MIN_CONTRAST: f64 = 9.0;

/// Minimum of that distance as a share of the distance between the sides' colours. Compression
/// blurs hues more than brightness, so that a plain border has colours off the segment.
const MIN_SHARE_OF_STEP: f64 = 0.22;

/// Sides that differ by more than this share of the contrast bias the points of half contrast.
const UNEVEN: f64 = 0.12;

/// Standard deviation of the blur by optics and compression, px.
const BLUR_PX: f64 = 0.8;

/// The centre of a line between different sides is sought this far around the midpoint of the
/// edges, in these steps, px.
const MOVED_PX: f64 = 1.75;
const MOVED_STEP_PX: f64 = 0.25;

/// Finds ridges on floors. Its buffers are reused from line to line.
#[derive(Clone, Debug, Default)]
pub(super) struct FloorRidgeFinder {
    profile: ColourProfile,
    contrast: Vec<f64>,
}

/// The colours on both sides of a point, and its own colour relative to them.
struct Sides {
    left: Colour,
    right: Colour,
    /// From the nearest mixture of the sides' colours to the point's colour.
    excess: Colour,
}

impl FloorRidgeFinder {
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
        let margin_px = across.margin_px();
        self.profile.read(
            ground.picture(),
            across.at,
            across.normal,
            reach_px + margin_px,
            step_px,
        );
        let profile = &self.profile;
        // Contrast along the profile. Its ends are read only as sides of the points in between.
        let searched = profile.without_margins(margin_px - 1.0);
        self.contrast.clear();
        self.contrast.extend((0..profile.len()).map(|index| {
            if searched.contains(&index) {
                sides(profile, across, index).contrast()
            } else {
                f64::NEG_INFINITY
            }
        }));
        // Non-maximum suppression within half the expected width.
        let reach = profile.places(0.5 * across.expected_width_px()).max(1) as usize;
        for index in searched {
            let is_peak = self.contrast[index] >= MIN_CONTRAST
                && is_local_maximum(&self.contrast, index, reach);
            if is_peak
                && let Some(ridge) = ridge(profile, across, index)
                && is_like_paint(ground, across, &ridge, reach_px)
            {
                found.push(ridge);
            }
        }
    }
}

impl Sides {
    /// Distance of the colour from all mixtures of the sides; −∞ if a blurred border could explain
    /// it.
    fn contrast(&self) -> f64 {
        let contrast = self.excess.norm();
        if contrast >= MIN_SHARE_OF_STEP * (self.left - self.right).norm() {
            contrast
        } else {
            f64::NEG_INFINITY
        }
    }
}

fn sides(profile: &ColourProfile, across: &Across, index: usize) -> Sides {
    let (near_px, far_px) = across.beside_px();
    let (near, far) = (profile.places(near_px), profile.places(far_px));
    // The middle 60 % of the line's width: its own colour, hardly mixed with the sides.
    let core = profile.places(0.3 * across.width_px);
    let [left, right] = profile.beside(index, near, far);
    let here = profile.mean(index, -core, core);
    // Projection onto the segment left–right; clamped, because beyond an end no mixture exists.
    let step = right - left;
    let share = if step.norm_squared() > 0.0 {
        (here - left).dot(&step) / step.norm_squared()
    } else {
        0.0
    };
    Sides {
        left,
        right,
        excess: here - (left + step * share.clamp(0.0, 1.0)),
    }
}

/// The ridge at a point of the profile, measured along the direction in which its colour differs
/// from its sides. None if an edge is not found near enough.
fn ridge(profile: &ColourProfile, across: &Across, index: usize) -> Option<Ridge> {
    let Sides {
        left,
        right,
        excess,
    } = sides(profile, across, index);
    // One-dimensional levels: projections onto the direction of greatest contrast. Along it the
    // line is a maximum, whether it is darker, brighter or of another hue. The contrast of a peak
    // has a minimum, so that nothing is divided by zero.
    let contrast = excess.norm();
    let direction = excess / contrast;
    let core = profile.places(0.3 * across.width_px);
    let own = profile.value(index);
    let top = direction
        .dot(&own)
        .max(direction.dot(&profile.mean(index, -core, core)));
    let (left, right) = (direction.dot(&left), direction.dot(&right));
    // From the peak outwards, to half the contrast against that side, interpolated between samples.
    let reach = profile.places(0.9 * across.expected_width_px() + 1.0);
    let steps = reach.max(1) as usize + 1;
    let [from_px, to_px] = [(-1, left), (1, right)].map(|(towards, side)| {
        let half = f64::midpoint(top, side);
        let edge =
            profile.falls_below(|colour| direction.dot(&colour), index, towards, half, steps)?;
        Some(profile.offset_px(edge))
    });
    let (from_px, to_px) = (from_px?, to_px?);
    let middle_px = f64::midpoint(from_px, to_px);
    // Half-contrast points of different levels are not symmetric about the centre of a blurred
    // line.
    let is_uneven = (left - right).abs() > UNEVEN * contrast;
    let offset_px = if is_uneven {
        middle_between_uneven_sides_px(profile, across, middle_px, &direction)?
    } else {
        middle_px
    };
    Some(Ridge {
        offset_px,
        width_px: to_px - from_px,
    })
}

/// The centre of a line between sides of different levels, by least squares near `near_px`. Levels
/// are projections of colours onto `direction`. None if the best centre is at an end of the search
/// interval.
///
/// Model at offset o, for a centre m, a line of width w, blur σ and the normal distribution
/// function Φ, with a = Φ((o − m + w/2)/σ) and b = Φ((o − m − w/2)/σ):
///
/// level(o) = left · (1 − a) + line · (a − b) + right · b
///
/// For a given m the three levels are linear unknowns. Only m is searched, on a grid.
fn middle_between_uneven_sides_px(
    profile: &ColourProfile,
    across: &Across,
    near_px: f64,
    direction: &Colour,
) -> Option<f64> {
    let (_, far_px) = across.beside_px();
    let (width_px, reach_px) = (across.width_px, far_px + MOVED_PX);
    // The part of the profile that the model describes for every centre tried.
    let places = (0..profile.len()).map(|place| (profile.offset_px(place as f64), place));
    let seen: Vec<(f64, f64)> = places
        .filter(|(offset_px, _)| (offset_px - near_px).abs() <= reach_px)
        .map(|(offset_px, place)| (offset_px, direction.dot(&profile.value(place))))
        .collect();
    // Grid search, then the vertex of the parabola through the minimum and its two neighbours.
    let steps = (MOVED_PX / MOVED_STEP_PX) as i32;
    let tried: Vec<f64> = (-steps..=steps)
        .map(|step| {
            let middle_px = near_px + f64::from(step) * MOVED_STEP_PX;
            least_squares_of_stripe(&seen, middle_px, width_px)
        })
        .collect::<Option<_>>()?;
    let best = (0..tried.len()).min_by(|a, b| tried[*a].total_cmp(&tried[*b]))?;
    let (less, here, more) = (
        *tried.get(best.checked_sub(1)?)?,
        tried[best],
        *tried.get(best + 1)?,
    );
    let curvature = less - 2.0 * here + more;
    let between = if curvature > 0.0 {
        0.5 * (less - more) / curvature
    } else {
        0.0
    };
    Some(near_px + (best as f64 - f64::from(steps) + between) * MOVED_STEP_PX)
}

/// The least sum of squares of a blurred stripe with a given centre over samples (offset px,
/// level). None if they do not determine the three levels.
fn least_squares_of_stripe(seen: &[(f64, f64)], middle_px: f64, width_px: f64) -> Option<f64> {
    let (mut matrix, mut gradient, mut sum) = (Mat3::zeros(), Vec3::zeros(), 0.0);
    for (offset_px, level) in seen {
        // Shares of the left side, the line and the right side at this offset: 1 − a, a − b and b.
        let [a, b] = [0.5, -0.5]
            .map(|edge| normal_cdf((offset_px - (middle_px - edge * width_px)) / BLUR_PX));
        let row = Vec3::new(1.0 - a, a - b, b);
        matrix += row * row.transpose();
        gradient += row * *level;
        sum += level * level;
    }
    // With the normal equations A x = g it is Σ level² − x·g.
    let levels = matrix.cholesky()?.solve(&gradient);
    Some(sum - levels.dot(&gradient))
}

/// The standard normal distribution function, to 2e-4: a logistic curve with a cubic term (Bowling,
/// Khasawneh, Kaewkuekool, Cho: "A logistic approximation to the cumulative normal distribution",
/// 2009).
fn normal_cdf(at: f64) -> f64 {
    1.0 / (1.0 + (-0.07056 * at.powi(3) - 1.5976 * at).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{COURT, SIZE, court, court_camera, court_truth};
    use crate::paint::{MarkingPixels, SnapOptions, check_lines, snap};
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
    use touchline_core::markings::LineVerdict;

    const WOOD: [f64; 3] = [214.0, 178.0, 132.0];
    const BLUE: [f64; 3] = [18.0, 52.0, 140.0];

    /// A floor whose colour is given at columns (px): above and below it is wood, so that an area
    /// of another colour is one.
    fn floor(colour: impl Fn(f64) -> [f64; 3]) -> GroundPicture {
        let size = ImageSize::new(160, 480);
        let row = |band: bool| -> Vec<u8> {
            let column = |column: u32| {
                let at = |sub: u32| f64::from(column) + (f64::from(sub) + 0.5) / 8.0;
                let colours = (0..8).map(|sub| if band { colour(at(sub)) } else { WOOD });
                let sum = colours.fold([0.0; 3], |sum, colour| {
                    [0, 1, 2].map(|channel| sum[channel] + colour[channel])
                });
                [sum[0] / 8.0, sum[1] / 8.0, sum[2] / 8.0, 255.0]
                    .map(|value: f64| value.round() as u8)
            };
            (0..size.width).flat_map(column).collect()
        };
        let rows = (0..size.height).flat_map(|y| row((200..280).contains(&y)));
        GroundPicture::new(&Picture::new(size, rows.collect()).unwrap(), &[])
    }

    fn mixed(shares: &[(f64, [f64; 3])]) -> [f64; 3] {
        [0, 1, 2].map(|channel| {
            shares
                .iter()
                .map(|(share, colour)| share * colour[channel])
                .sum()
        })
    }

    /// A line between two columns, with the blur of a lens, between two grounds.
    fn line(x: f64, from: f64, to: f64, colours: [[f64; 3]; 3]) -> [f64; 3] {
        let beyond = |edge: f64| 1.0 / (1.0 + (-(x - edge) / 0.4).exp());
        mixed(&[
            (1.0 - beyond(from), colours[0]),
            (beyond(from) - beyond(to), colours[1]),
            (beyond(to), colours[2]),
        ])
    }

    fn ridges(ground: &GroundPicture, width_px: f64) -> Vec<Ridge> {
        let across = Across {
            at: ImagePoint::new(80.0, 240.0),
            normal: Vec2::new(1.0, 0.0),
            width_px,
            outward: 0.0,
        };
        let mut found = Vec::new();
        FloorRidgeFinder::default().find(ground, &across, 30.0, 0.5, &mut found);
        found
    }

    #[test]
    fn lines_of_any_colour_are_found_also_where_an_area_ends() {
        let white = [238.0; 3];
        // Of wood's brightness.
        let red = [246.0, 160.0, 150.0];
        for (colours, allowed_px) in [
            ([WOOD, white, WOOD], 0.12),
            ([WOOD, BLUE, WOOD], 0.12),
            ([WOOD, red, WOOD], 0.15),
            ([BLUE, white, BLUE], 0.12),
            ([BLUE, white, WOOD], 0.25),
            ([WOOD, white, BLUE], 0.25),
        ] {
            for width_px in [2.0, 3.5, 6.0] {
                for shift in [-7.3, 0.0, 0.5, 6.25] {
                    let (from, to) = (80.0 + shift - width_px / 2.0, 80.0 + shift + width_px / 2.0);
                    let found = ridges(&floor(|x| line(x, from, to, colours)), width_px);
                    assert_eq!(
                        found.len(),
                        1,
                        "{colours:?} {width_px} px wide at {shift}: {found:?}"
                    );
                    let off_px = found[0].offset_px - shift;
                    assert!(
                        off_px.abs() < allowed_px,
                        "{colours:?} {width_px} px wide at {shift}: {off_px} px"
                    );
                }
            }
        }
    }

    #[test]
    fn borders_wide_areas_planks_and_shirts_are_no_lines() {
        let border = ridges(&floor(|x| line(x, 80.0, 400.0, [WOOD, BLUE, WOOD])), 3.0);
        let area = ridges(&floor(|x| line(x, 72.0, 90.0, [WOOD, BLUE, WOOD])), 3.0);
        let plank = ridges(
            &floor(|x| line(x, 79.0, 82.0, [WOOD, WOOD.map(|value| value - 6.0), WOOD])),
            3.0,
        );
        let shirt = [190.0, 30.0, 40.0];
        let on_shirt = |x: f64| {
            if (x - 80.0).abs() < 9.0 {
                line(x, 78.5, 81.5, [shirt, [238.0; 3], shirt])
            } else {
                WOOD
            }
        };
        let seam = ridges(&floor(on_shirt), 3.0);
        for (what, found) in [
            ("border", border),
            ("area", area),
            ("plank", plank),
            ("shirt", seam),
        ] {
            assert!(found.is_empty(), "{what}: {found:?}");
        }
    }

    #[test]
    fn a_court_tells_its_camera_from_others_and_gives_it_back() {
        let (field, ground) = (court(), GroundPicture::new(&COURT, &[]));
        assert!(!ground.surface().is_turf());
        let right = check_lines(&ground, &field, &court_truth());
        assert_eq!(right.verdict(), LineVerdict::Supports, "{right:?}");
        assert!(
            right.offset_px < 0.3 && right.found > 4 * right.bare,
            "{right:?}"
        );
        for (pan_deg, tilt_deg, focal_px) in [
            (-16.5, -21.0, 1300.0),
            (-18.0, -22.0, 1300.0),
            (-18.0, -21.0, 1450.0),
            (-18.6, -21.0, 1300.0),
        ] {
            let wrong = check_lines(&ground, &field, &court_camera(pan_deg, tilt_deg, focal_px));
            assert_ne!(wrong.verdict(), LineVerdict::Supports, "{wrong:?}");
        }
        for start in [
            court_camera(-17.8, -20.8, 1310.0),
            court_camera(-18.5, -21.2, 1290.0),
        ] {
            let found = snap(
                &ground,
                &field,
                start.base(),
                start.ptz(),
                &[],
                &SnapOptions::default(),
            )
            .unwrap();
            let off = crate::paint::camera_alignment::check::overlays_apart_px(
                &court_truth(),
                found.ptz,
                SIZE,
            );
            assert!(off < 0.3, "{off} px: {found:?}");
        }
    }

    #[test]
    fn dark_lines_of_a_floor_are_marking_pixels() {
        let (field, camera) = (court(), court_truth());
        let marking_pixels = MarkingPixels::detect(&GroundPicture::new(&COURT, &[]));
        let arc = field
            .lines
            .iter()
            .find(|line| line.id.as_str() == "three_point_arc_left")
            .unwrap();
        let near = marking_pixels
            .points
            .iter()
            .filter_map(|point| camera.plane_from_image(point.at, 0.0));
        let on_arc = near
            .filter(|at| arc.paint_centre.distance_m(*at) < 0.1)
            .count();
        assert!(on_arc > 200, "{on_arc}");
    }
}
