//! The base estimated together with the size of the field.

use super::{BaseEstimationError, BaseProblem, EstimatedBase};
use crate::calibrate::field_size::written::set_field_size;
use crate::calibrate::field_size::{keep_lengths, state_errors};
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::progress::Progress;
use touchline_core::solve::base::{
    AdjustOptions, BaseEstimate, BaseModel, BaseOptions, BaseProgress, FittedSize, FrameClicks,
    SizeStart,
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
        let fitted = self.fit_size_to(&self.clicks, &found.estimate);
        let sizes = self.open_size.fitted_or_assumed(fitted);
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

    /// What is open of the size of its field, as an error of a base that keeps it. A base on an
    /// assumed size draws what its frames do not show where the usual field has it.
    pub(in crate::calibrate) fn state_open_size(
        &self,
        frames: &[FrameClicks],
        estimate: &mut BaseEstimate,
    ) {
        if !self.open_size.is_stated {
            let fitted = self.fit_size_to(frames, estimate);
            let kept = keep_lengths(&self.field, fitted);
            state_errors(&mut estimate.base, &kept);
        }
    }

    /// Fits the open lengths from an estimate, with its lens model.
    fn fit_size_to(&self, frames: &[FrameClicks], estimate: &BaseEstimate) -> Vec<FittedSize> {
        let cameras = estimate.frames.iter();
        let ptz: Vec<Option<Ptz>> = cameras.map(|fit| fit.map(|fit| fit.ptz)).collect();
        self.fit_size(frames, (&estimate.base, &ptz), &estimate.model)
    }

    /// Fits the open lengths of the field to what the frames show, from an approximate base and
    /// cameras. Empty if the template leaves no choice or the fit fails.
    pub(in crate::calibrate) fn fit_size(
        &self,
        frames: &[FrameClicks],
        (base, ptz): (&CameraBase, &[Option<Ptz>]),
        model: &BaseModel,
    ) -> Vec<FittedSize> {
        let options = AdjustOptions::default().with_lens(&self.lens, self.image_size);
        self.open_size.fit(&SizeStart {
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
