//! Homographies: those of the World Cup 2014 set, those of the TS-WorldCup set, and JSON lines that
//! state their conventions.
//!
//! The homographies of both sets map a pixel (with the first pixel's centre as the origin) to a
//! template of 114.83 × 74.37 *yards* whose origin is the far left corner, y towards the camera.
//! Elsewhere H denotes the opposite direction, so the JSON lines state direction, unit and pixel
//! convention. A homography has neither distortion nor points off the ground: unless the user asks
//! for `undistorted`, the one that fits best over the visible pitch is written, and its error is
//! reported. Source: ericsujw/KpSFR (loaders).

use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext, has_ending, stem_of};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::ground_fit::fit_image_from_ground;
use crate::exchange::cameras::held::{parts, relative_name};
use crate::exchange::cameras::picture_size::SizeSource;
use crate::exchange::cameras::unreadable::read_frame_files;
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::{Files, stem, text};
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::node::{Node, parse, safe_path};
use crate::exchange::syntax::npy;
use crate::exchange::syntax::table::numbers;
use crate::exchange::syntax::values::{shorten, side_px};
use serde_json::{Value, json};
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::field::YARD_M;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

/// The template of both sets, yards.
const TEMPLATE_YD: [f64; 2] = [114.83, 74.37];
/// The pictures of both sets.
const SET_SIZE: ImageSize = ImageSize::new(1280, 720);
/// The ending of the World Cup 2014 set's files.
const WC14_ENDING: &str = "homographyMatrix";
/// The ending of the TS-WorldCup set's files behind the picture's name.
const TS_ENDING: &str = "_homography.npy";
/// The folder of the TS-WorldCup set's files.
const TS_FOLDER: &str = "Annotations/80_95";

/// The World Cup 2014 set.
pub struct Wc14;
/// The TS-WorldCup set.
pub struct TsWorldCup;
/// JSON lines.
pub struct HomographyLines;

/// The map from the ground (x and y in m, from the middle, y away from the camera) to a template of
/// this length and width (yards, from the far left corner, y down).
#[must_use]
pub fn template_from_ground([length, width]: [f64; 2]) -> Mat3 {
    Mat3::new(
        1.0 / YARD_M,
        0.0,
        0.5 * length,
        0.0,
        -1.0 / YARD_M,
        0.5 * width,
        0.0,
        0.0,
        1.0,
    )
}

/// The map from another pixel convention to ours, with the origin at the corner.
fn corner_from(pixels: Pixels) -> Mat3 {
    let shift = pixels.to_corner_px();
    Mat3::new(1.0, 0.0, shift, 0.0, 1.0, shift, 0.0, 0.0, 1.0)
}

/// Scaled so that the last entry is one, where it is not zero.
fn normalise_homography(h: Mat3) -> Mat3 {
    if h[(2, 2)] == 0.0 { h } else { h / h[(2, 2)] }
}

/// The inverse of a homography; an overflow counts as singular, too.
fn inverse(h: &Mat3, what: &str) -> Result<Mat3, Problem> {
    h.try_inverse()
        .filter(|inverse| inverse.iter().all(|entry| entry.is_finite()))
        .ok_or_else(|| Problem::Singular(what.to_owned()))
}

/// The homography from picture to template that a frame is written with.
fn template_from_image(frame: &FrameCamera) -> Option<Mat3> {
    let FrameProjection::Ground(image_from_ground) = &frame.shown else {
        return None;
    };
    let ground_from_image = image_from_ground.try_inverse()?;
    Some(normalise_homography(
        template_from_ground(TEMPLATE_YD) * ground_from_image * corner_from(Pixels::Centre),
    ))
}

/// The homography from ground (m) to picture (px), from one from picture to template as both sets
/// store it.
fn image_from_ground(template_from_image: &Mat3) -> Result<Mat3, Problem> {
    let image_from_template = inverse(template_from_image, "the homography")?;
    Ok(corner_from(Pixels::Centre) * image_from_template * template_from_ground(TEMPLATE_YD))
}

