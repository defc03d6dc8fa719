//! Timecodes of video frames, drop-frame included (SMPTE ST 12-1).

use super::rate::Rate;
use std::fmt;

/// Hours, minutes, seconds and frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timecode {
    /// 0 to 23.
    pub hours: u64,
    /// 0 to 59.
    pub minutes: u64,
    /// 0 to 59.
    pub seconds: u64,
    /// Below the rate.
    pub frames: u64,
    /// Whether numbers are dropped so that the code keeps pace with the clock.
    pub is_drop_frame: bool,
}

/// The nominal frame rate by which timecodes count: 30 at 29.97.
fn nominal(rate: Rate) -> u64 {
    u64::from(rate.frames)
        .div_ceil(u64::from(rate.seconds))
        .max(1)
}

/// The number of dropped frame numbers per minute, except every tenth minute: 2 at 29.97, 4 at
/// 59.94; none at other rates.
fn drops_per_minute(rate: Rate) -> Option<u64> {
    let nominal = nominal(rate);
    // Two numbers in each of 54 minutes of an hour: 108 of 108,000, which is the lag of 30000/1001
    // behind 30 (SMPTE ST 12-1). 24000/1001 has no such code.
    (rate.seconds == 1001 && nominal.is_multiple_of(30)).then_some(nominal / 15)
}

impl Timecode {
    /// The timecode of a frame, counted from 0, of a video that begins at `start`. Without `start`
    /// it begins at 00:00:00:00, with dropped numbers at 30000/1001 and 60000/1001; at these rates
    /// `start` determines whether numbers are dropped. The code restarts after 24 hours.
    pub fn from_start(start: Option<Self>, frame_index: u64, rate: Rate) -> Self {
        let dropped =
            drops_per_minute(rate).filter(|_| start.is_none_or(|start| start.is_drop_frame));
        // The start counts as frames, so that numbers which its own minutes drop are not counted
        // twice.
        let before = start.map_or(0, |start| start.count(nominal(rate), dropped));
        let nominal = nominal(rate);
        let mut number = before.saturating_add(frame_index);
        if let Some(dropped) = dropped {
            // From frame count to frame number: add the dropped numbers. Each block of ten minutes
            // has nine minutes with dropped numbers; its first minute is complete.
            let minute = 60 * nominal - dropped;
            let ten_minutes = 10 * minute + dropped;
            // A day has 144 blocks of ten minutes; whole days do not show in the code.
            number %= 144 * ten_minutes;
            let (tens, rest) = (number / ten_minutes, number % ten_minutes);
            // Within a block the first minute has `dropped` frames more than the others, which is
            // why `rest` is taken without them.
            number += 9 * dropped * tens
                + if rest >= dropped {
                    dropped * ((rest - dropped) / minute)
                } else {
                    0
                };
        }
        let seconds = number / nominal;
        Self {
            hours: seconds / 3600 % 24,
            minutes: seconds / 60 % 60,
            seconds: seconds % 60,
            frames: number % nominal,
            is_drop_frame: dropped.is_some(),
        }
    }

    /// The number of frames before this code. A dropped number counts as the next existing one.
    fn count(self, nominal: u64, dropped: Option<u64>) -> u64 {
        let minutes = 60 * self.hours + self.minutes;
        let numbers = (60 * minutes + self.seconds) * nominal + self.frames;
        // One drop at the start of every minute so far but each tenth.
        let left_out = dropped.map_or(0, |dropped| dropped * (minutes - minutes / 10));
        let is_left_out = dropped.is_some_and(|dropped| {
            self.seconds == 0 && self.frames < dropped && !self.minutes.is_multiple_of(10)
        });
        let next = if is_left_out {
            dropped.unwrap_or(0) - self.frames
        } else {
            0
        };
        numbers + next - left_out
    }

