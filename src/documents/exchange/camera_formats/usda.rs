//! A USD stage as text: an animated camera, y up, in centimetres.
//!
//! Row-vector matrices: translation in the last row, the first three rows the camera's right, up
//! and back axes in the stage. Focal length and apertures are in tenths of a stage unit. With
//! centimetres these are mm, so readers that ignore the stage unit get the same result. Time codes
//! are frame numbers; a gap in them starts another camera, so that readers do not interpolate
//! across it. Distortion cannot be represented. Source: `OpenUSD`, `UsdGeomCamera`.

use super::chan::{looking_back, y_up};
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, SequenceScope, WriteContext,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::held::{parts, with};
use crate::exchange::cameras::into_document::FreeNames;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, text};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::table::{number, numbers};
use crate::exchange::syntax::values::{frame_number, side_px};
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// The format.
pub struct Usda;

/// The aperture that is written for an unknown sensor, mm.
const NOMINAL_MM: f64 = 36.0;
/// Centimetres per metre.
const CM: f64 = 100.0;
/// The error of a landmark due to 32-bit focal lengths, px.
const RESOLUTION_PX: f64 = 1e-3;

/// A camera of the stage: a run of consecutive frames.
struct Take<'a> {
    name: String,
    camera: &'a str,
    size: ImageSize,
    samples: Vec<(u64, &'a Pinhole)>,
}

impl Take<'_> {
    /// Whether a frame is the next one of the same camera, with a picture of the same size and the
    /// same principal point.
    fn is_continued_by(&self, time: u64, pinhole: &Pinhole, size: ImageSize, camera: &str) -> bool {
        let follows = self.samples.last().is_some_and(|(last_time, last)| {
            last_time.checked_add(1) == Some(time)
                && last.principal_point == pinhole.principal_point
                && last.lens == pinhole.lens
        });
        follows && self.size == size && self.camera == camera
    }

    /// An animated attribute: a value for each sample.
    fn time_samples(&self, value: impl Fn(&Pinhole) -> String) -> String {
        let samples: Vec<String> = self
            .samples
            .iter()
            .map(|&(time, pinhole)| format!("{time}: {}", value(pinhole)))
            .collect();
        samples.join(", ")
    }
}

/// A name that USD accepts: letters, digits and underscores, not beginning with a digit.
fn prim_name(camera: &str) -> String {
    let name = camera.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_");
    if name.is_empty() || name.starts_with(|first: char| first.is_ascii_digit()) {
        format!("camera_{name}")
    } else {
        name
    }
}

fn takes(held: &[FrameCamera]) -> Vec<Take<'_>> {
    let mut takes: Vec<Take<'_>> = Vec::new();
    let mut names = FreeNames::new("_take");
    for (index, frame) in held.iter().enumerate() {
        let (Some(pinhole), Some(size)) = (frame.pinhole(), frame.size) else {
            continue;
        };
        // Pictures without a number are a frame each, in their order.
        let time = frame.frame_index.unwrap_or(index as u64);
        let camera = frame.camera.as_deref().unwrap_or_default();
        // Readers interpolate between samples of one camera, across any gap; and aperture and its
        // offsets are of a camera, not of a sample.
        if let Some(take) = takes
            .last_mut()
            .filter(|take| take.is_continued_by(time, pinhole, size, camera))
        {
            take.samples.push((time, pinhole));
            continue;
        }
        takes.push(Take {
            name: names.take(&prim_name(camera)),
            camera,
            size,
            samples: vec![(time, pinhole)],
        });
    }
    takes
}

/// The pose of a camera as a matrix of USD.
fn matrix_text(pinhole: &Pinhole) -> String {
    // The columns are the camera's right, up and back axes in the stage; USD multiplies row
    // vectors, so they are written as rows. The stage is in cm, our world in m.
    let axes: Mat3 = y_up() * pinhole.cam_from_world.transpose() * looking_back();
    let at = y_up() * pinhole.position_m * CM;
    let [right, up, back] = [0, 1, 2].map(|column| {
        let [x, y, z] = [0, 1, 2].map(|row| axes[(row, column)]);
        format!("({x}, {y}, {z}, 0)")
    });
    format!(
        "( {right}, {up}, {back}, ({}, {}, {}, 1) )",
        at.x, at.y, at.z
    )
}

