//! The field templates against the rule books.

use std::collections::BTreeMap;
use touchline_core::field::{Curve, FieldModel, Symmetry, builtin, builtin_names};
use touchline_core::geometry::Vec3;

fn model(name: &str) -> FieldModel {
    builtin(name).unwrap().default_model().unwrap()
}

/// Landmarks of a model against published coordinates, m.
fn assert_landmarks(model: &FieldModel, published: &[(&str, [f64; 3])]) {
    for (name, place) in published {
        let landmark = model
            .landmark(name)
            .unwrap_or_else(|| panic!("{} has no {name}", model.template));
        let off = (landmark.nominal_m - Vec3::from(*place)).norm();
        assert!(
            off < 1e-9,
            "{} {name}: {:?} instead of {place:?}",
            model.template,
            landmark.nominal_m
        );
    }
}

#[test]
fn soccer_has_the_documents_names() {
    let soccer = model("soccer");
    let mut landmarks = vec![
        "centre_mark",
        "halfway_near",
        "halfway_far",
        "centre_circle_halfway_near",
    ];
    landmarks.extend([
        "centre_circle_halfway_far",
        "centre_circle_left",
        "centre_circle_right",
    ]);
    let mut owned = Vec::new();
    let mut lines: Vec<String> = [
        "touchline_near",
        "touchline_far",
        "halfway_line",
        "centre_circle",
    ]
    .map(String::from)
    .to_vec();
    for side in ["left", "right"] {
        owned.extend([
            format!("penalty_mark_{side}"),
            format!("penalty_arc_apex_{side}"),
        ]);
        lines.extend(["goal_line", "penalty_arc", "crossbar"].map(|name| format!("{name}_{side}")));
        lines.extend(["penalty_area", "goal_area"].map(|name| format!("{name}_{side}_front")));
        for depth in ["near", "far"] {
            for area in ["penalty_area", "goal_area"] {
                owned.extend(
                    ["goal_line", "front"].map(|end| format!("{area}_{depth}_{side}_{end}")),
                );
                lines.push(format!("{area}_{side}_{depth}"));
            }
            owned.extend(["corner", "penalty_arc"].map(|name| format!("{name}_{depth}_{side}")));
            owned.extend(["base", "top"].map(|end| format!("post_{depth}_{side}_{end}")));
            owned.push(format!("corner_flag_{depth}_{side}_top"));
            lines.extend(["post", "corner_arc"].map(|name| format!("{name}_{depth}_{side}")));
        }
    }
    landmarks.extend(owned.iter().map(String::as_str));
    let mut ours: Vec<_> = soccer
        .landmarks
        .iter()
        .map(|landmark| landmark.id.as_str())
        .collect();
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
    let Curve::Arc {
        centre, radius_m, ..
    } = soccer.line("penalty_arc_left").unwrap().curve
    else {
        panic!("an arc")
    };
    assert!((centre - Vec3::new(-41.5, 0.0, 0.0)).norm() < 1e-9 && (radius_m - 9.15).abs() < 1e-9);
    assert!(soccer.line("centre_circle").unwrap().curve.is_closed());
}

#[test]
fn only_length_and_width_of_a_soccer_field_differ() {
    let params = BTreeMap::from([
        ("length_m".to_owned(), 107.90),
        ("width_m".to_owned(), 64.01),
    ]);
    let soccer = builtin("soccer").unwrap().model(&params, 0.2).unwrap();
    assert_landmarks(
        &soccer,
        &[
            ("corner_far_right", [53.95, 32.005, 0.0]),
            ("penalty_area_near_right_front", [37.45, -20.16, 0.0]),
        ],
    );
    let corner = soccer.landmark_in_world(soccer.landmark("corner_far_right").unwrap());
    assert!(
        (corner.z + 0.2).abs() < 1e-12,
        "the crown lowers the touchlines"
    );
}

