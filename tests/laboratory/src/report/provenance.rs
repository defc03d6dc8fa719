//! The provenance of a report.

use serde_json::{Value, json};

/// How a report was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// The program and its version.
    pub program: String,
    /// The commit from which the program was built; none if the build did not record it.
    pub commit: Option<String>,
    /// The command that made the report.
    pub command: String,
    /// The seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Whether it was a quick run, with a tenth or less of all sample sizes.
    pub quick: bool,
}

impl Provenance {
    /// The provenance in one or two sentences.
    #[must_use]
    pub fn describe(&self) -> String {
        let commit = self
            .commit
            .as_ref()
            .map_or("commit not stated".to_owned(), |commit| {
                format!("commit {commit}")
            });
        let seeds: Vec<String> = self.seeds.iter().map(ToString::to_string).collect();
        let seeds = match &seeds[..] {
            [one] => format!("seed {one}"),
            several => format!("seeds {}", several.join(", ")),
        };
        let quick = if self.quick {
            " A quick run: a tenth or less of everything, for trying out; quote no figure of it."
        } else {
            ""
        };
        format!(
            "Made by `{}` ({}, {commit}), {seeds}.{quick}",
            self.command, self.program
        )
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "program": self.program,
            "commit": self.commit,
            "command": self.command,
            "seeds": self.seeds,
            "quick": self.quick,
        })
    }
}
