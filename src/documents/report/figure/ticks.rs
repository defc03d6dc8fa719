//! Tick marks of an axis.

use super::{Axis, Scale};

/// An axis with its range and its tick marks.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruler {
    scale: Scale,
    from: f64,
    to: f64,
    /// The ticks' values and labels.
    pub ticks: Vec<(f64, String)>,
}

/// The approximate number of tick marks of a linear axis.
const WANTED: f64 = 5.0;

impl Ruler {
    /// The ruler of an axis for these values. Without a range of its own, the axis fits the values
    /// and begins and ends at a tick mark.
    pub fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let usable = values
            .filter(|value| value.is_finite() && (axis.scale == Scale::Linear || *value > 0.0));
        // Values that the axis cannot show do not widen it. Without any value it still has a range,
        // one that both scales can show.
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let [from, to] = axis.range.unwrap_or(if low <= high {
            [low, high]
        } else {
            [1.0, 10.0]
        });
        match axis.scale {
            Scale::Linear => Self::linear([from, to], axis.range.is_some(), WANTED),
            Scale::Log => Self::log(from, to, axis.range.is_some()),
        }
    }

    /// A linear ruler over a range with about this number of tick marks.
    pub fn within(range: [f64; 2], wanted: f64) -> Self {
        Self::linear(range, true, wanted)
    }

    /// A linear ruler over these values with about this number of tick marks, including one at
    /// either end.
    pub fn around(range: [f64; 2], wanted: f64) -> Self {
        Self::linear(range, false, wanted)
    }

    /// The first and the last value.
    pub const fn range(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    /// A linear ruler. Unless the range is fixed, it is extended to multiples of the step.
    fn linear([from, to]: [f64; 2], fixed: bool, wanted: f64) -> Self {
        // A single value gets a range of width 1 around it.
        let (from, to) = if from < to {
            (from, to)
        } else {
            (from - 0.5, from + 0.5)
        };
        let step = nice_step((to - from) / wanted);
        let (from, to) = if fixed {
            (from, to)
        } else {
            ((from / step).floor() * step, (to / step).ceil() * step)
        };
        // As many decimals as the step needs: its only digit, 1, 2 or 5, stands at
        // 10^floor(log10).
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        // Tolerance for rounding: a tick mark at either end of the range is included.
        let first = (from / step - 1e-9).ceil() as i64;
        let last = (to / step + 1e-9).floor() as i64;
        // Each value is a multiple of the step, not a sum, so that rounding does not add up. The
        // label of zero never has a sign.
        let ticks = (first..=last).map(|number| {
            let value = number as f64 * step;
            (
                value,
                format!("{:.decimals$}", if number == 0 { 0.0 } else { value }),
            )
        });
        Self {
            scale: Scale::Linear,
            from,
            to,
            ticks: ticks.collect(),
        }
    }

    /// A logarithmic ruler. Unless the range is fixed, it is extended to 1, 2 or 5 times a power of
    /// ten.
    fn log(from: f64, to: f64, fixed: bool) -> Self {
        // A single value gets two octaves around it.
        let (from, to) = if from < to {
            (from, to)
        } else {
            (from / 2.0, from * 2.0)
        };
        let (from, to) = if fixed {
            (from, to)
        } else {
            (round_down(from), round_up(to))
        };
        let decades = (to / from).log10();
        // Up to 1.5 decades, label 1, 2 and 5 of each. Over more than six, label every other power
        // or fewer.
        let between: &[f64] = if decades <= 1.5 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let stride = (decades / 6.0).ceil().max(1.0) as i32;
        // One power more on either side than needed; what lies outside the range is left out below.
        let powers = from.log10().floor() as i32..=to.log10().ceil() as i32;
        let ticks = powers
            .filter(|power| power.rem_euclid(stride) == 0)
            .flat_map(|power| between.iter().map(move |factor| factor * 10f64.powi(power)));
        let inside: Vec<f64> = ticks
            .filter(|value| *value >= from * (1.0 - 1e-9) && *value <= to * (1.0 + 1e-9))
            .collect();
        // All labels of an axis have the same form: decimal or exponential.
        let plain = inside.iter().all(|value| (1e-4..1e6).contains(value));
        let ticks = inside
            .into_iter()
            .map(|value| (value, log_label(value, plain)));
        Self {
            scale: Scale::Log,
            from,
            to,
            ticks: ticks.collect(),
        }
    }

    /// The position of a number along the axis, 0 to 1 within its range; none if a logarithmic axis
    /// cannot show it.
    pub fn share(&self, value: f64) -> Option<f64> {
        let share = match self.scale {
            Scale::Linear => (value - self.from) / (self.to - self.from),
            Scale::Log if value > 0.0 => (value / self.from).ln() / (self.to / self.from).ln(),
            Scale::Log => return None,
        };
        share.is_finite().then_some(share)
    }
}

