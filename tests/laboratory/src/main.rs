//! `touchline experiment`: measures the paper's tables and figures again. The program runs this one
//! where it finds it beside itself.

use anyhow::{Context as _, ensure};
use clap::Parser as _;
use std::fmt::Write as _;
use std::fs;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchline::store;
use touchline_laboratory::{
    Experiment, ExperimentOptions, OwnDocument, OwnDocuments, Provenance, Report, SharedInputs,
    claims_table, page, times_page,
};

/// Measures the paper's tables and figures again: data as JSON and CSV, figures as SVG and PNG, a
/// report in Markdown.
///
/// The same seed gives the same bytes; what depends on the machine is kept apart, in files whose
/// names end with `times`. Every test frame is in files whose names end with `frames.csv`. `all`
/// runs those of the paper and writes README.md, which begins with what the paper says beside what
/// was measured, and README-times.md. claims.csv has the numbers of these comparisons.
///
/// Frames are drawn unless others are given: the authors' published data (--data), or documents of
/// your own (--train), whose solved frames are the truth. --data DIR is searched, with the folders
/// in it, for the published sequences (MATLAB files such as `highlights/seq1_anno.mat` with their
/// images in `highlights/seq1`), for homographies (`train_val.json` or `N.homographyMatrix`) and
/// for a published motion (`soccer_ground_truth.json`).
#[derive(clap::Parser, Debug)]
#[command(name = "touchline experiment", version)]
struct ExperimentArgs {
    /// Which one: synthetic, ransac, highlights, assumptions, worldcup, errors, threshold, trees,
    /// fov, baselines, descriptors; those that need --data: homographies, motion; all of these; or
    /// what the paper does not have: pose, annotator.
    #[arg(value_name = "NAME", value_parser = parse_experiments)]
    experiments: Chosen,
    /// The folder to write; an empty one counts as absent.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// A tenth or less of everything.
    #[arg(long)]
    quick: bool,
    /// The seed of all random numbers.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Drawn sets are made with so many seeds, from --seed on; 5 by default, 2 with --quick.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    seeds: Option<u32>,
    /// A folder of published data.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// A document of your own whose solved frames are used for training, in place of drawn frames.
    /// Without --test each of its clips is tested against the other clips of its camera; several
    /// documents may be given then.
    #[arg(long, value_name = "DOC")]
    train: Vec<PathBuf>,
    /// A document of your own whose solved frames are tested against those of --train; its cameras
    /// are the truth.
    #[arg(long, value_name = "DOC", requires = "train")]
    test: Option<PathBuf>,
    /// Replace files that exist; files of other names stay.
    #[arg(long)]
    force: bool,
}

/// Some experiments.
#[derive(Clone, Debug)]
struct Chosen(Vec<Experiment>);

fn parse_experiments(name: &str) -> Result<Chosen, String> {
    if name == "all" {
        let of_paper = Experiment::ALL.into_iter().filter(|one| one.is_of_paper());
        return Ok(Chosen(of_paper.collect()));
    }
    match name.parse() {
        Ok(experiment) => Ok(Chosen(vec![experiment])),
        Err(error) => Err(format!("{error}, and all")),
    }
}

/// The file with the reports of all experiments, that with what depends on the machine, and that
/// with the numbers of the comparisons.
const REPORT_FILE: &str = "README.md";
const TIMES_FILE: &str = "README-times.md";
const CLAIMS_FILE: &str = "claims.csv";

fn main() -> ExitCode {
    let args = match ExperimentArgs::try_parse() {
        Ok(args) => args,
        // Help and version are no errors. Of a wrong argument the first paragraph says what is wrong.
        Err(help) if !help.use_stderr() => help.exit(),
        Err(wrong) => {
            let text = wrong.to_string();
            let wrong = text.split("\n\n").next().unwrap_or_default();
            let wrong: Vec<&str> = wrong.split_whitespace().skip(1).collect();
            eprintln!("touchline: {}", wrong.join(" "));
            return ExitCode::from(2);
        }
    };
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let text = format!("touchline: {error:#}");
            eprintln!("{}", text.split_whitespace().collect::<Vec<_>>().join(" "));
            ExitCode::from(2)
        }
    }
}

