//! Reads one sample of `OpenTrackIO`. What a sample leaves out is taken from the static part that
//! came before it, and what would change the picture but is not read is named.

use super::{MODEL, NAME_KEY, NOMINAL_NOTE, OWN_NOTES};
use crate::exchange::cameras::body_angles::{cam_from_world, world_from_body};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::error::Problem;
use crate::exchange::files::base_name;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::values::coefficient;
use serde_json::Value;
use std::collections::BTreeSet;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// The name of a frame in the notes of its sample; none in those of other programs.
pub(super) fn name_in_notes(notes: &str) -> Option<&str> {
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
pub(super) struct Static {
    pub(super) sensor_mm: Option<f64>,
    pub(super) size: Option<ImageSize>,
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
pub(super) fn unread_of_sample(root: &Node<'_>) -> BTreeSet<String> {
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

pub(super) fn radial(lens: &Node<'_>, focal_mm: f64) -> Result<Radial, Problem> {
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

pub(super) fn read_line(
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
