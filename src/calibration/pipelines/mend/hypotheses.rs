//! Tests whether all given cameras are mirrored, lack a lens, or are meant for other frames of the
//! video.
//!
//! Each hypothesis is tested on the same sample of pictures. The cameras that follow from it are
//! placed on the common place and aligned to the painted lines. The hypothesis under which the most
//! frames can be aligned is the right one; among those with about as many, the one whose cameras
//! the alignment moves least.

use super::common_error::CommonError;
use super::given::{GivenCamera, mirror};
use super::places::{Shots, mirror_back, ptz_near_place, with_lens};
use super::{MendError, MendEvent};
use crate::calibrate::ground_moved_px;
use crate::proposals::PictureStream;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::camera::{FocalCurve, PtzCamera};
use touchline_core::geometry::{median, subsample};
use touchline_core::progress::Progress;
use touchline_core::solve::base::BasePriors;
use touchline_documents::document::{Document, Fields, Frame};
use touchline_vision::media::{Picture, ReadFrames};
use touchline_vision::paint::{GroundPicture, SnapOptions, snap};

/// Number of pictures in the sample.
const PICTURES: usize = 24;

/// A lens, and mirrored cameras, are considered if less than this share of the sample can be
/// aligned.
const DOUBTFUL: f64 = 0.5;

/// Of two hypotheses with about as many aligned frames (at least this share of the most), the one
/// that moves its cameras less is the right one.
const AS_MANY: f64 = 0.8;

/// Pictures of some frames.
pub(super) struct Sample {
    /// The frames' indices in the document.
    pictures: Vec<(usize, Picture)>,
}

impl Sample {
    /// Reads pictures of frames whose cameras are possible, evenly spread over those between which
    /// the given cameras move most: where a camera rests, a shift by a frame does not show.
    pub fn read(
        document: &Document,
        folder: &Path,
        shots: &Shots,
        given: &[GivenCamera],
        reader: &mut dyn ReadFrames,
        progress: &Progress<'_, MendEvent>,
    ) -> Result<Self, MendError> {
        let mut moving = motions_px(document, shots, given);
        moving.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        // The faster half, in the order of the video again, from which the sample is then spread
        // evenly: the fastest frames alone may all be in one turn of the camera.
        moving.truncate(moving.len().div_ceil(2).max(PICTURES));
        let mut fastest: Vec<usize> = moving.into_iter().map(|(_, index)| index).collect();
        fastest.sort_unstable();
        let chosen = subsample(fastest, PICTURES);
        let stream = PictureStream::new(document.at(folder), chosen)
            .with_reader(reader)
            .with_progress(progress.part(MendEvent::Sampling));
        // Pictures that cannot be read are left out of the sample: they say nothing for or against
        // a hypothesis.
        let pictures = stream
            .filter_map(|read| Some((read.index, read.picture.ok()?)))
            .collect();
        if progress.is_cancelled() {
            return Err(MendError::Stopped);
        }
        Ok(Self { pictures })
    }
}

/// How far the ground moves in the picture from each frame to the next of its shot, with the index
/// of the frame, where both have a possible camera and the shot has a place.
fn motions_px(document: &Document, shots: &Shots, given: &[GivenCamera]) -> Vec<(f64, usize)> {
    let with_place = shots.ranges.iter().zip(&shots.of_shot);
    // Within each shot: from one to the next the picture changes, and no camera moves.
    with_place
        .filter(|(_, place)| place.is_some())
        .flat_map(|(range, _)| range.start + 1..range.end)
        .filter_map(|next| {
            let index = next - 1;
            let camera = given.get(index)?.usable()?;
            let after = given.get(next)?.usable()?;
            let image_size = document.frames[index].image_size;
            Some((ground_moved_px(camera, after, image_size)?, index))
        })
        .collect()
}

/// What may be wrong with all given cameras alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Hypothesis {
    /// By how many frames they come later.
    shift: i64,
    /// They leave out a lens like that of most broadcast cameras.
    lacks_lens: bool,
    /// They are cameras of the mirrored field.
    is_mirrored: bool,
}

