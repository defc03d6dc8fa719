//! Keypoints for Ultralytics' pose models: `data.yaml`, and `labels/…/NAME.txt` for
//! `images/…/NAME.jpg`.
//!
//! A line is `class cx cy w h (x y v)*`, as fractions of the picture's width or height in the
//! corner convention, without a half-pixel shift. An absent point is `0 0 0`. Readers drop the
//! whole picture if a coordinate is outside 0 … 1, so points outside are not written. `flip_idx` is
//! the permutation of the points in a mirrored picture.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReader, LabelledFrame, Mark, ThirdNumber,
    size_or_option,
};
use super::coco::{in_order, is_keypoint, range_of};
use super::labels::keypoints;
use crate::document::Click;
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::error::{ExchangeError, ExchangeResult, Problem};
use crate::exchange::files::{Files, base_name, text, without_ending};
use crate::exchange::format::{About, Format};
use crate::exchange::format_options::FormatOption;
use crate::exchange::syntax::table::numbers;
use std::fmt::Write as _;
use touchline_core::field::{FieldModel, Symmetry};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The format.
pub struct YoloPose;

const DATA: &str = "data.yaml";
/// The margin of the box around the points on each side, as a fraction of the picture.
const PADDING: f64 = 0.01;

/// The index of each keypoint's mirror image.
fn mirror_indices(names: &[String], field: &FieldModel) -> Vec<usize> {
    names
        .iter()
        .enumerate()
        .map(|(index, name)| mirror_index(name, names, field).unwrap_or(index))
        .collect()
}

/// The index of a keypoint's mirror image; none if the field or the names do not have it.
fn mirror_index(name: &str, names: &[String], field: &FieldModel) -> Option<usize> {
    let mirrored = field
        .landmark_element(name)?
        .twin(Symmetry::MirrorX, field)?
        .name(field)?
        .to_owned();
    names.iter().position(|other| *other == mirrored)
}

fn data_yaml(names: &[String], field: &FieldModel) -> String {
    let flipped: Vec<String> = mirror_indices(names, field)
        .iter()
        .map(ToString::to_string)
        .collect();
    format!(
        "# {}; split the labels into train and val, and put the pictures into images/ with the same folders\npath: .\n\
         train: images/train\nval: images/train\nkpt_shape: [{}, 3]\nflip_idx: [{}]\nnames: {{0: pitch}}\n\
         kpt_names: {{0: [{}]}}\n",
        crate::document::generator(),
        names.len(),
        flipped.join(", "),
        names.join(", ")
    )
}

fn label_line(frame: &ClickedFrame, names: &[String]) -> String {
    if frame.clicks.is_empty() {
        return String::new();
    }
    let (width, height) = (f64::from(frame.size.width), f64::from(frame.size.height));
    // A column for every keypoint, in their order; absent ones are zeros.
    let points: Vec<Option<(f64, f64)>> = in_order(&frame.clicks, names)
        .into_iter()
        .map(|click| click.map(|click| (click.image.x / width, click.image.y / height)))
        .collect();
    // The box is that of the points. The margin gives it a width and a height for a single point,
    // too: readers drop a box without them.
    let (left, right) = padded_range(points.iter().flatten().map(|(x, _)| *x));
    let (top, bottom) = padded_range(points.iter().flatten().map(|(_, y)| *y));
    let mut line = format!(
        "0 {} {} {} {}",
        left.midpoint(right),
        top.midpoint(bottom),
        right - left,
        bottom - top
    );
    for point in points {
        // Writing to a string cannot fail.
        let _ = match point {
            Some((x, y)) => write!(line, " {x} {y} 2"),
            None => write!(line, " 0 0 0"),
        };
    }
    line.push('\n');
    line
}

/// The range of coordinates with a margin, within the picture.
fn padded_range(coordinates: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = range_of(coordinates);
    ((low - PADDING).max(0.0), (high + PADDING).min(1.0))
}

/// Whether a file lies in a folder of labels.
fn is_in_labels(file: &str) -> bool {
    file.contains("labels/")
}

