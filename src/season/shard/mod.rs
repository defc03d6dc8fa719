//! One unit of work: a shard of a plan, from its input to its part.
//!
//! | step | where |
//! |---|---|
//! | check machine, video and project against the plan; leave a whole part alone | here |
//! | find the cameras of a match, train its forest | `find` |
//! | label the frames of a window | `label` |
//! | measure what it cost | `cost` |
//!
//! Shards may run in any order and on any machine that sees the frames and the folder of parts. A
//! label shard whose find part is not there yet makes that part first; an engine that knows the
//! order never comes to that, and one that does not is merely slower.

mod find;
mod frames;
mod label;

use crate::part::{Cost, Part, PartError, is_part_whole};
use crate::plan::{Plan, PlannedMatch, ShardOfPlan, path_in_plan};
use crate::processor::{ANY, processor_class};
use crate::source::{SourceError, examine_source, place_of_source};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use thiserror::Error;
use touchline_calibration::pipelines::{LabelMatchError, MatchEvent};
use touchline_calibration::proposals::BaseMismatch;
use touchline_core::field::FieldError;
use touchline_core::files::remove_stray_files;
use touchline_core::progress::Progress;
use touchline_documents::document::{ReadError, WriteError, generator};
use touchline_documents::store::StoreError;
use touchline_vision::media::{FrameSource, MediaError};
use touchline_vision::relocalize::ForestFileError;

/// Events while a shard is done.
#[derive(Debug)]
pub enum ShardEvent {
    /// The find shard of the match is done first, because its part is not there.
    FindingFirst,
    /// An image cannot be read and is left out.
    LeftOut {
        /// The image.
        frame: String,
        /// Why.
        error: MediaError,
    },
    /// Work on the frames goes on.
    Frames(MatchEvent),
}

/// How a shard ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShardDone {
    /// Its part was there, whole.
    WasThere,
    /// Its part was made.
    Made {
        /// Number of frames in the part.
        frames: usize,
        /// Number of them that have a camera.
        with_camera: usize,
        /// Why there is no camera or no forest, if so.
        reason: Option<String>,
    },
}

/// Does a shard of the plan at `plan_path` and writes its part into the folder `parts`, which is
/// made if necessary. Temporary files of processes that were killed a day ago are removed from it.
///
/// # Errors
/// The plan has no such shard or is of another program or processor class, the frames changed after
/// planning, a file in place of a part is not that part, or the part cannot be written.
/// [`ShardError::Stopped`] if `progress` cancelled it. There is no part then.
pub fn do_shard(
    plan_path: &Path,
    plan: &Plan,
    id: &str,
    parts: &Path,
    progress: &Progress<'_, ShardEvent>,
) -> Result<ShardDone, ShardError> {
    let shard = plan.shard(id).ok_or_else(|| ShardError::NotInPlan {
        plan: plan_path.to_path_buf(),
        id: id.to_owned(),
    })?;
    refuse_other_program(plan)?;
    fs::create_dir_all(parts).map_err(|source| PartError::Io {
        action: "make the folder",
        path: parts.to_path_buf(),
        source,
    })?;
    remove_stray_files(parts);
    // Before the frames are opened: a shard that is done costs no more than reading its part.
    if is_part_whole(parts, id)? {
        return Ok(ShardDone::WasThere);
    }
    let work = Work {
        plan_path,
        of_match: shard.of_match,
        source: open_source(plan_path, shard.of_match)?,
        progress,
    };
    let made = work.make(shard, parts)?;
    let frames = &made.document.frames;
    Ok(ShardDone::Made {
        frames: frames.len(),
        with_camera: frames.iter().filter(|frame| frame.ptz.is_some()).count(),
        reason: made.about.reason,
    })
}

/// The frames of a match, opened.
struct OpenSource {
    /// The video, or the images of the folder.
    frames: FrameSource,
    /// Of a folder: the number of each image.
    number_of_image: BTreeMap<PathBuf, usize>,
    /// The folder that frames are named from.
    folder: PathBuf,
    /// The name of the video or folder in it.
    name: String,
    /// What the video is recognised by; none for a folder.
    file_id: Option<Arc<str>>,
}

/// A match while one of its shards is done.
struct Work<'a> {
    plan_path: &'a Path,
    of_match: &'a PlannedMatch,
    source: OpenSource,
    progress: &'a Progress<'a, ShardEvent>,
}

impl Work<'_> {
    /// Makes the part of a shard and writes it, and before that the part that it needs.
    fn make(&self, shard: ShardOfPlan<'_>, parts: &Path) -> Result<Part, ShardError> {
        let find = &self.of_match.find;
        let Some(label) = shard.label else {
            return self.write(Work::find_cameras, parts, find);
        };
        // The find part may be missing because an engine does not know the order, or because it
        // runs at this moment elsewhere. To make it here is right in both cases: both processes
        // write the same bytes.
        let found = match Part::read(parts, find) {
            Err(PartError::Missing { .. }) => {
                let _ = self.progress.report(ShardEvent::FindingFirst);
                self.write(Work::find_cameras, parts, find)?
            }
            read => read?,
        };
        self.write(|work| work.label_window(&found, label), parts, &label.shard)
    }

    /// Makes a part, writes it, and states its cost beside it.
    fn write(
        &self,
        make: impl FnOnce(&Self) -> Result<Part, ShardError>,
        parts: &Path,
        id: &str,
    ) -> Result<Part, ShardError> {
        let stopwatch = Stopwatch::start();
        let part = make(self)?;
        // A function that was cancelled may have returned what it had so far, which is no part.
        if self.progress.is_cancelled() {
            return Err(ShardError::Stopped);
        }
        part.write(parts, id)?;
        stopwatch.cost().write(parts, id);
        Ok(part)
    }
}

