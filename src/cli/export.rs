//! `touchline export`: writes the document in another format.

use super::Outcome;
use super::dataset::{DatasetArgs, write_dataset};
use super::relocalize::probability;
use crate::cli::terminal::by_name::value_by_name;
use crate::cli::terminal::document::{DocumentArg, DocumentOutput, Loaded};
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{ending, print, refuse_existing};
use anyhow::{Context as _, bail, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
use std::path::Path;
use touchline_core::files::read_named_text;
use touchline_core::geometry::{ImageSize, Vec3, pluralise};
use touchline_documents::document::{FrameStatus, Stage};
use touchline_documents::exchange::{
    Direction, ExchangeError, ExportOptions, Format, FormatOption, FrameChoice, Gaps,
    KeypointNames, PointSource, Rate, Recording, Rotations, Timecode, Zoom,
    export as export_document,
};

/// Maximum size of a zoom table or a map of labels, bytes.
pub(super) const MAX_TABLE_BYTES: u64 = 16 << 20;

/// Writes a document in another format.
///
/// The result is read again before it is written: a landmark that comes back elsewhere is an error.
/// What the format cannot hold is said on standard error, in px. An option that the format does not
/// take is refused. Conventions, users, losses and options of every format: assets/formats.md.
#[derive(clap::Args, Debug)]
pub struct ExportArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// The format.
    #[arg(long, value_parser = format_parser(Direction::Export), required_unless_present = "dataset")]
    format: Option<Format>,
    #[command(flatten)]
    dataset: DatasetArgs,
    #[command(flatten)]
    output: DocumentOutput,
    /// Only frames of these statuses; without it all that are not rejected (in a dataset:
    /// references).
    #[arg(long, value_delimiter = ',', value_parser = parse_status)]
    status: Vec<FrameStatus>,
    /// Only frames of these cameras.
    #[arg(long, value_delimiter = ',')]
    camera: Vec<String>,
    /// Only frames with at least this confidence, or with none stated.
    #[arg(long, value_parser = probability)]
    min_confidence: Option<f64>,
    /// Cameras and points rescaled to pictures of this size, such as 960x540.
    #[arg(long, value_parser = parse_size)]
    size: Option<ImageSize>,
    /// Another dialect of the format: gamestate (soccernet-lines).
    #[arg(long, value_parser = ["gamestate"])]
    variant: Option<String>,
    /// Homographies of pictures whose distortion has been taken out; in a dataset these pictures as
    /// well.
    #[arg(long)]
    undistorted: bool,
    /// The names of keypoints; without it touchline's.
    #[arg(long, value_parser = value_by_name::<KeypointNames>())]
    names: Option<KeypointNames>,
    /// Keypoints where the camera shows the landmarks, not where people clicked.
    #[arg(long)]
    projected: bool,
    /// What happens to keypoints outside of the picture; without it they are dropped.
    #[arg(long, value_parser = ["drop", "keep"])]
    outside: Option<String>,
    /// Up to so many frames that are missing between solved frames of a video, camera and clip get
    /// cameras between theirs, marked as interpolated.
    #[arg(long, value_name = "FRAMES", conflicts_with = "takes", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    interpolate: Option<u64>,
    /// A gap between the frames of a video begins a new take, in a file of its own.
    #[arg(long)]
    takes: bool,
    /// The timecode of the video's first frame, such as 10:00:00:00, or 10:00:00;00 where numbers
    /// are dropped (29.97).
    #[arg(long, value_name = "TIMECODE", value_parser = parse_timecode)]
    start: Option<Timecode>,
    /// Frames a second, such as 25, 29.97 or 30000/1001; without it from the frames' times.
    #[arg(long, value_parser = parse_rate)]
    fps: Option<Rate>,
    /// The width of the camera's sensor, mm, where the document does not know it.
    #[arg(long, value_parser = parse_width)]
    sensor_mm: Option<f64>,
    /// The match's id in the other files about it (cdf).
    #[arg(long)]
    match_id: Option<String>,
    /// When the video begins, UTC, such as 2026-03-01T18:59:30Z (cdf).
    #[arg(long, value_parser = parse_start)]
    start_time: Option<String>,
    /// Which of the stadium's cameras it is (cdf).
    #[arg(long, value_parser = Recording::PERSPECTIVES)]
    perspective: Option<String>,
    /// No person turned the camera (cdf).
    #[arg(long)]
    automated: bool,
    /// The origin of a studio's stage on the field, m, such as 0,-20,0: tracks (opentrackio, freed,
    /// usda, chan) are in its axes.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    stage_origin: Option<Vec3>,
    /// Where the stage's y axis looks, seen from above: 0 is across the field, positive to the
    /// right, degrees.
    #[arg(long, value_name = "DEGREES", value_parser = parse_heading, allow_hyphen_values = true)]
    stage_heading: Option<f64>,
    /// Of which frames fifa gets rotation and translation: of all without it; with `first` it is
    /// what the tasks hand out.
    #[arg(long, value_parser = value_by_name::<Rotations>())]
    rotations: Option<Rotations>,
    /// How FreeD's zoom value says the focal length: focal-px (without it), focal-mm-x100, or a
    /// file of two columns, raw value and focal length in px.
    #[arg(long)]
    zoom: Option<String>,
}

