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
    /// It cannot be measured here.
    NotMeasured,
}

impl Verdict {
    /// Confirmed if this holds.
    #[must_use]
    pub const fn of(holds: bool) -> Self {
        if holds { Self::Confirmed } else { Self::Differs }
    }

    /// For people.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Differs => "differs",
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
