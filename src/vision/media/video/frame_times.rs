//! The number of a video's frames and their times.
//!
//! At a constant rate the number follows from the time of the last frame. Else the times come from
//! the sample table of an MP4, provided that sampled frames confirm it, or from decoding every
//! frame. The survey chooses among these.

use super::comb::{is_combed, may_be_interlaced};
use super::container::ContainerKind;
use super::player::{Player, ReadOutcome};
use super::sample_table::sample_times_s;
use super::{Capture, CountProgress, FrameClock, VideoInfo};
use crate::media::MediaError;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use touchline_core::progress::Progress;

/// Distance from the end at which the search for the last frame begins.
const TAIL_FRAMES: usize = 64;
/// A decoder keeps back at most this many frames to show them in order (H.264, annex A.3.1:
/// `MaxDpbFrames`).
const REORDERED_FRAMES: usize = 16;
/// Number of frames counted between two progress reports.
const COUNT_REPORT_FRAMES: usize = 100;
/// While the last frames are read to count them, every n-th is checked for interlacing artefacts.
const TAIL_LOOK_FRAMES: usize = 16;
/// Tolerance of times at a constant rate, s: floating-point rounding only.
pub(super) const EXACT_S: f64 = 2e-6;
/// Tolerance of times at a constant rate in a container that rounds to milliseconds, s.
pub(super) const ROUNDED_S: f64 = 6e-4;

/// The largest deviation of the known times from a clock, s.
pub(super) fn deviation_s(clock: &FrameClock, times_s: &[Option<f64>]) -> f64 {
    // Unknown times, as OpenCV has for the last frames, cannot deviate.
    let distances = times_s
        .iter()
        .enumerate()
        .filter_map(|(index, time_s)| Some(((*time_s)? - clock.pts_s(index)?).abs()));
    distances.fold(0.0, f64::max)
}

/// A clock from the times of all frames. Unknown times, and times that do not increase, follow
/// their predecessor at the stated rate; OpenCV does not know those of the last frames. The player
/// counts such frames as well.
pub(super) fn clock_from_times(times_s: &[Option<f64>], first_s: f64, fps: f64) -> FrameClock {
    let mut last_s = first_s - 1.0 / fps;
    let mut filled = Vec::with_capacity(times_s.len());
    for time_s in times_s {
        last_s = time_s
            .filter(|&time_s| time_s > last_s)
            .unwrap_or(last_s + 1.0 / fps);
        filled.push(last_s);
    }
    FrameClock::Listed(filled.into())
}

/// Whether the times go back for more frames than a decoder puts in order at a cut, as where
/// recordings were joined: a seek to a time may then lead to either part.
pub(super) fn times_go_back(clock: &FrameClock, times_s: &[Option<f64>]) -> bool {
    let replaced = times_s
        .iter()
        .enumerate()
        .filter(|(index, time_s)| time_s.is_some() && **time_s != clock.pts_s(*index));
    replaced.count() > REORDERED_FRAMES
}

/// The number of frames, from the index of the last one; `None` if the times do not fit one rate.
/// Bisects between an index that decodes and one that does not, then reads to the end. Adds to
/// `combed` the number of sampled frames that are interlaced.
pub(super) fn count_to_the_end(
    player: &mut Player,
    info: &VideoInfo,
    combed: &mut usize,
) -> Result<Option<usize>, MediaError> {
    // `good` decodes; `bad` does not, or is so near the end that its time is unknown.
    let mut good = info.decoded_frames - 1;
    let mut bad = info.stated_frames.max(good + 1);
    let mut probe = bad.saturating_sub(TAIL_FRAMES);
    // The first probe is near the stated end, which is usually right; bisection follows only if it
    // fails.
    while probe > good {
        match player.land_at(info, probe)? {
            ReadOutcome::At(landed) => good = landed,
            ReadOutcome::End => bad = probe,
            ReadOutcome::OffBeat => return Ok(None),
        }
        if bad.saturating_sub(good) <= 2 * TAIL_FRAMES {
            break;
        }
        probe = usize::midpoint(good, bad);
    }
    if player.go_to(info, good).is_err() {
        return Ok(None);
    }
    let mut read = 0;
    let last = player.read_to_the_end(info, |capture, index| {
        read += 1;
        let is_sampled = may_be_interlaced(info) && index.is_multiple_of(TAIL_LOOK_FRAMES);
        if is_sampled
            && capture
                .picture(index)
                .is_ok_and(|picture| is_combed(&picture))
        {
            *combed += 1;
        }
    })?;
    // A missing frame near the end, as in a truncated file, would shift the count of those after
    // it: the number read must equal the difference of the indices. Times that go back may even end
    // at a smaller index.
    Ok(last
        .filter(|&last| last.checked_sub(good) == Some(read))
        .map(|last| last + 1))
}

