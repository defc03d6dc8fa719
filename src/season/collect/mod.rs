//! From the parts of a season to what people work with.
//!
//! ```text
//! OUT/NAME/project.json   one project for each match, with all suggestions
//! OUT/queue.json          the frames to look at, worst first
//! OUT/season.csv, .md     a row for each match
//! OUT/collected.json      what was written, and from which frames
//! ```
//!
//! Parts may be collected while others are still being made, and again later. A project that is
//! there already is brought up to date: what a person did in a frame stays, and only frames that
//! show a suggestion, or nothing, take that of the parts (`project`). A project that is open in the
//! window, that is of another video, or in which a person works with another base than that of the
//! parts, is left alone and named. No file is replaced that is not as it was written (`record`).
//!
//! Only parts are read, no videos. What has no whole part is a gap: it is named, its frames are not
//! in the project, and the table counts them.

mod project;
mod record;
mod table;

use crate::part::shard_of_path;
use crate::plan::Plan;
use crate::queue::Queue;
use crate::season_file::{LOCK_FILE, QUEUE_FILE, RECORD_FILE, TABLE_FILES};
use project::{CollectedMatch, MatchToCollect};
use record::Record;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use table::SeasonTable;
use thiserror::Error;
use touchline_core::files::way_out;
use touchline_core::progress::Progress;
use touchline_documents::store::{ReadOnly, StoreError, lock_file};
use touchline_vision::relocalize::CERTAIN;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollectOptions {
    /// Suggestions below this confidence are in the queue, 0 to 1. Default: 0.9, from which on an
    /// answer is called certain.
    pub below: f64,
}

impl Default for CollectOptions {
    fn default() -> Self {
        Self { below: CERTAIN }
    }
}

/// Events while parts are collected.
#[derive(Debug)]
pub enum CollectEvent {
    /// A match was collected.
    Match,
    /// A part is missing or cannot be used.
    Gap {
        /// The match.
        name: String,
        /// Which frames, and why.
        what: String,
    },
    /// The project of a match was left as it is.
    LeftAlone {
        /// The match.
        name: String,
        why: String,
    },
    /// The frames of a match were collected under another name, in the folder of which its project
    /// stays.
    Renamed {
        /// The match.
        name: String,
        folder: String,
    },
    /// A match that was collected is no longer in the plan; its project stays.
    NotInPlan { folder: String },
    /// A file in the folder of parts is of no shard of this plan. It is not used.
    NotOfPlan {
        /// The part.
        path: PathBuf,
    },
}

/// What was collected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collected {
    /// Number of matches that have a project.
    pub projects: usize,
    /// Number of frames in them.
    pub frames: usize,
    /// Number of frames with a camera.
    pub with_camera: usize,
    /// Number of shards without a whole part.
    pub gaps: usize,
    /// Number of projects that were left as they are.
    pub left_alone: usize,
    /// Number of entries of the queue.
    pub queued: usize,
}

/// Collects the parts of a plan at `plan_path` into the folder `output`.
///
/// # Errors
/// The folder holds other things than a collected season, or a file that would be replaced and is
/// not as it was written; another process collects into it, or something cannot be written. Projects
/// that were written before stay.
pub fn collect(
    plan_path: &Path,
    plan: &Plan,
    parts: &Path,
    output: &Path,
    options: &CollectOptions,
    progress: &Progress<'_, CollectEvent>,
) -> Result<Collected, CollectError> {
    if !parts.is_dir() {
        return Err(CollectError::NoParts {
            parts: parts.to_path_buf(),
        });
    }
    refuse_other_folder(output)?;
    fs::create_dir_all(output).map_err(|source| CollectError::from_io("make", output, source))?;
    let lock_path = output.join(LOCK_FILE);
    // Dropped, and so unlocked, when the function ends.
    let _lock = lock_file(lock_path).map_err(|reason| match reason {
        ReadOnly::OpenElsewhere { holder } => CollectError::Busy {
            output: output.to_path_buf(),
            holder,
        },
        ReadOnly::NotWritable { reason } => CollectError::NotWritable {
            output: output.to_path_buf(),
            reason,
        },
    })?;
    let mut record = Record::from_folder(output)?;
    record.write(output)?;
    report_parts_of_others(plan, parts, progress)?;

    // Projects are written match by match, so that only one is in memory. Queue and table come
    // last, from what the projects have by then.
    let mut collected = Collected::default();
    let mut queue = Queue::new(options.below);
    let mut table = SeasonTable::new();
    let in_plan: BTreeSet<&str> = plan.matches.iter().map(|of| of.name.as_str()).collect();
    let mut used = BTreeSet::new();
    for of_match in &plan.matches {
        let folder = record.folder_of(output, of_match, &in_plan);
        if folder != of_match.name {
            let (name, folder) = (of_match.name.clone(), folder.clone());
            let _ = progress.report(CollectEvent::Renamed { name, folder });
        }
        let to_collect = MatchToCollect {
            plan_path,
            of_match,
            parts,
            output,
            folder: &folder,
        };
        let found = to_collect.collect(&mut record, progress)?;
        collected.add(&found);
        if let Some(document) = &found.document {
            queue.add_match(&of_match.name, &folder, document);
        }
        used.insert(folder);
        table.add(of_match, &found, parts, options.below);
        if progress.report(CollectEvent::Match).is_break() {
            return Err(CollectError::Stopped);
        }
    }
    for folder in record.folders_beside(output, &used) {
        let _ = progress.report(CollectEvent::NotInPlan { folder });
    }
    queue.sort();
    collected.queued = queue.entries().len();
    record.write_file(output, QUEUE_FILE, &queue.to_text())?;
    let table = table.finish();
    for (file, text) in TABLE_FILES
        .iter()
        .zip([table.to_csv(), table.to_markdown()])
    {
        record.write_file(output, file, &text)?;
    }
    record.write(output)?;
    Ok(collected)
}

