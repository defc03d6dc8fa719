//! Finds everything that is wrong with a document. Each kind of error has a name.

mod cameras;
mod fault;
mod pictures;
mod plausible;
mod stale;
mod still;
mod values;

pub use cameras::check_cameras;
pub use fault::{Fault, Problem};
pub use pictures::{PictureCheck, check_pictures};
pub use plausible::impossible_camera;
pub use stale::check_solutions;
pub use still::check_still_runs;
pub use values::check_values;
