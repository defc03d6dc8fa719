//! The base of a camera that shows a court, from the straight lines of single pictures.
//!
//! # Problem
//!
//! The panorama of the other stages needs a camera that rotates: a still one has no focal length
//! from matches. And it needs to know what the ground is: a court in a surround of another colour
//! is half of its own picture. Yet such a camera mostly shows the whole court at once.
//!
//! # Idea
//!
//! Two lines along a court and two across it determine a camera (D. Farin, S. Krabbe, P. de With,
//! W. Effelsberg: "Robust camera calibration for sport videos using court models", SPIE 5307,
//! 2004). Lines that long and straight stand out on ground of any colour.
//!
//! # Steps
//!
//! 1. The long straight lines of a picture, bright ones, dark ones and borders of areas
//!    ([`touchline_vision::paint::straight_lines`]).
//! 2. Every two pairs of them as every rectangle of the field (`rectangles.rs`); scored by the
//!    lines of the field that are lines of the picture (`shown_lines.rs`, `grid.rs`).
//!    That a line is not shown says something only where the ground is seen ([`EvenAreas`]).
//! 3. The best are adjusted to these lines, then to the paint beside them, and weighed in nats on
//!    the ground that they themselves say is the court's (`picture.rs`), each line in the tone that
//!    it has (`toned_markings.rs`).
//!    A picture decides alone, or two that show different views decide where each prefers a camera
//!    at the same place.
//! 4. The answer of one picture is tried on the others: with its base they are aligned to their own
//!    paint. The base is adjusted to all of them, and weighed once more (this file).
//! 5. Of pictures in no usual proportion, which are cut out of others, other principal points are
//!    tried (`search.rs`).
//!
//! # What it is not proof against
//!
//! Courts that are never shown with two lines in each direction; a crop that follows the players; a
//! lens that bends lines by more than some px.

mod grid;
mod picture;
mod rectangles;
mod search;
mod shown_lines;
#[cfg(test)]
mod tests;
mod toned_markings;

use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence};
pub use search::{CourtAnswer, search_court};

use picture::{Certainty, MAX_CONTRADICTED, PictureCamera, camera_of_picture};
use rayon::prelude::*;
use toned_markings::{TonedMarkings, weigh_tones};
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImageSize, Vec3, subsample};
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, CameraClicks, CrownModel, FrameClicks, LensModel, adjust_base,
};
use touchline_vision::paint::{
    EvenAreas, GroundPicture, SnapOptions, Snapped, StraightLine, observations_of_paint,
    paint_places, snap, straight_lines,
};

/// Minimum evidence for the base by all pictures together, nats.
const MIN_NATS_OF_ALL: f64 = 200.0;

/// Maximum number of answers of single pictures that are tried on the others.
const MAX_STARTS: usize = 3;

/// Minimum number of pictures that can be aligned with the base, where there are as many.
const MIN_ALIGNED: usize = 2;

/// Rounds of alignment and adjustment of the base.
const ROUNDS: usize = 2;

/// A picture that may show the court.
pub struct CourtFrame {
    /// Its index in the document.
    index: usize,
    ground: GroundPicture,
    lines: Vec<StraightLine>,
    even: EvenAreas,
}

impl CourtFrame {
    pub fn new(index: usize, ground: GroundPicture) -> Self {
        Self {
            index,
            lines: straight_lines(&ground),
            even: EvenAreas::detect(&ground),
            ground,
        }
    }

    /// The length of its straight lines, px.
    fn length_px(&self) -> f64 {
        self.lines.iter().map(StraightLine::covered_px).sum()
    }
}

/// The camera of some frames of one court with a principal point. None where the pictures are not
/// decisive.
fn find_court_camera(
    frames: &[CourtFrame],
    field: &FieldModel,
    lens: TriedLens,
) -> Option<AutocalibratedCamera> {
    let alone: Vec<Option<PictureCamera>> = frames
        .par_iter()
        .map(|frame| camera_of_picture(frame, field, &lens.stated))
        .collect();
    let size = frames.first()?.ground.size();
    let mut starts: Vec<&PictureCamera> = alone
        .iter()
        .flatten()
        .filter(|found| found.is_decided(&alone, size))
        .collect();
    starts.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    starts.iter().take(MAX_STARTS).find_map(|start| {
        let on_base = OnBase::settle(frames, field, &alone, start, &lens)?;
        let seen = on_base.markings(frames, field);
        let evidence = weigh_tones(field, &seen);
        let is_certain =
            evidence.nats() >= MIN_NATS_OF_ALL && evidence.contradicted_share() <= MAX_CONTRADICTED;
        is_certain.then(|| AutocalibratedCamera {
            paint: paint_directions(&seen),
            ..on_base.into_camera(frames, field, evidence.nats())
        })
    })
}

