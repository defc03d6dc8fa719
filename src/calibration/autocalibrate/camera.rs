//! A document's camera found without a click: its frames looked at, the bases that explain their paint, and the best of these
//! asked of every frame's own picture.

use super::candidates::{Candidate, RUNNER_UP_RATIO, SAME_POSITION_M, ViewGraph, find_candidates};
use super::clicked::GroundClick;
use super::deciding::deciding_landmark;
use super::error::Stop;
use super::evidence::missing_lines;
use super::field_prior::FieldPrior;
use super::held::Held;
use super::matched_frames::MatchedFrames;
use super::place::Place;
use super::refined::{Refined, without_labels};
use super::traces::{FrameTraces, PictureOfFrame};
use super::{Abstention, Doubt, UnclickedAnswer, UnclickedError, UnclickedProgress, WatchUnclicked};
use crate::calibrate::{UnclickedCamera, UnclickedFrame, record_found, snap_frame};
use rayon::prelude::*;
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImageSize;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{CameraId, DocumentAt, FrameStatus};
use touchline_vision::media::Picture;
use touchline_vision::paint::SnapOptions;

/// At least this share of the frames has to agree with the painted lines of its own picture. Right answers had .9 and more on
/// real and drawn matches, wrong ones .5 and less.
const MIN_SNAPPED: f64 = 0.75;

/// So many have to agree before the last adjustment, which brings a place that is nearly right to its lines.
const MIN_BEFORE: f64 = 0.5;

/// With a rival that explains nearly as much, this share has to agree with the one and at most that with the other.
const OVER_REFUTED: f64 = 0.85;
const REFUTED: f64 = 0.65;

/// Landmarks of the ground without which no place is named.
const FEWEST_CLICKS: usize = 2;

/// A click farther from where the camera has its landmark contradicts it, px at 1920 px width.
const CONTRADICTING_PX: f64 = 25.0;

/// Pictures that are held in memory together.
const AT_ONCE: usize = 8;

/// Finds a camera of a document from its frames' pictures alone; clicks are not read. `look_at` frames at most are looked at,
/// spread over all of them; each is asked for by `picture` up to twice.
///
/// # Errors
/// The search was stopped, the field cannot be had, or OpenCV is missing or refused. That no answer is certain is no error but
/// [`UnclickedAnswer::Abstained`].
pub fn camera_without_clicks(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    watch: WatchUnclicked<'_>,
) -> Result<UnclickedAnswer, UnclickedError> {
    answered((document, camera), false, look_at, picture, watch)
}

/// The same where a person has clicked two landmarks of the ground or more, in one frame or in several: they say where the camera
/// stands, and nothing is searched. Everything is asked of the answer that is asked of one without a click, and that the clicks
/// agree with it.
///
/// # Errors
/// As [`camera_without_clicks`].
pub fn camera_from_few_clicks(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    watch: WatchUnclicked<'_>,
) -> Result<UnclickedAnswer, UnclickedError> {
    answered((document, camera), true, look_at, picture, watch)
}

/// The answer of a search, by clicks or without.
fn answered(
    (document, camera): (DocumentAt<'_>, &CameraId),
    by_clicks: bool,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    watch: WatchUnclicked<'_>,
) -> Result<UnclickedAnswer, UnclickedError> {
    let field_prior = FieldPrior::from_document(document, camera)?;
    match (Search { document, camera, field_prior: &field_prior, by_clicks, watch }).answer(look_at, picture) {
        Ok(answer) => Ok(answer),
        Err(Stop::Abstained(why)) => Ok(UnclickedAnswer::Abstained(why)),
        Err(Stop::Failed(error)) => Err(error),
    }
}

struct Search<'a> {
    document: DocumentAt<'a>,
    camera: &'a CameraId,
    field_prior: &'a FieldPrior,
    /// Clicks say where the camera stands.
    by_clicks: bool,
    watch: WatchUnclicked<'a>,
}

