//! CVAT's XML 1.1: images with points, polylines and skeletons, and tracks of video tasks. Import
//! only.
//!
//! `points="x,y;x,y"` in px from the picture's corner. In skeletons `outside="1"` is absent. Only
//! key frames of tracks are read, because all others are interpolated. Document types and entities
//! are rejected.

use super::clicked_frame::{ClickFormat, LabelReader, LabelledFrame, Mark, picture_path};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::safe_path;
use crate::exchange::syntax::table::number;
use crate::exchange::syntax::values::{frame_number, shorten, side_px};
use roxmltree::Document as Xml;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The format.
pub struct Cvat;

fn not_xml(error: roxmltree::Error) -> Problem {
    Problem::NotXml(match error {
        roxmltree::Error::DtdDetected => {
            "it has a document type (<!DOCTYPE …>), which is not read".to_owned()
        }
        error => error.to_string(),
    })
}

/// The maximum number of attributes of an element, more than any in CVAT. The parser takes
/// quadratic time to find duplicates.
const MAX_ATTRIBUTES: usize = 100;

/// Rejects an element with so many attributes that the parser would take hours.
fn refuse_many_attributes(text: &str) -> Result<(), Problem> {
    /// The delimiters of markup that is not an element.
    const OTHERS: [(&str, &str); 3] = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
    // A scan of the markup alone, in linear time: an attribute has one `=` outside of quotes.
    // Whether the rest is XML is left to the parser.
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        if let Some((begin, end)) = OTHERS
            .into_iter()
            .find(|(begin, _)| rest.starts_with(begin))
        {
            // A comment without an end hides all that follows from the parser, too, which refuses
            // it.
            let Some(length) = rest[begin.len()..].find(end) else {
                return Ok(());
            };
            rest = &rest[begin.len() + length + end.len()..];
            continue;
        }
        let tag = measure_tag(rest);
        if tag.attributes > MAX_ATTRIBUTES {
            return Err(Problem::NotXml(format!(
                "an element has more than {MAX_ATTRIBUTES} attributes"
            )));
        }
        rest = &rest[tag.bytes..];
    }
    Ok(())
}

/// The length of a tag and its number of attributes.
struct TagLength {
    bytes: usize,
    attributes: usize,
}

fn measure_tag(tag: &str) -> TagLength {
    let (mut quote, mut attributes) = (None, 0);
    for (at, byte) in tag.bytes().enumerate() {
        // Bytes suffice: quotes, `=` and `>` are single bytes that no letter of UTF-8 contains, so
        // that the cut behind `>` is between letters.
        match (byte, quote) {
            (b'"' | b'\'', None) => quote = Some(byte),
            (byte, Some(open)) if byte == open => quote = None,
            (b'=', None) => attributes += 1,
            (b'>', None) => {
                return TagLength {
                    bytes: at + 1,
                    attributes,
                };
            }
            _ => {}
        }
    }
    TagLength {
        bytes: tag.len(),
        attributes,
    }
}

pub(in crate::exchange) type Element<'a> = roxmltree::Node<'a, 'a>;

/// A required attribute.
pub(in crate::exchange) fn attribute<'a>(
    element: Element<'a>,
    name: &str,
) -> Result<&'a str, Problem> {
    element
        .attribute(name)
        .ok_or_else(|| Problem::Missing(format!("{} of <{}>", name, element.tag_name().name())))
}

/// A required attribute that is a number.
pub(in crate::exchange) fn number_attribute(
    element: Element<'_>,
    name: &str,
) -> Result<f64, Problem> {
    number(name, attribute(element, name)?)
}

fn side(element: Element<'_>, name: &str) -> Result<u32, Problem> {
    side_px(name, number_attribute(element, name)?)
}

/// The points of a shape, all with its label.
fn marks(shape: Element<'_>, shift: f64) -> Result<Vec<Mark>, Problem> {
    // A key frame of a skeleton may have points that are interpolated all the same.
    let is_interpolated = shape.attribute("keyframe") == Some("0");
    if is_interpolated || shape.attribute("outside") == Some("1") {
        return Ok(Vec::new());
    }
    let label = attribute(shape, "label")?;
    points(shape, label, shift)
}

fn points(shape: Element<'_>, label: &str, shift: f64) -> Result<Vec<Mark>, Problem> {
    // One shape may have many points, which all have its label.
    let pairs = attribute(shape, "points")?.split(';');
    pairs
        .map(|pair| {
            let coordinates = pair
                .split(',')
                .map(|part| number("points", part))
                .collect::<Result<Vec<_>, _>>()?;
            let found = coordinates.len();
            let [x, y]: [f64; 2] = coordinates
                .try_into()
                .map_err(|_| Problem::wrong_count("coordinates of a point", 2, found))?;
            Ok(Mark::new(
                label.to_owned(),
                ImagePoint::new(x + shift, y + shift),
            ))
        })
        .collect()
}

