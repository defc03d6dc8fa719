//! `touchline synth --broadcast`: draws a broadcast as a video with its truth.

use super::drawn_folder::{DrawnFolder, TRUTH_FILE};
use crate::cli::Outcome;
use crate::cli::terminal::messages::Messages;
use anyhow::Context as _;
use std::path::Path;
use touchline_application::jobs::broadcast_truth;
use touchline_core::field::builtin;
use touchline_core::geometry::pluralise;
use touchline_vision::media::VideoWriter;
use touchline_vision::synthetic::{BROADCAST_FPS, Broadcast, BroadcastOptions};

/// The video beside the truth.
const VIDEO_FILE: &str = "broadcast.mp4";

/// Draws the broadcast and writes its video and its truth.
///
/// # Errors
/// The folder has other content and `--force` was not given, there is no `ffmpeg`, or a file cannot
/// be written.
pub(super) fn draw_broadcast(
    output: &Path,
    force: bool,
    options: &BroadcastOptions,
    messages: Messages,
) -> anyhow::Result<Outcome> {
    let broadcast = Broadcast::new(options, builtin("soccer")?.default_model()?);
    let folder = DrawnFolder::begin(output, force)?;
    let video = output.join(VIDEO_FILE);
    let cannot_write = || format!("cannot write {}", video.display());
    let mut writer = VideoWriter::create(&video, options.image_size, BROADCAST_FPS)
        .with_context(cannot_write)?;
    let progress = messages.progress(options.frames, "Drawing frames");
    for frame in 0..options.frames {
        let picture = broadcast.draw(frame);
        writer.write(picture.as_raw()).with_context(cannot_write)?;
        progress.inc(1);
    }
    writer.finish().with_context(cannot_write)?;
    progress.finish_and_clear();
    folder.write_truth(&broadcast_truth(&broadcast, VIDEO_FILE, options.image_size))?;
    folder.finish()?;
    messages.note(&format!(
        "{}: {} from {}, the truth in {TRUTH_FILE}",
        video.display(),
        pluralise(broadcast.shots().len(), "shot"),
        pluralise(broadcast.cameras().count(), "camera")
    ));
    Ok(Outcome::Done)
}