impl Search<'_> {
    fn told(&self, progress: UnclickedProgress) -> Result<(), Stop> {
        if (self.watch)(progress).is_break() { Err(UnclickedError::Stopped.into()) } else { Ok(()) }
    }

    fn answer(&self, look_at: usize, picture: PictureOfFrame<'_>) -> Result<UnclickedAnswer, Stop> {
        let spread = self.spread(look_at);
        // Fewer clicks name no place: no picture need be looked at.
        if self.by_clicks && self.clicks(&spread).len() < FEWEST_CLICKS {
            return Err(Abstention::NothingFits.into());
        }
        let (frames, traces) = self.look(&spread, picture)?;
        let matched = MatchedFrames::from_traces(&traces, self.watch)?;
        let of_group: Option<Vec<GroundClick>> = self.by_clicks.then(|| {
            let place = |click: &GroundClick| matched.indices.iter().position(|place| frames[*place] == click.frame);
            let in_group = |click: GroundClick| Some(GroundClick { frame: place(&click)?, ..click });
            self.clicks(&frames).into_iter().filter_map(in_group).collect()
        });
        let found = find_candidates(frames.len(), &matched, of_group.as_deref(), self.field_prior, self.watch)?;
        let mut places = found.into_iter();
        let best = places.next().ok_or(Abstention::NothingFits)?;
        let is_elsewhere = |other: &Candidate| {
            (other.base.position_m - best.base.position_m).norm() > SAME_POSITION_M && other.score() > 0.0
        };
        let rival = places.find(is_elsewhere);
        let rival_score = rival.as_ref().map_or(0.0, Candidate::score);
        // A rival with doubts of its own is none to an answer without.
        let is_rival = |rival: &Candidate| {
            best.score() < RUNNER_UP_RATIO * rival_score && (rival.doubts.is_empty() || !best.doubts.is_empty())
        };
        let other = rival.filter(is_rival);
        let doubts = best.doubts.clone();
        let mut best = Place::of(best, &frames);
        best.camera.evidence.rival = rival_score;
        // A line is looked for once more where the last adjustment has it: before, it may lie just beside its paint.
        if doubts.iter().any(|doubt| !matches!(doubt, Doubt::LinesMissing { .. })) {
            return Err(uncertain(doubts, best.camera));
        }
        let looked_at = LookedAt { frames: &frames, traces: &traces };
        let best = self.snapped(best, &frames, picture)?;
        let Some(other) = other else {
            return match few_snapped(&best.camera, MIN_BEFORE) {
                Some(doubt) => Err(uncertain(vec![doubt], best.camera)),
                None => self.found(best, looked_at, picture, MIN_SNAPPED),
            };
        };
        let is_doubted = !doubts.is_empty() || !other.doubts.is_empty();
        let mut other = Place::of(other, &frames);
        other.camera.evidence.rival = best.camera.evidence.score();
        let other = self.snapped(other, &frames, picture)?;
        // Both explain the paint about equally well: the one that the frames' own pictures contradict is the runner-up.
        let [best, other] = match few_snapped(&best.camera, MIN_BEFORE) {
            Some(doubt) if is_doubted || few_snapped(&other.camera, MIN_BEFORE).is_some() => {
                return Err(uncertain(vec![doubt], best.camera));
            }
            Some(_) => [other, best],
            None => [best, other],
        };
        // The frames' own pictures tell the two apart where nearly all agree with the one and few with the other.
        if snapped_share(&other.camera) <= REFUTED {
            return self.found(best, looked_at, picture, OVER_REFUTED);
        }
        // Two that become one where both are adjusted once more differed by the field's size only.
        let both = [self.refined(&best.camera, picture)?, self.refined(&other.camera, picture)?];
        let [best, other] = match both {
            [Some(of_best), Some(of_other)]
                if (of_best.position_m() - of_other.position_m()).norm() < SAME_POSITION_M =>
            {
                let best = self.settled(best, Some(of_best), &frames, picture)?;
                return self.judged(best, looked_at, OVER_REFUTED);
            }
            [of_best, of_other] => {
                [self.settled(best, of_best, &frames, picture)?, self.settled(other, of_other, &frames, picture)?]
            }
        };
        // Two that are left to a person to choose from have to be as good as one that refutes another.
        let doubt = |found| few_snapped(found, OVER_REFUTED).or_else(|| open_size(found));
        let mut doubts: Vec<Doubt> = [&best, &other].into_iter().filter_map(doubt).collect();
        if is_doubted || !doubts.is_empty() {
            doubts.insert(0, Doubt::Rival);
            return Err(uncertain(doubts, best));
        }
        let deciding = deciding_landmark(&self.document, &best, &other);
        Ok(UnclickedAnswer::Two { best: Box::new(best), other: Box::new(other), deciding })
    }

    /// The answer that is left: adjusted once more to what its frames' own pictures show.
    fn found(
        &self,
        found: Place,
        looked_at: LookedAt<'_>,
        picture: PictureOfFrame<'_>,
        least_snapped: f64,
    ) -> Result<UnclickedAnswer, Stop> {
        let Some(refined) = self.refined(&found.camera, picture)? else {
            return Err(uncertain(vec![Doubt::NotHeld], found.camera));
        };
        let mut settled = self.settled(found.clone(), Some(refined), looked_at.frames, picture)?;
        if few_snapped(&settled, least_snapped).is_some() {
            // The frames that already lay on their paint may have drawn the principal point away from where the others have it.
            let centred = BaseOptions { placing_frames: usize::MAX, ..BaseOptions::default() };
            if let Some(refined) = self.refined_by(&centred, &found.camera, picture)? {
                let other = self.settled(found, Some(refined), looked_at.frames, picture)?;
                settled = if other.snapped_count() > settled.snapped_count() { other } else { settled };
            }
        }
        self.judged(settled, looked_at, least_snapped)
    }

    /// A camera where it was adjusted once more, its frames pulled onto their paint from there; as it is where it was not.
    fn settled(
        &self,
        place: Place,
        refined: Option<Refined>,
        frames: &[usize],
        picture: PictureOfFrame<'_>,
    ) -> Result<UnclickedCamera, Stop> {
        let Some(refined) = refined else { return Ok(place.camera) };
        let size = self.size(frames, &place.view_graph);
        Ok(self.snapped(place.refined(refined, frames, size), frames, picture)?.camera)
    }

    /// The answer after its last adjustment, if enough of its frames agree with it, no line is missing and no click contradicts it.
    fn judged(
        &self,
        mut found: UnclickedCamera,
        looked_at: LookedAt<'_>,
        least_snapped: f64,
    ) -> Result<UnclickedAnswer, Stop> {
        found.evidence.missing = looked_at.missing_lines(&found);
        let missing = || {
            let lines = &found.evidence.missing;
            (!lines.is_empty()).then(|| Doubt::LinesMissing { lines: lines.clone() })
        };
        let contradicted = || self.contradicted(&found);
        match few_snapped(&found, least_snapped).or_else(missing).or_else(contradicted) {
            Some(doubt) => Err(uncertain(vec![doubt], found)),
            None => Ok(UnclickedAnswer::Found(Box::new(found))),
        }
    }

    /// A camera adjusted once more to its frames' own pictures. The field's size is fitted where that is open, even where the usual one
    /// explained as much: this adjustment sees decimetres of it.
    fn refined(&self, found: &UnclickedCamera, picture: PictureOfFrame<'_>) -> Result<Option<Refined>, Stop> {
        self.refined_by(&BaseOptions::default(), found, picture)
    }

    fn refined_by(
        &self,
        options: &BaseOptions,
        found: &UnclickedCamera,
        picture: PictureOfFrame<'_>,
    ) -> Result<Option<Refined>, Stop> {
        self.told(UnclickedProgress::Refining)?;
        let sized = self.field_prior.is_size_unknown();
        Refined::of((found, sized), options, (self.document, self.camera), picture, self.watch)
    }

    /// The clicks that say where the camera stands.
    fn clicks(&self, frames: &[usize]) -> Vec<GroundClick> {
        if self.by_clicks {
            GroundClick::of(&self.document.frames, frames, &self.field_prior.assumed)
        } else {
            Vec::new()
        }
    }

    /// The doubt about a camera that a click contradicts.
    fn contradicted(&self, found: &UnclickedCamera) -> Option<Doubt> {
        let indices: Vec<usize> = found.frames.iter().map(|frame| frame.index).collect();
        let off = |click: &GroundClick| {
            let of_found = found.frames.iter().find(|frame| frame.index == click.frame)?;
            let at_m = found.field.landmark_in_world(found.field.landmark(click.landmark.as_str())?);
            let seen = PtzCamera::new(found.base, of_found.ptz).image_from_world(at_m);
            let off_px = seen.map_or(f64::INFINITY, |seen| seen.distance_px(click.image));
            let frame = &self.document.frames[click.frame];
            (off_px > CONTRADICTING_PX * frame.image_size.scale_from_1920()).then(|| Doubt::ClickContradicts {
                landmark: click.landmark.as_str().to_owned(),
                frame: frame.name(),
                off_px,
            })
        };
        self.clicks(&indices).iter().find_map(off)
    }

    /// The frames that are looked at: of the camera, spread evenly, and those with clicks where these are read.
    fn spread(&self, look_at: usize) -> Vec<usize> {
        let frames = self.document.frames.iter().enumerate();
        let usable = frames.filter(|(_, frame)| frame.camera == *self.camera && frame.status != FrameStatus::Rejected);
        let of_camera: Vec<usize> = usable.map(|(index, _)| index).collect();
        let count = look_at.min(of_camera.len());
        let spread = (0..count).map(|place| of_camera[place * of_camera.len() / count]);
        let clicked = self.clicks(&of_camera).into_iter().map(|click| click.frame);
        spread.chain(clicked).collect::<BTreeSet<usize>>().into_iter().collect()
    }

    /// What is kept of the frames' pictures, and which frames could be read.
    fn look(&self, frames: &[usize], picture: PictureOfFrame<'_>) -> Result<(Vec<usize>, Vec<FrameTraces>), Stop> {
        let (mut read, mut traces) = (Vec::new(), Vec::new());
        for (chunk, some) in frames.chunks(AT_ONCE).enumerate() {
            self.told(UnclickedProgress::Looking { done: chunk * AT_ONCE, of: frames.len() })?;
            let pictures = pictures_of(some, picture);
            let of_picture = |(index, picture): &(usize, Picture)| {
                FrameTraces::of(picture, &self.document.masks_of(&self.document.frames[*index]))
            };
            let some: Result<Vec<_>, _> = pictures.par_iter().map(of_picture).collect();
            traces.extend(some.map_err(UnclickedError::from)?);
            read.extend(pictures.iter().map(|(index, _)| *index));
        }
        Ok((read, traces))
    }

    /// A camera's frames: held by their neighbours, pulled onto the paint of their own pictures, and held by that in turn. Those
    /// that stay uncertain go. `frames` are the places of those looked at.
    fn snapped(&self, place: Place, frames: &[usize], picture: PictureOfFrame<'_>) -> Result<Place, Stop> {
        let Place { camera: mut found, view_graph } = place;
        let size = self.size(frames, &view_graph);
        let Some(held) = Held::of(&found.base, &view_graph, &view_graph.paint_priors, size) else {
            return Ok(Place { camera: found, view_graph });
        };
        found.frames = held.frames(&view_graph, frames);
        let mut document = without_labels(self.document.document, self.camera);
        record_found(&mut document, self.camera, &found);
        let (of, field) = (found.frames.len(), &found.field);
        for (chunk, some) in found.frames.chunks_mut(AT_ONCE).enumerate() {
            self.told(UnclickedProgress::Snapping { done: chunk * AT_ONCE, of })?;
            let places: Vec<usize> = some.iter().map(|frame| frame.index).collect();
            let snapped = |(index, picture): &(usize, Picture)| {
                let snapped =
                    snap_frame(&document, &document.frames[*index], field, picture, &SnapOptions::default()).ok();
                (*index, snapped.map(|(_, snapped)| snapped))
            };
            let snapped: Vec<_> = pictures_of(&places, picture).par_iter().map(snapped).collect();
            for (index, snapped) in snapped {
                if let Some(frame) = some.iter_mut().find(|frame| frame.index == index) {
                    frame.snapped = snapped;
                }
            }
        }
        held.settle(&mut found, &view_graph);
        Ok(Place { camera: found, view_graph })
    }

    /// The size of the frames that hang together.
    fn size(&self, frames: &[usize], view_graph: &ViewGraph) -> ImageSize {
        let first = view_graph.indices.first().and_then(|place| frames.get(*place));
        first.map_or(ImageSize::new(0, 0), |index| self.document.frames[*index].image_size)
    }
}

