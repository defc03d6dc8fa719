//! Builds a field model from a template and its parameters.

use super::model::same_place;
use super::parts::{CurvePart, PointPart, Scoped};
use super::template::MAX_CROWN_M;
use super::{
    CLICKING_SHARE, Curve, Expression, FieldError, FieldLine, FieldModel, Landmark, Template,
};
use crate::geometry::{Angle, Vec3};
use std::collections::BTreeMap;

/// The maximum number of dashes of a line: each is drawn by itself.
const MAX_DASHES: f64 = 2_000.0;

/// 1-σ of a click on a line, px at 1920 px width.
const LINE_CLICK_SIGMA_PX: f64 = 2.0;

/// Maximum absolute coordinate, m; a larger one is a mistake in the template.
const MAX_COORDINATE_M: f64 = 1000.0;
/// Minimum length of a line, m.
const MIN_LENGTH_M: f64 = 1e-3;

impl Template {
    /// The field of a venue: parameters that are not given take their defaults.
    ///
    /// `crown_m` is the height of the middle above the touchlines, m.
    ///
    /// # Errors
    /// A parameter that the template does not have or whose value the rules do not allow, or an
    /// impossible crown.
    pub fn model(
        &self,
        params: &BTreeMap<String, f64>,
        crown_m: f64,
    ) -> Result<FieldModel, FieldError> {
        // An unknown name is an error: if it were ignored, a misspelt parameter would silently
        // take its default.
        if let Some(name) = params
            .keys()
            .find(|name| !self.params.iter().any(|param| param.name == **name))
        {
            return Err(FieldError::UnknownParam {
                template: self.name.clone(),
                name: name.clone(),
                known: self
                    .params
                    .iter()
                    .map(|param| param.name.as_str())
                    .collect::<Vec<_>>()
                    .join(", "),
            });
        }
        if !(crown_m.abs() <= MAX_CROWN_M) {
            return Err(FieldError::CrownOutOfRange {
                crown_m,
                limit: MAX_CROWN_M,
            });
        }
        // The comparisons here and above are negated, so that NaN is out of range, too.
        let mut filled = self.default_params();
        for param in &self.params {
            let Some(&value) = params.get(&param.name) else {
                continue;
            };
            if !(value >= param.min && value <= param.max) {
                return Err(FieldError::ParamOutOfRange {
                    template: self.name.clone(),
                    name: param.name.clone(),
                    value,
                    min: param.min,
                    max: param.max,
                    source_text: param.source.clone(),
                });
            }
            filled.insert(param.name.clone(), value);
        }
        build_model(self, filled, crown_m)
    }

    /// The field with every parameter at its default and no crown.
    ///
    /// # Errors
    /// None for a template that was read: reading it builds its default model.
    pub fn default_model(&self) -> Result<FieldModel, FieldError> {
        self.model(&BTreeMap::new(), 0.0)
    }
}

