//! `touchline plan`: the shards of a season.

use crate::cli::Outcome;
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{refuse_existing_file, write_file};
use anyhow::Context as _;
use std::path::{Path, PathBuf};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_season::plan::{MakePlanError, make_plan};
use touchline_season::processor::{ANY, processor_class};
use touchline_season::season_file::Season;

/// Divides a season into shards, which `touchline shard` does one by one on any machine. The season
/// file names the matches; videos are hashed once, and the hashes are kept beside them.
#[derive(clap::Args, Debug)]
pub struct PlanArgs {
    /// The season file.
    #[arg(value_name = "SEASON.toml")]
    season: PathBuf,
    /// The plan to write.
    #[arg(short, long, value_name = "plan.json")]
    output: PathBuf,
    /// Also write a file with one shell line for each shard, those that find cameras first.
    #[arg(long, value_name = "FILE")]
    commands: Option<PathBuf>,
    /// The folder of parts that these lines name.
    #[arg(
        long,
        value_name = "DIR",
        default_value = "parts",
        requires = "commands"
    )]
    parts: PathBuf,
    /// Allow machines of any processor class to do the shards. The bytes of their parts may then
    /// differ in last digits.
    #[arg(long)]
    any_processor: bool,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

/// Reads the season, makes its plan and writes it.
///
/// # Errors
/// The season file has a mistake, something that it names cannot be read, or a file exists or
/// cannot be written.
pub fn plan(args: &PlanArgs, messages: Messages) -> anyhow::Result<Outcome> {
    for path in std::iter::once(&args.output).chain(&args.commands) {
        refuse_existing_file(path, args.force)?;
    }
    // The videos are hashed first, which takes long: what the lines cannot name is refused here.
    let commands = match &args.commands {
        Some(file) => Some((file, quote(&args.output)?, quote(&args.parts)?)),
        None => None,
    };
    let season = Season::read(&args.season)?;
    let processor = if args.any_processor {
        ANY.to_owned()
    } else {
        processor_class()
    };
    let bar = messages.progress(season.matches.len(), "Hashing matches");
    let interrupt = Interrupt::listen();
    let progress = Progress::new(|()| {
        bar.inc(1);
        interrupt.check()
    });
    let plan = make_plan(&season, &args.output, &processor, &progress);
    bar.finish_and_clear();
    let plan = match plan {
        Err(MakePlanError::Stopped) => {
            messages.note(&MakePlanError::Stopped.to_string());
            return Ok(Outcome::Stopped);
        }
        plan => plan?,
    };
    write_file(&args.output, plan.to_text()?.as_bytes(), args.force)?;
    if let Some((file, path, parts)) = commands {
        let lines = plan
            .shard_ids()
            .map(|id| format!("touchline shard {path} {id} -o {parts}\n"));
        write_file(file, lines.collect::<String>().as_bytes(), args.force)?;
    }
    let finds = plan.matches.len();
    let labels = plan.shard_ids().count() - finds;
    messages.note(&format!(
        "{}: {} that find cameras, {} that label frames",
        args.output.display(),
        pluralise(finds, "shard"),
        pluralise(labels, "shard"),
    ));
    Ok(Outcome::Done)
}

/// A path as one word of a shell, which `xargs` reads in the same way.
///
/// # Errors
/// The path is not UTF-8, so that a line of text would name another one.
fn quote(path: &Path) -> anyhow::Result<String> {
    let text = path.to_str().with_context(|| {
        format!(
            "{}: --commands cannot name it, for it is not UTF-8; rename it",
            path.display()
        )
    })?;
    // A line is a command, and what begins with a dash is an option.
    if text.contains(['\n', '\r']) {
        anyhow::bail!("{text:?}: --commands cannot name it, for it has a line break; rename it");
    }
    let dashed = text.starts_with('-').then(|| format!("./{text}"));
    let text = dashed.as_deref().unwrap_or(text);
    let is_plain = text
        .chars()
        .all(|character| character.is_ascii_alphanumeric() || "/._-+,:@%".contains(character));
    if !text.is_empty() && is_plain {
        return Ok(text.to_owned());
    }
    Ok(format!("'{}'", text.replace('\'', "'\\''")))
}

#[cfg(test)]
mod tests {
    use super::quote;
    use std::path::Path;

    #[test]
    fn a_path_is_one_word_of_a_shell() {
        for (path, quoted) in [
            ("a/plan.json", "a/plan.json"),
            ("my plan.json", "'my plan.json'"),
            ("it's", r"'it'\''s'"),
            ("$HOME", "'$HOME'"),
            ("-plan.json", "./-plan.json"),
            ("-my plan", "'./-my plan'"),
        ] {
            assert_eq!(quote(Path::new(path)).unwrap(), quoted);
        }
    }

    #[test]
    fn a_path_of_two_lines_is_refused() {
        let error = quote(Path::new("a\nb.json")).unwrap_err().to_string();
        assert!(error.ends_with("it has a line break; rename it"), "{error}");
    }

    #[test]
    #[cfg(unix)]
    fn a_path_that_is_no_text_is_refused() {
        use std::os::unix::ffi::OsStrExt as _;
        let path = Path::new(std::ffi::OsStr::from_bytes(b"plan\xff.json"));
        let error = quote(path).unwrap_err().to_string();
        assert!(error.ends_with("it is not UTF-8; rename it"), "{error}");
    }
}
