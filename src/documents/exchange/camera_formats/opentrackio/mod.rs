//! `OpenTrackIO` 1.0.1: one sample per line and frame.
//!
//! World and metres are ours; angles about Z, X, Y with pan positive to the *left*. Focal length,
//! offsets and distortion are in mm of the sensor. Any sensor width gives the same picture as long
//! as it is stated, so an unknown width is written as a nominal 9.6 mm, and the notes say so. The
//! distortion model `Brown-Conrady U-D` equals ours: `radial` = [k1/F², 0, k2/F⁴, 0] (numerator and
//! denominator alternate). Source: SMPTE/ris-osvp-metadata-camdkit (schema and documentation).

mod sample_reading;
mod sample_writing;

use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext};
use crate::exchange::cameras::frame_camera::FrameCamera;
use crate::exchange::cameras::held::parts;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, text};
use crate::exchange::format::{About, FormatOption};
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse};
use sample_reading::{Static, read_line, unread_of_sample};
use sample_writing::{sample, static_part};
use std::collections::BTreeSet;
use touchline_core::geometry::ImageSize;

/// The format.
pub struct OpenTrackIo;

/// The width that is written for an unknown sensor, mm.
const NOMINAL_MM: f64 = 9.6;

/// The interval at which the static part is repeated, s.
const REPEAT_SECONDS: f64 = 2.0;

/// The name of the distortion model that equals ours.
const MODEL: &str = "Brown-Conrady U-D";

/// What the notes of a sample begin with.
const OWN_NOTES: &str = "touchline";

/// What follows in the notes where the sensor's width is not known.
const NOMINAL_NOTE: &str = "; sensor size nominal";

/// The maximum length of the notes, letters; the schema allows 1023.
const MAX_NOTES: usize = 1000;

/// The key in `custom` of the name of a frame that its notes do not hold.
const NAME_KEY: &str = "touchlineFrame";

impl CameraFormat for OpenTrackIo {
    fn about(&self) -> About {
        About {
            name: "opentrackio",
            title: "OpenTrackIO 1.0.1, one sample per line",
            conventions: "touchline's world; pan left positive, order Z X Y; mm on the sensor",
            users: "Unreal 5.6, disguise, Mo-Sys, stYpe",
            loses: Some("uncertainty"),
            file: Some("cameras.jsonl"),
            files: "samples (.jsonl)",
            endings: &["jsonl"],
            options: &[
                FormatOption::Track,
                FormatOption::Sensor,
                FormatOption::Start,
                FormatOption::Stage,
            ],
        }
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let note = context.sensor_width_note(NOMINAL_MM);
        let mut notes: Vec<String> = note.into_iter().collect();
        if frames.iter().any(|frame| context.rate_of(frame).is_none()) {
            notes
                .push("the frame rate is not known, so samples carry no timing (--fps)".to_owned());
        }
        notes
    }

    fn write(
        &self,
        held: &[FrameCamera],
        context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        // Without a rate no interval is known, and each sample has the static part.
        let every = context.rate.map_or(1, |rate| {
            (rate.per_second() * REPEAT_SECONDS).ceil() as usize
        });
        let mut text = String::new();
        let mut last: Option<(&Option<String>, ImageSize)> = None;
        for (index, frame) in held.iter().enumerate() {
            let Ok((pinhole, size)) = parts(frame) else {
                continue;
            };
            let mut sample = sample(frame, &pinhole, size, context);
            // Another camera, or another size, also begins with its own.
            if index % every == 0 || last != Some((&frame.camera, size)) {
                let sensor_mm = context.options.sensor_width_mm.unwrap_or(NOMINAL_MM);
                sample["static"] = static_part(frame, size, sensor_mm, context.rate_of(frame));
            }
            last = Some((&frame.camera, size));
            text.push_str(&sample.to_string());
            text.push('\n');
        }
        Ok(Files::one("camera.jsonl", text.into_bytes()))
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let sorted = files.sorted_entries();
        let lines = sorted
            .iter()
            .filter_map(|(_, bytes)| text(bytes).ok())
            .flat_map(str::lines);
        let mut unread = BTreeSet::new();
        for sample in lines.filter_map(|line| parse(line.as_bytes()).ok()) {
            unread.extend(unread_of_sample(&Node::root(&sample)));
        }
        let unread: Vec<String> = unread.into_iter().collect();
        if unread.is_empty() {
            Vec::new()
        } else {
            vec![format!("not read: {}", unread.join(", "))]
        }
    }

