//! The commands, one file each, run as a script runs them: results, exit codes, and the one-line
//! error for wrong usage. What a command calculates is tested where the function lies. Kills and
//! full disks are in `robustness`.

mod calibrate_clicked;
mod calibrate_command;
mod cli_documents;
mod dataset_command;
mod evaluate_command;
mod exchange_commands;
mod fields_command;
mod mend_command;
mod merge_command;
mod no_laboratory;
mod points_command;
mod queue_command;
pub mod refine_base_command;
pub mod relocalize_command;
mod season_commands;
mod synth_command;
mod track_command;
mod unreadable_end;
mod unseen_length;
mod venue_command;
mod window_command;
