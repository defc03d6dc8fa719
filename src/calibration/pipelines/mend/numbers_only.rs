//! Given cameras put on their places by their numbers alone, where there is no picture to compare
//! them with.
//!
//! 1. Impossible cameras are recognized as with pictures. Each other camera goes to the place at
//!    which it stands, if it fits there (`by_frame.rs`); one that fits none stays as it came, as a
//!    draft.
//! 2. Smoothness. Only frames that follow each other in time are compared with each other
//!    (`clips_in_time.rs`). A frame whose camera lies farther from those of its neighbours than
//!    they lie apart loses it, the farthest first, until all agree.
//! 3. A frame between them that fits no place may be mirrored, or have been found from too narrow a
//!    view: it joins its neighbours if it is in line with them.
//! 4. Short gaps are interpolated.
//!
//! Each frame keeps the camera that it came with, and says how far and why it was moved. No claim
//! of a confidence follows from numbers: a stretch of frames that are wrong alike is smooth.

use super::by_frame::{FramePlaces, PlacedFrame};
use super::clips_in_time::{ClipInTime, Gap, OUT_OF_LINE_PX, apart_px};
use super::given::{GivenCamera, given_cameras, mirror};
use super::kept::{Move, keep_given};
use super::places::place_camera;
use super::{MendError, count_usable};
use crate::calibrate::{ptz_on_base, withdraw};
use std::collections::BTreeSet;
use std::path::Path;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::solve::UNSTATED_PX;
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::{
    Camera, CameraId, Document, Fields, FrameId, FramePtz, FrameStatus, Solution, SolutionSource,
};

/// A frame whose ground was moved by more is moved far, px at 1920 px width.
const FAR_PX: f64 = 20.0;

/// If more than this share of the frames was moved far, the cameras or their places are not what
/// they seem.
const MAX_SHARE_MOVED: f64 = 0.1;

/// What became of given cameras without pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MendedNumbers {
    /// Number of frames that came with a camera.
    pub came: usize,
    /// Number of impossible cameras among them.
    pub impossible: usize,
    /// Number of mirrored cameras among them.
    pub mirrored: usize,
    /// Number of cameras that are out of line with those of their neighbours.
    pub out_of_line: usize,
    /// Number of frames whose camera was interpolated.
    pub interpolated: usize,
    /// The places that the cameras share.
    pub places: Vec<SharedPlace>,
    /// The frames that are left for a person: without a camera, or with the one that they came
    /// with, which fits no place.
    pub left: Vec<LeftFrame>,
    /// The frames whose ground was moved by more than 20 px at 1920 px width, with that distance.
    pub moved_far: Vec<(FrameId, f64)>,
}

/// A frame that is left for a person.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftFrame {
    /// The frame.
    pub id: FrameId,
    /// Why.
    pub why: String,
}

impl MendedNumbers {
    /// Whether so many frames were moved far that a person should look at the list.
    pub fn has_moved_many(&self) -> bool {
        self.moved_far.len() as f64 > MAX_SHARE_MOVED * self.came as f64
    }
}

/// Mends the given cameras of a document without its pictures. Frames that people decided on keep
/// their cameras.
///
/// # Errors
/// There is nothing to mend, the cameras have no place in common, or the field of a camera is not
/// valid; the document is then unchanged.
pub fn mend_numbers(document: &mut Document, folder: &Path) -> Result<MendedNumbers, MendError> {
    let fields = Fields::from_document(document.at(folder))?;
    let given = given_cameras(document, &fields);
    let cameras = count_usable(&given)?;
    let FramePlaces { places, of_frame } = FramePlaces::from_given(document, &given);
    if places.is_empty() {
        return Err(MendError::NoPlace { cameras });
    }
    let mut mending = MendingNumbers {
        moves: vec![Move::None; given.len()],
        mended: document.clone(),
        before: document,
        given,
        of_frame,
    };
    mending.place_frames(&places);
    for clip in ClipInTime::all(&mending.mended) {
        mending.drop_out_of_line(&clip);
        mending.join_neighbours(&clip);
        mending.interpolate_gaps(&clip);
    }
    mending.keep_rest();
    let result = mending.finish(places);
    let mended = mending.mended;
    *document = mended;
    Ok(result)
}

/// The state while numbers are mended.
struct MendingNumbers<'a> {
    /// The document as it came.
    before: &'a Document,
    /// On a copy: an error leaves the document as it is.
    mended: Document,
    given: Vec<GivenCamera>,
    of_frame: Vec<Option<PlacedFrame>>,
    /// What was done with the camera of each frame.
    moves: Vec<Move>,
}

