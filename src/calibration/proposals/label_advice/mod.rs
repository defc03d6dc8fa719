//! Advice on where to label next: which directions the references see, which frames need a label,
//! and which of them helps most. It is updated from the frames that changed, so that panels can ask
//! after every edit. It changes nothing in the document.

pub mod advice;
pub mod coverage;
pub mod label_needs;
mod needing_frames;
