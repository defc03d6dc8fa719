//! Where each camera of a document usually looks and how fast it moves, updated incrementally.
//!
//! Every solve needs both as a prior. Computing them from all frames each time would make solving a
//! document quadratic in its length. The lookup therefore keeps, for each camera, the sorted values
//! of its accepted frames and which frames have clicks; for each shot, the solved frames in the
//! order of the video and the sorted speeds between them. A changed frame changes a few entries of
//! these lists, and a prior that leaves one frame out is read off them without a copy.

use super::BaseReadiness;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, Directions};
use touchline_core::solve::{Motion, MotionPrior, PtzRanges, PtzStep};
use touchline_documents::document::{
    CameraId, Clip, Document, Frame, FrameChanges, FramePtz, FrameStatus, Frames,
};

/// Minimum number of accepted frames for a prior on where a camera looks.
const MIN_ACCEPTED: usize = 5;

/// Minimum number of moves between solved frames for a prior on how fast it moves.
const MIN_MOVES: usize = 8;

/// Frames of the video farther apart than this say nothing about speed.
const WITHIN_FRAMES: u64 = 50;

/// Priors of a document's cameras. It is valid for the document that it was built from or last
/// updated with; an update takes time only for frames that have changed.
#[derive(Clone, Debug, Default)]
pub struct FrameLookup {
    /// The frames as of the last update, by their index in the document.
    frames: Frames,
    accepted: BTreeMap<CameraId, Accepted>,
    shots: BTreeMap<ShotKey, Shot>,
    clicked: BTreeMap<CameraId, Clicked>,
}

/// The frames of a camera that have clicks, and what all its frames contribute to its base.
#[derive(Clone, Debug, Default)]
struct Clicked {
    places: BTreeSet<usize>,
    readiness: BaseReadiness,
}

/// Solved frames with the same key form one sequence.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ShotKey {
    camera: CameraId,
    clip: Option<Clip>,
    video: String,
}

impl FrameLookup {
    /// Builds the lookup of a document.
    #[must_use]
    pub fn of(document: &Document) -> Self {
        let mut accepted: BTreeMap<CameraId, Vec<Ptz>> = BTreeMap::new();
        let mut shots: BTreeMap<ShotKey, BTreeMap<Moment, Ptz>> = BTreeMap::new();
        let mut clicked: BTreeMap<CameraId, Clicked> = BTreeMap::new();
        for (index, frame) in document.frames.iter().enumerate() {
            if let Some(ptz) = accepted_ptz(frame) {
                accepted.entry(frame.camera.clone()).or_default().push(ptz);
            }
            if let Some((key, number, ptz)) = solved_in_shot(frame) {
                shots.entry(key).or_default().insert((number, index), ptz);
            }
            // A frame without clicks also counts if it was excluded from the base.
            let readiness = BaseReadiness::of_frame(frame);
            if !frame.clicks.is_empty() || readiness != BaseReadiness::default() {
                let of_camera = clicked.entry(frame.camera.clone()).or_default();
                of_camera.readiness += readiness;
                if !frame.clicks.is_empty() {
                    of_camera.places.insert(index);
                }
            }
        }
        Self {
            clicked,
            frames: document.frames.clone(),
            accepted: accepted
                .into_iter()
                .map(|(camera, all)| (camera, Accepted::of(&all)))
                .collect(),
            shots: shots
                .into_iter()
                .map(|(key, solved)| (key, Shot::of(solved)))
                .collect(),
        }
    }

    /// Updates the lookup after changes of the document. If frames were added, removed or
    /// reordered, it is built anew.
    pub fn update(&mut self, document: &Document) {
        let FrameChanges::At(changed) = document.frames.changes_since(&self.frames) else {
            *self = Self::of(document);
            return;
        };
        let before = std::mem::replace(&mut self.frames, document.frames.clone());
        for index in changed {
            self.replace(index, &before[index], &document.frames[index]);
        }
    }

