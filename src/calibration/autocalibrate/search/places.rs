//! The places of a camera that the exhaustive search tries.
//!
//! Nearly every broadcast is filmed from the stand along one side, so that place is searched first,
//! on a regular grid. Only where it gives no answer are the *other* places tried: behind either
//! goal, the corners, the goal lines extended, masts beside the touchline, and what is higher or
//! lower than usual. They lie on rings around the field, close together near it and wide apart far
//! from it, because a near camera sees a metre of its own position as more.
//!
//! A field looks the same after half a turn, so a camera on the other side is found as one on this
//! side. The places cover the half y ≤ 0 alone.

use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, Vec3};

/// The size of a field relative to a soccer pitch of 105 × 68 m, by their diagonals. Lengths of
/// the search are stated for such a pitch and multiplied by this: a field half as large looks the
/// same from half as far away.
pub fn relative_size(field: &FieldModel) -> f64 {
    field.length_m.hypot(field.width_m) / 105_f64.hypot(68.0)
}

/// Whether lines across a field repeat so often that moved along it by one of their distances it
/// looks nearly the same: of a drawn American football field a camera two five-yard lines off had
/// as much evidence as the right one, and all its frames on their lines.
pub fn has_repeating_lines(field: &FieldModel) -> bool {
    /// Soccer has nine lines across, most of them short, and hockey five.
    const MOST_ACROSS: usize = 12;
    let across = field.lines.iter().filter(|line| {
        let [from, to] = [0.0, 1.0].map(|along| line.curve.point_at(along));
        (from.x - to.x).abs() < 0.1 && (from.y - to.y).abs() > 0.5 * field.width_m
    });
    across.count() > MOST_ACROSS
}

/// Whether a field is a court, which pictures may show whole: less than half the size of a soccer
/// pitch.
pub fn is_court(field: &FieldModel) -> bool {
    relative_size(field) < 0.5
}

/// Places to try, in `world`.
pub struct SearchPlaces {
    /// Positions, m.
    positions_m: Vec<Vec3>,
    /// By [`relative_size`].
    relative_size: f64,
}

/// Headings at each position: degrees beside the direction of the field's middle, in which a sports
/// camera looks.
const TURN_FROM_DEG: f64 = -40.0;
pub const TURN_STEP_DEG: f64 = 2.0;
const NUM_HEADINGS: usize = 41;

/// Spacing of the usual places on a soccer pitch, m. Heights are a geometric series: errors of the
/// height matter relative to the height.
pub const X_STEP_M: f64 = 4.0;
pub const Y_STEP_M: f64 = 5.0;
pub const HEIGHT_RATIO: f64 = 1.14;

impl SearchPlaces {
    /// The stand along one side of a field, on a soccer pitch |x| ≤ 64 m, 40 to 110 m from the
    /// long axis, 5 to 31 m high.
    pub fn usual(field: &FieldModel) -> Self {
        let mut positions_m = Vec::new();
        for height in 0..15 {
            let z = 5.0 * HEIGHT_RATIO.powi(height);
            for row in 0..15 {
                let y = -110.0 + Y_STEP_M * f64::from(row);
                positions_m.extend(
                    (0..33).map(|column| Vec3::new(-64.0 + X_STEP_M * f64::from(column), y, z)),
                );
            }
        }
        Self::around(field, positions_m)
    }

    /// Rings around a field, on a soccer pitch 3 to 110 m outside its border, from 2.5 to 60 m high
    /// and under at most 60° to the border; without the usual places. Around a court they reach
    /// farther in proportion: a tennis camera stood 42 m outside a court 24 m long.
    pub fn others(field: &FieldModel) -> Self {
        /// Half the length and half the width of a usual field, m. The rings are searched for
        /// every size alike.
        const HALF_FIELD_M: [f64; 2] = [52.5, 34.0];
        let mut positions_m = Vec::new();
        let farthest_m = if is_court(field) { 200.0 } else { 110.0 };
        let mut outside_m = 3.0;
        while outside_m < farthest_m {
            let along_step_m = f64::clamp(0.3 * outside_m, 4.0, 8.0);
            for [x, y] in ring(HALF_FIELD_M.map(|half_m| half_m + outside_m), along_step_m) {
                let mut z = 2.5;
                while z < f64::min(60.0, 3.0 + 1.7 * outside_m) {
                    let is_usual = x.abs() <= 66.0
                        && (-112.5..=-37.5).contains(&y)
                        && (4.7..33.0).contains(&z);
                    if !is_usual {
                        positions_m.push(Vec3::new(x, y, z));
                    }
                    z *= 1.2;
                }
            }
            outside_m += f64::clamp(0.3 * outside_m, 3.0, 10.0);
        }
        Self::around(field, positions_m)
    }

    /// Places that are stated for a soccer pitch, around a field of another size.
    fn around(field: &FieldModel, mut positions_m: Vec<Vec3>) -> Self {
        let relative_size = relative_size(field);
        for at in &mut positions_m {
            *at *= relative_size;
        }
        Self {
            positions_m,
            relative_size,
        }
    }

