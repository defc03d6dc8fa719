//! Why a season file is refused. Each mistake has a line of the file and one sentence that says how
//! to mend it, because the person who reads it has the file open in an editor.

use std::io;
use std::path::PathBuf;
use thiserror::Error;
use touchline_core::field::FieldError;

/// Why a season file is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SeasonError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A line of it is wrong.
    #[error("{}, line {line}: {mistake}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong there.
        mistake: Box<SeasonMistake>,
    },
}

/// What is wrong in a line of a season file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SeasonMistake {
    /// It is not TOML, or not a season's.
    #[error("{0}")]
    Toml(String),
    /// There is no match in the file.
    #[error("the file names no match; write a [[match]] with its video")]
    NoMatch,
    /// A match has the name of another one.
    #[error(
        "the match {name:?} has the name of the one in line {other}; name one of them otherwise"
    )]
    SameName {
        /// The name.
        name: String,
        /// The line of the other match.
        other: usize,
    },
    /// A match has the frames of another one.
    #[error("{} is the match of line {other} already; take one of them out", frames.display())]
    SameFrames {
        /// The video or folder.
        frames: PathBuf,
        /// The line of the other match.
        other: usize,
    },
    /// A name cannot be the name of a folder.
    #[error("{name:?} cannot be the name of a match and its folder; use letters, digits, - and _")]
    Name {
        /// The name.
        name: String,
    },
    /// Two venues have one name.
    #[error("there is a venue {name:?} before; name one of them otherwise")]
    SameVenue {
        /// The name.
        name: String,
    },
    /// A match names a venue that is not in the file.
    #[error("no [[venue]] has the name {name:?}; add one, or correct the name")]
    UnknownVenue {
        /// The name.
        name: String,
    },
    /// A file that is named is not there.
    #[error("there is no {}; paths are relative to the season file", path.display())]
    Missing {
        /// The file or folder.
        path: PathBuf,
    },
    /// The field of a venue is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A venue has a template that is not built in.
    #[error(
        "{template}: a venue takes the templates that are built in (`touchline fields` lists them)"
    )]
    OwnTemplate {
        /// The template.
        template: String,
    },
    /// A number is out of its range.
    #[error("{option} is {found}; give a number from {least} to {most}")]
    Range {
        /// The option.
        option: &'static str,
        /// What it is.
        found: f64,
        /// The least that is allowed.
        least: f64,
        /// The most that is allowed.
        most: f64,
    },
    /// A forest is given without the project that it was trained from.
    #[error("a forest needs the project that it was trained from; add project = \"…\"")]
    ForestAlone,
}
