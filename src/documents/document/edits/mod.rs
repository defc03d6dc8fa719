//! Changes of a document: edits as the journal stores them, and undo. An edit says how two states
//! differ, frame by frame; the history keeps whole states and replays edits into them. Versions
//! that developed apart are joined in `versions`, not here.

mod beneath;
pub mod edit;
pub mod edit_mismatch;
pub mod frame_changes;
pub mod history;
pub mod step_edit;
pub mod suggestion_change;