/// Runs the experiments and writes their reports.
fn run(args: &ExperimentArgs) -> anyhow::Result<()> {
    let folder = &args.output;
    let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    ensure!(
        args.force || !folder.exists() || is_empty,
        "{} already exists; give --force to replace it, or another -o",
        folder.display()
    );
    if let Some(data) = &args.data {
        ensure!(
            data.is_dir(),
            "{} is no folder; give the folder of the data",
            data.display()
        );
    }
    let own = own_documents(args)?;
    let has_own = own.is_some();
    let options = ExperimentOptions {
        quick: args.quick,
        seed: args.seed,
        seeds: args.seeds,
    };
    // Sets of frames, and the forests' answers to them, are computed once for all experiments.
    let inputs = SharedInputs::new(options, own, args.data.as_deref());
    let (chosen, left_out) = chosen(args, &inputs, has_own)?;
    let mut reports = Vec::new();
    for experiment in chosen {
        let mut report = experiment
            .run(&inputs, &|done, total| {
                show_progress(experiment, done, total)
            })
            .with_context(|| format!("experiment {experiment}"))?;
        report.provenance = Some(provenance(
            experiment.name(),
            inputs.seeds(experiment),
            args,
        ));
        // Write each report at once, so that it is kept if a later experiment fails.
        for (name, bytes) in report.files()? {
            write(&folder.join(name), &bytes)?;
        }
        let page = folder.join(format!("{experiment}.md"));
        eprintln!("touchline: {experiment}: {}", page.display());
        reports.push(report);
    }
    if reports.len() > 1 {
        let report = together(&reports, &left_out, args);
        write(&folder.join(REPORT_FILE), report.as_bytes())?;
        write(
            &folder.join(TIMES_FILE),
            times_together(&reports, args).as_bytes(),
        )?;
    }
    let claims = claims_table(&reports);
    if !claims.rows.is_empty() {
        write(&folder.join(CLAIMS_FILE), claims.to_csv().as_bytes())?;
    }
    Ok(())
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    path.parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::write(path, bytes))
        .with_context(|| format!("cannot write {}", path.display()))
}

/// Shows how far an experiment is, on a terminal.
fn show_progress(experiment: Experiment, done: usize, total: usize) {
    if std::io::stderr().is_terminal() {
        eprint!("\r{experiment} {done}/{total}\x1b[K");
    }
}

/// The experiments to run, and those of `all` that are left out because their data are missing.
fn chosen(
    args: &ExperimentArgs,
    inputs: &SharedInputs,
    has_own: bool,
) -> anyhow::Result<(Vec<Experiment>, Vec<Experiment>)> {
    // With a single experiment, what it cannot use is an error. With `all`, what cannot run is left
    // out, and the report names it.
    if let [one] = args.experiments.0[..] {
        ensure!(
            !has_own || one.takes_frames(),
            "this experiment does not use frames of your own; omit --train and --test"
        );
        // Data that were given and have nothing for this experiment are an error: the frames that
        // would be drawn in their place might be taken for the given ones.
        if one.needs_data() || (args.data.is_some() && !has_own) {
            inputs.data_folder(one)?;
        }
        return Ok((vec![one], Vec::new()));
    }
    let experiments = args.experiments.0.iter().copied();
    let all = experiments.filter(|experiment| match experiment {
        Experiment::Homographies | Experiment::Motion => true,
        // A user's own frames are reported once, not again as a World Cup set.
        Experiment::Worldcup => !has_own,
        experiment => !has_own || experiment.takes_frames(),
    });
    Ok(all.partition(|experiment| {
        !experiment.needs_data() || inputs.data_folder(*experiment).is_ok()
    }))
}

