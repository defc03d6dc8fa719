//! The table: the numbers of packets, with times.

use super::sample::{CAMERA, Sample};
use super::{Reading, hold, notes, samples, second_camera_note};
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, SequenceScope, WriteContext,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::{About, Format};
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::table::{Table, TableRow, field_text, push_row};
use std::collections::BTreeSet;
use touchline_core::geometry::Vec3;

/// The table.
pub struct FreeDCsv;

/// The columns of the table.
const COLUMNS: [&str; 12] = [
    "frame_index",
    "pts_s",
    "timecode",
    "camera_id",
    "pan_deg",
    "tilt_deg",
    "roll_deg",
    "x_mm",
    "y_mm",
    "height_mm",
    "zoom_raw",
    "focus_raw",
];

impl CameraFormat for FreeDCsv {
    fn about(&self) -> About {
        About {
            name: "freed-csv",
            title: "FreeD data as a table, with times",
            conventions: "as FreeD, in degrees and mm, with times",
            users: "spreadsheets, FreeD players",
            loses: Some("lens, principal point, size; whole zoom values"),
            file: Some("camera.csv"),
            files: "table (.csv)",
            endings: &["csv"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::Fps,
                FormatOption::Start,
                FormatOption::SensorMm,
                FormatOption::Zoom,
                FormatOption::StageOrigin,
                FormatOption::StageHeading,
            ],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Size,
                FormatOption::Zoom,
                FormatOption::SensorMm,
            ],
        }
    }

    fn hold(&self, frame: &FrameCamera, index: usize, context: &WriteContext<'_>) -> HeldFrame {
        hold(frame, index, context)
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        notes(frames, context)
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::All)
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut text = String::new();
        push_row(&COLUMNS.map(ToOwned::to_owned), &mut text);
        for (sample, frame) in samples(held, context, Format::FreeDCsv)?
            .into_iter()
            .zip(held)
        {
            // Angles and places are not rounded to steps as in packets: a table keeps all digits.
            let numbers = sample
                .angles_deg
                .into_iter()
                .chain(sample.position_m.iter().map(|metres| metres * 1000.0));
            let mut row = vec![
                field_text(frame.frame_index),
                field_text(frame.pts_s),
                field_text(context.timecode(frame)),
                CAMERA.to_string(),
            ];
            // The focus is not known; 0 stands for it, as in packets.
            row.extend(
                numbers
                    .chain([sample.zoom_raw, 0.0])
                    .map(|number| number.to_string()),
            );
            push_row(&row, &mut text);
        }
        Ok(Files::one("camera.csv", text.into_bytes()))
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let mut ids = BTreeSet::new();
        for table in files
            .sorted_entries()
            .into_iter()
            .filter_map(|(_, bytes)| Table::read(bytes).ok())
        {
            ids.extend(
                table
                    .rows()
                    .filter_map(|row| row.text("camera_id").map(ToOwned::to_owned)),
            );
        }
        second_camera_note(&ids).into_iter().collect()
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let reading = Reading::from_options(options, Format::FreeDCsv)?;
        let mut count = 0;
        files.read_all(|_, bytes| {
            let table = Table::read(bytes)?;
            // From the angles to the zoom; numbers, times and the focus may be absent.
            table.needs(&COLUMNS[4..11])?;
            let mut frames = FrameCollector::default();
            for row in table.rows() {
                let name = format!("{count:06}");
                let number = row.frame_index().ok().flatten();
                frames.add_numbered(&name, number, read_row(row, reading, &name));
                count += 1;
                if frames.has_only_damaged() {
                    break;
                }
            }
            frames.finish()
        })
    }
}

fn read_row(row: TableRow<'_>, reading: Reading<'_>, name: &str) -> Result<FrameCamera, Problem> {
    let sample = Sample {
        angles_deg: [
            row.number("pan_deg")?,
            row.number("tilt_deg")?,
            row.number("roll_deg")?,
        ],
        position_m: Vec3::new(
            row.number("x_mm")? / 1000.0,
            row.number("y_mm")? / 1000.0,
            row.number("height_mm")? / 1000.0,
        ),
        zoom_raw: row.number("zoom_raw")?,
    };
    let pinhole = sample
        .pinhole(reading)
        .map_err(|problem| problem.at_line(row.line()))?;
    let frame = FrameCamera::new(name, Some(reading.size), FrameProjection::Camera(pinhole));
    // A table has numbers and times where its writer knew them.
    Ok(FrameCamera {
        frame_index: row.frame_index()?,
        pts_s: row.find("pts_s")?,
        ..frame
    })
}
