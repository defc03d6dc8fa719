//! From a template's JSON to its parts: checks names, expands groups of variants and parses
//! expressions.

use super::file::{Formula, LandmarkFile, LineFile, Ordered, ParamFile, PointFile, TemplateFile};
use super::parts::{CurvePart, LandmarkPart, LinePart, PointPart, Scoped};
use super::variants::{Variant, variants};
use super::{Dimension, Expression, FieldError, PaintEdge, Param, Symmetry, Template};
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of landmarks, and of lines.
const MAX_ENTRIES: usize = 2000;
/// The maximum number of parameters: loading builds the field with each at its smallest and largest
/// value.
const MAX_PARAMS: usize = 100;
/// Names with a meaning in expressions.
const RESERVED: [&str; 4] = ["sqrt", "x_side", "y_side", "number"];

/// Reads all parts of a template; expressions are parsed, but not evaluated.
pub fn read_parts(file: TemplateFile, place: &str) -> Result<Template, FieldError> {
    let reader = Reader { place };
    if !is_name(&file.name) {
        return Err(reader.invalid("name", format!("{:?} is not {NAME_RULE}", file.name)));
    }
    if file.params.0.len() > MAX_PARAMS {
        let found = file.params.0.len();
        return Err(reader.invalid(
            "params",
            format!(
                "{found} are given, and {MAX_PARAMS} are the most; write the others as numbers"
            ),
        ));
    }
    let params = reader.params(file.params)?;
    let mut dimensions = Vec::new();
    for (name, dimension) in file.dimensions.0 {
        let part = format!("dimension {name:?}");
        reader.new_name(&part, &name, &params, &dimensions)?;
        reader.text_given(&part, "source", &dimension.source)?;
        let value = reader.expression(&part, &dimension.value)?;
        dimensions.push(Dimension {
            name,
            value,
            source: dimension.source,
        });
    }
    let [length, width] = &file.extent_m;
    let extent_m = [
        reader.expression("extent_m[0]", length)?,
        reader.expression("extent_m[1]", width)?,
    ];
    let symmetry = file
        .symmetry
        .iter()
        .map(|name| {
            Symmetry::from_name(name).ok_or_else(|| {
                let known = Symmetry::ALL.map(Symmetry::name).join(", ");
                reader.invalid("symmetry", format!("{name:?} is not one of {known}"))
            })
        })
        .collect::<Result<_, _>>()?;

    let mut landmarks = Vec::new();
    for landmark in &file.landmarks {
        reader.landmark(landmark, file.click_sigma_px, &mut landmarks)?;
    }
    if landmarks.is_empty() {
        return Err(reader.invalid("landmarks", "there are none".to_owned()));
    }
    let mut lines = Vec::new();
    for line in &file.lines {
        reader.line(line, &landmarks, &mut lines)?;
    }
    if lines.is_empty() {
        return Err(reader.invalid("lines", "there are none".to_owned()));
    }
    reader.unique(&landmarks, &lines)?;
    Ok(Template {
        name: file.name,
        title: file.title,
        notes: file.notes,
        params,
        dimensions,
        symmetry,
        extent_m,
        landmarks,
        lines,
        place: place.to_owned(),
    })
}

const NAME_RULE: &str = "a name of lower-case letters, digits and \"_\" that starts with a letter";

fn is_name(text: &str) -> bool {
    text.len() <= 64
        && text.starts_with(|c: char| c.is_ascii_lowercase())
        && text
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

struct Reader<'a> {
    place: &'a str,
}

