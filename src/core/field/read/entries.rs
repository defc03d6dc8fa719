//! Reads landmarks and lines: one entry of the file for each group of variants.

use super::{NAME_RULE, Reader, is_name};
use crate::field::file::{Formula, LandmarkFile, LineFile, PointFile};
use crate::field::parts::{CurvePart, LandmarkPart, LinePart, PointPart, Scoped};
use crate::field::variants::{MAX_ENTRIES, Variant, variants};
use crate::field::{Expression, FieldError, PaintEdge};
use std::collections::BTreeSet;

/// An entry's names, filled in.
struct EntryNames {
    part: String,
    id: String,
    label: String,
    code: String,
    variant: Variant,
}

impl Reader<'_> {
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
                // Checked when filled in, because braces are no part of a name. These errors name
                // the entry as the file has it, later ones its variant.
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

    pub(super) fn landmark(
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

    pub(super) fn line(
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
            // The keys that are given say which curve it is; every other combination is ambiguous.
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
            // The side on which the paint of a straight line lies needs a point; the inside of a
            // round one is its centre's side, and centred paint has none.
            let straight = matches!(curve, CurvePart::Segment { .. });
            if inside.is_some() != (straight && edge != PaintEdge::Centre) {
                let problem = "inside (a point of the area that the line bounds) belongs to straight lines whose edge is \
                               outer or inner, and only to them";
                return Err(self.invalid(&part, problem.to_owned()));
            }
            let width_m =
                self.scoped_expression(&format!("{part}, width_m"), &file.width_m, &variant)?;
            // Dashes may depend on parameters, as widths may.
            let dash_part = format!("{part}, dash_m");
            let dash_m = match &file.dash_m {
                Some([dash, gap]) => Some([
                    self.scoped_expression(&dash_part, dash, &variant)?,
                    self.scoped_expression(&dash_part, gap, &variant)?,
                ]),
                None => None,
            };
            into.push(LinePart {
                id,
                label,
                code,
                curve,
                width_m,
                edge,
                inside,
                painted: file.painted.unwrap_or(true),
                dash_m,
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
            // The landmark's own formulas, with the names of its own variant.
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
    pub(super) fn unique(
        &self,
        landmarks: &[LandmarkPart],
        lines: &[LinePart],
    ) -> Result<(), FieldError> {
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
