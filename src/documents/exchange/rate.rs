//! Frame rates.

use std::fmt;

/// A frame rate as a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Frames.
    pub frames: u32,
    /// In this many seconds.
    pub seconds: u32,
}

impl Rate {
    /// The rates of broadcasts and films.
    const USUAL: [Self; 9] = [
        Self::new(24_000, 1001),
        Self::new(24, 1),
        Self::new(25, 1),
        Self::new(30_000, 1001),
        Self::new(30, 1),
        Self::new(50, 1),
        Self::new(60_000, 1001),
        Self::new(60, 1),
        Self::new(100, 1),
    ];

    /// A rate of `frames` in `seconds`.
    pub const fn new(frames: u32, seconds: u32) -> Self {
        Self { frames, seconds }
    }

    /// Frames per second.
    pub fn per_second(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// The usual rate within 0.02 % of a measured one.
    pub fn nearest(per_second: f64) -> Option<Self> {
        // Broadcast rates are a thousandth apart (30 and 30000/1001), five times the tolerance, so
        // that a measured rate cannot be taken for its neighbour. NaN, of no or equal times, is
        // near none.
        let nearest = Self::USUAL.into_iter().min_by(|a, b| {
            a.deviation_from(per_second)
                .total_cmp(&b.deviation_from(per_second))
        })?;
        (nearest.deviation_from(per_second) < 2e-4).then_some(nearest)
    }

    /// The relative difference from a measured rate.
    fn deviation_from(self, per_second: f64) -> f64 {
        (self.per_second() / per_second - 1.0).abs()
    }

    /// `25`, `29.97` or `30000/1001`.
    pub fn parse(text: &str) -> Option<Self> {
        if let Some((frames, seconds)) = text.split_once('/') {
            let (frames, seconds) = (frames.parse().ok()?, seconds.parse().ok()?);
            return (frames > 0 && seconds > 0).then_some(Self { frames, seconds });
        }
        let per_second: f64 = text.parse().ok()?;
        // A whole number is meant as it stands. A decimal one is a rounded ratio, such as 29.97,
        // and stands for the usual rate near it.
        if per_second.fract() == 0.0 && (1.0..=1000.0).contains(&per_second) {
            return Some(Self::new(per_second as u32, 1));
        }
        Self::nearest(per_second)
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, seconds } = self;
        if *seconds == 1 {
            write!(f, "{frames}")
        } else {
            write!(f, "{frames}/{seconds}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Rate;

    #[test]
    fn rates_are_read_as_people_write_them() {
        assert_eq!(Rate::parse("25"), Some(Rate::new(25, 1)));
        assert_eq!(Rate::parse("29.97"), Some(Rate::new(30_000, 1001)));
        assert_eq!(Rate::parse("30000/1001"), Some(Rate::new(30_000, 1001)));
        for rate in [Rate::new(50, 1), Rate::new(60_000, 1001)] {
            assert_eq!(Rate::parse(&rate.to_string()), Some(rate));
        }
        assert_eq!(Rate::nearest(23.9763), Some(Rate::new(24_000, 1001)));
        for bad in ["0", "1/0", "27.3", "fast", "-25"] {
            assert_eq!(Rate::parse(bad), None, "{bad}");
        }
    }
}
