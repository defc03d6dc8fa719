//! COCO keypoints: one JSON file, one category whose keypoints are landmarks.
//!
//! A keypoint is x, y, v: v 0 absent (x = y = 0), 1 labelled but hidden, 2 visible. The origin of
//! pixels is the first one's centre: our coordinates − 0.5, unless `info.convention` states
//! otherwise. Ids of images and annotations and indices of the skeleton begin at 1.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReader, LabelledFrame, Mark, ThirdNumber,
    picture_path,
};
use super::labels::keypoints;
use crate::document::{Click, Target};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::Pixels;
use crate::exchange::syntax::node::{Node, parse};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use touchline_core::geometry::ImagePoint;

/// The format.
pub struct Coco;

/// The words in `info.convention` for the origin at pixel centres.
const CENTRE: &str = "pixel centres";

/// The clicks in the order of the keypoints; none for absent ones.
pub(super) fn in_order<'a>(clicks: &'a [Click], names: &[String]) -> Vec<Option<&'a Click>> {
    names.iter().map(|name| find_click(clicks, name)).collect()
}

/// The first click on the landmark of this name.
fn find_click<'a>(clicks: &'a [Click], name: &str) -> Option<&'a Click> {
    clicks
        .iter()
        .find(|click| matches!(&click.target, Some(Target::Landmark(id)) if id.as_str() == name))
}

/// Whether a click is on one of the keypoints.
pub(super) fn is_keypoint(click: &Click, context: &ClickContext<'_>) -> bool {
    let Some(Target::Landmark(id)) = &click.target else {
        return false;
    };
    keypoints(context.options.names, context.field)
        .iter()
        .any(|name| name == id.as_str())
}

fn annotation(number: usize, frame: &ClickedFrame, names: &[String]) -> Option<Value> {
    let shift = Pixels::Centre.to_corner_px();
    let points: Vec<ImagePoint> = frame
        .clicks
        .iter()
        .map(|click| ImagePoint::new(click.image.x - shift, click.image.y - shift))
        .collect();
    // An image without points has no annotation, so that it is a negative example.
    if points.is_empty() {
        return None;
    }
    // COCO wants a box and its area; that of the points is all there is.
    let (left, right) = range_of(points.iter().map(|point| point.x));
    let (top, bottom) = range_of(points.iter().map(|point| point.y));
    let keypoints: Vec<f64> = in_order(&frame.clicks, names)
        .into_iter()
        .flat_map(|click| {
            click.map_or([0.0; 3], |click| {
                [click.image.x - shift, click.image.y - shift, 2.0]
            })
        })
        .collect();
    let visible = keypoints
        .chunks_exact(3)
        .filter(|point| point[2] > 0.0)
        .count();
    Some(json!({
        "id": number,
        "image_id": number,
        "category_id": 1,
        "keypoints": keypoints,
        "num_keypoints": visible,
        "bbox": [left, top, right - left, bottom - top],
        "area": (right - left) * (bottom - top),
        "iscrowd": 0,
        "segmentation": [],
    }))
}

/// The smallest and the largest of some numbers; infinite and the wrong way round for none.
pub(super) fn range_of(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    })
}

/// The number of an image or category.
pub(in crate::exchange) fn id_of(node: &Node<'_>) -> Result<i64, Problem> {
    let value = node.number()?;
    // Ids are compared for equality, which is exact for whole numbers below 2⁵³.
    if value.fract() == 0.0 && value.abs() < 9e15 {
        return Ok(value as i64);
    }
    Err(Problem::out_of_range(node.path(), value, "a whole number"))
}

/// The frames of a file with images, categories and annotations.
pub(in crate::exchange) fn read_with(
    third: ThirdNumber,
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    let value = parse(bytes)?;
    let root = Node::root(&value);
    // COCO itself counts from pixel centres; a file of a tool that does not may say so, and the
    // user knows best.
    let said = root.find("info").and_then(|info| info.find("convention"));
    let said =
        said.and_then(|convention| convention.text().ok().map(|text| text.contains("corner")));
    let by_file = if said == Some(true) {
        Pixels::Corner
    } else {
        Pixels::Centre
    };
    let shift = reading.options.pixels.unwrap_or(by_file).to_corner_px();
    // Images, categories and annotations refer to each other by ids in any order, so that the first
    // two are read before the annotations.
    let mut names: BTreeMap<i64, Vec<&str>> = BTreeMap::new();
    for category in root.key("categories")?.items()? {
        if let Some(of) = category.find("keypoints") {
            let of = of
                .items()?
                .map(|name| name.text())
                .collect::<Result<_, _>>()?;
            let id = id_of(&category.key("id")?)?;
            if names.insert(id, of).is_some() {
                return Err(Problem::twice("the category id", id.to_string()));
            }
        }
    }
    let mut frames: Vec<LabelledFrame> = Vec::new();
    let mut at: BTreeMap<i64, usize> = BTreeMap::new();
    for image in root.key("images")?.items()? {
        let id = id_of(&image.key("id")?)?;
        if at.insert(id, frames.len()).is_some() {
            return Err(Problem::twice("the image id", id.to_string()));
        }
        let name = picture_path(image.key("file_name")?.text()?, reading.options)?;
        frames.push(LabelledFrame::new(
            &name,
            Some(name.clone()),
            image.size_at("width", "height")?,
            Vec::new(),
        ));
    }
    for annotation in root.key("annotations")?.items()? {
        // Boxes and masks of other categories may be in the same file.
        if annotation.find("keypoints").is_none() {
            continue;
        }
        let read = annotation_marks(&annotation, &at, &names, (third, shift));
        let read = reading.keep(file, Some(annotation.path()), read);
        if let Some((frame, marks)) = read {
            frames[frame].marks.extend(marks);
        }
    }
    Ok(frames)
}

