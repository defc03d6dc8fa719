//! The base of a camera from its frames alone, without a click.
//!
//! One frame lacks lines, but the frames of one fixed camera together show most of the field. Their pictures tie together by
//! rotation and zoom ([`crate::track`]); paint that many of them show in one direction is drawn on the ground
//! ([`crate::paint::persistent_paint`]); a field of nearly known size fits what is drawn in one way only. Places are tried, the best are adjusted
//! with all frames to the paint in the pictures, and the answer is given where it explains the paint, is seen where it
//! should be, and leaves its rivals behind. Where two landmarks are clicked, they say where it stands in place of the search.

mod answer;
mod camera;
mod candidates;
mod clicked;
mod deciding;
mod doubt;
mod error;
mod evidence;
mod found;
mod held;
mod joint;
mod pitch_map;
mod place;
mod pose;
mod progress;
mod record;
mod refined;
mod rig;
mod search;
mod starts;
mod tied;
mod traces;
mod turn_levels;
mod venue;

pub use answer::{DecidingLandmark, UnclickedAnswer};
pub use camera::{camera_from_few_clicks, camera_without_clicks};
pub use doubt::Doubt;
pub use error::{Abstention, UnclickedError};
pub use evidence::UnclickedEvidence;
pub use found::{UnclickedCamera, UnclickedFrame};
pub use progress::{UnclickedProgress, WatchUnclicked};
pub use record::record_found;
pub use traces::PictureOfFrame;
