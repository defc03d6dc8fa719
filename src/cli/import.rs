//! `touchline import`: converts files of another program to a document, on request of a video.

use super::Outcome;
use super::attached_labels::{attach_to_video, open_video, recognize};
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::export::{MAX_TABLE_BYTES, format_parser, parse_size, zoom_of};
use super::messages::Messages;
use super::new::{parameter, read_field};
use anyhow::Context as _;
use std::path::{Path, PathBuf};
use touchline_core::files::read_named_text;
use touchline_core::geometry::{ImageSize, counted};
use touchline_documents::exchange::{
    Format, ImportOptions, Imported, LabelMap, Pixels, import as import_document,
};

/// Makes a document of the files of another program.
#[derive(clap::Args, Debug)]
pub struct ImportArgs {
    /// The file or folder.
    path: PathBuf,
    /// Its format; without it the format is recognized by endings and contents.
    #[arg(long, value_parser = format_parser(Format::imports))]
    format: Option<Format>,
    /// The video that the cameras are of. The document has all of its frames; each camera is
    /// attached to the frame of its number.
    #[arg(long, conflicts_with = "images")]
    video: Option<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
    /// The field's template.
    #[arg(long, default_value = "soccer")]
    field: String,
    /// A parameter of the field, such as `length_m=105`; may be given several times.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// The folder of the images; without it the files' own.
    #[arg(long)]
    images: Option<PathBuf>,
    /// The size of the pictures, where neither file nor image says it.
    #[arg(long, value_parser = parse_size)]
    size: Option<ImageSize>,
    /// Where pixels are counted from, where the format leaves it open.
    #[arg(long, value_parser = ["corner", "centre"])]
    pixels: Option<String>,
    /// What labels mean: touchline, roboflow-32, roboflow-32-captions, soccernet, or a JSON file
    /// {"label": "landmark or line"}.
    #[arg(long, default_value = "touchline")]
    map: String,
    /// Labels without meaning are left out.
    #[arg(long)]
    skip_unmapped: bool,
    /// Whose annotations are read, where a file has several.
    #[arg(long)]
    annotator: Option<String>,
    /// How FreeD's zoom value says the focal length: focal-px, focal-mm-x100, or a file of two
    /// columns, raw value and focal length in px.
    #[arg(long)]
    zoom: Option<String>,
    /// The width of the camera's sensor, mm.
    #[arg(long)]
    sensor_mm: Option<f64>,
}

/// The meaning of labels: one of the program's maps by name, or a JSON file.
fn label_map(name: &str) -> anyhow::Result<LabelMap> {
    Ok(match name {
        "touchline" => LabelMap::Touchline,
        "roboflow-32" => LabelMap::Roboflow32,
        "roboflow-32-captions" => LabelMap::Roboflow32Captions,
        "soccernet" => LabelMap::SoccerNet,
        file => {
            let text = read_named_text(Path::new(file), MAX_TABLE_BYTES);
            let text = text.with_context(|| format!("cannot read the map {file}"))?;
            LabelMap::Own(
                serde_json::from_str(&text)
                    .with_context(|| format!("{file} is no map of labels"))?,
            )
        }
    })
}

/// Converts the files and writes the document.
///
/// # Errors
/// The files cannot be read or are damaged, or the document cannot be written.
pub fn import(args: &ImportArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let format = match args.format {
        Some(format) => format,
        None => recognize(&args.path, messages)?,
    };
    let video = args.video.as_deref();
    let video = video.map(|video| open_video(video, messages)).transpose()?;
    let options = ImportOptions {
        field: read_field(&args.field, &args.set)?,
        images: args.images.clone(),
        size: args.size,
        video_size: video.as_ref().map(|video| video.size),
        pixels: args.pixels.as_deref().map(|pixels| {
            if pixels == "centre" {
                Pixels::Centre
            } else {
                Pixels::Corner
            }
        }),
        map: label_map(&args.map)?,
        skip_unmapped: args.skip_unmapped,
        annotator: args.annotator.clone(),
        sensor_width_mm: args.sensor_mm,
        zoom: args.zoom.as_deref().map(zoom_of).transpose()?,
    };
    let imported = match format {
        // A document is read together with its journal.
        Format::Json => {
            let Loaded { location, document } = DocumentArg {
                document: args.path.clone(),
            }
            .load(messages)?;
            Imported {
                document,
                folder: location.folder().to_path_buf(),
                format,
                notes: Vec::new(),
            }
        }
        format => import_document(&args.path, format, &options)?,
    };
    let (document, notes) = match video {
        Some(video) => {
            let attached = attach_to_video(video, &imported, options.field)?;
            (attached.document, attached.notes)
        }
        None => (imported.document, imported.notes),
    };
    for note in &notes {
        messages.note(note);
    }
    let (frames, cameras) = (document.frames.len(), document.cameras.len());
    args.output.write(document, &imported.folder)?;
    messages.note(&format!(
        "{} of {}",
        counted(frames, "frame"),
        counted(cameras, "camera")
    ));
    Ok(Outcome::Done)
}
