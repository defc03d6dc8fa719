//! Reads what SoccerNet's files say of pictures: points of lines by their class, and boxes of
//! people and the ball.
//!
//! Besides the files of one picture there are two of many: `Labels-GameState.json` of a clip of the
//! game state challenge, with shares of the picture, and `Labels-v3.json` of a match of
//! SoccerNet-v3, with pixels. Source: SoccerNet/sn-gamestate; SoccerNet/SoccerNet-v3,
//! `dataloader.py`.

use super::clicked_frame::{LabelReader, LabelledFrame, Mark};
use crate::exchange::error::Problem;
use crate::exchange::files::{base_name, folder_prefix};
use crate::exchange::syntax::node::{Node, safe_path};
use crate::exchange::syntax::values::shorten;
use serde_json::Value;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// A file of the data set with many pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManyPictures {
    /// Everything about a clip of the game state challenge.
    GameState,
    /// The actions of a match and their replays.
    Match,
}

/// The name of [`ManyPictures::GameState`].
const GAME_STATE: &str = "Labels-GameState.json";
/// The name of [`ManyPictures::Match`].
const LABELS_V3: &str = "Labels-v3.json";
/// The keys of [`ManyPictures::Match`], all of which are objects.
const KEYS_OF_MATCH: [&str; 3] = ["GameMetadata", "actions", "replays"];
/// The folder of a match with its pictures, beside its file.
const FRAMES_OF_MATCH: &str = "v3_frames";

/// A point this little beyond the border, as a share of the picture, is on the border. In 400
/// pictures 148 points lie up to a tenth of a pixel beyond it, and four up to one.
const BORDER_SHARE: f64 = 1e-3;

impl ManyPictures {
    /// What a file of this name and content is; none where it is another one.
    ///
    /// A file of the right name is one of them even if it is damaged, so that what is wrong with it
    /// is said.
    pub fn of_file(name: &str, value: Option<&Value>) -> Option<Self> {
        match base_name(name) {
            GAME_STATE => Some(Self::GameState),
            LABELS_V3 => Some(Self::Match),
            _ => value.and_then(Self::of_keys),
        }
    }

    /// What a file of this name with JSON in it is recognized as; none where it is another one.
    pub fn recognize(name: &str, value: &Value) -> Option<Self> {
        // Other files of the data set's family are called `Labels-v3.json` and have no such keys.
        let is_game_state = base_name(name) == GAME_STATE;
        is_game_state
            .then_some(Self::GameState)
            .or_else(|| Self::of_keys(value))
    }

    fn of_keys(value: &Value) -> Option<Self> {
        KEYS_OF_MATCH
            .iter()
            .all(|key| value.get(key).is_some_and(Value::is_object))
            .then_some(Self::Match)
    }

    /// The pictures of a file. One that is damaged is left out.
    ///
    /// # Errors
    /// The file is damaged as a whole, or a picture's name leads out of the folder.
    pub fn read(
        self,
        file: &str,
        root: &Node<'_>,
        reading: &LabelReader<'_>,
    ) -> Result<Vec<LabelledFrame>, Problem> {
        match self {
            Self::GameState => read_game_state(file, root, reading),
            Self::Match => read_match(file, root, reading),
        }
    }
}

/// The marks of lines by their classes, whose points are shares of a picture.
///
/// # Errors
/// A value is missing, of another kind, or no share.
pub fn marks_of_shares(lines: &Node<'_>, size: ImageSize) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    for (class, points) in lines.entries()? {
        for point in points.items()? {
            let image = ImagePoint::new(
                Unit::Share.px_of(&point.key("x")?, size.width)?,
                Unit::Share.px_of(&point.key("y")?, size.height)?,
            );
            marks.push(Mark::new(class.to_owned(), image));
        }
    }
    Ok(marks)
}

/// What coordinates of points are in.
#[derive(Clone, Copy)]
enum Unit {
    Share,
    Pixel,
}

impl Unit {
    /// A coordinate of a point along a side of the picture, px.
    ///
    /// A point on the border is often written a little beyond it. Annotators may also drag points
    /// there, which are kept where they are.
    fn px_of(self, coordinate: &Node<'_>, side: u32) -> Result<f64, Problem> {
        let (value, side) = (coordinate.number()?, f64::from(side));
        let share = match self {
            Self::Share => value,
            Self::Pixel => value / side,
        };
        if (-BORDER_SHARE..=1.0 + BORDER_SHARE).contains(&share) {
            return Ok(share.clamp(0.0, 1.0) * side);
        }
        // Values far beyond are in another unit.
        if (-0.5..=1.5).contains(&share) {
            return Ok(share * side);
        }
        Err(Problem::out_of_range(
            coordinate.path(),
            value,
            match self {
                Self::Share => "a share of the picture, 0 to 1",
                Self::Pixel => "a pixel of the picture",
            },
        ))
    }
}

