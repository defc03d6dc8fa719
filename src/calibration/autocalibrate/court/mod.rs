//! The base of a camera that shows a court, from the straight lines of single pictures.
//!
//! # Problem
//!
//! The panorama of the other stages needs a camera that turns: a still one has no focal length from
//! matches. And it needs to know what the ground is: a court in a surround of another colour is
//! half of its own picture. Yet such a camera mostly shows the whole court at once.
//!
//! # Idea
//!
//! Two lines along a court and two across it determine a camera (D. Farin, S. Krabbe, P. de With,
//! W. Effelsberg: "Robust camera calibration for sport videos using court models", SPIE 5307,
//! 2004). Lines that long and straight stand out on ground of any colour.
//!
//! # Steps
//!
//! 1. The long straight bright lines of a picture ([`touchline_vision::paint::straight_lines`]).
//! 2. Every two pairs of them as every rectangle of the field (`rectangles.rs`); scored by the
//!    lines of the field that are lines of the picture (`shown_lines.rs`, `grid.rs`).
//! 3. The best are adjusted to these lines, then to the paint beside them, and weighed in nats on
//!    the ground that they themselves say is the court's (`picture.rs`).
//! 4. The answer of one picture is tried on the others: with its base they are aligned to their own
//!    paint. The base is adjusted to all of them, and weighed once more (this file).
//!
//! # What it is not proof against
//!
//! Courts that are never shown with two lines in each direction; dark lines; a principal point far
//! from the middle; a lens that bends lines by more than some px.

mod grid;
mod picture;
mod rectangles;
mod shown_lines;
#[cfg(test)]
mod tests;

use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence};
use crate::evidence::Evidence;
use picture::{MAX_CONTRADICTED, PictureCamera, camera_of_picture};
use rayon::prelude::*;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, CameraClicks, CrownModel, FrameClicks, LensModel, adjust_base,
};
use touchline_vision::paint::{
    GroundPicture, MarkingPixels, SnapOptions, Snapped, observations_of_paint, paint_places, snap,
};

/// Number of pictures that are tried.
pub const MAX_PICTURES: usize = 7;

/// Minimum evidence for the base by all pictures together, nats.
const MIN_NATS: f64 = 200.0;

/// Maximum number of answers of single pictures that are tried on the others.
const MAX_STARTS: usize = 3;

/// Minimum number of pictures that can be aligned with the base, where there are as many.
const MIN_ALIGNED: usize = 2;

/// Rounds of alignment and adjustment of the base.
const ROUNDS: usize = 2;

/// A picture that may show the court.
pub struct CourtFrame {
    /// Its index in the document.
    pub index: usize,
    pub ground: GroundPicture,
    /// Its lens as it is stated.
    pub lens: StatedLens,
}

/// The camera of some frames of one court. None where the pictures are not decisive.
pub fn find_court_camera(
    frames: &[CourtFrame],
    field: &FieldModel,
) -> Option<AutocalibratedCamera> {
    let alone: Vec<Option<PictureCamera>> = frames
        .par_iter()
        .map(|frame| camera_of_picture(frame, field))
        .collect();
    let mut starts: Vec<&PictureCamera> = alone
        .iter()
        .flatten()
        .filter(|found| found.is_decided)
        .collect();
    starts.sort_by(|a, b| b.score.total_cmp(&a.score));
    starts.iter().take(MAX_STARTS).find_map(|start| {
        let on_base = OnBase::settle(frames, field, &alone, start)?;
        let seen = on_base.markings(frames, field);
        let pictures: Vec<(PtzCamera, &MarkingPixels)> = seen
            .iter()
            .map(|(camera, markings)| (*camera, markings))
            .collect();
        let evidence = Evidence::weigh(field, &pictures);
        let is_certain =
            evidence.nats() >= MIN_NATS && evidence.contradicted_share() <= MAX_CONTRADICTED;
        is_certain.then(|| AutocalibratedCamera {
            paint: paint_directions(&seen),
            ..on_base.into_camera(frames, field, evidence.nats())
        })
    })
}