fn push_take(take: &Take<'_>, aperture_mm: f64, text: &mut String) {
    let (width, height) = (f64::from(take.size.width), f64::from(take.size.height));
    // Apertures and focal length are in tenths of a stage unit, which are mm in a stage in cm.
    let per_px = aperture_mm / width;
    // Aperture offsets, mm: positive where the principal point lies left of the middle, or below
    // it.
    // A pixel that is wide for its height has the less of the aperture's height.
    let aspect = take
        .samples
        .first()
        .map_or(1.0, |(_, first)| first.lens.pixel_aspect);
    let down_px = per_px / aspect;
    let offset = take.samples.first().map_or([0.0; 2], |(_, first)| {
        [
            (width / 2.0 - first.principal_point.x) * per_px,
            (first.principal_point.y - height / 2.0) * down_px,
        ]
    });
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "    def Camera \"{}\"\n    {{\n        custom string touchline:camera = {}\n        token projection = \"perspective\"\n        float2 clippingRange = (10, 100000)\n        \
         float horizontalAperture = {aperture_mm}\n        float verticalAperture = {}\n        \
         float horizontalApertureOffset = {}\n        float verticalApertureOffset = {}\n        \
         float focalLength.timeSamples = {{ {} }}\n        matrix4d xformOp:transform.timeSamples = {{ {} }}\n        \
         uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n",
        take.name,
        serde_json::Value::from(take.camera),
        height * down_px,
        offset[0],
        offset[1],
        take.time_samples(|pinhole| (pinhole.focal_px * per_px).to_string()),
        take.time_samples(matrix_text),
    );
}

/// The text between two markers.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Result<&'a str, Problem> {
    let rest = text
        .split_once(from)
        .ok_or_else(|| Problem::Missing(from.trim().to_owned()))?
        .1;
    Ok(rest.split_once(to).map_or(rest, |(found, _)| found))
}

/// A number rounded to 32 bits, as readers of these attributes do.
#[expect(clippy::cast_possible_truncation, reason = "that is what readers do")]
fn single(what: &str, text: &str) -> Result<f64, Problem> {
    Ok(f64::from(number(what, text)? as f32))
}

/// The frames of a camera written by [`push_take`]. Stages of other programs are not supported.
fn read_take(prim: &str, stage: &str) -> Result<Vec<FrameCamera>, Problem> {
    // Only what `push_take` writes is read, to verify an export, so that the text is searched for
    // its exact words.
    let name = prim.split('"').next().unwrap_or_default();
    let camera: String = serde_json::from_str(between(prim, "touchline:camera = ", "\n")?)
        .map_err(|error| Problem::not_format("a name of a camera", error.to_string()))?;
    let sides = numbers(
        "the size",
        &between(stage, &format!("int2 {name}_image_size_px = ("), ")")?.replace(',', " "),
    )?;
    let [width, height]: [f64; 2] = sides.try_into().map_err(|sides: Vec<f64>| {
        let (what, found) = ("sides of the picture".to_owned(), sides.len());
        Problem::wrong_count(what, 2, found)
    })?;
    let size = ImageSize::new(side_px("width", width)?, side_px("height", height)?);
    let mm_per_px = float_attribute(prim, "horizontalAperture")? / width;
    let mm_down_px = float_attribute(prim, "verticalAperture")? / height;
    let principal_point = ImagePoint::new(
        width / 2.0 - float_attribute(prim, "horizontalApertureOffset")? / mm_per_px,
        height / 2.0 + float_attribute(prim, "verticalApertureOffset")? / mm_down_px,
    );
    let take = ReadTake {
        camera,
        size,
        mm_per_px,
        principal_point,
        pixel_aspect: mm_per_px / mm_down_px,
    };
    // Both lists have a sample a frame. The poses are 16 numbers each, in which only brackets and
    // commas separate them, and the time stands before the first. A missing one gives a frame too
    // few, which the comparison with what was written finds.
    let lengths = between(prim, "focalLength.timeSamples = { ", " }")?.split(',');
    let poses = between(prim, "transform.timeSamples = { ", " }")?.replace(['(', ')'], " ");
    let poses: Vec<&str> = poses.split(',').collect();
    lengths
        .zip(poses.chunks(16))
        .map(|(length, pose)| take.read_sample(length, pose))
        .collect()
}