    fn replace(&mut self, index: usize, before: &Frame, frame: &Frame) {
        // Clicks and readiness, also if the frame has moved to another camera.
        let clicked = [before, frame].map(|frame| {
            (
                &frame.camera,
                !frame.clicks.is_empty(),
                BaseReadiness::of_frame(frame),
            )
        });
        if clicked[0] != clicked[1] {
            let [(camera, _, readiness), added] = clicked;
            let of_camera = self.clicked.entry(camera.clone()).or_default();
            of_camera.places.remove(&index);
            of_camera.readiness -= readiness;
            let (camera, has_clicks, readiness) = added;
            let of_camera = self.clicked.entry(camera.clone()).or_default();
            of_camera.readiness += readiness;
            if has_clicks {
                of_camera.places.insert(index);
            }
        }
        // Accepted cameras. Within one camera, removal and insertion are one change, so that the
        // gaps of pan are recomputed once.
        let accepted = [before, frame].map(|frame| Some((&frame.camera, accepted_ptz(frame)?)));
        if accepted[0] != accepted[1] {
            let same_camera = before.camera == frame.camera;
            let [removed, added] = accepted.map(|accepted| accepted.map(|(_, ptz)| ptz));
            if same_camera {
                self.accepted
                    .entry(frame.camera.clone())
                    .or_default()
                    .change(removed, added);
            } else {
                self.accepted
                    .entry(before.camera.clone())
                    .or_default()
                    .change(removed, None);
                self.accepted
                    .entry(frame.camera.clone())
                    .or_default()
                    .change(None, added);
            }
        }
        // The solved frames of a shot, and the speeds beside the change.
        let solved = [before, frame].map(solved_in_shot);
        if solved[0] != solved[1] {
            let [removed, added] = solved;
            if let Some((key, number, _)) = removed {
                self.shots.entry(key).or_default().remove((number, index));
            }
            if let Some((key, number, ptz)) = added {
                self.shots
                    .entry(key)
                    .or_default()
                    .insert((number, index), ptz);
            }
        }
    }

    /// The indices of a camera's frames that have clicks, ascending.
    #[must_use]
    pub fn clicked(&self, camera: &CameraId) -> Vec<usize> {
        self.clicked
            .get(camera)
            .map(|clicked| clicked.places.iter().copied().collect())
            .unwrap_or_default()
    }

    /// Number of a camera's frames that have clicks.
    #[must_use]
    pub fn clicked_count(&self, camera: &CameraId) -> usize {
        self.clicked
            .get(camera)
            .map_or(0, |clicked| clicked.places.len())
    }

    /// What a camera's frames contribute to its base.
    #[must_use]
    pub fn readiness(&self, camera: &CameraId) -> BaseReadiness {
        self.clicked
            .get(camera)
            .map(|clicked| clicked.readiness)
            .unwrap_or_default()
    }

    /// The prior of a frame from all others: the ranges of its camera's accepted frames, and the
    /// nearest solved frame of its shot with the usual motion from there. Empty for an index that
    /// the document does not have.
    ///
    /// The frame itself is excluded; otherwise a wrong solution would confirm itself when it is
    /// solved again.
    #[must_use]
    pub fn prior(&self, index: usize) -> MotionPrior {
        let Some(frame) = self.frames.get(index) else {
            return MotionPrior::default();
        };
        let seen = self
            .accepted
            .get(&frame.camera)
            .and_then(|accepted| accepted.without(accepted_ptz(frame)));
        let motion =
            shot_of(frame).and_then(|(key, number)| self.shots.get(&key)?.motion((number, index)));
        MotionPrior { seen, motion }
    }
}

/// Pan, tilt and focal length of an accepted frame.
fn accepted_ptz(frame: &Frame) -> Option<Ptz> {
    frame
        .ptz
        .as_ref()
        .filter(|_| frame.status == FrameStatus::Reference)
        .map(FramePtz::ptz)
}

/// The shot of a frame of a video, and its frame number there.
fn shot_of(frame: &Frame) -> Option<(ShotKey, u64)> {
    let video = frame.video.as_ref()?;
    let key = ShotKey {
        camera: frame.camera.clone(),
        clip: frame.clip.clone(),
        video: video.path.clone(),
    };
    Some((key, video.frame_index))
}

/// The shot, frame number, and pan, tilt and focal length of a solved frame of a video.
fn solved_in_shot(frame: &Frame) -> Option<(ShotKey, u64, Ptz)> {
    let ptz = frame
        .ptz
        .as_ref()
        .filter(|_| frame.status != FrameStatus::Rejected && frame.vouches())?
        .ptz();
    let (key, number) = shot_of(frame)?;
    Some((key, number, ptz))
}

