//! A plain JSON map of points: what a script of a few lines writes for any model.
//!
//! ```json
//! {"0001.jpg": {"centre_mark": [444.7, 789.2, 0.93],
//!               "halfway_line": [[434.1, 535.7, 0.8], [440.6, 690.3, 0.7]],
//!               "halfway_far": {"x": 434.1, "y": 535.7, "covariance_px2": [[4, 0], [0, 9]]}}}
//! ```
//!
//! A point is `[x, y]`, `[x, y, p]`, or an object with `x`, `y` and any of `p`, `sigma_px` and
//! `covariance_px2`; a label has one or a list of them. Pixels count from the picture's corner
//! unless `--pixels` says otherwise.

use crate::exchange::click_formats::clicked_frame::{
    ClickFormat, LabelReader, LabelledFrame, Mark, picture_path, size_or_option,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::Files;
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::syntax::node::{Node, parse};
use serde_json::Value;
use touchline_core::geometry::ImagePoint;

/// The layout.
pub(super) struct JsonMap;

/// The point of a label.
fn mark(label: &str, point: &Node<'_>, shift_px: f64) -> Result<Mark, Problem> {
    let at = |[x, y]: [f64; 2]| {
        Mark::new(
            label.to_owned(),
            ImagePoint::new(x + shift_px, y + shift_px),
        )
    };
    if let Some(items) = point.value().as_array() {
        if items.len() == 2 {
            return Ok(at(point.numbers()?));
        }
        let [x, y, probability] = point.numbers()?;
        return at([x, y]).with_probability(probability);
    }
    let mut mark = at(point.numbers_at(["x", "y"])?);
    if let Some(probability) = point.find("p") {
        mark = mark.with_probability(probability.number()?)?;
    }
    if let Some(covariance) = point.find("covariance_px2") {
        let rows = covariance.items()?.map(|row| row.numbers());
        let rows: Vec<[f64; 2]> = rows.collect::<Result<_, _>>()?;
        mark.sigma_px = Some(sigma_of(&rows, &covariance)?);
    }
    if let Some(sigma_px) = point.find("sigma_px") {
        mark.sigma_px = Some(sigma_px.positive()?);
    }
    Ok(mark)
}

/// 1-σ in each direction of a covariance: the root of the mean of its two variances.
fn sigma_of(rows: &[[f64; 2]], node: &Node<'_>) -> Result<f64, Problem> {
    match rows {
        [[xx, xy], [yx, yy]] if xx * yy - xy * yx > 0.0 && *xx > 0.0 => {
            Ok(f64::midpoint(*xx, *yy).sqrt())
        }
        _ => Err(Problem::Kind {
            what: node.path().to_owned(),
            wanted: "a positive definite matrix [[xx, xy], [xy, yy]]",
            found: node.value().to_string(),
        }),
    }
}

/// The marks of a picture.
fn marks(picture: &Node<'_>, shift_px: f64) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    for (label, points) in picture.entries()? {
        let is_list = |value: &Value| {
            value
                .as_array()
                .and_then(|items| items.first())
                .is_some_and(|first| !first.is_number())
        };
        if is_list(points.value()) {
            for point in points.items()? {
                marks.push(mark(label, &point, shift_px)?);
            }
        } else {
            marks.push(mark(label, &points, shift_px)?);
        }
    }
    Ok(marks)
}

fn read_map(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    let value = parse(bytes)?;
    let shift_px = reading.options.shift_to_corner_px();
    let mut frames = Vec::new();
    for (name, picture) in Node::root(&value).entries()? {
        let name = picture_path(name, reading.options)?;
        let size = size_or_option(&name, (reading.sizes)(&name), reading.options)?;
        let read = marks(&picture, shift_px);
        if let Some(marks) = reading.keep(file, Some(&name), read) {
            frames.push(LabelledFrame::new(&name, Some(name.clone()), size, marks));
        }
    }
    Ok(frames)
}

impl ClickFormat for JsonMap {
    fn about(&self) -> About {
        About {
            name: "json-map",
            title: "a JSON map: picture, label, point",
            conventions: "pixels from the corner",
            users: "scripts",
            loses: None,
            file: None,
            files: "map of points (.json)",
            endings: &["json"],
            export_options: &[],
            import_options: format_options::LABELS_IN,
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| read_map((file, bytes), reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::click_formats::clicked_frame::{LabelReading, read_alone, read_labels};
    use crate::exchange::options::ImportOptions;
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    #[test]
    fn points_come_with_a_probability_a_sigma_or_a_covariance() {
        let text = r#"{"a.jpg": {"centre_mark": [1, 2, 0.5], "halfway_far": [3, 4],
            "halfway_line": [[5, 6, 0.25],
                {"x": 7, "y": 8, "p": 0.5, "covariance_px2": [[4, 1], [1, 14]]}],
            "corner_far_left": {"x": 9, "y": 10, "sigma_px": 2}}}"#;
        let files = Files::one("a.json", text.as_bytes().to_vec());
        let options = ImportOptions {
            pixels: Some(crate::exchange::options::Pixels::Centre),
            ..ImportOptions::default()
        };
        let frames = read_alone(&JsonMap, &files, &options, Some(SIZE)).unwrap();
        let found: Vec<(f64, Option<f64>, Option<f64>)> = frames[0]
            .marks
            .iter()
            .map(|mark| (mark.image.x, mark.probability, mark.sigma_px))
            .collect();
        assert_eq!(
            found,
            [
                (1.5, Some(0.5), None),
                (3.5, None, None),
                (5.5, Some(0.25), None),
                (7.5, Some(0.5), Some(3.0)),
                (9.5, None, Some(2.0))
            ]
        );
    }

    #[test]
    fn a_damaged_picture_costs_itself_alone() {
        let text = r#"{"a.jpg": {"centre_mark": [1, 2]},
            "b.jpg": {"centre_mark": {"x": 1, "y": 2, "covariance_px2": [[1, 2], [2, 1]]}},
            "c.jpg": {"centre_mark": [1]}}"#;
        let files = Files::one("a.json", text.as_bytes().to_vec());
        let reading = LabelReading {
            options: &ImportOptions::default(),
            sizes: &|_| Some(SIZE),
        };
        let (frames, unread) = read_labels(&JsonMap, &files, &reading).unwrap();
        assert_eq!(frames.len(), 1);
        let said = unread.describe(1).unwrap();
        assert!(said.contains("positive definite"), "{said}");
        assert!(said.contains("c.jpg"), "{said}");
    }
}
