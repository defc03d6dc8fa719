//! Label Studio's JSON: a list of tasks with results in percent of the picture, from its corner.
//!
//! Old files say `completions` for `annotations`; the flat form JSON-MIN has a list of points
//! beside the image. Cancelled annotations are skipped; of several, the last is used, or that of
//! `--annotator`. Names of uploaded files have a prefix before the first `-`.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReader, LabelledFrame, Mark, Sizes, size_needed,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, base_name};
use crate::exchange::format::About;
use crate::exchange::format_options::{self, FormatOption};
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse, safe_path};
use serde_json::{Value, json};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The format.
pub struct LabelStudio;

/// The kinds of results that contain points; each is also the key of its list of labels.
const KINDS: [&str; 2] = ["keypointlabels", "polygonlabels"];
/// The length of the prefix of an uploaded file.
const PREFIX: usize = 8;
/// What stands before the path of a file in a folder that is connected as storage.
const LOCAL_FILES: &str = "local-files/?d=";

fn to_json(index: usize, frame: &ClickedFrame) -> Value {
    let (width, height) = (f64::from(frame.size.width), f64::from(frame.size.height));
    let results = frame.clicks.iter().filter_map(|click| {
        let name = click.target.as_ref()?.as_str();
        Some(json!({
            "type": "keypointlabels",
            "from_name": "kp",
            "to_name": "img",
            "original_width": frame.size.width,
            "original_height": frame.size.height,
            "image_rotation": 0,
            "value": {
                "x": 100.0 * click.image.x / width,
                "y": 100.0 * click.image.y / height,
                "width": 0.3,
                "keypointlabels": [name],
            },
        }))
    });
    // For an image without results, this is the only place that keeps its size.
    json!({
        "id": index + 1,
        "data": { "image": frame.image, "width": frame.size.width, "height": frame.size.height },
        "annotations": [{ "was_cancelled": false, "result": results.collect::<Vec<_>>() }],
    })
}

/// The file of an image that was uploaded: without its folders and its prefix of hexadecimal
/// digits.
fn file_name(path: &str) -> Result<String, Problem> {
    // Files of a storage folder are named in the query. Any other query belongs to an address; the
    // name of a file may have these signs itself.
    let path = match path.split_once(LOCAL_FILES) {
        Some((_, file)) => file,
        None if path.contains("://") || path.starts_with('/') => {
            path.split(['?', '#']).next().unwrap_or(path)
        }
        None => path,
    };
    let name = base_name(path);
    // Only names below `upload/` have the prefix; the name of a picture may begin alike.
    let uploaded = name.split_once('-').filter(|(prefix, _)| {
        prefix.len() == PREFIX
            && prefix.bytes().all(|byte| byte.is_ascii_hexdigit())
            && path.contains("upload/")
    });
    safe_path(uploaded.map_or(name, |(_, rest)| rest))
}

/// The marks of a value with x and y, or with a list of points, in percent.
fn marks_of(
    value: &Node<'_>,
    labels: &[&str],
    size: ImageSize,
    shift_px: f64,
) -> Result<Vec<Mark>, Problem> {
    let in_percent: Vec<[f64; 2]> = match value.find("points") {
        Some(points) => points
            .items()?
            .map(|point| point.numbers::<2>())
            .collect::<Result<Vec<_>, _>>()?,
        None => vec![[value.key("x")?.number()?, value.key("y")?.number()?]],
    };
    Ok(labels
        .iter()
        .flat_map(|label| {
            in_percent.iter().map(move |at| {
                Mark::new((*label).to_owned(), point_from_percent(*at, size, shift_px))
            })
        })
        .collect())
}

/// A point of a picture, from percent of its sides.
fn point_from_percent([x, y]: [f64; 2], size: ImageSize, shift_px: f64) -> ImagePoint {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    ImagePoint::new(x / 100.0 * width + shift_px, y / 100.0 * height + shift_px)
}

/// The picture of a task, for a message: its file, or where the task stands.
fn picture_of(task: &Node<'_>) -> String {
    let data = task.find("data").unwrap_or_else(|| task.clone());
    let image = data.find("image").and_then(|image| image.value().as_str());
    let name = image.and_then(|image| file_name(image).ok());
    name.unwrap_or_else(|| task.path().to_owned())
}

