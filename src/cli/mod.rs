//! The command line: one file per command. What commands share is in `terminal`; the commands for a
//! season and those that only measure have folders of their own.
//!
//! Results go to `-o` or standard output; messages and progress go to standard error. Exit codes:
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | done except for named frames; or problems, conflicts, or no camera found |
//! | 2 | wrong usage or unreadable input, explained in one line |
//! | 130 | stopped by Ctrl-C; a message says which parts of the work were written |

#![allow(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]

mod calibrate;
mod check;
mod dataset;
mod export;
mod fields;
mod import;
mod match_report;
mod measuring;
mod mend;
mod merge;
mod new;
mod points;
mod refine_base;
mod relocalize;
mod render;
mod season;
mod shot_sheets;
mod shot_table;
mod snap;
mod solve;
mod split;
mod stretched;
mod terminal;
mod track;
mod train;
mod venue;

use clap::{CommandFactory as _, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use terminal::messages::Messages;

/// Calibrates a pan-tilt-zoom sports camera from two clicks.
#[derive(Parser)]
// Without the precedence a list of documents would take the command's name for one of them.
#[command(
    name = "touchline",
    version,
    about,
    subcommand_precedence_over_arg = true
)]
struct Cli {
    /// A project, dataset, folder of frames, video or queue to open in the window; several videos
    /// or projects open as a queue.
    documents: Vec<PathBuf>,
    #[command(subcommand)]
    command: Option<Command>,
    /// Messages as JSON, one object a line.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Command {
    Calibrate(calibrate::CalibrateArgs),
    Check(check::CheckArgs),
    Collect(season::collect::CollectArgs),
    Evaluate(measuring::evaluate::EvaluateArgs),
    #[command(hide = true)]
    Experiment(measuring::experiment::ExperimentArgs),
    Export(Box<export::ExportArgs>),
    Fields(fields::FieldsArgs),
    Import(Box<import::ImportArgs>),
    Mend(mend::MendArgs),
    Merge(merge::MergeArgs),
    New(new::NewArgs),
    Plan(season::plan::PlanArgs),
    Points(points::PointsArgs),
    Queue(season::queue::QueueArgs),
    RefineBase(refine_base::RefineBaseArgs),
    Relocalize(relocalize::RelocalizeArgs),
    Render(render::RenderArgs),
    Shard(season::shard::ShardArgs),
    Snap(snap::SnapArgs),
    Solve(solve::SolveArgs),
    Split(split::SplitArgs),
    Synth(measuring::synth::SynthArgs),
    Track(track::TrackArgs),
    Train(train::TrainArgs),
    Venue(venue::VenueArgs),
}

/// How a command ended, if it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Exit code 0: everything was done.
    Done,
    /// Exit code 1: done except for some frames, each named in a message; or the finding of the
    /// command is negative.
    SomeFailed,
    /// Exit code 130: stopped by Ctrl-C; a message says which parts of the work were written.
    Stopped,
}

impl Outcome {
    /// [`Self::SomeFailed`] if anything failed, else [`Self::Done`].
    const fn from_failure(has_failed: bool) -> Self {
        if has_failed {
            Self::SomeFailed
        } else {
            Self::Done
        }
    }
}

/// What the program does after it has read its arguments.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Exit with the code of the command that has run.
    Exit(ExitCode),
    /// Open the window, on the documents that were named.
    Window(Vec<PathBuf>),
}

