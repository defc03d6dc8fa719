//! Formats of labels with a probability where labels have a visibility: what networks predict.

use crate::exchange::click_formats::clicked_frame::{
    ClickFormat, LabelReader, LabelledFrame, Mark, ThirdNumber, size_or_option,
};
use crate::exchange::click_formats::points_table::PointsTable;
use crate::exchange::click_formats::{coco, yolo_pose};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::Pixels;
use crate::exchange::syntax::node::{Node, parse};
use std::collections::BTreeMap;

/// COCO keypoints, or the list of results that evaluations read: `image_id`, `keypoints` with x, y
/// and probability. Results name neither pictures nor points: a picture is called by its id, a
/// point by its index from 0, which `--map` gives a meaning.
pub(super) struct ScoredCoco;

/// Predictions of Ultralytics' pose models (`save_txt`).
pub(super) struct ScoredYolo;

/// A table of points with a column p or `sigma_px`.
pub(super) struct ScoredTable;

/// The marks of an entry of a list of results, and the id of its picture.
fn marks_of_result(entry: &Node<'_>, shift_px: f64) -> Result<(i64, Vec<Mark>), Problem> {
    let id = coco::id_of(&entry.key("image_id")?)?;
    let points = entry.key("keypoints")?;
    let values = points.all_numbers()?;
    if !values.len().is_multiple_of(3) {
        return Err(Problem::wrong_count(
            format!("{} (numbers)", points.path()),
            values.len().next_multiple_of(3),
            values.len(),
        ));
    }
    let names: Vec<String> = (0..values.len() / 3)
        .map(|index| index.to_string())
        .collect();
    let third = (ThirdNumber::Probability, shift_px);
    Ok((id, coco::marks_of_keypoints(&values, &names, third)?))
}

/// The frames of a list of results.
fn read_results(
    file: &str,
    root: &Node<'_>,
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    // COCO counts from pixel centres.
    let shift_px = reading
        .options
        .pixels
        .unwrap_or(Pixels::Centre)
        .to_corner_px();
    let mut frames: BTreeMap<i64, LabelledFrame> = BTreeMap::new();
    for entry in root.items()? {
        let read = marks_of_result(&entry, shift_px);
        let Some((id, marks)) = reading.keep(file, Some(entry.path()), read) else {
            continue;
        };
        let name = id.to_string();
        let size = size_or_option(&name, (reading.sizes)(&name), reading.options)?;
        let frame = frames
            .entry(id)
            .or_insert_with(|| LabelledFrame::new(&name, None, size, Vec::new()));
        frame.marks.extend(marks);
    }
    Ok(frames.into_values().collect())
}

impl ClickFormat for ScoredCoco {
    fn about(&self) -> About {
        About {
            title: "COCO keypoints or results with probabilities",
            loses: None,
            ..coco::Coco.about()
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            let value = parse(bytes)?;
            if value.is_array() {
                return read_results(file, &Node::root(&value), reading);
            }
            coco::read_with(ThirdNumber::Probability, (file, bytes), reading)
        })
    }
}

impl ClickFormat for ScoredYolo {
    fn about(&self) -> About {
        About {
            title: "predictions of Ultralytics' pose models",
            loses: None,
            ..yolo_pose::YoloPose.about()
        }
    }

    fn is_wanted(&self, name: &str) -> bool {
        yolo_pose::is_label_file(name)
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        yolo_pose::read_with(ThirdNumber::Probability, files, reading)
    }
}

impl ClickFormat for ScoredTable {
    fn about(&self) -> About {
        About {
            name: "table",
            title: "a table: frame, label, x, y, and p or sigma_px",
            import_options: format_options::LABELS_IN,
            ..PointsTable.about()
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        PointsTable.read(files, reading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::click_formats::clicked_frame::read_alone;
    use crate::exchange::options::{ImportOptions, PointModel};
    use touchline_core::geometry::{ImagePoint, ImageSize};

    const SIZE: ImageSize = ImageSize::new(1000, 500);

    fn marks(format: &dyn ClickFormat, file: &str, text: &str) -> Vec<Mark> {
        let files = Files::one(file, text.as_bytes().to_vec());
        let options = ImportOptions {
            model: Some(PointModel {
                name: "net".to_owned(),
                min_probability: 0.0,
            }),
            ..ImportOptions::default()
        };
        let frames = read_alone(format, &files, &options, Some(SIZE)).unwrap();
        assert_eq!(frames.len(), 1);
        frames[0].marks.clone()
    }

    #[test]
    fn predictions_of_networks_are_read_with_their_probabilities() {
        let results = r#"[{"image_id": 7, "category_id": 1, "score": 0.9,
            "keypoints": [10, 20, 0.5, 0, 0, 0, 30, 40, 1.05]}]"#;
        let found = marks(&ScoredCoco, "results.json", results);
        assert_eq!(found[0].image, ImagePoint::new(10.5, 20.5));
        let found: Vec<(&str, Option<f64>)> = found
            .iter()
            .map(|mark| (mark.label.as_str(), mark.probability))
            .collect();
        assert_eq!(found, [("0", Some(0.5)), ("2", Some(1.0))]);

        // Class, box, three points, the box's probability, the track.
        let yolo = "0 .5 .5 1 1 .1 .2 .75 0 0 .3 .3 .4 .25 .9 12\n";
        let found = marks(&ScoredYolo, "7.txt", yolo);
        let found: Vec<(&str, ImagePoint, Option<f64>)> = found
            .iter()
            .map(|mark| (mark.label.as_str(), mark.image, mark.probability))
            .collect();
        assert_eq!(
            found,
            [
                ("0", ImagePoint::new(100.0, 100.0), Some(0.75)),
                ("2", ImagePoint::new(300.0, 200.0), Some(0.25))
            ]
        );

        let table = "frame,label,x,y,p,sigma_px\n7,centre_mark,1,2,0.5,\n7,halfway_far,3,4,,2.5\n";
        let found = marks(&ScoredTable, "points.csv", table);
        assert_eq!((found[0].probability, found[0].sigma_px), (Some(0.5), None));
        assert_eq!((found[1].probability, found[1].sigma_px), (None, Some(2.5)));
    }

    #[test]
    fn a_visibility_is_no_probability() {
        let results = r#"[{"image_id": 7, "keypoints": [10, 20, 2]}]"#;
        let files = Files::one("results.json", results.as_bytes().to_vec());
        let error = read_alone(&ScoredCoco, &files, &ImportOptions::default(), Some(SIZE));
        assert_eq!(
            error.unwrap_err().to_string(),
            "results.json: the probability of \"0\" is 2, which must be between 0 and 1; files of \
             labels are imported without --points"
        );
    }
}
