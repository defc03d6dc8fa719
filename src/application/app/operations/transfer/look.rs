//! What an export, a dataset or an import would be: found without a change.

use super::words::describe_error;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::{App, sentence};
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_documents::document::Document;
use touchline_documents::exchange::{
    DatasetOptions, DatasetPlan, ExportOptions, Exported, Format, ImportOptions, Imported, Joined,
    export, import, join, plan_dataset,
};
use touchline_documents::store;

/// It is to be looked what an export, a dataset or an import would be.
#[derive(Debug)]
pub struct TransferLook {
    pub(super) document: Document,
    /// Where its relative paths start.
    pub(super) folder: PathBuf,
    /// Its revision.
    pub(super) revision: u64,
    pub(super) at: LookAt,
}

/// What is looked at.
#[derive(Debug)]
pub(super) enum LookAt {
    /// The document is made into a format and compared.
    Export {
        format: Format,
        options: Box<ExportOptions>,
    },
    /// A dataset is planned.
    Dataset(Box<DatasetOptions>),
    /// Files are read and joined with the document.
    Import {
        from: PathBuf,
        format: Format,
        options: Box<ImportOptions>,
    },
}

/// What was found, for the document of a revision.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The revision of the document that was looked at. A change since the order, also one from the
    /// background, makes it out of date.
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

impl Operation for TransferLook {
    type Progress = Infallible;
    type Output = Look;
    type Error = Infallible;

    const NAME: &'static str = "look at a transfer";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<Look, Infallible> {
        let at = self.document.at(&self.folder);
        Ok(match &self.at {
            LookAt::Export { format, options } => Look::Export(
                export(at, *format, options)
                    .map(Arc::new)
                    .map_err(|error| describe_error(&error)),
            ),
            LookAt::Dataset(options) => Look::Dataset(
                plan_dataset(at, options)
                    .map(Arc::new)
                    .map_err(|error| describe_error(&error)),
            ),
            LookAt::Import {
                from,
                format,
                options,
            } => {
                let imported = read_import(from, *format, options);
                Look::Import(imported.map(|imported| Arc::new(join(at, &imported))))
            }
        })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.transfer.look
    }

    fn take_over(&self, app: &mut App, result: Result<Look, Failure<Infallible>>) {
        let look = result.unwrap_or_else(|failure| self.at.failed(sentence(&failure.to_string())));
        app.operations.transfer.found = Some(Found {
            revision: self.revision,
            look,
        });
    }
}

impl LookAt {
    /// The look that gave nothing.
    const fn failed(&self, why: String) -> Look {
        match self {
            Self::Export { .. } => Look::Export(Err(why)),
            Self::Dataset(_) => Look::Dataset(Err(why)),
            Self::Import { .. } => Look::Import(Err(why)),
        }
    }
}

/// Reads foreign files, or a document with what its journal holds; an error is one line.
fn read_import(from: &Path, format: Format, options: &ImportOptions) -> Result<Imported, String> {
    if format != Format::Json {
        return import(from, format, options).map_err(|error| describe_error(&error));
    }
    let (location, document, recovery) =
        store::read(from).map_err(|error| sentence(&error.to_string()))?;
    let notes = recovery.message().into_iter().collect();
    Ok(Imported {
        document,
        folder: location.folder().to_path_buf(),
        notes,
    })
}