/// Whether a file of a folder is one of labels, or names their keypoints.
pub(in crate::exchange) fn is_label_file(name: &str) -> bool {
    name == DATA || (has_ending(name, "txt") && (is_in_labels(name) || !name.contains('/')))
}

/// The names of keypoints in a `data.yaml`, where it has some.
fn names_of(yaml: &str) -> Option<Vec<String>> {
    let (_, behind) = yaml.split_once("kpt_names:")?;
    let (before, list) = behind.split_once('[')?;
    // A list in YAML's block style (`- name`) has no bracket. The next bracket is then of another
    // key, such as `flip_idx`, with as many numbers as there are points.
    let is_of_another_key = before
        .lines()
        .skip(1)
        .any(|line| line.trim_start().starts_with('-') || line.starts_with(char::is_alphabetic));
    if is_of_another_key {
        return None;
    }
    let (list, _) = list.split_once(']')?;
    Some(
        list.split(',')
            .map(|name| name.trim().trim_matches(['"', '\'']).to_owned())
            .filter(|name| !name.is_empty())
            .collect(),
    )
}

fn marks_of(
    line: &str,
    third: ThirdNumber,
    names: Option<&[String]>,
    size: ImageSize,
) -> Result<Vec<Mark>, Problem> {
    let mut values = numbers("a column", line)?;
    let count = values.len().saturating_sub(5) / 3;
    if third == ThirdNumber::Probability {
        // Predictions may end with the probability of the box and the number of its track.
        values.truncate(5 + 3 * names.map_or(count, <[String]>::len));
    }
    // Five columns of class and box, three a point. Without names any number of points fits, so
    // that only a remainder is an error.
    let wanted = 5 + 3 * names.map_or(count, <[String]>::len);
    if values.len() != wanted || values.len() < 5 {
        let what = "columns (class, box, and x y v for each keypoint)".to_owned();
        return Err(Problem::wrong_count(what, wanted.max(8), values.len()));
    }
    let points = values[5..]
        .chunks_exact(3)
        .enumerate()
        // Predictions have a point that they do not believe in at the corner.
        .filter(|(_, point)| {
            point[2] != 0.0 && (third != ThirdNumber::Probability || point[..2] != [0.0, 0.0])
        });
    points
        .map(|(index, point)| {
            if third == ThirdNumber::Visibility && ![1.0, 2.0].contains(&point[2]) {
                let what = format!("the visibility of keypoint {index}");
                return Err(Problem::out_of_range(what, point[2], "0, 1 or 2"));
            }
            // Ultralytics allows this much beyond the border (`verify_image_label`).
            if let Some(value) = point[..2]
                .iter()
                .find(|value| !(-0.01..=1.01).contains(*value))
            {
                let what = format!("keypoint {index}");
                return Err(Problem::out_of_range(what, *value, "between 0 and 1"));
            }
            // There are as many names as points, as `wanted` has it.
            let label = names.map_or_else(|| index.to_string(), |names| names[index].clone());
            let image = ImagePoint::new(
                point[0] * f64::from(size.width),
                point[1] * f64::from(size.height),
            );
            let mark = Mark::new(label, image);
            match third {
                ThirdNumber::Visibility => Ok(mark),
                ThirdNumber::Probability => mark.with_probability(point[2]),
            }
        })
        .collect()
}

/// The marks of a file of labels.
fn marks_of_file(
    bytes: &[u8],
    third: ThirdNumber,
    names: Option<&[String]>,
    size: ImageSize,
) -> Result<Vec<Mark>, Problem> {
    // A picture without labels has an empty file.
    let lines = if bytes.is_empty() { "" } else { text(bytes)? };
    let lines = lines.lines().enumerate();
    let mut marks = Vec::new();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let of_line = marks_of(line, third, names, size);
        marks.extend(of_line.map_err(|problem| problem.at_line(index + 1))?);
    }
    Ok(marks)
}

