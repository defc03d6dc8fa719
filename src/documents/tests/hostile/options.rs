//! Every pair of a format and an option: an option that is declared changes what is written or
//! read, and one that changes something is declared.

use crate::samples::{Sample, document, formats};
use std::path::Path;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_documents::document::{Click, Document, Stage};
use touchline_documents::exchange::{
    Direction, ExportOptions, Format, FormatOption, Gaps, GroundPlan, ImportOptions, KeypointNames,
    LabelMap, MatrixDirection, Pixels, PointSource, Rate, Rotations, Timecode, Zoom, export,
};

/// What the test calls the options of imports that the command line heeds by itself.
const OF_THE_COMMAND: [FormatOption; 1] = [FormatOption::EachOwnCamera];

/// A document in which each option finds something to change: a gap of a frame, a click outside of
/// the picture, and one on a line whose class has two names.
fn probe() -> Document {
    let mut document = document();
    let mut third = (*document.frames[1]).clone();
    third.image = Some("images/0004.jpg".to_owned());
    third.id = "third".into();
    let video = third.video.as_mut().unwrap();
    (video.frame_index, video.pts_s) = (415, Some(415.0 / 25.0));
    third.ptz.as_mut().unwrap().pan_deg += 1.0;
    document.frames.push(third.into());
    for frame in &mut document.frames {
        let at = ImagePoint::new;
        frame.clicks.extend([
            Click::landmark("halfway_far".into(), at(434.0, -35.0)),
            Click::landmark("corner_far_right".into(), at(1700.0, 535.0)),
            Click::line("post_near_left".into(), at(100.0, 500.0)),
        ]);
    }
    document
}

/// Sets an option of an export to something unusual.
fn set(option: FormatOption, options: &mut ExportOptions) {
    let recording = &mut options.recording;
    match option {
        FormatOption::Size => options.size = Some(ImageSize::new(960, 540)),
        FormatOption::Variant => options.game_state = true,
        FormatOption::Undistorted => options.undistorted = true,
        FormatOption::Names => options.names = KeypointNames::Roboflow32,
        FormatOption::Projected => options.points = PointSource::Projected,
        FormatOption::Outside => options.keep_outside = true,
        FormatOption::Interpolate => options.gaps = Gaps::Interpolate(9),
        FormatOption::Takes => options.gaps = Gaps::Takes,
        FormatOption::Start => options.start = Timecode::parse("10:00:00:00"),
        FormatOption::Fps => options.rate = Rate::parse("50"),
        FormatOption::SensorMm => options.sensor_width_mm = Some(7.0),
        FormatOption::MatchId => recording.match_id = Some("other".to_owned()),
        FormatOption::StartTime => recording.start = Some("2026-03-02T18:59:30Z".to_owned()),
        FormatOption::Perspective => recording.perspective = Some("broadcast".to_owned()),
        FormatOption::Automated => recording.is_automated = true,
        FormatOption::StageOrigin => options.stage = Some(Stage::at(Vec3::new(3.0, 0.0, 0.0))),
        FormatOption::StageHeading => {
            options.stage = Some(Stage {
                heading_deg: 30.0,
                ..Stage::at(Vec3::zeros())
            });
        }
        FormatOption::Rotations => options.rotations = Rotations::First,
        FormatOption::Zoom => options.zoom = Zoom::Table(vec![(0.0, 1000.0), (1.0, 3000.0)]),
        _ => {}
    }
}

/// Everything that an export says and writes.
fn written(format: Format, option: Option<FormatOption>) -> String {
    let mut options = ExportOptions {
        sensor_width_mm: Some(9.6),
        ..ExportOptions::default()
    };
    options.recording.match_id = Some("m1".to_owned());
    options.recording.start = Some("2026-03-01T18:59:30Z".to_owned());
    options.recording.perspective = Some("camera_1".to_owned());
    // A sensor has a meaning for FreeD only where zoom is in mm.
    if format.takes(FormatOption::Zoom, Direction::Export) && option != Some(FormatOption::Zoom) {
        options.zoom = Zoom::FocalMmX100;
    }
    if let Some(option) = option {
        set(option, &mut options);
    }
    let document = probe();
    let exported = export(document.at(Path::new("/")), format, &options);
    let mut exported = exported.unwrap_or_else(|error| panic!("{format} {option:?}: {error}"));
    // How exactly it was read back is no effect.
    exported.worst_px = 0.0;
    format!("{exported:?}")
}

