//! The stream: packets, back to back.

use super::sample::{PACKET, Sample};
use super::{Reading, hold, notes, samples, second_camera_note};
use crate::exchange::cameras::camera_format::{
    CameraFormat, EXACT_PX, HeldFrame, SequenceScope, WriteContext,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::held::{cannot_hold, note_lost_gaps};
use crate::exchange::cameras::into_document::Exactness;
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, refuse_archive};
use crate::exchange::format::{About, Format};
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;

/// Packets.
pub struct FreeD;

/// The rounding of three angles and of a position seen from two metres, half a step each, rad.
const STEP_RAD: f64 = 8e-6;

/// The packets of a stream. Bytes that were lost on the way cost the packet that they are missing
/// in, not all behind it.
fn split_packets(bytes: &[u8]) -> Vec<&[u8]> {
    let mut packets = Vec::with_capacity(bytes.len() / PACKET + 1);
    let mut rest = bytes;
    while !rest.is_empty() {
        // A damaged packet ends where the next whole one begins, which is at its own end unless
        // bytes are missing.
        let is_packet = |at: usize| {
            let packet = rest.get(at..at + PACKET);
            packet.is_some_and(|packet| Sample::from_packet(packet).is_ok())
        };
        let end = if is_packet(0) || is_packet(PACKET) {
            PACKET
        } else {
            (1..PACKET).find(|at| is_packet(*at)).unwrap_or(PACKET)
        };
        let (packet, others) = rest.split_at(end.min(rest.len()));
        packets.push(packet);
        rest = others;
    }
    packets
}

impl CameraFormat for FreeD {
    fn about(&self) -> About {
        About {
            name: "freed",
            title: "FreeD D1 packets, back to back",
            conventions: "pan right positive, 1/32768°, 1/64 mm; zoom in raw steps",
            users: "virtual studios, Unreal LiveLink, Vizrt",
            loses: Some(
                "lens, principal point, size, time; steps of 1/32768° and 1/64 mm, whole zoom values",
            ),
            file: Some("camera.freed"),
            files: "packets (.freed)",
            endings: &["freed", "bin"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::SensorMm,
                FormatOption::Zoom,
                FormatOption::StageOrigin,
                FormatOption::StageHeading,
            ],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::Zoom,
                FormatOption::SensorMm,
            ],
        }
    }

    fn hold(&self, frame: &FrameCamera, index: usize, context: &WriteContext<'_>) -> HeldFrame {
        hold(frame, index, context)
    }

    fn resolution_px(&self, held: &FrameCamera) -> f64 {
        let Some((pinhole, size)) = held.pinhole().zip(held.size) else {
            return EXACT_PX;
        };
        // A turn moves a point by f (1 + r²), with r on normalised coordinates; points are compared
        // up to a picture's size beyond the border (`farthest_landmark`).
        let diagonal_px = f64::from(size.width).hypot(f64::from(size.height));
        let farthest = 1.5 * diagonal_px / pinhole.focal_px;
        EXACT_PX + STEP_RAD * pinhole.focal_px * (1.0 + farthest.powi(2))
    }

    fn exactness(&self) -> Exactness {
        // More than two roundings by half a step of 1/32768°, which is 2.7e-7 rad. A camera that
        // stays in its place is rounded to the same step in every packet.
        Exactness {
            angle_rad: 6e-7,
            place_m: 1e-6,
        }
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let mut notes = notes(frames, context);
        notes.extend(note_lost_gaps(frames));
        notes
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::All)
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut bytes = Vec::with_capacity(PACKET * held.len());
        for (sample, frame) in samples(held, context, Format::FreeD)?.into_iter().zip(held) {
            let packet = sample.packet();
            bytes.extend(packet.map_err(|why| cannot_hold(frame, Format::FreeD, why))?);
        }
        Ok(Files::one("camera.freed", bytes))
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        // The second byte is the camera's number.
        let sorted = files.sorted_entries();
        let packets = sorted
            .iter()
            .flat_map(|(_, bytes)| bytes.chunks_exact(PACKET));
        second_camera_note(&packets.map(|packet| packet[1].to_string()).collect())
            .into_iter()
            .collect()
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let reading = Reading::from_options(options, Format::FreeD)?;
        // Packets have no number: frames are counted over all files, in their natural order.
        let mut count = 0;
        files.read_all(|_, bytes| {
            if bytes.is_empty() {
                return Err(Problem::Empty);
            }
            refuse_archive(bytes)?;
            let mut frames = FrameCollector::default();
            for (index, packet) in split_packets(bytes).into_iter().enumerate() {
                let name = format!("{count:06}");
                let pinhole = Sample::from_packet(packet)
                    .and_then(|sample| sample.pinhole(reading))
                    .map_err(|problem| problem.at_packet(index + 1));
                let frame = pinhole.map(|pinhole| {
                    let shown = FrameProjection::Camera(pinhole);
                    FrameCamera::new(&name, Some(reading.size), shown)
                });
                frames.add(&name, None, frame);
                count += 1;
                if frames.has_only_damaged() {
                    break;
                }
            }
            frames.finish()
        })
    }
}