/// The homography of the camera's undistorted picture if the options ask for that, else of its
/// picture as it is. Exact without distortion and crown, else fitted.
fn hold(
    frame: &FrameCamera,
    name: String,
    context: &WriteContext<'_>,
) -> Result<FrameCamera, String> {
    let (pinhole, size) = parts(frame)?;
    // Without distortion and crown the homography is exact: K [r₁ r₂ t]. Else fit it.
    let ideal = Pinhole {
        lens: Radial::default(),
        ..pinhole
    };
    // The homography is of one picture: the one that is on disk, or the one without distortion that
    // the user makes of it.
    let shown_by = if context.options.undistorted {
        ideal
    } else {
        pinhole
    };
    let shown = if shown_by.lens.is_none() && context.field.crown_m == 0.0 {
        ideal.image_from_ground()
    } else {
        let fitted = fit_image_from_ground(&shown_by, size, context.field);
        fitted.ok_or("it shows too little of the pitch for a homography")?
    };
    if shown.try_inverse().is_none() {
        return Err("the ground is seen edge-on".to_owned());
    }
    Ok(FrameCamera {
        name,
        shown: FrameProjection::Ground(shown),
        ..frame.clone()
    })
}

/// Notes for the user about both sets.
fn notes(frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    let (length, width) = (context.field.length_m, context.field.width_m);
    let [template_length, template_width] = TEMPLATE_YD.map(|yards| yards * YARD_M);
    // The template is a rounded 105 × 68 m: 0.6 mm longer and 3.9 mm wider.
    if (length - template_length).abs() > 1e-3 || (width - template_width).abs() > 1e-2 {
        notes.push(format!(
            "the field is {length} × {width} m, written in its own yards; readers assume {} × {} yd ({template_length:.2} × \
             {template_width:.2} m)",
            TEMPLATE_YD[0], TEMPLATE_YD[1]
        ));
    }
    if let Some(size) = frames
        .iter()
        .find_map(|frame| frame.size)
        .filter(|size| *size != SET_SIZE)
    {
        notes.push(format!(
            "homographies are in px of {} × {}; readers of the set assume 1280 × 720 (--size 1280x720)",
            size.width, size.height
        ));
    }
    if context.options.undistorted {
        notes.push(
            "homographies are of pictures without distortion; undistort the pictures before they are used".to_owned(),
        );
    }
    notes
}

/// Nine numbers by rows.
fn matrix(values: &[f64]) -> Result<Mat3, Problem> {
    if values.len() == 9 {
        return Ok(Mat3::from_row_slice(values));
    }
    Err(Problem::Count {
        what: "the homography (numbers)".to_owned(),
        wanted: 9,
        found: values.len(),
    })
}

impl CameraFormat for Wc14 {
    fn size_source(&self) -> SizeSource {
        SizeSource::Assumed
    }

    fn hold(
        &self,
        frame: &FrameCamera,
        _index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        hold(frame, stem_of(frame), context)
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        notes(frames, context)
    }

    fn write(
        &self,
        held: &[FrameCamera],
        _context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut files = Files::default();
        for frame in held {
            let Some(h) = template_from_image(frame) else {
                continue;
            };
            let mut text = String::new();
            for row in h.row_iter() {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{:e} {:e} {:e}", row[0], row[1], row[2]);
            }
            files.add(format!("{}.{WC14_ENDING}", frame.name), text);
        }
        Ok(files)
    }

    fn file_description(&self) -> &'static str {
        "homographies (.homographyMatrix)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, WC14_ENDING)
    }

    fn read(
        &self,
        files: &Files,
        _options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        read_frame_files(&files.sorted_entries(), stem, |name, bytes| {
            let shown = image_from_ground(&matrix(&numbers("the homography", text(bytes)?)?)?)?;
            let shown = FrameProjection::Ground(shown);
            Ok(FrameCamera::new(name, Some(SET_SIZE), shown))
        })
    }
}

impl CameraFormat for TsWorldCup {
    fn size_source(&self) -> SizeSource {
        SizeSource::Assumed
    }

