//! `touchline snap`: solved frames pulled onto their painted lines.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::messages::Messages;
use crate::calibrate::{record_refusal, record_snapped, snap_frame};
use crate::document::{Fields, FrameStatus};
use crate::media::FrameReader;
use crate::paint::SnapOptions;
use crate::proposals::read_picture;

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
}

fn reach(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (4.0..=400.0).contains(&value) => Ok(value),
        _ => Err("the reach is a number of px from 4 to 400".to_owned()),
    }
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read, its field is not valid, or the result cannot be written.
pub fn snap(args: &SnapArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded { location, mut document } = args.document.load(messages)?;
    let before = document.clone();
    let fields = Fields::of(document.at(location.folder()))?;
    let options = SnapOptions { reach_px: args.reach, ..SnapOptions::default() };
    let mut reader = FrameReader::new();
    let bar = messages.progress(document.frames.len(), "Snapping");
    let (mut snapped, mut failed, mut passed) = (0_usize, 0_usize, 0_usize);
    for index in 0..document.frames.len() {
        bar.inc(1);
        let frame = &*document.frames[index];
        if frame.ptz.is_none() || frame.status == FrameStatus::Rejected {
            passed += 1;
            continue;
        }
        let name = frame.name();
        let picture = match read_picture(&mut reader, frame, location.folder()) {
            Ok(picture) => picture,
            Err(error) => {
                failed += 1;
                messages.frame_failed(&name, &error.to_string());
                continue;
            }
        };
        let field = fields.of_frame(&document, frame);
        match snap_frame(&document, frame, field, &picture, &options) {
            Ok((base, found)) => {
                snapped += 1;
                record_snapped(&mut document.frames[index], &base, &found);
            }
            Err(reason) => {
                failed += 1;
                messages.frame_failed(&name, &reason.to_string());
                record_refusal(&mut document.frames[index], &reason);
            }
        }
    }
    bar.finish_and_clear();
    document.count_edits_since(&before);
    args.output.write(&document, location.folder())?;
    messages.note(&format!(
        "{snapped} frames snapped, {failed} not, {passed} left unchanged (without a camera, or rejected)"
    ));
    Ok(if failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}