/// The times of an MP4's frames by its sample table, s. `None` if there is no usable table, or if
/// the first frames or those sampled later on do not have the times listed.
pub(super) fn verified_sample_times_s(
    path: &Path,
    kind: ContainerKind,
    lead_times_s: &[Option<f64>],
    player: &mut Player,
    info: &VideoInfo,
) -> Result<Option<Vec<f64>>, MediaError> {
    /// Number of frames sampled over the video. The last ones cannot be reached by a seek.
    const LOOKED_AT: usize = 4;
    let table = if kind == ContainerKind::Mp4 {
        sample_times_s(path)?
    } else {
        None
    };
    let Some(times_s) = table else {
        return Ok(None);
    };
    // The table may list frames that the decoder drops, or in another order. So the first frames
    // must have its times exactly, and seeks all over the video must land on a listed time.
    let clock = FrameClock::Listed(times_s.clone().into());
    let listed = VideoInfo {
        clock,
        decoded_frames: times_s.len(),
        ..info.clone()
    };
    let agree = deviation_s(&listed.clock, lead_times_s) <= EXACT_S
        && times_s.len() > lead_times_s.len()
        && (1..=LOOKED_AT).all(|place| {
            let index = place * (times_s.len() - 1) / (LOOKED_AT + 1);
            matches!(player.land_at(&listed, index), Ok(ReadOutcome::At(_)))
        });
    Ok(agree.then_some(times_s))
}

/// Whether frames come at an uneven rate. Where a file was cut off, some of the last frames lack
/// what they refer to and are missing: the number of frames says that already.
pub(super) fn is_uneven(info: &VideoInfo) -> bool {
    let FrameClock::Listed(times_s) = &info.clock else {
        return false;
    };
    let is_cut_off = info.decoded_frames < info.stated_frames;
    let before_cut = times_s
        .len()
        .saturating_sub(if is_cut_off { REORDERED_FRAMES } else { 0 });
    !times_s
        .iter()
        .enumerate()
        .take(before_cut)
        .all(|(index, time_s)| (time_s - times_s[0] - index as f64 / info.fps).abs() <= ROUNDED_S)
}

/// The time of every frame, by decoding all of them.
pub(super) fn play_through(
    mut capture: Box<dyn Capture>,
    counter: &Counter<'_>,
) -> Result<Vec<Option<f64>>, MediaError> {
    let mut times_s = Vec::new();
    while capture.grab()? {
        times_s.push(capture.time_s());
        counter.at(times_s.len())?;
    }
    Ok(times_s)
}

/// Reports the progress of a count at intervals.
pub(super) struct Counter<'a> {
    pub(super) path: Arc<Path>,
    pub(super) stated: usize,
    pub(super) progress: &'a Progress<'a, CountProgress>,
}

impl Counter<'_> {
    pub(super) fn at(&self, counted: usize) -> Result<(), MediaError> {
        if !counted.is_multiple_of(COUNT_REPORT_FRAMES) {
            return Ok(());
        }
        let step = CountProgress {
            path: Arc::clone(&self.path),
            counted,
            stated: self.stated,
        };
        match self.progress.report(step) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(MediaError::Stopped {
                path: self.path.to_path_buf(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::times_only::{TimesOnly, info, player};
    use super::*;

    #[test]
    fn a_last_frame_whose_time_goes_back_is_not_counted_by_its_time() {
        for (last, expected) in [(60, Some(61)), (10, None)] {
            let mut player = player(TimesOnly::new((0..60).chain([last])), 0);
            let counted = count_to_the_end(&mut player, &info(), &mut 0).unwrap();
            assert_eq!(counted, expected, "the last frame has the time of {last}");
        }
    }

    #[test]
    fn frames_of_joined_recordings_are_counted_where_their_times_begin_again() {
        let capture = TimesOnly::new((0..50).chain(0..70));
        let times_s: Vec<Option<f64>> = capture.times_s.iter().copied().map(Some).collect();
        let joined = VideoInfo {
            clock: clock_from_times(&times_s, 0.0, 25.0),
            decoded_frames: times_s.len(),
            ..info()
        };
        assert!(times_go_back(&joined.clock, &times_s));
        assert!(
            !times_go_back(&joined.clock, &times_s[..51]),
            "the last one alone"
        );
        let mut player = player(capture, usize::MAX);
        for index in [49, 50, 100, 20, 119, 60] {
            player.go_to(&joined, index).unwrap();
            let shown = player.capture.picture(index).unwrap().rgba()[0];
            assert_eq!(usize::from(shown), index + 1);
        }
    }
}
