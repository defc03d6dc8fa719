//! A packet: its numbers, its bytes, and the camera that they describe.

use super::Reading;
use crate::exchange::cameras::body_angles::{angles_deg, cam_from_world};
use crate::exchange::cameras::frame_camera::Pinhole;
use crate::exchange::error::Problem;
use crate::exchange::options::Zoom;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, Vec3};

/// The length of a packet, bytes.
pub(super) const PACKET: usize = 29;
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
/// The camera's number in packets.
pub(super) const CAMERA: u8 = 1;

/// The numbers of a packet: pan (to the right), tilt, roll in degrees; x, y, height in m; zoom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) angles_deg: [f64; 3],
    pub(super) position_m: Vec3,
    pub(super) zoom_raw: f64,
}

impl Sample {
    pub(super) fn from_pinhole(
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

    pub(super) fn pinhole(&self, reading: Reading<'_>) -> Result<Pinhole, Problem> {
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
        pinhole.validate("the camera")
    }

    pub(super) fn packet(&self) -> Result<[u8; PACKET], String> {
        // Byte 0 the type, 1 the camera, 2 to 19 six numbers of three bytes, 20 to 22 the zoom, 23
        // to 25 the focus, 26 and 27 free, 28 the check sum. What is not known stays 0.
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
            // Wrapped around it would be another camera. Angles within ±180° always fit.
            if !(value.abs() <= MAX_S24) {
                return Err(format!(
                    "{value} steps ({unit}) are more than 24 bits hold (±131 m)"
                ));
            }
            // The lower three bytes of a two's complement are that of 24 bits, as the value fits.
            bytes[2 + 3 * index..5 + 3 * index].copy_from_slice(&(value as i32).to_be_bytes()[1..]);
        }
        bytes[20..23].copy_from_slice(&(self.zoom_raw as u32).to_be_bytes()[1..]);
        bytes[PACKET - 1] = checksum(&bytes);
        Ok(bytes)
    }

    pub(super) fn from_packet(packet: &[u8]) -> Result<Self, Problem> {
        if packet.len() != PACKET {
            return Err(not_a_packet(format!(
                "{} bytes are left at the end",
                packet.len()
            )));
        }
        if packet[0] != D1 {
            return Err(not_a_packet(format!("it begins with {:#04x}", packet[0])));
        }
        // A lost byte shifts all that follow; the sum finds it at the first wrong packet.
        let sum = checksum(packet);
        if sum != packet[PACKET - 1] {
            return Err(not_a_packet(format!(
                "the checksum is {:#04x}, not {sum:#04x}",
                packet[PACKET - 1]
            )));
        }
        let position = Vec3::new(
            signed_24(packet, 11),
            signed_24(packet, 14),
            signed_24(packet, 17),
        );
        Ok(Self {
            angles_deg: [2, 5, 8].map(|at| signed_24(packet, at) / PER_DEGREE),
            position_m: position / PER_METRE,
            zoom_raw: f64::from(u32::from_be_bytes([0, packet[20], packet[21], packet[22]])),
        })
    }
}

/// The error that bytes are no packet.
fn not_a_packet(found: String) -> Problem {
    Problem::not_format("a FreeD D1 packet", found)
}

/// The big-endian signed number of 24 bits at a byte of a packet.
fn signed_24(packet: &[u8], at: usize) -> f64 {
    let [a, b, c] = [packet[at], packet[at + 1], packet[at + 2]];
    // Shifted to the top of 32 bits and back, which extends the sign.
    f64::from(i32::from_be_bytes([a, b, c, 0]) >> 8)
}

/// 0x40 less all bytes but the last.
pub(super) fn checksum(packet: &[u8]) -> u8 {
    packet[..PACKET - 1]
        .iter()
        .fold(CHECKSUM, |sum, byte| sum.wrapping_sub(*byte))
}
