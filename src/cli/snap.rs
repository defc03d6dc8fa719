//! `touchline snap`: aligns solved frames to their painted lines.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::messages::Messages;
use touchline_calibration::calibrate::{camera_on_paint, record_on_paint};
use touchline_calibration::proposals::{FramePicture, PictureStream};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::{Fields, FrameStatus};
use touchline_vision::paint::{FindOptions, SnapOptions};

/// Pulls solved frames onto the painted markings; statuses stay as they are.
#[derive(clap::Args, Debug)]
pub struct SnapArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// Paint is looked for this far from where a frame's camera predicts it, px at 1920 px width.
    #[arg(long, value_name = "PX", default_value_t = SnapOptions::default().reach_px, value_parser = reach)]
    reach: f64,
    /// Also find each frame's own k1, for cameras of which no lens is known.
    #[arg(long, conflicts_with = "from_nothing")]
    k1: bool,
    /// Also search the painted lines of frames that have no camera: for wide views of a camera
    /// whose base is known. What is found is a suggestion.
    #[arg(long)]
    from_nothing: bool,
}

fn reach(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (4.0..=400.0).contains(&value) => Ok(value),
        _ => Err("the reach is a number of px from 4 to 400".to_owned()),
    }
}

/// Aligns the frames and writes the document. [`Outcome::SomeFailed`] if a frame could not be
/// aligned.
///
/// # Errors
/// The document cannot be read, its field is invalid, or the result cannot be written.
pub fn snap(args: &SnapArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let input = &args.document.document;
    let output = args.output.reserve("snap", &[input], messages)?;
    let Loaded {
        location,
        mut document,
    } = output.read(input)?;
    let before = document.clone();
    let fields = Fields::from_document(document.at(location.folder()))?;
    // With --from-nothing the lines are searched first, and the camera that is found is aligned by
    // the same options as a known one.
    let snap = SnapOptions {
        reach_px: args.reach,
        own_k1: args.k1,
        ..SnapOptions::default()
    };
    let options = FindOptions {
        snap,
        ..FindOptions::default()
    };
    let bar = messages.progress(document.frames.len(), "Snapping");
    let looked_at: Vec<usize> = (0..before.frames.len())
        .filter(|&index| {
            let frame = &before.frames[index];
            frame.status != FrameStatus::Rejected && (frame.ptz.is_some() || args.from_nothing)
        })
        .collect();
    let mut counts = Counts {
        passed: before.frames.len() - looked_at.len(),
        ..Counts::default()
    };
    let mut failed = Vec::new();
    // In the order of the document, so that videos are read without seeking.
    for FramePicture { index, picture, .. } in
        PictureStream::new(before.at(location.folder()), looked_at)
    {
        bar.set_position(index as u64 + 1);
        let frame = &*document.frames[index];
        let (is_solved, name) = (frame.ptz.is_some(), frame.name());
        let picture = match picture {
            Ok(picture) => picture,
            Err(error) => {
                failed.push((name, error.to_string()));
                continue;
            }
        };
        let field = fields.for_frame(&document, frame);
        let found = camera_on_paint(
            &document,
            frame,
            field,
            &picture,
            (&options, !is_solved),
            &Progress::default(),
        );
        // The reason of a failure is recorded in the frame, too.
        record_on_paint(&mut document.frames[index], &found, !is_solved);
        match found {
            Ok(_) if is_solved => counts.snapped += 1,
            Ok(_) => counts.found += 1,
            Err(reason) => {
                failed.push((name, reason.to_string()));
            }
        }
    }
    bar.finish_and_clear();
    let failures = failed.len();
    messages.frames_failed(failed);
    document.count_edits_since(&before);
    output.write(document, location.folder())?;
    let Counts {
        snapped,
        found,
        passed,
    } = counts;
    let found = if args.from_nothing {
        format!("{found} found from nothing, ")
    } else {
        String::new()
    };
    messages.note(&format!(
        "{} snapped, {found}{failures} not, {passed} left unchanged (without a camera, or \
         rejected)",
        pluralise(snapped, "frame")
    ));
    Ok(Outcome::from_failure(failures > 0))
}

/// Numbers of frames by outcome.
#[derive(Default)]
struct Counts {
    snapped: usize,
    found: usize,
    passed: usize,
}