/// The lens with which pictures are tried.
#[derive(Clone, Copy, Debug, Default)]
struct TriedLens {
    stated: StatedLens,
    /// Whether its principal point is a guess, which several pictures together make better.
    is_guess: bool,
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
        lens: &TriedLens,
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
                aligned.is_none()
                    && alone.is_some_and(|alone| alone.certainty == Certainty::Decided)
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
            let adjusted = adjust_to_paint(field, &cameras, lens)?;
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
    ) -> Vec<(PtzCamera, TonedMarkings)> {
        frames
            .par_iter()
            .zip(&self.aligned)
            .filter_map(|(frame, aligned)| {
                let camera = PtzCamera::new(self.base, aligned.as_ref()?.ptz);
                let markings = TonedMarkings::detect(&frame.ground, field, &camera);
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
fn paint_directions(seen: &[(PtzCamera, TonedMarkings)]) -> Vec<PanTilt> {
    /// As many show every line, and draw at once.
    const MAX_DIRECTIONS: usize = 3000;
    let directions = seen.iter().flat_map(|(camera, markings)| {
        let points = markings.bright.points.iter();
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
    lens: &TriedLens,
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
        (first.ground.size(), lens),
        cameras.iter().map(|(_, camera)| *camera),
        &frames,
    )
}

/// A camera adjusted to places of lines in its picture.
fn adjust_to_places(
    field: &FieldModel,
    size: ImageSize,
    (camera, stated): (&PtzCamera, &StatedLens),
    places: Vec<Observation>,
) -> Option<PtzCamera> {
    let frames = [FrameClicks {
        observations: places,
        start: Some(camera.ptz()),
    }];
    let lens = TriedLens {
        stated: *stated,
        is_guess: false,
    };
    Some(adjust(field, (size, &lens), std::iter::once(*camera), &frames)?[0])
}

/// Adjusts the base of some cameras and their views. None where a frame has too few observations,
/// or the base flees the field.
fn adjust(
    field: &FieldModel,
    (size, lens): (ImageSize, &TriedLens),
    cameras: impl Iterator<Item = PtzCamera> + Clone,
    frames: &[FrameClicks],
) -> Option<Vec<PtzCamera>> {
    /// 1-σ of a guessed principal point, px at 1920 px width: guesses lie .1 widths apart.
    const GUESS_PX: f64 = 80.0;
    let base = *cameras.clone().next()?.base();
    let clicks = CameraClicks {
        field,
        frames,
        image_size: size,
        principal_point: base.principal_point,
        pixel_aspect: base.distortion.pixel_aspect,
        own_cameras: &[],
    };
    let model = BaseModel {
        lens: LensModel::K1Focal,
        crown: CrownModel::Fixed(field.crown_m),
        principal_point: lens.is_guess.then_some(base.principal_point),
    };
    let mut options = AdjustOptions::default().with_lens(&lens.stated, size);
    if lens.is_guess {
        options.priors.principal_point_px = GUESS_PX;
    }
    let ptz: Vec<Option<Ptz>> = cameras.map(|camera| Some(camera.ptz())).collect();
    let adjusted = adjust_base(&clicks, &base, &ptz, &model, &options);
    let is_sane = adjusted.base.is_finite() && may_stand_at(adjusted.base.position_m, field);
    let with_base = |ptz: Option<Ptz>| Some(PtzCamera::new(adjusted.base, ptz?));
    is_sane.then(|| adjusted.ptz.into_iter().map(with_base).collect())?
}

/// Whether a camera may look at a court from a place, m.
fn may_stand_at(place_m: Vec3, field: &FieldModel) -> bool {
    /// Those of nine real courts stand .4 to 2.2 diagonals of the court from its middle, and are
    /// seen from there under 10 to 30 degrees.
    const FARTHEST_DIAGONALS: f64 = 5.0;
    const LOWEST: Angle = Angle::from_degrees(3.0);
    let distance_m = place_m.norm();
    distance_m <= FARTHEST_DIAGONALS * field.length_m.hypot(field.width_m)
        && place_m.z >= LOWEST.sin_cos().0 * distance_m
}
