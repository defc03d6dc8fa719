//! The figures of relocalization: accuracy and times side by side, printed as Markdown.
//!
//! Not a divan bench: what counts is the accuracy over whole sets of frames, the times beside it.
//! Times are those of the thread's own processor time, as far as the system tells them. Needs the
//! folder of real frames in `TOUCHLINE_DATA`;
//! `cargo bench --bench relocalize [clicked] [rendered] [frames] [pose] [candidates] [scouting] [coarse] [unmasked] [trust] [videos] [reliability] [growth]`.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing"
)]

mod clicked;
mod coarse_to_fine;
mod growth;
mod pose;
mod proposed;
mod reliability;
mod rendered;
mod scouting;
mod set;
mod time;
mod trust;
mod videos;

use std::path::PathBuf;

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with('-'))
        .collect();
    let wants = |name: &str| asked.is_empty() || asked.iter().any(|argument| argument == name);
    if wants("pose") {
        pose::exact();
    }
    if wants("growth") {
        growth::growth();
    }
    if wants("clicked") {
        clicked::accuracy();
    }
    let Some(data) = std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) else {
        println!("the rest is skipped: TOUCHLINE_DATA names no folder of real frames");
        return;
    };
    if wants("candidates") {
        pose::candidates(&data);
    }
    if wants("rendered") {
        rendered::accuracy(&data);
        rendered::training(&data);
    }
    if wants("frames") {
        rendered::whole_frames(&data);
    }
    if wants("scouting") {
        scouting::accuracy(&data);
    }
    if wants("coarse") {
        coarse_to_fine::coarse_to_fine(&data);
    }
    if wants("unmasked") {
        scouting::accuracy_without_masks(&data);
    }
    if wants("trust") {
        trust::trust(&data);
    }
    if wants("videos") {
        videos::videos(
            &data,
            if asked.iter().any(|argument| argument == "some") {
                8
            } else {
                1
            },
        );
    }
    if wants("reliability") {
        reliability::reliability(&data);
    }
}
