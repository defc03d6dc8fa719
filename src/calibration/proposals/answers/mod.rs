//! The forest's answers: a proposed camera for a frame, the evidence of painted lines for it, and
//! the suggestions that stay beside the user's edits until they are accepted or discarded. A
//! request remembers the state of its frame, so that stale answers are recognised. The forest is
//! trained in `training`.

pub mod expected_wrong;
pub mod line_evidence;
pub mod order;
pub mod project;
pub mod proposal;
pub mod proposing;
pub mod request;
pub mod suggestions;
pub mod tracked;
