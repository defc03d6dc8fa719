//! `FreeD` D1: packets of 29 bytes, back to back, and the same as a table with times.
//!
//! Pan 0 looks along +y, positive to the right; tilt up; roll clockwise seen from behind; steps of
//! 1/32768° and 1/64 mm. The zoom is a raw number, here the focal length in px, in mm × 100 by the
//! sensor's width, or by a table. There is no size of picture, principal point, lens or time in it.
//! Source: Vinten Radamec manual V1.4.4, appendices A and B.

use super::body_angles::{angles_deg, cam_from_world};
use super::camera_format::{CameraFormat, EXACT_PX, WriteContext, has_ending};
use super::error::{ExchangeError, Problem};
use super::files::{Files, refuse_archive};
use super::format::Format;
use super::frame_camera::{FrameCamera, Pinhole, Shown};
use super::held::{parts, plain, with};
use super::into_document::Exactness;
use super::options::{ImportOptions, Zoom};
use super::table::{Row, Table, push_row};
use std::collections::BTreeSet;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, Vec3};

/// Packets.
pub struct FreeD;
/// The table.
pub struct FreeDCsv;

/// The length of a packet, bytes.
const PACKET: usize = 29;
/// The first byte of a packet.
const D1: u8 = 0xd1;
/// The initial value of the checksum.
const CHECKSUM: u8 = 0x40;
/// Steps per degree.
const PER_DEGREE: f64 = 32_768.0;
/// Steps per metre.
const PER_METRE: f64 = 64_000.0;
/// The largest signed number of 24 bits.
const MAX_S24: f64 = 8_388_607.0;
/// The largest unsigned number of 24 bits.
const MAX_U24: f64 = 16_777_215.0;
/// The camera's number in packets.
const CAMERA: u8 = 1;
/// The rounding of three angles and of a position seen from tens of metres, half a step each, rad.
const STEP_RAD: f64 = 1.5e-6;

impl Zoom {
    /// The raw value nearest to a focal length.
    fn raw(&self, focal_px: f64, size: ImageSize, sensor_mm: Option<f64>) -> Result<f64, String> {
        let raw = match self {
            Self::FocalPx => focal_px,
            Self::FocalMmX100 => {
                let sensor =
                    sensor_mm.ok_or("the sensor's width is not known; give --sensor-mm")?;
                100.0 * focal_px * sensor / f64::from(size.width)
            }
            Self::Table(table) => {
                between(table.iter().map(|(raw, focal)| (*focal, *raw)), focal_px).ok_or_else(
                    || format!("the focal length {focal_px} px is not within the zoom table"),
                )?
            }
        };
        let raw = raw.round();
        if (0.0..=MAX_U24).contains(&raw) {
            Ok(raw)
        } else {
            Err(format!("the zoom value {raw} needs more than 24 bits"))
        }
    }

    /// The focal length of a raw value, px.
    fn focal_px(&self, raw: f64, size: ImageSize, sensor_mm: Option<f64>) -> Result<f64, Problem> {
        match self {
            Self::FocalPx => Ok(raw),
            Self::FocalMmX100 => {
                let sensor = sensor_mm.ok_or_else(|| {
                    Problem::Missing("the sensor's width (--sensor-mm)".to_owned())
                })?;
                Ok(raw / 100.0 * f64::from(size.width) / sensor)
            }
            Self::Table(table) => between(table.iter().copied(), raw).ok_or_else(|| {
                let what = "the zoom value".to_owned();
                Problem::OutOfRange {
                    what,
                    value: raw,
                    wanted: "within the zoom table",
                }
            }),
        }
    }
}

/// Linear interpolation between the rows of a table, whose first column may be ascending or
/// descending. None outside the table.
fn between(table: impl Iterator<Item = (f64, f64)>, at: f64) -> Option<f64> {
    let mut rows: Vec<(f64, f64)> = table.collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pair = rows
        .windows(2)
        .find(|pair| pair[0].0 <= at && at <= pair[1].0)?;
    let share = (at - pair[0].0) / (pair[1].0 - pair[0].0);
    Some(if share.is_finite() {
        pair[0].1 + share * (pair[1].1 - pair[0].1)
    } else {
        pair[0].1
    })
}

/// What the user must state, because neither packets nor the table contain it.
#[derive(Clone, Copy)]
struct Reading<'a> {
    size: ImageSize,
    zoom: &'a Zoom,
    sensor_mm: Option<f64>,
}