/// A number of a camera that is not animated.
fn float_attribute(prim: &str, what: &str) -> Result<f64, Problem> {
    single(what, between(prim, &format!("float {what} = "), "\n")?)
}

/// What the samples of a camera that is read have in common.
struct ReadTake {
    camera: String,
    size: ImageSize,
    mm_per_px: f64,
    principal_point: ImagePoint,
    pixel_aspect: f64,
}

impl ReadTake {
    /// The frame of a sample: its focal length, as `time: mm`, and the 16 numbers of its pose. The
    /// first of them has the time before it.
    fn read_sample(&self, length: &str, pose: &[&str]) -> Result<FrameCamera, Problem> {
        let (time, length) = length.split_once(':').unwrap_or_default();
        let time = frame_number("the time", number("the time", time.trim())?)?;
        let m: Vec<f64> = (0..16)
            .map(|index| {
                let text = pose.get(index).copied().unwrap_or_default();
                let entry = text.rsplit(':').next().unwrap_or_default();
                number("the pose", entry.trim())
            })
            .collect::<Result<_, _>>()?;

        // The inverse of `matrix_text`: USD's rows are the camera's axes, and the last one is its
        // position, in the stage.
        let axes = Mat3::from_fn(|row, column| m[4 * column + row]);
        let pinhole = Pinhole {
            cam_from_world: (y_up().transpose() * axes * looking_back().transpose()).transpose(),
            position_m: y_up().transpose() * Vec3::new(m[12], m[13], m[14]) / CM,
            focal_px: single("focalLength", length.trim())? / self.mm_per_px,
            principal_point: self.principal_point,
            lens: Radial {
                pixel_aspect: self.pixel_aspect,
                ..Radial::default()
            },
        };
        let name = format!("{}@{time}", self.camera);
        Ok(FrameCamera {
            frame_index: Some(time),
            ..FrameCamera::new(&name, Some(self.size), FrameProjection::Camera(pinhole))
        })
    }
}