/// The annotation to be read.
fn annotation<'a>(task: &Node<'a>, annotator: Option<&str>) -> Result<Option<Node<'a>>, Problem> {
    let Some(all) = task
        .find("annotations")
        .or_else(|| task.find("completions"))
    else {
        return Ok(None);
    };
    // The last one is the newest.
    Ok(all.items()?.rfind(|node| {
        !is_cancelled(node)
            && annotator.is_none_or(|wanted| annotator_of(node).as_deref() == Some(wanted))
    }))
}

/// Whether the annotator discarded an annotation.
fn is_cancelled(annotation: &Node<'_>) -> bool {
    annotation
        .find("was_cancelled")
        .is_some_and(|is| is.value() == &Value::Bool(true))
}

/// The e-mail address or the number of the annotator.
fn annotator_of(annotation: &Node<'_>) -> Option<String> {
    let user = annotation.find("completed_by")?;
    // An object with an e-mail address, or a number, depending on how the file was exported.
    let user = user.find("email").unwrap_or(user);
    let text = user.value().as_str();
    Some(text.map_or_else(|| user.value().to_string(), ToOwned::to_owned))
}

fn read_task(
    task: &Node<'_>,
    options: &ImportOptions,
    sizes: &Sizes<'_>,
) -> Result<LabelledFrame, Problem> {
    let shift = options.shift_to_corner_px();
    // The flat form has the image beside the points.
    let data = task.find("data").unwrap_or_else(|| task.clone());
    let image = file_name(data.key("image")?.text()?)?;
    // Each result states the size of the picture that it was placed in, which is the surest one.
    // An image without results has its size beside its name, if this program wrote it.
    let stated = data.find_size("width", "height")?;
    let mut size = stated.or_else(|| sizes(&image)).or(options.size);
    let mut marks = Vec::new();
    let results: Vec<(Node<'_>, Node<'_>)> =
        if let Some(annotation) = annotation(task, options.annotator.as_deref())? {
            let results = annotation.key("result")?.items()?;
            results
                .filter_map(|result| Some((result.find("value")?, result)))
                .collect()
        } else {
            // JSON-MIN: points are beside the image, under the name of the tag. A whole task
            // without an annotation to read comes here, too; its lists have no labels and give no
            // marks.
            let lists = task.entries()?.filter_map(|(_, node)| node.items().ok());
            lists
                .flatten()
                .map(|point| (point.clone(), point))
                .collect()
        };
    for (value, result) in results {
        // Choices, brushes and boxes are results of the same list.
        let Some(labels) = KINDS.iter().find_map(|kind| value.find(kind)) else {
            continue;
        };
        if result
            .find("image_rotation")
            .is_some_and(|turn| turn.value().as_f64() != Some(0.0))
        {
            let what = format!("{}.image_rotation", result.path());
            return Err(Problem::not_supported(what, "rotate the picture itself"));
        }
        if let Some(of_result) = result.find_size("original_width", "original_height")? {
            size = Some(of_result);
        }
        let labels = labels
            .items()?
            .map(|label| label.text())
            .collect::<Result<Vec<_>, _>>()?;
        let known = size.ok_or_else(|| size_needed(&image))?;
        marks.extend(marks_of(&value, &labels, known, shift)?);
    }
    let size = size.ok_or_else(|| size_needed(&image))?;
    Ok(LabelledFrame::new(&image, Some(image.clone()), size, marks))
}

