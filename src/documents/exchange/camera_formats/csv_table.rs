//! A flat table with one row per frame: the camera as R, t and lens, and the homography from the
//! picture to the pitch.
//!
//! World, pixels and angles are the document's own. `r11` … `r33` are `cam_from_world`, `t_*_m` is
//! −R C, and `h_pitch_from_image_*` maps an *undistorted* pixel (corner convention) to metres on
//! the pitch. `grade`, `ground_sigma_m` and `visible_area_m` (JSON: `[[x, y], …]`, m) say what the
//! camera is good for on the ground; they are results and are not read. Empty fields are unknown values. Numbers have all their digits (before pandas 3:
//! `read_csv(f, float_precision="round_trip")`).

use crate::document::{FrameStatus, SolutionSource};
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, SequenceScope, WriteContext, stem_of,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole, Record};
use crate::exchange::cameras::ground_fit::fit_image_from_ground;
use crate::exchange::cameras::held::{parts, relative_name};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options::{self, FormatOption};
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::safe_path;
use crate::exchange::syntax::table::{Table, TableRow, field_text, push_row};
use crate::exchange::syntax::values::side_px;
use touchline_core::camera::Radial;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3, text_cell};

/// The table.
pub struct Csv;

/// The columns up to the rotation, and those behind the homography.
const COLUMNS: [&str; 20] = [
    "frame_index",
    "pts_s",
    "timecode",
    "image",
    "camera",
    "status",
    "source",
    "interpolated",
    "width_px",
    "height_px",
    "pan_deg",
    "tilt_deg",
    "focal_px",
    "cx_px",
    "cy_px",
    "k1",
    "k2",
    "camera_x_m",
    "camera_y_m",
    "camera_z_m",
];
const LAST_COLUMNS: [&str; 9] = [
    "sigma_pan_deg",
    "sigma_tilt_deg",
    "sigma_focal_px",
    "worst_corner_sigma_px",
    "rms_px",
    "confidence",
    "grade",
    "ground_sigma_m",
    "visible_area_m",
];

/// The last column, which only tables with pixels that are not square have.
const PIXEL_ASPECT: &str = "pixel_aspect";

/// The nine names of a matrix's entries, by rows.
fn entries(prefix: &str) -> impl Iterator<Item = String> + '_ {
    (1..=3).flat_map(move |row| (1..=3).map(move |column| format!("{prefix}{row}{column}")))
}

fn header() -> Vec<String> {
    let first = COLUMNS.into_iter().map(ToOwned::to_owned);
    let translation = ["t_x_m", "t_y_m", "t_z_m"]
        .into_iter()
        .map(ToOwned::to_owned);
    let last = LAST_COLUMNS.into_iter().map(ToOwned::to_owned);
    first
        .chain(entries("r"))
        .chain(translation)
        .chain(entries("h_pitch_from_image_"))
        .chain(last)
        .collect()
}

/// A number that may be absent, with all its digits.
fn field(value: Option<f64>) -> String {
    field_text(value.filter(|value| value.is_finite()))
}

/// The homography from an undistorted pixel to the pitch (m), scaled so that its last entry is one.
/// For crowned ground it is fitted.
fn ground_from_image(pinhole: &Pinhole, size: ImageSize, field: &FieldModel) -> Option<Mat3> {
    // On flat ground the homography follows from the camera exactly. A crowned field has none, so
    // that the nearest one is written, without the lens, as the column says.
    let image_from_ground = if field.crown_m == 0.0 {
        pinhole.image_from_ground()
    } else {
        fit_image_from_ground(
            &Pinhole {
                lens: pinhole.lens.without_distortion(),
                ..*pinhole
            },
            size,
            field,
        )?
    };
    // Edge-on ground has no inverse, and a horizon through the pixel (0, 0) makes the last entry
    // zero: then the nine fields stay empty.
    let inverse = image_from_ground.try_inverse()?;
    Some(inverse / inverse[(2, 2)]).filter(|h| h.iter().all(|entry| entry.is_finite()))
}

/// The name of a source in documents.
fn source_name(source: SolutionSource) -> String {
    // The word that a document has for it, so that both name a source alike.
    serde_json::to_value(source)
        .ok()
        .and_then(|name| Some(name.as_str()?.to_owned()))
        .unwrap_or_default()
}