/// The model of a template; the parameters are complete and within range.
fn build_model(
    template: &Template,
    params: BTreeMap<String, f64>,
    crown_m: f64,
) -> Result<FieldModel, FieldError> {
    let mut builder = Builder {
        template,
        scope: params.clone(),
    };
    // Dimensions are evaluated in order; each may use the ones before it. Extent, landmarks and
    // lines may use all of them.
    for dimension in &template.dimensions {
        let value = builder.value(
            &format!("dimension {:?}", dimension.name),
            &dimension.value,
            &[],
        )?;
        builder.scope.insert(dimension.name.clone(), value);
    }
    let [length_m, width_m] = [0, 1].map(|index| builder.extent(index));
    let landmarks = template
        .landmarks
        .iter()
        .map(|part| {
            let name = format!("landmark {:?}", part.id);
            let nominal_m = builder.point(&format!("{name}, at"), &part.at)?;
            // A spot is paint, and paint lies on the ground.
            let spot = part.spot_diameter_m.as_ref();
            let spot = spot
                .map(|diameter| builder.positive(&format!("{name}, spot_diameter_m"), diameter))
                .transpose()?;
            if spot.is_some() && nominal_m.z != 0.0 {
                return Err(builder.invalid(
                    &name,
                    "it has a spot_diameter_m, but does not lie on the ground".to_owned(),
                ));
            }
            Ok(Landmark {
                id: part.id.as_str().into(),
                label: part.label.clone(),
                code: part.code.clone(),
                nominal_m,
                click_sigma_px: part.click_sigma_px,
                // Independent parts of one variance: σ² = σ²_clicking + σ²_place.
                place_sigma_px: (1.0 - CLICKING_SHARE).sqrt() * part.click_sigma_px,
                spot_diameter_m: spot,
                is_unmarked: part.is_unmarked,
            })
        })
        .collect::<Result<_, FieldError>>()?;
    let lines = template
        .lines
        .iter()
        .map(|part| {
            let name = format!("line {:?}", part.id);
            let curve = builder.curve(&name, &part.curve, part.painted)?;
            let width_m = builder.positive(&format!("{name}, width_m"), &part.width_m)?;
            let inside = part
                .inside
                .as_ref()
                .map(|inside| builder.point(&format!("{name}, inside"), inside))
                .transpose()?;
            // The rules measure to an edge of the paint, but a picture shows its middle: for a line
            // of 12 cm at 60 m and f = 3000 px they are 3 px apart.
            let paint_centre = shift_inward(&curve, inside, part.edge.inward_shift() * width_m)
                .map_err(|problem| builder.invalid(&name, problem))?;
            let dash_m = match &part.dash_m {
                Some(dash) => Some(builder.dash(&format!("{name}, dash_m"), dash, &curve)?),
                None => None,
            };
            Ok(FieldLine {
                id: part.id.as_str().into(),
                label: part.label.clone(),
                code: part.code.clone(),
                curve,
                width_m,
                edge: part.edge,
                paint_centre,
                painted: part.painted,
                dash_m,
            })
        })
        .collect::<Result<_, FieldError>>()?;
    Ok(FieldModel {
        template: template.name.clone(),
        params,
        length_m: length_m?,
        width_m: width_m?,
        crown_m,
        landmarks,
        lines,
        line_click_sigma_px: LINE_CLICK_SIGMA_PX,
    })
}

/// Checks that no two landmarks coincide.
pub fn check_distinct(template: &Template, model: &FieldModel) -> Result<(), FieldError> {
    for (index, landmark) in model.landmarks.iter().enumerate() {
        let twin = model.landmarks[..index]
            .iter()
            .find(|other| same_place(other.nominal_m, landmark.nominal_m));
        if let Some(twin) = twin {
            let problem = format!("it lies where {:?} lies", twin.id.as_str());
            return Err(invalid(
                template,
                &format!("landmark {:?}", landmark.id.as_str()),
                problem,
            ));
        }
    }
    Ok(())
}

/// Checks the template's symmetries for every landmark and line.
pub fn check_symmetry(template: &Template, model: &FieldModel) -> Result<(), FieldError> {
    for symmetry in &template.symmetry {
        let without_twin = model
            .landmarks
            .iter()
            .find(|landmark| symmetry.landmark_twin(model, landmark).is_none())
            .map(|landmark| ("landmark", landmark.id.as_str()))
            .or_else(|| {
                model
                    .lines
                    .iter()
                    .find(|line| symmetry.line_twin(model, line).is_none())
                    .map(|line| ("line", line.id.as_str()))
            });
        if let Some((kind, id)) = without_twin {
            let problem = format!(
                "the field is not symmetric by {}: no {kind} lies where this one comes to lie",
                symmetry.name()
            );
            return Err(invalid(template, &format!("{kind} {id:?}"), problem));
        }
    }
    Ok(())
}

fn invalid(template: &Template, part: &str, problem: String) -> FieldError {
    FieldError::Invalid {
        place: template.place.clone(),
        part: part.to_owned(),
        problem,
    }
}

struct Builder<'a> {
    template: &'a Template,
    scope: BTreeMap<String, f64>,
}

