//! OpenCV's `FileStorage` YAML, one file per frame: `image_width`, `image_height`, `camera_matrix`,
//! `distortion_coefficients` (k1 k2 p1 p2 k3), `rvec` (Rodrigues) and `tvec` (−R C). Its XML and
//! JSON are read too, and `R` and `T` in place of the vectors.
//!
//! World and camera axes are ours, metres; pixels count from the first one's centre, so the
//! principal point is ours − 0.5.

use crate::exchange::cameras::calibration_matrix::Calibration;
use crate::exchange::cameras::camera_format::{CameraFormat, WriteContext, has_ending};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::table::{number, numbers};
use crate::exchange::syntax::values::{coefficient, refuse_further_coefficients, shorten, side_px};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::geometry::rotation::{from_rotation_vector, rotation_vector};
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

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
        &[
            f,
            0.0,
            cx,
            0.0,
            f * pinhole.lens.pixel_aspect,
            cy,
            0.0,
            0.0,
            1.0,
        ],
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
            let problem = Problem::twice("the key", shorten(&key));
            return Err(problem.at_line(line_number));
        }
    }
    Ok(found)
}

/// The entries of any of the three forms of `FileStorage`.
fn entries_of_file(name: &str, bytes: &[u8]) -> Result<Entries, Problem> {
    if has_ending(name, "json") {
        return entries_of_json(bytes);
    }
    if has_ending(name, "xml") {
        return entries_of_xml(text(bytes)?);
    }
    entries(text(bytes)?)
}

/// The numbers and matrices of JSON.
fn entries_of_json(bytes: &[u8]) -> Result<Entries, Problem> {
    let value = parse(bytes)?;
    let mut found = Entries::new();
    for (key, node) in Node::root(&value).entries()? {
        let values = match node.find("data") {
            Some(data) => data.all_numbers()?,
            // Texts such as a camera's name are skipped.
            None => node.number().into_iter().collect(),
        };
        found.insert(key.to_owned(), values);
    }
    Ok(found)
}

/// The numbers and matrices of XML.
fn entries_of_xml(text: &str) -> Result<Entries, Problem> {
    let xml =
        roxmltree::Document::parse(text).map_err(|error| Problem::NotXml(error.to_string()))?;
    let mut found = Entries::new();
    let entries = xml.root_element().children();
    for entry in entries.filter(roxmltree::Node::is_element) {
        let key = entry.tag_name().name();
        let data = entry.children().find(|child| child.has_tag_name("data"));
        let values = match data.and_then(|data| data.text()) {
            Some(data) => numbers(key, data)?,
            None => number(key, entry.text().unwrap_or_default().trim())
                .into_iter()
                .collect(),
        };
        found.insert(key.to_owned(), values);
    }
    Ok(found)
}

/// The rotation from `world` to `cam`: a vector of Rodrigues, or a matrix by rows.
fn rotation_of(entries: &Entries) -> Result<Mat3, Problem> {
    if entries.contains_key("R") && !entries.contains_key("rvec") {
        return Ok(Mat3::from_row_slice(values_of(entries, "R", 9)?));
    }
    let vector = Vec3::from_column_slice(values_of(entries, "rvec", 3)?);
    Ok(from_rotation_vector(vector))
}

/// The picture's size: the file's, else that of the options.
fn size_of(entries: &Entries, options: &ImportOptions) -> Result<ImageSize, Problem> {
    if let Some(size) = options
        .size
        .filter(|_| !entries.contains_key("image_width"))
    {
        return Ok(size);
    }
    if !entries.contains_key("image_width") {
        return Err(Problem::option_needed(
            "the size of the picture (image_width, image_height)",
            "--size WIDTHxHEIGHT",
        ));
    }
    Ok(ImageSize::new(
        side(entries, "image_width")?,
        side(entries, "image_height")?,
    ))
}