/// The frames of files of labels or predictions.
pub(in crate::exchange) fn read_with(
    third: ThirdNumber,
    files: &Files,
    reading: &LabelReader<'_>,
) -> ExchangeResult<Vec<LabelledFrame>> {
    let yaml = files
        .get(DATA)
        .map(text)
        .transpose()
        .map_err(|problem| problem.within(DATA))?;
    let names = yaml.and_then(names_of);
    // Texts beside the folders of labels say something about the set: `README.roboflow.txt`.
    let has_folders = files
        .sorted_entries()
        .iter()
        .any(|(file, _)| is_in_labels(file));
    files.read_all(|file, bytes| {
        if !has_ending(file, "txt") || (has_folders && !is_in_labels(file)) {
            return Ok(None);
        }
        let stem = without_ending(base_name(file));
        let at_image = without_ending(file).replacen("labels/", "images/", 1);
        // `labels/train/a.txt` is of `images/train/a.jpg`, or of a picture beside the labels.
        let own = (reading.sizes)(&at_image).or_else(|| (reading.sizes)(stem));
        let size = size_or_option(&at_image, own, reading.options)?;
        let marks = reading.keep(
            file,
            None,
            marks_of_file(bytes, third, names.as_deref(), size),
        );
        Ok(marks.map(|marks| LabelledFrame::new(stem, Some(at_image), size, marks)))
    })
}

