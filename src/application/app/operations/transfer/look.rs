//! Computes what an export, a dataset or an import would give, without writing anything.

use super::words::describe_error;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::{App, sentence};
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_calibration::pipelines::{CameraSurvey, survey_cameras};
use touchline_documents::document::{Document, DocumentAt, path_between};
use touchline_documents::exchange::{
    DatasetOptions, DatasetPlan, ExportOptions, Exported, Format, ImportOptions, Imported,
    JoinedImport, export, import, join, plan_dataset, size_of_only_video,
};
use touchline_documents::store;

/// Computes what an export, a dataset or an import would give.
#[derive(Debug)]
pub struct TransferPreview {
    pub(super) document: Document,
    /// The folder to which its relative paths refer.
    pub(super) folder: PathBuf,
    /// The document's revision.
    pub(super) revision: u64,
    pub(super) at: PreviewSubject,
}

/// The subject of a look.
#[derive(Debug)]
pub(super) enum PreviewSubject {
    /// Converts the document to a format and compares the result with it.
    Export {
        format: Format,
        options: Box<ExportOptions>,
    },
    /// Plans a dataset.
    Dataset(Box<DatasetOptions>),
    /// Reads files and joins them with the document.
    Import {
        from: PathBuf,
        format: Format,
        options: Box<ImportOptions>,
    },
}

/// The result of a look at one revision of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct RevisionPreview {
    /// The revision that was examined. Any later change of the document, also one from the
    /// background, makes the result obsolete.
    pub revision: u64,
    pub look: PreviewResult,
}

/// The result for an export, dataset or import; an error is one line.
#[derive(Clone, Debug, PartialEq)]
pub enum PreviewResult {
    /// An export, ready to be written.
    Export(Result<Arc<Exported>, String>),
    /// A dataset, ready to be written.
    Dataset(Result<Arc<DatasetPlan>, String>),
    /// An import, ready to be taken over.
    Import(Result<Arc<ImportPreview>, String>),
}

/// What an import would bring.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportPreview {
    /// The format of the files.
    pub format: Format,
    /// The document with the labels.
    pub joined: JoinedImport,
    /// The document's imported cameras, compared with each other; none if no frame has one.
    pub survey: Option<CameraSurvey>,
    /// The files' contents.
    imported: Arc<Imported>,
}

impl ImportPreview {
    /// What labels that were read would bring to a document.
    pub(super) fn new(at: DocumentAt<'_>, imported: Arc<Imported>) -> Self {
        let joined = join(at, &imported);
        // A field that is not valid is named by whatever uses it next.
        let survey = survey_cameras(joined.document.at(at.folder)).ok();
        Self {
            format: imported.format,
            survey: survey.filter(|survey| survey.cameras > 0),
            joined,
            imported,
        }
    }

    /// Whether the cameras that it brings can be mended afterwards.
    pub fn can_be_mended(&self) -> bool {
        cfg!(feature = "opencv")
            && self.joined.cameras > 0
            && self
                .survey
                .as_ref()
                .is_some_and(|survey| !survey.places.is_empty())
    }

    /// What the same labels would bring to a document that has changed since.
    pub(super) fn again(&self, at: DocumentAt<'_>) -> Self {
        Self::new(at, Arc::clone(&self.imported))
    }
}

impl Operation for TransferPreview {
    type Progress = Infallible;
    type Output = PreviewResult;
    type Error = Infallible;

    const NAME: &'static str = "look at a transfer";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<PreviewResult, Infallible> {
        let at = self.document.at(&self.folder);
        Ok(match &self.at {
            PreviewSubject::Export { format, options } => PreviewResult::Export(
                export(at, *format, options)
                    .map(Arc::new)
                    .map_err(|error| describe_error(&error)),
            ),
            PreviewSubject::Dataset(options) => PreviewResult::Dataset(
                plan_dataset(at, options)
                    .map(Arc::new)
                    .map_err(|error| describe_error(&error)),
            ),
            PreviewSubject::Import {
                from,
                format,
                options,
            } => {
                let options = ImportOptions {
                    video_size: size_of_only_video(at),
                    ..(**options).clone()
                };
                let imported = read_import(from, *format, &options, &self.folder);
                PreviewResult::Import(
                    imported.map(|imported| Arc::new(ImportPreview::new(at, Arc::new(imported)))),
                )
            }
        })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.transfer.look
    }

    fn take_over(&self, app: &mut App, result: Result<PreviewResult, Failure<Infallible>>) {
        let look =
            result.unwrap_or_else(|failure| self.at.failed_look(sentence(&failure.to_string())));
        app.operations.transfer.found = Some(RevisionPreview {
            revision: self.revision,
            look,
        });
    }
}

impl PreviewSubject {
    /// The result if the look itself failed.
    const fn failed_look(&self, why: String) -> PreviewResult {
        match self {
            Self::Export { .. } => PreviewResult::Export(Err(why)),
            Self::Dataset(_) => PreviewResult::Dataset(Err(why)),
            Self::Import { .. } => PreviewResult::Import(Err(why)),
        }
    }
}

/// Reads files of a foreign format, or a document with its journal. An error is one line. `folder`
/// is that of the open document, from which the path of its field's template starts.
fn read_import(
    from: &Path,
    format: Format,
    options: &ImportOptions,
    folder: &Path,
) -> Result<Imported, String> {
    if format != Format::Json {
        // The files may lie elsewhere, and a relative path would start from there.
        let placed = options.clone().with_template_in(folder);
        let mut imported = import(from, format, &placed).map_err(|error| describe_error(&error))?;
        // It is the field of the open document, so that no camera gets one of its own. Its path
        // starts where the labels lie, until they are joined with that document. A path that was
        // absolute already stays as it is.
        let field = &mut imported.document.field;
        if *field == placed.field && placed.field != options.field {
            field.template = path_between(&imported.folder, Path::new(&placed.field.template));
        }
        return Ok(imported);
    }
    let (location, document, recovery) =
        store::read(from).map_err(|error| sentence(&error.to_string()))?;
    let notes = recovery.message().into_iter().collect();
    Ok(Imported {
        document,
        folder: location.folder().to_path_buf(),
        format: Format::Json,
        notes,
        failures: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::FieldSpec;

    #[test]
    fn a_template_lies_where_the_document_does_wherever_the_labels_are() {
        let (project, labels) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let soccer = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/fields/soccer.json");
        std::fs::copy(soccer, project.path().join("mine.json")).unwrap();
        let file = labels.path().join("0001.json");
        let text = r#"{ "imagePath": "0001.jpg", "imageWidth": 160, "imageHeight": 90, "shapes": [
            { "label": "centre_mark", "points": [[81.0, 51.0]], "shape_type": "point" }
        ] }"#;
        std::fs::write(&file, text).unwrap();
        let options = ImportOptions {
            field: FieldSpec::new("mine.json"),
            ..ImportOptions::default()
        };
        let imported = read_import(&file, Format::Labelme, &options, project.path()).unwrap();
        assert_eq!(imported.document.frames[0].clicks.len(), 1);
        let open = Document::new(options.field);
        let preview = ImportPreview::new(open.at(project.path()), Arc::new(imported));
        let joined = &preview.joined.document;
        assert_eq!(joined.cameras.len(), 1);
        assert_eq!(joined.cameras[0].field, None, "that of the document");
        let spec = joined.field_of(&joined.frames[0]);
        let shown = joined.at(project.path()).model_of(spec);
        assert!(shown.is_ok(), "{shown:?}");
    }
}
