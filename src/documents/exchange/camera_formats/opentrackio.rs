//! `OpenTrackIO` 1.0.1: one sample per line and frame.
//!
//! World and metres are ours; angles about Z, X, Y with pan positive to the *left*. Focal length,
//! offsets and distortion are in mm of the sensor. Any sensor width gives the same picture as long
//! as it is stated, so an unknown width is written as a nominal 9.6 mm, and the notes say so. The
//! distortion model `Brown-Conrady U-D` equals ours: `radial` = [k1/F², 0, k2/F⁴, 0] (numerator and
//! denominator alternate). Source: SMPTE/ris-osvp-metadata-camdkit (schema and documentation).

use crate::document::SolutionSource;
use crate::exchange::cameras::body_angles::{angles_deg, cam_from_world, world_from_body};
use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext, has_ending};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::held::parts;
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::{Files, base_name, text};
use crate::exchange::options::ImportOptions;
use crate::exchange::rate::Rate;
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::values::coefficient;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeSet;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3, hex};

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

fn static_part(frame: &FrameCamera, size: ImageSize, sensor_mm: f64, rate: Option<Rate>) -> Value {
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
    json!({ "camera": camera })
}

fn timing(frame: &FrameCamera, context: &WriteContext<'_>) -> Option<Value> {
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

fn lens(pinhole: &Pinhole, size: ImageSize, sensor_mm: f64) -> Value {
    // The coefficients act on mm from the centre of projection, ours on x / z = mm / F: k1 r² = (k1
    // / F²) (F r)².
    let mm_per_px = sensor_mm / f64::from(size.width);
    // Px to mm by the sensor's pixel pitch. The offset is that of the principal point from the
    // picture's middle, positive to the right and down as ours.
    let (focal, offset) = (
        pinhole.focal_px * mm_per_px,
        pinhole.principal_point.offset_from(size.centre()) * mm_per_px,
    );
    let Radial { k1, k2 } = pinhole.lens;
    json!({
        "pinholeFocalLength": focal,
        "projectionOffset": { "x": offset.x, "y": offset.y },
        "entrancePupilOffset": 0.0,
        "distortion": [{ "model": MODEL, "radial": [k1 / focal.powi(2), 0.0, k2 / focal.powi(4), 0.0] }],
    })
}

fn sample(
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

/// The name of a frame in the notes of its sample; none in those of other programs.
fn name_in_notes(notes: &str) -> Option<&str> {
    let rest = notes.strip_prefix(OWN_NOTES)?;
    let rest = rest.strip_prefix(NOMINAL_NOTE).unwrap_or(rest);
    rest.strip_prefix("; ")
}

/// The name of a frame in its sample; none in samples of other programs.
fn name_in_sample<'a>(root: &Node<'a>) -> Option<&'a str> {
    text_at(root, &["custom", NAME_KEY])
        .or_else(|| text_at(root, &["tracker", "notes"]).and_then(name_in_notes))
}

/// The text under keys within each other.
fn text_at<'a>(root: &Node<'a>, path: &[&str]) -> Option<&'a str> {
    find_path(root, path)?.value().as_str()
}

/// The sensor's width (mm) and the size of the picture, which only some samples contain; the last
/// ones read remain valid.
#[derive(Clone, Copy, Default)]
struct Static {
    sensor_mm: Option<f64>,
    size: Option<ImageSize>,
}

impl Static {
    fn update(&mut self, root: &Node<'_>) -> Result<(), Problem> {
        // Only the first sample and one every few seconds have the static part, so that a receiver
        // can begin anywhere.
        let Some(camera) = root.find("static").and_then(|part| part.find("camera")) else {
            return Ok(());
        };
        if let Some(sensor) = camera.find("activeSensorPhysicalDimensions") {
            self.sensor_mm = Some(sensor.key("width")?.positive()?);
        }
        if let Some(size) = camera.find("activeSensorResolution") {
            self.size = Some(size.size_at("width", "height")?);
        }
        Ok(())
    }
}

/// The rotation and position (m) of the camera's body in the world: all transforms composed, in the
/// order of the file.
fn pose(root: &Node<'_>) -> Result<(Mat3, Vec3), Problem> {
    let mut rotation = Mat3::identity();
    let mut place = Vec3::zeros();
    let transforms = root.key("transforms")?;
    if transforms.count()? == 0 {
        return Err(Problem::Missing("a transform".to_owned()));
    }
    for transform in transforms.items()? {
        if transform.find("scale").is_some() {
            return Err(Problem::Unsupported {
                what: transform.path().to_owned() + ".scale",
                why: "cameras have one scale",
            });
        }
        let (t, r) = (transform.key("translation")?, transform.key("rotation")?);
        // Each transform is in the axes of the one before: a crane, its arm, its head.
        place += rotation * Vec3::from(t.numbers_at(["x", "y", "z"])?);
        rotation *= world_from_body(r.numbers_at(["pan", "tilt", "roll"])?);
    }
    Ok((rotation, place))
}

/// Entries that affect the picture and are not read.
const UNREAD: [&[&str]; 7] = [
    &["static", "camera", "anamorphicSqueeze"],
    &["static", "lens", "distortionOverscanMax"],
    &["static", "lens", "undistortionOverscanMax"],
    &["lens", "distortionOverscan"],
    &["lens", "undistortionOverscan"],
    &["lens", "distortionOffset"],
    &["lens", "perspectiveShift"],
];
/// The version that is read.
const VERSION: [f64; 3] = [1.0, 0.0, 1.0];

