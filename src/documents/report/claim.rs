//! Comparison of published statements with measurements.

use serde_json::{Value, json};

/// A published statement, and the measurement that tests it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// The statement.
    pub stated: String,
    /// The measurement.
    pub measured: String,
    /// How the two compare.
    pub verdict: Verdict,
    /// Why they differ, or what limits the comparison. May be empty.
    pub reason: String,
    /// Whether it is about times, which depend on the machine.
    pub of_times: bool,
}

/// The result of comparing a measurement with a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The measurement confirms the statement.
    Confirmed,
    /// The measurement contradicts the statement.
    Differs,
    /// The confidence interval of the measurement contains the stated number.
    Undecided,
    /// The statement cannot be tested here.
    NotMeasured,
}

impl Verdict {
    /// Confirmed if `holds`, otherwise different.
    #[must_use]
    pub const fn of(holds: bool) -> Self {
        if holds {
            Self::Confirmed
        } else {
            Self::Differs
        }
    }

    /// Compares a confidence interval with a stated minimum: confirmed if the whole interval lies
    /// above it, different if the whole interval lies below.
    #[must_use]
    pub fn above(interval: [f64; 2], least: f64) -> Self {
        let [low, high] = interval;
        if low > least {
            Self::Confirmed
        } else if high < least {
            Self::Differs
        } else {
            Self::Undecided
        }
    }

    /// Combines several verdicts into the worst: confirmed only if all are, different if one is.
    #[must_use]
    pub fn all(verdicts: impl IntoIterator<Item = Self>) -> Self {
        let rank = |verdict: &Self| {
            [
                Self::Confirmed,
                Self::NotMeasured,
                Self::Undecided,
                Self::Differs,
            ]
            .iter()
            .position(|other| other == verdict)
        };
        verdicts
            .into_iter()
            .max_by_key(rank)
            .unwrap_or(Self::NotMeasured)
    }

    /// The verdict as text for reports.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Differs => "differs",
            Self::Undecided => "undecided",
            Self::NotMeasured => "not measured",
        }
    }
}

impl Claim {
    pub(super) fn json(&self) -> Value {
        json!({
            "stated": self.stated,
            "measured": self.measured,
            "verdict": self.verdict.describe(),
            "reason": self.reason,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_chance_may_have_made_is_not_decided() {
        assert_eq!(Verdict::above([0.1, 0.3], 0.0), Verdict::Confirmed);
        assert_eq!(Verdict::above([-0.1, 0.3], 0.0), Verdict::Undecided);
        assert_eq!(Verdict::above([-0.3, -0.1], 0.0), Verdict::Differs);
        assert_eq!(Verdict::above([f64::NAN; 2], 0.0), Verdict::Undecided);
        assert_eq!(
            Verdict::all([Verdict::Confirmed, Verdict::Undecided]),
            Verdict::Undecided
        );
        assert_eq!(
            Verdict::all([Verdict::Differs, Verdict::Undecided]),
            Verdict::Differs
        );
        assert_eq!(Verdict::all([Verdict::Confirmed; 2]), Verdict::Confirmed);
    }
}
