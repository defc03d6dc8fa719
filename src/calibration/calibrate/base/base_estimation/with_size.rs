//! The base estimated together with the size of the field.

use super::{BaseEstimationError, BaseProblem, EstimatedBase};
use crate::calibrate::field_size::OpenSize;
use crate::calibrate::field_size::written::set_field_size;
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::progress::Progress;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, BaseOptions, BaseProgress, FittedSize, FrameClicks, SizeStart,
};
use touchline_documents::document::DocumentAt;

impl BaseProblem {
    /// Estimates the base together with the field's size: first the base on the field as assumed,
    /// then the size, then the base again if the size has changed. `document` is the one that the
    /// clicks were gathered from.
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
        let spec = document.field_of_camera(&self.camera);
        let open = OpenSize::of(document, spec, &self.field)?;
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
    pub(in crate::calibrate) fn fit_size(
        &self,
        open: &OpenSize,
        frames: &[FrameClicks],
        (base, ptz): (&CameraBase, &[Option<Ptz>]),
        model: &BaseModel,
    ) -> Vec<FittedSize> {
        let options = AdjustOptions::default().with_lens(&self.lens, self.image_size);
        open.fit(&SizeStart {
            field: &self.field,
            frames,
            base,
            ptz,
            model,
            image_size: self.image_size,
            options: &options,
        })
    }
}
