//! A report: text and figures in order, and the files they become.

use super::figure::{Figure, FigureError};
use serde_json::json;
use std::fmt::Write as _;

/// A report: text and figures in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    name: String,
    title: String,
    blocks: Vec<Block>,
}

/// A part of a report.
#[derive(Clone, Debug, PartialEq)]
enum Block {
    /// Markdown.
    Text(String),
    /// A figure, written as SVG and PNG.
    Figure {
        /// Name of its file, without extension.
        stem: String,
        caption: String,
        figure: Figure,
    },
}

/// A file of a report: name and content.
pub type ReportFile = (String, Vec<u8>);

impl Report {
    /// An empty report with the name that its files begin with, and its heading.
    pub fn new(name: &str, title: &str) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            blocks: Vec::new(),
        }
    }

    /// Adds Markdown text.
    pub fn text(&mut self, text: &str) {
        self.blocks.push(Block::Text(text.to_owned()));
    }

    /// Adds a figure.
    pub fn figure(&mut self, stem: &str, caption: &str, figure: Figure) {
        self.blocks.push(Block::Figure {
            stem: format!("{}-{stem}", self.name),
            caption: caption.to_owned(),
            figure,
        });
    }

    /// The report as Markdown. Figures are links to their files.
    fn to_markdown(&self) -> String {
        let mut out = format!("## {}\n", self.title);
        for block in &self.blocks {
            // Writing to a string cannot fail.
            let _ = match block {
                Block::Text(text) => writeln!(out, "\n{}", text.trim()),
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
            };
        }
        out
    }

    /// All files: the Markdown, the name and title as JSON, figures as SVG and PNG.
    ///
    /// # Errors
    /// A figure cannot be drawn.
    pub fn files(&self) -> Result<Vec<ReportFile>, FigureError> {
        let json = json!({ "experiment": self.name, "title": self.title, "tables": {} });
        let mut files = vec![
            (format!("{}.md", self.name), self.to_markdown().into_bytes()),
            (
                format!("{}.json", self.name),
                format!("{json:#}\n").into_bytes(),
            ),
        ];
        for block in &self.blocks {
            if let Block::Figure { stem, figure, .. } = block {
                files.push((format!("{stem}.svg"), figure.to_svg()?.into_bytes()));
                files.push((format!("{stem}.png"), figure.to_png()?));
            }
        }
        Ok(files)
    }
}
