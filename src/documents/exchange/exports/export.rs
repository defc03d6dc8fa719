//! Exports a document to a foreign format. All files are made in memory and read back before
//! anything is written.

use super::choose::{is_chosen, off_paint_note};
use super::export_cameras::export_cameras;
use super::export_clicks::export_clicks;
use super::exported::Exported;
use super::gaps::{in_takes, interpolate_gaps};
use crate::document::{DocumentAt, document_to_string, resolve_path};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::Files;
use crate::exchange::format::Format;
use crate::exchange::options::{ExportOptions, FrameChoice, Gaps};
use crate::exchange::registry::{Codec, codec};

/// The document in a foreign format, verified by reading it back. Nothing is written to the disk.
///
/// # Errors
/// There is nothing to export, two frames would have one name, an option is needed, or the files do
/// not read back as they were meant.
pub fn export(
    at: DocumentAt<'_>,
    format: Format,
    options: &ExportOptions,
) -> Result<Exported, ExchangeError> {
    if !format.exports() {
        return Err(ExchangeError::OneWay {
            format,
            what: "exported",
            instead: "imported",
        });
    }
    let mut exported = export_to_format(at, format, options)?;
    // Frames that people accepted against the evidence are worth a warning in every format, also
    // where the format itself has no place for it.
    let chosen = at
        .document
        .frames
        .iter()
        .map(|frame| &**frame)
        .filter(|frame| is_chosen(frame, &options.frames));
    exported.notes.extend(off_paint_note(chosen));
    Ok(exported)
}

/// The document in a format with a writer.
fn export_to_format(
    at: DocumentAt<'_>,
    format: Format,
    options: &ExportOptions,
) -> Result<Exported, ExchangeError> {
    let codec = match codec(format) {
        Codec::Cameras(codec) => codec,
        Codec::Clicks(codec) => return export_clicks(at, format, codec, options),
        Codec::Documents(_) => return dataset(at, options),
    };
    match options.gaps {
        Gaps::Keep => export_cameras(at, format, codec, options),
        Gaps::Interpolate(most) => {
            let (filled, note) = interpolate_gaps(at.document, &options.frames, most);
            // All of its frames were chosen, or interpolated between chosen ones.
            let options = ExportOptions {
                frames: FrameChoice::everything(),
                ..options.clone()
            };
            let mut exported = export_cameras(filled.at(at.folder), format, codec, &options)?;
            exported.notes.extend(note);
            Ok(exported)
        }
        Gaps::Takes => in_takes(at, &options.frames, &|at| {
            export_cameras(at, format, codec, options)
        }),
    }
}

/// The chosen frames as a dataset.
fn dataset(at: DocumentAt<'_>, options: &ExportOptions) -> Result<Exported, ExchangeError> {
    let mut dataset = at.to_dataset()?;
    // Without a choice of frames it is complete, including rejected frames.
    let is_whole = options.frames == FrameChoice::default();
    let frames: Vec<_> = dataset
        .frames
        .iter()
        .filter(|frame| is_whole || is_chosen(frame, &options.frames))
        .cloned()
        .collect();
    let count = frames.len();
    dataset.frames = frames.into_iter().collect();
    Ok(Exported {
        format: Format::Json,
        files: Files::one("dataset.json", document_to_string(&dataset)?.into_bytes()),
        frames: count,
        left_out: Vec::new(),
        loss: None,
        notes: Vec::new(),
        worst_px: 0.0,
        in_takes: false,
        dataset: Some((dataset, resolve_path(at.folder))),
    })
}
