//! The crown of the ground: pitches are built higher along the middle than at the touchlines, so
//! that water runs off.

use super::FieldModel;
use crate::geometry::Vec3;

/// A crowned ground: z = −height (2 y / width)² within the field, the touchline's height beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crown {
    /// The height of the middle above the touchlines, m.
    pub height_m: f64,
    /// The field's extent along y, m.
    pub width_m: f64,
}

impl Crown {
    /// Flat ground.
    pub const FLAT: Self = Self {
        height_m: 0.0,
        width_m: 1.0,
    };

    /// The drop of the ground below the middle at a given y, as a fraction of the crown's height:
    /// (2 y / width)², at most 1.
    pub fn drop_share(&self, y_m: f64) -> f64 {
        (2.0 * y_m / self.width_m).clamp(-1.0, 1.0).powi(2)
    }

    /// The derivative of [`Self::drop_share`] by y and by the width, 1/m.
    pub fn drop_share_by_y_and_width(&self, y_m: f64) -> [f64; 2] {
        let across = 2.0 * y_m / self.width_m;
        // Beyond the touchline the height is constant; the kink there has the outer derivative.
        if across.abs() < 1.0 {
            [
                4.0 * across / self.width_m,
                -2.0 * across * across / self.width_m,
            ]
        } else {
            [0.0, 0.0]
        }
    }

    /// The ground's height at a place, m.
    pub fn ground_z(&self, y_m: f64) -> f64 {
        // Flat ground is at exactly 0, not at −0.
        if self.height_m == 0.0 {
            0.0
        } else {
            -self.height_m * self.drop_share(y_m)
        }
    }

    /// The true position of a nominal point: lifted onto this ground.
    pub fn world_from_nominal(&self, nominal_m: Vec3) -> Vec3 {
        Vec3::new(
            nominal_m.x,
            nominal_m.y,
            nominal_m.z + self.ground_z(nominal_m.y),
        )
    }
}

/// The minimum width of a crowned field, m: only large grass pitches have a crown.
const MIN_CROWNED_WIDTH_M: f64 = 40.0;

impl FieldModel {
    /// Whether fields of this width may have a crown.
    pub fn may_be_crowned(&self) -> bool {
        self.width_m >= MIN_CROWNED_WIDTH_M
    }

    /// The same field with another crown.
    #[must_use]
    pub fn with_crown_m(&self, crown_m: f64) -> Self {
        Self {
            crown_m,
            ..self.clone()
        }
    }

    /// The shape of its ground.
    pub const fn crown(&self) -> Crown {
        Crown {
            height_m: self.crown_m,
            width_m: self.width_m,
        }
    }

    /// The ground's height at a place, m: see [`Crown`].
    pub fn ground_z(&self, y_m: f64) -> f64 {
        self.crown().ground_z(y_m)
    }

    /// The true position of a nominal point: lifted onto the crowned ground.
    pub fn world_from_nominal(&self, nominal_m: Vec3) -> Vec3 {
        self.crown().world_from_nominal(nominal_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivatives_of_the_drop_agree_with_differences() {
        let (crown, h) = (
            Crown {
                height_m: 0.2,
                width_m: 68.0,
            },
            1e-6,
        );
        for y_m in [-33.0, -10.0, 0.0, 21.0, 40.0] {
            let [by_y, by_width] = crown.drop_share_by_y_and_width(y_m);
            let along_y = (crown.drop_share(y_m + h) - crown.drop_share(y_m - h)) / (2.0 * h);
            let with_width = |width_m: f64| Crown { width_m, ..crown }.drop_share(y_m);
            let along_width = (with_width(68.0 + h) - with_width(68.0 - h)) / (2.0 * h);
            assert!(
                (by_y - along_y).abs() < 1e-8 && (by_width - along_width).abs() < 1e-8,
                "{y_m}"
            );
        }
        assert_eq!(crown.ground_z(34.0), -0.2);
        assert_eq!(Crown::FLAT.ground_z(20.0), 0.0);
    }
}
