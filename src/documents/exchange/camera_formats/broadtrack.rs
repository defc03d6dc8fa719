//! `BroadTrack`'s JSON: an object with a camera for each picture (WACV 2025).
//!
//! World, angles and their order are `SoccerNet`'s. The focal length is a horizontal field of view,
//! the principal point always the middle, and a distortion coefficient is `k · (height / f)^(2 i)`,
//! three at most. Pictures are found by the file's name, so names must be unique; a public reader
//! drops entries with a `score` below 0.3. Source: `evs-broadcast/BroadTrack`, formats of its files
//! only.

use super::soccernet::{
    SOCCERNET_WORLD, angles_deg, flip_point, flip_rotation, pitch_note, rotation_of,
};
use crate::document::FrameStatus;
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, WriteContext, file_name_of,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole, Record};
use crate::exchange::cameras::held::{parts, with};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse, safe_path};
use crate::exchange::syntax::values::coefficient;
use serde_json::{Map, Value, json};
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, Vec3};

/// The format.
pub struct BroadTrack;

/// (height / f)²: the factor from k₁ to their first distortion coefficient; its square is that of
/// k₂.
fn unit(pinhole: &Pinhole, size: ImageSize) -> f64 {
    (f64::from(size.height) / pinhole.focal_px).powi(2)
}

fn to_json(frame: &FrameCamera, pinhole: &Pinhole, size: ImageSize) -> Value {
    // SoccerNet's axes and angles.
    let [pan, tilt, roll] = angles_deg(&flip_rotation(&pinhole.cam_from_world));
    let position = flip_point(pinhole.position_m);
    let Radial { k1, k2, .. } = pinhole.lens;
    let (width, unit) = (f64::from(size.width), unit(pinhole, size));
    // Readers take the terms that the list has, up to three.
    let coefficients = if k2 == 0.0 {
        vec![k1 * unit]
    } else {
        vec![k1 * unit, k2 * unit * unit]
    };
    // Public readers drop entries with a low score. What a person accepted must not be among them,
    // and a frame without a stated confidence counts as sure.
    let is_reference = frame.record.status == FrameStatus::Reference;
    let score = if is_reference {
        1.0
    } else {
        frame.record.confidence.unwrap_or(1.0)
    };
    json!({
        "cp": {
            "sensorResolutionWidthPixels": width,
            "sensorResolutionHeightPixels": f64::from(size.height),
            "horizontalFieldOfViewDegrees": 2.0 * (width / 2.0).atan2(pinhole.focal_px).to_degrees(),
            "panDegrees": pan,
            "tiltDegrees": tilt,
            "rollDegrees": roll,
            "positionXMeters": position.x,
            "positionYMeters": position.y,
            "positionZMeters": position.z,
            "normalizedRadialDistortionCoefficients": coefficients,
        },
        "score": score,
        "time": 0.0,
        "reinit": false,
    })
}

fn from_json(name: &str, node: &Node<'_>) -> Result<FrameCamera, Problem> {
    let camera = node.key("cp")?;
    let size = camera.size_at(
        "sensorResolutionWidthPixels",
        "sensorResolutionHeightPixels",
    )?;
    let view = camera.key("horizontalFieldOfViewDegrees")?.positive()?;
    // Towards 180° the focal length goes to zero; written so that NaN is refused.
    if !(view < 179.0) {
        let what = format!("[{name:?}].cp.horizontalFieldOfViewDegrees");
        return Err(Problem::out_of_range(what, view, "below 179"));
    }
    let angles = camera.angles_at(["panDegrees", "tiltDegrees", "rollDegrees"])?;
    let position = camera.numbers_at(["positionXMeters", "positionYMeters", "positionZMeters"])?;
    // The field of view spans the width, symmetrically: f = (width / 2) / tan(view / 2).
    let mut pinhole = Pinhole {
        cam_from_world: flip_rotation(&rotation_of(angles)),
        position_m: flip_point(Vec3::from(position)),
        focal_px: f64::from(size.width) / 2.0 / (view / 2.0).to_radians().tan(),
        principal_point: size.centre(),
        lens: Radial::default(),
    };
    let terms = camera
        .find("normalizedRadialDistortionCoefficients")
        .map(|node| node.all_numbers())
        .transpose()?;
    let terms = terms.unwrap_or_default();
    if terms.iter().skip(2).any(|term| *term != 0.0) {
        let what = "a third distortion coefficient".to_owned();
        return Err(Problem::not_supported(
            what,
            "the document's lens has k1 and k2 only",
        ));
    }
    // The unit of the coefficients depends on the focal length, which is known only now.
    let unit = unit(&pinhole, size);
    pinhole.lens = Radial {
        k1: coefficient(&terms, 0) / unit,
        k2: coefficient(&terms, 1) / (unit * unit),
        ..Radial::default()
    };
    // Required: the program's own reader stops at a file without it.
    let score = node.key("score")?.number()?;
    let mut frame = FrameCamera::new(
        name,
        Some(size),
        FrameProjection::Camera(pinhole.validate("the camera")?),
    );
    frame.image = Some(safe_path(name)?);
    frame.record = Record {
        confidence: Some(score.clamp(0.0, 1.0)),
        ..Record::default()
    };
    Ok(frame)
}

