//! `touchline queue`: labels several matches, one after the other.

use crate::cli::calibrate::{CalibrateArgs, Labelling, LabellingArgs, label};
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{refuse_existing_file, write_file};
use crate::cli::{Outcome, describe_error};
use anyhow::{Context as _, anyhow, bail, ensure};
use std::path::{Path, PathBuf};
use touchline_application::jobs::{look_at_match, until_it_panics};
use touchline_application::scene::match_list::{MatchState, without_path};
use touchline_core::files::folder_of;
use touchline_core::geometry::thousands;
use touchline_documents::store::PROJECT_FILE;
use touchline_season::queue::{Queue, QueuedMatch};

/// The queue that is written without `-o`.
const QUEUE_FILE: &str = "queue.json";
/// What is noted of a match before its labelling begins, for a run that is killed.
const UNFINISHED: &str = "its labelling was stopped";

/// Labels several matches without a click, one after the other, each as `touchline calibrate` does,
/// into a project beside its video or folder: `match.mp4.touchline`. One that fails is named, and
/// the next one goes on. The queue that is written opens in the window.
///
/// A project that has a camera or accepted frames is left as it is, and counts as done; one without
/// a camera is labelled in place. After Ctrl-C or a crash the same command goes on from there.
#[derive(clap::Args, Debug)]
pub struct QueueArgs {
    /// Videos, folders of images, projects, and queues of them.
    #[arg(value_name = "FILES", required = true)]
    matches: Vec<PathBuf>,
    /// The queue to write; without it the queue that is given alone, or else `queue.json`.
    #[arg(short, long, value_name = "queue.json")]
    output: Option<PathBuf>,
    #[command(flatten)]
    labelling: LabellingArgs,
    /// Label matches again that have a project, which is kept as project.json.bak, and replace
    /// another queue.
    #[arg(long)]
    force: bool,
}

/// Labels the matches and writes the queue. [`Outcome::SomeFailed`] if one failed;
/// [`Outcome::Stopped`] after Ctrl-C.
///
/// # Errors
/// A queue cannot be read or written, or another one would be replaced.
pub fn queue(args: &QueueArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let output = match (&args.output, args.matches.as_slice()) {
        (Some(output), _) => output,
        (None, [alone]) if Queue::is_at(alone) => alone,
        (None, _) => Path::new(QUEUE_FILE),
    };
    let mut file = QueueFile::reserve(output, Queue::from_paths(&args.matches)?, args.force)?;
    let interrupt = Interrupt::listen();
    let count = file.queue.matches.len();
    let mut is_stopped = false;
    for at in 0..count {
        let queued = file.queue.matches[at].clone();
        let state = queued.project.exists().then(|| look_at_match(&queued));
        if !args.force && state.as_ref().is_some_and(|state| is_done(&queued, state)) {
            messages.note(&format!("{}: done already", queued.name));
            continue;
        }
        messages.note(&format!("match {} of {count}: {}", at + 1, queued.name));
        file.note(at, Some(UNFINISHED.to_owned()))?;
        let ended = until_it_panics(|| label_match(args, &queued, state.as_ref(), messages))
            .unwrap_or_else(|panicked| {
                Err(anyhow!("internal error (please report it): {panicked}"))
            });
        match ended {
            Ok(Labelling::Ended(Outcome::Stopped)) => is_stopped = true,
            Ok(Labelling::Ended(_)) => file.note(at, None)?,
            Ok(Labelling::NoCamera(why)) => file.note(at, Some(why))?,
            Err(error) => {
                let error = describe_error(&error);
                let why = without_path(&error, queued.source()).to_owned();
                messages.failures(&[format!("{}: {why}", queued.name)]);
                file.note(at, Some(why))?;
            }
        }
        is_stopped = is_stopped || interrupt.is_pressed();
        if is_stopped {
            messages.note("stopped; the same command goes on from here");
            return Ok(Outcome::Stopped);
        }
    }
    let states: Vec<MatchState> = file.queue.matches.iter().map(final_state).collect();
    for line in describe_matches(&file.queue.matches, &states) {
        messages.note(&line);
    }
    let failed = states
        .iter()
        .filter(|state| state.counts().is_none())
        .count();
    let path = output.display();
    messages.note(&format!(
        "{path}: {failed} of {count} failed; touchline {path} opens them"
    ));
    Ok(Outcome::from_failure(failed > 0))
}

/// Whether a match needs no labelling: a person has worked in its project, or it has a camera and
/// its labelling was not stopped.
fn is_done(queued: &QueuedMatch, state: &MatchState) -> bool {
    state.counts().is_some_and(|counts| {
        counts.accepted > 0 || (counts.cameras > 0 && queued.failed.is_none())
    })
}