/// Frames that are aligned to their paint with one base.
struct OnBase {
    base: CameraBase,
    /// Of each frame.
    aligned: Vec<Option<Snapped>>,
}

impl OnBase {
    /// Aligns frames with the base of one picture, and adjusts it to them. None where too few can
    /// be aligned, or no more than decide for another base. Close-ups and other cameras' pictures
    /// say nothing.
    fn settle(
        frames: &[CourtFrame],
        field: &FieldModel,
        alone: &[Option<PictureCamera>],
        start: &PictureCamera,
    ) -> Option<Self> {
        let mut base = *start.camera.base();
        let mut views: Vec<Vec<Ptz>> = alone
            .iter()
            .map(|found| {
                // As the frame's own lines say, as those of the first frame do: it may stand still.
                let own = found.as_ref().map(|found| view_from(&base, &found.camera));
                own.into_iter().chain([start.camera.ptz()]).collect()
            })
            .collect();
        let is_outvoted = |aligned: &[Option<Snapped>]| {
            let num_aligned = aligned.iter().flatten().count();
            let elsewhere = aligned.iter().zip(alone).filter(|(aligned, alone)| {
                aligned.is_none() && alone.is_some_and(|alone| alone.is_decided)
            });
            num_aligned < MIN_ALIGNED.min(frames.len()) || num_aligned <= elsewhere.count()
        };
        for round in 0..=ROUNDS {
            let aligned: Vec<Option<Snapped>> = frames
                .par_iter()
                .zip(&views)
                .map(|(frame, views)| align(frame, field, &base, views))
                .collect();
            if is_outvoted(&aligned) {
                return None;
            }
            if round == ROUNDS {
                return Some(Self { base, aligned });
            }
            let cameras: Vec<(&CourtFrame, PtzCamera)> = frames
                .iter()
                .zip(&aligned)
                .filter_map(|(frame, aligned)| {
                    Some((frame, PtzCamera::new(base, aligned.as_ref()?.ptz)))
                })
                .collect();
            let adjusted = adjust_to_paint(field, &cameras)?;
            let former = base;
            base = *adjusted.first()?.base();
            let mut adjusted = adjusted.into_iter();
            for (views, aligned) in views.iter_mut().zip(&aligned) {
                if aligned.is_some() {
                    views.clear();
                    views.extend(adjusted.next().map(|camera| camera.ptz()));
                } else {
                    for view in views {
                        *view = view_from(&base, &PtzCamera::new(former, *view));
                    }
                }
            }
        }
        None
    }

    /// The aligned cameras, each with the marking pixels of its picture.
    fn markings(
        &self,
        frames: &[CourtFrame],
        field: &FieldModel,
    ) -> Vec<(PtzCamera, MarkingPixels)> {
        frames
            .par_iter()
            .zip(&self.aligned)
            .filter_map(|(frame, aligned)| {
                let camera = PtzCamera::new(self.base, aligned.as_ref()?.ptz);
                let markings = MarkingPixels::bright_on_court(&frame.ground, field, &camera);
                Some((camera, markings))
            })
            .collect()
    }

    fn into_camera(
        self,
        frames: &[CourtFrame],
        field: &FieldModel,
        nats: f64,
    ) -> AutocalibratedCamera {
        let aligned = frames.iter().zip(self.aligned);
        let frames: Vec<AutocalibratedFrame> = aligned
            .filter_map(|(frame, aligned)| {
                Some(AutocalibratedFrame {
                    index: frame.index,
                    ptz: aligned.as_ref()?.ptz,
                    uncertainty: None,
                    snapped: aligned,
                    unaligned_score: None,
                })
            })
            .collect();
        AutocalibratedCamera {
            base: self.base,
            field: field.clone(),
            sizes: Vec::new(),
            others: Vec::new(),
            paint: Vec::new(),
            evidence: AutocalibrationEvidence {
                frames: frames.len(),
                nats,
                ..AutocalibrationEvidence::default()
            },
            frames,
        }
    }
}