#[test]
fn paint_lies_within_the_areas_that_it_bounds() {
    let soccer = model("soccer");
    let middle = |line: &str| soccer.line(line).unwrap().paint_centre.point_at(0.5);
    assert!((middle("touchline_far") - Vec3::new(0.0, 33.94, 0.0)).norm() < 1e-9);
    assert!((middle("penalty_area_right_front") - Vec3::new(36.06, 0.0, 0.0)).norm() < 1e-9);
    assert!((middle("halfway_line")).norm() < 1e-9);
    let Curve::Arc { radius_m, .. } = soccer.line("centre_circle").unwrap().paint_centre else {
        panic!("a circle")
    };
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
        soccer
            .model(&BTreeMap::from([(name.to_owned(), value)]), crown_m)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        message("length_m", 80.0, 0.0),
        "soccer field: length_m = 80 is outside 90 to 120 (IFAB Law 1.3: 90 to 120 m; 105 m recommended by UEFA and FIFA)"
    );
    assert!(
        message("width_m", f64::NAN, 0.0)
            .starts_with("soccer field: width_m = NaN is outside 45 to 90")
    );
    assert_eq!(
        message("lenght_m", 105.0, 0.0),
        "the field template \"soccer\" takes no parameter \"lenght_m\"; it takes length_m, width_m"
    );
    assert_eq!(
        message("length_m", 105.0, 7.0),
        "crown_m = 7 is outside -2 to 2"
    );
    assert_eq!(
        builtin("curling").unwrap_err().to_string(),
        format!(
            "no field template is named \"curling\"; built in are {}; a template of your own is given as a path \
             ending in .json",
            builtin_names().join(", ")
        )
    );
}

const FT: f64 = 0.3048;
const YD: f64 = 0.9144;

#[test]
fn every_template_is_whole_and_as_symmetric_as_its_rules() {
    for name in builtin_names() {
        let template = builtin(name).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(template.name, name);
        assert!(
            template.params.iter().any(|param| param.name == "length_m"),
            "{name}"
        );
        assert!(
            template.params.iter().any(|param| param.name == "width_m"),
            "{name}"
        );
        assert!(template.params.iter().all(|param| !param.source.is_empty()));
        assert!(
            template
                .dimensions
                .iter()
                .all(|dimension| !dimension.source.is_empty())
        );
        let field = template.default_model().unwrap();
        // A squash court has a front and a back.
        let is_whole = template.symmetry.len() == Symmetry::ALL.len();
        assert!(is_whole || name == "squash", "{name}");
        for symmetry in &template.symmetry {
            for landmark in &field.landmarks {
                let twin = symmetry.landmark_twin(&field, landmark).unwrap();
                assert_eq!(
                    symmetry.landmark_twin(&field, twin).unwrap().id,
                    landmark.id
                );
            }
            assert!(
                field
                    .lines
                    .iter()
                    .all(|line| symmetry.line_twin(&field, line).is_some())
            );
        }
        for line in &field.lines {
            assert!(
                line.curve.length_m() > 0.0 && line.width_m > 0.0,
                "{name} {}",
                line.id
            );
            let shift = (line.paint_centre.point_at(0.3) - line.curve.point_at(0.3)).norm();
            assert!(shift < line.width_m / 2.0 + 1e-9, "{name} {}", line.id);
        }
        assert!(
            field
                .landmarks
                .iter()
                .any(|landmark| landmark.nominal_m.z > 0.0),
            "{name} has no 3-D parts"
        );
    }
}

#[test]
fn a_mirrored_field_pairs_left_with_right() {
    let soccer = model("soccer");
    let twin = |symmetry: Symmetry, name: &str| {
        symmetry
            .landmark_twin(&soccer, soccer.landmark(name).unwrap())
            .unwrap()
            .id
            .to_string()
    };
    assert_eq!(
        twin(Symmetry::MirrorX, "penalty_area_far_left_front"),
        "penalty_area_far_right_front"
    );
    assert_eq!(
        twin(Symmetry::MirrorY, "penalty_area_far_left_front"),
        "penalty_area_near_left_front"
    );
    assert_eq!(
        twin(Symmetry::Turn180, "post_near_left_top"),
        "post_far_right_top"
    );
    assert_eq!(twin(Symmetry::Turn180, "centre_mark"), "centre_mark");
    let line = |name: &str| soccer.line(name).unwrap();
    assert_eq!(
        Symmetry::MirrorX
            .line_twin(&soccer, line("penalty_arc_left"))
            .unwrap()
            .id
            .as_str(),
        "penalty_arc_right"
    );
    assert_eq!(
        Symmetry::Turn180
            .line_twin(&soccer, line("corner_arc_near_left"))
            .unwrap()
            .id
            .as_str(),
        "corner_arc_far_right"
    );
}