    fn read(
        &self,
        files: &Files,
        options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        let mut count = 0;
        files.read_all(|_, bytes| {
            // The files of a folder are tracks of their own; names without numbers are counted over
            // all of them.
            let mut known = Static::default();
            let lines = text(bytes)?
                .lines()
                .enumerate()
                .filter(|(_, line)| !line.trim().is_empty());
            lines
                .map(|(index, line)| {
                    count += 1;
                    read_line(line, &mut known, options, count - 1)
                        .map_err(|problem| problem.at_line(index + 1))
                })
                .collect::<Result<Vec<_>, _>>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, export_as, reference, text_of};
    use crate::exchange::{ExportOptions, Files, Format};
    use serde_json::{Value, json};
    use std::path::Path;
    use touchline_core::camera::Radial;

    #[test]
    fn what_changes_the_picture_and_is_not_read_is_named() {
        let text = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let unread = |sample: &Value| {
            OpenTrackIo.unread(&Files::one("a.jsonl", sample.to_string().into_bytes()))
        };
        let mut sample: Value = serde_json::from_str(text.trim()).unwrap();
        assert_eq!(unread(&sample), [""; 0]);
        sample["static"]["camera"]["anamorphicSqueeze"] = json!({ "num": 1, "denom": 1 });
        sample["lens"]["distortionOffset"] = json!({ "x": 0.0, "y": 0.0 });
        sample["lens"]["distortionOverscan"] = 1.0.into();
        assert_eq!(unread(&sample), [""; 0], "nothing changes");
        sample["static"]["camera"]["anamorphicSqueeze"] = json!({ "num": 2, "denom": 1 });
        sample["lens"]["distortionOffset"]["x"] = 0.1.into();
        sample["lens"]["distortionOverscan"] = 1.2.into();
        sample["protocol"]["version"] = json!([0, 9, 2]);
        let first = sample["lens"]["distortion"][0].clone();
        sample["lens"]["distortion"] = json!([first, first]);
        let said = unread(&sample).concat();
        for named in [
            "anamorphicSqueeze",
            "distortionOffset",
            "distortionOverscan",
            "version 0.9.2",
            "another distortion",
        ] {
            assert!(said.contains(named), "{named}: {said}");
        }
    }

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let text = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let sample: Value = serde_json::from_str(text.trim()).unwrap();
        assert!((sample["lens"]["pinholeFocalLength"].as_f64().unwrap() - 12.05).abs() < 1e-12);
        let radial = sample["lens"]["distortion"][0]["radial"][0]
            .as_f64()
            .unwrap();
        assert!((radial - 4.552263218608495e-4).abs() < 1e-18);
        let rotation = &sample["transforms"][0]["rotation"];
        assert!(
            (rotation["pan"].as_f64().unwrap() + 12.5).abs() < 1e-12,
            "positive to the left"
        );
        assert!((rotation["tilt"].as_f64().unwrap() + 11.2).abs() < 1e-12);
        assert_eq!(sample["timing"]["timecode"]["frames"], 12);
        assert_eq!(
            sample["timing"]["sampleRate"],
            json!({ "num": 25, "denom": 1 })
        );
    }

    #[test]
    fn awkward_cameras_come_back() {
        let exported = export_as(&awkward(), Format::OpenTrackIo);
        assert!(
            exported.loss.is_none() && exported.worst_px < 1e-6,
            "{exported:?}"
        );
        let text = text_of(&exported.files, "camera.jsonl");
        assert_eq!(
            text.lines()
                .filter(|line| line.contains("\"static\""))
                .count(),
            1,
            "12 frames are half a second"
        );
    }

    #[test]
    fn the_pinhole_is_before_the_sensor_by_its_offset() {
        let text = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let moved = text.replace("\"entrancePupilOffset\":0.0", "\"entrancePupilOffset\":0.5");
        let options = ImportOptions::default();
        let read = |text: &str| {
            *read_line(text.trim(), &mut Static::default(), &options, 0)
                .unwrap()
                .pinhole()
                .unwrap()
        };
        let (before, after) = (read(&text), read(&moved));
        let forward = before.cam_from_world.row(2).transpose();
        assert!((after.position_m - before.position_m - forward * 0.5).norm() < 1e-12);
    }

    #[test]
    fn our_model_is_read_behind_that_of_the_other_direction() {
        let text = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let mut sample: Value = serde_json::from_str(text.trim()).unwrap();
        let ours = sample["lens"]["distortion"][0].clone();
        let mut foreign = ours.clone();
        foreign["model"] = "Brown-Conrady D-U".into();
        sample["lens"]["distortion"] = json!([foreign, ours]);
        let options = ImportOptions::default();
        let [alone, second] = [text.trim().to_owned(), sample.to_string()].map(|line| {
            let read = read_line(&line, &mut Static::default(), &options, 0);
            read.unwrap().pinhole().unwrap().lens
        });
        assert_eq!(second, alone);
        assert_ne!(second, Radial::default());
    }

    #[test]
    fn names_of_frames_come_back_whole() {
        let long = "a".repeat(2000);
        for (name, is_in_notes) in [
            ("left; high; 17", true),
            ("sensor size nominal; 17", true),
            (long.as_str(), false),
        ] {
            let mut document = reference();
            document.frames[0].labels_name = Some(name.to_owned());
            let files = export_as(&document, Format::OpenTrackIo).files;
            let read = OpenTrackIo.read(&files, &ImportOptions::default()).unwrap();
            assert_eq!(read[0].name, name);
            let text = text_of(&files, "camera.jsonl");
            assert_eq!(!text.contains(NAME_KEY), is_in_notes, "{text}");
        }
    }

    #[test]
    fn a_name_leads_out_of_no_folder() {
        let text = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let moved = text.replace("; 0001\"", "; ../../0001\"");
        assert_ne!(moved, text);
        let options = ImportOptions::default();
        let read = read_line(moved.trim(), &mut Static::default(), &options, 0);
        assert_eq!(read.unwrap().name, "0001");
    }

    #[test]
    fn a_name_like_a_note_comes_back_with_a_known_sensor() {
        let mut document = reference();
        document.frames[0].labels_name = Some("sensor size nominal; 17".to_owned());
        let options = ExportOptions {
            sensor_width_mm: Some(9.6),
            ..ExportOptions::default()
        };
        let exported = export(document.at(Path::new("/")), Format::OpenTrackIo, &options).unwrap();
        let read = OpenTrackIo.read(&exported.files, &ImportOptions::default());
        assert_eq!(read.unwrap()[0].name, "sensor size nominal; 17");
    }

    #[test]
    fn damaged_samples_are_named_in_one_line() {
        let good = text_of(
            &export_as(&reference(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let swap = |from: &str, to: &str| {
            assert!(good.contains(from), "{from} in {good}");
            good.replacen(from, to, 1)
        };
        for (text, wanted) in [
            (String::new(), "the file is empty"),
            (
                "{}".to_owned(),
                "line 1: static.camera.activeSensorResolution is missing",
            ),
            (swap("\"lens\"", "\"lense\""), "line 1: lens is missing"),
            (
                swap("\"transforms\"", "\"transform\""),
                "line 1: transforms is missing",
            ),
            (
                swap("\"pan\"", "\"yaw\""),
                "line 1: transforms[0].rotation.pan is missing",
            ),
            (
                swap("\"id\":\"Camera\"", "\"scale\":{\"x\":2}"),
                "line 1: transforms[0].scale cannot be read: cameras have one scale",
            ),
            (
                swap("Brown-Conrady U-D", "Brown-Conrady D-U"),
                "line 1: the model of lens.distortion[0] cannot be read: only Brown-Conrady U-D is read",
            ),
            (
                swap(",0.0,0.0,0.0]}", ",0.5,0.0,0.0]}"),
                "line 1: a coefficient of lens.distortion[0] beyond l1 and l3 cannot be read: the document's lens has k1 and k2 only",
            ),
            (
                swap("\"pinholeFocalLength\":12.05", "\"pinholeFocalLength\":0"),
                "line 1: lens.pinholeFocalLength is 0, which must be above 0",
            ),
            (
                swap("{\"width\":1920", "{\"width\":0"),
                "line 1: static.camera.activeSensorResolution.width is 0, which must be a whole number from 1 to 65535",
            ),
        ] {
            let files = Files::one("a.jsonl", text.into_bytes());
            let error = OpenTrackIo
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.jsonl: {wanted}"));
        }
    }
}
