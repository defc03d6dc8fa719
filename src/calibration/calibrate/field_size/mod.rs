//! The size of a field: what its rules leave open of it, what is fitted and measured of that, what
//! stays unseen, and its way into a document.
//!
//! [`OpenSize`] is the prior of the lengths that the rules do not fix, and the field at any value
//! of them. With clicks or paint on lines they are fitted with the base (`touchline_core`), on
//! pictures again and again until they stand (`base/size_on_paint.rs`). What the known frames of a
//! camera do not show of them is an error of every other frame of it (`unseen.rs`), until its paint
//! measures them (`on_lines.rs`).

pub mod on_lines;
pub mod unseen;
pub mod written;

use std::collections::BTreeMap;
use touchline_core::camera::CameraBase;
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_core::solve::base::{FittedSize, SizeParam, SizeStart, fit_field_size};
use touchline_documents::document::{DocumentAt, FieldSpec};

/// The template parameters that are a field's size.
const SIZE: [&str; 2] = ["length_m", "width_m"];

/// Prior 1-σ of a field's size as a fraction of the range that the rules allow: 7.5 m for the
/// length of a soccer pitch, 0.75 m for that of a rink.
const SIGMA_SHARE: f64 = 1.0 / 4.0;

/// Minimum 1-σ of the position along each axis, and of a fitted length of the field, where paint
/// alone determines it, as a share of the field's width: 0.3 m on a soccer pitch.
///
/// Deviations of the real ground from the model are common to all frames, so the scatter of the
/// paint does not show them. Positions differ by 0.06 to 0.64 m from those fitted to people's
/// clicks, where the scatter alone suggests 0.05 m; widths differ by up to 0.8 m where it suggests
/// 0.04 to 0.13 m. If clicks give a position too, half of the difference between the two is used
/// instead.
const ALONE_SHARE: f64 = 0.3 / 68.0;

/// A length that paint alone gives is not steady beyond this 1-σ (a share of the field's width: 1 m
/// on a soccer pitch): a far line that is off by 2 px gives a width that is off by that.
pub(crate) const UNSTEADY_SHARE: f64 = 1.0 / 68.0;

/// Paint alone does not determine a length beyond this 1-σ, even where the rules leave it far more
/// open. A length between the two is shown, but the search goes on: taken for open, its line would
/// be drawn where the usual size has it, 13 px beside a far touchline whose width was known to
/// 1.06 m.
const OPEN_SHARE: f64 = 1.5 * UNSTEADY_SHARE;

/// The minimum 1-σ of a position and of a length on a field, where paint alone determines them, m.
pub(crate) fn alone_sigma_m(field: &FieldModel) -> f64 {
    ALONE_SHARE * field.width_m
}

/// Raises the σ of each length to the floor that applies to paint alone, and marks the lengths that
/// it does not determine.
pub(crate) fn as_paint_alone_gives(sizes: &mut [FittedSize], field: &FieldModel) {
    for length in sizes {
        length.is_open |= length.error.sigma_m > OPEN_SHARE * field.width_m;
        length.cover_error(alone_sigma_m(field));
    }
}

/// The lengths of a field that its rules do not fix, and the field at other values of them.
#[derive(Clone, Debug)]
pub(crate) struct OpenSize {
    template: Template,
    params_m: BTreeMap<String, f64>,
    crown_m: f64,
    /// These lengths with their assumed values; empty if the rules fix all.
    pub params: Vec<SizeParam>,
    /// Whether a person or a file states them. They are then fitted only on request, and nothing
    /// depends on their errors.
    pub is_stated: bool,
}

impl OpenSize {
    /// The lengths that are free in the template of a document's field, with the values that
    /// `field` has.
    ///
    /// # Errors
    /// There is no such template.
    pub fn of(
        document: DocumentAt<'_>,
        spec: &FieldSpec,
        field: &FieldModel,
    ) -> Result<Self, FieldError> {
        Ok(Self {
            is_stated: spec.is_size_stated(),
            ..Self::new(spec.template(document.folder)?, field)
        })
    }

    fn new(template: Template, field: &FieldModel) -> Self {
        let open = template
            .params
            .iter()
            .filter(|param| SIZE.contains(&param.name.as_str()) && param.is_open());
        let params = open.map(|param| SizeParam {
            name: param.name.clone(),
            assumed_m: field
                .params
                .get(&param.name)
                .copied()
                .unwrap_or(param.default),
            usual_m: param.default,
            sigma_m: (param.max - param.min) * SIGMA_SHARE,
            min_m: param.min,
            max_m: param.max,
        });
        let params = params.collect();
        Self {
            template,
            params_m: field.params.clone(),
            crown_m: field.crown_m,
            params,
            is_stated: false,
        }
    }

    /// The lengths that a fit has found; the assumed ones, as not shown by the frames, if it has
    /// found none. Without a word of them the user would take the assumed size for the fitted one.
    pub fn fitted_or_assumed(&self, fitted: Vec<FittedSize>) -> Vec<FittedSize> {
        if !fitted.is_empty() {
            return fitted;
        }
        self.params.iter().map(SizeParam::unseen).collect()
    }

