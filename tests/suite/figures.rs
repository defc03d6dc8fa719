//! The table of the measured figures: `tests/benches/figures.json` is the source,
//! `tests/benches/README.md` shows it.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The figures that have a target.
const FIGURES: &str = "tests/benches/figures.json";
/// The page that shows them.
const PAGE: &str = "tests/benches/README.md";
/// The table stands between these two lines of the page.
const BEGIN: &str = "<!-- figures: begin -->";
const END: &str = "<!-- figures: end -->";
/// A page longer than this is no overview.
const MOST_LINES: usize = 150;
const HEADER: &str = "\
| subject | figure | target | now | met | command | commit |
|---|---|---|---|---|---|---|
";

/// One entry of the source.
struct Figure {
    /// The name of its page, without `.md`.
    subject: String,
    measures: String,
    target: String,
    now: String,
    is_met: bool,
    command: String,
    /// The commit whose code gave the figure, or `unknown`.
    commit: String,
}

impl Figure {
    fn from_json(entry: &Value) -> Self {
        let text = |key: &str| match entry[key].as_str() {
            Some(text) => text.to_owned(),
            None => panic!("{FIGURES}: an entry has no text `{key}`: {entry}"),
        };
        Self {
            subject: text("subject"),
            measures: text("figure"),
            target: text("target"),
            now: text("now"),
            is_met: entry["met"]
                .as_bool()
                .unwrap_or_else(|| panic!("{FIGURES}: `met` is no boolean: {entry}")),
            command: text("command"),
            commit: text("commit"),
        }
    }

    fn row(&self) -> String {
        let Self {
            subject,
            measures,
            target,
            now,
            command,
            commit,
            ..
        } = self;
        let met = if self.is_met { "yes" } else { "**no**" };
        format!(
            "| [{subject}]({subject}.md) | {measures} | {target} | {now} | {met} | `{command}` | {commit} |\n"
        )
    }

    /// The benches that its command runs: each word after `--bench`.
    fn benches(&self) -> impl Iterator<Item = &str> {
        let words = self.command.split_whitespace();
        words
            .clone()
            .zip(words.skip(1))
            .filter(|(flag, _)| *flag == "--bench")
            .map(|(_, bench)| bench)
    }
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The entries in the order of the table: those that miss their target first, then by subject.
fn figures() -> Vec<Figure> {
    let source = fs::read_to_string(path(FIGURES)).unwrap();
    let entries: Vec<Value> = serde_json::from_str(&source).unwrap();
    let mut figures: Vec<_> = entries.iter().map(Figure::from_json).collect();
    figures.sort_by(|a, b| (a.is_met, &a.subject).cmp(&(b.is_met, &b.subject)));
    figures
}

/// The page with the table of `figures` between the two marks.
fn page_with(page: &str, figures: &[Figure]) -> String {
    let (before, rest) = page
        .split_once(BEGIN)
        .unwrap_or_else(|| panic!("{PAGE} lacks the line {BEGIN}"));
    let (_, after) = rest
        .split_once(END)
        .unwrap_or_else(|| panic!("{PAGE} lacks the line {END}"));
    let rows: String = figures.iter().map(Figure::row).collect();
    format!("{before}{BEGIN}\n{HEADER}{rows}{END}{after}")
}

/// A figure is changed in the source; `UPDATE_FIGURES=1` writes the table again.
#[test]
fn the_page_shows_the_figures_of_the_source() {
    let kept = fs::read_to_string(path(PAGE)).unwrap();
    let now = page_with(&kept, &figures());
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        fs::write(path(PAGE), &now).unwrap();
    } else {
        assert!(
            now == kept,
            "the table of {PAGE} differs from {FIGURES}; write it again with UPDATE_FIGURES=1"
        );
    }
    let lines = now.lines().count();
    assert!(
        lines <= MOST_LINES,
        "{PAGE} has {lines} lines, at most {MOST_LINES} are allowed"
    );
}

#[test]
fn every_figure_names_a_page_and_a_bench_that_exist() {
    let manifests = ["Cargo.toml", "tests/laboratory/Cargo.toml"]
        .map(|manifest| fs::read_to_string(path(manifest)).unwrap());
    let known: BTreeSet<&str> = manifests
        .iter()
        .flat_map(|manifest| manifest.split("[[bench]]\nname = \"").skip(1))
        .filter_map(|rest| rest.split('"').next())
        .collect();
    for figure in figures() {
        let page = format!("tests/benches/{}.md", figure.subject);
        assert!(
            path(&page).is_file(),
            "{FIGURES}: \"{}\" belongs to {page}, which does not exist",
            figure.measures
        );
        for bench in figure.benches() {
            assert!(
                known.contains(bench),
                "{FIGURES}: no Cargo.toml has a bench `{bench}` of \"{}\"",
                figure.command
            );
        }
    }
}

#[test]
fn figures_that_miss_their_target_come_first() {
    let figure = |subject: &str, is_met| Figure {
        subject: subject.into(),
        measures: "time".into(),
        target: "1 s".into(),
        now: "2 s".into(),
        is_met,
        command: "cargo bench --bench solve --bench paint".into(),
        commit: "unknown".into(),
    };
    let missed = figure("solve", false);
    assert_eq!(missed.benches().collect::<Vec<_>>(), ["solve", "paint"]);
    let page = page_with(
        &format!("above\n{BEGIN}\nold\n{END}\nbelow\n"),
        &[missed, figure("paint", true)],
    );
    assert_eq!(
        page,
        format!(
            "above\n{BEGIN}\n{HEADER}\
             | [solve](solve.md) | time | 1 s | 2 s | **no** | `cargo bench --bench solve --bench paint` | unknown |\n\
             | [paint](paint.md) | time | 1 s | 2 s | yes | `cargo bench --bench solve --bench paint` | unknown |\n\
             {END}\nbelow\n"
        )
    );
}