/// Where some cameras see paint, evenly subsampled.
fn paint_directions(seen: &[(PtzCamera, MarkingPixels)]) -> Vec<PanTilt> {
    /// As many show every line, and draw at once.
    const MAX_DIRECTIONS: usize = 3000;
    let directions = seen.iter().flat_map(|(camera, markings)| {
        let points = markings.points.iter();
        points.filter_map(|point| camera.ray_from_image(point.at).ok())
    });
    subsample(directions.collect::<Vec<_>>(), MAX_DIRECTIONS).collect()
}

/// Aligns a frame to its paint with a base, from the first of some views that leads there.
fn align(
    frame: &CourtFrame,
    field: &FieldModel,
    base: &CameraBase,
    views: &[Ptz],
) -> Option<Snapped> {
    let options = SnapOptions::default();
    views
        .iter()
        .find_map(|view| snap(&frame.ground, field, base, *view, &[], &options).ok())
}

/// The pan, tilt and focal length with which a base looks as another camera does, or as that does
/// from the opposite place, whichever is nearer: half a turn makes courts alike.
fn view_from(base: &CameraBase, camera: &PtzCamera) -> Ptz {
    let opposite = camera.after_half_turn();
    let off_m = |camera: &PtzCamera| (camera.base().position_m - base.position_m).norm();
    let camera = if off_m(&opposite) < off_m(camera) {
        &opposite
    } else {
        camera
    };
    base.ptz_like(&camera.cam_from_world(), camera.ptz().focal_px)
}

/// Cameras of one base, adjusted with it to the paint near their lines.
fn adjust_to_paint(
    field: &FieldModel,
    cameras: &[(&CourtFrame, PtzCamera)],
) -> Option<Vec<PtzCamera>> {
    let (first, _) = cameras.first()?;
    let frames: Vec<FrameClicks> = cameras
        .par_iter()
        .map(|(frame, camera)| {
            let places = paint_places(&frame.ground, field, camera);
            FrameClicks {
                observations: observations_of_paint(&places, field).collect(),
                start: Some(camera.ptz()),
            }
        })
        .collect();
    adjust(
        field,
        (first.ground.size(), &first.lens),
        cameras.iter().map(|(_, camera)| *camera),
        &frames,
    )
}

/// A camera adjusted to places of lines in its picture.
fn adjust_to_places(
    field: &FieldModel,
    size: ImageSize,
    (camera, lens): (&PtzCamera, &StatedLens),
    places: Vec<Observation>,
) -> Option<PtzCamera> {
    let frames = [FrameClicks {
        observations: places,
        start: Some(camera.ptz()),
    }];
    Some(adjust(field, (size, lens), std::iter::once(*camera), &frames)?[0])
}

/// Adjusts the base of some cameras and their views. None where a frame has too few observations,
/// or the base flees the field.
fn adjust(
    field: &FieldModel,
    (size, lens): (ImageSize, &StatedLens),
    cameras: impl Iterator<Item = PtzCamera> + Clone,
    frames: &[FrameClicks],
) -> Option<Vec<PtzCamera>> {
    /// No camera stands farther away than this, in lengths of the field.
    const FARTHEST_LENGTHS: f64 = 20.0;
    let base = *cameras.clone().next()?.base();
    let clicks = CameraClicks {
        field,
        frames,
        image_size: size,
        principal_point: base.principal_point,
        own_cameras: &[],
    };
    let model = BaseModel {
        lens: LensModel::K1Focal,
        crown: CrownModel::Fixed(field.crown_m),
        principal_point: None,
    };
    let ptz: Vec<Option<Ptz>> = cameras.map(|camera| Some(camera.ptz())).collect();
    let options = AdjustOptions::default().with_lens(lens, size);
    let adjusted = adjust_base(&clicks, &base, &ptz, &model, &options);
    let is_sane = adjusted.base.is_finite()
        && adjusted.base.position_m.norm() < FARTHEST_LENGTHS * field.length_m;
    let with_base = |ptz: Option<Ptz>| Some(PtzCamera::new(adjusted.base, ptz?));
    is_sane.then(|| adjusted.ptz.into_iter().map(with_base).collect())?
}
