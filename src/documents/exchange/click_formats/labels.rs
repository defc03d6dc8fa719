//! The meaning of labels of other tools on our field.

use super::clicked_frame::LabelledFrame;
use crate::document::Target;
use crate::exchange::error::{ExchangeError, ExchangeResult, Problem};
use crate::exchange::options::{KeypointNames, LabelMap};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::field::{Curve, FieldModel};
use touchline_core::geometry::Vec3;

/// The 32 points of Roboflow's `SoccerPitchConfiguration` by index. Points 10, 11, 18 and 19 are
/// labelled where the arc meets the area's line, although the configuration's own coordinates
/// differ: we use only the names, never the coordinates.
pub const ROBOFLOW_32: [&str; 32] = [
    "corner_far_left",
    "penalty_area_far_left_goal_line",
    "goal_area_far_left_goal_line",
    "goal_area_near_left_goal_line",
    "penalty_area_near_left_goal_line",
    "corner_near_left",
    "goal_area_far_left_front",
    "goal_area_near_left_front",
    "penalty_mark_left",
    "penalty_area_far_left_front",
    "penalty_arc_far_left",
    "penalty_arc_near_left",
    "penalty_area_near_left_front",
    "halfway_far",
    "centre_circle_halfway_far",
    "centre_circle_halfway_near",
    "halfway_near",
    "penalty_area_far_right_front",
    "penalty_arc_far_right",
    "penalty_arc_near_right",
    "penalty_area_near_right_front",
    "penalty_mark_right",
    "goal_area_far_right_front",
    "goal_area_near_right_front",
    "corner_far_right",
    "penalty_area_far_right_goal_line",
    "goal_area_far_right_goal_line",
    "goal_area_near_right_goal_line",
    "penalty_area_near_right_goal_line",
    "corner_near_right",
    "centre_circle_left",
    "centre_circle_right",
];

/// SoccerNet's classes of lines and ours. The left and right post of a goal are seen from the
/// pitch.
pub const SOCCERNET_LINES: [(&str, &str); 26] = [
    ("Side line top", "touchline_far"),
    ("Side line bottom", "touchline_near"),
    ("Side line left", "goal_line_left"),
    ("Side line right", "goal_line_right"),
    ("Middle line", "halfway_line"),
    ("Big rect. left top", "penalty_area_left_far"),
    ("Big rect. left bottom", "penalty_area_left_near"),
    ("Big rect. left main", "penalty_area_left_front"),
    ("Big rect. right top", "penalty_area_right_far"),
    ("Big rect. right bottom", "penalty_area_right_near"),
    ("Big rect. right main", "penalty_area_right_front"),
    ("Small rect. left top", "goal_area_left_far"),
    ("Small rect. left bottom", "goal_area_left_near"),
    ("Small rect. left main", "goal_area_left_front"),
    ("Small rect. right top", "goal_area_right_far"),
    ("Small rect. right bottom", "goal_area_right_near"),
    ("Small rect. right main", "goal_area_right_front"),
    ("Circle central", "centre_circle"),
    ("Circle left", "penalty_arc_left"),
    ("Circle right", "penalty_arc_right"),
    ("Goal left crossbar", "crossbar_left"),
    ("Goal right crossbar", "crossbar_right"),
    // The trailing space is part of their class name.
    ("Goal left post left ", "post_near_left"),
    ("Goal left post right", "post_far_left"),
    ("Goal right post left", "post_far_right"),
    ("Goal right post right", "post_near_right"),
];

/// Classes that name nothing in particular.
const SOCCERNET_UNKNOWN: [&str; 2] = ["Goal unknown", "Line unknown"];

/// The keypoints of training data in their order.
pub fn keypoints(names: KeypointNames, field: &FieldModel) -> Vec<String> {
    match names {
        KeypointNames::Touchline => field
            .landmarks
            .iter()
            .map(|landmark| landmark.id.to_string())
            .collect(),
        KeypointNames::Roboflow32 => ROBOFLOW_32.map(ToOwned::to_owned).to_vec(),
    }
}

/// The index of the point with a given caption (1 to 32) among the 32 points. Captions number the
/// points as Roboflow's pictures show them: the two sides of the centre circle, which the index has
/// last, are 14 and 19 there.
const fn index_of_caption(caption: usize) -> Option<usize> {
    match caption {
        1..=13 => Some(caption - 1),
        14 => Some(30),
        15..=18 => Some(caption - 2),
        19 => Some(31),
        20..=32 => Some(caption - 3),
        _ => None,
    }
}

/// The meaning of a label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// A landmark or line.
    Target(Target),
    /// To be ignored, by its map.
    Nothing,
    /// Unknown.
    Unknown,
}

impl Meaning {
    /// The meaning of our own name. Unknown without a name, or if the field does not have it.
    fn from_name(name: Option<&str>, field: &FieldModel) -> Self {
        name.and_then(|name| ours(name, field))
            .map_or(Self::Unknown, Self::Target)
    }
}

