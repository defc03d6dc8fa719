//! `touchline track`: propagates cameras from solved frames to their neighbours.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::{Messages, StepBar};
use indicatif::ProgressBar;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use touchline_calibration::calibrate::{
    BasePaintEvidence, ClipProgress, ClipSpan, LengthOnLines, Misnamed, TrackClipOptions,
    TrackedClip, clips,
};
use touchline_calibration::pipelines::{
    TrackedFrames, TrackingEvent, TrackingOptions, track_clips,
};
use touchline_core::camera::SizeError;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{CameraId, Document};
use touchline_vision::media::{CachedReader, FrameReader, FrameRef, KEPT_BYTES};

/// Propagates the cameras of solved frames to their neighbours, and adjusts all frames of a clip
/// together.
#[derive(clap::Args, Debug)]
pub struct TrackArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    output: DocumentOutput,
    /// Smooth the motion of the camera; each frame keeps its own camera beside it
    /// (`solution.raw_ptz`).
    #[arg(long)]
    smooth: bool,
    /// Seek the focal length of frames that state their lens (`lens`) as well; without it they keep
    /// it, and pan and tilt alone are sought.
    #[arg(long)]
    seek_focal: bool,
    /// Only frames with these numbers: video frames from 0, or places in the document.
    #[arg(long, value_name = "A..B", value_parser = range)]
    frames: Option<RangeInclusive<usize>>,
    /// Hold every N-th frame to its painted lines; 0: none.
    #[arg(long, value_name = "N", default_value_t = TrackClipOptions::default().paint_every)]
    paint_every: usize,
    /// Also refine each camera's base on the painted lines of the frames that were reached, and
    /// track them again, until that moves it no more. A camera without a base gets one from its
    /// clicks first.
    #[arg(long)]
    refine_base: bool,
}

fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let numbers = text
        .split_once("..")
        .and_then(|(from, to)| Some((frame_number(from)?, frame_number(to)?)));
    match numbers {
        Some((from, to)) if from <= to => Ok(from..=to),
        _ => Err(
            "frames are given as A..B, the first and the last number, such as 100..250".to_owned(),
        ),
    }
}

fn frame_number(text: &str) -> Option<usize> {
    // `A..=B` means the same: both numbers are included either way.
    text.trim_start_matches('=').parse().ok()
}

/// Tracks the clips and writes the document. [`Outcome::SomeFailed`] if a frame got no camera,
/// [`Outcome::Stopped`] after Ctrl-C.
///
/// # Errors
/// The document cannot be read, its field is invalid, or the result cannot be written.
pub fn track(args: &TrackArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let input = &args.document.document;
    let output = args.output.reserve("track", &[input], messages)?;
    let Loaded {
        location,
        mut document,
    } = output.read(input)?;
    messages.name_video_backend(&document);
    let before = document.clone();
    let clip = TrackClipOptions {
        smooth: args.smooth,
        paint_every: args.paint_every,
        seek_focal: args.seek_focal,
        ..TrackClipOptions::default()
    };
    let options = TrackingOptions {
        clip,
        refine_base: args.refine_base,
    };
    let interrupt = Interrupt::listen();
    let within = args.frames.as_ref();
    let found = track_and_report(
        &mut document,
        location.folder(),
        within,
        &options,
        Some(&interrupt),
        messages,
    )?;
    // Nothing was changed, so that nothing is written.
    if found.is_stopped && found.tracked == 0 {
        messages.note("stopped; no clip was finished, nothing was written");
        return Ok(Outcome::Stopped);
    }
    document.count_edits_since(&before);
    output.write(document, location.folder())?;
    if found.is_stopped {
        messages.note(&format!(
            "stopped: {} of finished clips tracked and written; to go on, track the document \
             that was written",
            pluralise(found.tracked, "frame")
        ));
        return Ok(Outcome::Stopped);
    }
    messages.note(&format!(
        "{} tracked, {} not",
        pluralise(found.tracked, "frame"),
        found.missed
    ));
    Ok(Outcome::from_failure(found.missed > 0))
}

/// Tracks the clips of a document and reports progress and results. `interrupt` ends the clip in
/// progress; finished clips are kept.
///
/// # Errors
/// The field is invalid.
pub fn track_and_report(
    document: &mut Document,
    folder: &Path,
    within: Option<&RangeInclusive<usize>>,
    options: &TrackingOptions,
    interrupt: Option<&Interrupt>,
    messages: Messages,
) -> anyhow::Result<TrackedFrames> {
    let clips = clips(document.at(folder), within);
    // Events may come from any thread. Ctrl-C is noticed at the next one.
    let report = Mutex::new(TrackingReport::new(messages));
    let progress = Progress::new(|event| {
        report
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .on_event(event);
        interrupt.map_or(ControlFlow::Continue(()), Interrupt::check)
    });
    let mut reader = CachedReader::new(FrameReader::new(), KEPT_BYTES);
    Ok(track_clips(
        document,
        folder,
        &clips,
        &mut reader,
        options,
        &mut Vec::new(),
        &progress,
    )?)
}

/// Reports the events of tracking: a bar for each step, and messages.
pub struct TrackingReport {
    messages: Messages,
    bar: StepBar,
}

impl TrackingReport {
    /// A reporter that has not shown anything.
    pub const fn new(messages: Messages) -> Self {
        Self {
            messages,
            bar: StepBar::new(messages),
        }
    }