/// Labels a match: its project in place as long as it has no camera, else what it is made of.
fn label_match(
    args: &QueueArgs,
    queued: &QueuedMatch,
    state: Option<&MatchState>,
    messages: Messages,
) -> anyhow::Result<Labelling> {
    let has_camera = state
        .and_then(MatchState::counts)
        .is_some_and(|counts| counts.cameras > 0);
    let is_project = queued
        .project
        .file_name()
        .is_some_and(|name| name == PROJECT_FILE);
    let frames = queued
        .frames
        .as_ref()
        .filter(|_| state.is_none() || has_camera);
    if frames.is_none() && !is_project {
        bail!("only projects are labelled in place, not datasets");
    }
    let mut labelling = args.labelling.clone();
    if frames.is_none() {
        // A project states its field.
        (labelling.field, labelling.set) = (None, Vec::new());
    }
    let args = CalibrateArgs {
        frames: frames.unwrap_or(&queued.project).clone(),
        output: folder_of(&queued.project).to_path_buf(),
        labelling,
        panorama: None,
        report: None,
        force: state.is_some(),
    };
    label(&args, messages)
}

/// The state of a match after all of them: a failure outweighs a project without a camera.
fn final_state(queued: &QueuedMatch) -> MatchState {
    match &queued.failed {
        Some(why) if !queued.project.exists() => MatchState::from_failure(why, queued.source()),
        _ => look_at_match(queued),
    }
}

/// The lines of the table of matches.
fn describe_matches(matches: &[QueuedMatch], states: &[MatchState]) -> Vec<String> {
    let names = matches.iter().map(|queued| queued.name.chars().count());
    let width = names.max().unwrap_or_default().max("match".len());
    let heads = [
        "cameras",
        "frames",
        "certain",
        "uncertain",
        "none",
        "doubts",
        "minutes",
    ];
    let line = |name: &str, cells: [String; 7]| {
        let [a, b, c, d, e, f, g] = cells;
        format!("{name:<width$} {a:>9} {b:>9} {c:>9} {d:>9} {e:>9} {f:>9} {g:>9}")
    };
    let mut lines = vec![line("match", heads.map(str::to_owned))];
    for (queued, state) in matches.iter().zip(states) {
        let minutes = state
            .minutes
            .map_or_else(|| "–".to_owned(), |minutes| format!("{minutes:.1}"));
        lines.push(match state.counts() {
            Some(counts) => {
                let numbers = [
                    counts.cameras,
                    counts.frames,
                    counts.certain,
                    counts.uncertain,
                ];
                let [cameras, frames, certain, uncertain] = numbers.map(thousands);
                let [none, doubts] = [counts.none, counts.doubts].map(thousands);
                line(
                    &queued.name,
                    [cameras, frames, certain, uncertain, none, doubts, minutes],
                )
            }
            None => format!("{:<width$}   {}", queued.name, state.describe()),
        });
    }
    lines
}

/// The queue, and its file, which says after each match how far the work has come.
struct QueueFile {
    path: PathBuf,
    queue: Queue,
}

impl QueueFile {
    /// Takes over what the file says of the same matches.
    ///
    /// # Errors
    /// It is there and is no queue, or lists other matches or frames that would be lost.
    fn reserve(path: &Path, mut queue: Queue, force: bool) -> anyhow::Result<Self> {
        let before = if Queue::is_at(path) {
            Some(Queue::read(path)?)
        } else {
            None
        };
        refuse_existing_file(path, force || before.is_some())?;
        if let Some(before) = before.filter(|_| !force) {
            let mut is_kept = before.entries().is_empty();
            for known in before.all_matches(folder_of(path)) {
                let mut matches = queue.matches.iter_mut();
                let same = matches.find(|queued| queued.project == known.project);
                is_kept &= same.is_some();
                if let Some(same) = same {
                    (same.failed, same.frames) =
                        (known.failed, same.frames.take().or(known.frames));
                }
            }
            ensure!(
                is_kept,
                "{} is another queue; give --force to replace it, or another -o",
                path.display()
            );
        }
        let absolute = std::path::absolute(path)?;
        let folder = folder_of(&absolute);
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make {}", folder.display()))?;
        let file = folder
            .canonicalize()?
            .join(path.file_name().unwrap_or_default());
        let reserved = Self { path: file, queue };
        reserved.write()?;
        Ok(reserved)
    }

    /// Notes why the labelling of a match came to no good end.
    fn note(&mut self, at: usize, failed: Option<String>) -> anyhow::Result<()> {
        if let Some(queued) = self.queue.matches.get_mut(at) {
            queued.failed = failed;
        }
        self.write()
    }

    fn write(&self) -> anyhow::Result<()> {
        let written = self.queue.clone().relative_to(folder_of(&self.path));
        write_file(&self.path, written.to_text().as_bytes(), true)
    }
}
