//! A line of the field as a curve in space.

use crate::field::{Crown, Curve, FieldModel};
use crate::geometry::Vec3;

/// A curve of the field on the crowned ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldCurve {
    /// The nominal curve, `world`, m.
    nominal: Curve,
    crown: Crown,
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
    pub const fn on_field(field: &FieldModel, nominal: Curve) -> Self {
        Self {
            nominal,
            crown: field.crown(),
        }
    }

    /// A curve on flat ground.
    pub const fn flat(nominal: Curve) -> Self {
        Self {
            nominal,
            crown: Crown::FLAT,
        }
    }

    /// The nominal curve.
    pub const fn nominal(&self) -> &Curve {
        &self.nominal
    }

    /// The same curve on ground with another crown.
    #[must_use]
    pub(super) const fn with_crown(self, crown: Crown) -> Self {
        Self { crown, ..self }
    }

    /// This curve moved by a fraction of the difference between two nominal curves of its kind.
    #[must_use]
    pub(in crate::solve) fn move_along(self, from: &Curve, to: &Curve, share: f64) -> Self {
        // Coordinates, radius and angles change linearly with the share, which is exact where the
        // template is linear in its sizes.
        let nominal = match (self.nominal, from, to) {
            (
                Curve::Segment {
                    from: start,
                    to: end,
                },
                Curve::Segment {
                    from: start_0,
                    to: end_0,
                },
                Curve::Segment {
                    from: start_1,
                    to: end_1,
                },
            ) => Curve::Segment {
                from: start + (start_1 - start_0) * share,
                to: end + (end_1 - end_0) * share,
            },
            (
                Curve::Arc {
                    centre,
                    radius_m,
                    start,
                    sweep,
                },
                Curve::Arc {
                    centre: centre_0,
                    radius_m: radius_0,
                    start: start_0,
                    sweep: sweep_0,
                },
                Curve::Arc {
                    centre: centre_1,
                    radius_m: radius_1,
                    start: start_1,
                    sweep: sweep_1,
                },
            ) => Curve::Arc {
                centre: centre + (centre_1 - centre_0) * share,
                radius_m: radius_m + (radius_1 - radius_0) * share,
                start: start + (*start_1 - *start_0) * share,
                sweep: sweep + (*sweep_1 - *sweep_0) * share,
            },
            // Never: a template gives curves of one kind whatever its parameters are.
            (nominal, ..) => nominal,
        };
        Self { nominal, ..self }
    }

    /// The point at a parameter, m.
    pub(in crate::solve) fn point_at(&self, t: f64) -> Vec3 {
        self.crown.world_from_nominal(self.nominal.point_at(t))
    }

    /// The point at a parameter and its derivatives; the crown is z = −c (2y / width)² within the
    /// field.
    pub(crate) fn at(&self, t: f64) -> CurvePoint {
        let mut at = self.nominal.point_at(t);
        let mut first = self.nominal.tangent_at(t);
        // On a circle the second derivative points to the centre: r'' = −(r − c) (dθ/dt)².
        let mut second = match self.nominal {
            Curve::Segment { .. } => Vec3::zeros(),
            Curve::Arc { centre, sweep, .. } => (centre - at) * sweep.radians().powi(2),
        };
        // Chain rule with dz/dy = −8 c y / width²; outside the field the ground is level.
        if self.crown.height_m != 0.0 {
            let Crown { height_m, width_m } = self.crown;
            at.z += self.crown.ground_z(at.y);
            if (2.0 * at.y / width_m).abs() < 1.0 {
                let slope = -8.0 * height_m / (width_m * width_m);
                second.z += slope * (first.y * first.y + at.y * second.y);
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
        let segment = Curve::Segment {
            from: Vec3::new(-3.0, -30.0, 0.0),
            to: Vec3::new(10.0, 25.0, 0.0),
        };
        let circle = Curve::Arc {
            centre: Vec3::new(2.0, -5.0, 0.0),
            radius_m: 9.15,
            start: Angle::from_degrees(20.0),
            sweep: Angle::from_degrees(-300.0),
        };
        for nominal in [segment, circle] {
            let curve = WorldCurve {
                nominal,
                crown: Crown {
                    height_m: 0.3,
                    width_m: 68.0,
                },
            };
            for t in [0.0, 0.3, 0.77, 1.1] {
                let (h, here) = (1e-5, curve.at(t));
                let (before, after) = (curve.at(t - h), curve.at(t + h));
                assert!((here.first - (after.at - before.at) / (2.0 * h)).norm() < 1e-6);
                assert!((here.second - (after.first - before.first) / (2.0 * h)).norm() < 1e-5);
                let ground = -0.3 * (here.at.y / 34.0).powi(2);
                assert!((here.at.z - ground).abs() < 1e-12);
                assert_eq!(curve.point_at(t), here.at);
            }
        }
    }
}
