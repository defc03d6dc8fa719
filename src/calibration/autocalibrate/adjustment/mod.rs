//! Hypotheses: a base with all its frames, adjusted to paint, aligned to pictures and refined:
//! stages 6 to 8.

pub mod align;
pub mod candidates;
pub mod evidence;
pub mod hypothesis;
pub mod joint;
pub mod neighbours;
pub mod paint_on_lines;
pub mod refine;
