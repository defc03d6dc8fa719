//! Finds the format of files by their endings and contents.
//!
//! A few files of each ending are read. JSON is recognized by its keys, tables by their columns,
//! other files by their ending or first bytes. Files that cannot be read or belong to no format are
//! ignored, so that one damaged file in a folder does not matter. Where files of several formats
//! lie together, the user decides.

use super::lookalike::Lookalike;
use crate::exchange::camera_formats::lens_table::FOCAL_COLUMNS;
use crate::exchange::click_formats::labels::place_of_label;
use crate::exchange::click_formats::points_table::COLUMNS as POINT_COLUMNS;
use crate::exchange::click_formats::soccernet_pictures::ManyPictures;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, base_name, ending_of, refuse_archive, text};
use crate::exchange::format::Format;
use crate::exchange::registry::{Codec, codec};
use crate::exchange::syntax::node::parse;
use crate::exchange::syntax::table::{Table, numbers};
use serde_json::Value;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The most files that are read from a folder, and the most whose names differ in numbers only.
const MAX_FILES: usize = 64;
const MAX_ALIKE: usize = 6;
/// The length of a `FreeD` packet, bytes, and its first byte.
const FREED_PACKET: (usize, u8) = (29, 0xd1);

/// The format of a file, or of the files in a folder.
///
/// # Errors
/// Nothing can be read there, or the files are of no known format or of several.
pub fn recognize_format(path: &Path) -> Result<Format, ExchangeError> {
    let is_folder = path.is_dir();
    // `Files::read` takes a function that changes nothing; the counts of the sample are behind a
    // cell.
    let sample = RefCell::new(Sample::default());
    let files = Files::read(path, &|name| sample.borrow_mut().takes(name))?;
    let found: BTreeSet<Format> = files
        .sorted_entries()
        .into_iter()
        .filter_map(|(name, bytes)| {
            let format = format_of_file(name, bytes)?;
            (!is_folder || is_read_from_folder(format, name)).then_some(format)
        })
        .collect();
    let formats: Vec<Format> = found.into_iter().collect();
    match formats[..] {
        [format] => Ok(format),
        [] => {
            if let (false, [(name, bytes)]) = (is_folder, &files.sorted_entries()[..]) {
                refuse_archive(bytes).map_err(|problem| problem.within(name))?;
            }
            let entries = files.sorted_entries();
            let mut known = entries
                .iter()
                .filter_map(|(name, bytes)| Lookalike::from_file(name, bytes));
            Err(ExchangeError::UnknownFormat {
                path: path.to_path_buf(),
                hint: known.next().map(Lookalike::hint),
            })
        }
        _ => Err(ExchangeError::SeveralFormats {
            path: path.to_path_buf(),
            formats,
        }),
    }
}

/// The choice of a few files of each kind.
#[derive(Default)]
struct Sample {
    taken: usize,
    /// How many were taken of each name without its numbers.
    alike: BTreeMap<String, usize>,
}

impl Sample {
    /// Whether a file is read.
    fn takes(&mut self, name: &str) -> bool {
        if self.taken == MAX_FILES || !is_ending_of_format(&ending_of(name)) {
            return false;
        }
        // Thousands of files with names that differ in their numbers are of one format.
        let kind = name.replace(|letter: char| letter.is_ascii_digit(), "");
        let alike = self.alike.entry(kind).or_default();
        // More than one, because some of them may be damaged.
        let takes = *alike < MAX_ALIKE;
        *alike += usize::from(takes);
        self.taken += usize::from(takes);
        takes
    }
}

/// Whether some format has files of this ending.
fn is_ending_of_format(ending: &str) -> bool {
    let mut endings = Format::all().flat_map(|format| format.about().endings);
    endings.any(|known| known.eq_ignore_ascii_case(ending))
}

/// Whether the import of a folder in a format reads a file of this name.
fn is_read_from_folder(format: Format, name: &str) -> bool {
    match codec(format) {
        Codec::Cameras(codec) => codec.is_wanted(name),
        Codec::Clicks(codec) => codec.is_wanted(name),
        Codec::Documents(_) => true,
    }
}

/// The format of a file; none where it is damaged or of no known format.
fn format_of_file(name: &str, bytes: &[u8]) -> Option<Format> {
    match ending_of(name).as_str() {
        "npz" => Some(Format::Fifa),
        "npy" => Some(Format::TsWorldCup),
        "mat" => Some(Format::AuthorsMat),
        "chan" => Some(Format::Chan),
        "homographymatrix" => Some(Format::Wc14),
        // Any program may write a `.bin`.
        "freed" | "bin" => is_freed(bytes).then_some(Format::FreeD),
        "csv" => format_of_table(bytes),
        "yml" | "yaml" => format_of_yaml(text(bytes).ok()?),
        "xml" => format_of_xml(text(bytes).ok()?),
        _ => format_of_text(name, bytes),
    }
}