impl Builder<'_> {
    fn invalid(&self, part: &str, problem: String) -> FieldError {
        invalid(self.template, part, problem)
    }

    fn value(
        &self,
        part: &str,
        expression: &Expression,
        names: &[(&str, f64)],
    ) -> Result<f64, FieldError> {
        expression
            .evaluate(&self.scope, names)
            .map_err(|problem| FieldError::Expression {
                place: self.template.place.clone(),
                part: part.to_owned(),
                text: expression.text().to_owned(),
                problem: Box::new(problem),
            })
    }

    fn extent(&self, index: usize) -> Result<f64, FieldError> {
        let part = format!("extent_m[{index}]");
        let value = self.value(&part, &self.template.extent_m[index], &[])?;
        if value > 0.0 && value <= MAX_COORDINATE_M {
            return Ok(value);
        }
        Err(self.invalid(
            &part,
            format!("{value} m is outside 0 to {MAX_COORDINATE_M} m"),
        ))
    }

    fn positive(&self, part: &str, scoped: &Scoped) -> Result<f64, FieldError> {
        let value = self.value(part, &scoped.expression, &scoped.names)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(self.invalid(part, format!("{value} m is not greater than 0")))
        }
    }

    /// The length of the dashes of a line and of the gaps between them, m.
    fn dash(&self, part: &str, dash: &[Scoped; 2], of: &Curve) -> Result<[f64; 2], FieldError> {
        let [dash_m, gap_m] = [
            self.positive(part, &dash[0])?,
            self.positive(part, &dash[1])?,
        ];
        // A slip of the decimal point would make millions of them.
        if of.length_m() / (dash_m + gap_m) > MAX_DASHES {
            let problem = format!("{dash_m} and {gap_m} m make more than {MAX_DASHES} dashes");
            return Err(self.invalid(part, problem));
        }
        Ok([dash_m, gap_m])
    }

    fn point(&self, part: &str, point: &PointPart) -> Result<Vec3, FieldError> {
        let mut place = Vec3::zeros();
        for (index, expression) in point.coordinates.iter().enumerate() {
            let part = format!("{part}[{index}]");
            let value = self.value(&part, expression, &point.names)?;
            if value.abs() > MAX_COORDINATE_M {
                return Err(self.invalid(
                    &part,
                    format!("{value} m is more than {MAX_COORDINATE_M} m from the field's centre"),
                ));
            }
            place[index] = value;
        }
        Ok(place)
    }

    fn curve(&self, part: &str, curve: &CurvePart, painted: bool) -> Result<Curve, FieldError> {
        let curve = match curve {
            CurvePart::Segment { from, to } => Curve::Segment {
                from: self.line_point(&format!("{part}, from"), from, painted)?,
                to: self.line_point(&format!("{part}, to"), to, painted)?,
            },
            // A circle is an arc of a whole turn; where it starts shows only in parameters along
            // it.
            CurvePart::Circle { centre, radius_m } => Curve::Arc {
                centre: self.line_point(&format!("{part}, centre"), centre, painted)?,
                radius_m: self.positive(&format!("{part}, radius_m"), radius_m)?,
                start: Angle::ZERO,
                sweep: Angle::from_degrees(360.0),
            },
            CurvePart::Arc(points) => {
                let [from, through, to] = &**points;
                arc_through(
                    self.line_point(&format!("{part}, from"), from, painted)?,
                    self.line_point(&format!("{part}, through"), through, painted)?,
                    self.line_point(&format!("{part}, to"), to, painted)?,
                )
                .map_err(|problem| self.invalid(part, problem))?
            }
        };
        if curve.length_m() < MIN_LENGTH_M {
            return Err(self.invalid(part, format!("it is only {} m long", curve.length_m())));
        }
        Ok(curve)
    }

    /// A point of a line, m; that of a painted line must lie on the ground.
    fn line_point(&self, part: &str, point: &PointPart, painted: bool) -> Result<Vec3, FieldError> {
        let place = self.point(part, point)?;
        if painted && place.z != 0.0 {
            let problem = format!(
                "it lies at z = {} m: what is off the ground needs \"painted\": false",
                place.z
            );
            return Err(self.invalid(part, problem));
        }
        Ok(place)
    }
}

