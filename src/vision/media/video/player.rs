//! Seeking in a capture by frame index: reading on if the frame is near, a seek if it is far.

use super::{Capture, FrameClock, VideoInfo};
use crate::media::MediaError;

/// Maximum distance that is covered by reading on. A seek costs the frames since the last key frame
/// (100–175 frames apart in broadcast material) and flushing the decoder, about fifty frames on
/// average.
const READ_ON_FRAMES: usize = 48;
/// Maximum number of consecutive frames whose times fit no index.
const OFF_BEAT_FRAMES: usize = 16;

/// A capture and its position.
pub(super) struct Player {
    pub(super) capture: Box<dyn Capture>,
    /// Index of the last frame grabbed; `None` if unknown.
    pub(super) position: Option<usize>,
    /// Number of frames before the target at which a seek begins, so that a key frame lies between.
    pub(super) preroll: usize,
}

/// The result of reading on, by one frame or several.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ReadOutcome {
    /// The frame of this index.
    At(usize),
    /// A frame with a time that fits no index; of several, too many in a row.
    OffBeat,
    /// The end of the video.
    End,
}

impl Player {
    /// Makes `target` the last frame grabbed.
    pub(super) fn go_to(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        // Read on if the target is a little ahead; otherwise seek. A seek with a run-up costs the
        // run-up, so that reading on pays up to that distance; a run-up without end never seeks.
        let farthest = READ_ON_FRAMES.max(self.preroll);
        if self
            .position
            .is_none_or(|at| at > target || target - at > farthest)
        {
            self.jump_before(info, target)?;
        }
        let mut landed = self.read_on_to(info, target)?;
        if !matches!(landed, ReadOutcome::At(_)) {
            // In a video with irregular times, OpenCV counts the last frames after a seek as beyond
            // the stated number and withholds them; played from the start they appear.
            self.restart(info, target)?;
            landed = self.read_on_to(info, target)?;
        }
        match landed {
            ReadOutcome::At(landed) if landed == target => Ok(()),
            ReadOutcome::At(_) => Err(damaged_frame_error(info, target, "the decoder skips it")),
            ReadOutcome::OffBeat | ReadOutcome::End => Err(damaged_frame_error(
                info,
                target,
                "the decoder stops before it",
            )),
        }
    }

    /// Seeks to a frame and returns where that led: at or after the frame, if to a frame at all.
    pub(super) fn land_at(
        &mut self,
        info: &VideoInfo,
        target: usize,
    ) -> Result<ReadOutcome, MediaError> {
        let Some(target_s) = info.clock.pts_s(target) else {
            return Ok(ReadOutcome::End);
        };
        self.position = None;
        self.capture.jump_near(target_s);
        self.read_on_to(info, target)
    }

    /// Reads to the end and passes each frame to `look`; returns the index of the last one, or
    /// `None` if a frame's time fits no index.
    pub(super) fn read_to_the_end(
        &mut self,
        info: &VideoInfo,
        mut look: impl FnMut(&mut dyn Capture, usize),
    ) -> Result<Option<usize>, MediaError> {
        // The last index is recorded here, because the end of the video clears the position.
        let mut last = self.position;
        loop {
            match self.advance(info)? {
                ReadOutcome::At(index) => {
                    look(&mut *self.capture, index);
                    last = Some(index);
                }
                ReadOutcome::OffBeat => return Ok(None),
                ReadOutcome::End => return Ok(last),
            }
        }
    }

    /// Reads on until `target` or a frame after it.
    fn read_on_to(&mut self, info: &VideoInfo, target: usize) -> Result<ReadOutcome, MediaError> {
        // A single frame off the beat may be a remnant after a seek or a damaged part; several in a
        // row mean that the clock is wrong.
        let mut off_beat = 0;
        while off_beat < OFF_BEAT_FRAMES {
            if let Some(at) = self.position.filter(|&at| at >= target) {
                return Ok(ReadOutcome::At(at));
            }
            off_beat = match self.advance(info)? {
                ReadOutcome::At(_) => 0,
                ReadOutcome::OffBeat => off_beat + 1,
                ReadOutcome::End => return Ok(ReadOutcome::End),
            };
        }
        Ok(ReadOutcome::OffBeat)
    }

    /// Seeks to a frame at or before `target`. If the time stamp shows that it landed after it,
    /// starts twice as far back, and in the end at the very beginning.
    fn jump_before(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        // A run-up of `usize::MAX` (seeks do not reproduce the pictures) leaves no start, nor does
        // a target near the beginning: both go to the first frame, which is exact.
        let mut back = self.preroll;
        while let Some(start) = target.checked_sub(back).filter(|&start| start > 0) {
            self.position = None;
            if let Some(start_s) = info.clock.pts_s(start) {
                self.capture.jump_near(start_s);
                if matches!(self.advance(info)?, ReadOutcome::At(landed) if landed <= target) {
                    return Ok(());
                }
            }
            back = (2 * back).max(16);
        }
        self.restart(info, target)
    }

    /// Opens the file again and goes to its first frame.
    fn restart(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        self.capture.restart()?;
        self.position = None;
        if self.capture.grab()? {
            self.position = Some(0);
            Ok(())
        } else {
            Err(damaged_frame_error(
                info,
                target,
                "the first frame no longer decodes",
            ))
        }
    }

    /// Grabs the next frame and determines its index: by its time, or by counting if the time is
    /// unknown or goes back.
    fn advance(&mut self, info: &VideoInfo) -> Result<ReadOutcome, MediaError> {
        // The end and a failure of the reader leave no position, so that the next access seeks.
        let before = self.position.take();
        if !self.capture.grab()? {
            return Ok(ReadOutcome::End);
        }
        // Frames without a time of their own are counted. After a seek the position is unknown, and
        // such a frame has no index.
        let time_s = self
            .capture
            .time_s()
            .filter(|&time_s| !goes_back(&info.clock, before, time_s));
        self.position = match time_s {
            Some(time_s) => info.clock.index_at(time_s),
            None => before.map(|at| at + 1),
        };
        Ok(self.position.map_or(ReadOutcome::OffBeat, ReadOutcome::At))
    }
}

/// Whether a time is not later than that of the frame before it, in a video of irregular times. The
/// list has such a frame behind its predecessor, at another time than its own.
fn goes_back(clock: &FrameClock, before: Option<usize>, time_s: f64) -> bool {
    let FrameClock::Listed(times_s) = clock else {
        return false;
    };
    before
        .and_then(|at| times_s.get(at))
        .is_some_and(|&before_s| time_s <= before_s)
}

fn damaged_frame_error(info: &VideoInfo, index: usize, reason: &str) -> MediaError {
    MediaError::DamagedFrame {
        path: info.path.to_path_buf(),
        index,
        reason: reason.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::times_only::{TimesOnly, info, player};
    use super::*;

    #[test]
    fn a_reader_that_broke_down_is_started_again_by_the_next_access() {
        let info = VideoInfo {
            decoded_frames: 100,
            ..info()
        };
        let mut capture = TimesOnly::new(0..100);
        capture.breaks_at = Some(40);
        let mut player = player(capture, 0);
        player.go_to(&info, 30).unwrap();
        assert!(player.go_to(&info, 45).is_err());
        assert_eq!(player.position, None);
        player.go_to(&info, 45).unwrap();
        assert_eq!(player.position, Some(45));
    }
}