/// The command line as clap has it, for man pages and completions.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Reads the process's arguments and runs the command that they name.
pub fn run() -> Next {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return Next::Exit(wrong_usage(&error)),
        // Help and version are errors only by clap's types: they go to standard output, with code
        // 0.
        Err(help) => help.exit(),
    };
    let messages = if cli.json {
        Messages::Json
    } else {
        Messages::Text
    };
    let Some(command) = cli.command else {
        let first = cli.documents.first();
        let misspelt = first.and_then(|first| describe_misspelt(first.to_str()?));
        return misspelt.map_or(Next::Window(cli.documents), |why| {
            messages.error(&why);
            Next::Exit(ExitCode::from(2))
        });
    };
    // The parser accepts `touchline DOC COMMAND`, for the window alone takes documents there.
    if let Some(document) = cli.documents.first() {
        messages.error(&format!(
            "{} comes before the command; put it after the command",
            document.display()
        ));
        return Next::Exit(ExitCode::from(2));
    }
    let result: anyhow::Result<Outcome> = match command {
        Command::Calibrate(args) => calibrate::calibrate(&args, messages),
        Command::Check(args) => check::check(&args, messages),
        Command::Collect(args) => season::collect::collect(&args, messages),
        Command::Evaluate(args) => measuring::evaluate::evaluate(&args, messages),
        Command::Experiment(args) => measuring::experiment::experiment(&args),
        Command::Export(args) => export::export(&args, messages),
        Command::Fields(args) => fields::fields(&args, messages),
        Command::Import(args) => import::import(&args, messages),
        Command::Mend(args) => mend::mend(&args, messages),
        Command::Merge(args) => merge::merge(&args, messages),
        Command::New(args) => new::new(&args, messages),
        Command::Plan(args) => season::plan::plan(&args, messages),
        Command::Points(args) => points::points(&args, messages),
        Command::Queue(args) => season::queue::queue(&args, messages),
        Command::RefineBase(args) => refine_base::refine_base(&args, messages),
        Command::Relocalize(args) => relocalize::relocalize(&args, messages),
        Command::Render(args) => {
            give_runtime_folder();
            render::render(&args, messages)
        }
        Command::Shard(args) => season::shard::shard(&args, messages),
        Command::Snap(args) => snap::snap(&args, messages),
        Command::Solve(args) => solve::solve(&args, messages),
        Command::Split(args) => split::split(&args, messages),
        Command::Synth(args) => measuring::synth::synth(&args, messages),
        Command::Track(args) => track::track(&args, messages),
        Command::Train(args) => train::train(&args, messages),
        Command::Venue(args) => venue::venue(&args, messages),
    };
    Next::Exit(exit_code(result, messages))
}

/// Starts the program again with a runtime folder if its session names none. Without one the
/// libraries of Wayland and Vulkan write an error each time they look for a display, although X11
/// and drawing off screen need none; and a process cannot set a variable of its own once it may
/// have threads. On other systems than Linux nothing happens.
pub fn give_runtime_folder() {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::process::CommandExt as _;
        const VARIABLE: &str = "XDG_RUNTIME_DIR";
        if std::env::var_os(VARIABLE).is_some() {
            return;
        }
        let folder = private_folder(&std::env::temp_dir());
        if let (Ok(program), Some(folder)) = (std::env::current_exe(), folder) {
            // It returns only if it failed: then the program goes on as it is.
            let _ = std::process::Command::new(program)
                .args(std::env::args_os().skip(1))
                .env(VARIABLE, folder)
                .exec();
        }
    }
}

/// The user's own folder for runtime files within a folder that all users share; it is made if it
/// is missing. None if it is not the user's alone: the sockets in it would then be another's, and
/// the program would talk to them.
#[cfg(target_os = "linux")]
fn private_folder(shared: &std::path::Path) -> Option<PathBuf> {
    use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
    // A process's entry there belongs to its user.
    let user = std::fs::metadata("/proc/self").ok()?.uid();
    let folder = shared.join(format!("touchline-runtime-{user}"));
    // If it exists already, this fails, and what is there is examined.
    let _ = std::fs::DirBuilder::new().mode(0o700).create(&folder);
    // Not the target of a link, which may lead anywhere.
    let there = std::fs::symlink_metadata(&folder).ok()?;
    let is_private = there.is_dir() && there.uid() == user && there.mode() & 0o777 == 0o700;
    is_private.then_some(folder)
}

/// The error and its causes in one text. A cause that the text already contains is not repeated.
pub(in crate::cli) fn describe_error(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// The exit code of a command. Reports an error in one line.
fn exit_code(result: anyhow::Result<Outcome>, messages: Messages) -> ExitCode {
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::SomeFailed) => ExitCode::from(1),
        Ok(Outcome::Stopped) => ExitCode::from(terminal::interrupt::EXIT_CODE),
        Err(error) => {
            messages.error(&describe_error(&error));
            ExitCode::from(2)
        }
    }
}

/// Reports wrong arguments. They are not parsed, so `--json` is looked for among the raw ones.
fn wrong_usage(error: &clap::Error) -> ExitCode {
    let messages = if std::env::args_os().any(|arg| arg == "--json") {
        Messages::Json
    } else {
        Messages::Text
    };
    let first = std::env::args().nth(1);
    let misspelt = first.and_then(|first| describe_misspelt(&first));
    messages.error(&misspelt.unwrap_or_else(|| usage_line(error)));
    ExitCode::from(2)
}