/// The marks of an annotation with keypoints, and the index of its frame. `at` is that of images by
/// their ids, `names` are those of the keypoints of categories.
fn annotation_marks(
    annotation: &Node<'_>,
    at: &BTreeMap<i64, usize>,
    names: &BTreeMap<i64, Vec<&str>>,
    (third, shift): (ThirdNumber, f64),
) -> Result<(usize, Vec<Mark>), Problem> {
    let points = annotation.key("keypoints")?;
    let id = id_of(&annotation.key("image_id")?)?;
    let frame = *at
        .get(&id)
        .ok_or_else(|| unknown_id("the image of an annotation,", id))?;
    let category = id_of(&annotation.key("category_id")?)?;
    let of = names
        .get(&category)
        .ok_or_else(|| unknown_id("the category of an annotation,", category))?;
    let values = points.all_numbers()?;
    if values.len() != 3 * of.len() {
        let what = format!("{} (numbers)", points.path());
        return Err(Problem::wrong_count(what, 3 * of.len(), values.len()));
    }
    // Visibility 1 is a point that is hidden in the picture and was placed all the same.
    let marks = marks_of_keypoints(&values, of, (third, shift))?;
    Ok((frame, marks))
}

/// The marks of keypoints: x, y and the third number of each.
pub(in crate::exchange) fn marks_of_keypoints(
    values: &[f64],
    names: &[impl AsRef<str>],
    (third, shift): (ThirdNumber, f64),
) -> Result<Vec<Mark>, Problem> {
    let marks = values
        .chunks_exact(3)
        .zip(names)
        .filter(|(point, _)| point[2] != 0.0);
    let marks = marks.map(|(point, name)| {
        let at = ImagePoint::new(point[0] + shift, point[1] + shift);
        let mark = Mark::new(name.as_ref().to_owned(), at);
        match third {
            ThirdNumber::Visibility => Ok(mark),
            ThirdNumber::Probability => mark.with_probability(point[2]),
        }
    });
    marks.collect()
}

/// The error that an annotation refers to something that is not in the file.
fn unknown_id(what: &'static str, id: i64) -> Problem {
    Problem::Unknown {
        what,
        name: id.to_string(),
    }
}

impl ClickFormat for Coco {
    fn about(&self) -> About {
        About {
            name: "coco",
            title: "COCO keypoints",
            conventions: "pixel centres at whole numbers (touchline's − 0.5)",
            users: "mmpose, Detectron2, FiftyOne, pycocotools",
            loses: Some("points on lines, cameras"),
            file: Some("keypoints.json"),
            files: "keypoints (.json)",
            endings: &["json"],
            export_options: format_options::KEYPOINTS_OUT,
            import_options: format_options::LABELS_IN,
        }
    }

    fn holds(&self, click: &Click, context: &ClickContext<'_>) -> bool {
        is_keypoint(click, context)
    }

    fn holds_repeated_landmarks(&self) -> bool {
        false
    }

