//! The page "What the paper says, what we measure", and the file of its numbers.

use crate::report::{Claim, ClaimMeasurement, Report, Stated, Verdict};
use std::fmt::Write as _;
use touchline::report::{Cell, Table};

/// The page: how many statements have which verdict, the rules of the verdicts, the measures, and a
/// table with a row for each statement. Empty without statements.
#[must_use]
pub fn page(reports: &[Report]) -> String {
    let claims: Vec<(&Report, &Claim)> = claims_of(reports, false).collect();
    if claims.is_empty() {
        return String::new();
    }
    let counts = Verdict::ALL.map(|verdict| {
        let count = claims
            .iter()
            .filter(|(_, claim)| claim.verdict() == verdict)
            .count();
        format!("{count} {}", verdict.describe())
    });
    let mut text = String::from("## What the paper says, what we measure\n\n");
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{} statements on the paper's own forest: {}. Frames are drawn in the paper's setting; \
         its own were real: agreement shows that the method does what the paper says, not how it \
         does on anyone's footage.\n\n{}\n{}\n\n**Rules.** {} Intervals are 95 % (Student's t \
         over seeds; over cameras in the synthetic experiment), wider where a statement makes \
         several comparisons (Bonferroni), and not cut at 0 or 1. `claims.csv` has every number \
         of this table and how it follows from the other files; `recompute.py` does it \
         again.\n\n{}",
        claims.len(),
        counts.join(", "),
        in_brief(&claims),
        MEASURES,
        Stated::RULES,
        claim_table(&claims).to_markdown()
    );
    text
}

/// The statements that are neither confirmed nor without a comparison, a line for each.
fn in_brief(claims: &[(&Report, &Claim)]) -> String {
    let open = claims.iter().filter(|(_, claim)| {
        !matches!(claim.verdict(), Verdict::Confirmed | Verdict::NotComparable)
    });
    open.filter_map(|(_, claim)| {
        // The first measurement decides the verdict; the others stand beside it.
        let first = claim.tests.first()?;
        let verdict = claim.verdict().describe();
        let (paper, ours) = (claim.paper.describe(), claim.describe(first));
        Some(format!(
            "* {}: paper {paper}, ours {ours}: **{verdict}**.\n",
            claim.stated
        ))
    })
    .collect()
}

/// What is measured, once for all experiments.
const MEASURES: &str = "**Measures.** *IoU of the part* is that of the part of the field in the \
    picture, *of the whole* that of the whole field, as the paper may count it; a refused frame \
    counts as 0. *Right*: rotation within 1° of the true one; *wrong*: beyond; *refused*: no \
    answer.\n\n\
    **Forests.** *published*: the paper's settings (5 trees of 30 frames, depth 20, a leaf is \
    the mean of its samples, 4 leaves of each tree are visited); *default*: this program's. The \
    camera is found from their rays by this program for both, with its refinement and, unless \
    *untested*, its test of whether an answer is to be trusted.";

/// The statements about times, which depend on the machine. Empty without any.
#[must_use]
pub fn times_page(reports: &[Report]) -> String {
    let claims: Vec<(&Report, &Claim)> = claims_of(reports, true).collect();
    if claims.is_empty() {
        return String::new();
    }
    claim_table(&claims).to_markdown()
}

fn claims_of(reports: &[Report], about_times: bool) -> impl Iterator<Item = (&Report, &Claim)> {
    let each = reports
        .iter()
        .flat_map(|report| report.claims.iter().map(move |claim| (report, claim)));
    each.filter(move |(_, claim)| claim.is_about_times == about_times)
}

