//! Key points as Roboflow's `inference` writes them for RF-DETR and other models, a file a picture:
//!
//! ```json
//! {"image": {"width": 1280, "height": 720},
//!  "predictions": [{"class": "pitch", "confidence": 0.97,
//!                   "keypoints": [{"x": 640.5, "y": 360, "confidence": 0.9, "class": "13"}]}]}
//! ```
//!
//! The label of a point is its `class` (`class_name` in older files), else its `class_id`. Pixels
//! count from the picture's corner. Boxes are not read.

use crate::exchange::click_formats::clicked_frame::{
    ClickFormat, LabelReader, LabelledFrame, Mark, size_or_option,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::syntax::node::{Node, parse};
use touchline_core::geometry::ImagePoint;

/// The layout.
pub(super) struct RfDetr;

fn mark(point: &Node<'_>, shift_px: f64) -> Result<Mark, Problem> {
    let label = match point.find("class").or_else(|| point.find("class_name")) {
        Some(name) => name.text()?.to_owned(),
        None => point.key("class_id")?.number()?.to_string(),
    };
    let [x, y] = point.numbers_at(["x", "y"])?;
    let at = ImagePoint::new(x + shift_px, y + shift_px);
    Mark::new(label, at).with_probability(point.key("confidence")?.number()?)
}

fn read_picture(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<LabelledFrame, Problem> {
    let value = parse(bytes)?;
    let root = Node::root(&value);
    let name = stem(file).to_owned();
    let stated = match root.find("image") {
        Some(image) => image.find_size("width", "height")?,
        None => None,
    };
    let own = (reading.sizes)(&name).or(stated);
    let shift_px = reading.options.shift_to_corner_px();
    let mut marks = Vec::new();
    for prediction in root.key("predictions")?.items()? {
        let Some(points) = prediction.find("keypoints") else {
            continue;
        };
        for point in points.items()? {
            marks.extend(reading.keep(file, Some(point.path()), mark(&point, shift_px)));
        }
    }
    Ok(LabelledFrame::new(
        &name,
        None,
        size_or_option(&name, own, reading.options)?,
        marks,
    ))
}

impl ClickFormat for RfDetr {
    fn about(&self) -> About {
        About {
            name: "rf-detr",
            title: "predictions of RF-DETR as Roboflow's inference writes them",
            conventions: "pixels from the corner",
            users: "RF-DETR, Roboflow",
            loses: None,
            file: None,
            files: "predictions (.json)",
            endings: &["json"],
            export_options: &[],
            import_options: format_options::LABELS_IN,
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| Ok(vec![read_picture((file, bytes), reading)?]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::click_formats::clicked_frame::{LabelReading, read_labels};
    use super::*;
    use crate::exchange::options::ImportOptions;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn predictions_are_read_and_a_bad_point_costs_itself() {
        let text = r#"{"image": {"width": 1280, "height": 720}, "predictions": [
            {"class": "pitch", "confidence": 0.97, "x": 1, "y": 2, "keypoints": [
                {"x": 640.5, "y": 360, "confidence": 0.9, "class": "centre_mark", "class_id": 3},
                {"x": 1, "y": 2, "confidence": 0.8, "class_id": 13},
                {"x": 1, "y": 2, "confidence": 7, "class_id": 14}]},
            {"class": "ball", "confidence": 0.5, "x": 9, "y": 9}]}"#;
        let files = Files::one("0001.json", text.as_bytes().to_vec());
        let reading = LabelReading {
            options: &ImportOptions::default(),
            sizes: &|_| None,
        };
        let (frames, unread) = read_labels(&RfDetr, &files, &reading).unwrap();
        assert_eq!(
            (frames[0].name.as_str(), frames[0].size),
            ("0001", ImageSize::new(1280, 720))
        );
        let labels: Vec<&str> = frames[0].marks.iter().map(|mark| &*mark.label).collect();
        assert_eq!(labels, ["centre_mark", "13"]);
        assert_eq!(frames[0].marks[0].probability, Some(0.9));
        assert!(unread.describe(1).unwrap().contains("between 0 and 1"));
    }
}