/// The landmark or line of our own name.
fn ours(name: &str, field: &FieldModel) -> Option<Target> {
    if field.landmark_element(name).is_some() {
        return Some(Target::Landmark(name.into()));
    }
    field.line_element(name).map(|_| Target::Line(name.into()))
}

/// The place that a label states, such as `(16.5, 54.16)`: m from the field's far left corner to the
/// right and towards the main camera.
pub fn place_of_label(label: &str) -> Option<[f64; 2]> {
    let inner = label.trim().strip_prefix('(')?.strip_suffix(')')?;
    let (x, y) = inner.split_once(',')?;
    let place = [x.trim().parse().ok()?, y.trim().parse().ok()?];
    place.iter().all(|m: &f64| m.is_finite()).then_some(place)
}

/// The landmark at the place that a label states, or else the straight line that it lies on.
fn at_place(label: &str, field: &FieldModel) -> Option<Target> {
    /// Places are written with two decimals, m.
    const EXACT_M: f64 = 0.02;
    let [x, y] = place_of_label(label)?;
    let place = Vec3::new(x - field.length_m / 2.0, field.width_m / 2.0 - y, 0.0);
    let is_near = |point: Vec3| (point - place).norm() <= EXACT_M;
    let mut landmarks = field.landmarks.iter();
    if let Some(landmark) = landmarks.find(|landmark| is_near(landmark.nominal_m)) {
        return Some(Target::Landmark(landmark.id.clone()));
    }
    let mut lines = field.lines.iter();
    let line = lines.find(|line| match line.curve {
        Curve::Segment { from, to } => {
            let along = to - from;
            let share = (place - from).dot(&along) / along.norm_squared();
            line.painted && is_near(from + along * share.clamp(0.0, 1.0))
        }
        Curve::Arc { .. } => false,
    });
    line.map(|line| Target::Line(line.id.clone()))
}

impl LabelMap {
    /// Refuses labels that are numbered as another map has them. Indices go from 0 to 31, captions
    /// from 01 to 32, in two orders: taken for each other, nearly every point gets another's name.
    ///
    /// # Errors
    /// The labels are of the other order.
    pub(in crate::exchange) fn refuse_other_numbering(
        &self,
        frames: &[LabelledFrame],
    ) -> ExchangeResult<()> {
        let other = match self {
            Self::Roboflow32 => "roboflow-32-captions",
            Self::Roboflow32Captions => "roboflow-32",
            Self::Touchline | Self::SoccerNet | Self::Own(_) => return Ok(()),
        };
        let marks = frames.iter().flat_map(|frame| &frame.marks);
        let labels: BTreeSet<&str> = marks.map(|mark| mark.label.as_str()).collect();
        // Captions have two digits; of numbers without zeros in front only the ends tell.
        let is_index = |label: &str| matches!(label, "0" | "00");
        let is_caption = |label: &str| {
            let is_padded = label.len() == 2 && label.starts_with('0') && label != "00";
            is_padded || (label == "32" && !labels.contains("0"))
        };
        let of_other = labels.iter().copied().find(|label| match self {
            Self::Roboflow32 => is_caption(label),
            _ => is_index(label),
        });
        match of_other {
            None => Ok(()),
            Some(label) => Err(ExchangeError::OtherNumbering {
                label: label.to_owned(),
                other,
            }),
        }
    }

    /// What a label means on a field.
    ///
    /// # Errors
    /// A user's map names something that the field does not have.
    pub(in crate::exchange) fn meaning(
        &self,
        label: &str,
        field: &FieldModel,
    ) -> ExchangeResult<Meaning> {
        Ok(match self {
            Self::Touchline => match ours(label, field).or_else(|| at_place(label, field)) {
                Some(target) => Meaning::Target(target),
                None => Meaning::Unknown,
            },
            // Roboflow's index, or the name that an export gives the point.
            Self::Roboflow32 => {
                let name = if let Ok(index) = label.parse::<usize>() {
                    ROBOFLOW_32.get(index).copied()
                } else {
                    ROBOFLOW_32.into_iter().find(|name| *name == label)
                };
                Meaning::from_name(name, field)
            }
            // `index_of_caption` gives 0 to 31.
            Self::Roboflow32Captions => {
                let index = label.parse().ok().and_then(index_of_caption);
                Meaning::from_name(index.map(|index| ROBOFLOW_32[index]), field)
            }
            Self::SoccerNet if SOCCERNET_UNKNOWN.contains(&label.trim_end()) => Meaning::Nothing,
            Self::SoccerNet => {
                // One class ends in a space in one challenge and not in the other.
                let class = SOCCERNET_LINES
                    .iter()
                    .find(|(class, _)| class.trim_end() == label.trim_end());
                Meaning::from_name(class.map(|(_, line)| *line), field)
            }
            Self::Own(map) => match map.get(label) {
                None => Meaning::Unknown,
                Some(None) => Meaning::Nothing,
                Some(Some(name)) => {
                    // A wrong name in a map is a mistake of its author. As an unknown label it
                    // would be reported as one of the files.
                    let Some(target) = ours(name, field) else {
                        let unknown = Problem::Unknown {
                            what: "the landmark or line",
                            name: name.clone(),
                        };
                        return Err(unknown.within("the map of labels"));
                    };
                    Meaning::Target(target)
                }
            },
        })
    }
}

