//! The summary page "What the paper says, what we measure".

use std::fmt::Write as _;
use touchline_documents::report::{Cell, Report, Table, Verdict};

/// The page: a table with a row for each claim of the reports, and the number of each verdict.
/// Empty without claims.
#[must_use]
pub fn page(reports: &[Report]) -> String {
    let claims = || {
        reports
            .iter()
            .flat_map(|report| report.claims.iter().map(move |claim| (report, claim)))
    };
    if claims().next().is_none() {
        return String::new();
    }
    let mut table = Table::new(&[
        ("stated", "the paper says"),
        ("measured", "we measure"),
        ("verdict", ""),
        ("reason", "what limits the comparison"),
        ("experiment", "in"),
    ]);
    for (report, claim) in claims() {
        table.push(vec![
            claim.stated.as_str().into(),
            claim.measured.as_str().into(),
            match claim.verdict {
                Verdict::Differs => format!("**{}**", claim.verdict.describe()).into(),
                verdict => verdict.describe().into(),
            },
            Some(claim.reason.as_str())
                .filter(|reason| !reason.is_empty())
                .map_or(Cell::Empty, Cell::from),
            report.name.as_str().into(),
        ]);
    }
    let count = |verdict: Verdict| {
        claims()
            .filter(|(_, claim)| claim.verdict == verdict)
            .count()
    };
    let mut text = String::from("## What the paper says, what we measure\n\n");
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{} confirmed, {} different, {} undecided, {} not measured. IoU is that of the part of the field in the picture, mean ± SD over the frames, \
         a frame that was not found counting as 0; in parentheses the 95 % interval of the mean over the seeds; \
         undecided: the interval of the difference over the seeds holds 0, or what the paper states. Frames are drawn in the \
         paper's setting, players not masked; the paper's were real: agreement shows that the method does what the paper says, not how it \
         does on anyone's footage.\n\n{}",
        count(Verdict::Confirmed),
        count(Verdict::Differs),
        count(Verdict::Undecided),
        count(Verdict::NotMeasured),
        table.to_markdown()
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_claim_has_a_row_and_the_page_is_short() {
        let mut one = Report::new("one", "One");
        one.claim(Verdict::Confirmed, "up to 5 trees", "5: .90", "");
        one.claim(Verdict::Differs, "IoU .83", "IoU .71", "motion blur");
        let mut two = Report::new("two", "Two");
        two.claim(Verdict::NotMeasured, "SURF .74", "–", "non-free");
        let text = page(&[one, two, Report::new("three", "Three")]);
        assert!(
            text.contains("1 confirmed, 1 different, 0 undecided, 1 not measured"),
            "{text}"
        );
        assert!(
            text.contains("| IoU .83 | IoU .71 | **differs** | motion blur | one |"),
            "{text}"
        );
        assert!(text.lines().count() < 60);
        assert_eq!(page(&[Report::new("three", "Three")]), "");
    }
}
