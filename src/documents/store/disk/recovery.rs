//! What opening a document recovered from its journal, and the report of it to the user.

use crate::store::history_file::HistoryLeftOut;
use std::path::PathBuf;
use touchline_core::geometry::pluralise;

/// What was recovered from a journal when a document was opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovery {
    /// The names of the recovered edits, oldest first. The opened document contains them; its file
    /// does not.
    pub edits: Vec<String>,
    /// Number of unreadable bytes at the journal's end.
    pub lost_bytes: u64,
    /// The name of the first edit that does not apply to the document, and the number of edits from
    /// it to the journal's end. None of them is in the document.
    pub misfit: Option<(String, usize)>,
    /// The path under which a journal was kept because it is damaged or belongs to another
    /// document.
    pub set_aside: Option<PathBuf>,
    /// Number of edits in a journal that starts from another document. They are not in the
    /// document.
    pub foreign_edits: usize,
    /// Why the steps of earlier sessions cannot be undone, if they cannot.
    pub history: Option<HistoryLeftOut>,
}

impl Recovery {
    /// Whether there is nothing to report.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The report to the user, in a few sentences; none if there is nothing to report.
    pub fn message(&self) -> Option<String> {
        let mut sentences = Vec::new();
        match &self.edits[..] {
            [] => {}
            [one] => sentences.push(format!("Recovered 1 edit: {one}.")),
            [.., last] => sentences.push(format!(
                "Recovered {} edits, the last one: {last}.",
                self.edits.len()
            )),
        }
        if self.lost_bytes > 0 {
            sentences.push(format!(
                "The journal is incomplete: {} at its end cannot be read.",
                pluralise(self.lost_bytes as usize, "byte")
            ));
        }
        if let Some((name, left_out)) = &self.misfit {
            // The number counts the edit itself, so it is at least 1.
            let others = match left_out - 1 {
                0 => "it is".to_owned(),
                1 => "it and 1 edit after it are".to_owned(),
                others => format!("it and {others} edits after it are"),
            };
            sentences.push(format!(
                "The edit {name:?} does not apply to the document: {others} left out."
            ));
        }
        if self.foreign_edits > 0 {
            let edits = if self.foreign_edits == 1 {
                "edit is"
            } else {
                "edits are"
            };
            sentences.push(format!(
                "Another program changed the document: {} {edits} not in it.",
                self.foreign_edits
            ));
        }
        if let Some(path) = &self.set_aside {
            sentences.push(format!("The journal is kept as {}.", path.display()));
        }
        if let Some(left_out) = &self.history {
            sentences.push(format!(
                "Steps of earlier sessions cannot be undone: {left_out}."
            ));
        }
        (!sentences.is_empty()).then(|| sentences.join(" "))
    }
}
