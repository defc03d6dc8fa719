//! Refines the base of a hypothesis with the paint of its frames' own pictures.
//!
//! The marking pixels from which the search found the base are coarse, because they were detected without
//! a prediction. With a base, each painted line is measured where the base predicts it, as for a
//! base that the user refines ([`KnownFrames::estimate_base`]).

use super::align::prior_from_alignment;
use super::hypothesis::{Hypothesis, unaligned_frames};
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::sampled_frames::PictureOfFrame;
use crate::autocalibrate::progress::report;
use crate::autocalibrate::{AutocalibrationError, AutocalibrationProgress};
use crate::calibrate::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence, BaseOnPaintError,
    BaseProblem, KnownCameras, KnownFrames, OpenSize, PaintEstimate, covariance_on_paint,
};
use std::collections::BTreeMap;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{CameraId, Document, DocumentAt, FieldSpec};

/// The 1-σ of a quantity that was measured twice in the same pictures is at least this share of the
/// difference.
const SIGMA_OF_CHANGE: f64 = 0.5;

/// The document whose camera is searched.
#[derive(Clone, Copy)]
pub struct SearchedCamera<'a> {
    pub document: DocumentAt<'a>,
    pub camera: &'a CameraId,
    /// Whether the size of the field is fitted as well.
    pub is_size_unknown: bool,
}

