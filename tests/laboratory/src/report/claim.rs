//! Comparison of published statements with measurements, by the size of an effect.

use touchline::report::{Cell, significant};

/// A published statement, and the measurements that test it.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The statement.
    pub stated: String,
    /// What it states, as a number.
    pub paper: Stated,
    /// The measurements. The first one decides; the others stand beside it.
    pub tests: Vec<ClaimMeasurement>,
    /// Number of comparisons that the statement makes at once. Intervals are as wide as
    /// Bonferroni's correction for them asks.
    pub comparisons: usize,
    /// Why they differ, what limits the comparison, or why there is none. May be empty.
    pub reason: String,
    /// Whether it is about times, which depend on the machine.
    pub is_about_times: bool,
}

/// The form of a statement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stated {
    /// A number, and half a unit of its last digit.
    Level(f64, f64),
    /// A difference with its size, counted so that it is positive.
    Effect(f64),
    /// A difference of which only the sign is stated, counted so that it is positive.
    Positive,
    /// A lower bound.
    AtLeast(f64),
    /// An upper bound.
    AtMost(f64),
    /// Nothing that a measurement could be compared with.
    Nothing,
}

/// A measurement of what is stated.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimMeasurement {
    /// On what it was measured: `published`.
    pub on: String,
    /// Its value.
    pub value: f64,
    /// Its confidence interval. NaN if there is none.
    pub interval: [f64; 2],
    /// Number of independent values behind the interval.
    pub repeats: usize,
    /// Number of single measurements, such as frames.
    pub samples: usize,
    /// How it follows from a table of the report.
    pub source: Source,
}

/// The computation of a measurement, for a script that does it again from a report's files: the
/// weighted sum of means of one column, in each repetition; then the mean over the repetitions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Name of the table's file, without extension.
    pub table: String,
    /// Key of the column of which means are taken.
    pub column: String,
    /// Key of the column that numbers the repetitions. Empty if the table has one row for each
    /// term, whose number is exact.
    pub repeats_by: String,
    /// The terms: `way=published & view=wide: 1 | way=default: -1`.
    pub terms: String,
}

/// The result of comparing a measurement with a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The measurement confirms the statement.
    Confirmed,
    /// Less than stated.
    Smaller,
    /// More than stated.
    Larger,
    /// The measurement contradicts the statement.
    Differs,
    /// The interval allows the statement and its opposite.
    Undecided,
    /// The statement cannot be tested here.
    NotComparable,
}

impl Stated {
    /// The rules of [`Stated::verdict`], for readers of a report.
    pub const RULES: &'static str = "\
        A *difference* of stated size is confirmed if our interval excludes 0 in the stated \
        direction, and either contains the stated size or lies between half and one and a half \
        of it; it differs if the interval excludes the stated direction; otherwise it is smaller \
        or larger if the interval excludes the stated size, and undecided if it contains both \
        that size and 0. A difference of which only the *sign* is stated is confirmed or differs \
        if the interval excludes 0. A *number* is confirmed if the interval contains it (to its \
        rounding) and is no wider than half of it, undecided if the interval is wider, otherwise \
        ours is smaller or larger. A *bound* is confirmed or differs if the whole interval lies \
        on one side of it.";

    /// The difference of two numbers that are stated to two decimals.
    #[must_use]
    pub fn difference(more: f64, less: f64) -> Self {
        // Both numbers have two decimals, so their difference has no more: the rest is rounding of
        // `f64`.
        Self::Effect(((more - less) * 100.0).round() / 100.0)
    }

    /// Compares a confidence interval with the statement; [`Stated::RULES`] has the rules.
    #[must_use]
    pub fn verdict(self, [low, high]: [f64; 2]) -> Verdict {
        // The order of the arms matters. An interval without numbers decides nothing. A number is
        // first missed on one side, and only then found too uncertain; a difference first has the
        // wrong sign.
        match self {
            Self::Nothing => Verdict::NotComparable,
            _ if !(low <= high) => Verdict::Undecided,
            Self::Level(number, half_unit) if high < number - half_unit => Verdict::Smaller,
            Self::Level(number, half_unit) if low > number + half_unit => Verdict::Larger,
            Self::Level(number, _) if high - low > 0.5 * number.abs() => Verdict::Undecided,
            Self::Level(..) => Verdict::Confirmed,
            Self::Effect(_) if high < 0.0 => Verdict::Differs,
            Self::Effect(size) => {
                let has_size = low <= size && size <= high;
                let is_near = low >= 0.5 * size && high <= 1.5 * size;
                if has_size && low <= 0.0 {
                    Verdict::Undecided
                } else if has_size || is_near {
                    Verdict::Confirmed
                } else if high < size {
                    Verdict::Smaller
                } else {
                    Verdict::Larger
                }
            }
            Self::Positive => Self::AtLeast(0.0).verdict([low, high]),
            Self::AtLeast(bound) => on_one_side(low > bound, high < bound),
            Self::AtMost(bound) => on_one_side(high < bound, low > bound),
        }
    }

