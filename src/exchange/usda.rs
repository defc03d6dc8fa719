//! A USD stage as text: an animated camera, y up, in centimetres.
//!
//! Row-vector matrices: translation in the last row, the first three rows the camera's right, up and back axes in the stage.
//! Focal length and apertures are tenths of a stage unit, so with centimetres they are mm and careful and careless readers agree.
//! Time codes are frame numbers; a gap in them begins another camera, so nothing is interpolated over it. The lens is not held: its
//! coefficients stand in `customLayerData`.
//! Source: `OpenUSD`, `UsdGeomCamera`.

use super::camera_format::{CameraFormat, WriteContext, has_ending};
use super::chan::{looking_back, y_up};
use super::error::ExchangeError;
use super::files::Files;
use super::format::Format;
use super::frame_camera::{FrameCamera, Pinhole};
use super::held::{parts, with};
use super::options::ImportOptions;
use crate::camera::Radial;
use crate::geometry::{ImageSize, Mat3};
use std::fmt::Write as _;

/// The format.
pub struct Usda;

/// The aperture of a sensor that nobody knows, mm.
const NOMINAL_MM: f64 = 36.0;
/// Centimetres a metre.
const CM: f64 = 100.0;

/// A camera of the stage: its frames follow each other without a gap.
struct Take<'a> {
    name: String,
    size: ImageSize,
    samples: Vec<(u64, &'a Pinhole)>,
}

/// A name that USD accepts: letters, digits and underscores, not beginning with a digit.
fn prim_name(camera: &str) -> String {
    let kept = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let name: String = camera.chars().map(kept).collect();
    if name.is_empty() || name.starts_with(|first: char| first.is_ascii_digit()) {
        format!("camera_{name}")
    } else {
        name
    }
}

fn takes(held: &[FrameCamera]) -> Vec<Take<'_>> {
    let mut takes: Vec<Take<'_>> = Vec::new();
    for (index, frame) in held.iter().enumerate() {
        let (Some(pinhole), Some(size)) = (frame.pinhole(), frame.size) else { continue };
        let time = frame.frame_index.unwrap_or(index as u64);
        let name = prim_name(frame.camera.as_deref().unwrap_or_default());
        let goes_on = |take: &Take<'_>| {
            let follows = take.samples.last().is_some_and(|(last, _)| last + 1 == time);
            let same = take.samples.last().is_some_and(|(_, last)| last.principal_point == pinhole.principal_point);
            follows && same && take.size == size && take.name.starts_with(&name)
        };
        if let Some(take) = takes.last_mut().filter(|take| goes_on(take)) {
            take.samples.push((time, pinhole));
            continue;
        }
        let taken = |candidate: &String| takes.iter().any(|take| take.name == *candidate);
        let numbered = (1..).map(|number| if number == 1 { name.clone() } else { format!("{name}_take{number}") });
        let name = numbered.into_iter().find(|candidate| !taken(candidate)).unwrap_or(name);
        takes.push(Take { name, size, samples: vec![(time, pinhole)] });
    }
    takes
}

fn matrix_text(pinhole: &Pinhole) -> String {
    let axes: Mat3 = y_up() * pinhole.cam_from_world.transpose() * looking_back();
    let at = y_up() * pinhole.position_m * CM;
    let row = |column: usize| format!("({}, {}, {}, 0)", axes[(0, column)], axes[(1, column)], axes[(2, column)]);
    format!("( {}, {}, {}, ({}, {}, {}, 1) )", row(0), row(1), row(2), at.x, at.y, at.z)
}

fn push_take(take: &Take<'_>, aperture_mm: f64, text: &mut String) {
    let (width, height) = (f64::from(take.size.width), f64::from(take.size.height));
    let per_px = aperture_mm / width;
    let offset = take.samples.first().map_or([0.0; 2], |(_, first)| {
        [(width / 2.0 - first.principal_point.x) * per_px, (first.principal_point.y - height / 2.0) * per_px]
    });
    let samples = |of: &dyn Fn(&Pinhole) -> String| {
        let samples: Vec<String> =
            take.samples.iter().map(|(time, pinhole)| format!("{time}: {}", of(pinhole))).collect();
        samples.join(", ")
    };
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "    def Camera \"{}\"\n    {{\n        token projection = \"perspective\"\n        float2 clippingRange = (10, 100000)\n        \
         float horizontalAperture = {aperture_mm}\n        float verticalAperture = {}\n        \
         float horizontalApertureOffset = {}\n        float verticalApertureOffset = {}\n        \
         float focalLength.timeSamples = {{ {} }}\n        matrix4d xformOp:transform.timeSamples = {{ {} }}\n        \
         uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n",
        take.name,
        height * per_px,
        offset[0],
        offset[1],
        samples(&|pinhole| (pinhole.focal_px * per_px).to_string()),
        samples(&matrix_text),
    );
}

impl CameraFormat for Usda {
    fn hold(&self, frame: &FrameCamera, index: usize, _context: &WriteContext<'_>) -> Result<FrameCamera, String> {
        let (pinhole, _) = parts(frame)?;
        let camera = frame.camera.as_deref().unwrap_or_default();
        let time = frame.frame_index.unwrap_or(index as u64);
        Ok(with(frame, format!("{camera}@{time}"), Pinhole { lens: Radial::default(), ..pinhole }))
    }

    fn notes(&self, _frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let mut notes = vec!["USD keeps focal lengths as 32-bit floats: readers are within about 1e-3 px".to_owned()];
        if context.rate.is_none() {
            notes.push("the frame rate is not known; time codes are frame numbers without one (--fps)".to_owned());
        }
        if context.options.sensor_width_mm.is_none() {
            notes.push(format!(
                "the sensor's width is not known; lengths in mm are for a nominal {NOMINAL_MM} mm (--sensor-mm)"
            ));
        }
        notes
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> Result<Files, ExchangeError> {
        let takes = takes(held);
        let times = || takes.iter().flat_map(|take| take.samples.iter().map(|(time, _)| *time));
        let (first, last) = (times().min().unwrap_or(0), times().max().unwrap_or(0));
        let rate = context.rate.map(|rate| {
            let rate = rate.per_second();
            format!("    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}\n")
        });
        let sizes: Vec<String> = takes
            .iter()
            .map(|take| {
                format!("        int2 {}_image_size_px = ({}, {})\n", take.name, take.size.width, take.size.height)
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

    fn wanted(&self) -> &'static str {
        "stage (.usda)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "usda")
    }

    fn read(&self, _files: &Files, _options: &ImportOptions) -> Result<Vec<FrameCamera>, ExchangeError> {
        Err(ExchangeError::OneWay { format: Format::Usda, what: "imported", instead: "exported" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::tests::{exported, reference, text_of};

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let exported = exported(&reference(), Format::Usda);
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
    fn a_gap_begins_another_camera() {
        let mut document = super::super::tests::awkward();
        for (index, frame) in document.frames.iter_mut().enumerate() {
            frame.video.as_mut().unwrap().frame_index = if index < 5 { 100 } else { 200 } + index as u64;
        }
        let text = text_of(&exported(&document, Format::Usda).files, "camera.usda");
        assert_eq!(text.matches("def Camera").count(), 2, "{text}");
        assert!(text.contains("def Camera \"main_take2\""), "{text}");
        assert!(text.contains("startTimeCode = 100\n    endTimeCode = 211\n"), "{text}");
    }

    #[test]
    fn names_are_what_usd_accepts() {
        assert_eq!([prim_name("main 2"), prim_name("2"), prim_name("")], ["main_2", "camera_2", "camera_"]);
    }
}