/// How well the cameras of a hypothesis agree with the sample.
#[derive(Clone, Copy, Debug)]
struct Agreement {
    /// Number of frames that could be aligned.
    aligned: usize,
    /// The median distance by which the alignment moved the ground, px; infinite without any.
    moved_px: f64,
}

/// The given cameras without the errors of a hypothesis.
pub(super) struct Corrected {
    /// The cameras.
    pub given: Vec<GivenCamera>,
    /// Where they stand; none where they agree on no place. Mirrored cameras stand at mirrored
    /// places.
    pub shots: Option<Shots>,
    /// The lens to begin with, where they leave out theirs.
    pub lens: Option<FocalCurve>,
}

/// Cameras to be tested on a sample of frames.
pub(super) struct Test<'a> {
    pub document: &'a Document,
    pub fields: &'a Fields,
    pub shots: &'a Shots,
    pub given: &'a [GivenCamera],
    pub sample: &'a Sample,
}

impl Test<'_> {
    /// The likeliest hypothesis, among these shifts (the most plausible first). Lens and mirror are
    /// considered only where few frames can be aligned without.
    pub fn likeliest(&self, shifts: &[i64]) -> (Vec<CommonError>, Corrected) {
        let enough = (DOUBTFUL * self.sample.pictures.len() as f64) as usize;
        let mut tried: Vec<(Hypothesis, Corrected, Agreement)> = Vec::new();
        // From the simplest hypothesis to the least likely one, all shifts of each. Further ones
        // are tried only as long as less than half of the sample can be aligned, because each
        // aligns the whole sample anew.
        for (lacks_lens, is_mirrored) in
            [(false, false), (true, false), (false, true), (true, true)]
        {
            if tried
                .iter()
                .any(|(.., agreement)| agreement.aligned >= enough)
            {
                break;
            }
            for &shift in shifts {
                let hypothesis = Hypothesis {
                    shift,
                    lacks_lens,
                    is_mirrored,
                };
                let corrected = self.correct(hypothesis);
                let agreement = self.agreement(&corrected);
                tried.push((hypothesis, corrected, agreement));
            }
        }
        // A wrong hypothesis also aligns some frames, to lines beside the right ones, and moves its
        // cameras far for that. So the number decides roughly, and the distance among those that
        // are about equal.
        let most = tried.iter().map(|(.., agreement)| agreement.aligned).max();
        let least = (AS_MANY * most.unwrap_or(0) as f64).ceil() as usize;
        tried.retain(|(.., agreement)| agreement.aligned >= least);
        // Of equals the first one: the likeliest by the numbers, and not mirrored.
        let best = tried.into_iter().reduce(|best, other| {
            if other.2.moved_px < best.2.moved_px {
                other
            } else {
                best
            }
        });
        // The first shift is what the numbering says, so only another one is an error of the
        // cameras.
        let first_shift = shifts.first().copied().unwrap_or(0);
        // No shift was given to try: the cameras stay with the frames that they came with.
        let Some((best, corrected, _)) = best else {
            let as_given = Hypothesis {
                shift: first_shift,
                lacks_lens: false,
                is_mirrored: false,
            };
            return (Vec::new(), self.correct(as_given));
        };
        let mut errors = Vec::new();
        errors.extend(best.is_mirrored.then_some(CommonError::Mirrored));
        if best.shift != first_shift {
            errors.push(CommonError::Shifted(best.shift - first_shift));
        }
        (errors, corrected)
    }

    /// What a hypothesis makes of the given cameras.
    fn correct(&self, hypothesis: Hypothesis) -> Corrected {
        // If all are mirrored, their places are mirrored as well, so each is reflected. Otherwise
        // the places are right, and only cameras that stand at none of them may be mirrored.
        let given = if hypothesis.is_mirrored {
            self.given.iter().map(reflect).collect()
        } else {
            mirror_back(self.given, &self.shots.places)
        };
        let given = shift_frames(self.document, given, hypothesis.shift);
        Corrected {
            shots: Shots::new(self.document, self.shots.cuts.clone(), &given),
            lens: self.lens(hypothesis),
            given,
        }
    }

    /// The lens that a hypothesis adds.
    fn lens(&self, hypothesis: Hypothesis) -> Option<FocalCurve> {
        let size = self.document.frames.first()?.image_size;
        hypothesis
            .lacks_lens
            .then(|| BasePriors::default().usual_lens(size))
    }

    /// Aligns the sample's frames from corrected cameras, each on the place of its shot.
    fn agreement(&self, corrected: &Corrected) -> Agreement {
        let pictures = self.sample.pictures.par_iter();
        let mut moved: Vec<f64> = pictures
            .filter_map(|(index, picture)| self.moved_px(corrected, *index, picture))
            .collect();
        Agreement {
            aligned: moved.len(),
            moved_px: median(&mut moved).unwrap_or(f64::INFINITY),
        }
    }

    /// How far the alignment to paint moves the ground in a frame from its corrected camera, px.
    /// None if the frame has no camera or place, or cannot be aligned.
    fn moved_px(&self, corrected: &Corrected, index: usize, picture: &Picture) -> Option<f64> {
        let frame = &self.document.frames[index];
        let place = corrected.shots.as_ref()?.place_of(index)?;
        let base = with_lens(&place.base, corrected.lens);
        // Each given camera has a position of its own. On the common place it is turned and zoomed
        // until its ground lies where it was.
        let given = corrected.given[index].usable()?;
        let ptz = ptz_near_place(given, &base, frame.image_size)?;
        let ground = GroundPicture::new(picture, &self.document.masks_of(frame));
        let field = self.fields.for_frame(self.document, frame);
        let snapped = snap(
            &ground,
            field,
            &base,
            ptz,
            &[],
            &SnapOptions::for_unknown_lens(),
        )
        .ok()?;
        let [before, after] = [ptz, snapped.ptz].map(|ptz| PtzCamera::new(base, ptz));
        ground_moved_px(&before, &after, frame.image_size)
    }
}