    /// Its kind, in files.
    #[must_use]
    pub const fn kind(self) -> &'static str {
        match self {
            Self::Level(..) => "number",
            Self::Effect(_) => "difference",
            Self::Positive => "sign",
            Self::AtLeast(_) => "at least",
            Self::AtMost(_) => "at most",
            Self::Nothing => "nothing",
        }
    }

    /// The stated number; none if only a sign or nothing is stated.
    #[must_use]
    pub const fn number(self) -> Option<f64> {
        match self {
            Self::Level(number, _)
            | Self::Effect(number)
            | Self::AtLeast(number)
            | Self::AtMost(number) => Some(number),
            Self::Positive | Self::Nothing => None,
        }
    }

    /// The statement for readers: `+0.15`, `> 0`, `< 0.02`.
    #[must_use]
    pub fn describe(self) -> String {
        match self {
            Self::Level(number, _) => short(number),
            Self::Effect(size) => format!("+{}", short(size)),
            Self::Positive => "> 0".to_owned(),
            Self::AtLeast(bound) => format!("> {}", short(bound)),
            Self::AtMost(bound) => format!("< {}", short(bound)),
            Self::Nothing => "–".to_owned(),
        }
    }

    /// Whether the measurement is a difference, which is shown with its sign.
    const fn is_difference(self) -> bool {
        matches!(self, Self::Effect(_) | Self::Positive)
    }
}

/// The verdict on a bound.
const fn on_one_side(confirms: bool, contradicts: bool) -> Verdict {
    match (confirms, contradicts) {
        (true, _) => Verdict::Confirmed,
        (_, true) => Verdict::Differs,
        _ => Verdict::Undecided,
    }
}

/// A number without superfluous zeros.
fn short(number: f64) -> String {
    format!("{number}")
}

impl Verdict {
    /// All verdicts, in the order in which reports count them.
    pub const ALL: [Self; 6] = [
        Self::Confirmed,
        Self::Smaller,
        Self::Larger,
        Self::Differs,
        Self::Undecided,
        Self::NotComparable,
    ];

    /// The verdict as text for reports.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Smaller => "smaller",
            Self::Larger => "larger",
            Self::Differs => "differs",
            Self::Undecided => "undecided",
            Self::NotComparable => "not comparable",
        }
    }
}

impl Claim {
    /// The verdict by the first measurement.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let first = self.tests.first();
        first.map_or(Verdict::NotComparable, |test| self.verdict_on(test))
    }

    /// The verdict by one of the measurements.
    #[must_use]
    pub fn verdict_on(&self, test: &ClaimMeasurement) -> Verdict {
        self.paper.verdict(test.interval)
    }

    /// A measurement with its interval for readers: `+0.146 (+0.098 to +0.190)`.
    #[must_use]
    pub fn describe(&self, test: &ClaimMeasurement) -> String {
        let value = self.describe_number(test.value);
        let [low, high] = test.interval;
        if low < high {
            let [low, high] = [low, high].map(|end| self.describe_number(end));
            format!("{value} ({low} to {high})")
        } else {
            value
        }
    }

    /// A measured number for readers: a difference with its sign.
    fn describe_number(&self, value: f64) -> String {
        // Differences have three decimals, one more than the stated ones. Of numbers, small ones
        // have a fourth, and large ones four significant digits.
        if self.paper.is_difference() {
            format!("{value:+.3}")
        } else if value.abs() < 10.0 {
            Cell::Fixed(value, if value.abs() < 0.1 { 4 } else { 3 }).to_string()
        } else {
            significant(value)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_on_a_difference_follows_its_size() {
        let gate = Stated::Effect(0.30);
        for (interval, verdict) in [
            // The stated size, and 0 excluded.
            ([0.10, 0.35], Verdict::Confirmed),
            // Narrow and near the stated size, which it does not contain.
            ([0.20, 0.25], Verdict::Confirmed),
            ([0.35, 0.44], Verdict::Confirmed),
            // The right sign, another size.
            ([0.10, 0.19], Verdict::Smaller),
            ([0.50, 0.60], Verdict::Larger),
            // An effect that cannot be distinguished from none, and the stated size excluded.
            ([-0.003, 0.020], Verdict::Smaller),
            ([-0.20, -0.10], Verdict::Differs),
            ([-0.10, 0.40], Verdict::Undecided),
            ([f64::NAN; 2], Verdict::Undecided),
        ] {
            assert_eq!(gate.verdict(interval), verdict, "{interval:?}");
        }
    }

    #[test]
    fn numbers_bounds_and_signs_have_rules_of_their_own() {
        let rounds = Stated::Level(71.0, 0.5);
        assert_eq!(rounds.verdict([71.36; 2]), Verdict::Confirmed);
        assert_eq!(rounds.verdict([72.0; 2]), Verdict::Larger);
        assert_eq!(rounds.verdict([60.0, 70.0]), Verdict::Smaller);
        assert_eq!(rounds.verdict([40.0, 90.0]), Verdict::Undecided);
        assert_eq!(
            Stated::AtMost(0.02).verdict([0.01, 0.015]),
            Verdict::Confirmed
        );
        assert_eq!(Stated::AtMost(0.02).verdict([0.03, 0.04]), Verdict::Differs);
        assert_eq!(
            Stated::AtLeast(0.85).verdict([0.8, 0.9]),
            Verdict::Undecided
        );
        assert_eq!(Stated::Positive.verdict([0.1, 0.3]), Verdict::Confirmed);
        assert_eq!(Stated::Positive.verdict([-0.3, -0.1]), Verdict::Differs);
        assert_eq!(Stated::Nothing.verdict([0.1, 0.3]), Verdict::NotComparable);
    }
}
