//! `touchline track`: cameras carried from solved frames to their neighbours.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::interrupt::Interrupt;
use super::messages::Messages;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::Path;
use touchline_calibration::calibrate::{
    ClipEvidence, ClipProgress, TrackClipError, TrackClipOptions, clips, length_on_lines, record_tracked, take_length,
    track_clip,
};
use touchline_calibration::proposals::read_picture;
use touchline_core::geometry::counted;
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{Document, Fields, Frame};
use touchline_vision::media::FrameReader;

/// Carries the cameras of solved frames to their neighbours, and adjusts all frames of a clip together.
#[derive(clap::Args, Debug)]
pub struct TrackArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// Smooth the motion of the camera; each frame keeps its own camera beside it (`solution.raw_ptz`).
    #[arg(long)]
    smooth: bool,
    /// Seek the focal length of frames that state their lens (`lens`) as well; without it they keep it, and pan and tilt alone are sought.
    #[arg(long)]
    seek_focal: bool,
    /// Only frames with these numbers: video frames from 0, or places in the document.
    #[arg(long, value_name = "A..B", value_parser = range)]
    frames: Option<RangeInclusive<usize>>,
    /// Hold every N-th frame to its painted lines; 0: none.
    #[arg(long, value_name = "N", default_value_t = TrackClipOptions::default().paint_every)]
    paint_every: usize,
}

fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let wanted = || "frames are given as A..B, the first and the last number, such as 100..250".to_owned();
    let (from, to) = text.split_once("..").ok_or_else(wanted)?;
    let number = |text: &str| text.trim_start_matches('=').parse::<usize>().map_err(|_| wanted());
    let (from, to) = (number(from)?, number(to)?);
    if from <= to { Ok(from..=to) } else { Err(wanted()) }
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read, its field is not valid, or the result cannot be written.
pub fn track(args: &TrackArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded { location, mut document } = args.document.load(messages)?;
    let before = document.clone();
    let options = TrackClipOptions {
        smooth: args.smooth,
        paint_every: args.paint_every,
        seek_focal: args.seek_focal,
        ..TrackClipOptions::default()
    };
    let interrupt = Interrupt::listen();
    let is_stopped = || interrupt.is_pressed();
    let carried = carry(&mut document, location.folder(), args.frames.as_ref(), &options, &is_stopped, messages)?;
    if carried.is_stopped && carried.frames == 0 {
        messages.note("stopped; no clip was finished, nothing was written");
        return Ok(Outcome::Stopped);
    }
    document.count_edits_since(&before);
    args.output.write(document, location.folder())?;
    if carried.is_stopped {
        messages.note(&format!(
            "stopped: {} frames of finished clips were carried and are written; track what was written for the rest",
            carried.frames
        ));
        return Ok(Outcome::Stopped);
    }
    messages.note(&format!("{} carried, {} not", counted(carried.frames, "frame"), carried.failed));
    Ok(if carried.failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}

/// Frames to which cameras were carried, and those to which they were not.
#[derive(Clone, Copy, Debug, Default)]
pub struct CarriedFrames {
    /// How many got a camera.
    pub frames: usize,
    /// How many did not.
    pub failed: usize,
    /// Somebody ended it; clips that were finished before are carried.
    pub is_stopped: bool,
}

/// Carries the cameras of a document's clips to their other frames. A clip that cannot be carried is named, and the others go on;
/// `is_stopped` ends it within a clip, and keeps those before.
///
/// Where the carried frames show that the field has another length than was assumed, the length is taken and carrying done again.
///
/// # Errors
/// The field is not valid.
pub fn carry(
    document: &mut Document,
    folder: &Path,
    within: Option<&RangeInclusive<usize>>,
    options: &TrackClipOptions,
    is_stopped: &dyn Fn() -> bool,
    messages: Messages,
) -> anyhow::Result<CarriedFrames> {
    let before = document.clone();
    let carried = carry_once(document, folder, within, options, is_stopped, messages)?;
    if carried.is_stopped || carried.frames == 0 {
        return Ok(carried);
    }
    let mut reader = FrameReader::new();
    let mut picture = |frame: &Frame| read_picture(&mut reader, frame, folder).ok();
    let Some(found) = length_on_lines(document.at(folder), &mut picture)? else { return Ok(carried) };
    let FittedSize { assumed_m, value_m, sigma_m, .. } = found.size;
    let seen =
        format!("the painted lines of {} frames ask for a length of {value_m:.2} ± {sigma_m:.2} m", found.frames);
    if found.is_prescribed {
        messages.note(&format!("{seen}; {assumed_m} m is stated, and stays"));
        return Ok(carried);
    }
    messages.note(&format!("{seen}, where {assumed_m} m was assumed: carrying again"));
    // From the cameras that were known before: carried ones hold nothing.
    *document = before;
    take_length(document, &found);
    carry_once(document, folder, within, options, is_stopped, messages)
}

/// Carries the cameras of each clip once.
fn carry_once(
    document: &mut Document,
    folder: &Path,
    within: Option<&RangeInclusive<usize>>,
    options: &TrackClipOptions,
    is_stopped: &dyn Fn() -> bool,
    messages: Messages,
) -> anyhow::Result<CarriedFrames> {
    let before = document.clone();
    let fields = Fields::of(before.at(folder))?;
    let mut reader = FrameReader::new();
    let mut all = CarriedFrames::default();
    for clip in clips(before.at(folder), within) {
        let (Some(first), Some(last)) = (clip.frames.first(), clip.frames.last()) else { continue };
        let name = format!("{} to {}", first.source, last.source);
        let bar = messages.progress(2 * clip.frames.len(), "Tracking");
        let field = clip.frames.iter().find_map(|frame| before.frames.get(frame.place?));
        let Some(field) = field.map(|frame| fields.of_frame(&before, frame)) else { continue };
        let mut watch = |progress| {
            match progress {
                ClipProgress::Following(done, _) => bar.set_position(done as u64),
                ClipProgress::Painting(done, of) => {
                    bar.set_message("Painted lines");
                    bar.set_position((clip.frames.len() + done * clip.frames.len() / of.max(1)) as u64);
                }
                ClipProgress::Adjusting => bar.set_message("Adjusting"),
            }
            if is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut evidence = ClipEvidence::default();
        let tracked = track_clip(before.at(folder), &clip, field, &mut reader, options, &mut evidence, &mut watch);
        bar.finish_and_clear();
        match tracked {
            Ok(tracked) => {
                record_tracked(document, &tracked);
                all.frames += tracked.frames.len();
                all.failed += tracked.missed.len();
                messages.note(&format!(
                    "{name}: {} frames carried, {} held to their painted lines, points {:.2} px, widened {:.1} times",
                    tracked.frames.len(),
                    tracked.painted,
                    tracked.sigma_px,
                    tracked.widened
                ));
                if tracked.kept > 0 {
                    messages.note(&format!(
                        "{name}: {} frames keep the camera that they had: their painted lines speak more for it",
                        tracked.kept
                    ));
                }
                for stop in &tracked.stops {
                    let why = format!("only {} of {} points agree with one turn and zoom", stop.agreeing, stop.seen);
                    messages.frame_failed(&stop.picture, &format!("not carried on to this frame: {why}"));
                }
                for (what, jitter) in [("before smoothing", tracked.raw_jitter), ("", tracked.jitter)] {
                    if let Some(jitter) = jitter {
                        let what = if what.is_empty() { String::new() } else { format!(" {what}") };
                        messages.note(&format!(
                            "jitter{what}: pan {:.4}°, tilt {:.4}°, focal length {:.2} px, picture {:.2} px",
                            jitter.pan_deg, jitter.tilt_deg, jitter.focal_px, jitter.centre_px
                        ));
                    }
                }
            }
            Err(TrackClipError::Stopped) => {
                all.is_stopped = true;
                break;
            }
            Err(error) => {
                all.failed += clip.frames.iter().filter(|frame| frame.place.is_some()).count();
                messages.frame_failed(&name, &error.to_string());
            }
        }
    }
    Ok(all)
}
