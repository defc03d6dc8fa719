//! A base that was found without clicks, adjusted once more to the paint that its frames' own pictures show: the strokes that it
//! was found by are coarser than what can be read there once it is known where to look.

use super::candidates::ViewGraph;
use super::error::Stop;
use super::held::hold_on_paint;
use super::traces::PictureOfFrame;
use super::{UnclickedError, UnclickedProgress, WatchUnclicked};
use crate::calibrate::{
    BaseOnPaintError, EstimatedBase, UnclickedCamera, covariance_on_paint, estimate_on_paint, record_found,
};
use std::collections::BTreeMap;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame};

/// What is seen once more from the same pictures is known no better than half of what it moved by.
const OF_MOVE: f64 = 0.5;

/// A copy of a document in which nothing is known of a camera's frames: a search reads neither clicks nor cameras that were known before.
pub(super) fn without_labels(document: &Document, camera: &CameraId) -> Document {
    let mut bare = document.clone();
    for index in 0..bare.frames.len() {
        if bare.frames[index].camera == *camera {
            let frame = &mut bare.frames[index];
            (frame.clicks, frame.ptz, frame.solution) = (Vec::new(), None, None);
            frame.status = frame.undecided();
        }
    }
    bare
}

/// A base adjusted once more.
pub(super) struct Refined {
    estimated: EstimatedBase,
    field: FieldModel,
    /// Of each frame that took part, by its place in the document.
    ptz: BTreeMap<usize, Ptz>,
}

impl Refined {
    /// Of a camera that was found, with the field's size where that is open (`sized`); none where its frames' paint does not hold a
    /// base.
    ///
    /// # Errors
    /// The search was stopped, or the field cannot be had.
    pub fn of(
        (found, sized): (&UnclickedCamera, bool),
        options: &BaseOptions,
        (document, camera): (DocumentAt<'_>, &CameraId),
        picture: PictureOfFrame<'_>,
        watch: WatchUnclicked<'_>,
    ) -> Result<Option<Self>, Stop> {
        let mut bare = without_labels(document.document, camera);
        record_found(&mut bare, camera, found);
        let mut picture_of = |frame: &Frame| picture(document.frames.position_of(&frame.id)?);
        let at = bare.at(document.folder);
        let progress = Progress::new(|_| watch(UnclickedProgress::Refining));
        let estimated = match estimate_on_paint(at, camera, options, sized, &mut picture_of, &progress) {
            Ok(on_paint) => on_paint.estimated,
            Err(_) if watch(UnclickedProgress::Refining).is_break() => return Err(UnclickedError::Stopped.into()),
            Err(BaseOnPaintError::TooFewLines { .. } | BaseOnPaintError::Base(_)) => return Ok(None),
        };
        estimated.write_camera(&mut bare);
        let field = bare.at(document.folder).model_of(bare.field_of_camera(camera)).map_err(UnclickedError::from)?;
        let fits = estimated.frames.iter().zip(&estimated.estimate.frames);
        let ptz = fits.filter_map(|(index, fit)| Some((*index, fit.as_ref()?.ptz))).collect();
        Ok(Some(Self { estimated, field, ptz }))
    }

    /// Where the camera stands, `world`, m.
    pub const fn position_m(&self) -> Vec3 {
        self.estimated.estimate.base.position_m
    }

    /// The view graph around the new base. `looked_at` has the index in the document of each sampled frame.
    pub fn view_graph(&self, view_graph: ViewGraph, looked_at: &[usize], size: ImageSize) -> ViewGraph {
        let of_place = |frame: usize| {
            let index = looked_at.get(*view_graph.indices.get(frame)?)?;
            self.ptz.get(index).copied()
        };
        let ptz: Vec<Option<Ptz>> = (0..view_graph.ptz.len()).map(of_place).collect();
        // What the strokes told of a frame counted for little where they lay beside its lines; now it lies on its paint.
        let held = |(frame, ptz): (usize, &Option<Ptz>)| {
            let ptz = (*ptz)?;
            let camera = PtzCamera::new(self.estimated.estimate.base, ptz);
            hold_on_paint(frame, ptz, &covariance_on_paint(&camera, size), size)
        };
        let paint_priors = ptz.iter().enumerate().filter_map(held).collect();
        ViewGraph { ptz, paint_priors, ..view_graph }
    }

    /// The camera with the new base.
    pub fn camera(self, found: UnclickedCamera) -> UnclickedCamera {
        let Self { estimated: EstimatedBase { estimate, mut sizes, .. }, field, .. } = self;
        let mut base = estimate.base;
        let moved = base.position_m - found.base.position_m;
        let moved = base.sigma.following_position(OF_MOVE * moved);
        base.sigma = base.sigma.covering(&(moved * moved.transpose()));
        for (size, before) in sizes.iter_mut().zip(&found.sizes) {
            size.assumed_m = before.assumed_m;
            size.sigma_m = size.sigma_m.max(OF_MOVE * (size.value_m - before.value_m).abs());
        }
        UnclickedCamera { base, field, sizes, ..found }
    }
}
