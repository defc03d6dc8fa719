//! The application without its window, and the rooms that run its work and draw for it. Internal to
//! the program and its tests: it may change at any time.
//!
//! | floor | rooms |
//! |---|---|
//! | 7 | [`jobs`] (the only detached threads), `render` (wgpu, no egui) |
//! | 6 | [`app`] (the whole application without a window) |
//! | 5 | [`scene`] (what is drawn, as plain data) |

#![allow(
    missing_docs,
    reason = "a room of the program itself: what its name says needs no second sentence"
)]

pub mod app;
pub mod jobs;
#[cfg(feature = "render")]
pub mod render;
pub mod scene;
#[cfg(any(test, feature = "testing"))]
#[doc(hidden)]
pub mod testing;
