//! Reads one sample of `OpenTrackIO`. What a sample leaves out is taken from the static part that
//! came before it, and what would change the picture but is not read is named.

use super::lens_law::{BrownConrady, FittedLens, Screen};
use super::transforms::BodyPose;
use super::{INVERSE_MODEL, MODEL, NAME_KEY, NOMINAL_NOTE, OWN_NOTES};
use crate::exchange::cameras::body_angles::cam_from_world;
use crate::exchange::cameras::calibration_matrix::Calibration;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::error::Problem;
use crate::exchange::files::base_name;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::Node;
use crate::exchange::syntax::values::shorten;
use serde_json::Value;
use std::collections::BTreeSet;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};

/// How far the lens and the axes of a document may each be from those of a sample, px.
const MOST_OFF_PX: f64 = 0.05;

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
#[derive(Clone, Copy)]
pub(super) struct Static {
    sensor_mm: Option<f64>,
    size: Option<ImageSize>,
    /// How much wider the lens sees than the sensor has pixels for.
    squeeze: f64,
}

impl Default for Static {
    fn default() -> Self {
        Self {
            sensor_mm: None,
            size: None,
            squeeze: 1.0,
        }
    }
}

impl Static {
    /// What a sample itself states; none where it has no such part.
    pub(super) fn of_sample(root: &Node<'_>) -> Option<Self> {
        root.find("static")?.find("camera")?;
        let mut stated = Self::default();
        stated.update(root).ok().map(|()| stated)
    }

    pub(super) fn update(&mut self, root: &Node<'_>) -> Result<(), Problem> {
        // Only the first sample and one every few seconds have the static part, so that a receiver
        // can begin anywhere.
        let Some(camera) = root.find("static").and_then(|part| part.find("camera")) else {
            return Ok(());
        };
        if let Some(sensor) = camera.find("activeSensorPhysicalDimensions") {
            self.sensor_mm = Some(sensor.key("width")?.positive()?);
        }
        if let Some(squeeze) = camera.find("anamorphicSqueeze") {
            let [num, denom] = squeeze.numbers_at(["num", "denom"])?;
            self.squeeze = num / denom;
        }
        if let Some(size) = camera.find("activeSensorResolution") {
            self.size = Some(size.size_at("width", "height")?);
        }
        Ok(())
    }
}

