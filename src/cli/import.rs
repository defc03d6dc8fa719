//! `touchline import`: converts files of another program to a document, on request of a video.

use super::Outcome;
use super::export::{
    MAX_TABLE_BYTES, format_parser, given_options, parse_size, parse_width, zoom_of,
};
use super::new::{parameter, parse_stride, read_field};
use super::relocalize::probability;
use crate::cli::terminal::attached_labels::{attach_to_video, open_video, read_labels, recognize};
use crate::cli::terminal::by_name::value_by_name;
use crate::cli::terminal::document::DocumentOutput;
use crate::cli::terminal::messages::{Messages, count_steps};
use anyhow::{Context as _, ensure};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use touchline_calibration::calibrate::give_own_cameras;
use touchline_core::files::read_named_text;
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_documents::document::Document;
use touchline_documents::exchange::{
    Direction, Format, FormatOption, GroundPlan, HomographyOptions, ImportOptions, LabelMap,
    MatrixDirection, Pixels, PointLayout, PointModel, import_points,
};

/// Makes a document of the files of another program.
#[derive(clap::Args, Debug)]
pub struct ImportArgs {
    /// The file or folder.
    #[arg(required_unless_present = "points")]
    path: Option<PathBuf>,
    /// A file or folder with points that a model found, in place of labels of people: clicks of the
    /// origin `model:NAME`, each with its σ, which start suggestions.
    #[arg(long, value_name = "PATH", requires = "layout", conflicts_with_all = ["path", "format"])]
    points: Option<PathBuf>,
    /// The layout of the points.
    #[arg(long, requires = "points", value_parser = value_by_name::<PointLayout>())]
    layout: Option<PointLayout>,
    /// The name of the model; without it that of the layout.
    #[arg(long, value_name = "NAME", requires = "points")]
    model: Option<String>,
    /// Points of a lower probability are left out.
    #[arg(long, value_name = "P", default_value = "0", requires = "points")]
    #[arg(value_parser = probability)]
    min_probability: f64,
    /// Its format; without it the format is recognized by endings and contents.
    #[arg(long, value_parser = format_parser(Direction::Import))]
    format: Option<Format>,
    /// The video that the cameras are of. The document has all of its frames; each camera is
    /// attached to the frame of its number.
    #[arg(long, conflicts_with = "images")]
    video: Option<PathBuf>,
    /// The cameras are of every N-th frame of the video, as frames were sampled from it; the
    /// document has these frames alone.
    #[arg(long, value_name = "N", default_value = "1", requires = "video", value_parser = parse_stride)]
    every: NonZeroUsize,
    #[command(flatten)]
    output: DocumentOutput,
    /// The field's template; without it that of the format, mostly soccer.
    #[arg(long)]
    field: Option<String>,
    /// A parameter of the field, such as `length_m=105`; may be given several times.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// The folder of the images; without it the files' own.
    #[arg(long)]
    images: Option<PathBuf>,
    /// The size of the pictures, where no image says it. What is for pictures of another size is
    /// rescaled.
    #[arg(long, value_parser = parse_size)]
    size: Option<ImageSize>,
    /// The size that the pictures had before they were stretched to that of the labels, such as
    /// 1280x720.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    stretched_from: Option<ImageSize>,
    /// Where pixels are counted from, where the format leaves it open.
    #[arg(long, value_parser = ["corner", "centre"])]
    pixels: Option<String>,
    /// What labels mean: touchline, roboflow-32, roboflow-32-captions, soccernet, or a JSON file
    /// {"label": "landmark or line"}; without it touchline.
    #[arg(long)]
    map: Option<String>,
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
    #[arg(long, value_parser = parse_width)]
    sensor_mm: Option<f64>,
    /// The distortion that the files state has been taken out of the pictures.
    #[arg(long)]
    undistorted: bool,
    /// Boxes of people that the files state become masks, in which nothing is looked for.
    #[arg(long)]
    masks: bool,
    /// The plane of homographies that do not say it: metres from the field's centre or from its far
    /// left corner, or the template of a set.
    #[arg(long, value_parser = value_by_name::<GroundPlan>())]
    template: Option<GroundPlan>,
    /// The direction of homographies that do not say it.
    #[arg(long, value_parser = value_by_name::<MatrixDirection>())]
    direction: Option<MatrixDirection>,
    /// The columns of a table of homographies: h=NAME for the matrix, name=NAME for the frame.
    #[arg(long, value_name = "ROLE=NAME", value_delimiter = ',', value_parser = parse_column)]
    columns: Vec<(ColumnRole, String)>,
    /// Each picture is of a camera of its own: position, rotation, lens and focal length are found
    /// from its lines.
    #[arg(long)]
    each_own_camera: bool,
}