impl MendingNumbers<'_> {
    /// Gives each place one camera of the document, and the open frames that fit it their camera
    /// there. Impossible cameras are taken away.
    fn place_frames(&mut self, places: &[SharedPlace]) {
        for (place, shared) in places.iter().enumerate() {
            let is_here = |index: usize| {
                self.before.frames[index].is_open()
                    && self.of_frame[index].is_some_and(|at| at.place == place)
            };
            let Some(camera) = place_camera(&mut self.mended, shared, None, is_here) else {
                continue;
            };
            for index in shared
                .members
                .iter()
                .copied()
                .filter(|index| is_here(*index))
            {
                if let Some(at) = self.of_frame[index] {
                    let (ptz, source) = (at.on_base.ptz, SolutionSource::Import);
                    put(&mut self.mended, index, &camera, ptz, source);
                    self.moves[index] = Move::OntoPlace;
                }
            }
        }
        for (index, given) in self.given.iter().enumerate() {
            if given.fault().is_some() && self.before.frames[index].is_open() {
                withdraw(&mut self.mended.frames[index]);
            }
        }
    }

    /// Puts frames that fit no place on that of their neighbours in time, as they came, turned
    /// round, or mirrored: the first of these that is in line with them. One that is not loses its
    /// camera.
    fn join_neighbours(&mut self, clip: &ClipInTime) {
        let (given, of_frame, before) = (&self.given, &self.of_frame, self.before);
        let mended = &self.mended;
        let is_open = |index: usize| before.frames[index].is_open() && of_frame[index].is_none();
        let joining = clip.gaps(
            mended,
            |index| is_open(index) && given[index].usable().is_some(),
            |index| of_frame[index].is_some() && mended.frames[index].ptz.is_some(),
        );
        for (index, gap) in joining {
            let camera = self.mended.frames[gap.from].camera.clone();
            let base = self.mended.camera(&camera).and_then(Camera::base);
            let given = self.given[index].usable().copied();
            let (Some(base), Some(given)) = (base, given) else {
                continue;
            };
            let turned = given.after_half_turn();
            let ways = [
                (given, false),
                (turned, false),
                (mirror(&given), true),
                (mirror(&turned), true),
            ];
            let there = ways.map(|(way, is_mirrored)| {
                let (ptz, apart_px) = self.beside(index, gap, &base, &way)?;
                Some((ptz, apart_px, is_mirrored))
            });
            let mut in_line = there.into_iter().flatten();
            if let Some((ptz, _, is_mirrored)) =
                in_line.find(|(_, apart, _)| *apart <= OUT_OF_LINE_PX)
            {
                put(
                    &mut self.mended,
                    index,
                    &camera,
                    ptz,
                    SolutionSource::Import,
                );
                self.moves[index] = Move::OntoPlace;
                if is_mirrored {
                    self.given[index] = GivenCamera::Mirrored(Box::new(given));
                    self.moves[index] = Move::Mirrored;
                }
            } else {
                withdraw(&mut self.mended.frames[index]);
                let apart_px = there[0].map_or(f64::INFINITY, |(_, apart_px, _)| apart_px);
                self.moves[index] = Move::OutOfLine { apart_px };
            }
        }
    }

    /// A camera on the base of its neighbours, and how far it is out of line with them there.
    fn beside(
        &self,
        index: usize,
        gap: Gap,
        base: &CameraBase,
        camera: &PtzCamera,
    ) -> Option<(Ptz, f64)> {
        let ptz = ptz_on_base(camera, base, self.mended.frames[index].image_size)?.ptz;
        let apart_px = apart_px(&self.mended, &PtzCamera::new(*base, ptz), gap)?;
        Some((ptz, apart_px))
    }

    /// Takes away the cameras that are out of line with those of their neighbours.
    fn drop_out_of_line(&mut self, clip: &ClipInTime) {
        for &(index, apart_px) in &clip.out_of_line {
            withdraw(&mut self.mended.frames[index]);
            self.moves[index] = Move::OutOfLine { apart_px };
        }
    }

    /// Interpolates pan, tilt and the logarithm of the focal length over short gaps.
    fn interpolate_gaps(&mut self, clip: &ClipInTime) {
        let mended = &self.mended;
        let solved: BTreeSet<usize> = clip.solved_frames(mended).into_iter().collect();
        let is_missing = |index: usize| {
            let frame = &mended.frames[index];
            frame.ptz.is_none() && frame.is_open()
        };
        for (index, gap) in clip.gaps(mended, is_missing, |index| solved.contains(&index)) {
            let ends = [gap.from, gap.to].map(|end| self.mended.frames[end].ptz.as_ref());
            let [Some(from), Some(to)] = ends.map(|end| end.map(FramePtz::ptz)) else {
                continue;
            };
            if self.is_of_other_camera(index, gap) {
                continue;
            }
            let Some((share, [frames_before, frames_after])) = gap.share(&self.mended, index)
            else {
                continue;
            };
            // The camera is taken to move uniformly from one end of the gap to the other. By how
            // much it does not, the frames that have their neighbours beside them show: twice as
            // far, the deviation is four times as large.
            let camera = self.mended.frames[gap.from].camera.clone();
            let (ptz, source) = (from.interpolate(&to, share), SolutionSource::Interpolated);
            put(&mut self.mended, index, &camera, ptz, source);
            let sigma_px = clip.typical_px * frames_before * frames_after;
            let out_of_line_px = match self.moves[index] {
                Move::OutOfLine { apart_px } => Some(apart_px),
                _ => None,
            };
            self.moves[index] = Move::Interpolated {
                sigma_px,
                out_of_line_px,
            };
        }
    }

    /// Whether a frame that came without a camera is known to be of another one than a gap's ends.
    fn is_of_other_camera(&self, index: usize, gap: Gap) -> bool {
        let camera = &self.mended.frames[index].camera;
        let is_other = *camera != self.mended.frames[gap.from].camera;
        let mut frames = self.mended.frames.iter();
        self.given[index].is_missing()
            && is_other
            && frames.any(|frame| frame.camera == *camera && frame.ptz.is_some())
    }

    /// Leaves cameras that fit no place to a person, as they came.
    fn keep_rest(&mut self) {
        for (index, given) in self.given.iter().enumerate() {
            let frame = &mut self.mended.frames[index];
            let stays = self.of_frame[index].is_none() && self.moves[index] == Move::None;
            if stays && frame.is_open() && frame.ptz.is_some() && given.usable().is_some() {
                frame.status = FrameStatus::Draft;
                self.moves[index] = Move::FitsNoPlace;
            }
        }
        let used = self.mended.used_cameras();
        self.mended
            .cameras
            .retain(|camera| used.contains(&camera.id));
    }

    /// Records what came with each frame and what was done with it, and counts it.
    fn finish(&mut self, places: Vec<SharedPlace>) -> MendedNumbers {
        let mut result = MendedNumbers {
            came: self
                .given
                .iter()
                .filter(|given| !given.is_missing())
                .count(),
            impossible: count(&self.given, |given| given.fault().is_some()),
            mirrored: count(&self.given, GivenCamera::is_mirrored),
            places,
            ..MendedNumbers::default()
        };
        for (index, given) in self.given.iter().enumerate() {
            if !self.before.frames[index].is_open() {
                continue;
            }
            let how = self.moves[index];
            let moved_px = keep_given(&mut self.mended, self.before, index, given.fault(), how);
            if let Some(sigma_px) = how.sigma_px() {
                self.mended
                    .state_uncertainty(index, sigma_px.max(UNSTATED_PX));
            }
            let frame = &self.mended.frames[index];
            let id = &frame.id;
            result.out_of_line += usize::from(how.is_out_of_line());
            result.interpolated +=
                usize::from(frame.source() == Some(SolutionSource::Interpolated));
            if let Some(moved_px) = moved_px.filter(|moved_px| *moved_px > FAR_PX) {
                result.moved_far.push((id.clone(), moved_px));
            }
            if let Some(why) = how.why_left(given, frame.ptz.is_some()) {
                result.left.push(LeftFrame {
                    id: id.clone(),
                    why,
                });
            }
        }
        result
    }
}

fn count(given: &[GivenCamera], is_counted: impl Fn(&GivenCamera) -> bool) -> usize {
    given.iter().filter(|given| is_counted(given)).count()
}

/// Gives a frame a camera as a suggestion.
fn put(document: &mut Document, index: usize, camera: &CameraId, ptz: Ptz, source: SolutionSource) {
    let base = document.camera(camera).and_then(Camera::base);
    let lens = base.map(|base| base.distortion.radial_at(ptz.focal_px));
    let frame = &mut document.frames[index];
    frame.camera.clone_from(camera);
    frame.point(ptz, lens.unwrap_or_default());
    frame.status = FrameStatus::Suggested;
    let extra = frame.solution.take().map(|known| known.extra);
    frame.solution = Some(Solution {
        source: Some(source),
        extra: extra.unwrap_or_default(),
        ..Solution::default()
    });
}

#[cfg(test)]
mod tests;