#[test]
fn basketball_is_where_fiba_nba_and_ncaa_put_it() {
    let fiba = model("basketball_fiba");
    let bend = 14.0 - 1.575 - (6.75_f64 * 6.75 - 6.6 * 6.6).sqrt();
    assert!(
        (14.0 - bend - 2.990).abs() < 5e-4,
        "the published 2.990 m from the end line"
    );
    assert_landmarks(
        &fiba,
        &[
            ("corner_far_right", [14.0, 7.5, 0.0]),
            ("key_near_left_free_throw", [-8.2, -2.45, 0.0]),
            ("three_point_far_right_bend", [bend, 6.6, 0.0]),
            ("three_point_apex_right", [5.675, 0.0, 0.0]),
            ("ring_left_front", [-12.2, 0.0, 3.05]),
            ("backboard_far_left_top", [-12.8, 0.9, 3.95]),
            ("backboard_near_right_bottom", [12.8, -0.9, 2.9]),
        ],
    );
    let nba = model("basketball_nba");
    let bend = 5.25 + (23.75_f64 * 23.75 - 22.0 * 22.0).sqrt();
    assert!(
        (bend - 14.20).abs() < 5e-3,
        "the published 14.20 ft from the end line"
    );
    assert_landmarks(
        &nba,
        &[
            ("corner_near_right", [47.0 * FT, -25.0 * FT, 0.0]),
            ("key_far_right_free_throw", [28.0 * FT, 8.0 * FT, 0.0]),
            (
                "three_point_near_left_bend",
                [(bend - 47.0) * FT, -22.0 * FT, 0.0],
            ),
            ("hash_mark_far_left", [-19.0 * FT, 25.0 * FT, 0.0]),
            ("backboard_far_right_top", [43.0 * FT, 3.0 * FT, 13.0 * FT]),
            ("ring_right_front", [41.0 * FT, 0.0, 10.0 * FT]),
        ],
    );
    let ncaa = model("basketball_ncaa");
    let bend = ncaa
        .landmark("three_point_far_right_bend")
        .unwrap()
        .nominal_m;
    assert!(
        (47.0 - bend.x / FT - (9.0 + 10.375 / 12.0)).abs() < 0.02,
        "the published 9 ft 10 3/8 in"
    );
    assert_landmarks(
        &ncaa,
        &[("key_far_left_end_line", [-47.0 * FT, 6.0 * FT, 0.0])],
    );
}

#[test]
fn ice_hockey_is_where_iihf_and_nhl_put_it() {
    let iihf = model("ice_hockey_iihf");
    let reach = iihf.landmark("goal_line_far_right").unwrap().nominal_m;
    assert!(
        (reach.y - 13.71).abs() < 2e-3,
        "the published 13.71 m for 60 x 30 m, radius 8.5 m: {}",
        reach.y
    );
    assert_landmarks(
        &iihf,
        &[
            ("blue_line_near_right", [7.14, -15.0, 0.0]),
            ("end_spot_far_left", [-20.0, 7.0, 0.0]),
            ("neutral_spot_near_left", [-5.64, -7.0, 0.0]),
            ("post_far_right_top", [26.0, 0.915, 1.22]),
            ("crease_apex_right", [24.2, 0.0, 0.0]),
        ],
    );
    let narrow = BTreeMap::from([("width_m".to_owned(), 26.0)]);
    let narrow = builtin("ice_hockey_iihf")
        .unwrap()
        .model(&narrow, 0.0)
        .unwrap();
    assert!((narrow.landmark("goal_line_far_left").unwrap().nominal_m.y - 11.71).abs() < 2e-3);
    let nhl = model("ice_hockey_nhl");
    let reach = nhl.landmark("goal_line_far_right").unwrap().nominal_m.y / FT;
    assert!(
        (reach - 36.75).abs() < 2e-3,
        "the published 36.75 ft: {reach}"
    );
    assert_landmarks(
        &nhl,
        &[
            ("blue_line_far_left", [-25.0 * FT, 42.5 * FT, 0.0]),
            ("end_spot_near_right", [69.0 * FT, -22.0 * FT, 0.0]),
            ("neutral_spot_far_right", [20.0 * FT, 22.0 * FT, 0.0]),
            ("trapezoid_near_left_boards", [-100.0 * FT, -14.0 * FT, 0.0]),
            (
                "trapezoid_near_left_goal_line",
                [-89.0 * FT, -11.0 * FT, 0.0],
            ),
            ("post_near_left_top", [-89.0 * FT, -3.0 * FT, 4.0 * FT]),
        ],
    );
    let crease = nhl.landmark("crease_near_right_front").unwrap().nominal_m;
    assert!(
        (89.0 - crease.x / FT - 4.5).abs() < 0.03,
        "the published 4 ft 6 in"
    );
}

