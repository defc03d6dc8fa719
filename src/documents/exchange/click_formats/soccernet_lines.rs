//! SoccerNet's line annotations: `{frame}.json`, with points for each class of line, as fractions
//! of the picture's width and height.
//!
//! The first and last point of a straight line are its extremities, more may lie between. The class
//! `Goal left post left ` ends in a space in the calibration challenge and has none in the game
//! state challenge. Corner arcs have no class. Source: SoccerNet/sn-calibration,
//! SoccerNet/sn-gamestate.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReading, LabelledFrame, Mark, UnreadLabels,
    size_or_option,
};
use super::coco::range_of;
use super::labels::SOCCERNET_LINES;
use crate::document::{Click, Target};
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::{Files, base_name, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::LabelMap;
use crate::exchange::syntax::node::{Node, parse, safe_path};
use crate::exchange::syntax::values::shorten;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// The format.
pub struct SoccerNetLines;

/// The file of the game state challenge with everything about a clip.
pub const GAME_STATE: &str = "Labels-GameState.json";

/// The beginning of the classes of curves, which have no ends.
const CIRCLE: &str = "Circle";

/// A point this little beyond the border, as a share of the picture, is on the border. In 400
/// pictures 148 points lie up to a tenth of a pixel beyond it, and four up to one.
const BORDER_SHARE: f64 = 1e-3;

/// The class of the line that a click is on.
fn class_of(click: &Click) -> Option<&'static str> {
    let Some(Target::Line(id)) = &click.target else {
        return None;
    };
    SOCCERNET_LINES
        .iter()
        .find(|(_, line)| *line == id.as_str())
        .map(|(class, _)| *class)
}

fn annotation(frame: &ClickedFrame, game_state: bool) -> Value {
    let (width, height) = (f64::from(frame.size.width), f64::from(frame.size.height));
    let mut lines = Map::new();
    // In the order of the classes, whatever the order in which the lines were clicked.
    for (class, line) in SOCCERNET_LINES {
        let mut places: Vec<ImagePoint> = frame
            .clicks
            .iter()
            .filter(|click| matches!(&click.target, Some(Target::Line(id)) if id.as_str() == line))
            .map(|click| click.image)
            .collect();
        if !class.starts_with(CIRCLE) {
            sort_along(&mut places);
        }
        let points: Vec<Value> = places
            .iter()
            .map(|place| json!({ "x": place.x / width, "y": place.y / height }))
            .collect();
        if !points.is_empty() {
            lines.insert(
                if game_state { class.trim_end() } else { class }.to_owned(),
                Value::Array(points),
            );
        }
    }
    Value::Object(lines)
}

/// Sorts the points of a straight line from one end to the other: readers take the first and the
/// last one for its ends, and people click in any order.
fn sort_along(places: &mut [ImagePoint]) {
    // Along the side of the picture over which the line extends farther the order is that on the
    // line.
    let (left, right) = range_of(places.iter().map(|place| place.x));
    let (top, bottom) = range_of(places.iter().map(|place| place.y));
    if right - left >= bottom - top {
        places.sort_by(|a, b| a.x.total_cmp(&b.x));
    } else {
        places.sort_by(|a, b| a.y.total_cmp(&b.y));
    }
}

fn read_file(bytes: &[u8], size: ImageSize) -> Result<Vec<Mark>, Problem> {
    let value = parse(bytes)?;
    marks_of_lines(&Node::root(&value), size)
}

/// The marks of lines by their classes.
fn marks_of_lines(lines: &Node<'_>, size: ImageSize) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    for (class, points) in lines.entries()? {
        for point in points.items()? {
            let image = ImagePoint::new(
                share_of_side(&point.key("x")?)? * f64::from(size.width),
                share_of_side(&point.key("y")?)? * f64::from(size.height),
            );
            marks.push(Mark::new(class.to_owned(), image));
        }
    }
    Ok(marks)
}

/// A coordinate of a point, as a share of the picture's side.
///
/// A point on the border is often written a little beyond it. Annotators may also drag points
/// there, which are kept where they are.
fn share_of_side(coordinate: &Node<'_>) -> Result<f64, Problem> {
    let value = coordinate.number()?;
    if (-BORDER_SHARE..=1.0 + BORDER_SHARE).contains(&value) {
        return Ok(value.clamp(0.0, 1.0));
    }
    // Values far beyond are no shares but pixels.
    if (-0.5..=1.5).contains(&value) {
        return Ok(value);
    }
    Err(Problem::OutOfRange {
        what: coordinate.path().to_owned(),
        value,
        wanted: "a share of the picture, 0 to 1",
    })
}