impl CameraFormat for BroadTrack {
    fn about(&self) -> About {
        About {
            name: "broadtrack",
            title: "BroadTrack cameras, one JSON file",
            conventions: SOCCERNET_WORLD,
            users: "BroadTrack, pipelines with cached calibrations",
            loses: Some("an off-centre principal point, time, uncertainty"),
            file: Some("broadtrack.json"),
            files: "camera file (.json)",
            endings: &["json"],
            export_options: format_options::CAMERAS_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let (pinhole, size) = parts(frame)?;
        Ok(with(
            frame,
            file_name_of(frame),
            Pinhole {
                principal_point: size.centre(),
                lens: Radial {
                    pixel_aspect: 1.0,
                    ..pinhole.lens
                },
                ..pinhole
            },
        ))
    }

    fn notes(&self, _frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        pitch_note(context).into_iter().collect()
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut all = Map::new();
        for frame in held {
            if let Ok((pinhole, size)) = parts(frame) {
                all.insert(frame.name.clone(), to_json(frame, &pinhole, size));
            }
        }
        Ok(Files::one(
            "broadtrack.json",
            format!("{:#}\n", Value::Object(all)).into_bytes(),
        ))
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|_, bytes| {
            let value = parse(bytes)?;
            let mut frames = FrameCollector::default();
            for (name, node) in Node::root(&value).entries()? {
                frames.add(name, None, from_json(name, &node));
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
    use crate::exchange::Format;
    use crate::exchange::tests::{awkward, export_as, reference, text_of};

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let text = text_of(
            &export_as(&reference(), Format::BroadTrack).files,
            "broadtrack.json",
        );
        let all: Value = serde_json::from_str(&text).unwrap();
        let camera = &all["0001.jpg"]["cp"];
        assert!(
            (camera["horizontalFieldOfViewDegrees"].as_f64().unwrap() - 43.43876531380934).abs()
                < 1e-12
        );
        let coefficient = camera["normalizedRadialDistortionCoefficients"][0]
            .as_f64()
            .unwrap();
        assert!((coefficient - 0.013274399545462374).abs() < 1e-15);
        assert_eq!(all["0001.jpg"]["score"], 1.0);
    }

    #[test]
    fn an_off_centre_principal_point_is_lost_and_said_so() {
        let exported = export_as(&awkward(), Format::BroadTrack);
        assert!(exported.worst_px < 1e-6);
        let loss = exported.loss.unwrap();
        assert_eq!(
            (loss.what.as_slice(), loss.frames),
            (["the principal point"].as_slice(), 12)
        );
        assert!(loss.rms_px > 8.0 && loss.rms_px < 15.0, "{loss}");
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good = text_of(
            &export_as(&reference(), Format::BroadTrack).files,
            "broadtrack.json",
        );
        let swap = |from: &str, to: &str| good.replacen(from, to, 1);
        for (text, wanted) in [
            (
                "[]".to_owned(),
                "the file: an object is expected, found a list of 0",
            ),
            (
                swap("0001.jpg", "../0001.jpg"),
                "the path \"../0001.jpg\" points outside the folder",
            ),
            (
                swap("\"score\"", "\"scores\""),
                "[\"0001.jpg\"].score is missing",
            ),
            (swap("\"cp\"", "\"camera\""), "[\"0001.jpg\"].cp is missing"),
            (
                swap("1920.0", "1920.5"),
                "[\"0001.jpg\"].cp.sensorResolutionWidthPixels is 1920.5, which must be a whole number from 1 to 65535",
            ),
            (
                swap("43.43", "-43.43"),
                "[\"0001.jpg\"].cp.horizontalFieldOfViewDegrees is -43.43876531380934, which must be above 0",
            ),
            (
                swap("43.43", "243.43"),
                "[\"0001.jpg\"].cp.horizontalFieldOfViewDegrees is 243.43876531380934, which must be below 179",
            ),
            (
                swap("60.0", "\"far\""),
                "[\"0001.jpg\"].cp.positionYMeters: a number is expected, found the text \"far\"",
            ),
        ] {
            let files = Files::one("a.json", text.into_bytes());
            let error = BroadTrack
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.json: {wanted}"));
        }
    }
}