/// The marks of the shapes within an element.
fn marks_within(parent: Element<'_>, shift: f64) -> Result<Vec<Mark>, Problem> {
    let shapes = parent
        .children()
        .filter(|shape| matches!(shape.tag_name().name(), "points" | "polyline"));
    let mut found = Vec::new();
    for shape in shapes {
        found.extend(marks(shape, shift)?);
    }
    Ok(found)
}

/// The marks of an image: its shapes' and its skeletons'. A skeleton holds no other.
fn marks_of_image(image: Element<'_>, shift: f64) -> Result<Vec<Mark>, Problem> {
    let mut found = marks_within(image, shift)?;
    for skeleton in image
        .children()
        .filter(|child| child.has_tag_name("skeleton"))
    {
        found.extend(marks_within(skeleton, shift)?);
    }
    Ok(found)
}

/// The key frames of tracks by their number in the task.
fn tracks(root: Element<'_>, shift: f64) -> Result<BTreeMap<u64, Vec<Mark>>, Problem> {
    let mut frames: BTreeMap<u64, Vec<Mark>> = BTreeMap::new();
    for track in root.children().filter(|child| child.has_tag_name("track")) {
        // The label stands at the track, or at the points within its skeletons. One that is missing
        // is reported as a label without a meaning.
        let label = track.attribute("label").unwrap_or_default();
        let shapes = track.children().filter(Element::is_element);
        // Shapes without `keyframe="1"` are interpolated by CVAT; an `outside` one ends the track's
        // visible part.
        for shape in shapes.filter(|shape| {
            shape.attribute("keyframe") == Some("1") && shape.attribute("outside") != Some("1")
        }) {
            let frame = frame_number("frame", number_attribute(shape, "frame")?)?;
            let of_shape = match shape.tag_name().name() {
                "points" | "polyline" => points(shape, label, shift)?,
                "skeleton" => marks_within(shape, shift)?,
                _ => continue,
            };
            frames.entry(frame).or_default().extend(of_shape);
        }
    }
    Ok(frames)
}

/// The size of a video task's pictures.
fn task_size(root: Element<'_>) -> Result<Option<ImageSize>, Problem> {
    let Some(size) = root
        .descendants()
        .find(|element| element.has_tag_name("original_size"))
    else {
        return Ok(None);
    };
    Ok(Some(ImageSize::new(
        original_side_px(size, "width")?,
        original_side_px(size, "height")?,
    )))
}

/// A side of `<original_size>`, px: the text of a child of this name.
fn original_side_px(size: Element<'_>, name: &str) -> Result<u32, Problem> {
    let text = size
        .children()
        .find(|child| child.has_tag_name(name))
        .and_then(|child| child.text())
        .ok_or_else(|| Problem::Missing(format!("{name} of <original_size>")))?;
    side_px(name, number(name, text)?)
}

/// The parsed text of CVAT's XML.
///
/// # Errors
/// It is not XML, has a document type, or its root is not `annotations`.
pub(in crate::exchange) fn parse_annotations(text: &str) -> Result<Xml<'_>, Problem> {
    refuse_many_attributes(text)?;
    let xml = Xml::parse(text).map_err(not_xml)?;
    let root = xml.root_element().tag_name().name();
    if root == "annotations" {
        return Ok(xml);
    }
    let found = format!("it begins with <{}>", shorten(root));
    Err(Problem::not_format("CVAT's XML", found))
}

/// The names of the tasks of a project, by their ids.
fn task_names(root: Element<'_>) -> BTreeMap<&str, &str> {
    let tasks = root
        .descendants()
        .filter(|element| element.has_tag_name("task"));
    tasks
        .filter_map(|task| Some((child_text(task, "id")?, child_text(task, "name")?)))
        .collect()
}

/// The text of a child of this name.
fn child_text<'a>(parent: Element<'a>, name: &str) -> Option<&'a str> {
    let child = parent.children().find(|child| child.has_tag_name(name))?;
    child.text().map(str::trim)
}

/// The folders of tasks by their ids, where images of several tasks have one name; else none.
fn folders_of_tasks(root: Element<'_>) -> Option<BTreeMap<String, String>> {
    let images = root.children().filter(|child| child.has_tag_name("image"));
    let mut seen = BTreeSet::new();
    let mut is_repeated = false;
    let mut tasks = BTreeSet::new();
    for image in images {
        is_repeated |= !seen.insert(image.attribute("name"));
        tasks.extend(image.attribute("task_id"));
    }
    if !is_repeated || tasks.is_empty() {
        return None;
    }
    // Two tasks may have one name.
    let names = task_names(root);
    let mut taken = BTreeSet::new();
    let folders = tasks.into_iter().map(|task| {
        let name = names.get(task).copied().unwrap_or(task);
        let name = name.replace(['/', '\\', ':'], "_");
        let free = if taken.insert(name.clone()) {
            name
        } else {
            format!("{name}-{task}")
        };
        (task.to_owned(), free)
    });
    Some(folders.collect())
}