/// The frames that were looked at, by their places in the document, with what was kept of each.
#[derive(Clone, Copy)]
struct LookedAt<'a> {
    frames: &'a [usize],
    traces: &'a [FrameTraces],
}

impl LookedAt<'_> {
    /// The lines of the field that a camera should show in its frames and does not, by name.
    fn missing_lines(&self, found: &UnclickedCamera) -> Vec<String> {
        let looking = |frame: &UnclickedFrame| {
            let place = self.frames.iter().position(|index| *index == frame.index)?;
            Some((PtzCamera::new(found.base, frame.ptz), &self.traces[place].strokes))
        };
        missing_lines(&found.field, &found.frames.iter().filter_map(looking).collect::<Vec<_>>())
    }
}

/// No answer, for what speaks against the best one.
fn uncertain(doubts: Vec<Doubt>, best: UnclickedCamera) -> Stop {
    Abstention::Uncertain { doubts, best: Some(Box::new(best)) }.into()
}

/// The share of the frames that agree with their own paint, of those that show enough of it.
fn snapped_share(found: &UnclickedCamera) -> f64 {
    found.snapped_count() as f64 / found.evidence.frames.max(1) as f64
}

/// The doubt about a camera with which fewer than a share of its frames agree.
fn few_snapped(found: &UnclickedCamera, least: f64) -> Option<Doubt> {
    let (snapped, frames) = (found.snapped_count(), found.evidence.frames);
    (snapped_share(found) < least).then_some(Doubt::FewSnapped { snapped, frames })
}

/// The doubt about a camera whose frames do not show how large the field is: lines that they do not show, or the position itself, may
/// be metres off.
fn open_size(found: &UnclickedCamera) -> Option<Doubt> {
    let open = found.sizes.iter().find(|size| size.is_open)?;
    Some(Doubt::SizeOpen { name: open.name.clone(), value_m: open.value_m, sigma_m: open.sigma_m })
}

/// Some frames' pictures with their places; those that cannot be read are left out.
fn pictures_of(frames: &[usize], picture: PictureOfFrame<'_>) -> Vec<(usize, Picture)> {
    frames.iter().filter_map(|index| Some((*index, picture(*index)?))).collect()
}
