//! Writes one sample of `OpenTrackIO`: timing, lens and pose, and in some samples the static part,
//! which is repeated so that a reader may begin anywhere.

use super::sample_reading::name_in_notes;
use super::{MAX_NOTES, MODEL, NAME_KEY, NOMINAL_MM, NOMINAL_NOTE, OWN_NOTES};
use crate::document::SolutionSource;
use crate::exchange::cameras::body_angles::angles_deg;
use crate::exchange::cameras::camera_format::WriteContext;
use crate::exchange::cameras::frame_camera::{FrameCamera, Pinhole};
use crate::exchange::rate::Rate;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, hex};

/// A reproducible id, from a hash of what it identifies.
fn urn(of: &str) -> String {
    // A random id would change with each export of the same document. The schema wants the form of
    // a UUID in small letters, not its version bits.
    let digest = hex(&Sha256::digest(of.as_bytes()));
    format!(
        "urn:uuid:{}-{}-{}-{}-{}",
        &digest[..8],
        &digest[8..12],
        &digest[12..16],
        &digest[16..20],
        &digest[20..32]
    )
}

fn rational(rate: Rate) -> Value {
    json!({ "num": rate.frames, "denom": rate.seconds })
}

/// The nearest fraction of whole numbers that the schema allows, numerator and denominator, of a
/// number between 1/4 and 4, by its continued fraction.
fn nearest_fraction(number: f64) -> [u64; 2] {
    /// The largest numerator in the schema.
    const MOST: f64 = 2_147_483_647.0;
    let ([mut before, mut now], mut rest) = ([[0.0, 1.0], [1.0, 0.0]], number);
    loop {
        let whole = rest.floor();
        let next = [0, 1].map(|part| whole * now[part] + before[part]);
        if next.iter().any(|part| *part > MOST) {
            break;
        }
        (before, now) = (now, next);
        if now[0] / now[1] == number {
            break;
        }
        // Exact numbers end above; a rest of 0 that rounding leaves ends with an infinite term.
        rest = (rest - whole).recip();
    }
    now.map(|part| part as u64)
}

pub(super) fn static_part(
    frame: &FrameCamera,
    size: ImageSize,
    sensor_mm: f64,
    (rate, squeeze): (Option<Rate>, Option<f64>),
) -> Value {
    let mut camera = json!({
        "label": frame.camera.as_deref().filter(|label| !label.is_empty()).unwrap_or("main"),
        "activeSensorPhysicalDimensions": {
            "width": sensor_mm,
            "height": sensor_mm * f64::from(size.height) / f64::from(size.width),
        },
        "activeSensorResolution": { "width": size.width, "height": size.height },
    });
    if let Some(rate) = rate {
        camera["captureFrameRate"] = rational(rate);
    }
    if let Some(squeeze) = squeeze {
        let [num, denom] = nearest_fraction(squeeze);
        camera["anamorphicSqueeze"] = json!({ "num": num, "denom": denom });
    }
    json!({ "camera": camera })
}

pub(super) fn timing(frame: &FrameCamera, context: &WriteContext<'_>) -> Option<Value> {
    let (index, rate, code) = (
        frame.frame_index?,
        context.rate_of(frame)?,
        context.timecode(frame)?,
    );
    Some(json!({
        "mode": "external",
        "sampleRate": rational(rate),
        "sequenceNumber": index,
        "timecode": {
            "hours": code.hours,
            "minutes": code.minutes,
            "seconds": code.seconds,
            "frames": code.frames,
            "frameRate": rational(rate),
            "dropFrame": code.is_drop_frame,
        },
    }))
}

pub(super) fn lens(pinhole: &Pinhole, size: ImageSize, sensor_mm: f64) -> Value {
    // The coefficients act on mm from the centre of projection, ours on x / z = mm / F: k1 r² = (k1
    // / F²) (F r)².
    let mm_per_px = sensor_mm / f64::from(size.width);
    // Px to mm by the sensor's pixel pitch. The offset is that of the principal point from the
    // picture's middle, positive to the right and down as ours.
    let Radial {
        k1,
        k2,
        pixel_aspect,
    } = pinhole.lens;
    // The stated focal length is that down the picture, where nothing is squeezed.
    let (focal, offset) = (
        pinhole.focal_px * pixel_aspect * mm_per_px,
        pinhole.principal_point.offset_from(size.centre()) * mm_per_px,
    );
    json!({
        "pinholeFocalLength": focal,
        "projectionOffset": { "x": offset.x, "y": offset.y },
        "entrancePupilOffset": 0.0,
        "distortion": [{ "model": MODEL, "radial": [k1 / focal.powi(2), 0.0, k2 / focal.powi(4), 0.0] }],
    })
}

pub(super) fn sample(
    frame: &FrameCamera,
    pinhole: &Pinhole,
    size: ImageSize,
    context: &WriteContext<'_>,
) -> Value {
    let given = context.options.sensor_width_mm;
    let sensor_mm = given.unwrap_or(NOMINAL_MM);
    let [pan, tilt, roll] = angles_deg(&pinhole.cam_from_world);
    let at = pinhole.position_m;
    let nominal = if given.is_some() { "" } else { NOMINAL_NOTE };
    let camera = frame.camera.as_deref().unwrap_or_default();
    // The notes are for people. A name that they cut, or that could be read as another one, goes
    // into `custom`: the schema lets unknown keys pass at the top level.
    let notes = format!("{OWN_NOTES}{nominal}; {}", frame.name)
        .chars()
        .take(MAX_NOTES)
        .collect::<String>();
    let is_interpolated = frame.record.source == Some(SolutionSource::Interpolated);
    let status = if is_interpolated {
        "interpolated"
    } else {
        frame.record.status.as_str()
    };
    let mut sample = json!({
        "protocol": { "name": "OpenTrackIO", "version": [1, 0, 1] },
        "sampleId": urn(&format!("sample {}", frame.name)),
        "sourceId": urn(&format!("source {camera}")),
        "sourceNumber": 1,
        "tracker": { "status": status, "recording": false, "notes": notes },
    });
    if name_in_notes(&notes) != Some(frame.name.as_str()) {
        sample["custom"] = json!({ NAME_KEY: frame.name });
    }
    if let Some(timing) = timing(frame, context) {
        sample["timing"] = timing;
    }
    sample["lens"] = lens(pinhole, size, sensor_mm);
    sample["transforms"] = json!([{
        "id": "Camera",
        "translation": { "x": at.x, "y": at.y, "z": at.z },
        "rotation": { "pan": pan, "tilt": tilt, "roll": roll },
    }]);
    sample
}