fn is_freed(bytes: &[u8]) -> bool {
    let (length, first) = FREED_PACKET;
    bytes.first() == Some(&first) && bytes.len().is_multiple_of(length)
}

fn format_of_table(bytes: &[u8]) -> Option<Format> {
    let table = Table::read(bytes).ok()?;
    if table.needs(&["r11", "focal_px"]).is_ok() {
        return Some(Format::Csv);
    }
    if table.needs(&["homography_matrix"]).is_ok() {
        return Some(Format::Homographies);
    }
    if table.needs(&POINT_COLUMNS).is_ok() {
        return Some(Format::Points);
    }
    let mut focal = FOCAL_COLUMNS.iter();
    if focal.any(|column| table.needs(&[column]).is_ok()) {
        return Some(Format::Lens);
    }
    let has_zoom = table.needs(&["pan_deg", "zoom_raw"]).is_ok();
    has_zoom.then_some(Format::FreeDCsv)
}

fn format_of_xml(text: &str) -> Option<Format> {
    if text.contains("<opencv_storage") {
        return Some(Format::OpenCv);
    }
    text.contains("<annotations").then_some(Format::Cvat)
}

fn format_of_yaml(text: &str) -> Option<Format> {
    if text.contains("camera_matrix") {
        Some(Format::OpenCv)
    } else {
        text.contains("kpt_shape").then_some(Format::YoloPose)
    }
}

/// The format of JSON, JSON lines, or a text of numbers.
fn format_of_text(name: &str, bytes: &[u8]) -> Option<Format> {
    // A whole file of JSON first: the first line of an indented file is a bare brace.
    if let Ok(value) = parse(bytes) {
        return format_of_json(name, &value);
    }
    let text = text(bytes).ok()?;
    let first = text.lines().find(|line| !line.trim().is_empty())?;
    if let Ok(value) = parse(first.as_bytes()) {
        return format_of_json(name, &value);
    }
    // These names are Colmap's alone. Other texts are known by how many numbers they have.
    if matches!(base_name(name), "cameras.txt" | "images.txt") {
        return Some(Format::Colmap);
    }
    if numbers("a number", text).is_ok_and(|values| values.len() == 9) {
        return Some(Format::Wc14);
    }
    // A line of YOLO's keypoints: a class, a box, and three numbers a point.
    let values = numbers("a number", first).ok()?;
    let is_pose = values.len() > 5 && (values.len() - 5).is_multiple_of(3);
    let is_class = values.first().is_some_and(|class| class.fract() == 0.0);
    let is_box = is_pose && values[1..5].iter().all(|side| (0.0..=1.0).contains(side));
    (is_class && is_box).then_some(Format::YoloPose)
}

fn format_of_json(name: &str, value: &Value) -> Option<Format> {
    if let Some(items) = value.as_array() {
        return format_of_list(items);
    }
    if value.get("format").and_then(Value::as_str) == Some("touchline") {
        return Some(Format::Json);
    }
    // The first entry counts of which the object has all keys.
    let keys: [(&[&str], Format); 9] = [
        (&["camera_matrix"], Format::OpenCv),
        (&["cam_params"], Format::PnlCalib),
        (&["parameters"], Format::PnlCalib),
        (&["direction", "h"], Format::Homography),
        (&["transforms", "lens"], Format::OpenTrackIo),
        (&["calibration"], Format::DeepSport),
        (&["shapes"], Format::Labelme),
        (&["data", "annotations"], Format::LabelStudio),
        (&["data", "completions"], Format::LabelStudio),
    ];
    if is_camera(value) {
        // The keys are the same; SoccerNet's evaluator reads files by their prefix.
        let is_soccernet = base_name(name).starts_with("camera_");
        return Some(if is_soccernet {
            Format::SoccerNet
        } else {
            Format::PnlCalib
        });
    }
    if is_by_places(value) {
        return Some(Format::Points);
    }
    if ManyPictures::recognize(name, value).is_some() {
        return Some(Format::SoccerNetLines);
    }
    // Many files about pictures have such lists; COCO's pictures have an id.
    let lists = ["images", "annotations", "categories"];
    if lists
        .iter()
        .all(|key| value.get(key).is_some_and(Value::is_array))
    {
        let first = value["images"].get(0);
        let is_coco = first.is_none_or(|image| image.get("id").is_some());
        return is_coco.then_some(Format::Coco);
    }
    let by_keys = keys
        .into_iter()
        .find(|(keys, _)| keys.iter().all(|key| value.get(key).is_some()));
    by_keys
        .map(|(_, format)| format)
        .or_else(|| format_by_values(value))
}

