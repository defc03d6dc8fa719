//! Exporting and importing in the window: what was chosen, what the background is asked for, and what came of it in words.

use super::sentence;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_core::geometry::counted;
use touchline_documents::document::Document;
use touchline_documents::exchange::{
    DatasetDone, DatasetOptions, DatasetPlan, ExchangeError, ExportOptions, Exported, Format, FrameChoice,
    ImportOptions, Imported, Joined, export, import, join, plan_dataset, write_dataset,
};
use touchline_documents::store;
use touchline_vision::media::ReadFrames;

/// The pages of the dialog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransferTab {
    /// The document in a foreign format.
    #[default]
    Export,
    /// A folder with labels, pictures and their card.
    Dataset,
    /// Labels of another program, joined with the document.
    Import,
}

/// What was chosen in the dialog, and what is under way.
#[derive(Clone, Debug)]
pub struct Transfer {
    /// The page.
    pub tab: TransferTab,
    /// The format of an export.
    pub format: Format,
    /// How it is exported.
    pub export: ExportOptions,
    /// How a dataset is written.
    pub dataset: DatasetOptions,
    /// A dataset that is there is replaced.
    pub replace: bool,
    /// The format of an import.
    pub import_format: Format,
    /// How files are read.
    pub import: ImportOptions,
    /// The number of the order that is under way; none while nothing is.
    pub under_way: Option<UnderWay>,
    /// What the last look found.
    pub found: Option<Found>,
    /// The last order's number.
    pub(super) tickets: u64,
}

impl Default for Transfer {
    fn default() -> Self {
        Self {
            tab: TransferTab::default(),
            format: Format::Json,
            export: ExportOptions { frames: FrameChoice::reviewed(), ..ExportOptions::default() },
            dataset: DatasetOptions::default(),
            replace: false,
            import_format: Format::SoccerNet,
            import: ImportOptions::default(),
            under_way: None,
            found: None,
            tickets: 0,
        }
    }
}

/// What the background is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnderWay {
    /// Which order.
    pub ticket: u64,
    /// The revision of the document that it was given.
    pub revision: u64,
    /// A dataset or file is being written; otherwise it only looks.
    pub writes: bool,
    /// How many of how many pictures are done, where that is known.
    pub pictures: Option<(usize, usize)>,
}

/// What was found, for the document of a revision.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The revision of the document that was looked at. A change since the order, also one from the background, makes it out of date.
    pub revision: u64,
    /// What.
    pub look: Look,
}

/// What a look at an export, dataset or import found; an error is one line.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// An export that waits to be written.
    Export(Result<Arc<Exported>, String>),
    /// A dataset that waits to be written.
    Dataset(Result<Arc<DatasetPlan>, String>),
    /// An import that waits to be taken over.
    Import(Result<Arc<Joined>, String>),
}

/// What changes state here.
#[derive(Clone, Debug, PartialEq)]
pub enum TransferAction {
    /// Another page.
    Tab(TransferTab),
    /// Another format of an export.
    Format(Format),
    /// Other options of an export.
    Export(Box<ExportOptions>),
    /// Other options of a dataset.
    Dataset(Box<DatasetOptions>),
    /// Whether a dataset that is there is replaced.
    Replace(bool),
    /// Another format of an import.
    ImportFormat(Format),
    /// Other options of an import.
    Import(Box<ImportOptions>),
    /// A place to write to, or a file to read, is asked for.
    Choose,
    /// What was read is taken over: one step of undo.
    TakeOver,
    /// What is under way ends.
    Stop,
    /// How many of how many pictures are done.
    Progress {
        /// Which order.
        ticket: u64,
        /// Done.
        done: usize,
        /// Of.
        of: usize,
    },
    /// A look has ended.
    Looked {
        /// Which order.
        ticket: u64,
        /// What it found.
        look: Look,
    },
    /// Something was written, or why it was not.
    Written {
        /// Which order.
        ticket: u64,
        /// What is said.
        result: Result<String, String>,
    },
}

/// Something for the background.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferOrder {
    /// Which order: the reports say it again.
    pub ticket: u64,
    /// The document.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
    /// What is to be done.
    pub work: TransferWork,
}

/// What is to be done.
#[derive(Clone, Debug, PartialEq)]
pub enum TransferWork {
    /// The document is made into a format and compared.
    Export {
        /// The format.
        format: Format,
        /// How.
        options: Box<ExportOptions>,
    },
    /// It is written.
    WriteExport {
        /// The format.
        format: Format,
        /// How.
        options: Box<ExportOptions>,
        /// As it was made for the dialog; none where the document has changed since.
        made: Option<Arc<Exported>>,
        /// Where.
        to: PathBuf,
        /// A file that is there is replaced; a folder never is.
        replace: bool,
    },
    /// A dataset is planned.
    PlanDataset(Box<DatasetOptions>),
    /// It is written.
    WriteDataset {
        /// As planned for the dialog; none where the document has changed since.
        plan: Option<Arc<DatasetPlan>>,
        /// How.
        options: Box<DatasetOptions>,
        /// Where.
        to: PathBuf,
        /// A dataset that is there is replaced.
        replace: bool,
    },
    /// Files are read and joined with the document.
    Import {
        /// The file or folder.
        from: PathBuf,
        /// Its format.
        format: Format,
        /// How.
        options: Box<ImportOptions>,
    },
}

impl TransferWork {
    /// Whether something is written.
    #[must_use]
    pub const fn writes(&self) -> bool {
        matches!(self, Self::WriteExport { .. } | Self::WriteDataset { .. })
    }
}

