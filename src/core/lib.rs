//! A pan-tilt-zoom camera over a sports field, as mathematics: no picture, no document, no disk but
//! what it is given.
//!
//! | floor | rooms |
//! |---|---|
//! | 3 | [`solve`] (observations to cameras), [`score`] (how far a camera is from the true one) |
//! | 2 | [`markings`] (the field's lines as a camera sees them) |
//! | 1 | [`camera`], [`field`] |
//! | 0 | [`geometry`], [`files`] (opening files that may come from anybody), [`progress`] (what long functions report to) |
//!
//! Frames, signs and units of all numbers: [`conventions`].

#[doc = include_str!("conventions.md")]
pub mod conventions {}

pub mod camera;
pub mod field;
pub mod files;
pub mod geometry;
pub mod markings;
pub mod progress;
pub mod score;
pub mod solve;
#[cfg(any(test, feature = "testing"))]
#[doc(hidden)]
pub mod testing;
