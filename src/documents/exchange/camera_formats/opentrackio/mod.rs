//! `OpenTrackIO` 1.0.1: one sample per line and frame. Files of one sample, and lists, are read
//! too.
//!
//! World and metres are ours; angles about Z, X, Y with pan positive to the *left*. Focal length,
//! offsets and distortion are in mm of the sensor. Any sensor width gives the same picture as long
//! as it is stated, so an unknown width is written as a nominal 9.6 mm, and the notes say so. The
//! distortion model `Brown-Conrady U-D` equals ours: `radial` = [k1/F², 0, k2/F⁴, 0] (numerator and
//! denominator alternate). Source: SMPTE/ris-osvp-metadata-camdkit (schema and documentation).

mod lens_law;
mod sample_reading;
mod sample_writing;
mod transforms;

use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext};
use crate::exchange::cameras::frame_camera::FrameCamera;
use crate::exchange::cameras::held::parts;
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::Node;
use crate::exchange::syntax::samples::each_sample;
use sample_reading::{Static, name_of_sample, read_sample, unread_of_sample};
use sample_writing::{sample, static_part};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::ImageSize;

/// The format.
pub struct OpenTrackIo;

/// The width that is written for an unknown sensor, mm.
const NOMINAL_MM: f64 = 9.6;

/// The interval at which the static part is repeated, s.
const REPEAT_SECONDS: f64 = 2.0;

/// The name of the distortion model that equals ours.
const MODEL: &str = "Brown-Conrady U-D";

/// The model of the other direction, which is meant where no model is named.
const INVERSE_MODEL: &str = "Brown-Conrady D-U";

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
            files: "samples (.jsonl, .json)",
            endings: &["jsonl", "json"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::Fps,
                FormatOption::Start,
                FormatOption::SensorMm,
                FormatOption::StageOrigin,
                FormatOption::StageHeading,
            ],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::SensorMm,
                FormatOption::Undistorted,
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

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        // Without a rate no interval is known, and each sample has the static part.
        let every = context.rate.map_or(1, |rate| {
            (rate.per_second() * REPEAT_SECONDS).ceil() as usize
        });
        let mut text = String::new();
        let mut last: Option<(&Option<String>, ImageSize, f64)> = None;
        let is_squeezed = held
            .iter()
            .filter_map(FrameCamera::pinhole)
            .any(|pinhole| pinhole.lens.pixel_aspect != 1.0);
        for (index, frame) in held.iter().enumerate() {
            let Ok((pinhole, size)) = parts(frame) else {
                continue;
            };
            let mut sample = sample(frame, &pinhole, size, context);
            // Another camera, another size, or other pixels also begin with their own.
            let is_of = Some((&frame.camera, size, pinhole.lens.pixel_aspect));
            if index % every == 0 || last != is_of {
                let sensor_mm = context.options.sensor_width_mm.unwrap_or(NOMINAL_MM);
                let squeeze = is_squeezed.then_some(pinhole.lens.pixel_aspect);
                let rate = context.rate_of(frame);
                sample["static"] = static_part(frame, size, sensor_mm, (rate, squeeze));
            }
            last = is_of;
            text.push_str(&sample.to_string());
            text.push('\n');
        }
        Ok(Files::one("camera.jsonl", text.into_bytes()))
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let mut unread = BTreeSet::new();
        for (_, bytes) in files.sorted_entries() {
            // What is damaged was named when it was read.
            let _ = each_sample(bytes, |_, sample| {
                unread.extend(unread_of_sample(&Node::root(&sample?)));
                Ok(())
            });
        }
        let unread: Vec<String> = unread.into_iter().collect();
        if unread.is_empty() {
            Vec::new()
        } else {
            vec![format!("not read: {}", unread.join(", "))]
        }
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let sorted = files.sorted_entries();
        // The static part may be in any sample of a source, or in another file of the folder: what
        // comes before the first one has that one's.
        let mut known = first_statics(&sorted);
        let mut frames = FrameCollector::default();
        for (file, bytes) in &sorted {
            let read = each_sample(bytes, |line, sample| {
                let index = frames.len();
                let mut name = format!("{index:06}");
                let read = sample.and_then(|sample| {
                    let root = Node::root(&sample);
                    name = name_of_sample(&root, index)?;
                    let known = known.entry(source_of(&root)).or_default();
                    read_sample(&root, known, options, index)
                });
                let read = read.map_err(|problem| match line {
                    Some(line) => problem.at_line(line),
                    None => problem,
                });
                frames.add(&name, None, read);
                if frames.has_only_damaged() {
                    Err(Problem::Empty)
                } else {
                    Ok(())
                }
            });
            // An empty file is said to be empty; a stop at damage alone is said by the frames.
            if let Err(problem) = read
                && frames.len() == 0
            {
                return Err(problem.within(file));
            }
        }
        let first = sorted.first().map_or("", |(file, _)| *file);
        frames.finish().map_err(|problem| problem.within(first))
    }
}

/// The source of a sample, whose static part it has; empty where it names none.
fn source_of(root: &Node<'_>) -> String {
    let source = root
        .find("sourceId")
        .and_then(|source| source.value().as_str());
    source.unwrap_or_default().to_owned()
}

