//! SoccerNet's line annotations: `{frame}.json`, with points for each class of line, as fractions
//! of the picture's width and height.
//!
//! The first and last point of a straight line are its extremities, more may lie between. The class
//! `Goal left post left ` ends in a space in the calibration challenge and has none in the game
//! state challenge. Corner arcs have no class. Source: SoccerNet/sn-calibration,
//! SoccerNet/sn-gamestate.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReader, LabelledFrame, size_or_option,
};
use super::coco::range_of;
use super::labels::SOCCERNET_LINES;
use super::soccernet_pictures::{ManyPictures, marks_of_shares};
use crate::document::{Click, Target};
use crate::exchange::cameras::camera_format::has_ending;
use crate::exchange::error::ExchangeResult;
use crate::exchange::files::{Files, base_name, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::LabelMap;
use crate::exchange::syntax::node::{Node, parse};
use serde_json::{Map, Value, json};
use touchline_core::geometry::ImagePoint;

/// The format.
pub struct SoccerNetLines;

/// The beginning of the classes of curves, which have no ends.
const CIRCLE: &str = "Circle";

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

    fn write(&self, frames: &[ClickedFrame], context: &ClickContext<'_>) -> ExchangeResult<Files> {
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

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            let value = parse(bytes);
            if let Some(kind) = ManyPictures::of_file(file, value.as_ref().ok()) {
                return kind.read(file, &Node::root(&value?), reading);
            }
            let path = without_ending(file);
            let size = size_or_option(path, (reading.sizes)(path), reading.options)?;
            let marks = value.and_then(|value| marks_of_shares(&Node::root(&value), size));
            let marks = reading.keep(file, None, marks);
            let frame = marks.map(|marks| LabelledFrame::new(path, None, size, marks));
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
    use super::super::clicked_frame::read_alone;
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
}