    /// Fits them to what frames show, from an approximate base and cameras; the field keeps its
    /// crown. Empty if the rules leave no choice or the fit fails.
    pub fn fit(&self, start: &SizeStart<'_>) -> Vec<FittedSize> {
        let resize = |values: &[f64]| self.resize(start.field, values);
        fit_field_size(&resize, &self.params, start).unwrap_or_default()
    }

    /// The field as the document has it with fitted lengths: those that are not shown stay as they
    /// were assumed.
    pub fn field_with(&self, sizes: &[FittedSize]) -> Option<FieldModel> {
        let stated = sizes.iter().map(|size| {
            if size.is_open {
                size.assumed_m
            } else {
                rounded_m(size.value_m)
            }
        });
        self.field_with_lengths(&stated.collect::<Vec<_>>())
    }

    /// A field with other lengths, in their order, and its own crown.
    pub fn resize(&self, field: &FieldModel, values_m: &[f64]) -> Option<FieldModel> {
        Some(FieldModel {
            crown_m: field.crown_m,
            ..self.field_with_lengths(values_m)?
        })
    }

    /// The free lengths with those of `field` as their assumed values.
    pub fn params_of(&self, field: &FieldModel) -> Vec<SizeParam> {
        self.params
            .iter()
            .map(|param| SizeParam {
                assumed_m: field
                    .params
                    .get(&param.name)
                    .copied()
                    .unwrap_or(param.assumed_m),
                ..param.clone()
            })
            .collect()
    }

    /// The field at these lengths, in the order of `params`, clamped to what the rules allow. None
    /// if the template has no field of that size.
    pub fn field_with_lengths(&self, values_m: &[f64]) -> Option<FieldModel> {
        // Values outside the rules, which an optimiser may try, are clamped.
        let lengths = self.params.iter().zip(values_m);
        let allowed = lengths
            .map(|(param, value)| (param.name.clone(), value.clamp(param.min_m, param.max_m)));
        let mut filled = self.params_m.clone();
        filled.extend(allowed);
        self.template.model(&filled, self.crown_m).ok()
    }
}

/// A length as documents state it, m: nothing determines it better than to a centimetre.
fn rounded_m(value_m: f64) -> f64 {
    (value_m * 100.0).round() / 100.0
}

/// If the position changes by less than this with 1 σ of an unknown length, the text does not
/// mention it, m.
const WORTH_SAYING_M: f64 = 0.2;

/// The errors of the lengths of a field that a base keeps: the σ that frames leave of each, and what
/// they would have made of it.
pub(super) fn keep_lengths(field: &FieldModel, mut fitted: Vec<FittedSize>) -> Vec<FittedSize> {
    for size in &mut fitted {
        if let Some(kept_m) = field.params.get(&size.name) {
            let off_m = size.value_m - kept_m;
            size.error.sigma_m = size.error.sigma_m.hypot(off_m);
        }
    }
    fitted
}

/// Makes the errors of lengths errors of a base.
pub(super) fn state_errors(base: &mut CameraBase, sizes: &[FittedSize]) {
    for size in sizes {
        base.sigma.size[size.axis()] = size.error;
    }
}

/// Describes a fitted size: "length 103.40 ± 0.08 m (105 m assumed)".
pub fn describe_size(size: &FittedSize) -> String {
    let what = size.name.trim_end_matches("_m");
    if size.is_open {
        let (assumed_m, sigma_m) = (size.assumed_m, size.error.sigma_m);
        return format!(
            "{what} {assumed_m} m is assumed: the frames do not show it (± {sigma_m:.1} m). What they show lies right; state the field's {what} if it is another"
        );
    }
    let text = format!(
        "{what} {:.2} ± {:.2} m ({} m assumed)",
        size.value_m, size.error.sigma_m, size.assumed_m
    );
    let along_m = size.position_sigma_m();
    if along_m.norm() <= WORTH_SAYING_M {
        return text;
    }
    let (x, y, z) = (along_m.x, along_m.y, along_m.z);
    format!(
        "{text}; where the field's middle lies, and so the camera's position, goes with it by ({x:.1}, {y:.1}, {z:.1}) m"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::field::builtin;

    #[test]
    fn a_fit_that_fails_is_not_taken_for_a_field_of_fixed_size() {
        let template = builtin("soccer").unwrap();
        let field = template.default_model().unwrap();
        let open = OpenSize::new(template.clone(), &field);
        let stated = open.fitted_or_assumed(Vec::new());
        let names: Vec<&str> = stated.iter().map(|size| size.name.as_str()).collect();
        assert_eq!(names, SIZE);
        assert!(stated.iter().all(|size| size.is_open));
        assert!(
            describe_size(&stated[0]).starts_with("length 105 m is assumed"),
            "{}",
            describe_size(&stated[0])
        );
        assert_eq!(open.fitted_or_assumed(stated.clone()), stated);
    }
}