/// What a column of a table of homographies holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ColumnRole {
    Matrix,
    Name,
}

/// A column with what it holds, such as `h=homography_matrix`.
fn parse_column(text: &str) -> Result<(ColumnRole, String), String> {
    match text.split_once('=') {
        Some(("h", name)) if !name.is_empty() => Ok((ColumnRole::Matrix, name.to_owned())),
        Some(("name", name)) if !name.is_empty() => Ok((ColumnRole::Name, name.to_owned())),
        _ => Err("h=NAME or name=NAME is expected".to_owned()),
    }
}

/// What is read: labels in a format, or points of a model.
enum Source {
    Labels(Format),
    Points(PointLayout, PointModel),
}

impl ImportArgs {
    /// The file or folder that is read.
    fn source_path(&self) -> &Path {
        let path = self.points.as_ref().or(self.path.as_ref());
        // One of the two is required.
        path.map_or(Path::new(""), PathBuf::as_path)
    }

    /// The field that the files usually show.
    fn usual_field(&self, source: &Source) -> &'static str {
        match (source, self.template) {
            (_, Some(plan)) => plan.usual_field(),
            (Source::Labels(format), None) => format.usual_field(),
            (Source::Points(..), None) => "soccer",
        }
    }

    /// The name of the column that has a role, where one was given.
    fn column(&self, role: ColumnRole) -> Option<String> {
        let mut columns = self.columns.iter();
        let found = columns.find(|(given, _)| *given == role);
        found.map(|(_, name)| name.clone())
    }

    /// What is read, after options that it does not take were refused.
    fn source(&self, messages: Messages) -> anyhow::Result<Source> {
        let Some(layout) = self.layout else {
            let format = recognize(self.format, self.source_path(), messages)?;
            format.refuse_options(self.list_options(), Direction::Import)?;
            return Ok(Source::Labels(format));
        };
        // Clap does not ask for `--points` where the path that it excludes is given.
        ensure!(
            self.points.is_some(),
            "--layout belongs to --points PATH; labels of people have a --format"
        );
        layout.refuse_options(self.list_options())?;
        let name = self.model.clone();
        let model = PointModel {
            name: name.unwrap_or_else(|| layout.name().to_owned()),
            min_probability: self.min_probability,
        };
        Ok(Source::Points(layout, model))
    }

    /// The options that were given and that only some formats take.
    pub(super) fn list_options(&self) -> Vec<FormatOption> {
        given_options(&[
            (FormatOption::Field, self.field.is_some()),
            (FormatOption::Set, !self.set.is_empty()),
            (FormatOption::Images, self.images.is_some()),
            (FormatOption::Size, self.size.is_some()),
            (FormatOption::Pixels, self.pixels.is_some()),
            (FormatOption::Map, self.map.is_some()),
            (FormatOption::SkipUnmapped, self.skip_unmapped),
            (FormatOption::Annotator, self.annotator.is_some()),
            (FormatOption::Zoom, self.zoom.is_some()),
            (FormatOption::SensorMm, self.sensor_mm.is_some()),
            (FormatOption::Undistorted, self.undistorted),
            (FormatOption::EachOwnCamera, self.each_own_camera),
            (FormatOption::StretchedFrom, self.stretched_from.is_some()),
            (FormatOption::Template, self.template.is_some()),
            (FormatOption::Direction, self.direction.is_some()),
            (FormatOption::Columns, !self.columns.is_empty()),
            (FormatOption::Masks, self.masks),
        ])
    }
}

