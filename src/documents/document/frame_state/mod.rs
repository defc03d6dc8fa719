//! What the records of one frame mean together: its solution or the lack of one, the program's
//! suggestion for it, whether it trains the forest or counts for its camera's base, and its blind
//! clicks as a gold frame. The types of these records are in `model`. Nothing here solves a frame
//! or changes a file.

mod earlier_state;
pub mod frame_solution;
pub mod gold;
mod ground;
pub mod model_points;
pub mod moment;
pub mod overlay_sigma;
pub mod suggestion;
mod unanswered;
mod uses;
