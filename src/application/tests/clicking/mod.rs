//! Clicks, names and masks, changed by actions as the window sends them. The rooms of `app/update`
//! have the same names. Decisions about frames are tested in `reviewing`.

mod gold_in_app;
mod grab_in_app;
pub mod masks_in_app;
pub mod names_in_app;
mod snapped_points_in_app;