fn refuse_other_program(plan: &Plan) -> Result<(), ShardError> {
    if plan.program != generator() {
        return Err(ShardError::OtherProgram {
            planned: plan.program.clone(),
            here: generator(),
        });
    }
    // The class is measured only where it counts: it starts ffmpeg and hashes libraries.
    if plan.processor == ANY {
        return Ok(());
    }
    let here = processor_class();
    if plan.processor != here {
        return Err(ShardError::OtherProcessor {
            planned: plan.processor.clone(),
            here,
        });
    }
    Ok(())
}

/// Opens the frames of a match and checks that they are those that were planned.
fn open_source(plan_path: &Path, of_match: &PlannedMatch) -> Result<OpenSource, ShardError> {
    let path = path_in_plan(plan_path, &of_match.frames);
    let state = examine_source(&path)?;
    let (folder, name) = place_of_source(&path)?;
    // The name counts, too: it names the frames in the part.
    if state.sha256 != of_match.frames_sha256
        || state.num_frames != of_match.num_frames
        || name != of_match.frames_name
    {
        return Err(ShardError::FramesChanged { path });
    }
    Ok(OpenSource::open(folder, name).map_err(SourceError::from)?)
}

/// Ticks of the processor times that Linux states in `/proc`, a second: the same on every machine.
#[cfg(target_os = "linux")]
const TICKS: f64 = 100.0;

/// Measures from its start on.
#[derive(Clone, Copy, Debug)]
struct Stopwatch {
    wall: Instant,
    cpu_s: Option<f64>,
}

impl Stopwatch {
    fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu_s: cpu_s(),
        }
    }

    /// The cost since the start.
    fn cost(self) -> Cost {
        Cost {
            cpu_s: cpu_s().zip(self.cpu_s).map(|(now, start)| now - start),
            wall_s: self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// The time that this process and the decoders that it waited for have used of all processors, s.
#[cfg(target_os = "linux")]
fn cpu_s() -> Option<f64> {
    // User and system time of this process, then those of the children that it waited for, such as
    // ffmpeg.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in parentheses, may contain anything. Behind it the times are the
    // columns 14 to 17 of proc(5); the first one here is column 3.
    let (_, columns) = stat.rsplit_once(')')?;
    let times = columns.split_whitespace().skip(11).take(4);
    let ticks: Vec<f64> = times.filter_map(|ticks| ticks.parse().ok()).collect();
    (ticks.len() == 4).then(|| ticks.iter().sum::<f64>() / TICKS)
}

#[cfg(not(target_os = "linux"))]
fn cpu_s() -> Option<f64> {
    None
}

/// What to do on a machine of another class than the plan's.
const OTHER_CLASS: &str =
    "bytes would differ; use such a machine, or make the plan again with --any-processor";

/// Why a shard was not done. Nothing was written then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShardError {
    /// The plan has no shard of this id.
    #[error(
        "{} has no shard {id}; touchline plan --commands writes its shards",
        plan.display()
    )]
    NotInPlan { plan: PathBuf, id: String },
    /// Another program made the plan.
    #[error(
        "the plan is of {planned}, and this is {here}: bytes would differ; make the plan again"
    )]
    OtherProgram {
        /// The program that made the plan.
        planned: String,
        /// This program.
        here: String,
    },
    /// This machine is of another processor class than the plan.
    #[error(
        "the plan is for machines of class \"{planned}\", this is one of \"{here}\": {OTHER_CLASS}"
    )]
    OtherProcessor {
        /// The plan's class.
        planned: String,
        /// This machine's class.
        here: String,
    },
    /// The frames are not those that were planned.
    #[error("{} changed after the plan was made; make the plan again", path.display())]
    FramesChanged {
        /// The video or folder.
        path: PathBuf,
    },
    /// A project or forest is not the one that was planned.
    #[error("{} changed after the plan was made; make the plan again", path.display())]
    FileChanged {
        /// The project or forest.
        path: PathBuf,
    },
    /// The frames cannot be read.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A part cannot be used or written.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The project cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The project cannot be hashed.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The forest cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    ForestIo {
        /// The forest.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A forest is not one, or is damaged.
    #[error("{what}: {source}")]
    Forest {
        /// The forest.
        what: String,
        /// Why.
        source: ForestFileError,
    },
    /// The cameras in a forest cannot be read.
    #[error("{what}: {source}")]
    ForestCameras {
        /// The forest.
        what: String,
        /// Why.
        source: ReadError,
    },
    /// A forest is of other cameras than the project.
    #[error(transparent)]
    Base(#[from] BaseMismatch),
    /// Cameras could not be searched for.
    #[error(transparent)]
    Label(#[from] LabelMatchError),
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// `progress` cancelled it.
    #[error("stopped; no part was written")]
    Stopped,
}
