//! Merges versions of the document: one that another program wrote, and edits to another version
//! that were set aside.

use crate::app::effect::{Effect, OrphanOrder, OutsideOrder};
use crate::app::window_state::session::{Dialog, Level, Mode, Opening};
use crate::app::{App, Command, OutsideChoice};
use std::path::{Path, PathBuf};
use touchline_calibration::calibrate::{SolvedAfterMerge, solve_after_merge};
use touchline_core::field::FieldError;
use touchline_documents::document::{Document, Merged, Step, merge};
use touchline_documents::store::{Orphan, OrphanEdits, Outside};

/// Maximum number of conflicts that are listed by name.
const NAMED: usize = 3;

/// What is merged into the document.
#[derive(Clone, Copy)]
enum MergeOf {
    /// The version that another program wrote.
    Outside,
    /// Edits that were set aside.
    SetAside,
}

impl MergeOf {
    /// The name of the step of undo.
    const fn step(self) -> &'static str {
        match self {
            Self::Outside => "Merge another program's changes",
            Self::SetAside => "Merge edits that were set aside",
        }
    }

    /// The text before the list of what both sides changed.
    const fn describe_conflicts(self) -> &'static str {
        match self {
            Self::Outside => "Changed on both sides, your version is kept",
            Self::SetAside => "Changed on both sides",
        }
    }
}

impl App {
    /// Handles a change of the document by another program. Opens the dialog once, and again
    /// whenever the user wants to leave the document; in between a row at the top of the window
    /// shows the state. Until the user decides, the window's version (`own`) is listed among the
    /// edits that were set aside.
    pub(in crate::app::update) fn handle_outside_change(
        &mut self,
        path: PathBuf,
        own: Option<Orphan>,
    ) {
        let is_leaving = self.stay().is_some();
        if self.session.disk.changed_outside.replace(path).is_none() || is_leaving {
            self.session.dialog = Some(Dialog::ChangedOutside);
        }
        if let Some(own) = own {
            self.session
                .disk
                .orphans
                .retain(|orphan| orphan.path != own.path);
            self.session.disk.own_version = Some(own.path.clone());
            self.session.disk.orphans.push(own);
        }
    }

    /// Carries out the user's decision about the other program's version.
    pub(in crate::app::update) fn resolve_outside(&mut self, choice: OutsideChoice) {
        self.session.dialog = None;
        let Some(open) = &self.open else { return };
        match choice {
            OutsideChoice::Merge => self.effects.push(Effect::Outside(OutsideOrder::Read)),
            OutsideChoice::Replace => self.effects.push(Effect::Outside(OutsideOrder::SaveOver)),
            OutsideChoice::TakeTheirs => {
                self.session.disk.opening = Some("Opening the other version…".to_owned());
                self.effects
                    .push(Effect::Open(Opening::Again(open.file.clone())));
            }
        }
    }