/// The first static part of each source.
fn first_statics(files: &[(&str, &[u8])]) -> BTreeMap<String, Static> {
    let mut first = BTreeMap::new();
    for (_, bytes) in files {
        let _ = each_sample(bytes, |_, sample| {
            let sample = sample?;
            let root = Node::root(&sample);
            if let Some(stated) = Static::of_sample(&root) {
                first.entry(source_of(&root)).or_insert(stated);
            }
            Ok(())
        });
    }
    first
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

    /// Reads a sample by itself.
    fn read_line(text: &str, options: &ImportOptions) -> ExchangeResult<FrameCamera> {
        let files = Files::one("a.jsonl", text.as_bytes().to_vec());
        OpenTrackIo
            .read(&files, options)
            .map(|mut frames| frames.remove(0))
    }

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
        sample["lens"]["perspectiveShift"] = json!({ "x": 0.0, "y": 0.0 });
        sample["lens"]["distortionOverscan"] = 1.0.into();
        assert_eq!(unread(&sample), [""; 0], "nothing changes");
        sample["lens"]["perspectiveShift"]["x"] = 0.1.into();
        sample["lens"]["distortionOverscan"] = 1.2.into();
        sample["lens"]["distortion"][0]["overscan"] = 1.1.into();
        sample["protocol"]["version"] = json!([0, 9, 2]);
        let said = unread(&sample).concat();
        for named in [
            "perspectiveShift",
            "distortionOverscan",
            "distortion[0].overscan",
            "version 0.9.2",
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
        let read = |text: &str| *read_line(text, &options).unwrap().pinhole().unwrap();
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
        let [alone, second] = [text.trim().to_owned(), sample.to_string()]
            .map(|line| read_line(&line, &options).unwrap().pinhole().unwrap().lens);
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
        assert_eq!(read_line(&moved, &options).unwrap().name, "0001");
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
                "line 1: the camera (static.camera: activeSensorResolution, \
                 activeSensorPhysicalDimensions) is not known; give --size WIDTHxHEIGHT and \
                 --sensor-mm",
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
                swap("\"id\":\"Camera\"", "\"scale\":{\"x\":0}"),
                "line 1: transforms[0].scale.x is 0, which must be above 0",
            ),
            (
                swap("Brown-Conrady U-D", "Fisheye"),
                "line 1: the model of lens.distortion[0]: Brown-Conrady U-D or Brown-Conrady D-U \
                 is expected, found \"Fisheye\"",
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

    /// Samples of two frames, of which only the given ones have the static part.
    fn samples(with_static: [bool; 2]) -> [Value; 2] {
        let text = text_of(
            &export_as(&awkward(), Format::OpenTrackIo).files,
            "camera.jsonl",
        );
        let mut lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
        let mut two: [Value; 2] = [lines.next().unwrap(), lines.next().unwrap()];
        let stated = two[0]["static"].clone();
        for (sample, has_it) in two.iter_mut().zip(with_static) {
            sample["static"] = if has_it { stated.clone() } else { json!({}) };
        }
        two
    }

    #[test]
    fn samples_are_read_however_they_are_laid_out() {
        let [a, b] = samples([true, true]);
        let lines = format!("{a}\n\n{b}\n");
        let list = json!([a, b]);
        let one = |text: String| Files::one("a.json", text.into_bytes());
        let mut a_file_each = one(format!("{a:#}"));
        a_file_each.add("b.json", format!("{b:#}"));
        let options = ImportOptions::default();
        let wanted = OpenTrackIo.read(&one(lines), &options).unwrap();
        assert_eq!(wanted.len(), 2);
        for files in [one(list.to_string()), one(format!("{list:#}")), a_file_each] {
            assert_eq!(OpenTrackIo.read(&files, &options).unwrap(), wanted);
        }
    }

    #[test]
    fn the_static_part_may_come_once_late_or_never() {
        let options = ImportOptions {
            size: Some(ImageSize::new(1920, 1080)),
            sensor_width_mm: Some(NOMINAL_MM),
            ..ImportOptions::default()
        };
        let read = |with_static, options: &ImportOptions| {
            let [a, b] = samples(with_static);
            let files = Files::one("a.jsonl", format!("{a}\n{b}\n").into_bytes());
            OpenTrackIo.read(&files, options)
        };
        let stated = ImportOptions::default();
        let wanted = read([true, true], &stated).unwrap();
        for with_static in [[true, false], [false, true]] {
            assert_eq!(
                read(with_static, &stated).unwrap(),
                wanted,
                "{with_static:?}"
            );
        }
        let never = read([false, false], &stated).unwrap_err().to_string();
        assert!(
            never.ends_with("give --size WIDTHxHEIGHT and --sensor-mm"),
            "{never}"
        );
        assert_eq!(
            read([false, false], &options).unwrap(),
            wanted,
            "as it says"
        );
    }

    #[test]
    fn what_the_document_cannot_have_is_refused_with_how_far_it_is() {
        let [sample, _] = samples([true, true]);
        let read = |sample: &Value| read_line(&sample.to_string(), &ImportOptions::default());
        let mut absurd = sample.clone();
        absurd["lens"]["distortion"] =
            json!([{ "radial": [1.0, 2.0, 3.0], "tangential": [1.0, 2.0] }]);
        let said = read(&absurd).unwrap_err().to_string();
        assert!(
            said.contains("px off where k1 and k2 are nearest"),
            "{said}"
        );
        absurd["lens"].as_object_mut().unwrap().remove("distortion");
        assert!(read(&absurd).is_ok(), "as it says");
        let square_px = read(&sample).unwrap().pinhole().unwrap().focal_px;
        let mut squeezed = sample;
        let mut squeezed_by = |num: u32| {
            squeezed["static"]["camera"]["anamorphicSqueeze"] = json!({ "num": num, "denom": 1 });
            read(&squeezed)
        };
        let pinhole = *squeezed_by(2).unwrap().pinhole().unwrap();
        let read = (pinhole.focal_px, pinhole.lens.pixel_aspect);
        assert_eq!(read, (0.5 * square_px, 2.0));
        let said = squeezed_by(5).unwrap_err().to_string();
        assert!(said.contains("is 5, which must be 0.25 to 4"), "{said}");
    }
}
