//! The camera without a click, on drawn matches and on inputs that must fail: how often it is right,
//! wrong, undecided or silent. Printed as Markdown. Studies on other clips are in the laboratory.
//!
//! Not a divan bench: what counts is the share of right answers, the times beside it.
//! `cargo bench --bench no_click [-- drawn refused] [--matches N] [--from K] [--frames N] [--keep DIR] [--gate]`.
//! With `--two-clicks` drawn matches are found from two clicks each. With `--keep` drawn pictures
//! stay in a folder and are used again. With `--gate` it fails where a section is below its rate,
//! which is stated beside its inputs.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing"
)]

mod answers;
#[path = "../arguments.rs"]
mod arguments;
mod drawing;
mod gate;
mod matches;
mod refused;

use answers::Tally;
use arguments::Arguments;
use gate::{Gate, Rate};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::of_process();
    let sections = ["drawn", "refused"];
    let wants = |name: &str| arguments.wants(name, &sections);
    let kept = arguments.value("--keep").map(PathBuf::from);
    let scratch = tempfile::tempdir().unwrap();
    let pictures = kept.as_deref().unwrap_or(scratch.path());
    let (from, count) = (
        arguments.number("--from", 0),
        arguments.number("--matches", matches::RATE.tried),
    );

    let mut all = Tally::default();
    let mut gate = Gate::default();
    let mut answered = |section: &str, tally: &Tally, rate: &Rate| {
        all.add(tally);
        gate.compare(section, tally, rate);
    };
    if wants("drawn") {
        let frames = arguments.number("--frames", matches::FRAMES);
        let drawn = matches::drawn_matches(
            pictures,
            from..from + count,
            frames,
            arguments.is_set("--two-clicks"),
        );
        if !arguments.is_set("--two-clicks") {
            answered("drawn", &drawn.without_clicks, &matches::RATE);
        }
        if drawn.two_clicks.num_tried() > 0 {
            answered(
                "drawn, with two clicks",
                &drawn.two_clicks,
                &matches::TWO_CLICKS_RATE,
            );
        }
    }
    if wants("refused") {
        let count = arguments
            .number("--matches", refused::INPUTS.len())
            .min(refused::INPUTS.len().saturating_sub(from));
        answered(
            "refused",
            &refused::bad_inputs(pictures, from..from + count),
            &refused::RATE,
        );
    }
    println!("\nIn all: {all}");
    if !arguments.is_set("--gate") {
        return ExitCode::SUCCESS;
    }
    let (lines, failed) = gate.verdict();
    println!("\n{lines}");
    if failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