    /// Reports one event.
    pub fn on_event(&mut self, event: TrackingEvent) {
        let messages = self.messages;
        if !matches!(event, TrackingEvent::Progress(_)) {
            self.bar.clear();
        }
        match event {
            TrackingEvent::Begun(clip) => {
                self.bar.of("Tracking", 2 * clip.num_pictures);
            }
            TrackingEvent::Progress(progress) => show_progress(self.bar.current(), progress),
            TrackingEvent::Refining(_) => {
                self.bar.of("Refining the base on painted lines", 1);
            }
            TrackingEvent::Renamed(camera, names) => {
                messages.note(&describe_renamed(&camera, &names));
            }
            TrackingEvent::Tracked(clip, tracked) => report_tracked(&clip, &tracked, messages),
            TrackingEvent::Failed(clip, error) => {
                messages.frame_failed(&name_of(&clip), &error.to_string());
            }
            TrackingEvent::Length(found) => messages.note(&describe_length(&found)),
            TrackingEvent::Refined(camera, seen) => {
                messages.note(&describe_refined(&camera, &seen));
            }
            TrackingEvent::NoBetter { kept, refined } => {
                let [kept, refined] = [kept, refined].map(|confidence| 100.0 * confidence);
                messages.note(&format!(
                    "with the refined base the frames are less certain ({refined:.1} % on average, {kept:.1} % before): the one before stays"
                ));
            }
        }
    }
}

/// Shows the progress of a clip: following points fills the first half of the bar, reading the
/// painted lines the second.
fn show_progress(bar: Option<&ProgressBar>, progress: ClipProgress) {
    let Some(bar) = bar else { return };
    // The bar counts two steps for each picture. Fewer pictures are read for their paint than are
    // followed, so that the share of these fills the second half; of none it is 0 of 1.
    let half = bar.length().unwrap_or(0) / 2;
    match progress {
        ClipProgress::Following(done, _) => bar.set_position(done as u64),
        ClipProgress::Painting(done, of) => {
            bar.set_message("Painted lines");
            bar.set_position(half + done as u64 * half / of.max(1) as u64);
        }
        ClipProgress::Adjusting => bar.set_message("Adjusting"),
    }
}

/// That clicks of a camera, which were named for the wrong sides, have other names now.
pub fn describe_renamed(camera: &CameraId, names: &Misnamed) -> String {
    format!("{camera}: {names}; they are renamed")
}

/// The name of a clip: its first and its last picture.
fn name_of(clip: &ClipSpan) -> String {
    match (&clip.first, &clip.last) {
        (FrameRef::Video { path, index }, FrameRef::Video { index: last, .. }) => {
            format!("{} frames {index} to {last}", file_name(path))
        }
        (FrameRef::Image(first), FrameRef::Image(last)) => {
            format!("{} to {}", file_name(first), file_name(last))
        }
        (first, last) => format!("{first} to {last}"),
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Reports the result of one clip: residuals, frames that kept their camera, breaks, jitter.
fn report_tracked(clip: &ClipSpan, tracked: &TrackedClip, messages: Messages) {
    let name = name_of(clip);
    messages.note(&format!(
        "{name}: {} tracked, {} aligned to their painted lines, points ±{:.2} px, \
         uncertainty multiplied by {:.1}",
        pluralise(tracked.frames.len(), "frame"),
        tracked.painted,
        tracked.sigma_px,
        tracked.inflation
    ));
    if tracked.kept > 0 {
        messages.note(&format!(
            "{name}: {} with the camera from before: the painted lines speak more for it",
            pluralise(tracked.kept, "frame")
        ));
    }
    if let Some(why) = &tracked.unreadable {
        messages.note(&format!("{name}: not tracked to its end: {why}"));
    }
    for stop in &tracked.stops {
        let why = format!(
            "only {} of {} points agree with one rotation and zoom",
            stop.agreeing, stop.seen
        );
        messages.frame_failed(&stop.picture, &format!("not tracked to this frame: {why}"));
    }
    for (what, jitter) in [
        (" before smoothing", tracked.raw_jitter),
        ("", tracked.jitter),
    ] {
        if let Some(jitter) = jitter {
            messages.note(&format!(
                "jitter{what}: pan {:.4}°, tilt {:.4}°, focal length {:.2} px, picture {:.2} px",
                jitter.pan_deg, jitter.tilt_deg, jitter.focal_px, jitter.centre_px
            ));
        }
    }
}

fn describe_length(found: &LengthOnLines) -> String {
    let FittedSize {
        name,
        assumed_m,
        value_m,
        error: SizeError { sigma_m, .. },
        ..
    } = &found.size;
    let seen = format!(
        "the painted lines of {} indicate a {} of {value_m:.2} ± {sigma_m:.2} m",
        pluralise(found.frames, "frame"),
        name.trim_end_matches("_m")
    );
    if found.is_prescribed {
        format!("{seen}; {assumed_m} m is stated, and stays")
    } else {
        format!("{seen}, where {assumed_m} m was assumed: tracking again")
    }
}

fn describe_refined(camera: &CameraId, seen: &BasePaintEvidence) -> String {
    // Where no paint was held out there is no error, which is another thing than an error of 0.
    let errors = seen.before.paint.zip(seen.after.paint);
    let change = errors.map_or_else(String::new, |(before, after)| {
        format!(
            ", from {:.2} to {:.2} px off paint held out",
            before.median_px, after.median_px
        )
    });
    format!(
        "{camera}: the base is refined on {} in {}{change}: tracking again",
        pluralise(seen.lines, "line"),
        pluralise(seen.frames, "frame")
    )
}
