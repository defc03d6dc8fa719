//! The window, driven through its accessibility nodes and looked at in small pictures.
//!
//! It runs without a display on whatever adapter there is; on a machine without any it says so and is skipped.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that fails should say so at once")]

mod base;
mod cameras;
mod gold;
mod labelling;
mod names;
mod panels;
mod quality;
mod review;
mod trainer;
mod typed;
mod viewport;
mod window;
