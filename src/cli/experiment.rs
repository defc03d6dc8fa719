//! `touchline experiment`: the paper's tables and figures, measured again.

use super::Outcome;
use super::document::{DocumentArg, Loaded};
use super::messages::Messages;
use super::output::{refuse_existing, write_file};
use crate::experiments::{Experiment, ExperimentOptions, OwnDocuments, Report, Workshop};
use anyhow::{Context as _, ensure};
use std::fs;
use std::path::{Path, PathBuf};

/// Measures the paper's tables and figures again: data as JSON and CSV, figures as SVG and PNG, a report in Markdown.
///
/// The same seed gives the same bytes; what depends on the machine stands apart, in files whose names end with `times`.
#[derive(clap::Args, Debug)]
pub struct ExperimentArgs {
    /// Which one: synthetic, ransac, highlights, worldcup, errors, threshold, trees, fov, baselines, descriptors, pose, or all.
    #[arg(value_name = "NAME", value_parser = named)]
    experiments: Chosen,
    /// The folder to write; an empty one counts as absent.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// A tenth or less of everything.
    #[arg(long)]
    quick: bool,
    /// Where chance starts.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// A document of your own whose solved frames teach, in place of drawn frames.
    #[arg(long, value_name = "DOC", requires = "test")]
    train: Option<PathBuf>,
    /// A document of your own whose solved frames are asked; its cameras are the truth.
    #[arg(long, value_name = "DOC", requires = "train")]
    test: Option<PathBuf>,
    /// Replace files that exist; files of other names stay.
    #[arg(long)]
    force: bool,
}

/// Some experiments.
#[derive(Clone, Debug)]
struct Chosen(Vec<Experiment>);

fn named(name: &str) -> Result<Chosen, String> {
    if name == "all" {
        return Ok(Chosen(Experiment::ALL.to_vec()));
    }
    match name.parse() {
        Ok(experiment) => Ok(Chosen(vec![experiment])),
        Err(error) => Err(format!("{error}, and all")),
    }
}

/// The report of all experiments.
const REPORT_FILE: &str = "README.md";

/// Carries out the command.
///
/// # Errors
/// The folder holds something already and `--force` was not given, what an experiment needs is missing, or a file cannot be
/// written.
pub fn experiment(args: &ExperimentArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing(&args.output, args.force)?;
    let folder = &args.output;
    ensure!(folder.is_dir() || !folder.exists(), "{} is a file; give a folder for the results", folder.display());
    let own = own_documents(args, messages)?;
    let chosen: Vec<Experiment> =
        args.experiments.0.iter().copied().filter(|experiment| own.is_none() || experiment.takes_frames()).collect();
    ensure!(!chosen.is_empty(), "this experiment does not look at frames of your own; leave --train and --test away");
    let workshop = Workshop::new(ExperimentOptions { quick: args.quick, seed: args.seed }, own);
    let mut reports = Vec::new();
    for experiment in chosen {
        let bar = messages.progress(1, experiment.name());
        let report = experiment.run(&workshop, &|done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        });
        bar.finish_and_clear();
        let report = report.with_context(|| format!("experiment {experiment}"))?;
        // What is finished is kept, whatever becomes of the next one.
        write_report(&report, folder, args.force)?;
        messages.note(&format!("{experiment}: {}", folder.join(format!("{experiment}.md")).display()));
        reports.push(report);
    }
    if reports.len() > 1 {
        write_file(&folder.join(REPORT_FILE), together(&reports, args).as_bytes(), args.force)?;
    }
    Ok(Outcome::Done)
}

/// Writes the files of a report into a folder, which is made.
///
/// # Errors
/// A figure cannot be drawn, or a file is there already or cannot be written.
pub(super) fn write_report(report: &Report, folder: &Path, force: bool) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, bytes) in report.files()? {
        write_file(&folder.join(name), &bytes, force)?;
    }
    Ok(())
}

fn own_documents(args: &ExperimentArgs, messages: Messages) -> anyhow::Result<Option<OwnDocuments>> {
    let (Some(train), Some(test)) = (&args.train, &args.test) else { return Ok(None) };
    let read = |path: &PathBuf| -> anyhow::Result<_> {
        let Loaded { location, document } = DocumentArg { document: path.clone() }.load(messages)?;
        Ok((document, location.folder().to_path_buf()))
    };
    Ok(Some(OwnDocuments { train: read(train)?, test: read(test)? }))
}

/// All reports one after the other.
fn together(reports: &[Report], args: &ExperimentArgs) -> String {
    let quick = if args.quick { " --quick" } else { "" };
    let seed = if args.seed == 0 { String::new() } else { format!(" --seed {}", args.seed) };
    let mut text = format!(
        "# The paper, measured again\n\nMade by `touchline experiment all{quick}{seed}`. The paper: Chen, Zhu, Little, \"A Two-point \
         Method for PTZ Camera Calibration in Sports\", WACV 2018. Sequences are drawn where it does not say otherwise.\n"
    );
    for report in reports {
        text.push('\n');
        text.push_str(&report.to_markdown());
    }
    text
}