/// Gives each frame a camera of its own, and names those whose lines give none. Returns how many
/// these are.
fn find_own_cameras(
    document: &mut Document,
    folder: &Path,
    messages: Messages,
) -> anyhow::Result<usize> {
    let bar = messages.progress(document.frames.len(), "Solving");
    // None would mean that the progress cancelled it, and this one never does.
    let found = give_own_cameras(document, folder, &count_steps(&bar))?.unwrap_or_default();
    bar.finish_and_clear();
    let failed = found.failed.iter();
    messages.frames_failed(failed.map(|(index, error)| (document.frames[*index].name(), error)));
    messages.note(&format!(
        "{} with a camera of their own, {} without one",
        pluralise(found.solved.len(), "frame"),
        found.failed.len()
    ));
    Ok(found.failed.len())
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
/// [`Outcome::SomeFailed`] if something of the files cannot be read, or a picture's lines give no
/// camera where each has its own.
///
/// # Errors
/// The files cannot be read or are damaged, or the document cannot be written.
pub fn import(args: &ImportArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let path = args.source_path();
    let output = args.output.reserve("import", &[path], messages)?;
    let source = args.source(messages)?;
    let video = args.video.as_deref();
    let video = video.map(|video| open_video(video, messages)).transpose()?;
    let field = args.field.as_deref().unwrap_or(args.usual_field(&source));
    let options = ImportOptions {
        field: read_field(field, &args.set)?,
        images: args.images.clone(),
        size: args.size,
        stretched_from: args.stretched_from,
        // The video is opened before the files are read: some formats state no size of their
        // pictures.
        video_size: video.as_ref().map(|video| video.size),
        pixels: args.pixels.as_deref().map(|pixels| {
            if pixels == "centre" {
                Pixels::Centre
            } else {
                Pixels::Corner
            }
        }),
        map: label_map(args.map.as_deref().unwrap_or("touchline"))?,
        skip_unmapped: args.skip_unmapped,
        annotator: args.annotator.clone(),
        sensor_width_mm: args.sensor_mm,
        undistorted: args.undistorted,
        masks: args.masks,
        zoom: args.zoom.as_deref().map(zoom_of).transpose()?,
        homographies: HomographyOptions {
            plan: args.template,
            direction: args.direction,
            matrix_column: args.column(ColumnRole::Matrix),
            name_column: args.column(ColumnRole::Name),
        },
        model: match &source {
            Source::Labels(_) => None,
            Source::Points(_, model) => Some(model.clone()),
        },
    };
    let imported = match source {
        Source::Labels(format) => read_labels(path, format, &options, messages)?,
        Source::Points(layout, _) => import_points(path, layout, &options)?,
    };
    let (mut document, notes) = match video {
        Some(video) => {
            let attached = attach_to_video(video, &imported, options.field, args.every)?;
            (attached.document, attached.notes)
        }
        None => (imported.document, imported.notes),
    };
    messages.notes(&notes);
    messages.failures(&imported.failures);
    let failed = if args.each_own_camera {
        find_own_cameras(&mut document, &imported.folder, messages)?
    } else {
        0
    };
    let (frames, cameras) = (document.frames.len(), document.cameras.len());
    output.write(document, &imported.folder)?;
    messages.note(&format!(
        "{} of {}",
        pluralise(frames, "frame"),
        pluralise(cameras, "camera")
    ));
    let is_unread = !imported.failures.is_empty();
    Ok(Outcome::from_failure(is_unread || failed > 0))
}
