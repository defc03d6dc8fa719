//! Lens data that recorders write frame by frame: a table with a row a frame. Import only.
//!
//! Each frame gets the focal length of its row as a known lens ([`FrameLens`]); pan and tilt stay
//! open, and tracking and clicks find them. The pixel's focal length needs the width of the sensor:
//! from the focal length that the same row states for film of 36 × 24 mm, or from `--sensor-mm`.
//! Such tables state no principal point and no distortion: the middle of the picture, and none.
//! Rows follow each other as the frames of the video do; the timecode is not read.
//!
//! [`FrameLens`]: crate::document::FrameLens

use super::fifa::document_with_lenses;
use crate::document::{Document, FieldSpec};
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, KnownLens};
use crate::exchange::cameras::into_document::View;
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::table::{Table, TableRow, number};
use touchline_core::camera::Radial;
use touchline_core::geometry::ImageSize;

/// The format.
pub struct LensTable;

/// Columns of two makers with the focal length, mm.
pub const FOCAL_COLUMNS: [&str; 2] = ["Focal Length (mm)", "FocalLength"];
/// The column with the focal length of the same view on film of 36 × 24 mm, mm.
const ON_FILM_COLUMN: &str = "FocalLength35mm";
/// The width of that film, mm.
const FILM_MM: f64 = 36.0;
/// What a row has where the recorder does not know a number, such as `65535/65535`.
const UNKNOWN: f64 = 65_535.0;

/// A length of a row, mm, written as a number or as a fraction such as `180/10`; none where it is
/// empty or stated as unknown.
fn length_mm(row: &TableRow<'_>, column: &str) -> Result<Option<f64>, Problem> {
    let Some(text) = row.text(column) else {
        return Ok(None);
    };
    let (above, below) = text.split_once('/').unwrap_or((text, "1"));
    let value = |text| number(column, text).map_err(|problem| problem.at_line(row.line()));
    let (above, below) = (value(above)?, value(below)?);
    if above == UNKNOWN {
        return Ok(None);
    }
    let length_mm = above / below;
    if length_mm > 0.0 && length_mm.is_finite() {
        return Ok(Some(length_mm));
    }
    let problem = Problem::out_of_range(column, length_mm, "a length above 0, mm");
    Err(problem.at_line(row.line()))
}

/// The lens of a row.
fn lens_of(
    row: &TableRow<'_>,
    column: &str,
    options: &ImportOptions,
    size: ImageSize,
) -> Result<KnownLens, Problem> {
    let focal_mm = length_mm(row, column)?.ok_or_else(|| row.missing(column))?;
    let on_film_mm = length_mm(row, ON_FILM_COLUMN)?;
    let sensor_mm = options
        .sensor_width_mm
        .or_else(|| Some(FILM_MM * focal_mm / on_film_mm?));
    let sensor_mm = sensor_mm
        .ok_or_else(|| Problem::option_needed("the width of the sensor", "--sensor-mm"))?;
    Ok(KnownLens {
        focal_px: focal_mm / sensor_mm * f64::from(size.width),
        principal_point: size.centre(),
        radial: Radial::default(),
    })
}

fn read_table(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<Vec<FrameCamera>, Problem> {
    let table = Table::read(bytes)?;
    let mut columns = FOCAL_COLUMNS.into_iter();
    let column = columns
        .find(|column| table.needs(&[column]).is_ok())
        .ok_or_else(|| Problem::Missing(format!("the column {}", FOCAL_COLUMNS.join(" or "))))?;
    let size = options.size.ok_or_else(|| {
        Problem::option_needed(
            "the size of the pictures",
            "--video VIDEO or --size WIDTHxHEIGHT",
        )
    })?;
    let video = format!("{}.mp4", stem(name));
    let mut frames = FrameCollector::default();
    for (index, row) in table.rows().enumerate() {
        let name = format!("{video}#{index:06}");
        let read = lens_of(&row, column, options, size).map(|lens| FrameCamera {
            video: Some(video.clone()),
            frame_index: Some(index as u64),
            ..FrameCamera::new(&name, Some(size), FrameProjection::Lens(lens))
        });
        frames.add_numbered(&name, Some(index as u64), read);
        if frames.has_only_damaged() {
            break;
        }
    }
    frames.finish()
}

impl CameraFormat for LensTable {
    fn about(&self) -> About {
        About {
            name: "lens",
            title: "a recorder's table of focal lengths, one row per frame",
            conventions: "mm on the sensor; the principal point is the middle; no pan and tilt",
            users: "Sony Venice and Canon Cinema EOS metadata tables",
            loses: None,
            file: Some("lens.csv"),
            files: "table (.csv)",
            endings: &["csv"],
            export_options: &[],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::SensorMm,
            ],
        }
    }

    fn document(&self, field: FieldSpec, frames: &[View]) -> Document {
        document_with_lenses(field, frames, self.exactness())
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|name, bytes| read_table(name, bytes, options))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, sensor_mm: Option<f64>) -> ExchangeResult<Vec<FrameCamera>> {
        let options = ImportOptions {
            size: Some(ImageSize::new(1920, 1080)),
            sensor_width_mm: sensor_mm,
            ..ImportOptions::default()
        };
        LensTable.read(&Files::one("A001.csv", text.as_bytes().to_vec()), &options)
    }

    fn focal_px(frame: &FrameCamera) -> f64 {
        match frame.shown {
            FrameProjection::Lens(lens) => lens.focal_px,
            _ => f64::NAN,
        }
    }

    #[test]
    fn rows_give_the_lens_of_their_frames() {
        let text = "\"Timecode\",\"Focal Length (mm)\"\n\"16:47:04:19\",\"32\"\n\"16:47:04:20\",\"40.5\"\n";
        let frames = read(text, Some(24.0)).unwrap();
        assert_eq!([0, 1].map(|row| focal_px(&frames[row])), [2560.0, 3240.0]);
        assert_eq!(frames[1].frame_index, Some(1));
        let text = "Timecode,FocalLength,FocalLength35mm\n0:0,180/10,263/10\n0:1,65535/65535,1\n";
        let frames = read(text, None).unwrap();
        assert!((focal_px(&frames[0]) - 1920.0 * 26.3 / 36.0).abs() < 1e-9);
        assert!(
            frames[1].unreadable.is_some(),
            "the zoom is not known there"
        );
    }

    #[test]
    fn a_table_says_what_it_lacks() {
        for (text, wanted) in [
            (
                "FocalLength\n18\n",
                "the width of the sensor is not known; give --sensor-mm",
            ),
            (
                "FocalLength\n0\n",
                "line 2: FocalLength is 0, which must be a length above 0, mm",
            ),
            (
                "FocalLength\n1/0\n",
                "line 2: FocalLength is inf, which must be a length above 0, mm",
            ),
            (
                "Timecode\n18\n",
                "the column Focal Length (mm) or FocalLength is missing",
            ),
            ("", "the file is empty"),
        ] {
            let error = read(text, None).unwrap_err().to_string();
            assert_eq!(error, format!("A001.csv: {wanted}"), "{text}");
        }
    }
}
