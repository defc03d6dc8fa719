//! Plays the video, and goes to a frame number or a time.

use super::App;
use crate::app::window_state::place::FrameOrTime;
use crate::app::window_state::session::{Level, Mode};

impl App {
    /// Plays or pauses the video. At the end, starts from the first frame.
    pub(super) fn toggle_playing(&mut self) {
        let playing = !self.session.video.playing;
        let last = self
            .open
            .as_ref()
            .map_or(0, |open| open.document.frames.len().saturating_sub(1));
        if playing && self.session.frame == last {
            self.go_to(0);
        }
        self.session.video.playing = playing && self.session.mode == Mode::Idle;
    }

    /// Shows the frame with a number, or the one at a time of the shown frame's video. If there is
    /// none, the nearest.
    pub(super) fn go_to_place(&mut self, place: FrameOrTime) {
        let Some(open) = &self.open else { return };
        let frame = match place {
            FrameOrTime::Frame(wanted) => {
                // A document may have every n-th frame of a video only.
                let nearest = open
                    .frame_numbers_in_video(self.session.frame)
                    .min_by_key(|(_, number)| number.abs_diff(wanted));
                if let Some((_, number)) = nearest.filter(|(_, number)| *number != wanted) {
                    let text = format!("There is no frame {wanted}: the nearest one is {number}.");
                    self.session.notify(Level::Info, text);
                }
                nearest.map(|(position, _)| position)
            }
            // Only frames of the shown frame's video; if that has none, of any video.
            FrameOrTime::Time(wanted_s) => {
                let video = self.frame().and_then(|frame| frame.video.as_ref());
                let timed =
                    open.document
                        .frames
                        .iter()
                        .enumerate()
                        .filter_map(|(position, frame)| {
                            let of = frame
                                .video
                                .as_ref()
                                .filter(|of| video.is_none_or(|video| video.path == of.path))?;
                            Some((position, of.pts_s?))
                        });
                timed
                    .min_by(|(_, a), (_, b)| (a - wanted_s).abs().total_cmp(&(b - wanted_s).abs()))
                    .map(|(at, _)| at)
            }
        };
        self.session.dialog = None;
        match frame {
            Some(frame) => self.go_to(frame),
            None => self.session.notify(
                Level::Info,
                "These frames have no times: type the number of a frame.",
            ),
        }
    }
}
