//! Cameras against the paint of a picture: where paint is expected and seen, whether a camera
//! passes the line check, and how it is moved until its lines lie on the paint. A small search
//! around the camera finds the right lines first. Ridges themselves are found in `ridges`.

mod alignment;
pub mod check;
pub mod ground_on_field;
mod lens;
pub mod places;
mod search;
mod sightings;
pub mod snap;
mod unexplained;