#[test]
fn american_football_is_where_nfl_and_ncaa_put_it() {
    let nfl = model("american_football_nfl");
    let ncaa = model("american_football_ncaa");
    let half_width = 80.0 * FT;
    for field in [&nfl, &ncaa] {
        assert_landmarks(
            field,
            &[
                ("corner_near_left", [-60.0 * YD, -half_width, 0.0]),
                ("goal_line_far_right", [50.0 * YD, half_width, 0.0]),
                ("yard_line_left_5_near", [-45.0 * YD, -half_width, 0.0]),
                ("yard_line_right_45_far", [5.0 * YD, half_width, 0.0]),
                ("crossbar_far_right", [60.0 * YD, 9.25 * FT, 10.0 * FT]),
            ],
        );
        let yard_lines = field
            .lines
            .iter()
            .filter(|line| line.id.as_str().starts_with("yard_line_"))
            .count();
        assert_eq!(yard_lines, 18);
    }
    assert_landmarks(
        &nfl,
        &[("yard_line_right_20_hash_far", [30.0 * YD, 9.25 * FT, 0.0])],
    );
    assert_landmarks(
        &ncaa,
        &[("yard_line_right_20_hash_far", [30.0 * YD, 20.0 * FT, 0.0])],
    );
    assert_landmarks(
        &nfl,
        &[("upright_near_left_top", [-60.0 * YD, -9.25 * FT, 35.0 * FT])],
    );
    assert_landmarks(&ncaa, &[("try_mark_left", [-47.0 * YD, 0.0, 0.0])]);
}

#[test]
fn badminton_pickleball_padel_beach_volleyball_and_field_hockey_are_where_their_rules_put_them() {
    assert_landmarks(
        &model("badminton"),
        &[
            ("corner_far_left", [-6.7, 3.05, 0.0]),
            ("singles_near_right", [6.7, -2.59, 0.0]),
            ("long_service_far_right", [5.94, 3.05, 0.0]),
            ("short_service_t_left", [-1.98, 0.0, 0.0]),
            ("net_post_near_top", [0.0, -3.05, 1.55]),
        ],
    );
    // Both edges of the short service line are within the service court.
    let badminton = model("badminton");
    let mut lines = badminton.lines.iter();
    let short = lines
        .find(|line| line.id.as_str() == "short_service_line_right")
        .unwrap();
    assert!((short.paint_centre.point_at(0.5).x - 2.0).abs() < 1e-9);
    assert_landmarks(
        &model("pickleball"),
        &[
            ("corner_near_left", [-22.0 * FT, -10.0 * FT, 0.0]),
            ("non_volley_t_right", [7.0 * FT, 0.0, 0.0]),
            ("net_post_far_top", [0.0, 11.0 * FT, 3.0 * FT]),
        ],
    );
    assert_landmarks(
        &model("padel"),
        &[
            ("fence_top_near_right", [10.0, -5.0, 4.0]),
            ("service_far_left", [-6.95, 5.0, 0.0]),
            ("centre_line_end_right", [7.15, 0.0, 0.0]),
        ],
    );
    assert_landmarks(
        &model("beach_volleyball"),
        &[
            ("corner_far_right", [8.0, 4.0, 0.0]),
            ("antenna_near_top", [0.0, -4.0, 3.23]),
        ],
    );
    assert_landmarks(
        &model("field_hockey"),
        &[
            ("line_23_near_left", [-22.8, -27.5, 0.0]),
            ("circle_far_right_back_line", [45.7, 16.46, 0.0]),
            ("circle_near_left_front", [-31.07, -1.83, 0.0]),
            ("penalty_spot_right", [39.225, 0.0, 0.0]),
            ("post_far_left_top", [-45.7, 1.83, 2.14]),
        ],
    );
}