impl Collected {
    fn add(&mut self, found: &CollectedMatch) {
        self.gaps += found.gaps;
        self.left_alone += usize::from(found.is_left_alone);
        if let Some(document) = &found.document {
            self.projects += 1;
            self.frames += document.frames.len();
            let frames = document.frames.iter();
            self.with_camera += frames.filter(|frame| frame.ptz.is_some()).count();
        }
    }
}

/// Refuses a folder that holds something, but nothing of an earlier collection.
fn refuse_other_folder(output: &Path) -> Result<(), CollectError> {
    let mut entries = match fs::read_dir(output) {
        Ok(entries) => entries,
        Err(_) if !output.exists() => return Ok(()),
        Err(source) if output.is_dir() => {
            return Err(CollectError::from_io("read", output, source));
        }
        Err(_) => {
            return Err(CollectError::NotAFolder {
                output: output.to_path_buf(),
            });
        }
    };
    // A first collection that was killed, or is going on, has left at least its lock. The names of
    // other files say nothing.
    let is_season = [RECORD_FILE, LOCK_FILE]
        .iter()
        .any(|file| output.join(file).exists());
    if is_season || entries.next().is_none() {
        return Ok(());
    }
    Err(CollectError::OtherFolder {
        output: output.to_path_buf(),
    })
}

fn report_parts_of_others(
    plan: &Plan,
    parts: &Path,
    progress: &Progress<'_, CollectEvent>,
) -> Result<(), CollectError> {
    let ids: BTreeSet<&str> = plan.shard_ids().collect();
    let entries =
        fs::read_dir(parts).map_err(|source| CollectError::from_io("read", parts, source))?;
    let mut others: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| shard_of_path(path).is_some_and(|shard| !ids.contains(shard)))
        .collect();
    // A folder lists its files in no order; messages have one.
    others.sort();
    for path in others {
        let _ = progress.report(CollectEvent::NotOfPlan { path });
    }
    Ok(())
}

/// Why parts were not collected.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CollectError {
    /// The system refused.
    #[error("cannot {action} {}: {source}{}", path.display(), way_out(source))]
    Io {
        /// The attempted action.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// There is no folder of parts.
    #[error("there is no folder {}; do the shards of the plan first, with this folder as their -o", parts.display())]
    NoParts {
        /// The folder of parts.
        parts: PathBuf,
    },
    /// The output is a file.
    #[error("{} is a file; give a folder for the season", output.display())]
    NotAFolder { output: PathBuf },
    /// The output holds other things.
    #[error("{} holds other things than a collected season; give another -o", output.display())]
    OtherFolder { output: PathBuf },
    /// A file there has the name of one that is to be written, and is not as it was written.
    #[error(
        "{} is not as touchline collect wrote it and would be replaced; move it away or give another -o",
        path.display()
    )]
    OtherFile {
        /// The file.
        path: PathBuf,
    },
    /// Another process collects into the same folder.
    #[error(
        "another touchline collects into {} ({holder}); wait until it has ended",
        output.display()
    )]
    Busy {
        output: PathBuf,
        /// The process, if known.
        holder: String,
    },
    /// The output cannot be written into.
    #[error("cannot write into {}: {reason}", output.display())]
    NotWritable {
        output: PathBuf,
        /// The system's reason.
        reason: String,
    },
    /// A project cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The progress cancelled it.
    #[error("stopped; the projects of some matches are not collected, and the queue is as it was")]
    Stopped,
}

impl CollectError {
    fn from_io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.to_path_buf(),
            source,
        }
    }
}