/// Parses a time in UTC and keeps its text.
fn parse_start(text: &str) -> Result<String, String> {
    Recording::is_start(text)
        .then(|| text.to_owned())
        .ok_or_else(|| format!("{text} is no time in UTC such as 2026-03-01T18:59:30Z"))
}

impl ExportArgs {
    /// The options that were given and that only some formats take.
    fn list_options(&self) -> Vec<FormatOption> {
        given_options(&[
            (FormatOption::Size, self.size.is_some()),
            (FormatOption::Variant, self.variant.is_some()),
            (FormatOption::Undistorted, self.undistorted),
            (FormatOption::Names, self.names.is_some()),
            (FormatOption::Projected, self.projected),
            (FormatOption::Outside, self.outside.is_some()),
            (FormatOption::Interpolate, self.interpolate.is_some()),
            (FormatOption::Takes, self.takes),
            (FormatOption::Start, self.start.is_some()),
            (FormatOption::Fps, self.fps.is_some()),
            (FormatOption::SensorMm, self.sensor_mm.is_some()),
            (FormatOption::MatchId, self.match_id.is_some()),
            (FormatOption::StartTime, self.start_time.is_some()),
            (FormatOption::Perspective, self.perspective.is_some()),
            (FormatOption::Automated, self.automated),
            (FormatOption::StageOrigin, self.stage_origin.is_some()),
            (FormatOption::StageHeading, self.stage_heading.is_some()),
            (FormatOption::Rotations, self.rotations.is_some()),
            (FormatOption::Zoom, self.zoom.is_some()),
        ])
    }

    /// Refuses options that have no effect.
    fn refuse_options(&self) -> Result<(), ExchangeError> {
        let given = self.list_options();
        match self.format {
            Some(format) => format.refuse_options(given, Direction::Export),
            // A dataset is no format, and has one of their options.
            None => match given
                .into_iter()
                .find(|option| *option != FormatOption::Undistorted)
            {
                Some(option) => Err(ExchangeError::OptionNotTaken {
                    what: "a dataset".to_owned(),
                    option: option.name(),
                    takers: option.takers(Direction::Export),
                }),
                None => Ok(()),
            },
        }
    }

    /// The stage that the arguments describe; `None` if they name neither origin nor heading.
    fn stage(&self) -> Option<Stage> {
        (self.stage_origin.is_some() || self.stage_heading.is_some()).then(|| Stage {
            heading_deg: self.stage_heading.unwrap_or(0.0),
            ..Stage::at(self.stage_origin.unwrap_or_default())
        })
    }

    /// What to do where frames are missing.
    fn gaps(&self) -> Gaps {
        match self.interpolate {
            Some(most) => Gaps::Interpolate(most),
            None if self.takes => Gaps::Takes,
            None => Gaps::Keep,
        }
    }
}

/// The options that are marked as given.
pub(super) fn given_options(options: &[(FormatOption, bool)]) -> Vec<FormatOption> {
    let given = options.iter().filter(|(_, is_given)| *is_given);
    given.map(|(option, _)| *option).collect()
}

/// A parser for the names of formats that can be exported, or imported.
pub(super) fn format_parser(
    direction: Direction,
) -> impl clap::builder::TypedValueParser<Value = Format> {
    // The same list is the parser, the help and the completion.
    let formats = Format::all().filter(move |format| match direction {
        Direction::Export => format.exports(),
        Direction::Import => format.imports(),
    });
    let values: Vec<PossibleValue> = formats
        .map(|format| PossibleValue::new(format.name()).help(describe_format(format, direction)))
        .collect();
    PossibleValuesParser::new(values)
        .try_map(|name| Format::from_name(&name).ok_or_else(|| format!("{name} is no format")))
}