impl ClickFormat for LabelStudio {
    fn about(&self) -> About {
        About {
            name: "label-studio",
            title: "Label Studio keypoints",
            conventions: "percent of width and height",
            users: "Label Studio",
            loses: Some("check points, cameras"),
            file: Some("label-studio.json"),
            files: "Label Studio export (.json)",
            endings: &["json"],
            export_options: format_options::POINTS_OUT,
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::Pixels,
                FormatOption::Map,
                FormatOption::SkipUnmapped,
                FormatOption::Annotator,
                FormatOption::EachOwnCamera,
                FormatOption::StretchedFrom,
            ],
        }
    }

    fn write(&self, frames: &[ClickedFrame], _context: &ClickContext<'_>) -> ExchangeResult<Files> {
        let tasks: Vec<Value> = frames
            .iter()
            .enumerate()
            .map(|(index, frame)| to_json(index, frame))
            .collect();
        Ok(Files::one(
            "tasks.json",
            format!("{:#}\n", Value::Array(tasks)).into_bytes(),
        ))
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            let value = parse(bytes)?;
            let tasks = Node::root(&value).items()?;
            let frames = tasks.filter_map(|task| {
                let read = read_task(&task, reading.options, reading.sizes);
                reading.keep(file, Some(&picture_of(&task)), read)
            });
            Ok(frames.collect::<Vec<_>>())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::read_alone;
    use super::*;
    use crate::exchange::Format;
    use crate::exchange::tests::{export_as, text_of, with_clicks};

    fn read(text: &str) -> Result<Vec<LabelledFrame>, String> {
        let files = Files::one("a.json", text.as_bytes().to_vec());
        read_alone(&LabelStudio, &files, &ImportOptions::default(), None)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn points_are_percent_of_the_picture() {
        let exported = export_as(&with_clicks(), Format::LabelStudio);
        let tasks: Value = serde_json::from_str(&text_of(&exported.files, "tasks.json")).unwrap();
        let x = tasks[0]["annotations"][0]["result"][0]["value"]["x"]
            .as_f64()
            .unwrap();
        assert!((x - 100.0 * 444.681 / 1920.0).abs() < 1e-12);
    }

    #[test]
    fn a_file_is_named_by_an_address_a_storage_folder_or_itself() {
        for (path, name) in [
            ("https://host/a/0001.jpg?token=1#2", "0001.jpg"),
            ("/data/local-files/?d=clip/0001.jpg", "0001.jpg"),
            ("clip#1.jpg", "clip#1.jpg"),
        ] {
            assert_eq!(file_name(path).unwrap(), name);
        }
    }

    #[test]
    fn old_flat_and_uploaded_files_are_read() {
        let old = json!([{ "data": { "image": "/data/upload/1/ab12cd34-0001.jpg" }, "completions": [
            { "was_cancelled": true, "result": [] },
            { "result": [{ "original_width": 200, "original_height": 100, "value": { "x": 50.0, "y": 10.0, "keypointlabels": ["centre_mark"] } }] },
            { "was_cancelled": true, "result": [] }
        ] }]);
        let frames = read(&old.to_string()).unwrap();
        let mark = Mark::new("centre_mark".to_owned(), ImagePoint::new(100.0, 10.0));
        assert_eq!(
            (frames[0].name.as_str(), &frames[0].marks),
            ("0001.jpg", &vec![mark.clone()])
        );
        let flat = json!([{ "image": "0001.jpg", "kp": [{ "x": 50.0, "y": 10.0, "keypointlabels": ["centre_mark"], "original_width": 200, "original_height": 100 }] }]);
        assert_eq!(read(&flat.to_string()).unwrap()[0].marks, [mark]);
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let task = |result: Value| {
            json!([{ "data": { "image": "a.jpg" }, "annotations": [{ "result": [result] }] }])
                .to_string()
        };
        let good = json!({ "original_width": 200, "original_height": 100, "image_rotation": 0, "value": { "x": 1.0, "y": 2.0, "keypointlabels": ["a"] } });
        let with = |pointer: &str, value: Value| {
            let mut result = good.clone();
            *result.pointer_mut(pointer).unwrap() = value;
            task(result)
        };
        for (text, wanted) in [
            (
                "{}".to_owned(),
                "the file: a list is expected, found an object",
            ),
            ("[{}]".to_owned(), "[0].image is missing"),
            (
                "[{\"image\": \"..\"}]".to_owned(),
                "the path \"..\" points outside the folder",
            ),
            (
                "[{\"image\": \"a.jpg\"}]".to_owned(),
                "the size of \"a.jpg\" is not known; give --size WIDTHxHEIGHT or --images FOLDER",
            ),
            (
                with("/image_rotation", json!(90)),
                "[0].annotations[0].result[0].image_rotation cannot be read: rotate the picture itself",
            ),
            (
                with("/value/x", json!("left")),
                "[0].annotations[0].result[0].value.x: a number is expected, found the text \"left\"",
            ),
            (
                with("/value/keypointlabels", json!("a")),
                "[0].annotations[0].result[0].value.keypointlabels: a list is expected, found the text \"a\"",
            ),
            (
                with("/original_width", json!(-1)),
                "[0].annotations[0].result[0].original_width is -1, which must be a whole number from 1 to 65535",
            ),
            (
                with("/original_width", Value::Null),
                "the size of \"a.jpg\" is not known; give --size WIDTHxHEIGHT or --images FOLDER",
            ),
        ] {
            assert_eq!(read(&text).unwrap_err(), format!("a.json: {wanted}"));
        }
    }
}