    /// The size of the field relative to a soccer pitch.
    pub const fn relative_size(&self) -> f64 {
        self.relative_size
    }

    /// Number of positions and headings.
    pub fn len(&self) -> usize {
        self.positions_m.len() * NUM_HEADINGS
    }

    /// Position and heading of a number below [`Self::len`]; headings vary fastest.
    pub fn at(&self, index: usize) -> (Vec3, Angle) {
        let position_m = self.positions_m[index / NUM_HEADINGS];
        let to_middle_deg = (-position_m.x).atan2(-position_m.y).to_degrees();
        let turn_deg = TURN_FROM_DEG + TURN_STEP_DEG * (index % NUM_HEADINGS) as f64;
        (position_m, Angle::from_degrees(to_middle_deg + turn_deg))
    }
}

/// Points of the half y ≤ 0 of a rectangle around the origin, about `step_m` apart.
fn ring([half_length, half_width]: [f64; 2], step_m: f64) -> Vec<[f64; 2]> {
    let across = num_steps(half_width, step_m);
    let along = num_steps(2.0 * half_length, step_m);
    let share = |step: usize, of: usize| step as f64 / of as f64;
    let down = (0..across).map(|step| [-half_length, -half_width * share(step, across)]);
    let right =
        (0..along).map(|step| [half_length * (2.0 * share(step, along) - 1.0), -half_width]);
    let up = (0..across).map(|step| [half_length, -half_width * (1.0 - share(step, across))]);
    down.chain(right).chain(up).collect()
}

/// The number of steps of at most `step_m` into which a length is divided.
fn num_steps(length_m: f64, step_m: f64) -> usize {
    (length_m / step_m).ceil().max(1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::soccer;
    use touchline_core::field::{Template, builtin, builtin_names};

    #[test]
    fn only_lines_of_every_few_yards_repeat() {
        for name in builtin_names() {
            let field = builtin(name).and_then(Template::default_model);
            let repeats = has_repeating_lines(&field.unwrap());
            assert_eq!(repeats, name.starts_with("american_football"), "{name}");
        }
    }

    /// A court has a quarter of the size and is filmed from a quarter as far away.
    #[test]
    fn places_keep_their_proportion_to_the_field() {
        let tennis = builtin("tennis").unwrap().default_model().unwrap();
        let quarter = 23.77_f64.hypot(10.97) / 105_f64.hypot(68.0);
        for of_field in [SearchPlaces::usual, SearchPlaces::others] {
            let ((far, heading), (near, same)) = (
                of_field(&soccer().assumed).at(1000),
                of_field(&tennis).at(1000),
            );
            assert!((far * quarter - near).norm() < 1e-3, "{far:?} {near:?}");
            assert!((heading - same).degrees().abs() < 1e-6);
        }
        let farthest =
            |of: &SearchPlaces| of.positions_m.iter().map(Vec3::norm).fold(0.0, f64::max);
        assert!(farthest(&SearchPlaces::others(&tennis)) > 42.0 + 12.0);
    }

    #[test]
    fn the_usual_places_look_at_the_field_from_one_side() {
        let places = SearchPlaces::usual(&soccer().assumed);
        assert_eq!(places.len(), 304_425);
        let (first, heading) = places.at(0);
        assert_eq!(first, Vec3::new(-64.0, -110.0, 5.0));
        // The middle lies 30.2° to the right of straight ahead.
        assert!((heading.degrees() - (30.19 - 40.0)).abs() < 0.01);
        let (last, _) = places.at(places.len() - 1);
        assert!((last - Vec3::new(64.0, -40.0, 31.3)).norm() < 0.1);
    }

    /// A camera behind a goal, in a corner, on a mast and high in the roof: some place is near
    /// enough to converge from, relative to how far away the field is.
    #[test]
    fn every_other_place_around_the_field_is_near_one_that_is_tried() {
        let places = SearchPlaces::others(&soccer().assumed);
        for camera in [
            Vec3::new(-70.0, -3.0, 12.0),
            Vec3::new(140.0, 0.0, 40.0),
            Vec3::new(80.0, -60.0, 22.0),
            Vec3::new(-52.0, -41.0, 4.0),
            Vec3::new(3.0, -38.5, 2.7),
            Vec3::new(0.0, -70.0, 55.0),
        ] {
            let off = |at: &Vec3| {
                let outside_m = (camera.x.abs() - 52.5).max(camera.y.abs() - 34.0);
                (camera - at).xy().norm() / (5.0 + 0.3 * outside_m)
                    + (camera.z / at.z).ln().abs() / 0.2
            };
            let nearest = places
                .positions_m
                .iter()
                .map(off)
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 1.2, "{camera:?}: {nearest:.2}");
        }
        assert!(places.positions_m.iter().all(|at| at.y <= 0.0));
    }
}
