//! The success rate of a forest on references that were left out of its training.

/// How often certain answers about left-out references were right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CertainAnswerCounts {
    /// Number of answers stated to be certain: see [`CERTAIN`].
    pub certain: u32,
    /// Number of those that were right.
    pub right: u32,
}

/// Weight of the prior success rate, in answers.
const BEFORE: f64 = 20.0;

/// Prior success rate of certain answers, from the calibration on other matches.
const RIGHT_BEFORE: f64 = 0.998;

/// An answer of at least this probability is called certain: it is used for other frames without
/// confirmation by the user.
pub const CERTAIN: f64 = 0.9;

impl CertainAnswerCounts {
    /// Upper bound of the stated probability: the success rate of certain answers, combined with
    /// the prior rate. 1 if nothing was measured.
    pub fn at_most(&self) -> f64 {
        if self.certain == 0 {
            return 1.0;
        }
        (f64::from(self.right) + BEFORE * RIGHT_BEFORE) / (f64::from(self.certain) + BEFORE)
    }
}

#[cfg(test)]
mod tests {
    use super::CertainAnswerCounts;

    #[test]
    fn wrong_answers_about_references_bound_what_is_stated() {
        let at_most = |certain, right| CertainAnswerCounts { certain, right }.at_most();
        assert!(at_most(0, 0) == 1.0);
        assert!((0.998..0.9995).contains(&at_most(8, 8)) && at_most(200, 200) > at_most(8, 8));
        assert!((0.92..0.95).contains(&at_most(8, 6)), "{}", at_most(8, 6));
        assert!(at_most(8, 7) < at_most(32, 31));
    }
}
