//! `touchline shard`: one unit of work of a season.

use crate::cli::Outcome;
use crate::cli::match_report::MatchReport;
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use std::path::PathBuf;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_season::parent::die_with_parent;
use touchline_season::plan::Plan;
use touchline_season::shard::{ShardDone, ShardError, ShardEvent, do_shard};

/// Does one shard of a plan and writes its part. A part that is there and whole is left as it is,
/// so a shard may be started again at any time and on several machines. It ends when the process
/// that started it does.
#[derive(clap::Args, Debug)]
pub struct ShardArgs {
    /// The plan that `touchline plan` wrote.
    #[arg(value_name = "plan.json")]
    plan: PathBuf,
    /// The shard's id in the plan.
    #[arg(value_name = "ID")]
    id: String,
    /// The folder of parts; made if absent.
    #[arg(short, long, value_name = "PARTS")]
    output: PathBuf,
}

/// Does the shard. That a frame or a match has no camera is no failure of its shard: the part says
/// so, and an engine must not do it again.
///
/// # Errors
/// The plan has no such shard or is for other machines, its frames changed, a file in place of the
/// part is another one, or it cannot be written.
pub fn shard(args: &ShardArgs, messages: Messages) -> anyhow::Result<Outcome> {
    // Before any work: an engine that was killed cannot stop what it started.
    die_with_parent();
    let interrupt = Interrupt::listen();
    let plan = Plan::read(&args.plan)?;
    let report = MatchReport::new(messages);
    let progress = Progress::new(|event| {
        match event {
            ShardEvent::FindingFirst => {
                messages.note("the cameras of the match are not found yet: this is done first");
            }
            ShardEvent::LeftOut { frame, error } => {
                messages.frame_failed(&frame, &error.to_string());
            }
            ShardEvent::Frames(event) => report.on_event(event),
        }
        interrupt.check()
    });
    let done = do_shard(&args.plan, &plan, &args.id, &args.output, &progress);
    drop(progress);
    drop(report);
    let what = plan.shard(&args.id).map(|shard| shard.describe());
    let what = what.unwrap_or_default();
    match done {
        Ok(ShardDone::WasThere) => messages.note(&format!("{what}: done before")),
        Ok(ShardDone::Made {
            frames,
            with_camera,
            reason,
        }) => {
            let reason = reason.map_or_else(String::new, |reason| format!("; {reason}"));
            messages.note(&format!(
                "{what}: {}, {with_camera} with a camera{reason}",
                pluralise(frames, "frame")
            ));
        }
        // No part is written then; the shard may be started again.
        Err(ShardError::Stopped) => {
            messages.note(&ShardError::Stopped.to_string());
            return Ok(Outcome::Stopped);
        }
        Err(error) => return Err(error.into()),
    }
    Ok(Outcome::Done)
}
