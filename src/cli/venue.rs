//! `touchline venue`: keeps the cameras of a project for other matches in the same stadium.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, Loaded};
use crate::cli::terminal::features::FeaturesArg;
use crate::cli::terminal::messages::{Messages, StepBar};
use crate::cli::terminal::output::{refuse_existing_file, write_file};
use anyhow::{Context as _, ensure};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use touchline_calibration::pipelines::{
    LearningProgress, NewVenue, VENUE_ENDING, Venue, make_venue,
};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::CameraId;
use touchline_vision::media::FrameReader;

/// Writes the cameras of a project into a venue file: where they stand, their lenses and the field,
/// and what recognises their pictures. `touchline calibrate --venue` tries them on another match.
///
/// A camera is kept if it has a base and at least four frames that are accepted or certain. The
/// file has no pictures and no paths.
#[derive(clap::Args, Debug)]
pub struct VenueArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    kept: FeaturesArg,
    /// The venue file to write, such as arena.venue.
    #[arg(short, long, value_name = "VENUE")]
    output: PathBuf,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Writes the venue file of a project. [`Outcome::SomeFailed`] if a camera is left out.
///
/// # Errors
/// The project cannot be read, has no camera that is certain, or the file cannot be written.
pub fn venue(args: &VenueArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing_file(&args.output, args.force)?;
    let Loaded { location, document } = args.document.load(messages)?;
    messages.name_video_backend(&document);
    let store = args.kept.store(Some(location.file()));
    let bar = Mutex::new(StepBar::new(messages));
    let progress = Progress::new(|step| {
        if let LearningProgress::Features { done, of } = step {
            let mut bar = bar.lock().unwrap_or_else(PoisonError::into_inner);
            bar.of("Finding features", of).set_position(done as u64);
        }
        ControlFlow::Continue(())
    });
    let at = document.at(location.folder());
    let made = make_venue(at, &mut FrameReader::new(), &store, &progress);
    drop(progress);
    drop(bar);
    let made = made.with_context(|| location.file().display().to_string())?;
    // None would mean that the progress cancelled it, and this one never does.
    let NewVenue {
        model,
        cameras,
        left_out,
    } = made.context("stopped")?;
    let bytes = model.to_bytes();
    write_file(&args.output, &bytes, args.force)?;
    messages.note(&format!(
        "{}: {} ({}), {:.1} MB",
        args.output.display(),
        pluralise(cameras.len(), "camera"),
        list(&cameras),
        bytes.len() as f64 / 1e6
    ));
    if !left_out.is_empty() {
        messages.note(&format!(
            "left out, for want of a base or of certain frames: {}",
            list(&left_out)
        ));
    }
    Ok(Outcome::from_failure(!left_out.is_empty()))
}

fn list(cameras: &[CameraId]) -> String {
    let names: Vec<&str> = cameras.iter().map(CameraId::as_str).collect();
    names.join(", ")
}

/// The venues of some files, and of all venue files in some folders, in the order of their names.
///
/// # Errors
/// A file cannot be read as a venue, or a folder has none.
pub fn read_venues(paths: &[PathBuf]) -> anyhow::Result<Vec<Venue>> {
    let mut venues = Vec::new();
    for path in paths {
        let files = if path.is_dir() {
            venue_files(path)?
        } else {
            vec![path.clone()]
        };
        for file in files {
            venues.push(Venue::read(&file)?);
        }
    }
    Ok(venues)
}

/// The venue files of a folder, by name.
fn venue_files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let cannot_read = || format!("cannot read the folder {}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(cannot_read)? {
        let path = entry.with_context(cannot_read)?.path();
        if path
            .extension()
            .is_some_and(|ending| ending == VENUE_ENDING)
        {
            files.push(path);
        }
    }
    ensure!(
        !files.is_empty(),
        "{} has no file that ends in .{VENUE_ENDING}; `touchline venue` writes one",
        folder.display()
    );
    files.sort();
    Ok(files)
}