impl CameraFormat for Usda {
    fn about(&self) -> About {
        About {
            name: "usda",
            title: "a USD stage with an animated camera",
            conventions: "y up, centimetres, mm; one stage frame per video frame; a gap starts a new camera",
            users: "Blender, Houdini, Unreal, usdview",
            loses: Some("lens, size of the picture, uncertainty"),
            file: Some("camera.usda"),
            files: "stage (.usda)",
            endings: &[],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::Fps,
                FormatOption::SensorMm,
                FormatOption::StageOrigin,
                FormatOption::StageHeading,
            ],
            import_options: &[],
        }
    }

    fn resolution_px(&self, _held: &FrameCamera) -> f64 {
        RESOLUTION_PX
    }

    fn hold(&self, frame: &FrameCamera, index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let (pinhole, _) = parts(frame)?;
        let camera = frame.camera.as_deref().unwrap_or_default();
        let time = frame.frame_index.unwrap_or(index as u64);
        Ok(with(
            frame,
            format!("{camera}@{time}"),
            Pinhole {
                lens: pinhole.lens.without_distortion(),
                ..pinhole
            },
        ))
    }

    fn notes(&self, _frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let mut notes = vec![
            "USD keeps focal lengths as 32-bit floats: readers are within about 1e-3 px".to_owned(),
        ];
        if context.rate.is_none() {
            notes.push(
                "the frame rate is not known; time codes are frame numbers without one (--fps)"
                    .to_owned(),
            );
        }
        notes.extend(context.sensor_width_note(NOMINAL_MM));
        notes
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::Camera)
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let takes = takes(held);
        let times: Vec<u64> = takes
            .iter()
            .flat_map(|take| take.samples.iter().map(|(time, _)| *time))
            .collect();
        // Over all cameras, which may overlap in time.
        let first = times.iter().min().copied().unwrap_or(0);
        let last = times.iter().max().copied().unwrap_or(0);
        let rate = context.rate.map(|rate| {
            let rate = rate.per_second();
            format!("    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}\n")
        });
        // USD has no size of picture; the entry of each camera is for people and for the reader
        // below.
        let sizes: Vec<String> = takes
            .iter()
            .map(|take| {
                format!(
                    "        int2 {}_image_size_px = ({}, {})\n",
                    take.name, take.size.width, take.size.height
                )
            })
            .collect();
        let mut text = format!(
            "#usda 1.0\n(\n    customLayerData = {{\n        string generator = \"{}\"\n        string world = \"origin at the \
             field's centre; stage x, y, z = field x, z, -y\"\n{}    }}\n    defaultPrim = \"Match\"\n    \
             metersPerUnit = 0.01\n    upAxis = \"Y\"\n    startTimeCode = {first}\n    endTimeCode = {last}\n{})\ndef Xform \
             \"Match\"\n{{\n",
            crate::document::generator(),
            sizes.concat(),
            rate.unwrap_or_default(),
        );
        let aperture_mm = context.options.sensor_width_mm.unwrap_or(NOMINAL_MM);
        for take in &takes {
            push_take(take, aperture_mm, &mut text);
        }
        text.push_str("}\n");
        Ok(Files::one("camera.usda", text.into_bytes()))
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|_, bytes| {
            let stage = text(bytes)?;
            let takes = stage
                .split("    def Camera \"")
                .skip(1)
                .map(|prim| read_take(prim, stage));
            Ok(takes.collect::<Result<Vec<_>, _>>()?.concat())
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
        let exported = export_as(&reference(), Format::Usda);
        let text = text_of(&exported.files, "camera.usda");
        for line in [
            "float focalLength.timeSamples = { 412: 45.1875 }",
            "float verticalAperture = 20.25",
            "timeCodesPerSecond = 25",
            "(0, 1800, 6000, 1) )",
            "def Camera \"main\"",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
        assert_eq!(exported.loss.unwrap().what, ["lens distortion"]);
    }

    #[test]
    fn what_is_written_is_read_again_as_32_bit_floats() {
        let exported = export_as(&awkward(), Format::Usda);
        assert!(
            exported.worst_px > 0.0 && exported.worst_px < 5e-4,
            "{}",
            exported.worst_px
        );
    }

    #[test]
    fn cameras_whose_names_begin_alike_are_two() {
        let mut document = awkward();
        let mut other = (*document.cameras[0]).clone();
        other.id = "main2".into();
        document.cameras.push(other.into());
        document.frames[0].camera = "main2".into();
        let text = text_of(&export_as(&document, Format::Usda).files, "camera.usda");
        assert!(
            text.contains("def Camera \"main2\"") && text.contains("def Camera \"main\""),
            "{text}"
        );
    }

    #[test]
    fn a_gap_begins_another_camera() {
        let mut document = awkward();
        for (index, frame) in document.frames.iter_mut().enumerate() {
            frame.video.as_mut().unwrap().frame_index =
                if index < 5 { 100 } else { 200 } + index as u64;
        }
        let text = text_of(&export_as(&document, Format::Usda).files, "camera.usda");
        assert_eq!(text.matches("def Camera").count(), 2, "{text}");
        assert!(text.contains("def Camera \"main_take2\""), "{text}");
        assert!(
            text.contains("startTimeCode = 100\n    endTimeCode = 211\n"),
            "{text}"
        );
    }

    #[test]
    fn no_frame_is_the_next_one_after_the_largest_number() {
        let pinhole = Pinhole {
            cam_from_world: Mat3::identity(),
            position_m: Vec3::zeros(),
            focal_px: 2000.0,
            principal_point: ImagePoint::new(960.0, 540.0),
            lens: Radial::default(),
        };
        let size = ImageSize::new(1920, 1080);
        let take = |time| Take {
            name: String::new(),
            camera: "main",
            size,
            samples: vec![(time, &pinhole)],
        };
        assert!(take(7).is_continued_by(8, &pinhole, size, "main"));
        assert!(!take(u64::MAX).is_continued_by(0, &pinhole, size, "main"));
    }

    #[test]
    fn names_are_what_usd_accepts() {
        assert_eq!(
            [prim_name("main 2"), prim_name("2"), prim_name("")],
            ["main_2", "camera_2", "camera_"]
        );
    }
}
