//! Points and lines of `PnLCalib` and No Bells Just Whistles: a JSON file a picture.
//!
//! ```json
//! {"kp": {"35": {"x": 0.2375, "y": 0.6138, "p": 0.51}},
//!  "lines": {"13": {"x_1": 0.23, "y_1": 0.31, "p_1": 0.75,
//!                   "x_2": 0.24, "y_2": 0.99, "p_2": 0.47}}}
//! ```
//!
//! Coordinates are shares of the picture. Points are numbered from 1 as the list below has them
//! (mguti97/PnLCalib, `utils_keypoints.py`), lines as SoccerNet's classes in the order of the
//! alphabet. Points 58 to 73 lie where lines would meet beyond their ends; such points, and those
//! on a circle that are no landmark, lie on a line, which is what is used of them. A point of
//! probability 1 was not found by the network: the program computed it from its lines, which are
//! read themselves.

use crate::exchange::click_formats::clicked_frame::{
    ClickFormat, LabelReader, LabelledFrame, Mark, size_or_option,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, base_name, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::LabelMap;
use crate::exchange::syntax::node::{Node, parse};
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The layout.
pub(super) struct PnlCalibPoints;

/// Points 1 to 73: a landmark, or the line that the point lies on.
const POINTS: [&str; 73] = [
    "corner_far_left",
    "halfway_far",
    "corner_far_right",
    "penalty_area_far_left_goal_line",
    "penalty_area_far_left_front",
    "penalty_area_far_right_front",
    "penalty_area_far_right_goal_line",
    "goal_area_far_left_goal_line",
    "goal_area_far_left_front",
    "goal_area_far_right_front",
    "goal_area_far_right_goal_line",
    "post_far_left_top",
    "post_far_left_base",
    "post_far_right_base",
    "post_far_right_top",
    "post_near_left_top",
    "post_near_left_base",
    "post_near_right_base",
    "post_near_right_top",
    "goal_area_near_left_goal_line",
    "goal_area_near_left_front",
    "goal_area_near_right_front",
    "goal_area_near_right_goal_line",
    "penalty_area_near_left_goal_line",
    "penalty_area_near_left_front",
    "penalty_area_near_right_front",
    "penalty_area_near_right_goal_line",
    "corner_near_left",
    "halfway_near",
    "corner_near_right",
    "penalty_arc_far_left",
    "centre_circle_halfway_far",
    "penalty_arc_far_right",
    "penalty_arc_near_left",
    "centre_circle_halfway_near",
    "penalty_arc_near_right",
    // Where a straight line from a corner of an area, or from the halfway line's end, touches.
    "penalty_arc_left",
    "centre_circle",
    "centre_circle",
    "penalty_arc_right",
    "penalty_arc_left",
    "centre_circle",
    "centre_circle",
    "penalty_arc_right",
    "penalty_mark_left",
    "penalty_area_left_front",
    "penalty_arc_apex_left",
    "centre_circle",
    "centre_circle",
    "centre_circle_left",
    "centre_mark",
    "centre_circle_right",
    "centre_circle",
    "centre_circle",
    "penalty_arc_apex_right",
    "penalty_area_right_front",
    "penalty_mark_right",
    // Beyond the ends of lines.
    "touchline_far",
    "touchline_far",
    "touchline_far",
    "touchline_far",
    "penalty_area_left_far",
    "penalty_area_right_far",
    "penalty_area_left_front",
    "penalty_area_right_front",
    "penalty_area_left_front",
    "penalty_area_right_front",
    "penalty_area_left_near",
    "penalty_area_right_near",
    "touchline_near",
    "touchline_near",
    "touchline_near",
    "touchline_near",
];

/// Lines 1 to 23.
const LINES: [&str; 23] = [
    "penalty_area_left_near",
    "penalty_area_left_front",
    "penalty_area_left_far",
    "penalty_area_right_near",
    "penalty_area_right_front",
    "penalty_area_right_far",
    "crossbar_left",
    "post_near_left",
    "post_far_left",
    "crossbar_right",
    "post_far_right",
    "post_near_right",
    "halfway_line",
    "touchline_near",
    "goal_line_left",
    "goal_line_right",
    "touchline_far",
    "goal_area_left_near",
    "goal_area_left_front",
    "goal_area_left_far",
    "goal_area_right_near",
    "goal_area_right_front",
    "goal_area_right_far",
];

/// What the labels of points and lines begin with.
const KINDS: [(&str, &[&str]); 2] = [("point", &POINTS), ("line", &LINES)];

/// The label of a point or line.
fn label(kind: &str, number: &str) -> String {
    format!("{kind} {number}")
}

/// A point of a picture that is stated in shares of it.
fn mark(label: String, [x, y, probability]: [f64; 3], size: ImageSize) -> Result<Mark, Problem> {
    let image = ImagePoint::new(x * f64::from(size.width), y * f64::from(size.height));
    Mark::new(label, image).with_probability(probability)
}

/// The marks of a file.
fn marks(root: &Node<'_>, size: ImageSize) -> Result<Vec<Mark>, Problem> {
    let mut marks = Vec::new();
    let lines = root.find("lines");
    for (number, point) in root.key("kp")?.entries()? {
        let numbers = point.numbers_at(["x", "y", "p"])?;
        // Computed from lines that are read themselves: the same evidence twice.
        let is_computed = numbers[2] == 1.0 && lines.is_some();
        if !is_computed {
            marks.push(mark(label("point", number), numbers, size)?);
        }
    }
    let entries = lines.as_ref().map(Node::entries).transpose()?;
    for (number, line) in entries.into_iter().flatten() {
        for keys in [["x_1", "y_1", "p_1"], ["x_2", "y_2", "p_2"]] {
            let numbers = line.numbers_at(keys)?;
            marks.push(mark(label("line", number), numbers, size)?);
        }
    }
    Ok(marks)
}

fn read_picture(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<LabelledFrame, Problem> {
    let value = parse(bytes)?;
    let root = Node::root(&value);
    root.key("kp")?;
    let name = without_ending(base_name(file)).to_owned();
    let size = size_or_option(&name, (reading.sizes)(&name), reading.options)?;
    Ok(LabelledFrame::new(&name, None, size, marks(&root, size)?))
}

impl ClickFormat for PnlCalibPoints {
    fn about(&self) -> About {
        About {
            name: "pnlcalib",
            title: "points and lines of PnLCalib, one file a picture",
            conventions: "shares of the picture",
            users: "PnLCalib, No Bells Just Whistles",
            loses: None,
            file: None,
            files: "points of PnLCalib (.json)",
            endings: &["json"],
            export_options: &[],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::EachOwnCamera,
            ],
        }
    }

    fn has_own_classes(&self) -> bool {
        true
    }

    fn own_labels(&self) -> LabelMap {
        let all = KINDS.iter().flat_map(|(kind, names)| {
            let numbered = names.iter().enumerate();
            numbered.map(|(index, name)| {
                let number = (index + 1).to_string();
                (label(kind, &number), Some((*name).to_owned()))
            })
        });
        LabelMap::Own(all.collect())
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            let read = read_picture((file, bytes), reading);
            Ok(reading.keep(file, None, read))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::click_formats::clicked_frame::read_alone;
    use crate::exchange::click_formats::labels::{Meaning, SOCCERNET_LINES};
    use crate::exchange::options::ImportOptions;
    use touchline_core::testing::soccer;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    #[test]
    fn every_number_is_of_the_field_and_lines_are_soccernets_in_the_order_of_the_alphabet() {
        let (field, labels) = (soccer(), PnlCalibPoints.own_labels());
        for (kind, names) in KINDS {
            for number in 1..=names.len() {
                let meaning = labels.meaning(&label(kind, &number.to_string()), &field);
                assert!(matches!(meaning, Ok(Meaning::Target(_))), "{kind} {number}");
            }
        }
        let mut classes: Vec<(&str, &str)> = SOCCERNET_LINES
            .into_iter()
            .filter(|(class, _)| !class.starts_with("Circle"))
            .collect();
        classes.sort_unstable();
        let ours: Vec<&str> = classes.iter().map(|(_, ours)| *ours).collect();
        assert_eq!(ours, LINES);
    }

    #[test]
    fn points_and_both_ends_of_lines_are_read_with_their_probability_and_computed_points_are_not() {
        let text = r#"{"kp": {"51": {"x": 0.5, "y": 0.25, "p": 0.5},
                "1": {"x": 0, "y": 0, "p": 1.0}},
            "lines": {"13": {"x_1": 0.25, "y_1": 0.5, "p_1": 0.75,
                "x_2": 0.5, "y_2": 1, "p_2": 0.4}}}"#;
        let files = Files::one("7.json", text.as_bytes().to_vec());
        let options = ImportOptions {
            size: Some(SIZE),
            ..ImportOptions::default()
        };
        let frames = read_alone(&PnlCalibPoints, &files, &options, None).unwrap();
        let found: Vec<(&str, f64, f64, Option<f64>)> = frames[0]
            .marks
            .iter()
            .map(|mark| {
                (
                    mark.label.as_str(),
                    mark.image.x,
                    mark.image.y,
                    mark.probability,
                )
            })
            .collect();
        assert_eq!(
            found,
            [
                ("point 51", 640.0, 180.0, Some(0.5)),
                ("line 13", 320.0, 360.0, Some(0.75)),
                ("line 13", 640.0, 720.0, Some(0.4))
            ]
        );
    }

    #[test]
    fn damaged_files_say_what_is_wrong() {
        for (text, wanted) in [
            (
                r#"{"kp": {"1": {"x": 0, "y": 0, "p": 2}}}"#,
                "a.json: the probability of \"point 1\" is 2, which must be between 0 and 1; files \
                 of labels are imported without --points",
            ),
            (
                r#"{"kp": {"1": {"x": 0, "p": 0.2}}}"#,
                "a.json: kp[\"1\"].y is missing",
            ),
            ("{}", "a.json: kp is missing"),
        ] {
            let files = Files::one("a.json", text.as_bytes().to_vec());
            let error = read_alone(
                &PnlCalibPoints,
                &files,
                &ImportOptions::default(),
                Some(SIZE),
            );
            assert_eq!(error.unwrap_err().to_string(), wanted);
        }
    }
}