/// Entries that affect the picture and are not read.
const UNREAD: [&[&str]; 5] = [
    &["static", "lens", "distortionOverscanMax"],
    &["static", "lens", "undistortionOverscanMax"],
    &["lens", "distortionOverscan"],
    &["lens", "undistortionOverscan"],
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
    // How much wider a renderer has to draw before it bends its picture.
    let laws = find_path(root, &["lens", "distortion"]).and_then(|list| list.items().ok());
    let overscans = laws
        .into_iter()
        .flatten()
        .filter_map(|law| law.find("overscan"));
    let changed = overscans.filter(|overscan| !is_neutral(overscan.value()));
    unread.extend(changed.map(|overscan| overscan.path().to_string()));
    let version =
        find_path(root, &["protocol", "version"]).and_then(|version| version.numbers::<3>().ok());
    if let Some([major, minor, patch]) = version.filter(|version| *version != VERSION) {
        unread.insert(format!(
            "protocol version {major}.{minor}.{patch} (taken as 1.0.1)"
        ));
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

/// The distortions that a lens states.
fn distortions(lens: &Node<'_>) -> Result<Vec<BrownConrady>, Problem> {
    let centre_mm = match lens.find("distortionOffset") {
        Some(offset) => Vec2::from(offset.numbers_at(["x", "y"])?),
        None => Vec2::zeros(),
    };
    let mut laws = Vec::new();
    let Some(list) = lens.find("distortion") else {
        return Ok(laws);
    };
    for distortion in list.items()? {
        let model = distortion
            .find("model")
            .map(|model| model.text())
            .transpose()?;
        let is_inverse = match model {
            Some(MODEL) => false,
            None | Some(INVERSE_MODEL) => true,
            Some(other) => {
                return Err(Problem::Kind {
                    what: format!("the model of {}", distortion.path()),
                    wanted: "Brown-Conrady U-D or Brown-Conrady D-U",
                    found: format!("{:?}", shorten(other)),
                });
            }
        };
        let tangential = distortion
            .find("tangential")
            .map(|node| node.all_numbers())
            .transpose()?;
        laws.push(BrownConrady {
            radial: distortion.key("radial")?.all_numbers()?,
            tangential: tangential.unwrap_or_default(),
            centre_mm,
            is_inverse,
        });
    }
    laws.retain(BrownConrady::bends);
    Ok(laws)
}

/// The lens of a document nearest to that of a sample, and how far it is off at most, px.
///
/// # Errors
/// It is too far off; how far is said.
fn radial(lens: &Node<'_>, screen: &Screen) -> Result<(Radial, f64), Problem> {
    // A list may have a law for each direction: the nearer one to ours is taken, which is exact
    // where it is of our direction.
    let fits = distortions(lens)?.into_iter().map(|law| law.fit(screen));
    let nearest = fits.min_by(|a, b| a.off_px.total_cmp(&b.off_px));
    let Some(FittedLens { radial, off_px }) = nearest else {
        return Ok((Radial::default(), 0.0));
    };
    if off_px <= MOST_OFF_PX {
        return Ok((radial, off_px));
    }
    let far = if off_px.is_finite() {
        format!("{off_px:.3e} px off")
    } else {
        "without undistorted points for all of the picture".to_owned()
    };
    Err(Problem::not_supported(
        format!("lens.distortion: it is {far} where k1 and k2 are nearest, so that it"),
        "up to 0.05 px is taken; take it out of the pictures with a tool that knows it, and \
         give --undistorted",
    ))
}

/// The numbers of the camera that a sample or an option must state.
fn sensor_of(known: &Static, options: &ImportOptions) -> Result<(ImageSize, f64), Problem> {
    // What the file states goes before what the user says: one file may have samples of several
    // cameras.
    let sensor_mm = known.sensor_mm.or(options.sensor_width_mm);
    match (known.size.or(options.size), sensor_mm) {
        (Some(size), Some(sensor_mm)) => Ok((size, sensor_mm)),
        (None, Some(_)) => Err(Problem::option_needed(
            "the size of the pictures (static.camera.activeSensorResolution)",
            "--size WIDTHxHEIGHT",
        )),
        (Some(_), None) => Err(Problem::option_needed(
            "the width of the sensor (static.camera.activeSensorPhysicalDimensions)",
            "--sensor-mm",
        )),
        (None, None) => Err(Problem::option_needed(
            "the camera (static.camera: activeSensorResolution, activeSensorPhysicalDimensions)",
            "--size WIDTHxHEIGHT and --sensor-mm",
        )),
    }
}

/// Reads a sample. `known` is what samples before it stated, and is brought up to date.
pub(super) fn read_sample(
    root: &Node<'_>,
    known: &mut Static,
    options: &ImportOptions,
    index: usize,
) -> Result<FrameCamera, Problem> {
    known.update(root)?;
    let (size, sensor_mm) = sensor_of(known, options)?;
    let mm_per_px = sensor_mm / f64::from(size.width);
    let lens = root.key("lens")?;
    let focal_mm = lens.key("pinholeFocalLength")?.positive()?;
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
    // A squeezed picture has a shorter focal length across: that is the aspect of its pixels. The
    // sensor's height does not count: it is often that of the whole chip, of which the picture is a
    // part.
    let across = focal_mm / mm_per_px / known.squeeze;
    let taken = Calibration {
        fx: across,
        fy: focal_mm / mm_per_px,
        skew: 0.0,
        principal_point,
    };
    let taken = taken.without_skew(size)?;
    let screen = Screen {
        size,
        principal_point,
        mm_per_px,
        focal_mm,
        squeeze: known.squeeze,
    };
    let body = BodyPose::of_sample(root, &screen, MOST_OFF_PX)?;
    let (radial, off_px) = if options.undistorted {
        (Radial::default(), 0.0)
    } else {
        radial(&lens, &screen)?
    };
    let pinhole = Pinhole {
        // From the body's axes to the camera's. The entrance pupil, which is the centre of
        // projection, lies ahead of the tracked point along the body's y axis.
        cam_from_world: cam_from_world([0.0; 3]) * body.world_from_body.transpose(),
        position_m: body.place_m + body.world_from_body * Vec3::new(0.0, forward, 0.0),
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        lens: Radial {
            pixel_aspect: taken.pixel_aspect,
            ..radial
        },
    };
    let shown = FrameProjection::Camera(pinhole.validate("the camera")?);
    Ok(FrameCamera {
        off_px: off_px + taken.off_px + body.off_px,
        ..FrameCamera::new(&name_of_sample(root, index)?, Some(size), shown)
    })
}

/// The name of a sample: that of our own notes, else its number, else its place.
pub(super) fn name_of_sample(root: &Node<'_>, index: usize) -> Result<String, Problem> {
    if let Some(name) = name_in_sample(root) {
        return Ok(base_name(name).to_owned());
    }
    let timing = root.find("timing");
    let number = timing.and_then(|timing| timing.find("sequenceNumber"));
    Ok(match number {
        Some(number) => format!("{:06}", number.number()?),
        None => format!("{index:06}"),
    })
}
