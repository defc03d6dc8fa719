//! A camera of a venue, tried on the frames of another match.

use super::forest_labels::{ForestRequest, propose_on_lines};
use super::match_labels::{Labelling, MatchEvent};
use super::venues::{BaseChange, VenueCamera, VenueEvent, VenueRefusal, Whereabouts};
use crate::autocalibrate::{GroundClick, MIN_NATS, contradicting_click};
use crate::calibrate::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence, estimate_on_paint,
};
use crate::evidence::Evidence;
use crate::proposals::{FeatureStore, FramePictures, read_picture};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera, StatedLens, StatedRadial};
use touchline_core::field::FieldModel;
use touchline_core::solve::base::{BaseOptions, BaseProgress, CrownModel};
use touchline_documents::document::{CameraId, Document, FieldSize, FieldSpec};
use touchline_vision::paint::{GroundPicture, MarkingPixels, SnapOptions, Snapped, snap};
use touchline_vision::relocalize::RelocalizeOptions;

/// Minimum number of frames that features answer and that lie on their paint.
const MIN_ALIGNED: usize = 4;
/// Minimum share of the answered frames that lie on their paint.
const MIN_ALIGNED_SHARE: f64 = 0.5;
/// A base explains too little if more than this share of what speaks for it speaks against it.
const MAX_CONTRADICTED: f64 = 0.15;
/// A camera that stands farther from the known one is another camera of the venue, m.
const MAX_MOVED_M: f64 = 5.0;
/// The known base is kept where it has at least this share of the evidence for the one that is
/// estimated from the frames themselves, which fits their noise as well. Halves of six broadcast
/// clips and a drawn match have .90 to 1.00 of it; a lean of .3° leaves .71, a step of 1.2 m .34.
const SAME_SHARE: f64 = 0.85;

/// A camera of a venue that took frames of another match.
#[derive(Clone, Debug)]
pub(super) struct VenueAnswer {
    /// The camera, with its frames that lie on their paint. Its evidence has nats alone.
    pub found: AutocalibratedCamera,
    /// The field of the venue.
    pub field: FieldSpec,
    /// How it stands now.
    pub change: BaseChange,
    /// Number of frames that features answered.
    pub answered: usize,
}

impl VenueCamera<'_> {
    /// The event that it is tried.
    fn event(self) -> MatchEvent {
        MatchEvent::Venue(VenueEvent::Trying {
            venue: self.venue.name.clone(),
        })
    }
}

/// A frame whose direction is known by its features.
struct RecognisedFrame {
    index: usize,
    ptz: Ptz,
    ground: GroundPicture,
    markings: MarkingPixels,
}

/// The base that the paint of some frames gives.
struct Estimate {
    base: CameraBase,
    crown_m: f64,
    /// The frames that took part, by their index in the document, and their cameras.
    fits: Vec<(usize, Ptz)>,
}

/// What some frames show with a base.
struct OnBase {
    /// The alignment of each frame to its paint; none where that fails.
    alignment: Vec<Option<Snapped>>,
    evidence: Evidence,
}

impl OnBase {
    /// Aligns frames to their paint, each from its own start, and weighs all of their paint.
    fn align(
        frames: &[(&RecognisedFrame, Ptz)],
        field: &FieldModel,
        base: &CameraBase,
        options: &SnapOptions,
    ) -> Self {
        let alignment: Vec<_> = frames
            .par_iter()
            .map(|(frame, start)| snap(&frame.ground, field, base, *start, &[], options).ok())
            .collect();
        let pictures: Vec<(PtzCamera, &MarkingPixels)> = frames
            .iter()
            .zip(&alignment)
            .map(|((frame, start), alignment)| {
                let ptz = alignment.as_ref().map_or(*start, |alignment| alignment.ptz);
                (PtzCamera::new(*base, ptz), &frame.markings)
            })
            .collect();
        Self {
            evidence: Evidence::weigh(field, &pictures),
            alignment,
        }
    }

    fn aligned_count(&self) -> usize {
        self.alignment.iter().flatten().count()
    }
}