/// The frame of an image; `folders` are those of tasks.
fn read_image(
    image: Element<'_>,
    folders: Option<&BTreeMap<String, String>>,
    options: &ImportOptions,
) -> Result<LabelledFrame, Problem> {
    let shift = options.shift_to_corner_px();
    let name = picture_path(attribute(image, "name")?, options)?;
    let folder = folders.and_then(|folders| folders.get(image.attribute("task_id")?));
    let name = match folder {
        Some(folder) => safe_path(&format!("{folder}/{name}"))?,
        None => name,
    };
    let size = ImageSize::new(side(image, "width")?, side(image, "height")?);
    Ok(LabelledFrame::new(
        &name,
        Some(name.clone()),
        size,
        marks_of_image(image, shift)?,
    ))
}

fn read_file(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    let options = reading.options;
    let xml = parse_annotations(text(bytes)?)?;
    let root = xml.root_element();
    let shift = options.shift_to_corner_px();
    let folders = folders_of_tasks(root);
    let mut frames: Vec<LabelledFrame> = Vec::new();
    for image in root.children().filter(|child| child.has_tag_name("image")) {
        let read = read_image(image, folders.as_ref(), options);
        let name = image
            .attribute("name")
            .unwrap_or("a picture without a name");
        frames.extend(reading.keep(file, Some(name), read));
    }
    let tracks = tracks(root, shift)?;
    if !tracks.is_empty() {
        // Images state their sizes themselves; the frames of a video have one size, that of the
        // task.
        let size = task_size(root)?
            .or(options.size)
            .ok_or_else(|| Problem::Missing("<original_size>".to_owned()))?;
        for (number, marks) in tracks {
            frames.push(LabelledFrame::new(
                &format!("frame_{number:06}"),
                None,
                size,
                marks,
            ));
        }
    }
    Ok(frames)
}