/// The number of the form 1, 2 or 5 times a power of ten that is nearest by ratio.
fn nice_step(rough: f64) -> f64 {
    // 10 stands for 1 of the next power, which may be nearer.
    let power = 10f64.powf(rough.log10().floor());
    let off = |factor: &f64| (factor * power / rough).ln().abs();
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .unwrap_or(1.0)
        * power
}

/// The largest number of the form 1, 2 or 5 times a power of ten that is at most `value`.
fn round_down(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|v| *v <= value * (1.0 + 1e-9))
        .unwrap_or(power)
}

/// The smallest number of the form 1, 2 or 5 times a power of ten that is at least `value`.
fn round_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|v| *v >= value * (1.0 - 1e-9))
        .unwrap_or(power)
}

fn log_label(value: f64, plain: bool) -> String {
    if plain {
        let decimals = (-value.log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        Ruler::new(axis, values.iter().copied())
            .ticks
            .into_iter()
            .map(|tick| tick.1)
            .collect()
    }

    #[test]
    fn linear_axes_end_at_numbers() {
        let axis = Axis::linear("x");
        assert_eq!(labels(&axis, &[0.03, 4.7]), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(
            labels(&axis, &[0.0, 0.0098]),
            ["0.000", "0.002", "0.004", "0.006", "0.008", "0.010"]
        );
        assert_eq!(
            labels(&axis.clone().within(0.0, 1.0), &[7.0]),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(&axis, &[-2.0, 3.0]),
            ["-2", "-1", "0", "1", "2", "3"]
        );
        assert!(!labels(&axis, &[]).is_empty() && !labels(&axis, &[2.0, 2.0]).is_empty());
    }

    #[test]
    fn a_small_plot_has_few_numbers() {
        let labels = |ruler: Ruler| {
            ruler
                .ticks
                .into_iter()
                .map(|tick| tick.1)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            labels(Ruler::around([-37.0, 41.0], 2.0)),
            ["-50", "0", "50"]
        );
        assert_eq!(labels(Ruler::within([3.0, 97.0], 2.0)), ["50"]);
        assert_eq!(Ruler::around([-37.0, 41.0], 2.0).range(), [-50.0, 50.0]);
    }

    #[test]
    fn log_axes_have_powers_and_leave_out_what_is_not_positive() {
        let axis = Axis::log("x");
        assert_eq!(
            labels(&axis, &[0.0, 0.012, 90.0]),
            ["0.01", "0.1", "1", "10", "100"]
        );
        assert_eq!(labels(&axis, &[2.0, 15.0]), ["2", "5", "10", "20"]);
        assert_eq!(
            labels(&axis, &[2e-6, 0.3]),
            ["1e-5", "1e-4", "1e-3", "1e-2", "1e-1"]
        );
        let ruler = Ruler::new(&axis, [1.0, 100.0].into_iter());
        assert_eq!(
            ruler.share(10.0).map(|share| (share * 1e9).round()),
            Some(0.5e9)
        );
        assert_eq!(ruler.share(0.0), None);
    }
}