/// Reads the documents of `--train` and `--test`; `None` without `--train`.
fn own_documents(args: &ExperimentArgs) -> anyhow::Result<Option<OwnDocuments>> {
    if args.train.is_empty() {
        return Ok(None);
    }
    ensure!(
        args.test.is_none() || args.train.len() == 1,
        "--test needs exactly one --train"
    );
    let train = args
        .train
        .iter()
        .map(|path| own_document(path))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let test = args
        .test
        .as_ref()
        .map(|path| own_document(path))
        .transpose()?;
    Ok(Some(OwnDocuments { train, test }))
}

fn own_document(path: &Path) -> anyhow::Result<OwnDocument> {
    let (location, document, _) = store::read(path)?;
    // A project is named by its folder, another document by its file.
    let (folder, stem) = (location.folder().file_name(), location.file().file_stem());
    let named_by = if stem.is_some_and(|stem| stem == "project") {
        folder.or(stem)
    } else {
        stem
    };
    Ok(OwnDocument {
        name: named_by.unwrap_or_default().to_string_lossy().into_owned(),
        document,
        folder: location.folder().to_path_buf(),
    })
}

/// The provenance of one experiment's report, or of the joint one: program, commit, command, seeds.
fn provenance(name: &str, seeds: Vec<u64>, args: &ExperimentArgs) -> Provenance {
    let mut command = format!("touchline experiment {name}");
    if args.quick {
        command.push_str(" --quick");
    }
    // Writing to a string cannot fail.
    if args.seed != 0 {
        let _ = write!(command, " --seed {}", args.seed);
    }
    if let Some(seeds) = args.seeds {
        let _ = write!(command, " --seeds {seeds}");
    }
    // Only the last part of each path is written: the same data in another folder give the same
    // report.
    let given = args.train.iter().map(|path| ("--train", path));
    let given = given.chain(args.test.iter().map(|path| ("--test", path)));
    for (flag, path) in given.chain(args.data.iter().map(|path| ("--data", path))) {
        let name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy();
        let _ = write!(command, " {flag} {name}");
    }
    Provenance {
        program: format!("touchline {}", env!("CARGO_PKG_VERSION")),
        commit: option_env!("TOUCHLINE_COMMIT").map(str::to_owned),
        command,
        seeds,
        quick: args.quick,
    }
}

/// The provenance of the joint report: its seeds are those of the report that has most of them,
/// since each report counts its own from the same first one.
fn joint_provenance(reports: &[Report], args: &ExperimentArgs) -> Provenance {
    let each = reports
        .iter()
        .filter_map(|report| report.provenance.as_ref());
    let most = each.map(|one| &one.seeds).max_by_key(|seeds| seeds.len());
    provenance("all", most.cloned().unwrap_or_default(), args)
}

/// All reports in one text, preceded by a comparison of the paper's numbers with the measured ones.
fn together(reports: &[Report], left_out: &[Experiment], args: &ExperimentArgs) -> String {
    let (title, frames) = if args.train.is_empty() {
        (
            "The paper, measured again",
            "Sequences are drawn where it does not say otherwise.",
        )
    } else {
        (
            "Real frames and real cameras, measured",
            "Each heading says whose frames it is about.",
        )
    };
    let mut text = format!(
        "# {title}\n\n{} The paper: Chen, Zhu, Little, \"A Two-point Method for PTZ Camera Calibration in Sports\", WACV 2018. {frames}\n",
        joint_provenance(reports, args).describe()
    );
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out
            .iter()
            .map(|experiment| experiment.name())
            .collect();
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\nLeft out for want of data (`--data`): {}.\n",
            names.join(", ")
        );
    }
    for part in std::iter::once(page(reports)).chain(reports.iter().map(Report::to_markdown)) {
        if !part.is_empty() {
            text.push('\n');
            text.push_str(&part);
        }
    }
    text
}

/// What depends on the machine, of all reports.
fn times_together(reports: &[Report], args: &ExperimentArgs) -> String {
    let mut text = format!(
        "# Times on the machine that made this report\n\n{}\n",
        joint_provenance(reports, args).describe()
    );
    let each = reports
        .iter()
        .filter(|report| !report.times.is_empty())
        .map(Report::times_to_markdown);
    for part in std::iter::once(times_page(reports)).chain(each) {
        text.push('\n');
        text.push_str(&part);
    }
    text
}
