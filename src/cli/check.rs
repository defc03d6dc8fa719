//! `touchline check`: lists the problems of a document.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, Loaded};
use crate::cli::terminal::messages::{Messages, count_steps};
use crate::cli::terminal::output::print;
use serde_json::{Value, json};
use std::fmt::Write;
use touchline_calibration::calibrate::{
    Problem, check_cameras, check_pictures, check_solutions, check_still_runs, check_values,
};
use touchline_core::files::plain;
use touchline_core::geometry::pluralise;
use touchline_documents::document::Document;

/// Lists everything wrong with a document; exit 1 if there is anything.
#[derive(clap::Args, Debug)]
pub struct CheckArgs {
    #[command(flatten)]
    document: DocumentArg,
}

/// Prints the problems of a document. [`Outcome::SomeFailed`] if there are any.
///
/// # Errors
/// The document cannot be read.
pub fn check(args: &CheckArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let Loaded { location, document } = args.document.load(messages)?;
    let bar = messages.progress(document.frames.len(), "Checking pictures");
    let at = document.at(location.folder());
    let mut problems = check_values(at);
    problems.extend(check_cameras(at));
    problems.extend(check_solutions(at));
    problems.extend(check_pictures(at, &count_steps(&bar)));
    problems.extend(check_still_runs(at));
    // Problems of the whole document come first, then those of each frame. The sort is stable, so
    // that those of one frame stay in the order of the checks.
    problems.sort_by_key(|problem| problem.frame.map_or(0, |frame| frame + 1));
    bar.finish_and_clear();
    print(&match messages {
        Messages::Text => text(&document, &problems),
        Messages::Json => format!("{:#}\n", report(&document, &problems)),
    })?;
    Ok(Outcome::from_failure(!problems.is_empty()))
}

fn text(document: &Document, problems: &[Problem]) -> String {
    let mut text = String::new();
    for problem in problems {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", plain(&problem.to_string()));
    }
    let clicks = document.frames.iter().map(|frame| frame.clicks.len()).sum();
    let (frames, clicks) = (
        pluralise(document.frames.len(), "frame"),
        pluralise(clicks, "click"),
    );
    let _ = match problems.len() {
        0 => writeln!(text, "No problems: {frames}, {clicks}."),
        count => {
            let problems = pluralise(count, "problem");
            writeln!(text, "{problems} in {frames}, {clicks}.")
        }
    };
    text
}

fn report(document: &Document, problems: &[Problem]) -> Value {
    let problems = problems.iter().map(|problem| {
        json!({
            "code": problem.fault.code(),
            "place": problem.place,
            "frame": problem.frame,
            "message": problem.fault.to_string(),
        })
    });
    let problems: Vec<Value> = problems.collect();
    json!({ "frames": document.frames.len(), "problems": problems })
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn thousands_of_frames_are_set_apart() {
        let mut document = soccer_document();
        for index in 0..1000 {
            let image = format!("{index}.jpg");
            let frame = new_frame(&image, ImageSize::new(64, 48));
            document.frames.push(frame.into());
        }
        assert_eq!(
            text(&document, &[]),
            "No problems: 1,000 frames, 0 clicks.\n"
        );
    }
}
