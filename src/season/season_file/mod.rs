//! The season file: what a person writes.
//!
//! ```toml
//! [options]                     # of all matches; each may be absent
//! look_at = 40                  # frames from which a match's cameras are found
//! window_s = 60.0               # seconds of video for a shard
//! images = 400                  # images for a shard, where a match is a folder of them
//!
//! [[venue]]
//! name = "North Park"
//! field = "soccer"
//! set = { length_m = 105.0, width_m = 68.0 }
//!
//! [[match]]
//! name = "north-south"          # if absent, the folder's, or the video's without its ending
//! video = "videos/a.mp4"        # or frames = "FOLDER"
//! venue = "North Park"          # a soccer field of unknown size if absent
//! project = "north/project.json"  # its cameras are used; without it they are found
//! forest = "north.tlf"          # trained from that project; else trained from its references
//! options = { look_at = 100 }
//! ```
//!
//! Paths are relative to the season file's folder. Every mistake is one line that names the file,
//! the line in it and the way to mend it.
//!
//! What is read is described here, and so are the names in the folder of a collected season. The
//! text is read in `reader.rs`.

mod reader;
mod text;

use reader::SeasonReader;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::files::read_named_text;
use touchline_documents::document::FieldSpec;

/// Maximum size of a season file, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Maximum length of a match's name, bytes: it becomes the name of a folder.
const MAX_NAME_BYTES: usize = 100;

/// The file of a collected season's queue.
pub const QUEUE_FILE: &str = "queue.json";
/// The files of its table: as CSV and as Markdown.
pub(crate) const TABLE_FILES: [&str; 2] = ["season.csv", "season.md"];
/// Locked while the folder of a collected season is written into.
pub(crate) const LOCK_FILE: &str = "collect.lock";
/// What was written there, and from which frames.
pub(crate) const RECORD_FILE: &str = "collected.json";
/// Files that lie beside the folders of the matches once the season is collected.
const FILES_BESIDE_MATCHES: [&str; 5] = [
    QUEUE_FILE,
    TABLE_FILES[0],
    TABLE_FILES[1],
    LOCK_FILE,
    RECORD_FILE,
];

/// A season: its matches, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Season {
    /// The matches; names and frames differ.
    pub matches: Vec<Match>,
}

/// A match of a season.
#[derive(Clone, Debug, PartialEq)]
pub struct Match {
    /// Its name, which can be the name of a folder.
    pub name: String,
    /// Its line in the season file, for messages.
    pub line: usize,
    /// The video or the folder of images; the season file's folder is joined to it.
    pub frames: PathBuf,
    /// The field; of a project, the project's field is used instead.
    pub field: FieldSpec,
    /// The project whose cameras are used.
    pub project: Option<PathBuf>,
    /// The forest that was trained from the project.
    pub forest: Option<PathBuf>,
    /// How it is divided and searched.
    pub options: ShardOptions,
}

/// How a match is divided into shards and its cameras are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShardOptions {
    /// Maximum number of frames from which each camera is found. Default: 40.
    pub look_at: usize,
    /// Length of a shard of a video, s. Default: 60.
    pub window_s: f64,
    /// Number of images of a shard of a folder. Default: 400.
    pub images: usize,
}

impl Default for ShardOptions {
    fn default() -> Self {
        Self {
            look_at: 40,
            window_s: 60.0,
            images: 400,
        }
    }
}

impl Season {
    /// Reads a season file and checks everything in it that can be checked without reading videos.
    ///
    /// # Errors
    /// The file cannot be read, or a line of it is wrong.
    pub fn read(path: &Path) -> Result<Self, SeasonError> {
        let text = read_named_text(path, MAX_BYTES).map_err(|source| SeasonError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        SeasonReader { path, text: &text }.season()
    }
}

/// Whether a folder of any system may have this name: no separators, no signs that Windows
/// reserves, and neither blanks nor dots at the ends, which Windows drops or which hide a folder.
/// Nor may a file of the collected season have it; some systems do not tell letters by their case.
pub(crate) fn is_folder_name(name: &str) -> bool {
    let is_taken = FILES_BESIDE_MATCHES
        .iter()
        .any(|file| name.eq_ignore_ascii_case(file));
    !name.is_empty()
        && !is_taken
        && name.len() <= MAX_NAME_BYTES
        && !name.starts_with(['.', ' '])
        && !name.ends_with(['.', ' '])
        && name
            .chars()
            .all(|character| character.is_alphanumeric() || " -_.,+()".contains(character))
}

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
    Name { name: String },
    /// Two venues have one name.
    #[error("there is a venue {name:?} before; name one of them otherwise")]
    SameVenue { name: String },
    /// A match names a venue that is not in the file.
    #[error("no [[venue]] has the name {name:?}; add one, or correct the name")]
    UnknownVenue { name: String },
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
    OwnTemplate { template: String },
    /// A number is out of its range.
    #[error("{option} is {found}; give a number from {least} to {most}")]
    Range {
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_season_has_its_defaults_and_takes_its_options() {
        let folder = tempfile::tempdir().unwrap();
        for video in ["a.mp4", "b.mp4", "p.json"] {
            fs::write(folder.path().join(video), "video").unwrap();
        }
        let path = folder.path().join("season.toml");
        let text = "
            [options]
            window_s = 3600
            [[venue]]
            name = 'Park'
            field = 'soccer'
            set = { length_m = 101.5 }
            [[match]]
            video = 'a.mp4'
            [[match]]
            name = 'second leg'
            frames = 'b.mp4'
            venue = 'Park'
            project = 'p.json'
            options = { look_at = 100 }
        ";
        fs::write(&path, text).unwrap();
        let season = Season::read(&path).unwrap();
        let [first, second] = &season.matches[..] else {
            panic!("{season:?}")
        };
        assert_eq!(
            (first.name.as_str(), second.name.as_str()),
            ("a", "second leg")
        );
        assert_eq!((first.line, second.line), (9, 11));
        assert_eq!(first.frames, folder.path().join("a.mp4"));
        assert_eq!(second.project, Some(folder.path().join("p.json")));
        assert_eq!(second.field.params["length_m"], 101.5);
        let usual = ShardOptions {
            window_s: 3600.0,
            ..ShardOptions::default()
        };
        assert_eq!(first.options, usual);
        assert_eq!(
            second.options,
            ShardOptions {
                look_at: 100,
                ..usual
            }
        );
    }

    #[test]
    fn a_folder_gives_its_whole_name_and_a_video_that_without_its_ending() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("2024.05.11")).unwrap();
        fs::write(folder.path().join("2024.05.12.mp4"), "video").unwrap();
        let path = folder.path().join("season.toml");
        let text = "[[match]]\nframes = '2024.05.11'\n[[match]]\nvideo = '2024.05.12.mp4'\n";
        fs::write(&path, text).unwrap();
        let season = Season::read(&path).unwrap();
        let names = [0, 1].map(|at: usize| season.matches[at].name.as_str());
        assert_eq!(names, ["2024.05.11", "2024.05.12"]);
    }
}
