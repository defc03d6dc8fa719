//! From a template's JSON to its parts: checks names, expands groups of variants and parses
//! expressions.
//!
//! Landmarks and lines are read in `entries.rs`, everything else here.

mod entries;

use super::file::{Formula, Ordered, ParamFile, TemplateFile};
use super::{Dimension, Expression, FieldError, Param, Symmetry, Template};
use std::collections::BTreeMap;

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
    // Parameters and dimensions first: they give the names that all other formulas use.
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

    // Landmarks before lines, because a line's points may be landmarks.
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

/// What a name is, in words; [`is_name`] checks it.
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
        // A name has one meaning in all expressions; those of variants are reserved.
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
            // Without names in scope: the range is what the rules say, and depends on nothing.
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
                varies: file.varies,
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
}