impl Reader<'_> {
    fn invalid(&self, part: &str, problem: String) -> FieldError {
        FieldError::Invalid {
            place: self.place.to_owned(),
            part: part.to_owned(),
            problem,
        }
    }

    fn expression(&self, part: &str, formula: &Formula) -> Result<Expression, FieldError> {
        formula
            .expression()
            .map_err(|problem| FieldError::Expression {
                place: self.place.to_owned(),
                part: part.to_owned(),
                text: formula.text(),
                problem: Box::new(problem),
            })
    }

    fn text_given(&self, part: &str, key: &str, text: &str) -> Result<(), FieldError> {
        if text.trim().is_empty() {
            Err(self.invalid(part, format!("{key} is empty")))
        } else {
            Ok(())
        }
    }

    fn new_name(
        &self,
        part: &str,
        name: &str,
        params: &[Param],
        dimensions: &[Dimension],
    ) -> Result<(), FieldError> {
        if !is_name(name) {
            return Err(self.invalid(part, format!("{name:?} is not {NAME_RULE}")));
        }
        let taken = params.iter().any(|param| param.name == name)
            || dimensions.iter().any(|dimension| dimension.name == name)
            || RESERVED.contains(&name);
        if taken {
            Err(self.invalid(part, format!("the name {name:?} is taken")))
        } else {
            Ok(())
        }
    }

    fn params(&self, files: Ordered<ParamFile>) -> Result<Vec<Param>, FieldError> {
        let mut params: Vec<Param> = Vec::new();
        for (name, file) in files.0 {
            let part = format!("param {name:?}");
            self.new_name(&part, &name, &params, &[])?;
            self.text_given(&part, "label", &file.label)?;
            self.text_given(&part, "source", &file.source)?;
            if file.unit != "m" || !name.ends_with("_m") {
                let problem = format!(
                    "its unit is {:?}; parameters are metres (unit \"m\", name ending in _m)",
                    file.unit
                );
                return Err(self.invalid(&part, problem));
            }
            let (min, default, max) = (
                self.constant(format!("{part}, min"), &file.min)?,
                self.constant(format!("{part}, default"), &file.default)?,
                self.constant(format!("{part}, max"), &file.max)?,
            );
            if !(min <= default && default <= max) {
                let problem =
                    format!("the default {default} is not within min {min} and max {max}");
                return Err(self.invalid(&part, problem));
            }
            params.push(Param {
                name,
                label: file.label,
                unit: file.unit,
                default,
                min,
                max,
                source: file.source,
            });
        }
        Ok(params)
    }

    /// The value of a formula that refers to no parameter and no dimension, m.
    fn constant(&self, part: String, formula: &Formula) -> Result<f64, FieldError> {
        let expression = self.expression(&part, formula)?;
        expression
            .evaluate(&BTreeMap::new(), &[])
            .map_err(|problem| FieldError::Expression {
                place: self.place.to_owned(),
                part,
                text: formula.text(),
                problem: Box::new(problem),
            })
    }

    /// Every variant of an entry's id, with its id, label and code filled in.
    fn names(
        &self,
        kind: &str,
        id: &str,
        label: &str,
        code: &str,
    ) -> Result<Vec<EntryNames>, FieldError> {
        let part = format!("{kind} {id:?}");
        self.text_given(&part, "label", label)?;
        variants(id)
            .map_err(|problem| self.invalid(&part, problem))?
            .into_iter()
            .map(|variant| {
                let (id, label, code) = (
                    self.fill(&part, &variant, id)?,
                    self.fill(&part, &variant, label)?,
                    self.fill(&part, &variant, code)?,
                );
                if !is_name(&id) {
                    return Err(self.invalid(&part, format!("{id:?} is not {NAME_RULE}")));
                }
                if !(2..=4).contains(&code.len())
                    || !code
                        .bytes()
                        .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit())
                {
                    return Err(self.invalid(
                        &part,
                        format!("its code {code:?} is not 2 to 4 lower-case letters or digits"),
                    ));
                }
                Ok(EntryNames {
                    part: format!("{kind} {id:?}"),
                    id,
                    label,
                    code,
                    variant,
                })
            })
            .collect()
    }

    /// A text with the names of a variant filled in.
    fn fill(&self, part: &str, variant: &Variant, text: &str) -> Result<String, FieldError> {
        variant
            .fill(text)
            .map_err(|problem| self.invalid(part, problem))
    }

    fn coordinates(
        &self,
        part: &str,
        variant: &Variant,
        formulas: &[Formula],
    ) -> Result<PointPart, FieldError> {
        if !(2..=3).contains(&formulas.len()) {
            let problem = format!(
                "{} coordinates instead of [x, y] or [x, y, z]",
                formulas.len()
            );
            return Err(self.invalid(part, problem));
        }
        Ok(PointPart {
            coordinates: [
                self.coordinate(part, formulas, 0)?,
                self.coordinate(part, formulas, 1)?,
                self.coordinate(part, formulas, 2)?,
            ],
            names: variant.names().collect(),
        })
    }

    /// One of a point's coordinates; 0 where it is not given, which lays the point on the ground.
    fn coordinate(
        &self,
        part: &str,
        formulas: &[Formula],
        index: usize,
    ) -> Result<Expression, FieldError> {
        formulas.get(index).map_or_else(
            || Ok(Expression::number(0.0)),
            |formula| self.expression(&format!("{part}[{index}]"), formula),
        )
    }

    fn landmark(
        &self,
        file: &LandmarkFile,
        sigma_px: f64,
        into: &mut Vec<LandmarkPart>,
    ) -> Result<(), FieldError> {
        for EntryNames {
            part,
            id,
            label,
            code,
            variant,
        } in self.names("landmark", &file.id, &file.label, &file.code)?
        {
            let click_sigma_px = file.click_sigma_px.unwrap_or(sigma_px);
            if !(click_sigma_px > 0.0 && click_sigma_px <= 100.0) {
                return Err(self.invalid(
                    &part,
                    format!("click_sigma_px = {click_sigma_px} is outside 0 to 100"),
                ));
            }
            let at = self.coordinates(&format!("{part}, at"), &variant, &file.at)?;
            let spot = file.spot_diameter_m.as_ref();
            let spot = spot.map(|diameter| {
                self.scoped_expression(&format!("{part}, spot_diameter_m"), diameter, &variant)
            });
            into.push(LandmarkPart {
                id,
                label,
                code,
                at,
                click_sigma_px,
                spot_diameter_m: spot.transpose()?,
                is_unmarked: file.unmarked,
            });
        }
        self.not_too_many("landmarks", into.len())
    }

    fn line(
        &self,
        file: &LineFile,
        landmarks: &[LandmarkPart],
        into: &mut Vec<LinePart>,
    ) -> Result<(), FieldError> {
        for EntryNames {
            part,
            id,
            label,
            code,
            variant,
        } in self.names("line", &file.id, &file.label, &file.code)?
        {
            let point =
                |key: &str, point: &PointFile| self.point(&part, key, point, &variant, landmarks);
            let curve = match (
                &file.from,
                &file.through,
                &file.to,
                &file.centre,
                &file.radius_m,
            ) {
                (Some(from), None, Some(to), None, None) => CurvePart::Segment {
                    from: point("from", from)?,
                    to: point("to", to)?,
                },
                (Some(from), Some(through), Some(to), None, None) => CurvePart::Arc(Box::new([
                    point("from", from)?,
                    point("through", through)?,
                    point("to", to)?,
                ])),
                (None, None, None, Some(centre), Some(radius)) => CurvePart::Circle {
                    centre: point("centre", centre)?,
                    radius_m: self.scoped_expression(
                        &format!("{part}, radius_m"),
                        radius,
                        &variant,
                    )?,
                },
                _ => {
                    let problem = "it needs from and to (straight), from, through and to (arc), or centre and radius_m (circle)";
                    return Err(self.invalid(&part, problem.to_owned()));
                }
            };
            let edge = match file.edge.as_deref() {
                None | Some("centre") => PaintEdge::Centre,
                Some("outer") => PaintEdge::Outer,
                Some("inner") => PaintEdge::Inner,
                Some(other) => {
                    return Err(self.invalid(
                        &part,
                        format!("edge {other:?} is not one of centre, outer, inner"),
                    ));
                }
            };
            let inside = file
                .inside
                .as_ref()
                .map(|inside| point("inside", inside))
                .transpose()?;
            let straight = matches!(curve, CurvePart::Segment { .. });
            if inside.is_some() != (straight && edge != PaintEdge::Centre) {
                let problem = "inside (a point of the area that the line bounds) belongs to straight lines whose edge is \
                               outer or inner, and only to them";
                return Err(self.invalid(&part, problem.to_owned()));
            }
            let width_m =
                self.scoped_expression(&format!("{part}, width_m"), &file.width_m, &variant)?;
            into.push(LinePart {
                id,
                label,
                code,
                curve,
                width_m,
                edge,
                inside,
                painted: file.painted.unwrap_or(true),
            });
        }
        self.not_too_many("lines", into.len())
    }

    fn point(
        &self,
        part: &str,
        key: &str,
        point: &PointFile,
        variant: &Variant,
        landmarks: &[LandmarkPart],
    ) -> Result<PointPart, FieldError> {
        match point {
            PointFile::Coordinates(formulas) => {
                self.coordinates(&format!("{part}, {key}"), variant, formulas)
            }
            PointFile::Landmark(name) => {
                let id = self.fill(part, variant, name)?;
                landmarks
                    .iter()
                    .find(|landmark| landmark.id == id)
                    .map(|landmark| landmark.at.clone())
                    .ok_or_else(|| {
                        self.invalid(
                            &format!("{part}, {key}"),
                            format!("there is no landmark {id:?}"),
                        )
                    })
            }
        }
    }

    fn scoped_expression(
        &self,
        part: &str,
        formula: &Formula,
        variant: &Variant,
    ) -> Result<Scoped, FieldError> {
        Ok(Scoped {
            expression: self.expression(part, formula)?,
            names: variant.names().collect(),
        })
    }

    fn not_too_many(&self, part: &str, count: usize) -> Result<(), FieldError> {
        if count > MAX_ENTRIES {
            return Err(self.invalid(part, format!("more than {MAX_ENTRIES}")));
        }
        Ok(())
    }

    /// Checks that ids are unique among landmarks and among lines, and codes among both, because a
    /// typed code must have one meaning.
    fn unique(&self, landmarks: &[LandmarkPart], lines: &[LinePart]) -> Result<(), FieldError> {
        let mut codes = BTreeSet::new();
        let mut ids = BTreeSet::new();
        let all = landmarks
            .iter()
            .map(|landmark| ("landmark", &landmark.id, &landmark.code))
            .chain(lines.iter().map(|line| ("line", &line.id, &line.code)));
        for (kind, id, code) in all {
            if !ids.insert((kind, id)) {
                return Err(self.invalid(
                    &format!("{kind} {id:?}"),
                    "there are two of this id".to_owned(),
                ));
            }
            if !codes.insert(code) {
                return Err(self.invalid(
                    &format!("{kind} {id:?}"),
                    format!("its code {code:?} is taken"),
                ));
            }
        }
        Ok(())
    }
}

/// An entry's names, filled in.
struct EntryNames {
    part: String,
    id: String,
    label: String,
    code: String,
    variant: Variant,
}
