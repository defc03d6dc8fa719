//! Homographies as JSON lines, each with its conventions.
//!
//! The same nine numbers are in use in both directions, in several units and with two origins of
//! the pixels, and no value shows which is meant. So a line states direction, unit and pixels, and
//! one that leaves any of them out is refused.

use super::ground_homography::{corner_from, hold, inverse, matrix, normalise_homography};
use crate::exchange::cameras::camera_format::{CameraFormat, HeldFrame, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::held::relative_name;
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::node::{Node, parse, safe_path};
use crate::exchange::syntax::values::{shorten, side_px};
use serde_json::{Value, json};
use std::fmt::Write as _;
use touchline_core::field::YARD_M;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

/// JSON lines.
pub struct HomographyLines;

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
        return Err(Problem::wrong_count("h (rows)", 3, rows.count()?));
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
    fn about(&self) -> About {
        About {
            name: "homography",
            title: "homographies that state their direction",
            conventions: "pitch ← image in metres, pixels from the corner; each line says so",
            users: "scripts",
            loses: Some("lens, points off the ground, time, uncertainty"),
            file: Some("cameras.jsonl"),
            files: "homographies (.jsonl)",
            endings: &["jsonl"],
            export_options: format_options::HOMOGRAPHIES_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, context: &WriteContext<'_>) -> HeldFrame {
        hold(
            frame,
            safe_path(&relative_name(frame)).map_err(|problem| problem.to_string())?,
            context,
        )
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
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

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|_, bytes| {
            let lines = text(bytes)?
                .lines()
                .enumerate()
                .filter(|(_, line)| !line.trim().is_empty());
            let mut frames = FrameCollector::default();
            for (index, line) in lines {
                let read = read_line(line).map_err(|problem| problem.at_line(index + 1));
                frames.add(&format!("line {}", index + 1), None, read);
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
    use crate::exchange::tests::{awkward, export_as, pinhole_reference, text_of};

    #[test]
    fn awkward_homographies_come_back_from_their_lines() {
        let exported = export_as(&awkward(), Format::Homography);
        assert!(exported.worst_px < 1e-6, "{}", exported.worst_px);
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
    fn a_damaged_line_is_named_with_its_number() {
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