fn read_game_state(
    file: &str,
    root: &Node<'_>,
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
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
        frames.push(LabelledFrame::new(
            &name,
            Some(name.clone()),
            image.size_at("width", "height")?,
            Vec::new(),
        ));
    }
    for annotation in root.key("annotations")?.items()? {
        // People and the ball have boxes.
        let lines = annotation.find("lines");
        let found = annotation
            .find("bbox_image")
            .filter(|_| reading.options.masks);
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
            let read = found.numbers_at(["x", "y", "w", "h"]);
            let mask = read.map(|[x, y, width, height]| {
                part_in_picture([x, y, x + width, y + height], frame.size)
            });
            let mask = reading.keep(file, Some(&frame.name), mask);
            frame.masks.extend(mask.flatten());
        }
        if let Some(lines) = lines {
            let read = marks_of_shares(&lines, frame.size);
            let marks = reading.keep(file, Some(&frame.name), read);
            frame.marks.extend(marks.unwrap_or_default());
        }
    }
    Ok(frames)
}

fn read_match(
    file: &str,
    root: &Node<'_>,
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    let mut frames = Vec::new();
    for key in ["actions", "replays"] {
        for (name, picture) in root.key(key)?.entries()? {
            safe_path(name)?;
            let name = safe_path(&format!("{}{FRAMES_OF_MATCH}/{name}", folder_prefix(file)))?;
            let read = read_picture(&name, &picture, reading.options.masks);
            frames.extend(reading.keep(file, Some(&name), read));
        }
    }
    // An action is followed by its replays: 7.png, 7_1.png, 7_2.png, 8.png.
    frames.sort_by(|a, b| alphanumeric_sort::compare_str(&a.name, &b.name));
    Ok(frames)
}

/// A picture of a match. Things without a class were not annotated.
fn read_picture(
    name: &str,
    picture: &Node<'_>,
    with_masks: bool,
) -> Result<LabelledFrame, Problem> {
    let size = picture.key("imageMetadata")?.size_at("width", "height")?;
    let mut marks = Vec::new();
    for line in picture.key("lines")?.items()? {
        let Some(class) = line.find("class") else {
            continue;
        };
        let class = class.text()?;
        marks.extend(marks_of_pixels(class, &line.key("points")?, size)?);
    }
    let masks = if with_masks {
        masks_of_boxes(&picture.key("bboxes")?, size)?
    } else {
        Vec::new()
    };
    Ok(LabelledFrame {
        name: name.to_owned(),
        image: Some(name.to_owned()),
        size,
        marks,
        masks,
    })
}

/// The masks of a picture of a match. All that has a box moves: people, ball, cards, flags.
fn masks_of_boxes(boxes: &Node<'_>, size: ImageSize) -> Result<Vec<PixelBox>, Problem> {
    let mut masks = Vec::new();
    for found in boxes.items()? {
        if found.find("class").is_none() {
            continue;
        }
        let points = found.key("points")?;
        let [x1, y1, x2, y2] = points.numbers_at(["x1", "y1", "x2", "y2"])?;
        // People drag boxes from any corner to the opposite one.
        let corners = [x1.min(x2), y1.min(y2), x1.max(x2), y1.max(y2)];
        masks.extend(part_in_picture(corners, size));
    }
    Ok(masks)
}

/// The marks of a line whose points are x and y in turn, px.
fn marks_of_pixels(class: &str, points: &Node<'_>, size: ImageSize) -> Result<Vec<Mark>, Problem> {
    let found = points.count()?;
    if !found.is_multiple_of(2) {
        return Err(Problem::wrong_count(
            format!("{} (x and y in turn)", points.path()),
            found + 1,
            found,
        ));
    }
    let mut coordinates = points.items()?;
    let mut marks = Vec::with_capacity(found / 2);
    while let (Some(x), Some(y)) = (coordinates.next(), coordinates.next()) {
        let image = ImagePoint::new(
            Unit::Pixel.px_of(&x, size.width)?,
            Unit::Pixel.px_of(&y, size.height)?,
        );
        marks.push(Mark::new(class.to_owned(), image));
    }
    Ok(marks)
}

