//! What a click says: this pixel shows that landmark, or a point of that line.

use super::ObservationError;
use crate::field::{Curve, FieldModel};
use crate::geometry::{ImagePoint, ImageSize, Vec3};

/// One click, ready for solving: the pixel, what it shows in `world`, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The clicked pixel, px of the frame.
    pub image: ImagePoint,
    /// 1-σ of the click in each direction, px of the frame.
    pub sigma_px: f64,
    /// What it shows.
    pub target: Target,
    /// Which of the frame's clicks this is, from 0.
    pub click: usize,
    /// Held out of the solve; its error is reported.
    pub check: bool,
}

/// What a click shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// A point of `world`, m, the crown included: two equations.
    Landmark(Vec3),
    /// Some point of a curve: one equation. Straight lines count beyond their ends, arcs as their whole circle.
    Line(WorldCurve),
}

impl Target {
    /// How many equations a click on it gives.
    #[must_use]
    pub const fn equations(&self) -> usize {
        match self {
            Self::Landmark(_) => 2,
            Self::Line(_) => 1,
        }
    }
}

impl Observation {
    /// A click on a landmark of the field, with the landmark's own click noise scaled to the frame.
    ///
    /// # Errors
    /// The field has no landmark of this name.
    pub fn of_landmark(
        field: &FieldModel,
        name: &str,
        image: ImagePoint,
        image_size: ImageSize,
        click: usize,
    ) -> Result<Self, ObservationError> {
        let landmark = field.landmark(name).ok_or_else(|| ObservationError::UnknownLandmark {
            name: name.to_owned(),
            template: field.template.clone(),
        })?;
        Ok(Self {
            image,
            sigma_px: landmark.click_sigma_px * image_size.scale_from_1920(),
            target: Target::Landmark(field.landmark_in_world(landmark)),
            click,
            check: false,
        })
    }

    /// A click on a line of the field.
    ///
    /// # Errors
    /// The field has no line of this name.
    pub fn of_line(
        field: &FieldModel,
        name: &str,
        image: ImagePoint,
        image_size: ImageSize,
        click: usize,
    ) -> Result<Self, ObservationError> {
        let line = field
            .line(name)
            .ok_or_else(|| ObservationError::UnknownLine { name: name.to_owned(), template: field.template.clone() })?;
        Ok(Self {
            image,
            sigma_px: field.line_click_sigma_px * image_size.scale_from_1920(),
            target: Target::Line(WorldCurve::on_field(field, line.curve)),
            click,
            check: false,
        })
    }

    /// The same click, held out of the solve.
    #[must_use]
    pub const fn held_out(self) -> Self {
        Self { check: true, ..self }
    }
}

/// A curve of the field where it really is: lifted onto the crowned ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldCurve {
    /// The nominal curve, `world`, m.
    nominal: Curve,
    /// How much the middle is higher than the touchlines, m.
    crown_m: f64,
    /// The field's extent along y, m.
    width_m: f64,
}

/// A point of a curve and its derivatives by the curve's parameter, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurvePoint {
    pub at: Vec3,
    pub first: Vec3,
    pub second: Vec3,
}

impl WorldCurve {
    /// A nominal curve of a field.
    #[must_use]
    pub const fn on_field(field: &FieldModel, nominal: Curve) -> Self {
        Self { nominal, crown_m: field.crown_m, width_m: field.width_m }
    }

    /// A curve on flat ground.
    #[must_use]
    pub const fn flat(nominal: Curve) -> Self {
        Self { nominal, crown_m: 0.0, width_m: 1.0 }
    }

    /// The nominal curve.
    #[must_use]
    pub const fn nominal(&self) -> &Curve {
        &self.nominal
    }

    /// The same curve on ground with another crown.
    #[must_use]
    pub(super) const fn with_crown(self, crown_m: f64, width_m: f64) -> Self {
        Self { crown_m, width_m, ..self }
    }

    /// The point at a parameter and its derivatives; the crown is z = −c (2y / width)² within the field.
    pub(crate) fn at(&self, t: f64) -> CurvePoint {
        let mut at = self.nominal.point_at(t);
        let mut first = self.nominal.tangent_at(t);
        let mut second = match self.nominal {
            Curve::Segment { .. } => Vec3::zeros(),
            Curve::Arc { centre, sweep, .. } => (centre - at) * sweep.radians().powi(2),
        };
        if self.crown_m != 0.0 {
            let across = (2.0 * at.y / self.width_m).clamp(-1.0, 1.0);
            at.z -= self.crown_m * across * across;
            if across.abs() < 1.0 {
                let slope = -8.0 * self.crown_m / (self.width_m * self.width_m);
                second.z += slope * (first.y * first.y + (at.y) * second.y);
                first.z += slope * at.y * first.y;
            }
        }
        CurvePoint { at, first, second }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Angle;

    #[test]
    fn derivatives_of_curves_on_a_crowned_field_agree_with_differences() {
        let segment = Curve::Segment { from: Vec3::new(-3.0, -30.0, 0.0), to: Vec3::new(10.0, 25.0, 0.0) };
        let circle = Curve::Arc {
            centre: Vec3::new(2.0, -5.0, 0.0),
            radius_m: 9.15,
            start: Angle::from_degrees(20.0),
            sweep: Angle::from_degrees(-300.0),
        };
        for nominal in [segment, circle] {
            let curve = WorldCurve { nominal, crown_m: 0.3, width_m: 68.0 };
            for t in [0.0, 0.3, 0.77, 1.1] {
                let (h, here) = (1e-5, curve.at(t));
                let (before, after) = (curve.at(t - h), curve.at(t + h));
                assert!((here.first - (after.at - before.at) / (2.0 * h)).norm() < 1e-6);
                assert!((here.second - (after.first - before.first) / (2.0 * h)).norm() < 1e-5);
                let ground = -0.3 * (here.at.y / 34.0).powi(2);
                assert!((here.at.z - ground).abs() < 1e-12);
            }
        }
    }
}