#[test]
fn rugby_and_squash_are_where_their_rules_put_them() {
    let rugby = model("rugby_union");
    assert_landmarks(
        &rugby,
        &[
            ("corner_far_left", [-50.0, 35.0, 0.0]),
            ("line_22_15_near_right", [28.0, -20.0, 0.0]),
            ("line_10_5_far_left", [-10.0, 30.0, 0.0]),
            ("dead_ball_near_right", [60.0, -35.0, 0.0]),
            ("crossbar_far_right", [50.0, 2.8, 3.0]),
        ],
    );
    // The goal line lies in the in-goal area, the 22 m line within its 22 m.
    let paint_x = |field: &FieldModel, id: &str| {
        let line = field.lines.iter().find(|line| line.id.as_str() == id);
        line.unwrap().paint_centre.point_at(0.5).x
    };
    assert!((paint_x(&rugby, "goal_line_right") - 50.05).abs() < 1e-9);
    assert!((paint_x(&rugby, "line_22_right") - 28.05).abs() < 1e-9);
    let short = BTreeMap::from([("length_m".to_owned(), 94.0), ("width_m".to_owned(), 68.0)]);
    let short = builtin("rugby_union").unwrap().model(&short, 0.0).unwrap();
    assert_landmarks(&short, &[("line_22_15_near_right", [25.0, -19.0, 0.0])]);

    let squash = model("squash");
    assert_landmarks(
        &squash,
        &[
            ("short_line_near", [-0.615, -3.2, 0.0]),
            ("service_box_far_back", [-2.215, 1.6, 0.0]),
            ("front_out_far", [4.875, 3.2, 4.57]),
            ("back_out_near", [-4.875, -3.2, 2.13]),
        ],
    );
    // 5.44 m from the front wall to the short line's far edge: 9.75 m less 4.26 m and 50 mm.
    assert!((paint_x(&squash, "short_line") - (4.875 - 5.465)).abs() < 1e-9);
}

#[test]
fn tennis_volleyball_handball_and_futsal_are_where_their_rules_put_them() {
    assert_landmarks(
        &model("tennis"),
        &[
            ("corner_far_left", [-11.885, 5.485, 0.0]),
            ("singles_near_right", [11.885, -4.115, 0.0]),
            ("service_t_left", [-6.4, 0.0, 0.0]),
            ("net_post_far_top", [0.0, 6.399, 1.07]),
            ("net_centre_top", [0.0, 0.0, 0.914]),
        ],
    );
    assert_landmarks(
        &model("volleyball"),
        &[
            ("corner_near_left", [-9.0, -4.5, 0.0]),
            ("attack_far_right", [3.0, 4.5, 0.0]),
            ("antenna_far_top", [0.0, 4.5, 3.23]),
            ("net_near_bottom", [0.0, -4.5, 1.43]),
        ],
    );
    let women = BTreeMap::from([("net_height_m".to_owned(), 2.24)]);
    let women = builtin("volleyball").unwrap().model(&women, 0.0).unwrap();
    assert_landmarks(&women, &[("antenna_near_top", [0.0, -4.5, 3.04])]);
    assert_landmarks(
        &model("handball"),
        &[
            ("goal_area_far_left_goal_line", [-20.0, 7.5, 0.0]),
            ("goal_area_near_right_front", [14.0, -1.5, 0.0]),
            (
                "free_throw_far_right_sideline",
                [20.0 - (81.0_f64 - 72.25).sqrt(), 10.0, 0.0],
            ),
            ("seven_metre_far_left", [-13.0, 0.5, 0.0]),
            ("goalkeeper_line_right", [16.0, 0.0, 0.0]),
            ("post_near_left_top", [-20.0, -1.5, 2.0]),
        ],
    );
    assert_landmarks(
        &model("futsal"),
        &[
            ("penalty_area_far_right_front", [14.0, 1.58, 0.0]),
            ("penalty_area_far_right_goal_line", [20.0, 7.58, 0.0]),
            ("second_penalty_mark_left", [-10.0, 0.0, 0.0]),
        ],
    );
}

#[test]
fn the_template_of_the_guide_is_one() {
    let page = include_str!("../../../assets/guide/fields.md");
    let example = page.split("```json").nth(1).unwrap().split("```").next();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my-court.json");
    std::fs::write(&path, example.unwrap()).unwrap();
    let court = touchline_core::field::Template::from_file(&path).unwrap();
    let court = court.default_model().unwrap();
    assert_landmarks(&court, &[("corner_far_left", [-10.0, 5.0, 0.0])]);
    assert_eq!(court.lines.len(), 5);
}
