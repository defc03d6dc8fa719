//! What references show of a forest when they are left out of its training and asked for.

/// How often a forest was right about references that it was not trained on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Answers that were stated to be certain: see [`CERTAIN`].
    pub certain: u32,
    /// Those of them that were right.
    pub right: u32,
}

/// What the calibration on other matches is worth, in answers.
const BEFORE: f64 = 20.0;

/// What it says of answers that are certain.
const RIGHT_BEFORE: f64 = 0.998;

/// An answer that is right with at least this probability is stated to be certain: other frames
/// rest on it, and nobody has to look at it before it is used.
pub const CERTAIN: f64 = 0.9;

impl Shown {
    /// No answer is stated with a greater probability than this: the share of certain answers that
    /// were right, beside what is known from other matches. 1 where nothing was measured.
    #[must_use]
    pub fn at_most(&self) -> f64 {
        if self.certain == 0 {
            return 1.0;
        }
        (f64::from(self.right) + BEFORE * RIGHT_BEFORE) / (f64::from(self.certain) + BEFORE)
    }
}

#[cfg(test)]
mod tests {
    use super::Shown;

    #[test]
    fn wrong_answers_about_references_bound_what_is_stated() {
        let at_most = |certain, right| Shown { certain, right }.at_most();
        assert!(at_most(0, 0) == 1.0);
        assert!((0.998..0.9995).contains(&at_most(8, 8)) && at_most(200, 200) > at_most(8, 8));
        assert!((0.92..0.95).contains(&at_most(8, 6)), "{}", at_most(8, 6));
        assert!(at_most(8, 7) < at_most(32, 31));
    }
}