/// The title of a format, what an export loses, and the options that it takes.
fn describe_format(format: Format, direction: Direction) -> String {
    let about = format.about();
    let lost = about.loses.filter(|_| direction == Direction::Export);
    let lost = lost.map(|loses| format!(" (an export loses: {loses})"));
    let options = format.options(direction).iter();
    let options: Vec<String> = options
        .map(|option| format!("--{}", option.name()))
        .collect();
    let taken = if options.is_empty() {
        String::new()
    } else {
        format!("; takes {}", options.join(" "))
    };
    format!("{}{}{taken}", about.title, lost.unwrap_or_default())
}

/// Parses a status by its name in documents.
fn parse_status(text: &str) -> Result<FrameStatus, String> {
    let none = |_| format!("{text} is none of new, draft, suggested, reference, rejected");
    text.parse().map_err(none)
}

/// Parses a size such as `1920x1080`.
pub(super) fn parse_size(text: &str) -> Result<ImageSize, String> {
    ImageSize::parse(text).ok_or_else(|| format!("{text} is no size such as 1920x1080"))
}

fn parse_rate(text: &str) -> Result<Rate, String> {
    Rate::parse(text)
        .ok_or_else(|| format!("{text} is no frame rate such as 25, 29.97 or 30000/1001"))
}

fn parse_timecode(text: &str) -> Result<Timecode, String> {
    Timecode::parse(text)
        .ok_or_else(|| format!("{text} is no timecode such as 10:00:00:00 or 10:00:00;00"))
}

/// Parses a number that is neither infinite nor NaN.
pub(super) fn parse_finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Parses a point such as `0,-20,0`.
fn parse_point(text: &str) -> Result<Vec3, String> {
    let parts: Option<Vec<f64>> = text
        .split(',')
        .map(|part| parse_finite(part.trim()))
        .collect();
    let point = parts
        .and_then(|parts| <[f64; 3]>::try_from(parts).ok())
        .map(Vec3::from);
    point.ok_or_else(|| format!("{text} is no point such as 0,-20,0"))
}

/// Parses the direction of a stage, degrees.
fn parse_heading(text: &str) -> Result<f64, String> {
    parse_finite(text).ok_or_else(|| format!("{text} is no number of degrees"))
}

/// Parses the width of a sensor, mm.
pub(super) fn parse_width(text: &str) -> Result<f64, String> {
    let mm = parse_finite(text).filter(|mm| *mm > 0.0);
    mm.ok_or_else(|| format!("{text} is no width above 0, such as 9.6"))
}

/// How a zoom value encodes the focal length: by name, or a table from a file.
pub(super) fn zoom_of(name: &str) -> anyhow::Result<Zoom> {
    let file = match name {
        "focal-px" => return Ok(Zoom::FocalPx),
        "focal-mm-x100" => return Ok(Zoom::FocalMmX100),
        file => file,
    };
    let text = read_named_text(Path::new(file), MAX_TABLE_BYTES);
    let text = text.with_context(|| format!("cannot read the zoom table {file}"))?;
    let rows = text
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    // A row that is no pair of numbers refuses the whole table: a zoom value between its neighbours
    // would otherwise get a wrong focal length without a word. Values are interpolated, which takes
    // two rows.
    let rows = rows.map(|line| {
        let (raw, focal) = line.split_once([',', ' ', '\t'])?;
        Some((parse_finite(raw.trim())?, parse_finite(focal.trim())?))
    });
    let table: Option<Vec<(f64, f64)>> = rows.collect();
    match table {
        Some(table) if table.len() >= 2 => Ok(Zoom::Table(table)),
        _ => bail!(
            "{file} is no table of at least two rows with a raw value and a focal length in px"
        ),
    }
}

/// Refuses the name of a spreadsheet, which no format writes: programs would refuse the file.
fn refuse_spreadsheet(path: Option<&Path>) -> anyhow::Result<()> {
    let ending = path.map(ending).unwrap_or_default();
    ensure!(
        !matches!(ending.as_str(), "xlsx" | "xls" | "ods" | "parquet"),
        "no format writes .{ending}; export --format csv -o NAME.csv, which such programs open"
    );
    Ok(())
}