    fn write(&self, frames: &[ClickedFrame], context: &ClickContext<'_>) -> ExchangeResult<Files> {
        let names = keypoints(context.options.names, context.field);
        let images = frames.iter().enumerate().map(|(index, frame)| {
            let (width, height) = (frame.size.width, frame.size.height);
            json!({ "id": index + 1, "width": width, "height": height, "file_name": frame.name })
        });
        let annotations = frames
            .iter()
            .enumerate()
            .filter_map(|(index, frame)| annotation(index + 1, frame, &names));
        let all = json!({
            "info": { "description": crate::document::generator(), "convention": CENTRE },
            "licenses": [],
            "images": images.collect::<Vec<_>>(),
            "categories": [{ "id": 1, "name": "pitch", "keypoints": names, "skeleton": [] }],
            "annotations": annotations.collect::<Vec<_>>(),
        });
        Ok(Files::one(
            "keypoints.json",
            format!("{all}\n").into_bytes(),
        ))
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            let third = ThirdNumber::Visibility;
            read_with(third, (file, bytes), reading)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::read_alone;
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{export_as, text_of, with_clicks};
    use crate::exchange::{ExportOptions, Format, ImportOptions, KeypointNames};
    use std::path::Path;

    #[test]
    fn keypoints_count_from_the_first_pixels_centre() {
        let exported = export_as(&with_clicks(), Format::Coco);
        let all: Value = serde_json::from_str(&text_of(&exported.files, "keypoints.json")).unwrap();
        let names = all["categories"][0]["keypoints"].as_array().unwrap();
        let at = names.iter().position(|name| name == "centre_mark").unwrap();
        let point: Vec<f64> = (0..3)
            .map(|part| {
                all["annotations"][0]["keypoints"][3 * at + part]
                    .as_f64()
                    .unwrap()
            })
            .collect();
        assert!(
            (point[0] - 444.181).abs() < 1e-9
                && (point[1] - 788.675).abs() < 1e-9
                && point[2] == 2.0,
            "{point:?}"
        );
        assert_eq!(all["images"][0]["id"], 1);
        assert_eq!(
            exported.notes,
            [
                "1 click on something that coco has no name for, left out",
                "1 check click not marked as such, because coco cannot"
            ]
        );
    }

    #[test]
    fn a_landmark_that_is_clicked_twice_is_left_out() {
        let mut document = with_clicks();
        let mut again = document.frames[0].clicks[0].clone();
        again.image.x += 5.0;
        document.frames[0].clicks.push(again);
        let exported = export_as(&document, Format::Coco);
        let all: Value = serde_json::from_str(&text_of(&exported.files, "keypoints.json")).unwrap();
        assert_eq!(all["annotations"][0]["num_keypoints"], 2);
        let note = "left out because a frame has them more than once: \"centre_mark\" (2×)";
        assert_eq!(exported.notes.last().unwrap(), note);
    }

    #[test]
    fn the_names_of_roboflow_are_kept() {
        let options = ExportOptions {
            names: KeypointNames::Roboflow32,
            ..ExportOptions::default()
        };
        let exported = export(with_clicks().at(Path::new("/")), Format::Coco, &options).unwrap();
        let all: Value = serde_json::from_str(&text_of(&exported.files, "keypoints.json")).unwrap();
        assert_eq!(
            all["categories"][0]["keypoints"].as_array().unwrap().len(),
            32
        );
        // The centre mark is not among them.
        assert_eq!(all["annotations"][0]["num_keypoints"], 2);
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good: Value = serde_json::from_str(&text_of(
            &export_as(&with_clicks(), Format::Coco).files,
            "keypoints.json",
        ))
        .unwrap();
        let with = |pointer: &str, value: Value| {
            let mut all = good.clone();
            *all.pointer_mut(pointer).unwrap() = value;
            all.to_string()
        };
        let repeated = |key: &str| {
            let mut all = good.clone();
            let first = all[key][0].clone();
            all[key].as_array_mut().unwrap().push(first);
            all.to_string()
        };
        for (text, wanted) in [
            ("{}".to_owned(), "categories is missing"),
            ("{\"categories\":[]}".to_owned(), "images is missing"),
            (
                with("/images", json!({})),
                "images: a list is expected, found an object",
            ),
            (
                with("/images/0/width", json!(0)),
                "images[0].width is 0, which must be a whole number from 1 to 65535",
            ),
            (
                with("/images/0/file_name", json!("../../a.jpg")),
                "the picture \"../../a.jpg\" lies outside the folder; give --images FOLDER, \
                 where it is looked for by its name",
            ),
            (
                with("/images/0/id", json!(1.5)),
                "images[0].id is 1.5, which must be a whole number",
            ),
            (repeated("images"), "the image id \"1\" occurs twice"),
            (
                with("/annotations/0/image_id", json!(99)),
                "the image of an annotation, \"99\" is not in the file",
            ),
            (
                with("/annotations/0/category_id", json!(9)),
                "the category of an annotation, \"9\" is not in the file",
            ),
            (
                with("/annotations/0/keypoints", json!([1.0, 2.0, 2])),
                "annotations[0].keypoints (numbers): 141 are expected, found 3",
            ),
            (
                with("/annotations/0/keypoints/0", json!("x")),
                "annotations[0].keypoints[0]: a number is expected, found the text \"x\"",
            ),
            (
                with("/categories/0/keypoints/0", json!(7)),
                "categories[0].keypoints[0]: a text is expected, found 7",
            ),
        ] {
            let files = Files::one("a.json", text.into_bytes());
            let error = read_alone(&Coco, &files, &ImportOptions::default(), None)
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.json: {wanted}"));
        }
    }
}
