//! The field templates against the rule books.

use std::collections::BTreeMap;
use touchline::field::{Curve, FieldModel, builtin};
use touchline::geometry::Vec3;

fn model(name: &str) -> FieldModel {
    builtin(name).unwrap().default_model().unwrap()
}

/// Landmarks of a model against published coordinates, m.
fn assert_landmarks(model: &FieldModel, published: &[(&str, [f64; 3])]) {
    for (name, place) in published {
        let landmark = model.landmark(name).unwrap_or_else(|| panic!("{} has no {name}", model.template));
        let off = (landmark.nominal_m - Vec3::from(*place)).norm();
        assert!(off < 1e-9, "{} {name}: {:?} instead of {place:?}", model.template, landmark.nominal_m);
    }
}

#[test]
fn soccer_has_the_documents_names() {
    let soccer = model("soccer");
    let mut landmarks = vec!["centre_mark", "halfway_near", "halfway_far", "centre_circle_halfway_near"];
    landmarks.extend(["centre_circle_halfway_far", "centre_circle_left", "centre_circle_right"]);
    let mut owned = Vec::new();
    let mut lines: Vec<String> =
        ["touchline_near", "touchline_far", "halfway_line", "centre_circle"].map(String::from).to_vec();
    for side in ["left", "right"] {
        owned.extend([format!("penalty_mark_{side}"), format!("penalty_arc_apex_{side}")]);
        lines.extend(["goal_line", "penalty_arc", "crossbar"].map(|name| format!("{name}_{side}")));
        lines.extend(["penalty_area", "goal_area"].map(|name| format!("{name}_{side}_front")));
        for depth in ["near", "far"] {
            for area in ["penalty_area", "goal_area"] {
                owned.extend(["goal_line", "front"].map(|end| format!("{area}_{depth}_{side}_{end}")));
                lines.push(format!("{area}_{side}_{depth}"));
            }
            owned.extend(["corner", "penalty_arc"].map(|name| format!("{name}_{depth}_{side}")));
            owned.extend(["base", "top"].map(|end| format!("post_{depth}_{side}_{end}")));
            owned.push(format!("corner_flag_{depth}_{side}_top"));
            lines.extend(["post", "corner_arc"].map(|name| format!("{name}_{depth}_{side}")));
        }
    }
    landmarks.extend(owned.iter().map(String::as_str));
    let mut ours: Vec<_> = soccer.landmarks.iter().map(|landmark| landmark.id.as_str()).collect();
    landmarks.sort_unstable();
    ours.sort_unstable();
    assert_eq!(ours, landmarks);
    let mut our_lines: Vec<_> = soccer.lines.iter().map(|line| line.id.as_str()).collect();
    lines.sort_unstable();
    our_lines.sort_unstable();
    assert_eq!(our_lines, lines);
}

#[test]
fn soccer_is_where_law_1_puts_it() {
    let soccer = model("soccer");
    assert_eq!((soccer.length_m, soccer.width_m), (105.0, 68.0));
    let half_chord = 7.312_489_316_231_510_5;
    assert_landmarks(
        &soccer,
        &[
            ("corner_near_left", [-52.5, -34.0, 0.0]),
            ("penalty_mark_right", [41.5, 0.0, 0.0]),
            ("penalty_area_far_right_front", [36.0, 20.16, 0.0]),
            ("goal_area_near_left_goal_line", [-52.5, -9.16, 0.0]),
            ("penalty_arc_near_left", [-36.0, -half_chord, 0.0]),
            ("penalty_arc_apex_right", [32.35, 0.0, 0.0]),
            ("post_far_right_top", [52.5, 3.66, 2.44]),
            ("corner_flag_far_left_top", [-52.5, 34.0, 1.5]),
            ("centre_circle_halfway_far", [0.0, 9.15, 0.0]),
        ],
    );
    let Curve::Arc { centre, radius_m, .. } = soccer.line("penalty_arc_left").unwrap().curve else { panic!("an arc") };
    assert!((centre - Vec3::new(-41.5, 0.0, 0.0)).norm() < 1e-9 && (radius_m - 9.15).abs() < 1e-9);
    assert!(soccer.line("centre_circle").unwrap().curve.is_closed());
}

#[test]
fn only_length_and_width_of_a_soccer_field_differ() {
    let params = BTreeMap::from([("length_m".to_owned(), 107.90), ("width_m".to_owned(), 64.01)]);
    let soccer = builtin("soccer").unwrap().model(&params, 0.2).unwrap();
    assert_landmarks(
        &soccer,
        &[("corner_far_right", [53.95, 32.005, 0.0]), ("penalty_area_near_right_front", [37.45, -20.16, 0.0])],
    );
    let corner = soccer.landmark_in_world(soccer.landmark("corner_far_right").unwrap());
    assert!((corner.z + 0.2).abs() < 1e-12, "the crown lowers the touchlines");
}

#[test]
fn paint_lies_within_the_areas_that_it_bounds() {
    let soccer = model("soccer");
    let middle = |line: &str| soccer.line(line).unwrap().paint_centre.point_at(0.5);
    assert!((middle("touchline_far") - Vec3::new(0.0, 33.94, 0.0)).norm() < 1e-9);
    assert!((middle("penalty_area_right_front") - Vec3::new(36.06, 0.0, 0.0)).norm() < 1e-9);
    assert!((middle("halfway_line")).norm() < 1e-9);
    let Curve::Arc { radius_m, .. } = soccer.line("centre_circle").unwrap().paint_centre else { panic!("a circle") };
    assert!((radius_m - 9.09).abs() < 1e-9);
    assert!(
        (middle("post_far_left") - Vec3::new(-52.5, 3.72, 1.22)).norm() < 1e-9,
        "posts stand around the goal mouth"
    );
}

#[test]
fn parameters_outside_the_rules_are_named() {
    let soccer = builtin("soccer").unwrap();
    let message = |name: &str, value: f64, crown_m: f64| {
        soccer.model(&BTreeMap::from([(name.to_owned(), value)]), crown_m).unwrap_err().to_string()
    };
    assert_eq!(
        message("length_m", 80.0, 0.0),
        "soccer field: length_m = 80 is outside 90 to 120 (IFAB Law 1.3: 90 to 120 m; 105 m recommended by UEFA and FIFA)"
    );
    assert!(message("width_m", f64::NAN, 0.0).starts_with("soccer field: width_m = NaN is outside 45 to 90"));
    assert_eq!(
        message("lenght_m", 105.0, 0.0),
        "the field template \"soccer\" takes no parameter \"lenght_m\"; it takes length_m, width_m"
    );
    assert_eq!(message("length_m", 105.0, 7.0), "crown_m = 7 is outside -2 to 2");
    assert_eq!(
        builtin("curling").unwrap_err().to_string(),
        "no field template is named \"curling\"; built in are soccer; a template of your own is given as a path ending in .json"
    );
}