fn row_of(
    frame: &FrameCamera,
    pinhole: &Pinhole,
    size: ImageSize,
    context: &WriteContext<'_>,
) -> Vec<String> {
    // The fields stand in the order of `COLUMNS`, the rotation, the translation, the homography and
    // `LAST_COLUMNS`.
    let record = &frame.record;
    let (translation, c) = (pinhole.translation(), pinhole.position_m);
    let mut row = vec![
        field_text(frame.frame_index),
        field(frame.pts_s),
        field_text(context.timecode(frame)),
        if frame.image.is_some() {
            text_cell(&frame.name)
        } else {
            String::new()
        },
        frame.camera.as_deref().map(text_cell).unwrap_or_default(),
        record.status.as_str().to_owned(),
        record.source.map(source_name).unwrap_or_default(),
        u8::from(record.source == Some(SolutionSource::Interpolated)).to_string(),
        size.width.to_string(),
        size.height.to_string(),
        field(record.ptz.map(|ptz| ptz.pan.degrees())),
        field(record.ptz.map(|ptz| ptz.tilt.degrees())),
    ];
    let Pinhole {
        focal_px,
        principal_point,
        lens,
        ..
    } = *pinhole;
    let numbers = [
        focal_px,
        principal_point.x,
        principal_point.y,
        lens.k1,
        lens.k2,
        c.x,
        c.y,
        c.z,
    ];
    row.extend(numbers.map(|number| field(Some(number))));
    // nalgebra runs through a matrix by columns; the table has its rows.
    row.extend(
        pinhole
            .cam_from_world
            .transpose()
            .iter()
            .map(|entry| field(Some(*entry))),
    );
    row.extend(translation.iter().map(|entry| field(Some(*entry))));
    match ground_from_image(pinhole, size, context.field) {
        Some(h) => row.extend(h.transpose().iter().map(|entry| field(Some(*entry)))),
        None => row.extend(vec![String::new(); 9]),
    }
    let sigma = record.sigma.map_or([None; 3], |sigma| sigma.map(Some));
    let last = [
        record.worst_corner_sigma_px,
        record.rms_px,
        record.confidence,
    ];
    row.extend(sigma.into_iter().chain(last).map(field));
    match &record.ground {
        Some(ground) => row.extend([
            ground.grade.as_str().to_owned(),
            field(ground.sigma_m),
            format!("{:?}", ground.visible_area_m),
        ]),
        None => row.extend(vec![String::new(); 3]),
    }
    row
}

/// The name of a frame without an image of its own.
fn name_by_number(index: u64, camera: &str) -> String {
    format!("{camera}#{index}")
}

/// The name of a row's frame where its camera cannot be read, and its number in its video, where it
/// has no image.
fn name_of(row: &TableRow<'_>) -> (String, Option<u64>) {
    if let Some(image) = row.text("image").and_then(|image| safe_path(image).ok()) {
        return (image, None);
    }
    match row.frame_index() {
        Ok(Some(index)) => {
            let camera = row.text("camera").unwrap_or_default();
            (name_by_number(index, camera), Some(index))
        }
        _ => (format!("line {}", row.line()), None),
    }
}

fn read_row(row: TableRow<'_>) -> Result<FrameCamera, Problem> {
    // The camera comes from R, C and the lens alone. Pan, tilt, t and H follow from them and are
    // not read, so that a file cannot contradict itself.
    let rotation: Vec<f64> = entries("r")
        .map(|column| row.number(&column))
        .collect::<Result<_, _>>()?;
    let position = Vec3::new(
        row.number("camera_x_m")?,
        row.number("camera_y_m")?,
        row.number("camera_z_m")?,
    );
    let pinhole = Pinhole {
        cam_from_world: Mat3::from_row_slice(&rotation),
        position_m: position,
        focal_px: row.number("focal_px")?,
        principal_point: ImagePoint::new(row.number("cx_px")?, row.number("cy_px")?),
        lens: Radial {
            k1: row.find("k1")?.unwrap_or(0.0),
            k2: row.find("k2")?.unwrap_or(0.0),
            pixel_aspect: row.find(PIXEL_ASPECT)?.unwrap_or(1.0),
        },
    };
    let pinhole = pinhole
        .validate("the camera")
        .map_err(|problem| problem.at_line(row.line()))?;
    let index = row.frame_index()?;
    let image = row
        .text("image")
        .map(safe_path)
        .transpose()
        .map_err(|problem| problem.at_line(row.line()))?;
    let camera = row.text("camera").map(ToOwned::to_owned);
    // A frame of a video without an image is named by camera and number, as `hold` names it.
    let by_number = index.map(|index| name_by_number(index, camera.as_deref().unwrap_or_default()));
    let name = image.clone().or(by_number).ok_or_else(|| {
        Problem::Missing("both image and frame_index".to_owned()).at_line(row.line())
    })?;
    let size = ImageSize::new(side(row, "width_px")?, side(row, "height_px")?);
    Ok(FrameCamera {
        image,
        camera,
        frame_index: index,
        pts_s: row.find("pts_s")?,
        record: Record {
            // A word of another version of the program is no reason to refuse a camera.
            status: row
                .text("status")
                .and_then(|status| serde_json::from_value(status.into()).ok())
                .unwrap_or(FrameStatus::Suggested),
            worst_corner_sigma_px: row.find("worst_corner_sigma_px")?,
            rms_px: row.find("rms_px")?,
            confidence: row.find("confidence")?,
            ..Record::default()
        },
        ..FrameCamera::new(&name, Some(size), FrameProjection::Camera(pinhole))
    })
}

