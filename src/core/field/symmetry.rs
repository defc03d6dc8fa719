//! The field's symmetries: they map each landmark and line to the one for which it is mistaken when
//! a picture is named from the wrong side.

use super::model::same_place;
use super::{Curve, FieldLine, FieldModel, Landmark};
use crate::geometry::Vec3;
use serde::{Serialize, Serializer};

/// A symmetry of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// x → −x: left and right are exchanged.
    MirrorX,
    /// y → −y: near and far are exchanged.
    MirrorY,
    /// Both: rotation by 180° about the middle, the view of a camera on the other side.
    Turn180,
}

impl Serialize for Symmetry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Symmetry {
    /// All three.
    pub const ALL: [Self; 3] = [Self::MirrorX, Self::MirrorY, Self::Turn180];

    /// Its name in templates.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MirrorX => "mirror_x",
            Self::MirrorY => "mirror_y",
            Self::Turn180 => "turn_180",
        }
    }

    /// The symmetry of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|symmetry| symmetry.name() == name)
    }

    /// The image of a point, `world`, m.
    pub fn apply(self, point: Vec3) -> Vec3 {
        match self {
            Self::MirrorX => Vec3::new(-point.x, point.y, point.z),
            Self::MirrorY => Vec3::new(point.x, -point.y, point.z),
            Self::Turn180 => Vec3::new(-point.x, -point.y, point.z),
        }
    }

    /// The landmark at the image of this one: itself, another, or none where the field is not
    /// symmetric.
    pub fn landmark_twin<'a>(
        self,
        model: &'a FieldModel,
        landmark: &Landmark,
    ) -> Option<&'a Landmark> {
        let there = self.apply(landmark.nominal_m);
        model
            .landmarks
            .iter()
            .find(|other| same_place(other.nominal_m, there))
    }

    /// The line at the image of this one; none where the field is not symmetric.
    pub fn line_twin<'a>(self, model: &'a FieldModel, line: &FieldLine) -> Option<&'a FieldLine> {
        model
            .lines
            .iter()
            .find(|other| self.maps(&line.curve, &other.curve))
    }

    /// Whether the image of one curve is another, in either direction.
    fn maps(self, curve: &Curve, other: &Curve) -> bool {
        match (*curve, *other) {
            (
                Curve::Segment { from, to },
                Curve::Segment {
                    from: first,
                    to: last,
                },
            ) => {
                let (from, to) = (self.apply(from), self.apply(to));
                (same_place(from, first) && same_place(to, last))
                    || (same_place(from, last) && same_place(to, first))
            }
            (
                Curve::Arc {
                    centre, radius_m, ..
                },
                Curve::Arc {
                    centre: there,
                    radius_m: other_radius,
                    ..
                },
            ) => {
                if !same_place(self.apply(centre), there) || (radius_m - other_radius).abs() > 1e-6
                {
                    return false;
                }
                // Circles start anywhere, so their ends are not compared.
                if curve.is_closed() || other.is_closed() {
                    return curve.is_closed() && other.is_closed();
                }
                // Two arcs of one circle with the same ends may be complements; their middles
                // decide.
                let [from, middle, to] = [0.0, 0.5, 1.0].map(|t| self.apply(curve.point_at(t)));
                let [first, halfway, last] = [0.0, 0.5, 1.0].map(|t| other.point_at(t));
                same_place(middle, halfway)
                    && ((same_place(from, first) && same_place(to, last))
                        || (same_place(from, last) && same_place(to, first)))
            }
            _ => false,
        }
    }
}
