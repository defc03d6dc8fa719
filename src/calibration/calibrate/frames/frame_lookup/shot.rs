//! How fast a camera usually moves: the solved frames of a shot and the speeds between them.

use super::sorted::Sorted;
use std::collections::BTreeMap;
use touchline_core::camera::Ptz;
use touchline_core::geometry::Angle;
use touchline_core::solve::{Motion, PtzStep};

/// Minimum number of moves between solved frames for a prior on how fast it moves.
pub(super) const MIN_MOVES: usize = 8;

/// Frames of the video farther apart than this say nothing about speed.
pub(super) const WITHIN_FRAMES: u64 = 50;

/// The time of a frame: its number in the video, then, among frames of equal number, its index in
/// the document.
pub(super) type Moment = (u64, usize);

/// A solved frame: its time, and pan, tilt and focal length.
type Solved<'a> = (&'a Moment, &'a Ptz);

/// The solved frames of a shot, and the speeds of the camera between consecutive ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Shot {
    solved: BTreeMap<Moment, Ptz>,
    /// Speed of pan (°), tilt (°) and log focal length per frame of the video, absolute values,
    /// each sorted.
    rates: [Sorted; 3],
}

impl Shot {
    pub(super) fn new(solved: BTreeMap<Moment, Ptz>) -> Self {
        let pairs = solved.iter().zip(solved.iter().skip(1));
        let moves: Vec<[f64; 3]> = pairs.filter_map(|(from, to)| rates(from, to)).collect();
        let rates = [0, 1, 2].map(|which| moves.iter().map(|rates| rates[which]).collect());
        Self { solved, rates }
    }

    pub(super) fn insert(&mut self, moment: Moment, ptz: Ptz) {
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

    pub(super) fn remove(&mut self, moment: Moment) {
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
    pub(super) fn motion(&self, moment: Moment) -> Option<Motion> {
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
        let [pan_deg, tilt_deg, log_focal] = [0, 1, 2].map(|which: usize| {
            let broken: Vec<f64> = broken.iter().map(|rates| rates[which]).collect();
            let made = made.map(|rates| rates[which]);
            self.rates[which].nth_of_changed(count * 9 / 10, &broken, made) * frames as f64
        });
        let usual = PtzStep {
            pan: Angle::from_degrees(pan_deg),
            tilt: Angle::from_degrees(tilt_deg),
            log_focal,
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
        // Frames of the same number may be there several times, for instance after a merge. They
        // are as near as can be, at a distance of 0.
        let number = moment.0;
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
            .filter_map(|at| Some((at, self.first_at(at, moment)?)));
        let (at, ptz) = found.min_by_key(|(at, _)| at.abs_diff(number))?;
        let frames = at.abs_diff(number).max(1);
        (frames <= WITHIN_FRAMES).then_some((ptz, frames))
    }

    /// The first of the solved frames with this number, which represents them, the frame of the
    /// moment itself excluded.
    fn first_at(&self, number: u64, moment: Moment) -> Option<Ptz> {
        let mut of_number = self.solved.range((number, 0)..=(number, usize::MAX));
        of_number
            .find(|(other, _)| **other != moment)
            .map(|(_, ptz)| *ptz)
    }
}

/// Change of pan (°), tilt (°) and log focal length per frame of the video between two consecutive
/// solved frames; none if these are more than [`WITHIN_FRAMES`] apart or have the same number.
pub(super) fn rates(
    (from, before): (&Moment, &Ptz),
    (to, after): (&Moment, &Ptz),
) -> Option<[f64; 3]> {
    // `to` is the later one in the order of the map, so the difference is not negative.
    let frames = to.0 - from.0;
    let step = PtzStep::between(before, after);
    let moved = [step.pan.degrees(), step.tilt.degrees(), step.log_focal];
    (1..=WITHIN_FRAMES)
        .contains(&frames)
        .then(|| moved.map(|moved| moved / frames as f64))
}
