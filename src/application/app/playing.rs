//! The clock of a playing video: which frame is due at which time.

use super::OpenProject;

/// The speeds to choose from, as multiples of the video's own.
pub const SPEEDS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Assumed interval of frames without a time, s.
const UNKNOWN_SPACING_S: f64 = 0.04;

/// A clock that runs from the moment at which a frame was shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayClock {
    /// The time of the start, s, on the caller's clock.
    started_s: f64,
    /// The index of the frame shown at the start.
    from: usize,
    speed: f64,
    /// The index of the frame shown last.
    shown: usize,
}

impl PlayClock {
    /// Starts the clock with the frame that is shown now.
    pub const fn start(now_s: f64, frame: usize, speed: f64) -> Self {
        Self {
            started_s: now_s,
            from: frame,
            speed,
            shown: frame,
        }
    }

    /// Whether the clock still fits the shown frame and the speed. It does not after the user went
    /// to another frame.
    pub fn follows(&self, frame: usize, speed: f64) -> bool {
        self.shown == frame && self.speed == speed
    }

    /// The index of the frame to show now. `is_there` says whether a frame is decoded. The clock
    /// stops before the first frame that is not, and restarts from there, so that playback waits
    /// for the decoder and skips no frame for want of a picture.
    pub fn frame_at(
        &mut self,
        now_s: f64,
        open: &OpenProject,
        is_there: impl Fn(usize) -> bool,
    ) -> usize {
        let last = open.document.frames.len().saturating_sub(1);
        // Several frames may be due since the last call: all but the last of them are skipped.
        while self.shown < last && self.next_due_s(open) <= now_s {
            let next = self.shown + 1;
            if !is_there(next) {
                *self = Self::start(now_s, self.shown, self.speed);
                break;
            }
            // Each video has its own times, so that the clock goes on from the first frame of the
            // next one.
            if !is_same_video(open, self.shown, next) {
                *self = Self::start(self.next_due_s(open), next, self.speed);
            }
            self.shown = next;
        }
        self.shown
    }

    /// The time until the next frame is due, s.
    pub fn until_next_s(&self, now_s: f64, open: &OpenProject) -> f64 {
        (self.next_due_s(open) - now_s).max(0.0)
    }

    /// When the frame after the shown one is due, s, on the caller's clock.
    fn next_due_s(&self, open: &OpenProject) -> f64 {
        let next = self.shown + 1;
        let next_s = if is_same_video(open, self.shown, next) {
            time_s(open, next)
        } else {
            time_s(open, self.shown) + UNKNOWN_SPACING_S
        };
        self.started_s + (next_s - time_s(open, self.from)) / self.speed
    }
}

/// The last frame that was due some time before another one of its video, s; the first of the video
/// where there is none.
pub fn frame_earlier(open: &OpenProject, frame: usize, by_s: f64) -> usize {
    let at_s = time_s(open, frame) - by_s;
    let before = (0..frame).rev();
    let of_video = before.take_while(|at| is_same_video(open, *at, frame));
    let mut first = frame;
    for at in of_video {
        first = at;
        if time_s(open, at) <= at_s {
            break;
        }
    }
    first
}

/// Whether two frames are of the same video, or both of none.
fn is_same_video(open: &OpenProject, one: usize, other: usize) -> bool {
    let [one, other] = [one, other].map(|at| open.frame(at)?.video_path());
    one == other
}

/// The time of a frame, s from the start of its own video.
fn time_s(open: &OpenProject, frame: usize) -> f64 {
    let known = open
        .frame(frame)
        .and_then(|frame| frame.video.as_ref()?.pts_s);
    known.unwrap_or(frame as f64 * UNKNOWN_SPACING_S)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Frame, VideoFrame};
    use touchline_documents::testing::soccer_document;

    fn open() -> OpenProject {
        let mut document = soccer_document();
        // 25 frames per second, with a gap of one second after frame 4.
        for index in 0..10_u64 {
            let time = index as f64 / 25.0 + if index > 4 { 1.0 } else { 0.0 };
            let video = VideoFrame::new("match.mp4", index, Some(time));
            document
                .frames
                .push(Frame::from_video(video, "main".into(), ImageSize::new(64, 36)).into());
        }
        OpenProject::with_document(document)
    }

    #[test]
    fn frames_come_at_the_rate_of_the_video() {
        let open = open();
        let mut clock = PlayClock::start(100.0, 1, 1.0);
        assert_eq!(clock.frame_at(100.03, &open, |_| true), 1);
        assert!((clock.until_next_s(100.03, &open) - 0.01).abs() < 1e-9);
        assert_eq!(clock.frame_at(100.09, &open, |_| true), 3);
        assert_eq!(
            clock.frame_at(100.9, &open, |_| true),
            4,
            "the next one is a second away"
        );
        assert_eq!(clock.frame_at(200.0, &open, |_| true), 9, "the end");
        let mut slow = PlayClock::start(0.0, 0, 0.5);
        assert_eq!(slow.frame_at(0.13, &open, |_| true), 1);
    }

    #[test]
    fn the_next_video_is_played_at_its_own_rate() {
        let mut open = open();
        for index in 0..10_u64 {
            let video = VideoFrame::new("second.mp4", index, Some(index as f64 / 25.0));
            let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
            open.document.frames.push(frame.into());
        }
        let mut clock = PlayClock::start(100.0, 8, 1.0);
        assert_eq!(clock.frame_at(100.05, &open, |_| true), 9);
        assert!((clock.until_next_s(100.05, &open) - 0.03).abs() < 1e-9);
        assert_eq!(clock.frame_at(100.09, &open, |_| true), 10);
        assert_eq!(
            clock.frame_at(100.11, &open, |_| true),
            10,
            "its times begin at zero again"
        );
        assert_eq!(clock.frame_at(100.17, &open, |_| true), 12);
    }

    #[test]
    fn the_clock_waits_for_what_is_not_decoded() {
        let open = open();
        let mut clock = PlayClock::start(0.0, 0, 1.0);
        assert_eq!(clock.frame_at(0.121, &open, |frame| frame < 2), 1);
        assert!(clock.follows(1, 1.0) && !clock.follows(2, 1.0) && !clock.follows(1, 2.0));
        assert_eq!(
            clock.frame_at(0.13, &open, |_| true),
            1,
            "it was started again at 0.121 s"
        );
        assert_eq!(clock.frame_at(0.17, &open, |_| true), 2);
    }
}