impl<'a> Reading<'a> {
    fn of(options: &'a ImportOptions, format: Format) -> Result<Self, ExchangeError> {
        let needed = |what, option| ExchangeError::OptionNeeded {
            format,
            what,
            option,
        };
        let size = options
            .size
            .ok_or_else(|| needed("the size of its pictures", "--size WIDTHxHEIGHT"))?;
        let zoom = options
            .zoom
            .as_ref()
            .ok_or_else(|| needed("what its zoom value means", "--zoom"))?;
        if *zoom == Zoom::FocalMmX100 && options.sensor_width_mm.is_none() {
            return Err(needed("how wide the sensor is", "--sensor-mm"));
        }
        Ok(Self {
            size,
            zoom,
            sensor_mm: options.sensor_width_mm,
        })
    }
}

/// The numbers of a packet: pan (to the right), tilt, roll in degrees; x, y, height in m; zoom.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    angles_deg: [f64; 3],
    position_m: Vec3,
    zoom_raw: f64,
}

impl Sample {
    fn of(
        pinhole: &Pinhole,
        size: ImageSize,
        zoom: &Zoom,
        sensor_mm: Option<f64>,
    ) -> Result<Self, String> {
        let [pan, tilt, roll] = angles_deg(&pinhole.cam_from_world);
        let zoom_raw = zoom.raw(pinhole.focal_px, size, sensor_mm)?;
        Ok(Self {
            // FreeD's pan is positive to the right.
            angles_deg: [-pan, tilt, roll],
            position_m: pinhole.position_m,
            zoom_raw,
        })
    }

    fn pinhole(&self, reading: Reading<'_>) -> Result<Pinhole, Problem> {
        let [pan, tilt, roll] = self.angles_deg;
        let pinhole = Pinhole {
            cam_from_world: cam_from_world([-pan, tilt, roll]),
            position_m: self.position_m,
            focal_px: reading
                .zoom
                .focal_px(self.zoom_raw, reading.size, reading.sensor_mm)?,
            principal_point: reading.size.centre(),
            lens: Radial::default(),
        };
        pinhole.checked("the camera")
    }

    fn packet(&self) -> Result<[u8; PACKET], String> {
        let mut bytes = [0; PACKET];
        (bytes[0], bytes[1]) = (D1, CAMERA);
        let places = self
            .position_m
            .iter()
            .map(|metres| (metres * PER_METRE, "m"));
        let steps = self
            .angles_deg
            .iter()
            .map(|degrees| (degrees * PER_DEGREE, "°"))
            .chain(places);
        for (index, (value, unit)) in steps.enumerate() {
            let value = value.round();
            if !(value.abs() <= MAX_S24) {
                return Err(format!(
                    "{value} steps ({unit}) are more than 24 bits hold (±131 m)"
                ));
            }
            bytes[2 + 3 * index..5 + 3 * index].copy_from_slice(&(value as i32).to_be_bytes()[1..]);
        }
        bytes[20..23].copy_from_slice(&(self.zoom_raw as u32).to_be_bytes()[1..]);
        bytes[PACKET - 1] = checksum(&bytes);
        Ok(bytes)
    }

    fn from_packet(packet: &[u8]) -> Result<Self, Problem> {
        let wrong = |found: String| Problem::NotFormat {
            wanted: "a FreeD D1 packet",
            found,
        };
        if packet.len() != PACKET {
            return Err(wrong(format!("{} bytes are left at the end", packet.len())));
        }
        if packet[0] != D1 {
            return Err(wrong(format!("it begins with {:#04x}", packet[0])));
        }
        let sum = checksum(packet);
        if sum != packet[PACKET - 1] {
            return Err(wrong(format!(
                "the checksum is {:#04x}, not {sum:#04x}",
                packet[PACKET - 1]
            )));
        }
        // A big-endian signed number of 24 bits: shifted to the top of 32 bits and back, which
        // extends the sign.
        let signed = |at: usize| {
            let [a, b, c] = [packet[at], packet[at + 1], packet[at + 2]];
            f64::from(i32::from_be_bytes([a, b, c, 0]) >> 8)
        };
        Ok(Self {
            angles_deg: [2, 5, 8].map(|at| signed(at) / PER_DEGREE),
            position_m: Vec3::new(signed(11), signed(14), signed(17)) / PER_METRE,
            zoom_raw: f64::from(u32::from_be_bytes([0, packet[20], packet[21], packet[22]])),
        })
    }
}

