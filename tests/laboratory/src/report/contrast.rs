//! What a claim measures: a weighted sum of means of one column of a report's table.
//!
//! Claims are computed from the tables that are written as files, and from nothing else, so that
//! anybody can compute them again from these files (`tests/experiments/recompute.py` does).

use super::statistics::{interval_of_mean, mean_sd};
use crate::report::{Claim, ClaimMeasurement, Report, Source, Stated};
use touchline::report::{Cell, Table};

/// A weighted sum of means. A mean is that of one column over the rows that a term selects, in each
/// repetition (each seed, or each camera).
#[derive(Clone, Debug)]
pub struct Contrast {
    /// Name of the table within the report, without the report's name.
    table: &'static str,
    column: &'static str,
    repeats_by: &'static str,
    terms: Vec<Term>,
}

/// A weight, and the cells that a row must have.
#[derive(Clone, Debug)]
struct Term {
    weight: f64,
    cells: Vec<(&'static str, String)>,
}

impl Contrast {
    /// Means of a column of a table with a row for each test frame.
    pub const fn over_frames(column: &'static str) -> Self {
        Self::over("frames", column, "seed")
    }

    /// Means of a column of a table whose repetitions another column numbers.
    pub const fn over(table: &'static str, column: &'static str, repeats_by: &'static str) -> Self {
        Self {
            table,
            column,
            repeats_by,
            terms: Vec::new(),
        }
    }

    /// Numbers of a table that are exact: one row for each term.
    pub const fn exact(table: &'static str, column: &'static str) -> Self {
        Self::over(table, column, "")
    }