/// A curve moved sideways by `shift_m`: a straight one towards `inside`, a round one towards its
/// centre; away from it if negative.
fn shift_inward(curve: &Curve, inside: Option<Vec3>, shift_m: f64) -> Result<Curve, String> {
    match *curve {
        Curve::Segment { from, to } => {
            // The reader demands a point inside unless the paint is centred on the line.
            let Some(inside) = inside else {
                return Ok(*curve);
            };
            // The part of the way to the point inside that is perpendicular to the line. The line
            // has a length of at least MIN_LENGTH_M, so its direction is defined.
            let along = (to - from).normalize();
            let towards = inside - from;
            let across = towards - along * towards.dot(&along);
            if across.norm() < MIN_LENGTH_M {
                return Err("its point inside lies on the line itself".to_owned());
            }
            let shift = across.normalize() * shift_m;
            Ok(Curve::Segment {
                from: from + shift,
                to: to + shift,
            })
        }
        Curve::Arc {
            centre,
            radius_m,
            start,
            sweep,
        } if radius_m > shift_m => Ok(Curve::Arc {
            centre,
            radius_m: radius_m - shift_m,
            start,
            sweep,
        }),
        Curve::Arc { radius_m, .. } => Err(format!(
            "its radius {radius_m} m is less than half the width of its paint"
        )),
    }
}

/// The arc of the horizontal circle through three points, from the first to the last.
fn arc_through(from: Vec3, through: Vec3, to: Vec3) -> Result<Curve, String> {
    if from.z != through.z || from.z != to.z {
        return Err("an arc's three points must lie at one height".to_owned());
    }
    // The circumcentre relative to `from`, which keeps the subtraction exact for small arcs far
    // from the origin.
    let (b, c) = (through - from, to - from);
    let twice_area = b.x * c.y - b.y * c.x;
    // In relation to the squared length, so that the limit is an angle. Three coinciding points
    // have zero on both sides, hence the second condition.
    if twice_area.abs() < 1e-9 * b.norm().max(c.norm()).powi(2) || twice_area == 0.0 {
        return Err("an arc's three points must not lie on one straight line".to_owned());
    }
    // The point p with |p|² = |p − b|² = |p − c|²: 2 b·p = |b|² and 2 c·p = |c|², by Cramer's rule.
    let (bb, cc) = (b.norm_squared(), c.norm_squared());
    let offset = Vec3::new(c.y * bb - b.y * cc, b.x * cc - c.x * bb, 0.0) / (2.0 * twice_area);
    let centre = from + offset;
    let direction = |point: Vec3| (point.y - centre.y).atan2(point.x - centre.x);
    let start = direction(from);
    let turn = (direction(to) - start).rem_euclid(std::f64::consts::TAU);
    // A positive area means counter-clockwise (from +x towards +y), so the sweep is positive.
    let sweep = if twice_area > 0.0 {
        turn
    } else {
        turn - std::f64::consts::TAU
    };
    Ok(Curve::Arc {
        centre,
        radius_m: offset.norm(),
        start: Angle::from_radians(start),
        sweep: Angle::from_radians(sweep),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_passes_through_its_three_points_in_order() {
        for (from, through, to) in [
            (
                Vec3::new(36.0, -7.3, 0.0),
                Vec3::new(32.35, 0.0, 0.0),
                Vec3::new(36.0, 7.3, 0.0),
            ),
            (
                Vec3::new(1.0, 0.0, 2.0),
                Vec3::new(0.0, -1.0, 2.0),
                Vec3::new(0.0, 1.0, 2.0),
            ),
            (
                Vec3::new(1.0, 0.0, 0.0),
                Vec3::new(0.0, 1.0, 0.0),
                Vec3::new(-1.0, 0.0, 0.0),
            ),
        ] {
            let arc = arc_through(from, through, to).unwrap();
            assert!(
                same_place(arc.point_at(0.0), from) && same_place(arc.point_at(1.0), to),
                "{arc:?}"
            );
            let nearest = (0..=10_000)
                .map(|i| (arc.point_at(f64::from(i) / 1e4) - through).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-3, "{arc:?} misses {through}");
        }
    }
}