/// 0x40 less all bytes but the last.
fn checksum(packet: &[u8]) -> u8 {
    packet[..PACKET - 1]
        .iter()
        .fold(CHECKSUM, |sum, byte| sum.wrapping_sub(*byte))
}

/// What both formats keep: a pinhole whose focal length corresponds to a whole zoom value.
fn hold(
    frame: &FrameCamera,
    index: usize,
    context: &WriteContext<'_>,
) -> Result<FrameCamera, String> {
    let (pinhole, size) = parts(frame)?;
    let (zoom, sensor) = (&context.options.zoom, context.options.sensor_width_mm);
    let raw = zoom.raw(pinhole.focal_px, size, sensor)?;
    let focal_px = zoom
        .focal_px(raw, size, sensor)
        .map_err(|problem| problem.to_string())?;
    Ok(with(
        frame,
        format!("{index:06}"),
        Pinhole {
            focal_px,
            ..plain(&pinhole, size)
        },
    ))
}

fn samples(
    held: &[FrameCamera],
    context: &WriteContext<'_>,
    format: Format,
) -> Result<Vec<Sample>, ExchangeError> {
    let one = |frame: &FrameCamera| {
        let sample = parts(frame).and_then(|(pinhole, size)| {
            if Some(size) != held.first().and_then(|first| first.size) {
                return Err(
                    "its picture size differs from the first one's; export one camera at a time"
                        .to_owned(),
                );
            }
            Sample::of(
                &pinhole,
                size,
                &context.options.zoom,
                context.options.sensor_width_mm,
            )
        });
        sample.map_err(|why| ExchangeError::CannotHold {
            frame: frame.name.clone(),
            format,
            why,
        })
    };
    held.iter().map(one).collect()
}

fn zoom_note(context: &WriteContext<'_>) -> String {
    let meaning = match context.options.zoom {
        Zoom::FocalPx => "the focal length in whole px",
        Zoom::FocalMmX100 => "the focal length in mm × 100",
        Zoom::Table(_) => "by the given table",
    };
    format!("the zoom value is {meaning}; tell whoever reads it")
}

impl CameraFormat for FreeD {
    fn hold(
        &self,
        frame: &FrameCamera,
        index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        hold(frame, index, context)
    }

    fn resolution_px(&self, held: &FrameCamera) -> f64 {
        EXACT_PX
            + held
                .pinhole()
                .map_or(0.0, |pinhole| STEP_RAD * pinhole.focal_px)
    }

    fn exactness(&self) -> Exactness {
        Exactness {
            angle_rad: 6e-7,
            place_m: 1e-6,
        }
    }

    fn notes(&self, _frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        vec![zoom_note(context)]
    }

    fn write(
        &self,
        held: &[FrameCamera],
        context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut bytes = Vec::with_capacity(PACKET * held.len());
        for (sample, frame) in samples(held, context, Format::FreeD)?.into_iter().zip(held) {
            let cannot = |why| ExchangeError::CannotHold {
                frame: frame.name.clone(),
                format: Format::FreeD,
                why,
            };
            bytes.extend(sample.packet().map_err(cannot)?);
        }
        Ok(Files::one("camera.freed", bytes))
    }

    fn wanted(&self) -> &'static str {
        "packets (.freed)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "freed") || has_ending(name, "bin")
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let sorted = files.sorted();
        let packets = sorted
            .iter()
            .flat_map(|(_, bytes)| bytes.chunks_exact(PACKET));
        second_camera_note(&packets.map(|packet| packet[1].to_string()).collect())
            .into_iter()
            .collect()
    }

    fn read(
        &self,
        files: &Files,
        options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        let reading = Reading::of(options, Format::FreeD)?;
        let mut count = 0;
        files.read_all(|_, bytes| {
            if bytes.is_empty() {
                return Err(Problem::Empty);
            }
            refuse_archive(bytes)?;
            let frame = |(index, packet): (usize, &[u8])| {
                let pinhole =
                    Sample::from_packet(packet).and_then(|sample| sample.pinhole(reading));
                let pinhole = pinhole.map_err(|problem| problem.at_packet(index + 1))?;
                count += 1;
                Ok(FrameCamera::new(
                    &format!("{:06}", count - 1),
                    Some(reading.size),
                    Shown::Camera(pinhole),
                ))
            };
            bytes
                .chunks(PACKET)
                .enumerate()
                .map(frame)
                .collect::<Result<Vec<_>, _>>()
        })
    }
}