/// The frames of a file of the game state challenge, which has all pictures of a clip and more than
/// their lines.
fn read_game_state(
    file: &str,
    bytes: &[u8],
    with_masks: bool,
    unread: &mut UnreadLabels,
) -> Result<Vec<LabelledFrame>, Problem> {
    let value = parse(bytes)?;
    let root = Node::root(&value);
    // The pictures lie in a folder of the clip.
    let folder = root.find("info").and_then(|info| info.find("im_dir"));
    let folder = folder.and_then(|folder| folder.value().as_str());
    let folder = folder.map_or_else(String::new, |folder| format!("{folder}/"));
    let mut frames: Vec<LabelledFrame> = Vec::new();
    let mut at: BTreeMap<String, usize> = BTreeMap::new();
    for image in root.key("images")?.items()? {
        let name = image.key("file_name")?.text()?;
        let name = safe_path(&format!("{folder}{name}"))?;
        at.insert(image.key("image_id")?.text()?.to_owned(), frames.len());
        frames.push(LabelledFrame {
            masks: Vec::new(),
            image: Some(name.clone()),
            name,
            size: image.size_at("width", "height")?,
            marks: Vec::new(),
        });
    }
    for annotation in root.key("annotations")?.items()? {
        // People and the ball have boxes.
        let lines = annotation.find("lines");
        let found = annotation.find("bbox_image").filter(|_| with_masks);
        if lines.is_none() && found.is_none() {
            continue;
        }
        let id = annotation.key("image_id")?.text()?;
        let index = *at.get(id).ok_or_else(|| Problem::Unknown {
            what: "the image of an annotation,",
            name: shorten(id),
        })?;
        let frame = &mut frames[index];
        if let Some(found) = found {
            let read = mask_of_box(&found, frame.size);
            let mask = unread.keep(file, Some(&frame.name), read);
            frame.masks.extend(mask.flatten());
        }
        if let Some(lines) = lines {
            let read = marks_of_lines(&lines, frame.size);
            let marks = unread.keep(file, Some(&frame.name), read);
            frame.marks.extend(marks.unwrap_or_default());
        }
    }
    Ok(frames)
}

/// The part of a person's box that lies in the picture, px; none where no part does.
fn mask_of_box(found: &Node<'_>, size: ImageSize) -> Result<Option<PixelBox>, Problem> {
    let [x, y, width, height] = found.numbers_at(["x", "y", "w", "h"])?;
    let (left, top) = (x.max(0.0), y.max(0.0));
    let (right, bottom) = (
        (x + width).min(f64::from(size.width)),
        (y + height).min(f64::from(size.height)),
    );
    Ok((right > left && bottom > top).then_some(PixelBox {
        x: left,
        y: top,
        width: right - left,
        height: bottom - top,
    }))
}