/// The values of a camera's accepted frames.
#[derive(Clone, Debug, Default)]
struct Accepted {
    pans: Directions,
    /// Tilts, rad.
    tilts: Sorted,
    /// Focal lengths, px.
    focals: Sorted,
}

impl Accepted {
    fn of(all: &[Ptz]) -> Self {
        Self {
            pans: all.iter().map(|ptz| ptz.pan).collect(),
            tilts: all.iter().map(|ptz| ptz.tilt.radians()).collect(),
            focals: all.iter().map(|ptz| ptz.focal_px).collect(),
        }
    }

    fn change(&mut self, removed: Option<Ptz>, added: Option<Ptz>) {
        self.pans
            .change(added.map(|ptz| ptz.pan), removed.map(|ptz| ptz.pan));
        if let Some(ptz) = removed {
            self.tilts.remove(ptz.tilt.radians());
            self.focals.remove(ptz.focal_px);
        }
        if let Some(ptz) = added {
            self.tilts.insert(ptz.tilt.radians());
            self.focals.insert(ptz.focal_px);
        }
    }

    /// The ranges of all values but those of `left_out`; none with fewer than [`MIN_ACCEPTED`] of
    /// them. Pans are cyclic: their range is the smallest arc that contains all.
    fn without(&self, left_out: Option<Ptz>) -> Option<PtzRanges> {
        if self.pans.len() - usize::from(left_out.is_some()) < MIN_ACCEPTED {
            return None;
        }
        let pan = match left_out {
            Some(ptz) => AngleRange::smallest_without(&self.pans, ptz.pan),
            None => AngleRange::smallest_of(&self.pans),
        }?;
        let [lowest, highest] = self
            .tilts
            .ends_without(left_out.map(|ptz| ptz.tilt.radians()))?;
        let [shortest, longest] = self.focals.ends_without(left_out.map(|ptz| ptz.focal_px))?;
        let tilt = Angle::from_radians(lowest)..=Angle::from_radians(highest);
        Some(PtzRanges {
            pan,
            tilt,
            focal_px: shortest..=longest,
        })
    }
}

/// The time of a frame: its number in the video, then, among frames of equal number, its index in
/// the document.
type Moment = (u64, usize);

/// A solved frame: its time, and pan, tilt and focal length.
type Solved<'a> = (&'a Moment, &'a Ptz);

/// The solved frames of a shot, and the speeds of the camera between consecutive ones.
#[derive(Clone, Debug, Default)]
struct Shot {
    solved: BTreeMap<Moment, Ptz>,
    /// Speed of pan (°), tilt (°) and log focal length per frame of the video, absolute values,
    /// each sorted.
    rates: [Sorted; 3],
}

impl Shot {
    fn of(solved: BTreeMap<Moment, Ptz>) -> Self {
        let pairs = solved.iter().zip(solved.iter().skip(1));
        let moves: Vec<[f64; 3]> = pairs.filter_map(|(from, to)| rates(from, to)).collect();
        let rates = [0, 1, 2].map(|which| moves.iter().map(|rates| rates[which]).collect());
        Self { solved, rates }
    }

    fn insert(&mut self, moment: Moment, ptz: Ptz) {
        // A new frame splits one move into two.
        let (before, after) = self.beside(moment);
        let at = (&moment, &ptz);
        let broken = before.zip(after).and_then(|(from, to)| rates(from, to));
        let made = [
            before.and_then(|from| rates(from, at)),
            after.and_then(|to| rates(at, to)),
        ];
        self.change(made.into_iter().flatten(), broken);
        self.solved.insert(moment, ptz);
    }

    fn remove(&mut self, moment: Moment) {
        let Some(ptz) = self.solved.remove(&moment) else {
            return;
        };
        // A removed frame joins two moves into one.
        let (before, after) = self.beside(moment);
        let at = (&moment, &ptz);
        let made = before.zip(after).and_then(|(from, to)| rates(from, to));
        let broken = [
            before.and_then(|from| rates(from, at)),
            after.and_then(|to| rates(at, to)),
        ];
        self.change(made, broken.into_iter().flatten());
    }

    fn change(
        &mut self,
        made: impl IntoIterator<Item = [f64; 3]>,
        broken: impl IntoIterator<Item = [f64; 3]>,
    ) {
        for moved in broken {
            self.rates
                .iter_mut()
                .zip(moved)
                .for_each(|(rates, moved)| rates.remove(moved));
        }
        for moved in made {
            self.rates
                .iter_mut()
                .zip(moved)
                .for_each(|(rates, moved)| rates.insert(moved));
        }
    }

