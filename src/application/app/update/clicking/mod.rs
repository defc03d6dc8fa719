//! Changes of clicks: placing, moving and removing them, naming them, dragging a drawn line to
//! where the picture shows it, blind clicks on gold frames, and masks. Each is a step of undo.
//! Which names a click may have is worked out elsewhere; here the choice is applied.

mod clicks;
pub mod gold;
mod grabbing;
mod masks;
mod naming;
