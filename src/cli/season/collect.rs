//! `touchline collect`: projects, a review queue and a table from the parts of a season.

use crate::cli::Outcome;
use crate::cli::relocalize::probability;
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use std::path::PathBuf;
use touchline_core::geometry::{pluralise, thousands};
use touchline_core::progress::Progress;
use touchline_season::collect::{
    CollectError, CollectEvent, CollectOptions, collect as collect_parts,
};
use touchline_season::plan::Plan;
use touchline_season::season_file::QUEUE_FILE;

/// Makes a project for each match of a season from the parts of its shards, a queue of the frames
/// to look at, worst first, and a table. What is missing is named. May be run again when there are
/// more parts: what people did in the projects stays.
#[derive(clap::Args, Debug)]
pub struct CollectArgs {
    /// The plan that `touchline plan` wrote.
    #[arg(value_name = "plan.json")]
    plan: PathBuf,
    /// The folder of parts.
    #[arg(value_name = "PARTS")]
    parts: PathBuf,
    /// The folder of the season: absent, empty, or of an earlier collection.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Suggestions below this confidence, from 0 to 1, are in the queue and counted as uncertain.
    #[arg(
        long,
        value_name = "0..1",
        default_value_t = CollectOptions::default().below,
        value_parser = probability
    )]
    below: f64,
}

/// Collects the parts. [`Outcome::SomeFailed`] if a shard has no whole part, or a project was left
/// as it is.
///
/// # Errors
/// The plan or the parts cannot be read, the folder holds other things, another process collects
/// into it, or something cannot be written.
pub fn collect(args: &CollectArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let plan = Plan::read(&args.plan)?;
    let interrupt = Interrupt::listen();
    let bar = messages.progress(plan.matches.len(), "Collecting matches");
    let progress = Progress::new(|event| {
        match event {
            CollectEvent::Match => bar.inc(1),
            CollectEvent::Gap { name, what } => messages.frame_failed(&name, &what),
            CollectEvent::LeftAlone { name, why } => {
                messages.frame_failed(&name, &format!("its project was left as it is: {why}"));
            }
            CollectEvent::Renamed { name, folder } => messages.note(&format!(
                "{name}: its frames were collected as {folder}; its project stays in that folder, \
                 which may be renamed"
            )),
            CollectEvent::NotInPlan { folder } => messages.note(&format!(
                "{folder}: no match of this plan; its project stays and is not in {QUEUE_FILE}"
            )),
            CollectEvent::NotOfPlan { path } => messages.note(&format!(
                "{}: no shard of this plan; it is not used",
                path.display()
            )),
        }
        interrupt.check()
    });
    let options = CollectOptions { below: args.below };
    let collected = collect_parts(
        &args.plan,
        &plan,
        &args.parts,
        &args.output,
        &options,
        &progress,
    );
    bar.finish_and_clear();
    let collected = match collected {
        // Ctrl-C is no error: the message says what was written, and the next run goes on from
        // there.
        Err(CollectError::Stopped) => {
            messages.note(&CollectError::Stopped.to_string());
            return Ok(Outcome::Stopped);
        }
        collected => collected?,
    };
    messages.note(&format!(
        "{}: {} with {}, {} of them with a camera; {} in {QUEUE_FILE}, {} without a whole part",
        args.output.display(),
        pluralise(collected.projects, "project"),
        pluralise(collected.frames, "frame"),
        thousands(collected.with_camera),
        pluralise(collected.queued, "frame"),
        pluralise(collected.gaps, "shard"),
    ));
    Ok(Outcome::from_failure(
        collected.gaps + collected.left_alone > 0,
    ))
}