/// A given camera mirrored.
fn reflect(given: &GivenCamera) -> GivenCamera {
    given.usable().map_or_else(
        || given.clone(),
        |camera| GivenCamera::Mirrored(Box::new(mirror(camera))),
    )
}

/// The given cameras where each belongs to the frame of the same video whose number is larger by
/// `shift`.
fn shift_frames(document: &Document, given: Vec<GivenCamera>, shift: i64) -> Vec<GivenCamera> {
    if shift == 0 {
        return given;
    }
    let by_number: BTreeMap<(&str, i64), usize> = document
        .frames
        .iter()
        .enumerate()
        .filter_map(|(index, frame)| Some((number(frame)?, index)))
        .collect();
    let frames = document.frames.iter();
    frames
        .map(|frame| {
            // A frame takes the camera that came with the frame `shift` numbers before it. Without
            // such a frame it has none.
            let source =
                number(frame).and_then(|(path, number)| by_number.get(&(path, number - shift)));
            source.map_or(GivenCamera::Missing, |index| given[*index].clone())
        })
        .collect()
}

/// The video of a frame and the frame's number in it.
fn number(frame: &Frame) -> Option<(&str, i64)> {
    let video = frame.video.as_ref()?;
    Some((video.path.as_str(), i64::try_from(video.frame_index).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn a_cut_is_no_motion_of_the_camera() {
        let base = base_at([2.0, -70.0, 18.0], SIZE);
        let mut document = soccer_document();
        let mut given = Vec::new();
        for number in 0..12 {
            // The second shot begins at another end of the field.
            let pan_deg = 0.2 * f64::from(number) + if number < 6 { 0.0 } else { 20.0 };
            let ptz = Ptz::from_degrees(pan_deg, -12.0, 2500.0);
            given.push(GivenCamera::Possible(Box::new(PtzCamera::new(base, ptz))));
            let frame = new_frame(&format!("{number}.jpg"), SIZE);
            document.frames.push(frame.into());
        }
        let shots = Shots::new(&document, vec![6], &given).unwrap();
        let moving = motions_px(&document, &shots, &given);
        let frames: Vec<usize> = moving.iter().map(|(_, index)| *index).collect();
        assert_eq!(frames, [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]);
        assert!(moving.iter().all(|(px, _)| *px < 20.0), "{moving:?}");
    }
}
