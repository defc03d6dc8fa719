//! A report: text, tables and figures in order, and the files they become.

use super::claim::Claim;
use super::provenance::Provenance;
use serde_json::{Map, json};
use std::fmt::Write as _;
use touchline::report::figure::{Figure, FigureError};
use touchline::report::{ReportFile, Table};

/// A report: text, tables and figures in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Its name, with which the names of its files begin.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// Its content, in order.
    pub blocks: Vec<Block>,
    /// The content that depends on the machine. It goes into separate files, so that all others
    /// have the same bytes in each run.
    pub times: Vec<Block>,
    /// Published statements and the measurements that test them.
    pub claims: Vec<Claim>,
    /// How the report was made; left out of the files if none.
    pub provenance: Option<Provenance>,
}

/// A part of a report.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Markdown.
    Text(String),
    /// A table, also written as CSV.
    Table {
        /// Name of its file, without extension.
        stem: String,
        /// Caption.
        caption: String,
        /// The table.
        table: Table,
    },
    /// A long table, written as CSV only and named in the text.
    Data {
        /// Name of its file, without extension.
        stem: String,
        /// Caption.
        caption: String,
        /// The table.
        table: Table,
    },
    /// A figure, written as SVG and PNG.
    Figure {
        /// Name of its file, without extension.
        stem: String,
        /// Caption.
        caption: String,
        /// The figure.
        figure: Figure,
    },
    /// A picture that is a PNG already.
    Picture {
        /// Name of its file, without extension.
        stem: String,
        /// Caption.
        caption: String,
        /// The PNG file's bytes.
        png: Vec<u8>,
    },
}

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
        self.blocks.push(self.table_block(stem, caption, table));
    }

    /// Adds a long table, which is written as CSV only.
    pub fn data(&mut self, stem: &str, caption: &str, table: Table) {
        self.blocks.push(Block::Data {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            table,
        });
    }

    /// Adds a figure.
    pub fn figure(&mut self, stem: &str, caption: &str, figure: Figure) {
        self.blocks.push(self.figure_block(stem, caption, figure));
    }

    /// Adds a picture.
    pub fn picture(&mut self, stem: &str, caption: &str, png: Vec<u8>) {
        self.blocks.push(Block::Picture {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            png,
        });
    }

    /// Adds a table of numbers that depend on the machine.
    pub fn time_table(&mut self, stem: &str, caption: &str, table: Table) {
        self.times.push(self.table_block(stem, caption, table));
    }

    /// Adds a figure of numbers that depend on the machine.
    pub fn time_figure(&mut self, stem: &str, caption: &str, figure: Figure) {
        self.times.push(self.figure_block(stem, caption, figure));
    }

    fn table_block(&self, stem: &str, caption: &str, table: Table) -> Block {
        Block::Table {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            table,
        }
    }

    fn figure_block(&self, stem: &str, caption: &str, figure: Figure) -> Block {
        Block::Figure {
            stem: self.stem(stem),
            caption: caption.to_owned(),
            figure,
        }
    }

    /// A table of this report by the name of its file; that of a [`Block::Data`] or
    /// [`Block::Table`].
    #[must_use]
    pub fn table_of_file(&self, file: &str) -> Option<&Table> {
        self.blocks
            .iter()
            .chain(&self.times)
            .find_map(|block| match block {
                Block::Table { stem, table, .. } | Block::Data { stem, table, .. } => {
                    (stem == file).then_some(table)
                }
                _ => None,
            })
    }

    fn stem(&self, stem: &str) -> String {
        format!("{}-{stem}", self.name)
    }

    /// The report as Markdown. Figures and pictures are links to their files.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        markdown(&self.title, &self.blocks)
    }

    /// The content that depends on the machine, as Markdown.
    #[must_use]
    pub fn times_to_markdown(&self) -> String {
        markdown(
            &format!("{}: times on this machine", self.title),
            &self.times,
        )
    }

    /// Markdown with the provenance below it, for a file.
    fn standing_alone(&self, markdown: String) -> String {
        match &self.provenance {
            Some(provenance) => format!("{markdown}\n{}\n", provenance.describe()),
            None => markdown,
        }
    }

    /// All files: the Markdown, the tables as JSON and CSV, figures as SVG and PNG. Markdown and
    /// JSON of content that depends on the machine are separate files with names in `times`.
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
                self.json(&self.blocks).into_bytes(),
            ),
        ];
        if !self.times.is_empty() {
            let times = self.standing_alone(self.times_to_markdown());
            files.push((format!("{}-times.md", self.name), times.into_bytes()));
            files.push((
                format!("{}-times.json", self.name),
                self.json(&self.times).into_bytes(),
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

    /// The tables of these blocks as JSON.
    fn json(&self, blocks: &[Block]) -> String {
        // Long tables are in their CSV files alone.
        let tables = blocks.iter().filter_map(|block| match block {
            Block::Table { stem, table, .. } => Some((stem.clone(), table.to_json())),
            _ => None,
        });
        let tables: Map<_, _> = tables.collect();
        let mut whole = json!({ "experiment": self.name, "title": self.title, "tables": tables });
        if let Some(provenance) = &self.provenance {
            whole["made_by"] = provenance.json();
        }
        format!("{whole:#}\n")
    }
}

/// Blocks as Markdown with a heading.
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
            Block::Figure {
                stem,
                caption,
                figure,
            } => {
                let title = if figure.title.is_empty() {
                    stem
                } else {
                    &figure.title
                };
                writeln!(out, "\n![{title}]({stem}.svg)\n\n{caption}")
            }
            Block::Picture { stem, caption, .. } => {
                writeln!(out, "\n![{stem}]({stem}.png)\n\n{caption}")
            }
        };
    }
    out
}