/// The entries of a sample that affect the picture and are not read.
fn unread_of_sample(root: &Node<'_>) -> BTreeSet<String> {
    let mut unread: BTreeSet<String> = UNREAD
        .iter()
        .filter(|path| find_path(root, path).is_some_and(|node| !is_neutral(node.value())))
        .map(|path| path.join("."))
        .collect();
    let version =
        find_path(root, &["protocol", "version"]).and_then(|version| version.numbers::<3>().ok());
    if let Some([major, minor, patch]) = version.filter(|version| *version != VERSION) {
        unread.insert(format!(
            "protocol version {major}.{minor}.{patch} (taken as 1.0.1)"
        ));
    }
    if find_path(root, &["lens", "distortion"])
        .and_then(|list| list.count().ok())
        .is_some_and(|count| count > 1)
    {
        unread.insert("another distortion of the lens".to_owned());
    }
    unread
}

/// The value under keys within each other; none where one of them is absent.
fn find_path<'a>(root: &Node<'a>, path: &[&str]) -> Option<Node<'a>> {
    path.iter()
        .try_fold(root.clone(), |node, key| node.find(key))
}

/// Whether a value has no effect: an offset of zero, a scale of one.
fn is_neutral(value: &Value) -> bool {
    match value {
        Value::Object(parts) => match (parts.get("num"), parts.get("denom")) {
            (Some(num), Some(denom)) => num == denom,
            _ => parts.values().all(|part| part.as_f64() == Some(0.0)),
        },
        value => value.as_f64() == Some(1.0),
    }
}

fn radial(lens: &Node<'_>, focal_mm: f64) -> Result<Radial, Problem> {
    let Some(list) = lens.find("distortion") else {
        return Ok(Radial::default());
    };
    // A list may have a model for each direction, in any order. The first one of ours that distorts
    // counts: the other direction has no closed form in our coefficients. `unread` reports that
    // there is another one.
    let mut foreign = None;
    for distortion in list.items()? {
        let terms = distortion.key("radial")?.all_numbers()?;
        let tangential = distortion
            .find("tangential")
            .map(|node| node.all_numbers())
            .transpose()?
            .unwrap_or_default();
        let bends = terms.iter().chain(&tangential).any(|term| *term != 0.0);
        let is_ours = distortion
            .find("model")
            .is_some_and(|model| model.value() == MODEL);
        if !is_ours && bends {
            let what = format!("the model of {}", distortion.path());
            foreign.get_or_insert(Problem::Unsupported {
                what,
                why: "only Brown-Conrady U-D is read",
            });
            continue;
        }
        // Numerator and denominator alternate: l1 and l3 are the first two terms of the numerator,
        // k1 and k2. All others must be zero.
        let further = terms
            .iter()
            .enumerate()
            .any(|(index, term)| *term != 0.0 && index != 0 && index != 2);
        if further || tangential.iter().any(|term| *term != 0.0) {
            let what = format!("a coefficient of {} beyond l1 and l3", distortion.path());
            return Err(Problem::Unsupported {
                what,
                why: "the document's lens has k1 and k2 only",
            });
        }
        if bends {
            return Ok(Radial {
                k1: coefficient(&terms, 0) * focal_mm.powi(2),
                k2: coefficient(&terms, 2) * focal_mm.powi(4),
            });
        }
    }
    foreign.map_or_else(|| Ok(Radial::default()), Err)
}

fn read_line(
    line: &str,
    known: &mut Static,
    options: &ImportOptions,
    index: usize,
) -> Result<FrameCamera, Problem> {
    let value = parse(line.as_bytes())?;
    let root = Node::root(&value);
    known.update(&root)?;
    // What the file states goes before what the user says: one file may have samples of several
    // cameras.
    let size = known.size.or(options.size);
    let size =
        size.ok_or_else(|| Problem::Missing("static.camera.activeSensorResolution".to_owned()))?;
    let sensor_mm = known.sensor_mm.or(options.sensor_width_mm);
    let sensor_mm = sensor_mm.ok_or_else(|| {
        Problem::Missing("static.camera.activeSensorPhysicalDimensions".to_owned())
    })?;
    let mm_per_px = sensor_mm / f64::from(size.width);
    let lens = root.key("lens")?;
    let focal_mm = lens.key("pinholeFocalLength")?.positive()?;
    let (body, place) = pose(&root)?;
    let forward = lens
        .find("entrancePupilOffset")
        .map(|node| node.number())
        .transpose()?
        .unwrap_or(0.0);
    let mut principal_point = size.centre();
    if let Some(offset) = lens.find("projectionOffset") {
        let [x, y] = offset.numbers_at(["x", "y"])?;
        principal_point = ImagePoint::new(
            principal_point.x + x / mm_per_px,
            principal_point.y + y / mm_per_px,
        );
    }
    let pinhole = Pinhole {
        // From the body's axes to the camera's. The entrance pupil, which is the centre of
        // projection, lies ahead of the tracked point along the body's y axis.
        cam_from_world: cam_from_world([0.0; 3]) * body.transpose(),
        position_m: place + body * Vec3::new(0.0, forward, 0.0),
        focal_px: focal_mm / mm_per_px,
        principal_point,
        lens: radial(&lens, focal_mm)?,
    };
    let timing = root.find("timing");
    let number = timing
        .and_then(|timing| timing.find("sequenceNumber"))
        .map(|node| node.number())
        .transpose()?;
    let name = name_in_sample(&root).map_or_else(
        || number.map_or_else(|| format!("{index:06}"), |number| format!("{number:06}")),
        |name| base_name(name).to_owned(),
    );
    Ok(FrameCamera::new(
        &name,
        Some(size),
        FrameProjection::Camera(pinhole.validate("the camera")?),
    ))
}

impl CameraFormat for OpenTrackIo {
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

    fn file_description(&self) -> &'static str {
        "samples (.jsonl)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "jsonl")
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
    use std::path::Path;

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
