//! A capture moved to a frame by its number: reading forward where that is near, jumping where it
//! is far.

use super::VideoInfo;
use super::backend::{VideoBackend, open_capture};
use super::capture::Capture;
use crate::media::MediaError;

/// The farthest frame ahead that is reached by reading on. A jump costs the frames from the key
/// frame before the target (100–175 frames apart in broadcast material) and the emptying of the
/// decoder, about fifty frames on average.
const READ_ON_FRAMES: usize = 48;
/// After so many frames in a row whose times fit no number, the next ones are not waited for.
const OFF_BEAT_FRAMES: usize = 16;

/// A capture and where it stands.
pub(super) struct Player {
    pub(super) capture: Box<dyn Capture>,
    /// What the video is opened with again.
    pub(super) backend: VideoBackend,
    /// The number of the frame grabbed last; none where that is not known.
    pub(super) position: Option<usize>,
    /// How many frames before its target a jump begins, so that a key frame lies between.
    pub(super) preroll: usize,
}

/// Where reading on led.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Landed {
    /// To the frame of this number.
    At(usize),
    /// To frames whose times fit no number.
    OffBeat,
    /// To the end.
    End,
}

/// What the next frame was.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Advance {
    /// The frame of this number.
    To(usize),
    /// A frame whose time fits no number.
    OffBeat,
    /// There was none.
    End,
}

impl Player {
    /// Makes `target` the frame that was grabbed last.
    pub(super) fn go_to(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        let farthest = READ_ON_FRAMES.max(self.preroll);
        if self
            .position
            .is_none_or(|at| at > target || target - at > farthest)
        {
            self.jump_before(info, target)?;
        }
        let mut landed = self.read_on_to(info, target)?;
        if !matches!(landed, Landed::At(_)) {
            // After a jump in a video of uneven frame times, OpenCV takes the last frames for lying
            // behind the stated number of frames and holds them back. Played from the start they
            // come.
            self.restart(info, target)?;
            landed = self.read_on_to(info, target)?;
        }
        match landed {
            Landed::At(landed) if landed == target => Ok(()),
            Landed::At(_) => Err(damaged(info, target, "the decoder skips it")),
            Landed::OffBeat | Landed::End => {
                Err(damaged(info, target, "the decoder stops before it"))
            }
        }
    }

    /// Jumps to a frame and says where that led: at or behind the frame, if to a frame at all.
    pub(super) fn land_at(
        &mut self,
        info: &VideoInfo,
        target: usize,
    ) -> Result<Landed, MediaError> {
        let Some(target_s) = info.clock.pts_s(target) else {
            return Ok(Landed::End);
        };
        self.position = None;
        self.capture.jump_near(target_s);
        self.read_on_to(info, target)
    }

    /// Reads on to the end and lets each frame be looked at: the number of the last one. None when
    /// a frame's time fits no number.
    pub(super) fn read_to_the_end(
        &mut self,
        info: &VideoInfo,
        mut look: impl FnMut(&mut dyn Capture, usize),
    ) -> Result<Option<usize>, MediaError> {
        let mut last = self.position;
        loop {
            match self.advance(info)? {
                Advance::To(index) => {
                    look(&mut *self.capture, index);
                    last = Some(index);
                }
                Advance::OffBeat => return Ok(None),
                Advance::End => return Ok(last),
            }
        }
    }

    /// Reads on until `target` or a frame behind it.
    fn read_on_to(&mut self, info: &VideoInfo, target: usize) -> Result<Landed, MediaError> {
        let mut off_beat = 0;
        while off_beat < OFF_BEAT_FRAMES {
            if let Some(at) = self.position.filter(|&at| at >= target) {
                return Ok(Landed::At(at));
            }
            off_beat = match self.advance(info)? {
                Advance::To(_) => 0,
                Advance::OffBeat => off_beat + 1,
                Advance::End => return Ok(Landed::End),
            };
        }
        Ok(Landed::OffBeat)
    }

    /// Jumps to a frame at or before `target`, farther back as long as the time stamps say that it
    /// came out behind, and to the very start at last.
    fn jump_before(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        let mut back = self.preroll;
        while let Some(start) = target.checked_sub(back).filter(|&start| start > 0) {
            self.position = None;
            if let Some(start_s) = info.clock.pts_s(start) {
                self.capture.jump_near(start_s);
                if matches!(self.advance(info)?, Advance::To(landed) if landed <= target) {
                    return Ok(());
                }
            }
            back = (2 * back).max(16);
        }
        self.restart(info, target)
    }

    /// Opens the file again and goes to its first frame.
    fn restart(&mut self, info: &VideoInfo, target: usize) -> Result<(), MediaError> {
        self.capture = open_capture(&info.path, self.backend)?;
        self.position = None;
        if self.capture.grab()? {
            self.position = Some(0);
            Ok(())
        } else {
            Err(damaged(info, target, "the first frame no longer decodes"))
        }
    }

    /// Grabs the next frame and finds its number: by its time, or by counting on where the reader
    /// does not know it.
    fn advance(&mut self, info: &VideoInfo) -> Result<Advance, MediaError> {
        if !self.capture.grab()? {
            self.position = None;
            return Ok(Advance::End);
        }
        let counted = self.position.map(|at| at + 1);
        self.position = self
            .capture
            .time_s()
            .map_or(counted, |time_s| info.clock.index_at(time_s));
        Ok(self.position.map_or(Advance::OffBeat, Advance::To))
    }
}

fn damaged(info: &VideoInfo, index: usize, reason: &str) -> MediaError {
    MediaError::DamagedFrame {
        path: info.path.to_path_buf(),
        index,
        reason: reason.to_owned(),
    }
}
