//! A report: text, tables and figures in order, and the files they become.

use super::claim::{Claim, Verdict};
use super::figure::{Figure, FigureError};
use super::provenance::Provenance;
use super::table::Table;
use serde_json::{Map, json};
use std::fmt::Write as _;

/// A report: text, tables and figures in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Its name, with which the files begin.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What it says, in order.
    pub blocks: Vec<Block>,
    /// What depends on the machine, kept apart: everything else has the same bytes each time.
    pub times: Vec<Block>,
    /// What others state, and what was measured here.
    pub claims: Vec<Claim>,
    /// What made it; none: nothing is said of that.
    pub provenance: Option<Provenance>,
}

/// A part of a report.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Markdown.
    Text(String),
    /// A table, also written as CSV.
    Table {
        /// Its file's name without an ending.
        stem: String,
        /// What it shows.
        caption: String,
        /// The table.
        table: Table,
    },
    /// A long table, written as CSV only and named in the text.
    Data {
        /// Its file's name without an ending.
        stem: String,
        /// What it holds.
        caption: String,
        /// The table.
        table: Table,
    },
    /// A figure, written as SVG and PNG.
    Figure {
        /// Its file's name without an ending.
        stem: String,
        /// What it shows.
        caption: String,
        /// The figure.
        figure: Figure,
    },
    /// A picture that is a PNG already.
    Picture {
        /// Its file's name without an ending.
        stem: String,
        /// What it shows.
        caption: String,
        /// The file.
        png: Vec<u8>,
    },
}

/// A file of a report: its name and its bytes.
pub type ReportFile = (String, Vec<u8>);

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(name: &str, title: &str) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            ..Self::default()
        }
    }

    /// Adds Markdown text.
    pub fn text(&mut self, text: &str) {
        self.blocks.push(Block::Text(text.to_owned()));
    }

    /// Adds a table.
    pub fn table(&mut self, stem: &str, caption: &str, table: Table) {
        self.blocks.push(Block::Table {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            table,
        });
    }

    /// Adds a long table, which people find in a file of its own.
    pub fn data(&mut self, stem: &str, caption: &str, table: Table) {
        self.blocks.push(Block::Data {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            table,
        });
    }

    /// Adds what others state and what was measured.
    pub fn claim(&mut self, verdict: Verdict, stated: &str, measured: &str, reason: &str) {
        let [stated, measured, reason] = [stated, measured, reason].map(str::to_owned);
        self.claims.push(Claim {
            stated,
            measured,
            verdict,
            reason,
            of_times: false,
        });
    }

    /// The same of times, which depend on the machine.
    pub fn time_claim(&mut self, verdict: Verdict, stated: &str, measured: &str, reason: &str) {
        self.claim(verdict, stated, measured, reason);
        if let Some(claim) = self.claims.last_mut() {
            claim.of_times = true;
        }
    }

    /// Adds a figure.
    pub fn figure(&mut self, stem: &str, caption: &str, figure: Figure) {
        self.blocks.push(Block::Figure {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            figure,
        });
    }

    /// Adds a picture.
    pub fn picture(&mut self, stem: &str, caption: &str, png: Vec<u8>) {
        self.blocks.push(Block::Picture {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            png,
        });
    }

    /// Adds a table of what depends on the machine.
    pub fn time_table(&mut self, stem: &str, caption: &str, table: Table) {
        self.times.push(Block::Table {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            table,
        });
    }

    /// Adds a figure of what depends on the machine.
    pub fn time_figure(&mut self, stem: &str, caption: &str, figure: Figure) {
        self.times.push(Block::Figure {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            figure,
        });
    }

    fn stem(&self, stem: &str) -> String {
        format!("{}-{stem}", self.name)
    }

    /// The report as Markdown; figures and pictures by their files' names.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        markdown(&self.title, &self.blocks)
    }

    /// The same of what depends on the machine.
    #[must_use]
    pub fn times_to_markdown(&self) -> String {
        markdown(
            &format!("{}: times on this machine", self.title),
            &self.times,
        )
    }

    /// A report of its own file: what made it stands below.
    fn standing_alone(&self, markdown: String) -> String {
        match &self.provenance {
            Some(provenance) => format!("{markdown}\n{}\n", provenance.describe()),
            None => markdown,
        }
    }

    /// Every file: the Markdown, all tables as JSON and CSV, figures as SVG and PNG; what depends
    /// on the machine in files of its own, whose names end with `times`.
    ///
    /// # Errors
    /// A figure cannot be drawn.
    pub fn files(&self) -> Result<Vec<ReportFile>, FigureError> {
        let mut files = vec![
            (
                format!("{}.md", self.name),
                self.standing_alone(self.to_markdown()).into_bytes(),
            ),
            (
                format!("{}.json", self.name),
                self.json(&self.blocks, false).into_bytes(),
            ),
        ];
        if !self.times.is_empty() {
            let times = self.standing_alone(self.times_to_markdown());
            files.push((format!("{}-times.md", self.name), times.into_bytes()));
            files.push((
                format!("{}-times.json", self.name),
                self.json(&self.times, true).into_bytes(),
            ));
        }
        for block in self.blocks.iter().chain(&self.times) {
            match block {
                Block::Text(_) => {}
                Block::Table { stem, table, .. } | Block::Data { stem, table, .. } => {
                    files.push((format!("{stem}.csv"), table.to_csv().into_bytes()));
                }
                Block::Figure { stem, figure, .. } => {
                    files.push((format!("{stem}.svg"), figure.to_svg()?.into_bytes()));
                    files.push((format!("{stem}.png"), figure.to_png()?));
                }
                Block::Picture { stem, png, .. } => {
                    files.push((format!("{stem}.png"), png.clone()));
                }
            }
        }
        Ok(files)
    }

    /// The tables of these blocks, and the claims of times or the others.
    fn json(&self, blocks: &[Block], of_times: bool) -> String {
        let tables = blocks.iter().filter_map(|block| match block {
            Block::Table { stem, table, .. } => Some((stem.clone(), table.to_json())),
            _ => None,
        });
        let tables: Map<_, _> = tables.collect();
        let mut whole = json!({ "experiment": self.name, "title": self.title, "tables": tables });
        if let Some(provenance) = &self.provenance {
            whole["made_by"] = provenance.json();
        }
        let claims: Vec<&Claim> = self
            .claims
            .iter()
            .filter(|claim| claim.of_times == of_times)
            .collect();
        if !claims.is_empty() {
            whole["claims"] = claims.into_iter().map(Claim::json).collect();
        }
        format!("{whole:#}\n")
    }
}

fn markdown(title: &str, blocks: &[Block]) -> String {
    let mut out = format!("## {title}\n");
    for block in blocks {
        // Writing to a string cannot fail.
        let _ = match block {
            Block::Text(text) => writeln!(out, "\n{}", text.trim()),
            Block::Table { caption, table, .. } => {
                writeln!(out, "\n{caption}\n\n{}", table.to_markdown().trim_end())
            }
            Block::Data { stem, caption, .. } => writeln!(out, "\n{caption} File: `{stem}.csv`."),
            Block::Figure { stem, caption, .. } => {
                writeln!(out, "\n![{caption}]({stem}.svg)\n\n{caption}")
            }
            Block::Picture { stem, caption, .. } => {
                writeln!(out, "\n![{caption}]({stem}.png)\n\n{caption}")
            }
        };
    }
    out
}
