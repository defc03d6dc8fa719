//! Timecodes of video frames, drop-frame included (SMPTE ST 12-1).

use super::options::Rate;
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
    /// Numbers are left out so that the code keeps pace with the clock.
    pub is_drop_frame: bool,
}

impl Timecode {
    /// The timecode of a frame, the first frame being 00:00:00:00. Rates of 30000/1001 and 60000/1001 drop numbers: 2 and 4 in
    /// each minute that is no tenth.
    #[must_use]
    pub fn of(frame_index: u64, rate: Rate) -> Self {
        let nominal = u64::from(rate.frames).div_ceil(u64::from(rate.seconds)).max(1);
        let is_drop_frame = rate.seconds == 1001 && nominal % 30 == 0;
        let mut number = frame_index;
        if is_drop_frame {
            let dropped = nominal / 15;
            let minute = 60 * nominal - dropped;
            let ten_minutes = 10 * minute + dropped;
            let (tens, rest) = (number / ten_minutes, number % ten_minutes);
            number += 9 * dropped * tens + if rest >= dropped { dropped * ((rest - dropped) / minute) } else { 0 };
        }
        let seconds = number / nominal;
        Self {
            hours: seconds / 3600 % 24,
            minutes: seconds / 60 % 60,
            seconds: seconds % 60,
            frames: number % nominal,
            is_drop_frame,
        }
    }
}

impl fmt::Display for Timecode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { hours, minutes, seconds, frames, is_drop_frame } = self;
        let mark = if *is_drop_frame { ';' } else { ':' };
        write!(f, "{hours:02}:{minutes:02}:{seconds:02}{mark}{frames:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_dropped_at_every_minute_but_the_tenth() {
        let at = |index, rate| Timecode::of(index, rate).to_string();
        let ntsc = Rate::new(30_000, 1001);
        assert_eq!(at(412, Rate::new(25, 1)), "00:00:16:12");
        assert_eq!([at(1799, ntsc), at(1800, ntsc)], ["00:00:59;29", "00:01:00;02"]);
        assert_eq!([at(17_981, ntsc), at(17_982, ntsc)], ["00:09:59;29", "00:10:00;00"]);
        assert_eq!(at(107_892, ntsc), "01:00:00;00");
        assert_eq!(at(3600, Rate::new(60_000, 1001)), "00:01:00;04");
        assert_eq!(at(1440, Rate::new(24_000, 1001)), "00:01:00:00");
    }
}