    /// Adds the mean over the rows with these cells.
    pub fn plus(self, cells: &[(&'static str, &str)]) -> Self {
        self.add(1.0, cells)
    }

    /// Subtracts the mean over the rows with these cells.
    pub fn minus(self, cells: &[(&'static str, &str)]) -> Self {
        self.add(-1.0, cells)
    }

    /// Adds a multiple of the mean over the rows with these cells.
    pub fn add(mut self, weight: f64, cells: &[(&'static str, &str)]) -> Self {
        let cells = cells.iter().map(|(key, text)| (*key, (*text).to_owned()));
        self.terms.push(Term {
            weight,
            cells: cells.collect(),
        });
        self
    }

    /// Measures it in a report's table. NaN if the report has no such table, or no row for a term.
    fn measure(&self, report: &Report, on: &str, comparisons: usize) -> ClaimMeasurement {
        let file = format!("{}-{}", report.name, self.table);
        // The table is found by the name of its file, the same that the claim states as its source.
        let values = report
            .table_of_file(&file)
            .map_or_else(Vec::new, |table| self.by_repeat(table));
        let sums: Vec<f64> = values.iter().map(|(sum, _)| *sum).collect();
        let value = mean_sd(&sums)[0];
        // An exact number has no interval.
        let interval = if self.repeats_by.is_empty() {
            [value; 2]
        } else {
            interval_of_mean(&sums, comparisons)
        };
        ClaimMeasurement {
            on: on.to_owned(),
            value,
            interval,
            repeats: sums.len(),
            samples: values.iter().map(|(_, rows)| rows).sum(),
            source: self.source(file),
        }
    }

    /// The sum of all terms, and the number of rows, in each repetition that has rows for each
    /// term.
    fn by_repeat(&self, table: &Table) -> Vec<(f64, usize)> {
        let repeat_of = |row: &[Cell]| {
            let column = table.column(self.repeats_by);
            column.map_or_else(String::new, |column| row[column].exact())
        };
        // Repetitions are compared as texts, as they are written in the file. In order of
        // appearance, which does not depend on a hash.
        let mut repeats: Vec<String> = Vec::new();
        for row in &table.rows {
            let repeat = repeat_of(row);
            if !repeats.contains(&repeat) {
                repeats.push(repeat);
            }
        }
        let sum = |repeat: &String| {
            let rows: Vec<&Vec<Cell>> = table
                .rows
                .iter()
                .filter(|row| repeat_of(row) == *repeat)
                .collect();
            // Empty cells are no numbers and are left out of a mean. A repetition that lacks one
            // term says nothing about the sum.
            let means = self.terms.iter().map(|term| {
                let values = term.values(table, &rows, self.column);
                (!values.is_empty()).then(|| (term.weight * mean_sd(&values)[0], values.len()))
            });
            // The sum is taken within each repetition, before the mean over them: what a seed makes
            // easier for both sides then cancels.
            let parts: Vec<(f64, usize)> = means.collect::<Option<_>>()?;
            Some((
                parts.iter().map(|(part, _)| part).sum(),
                parts.iter().map(|(_, rows)| rows).sum(),
            ))
        };
        repeats.iter().filter_map(sum).collect()
    }

    fn source(&self, table: String) -> Source {
        // The form that `tests/experiments/recompute.py` parses.
        let terms = self.terms.iter().map(|term| {
            let cells = term.cells.iter().map(|(key, text)| format!("{key}={text}"));
            format!("{}: {}", cells.collect::<Vec<_>>().join(" & "), term.weight)
        });
        Source {
            table,
            column: self.column.to_owned(),
            repeats_by: self.repeats_by.to_owned(),
            terms: terms.collect::<Vec<_>>().join(" | "),
        }
    }
}

impl Term {
    /// The numbers of a column in the rows that it selects.
    fn values(&self, table: &Table, rows: &[&Vec<Cell>], column: &str) -> Vec<f64> {
        let is_selected = |row: &&&Vec<Cell>| {
            self.cells.iter().all(|(key, text)| {
                let column = table.column(key);
                // All digits, not those that a reader is shown: two noises must not become one by
                // rounding.
                column.is_some_and(|column| row[column].exact() == *text)
            })
        };
        let Some(column) = table.column(column) else {
            return Vec::new();
        };
        let selected = rows.iter().filter(is_selected);
        selected.filter_map(|row| row[column].number()).collect()
    }
}

/// A statement of the paper, to be tested on tables that the report has already.
pub struct Statement<'a> {
    pub words: &'a str,
    pub paper: Stated,
    /// Number of comparisons that the statement makes at once.
    pub comparisons: usize,
    /// What limits the comparison, or why there is none. May be empty.
    pub reason: &'a str,
}

impl<'a> Statement<'a> {
    /// A statement that makes one comparison.
    pub const fn new(words: &'a str, paper: Stated, reason: &'a str) -> Self {
        Self {
            words,
            paper,
            comparisons: 1,
            reason,
        }
    }

    /// Adds the statement and its measurements to a report. The first measurement decides.
    pub fn test(&self, report: &mut Report, tests: &[(&str, Contrast)]) {
        let measured = tests
            .iter()
            .map(|(on, contrast)| contrast.measure(report, on, self.comparisons))
            .collect();
        report.claims.push(Claim {
            stated: self.words.to_owned(),
            paper: self.paper,
            tests: measured,
            comparisons: self.comparisons,
            reason: self.reason.to_owned(),
            is_about_times: false,
        });
    }

    /// Adds a statement about times, which depend on the machine.
    pub fn test_times(&self, report: &mut Report, tests: &[(&str, Contrast)]) {
        self.test(report, tests);
        if let Some(claim) = report.claims.last_mut() {
            claim.is_about_times = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Verdict;

    fn report() -> Report {
        let mut table = Table::new(&[("way", "way"), ("seed", "seed"), ("iou", "IoU")]);
        for (way, seed, iou) in [
            ("one", 0usize, Cell::Number(0.5)),
            ("one", 0, Cell::Number(0.7)),
            ("one", 0, Cell::Empty),
            ("two", 0, Cell::Number(0.4)),
            ("one", 1, Cell::Number(0.8)),
            ("two", 1, Cell::Number(0.6)),
            // No row of the other way: this seed says nothing about the difference.
            ("one", 2, Cell::Number(0.0)),
        ] {
            table.push(vec![way.into(), seed.into(), iou]);
        }
        let mut report = Report::new("trial", "Trial");
        report.data("frames", "Every frame.", table);
        report
    }

    #[test]
    fn a_difference_is_taken_in_each_seed() {
        let contrast = Contrast::over_frames("iou")
            .plus(&[("way", "one")])
            .minus(&[("way", "two")]);
        let found = contrast.measure(&report(), "both", 1);
        assert!((found.value - 0.2).abs() < 1e-12, "{found:?}");
        assert!((found.interval[1] - found.interval[0]).abs() < 1e-9);
        assert_eq!((found.repeats, found.samples), (2, 5));
        assert_eq!(found.source.table, "trial-frames");
        assert_eq!(found.source.terms, "way=one: 1 | way=two: -1");
    }

    #[test]
    fn what_a_report_does_not_have_is_undecided() {
        let mut report = report();
        let none = Contrast::over_frames("none").plus(&[("way", "one")]);
        let statement = Statement::new("better", Stated::Positive, "");
        statement.test(&mut report, &[("published", none)]);
        assert_eq!(report.claims[0].verdict(), Verdict::Undecided);
        assert_eq!(report.claims[0].tests[0].repeats, 0);
    }
}
