//! OpenCV's `FileStorage` YAML, one file per frame: `image_width`, `image_height`, `camera_matrix`,
//! `distortion_coefficients` (k1 k2 p1 p2 k3), `rvec` (Rodrigues) and `tvec` (−R C).
//!
//! World and camera axes are ours, metres; pixels count from the first one's centre, so the
//! principal point is ours − 0.5.

use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::unreadable::read_frame_files;
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::{Files, stem, text};
use crate::exchange::format::About;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::table::number;
use crate::exchange::syntax::values::{
    coefficient, refuse_further_coefficients, refuse_skewed_pixels, shorten, side_px,
};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::geometry::rotation::{from_rotation_vector, rotation_vector};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};

/// The format.
pub struct OpenCvYaml;

/// The tag of a matrix.
const MATRIX: &str = "!!opencv-matrix";

fn push_matrix(name: &str, rows: usize, columns: usize, data: &[f64], into: &mut String) {
    // `{:?}` writes all digits and a decimal point in every number, as OpenCV does.
    let data: Vec<String> = data.iter().map(|value| format!("{value:?}")).collect();
    // Writing to a string cannot fail.
    let _ = write!(
        into,
        "{name}: {MATRIX}\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {} ]\n",
        data.join(", ")
    );
}

fn yaml(frame: &FrameCamera, pinhole: &Pinhole, size: ImageSize) -> String {
    let mut text = format!(
        "%YAML:1.0\n---\n# {}: world in metres from the field's middle, x right, y away, z up; pixels from the first one's \
         centre\nimage_width: {}\nimage_height: {}\n",
        frame.name, size.width, size.height
    );
    let (f, shift) = (pinhole.focal_px, Pixels::Centre.to_corner_px());
    let (cx, cy) = (
        pinhole.principal_point.x - shift,
        pinhole.principal_point.y - shift,
    );
    push_matrix(
        "camera_matrix",
        3,
        3,
        &[f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        &mut text,
    );
    push_matrix(
        "distortion_coefficients",
        1,
        5,
        &[pinhole.lens.k1, pinhole.lens.k2, 0.0, 0.0, 0.0],
        &mut text,
    );
    push_matrix(
        "rvec",
        3,
        1,
        rotation_vector(&pinhole.cam_from_world).as_slice(),
        &mut text,
    );
    push_matrix("tvec", 3, 1, pinhole.translation().as_slice(), &mut text);
    text
}

/// The numbers of a file, by the name of their entry.
type Entries = BTreeMap<String, Vec<f64>>;

/// The plain numbers and the matrices' data of a file, by name. Other lines are ignored.
fn entries(text: &str) -> Result<Entries, Problem> {
    let mut found = Entries::new();
    // OpenCV writes a small part of YAML: entries begin at the margin, and the lines of a matrix
    // are indented. So the file is read line by line.
    let mut lines = text.lines().enumerate().peekable();
    while let Some((index, line)) = lines.next() {
        let Some((key, value)) = line
            .split_once(':')
            .filter(|_| !line.starts_with(['%', '#', ' ', '-']))
        else {
            continue;
        };
        let (key, value) = (key.trim().to_owned(), value.trim());
        let line_number = index + 1;
        // A matrix: collect the indented lines from `data:` up to the closing bracket.
        let values = if value.starts_with(MATRIX) || value.is_empty() {
            let mut data = String::new();
            let mut is_open = false;
            while let Some((_, inner)) = lines
                .peek()
                .filter(|(_, inner)| inner.starts_with([' ', '\t']))
            {
                if let Some((_, list)) = inner.split_once("data:") {
                    is_open = true;
                    data.push_str(list);
                } else if is_open {
                    data.push_str(inner);
                }
                is_open &= !inner.contains(']');
                lines.next();
            }
            if is_open || (value.starts_with(MATRIX) && data.is_empty()) {
                let problem = Problem::Kind {
                    what: key,
                    wanted: "data: [ … ]",
                    found: "a list that does not end".to_owned(),
                };
                return Err(problem.at_line(line_number));
            }
            let list = data.trim().trim_start_matches('[').trim_end_matches(']');
            let items = list
                .split(',')
                .map(str::trim)
                .filter(|item| !item.is_empty());
            items
                .map(|item| number(&key, item))
                .collect::<Result<Vec<_>, _>>()
                .map_err(|problem| problem.at_line(line_number))?
        } else {
            // Texts such as a camera's name are skipped.
            number(&key, value).into_iter().collect()
        };
        if found.insert(key.clone(), values).is_some() {
            let problem = Problem::Twice {
                what: "the key",
                name: shorten(&key),
            };
            return Err(problem.at_line(line_number));
        }
    }
    Ok(found)
}

fn camera(bytes: &[u8]) -> Result<(Pinhole, ImageSize), Problem> {
    let entries = entries(text(bytes)?)?;
    let size = ImageSize::new(
        side(&entries, "image_width")?,
        side(&entries, "image_height")?,
    );
    // By rows: f 0 cx, 0 f cy, 0 0 1.
    let k = values_of(&entries, "camera_matrix", 9)?;
    refuse_skewed_pixels(k[0], k[4], k[1])?;
    // OpenCV writes 4, 5, 8, 12 or 14 coefficients, k1 and k2 first; without the entry there is no
    // distortion.
    let lens = entries
        .get("distortion_coefficients")
        .map_or(&[][..], Vec::as_slice);
    refuse_further_coefficients(lens.get(2..).unwrap_or_default())?;
    let rotation = Vec3::from_column_slice(values_of(&entries, "rvec", 3)?);
    let translation = Vec3::from_column_slice(values_of(&entries, "tvec", 3)?);
    let cam_from_world = from_rotation_vector(rotation);
    let shift = Pixels::Centre.to_corner_px();
    let pinhole = Pinhole {
        cam_from_world,
        position_m: -(cam_from_world.transpose() * translation),
        focal_px: k[0],
        principal_point: ImagePoint::new(k[2] + shift, k[5] + shift),
        lens: Radial {
            k1: coefficient(lens, 0),
            k2: coefficient(lens, 1),
        },
    };
    Ok((pinhole.validate("the camera")?, size))
}

/// The numbers of an entry, which must be this many.
fn values_of<'a>(entries: &'a Entries, key: &str, wanted: usize) -> Result<&'a [f64], Problem> {
    let values = entries
        .get(key)
        .ok_or_else(|| Problem::Missing(key.to_owned()))?;
    if values.len() == wanted {
        return Ok(values);
    }
    // `entries` keeps a key with a text, without numbers.
    if values.is_empty() {
        return Err(Problem::Kind {
            what: key.to_owned(),
            wanted: if wanted == 1 { "a number" } else { "a matrix" },
            found: "a text".to_owned(),
        });
    }
    Err(Problem::Count {
        what: format!("{key} (numbers)"),
        wanted,
        found: values.len(),
    })
}

