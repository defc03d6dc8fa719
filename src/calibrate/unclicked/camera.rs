//! A document's camera found without a click: its frames looked at, the bases that explain their paint, and the best of these
//! asked of every frame's own picture.

use super::candidates::{Candidate, OVER_RIVAL, SAME_M, Stop, candidates};
use super::deciding::deciding_landmark;
use super::traces::FrameTraces;
use super::venue::Venue;
use super::{
    Abstention, Doubt, UnclickedAnswer, UnclickedCamera, UnclickedError, UnclickedFrame, UnclickedProgress,
    WatchUnclicked,
};
use crate::calibrate::snap_frame;
use crate::document::{CameraId, Document, DocumentAt, FrameStatus};
use crate::media::Picture;
use crate::paint::SnapOptions;
use rayon::prelude::*;

/// At least this share of the frames has to agree with the painted lines of its own picture. Right answers had .9 and more on
/// real and drawn matches, wrong ones .5 and less.
const MIN_SNAPPED: f64 = 0.75;

/// Pictures that are held in memory together.
const AT_ONCE: usize = 8;

/// The pictures of a document's frames, by their places in it; none where one cannot be read.
pub type PictureOfFrame<'a> = &'a mut dyn FnMut(usize) -> Option<Picture>;

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
    let venue = Venue::of(document, camera)?;
    let search = Search { document: document.document, camera, venue: &venue, watch };
    match search.answer(look_at, picture) {
        Ok(answer) => Ok(answer),
        Err(Stop::Abstained(why)) => Ok(UnclickedAnswer::Abstained(why)),
        Err(Stop::Failed(error)) => Err(error),
    }
}

struct Search<'a> {
    document: &'a Document,
    camera: &'a CameraId,
    venue: &'a Venue,
    watch: WatchUnclicked<'a>,
}

impl Search<'_> {
    fn told(&self, progress: UnclickedProgress) -> Result<(), Stop> {
        if (self.watch)(progress).is_break() { Err(UnclickedError::Stopped.into()) } else { Ok(()) }
    }

    fn answer(&self, look_at: usize, picture: PictureOfFrame<'_>) -> Result<UnclickedAnswer, Stop> {
        let (frames, traces) = self.look(&self.spread(look_at), picture)?;
        let found = candidates(&traces, self.venue, self.watch)?;
        let mut places = found.into_iter();
        let best = places.next().ok_or(Abstention::NothingFits)?;
        let is_elsewhere =
            |other: &Candidate| (other.base.position_m - best.base.position_m).norm() > SAME_M && other.score() > 0.0;
        let rival = places.find(is_elsewhere);
        let rival_score = rival.as_ref().map_or(0.0, Candidate::score);
        let rivalled = best.score() < OVER_RIVAL * rival_score;
        let other = rival.filter(|rival| rivalled && rival.doubts.is_empty());
        let mut doubts = best.doubts.clone();
        if rivalled && other.is_none() {
            doubts.push(Doubt::Rival);
        }
        if !doubts.is_empty() {
            return Err(Abstention::Uncertain { doubts }.into());
        }
        let mut best = self.snapped(best, &frames, picture)?;
        best.evidence.rival = rival_score;
        let Some(other) = other else {
            return match few_snapped(&best) {
                Some(doubt) => Err(Abstention::Uncertain { doubts: vec![doubt] }.into()),
                None => Ok(UnclickedAnswer::Found(Box::new(best))),
            };
        };
        let mut other = self.snapped(other, &frames, picture)?;
        other.evidence.rival = best.evidence.score();
        let few: Vec<Doubt> = [&best, &other].into_iter().filter_map(few_snapped).collect();
        if !few.is_empty() {
            // Where one of two is refuted only now, the search has not told them apart by itself.
            return Err(Abstention::Uncertain { doubts: [vec![Doubt::Rival], few].concat() }.into());
        }
        let deciding = deciding_landmark(self.document, &self.venue.assumed, &best, &other);
        Ok(UnclickedAnswer::Two { best: Box::new(best), other: Box::new(other), deciding })
    }

    /// The frames that are looked at: of the camera, spread evenly.
    fn spread(&self, look_at: usize) -> Vec<usize> {
        let frames = self.document.frames.iter().enumerate();
        let usable = frames.filter(|(_, frame)| frame.camera == *self.camera && frame.status != FrameStatus::Rejected);
        let of_camera: Vec<usize> = usable.map(|(index, _)| index).collect();
        let count = look_at.min(of_camera.len());
        (0..count).map(|place| of_camera[place * of_camera.len() / count]).collect()
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

    /// A candidate's frames pulled onto the paint of their own pictures. `frames` are the places of those looked at.
    fn snapped(
        &self,
        candidate: Candidate,
        frames: &[usize],
        picture: PictureOfFrame<'_>,
    ) -> Result<UnclickedCamera, Stop> {
        let pointed = frames.iter().zip(&candidate.ptz);
        let frames = pointed.filter_map(|(&index, ptz)| Some(UnclickedFrame { index, ptz: (*ptz)?, snapped: None }));
        let Candidate { base, field, sizes, evidence, .. } = candidate;
        let mut found = UnclickedCamera { base, crown_m: field.crown_m, sizes, frames: frames.collect(), evidence };
        // Snapping reads the clicks of a frame; here there are none.
        let mut document = self.document.clone();
        for frame in &found.frames {
            document.frames[frame.index].clicks.clear();
        }
        super::record_found(&mut document, self.camera, &found);
        let of = found.frames.len();
        for (chunk, some) in found.frames.chunks_mut(AT_ONCE).enumerate() {
            self.told(UnclickedProgress::Snapping { done: chunk * AT_ONCE, of })?;
            let places: Vec<usize> = some.iter().map(|frame| frame.index).collect();
            let snapped = |(index, picture): &(usize, Picture)| {
                let snapped =
                    snap_frame(&document, &document.frames[*index], &field, picture, &SnapOptions::default()).ok();
                (*index, snapped.map(|(_, snapped)| snapped))
            };
            let snapped: Vec<_> = pictures_of(&places, picture).par_iter().map(snapped).collect();
            for (index, snapped) in snapped {
                if let Some(frame) = some.iter_mut().find(|frame| frame.index == index) {
                    frame.snapped = snapped;
                }
            }
        }
        Ok(found)
    }
}

/// The doubt about a camera with which few frames agree.
fn few_snapped(found: &UnclickedCamera) -> Option<Doubt> {
    let (snapped, frames) = (found.snapped_count(), found.frames.len());
    ((snapped as f64) < MIN_SNAPPED * frames as f64).then_some(Doubt::FewSnapped { snapped, frames })
}

/// Some frames' pictures with their places; those that cannot be read are left out.
fn pictures_of(frames: &[usize], picture: PictureOfFrame<'_>) -> Vec<(usize, Picture)> {
    frames.iter().filter_map(|index| Some((*index, picture(*index)?))).collect()
}