/// A side of the picture in a column, px.
fn side(row: TableRow<'_>, column: &str) -> Result<u32, Problem> {
    side_px(column, row.number(column)?).map_err(|problem| problem.at_line(row.line()))
}

impl CameraFormat for Csv {
    fn about(&self) -> About {
        About {
            name: "csv",
            title: "a table, one row per frame, with R, t and H",
            conventions: "touchline's world; R is cam_from_world, H takes undistorted pixels to metres on the pitch",
            users: "pandas, polars, spreadsheets, analysts",
            loses: Some("clicks"),
            file: Some("cameras.csv"),
            files: "table (.csv)",
            endings: &["csv"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::Fps,
                FormatOption::Start,
            ],
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let camera = frame.camera.as_deref().unwrap_or_default();
        let name = match (&frame.image, frame.frame_index) {
            (Some(_), _) => relative_name(frame),
            (None, Some(index)) => name_by_number(index, camera),
            (None, None) => {
                return Err(format!(
                    "{} has neither an image nor a number",
                    stem_of(frame)
                ));
            }
        };
        Ok(frame.with_name(name))
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::CameraWithoutImages)
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut text = String::new();
        let is_square = held
            .iter()
            .filter_map(FrameCamera::pinhole)
            .all(|pinhole| pinhole.lens.pixel_aspect == 1.0);
        let mut columns = header();
        columns.extend((!is_square).then(|| PIXEL_ASPECT.to_owned()));
        push_row(&columns, &mut text);
        for frame in held {
            if let Ok((pinhole, size)) = parts(frame) {
                let mut row = row_of(frame, &pinhole, size, context);
                row.extend((!is_square).then(|| field(Some(pinhole.lens.pixel_aspect))));
                push_row(&row, &mut text);
            }
        }
        Ok(Files::one("cameras.csv", text.into_bytes()))
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|_, bytes| {
            // One column for each group: the header of another program's table is refused at once,
            // with the column that it lacks.
            let table = Table::read(bytes)?;
            table.needs(&[
                "focal_px",
                "cx_px",
                "cy_px",
                "camera_x_m",
                "r11",
                "width_px",
            ])?;
            let mut frames = FrameCollector::default();
            for row in table.rows() {
                let (name, number) = name_of(&row);
                frames.add_numbered(&name, number, read_row(row));
                if frames.has_only_damaged() {
                    break;
                }
            }
            frames.finish()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, export_as, reference, text_of};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;

    #[test]
    fn timecodes_of_two_videos_are_by_their_own_rates() {
        let mut document = awkward();
        for (index, frame) in document.frames.iter_mut().enumerate() {
            let (video, rate, number) = if index < 6 {
                ("a.mp4", 25.0, 100)
            } else {
                ("b.mp4", 50.0, 200)
            };
            let number = number + index as u64;
            frame.video = Some(crate::document::VideoFrame::new(
                video,
                number,
                Some(number as f64 / rate),
            ));
        }
        let text = text_of(&export_as(&document, Format::Csv).files, "cameras.csv");
        let table = Table::read(text.as_bytes()).unwrap();
        let codes: Vec<String> = table
            .rows()
            .filter_map(|row| row.text("timecode").map(ToOwned::to_owned))
            .collect();
        assert_eq!(
            (codes[0].as_str(), codes[6].as_str()),
            ("00:00:04:00", "00:00:04:06")
        );
    }

    #[test]
    fn the_homography_takes_pixels_to_the_pitch() {
        let mut document = reference();
        document.cameras[0].distortion = None;
        let text = text_of(&export_as(&document, Format::Csv).files, "cameras.csv");
        let table = Table::read(text.as_bytes()).unwrap();
        let row = table.rows().next().unwrap();
        assert_eq!(
            (row.text("timecode"), row.text("image")),
            (Some("00:00:16:12"), Some("images/0001.jpg"))
        );
        let h: Vec<f64> = entries("h_pitch_from_image_")
            .map(|column| row.number(&column).unwrap())
            .collect();
        for (entry, wanted) in h.iter().zip([
            -0.28523037860,
            0.01228222517,
            117.69701651986,
            0.06323405255,
            1.01070678755,
            -824.93520766999,
            0.0,
            -0.01592175417,
            1.0,
        ]) {
            assert!((entry - wanted).abs() < 1e-9, "{entry} {wanted}");
        }
    }

    #[test]
    fn what_is_in_px_belongs_to_the_size_of_picture_that_is_written() {
        let mut document = reference();
        document.frames[0].solution = Some(crate::document::Solution {
            covariance: Some(Mat3::from_diagonal(&Vec3::new(0.25, 0.25, 9.0))),
            worst_corner_sigma_px: Some(4.0),
            rms_px: Some(1.5),
            ..crate::document::Solution::default()
        });
        let options = ExportOptions {
            size: Some(ImageSize::new(960, 540)),
            ..ExportOptions::default()
        };
        let exported = export(document.at(Path::new("/")), Format::Csv, &options).unwrap();
        let text = text_of(&exported.files, "cameras.csv");
        let table = Table::read(text.as_bytes()).unwrap();
        let row = table.rows().next().unwrap();
        let numbers = [
            "focal_px",
            "sigma_pan_deg",
            "sigma_focal_px",
            "worst_corner_sigma_px",
            "rms_px",
        ]
        .map(|column| row.number(column).unwrap());
        assert_eq!(numbers, [1205.0, 0.5, 1.5, 2.0, 0.75]);
    }

    #[test]
    fn every_number_comes_back() {
        let exported = export_as(&awkward(), Format::Csv);
        assert!(
            exported.loss.is_none() && exported.worst_px < 1e-6,
            "{exported:?}"
        );
        let mut document = awkward();
        for frame in &mut document.frames {
            frame.image = None;
        }
        let from_video = export_as(&document, Format::Csv);
        assert!(
            text_of(&from_video.files, "cameras.csv")
                .lines()
                .nth(1)
                .unwrap()
                .starts_with("412,16.48,00:00:16:12,,main,")
        );
    }

    #[test]
    fn damaged_tables_are_named_in_one_line() {
        let good = text_of(&export_as(&reference(), Format::Csv).files, "cameras.csv");
        let swap = |from: &str, to: &str| good.replacen(from, to, 1);
        for (text, wanted) in [
            (String::new(), "the file is empty"),
            ("a,b\n1,2\n".to_owned(), "the column focal_px is missing"),
            (
                swap("images/0001.jpg", "../../etc/passwd"),
                "line 2: the path \"../../etc/passwd\" points outside the folder",
            ),
            (
                swap(",1920,", ",0,"),
                "line 2: width_px is 0, which must be a whole number from 1 to 65535",
            ),
            (
                swap(",1920,", ",wide,"),
                "line 2: width_px: a number is expected, found \"wide\"",
            ),
            (
                swap(",2410,", ",-2410,"),
                "line 2: the focal length of the camera is -2410, which must be above 0",
            ),
            (
                swap(",2410,", ",NaN,"),
                "line 2: focal_px is not a finite number",
            ),
            (
                swap(",2410,", ",,"),
                "line 2: a value for focal_px is missing",
            ),
            (
                swap(",960,", ",inf,"),
                "line 2: cx_px is not a finite number",
            ),
            (swap("r11", "r12"), "the column \"r12\" occurs twice"),
            (
                swap(",images/0001.jpg,", ","),
                "line 2: fields: 50 are expected, found 49",
            ),
            (
                swap("412,", "\"412,"),
                "not a table: a quote is never closed",
            ),
        ] {
            let files = Files::one("a.csv", text.into_bytes());
            let error = Csv
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.csv: {wanted}"));
        }
    }
}
