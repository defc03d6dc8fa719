//! Fits the size of a document's field to the clicks of a camera.

use super::field_size::set_field_size;
use crate::calibrate::{BaseEstimationError, BaseProblem, EstimatedBase};
use std::collections::BTreeMap;
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::field::{FieldModel, Template};
use touchline_core::progress::Progress;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, BaseOptions, BaseProgress, FittedSize, FrameClicks, SizeParam,
    SizeStart, fit_field_size,
};
use touchline_documents::document::DocumentAt;

/// The template parameters that are a field's size.
const SIZE: [&str; 2] = ["length_m", "width_m"];

/// Prior 1-σ of a field's size as a fraction of the range that the rules allow: 7.5 m for the
/// length of a soccer pitch, 0.75 m for that of a rink.
const SIGMA_SHARE: f64 = 1.0 / 4.0;

impl BaseProblem {
    /// Estimates the base together with the field's size: first the base on the field as assumed,
    /// then the size, then the base again if the size has changed. `document` is the one that the clicks were gathered
    /// from.
    ///
    /// # Errors
    /// The clicks give no base, or it was cancelled.
    pub fn estimate_with_size(
        &self,
        document: DocumentAt<'_>,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<EstimatedBase, BaseEstimationError> {
        let found = self.estimate(&document, options, progress)?;
        // The size is fitted from there with the same lens model.
        let ptz: Vec<_> = found
            .estimate
            .frames
            .iter()
            .map(|fit| fit.map(|fit| fit.ptz))
            .collect();
        let model = &found.estimate.model;
        let template = document
            .field_of_camera(&self.camera)
            .template(document.folder)?;
        let open = OpenSize::new(template, &self.field);
        let fitted = self.fit_size(&open, &self.clicks, (&found.estimate.base, &ptz), model);
        let sizes = open.fitted_or_assumed(fitted);
        // Where the frames show no length, the field and with it the base stay as they are.
        if sizes.iter().all(|size| size.is_open) {
            return Ok(EstimatedBase { sizes, ..found });
        }
        // The base again, on a copy of the document with the fitted field.
        let mut sized = document.document.clone();
        set_field_size(&mut sized, &self.camera, &sizes);
        let found = Self::from_document(sized.at(document.folder), &self.camera)?
            .estimate(&sized, options, progress)?;
        Ok(EstimatedBase { sizes, ..found })
    }

    /// Fits the open lengths of the field to what the frames show, from an approximate base and
    /// cameras. Empty if the template leaves no choice or the fit fails.
    pub(super) fn fit_size(
        &self,
        open: &OpenSize,
        frames: &[FrameClicks],
        (base, ptz): (&CameraBase, &[Option<Ptz>]),
        model: &BaseModel,
    ) -> Vec<FittedSize> {
        let start = SizeStart {
            field: &self.field,
            frames,
            base,
            ptz,
            model,
            image_size: self.image_size,
            options: &AdjustOptions::default(),
        };
        fit_field_size(
            &|values| open.field_with_lengths(values),
            &open.params,
            &start,
        )
        .unwrap_or_default()
    }
}

/// The lengths of a field that its rules do not fix, and the field at other values of them.
#[derive(Clone)]
pub(crate) struct OpenSize {
    template: Template,
    params_m: BTreeMap<String, f64>,
    crown_m: f64,
    /// These lengths with their assumed values; empty if the rules fix all.
    pub params: Vec<SizeParam>,
}

impl OpenSize {
    /// Collects the lengths that are free in the template of a field.
    pub fn new(template: Template, field: &FieldModel) -> Self {
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

/// If the position changes by less than this with 1 σ of an unknown length, the text does not
/// mention it, m.
const WORTH_SAYING_M: f64 = 0.2;

/// Describes a fitted size: "length 103.40 ± 0.08 m (105 m assumed)".
pub fn describe_size(size: &FittedSize) -> String {
    let what = size.name.trim_end_matches("_m");
    if size.is_open {
        let (assumed_m, sigma_m) = (size.assumed_m, size.sigma_m);
        return format!(
            "{what} {assumed_m} m is assumed: the frames do not show it (± {sigma_m:.1} m). What they show lies right; state the field's {what} if it is another"
        );
    }
    let text = format!(
        "{what} {:.2} ± {:.2} m ({} m assumed)",
        size.value_m, size.sigma_m, size.assumed_m
    );
    let along_m = size.position_sigma_m;
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