    /// `10:00:00:00`, or `10:00:00;00` where numbers are dropped.
    pub fn parse(text: &str) -> Option<Self> {
        let (clock, frames, is_drop_frame) = match text.rsplit_once(';') {
            Some((clock, frames)) => (clock, frames, true),
            None => text
                .rsplit_once(':')
                .map(|(clock, frames)| (clock, frames, false))?,
        };
        let parts: Vec<u64> = clock.split(':').map(parse_part).collect::<Option<_>>()?;
        let [hours, minutes, seconds] = parts.try_into().ok()?;
        let frames = parse_part(frames)?;
        let is_one = hours < 24 && minutes < 60 && seconds < 60 && frames < 120;
        is_one.then_some(Self {
            hours,
            minutes,
            seconds,
            frames,
            is_drop_frame,
        })
    }
}

/// A number of a timecode: one to three digits.
fn parse_part(text: &str) -> Option<u64> {
    let is_plain = (1..=3).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    if is_plain { text.parse().ok() } else { None }
}

impl fmt::Display for Timecode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            hours,
            minutes,
            seconds,
            frames,
            is_drop_frame,
        } = self;
        let mark = if *is_drop_frame { ';' } else { ':' };
        write!(f, "{hours:02}:{minutes:02}:{seconds:02}{mark}{frames:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NTSC: Rate = Rate::new(30_000, 1001);

    #[test]
    fn numbers_are_dropped_at_every_minute_but_the_tenth() {
        let at = |index, rate| Timecode::from_start(None, index, rate).to_string();
        assert_eq!(at(412, Rate::new(25, 1)), "00:00:16:12");
        assert_eq!(
            [at(1799, NTSC), at(1800, NTSC)],
            ["00:00:59;29", "00:01:00;02"]
        );
        assert_eq!(
            [at(17_981, NTSC), at(17_982, NTSC)],
            ["00:09:59;29", "00:10:00;00"]
        );
        assert_eq!(at(107_892, NTSC), "01:00:00;00");
        assert_eq!(at(3600, Rate::new(60_000, 1001)), "00:01:00;04");
        assert_eq!(at(1440, Rate::new(24_000, 1001)), "00:01:00:00");
    }

    #[test]
    fn any_frame_number_has_a_timecode() {
        for rate in [NTSC, Rate::new(25, 1), Rate::new(u32::MAX, 1001)] {
            for start in [
                None,
                Timecode::parse("23:59:59;29"),
                Timecode::parse("23:59:59:29"),
            ] {
                let code = Timecode::from_start(start, u64::MAX, rate);
                assert!(code.hours < 24 && code.frames < nominal(rate), "{code}");
            }
        }
    }

    #[test]
    fn a_video_may_begin_at_any_timecode() {
        let at = |start: &str, index, rate| {
            Timecode::from_start(Timecode::parse(start), index, rate).to_string()
        };
        assert_eq!(at("10:00:00:00", 412, Rate::new(25, 1)), "10:00:16:12");
        assert_eq!(at("10:00:00;00", 1800, NTSC), "10:01:00;02");
        assert_eq!(
            at("10:00:00:00", 1800, NTSC),
            "10:01:00:00",
            "the colon says that nothing is dropped"
        );
        assert_eq!(at("00:00:59;29", 1, NTSC), "00:01:00;02");
        assert_eq!(
            at("00:01:00;00", 0, NTSC),
            "00:01:00;02",
            "that number is left out"
        );
        assert_eq!(at("23:59:59:24", 1, Rate::new(25, 1)), "00:00:00:00");
        for start in ["01:09:59;29", "01:10:00;00", "12:34:56;07"] {
            assert_eq!(at(start, 0, NTSC), start);
        }
    }

    #[test]
    fn what_is_no_timecode_is_none() {
        for text in [
            "",
            "10:00:00",
            "24:00:00:00",
            "10:60:00:00",
            "10:00:00:x",
            "-1:00:00:00",
            "1:2:3:4:5",
            "10:00;00:00",
        ] {
            assert_eq!(Timecode::parse(text), None, "{text}");
        }
    }
}