    fn hold(
        &self,
        frame: &FrameCamera,
        _index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        // The folder of a video is that of its camera; a slash or dots in its name would lead
        // elsewhere.
        let camera = frame
            .camera
            .as_deref()
            .unwrap_or("main")
            .replace(['/', '\\', '.'], "_");
        hold(frame, format!("{camera}/{}", stem_of(frame)), context)
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let order = "pictures and homographies are paired by their order: keep the same names in both folders";
        notes(frames, context)
            .into_iter()
            .chain([order.to_owned()])
            .collect()
    }

    fn write(
        &self,
        held: &[FrameCamera],
        _context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut files = Files::default();
        let mut videos: Vec<&str> = Vec::new();
        for frame in held {
            let Some(h) = template_from_image(frame) else {
                continue;
            };
            files.add(
                format!("{TS_FOLDER}/{}{TS_ENDING}", frame.name),
                npy::matrix_to_bytes(&h),
            );
            // The list of videos, by which the loaders find the folders, each once in the order of
            // the frames.
            let video = frame.name.split('/').next().unwrap_or_default();
            if !videos.contains(&video) {
                videos.push(video);
            }
        }
        files.add("test.txt", format!("{}\n", videos.join("\n")));
        Ok(files)
    }

    fn file_description(&self) -> &'static str {
        "homographies (…_homography.npy)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "npy")
    }

    fn read(
        &self,
        files: &Files,
        _options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        // The files of an export that are verified include the list of videos.
        let mut homographies = files.sorted_entries();
        homographies.retain(|(name, _)| self.is_wanted(name));
        read_frame_files(&homographies, ts_frame_name, |name, bytes| {
            let shown = FrameProjection::Ground(image_from_ground(&npy::matrix(bytes)?)?);
            Ok(FrameCamera::new(name, Some(SET_SIZE), shown))
        })
    }
}

/// The name of the frame of a file of the TS-WorldCup set, with the folder of its video.
fn ts_frame_name(file: &str) -> &str {
    let stem = file
        .strip_suffix(TS_ENDING)
        .or_else(|| file.strip_suffix(".npy"))
        .unwrap_or(file);
    stem.strip_prefix(TS_FOLDER)
        .map_or(stem, |rest| rest.trim_start_matches('/'))
}

/// The length of a unit, m.
fn unit_m(node: &Node<'_>) -> Result<f64, Problem> {
    match node.text()? {
        "m" => Ok(1.0),
        "yd" => Ok(YARD_M),
        "cm" => Ok(0.01),
        other => Err(Problem::Kind {
            what: "unit".to_owned(),
            wanted: "one of m, yd, cm",
            found: format!("{:?}", shorten(other)),
        }),
    }
}

fn read_line(line: &str) -> Result<FrameCamera, Problem> {
    // A line must state all three of its conventions: the same nine numbers are in use in both
    // directions and in several units, and no value shows which is meant.
    let value = parse(line.as_bytes())?;
    let node = Node::root(&value);
    let rows = node.key("h")?;
    if rows.count()? != 3 {
        return Err(Problem::Count {
            what: "h (rows)".to_owned(),
            wanted: 3,
            found: rows.count()?,
        });
    }
    let rows: Vec<[f64; 3]> = rows
        .items()?
        .map(|row| row.numbers())
        .collect::<Result<_, _>>()?;
    let h = matrix(&rows.concat())?;
    let unit = unit_m(&node.key("unit")?)?;
    let pixels = match node.key("pixels")?.text()? {
        "corner" => Pixels::Corner,
        "centre" => Pixels::Centre,
        other => {
            let found = format!("{:?}", shorten(other));
            return Err(Problem::Kind {
                what: "pixels".to_owned(),
                wanted: "corner or centre",
                found,
            });
        }
    };
    let image_from_pitch = match node.key("direction")?.text()? {
        "pitch_from_image" => inverse(&h, "h")?,
        "image_from_pitch" => h,
        other => {
            let wanted = "pitch_from_image or image_from_pitch";
            return Err(Problem::Kind {
                what: "direction".to_owned(),
                wanted,
                found: format!("{:?}", shorten(other)),
            });
        }
    };
    // Applied from right to left: metres to the unit of the file, to its pixels, to ours.
    let in_metres = Mat3::from_diagonal(&Vec3::new(1.0 / unit, 1.0 / unit, 1.0));
    let shown = corner_from(pixels) * image_from_pitch * in_metres;
    // Only to refuse a singular matrix, which no camera gives.
    inverse(&shown, "h")?;
    let image = node.key("image")?.image_name()?;
    let size = match node.find("size_px") {
        Some(size) => {
            let [width, height] = size.numbers()?;
            Some(ImageSize::new(
                side_px("size_px[0]", width)?,
                side_px("size_px[1]", height)?,
            ))
        }
        None => None,
    };
    Ok(FrameCamera {
        image: Some(image.clone()),
        ..FrameCamera::new(&image, size, FrameProjection::Ground(shown))
    })
}

