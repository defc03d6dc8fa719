//! Values that panels show and that follow from the rest of the state: the shown frame's solution,
//! an estimated base that waits for a decision, the next step, and advice where to label.
//! [`current::Current`] is computed again after every action. Nothing here changes the document,
//! and nothing is stored.

pub mod camera_text;
pub mod current;
pub mod guidance;
pub mod progress;
pub mod proposed_base;
pub mod sentence;
pub mod shown;
pub mod where_to_label;
