//! The camera without a click, on drawn clips of a bowl, on fewer and fewer views, and on real
//! frames: how often it is right, wrong, undecided or silent. Printed as Markdown.
//!
//! `cargo bench --bench no_click_studies [-- bowl spread real clips wild] [--matches N] [--from K] [--keep DIR] [--gate]`
//! in `tests/laboratory`; the real frames are those of `TOUCHLINE_DATA`. With `--keep` drawn
//! pictures stay in a folder and are used again. With `--gate` it fails where a section is below its
//! rate, which is stated beside its inputs. Drawn matches and inputs that must fail are the
//! program's own bench `no_click`.
#![allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing, and does not use all that it shares"
)]

#[path = "../../../benches/no_click/answers.rs"]
mod answers;
#[path = "../../../benches/arguments.rs"]
mod arguments;
mod bowl;
#[path = "../../../benches/no_click/drawing.rs"]
mod drawing;
#[path = "../../../benches/no_click/gate.rs"]
mod gate;
#[path = "../../../benches/no_click/matches.rs"]
mod matches;
mod real;
#[path = "../scaled_camera.rs"]
mod scaled_camera;
mod spread;
#[path = "../video_document.rs"]
mod video_document;
mod wild;

use answers::Tally;
use arguments::Arguments;
use gate::{Gate, Rate};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::of_process();
    let sections = ["bowl", "spread", "real", "clips", "wild"];
    let wants = |name: &str| arguments.wants(name, &sections);
    let kept = arguments.value("--keep").map(PathBuf::from);
    let scratch = tempfile::tempdir().unwrap();
    let pictures = kept.as_deref().unwrap_or(scratch.path());
    let (from, count) = (
        arguments.number("--from", 0),
        arguments.number("--matches", bowl::RATE.tried),
    );

    let mut all = Tally::default();
    let mut gate = Gate::default();
    let mut answered = |section: &str, tally: &Tally, rate: &Rate| {
        all.add(tally);
        gate.compare(section, tally, rate);
    };
    if wants("bowl") {
        let drawn = bowl::clips(pictures, from..from + count);
        answered("bowl", &drawn.without_clicks, &bowl::RATE);
        if drawn.two_clicks.num_tried() > 0 {
            answered("bowl, with two clicks", &drawn.two_clicks, &bowl::RATE);
        }
    }
    if wants("spread") {
        answered("spread", &spread::spread(pictures), &spread::RATE);
    }
    match std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) {
        None => {
            println!("\nreal frames are skipped: TOUCHLINE_DATA names no folder of them");
            // Who names them wants to know how they are answered.
            for section in ["real", "clips", "wild"]
                .into_iter()
                .filter(|name| arguments.is_set(name))
            {
                answered(section, &Tally::default(), &real::MATCHES_RATE);
            }
        }
        Some(data) => {
            if wants("real") {
                answered("real", &real::matches(&data), &real::MATCHES_RATE);
                answered("real, others", &real::others(&data), &real::OTHERS_RATE);
            }
            if wants("clips") {
                answered("clips", &real::clips(&data), &real::CLIPS_RATE);
            }
            if wants("wild") {
                answered("wild", &wild::clips(&data), &wild::RATE);
            }
        }
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