/// A note if a stream contains several cameras: the frames of all of them are numbered in one
/// sequence.
fn second_camera_note(ids: &BTreeSet<String>) -> Option<String> {
    (ids.len() > 1).then(|| {
        let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
        format!(
            "camera ids {} are in one stream and are not told apart; import one camera at a time",
            ids.join(", ")
        )
    })
}

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

fn read_row(row: Row<'_>, reading: Reading<'_>, name: &str) -> Result<FrameCamera, Problem> {
    let place = |column| row.number(column).map(|mm| mm / 1000.0);
    let sample = Sample {
        angles_deg: [
            row.number("pan_deg")?,
            row.number("tilt_deg")?,
            row.number("roll_deg")?,
        ],
        position_m: Vec3::new(place("x_mm")?, place("y_mm")?, place("height_mm")?),
        zoom_raw: row.number("zoom_raw")?,
    };
    let pinhole = sample
        .pinhole(reading)
        .map_err(|problem| problem.at_line(row.line()))?;
    let frame = FrameCamera::new(name, Some(reading.size), Shown::Camera(pinhole));
    Ok(FrameCamera {
        frame_index: row.frame_index()?,
        pts_s: row.find("pts_s")?,
        ..frame
    })
}

impl CameraFormat for FreeDCsv {
    fn hold(
        &self,
        frame: &FrameCamera,
        index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        hold(frame, index, context)
    }

    fn notes(&self, _frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        vec![zoom_note(context)]
    }

    fn write(
        &self,
        held: &[FrameCamera],
        context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut text = String::new();
        push_row(&COLUMNS.map(ToOwned::to_owned), &mut text);
        for (sample, frame) in samples(held, context, Format::FreeDCsv)?
            .into_iter()
            .zip(held)
        {
            let timecode = context.timecode(frame).map(|timecode| timecode.to_string());
            let numbers = sample
                .angles_deg
                .into_iter()
                .chain(sample.position_m.iter().map(|metres| metres * 1000.0));
            let mut row = vec![
                frame
                    .frame_index
                    .map(|index| index.to_string())
                    .unwrap_or_default(),
                frame.pts_s.map(|pts| pts.to_string()).unwrap_or_default(),
                timecode.unwrap_or_default(),
                CAMERA.to_string(),
            ];
            row.extend(
                numbers
                    .chain([sample.zoom_raw, 0.0])
                    .map(|number| number.to_string()),
            );
            push_row(&row, &mut text);
        }
        Ok(Files::one("camera.csv", text.into_bytes()))
    }

    fn wanted(&self) -> &'static str {
        "table (.csv)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "csv")
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let mut ids = BTreeSet::new();
        for table in files
            .sorted()
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

