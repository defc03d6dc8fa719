//! Directions of lines in a picture, quantised.

use touchline_core::geometry::Vec2;

/// Number of bins over half a turn: a line and its reverse have one direction.
pub(super) const DIRECTIONS: usize = 8;

/// The bin of a normal, counted from x towards y. Bin 0 is centred on the x axis.
pub(super) fn direction_of(normal: Vec2) -> usize {
    let steps =
        (normal.y.atan2(normal.x) / std::f64::consts::PI * DIRECTIONS as f64).round() as i32;
    steps.rem_euclid(DIRECTIONS as i32) as usize
}

/// A direction and its two neighbours.
pub(super) fn with_neighbours(direction: usize) -> [usize; 3] {
    [DIRECTIONS - 1, 0, 1].map(|turn| (direction + turn) % DIRECTIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_and_its_opposite_are_one_direction() {
        for step in 0..32 {
            let (y, x) = (f64::from(step) * 0.2 + 0.05).sin_cos();
            let direction = direction_of(Vec2::new(x, y));
            assert_eq!(direction, direction_of(Vec2::new(-x, -y)));
            assert!(with_neighbours(direction).contains(&direction));
        }
        assert_eq!(
            (
                direction_of(Vec2::new(1.0, 0.01)),
                direction_of(Vec2::new(0.0, 1.0))
            ),
            (0, 4)
        );
        assert_eq!(with_neighbours(0), [7, 0, 1]);
    }
}
