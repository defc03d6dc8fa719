//! What made a report.

use serde_json::{Value, json};

/// What made a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// The program and its version.
    pub program: String,
    /// The commit that it was built from; none where the build did not say.
    pub commit: Option<String>,
    /// The command that made the report.
    pub command: String,
    /// The seeds of all random numbers.
    pub seeds: Vec<u64>,
    /// Whether everything was a tenth or less of its size.
    pub quick: bool,
}

impl Provenance {
    /// For people: one sentence or two.
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