    /// The solved frames directly before and after a moment, that of the moment itself excluded.
    fn beside(&self, moment: Moment) -> (Option<Solved<'_>>, Option<Solved<'_>>) {
        use std::ops::Bound::{Excluded, Unbounded};
        (
            self.solved.range(..moment).next_back(),
            self.solved.range((Excluded(moment), Unbounded)).next(),
        )
    }

    /// The solved frame nearest to a moment, and how far the camera usually moves from there,
    /// without the frame of the moment itself.
    ///
    /// The speeds are not copied to leave that frame out. At most two moves end at it, and one
    /// joins its neighbours instead; the quantile accounts for these three.
    fn motion(&self, moment: Moment) -> Option<Motion> {
        let (before, after) = self.beside(moment);
        let (mut broken, mut made) = (Vec::new(), None);
        if let Some(ptz) = self.solved.get(&moment) {
            let at = (&moment, ptz);
            broken.extend(before.and_then(|from| rates(from, at)));
            broken.extend(after.and_then(|to| rates(at, to)));
            made = before.zip(after).and_then(|(from, to)| rates(from, to));
        }
        // The number of moves without the frame.
        let count = self.rates[0].len() + usize::from(made.is_some()) - broken.len();
        if count < MIN_MOVES {
            return None;
        }
        let (from, frames) = self.nearest(moment)?;
        // The 90th percentile of the speeds, times the number of frames. It assumes that the camera
        // keeps one direction, so it is an upper estimate of the motion.
        let usual = |which: usize| {
            let broken: Vec<f64> = broken.iter().map(|rates| rates[which]).collect();
            let made = made.map(|rates| rates[which]);
            self.rates[which].nth_of_changed(count * 9 / 10, &broken, made) * frames as f64
        };
        let usual = PtzStep {
            pan: Angle::from_degrees(usual(0)),
            tilt: Angle::from_degrees(usual(1)),
            log_focal: usual(2),
        };
        Some(Motion {
            from,
            frames,
            usual,
        })
    }

    /// The solved frame nearest in the video, of two equally near ones the earlier, and its
    /// distance in frames, at least 1. None within [`WITHIN_FRAMES`].
    fn nearest(&self, moment: Moment) -> Option<(Ptz, u64)> {
        let number = moment.0;
        // Frames with the same number are represented by the first of them, the frame itself
        // excluded.
        let first_of = |at: u64| {
            let mut of_number = self.solved.range((at, 0)..=(at, usize::MAX));
            of_number
                .find(|(other, _)| **other != moment)
                .map(|(_, ptz)| *ptz)
        };
        let earlier = self
            .solved
            .range(..(number, 0))
            .next_back()
            .map(|(at, _)| at.0);
        let later = self
            .solved
            .range((number, usize::MAX)..)
            .map(|(at, _)| at.0)
            .find(|at| *at > number);
        let found = [earlier, Some(number), later]
            .into_iter()
            .flatten()
            .filter_map(|at| Some((at, first_of(at)?)));
        let (at, ptz) = found.min_by_key(|(at, _)| at.abs_diff(number))?;
        let frames = at.abs_diff(number).max(1);
        (frames <= WITHIN_FRAMES).then_some((ptz, frames))
    }
}

/// Change of pan (°), tilt (°) and log focal length per frame of the video between two consecutive
/// solved frames; none if these are more than [`WITHIN_FRAMES`] apart or have the same number.
fn rates((from, before): (&Moment, &Ptz), (to, after): (&Moment, &Ptz)) -> Option<[f64; 3]> {
    let frames = to.0 - from.0;
    let step = PtzStep::between(before, after);
    let moved = [step.pan.degrees(), step.tilt.degrees(), step.log_focal];
    (1..=WITHIN_FRAMES)
        .contains(&frames)
        .then(|| moved.map(|moved| moved / frames as f64))
}

/// Numbers in ascending order; equal ones are allowed.
#[derive(Clone, Debug, Default)]
struct Sorted(Vec<f64>);

impl FromIterator<f64> for Sorted {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_unstable_by(f64::total_cmp);
        Self(values)
    }
}