impl Labelling<'_> {
    /// Tries a camera of a venue on some frames of `camera`.
    ///
    /// # Errors
    /// The reason why it is not the camera that took them.
    pub(super) fn try_venue(
        &mut self,
        of_venue: VenueCamera<'_>,
        camera: &CameraId,
        frames: &[usize],
        store: &FeatureStore,
    ) -> Result<VenueAnswer, VenueRefusal> {
        let (mut trial, known, field) = self.trial_document(of_venue, camera)?;
        let recognised = self.recognise(&trial, of_venue, camera, frames, store);
        let answered = recognised.len();
        if answered < MIN_ALIGNED {
            let of = frames.len();
            return Err(VenueRefusal::NotRecognised { answered, of });
        }
        // With the known base. A camera that leans in another way lies on its paint less exactly.
        let by_features: Vec<_> = recognised.iter().map(|it| (it, it.ptz)).collect();
        let loose = SnapOptions::for_unknown_lens();
        let before = OnBase::align(&by_features, &field, &known, &loose);
        check_aligned(before.aligned_count(), answered)?;
        // The base once more, from the paint of these frames alone.
        let mut starts = by_features;
        for ((frame, start), alignment) in starts.iter_mut().zip(&before.alignment) {
            *start = alignment.as_ref().map_or(*start, |alignment| alignment.ptz);
            trial.frames[frame.index].point(*start, known.distortion.radial_at(start.focal_px));
        }
        // From here on the features play no part: the paint says where the camera stands.
        let again = self.estimate_again(&trial, of_venue, camera, (&known, &field));
        let Some(estimate) = again else {
            let aligned = before.aligned_count();
            return Err(VenueRefusal::NotOnPaint { aligned, answered });
        };
        let base = estimate.base;
        // Each base is weighed with frames that are aligned with it.
        let strict = SnapOptions::default();
        let on_known = OnBase::align(&starts, &field, &known, &strict);
        for (frame, start) in &mut starts {
            let fit = estimate
                .fits
                .iter()
                .find(|(index, _)| *index == frame.index);
            *start = fit.map_or(*start, |(_, ptz)| *ptz);
        }
        // The crown was estimated beside the base.
        let field_again = FieldModel {
            crown_m: estimate.crown_m,
            ..field.clone()
        };
        let again = OnBase::align(&starts, &field_again, &base, &strict);
        // The paint decides whether anything changed. Covariances take the upright position that
        // every base is presumed to have for a measurement of it, and overlook a small lean.
        let mut change = BaseChange::between(&known, &base);
        if on_known.evidence.nats() >= SAME_SHARE * again.evidence.nats() {
            change.whereabouts = Whereabouts::Same;
        } else if change.whereabouts == Whereabouts::Same {
            change.whereabouts = change.likelier_change();
        }
        let (base, field, on_base) = match change.whereabouts {
            Whereabouts::Same => (known, field, on_known),
            Whereabouts::Turned | Whereabouts::Moved => (base, field_again, again),
        };
        check_aligned(on_base.aligned_count(), answered)?;
        // A neighbouring camera sees the same stands, and its frames fit a base of its own.
        if change.moved_m > MAX_MOVED_M {
            return Err(VenueRefusal::Elsewhere(change));
        }
        // As after a search: enough has to speak for the camera, and little against it.
        let (nats, contradicted) = (
            on_base.evidence.nats(),
            on_base.evidence.contradicted_share(),
        );
        if nats < MIN_NATS || contradicted > MAX_CONTRADICTED {
            return Err(VenueRefusal::LittleEvidence { nats, contradicted });
        }
        // The field goes into the document with the crown of the base that is taken.
        let mut spec = trial.field_of_camera(camera).clone();
        spec.set_crown_m(field.crown_m);
        let aligned = recognised.iter().zip(on_base.alignment);
        let frames: Vec<AutocalibratedFrame> = aligned
            .filter_map(|(frame, alignment)| Some(found_frame(frame.index, alignment?)))
            .collect();
        let found = AutocalibratedCamera {
            base,
            field,
            sizes: Vec::new(),
            evidence: AutocalibrationEvidence {
                frames: frames.len(),
                nats,
                ..AutocalibrationEvidence::default()
            },
            frames,
            others: Vec::new(),
            paint: Vec::new(),
        };
        // Clicks take no part in a trial, so that they are a check of its own.
        let of_match = &self.document.frames;
        let answered_frames: Vec<usize> = found.frames.iter().map(|frame| frame.index).collect();
        let clicks = GroundClick::from_frames(of_match, &answered_frames, &found.field);
        if let Some(doubt) = contradicting_click(&found, &clicks, of_match) {
            return Err(VenueRefusal::Contradicted(doubt));
        }
        Ok(VenueAnswer {
            found,
            field: spec,
            change,
            answered,
        })
    }

    /// The document with a base and a field of a venue, and no clicks; the base and the field.
    fn trial_document(
        &self,
        of_venue: VenueCamera<'_>,
        camera: &CameraId,
    ) -> Result<(Document, CameraBase, FieldModel), VenueRefusal> {
        let mut trial = self.document.clone();
        let stated = trial.field_of_camera(camera).clone();
        let spec = of_venue.field();
        if spec.template != stated.template {
            let template = spec.template.clone();
            return Err(VenueRefusal::OtherField { template });
        }
        // A size that the user states is not replaced.
        let is_stated = stated.size == Some(FieldSize::Confirmed);
        let spec = if is_stated { &stated } else { spec };
        let size = of_venue.camera.image_size;
        // Pictures of other proportions are cut out of the camera's, at an unknown place.
        let camera_mut = trial.camera_mut(camera);
        let known = camera_mut.and_then(|camera| {
            let base = of_venue.base_in(camera.image_size)?;
            Some((camera, base))
        });
        let Some((camera_mut, base)) = known else {
            return Err(VenueRefusal::OtherSize { size });
        };
        camera_mut.set_base(&base);
        camera_mut.field = Some(spec.clone());
        // Clicks would take part in the estimate. Frames without any stay shared with the document.
        for frame in 0..trial.frames.len() {
            if !trial.frames[frame].clicks.is_empty() {
                trial.frames[frame].clicks.clear();
            }
        }
        let field = trial
            .at(self.folder)
            .model_of(spec)
            .map_err(|_| VenueRefusal::OtherField {
                template: spec.template.clone(),
            })?;
        Ok((trial, base, field))
    }

    /// The frames whose direction the features of a camera give.
    fn recognise(
        &mut self,
        trial: &Document,
        of_venue: VenueCamera<'_>,
        camera: &CameraId,
        frames: &[usize],
        store: &FeatureStore,
    ) -> Vec<RecognisedFrame> {
        let Some(model) = trial
            .camera(camera)
            .and_then(|it| of_venue.model_for(camera, it.image_size))
        else {
            return Vec::new();
        };
        // The forest's answer is used even where it is unsure of it: the paint decides.
        let pictures = FramePictures::new(trial, self.folder, model.features, store);
        let forest = ForestRequest {
            model: &model,
            generation: 0,
            options: RelocalizeOptions::default(),
        };
        let progress = self.progress.part(|_: usize| of_venue.event());
        let proposals = propose_on_lines(&pictures, self.reader, frames, &forest, None, &progress);
        let mut recognised = Vec::new();
        for (&index, proposal) in frames.iter().zip(proposals) {
            // A frame that the forest does not know is no evidence against the camera: it may show
            // what no frame of the venue showed.
            let Ok(answer) = proposal.outcome else {
                continue;
            };
            let frame = &trial.frames[index];
            if let Ok(picture) = read_picture(&mut *self.reader, frame, self.folder) {
                let ground = GroundPicture::new(&picture, &trial.masks_of(frame));
                recognised.push(RecognisedFrame {
                    index,
                    ptz: answer.ptz.ptz(),
                    markings: MarkingPixels::detect(&ground),
                    ground,
                });
            }
        }
        recognised
    }

    /// The base, the crown and the frames' cameras by the paint of the frames alone; the lens and
    /// the crown are those of the venue, as well as they are known there.
    fn estimate_again(
        &mut self,
        trial: &Document,
        of_venue: VenueCamera<'_>,
        camera: &CameraId,
        (known, field): (&CameraBase, &FieldModel),
    ) -> Option<Estimate> {
        // A lens is the camera's, wherever that stands; a few frames hardly show it.
        let lens = StatedLens {
            radial: Some(StatedRadial::new(known.distortion, &known.sigma)),
            ..StatedLens::default()
        };
        let options = BaseOptions {
            crown: Some(CrownModel::Fixed(field.crown_m)),
            placing_frames: usize::MAX,
            ..BaseOptions::default()
        }
        .with_lens(&lens, trial.camera(camera)?.image_size);
        let (reader, folder) = (&mut *self.reader, self.folder);
        let estimated = estimate_on_paint(
            trial.at(folder),
            camera,
            &options,
            false,
            &mut |frame| read_picture(&mut *reader, frame, folder).ok(),
            &self.progress.part(|_: BaseProgress| of_venue.event()),
        );
        let estimated = estimated.ok()?.estimated;
        // Frames that took no part in the estimate keep the start that they had.
        let fits = estimated.frames.iter().zip(&estimated.estimate.frames);
        let fits = fits.filter_map(|(index, fit)| Some((*index, fit.as_ref()?.ptz)));
        Some(Estimate {
            base: estimated.estimate.base,
            crown_m: estimated.estimate.crown_m,
            fits: fits.collect(),
        })
    }
}

/// Whether enough of the frames that features answered lie on their paint.
fn check_aligned(aligned: usize, answered: usize) -> Result<(), VenueRefusal> {
    let needed = (MIN_ALIGNED_SHARE * answered as f64).max(MIN_ALIGNED as f64);
    if (aligned as f64) < needed {
        return Err(VenueRefusal::NotOnPaint { aligned, answered });
    }
    Ok(())
}

/// A frame that lies on its paint.
fn found_frame(index: usize, alignment: Snapped) -> AutocalibratedFrame {
    AutocalibratedFrame {
        index,
        ptz: alignment.ptz,
        uncertainty: None,
        unaligned_score: None,
        snapped: Some(alignment),
    }
}