    fn read(
        &self,
        files: &Files,
        options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        let reading = Reading::of(options, Format::FreeDCsv)?;
        let mut count = 0;
        files.read_all(|_, bytes| {
            let table = Table::read(bytes)?;
            table.needs(&COLUMNS[4..11])?;
            let frame = |row| {
                count += 1;
                read_row(row, reading, &format!("{:06}", count - 1))
            };
            table.rows().map(frame).collect::<Result<Vec<_>, _>>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::tests::{SIZE, awkward, exported, reference, text_of};

    #[test]
    fn the_reference_camera_is_the_published_packet() {
        let exported = exported(&reference(), Format::FreeD);
        let packet = exported.files.get("camera.freed").unwrap();
        let hex: Vec<String> = packet.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(
            hex.join(" "),
            "d1 01 06 40 00 fa 66 66 00 00 00 00 00 00 c5 68 00 11 94 00 00 09 6a 00 00 00 00 00 1d"
        );
        assert!(exported.worst_px < 2e-3, "{}", exported.worst_px);
    }

    #[test]
    fn a_captured_packet_is_read_as_published() {
        let mut packet = vec![0xd1, 0x00, 0xdf, 0x78, 0xaa, 0x00, 0x47, 0xef];
        packet.extend([0; 12]);
        packet.extend([0x00, 0x40, 0x00, 0x00, 0x15, 0x01, 0xd1, 0xff, 0x12]);
        let sample = Sample::from_packet(&packet).unwrap();
        assert!(
            (sample.angles_deg[0] + 65.05731).abs() < 1e-5
                && (sample.angles_deg[1] - 0.56198).abs() < 1e-5
        );
        assert_eq!(sample.zoom_raw, 16384.0);
    }

    #[test]
    fn awkward_cameras_come_back_within_half_a_step() {
        let exported = exported(&awkward(), Format::FreeD);
        assert!(exported.worst_px < 7e-3, "{}", exported.worst_px);
        let table = super::super::tests::exported(&awkward(), Format::FreeDCsv);
        assert!(table.worst_px < 1e-6, "{}", table.worst_px);
        assert!(
            text_of(&table.files, "camera.csv")
                .lines()
                .nth(1)
                .unwrap()
                .starts_with("412,16.48,00:00:16:12,1,")
        );
    }

    #[test]
    fn the_zoom_follows_a_table_either_way() {
        let zoom = Zoom::Table(vec![(0.0, 1000.0), (4096.0, 9192.0)]);
        assert_eq!(zoom.raw(3048.0, SIZE, None), Ok(1024.0));
        assert_eq!(zoom.focal_px(1024.0, SIZE, None), Ok(3048.0));
        assert!(zoom.raw(900.0, SIZE, None).is_err() && zoom.focal_px(5000.0, SIZE, None).is_err());
        assert_eq!(Zoom::FocalMmX100.raw(2410.0, SIZE, Some(9.6)), Ok(1205.0));
    }

    #[test]
    fn damaged_streams_are_named_in_one_line() {
        let good = exported(&reference(), Format::FreeD)
            .files
            .get("camera.freed")
            .unwrap()
            .to_vec();
        let with = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            bytes
        };
        let options = ImportOptions {
            size: Some(SIZE),
            zoom: Some(Zoom::FocalPx),
            ..ImportOptions::default()
        };
        let read = |bytes: Vec<u8>, options: &ImportOptions| {
            FreeD
                .read(&Files::one("a.freed", bytes), options)
                .unwrap_err()
                .to_string()
        };
        let wanted = "not a FreeD D1 packet:";
        assert_eq!(read(Vec::new(), &options), "a.freed: the file is empty");
        assert_eq!(
            read(with(0, 0xd0), &options),
            format!("a.freed: packet 1: {wanted} it begins with 0xd0")
        );
        assert_eq!(
            read(with(28, 0), &options),
            format!("a.freed: packet 1: {wanted} the checksum is 0x00, not 0x1d")
        );
        let long = [good.clone(), vec![1, 2]].concat();
        assert_eq!(
            read(long, &options),
            format!("a.freed: packet 2: {wanted} 2 bytes are left at the end")
        );
        let silent = ImportOptions {
            zoom: None,
            ..options.clone()
        };
        assert_eq!(
            read(good.clone(), &silent),
            "freed does not say what its zoom value means; give --zoom"
        );
        let silent = ImportOptions {
            size: None,
            ..options
        };
        assert_eq!(
            read(good, &silent),
            "freed does not say the size of its pictures; give --size WIDTHxHEIGHT"
        );
    }

    #[test]
    fn a_camera_beyond_the_range_is_an_error() {
        let mut document = reference();
        document.cameras[0].position_m = Some(Vec3::new(0.0, -140.0, 18.0));
        let error = crate::exchange::export(
            document.at(std::path::Path::new("/")),
            Format::FreeD,
            &crate::exchange::ExportOptions::default(),
        );
        let said = error.unwrap_err().to_string();
        assert_eq!(
            said,
            "000000 cannot be written as freed: -8960000 steps (m) are more than 24 bits hold (±131 m)"
        );
    }

    #[test]
    fn a_second_camera_of_a_stream_is_named() {
        let files = exported(&reference(), Format::FreeD).files;
        let mut bytes = files.get("camera.freed").unwrap().to_vec();
        assert_eq!(FreeD.unread(&files), [""; 0]);
        let mut second = bytes.clone();
        second[1] = 2;
        second[PACKET - 1] = checksum(&second);
        bytes.extend(second);
        let said = FreeD.unread(&Files::one("a.freed", bytes)).concat();
        assert!(
            said.starts_with("camera ids 1, 2 are in one stream"),
            "{said}"
        );
    }
}