impl Sorted {
    const fn len(&self) -> usize {
        self.0.len()
    }

    fn insert(&mut self, value: f64) {
        let place = self
            .0
            .partition_point(|known| known.total_cmp(&value).is_lt());
        self.0.insert(place, value);
    }

    /// Removes one instance of a number; does nothing if it is not in the list.
    fn remove(&mut self, value: f64) {
        if let Ok(place) = self.0.binary_search_by(|known| known.total_cmp(&value)) {
            self.0.remove(place);
        }
    }

    /// The smallest and the largest number, with one instance of `left_out` excluded.
    fn ends_without(&self, left_out: Option<f64>) -> Option<[f64; 2]> {
        let is_left_out =
            |value: &f64| left_out.is_some_and(|left_out| left_out.total_cmp(value).is_eq());
        let least = self
            .0
            .get(usize::from(self.0.first().is_some_and(is_left_out)))?;
        let greatest = self
            .0
            .iter()
            .rev()
            .nth(usize::from(self.0.last().is_some_and(is_left_out)))?;
        Some([*least, *greatest])
    }

    /// The number at index `place` after removing at most two numbers and adding one, without
    /// changing the list. Zero if the index is out of range.
    fn nth_of_changed(&self, place: usize, removed: &[f64], added: Option<f64>) -> f64 {
        // The number of values below (`is_lt`) or not above (`is_le`) a value in the changed list.
        let rank = |value: f64, counts: fn(std::cmp::Ordering) -> bool| {
            let counts_value = |known: &f64| counts(known.total_cmp(&value));
            let before = self.0.partition_point(counts_value)
                + usize::from(added.as_ref().is_some_and(counts_value));
            before
                - removed
                    .iter()
                    .filter(|removed| counts_value(removed))
                    .count()
        };
        // The answer is the added value or an element of the list: that at index `place` − 1 if the
        // insertion shifted it up, or up to `place` + 2 if both removals shifted it down. It is the
        // one whose range of ranks contains `place`.
        let near = self.0.iter().skip(place.saturating_sub(1)).take(4);
        let found = near.copied().chain(added).find(|value| {
            let (below, upto) = (
                rank(*value, std::cmp::Ordering::is_lt),
                rank(*value, std::cmp::Ordering::is_le),
            );
            (below..upto).contains(&place)
        });
        found.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_documents::document::{Click, FieldSpec, Shared, VideoFrame};

    /// What the index keeps, looked up in all frames.
    fn looked_up(document: &Document, index: usize) -> MotionPrior {
        let frame = &document.frames[index];
        let others = || {
            let all = document.frames.iter().enumerate();
            all.filter(move |(other, candidate)| {
                *other != index && candidate.camera == frame.camera
            })
            .map(|(_, other)| &**other)
        };
        let accepted: Vec<Ptz> = others().filter_map(accepted_ptz).collect();
        let range = |of: fn(&Ptz) -> f64| {
            let values = accepted.iter().map(of);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, upto], value| {
                [from.min(value), upto.max(value)]
            })
        };
        let ([lowest, highest], [shortest, longest]) =
            (range(|ptz| ptz.tilt.radians()), range(|ptz| ptz.focal_px));
        let seen = (accepted.len() >= MIN_ACCEPTED).then(|| PtzRanges {
            pan: AngleRange::smallest(accepted.iter().map(|ptz| ptz.pan)).unwrap(),
            tilt: Angle::from_radians(lowest)..=Angle::from_radians(highest),
            focal_px: shortest..=longest,
        });
        MotionPrior {
            seen,
            motion: motion_looked_up(frame, others()),
        }
    }

    fn motion_looked_up<'a>(
        frame: &Frame,
        others: impl Iterator<Item = &'a Frame>,
    ) -> Option<Motion> {
        let (key, number) = shot_of(frame)?;
        let of_shot = others
            .filter_map(solved_in_shot)
            .filter(|(other, ..)| *other == key);
        let mut solved: Vec<(u64, Ptz)> = of_shot.map(|(_, number, ptz)| (number, ptz)).collect();
        solved.sort_by_key(|(number, _)| *number);
        let pairs = solved
            .windows(2)
            .map(|pair| (((pair[0].0, 0), pair[0].1), ((pair[1].0, 0), pair[1].1)));
        let moves: Vec<[f64; 3]> = pairs
            .filter_map(|(a, b)| rates((&a.0, &a.1), (&b.0, &b.1)))
            .collect();
        if moves.len() < MIN_MOVES {
            return None;
        }
        let (at, from) = *solved.iter().min_by_key(|(at, _)| at.abs_diff(number))?;
        let frames = at.abs_diff(number).max(1);
        let usual = [0, 1, 2].map(|which| {
            let mut moved: Vec<f64> = moves.iter().map(|moved| moved[which]).collect();
            moved.sort_by(f64::total_cmp);
            moved[moved.len() * 9 / 10] * frames as f64
        });
        let [pan, tilt] = [usual[0], usual[1]].map(Angle::from_degrees);
        (frames <= WITHIN_FRAMES).then_some(Motion {
            from,
            frames,
            usual: PtzStep {
                pan,
                tilt,
                log_focal: usual[2],
            },
        })
    }

    /// A frame of a camera and a video, perhaps solved. Few different values, so that many are
    /// equal.
    fn a_frame() -> impl Strategy<Value = Frame> {
        let video = prop_oneof![9 => Just(0_usize), 1 => Just(1)];
        let places = (0..2_usize, 0..2_i64, video, 0..40_u64);
        let ptz = proptest::option::weighted(0.8, (-6..6_i32, -3..0_i32, 0..4_i32));
        let status = prop_oneof![
            3 => Just(FrameStatus::Reference),
            2 => Just(FrameStatus::Draft),
            1 => Just(FrameStatus::Rejected),
        ];
        (places, ptz, status).prop_map(|((camera, clip, video, number), ptz, status)| {
            let video = VideoFrame::new(["a.mp4", "b.mp4"][video], number, None);
            let mut frame = Frame::from_video(
                video,
                ["main", "high"][camera].into(),
                ImageSize::new(64, 36),
            );
            frame.clip = Some(Clip::Number(clip));
            if number % 3 == 0 {
                frame.clicks.push(Click::landmark(
                    "centre_mark".into(),
                    ImagePoint::new(1.0, 1.0),
                ));
            }
            frame.status = status;
            frame.ptz = ptz.map(|(pan, tilt, focal)| {
                let [pan, tilt, focal] = [pan, tilt, focal].map(f64::from);
                FramePtz::new(
                    Ptz::from_degrees(30.0 * pan, 5.0 * tilt, 1000.0 + 100.0 * focal),
                    None,
                )
            });
            frame
        })
    }

    fn same_as_looked_up(index: &FrameLookup, document: &Document) -> Result<(), TestCaseError> {
        for place in 0..document.frames.len() {
            prop_assert_eq!(
                index.prior(place),
                looked_up(document, place),
                "frame {}",
                place
            );
        }
        prop_assert_eq!(index.prior(document.frames.len()), MotionPrior::default());
        for camera in ["main", "high"] {
            let of_camera = |place: &usize| document.frames[*place].camera == camera.into();
            let of_camera: Vec<usize> = (0..document.frames.len()).filter(of_camera).collect();
            let mut readiness = BaseReadiness::default();
            for &place in &of_camera {
                readiness += BaseReadiness::of_frame(&document.frames[place]);
            }
            prop_assert_eq!(index.readiness(&camera.into()), readiness);
            let has_clicks = |place: &usize| !document.frames[*place].clicks.is_empty();
            let places: Vec<usize> = of_camera.into_iter().filter(has_clicks).collect();
            prop_assert_eq!(index.clicked(&camera.into()), places);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_index_says_what_a_look_through_all_frames_says(
            frames in proptest::collection::vec(a_frame(), 1..120),
            edits in proptest::collection::vec((0..120_usize, a_frame()), 0..12),
        ) {
            let mut document = Document::new(FieldSpec::new("soccer"));
            document.frames.extend(frames.into_iter().map(Shared::new));
            let mut index = FrameLookup::of(&document);
            same_as_looked_up(&index, &document)?;
            for (place, frame) in edits {
                let place = place % document.frames.len();
                document.frames[place] = frame.into();
                index.update(&document);
            }
            same_as_looked_up(&index, &document)?;
            let last = document.frames.len() - 1;
            document.frames[last].status = FrameStatus::Reference;
            index.update(&document);
            same_as_looked_up(&index, &document)?;
            document.frames.remove(0);
            index.update(&document);
            same_as_looked_up(&index, &document)?;
        }
    }
}