impl ClickFormat for YoloPose {
    fn about(&self) -> About {
        About {
            name: "yolo-pose",
            title: "keypoints for Ultralytics' pose models",
            conventions: "points as fractions of width and height; one box per picture",
            users: "Ultralytics pose models, Roboflow",
            loses: Some("points on lines, points outside of the picture, cameras"),
            file: None,
            files: "labels (labels/….txt)",
            endings: &["txt", "yaml"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Projected,
                FormatOption::Names,
            ],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::Map,
                FormatOption::SkipUnmapped,
                FormatOption::EachOwnCamera,
                FormatOption::StretchedFrom,
            ],
        }
    }

    fn holds_outside(&self) -> bool {
        false
    }

    fn has_shares_alone(&self) -> bool {
        true
    }

    fn holds(&self, click: &Click, context: &ClickContext<'_>) -> bool {
        is_keypoint(click, context)
    }

    fn holds_repeated_landmarks(&self) -> bool {
        false
    }

    fn name_of(&self, frame: &ClickedFrame) -> String {
        without_ending(&frame.image).to_owned()
    }

    fn write(&self, frames: &[ClickedFrame], context: &ClickContext<'_>) -> ExchangeResult<Files> {
        let names = keypoints(context.options.names, context.field);
        let mut files = Files::one(DATA, data_yaml(&names, context.field).into_bytes());
        for frame in frames {
            // `--outside keep` does not help here: a point outside makes readers drop the whole
            // picture.
            if let Some(outside) = frame
                .clicks
                .iter()
                .find(|click| !frame.size.contains(click.image))
            {
                let why = format!(
                    "({}, {}) lies outside of it, which Ultralytics drops",
                    outside.image.x, outside.image.y
                );
                return Err(ExchangeError::CannotHold {
                    frame: frame.image.clone(),
                    format: Format::YoloPose,
                    why,
                });
            }
            files.add(
                format!("labels/train/{}.txt", frame.name),
                label_line(frame, &names),
            );
        }
        Ok(files)
    }

    fn is_wanted(&self, name: &str) -> bool {
        is_label_file(name)
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        read_with(ThirdNumber::Visibility, files, reading)
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::read_alone;
    use super::*;
    use crate::exchange::export;
    use crate::exchange::options::ImportOptions;
    use crate::exchange::tests::{SIZE, export_as, text_of, with_clicks};
    use crate::exchange::{ExportOptions, KeypointNames};
    use std::path::Path;

    #[test]
    fn points_are_shares_of_the_picture_from_its_corner() {
        let exported = export_as(&with_clicks(), Format::YoloPose);
        let line = text_of(&exported.files, "labels/train/0001.txt");
        let values = numbers("the label", &line).unwrap();
        assert_eq!(&values[5..8], [444.681 / 1920.0, 789.175 / 1080.0, 2.0]);
        assert_eq!(values.len(), 5 + 3 * 47);
        assert_eq!(exported.notes.len(), 2, "{:?}", exported.notes);
    }

    #[test]
    fn a_frame_that_loses_all_its_clicks_is_left_out_and_no_background_image() {
        let mut document = with_clicks();
        let mut lines_only = (*document.frames[0]).clone();
        lines_only.id = "lines".into();
        lines_only.image = Some("images/0002.jpg".to_owned());
        lines_only
            .clicks
            .retain(|click| click.target.as_ref().unwrap().line().is_some());
        document.frames.push(lines_only.into());
        let exported = export_as(&document, Format::YoloPose);
        assert_eq!(exported.frames, 1);
        assert_eq!(exported.files.get("labels/train/0002.txt"), None);
        let why = "none of its clicks can be written as yolo-pose".to_owned();
        assert_eq!(exported.left_out, [("0002.jpg".to_owned(), why)]);
    }

    #[test]
    fn the_published_order_of_mirrored_points_follows_from_the_names() {
        let options = ExportOptions {
            names: KeypointNames::Roboflow32,
            ..ExportOptions::default()
        };
        let exported =
            export(with_clicks().at(Path::new("/")), Format::YoloPose, &options).unwrap();
        let yaml = text_of(&exported.files, DATA);
        let published = "flip_idx: [24, 25, 26, 27, 28, 29, 22, 23, 21, 17, 18, 19, 20, 13, 14, 15, 16, 9, 10, 11, 12, 8, 6, 7, 0, \
                         1, 2, 3, 4, 5, 31, 30]";
        assert!(yaml.contains(published), "{yaml}");
    }

    #[test]
    fn names_in_block_style_are_not_taken_from_another_list() {
        let list = "kpt_names: {0: [\"left\", right]}\nflip_idx: [1, 0]\n";
        assert_eq!(names_of(list).unwrap(), ["left", "right"]);
        let indented = "kpt_names:\n  0: [left, right]\n";
        assert_eq!(names_of(indented).unwrap(), ["left", "right"]);
        let block = "kpt_names:\n  0:\n    - left\n    - right\nflip_idx: [1, 0]\n";
        assert_eq!(names_of(block), None);
    }

    #[test]
    fn a_text_about_the_set_is_no_label() {
        let mut files = Files::one("README.roboflow.txt", b"pitch - v1\n".to_vec());
        files.add("train/labels/a.txt", "0 0.5 0.5 1 1 0.2 0.3 2\n");
        let read = read_alone(&YoloPose, &files, &ImportOptions::default(), Some(SIZE));
        let read = read.unwrap();
        assert_eq!(read.len(), 1);
        assert_eq!(read[0].image.as_deref(), Some("train/images/a"));
    }

    #[test]
    fn damaged_labels_are_named_in_one_line() {
        let with_names = Some(vec!["a".to_owned(), "b".to_owned()]);
        for (line, names, wanted) in [
            (
                "0 0.5 0.5 1",
                None,
                "columns (class, box, and x y v for each keypoint): 8 are expected, found 4",
            ),
            (
                "0 0.5 0.5 1 1 0.2",
                None,
                "columns (class, box, and x y v for each keypoint): 8 are expected, found 6",
            ),
            (
                "0 0.5 0.5 1 1 0.2 0.3 2",
                with_names,
                "columns (class, box, and x y v for each keypoint): 11 are expected, found 8",
            ),
            (
                "0 0.5 0.5 1 1 1.2 0.3 2",
                None,
                "keypoint 0 is 1.2, which must be between 0 and 1",
            ),
            (
                "0 0.5 0.5 1 1 x 0.3 2",
                None,
                "a column: a number is expected, found \"x\"",
            ),
            (
                "0 0.5 0.5 1 1 nan 0.3 2",
                None,
                "a column is not a finite number",
            ),
        ] {
            assert_eq!(
                marks_of(line, ThirdNumber::Visibility, names.as_deref(), SIZE)
                    .unwrap_err()
                    .to_string(),
                wanted
            );
        }
        let files = Files::one("labels/a.txt", b"0 0.5 0.5 1 1 0.2 0.3 2\n".to_vec());
        let error = read_alone(&YoloPose, &files, &ImportOptions::default(), None)
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "labels/a.txt: the size of \"images/a\" is not known; give --size WIDTHxHEIGHT or --images FOLDER"
        );
    }
}
