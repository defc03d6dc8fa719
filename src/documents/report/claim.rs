//! What others state, beside what was measured.

use serde_json::{Value, json};

/// What others state, and what was measured here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// What they state.
    pub stated: String,
    /// What was measured.
    pub measured: String,
    /// How the two compare.
    pub verdict: Verdict,
    /// Why they differ, or what limits the comparison; may be empty.
    pub reason: String,
    /// Whether it is of times, which depend on the machine.
    pub of_times: bool,
}

/// How a measurement compares with what others state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It confirms what they state.
    Confirmed,
    /// It does not.
    Differs,
    /// The difference is one that chance makes: its interval holds both.
    Undecided,
    /// It cannot be measured here.
    NotMeasured,
}

impl Verdict {
    /// Confirmed if this holds.
    #[must_use]
    pub const fn of(holds: bool) -> Self {
        if holds {
            Self::Confirmed
        } else {
            Self::Differs
        }
    }

    /// Confirmed if the whole interval of a measurement lies above a number, different if all of it
    /// lies below.
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

    /// Of several measurements together: confirmed if all are, different if one is.
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

    /// For people.
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
