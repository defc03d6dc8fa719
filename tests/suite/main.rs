//! Every test that looks at the library and the program from outside, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod alignment;
mod annotators;
mod app;
mod architecture;
mod around_the_field;
mod bad_documents;
mod bad_fields;
mod bad_images;
mod base_in_app;
mod base_truth;
mod bench;
mod bulk_in_app;
mod burnt_in;
mod calibrate_command;
mod child;
mod cli_documents;
mod contradictions;
mod dataset_command;
mod described_scene;
mod document;
mod evaluate_command;
mod exchange_commands;
mod experiment_command;
mod failing_places;
mod features;
mod fields;
mod fields_command;
mod files;
mod find_camera_in_app;
mod forest;
mod given_data;
mod gold_in_app;
mod headless;
mod identity;
mod journal;
mod kept_edits;
mod killed;
mod library;
mod masks_in_app;
mod merge_command;
mod names_in_app;
mod nothing_lost_by_force;
mod nothing_unasked;
mod operations_in_app;
mod outside;
mod paint;
mod paint_in_app;
mod places_in_app;
mod pose;
mod program;
mod published_figures;
mod quality_in_app;
mod random_kills;
mod refine_base_command;
mod relocalize_command;
mod review_in_app;
mod seeded;
mod session;
mod shaders;
mod shots_in_app;
mod snapped_points_in_app;
mod snapped_suggestions;
mod soak;
mod strings;
mod suggestions_in_app;
mod synth_command;
mod synthetic;
mod track_command;
mod trainer;
mod transfer_in_app;
mod trust;
mod two_point_truth;
mod undo_after_restart;
mod undo_in_app;
mod unseen_length;
mod which_camera;
mod window_command;