impl ClickFormat for Cvat {
    fn about(&self) -> About {
        About {
            name: "cvat",
            title: "CVAT for images, XML 1.1",
            conventions: "pixels from the corner",
            users: "CVAT",
            loses: None,
            file: Some("annotations.xml"),
            files: "annotations.xml",
            endings: &["xml"],
            export_options: &[],
            import_options: format_options::LABELS_IN,
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| read_file((file, bytes), reading))
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::read_alone;
    use super::*;

    const GOOD: &str = r#"<annotations><version>1.1</version><image id="0" name="clip/0001.jpg" width="1920" height="1080">
 <points label="centre_mark" occluded="0" points="444.68,789.18" z_order="0"></points>
 <polyline label="halfway_line" occluded="0" points="434.1,535.7;440.6,690.3" z_order="0"></polyline>
 <skeleton label="pitch" z_order="0"><points label="corner_far_left" outside="1" points="0.00,0.00"></points>
 <points label="corner_near_left" outside="0" points="1.00,2.00"></points></skeleton>
</image></annotations>"#;

    fn read(text: &str) -> Result<Vec<LabelledFrame>, String> {
        let files = Files::one("a.xml", text.as_bytes().to_vec());
        read_alone(&Cvat, &files, &ImportOptions::default(), None)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn points_polylines_and_skeletons_are_marks() {
        let frames = read(GOOD).unwrap();
        let marks: Vec<(&str, f64)> = frames[0]
            .marks
            .iter()
            .map(|mark| (mark.label.as_str(), mark.image.x))
            .collect();
        let wanted = [
            ("centre_mark", 444.68),
            ("halfway_line", 434.1),
            ("halfway_line", 440.6),
            ("corner_near_left", 1.0),
        ];
        assert_eq!(
            (frames[0].name.as_str(), marks.as_slice()),
            ("clip/0001.jpg", wanted.as_slice())
        );
    }

    #[test]
    fn only_key_frames_of_tracks_are_taken() {
        let track = r#"<annotations><meta><original_size><width>640</width><height>360</height></original_size></meta>
<track id="0" label="centre_mark"><points frame="3" keyframe="1" outside="0" points="1,2"/>
<points frame="4" keyframe="0" outside="0" points="3,4"/><points frame="5" keyframe="1" outside="1" points="5,6"/></track></annotations>"#;
        let frames = read(track).unwrap();
        assert_eq!(frames.len(), 1);
        assert_eq!(
            (frames[0].name.as_str(), frames[0].size),
            ("frame_000003", ImageSize::new(640, 360))
        );
        assert_eq!(
            frames[0].marks,
            [Mark::new(
                "centre_mark".to_owned(),
                ImagePoint::new(1.0, 2.0)
            )]
        );
    }

    #[test]
    fn interpolated_points_of_a_skeleton_are_left_out() {
        let track = r#"<annotations><meta><original_size><width>640</width><height>360</height></original_size></meta>
<track id="0" label="pitch"><skeleton frame="3" keyframe="1"><points label="centre_mark" keyframe="1" points="1,2"/>
<points label="halfway_far" keyframe="0" points="3,4"/></skeleton></track></annotations>"#;
        let frames = read(track).unwrap();
        let labels: Vec<&str> = frames[0]
            .marks
            .iter()
            .map(|mark| mark.label.as_str())
            .collect();
        assert_eq!(labels, ["centre_mark"]);
    }

    #[test]
    fn an_element_of_a_hundred_thousand_attributes_is_refused_at_once() {
        let many = |count: usize| {
            (0..count)
                .map(|index| format!(" a{index}='>='"))
                .collect::<Vec<_>>()
                .concat()
        };
        let with = |attributes: String| {
            GOOD.replacen(
                "<image ",
                &format!("<!-- don't = --><image{attributes} "),
                1,
            )
        };
        assert!(read(&with(many(90))).is_ok());
        let error = read(&with(many(100_000))).unwrap_err();
        assert_eq!(
            error,
            "a.xml: not valid XML: an element has more than 100 attributes"
        );
    }

    #[test]
    fn damaged_and_hostile_files_are_named_in_one_line() {
        let swap = |from: &str, to: &str| GOOD.replacen(from, to, 1);
        let entities = "<!DOCTYPE a [<!ENTITY b \"c\"><!ENTITY d \"&b;&b;&b;\">]><annotations>&d;</annotations>";
        for (text, wanted) in [
            (String::new(), "the file is empty"),
            ("not xml".to_owned(), "not valid XML: "),
            (
                "<a\u{14}/>".to_owned(),
                "not valid XML: expected a whitespace not '\\u{14}'",
            ),
            (GOOD[..200].to_owned(), "not valid XML: "),
            (
                entities.to_owned(),
                "not valid XML: it has a document type (<!DOCTYPE …>), which is not read",
            ),
            (
                "<html></html>".to_owned(),
                "not CVAT's XML: it begins with <html>",
            ),
            (swap("width=\"1920\"", ""), "width of <image> is missing"),
            (
                swap("width=\"1920\"", "width=\"0\""),
                "width is 0, which must be a whole number from 1 to 65535",
            ),
            (
                swap("clip/0001.jpg", "../0001.jpg"),
                "the picture \"../0001.jpg\" lies outside the folder; give --images FOLDER",
            ),
            (
                swap("444.68,789.18", "444.68"),
                "coordinates of a point: 2 are expected, found 1",
            ),
            (
                swap("444.68,789.18", "nan,789.18"),
                "points is not a finite number",
            ),
            (
                swap("444.68,789.18", ""),
                "points: a number is expected, found \"\"",
            ),
            (
                swap(" label=\"centre_mark\"", ""),
                "label of <points> is missing",
            ),
        ] {
            let error = read(&text).unwrap_err();
            assert!(
                error.starts_with(&format!("a.xml: {wanted}")),
                "{error}\nwanted {wanted}"
            );
            assert!(!error.contains('\n'));
        }
    }

    #[test]
    fn tasks_of_a_project_tell_images_of_one_name_apart() {
        let project = r#"<annotations><meta><project><tasks><task><id>7</id><name>first leg</name></task><task><id>8</id><name>second</name></task></tasks></project></meta>
<image id="0" name="frame_000000.png" subset="Train" task_id="7" width="640" height="360"><points label="centre_mark" points="1,2"/></image>
<image id="1" name="frame_000000.png" subset="Test" task_id="8" width="640" height="360"><points label="centre_mark" points="3,4"/></image></annotations>"#;
        let names = |text: &str| {
            let frames = read(text).unwrap();
            let names = frames.into_iter().map(|frame| frame.name);
            names.collect::<Vec<String>>()
        };
        assert_eq!(
            names(project),
            ["first leg/frame_000000.png", "second/frame_000000.png"]
        );
        let others = project.replace(
            "id=\"1\" name=\"frame_000000",
            "id=\"1\" name=\"frame_000001",
        );
        assert_eq!(names(&others), ["frame_000000.png", "frame_000001.png"]);
    }
}
