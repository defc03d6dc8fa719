//! Presentation times of the frames of a video.

use std::sync::Arc;

/// Maximum deviation of a time stamp from its frame's time, as a share of the frame spacing.
/// Matroska rounds to milliseconds, a deviation of up to 0.03 of the spacing at 60 frames a second.
const TOLERANCE: f64 = 0.25;

/// The times of a video's frames, seconds from the stream's start.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameClock {
    /// A constant rate.
    Even {
        /// When frame 0 is shown, s.
        first_s: f64,
        /// Frames a second.
        fps: f64,
    },
    /// Irregular times: the time of every frame, s, ascending.
    Listed(Arc<[f64]>),
}

impl FrameClock {
    /// When a frame is shown, s; none beyond the list.
    pub fn pts_s(&self, index: usize) -> Option<f64> {
        match self {
            Self::Even { first_s, fps } => Some(first_s + index as f64 / fps),
            Self::Listed(times) => times.get(index).copied(),
        }
    }

    /// The frame shown at a time stamp; `None` if no frame has about that time.
    pub fn index_at(&self, pts_s: f64) -> Option<usize> {
        match self {
            Self::Even { first_s, fps } => {
                // In units of the frame spacing. Comparisons with NaN are false, so a time that is
                // not a number has no frame.
                let slot = (pts_s - first_s) * fps;
                let nearest = slot.round();
                ((slot - nearest).abs() <= TOLERANCE && nearest >= 0.0).then_some(nearest as usize)
            }
            Self::Listed(times) => {
                // The nearest of the two neighbours, accepted within a share of the smaller gap
                // beside it. A single frame has no gap and is accepted at any time.
                let after = times.partition_point(|&time| time < pts_s);
                let nearest = [after.checked_sub(1), Some(after)]
                    .into_iter()
                    .flatten()
                    .filter(|&index| index < times.len())
                    .min_by(|&a, &b| {
                        (times[a] - pts_s)
                            .abs()
                            .total_cmp(&(times[b] - pts_s).abs())
                    })?;
                let spacing_s = [
                    nearest
                        .checked_sub(1)
                        .map(|before| times[nearest] - times[before]),
                    times.get(nearest + 1).map(|next| next - times[nearest]),
                ]
                .into_iter()
                .flatten()
                .fold(f64::INFINITY, f64::min);
                ((times[nearest] - pts_s).abs() <= TOLERANCE * spacing_s).then_some(nearest)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_clock_finds_its_own_frames() {
        let clock = FrameClock::Even {
            first_s: 0.04,
            fps: 30_000.0 / 1001.0,
        };
        for index in [0, 1, 2, 17, 135_000] {
            assert_eq!(clock.index_at(clock.pts_s(index).unwrap()), Some(index));
        }
        // A container that rounds to milliseconds.
        assert_eq!(
            clock.index_at((clock.pts_s(1001).unwrap() * 1000.0).round() / 1000.0),
            Some(1001)
        );
        assert_eq!(
            clock.index_at(0.04 + 0.5 * 1001.0 / 30_000.0),
            None,
            "between two frames"
        );
        assert_eq!(clock.index_at(0.0), None, "before the first");
        assert_eq!(clock.index_at(f64::NAN), None);
    }

    #[test]
    fn a_listed_clock_finds_its_own_frames() {
        let times = [0.0, 0.04, 0.08, 0.28, 0.32, 0.325];
        let clock = FrameClock::Listed(times.into());
        for (index, time) in times.into_iter().enumerate() {
            assert_eq!(clock.index_at(time), Some(index));
            assert_eq!(clock.pts_s(index), Some(time));
        }
        assert_eq!(clock.index_at(0.2), None, "in the gap");
        assert_eq!(clock.index_at(0.3249), Some(5));
        assert_eq!(clock.index_at(1.0), None);
        assert_eq!(clock.index_at(f64::NAN), None);
        assert_eq!(clock.pts_s(6), None);
        assert_eq!(FrameClock::Listed([].into()).index_at(0.0), None);
        assert_eq!(FrameClock::Listed([0.0].into()).index_at(0.0), Some(0));
    }
}
