//! One type for angles, so that degrees and radians cannot be mixed.

use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// An angle: radians inside, degrees in files and in the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Angle {
    radians: f64,
}

/// Serialised in degrees; the key has to end in `_deg`.
impl Serialize for Angle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.degrees().serialize(serializer)
    }
}

impl Angle {
    /// An angle of zero.
    pub const ZERO: Self = Self { radians: 0.0 };

    /// The full circle, 360°.
    pub const TURN: Self = Self {
        radians: std::f64::consts::TAU,
    };

    /// An angle from radians.
    pub const fn from_radians(radians: f64) -> Self {
        Self { radians }
    }

    /// An angle from degrees.
    pub const fn from_degrees(degrees: f64) -> Self {
        Self {
            radians: degrees.to_radians(),
        }
    }

    /// The angle in radians.
    pub const fn radians(self) -> f64 {
        self.radians
    }

    /// The angle in degrees.
    pub const fn degrees(self) -> f64 {
        self.radians.to_degrees()
    }

    /// The same direction within (−π, π].
    #[must_use]
    pub fn wrap(self) -> Self {
        use std::f64::consts::{PI, TAU};
        // An angle within the range stays bit-identical.
        if self.radians > -PI && self.radians <= PI {
            return self;
        }
        // In [0, 2π): the upper half belongs to the negative angles, and −π becomes π.
        let turned = self.radians.rem_euclid(TAU);
        Self {
            radians: if turned > PI { turned - TAU } else { turned },
        }
    }

    /// The shortest signed rotation from another direction to this one, within (−π, π].
    #[must_use]
    pub fn turn_from(self, from: Self) -> Self {
        (self - from).wrap()
    }

    /// (sine, cosine).
    pub fn sin_cos(self) -> (f64, f64) {
        self.radians.sin_cos()
    }

    /// The angle without its sign.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self {
            radians: self.radians.abs(),
        }
    }

    /// Neither NaN nor infinite.
    pub const fn is_finite(self) -> bool {
        self.radians.is_finite()
    }
}

impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        write!(f, "{:.digits$}°", self.degrees())
    }
}

impl Add for Angle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            radians: self.radians + other.radians,
        }
    }
}

impl Sub for Angle {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            radians: self.radians - other.radians,
        }
    }
}

impl Neg for Angle {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            radians: -self.radians,
        }
    }
}

impl Mul<f64> for Angle {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            radians: self.radians * factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Angle;
    use std::f64::consts::PI;

    #[test]
    fn wrapping_keeps_the_direction_within_half_a_turn() {
        for (degrees, wrapped) in [
            (0.0, 0.0),
            (180.0, 180.0),
            (-180.0, 180.0),
            (190.0, -170.0),
            (725.0, 5.0),
        ] {
            assert!(
                (Angle::from_degrees(degrees).wrap().degrees() - wrapped).abs() < 1e-12,
                "{degrees}"
            );
        }
        assert!(Angle::from_radians(-PI).wrap().radians() > 0.0);
    }

    #[test]
    fn the_turn_between_directions_is_the_shorter_one() {
        for (to, from, turn) in [
            (10.0, 4.0, 6.0),
            (-179.0, 179.0, 2.0),
            (178.0, -177.0, -5.0),
            (90.0, -90.0, 180.0),
        ] {
            let found = Angle::from_degrees(to).turn_from(Angle::from_degrees(from));
            assert!((found.degrees() - turn).abs() < 1e-12, "{to} from {from}");
        }
    }
}