    /// Merges another program's changes with the user's. The other version is set aside in any
    /// case.
    pub(in crate::app::update) fn merge_outside(&mut self, outside: &Outside) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let merged = merge(&outside.base, &open.document, &outside.theirs);
        if self.take_merged(merged, Some(&outside.theirs), MergeOf::Outside) {
            self.effects.push(Effect::Outside(OutsideOrder::SaveOver));
        }
    }

    /// Reports edits that were set aside beside the document.
    pub(super) fn report_orphans(&mut self) {
        let count: usize = self
            .session
            .disk
            .orphans
            .iter()
            .map(|orphan| orphan.edits.len())
            .sum();
        if count > 0 {
            let edits = if count == 1 {
                "1 edit".to_owned()
            } else {
                format!("{count} edits")
            };
            let text = format!("{edits} of another version of this document are set aside.");
            self.session
                .notify_with(Level::Warning, text, [("Look at them", Command::Orphans)]);
        }
    }

    /// Merges edits that were set aside into the document.
    pub(in crate::app::update) fn merge_orphan(&mut self, orphan: PathBuf, edits: &OrphanEdits) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let merged = edits.merge_with(&open.document);
        if self.take_merged(merged, edits.result().as_ref(), MergeOf::SetAside) {
            self.effects.push(Effect::Orphan {
                file: orphan,
                order: OrphanOrder::PutAway,
            });
        }
    }

    /// Handles the renaming of a file whose edits are merged.
    pub(in crate::app::update) fn orphan_put_away(&mut self, orphan: &Path, renamed: &Path) {
        self.session
            .disk
            .orphans
            .retain(|known| known.path != orphan);
        if self.session.disk.orphans.is_empty() && self.session.dialog == Some(Dialog::Orphans) {
            self.session.dialog = None;
        }
        self.session.note(format!(
            "The edits are merged; their file is now {}.",
            renamed.display()
        ));
    }

    /// Replaces the open document by a merged one, as one step of undo; the same frame stays shown.
    /// Solves the frames again that the other side solved on another base. Lists conflicts and
    /// replaced labels. Returns false if the document cannot be changed.
    fn take_merged(&mut self, merged: Merged, theirs: Option<&Document>, of: MergeOf) -> bool {
        if !self.begin_step(Step::on_document(of.step())) {
            return false;
        }
        let Some(open) = &mut self.open else {
            return false;
        };
        let ours = open.document.clone();
        let Merged {
            mut document,
            conflicts,
        } = merged;
        // A merged frame may come from a side with another base or field than the merged ones.
        let sides: Vec<&Document> = std::iter::once(&ours).chain(theirs).collect();
        let solved = solve_after_merge(&mut document, &sides, &open.folder);
        let replaced = frames_with_replaced_label(&ours, &document);
        *open.document = document;
        self.follow_frames(&ours.frames);
        self.session.mode = Mode::Idle;
        self.session.points.selected = None;
        self.session.frames_selected.clear();
        // `solve_after_merge` has updated the frames already.
        self.close_step();
        self.report_merged(of, solved, &conflicts, &replaced);
        true
    }

    /// Reports the result of a merge, with a button to undo it.
    fn report_merged(
        &mut self,
        of: MergeOf,
        solved: Result<SolvedAfterMerge, FieldError>,
        conflicts: &[String],
        replaced: &[String],
    ) {
        let mut sentences = vec!["Both versions are merged.".to_owned()];
        let mut level = Level::Info;
        // Conflicts and replaced labels make the message a warning.
        if !conflicts.is_empty() {
            sentences.push(format!(
                "{}: {}.",
                of.describe_conflicts(),
                name_some(conflicts)
            ));
            level = Level::Warning;
        }
        if !replaced.is_empty() {
            sentences.push(format!(
                "Taken from the other version: {}.",
                name_some(replaced)
            ));
            level = Level::Warning;
        }
        match solved {
            Ok(SolvedAfterMerge {
                solved: 0,
                withdrawn,
                ..
            }) => self.report_withdrawn(withdrawn),
            Ok(SolvedAfterMerge {
                solved, withdrawn, ..
            }) => {
                let frames = if solved == 1 { "frame" } else { "frames" };
                sentences.push(format!(
                    "Solved again on the merged base or field: {solved} {frames}."
                ));
                self.report_withdrawn(withdrawn);
            }
            Err(error) => {
                sentences.push(format!(
                    "Frames of another base were not solved again: {error}."
                ));
                level = Level::Warning;
            }
        }
        self.session
            .notify_with(level, sentences.join(" "), [("Undo", Command::Undo)]);
    }
}

/// The names of the frames in which a merge replaced or removed the user's label.
fn frames_with_replaced_label(before: &Document, now: &Document) -> Vec<String> {
    let replaced = before.frames.iter().filter(|frame| frame.gives_way_in(now));
    replaced.map(|frame| frame.name()).collect()
}

/// The first [`NAMED`] names as a list, and the number of the rest.
fn name_some(names: &[String]) -> String {
    let named = &names[..names.len().min(NAMED)];
    let more = names.len() - named.len();
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    named.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, DiskReport, EditAction};
    use touchline_core::testing::{HD, base_at};
    use touchline_documents::testing::{WithFrames, match_from};

    /// Three frames of a camera with a base.
    fn app() -> App {
        App::with_document(match_from(&base_at([0.0, -60.0, 18.0], HD), HD).with_numbered(3, HD))
    }

    /// Whether an estimation that was started before an action goes on after it.
    fn outlasts(app: &mut App, action: Action) -> bool {
        app.update(Action::Command(Command::EstimateBase));
        assert!(app.operations.base_estimate.running().is_some());
        app.update(action);
        app.operations.base_estimate.running().is_some()
    }

    #[test]
    fn an_estimate_ends_with_the_order_of_the_frames_that_it_names() {
        let mut app = app();
        let comment = EditAction::SetComment("blurred".to_owned());
        assert!(outlasts(&mut app, Action::Edit(comment)));
        assert!(outlasts(&mut app, Action::Command(Command::Undo)));
        let base = (*app.open().unwrap().document).clone();
        let mut theirs = base.clone();
        drop(theirs.frames.remove(2));
        let outside = Box::new(Outside { base, theirs });
        let report = Action::Disk(DiskReport::Outside(outside));
        assert!(!outlasts(&mut app, report));
        assert_eq!(app.open().unwrap().document.frames.len(), 2);
        assert!(!outlasts(&mut app, Action::Command(Command::Undo)));
        assert_eq!(app.open().unwrap().document.frames.len(), 3);
        assert!(!outlasts(&mut app, Action::Command(Command::Redo)));
        assert_eq!(app.open().unwrap().document.frames.len(), 2);
    }
}
