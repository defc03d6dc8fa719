//! How well solved frames agree with the motion of their neighbours.
//!
//! Three consecutive solved frames of a shot are compared by where their cameras project the
//! corners of the middle frame's picture. However fast the camera pans, the middle frame should lie
//! on the way between the other two.

use nalgebra::SVector;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Vec2, distance_from_segment};
use touchline_documents::document::{
    Camera, CameraId, Clip, Document, Frame, FrameChanges, FramePtz, FrameStatus, Frames, Shared,
};

/// Neighbours farther apart than this (frames) are not compared: in that time a camera can go
/// anywhere.
const MAX_FRAMES_APART: f64 = 50.0;

/// The displacement of a corner that another camera has behind it, px.
const BEHIND_PX: f64 = 20_000.0;

/// Position of a frame relative to the solved frames before and after it, px at 1920 px width: root
/// mean square over the corners of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Distance from the straight way between the two neighbours, at whatever point of it the frame
    /// is nearest.
    pub apart_px: f64,
    /// Length of that way.
    pub neighbours_px: f64,
}

/// Cameras that differ by less are identical, px at 1920 px width.
const STILL_PX: f64 = 0.1;

impl Disagreement {
    /// Whether the camera is exactly still from the frame before to the one after. An operator
    /// never holds a camera that still for long; if the picture moves meanwhile, the solutions
    /// follow something that is fixed on the screen.
    pub fn is_still(&self) -> bool {
        self.apart_px.max(self.neighbours_px) < STILL_PX
    }
}

/// The disagreement of every frame with its neighbours in time; none for a frame that is not solved
/// or that lacks a neighbour on one side in its shot.
pub fn disagreements(document: &Document) -> Vec<Option<Disagreement>> {
    Disagreements::from_document(document).found
}

/// The disagreements of a document's frames, updated incrementally: only frames that have changed,
/// and their neighbours, are compared again.
#[derive(Clone, Debug, Default)]
pub struct Disagreements {
    cameras: Vec<Shared<Camera>>,
    frames: Frames,
    /// The indices of the solved frames of each shot.
    shots: BTreeMap<ShotKey, BTreeSet<usize>>,
    found: Vec<Option<Disagreement>>,
    /// Number of changes so far.
    edition: u64,
    /// The frames of the last changes, in order; the last one belongs to `edition`.
    changed: Vec<usize>,
}

/// Maximum length of the list of changes; it is then cleared.
const REMEMBERED: usize = 10_000;

/// A camera and one of its shots; the frames of a camera without a shot form one.
type ShotKey = (CameraId, Option<Clip>);

impl Disagreements {
    /// The disagreements of a document.
    pub fn from_document(document: &Document) -> Self {
        Self::anew(document, 0)
    }

    /// The disagreement of a frame with its neighbours; none for a frame that is not solved or that
    /// lacks a neighbour on one side in its shot.
    pub fn for_frame(&self, index: usize) -> Option<Disagreement> {
        self.found.get(index).copied().flatten()
    }

    /// The indices of the solved frames of each shot, ascending.
    pub(super) fn shots(&self) -> impl Iterator<Item = &BTreeSet<usize>> {
        self.shots.values()
    }

    /// A counter that grows with every change of a disagreement.
    pub const fn edition(&self) -> u64 {
        self.edition
    }

    /// The frames whose disagreement has changed since an edition; none if that is too long ago.
    pub fn changes_since(&self, edition: u64) -> Option<&[usize]> {
        let changes = usize::try_from(self.edition.checked_sub(edition)?).ok()?;
        self.changed.get(self.changed.len().checked_sub(changes)?..)
    }

    /// Updates the disagreements after changes of the document. If a camera changed, or frames were
    /// added, removed or reordered, all are computed anew.
    pub fn update(&mut self, document: &Document) {
        let same_cameras = self.cameras.len() == document.cameras.len()
            && self
                .cameras
                .iter()
                .zip(&document.cameras)
                .all(|(known, camera)| known.is_same(camera));
        match document.frames.changes_since(&self.frames) {
            FrameChanges::At(changed) if same_cameras => self.change(document, &changed),
            _ => *self = Self::anew(document, self.edition + 1),
        }
    }

    fn anew(document: &Document, edition: u64) -> Self {
        let mut shots: BTreeMap<ShotKey, BTreeSet<usize>> = BTreeMap::new();
        for (index, frame) in document.frames.iter().enumerate() {
            if let Some(key) = shot_if_solved(frame) {
                shots.entry(key).or_default().insert(index);
            }
        }
        let threes: Vec<[usize; 3]> = shots
            .values()
            .flat_map(|shot| threes(shot.iter().copied()))
            .collect();
        // Comparisons are independent of each other; `par_iter` keeps their order.
        let compared: Vec<Option<Disagreement>> = threes
            .par_iter()
            .map(|three| compare(document, *three))
            .collect();
        let mut found = vec![None; document.frames.len()];
        for ([_, index, _], compared) in threes.into_iter().zip(compared) {
            found[index] = compared;
        }
        let (cameras, frames) = (document.cameras.clone(), document.frames.clone());
        Self {
            cameras,
            frames,
            shots,
            found,
            edition,
            changed: Vec::new(),
        }
    }

