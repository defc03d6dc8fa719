//! Two documents compared: how far an estimate is from the truth.
//!
//! ```sh
//! cargo run --example evaluate -- [TRUTH ESTIMATE]
//! ```

use std::env;
use std::error::Error;
use std::path::PathBuf;
use touchline::evaluate::evaluate;
use touchline::store::read;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let mut path = |usual: &str| {
        arguments
            .next()
            .map_or_else(|| PathBuf::from(usual), PathBuf::from)
    };
    let (truth, estimate) = (
        path("projects/demo/truth.json"),
        path("projects/demo/project.json"),
    );
    let (true_location, truth, _) = read(&truth)?;
    let (location, estimate, _) = read(&estimate)?;

    let evaluation = evaluate(
        truth.at(true_location.folder()),
        estimate.at(location.folder()),
    )?;
    let scored = evaluation
        .frames
        .iter()
        .filter(|frame| frame.scores.is_ok())
        .count();
    println!(
        "{scored} of {} frames have a camera in both",
        evaluation.frames.len()
    );
    // The seed decides the resamples of the bootstrap intervals.
    for group in evaluation.groups(0) {
        for (measure, summary) in &group.measures {
            println!(
                "{}: {} median {:.4}, 90 % {:.4}",
                group.name,
                measure.label(),
                summary.median,
                summary.p90
            );
        }
    }
    Ok(())
}
