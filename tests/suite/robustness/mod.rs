//! Work that is disturbed: the program is killed, places fail, the disk refuses, and a person works
//! for hours. Nothing that was acknowledged may be lost. Commands that run undisturbed are in
//! `commands`.

mod failing_places;
mod killed;
mod nothing_lost_by_force;
mod project_that_goes_on;
mod random_kills;
mod soak;