/// A side of the picture, px.
fn side(entries: &Entries, key: &str) -> Result<u32, Problem> {
    side_px(key, values_of(entries, key, 1)?[0])
}

impl CameraFormat for OpenCvYaml {
    fn about(&self) -> About {
        About {
            name: "opencv",
            title: "OpenCV FileStorage YAML, one file per frame",
            conventions: "touchline's world → camera, rvec and tvec; pixel centres at whole numbers",
            users: "OpenCV FileStorage, robotics",
            loses: Some("time, uncertainty"),
            file: None,
            files: "camera files (.yml)",
            endings: &["yml", "yaml"],
            options: &[],
        }
    }

    fn write(
        &self,
        held: &[FrameCamera],
        _context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut files = Files::default();
        for frame in held {
            if let (Some(pinhole), Some(size)) = (frame.pinhole(), frame.size) {
                files.add(format!("{}.yml", frame.name), yaml(frame, pinhole, size));
            }
        }
        Ok(files)
    }

    fn read(
        &self,
        files: &Files,
        _options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        read_frame_files(&files.sorted_entries(), stem, |name, bytes| {
            let (pinhole, size) = camera(bytes)?;
            Ok(FrameCamera::new(
                name,
                Some(size),
                FrameProjection::Camera(pinhole),
            ))
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
        let text = text_of(&export_as(&reference(), Format::OpenCv).files, "0001.yml");
        let entries = entries(&text).unwrap();
        assert_eq!(
            entries["camera_matrix"],
            [2410.0, 0.0, 959.5, 0.0, 2410.0, 539.5, 0.0, 0.0, 1.0]
        );
        for (found, wanted) in
            entries["rvec"]
                .iter()
                .zip([1.7584451699, -0.1925810670, 0.1581878718])
        {
            assert!((found - wanted).abs() < 1e-10, "{text}");
        }
        for (found, wanted) in
            entries["tvec"]
                .iter()
                .zip([-12.986376836286173, 6.279379503790085, 60.95837440182727])
        {
            assert!((found - wanted).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn awkward_cameras_come_back() {
        let exported = export_as(&awkward(), Format::OpenCv);
        assert!(
            exported.loss.is_none() && exported.worst_px < 1e-6,
            "{exported:?}"
        );
    }

    #[test]
    fn lists_may_go_over_lines_as_opencv_breaks_them() {
        let one = text_of(&export_as(&reference(), Format::OpenCv).files, "0001.yml");
        let broken = one.replace("959.5, ", "959.5,\n       ");
        assert_ne!(one, broken);
        assert_eq!(camera(one.as_bytes()), camera(broken.as_bytes()));
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good = text_of(&export_as(&reference(), Format::OpenCv).files, "0001.yml");
        let swap = |from: &str, to: &str| good.replacen(from, to, 1);
        for (text, wanted) in [
            (String::new(), "the file is empty"),
            ("%YAML:1.0\n---\n".to_owned(), "image_width is missing"),
            (swap("rvec", "om"), "rvec is missing"),
            (
                swap("image_width: 1920", "image_width: 0"),
                "image_width is 0, which must be a whole number from 1 to 65535",
            ),
            (
                swap("image_width: 1920", "image_width: many"),
                "image_width: a number is expected, found a text",
            ),
            (
                swap(
                    "2410.0, 0.0, 959.5, 0.0, 2410.0",
                    "2410.0, 0.0, 959.5, 0.0, 2400.0",
                ),
                "focal lengths 2410 and 2400 px, skew 0 cannot be read: pixels must be square",
            ),
            (
                swap("959.5, ", ""),
                "camera_matrix (numbers): 9 are expected, found 8",
            ),
            (
                swap("959.5", ".nan"),
                "line 6: camera_matrix: a number is expected, found \".nan\"",
            ),
            (
                swap("959.5", "nan"),
                "line 6: camera_matrix is not a finite number",
            ),
            (
                swap("0.0661, 0.0, 0.0", "0.0661, 0.0, 0.2"),
                "a distortion coefficient of 0.2 beyond k1 and k2 cannot be read: the document's lens has k1 and k2 only",
            ),
            (
                good.replace("tvec", "rvec"),
                "line 21: the key \"rvec\" occurs twice",
            ),
            (
                good[..good.len() - 3].to_owned(),
                "line 21: tvec: data: [ … ] is expected, found a list that does not end",
            ),
        ] {
            let files = Files::one("a.yml", text.into_bytes());
            let error = OpenCvYaml
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.yml: {wanted}"));
        }
    }
}