/// The message that a word in the place of a command is nearly one; none where it is not, or where
/// a document of this name lies there.
fn describe_misspelt(word: &str) -> Option<String> {
    /// Letters that may be missing, wrong or too many.
    const MOST_WRONG: usize = 2;
    let program = Cli::command();
    let names: Vec<&str> = program
        .get_subcommands()
        .map(clap::Command::get_name)
        .collect();
    if names.contains(&word) || std::path::Path::new(word).exists() {
        return None;
    }
    let meant = names
        .iter()
        .find(|name| count_edits(word, name) <= MOST_WRONG.min(name.len() / 2))?;
    Some(format!(
        "there is no command {word:?}; `touchline {meant}` may be meant"
    ))
}

/// How many letters have to be put in, taken out or replaced to make one word of another
/// (Levenshtein's distance).
fn count_edits(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    // The distances of what was read of `from` to each beginning of `to`.
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (read, letter) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = read + 1;
        for (index, other) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[index + 1];
            row[index + 1] = replaced.min(row[index] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

/// One line about wrong arguments, without clap's usage text.
fn usage_line(error: &clap::Error) -> String {
    let text = error.to_string();
    // What is wrong may take several lines, such as a list of possible values. They are joined up
    // to the usage, for a script reads one line for each message.
    let what = text
        .lines()
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        .map(str::trim);
    let what = what
        .filter(|line| !line.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    let what = what.strip_prefix("error: ").unwrap_or(&what);
    // The advice to put `--` before a number below zero is for a place of its own; that of an
    // option stands behind `=`.
    let is_number = |tip: &str| tip.as_bytes().get(2).is_some_and(u8::is_ascii_digit);
    let what = match what.split_once(" tip: to pass ") {
        Some((what, tip)) if is_number(tip) => {
            format!("{what}; a number below zero is written behind =, as in --frame=-1")
        }
        _ => what.to_owned(),
    };
    format!("{what}; see touchline --help")
}

/// The message about wrong arguments, for `tests/fuzz`; runs nothing.
#[cfg(fuzzing)]
pub fn usage_message<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let error = Cli::try_parse_from(std::iter::once("touchline").chain(arguments)).err()?;
    error
        .use_stderr()
        .then(|| Messages::Text.line("error", None, &usage_line(&error)))
}

#[cfg(test)]
mod tests {
    use super::{count_edits, describe_error, describe_misspelt};
    use anyhow::Context as _;

    #[test]
    fn a_misspelt_command_names_the_one_that_is_meant() {
        assert_eq!(count_edits("sovle", "solve"), 2);
        let said = describe_misspelt("sovle").unwrap();
        assert!(said.contains("`touchline solve`"), "{said}");
        assert_eq!(describe_misspelt("solve"), None);
        assert_eq!(describe_misspelt("match.json"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_runtime_folder_is_the_users_alone() {
        use std::os::unix::fs::PermissionsExt as _;
        let shared = tempfile::tempdir().unwrap();
        let folder = super::private_folder(shared.path()).unwrap();
        assert_eq!(folder.parent(), Some(shared.path()));
        assert_eq!(super::private_folder(shared.path()), Some(folder.clone()));
        let open = std::fs::Permissions::from_mode(0o777);
        std::fs::set_permissions(&folder, open).unwrap();
        assert_eq!(super::private_folder(shared.path()), None);
        std::fs::remove_dir(&folder).unwrap();
        std::os::unix::fs::symlink(shared.path(), &folder).unwrap();
        assert_eq!(super::private_folder(shared.path()), None);
    }

    #[test]
    fn a_cause_is_said_once() {
        let cause = || std::io::Error::other("no space");
        let named = touchline_documents::exchange::ExchangeError::Write {
            path: "a".into(),
            source: cause(),
        };
        assert_eq!(
            describe_error(&anyhow::Error::from(named)),
            "cannot write a: no space"
        );
        let wrapped = Err::<(), _>(cause())
            .context("cannot read the map")
            .unwrap_err();
        assert_eq!(describe_error(&wrapped), "cannot read the map: no space");
    }
}