/// Exports the document. [`Outcome::SomeFailed`] if frames had to be left out.
///
/// # Errors
/// The document cannot be read, the format cannot represent it, or the result cannot be written.
pub fn export(args: &ExportArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.refuse_options()?;
    let input = &args.document.document;
    args.output.refuse_input(input)?;
    refuse_spreadsheet(args.output.output.as_deref())?;
    // A document is written as such, and locked until then; all else by `exported.write` below.
    let output = if args.format == Some(Format::Json) {
        args.output.reserve("export", &[], messages)?
    } else {
        args.output.refuse_for_export()?;
        DocumentOutput::default().reserve("export", &[], messages)?
    };
    let Loaded { location, document } = args.document.load(messages)?;
    // Check the names of cameras first: a wrong one would export no frame.
    let unknown = args.camera.iter().find(|name| {
        document
            .cameras
            .iter()
            .all(|camera| camera.id.as_str() != name.as_str())
    });
    if let Some(unknown) = unknown {
        bail!("there is no camera {unknown:?} in the document");
    }
    let frames = FrameChoice {
        statuses: args.status.clone(),
        cameras: args
            .camera
            .iter()
            .map(|name| name.as_str().into())
            .collect(),
        min_confidence: args.min_confidence,
    };
    // Without `--format` the argument parser has required `--dataset`.
    let Some(format) = args.format else {
        let at = document.at(location.folder());
        return write_dataset(
            at,
            &args.dataset,
            frames,
            args.undistorted,
            args.output.force,
            messages,
        );
    };
    // A complete JSON export is the document itself and needs no conversion.
    if format == Format::Json && frames == FrameChoice::default() {
        output.write(
            document.at(location.folder()).to_dataset()?,
            location.folder(),
        )?;
        return Ok(Outcome::Done);
    }
    let options = ExportOptions {
        frames,
        gaps: args.gaps(),
        start: args.start,
        stage: args.stage(),
        size: args.size,
        game_state: args.variant.as_deref() == Some("gamestate"),
        undistorted: args.undistorted,
        names: args.names.unwrap_or_default(),
        keep_outside: args.outside.as_deref() == Some("keep"),
        points: if args.projected {
            PointSource::Projected
        } else {
            PointSource::Clicked
        },
        rate: args.fps,
        sensor_width_mm: args.sensor_mm,
        zoom: zoom_of(args.zoom.as_deref().unwrap_or("focal-px"))?,
        rotations: args.rotations.unwrap_or_default(),
        recording: Recording {
            match_id: args.match_id.clone(),
            start: args.start_time.clone(),
            perspective: args.perspective.clone(),
            is_automated: args.automated,
        },
    };
    // Export, read the result again, and report what the format cannot represent.
    let exported = export_document(document.at(location.folder()), format, &options)?;
    messages.notes(&exported.loss);
    messages.notes(&exported.notes);
    messages.frames_failed(exported.left_out.iter().map(|(frame, why)| (frame, why)));
    match (exported.dataset(), &args.output.output) {
        // Write a document as such: with backup, lock, and paths changed to lead to the same files.
        (Some((dataset, folder)), _) => output.write(dataset.clone(), folder)?,
        (None, Some(path)) => {
            refuse_existing(path, args.output.force)?;
            exported.write(path, args.output.force)?;
        }
        (None, None) if exported.is_folder() => bail!("{format} makes a folder; name it with -o"),
        (None, None) => {
            let bytes = exported
                .files
                .sorted_entries()
                .first()
                .map_or(&[][..], |(_, bytes)| bytes);
            print(
                std::str::from_utf8(bytes).context("the format is no text; name a file with -o")?,
            )?;
        }
    }
    // The largest distance of a landmark or click between the document and the file as it was read
    // again. A sheet without cameras has nothing to compare, and a document is compared as text.
    let proof = if exported.format.is_proved() {
        format!(
            "; read again, landmarks are within {:.1e} px",
            exported.worst_px
        )
    } else {
        String::new()
    };
    messages.note(&format!(
        "{} written as {}{proof}",
        pluralise(exported.frames, "frame"),
        exported.format
    ));
    Ok(Outcome::from_failure(!exported.left_out.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::{ExportArgs, parse_heading, parse_width, zoom_of};
    use crate::cli::import::ImportArgs;
    use clap::{Args, Command, FromArgMatches};
    use touchline_documents::exchange::{Direction, Format, FormatOption};

    #[test]
    fn every_option_is_for_all_formats_or_declared_by_some() {
        // The choice of frames and what is written where.
        let of_all = [
            "document",
            "path",
            "format",
            "output",
            "force",
            "status",
            "camera",
            "min_confidence",
            "video",
            "every",
        ];
        // Clap itself ties these to `--dataset`.
        let of_datasets = [
            "dataset",
            "images",
            "image_format",
            "outside_pictures",
            "split",
            "split_by",
            "seed",
            "licence",
        ];
        // And these to `--points`, whose layouts refuse what they do not take.
        let of_points = ["points", "layout", "model", "min_probability"];
        let declared: Vec<String> = FormatOption::all()
            .map(|option| option.name().replace('-', "_"))
            .collect();
        let commands = [
            ExportArgs::augment_args(Command::new("export")),
            ImportArgs::augment_args(Command::new("import")),
        ];
        for command in commands {
            for id in command
                .get_arguments()
                .map(|argument| argument.get_id().as_str())
            {
                let is_known = of_all.contains(&id)
                    || of_datasets.contains(&id)
                    || of_points.contains(&id)
                    || declared.iter().any(|name| name == id);
                assert!(is_known, "{} {id}", command.get_name());
            }
        }
    }

    /// Something that an option accepts; none for a switch.
    fn value_of(option: &str) -> Option<&'static str> {
        Some(match option {
            "undistorted" | "projected" | "takes" | "automated" | "skip-unmapped"
            | "each-own-camera" | "masks" => return None,
            "variant" => "gamestate",
            "names" => "roboflow-32",
            "outside" => "keep",
            "interpolate" => "3",
            "start" => "10:00:00:00",
            "fps" => "25",
            "sensor-mm" => "10",
            "start-time" => "2026-01-01T00:00:00Z",
            "perspective" => "camera_1",
            "stage-origin" => "1,2,3",
            "stage-heading" => "30",
            "rotations" => "first",
            "zoom" => "focal-px",
            "pixels" => "centre",
            "map" => "touchline",
            "field" => "soccer",
            "set" => "length_m=105",
            "template" => "centre-m",
            "direction" => "pitch_from_image",
            "columns" => "h=matrix",
            "size" | "stretched-from" => "640x360",
            _ => "name",
        })
    }

    /// The arguments of a command with one option.
    fn given<A: Args + FromArgMatches>(option: FormatOption) -> A {
        let command = A::augment_args(Command::new("command"));
        let name = format!("--{}", option.name());
        let words = ["command", "here", "--format", "json", "--force", &name];
        let found = command.try_get_matches_from(words.into_iter().chain(value_of(option.name())));
        A::from_arg_matches(&found.unwrap_or_else(|error| panic!("{name}: {error}"))).unwrap()
    }

    #[test]
    fn each_format_takes_or_refuses_each_option() {
        let mut pairs = 0;
        for option in FormatOption::all() {
            let [out, back] = [Direction::Export, Direction::Import].map(|way| option.takers(way));
            // What the command line reads must be known as given, or it is ignored. What no format
            // takes is unknown there, but for `--images`, which is for datasets.
            if !out.is_empty() {
                let mut arguments: ExportArgs = given(option);
                assert_eq!(arguments.list_options(), [option]);
                for format in Format::all().filter(|format| format.exports()) {
                    arguments.format = Some(format);
                    let is_taken = arguments.refuse_options().is_ok();
                    assert_eq!(is_taken, out.contains(&format), "{format} {option:?}");
                    pairs += 1;
                }
            }
            if !back.is_empty() {
                let arguments: ImportArgs = given(option);
                assert_eq!(arguments.list_options(), [option]);
                for format in Format::all().filter(|format| format.imports()) {
                    let refused =
                        format.refuse_options(arguments.list_options(), Direction::Import);
                    assert_eq!(
                        refused.is_ok(),
                        back.contains(&format),
                        "{format} {option:?}"
                    );
                    pairs += 1;
                }
            }
        }
        assert!(pairs > 700, "{pairs}");
    }

    #[test]
    fn numbers_that_mean_nothing_are_refused_and_not_ignored() {
        assert_eq!(parse_heading("-12.5"), Ok(-12.5));
        assert_eq!(parse_width("9.6"), Ok(9.6));
        for wrong in ["NaN", "inf", "1e999", "wide"] {
            assert!(parse_heading(wrong).is_err(), "{wrong}");
            assert!(parse_width(wrong).is_err(), "{wrong}");
        }
        assert!(parse_width("0").is_err() && parse_width("-9.6").is_err());
        let file = tempfile::NamedTempFile::new().unwrap();
        for (rows, is_table) in [("0 900\n4096, 9e3", true), ("0 900\n4096 inf", false)] {
            std::fs::write(file.path(), rows).unwrap();
            let table = zoom_of(file.path().to_str().unwrap());
            assert_eq!(table.is_ok(), is_table, "{rows}");
        }
    }
}
