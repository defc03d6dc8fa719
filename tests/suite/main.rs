//! Every test that looks at the library and the program from outside, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/bench.rs"]
mod bench;
mod drawn;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/headless.rs"]
mod headless;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/program.rs"]
mod program;

mod annotators;
mod architecture;
mod base_in_app;
mod commands;
mod drawn_clip;
mod figures;
mod ground_grades;
mod library;
mod paint;
mod paint_in_app;
mod robustness;
mod snapped_suggestions;
mod steps;
mod strings;
mod trainer;