/// Whether an object has the keys of a camera of the `SoccerNet` challenge.
fn is_camera(value: &Value) -> bool {
    value.get("pan_degrees").is_some() && value.get("x_focal_length").is_some()
}

/// Whether an object has a point at each key that is a place on the field.
fn is_by_places(value: &Value) -> bool {
    let mut keys = value
        .as_object()
        .into_iter()
        .flat_map(|object| object.keys());
    keys.next()
        .is_some_and(|first| place_of_label(first).is_some())
        && keys.all(|key| place_of_label(key).is_some())
}

fn format_of_list(items: &[Value]) -> Option<Format> {
    items.iter().find_map(|item| {
        if is_camera(item) {
            return Some(Format::PnlCalib);
        }
        if ["K", "kc", "R", "T"]
            .iter()
            .all(|key| item.get(key).is_some())
        {
            return Some(Format::DeepSport);
        }
        if item.get("transforms").is_some() && item.get("lens").is_some() {
            return Some(Format::OpenTrackIo);
        }
        // A task of Label Studio, or one of its flat form JSON-MIN.
        let is_task = item.get("data").is_some() || item.get("image").is_some();
        is_task.then_some(Format::LabelStudio)
    })
}

/// The format of an object with names for keys: pictures with cameras, or lines with points.
fn format_by_values(value: &Value) -> Option<Format> {
    value.as_object()?.values().find_map(|value| {
        if value.get("cp").is_some() {
            return Some(Format::BroadTrack);
        }
        let point = value.as_array()?.first()?;
        let is_point = point.get("x").is_some() && point.get("y").is_some();
        is_point.then_some(Format::SoccerNetLines)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::tests::{awkward, export_as, with_clicks};
    use std::fs;

    #[test]
    fn what_this_program_writes_is_recognized() {
        for format in Format::all() {
            if !format.exports() || !format.imports() {
                continue;
            }
            let document = if format.is_of_points() {
                with_clicks()
            } else {
                awkward()
            };
            let folder = tempfile::tempdir().unwrap();
            let files = export_as(&document, format).files;
            let names = files.sorted_entries();
            let path = if format.is_folder() {
                folder.path().join("files")
            } else {
                folder.path().join(names[0].0)
            };
            files.write(&path, format.is_folder(), false).unwrap();
            assert_eq!(recognize_format(&path).unwrap(), format, "{names:?}");
        }
    }

    #[test]
    fn formats_that_are_only_read_are_recognized_by_their_keys() {
        let camera = r#"{"pan_degrees": 1, "x_focal_length": 2}"#;
        for (name, text, format) in [
            ("0001.json", camera.to_owned(), Format::PnlCalib),
            (
                "0001.json",
                format!("{{\"cam_params\": {camera}}}"),
                Format::PnlCalib,
            ),
            ("all.json", format!("[null, {camera}]"), Format::PnlCalib),
            (
                "camcourt1.json",
                "{\"calibration\": {}}".to_owned(),
                Format::DeepSport,
            ),
            (
                "annotations.xml",
                "<annotations></annotations>".to_owned(),
                Format::Cvat,
            ),
            (
                "list.json",
                "[{\"width\": 1}, {\"K\": [], \"kc\": [], \"R\": [], \"T\": []}]".to_owned(),
                Format::DeepSport,
            ),
            (
                "sample.json",
                "{\n\"transforms\": [],\n\"lens\": {}\n}".to_owned(),
                Format::OpenTrackIo,
            ),
            (
                "a.xml",
                "<opencv_storage></opencv_storage>".to_owned(),
                Format::OpenCv,
            ),
            ("h.txt", "1 2 3\n4 5 6\n7 8 9\n".to_owned(), Format::Wc14),
        ] {
            assert_eq!(
                format_of_file(name, text.as_bytes()),
                Some(format),
                "{text}"
            );
        }
    }

    #[test]
    fn a_damaged_file_says_nothing_and_two_formats_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("camera_0001.json", "null");
        write("camera_0002.json", "{\"a\": NaN}");
        let error = recognize_format(folder.path()).unwrap_err().to_string();
        assert!(
            error.ends_with(": no format is recognized; give --format"),
            "{error}"
        );
        write(
            "camera_0003.json",
            r#"{"pan_degrees": 1, "x_focal_length": 2}"#,
        );
        assert_eq!(recognize_format(folder.path()).unwrap(), Format::SoccerNet);
        write("0003.json", r#"{"Middle line": [{"x": 0.5, "y": 0.5}]}"#);
        let error = recognize_format(folder.path()).unwrap_err().to_string();
        assert!(
            error.ends_with(": the files may be soccernet or soccernet-lines; give --format"),
            "{error}"
        );
    }
}