/// The part of a box that lies in the picture, px; none where no part does. A box is the left, top,
/// right and bottom side.
fn part_in_picture([left, top, right, bottom]: [f64; 4], size: ImageSize) -> Option<PixelBox> {
    let (left, top) = (left.max(0.0), top.max(0.0));
    let (right, bottom) = (
        right.min(f64::from(size.width)),
        bottom.min(f64::from(size.height)),
    );
    (right > left && bottom > top).then_some(PixelBox::new(left, top, right - left, bottom - top))
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::{LabelReading, read_alone, read_labels};
    use super::super::soccernet_lines::SoccerNetLines;
    use super::*;
    use crate::exchange::files::Files;
    use crate::exchange::options::ImportOptions;
    use serde_json::json;

    #[test]
    fn points_on_the_border_are_inside_the_picture_and_others_beyond_it_stay() {
        let beyond = [
            json!({ "x": 1.00001, "y": -0.00002 }),
            json!({ "x": 1.004, "y": 0.5 }),
        ];
        let lines = json!({ "Middle line": beyond });
        let marks = marks_of_shares(&Node::root(&lines), ImageSize::new(960, 540)).unwrap();
        let at = |mark: &Mark| (mark.image.x, mark.image.y);
        assert_eq!(at(&marks[0]), (960.0, 0.0));
        assert_eq!(at(&marks[1]), (963.84, 270.0));
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

    /// A match with an action of two lines and two boxes, and its replays.
    fn labels_of_match() -> Value {
        let meta = json!({ "width": 1920, "height": 1080, "gameTime": "1 - 02:00" });
        let player = |points: [f64; 4]| {
            let [x1, y1, x2, y2] = points;
            let points = json!({ "x1": x1, "y1": y1, "x2": x2, "y2": y2 });
            json!({ "class": "Player team left", "ID": "7", "points": points })
        };
        let line = |class: Value, points: Value| json!({ "class": class, "points": points });
        let lines = [
            line("Middle line".into(), json!([960, 270.5, 961, 1080.4])),
            line("Goal left post left ".into(), json!([10, 20])),
            line(Value::Null, json!([1, 2])),
        ];
        let unknown = json!({ "class": null, "ID": null, "points": {} });
        let replay = |lines: Value| json!({ "imageMetadata": meta, "lines": lines, "bboxes": [], "linked_action": "7.png" });
        json!({
            "GameMetadata": { "UrlLocal": "a/b", "list_actions": ["7.png"] },
            "actions": { "7.png": {
                "imageMetadata": meta,
                "lines": lines,
                "bboxes": [player([140.0, 90.0, 100.0, 10.0]), player([-9.0, 0.0, -1.0, 5.0]), unknown],
                "linked_replays": ["7_1.png", "7_2.png", "7_10.png"],
            } },
            "replays": {
                "7_10.png": replay(json!([])),
                "7_1.png": replay(json!([line("Side line top".into(), json!([1, 2, 3]))])),
                "7_2.png": replay(json!([line("Side line top".into(), json!([5000, 2]))])),
            },
        })
    }

    #[test]
    fn a_match_has_the_lines_of_its_actions_and_replays() {
        let text = labels_of_match().to_string();
        // The folder of a match, or a file by another name.
        for (name, folder) in [("league/a b/Labels-v3.json", "league/a b/"), ("1.json", "")] {
            let files = Files::one(name, text.clone().into_bytes());
            let options = ImportOptions {
                masks: true,
                ..ImportOptions::default()
            };
            let reading = LabelReading {
                options: &options,
                sizes: &|_| None,
            };
            let (frames, unread) = read_labels(&SoccerNetLines, &files, &reading).unwrap();
            let names: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
            let wanted = ["7.png", "7_10.png"].map(|name| format!("{folder}v3_frames/{name}"));
            assert_eq!(names, wanted);
            let marks = frames[0].marks.iter();
            let marks: Vec<(&str, f64, f64)> = marks
                .map(|mark| (mark.label.as_str(), mark.image.x, mark.image.y))
                .collect();
            let ours = [
                ("Middle line", 960.0, 270.5),
                ("Middle line", 961.0, 1080.0),
                ("Goal left post left ", 10.0, 20.0),
            ];
            assert_eq!(marks, ours);
            let mask = PixelBox {
                x: 100.0,
                y: 10.0,
                width: 40.0,
                height: 80.0,
            };
            assert_eq!(
                frames[0].masks,
                [mask],
                "one lies outside, one is of nothing"
            );
            let said = unread.describe(2).unwrap();
            assert!(
                said.starts_with("2 of 4 pictures have no labels that can be read: "),
                "{said}"
            );
            assert!(
                said.contains("points (x and y in turn): 4 are expected, found 3"),
                "{said}"
            );
        }
    }

    #[test]
    fn masks_of_a_match_are_not_read_unless_they_are_asked_for() {
        let mut labels = labels_of_match();
        labels["actions"]["7.png"]["bboxes"] = json!("damaged");
        let files = Files::one(LABELS_V3, labels.to_string().into_bytes());
        let frames = read_alone(&SoccerNetLines, &files, &ImportOptions::default(), None).unwrap();
        assert_eq!((frames[0].marks.len(), frames[0].masks.len()), (3, 0));
    }

    #[test]
    fn a_match_is_known_by_its_keys_and_not_by_its_name() {
        let known = |name: &str, value: &Value| ManyPictures::recognize(name, value);
        assert_eq!(
            known("1.json", &labels_of_match()),
            Some(ManyPictures::Match)
        );
        for key in KEYS_OF_MATCH {
            let mut other = labels_of_match();
            other[key] = json!([]);
            assert_eq!(known(LABELS_V3, &other), None, "{key} is a list");
        }
        let spotting = json!({ "UrlLocal": "a/b", "annotations": [] });
        assert_eq!(known(LABELS_V3, &spotting), None);
        assert_eq!(known(GAME_STATE, &spotting), Some(ManyPictures::GameState));
    }
}