/// Labels with how often each occurs, for a message.
pub fn describe_counts(labels: &BTreeMap<String, usize>) -> String {
    labels
        .iter()
        .map(|(label, count)| format!("{label:?} ({count}×)"))
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::Mark;
    use super::*;
    use touchline_core::field::{Symmetry, builtin};
    use touchline_core::geometry::{ImagePoint, ImageSize};

    #[test]
    fn the_names_of_both_tools_are_on_the_field() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        for name in ROBOFLOW_32 {
            assert!(field.landmark_element(name).is_some(), "{name}");
        }
        for (class, line) in SOCCERNET_LINES {
            assert!(field.line_element(line).is_some(), "{class}: {line}");
        }
    }

    #[test]
    fn captions_and_indices_are_two_orders() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let meaning = |map: LabelMap, label: &str| map.meaning(label, &field).unwrap();
        let target = |name: &str| Meaning::Target(Target::Landmark(name.into()));
        assert_eq!(meaning(LabelMap::Roboflow32, "13"), target("halfway_far"));
        assert_eq!(
            meaning(LabelMap::Roboflow32, "halfway_far"),
            target("halfway_far"),
            "as an export calls it"
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32, "centre_mark"),
            Meaning::Unknown,
            "none of the 32"
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32Captions, "13"),
            target("penalty_area_near_left_front")
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32Captions, "14"),
            target("centre_circle_left")
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32Captions, "19"),
            target("centre_circle_right")
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32Captions, "32"),
            target("corner_near_right")
        );
        assert_eq!(
            meaning(LabelMap::Roboflow32Captions, "33"),
            Meaning::Unknown
        );
        let mut seen: Vec<usize> = (1..=32).filter_map(index_of_caption).collect();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..32), "each point has one caption");
    }

    #[test]
    fn a_place_is_a_landmark_or_a_line() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let meaning = |label: &str| LabelMap::Touchline.meaning(label, &field).unwrap();
        for (label, landmark) in [
            ("(0.0, 68.0)", "corner_near_left"),
            ("(88.5, 13.84)", "penalty_area_far_right_front"),
            ("(52.5, 24.85)", "centre_circle_halfway_far"),
        ] {
            let target = Target::Landmark(landmark.into());
            assert_eq!(meaning(label), Meaning::Target(target), "{label}");
        }
        let touchline = Target::Line("touchline_near".into());
        assert_eq!(meaning("(44.0, 68.0)"), Meaning::Target(touchline));
        for label in ["(44.0, 60.0)", "(inf, 68.0)", "(44.0)", "44.0, 68.0"] {
            assert_eq!(meaning(label), Meaning::Unknown, "{label}");
        }
    }

    #[test]
    fn the_space_behind_a_post_may_be_there_or_not() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let line = Meaning::Target(Target::Line("post_near_left".into()));
        for label in ["Goal left post left ", "Goal left post left"] {
            assert_eq!(LabelMap::SoccerNet.meaning(label, &field).unwrap(), line);
        }
        assert_eq!(
            LabelMap::SoccerNet.meaning("Line unknown", &field).unwrap(),
            Meaning::Nothing
        );
    }

    #[test]
    fn seen_from_the_pitch_left_and_right_posts_are_mirrored_by_half_a_turn() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let line = |class: &str| {
            SOCCERNET_LINES
                .iter()
                .find(|(name, _)| name.trim_end() == class)
                .unwrap()
                .1
        };
        let twin = field
            .line_element(line("Goal left post left"))
            .unwrap()
            .twin(Symmetry::Turn180, &field);
        assert_eq!(twin, field.line_element(line("Goal right post left")));
    }

    #[test]
    fn numbers_of_the_other_order_are_refused() {
        let refuses = |map: &LabelMap, labels: &[&str]| {
            let marks = labels
                .iter()
                .map(|label| Mark::new((*label).to_owned(), ImagePoint::new(1.0, 1.0)));
            let frame = LabelledFrame {
                masks: Vec::new(),
                name: "a".to_owned(),
                image: None,
                size: ImageSize::new(2, 2),
                marks: marks.collect(),
            };
            map.refuse_other_numbering(&[frame]).is_err()
        };
        let (indices, captions) = (LabelMap::Roboflow32, LabelMap::Roboflow32Captions);
        for of_captions in [&["01", "14"][..], &["1", "32"], &["09"]] {
            assert!(refuses(&indices, of_captions), "{of_captions:?}");
            assert!(!refuses(&captions, of_captions), "{of_captions:?}");
        }
        assert!(refuses(&captions, &["0", "14"]) && !refuses(&indices, &["0", "14"]));
        assert!(!refuses(&indices, &["1", "14"]) && !refuses(&captions, &["1", "14"]));
    }
}