impl TransferOrder {
    /// Does it; `watch` is told how many of how many pictures are done, and may end it.
    pub fn carry_out(
        &self,
        reader: &mut dyn ReadFrames,
        watch: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> TransferAction {
        let (ticket, at) = (self.ticket, self.document.at(&self.folder));
        let looked = |look| TransferAction::Looked { ticket, look };
        match &self.work {
            TransferWork::Export { format, options } => {
                looked(Look::Export(export(at, *format, options).map(Arc::new).map_err(|error| said(&error))))
            }
            TransferWork::PlanDataset(options) => {
                looked(Look::Dataset(plan_dataset(at, options).map(Arc::new).map_err(|error| said(&error))))
            }
            TransferWork::Import { from, format, options } => {
                let imported = read_import(from, *format, options);
                looked(Look::Import(imported.map(|imported| Arc::new(join(at, &imported)))))
            }
            TransferWork::WriteExport { format, options, made, to, replace } => {
                let mut write = || {
                    let exported = match made {
                        Some(made) => Arc::clone(made),
                        None => Arc::new(export(at, *format, options)?),
                    };
                    // It was made without a look at the button.
                    if watch(0, 1).is_break() {
                        return Err(ExchangeError::Stopped);
                    }
                    exported.write(to, *replace && !exported.is_folder())?;
                    Ok(format!("{} written as {format}: {}", counted(exported.frames, "frame"), to.display()))
                };
                TransferAction::Written { ticket, result: write().map_err(|error| said(&error)) }
            }
            TransferWork::WriteDataset { plan, options, to, replace } => {
                let plan = match plan {
                    Some(plan) => Ok(Arc::clone(plan)),
                    None => plan_dataset(at, options).map(Arc::new),
                };
                let written = plan.and_then(|plan| write_dataset(at, &plan, options, reader, to, *replace, watch));
                let text = |done: DatasetDone| {
                    let left_out = match done.left_out.len() {
                        0 => String::new(),
                        count => format!(", {count} left out"),
                    };
                    format!("Dataset of {}{left_out} written: {}", counted(done.frames, "frame"), to.display())
                };
                TransferAction::Written { ticket, result: written.map(text).map_err(|error| said(&error)) }
            }
        }
    }
}

/// Reads foreign files, or a document with what its journal holds; an error is one line.
fn read_import(from: &Path, format: Format, options: &ImportOptions) -> Result<Imported, String> {
    if format != Format::Json {
        return import(from, format, options).map_err(|error| said(&error));
    }
    let (location, document, recovery) = store::read(from).map_err(|error| sentence(&error.to_string()))?;
    let notes = recovery.message().into_iter().collect();
    Ok(Imported { document, folder: location.folder().to_path_buf(), notes })
}

/// Options of the command line, and what they are called in the dialog. The longer of two that begin alike comes first.
const OPTIONS: [(&str, &str); 21] = [
    ("give a --map file with them, or --skip-unmapped", "choose what labels are, or leave out others"),
    (" (--images FOLDER)", ""),
    ("; --size WIDTHxHEIGHT gives another", ""),
    ("--size WIDTHxHEIGHT or --images FOLDER", "the picture size"),
    ("--size WIDTHxHEIGHT", "the picture size"),
    ("given by --size", "given as picture size"),
    ("--size ", "picture size "),
    ("--sensor-mm", "sensor width"),
    ("--zoom", "what zoom values are"),
    ("--fps", "frames a second"),
    ("--match-id", "the match's id"),
    ("--start-time", "when the video begins"),
    ("--perspective", "the perspective"),
    ("choose one with --camera", "choose one"),
    ("--split-by ", "divided by "),
    ("; --outside-pictures takes it too", ""),
    ("; --outside-pictures copies them too", ""),
    ("; --set length_m=… and width_m=… give another", ""),
    (" (--outside keep)", ""),
    (" (--images copy)", ""),
    (" (--variant gamestate)", ""),
];

/// An error as the window says it: with the dialog's words for the command line's options.
fn said(error: &ExchangeError) -> String {
    match error {
        ExchangeError::Exists { path } => format!("{} exists already; choose another place.", path.display()),
        ExchangeError::OtherDisk { .. } => {
            "The pictures lie on another disk and cannot be linked; copy them instead.".to_owned()
        }
        other => in_dialog(&other.to_string()),
    }
}

/// What an export or import says, as a sentence with the dialog's words for the command line's options.
#[must_use]
pub fn in_dialog(text: &str) -> String {
    sentence(&OPTIONS.iter().fold(text.to_owned(), |text, (option, words)| text.replace(option, words)))
}

/// Bytes for people: "34 MB".
#[must_use]
pub fn describe_bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["kB", "MB", "GB", "TB"];
    let mut value = bytes as f64 / 1000.0;
    let mut unit = 0;
    while value >= 999.5 && unit + 1 < UNITS.len() {
        value /= 1000.0;
        unit += 1;
    }
    if value < 9.95 { format!("{value:.1} {}", UNITS[unit]) } else { format!("{value:.0} {}", UNITS[unit]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_said_as_people_say_them() {
        assert_eq!(
            [0, 1234, 34_400_000, 999_700_000, 1_260_000_000].map(describe_bytes),
            ["0.0 kB", "1.2 kB", "34 MB", "1.0 GB", "1.3 GB"]
        );
    }

    #[test]
    fn errors_are_sentences_without_options() {
        let exists = ExchangeError::Exists { path: "out".into() };
        assert_eq!(said(&exists), "out exists already; choose another place.");
        let needed = ExchangeError::ExportNeeds { format: Format::Cdf, what: "the frame rate", option: "--fps" };
        assert_eq!(said(&needed), "Cdf needs the frame rate; give frames a second.");
        assert_eq!(said(&ExchangeError::Stopped), "Stopped; nothing was written.");
    }
}