/// A row for each statement.
fn claim_table(claims: &[(&Report, &Claim)]) -> Table {
    let mut table = Table::new(&[
        ("stated", "the paper says"),
        ("paper", "paper"),
        ("measured", "we measure (95 %)"),
        ("samples", "n"),
        ("verdict", "verdict"),
        ("beside", "beside it"),
        ("reason", "what limits the comparison"),
    ]);
    for (report, claim) in claims {
        let first = claim.tests.first();
        let others = claim.tests.iter().skip(1).map(|test| {
            let verdict = claim.verdict_on(test).describe();
            format!("{}: {}: {verdict}", test.on, claim.describe(test))
        });
        let others = others.collect::<Vec<_>>().join("; ");
        table.push(vec![
            format!("{} ({})", claim.stated, report.name).into(),
            claim.paper.describe().into(),
            first
                .map(|test| format!("{}: {}", test.on, claim.describe(test)))
                .into(),
            first.map(|test| test.samples).into(),
            match claim.verdict() {
                verdict @ (Verdict::Confirmed | Verdict::NotComparable) => {
                    verdict.describe().into()
                }
                // What is not simply confirmed is set in bold, so that it cannot be overlooked.
                verdict => format!("**{}**", verdict.describe()).into(),
            },
            or_empty(&others),
            or_empty(&claim.reason),
        ]);
    }
    table
}

fn or_empty(text: &str) -> Cell {
    Some(text)
        .filter(|text| !text.is_empty())
        .map_or(Cell::Empty, Cell::from)
}

/// Every measurement behind the page, and how it follows from the tables of the reports.
#[must_use]
pub fn claims_table(reports: &[Report]) -> Table {
    let mut table = Table::new(&[
        ("stated", "stated"),
        ("on", "on"),
        ("kind", "kind"),
        ("paper", "paper"),
        ("half_unit", "half unit"),
        ("comparisons", "comparisons"),
        ("value", "value"),
        ("low", "low"),
        ("high", "high"),
        ("repeats", "repeats"),
        ("samples", "samples"),
        ("verdict", "verdict"),
        ("table", "table"),
        ("column", "column"),
        ("repeats_by", "repeats by"),
        ("terms", "terms"),
    ]);
    for (_, claim) in claims_of(reports, false) {
        for test in &claim.tests {
            table.push(claim_row(claim, test));
        }
    }
    table
}

fn claim_row(claim: &Claim, test: &ClaimMeasurement) -> Vec<Cell> {
    let half_unit = match claim.paper {
        // Only a stated level has a last digit, within half a unit of which a number agrees.
        Stated::Level(_, half_unit) => Some(half_unit),
        _ => None,
    };
    let [low, high] = test.interval;
    vec![
        claim.stated.as_str().into(),
        test.on.as_str().into(),
        claim.paper.kind().into(),
        claim.paper.number().into(),
        half_unit.into(),
        claim.comparisons.into(),
        test.value.into(),
        low.into(),
        high.into(),
        test.repeats.into(),
        test.samples.into(),
        claim.verdict_on(test).describe().into(),
        test.source.table.as_str().into(),
        test.source.column.as_str().into(),
        test.source.repeats_by.as_str().into(),
        test.source.terms.as_str().into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::contrast::{Contrast, Statement};
    use super::*;

    #[test]
    fn every_statement_has_a_row_with_its_numbers() {
        let mut one = Report::new("one", "One");
        let mut table = Table::new(&[("points", "points"), ("needed", "needed")]);
        table.push(vec![4usize.into(), 71.36.into()]);
        one.table("rounds", "Rounds.", table);
        let needed = Contrast::exact("rounds", "needed").plus(&[("points", "4")]);
        Statement::new("rounds", Stated::Level(71.0, 0.5), "").test(&mut one, &[("exact", needed)]);
        let mut two = Report::new("two", "Two");
        Statement::new("small", Stated::Nothing, "no number").test(&mut two, &[]);
        Statement::new("slow", Stated::AtMost(0.0), "").test_times(&mut two, &[]);
        let text = page(&[one.clone(), two.clone(), Report::new("three", "Three")]);
        assert!(
            text.contains("2 statements on the paper's own forest: 1 confirmed, 0 smaller"),
            "{text}"
        );
        assert!(
            text.contains("| rounds (one) | 71 | exact: 71.36 | 1 | confirmed | – | – |"),
            "{text}"
        );
        assert!(text.contains("not comparable | – | no number |") && !text.contains("slow"));
        assert!(times_page(&[two.clone()]).contains("slow"));
        assert_eq!(page(&[Report::new("three", "Three")]), "");
        let file = claims_table(&[one, two]);
        assert_eq!(file.rows.len(), 1);
        assert!(
            file.to_csv()
                .ends_with("confirmed,one-rounds,needed,,points=4: 1\n")
        );
    }
}
