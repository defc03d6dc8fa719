//! A venue known again: the cameras of a stadium in a file, tried on the frames of a new match.
//!
//! # Problem
//!
//! A stadium's cameras stand where they stood, or nearly so. Given: the base of each, the field,
//! and what their pictures looked like. Wanted: which of them took the frames of another match, and
//! whether it still stands there, in seconds and without a search. A wrong base is worse than a
//! search, so that in doubt no camera is recognised.
//!
//! # Idea
//!
//! Features identify, paint decides. Seats, roofs and boards look like no other stadium's, so that
//! a forest that learnt them gives the direction of a frame, or finds none. But they do not say where
//! the camera stands: a forest rotates a camera that was moved until its features fit. The paint of
//! the frames does: each is aligned to its own, the base is estimated anew from all of them, and
//! compared with the known one: by how much better it explains the paint, and by the uncertainty of
//! both.
//!
//! | step | file |
//! |---|---|
//! | A venue's file: a forest of few features, with cameras and field | `file.rs` |
//! | Frames are answered and aligned to their paint; the base is estimated anew | `venue_trial.rs` |
//! | Pictures of another size than those that the venue knows | `size.rs` |
//! | The two bases are compared: same place, turned, moved, or another camera | `change.rs` |
//! | What is reported meanwhile | `event.rs` |
//! | Of several venues the best, if no other one answers nearly as well | `venue_choice.rs` |

mod change;
mod event;
mod file;
mod size;

pub use change::{BaseChange, Whereabouts};
pub use event::{RecognisedCamera, VenueEvent, VenueRefusal};
pub(super) use file::VenueCamera;
pub use file::{NewVenue, VENUE_ENDING, Venue, VenueError, make_venue};