/// The frame of a file.
fn read_file(
    (file, name): (&str, &str),
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<FrameCamera, Problem> {
    let entries = entries_of_file(file, bytes)?;
    // By rows: f 0 cx, 0 f cy, 0 0 1.
    let mut k = [0.0; 9];
    k.copy_from_slice(values_of(&entries, "camera_matrix", 9)?);
    let size = size_of(&entries, options)?;
    let taken = Calibration::from_rows(&k, Pixels::Centre)?.without_skew(size)?;
    // OpenCV writes 4, 5, 8, 12 or 14 coefficients, k1 and k2 first; without the entry there is no
    // distortion.
    let lens = entries
        .get("distortion_coefficients")
        .map_or(&[][..], Vec::as_slice);
    refuse_further_coefficients(lens.get(2..).unwrap_or_default())?;
    let cam_from_world = rotation_of(&entries)?;
    let key = if entries.contains_key("T") && !entries.contains_key("tvec") {
        "T"
    } else {
        "tvec"
    };
    let translation = Vec3::from_column_slice(values_of(&entries, key, 3)?);
    let pinhole = Pinhole {
        cam_from_world,
        position_m: -(cam_from_world.transpose() * translation),
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        lens: Radial {
            k1: coefficient(lens, 0),
            k2: coefficient(lens, 1),
            pixel_aspect: taken.pixel_aspect,
        },
    };
    let shown = FrameProjection::Camera(pinhole.validate("the camera")?);
    Ok(FrameCamera {
        off_px: taken.off_px,
        ..FrameCamera::new(name, Some(size), shown)
    })
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
    Err(Problem::wrong_count(
        format!("{key} (numbers)"),
        wanted,
        values.len(),
    ))
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
            files: "camera files (.yml, .xml, .json)",
            endings: &["yml", "yaml", "xml", "json"],
            export_options: format_options::CAMERAS_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut files = Files::default();
        for frame in held {
            if let (Some(pinhole), Some(size)) = (frame.pinhole(), frame.size) {
                files.add(format!("{}.yml", frame.name), yaml(frame, pinhole, size));
            }
        }
        Ok(files)
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        // XML and JSON may be anything, beside the YAML that is meant.
        let mut sorted = files.sorted_entries();
        if sorted.len() > 1 {
            sorted.retain(|(name, bytes)| is_yaml(name) || has_camera(bytes));
        }
        let mut frames = FrameCollector::default();
        for (file, bytes) in &sorted {
            let name = stem(file);
            frames.add(name, Some(file), read_file((file, name), bytes, options));
        }
        let first = sorted.first().map_or("", |(file, _)| *file);
        frames.finish().map_err(|problem| problem.within(first))
    }
}

fn is_yaml(name: &str) -> bool {
    has_ending(name, "yml") || has_ending(name, "yaml")
}

/// Whether a file speaks of a calibration matrix.
fn has_camera(bytes: &[u8]) -> bool {
    let wanted = b"camera_matrix";
    bytes.windows(wanted.len()).any(|window| window == wanted)
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
        assert_eq!(entries(&one), entries(&broken));
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good = text_of(&export_as(&reference(), Format::OpenCv).files, "0001.yml");
        let swap = |from: &str, to: &str| good.replacen(from, to, 1);
        for (text, wanted) in [
            (String::new(), "the file is empty"),
            ("%YAML:1.0\n---\n".to_owned(), "camera_matrix is missing"),
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
                    "2410.0, 3.0, 959.5, 0.0, 2410.0",
                ),
                "a skew of 3 px: without it the picture is 0.67 px off; up to 0.1 px is taken; \
                 resample the picture to upright pixels",
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

    #[test]
    fn the_other_forms_of_the_storage_mean_the_same() {
        let yaml = text_of(&export_as(&reference(), Format::OpenCv).files, "0001.yml");
        let read = |name: &str, text: String, options: &ImportOptions| {
            let files = Files::one(name, text.into_bytes());
            OpenCvYaml.read(&files, options).unwrap().remove(0)
        };
        let stated = ImportOptions::default();
        let wanted = read("0001.yml", yaml.clone(), &stated);
        let entries = entries(&yaml).unwrap();
        let mut json = serde_json::Map::new();
        let mut xml = "<?xml version=\"1.0\"?>\n<opencv_storage>".to_owned();
        for (key, values) in &entries {
            let texts: Vec<String> = values.iter().map(ToString::to_string).collect();
            if let [value] = values[..] {
                json.insert(key.clone(), value.into());
                let _ = write!(xml, "<{key}>{value}</{key}>");
            } else {
                json.insert(
                    key.clone(),
                    serde_json::json!({ "dt": "d", "data": values }),
                );
                let _ = write!(
                    xml,
                    "<{key} type_id=\"opencv-matrix\"><dt>d</dt><data>{}</data></{key}>",
                    texts.join(" ")
                );
            }
        }
        xml.push_str("</opencv_storage>");
        let json = serde_json::Value::Object(json).to_string();
        assert_eq!(read("0001.json", json, &stated), wanted);
        assert_eq!(read("0001.xml", xml, &stated), wanted);
        // A matrix in place of the vector, and the size from the option.
        let rotation = wanted.pinhole().unwrap().cam_from_world;
        let rows: Vec<String> = rotation
            .transpose()
            .iter()
            .map(ToString::to_string)
            .collect();
        let at = yaml.find("rvec:").unwrap();
        let end = yaml.find("tvec:").unwrap();
        let matrix = format!(
            "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n",
            rows.join(", ")
        );
        let other = format!(
            "{}{matrix}{}",
            &yaml[..at],
            yaml[end..].replace("tvec:", "T:")
        );
        let other = other.replace("image_width: 1920\nimage_height: 1080\n", "");
        let sized = ImportOptions {
            size: Some(ImageSize::new(1920, 1080)),
            ..ImportOptions::default()
        };
        let again = read("0001.yml", other, &sized);
        let [one, two] = [&wanted, &again].map(|frame| *frame.pinhole().unwrap());
        assert!((one.cam_from_world - two.cam_from_world).amax() < 1e-15);
        assert!((one.position_m - two.position_m).amax() < 1e-12);
    }
}
