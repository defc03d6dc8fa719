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
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/child.rs"]
mod child;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/headless.rs"]
mod headless;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/program.rs"]
mod program;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/proposed.rs"]
mod proposed;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/seeded.rs"]
mod seeded;

mod annotators;
mod architecture;
mod base_in_app;
mod calibrate_command;
mod cli_documents;
mod dataset_command;
mod drawn_clip;
mod evaluate_command;
mod exchange_commands;
mod experiment_command;
mod experiment_report;
mod failing_places;
mod fields_command;
mod figures;
mod given_data;
mod killed;
mod library;
mod mend_command;
mod merge_command;
#[cfg(not(feature = "experiments"))]
mod no_experiments;
mod nothing_lost_by_force;
mod paint;
mod paint_in_app;
mod random_kills;
mod refine_base_command;
mod relocalize_command;
mod season_commands;
mod snapped_suggestions;
mod soak;
mod steps;
mod strings;
mod synth_command;
mod track_command;
mod trainer;
mod window_command;