    fn change(&mut self, document: &Document, changed: &[usize]) {
        let before = std::mem::replace(&mut self.frames, document.frames.clone());
        // After this, `changes_since` returns none for older editions, and callers have to look at
        // all frames.
        if self.changed.len() >= REMEMBERED {
            self.changed.clear();
        }
        // A changed frame concerns itself and its neighbours, both in the shot that it left and in
        // the one that it joined.
        let mut concerned = BTreeSet::new();
        for &index in changed {
            concerned.insert(index);
            for frame in [&before[index], &document.frames[index]] {
                concerned.extend(self.beside(frame, index).into_iter().flatten());
            }
            if let Some(shot) =
                shot_if_solved(&before[index]).and_then(|key| self.shots.get_mut(&key))
            {
                shot.remove(&index);
            }
            if let Some(key) = shot_if_solved(&document.frames[index]) {
                self.shots.entry(key).or_default().insert(index);
            }
        }
        // Compare again once all shots are updated.
        for index in concerned {
            // A frame without neighbours on both sides has no disagreement.
            let three = match self.beside(&document.frames[index], index) {
                [Some(before), Some(after)] => Some([before, index, after]),
                _ => None,
            };
            let found = three.and_then(|three| compare(document, three));
            // Edition and list grow together, so that `changes_since` can count from the end.
            if found != self.found[index] {
                self.edition += 1;
                self.changed.push(index);
                self.found[index] = found;
            }
        }
    }

    /// The solved frames before and after an index in the shot of a frame; none for a frame that is
    /// not solved.
    fn beside(&self, frame: &Frame, index: usize) -> [Option<usize>; 2] {
        let Some(shot) = shot_if_solved(frame).and_then(|key| self.shots.get(&key)) else {
            return [None; 2];
        };
        [
            shot.range(..index).next_back().copied(),
            shot.range(index + 1..).next().copied(),
        ]
    }
}

/// Each index with the one before and the one after it.
fn threes(places: impl Iterator<Item = usize> + Clone) -> impl Iterator<Item = [usize; 3]> {
    let (after, last) = (places.clone().skip(1), places.clone().skip(2));
    places
        .zip(after)
        .zip(last)
        .map(|((before, index), after)| [before, index, after])
}

fn shot_if_solved(frame: &Frame) -> Option<ShotKey> {
    ptz_if_solved(frame).map(|_| (frame.camera.clone(), frame.clip.clone()))
}

fn ptz_if_solved(frame: &Frame) -> Option<Ptz> {
    frame
        .ptz
        .as_ref()
        .filter(|_| frame.status != FrameStatus::Rejected)
        .map(FramePtz::ptz)
}

/// The disagreement of the middle one of three solved frames; none if the outer two are more than
/// [`MAX_FRAMES_APART`] frames apart, or if it does not lie between them in time.
fn compare(document: &Document, [before, index, after]: [usize; 3]) -> Option<Disagreement> {
    let [from, frame, to] = [before, index, after].map(|place| &*document.frames[place]);
    let whole = frames_between(from, to)?;
    let part = frames_between(from, frame)?;
    // A document may list the frames of a video in any order.
    let is_between = (whole.min(0.0)..=whole.max(0.0)).contains(&part);
    if whole.abs() > MAX_FRAMES_APART || !is_between {
        return None;
    }
    let own = document.ptz_camera(frame)?;
    Some(disagreement(
        &own,
        ptz_if_solved(from)?,
        ptz_if_solved(to)?,
        frame.image_size,
    ))
}

/// Number of frames from one frame of a shot to another, negative if the document has them in
/// reverse order. None for stills and for names without a number: the order of a document's frames
/// says nothing about time.
fn frames_between(from: &Frame, to: &Frame) -> Option<f64> {
    let is_shot = from.video.is_some() || from.clip.is_some();
    from.moment().filter(|_| is_shot)?.frames_to(&to.moment()?)
}

/// The disagreement in R⁸, the displacements (x, y) of the four corners. In the middle frame's own
/// picture they are 0, so its distance from the way is that of the origin from a segment.
pub(crate) fn disagreement(
    own: &PtzCamera,
    from: Ptz,
    to: Ptz,
    image_size: ImageSize,
) -> Disagreement {
    let [from, to] =
        [from, to].map(|ptz| corners_off_px(own, &PtzCamera::new(*own.base(), ptz), image_size));
    let way = to - from;
    // Between neighbours the corners move along nearly straight lines.
    let apart = distance_from_segment(SVector::zeros(), [from, to]);
    // The norm over four corners is √4 times their root mean square; convert to 1920 px width.
    let scale = 0.5 / image_size.scale_from_1920();
    Disagreement {
        apart_px: scale * apart,
        neighbours_px: scale * way.norm(),
    }
}