/// Estimates the base of a hypothesis once more, from the paint of its frames' own pictures. None
/// if that does not determine a base.
///
/// Where the field's size is open it is fitted, even if the assumed one explained the paint as
/// well: this adjustment sees decimetres of it.
///
/// # Errors
/// The search was stopped, or the field cannot be had.
pub fn refine_base(
    hypothesis: &Hypothesis,
    options: &BaseOptions,
    searched: SearchedCamera<'_>,
    matched: &MatchedFrames,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<Option<Hypothesis>, Stop> {
    report(progress, AutocalibrationProgress::Refining)?;
    let SearchedCamera {
        document,
        camera,
        is_size_unknown,
    } = searched;
    let Some(of_document) = document.camera(camera) else {
        return Ok(None);
    };
    // The field of the document, with the size and the crown of the hypothesis.
    let found = &hypothesis.camera;
    let spec = found_field(&document, camera, found);
    let field = document
        .model_of(&spec)
        .map_err(AutocalibrationError::from)?;

    // Collect the frames of the hypothesis that may take part. Neither clicks nor cameras that the
    // document already has are used.
    let frames: Vec<&AutocalibratedFrame> = found
        .frames
        .iter()
        .filter(|frame| {
            let frame = &document.frames[frame.index];
            frame.is_used_for_base() && frame.image_size == of_document.image_size
        })
        .collect();
    let indices: Vec<usize> = frames.iter().map(|frame| frame.index).collect();
    let open = OpenSize::of(document, &spec, &field).map_err(AutocalibrationError::from)?;
    let known = KnownFrames {
        start: KnownCameras {
            base: found.base,
            crown_m: field.crown_m,
            ptz: frames.iter().map(|frame| Some(frame.best_ptz())).collect(),
            by_clicks: false,
        },
        masks: indices
            .iter()
            .map(|&index| document.masks_of(&document.frames[index]))
            .collect(),
        picture: &mut |place: usize| picture(indices[place]),
        fits_size: is_size_unknown,
        problem: BaseProblem::without_clicks(
            of_document,
            (field, open),
            &found.base,
            indices.clone(),
        ),
    };
    // An error after the receiver ended the search is the cancellation. Any other means that the
    // paint does not determine a base: no answer, but no failure either.
    let estimating = progress.part(|_| AutocalibrationProgress::Refining);
    let estimated = match known.estimate_base(options, &estimating) {
        Ok(estimated) => estimated,
        Err(_)
            if progress
                .report(AutocalibrationProgress::Refining)
                .is_break() =>
        {
            return Err(AutocalibrationError::Stopped.into());
        }
        Err(BaseOnPaintError::TooFewLines { .. } | BaseOnPaintError::Base(_)) => return Ok(None),
    };
    Ok(Some(with_base(hypothesis, estimated, matched)))
}

/// The field of the document's camera, with the size and the crown of the hypothesis.
fn found_field(document: &Document, camera: &CameraId, found: &AutocalibratedCamera) -> FieldSpec {
    let mut spec = document.field_of_camera(camera).clone();
    // Lengths that its frames hardly show, too: the base belongs to them.
    let lengths = found
        .sizes
        .iter()
        .map(|size| (size.name.clone(), size.value_m));
    spec.params.extend(lengths);
    spec.set_crown_m(found.field.crown_m);
    spec
}

/// The hypothesis with the estimated base, frames, and field in place of its own.
fn with_base(
    hypothesis: &Hypothesis,
    estimated: PaintEstimate,
    matched: &MatchedFrames,
) -> Hypothesis {
    let PaintEstimate {
        problem,
        estimate,
        mut sizes,
        ..
    } = estimated;
    let before = &hypothesis.camera;

    // Both bases come from the same pictures, so their difference is an error that is in neither
    // covariance. Half of it is taken as the 1-σ, with rotation and lens following the position by
    // their correlations. The same holds for the lengths of the field.
    let mut base = estimate.base;
    let change_m = base.position_m - before.base.position_m;
    let error_m = base.sigma.following_position(SIGMA_OF_CHANGE * change_m);
    base.sigma = base.sigma.covering(&(error_m * error_m.transpose()));
    for (size, before) in sizes.iter_mut().zip(&before.sizes) {
        size.assumed_m = before.assumed_m;
        size.cover_error(SIGMA_OF_CHANGE * (size.value_m - before.value_m).abs());
    }
    // A size that finds less of the paint is not taken; the field keeps that of the hypothesis.
    if sizes.is_empty() {
        sizes.clone_from(&before.sizes);
    }

    let field = FieldModel {
        crown_m: estimate.crown_m,
        ..problem.field
    };
    // The pose prior of a frame from the marking pixels is weak if these lay beside its lines. The frame
    // now lies on its paint, so it gets the covariance of an alignment.
    let fitted = problem.frames.iter().zip(&estimate.frames);
    let ptz_by_index: BTreeMap<usize, Ptz> = fitted
        .filter_map(|(index, fit)| Some((*index, fit.as_ref()?.ptz)))
        .collect();
    let ptz: Vec<Option<Ptz>> = matched
        .indices
        .iter()
        .map(|index| ptz_by_index.get(index).copied())
        .collect();
    let paint_priors = ptz.iter().enumerate().filter_map(|(number, ptz)| {
        let ptz = (*ptz)?;
        let covariance =
            covariance_on_paint(&PtzCamera::new(estimate.base, ptz), matched.image_size);
        prior_from_alignment(number, ptz, &covariance, matched.image_size)
    });
    Hypothesis {
        paint_priors: paint_priors.collect(),
        camera: AutocalibratedCamera {
            base,
            field,
            sizes,
            // The alignments were made with the other base.
            frames: unaligned_frames(&ptz, matched),
            evidence: AutocalibrationEvidence {
                pixel_aspect: estimate.pixel_aspect,
                ..before.evidence.clone()
            },
            ..before.clone()
        },
        ptz,
        frames: hypothesis.frames.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        base, document, draw_picture, hypothesis, matched_views, ptz, soccer,
    };
    use rayon::prelude::*;
    use std::ops::ControlFlow;
    use std::path::Path;
    use touchline_core::geometry::Vec3;
    use touchline_vision::media::Picture;

    /// The right hypothesis with its position shifted by half a metre.
    fn beside() -> Hypothesis {
        let mut hypothesis = hypothesis(&soccer().assumed);
        hypothesis.camera.base.position_m += Vec3::new(0.3, -0.4, 0.1);
        hypothesis
    }

    fn refine(
        hypothesis: &Hypothesis,
        picture: PictureOfFrame<'_>,
        progress: &Progress<'_, AutocalibrationProgress>,
    ) -> Result<Option<Hypothesis>, Stop> {
        refine_on(hypothesis, false, picture, progress)
    }

    fn refine_on(
        hypothesis: &Hypothesis,
        is_size_unknown: bool,
        picture: PictureOfFrame<'_>,
        progress: &Progress<'_, AutocalibrationProgress>,
    ) -> Result<Option<Hypothesis>, Stop> {
        let (document, camera) = (document(), "main".into());
        let document = document.at(Path::new(""));
        let searched = SearchedCamera {
            document,
            camera: &camera,
            is_size_unknown,
        };
        refine_base(
            hypothesis,
            &BaseOptions::default(),
            searched,
            &matched_views(),
            picture,
            progress,
        )
    }

    fn drawn_pictures(field: &FieldModel) -> Vec<Picture> {
        ptz()
            .into_par_iter()
            .map(|ptz| draw_picture(field, ptz))
            .collect()
    }

    #[test]
    fn a_base_beside_its_place_is_brought_onto_the_paint() {
        let (from, pictures) = (beside(), drawn_pictures(&soccer().assumed));
        let mut indices_read = Vec::new();
        let mut picture = |index: usize| {
            indices_read.push(index);
            pictures.get(index - 10).cloned()
        };
        let refined = refine(&from, &mut picture, &Progress::default())
            .ok()
            .flatten()
            .unwrap();
        let off_m = (refined.position_m() - base().position_m).norm();
        assert!(off_m < 0.1, "{off_m:.3} m");
        assert!(
            indices_read.iter().all(|index| (10..17).contains(index)),
            "{indices_read:?}"
        );
        let off_px =
            |(found, truth): (&Option<Ptz>, Ptz)| (found.unwrap().focal_px - truth.focal_px).abs();
        assert!(
            refined.ptz.iter().zip(ptz()).map(off_px).all(|px| px < 3.0),
            "{:?}",
            refined.ptz
        );
        assert_eq!(refined.paint_priors.len(), 7);
        let frames: Vec<Option<Ptz>> = refined
            .camera
            .frames
            .iter()
            .map(|frame| Some(frame.ptz))
            .collect();
        assert_eq!(frames, refined.ptz, "with the refined base");
        // Both positions come from the same pictures: half of their difference stays uncertain.
        let changed_m = (refined.position_m() - from.position_m()).norm();
        let sigma_m = refined.camera.base.sigma.position_m.norm();
        assert!(
            sigma_m > SIGMA_OF_CHANGE * changed_m && sigma_m < 1.0,
            "{sigma_m} m after {changed_m} m"
        );
        assert_eq!(
            refined.camera.field.length_m, from.camera.field.length_m,
            "the size is known"
        );
    }

    /// The near touchline lies 27 px beside where the assumed field has it, too far to be found. The
    /// far one, 2 px off, gives a width of which the near one is found.
    #[test]
    fn a_width_is_fitted_until_both_touchlines_are_found() {
        let prior = soccer();
        let pictures = drawn_pictures(&prior.with_lengths(&[105.0, 65.0]).unwrap());
        let mut picture = |index: usize| pictures.get(index - 10).cloned();
        let from = hypothesis(&prior.assumed);
        let refined = refine_on(&from, true, &mut picture, &Progress::default());
        let refined = refined.ok().flatten().unwrap();
        let [length, width] = refined.camera.sizes.as_slice() else {
            panic!("{:?}", refined.camera.sizes);
        };
        assert!((length.value_m - 105.0).abs() < 0.1, "{length:?}");
        assert!((width.value_m - 65.0).abs() < 0.1, "{width:?}");
        let off_m = (refined.position_m() - base().position_m).norm();
        assert!(off_m < 0.15, "{off_m:.3} m");
    }

    #[test]
    fn without_pictures_no_base_is_refined() {
        let refined = refine(&beside(), &mut |_| None, &Progress::default());
        assert!(matches!(refined, Ok(None)));
    }

    #[test]
    fn refining_stops_when_it_is_cancelled() {
        let stopped = refine(
            &beside(),
            &mut |_| None,
            &Progress::new(|_| ControlFlow::Break(())),
        );
        assert!(matches!(
            stopped,
            Err(Stop::Failed(AutocalibrationError::Stopped))
        ));
    }
}