impl ClickFormat for SoccerNetLines {
    fn about(&self) -> About {
        About {
            name: "soccernet-lines",
            title: "SoccerNet line annotations, one file per frame",
            conventions: "points as fractions of width and height, by class of line",
            users: "SoccerNet calibration, game state (--variant gamestate)",
            loses: Some("landmarks, cameras; corner arcs have no class"),
            file: None,
            files: "line annotations (.json)",
            endings: &["json"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Projected,
                FormatOption::Variant,
            ],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::EachOwnCamera,
                FormatOption::StretchedFrom,
                FormatOption::Masks,
            ],
        }
    }

    fn has_shares_alone(&self) -> bool {
        true
    }

    fn holds(&self, click: &Click, _context: &ClickContext<'_>) -> bool {
        class_of(click).is_some()
    }

    fn holds_outside(&self) -> bool {
        false
    }

    fn name_of(&self, frame: &ClickedFrame) -> String {
        without_ending(&frame.image).to_owned()
    }

    fn write(
        &self,
        frames: &[ClickedFrame],
        context: &ClickContext<'_>,
    ) -> Result<Files, ExchangeError> {
        let mut files = Files::default();
        for frame in frames {
            files.add(
                format!("{}.json", frame.name),
                format!("{}\n", annotation(frame, context.options.game_state)),
            );
        }
        Ok(files)
    }

    fn is_wanted(&self, name: &str) -> bool {
        let file = base_name(name);
        // Files of the same data set that are no annotations: cameras, and the lists of matches.
        let other = file.starts_with("camera_") || file.ends_with("match_info.json");
        has_ending(name, "json") && !other
    }

    fn read(
        &self,
        files: &Files,
        reading: &LabelReading<'_>,
        unread: &mut UnreadLabels,
    ) -> Result<Vec<LabelledFrame>, ExchangeError> {
        files.read_all(|file, bytes| {
            if base_name(file) == GAME_STATE {
                return read_game_state(file, bytes, reading.options.masks, unread);
            }
            let path = without_ending(file);
            let size = size_or_option(path, (reading.sizes)(path), reading.options)?;
            let marks = unread.keep(file, None, read_file(bytes, size));
            let frame = marks.map(|marks| LabelledFrame {
                masks: Vec::new(),
                name: path.to_owned(),
                image: None,
                size,
                marks,
            });
            Ok(frame.into_iter().collect())
        })
    }

    fn own_labels(&self) -> LabelMap {
        LabelMap::SoccerNet
    }

    fn has_own_classes(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::{read_alone, read_labels};
    use super::*;
    use crate::exchange::export;
    use crate::exchange::options::ImportOptions;
    use crate::exchange::tests::{SIZE, export_as, reference, text_of, with_clicks};
    use crate::exchange::{ExportOptions, Format, PointSource};
    use std::path::Path;

    #[test]
    fn clicks_on_lines_are_shares_of_the_picture() {
        let exported = export_as(&with_clicks(), Format::SoccerNetLines);
        let lines: Value = serde_json::from_str(&text_of(&exported.files, "0001.json")).unwrap();
        assert_eq!(
            lines,
            json!({ "Middle line": [{ "x": 440.63 / 1920.0, "y": 690.25 / 1080.0 }] })
        );
    }

    #[test]
    fn the_ends_of_a_straight_line_are_its_first_and_last_point() {
        let mut document = with_clicks();
        for (x, y) in [(450.0, 400.0), (436.0, 900.0), (441.0, 650.0)] {
            let end = Click::line("halfway_line".into(), ImagePoint::new(x, y));
            document.frames[0].clicks.push(end);
        }
        let exported = export_as(&document, Format::SoccerNetLines);
        let lines: Value = serde_json::from_str(&text_of(&exported.files, "0001.json")).unwrap();
        let points = lines["Middle line"].as_array().unwrap();
        let rows = points.iter().map(|point| point["y"].as_f64().unwrap());
        assert!(rows.is_sorted(), "{points:?}");
    }

    #[test]
    fn what_the_camera_shows_is_written_on_request_and_the_space_only_for_one_challenge() {
        let mut document = reference();
        document.frames[0].ptz.as_mut().unwrap().pan_deg = -30.0;
        let options = ExportOptions {
            points: PointSource::Projected,
            ..ExportOptions::default()
        };
        let text = |options: &ExportOptions| {
            let exported =
                export(document.at(Path::new("/")), Format::SoccerNetLines, options).unwrap();
            text_of(&exported.files, "0001.json")
        };
        let with_space = text(&options);
        assert!(
            with_space.contains("\"Goal left post left \""),
            "{with_space}"
        );
        let without = text(&ExportOptions {
            game_state: true,
            ..options
        });
        assert!(without.contains("\"Goal left post left\""), "{without}");
        assert!(
            with_space.contains("Side line top") && with_space.contains("Circle left"),
            "{with_space}"
        );
    }

    #[test]
    fn points_outside_of_the_picture_are_left_out_and_said_so() {
        let mut document = with_clicks();
        let beyond = Click::line("halfway_line".into(), ImagePoint::new(1920.5, 700.0));
        document.frames[0].clicks.push(beyond);
        let options = ExportOptions {
            keep_outside: true,
            ..ExportOptions::default()
        };
        let exported = export(
            document.at(Path::new("/")),
            Format::SoccerNetLines,
            &options,
        );
        let notes = exported.unwrap().notes;
        let said = "1 click outside of the picture, left out";
        assert!(notes.iter().any(|note| note == said), "{notes:?}");
    }

    #[test]
    fn points_on_the_border_are_inside_the_picture_and_others_beyond_it_stay() {
        let text = br#"{"Middle line": [{"x": 1.00001, "y": -0.00002}, {"x": 1.004, "y": 0.5}]}"#;
        let marks = read_file(text, ImageSize::new(960, 540)).unwrap();
        let at = |mark: &Mark| (mark.image.x, mark.image.y);
        assert_eq!(at(&marks[0]), (960.0, 0.0));
        assert_eq!(at(&marks[1]), (963.84, 270.0));
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        for (text, wanted) in [
            ("[]", "the file: an object is expected, found a list of 0"),
            (
                "{\"Middle line\": {}}",
                "[\"Middle line\"]: a list is expected, found an object",
            ),
            (
                "{\"Middle line\": [{\"x\": 0.5}]}",
                "[\"Middle line\"][0].y is missing",
            ),
            (
                "{\"Middle line\": [[0.5, 0.5]]}",
                "[\"Middle line\"][0]: an object is expected, found a list of 2",
            ),
            (
                "{\"Middle line\": [{\"x\": 960, \"y\": 540}]}",
                "[\"Middle line\"][0].x is 960, which must be a share of the picture, 0 to 1",
            ),
            (
                "{\"Middle line\": [{\"x\": null, \"y\": 0.5}]}",
                "[\"Middle line\"][0].x: a number is expected, found null",
            ),
        ] {
            let files = Files::one("a.json", text.as_bytes().to_vec());
            let error = read_alone(
                &SoccerNetLines,
                &files,
                &ImportOptions::default(),
                Some(SIZE),
            )
            .unwrap_err()
            .to_string();
            assert_eq!(error, format!("a.json: {wanted}"));
        }
    }

    #[test]
    fn boxes_of_people_are_masks_where_they_are_asked_for() {
        let with_box = |x: f64, w: f64| {
            let found = json!({ "x": x, "y": 5.0, "w": w, "h": 80.0 });
            json!({ "image_id": "1", "bbox_image": found })
        };
        let text = json!({
            "images": [{ "image_id": "1", "file_name": "1.jpg", "width": 1920, "height": 1080 }],
            "annotations": [with_box(100.0, 40.0), with_box(-10.0, 30.0), with_box(-50.0, 30.0)],
        });
        let files = Files::one(GAME_STATE, text.to_string().into_bytes());
        let masks = |masks: bool| {
            let options = ImportOptions {
                masks,
                ..ImportOptions::default()
            };
            let frames = read_alone(&SoccerNetLines, &files, &options, None).unwrap();
            let boxes = frames[0].masks.iter();
            boxes.map(|mask| [mask.x, mask.width]).collect::<Vec<_>>()
        };
        assert_eq!(
            masks(true),
            [[100.0, 40.0], [0.0, 20.0]],
            "what is in the picture"
        );
        assert!(masks(false).is_empty());
    }

    #[test]
    fn a_file_of_the_game_state_challenge_has_the_lines_of_all_pictures() {
        let text = json!({
            "info": { "im_dir": "img1" },
            "images": [
                { "image_id": "2021000001", "file_name": "000001.jpg", "width": 1920, "height": 1080 },
                { "image_id": "2021000002", "file_name": "000002.jpg", "width": 1920, "height": 1080 },
            ],
            "annotations": [
                { "image_id": "2021000001", "bbox_image": {} },
                { "image_id": "2021000001", "lines": { "Middle line": [{ "x": 0.5, "y": 0.25 }] } },
                { "image_id": "2021000002", "lines": { "Middle line": [{ "x": 7, "y": 0.25 }] } },
            ],
            "categories": [],
        });
        let files = Files::one(GAME_STATE, text.to_string().into_bytes());
        let reading = LabelReading {
            options: &ImportOptions::default(),
            sizes: &|_| None,
        };
        let (frames, unread) = read_labels(&SoccerNetLines, &files, &reading).unwrap();
        assert_eq!(frames[0].name, "img1/000001.jpg");
        assert_eq!(frames[0].marks[0].image, ImagePoint::new(960.0, 270.0));
        let said = unread.describe(1).unwrap();
        let wanted = "1 of 2 pictures has no labels that can be read: img1/000002.jpg (";
        assert!(said.starts_with(wanted), "{said}");
    }
}
