//! What the answers of a section have to reach, so that a change that makes them worse is not
//! taken.

use super::answers::Tally;

/// What a section reaches with the code as it is. Each section states its own beside its inputs.
#[derive(Clone, Copy)]
pub struct Rate {
    /// The inputs of the whole section.
    pub tried: usize,
    /// At least so many of them have a right answer.
    pub right: usize,
    /// At most so many have a wrong answer that is shown as good.
    pub wrong: usize,
}

impl Rate {
    /// No input needs an answer, but none is wrong.
    pub const fn never_wrong(tried: usize) -> Self {
        Self {
            tried,
            right: 0,
            wrong: 0,
        }
    }
}

/// Why a tally is below its rate; nothing if it is not. Some inputs of a section may have as many
/// without a right answer as the whole section may: which of them these are is not known
/// beforehand.
pub fn shortfalls(tally: &Tally, rate: &Rate) -> Vec<String> {
    let (tried, right) = (tally.num_tried(), rights_needed(tally.num_tried(), rate));
    [
        (tried == 0, "nothing was asked".to_owned()),
        (
            tally.right < right,
            format!("{} right, at least {right} have to be", tally.right),
        ),
        (
            tally.wrong > rate.wrong,
            format!("{} wrong, at most {} may be", tally.wrong, rate.wrong),
        ),
    ]
    .into_iter()
    .filter_map(|(falls_short, why)| falls_short.then_some(why))
    .collect()
}

/// How many right answers are needed of so many inputs of a section.
fn rights_needed(tried: usize, rate: &Rate) -> usize {
    tried.saturating_sub(rate.tried - rate.right)
}

/// The sections that were asked, each compared with its rate.
#[derive(Default)]
pub struct Gate {
    lines: Vec<String>,
    failed: bool,
}

impl Gate {
    pub fn compare(&mut self, section: &str, tally: &Tally, rate: &Rate) {
        let shortfalls = shortfalls(tally, rate);
        let says = if shortfalls.is_empty() {
            "passed".to_owned()
        } else {
            format!("FAILED ({})", shortfalls.join("; "))
        };
        self.failed |= !shortfalls.is_empty();
        let right = rights_needed(tally.num_tried(), rate);
        self.lines.push(format!(
            "{section}: {says}: {tally} (rate: {right} right, {} wrong)",
            rate.wrong
        ));
    }

    /// The lines of all sections, and whether one of them is below its rate.
    pub fn verdict(self) -> (String, bool) {
        (self.lines.join("\n"), self.failed)
    }
}