/// The displacement (x, y) of each corner of a camera's picture as seen by another camera with the
/// same base, px.
fn corners_off_px(own: &PtzCamera, other: &PtzCamera, image_size: ImageSize) -> SVector<f64, 8> {
    let offsets = image_size.corners().map(|corner| {
        let seen = own
            .ray_from_image(corner)
            .ok()
            .and_then(|ray| other.image_from_ray(ray).ok());
        seen.map_or(Vec2::new(BEHIND_PX, 0.0), |seen| seen.offset_from(corner))
    });
    SVector::from_iterator(offsets.iter().flat_map(|offset| [offset.x, offset.y]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::{Clip, VideoFrame};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    /// A shot whose frames look at these pans.
    fn document(pans_deg: &[f64]) -> Document {
        let mut document = match_from(&base_at([0.0, -60.0, 18.0], SIZE), SIZE);
        for (number, &pan_deg) in pans_deg.iter().enumerate() {
            let name = format!("{number}.jpg");
            let mut frame = new_frame(&name, SIZE);
            frame.clip = Some(Clip::Number(1));
            frame.ptz = ptz_at(pan_deg, -10.0, 2000.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn a_pan_agrees_however_fast_and_a_jump_stands_out() {
        let mut document = document(&[0.0, 0.5, 1.5, 1.6, 2.0]);
        let pan = disagreements(&document);
        assert_eq!((pan[0], pan[4]), (None, None), "no neighbour on one side");
        assert!(
            pan[1..4].iter().all(|found| found.unwrap().apart_px < 0.5),
            "{pan:?}"
        );
        // A degree of pan at 2000 px is 35 px in the middle of the picture, more at its corners.
        assert!(
            (52.0..66.0).contains(&pan[1].unwrap().neighbours_px),
            "{pan:?}"
        );
        if let Some(ptz) = &mut document.frames[2].ptz {
            ptz.tilt_deg += 1.0;
        }
        let jump = disagreements(&document);
        assert!(
            (34.0..45.0).contains(&jump[2].unwrap().apart_px),
            "{jump:?}"
        );
        document.frames[2].ptz = ptz_at(170.0, -10.0, 2000.0);
        assert!(
            disagreements(&document)[2].unwrap().apart_px > 10_000.0,
            "it looks the other way"
        );
    }

    #[test]
    fn what_is_known_is_what_would_be_found_anew() {
        let mut document = document(&[0.0, 0.5, 1.5, 1.6, 2.0, 9.0, 2.5]);
        let mut known = Disagreements::default();
        let changes: [fn(&mut Document); 7] = [
            |document| document.frames[4].ptz.as_mut().unwrap().focal_px += 1.0,
            |document| document.frames[2].ptz.as_mut().unwrap().tilt_deg += 1.0,
            |document| document.frames[3].ptz = None,
            |document| {
                document.cameras[0]
                    .set_base(&base_at([0.0, -70.0, 9.0], ImagePoint::new(900.0, 500.0)));
            },
            |document| document.frames[1].clip = Some(Clip::Number(2)),
            |document| document.frames[1].clip = Some(Clip::Number(1)),
            |document| drop(document.frames.remove(4)),
        ];
        for change in changes {
            change(&mut document);
            let before = known.edition();
            known.update(&document);
            let found: Vec<_> = (0..document.frames.len())
                .map(|index| known.for_frame(index))
                .collect();
            assert_eq!(found, disagreements(&document));
            assert!(found.iter().any(Option::is_some) && known.edition() > before);
            let edition = known.edition();
            document.frames[0].comment = document.frames[0]
                .comment
                .is_none()
                .then(|| "rain".to_owned());
            known.update(&document);
            assert_eq!(known.edition(), edition, "a comment moves no camera");
        }
    }

    #[test]
    fn frames_far_apart_in_the_video_or_out_of_order_are_not_compared() {
        for numbers in [[0, 1, 900], [900, 1, 0], [0, 30, 20]] {
            let mut document = document(&[0.0, 9.0, -4.0]);
            for (frame, number) in document.frames.iter_mut().zip(numbers) {
                frame.video = Some(VideoFrame::new("match.mp4", number, None));
            }
            assert_eq!(disagreements(&document), [None; 3], "{numbers:?}");
        }
    }

    #[test]
    fn stills_have_no_neighbours_in_time() {
        let mut document = document(&[0.0, 9.0, -4.0]);
        assert!(disagreements(&document)[1].is_some());
        document
            .frames
            .iter_mut()
            .for_each(|frame| frame.clip = None);
        assert_eq!(disagreements(&document), [None; 3]);
    }

    #[test]
    fn only_solved_frames_of_the_shot_count() {
        let mut document = document(&[0.0, 0.5, 9.0, 1.5]);
        document.frames[2].ptz = None;
        assert!(disagreements(&document)[1].unwrap().apart_px < 0.5);
        document.frames[3].clip = Some(Clip::Number(2));
        assert_eq!(disagreements(&document), [None; 4]);
    }
}