#[test]
fn every_option_of_an_export_is_heeded_or_not_declared() {
    let mut wrong = Vec::new();
    for format in Format::all().filter(|format| format.exports()) {
        let plain = written(format, None);
        for option in FormatOption::all() {
            let is_declared = format.takes(option, Direction::Export);
            // Reading has these, and they are never given to an export.
            let is_heeded = written(format, Some(option)) != plain;
            // A sheet has no frames; only their number in a message changes.
            let is_count = format == Format::Cdf
                && matches!(option, FormatOption::Interpolate | FormatOption::Takes);
            if is_heeded != is_declared && !is_count {
                wrong.push(format!("{format} --{}: heeded {is_heeded}", option.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Sets an option of an import to something unusual.
fn set_reading(option: FormatOption, options: &mut ImportOptions) {
    match option {
        FormatOption::Size => options.size = Some(ImageSize::new(960, 540)),
        FormatOption::Images => options.images = Some("elsewhere".into()),
        FormatOption::Pixels => options.pixels = Some(Pixels::Corner),
        FormatOption::Map => options.map = LabelMap::Roboflow32Captions,
        FormatOption::SkipUnmapped => options.skip_unmapped = true,
        FormatOption::Annotator => options.annotator = Some("nobody".to_owned()),
        FormatOption::Field => "basketball_nba".clone_into(&mut options.field.template),
        FormatOption::Set => {
            options.field.params.insert("length_m".to_owned(), 20.0);
        }
        FormatOption::Zoom => options.zoom = Some(Zoom::Table(vec![(0.0, 1e3), (1e4, 9e4)])),
        FormatOption::SensorMm => options.sensor_width_mm = Some(7.0),
        FormatOption::Undistorted => options.undistorted = true,
        FormatOption::Masks => options.masks = true,
        FormatOption::Template => options.homographies.plan = Some(GroundPlan::CornerMetres),
        FormatOption::Direction => {
            options.homographies.direction = Some(MatrixDirection::ImageFromPitch);
        }
        FormatOption::StretchedFrom => options.stretched_from = Some(ImageSize::new(1000, 900)),
        FormatOption::Columns => options.homographies.matrix_column = Some("other".to_owned()),
        _ => {}
    }
}

/// Everything that an import says and makes.
fn read(sample: &Sample, folder: &Path, change: impl Fn(&mut ImportOptions)) -> String {
    let mut sample = sample.clone();
    change(&mut sample.options);
    match sample.import(&sample.files, folder) {
        Ok(imported) => format!("{:?} {:?}", imported.document, imported.notes),
        Err(error) => error.to_string(),
    }
}

#[test]
fn every_option_of_an_import_is_heeded_or_not_declared() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for format in formats() {
        let mut sample = Sample::of(format);
        if format == Format::OpenTrackIo {
            // The sensor of the option counts where the file states none.
            let text = sample
                .text()
                .replace("activeSensorPhysicalDimensions", "unknown");
            sample.files[0].1 = text.into_bytes();
            sample.options.sensor_width_mm = Some(9.6);
        }
        if format.takes(FormatOption::Zoom, Direction::Import) {
            sample.options.zoom = Some(Zoom::FocalMmX100);
            sample.options.sensor_width_mm = Some(9.6);
        }
        for option in FormatOption::all() {
            if OF_THE_COMMAND.contains(&option) {
                continue;
            }
            let mut sample = sample.clone();
            if (format, option) == (Format::SoccerNetLines, FormatOption::Masks) {
                sample.files = Sample::game_state().files;
            }
            let is_heeded = [Pixels::Corner, Pixels::Centre].into_iter().any(|pixels| {
                // Whether labels without a meaning are skipped matters where there are some.
                let prepare = |options: &mut ImportOptions| {
                    if option == FormatOption::SkipUnmapped {
                        options.map = LabelMap::SoccerNet;
                    }
                };
                let plain = read(&sample, folder.path(), prepare);
                let given = read(&sample, folder.path(), |options| {
                    prepare(options);
                    set_reading(option, options);
                    if option == FormatOption::Pixels {
                        options.pixels = Some(pixels);
                    }
                });
                given != plain
            });
            let is_declared = format.takes(option, Direction::Import);
            if is_heeded != is_declared {
                wrong.push(format!("{format} --{}: heeded {is_heeded}", option.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn an_option_that_is_not_taken_is_refused_with_the_formats_that_take_it() {
    let error = Format::Coco.refuse_options([FormatOption::Undistorted], Direction::Export);
    assert_eq!(
        error.unwrap_err().to_string(),
        "--undistorted has no effect on coco; it is for wc14, tsworldcup or homography"
    );
    let error = Format::Csv.refuse_options([FormatOption::Annotator], Direction::Import);
    assert_eq!(
        error.unwrap_err().to_string(),
        "--annotator has no effect on csv; it is for label-studio"
    );
    let taken = Format::Coco.refuse_options([FormatOption::Size], Direction::Export);
    assert!(taken.is_ok());
    for option in FormatOption::all() {
        let takers = [Direction::Export, Direction::Import].map(|way| option.takers(way).len());
        assert!(takers != [0, 0], "--{} is for no format", option.name());
    }
}