impl CameraFormat for HomographyLines {
    fn hold(
        &self,
        frame: &FrameCamera,
        _index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        hold(
            frame,
            safe_path(&relative_name(frame)).map_err(|problem| problem.to_string())?,
            context,
        )
    }

    fn write(
        &self,
        held: &[FrameCamera],
        context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut text = String::new();
        for frame in held {
            let FrameProjection::Ground(image_from_ground) = &frame.shown else {
                continue;
            };
            let Some(h) = image_from_ground.try_inverse().map(normalise_homography) else {
                continue;
            };
            let rows: Vec<Value> = h
                .row_iter()
                .map(|row| json!([row[0], row[1], row[2]]))
                .collect();
            let line = json!({
                "image": frame.name,
                "direction": "pitch_from_image",
                "unit": "m",
                "pixels": "corner",
                "undistorted": context.options.undistorted,
                "size_px": frame.size.map(|size| [size.width, size.height]),
                "h": rows,
            });
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{line}");
        }
        Ok(Files::one("homographies.jsonl", text.into_bytes()))
    }

    fn file_description(&self) -> &'static str {
        "homographies (.jsonl)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "jsonl")
    }

    fn read(
        &self,
        files: &Files,
        _options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        files.read_all(|_, bytes| {
            let lines = text(bytes)?
                .lines()
                .enumerate()
                .filter(|(_, line)| !line.trim().is_empty());
            let frames = lines
                .map(|(index, line)| read_line(line).map_err(|problem| problem.at_line(index + 1)));
            frames.collect::<Result<Vec<_>, _>>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, export_as, reference, text_of};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;
    use touchline_core::geometry::Vec2;

    fn pinhole_reference() -> crate::document::Document {
        let mut document = reference();
        document.cameras[0].distortion = None;
        document
    }

    #[test]
    fn the_centre_mark_is_in_the_middle_of_the_template() {
        let text = text_of(
            &export_as(&pinhole_reference(), Format::Wc14).files,
            "0001.homographyMatrix",
        );
        let h = matrix(&numbers("h", &text).unwrap()).unwrap();
        // The pixel counts from the first one's centre.
        let template = h * Vec3::new(446.0813, 787.7564, 1.0);
        let template = template.xy() / template.z;
        assert!(
            (template - Vec2::new(57.415, 37.185)).norm() < 1e-4,
            "{template}"
        );
        assert_eq!(h[(2, 2)], 1.0);
    }

    #[test]
    fn a_distorted_picture_gives_the_nearest_homography_and_its_distance() {
        let distorted = export_as(&reference(), Format::Wc14);
        let loss = distorted.loss.unwrap();
        assert_eq!(loss.what, ["lens distortion", "points off the ground"]);
        assert!(
            loss.rms_px > 0.1 && loss.rms_px < 5.0 && loss.off_ground > 0,
            "{loss}"
        );
        let options = ExportOptions {
            undistorted: true,
            ..ExportOptions::default()
        };
        let flat = export(reference().at(Path::new("/")), Format::Wc14, &options).unwrap();
        let straight = export_as(&pinhole_reference(), Format::Wc14);
        assert_eq!(
            flat.files, straight.files,
            "of the picture without distortion"
        );
        assert!(
            flat.notes
                .iter()
                .any(|note| note.contains("undistort the pictures")),
            "{:?}",
            flat.notes
        );
    }

    #[test]
    fn awkward_homographies_come_back() {
        for format in [Format::Wc14, Format::TsWorldCup, Format::Homography] {
            let exported = export_as(&awkward(), format);
            assert!(exported.worst_px < 1e-6, "{format}: {}", exported.worst_px);
        }
    }

    #[test]
    fn the_other_direction_and_unit_mean_the_same() {
        let text = text_of(
            &export_as(&pinhole_reference(), Format::Homography).files,
            "homographies.jsonl",
        );
        let one = read_line(text.trim()).unwrap();
        let FrameProjection::Ground(shown) = one.shown else {
            panic!("a homography")
        };
        let in_yards = corner_from(Pixels::Centre).try_inverse().unwrap() * shown;
        let in_yards = in_yards * Mat3::from_diagonal(&Vec3::new(YARD_M, YARD_M, 1.0));
        let rows: Vec<Vec<f64>> = in_yards
            .row_iter()
            .map(|row| row.iter().copied().collect())
            .collect();
        let other = json!({ "image": "images/0001.jpg", "direction": "image_from_pitch", "unit": "yd", "pixels": "centre", "h": rows });
        let other = read_line(&other.to_string()).unwrap();
        let point = Vec3::new(20.0, 10.0, 0.0);
        let (a, b) = (
            one.image_from_world(point).unwrap(),
            other.image_from_world(point).unwrap(),
        );
        assert!(a.distance_px(b) < 1e-9, "{a:?} {b:?}");
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        for (text, wanted) in [
            ("", "the file is empty"),
            (
                "1 2 3\n4 5 6\n",
                "the homography (numbers): 9 are expected, found 6",
            ),
            (
                "1 2 3\n4 5 6\n7 8 nine\n",
                "the homography: a number is expected, found \"nine\"",
            ),
            (
                "1 2 3\n4 5 6\n7 8 nan\n",
                "the homography is not a finite number",
            ),
            ("0 0 0\n0 0 0\n0 0 0\n", "the homography is singular"),
            ("1 2 3\n2 4 6\n0 0 1\n", "the homography is singular"),
        ] {
            let files = Files::one("1.homographyMatrix", text.as_bytes().to_vec());
            let error = Wc14
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("1.homographyMatrix: {wanted}"));
        }
        let good = json!({ "image": "a.jpg", "direction": "pitch_from_image", "unit": "m", "pixels": "corner", "h": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] });
        let with = |key: &str, value: Value| {
            let mut line = good.clone();
            line[key] = value;
            line.to_string()
        };
        let mut silent = good.clone();
        silent.as_object_mut().unwrap().remove("direction");
        for (line, wanted) in [
            (silent.to_string(), "direction is missing"),
            (
                with("direction", json!("both")),
                "direction: pitch_from_image or image_from_pitch is expected, found \"both\"",
            ),
            (
                with("unit", json!("ft")),
                "unit: one of m, yd, cm is expected, found \"ft\"",
            ),
            (
                with("pixels", json!("middle")),
                "pixels: corner or centre is expected, found \"middle\"",
            ),
            (
                with("h", json!([[1.0, 0.0], [0.0, 1.0]])),
                "h (rows): 3 are expected, found 2",
            ),
            (
                with(
                    "h",
                    json!([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
                ),
                "h is singular",
            ),
            (
                with("image", json!("../a.jpg")),
                "the path \"../a.jpg\" points outside the folder",
            ),
            (
                with("image", json!("/a.jpg")),
                "the path \"/a.jpg\" points outside the folder",
            ),
        ] {
            let files = Files::one("a.jsonl", line.into_bytes());
            let error = HomographyLines
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.jsonl: line 1: {wanted}"));
        }
    }
}
