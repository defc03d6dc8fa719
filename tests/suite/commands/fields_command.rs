//! `touchline fields` from outside.

use crate::program::touchline;
use serde_json::Value;
use std::fs;
use touchline::field::builtin_names;

#[test]
fn every_template_is_listed_for_people_and_for_scripts() {
    let folder = tempfile::tempdir().unwrap();
    let listed = touchline(folder.path(), "fields").stdout;
    let described: Value =
        serde_json::from_str(&touchline(folder.path(), "fields --json").stdout).unwrap();
    let templates = described["templates"].as_array().unwrap();
    assert_eq!(
        templates
            .iter()
            .map(|template| template["name"].as_str().unwrap())
            .collect::<Vec<_>>(),
        builtin_names()
    );
    for template in templates {
        assert!(listed.contains(template["title"].as_str().unwrap()));
        for part in ["landmarks", "lines"] {
            for entry in template[part].as_array().unwrap() {
                assert!(listed.contains(entry["id"].as_str().unwrap()));
            }
        }
        for (name, param) in template["params"].as_object().unwrap() {
            assert!(listed.contains(name) && listed.contains(param["source"].as_str().unwrap()));
            assert!(
                param["min"].as_f64() <= param["default"].as_f64()
                    && param["default"].as_f64() <= param["max"].as_f64()
            );
        }
    }
    assert!(listed.contains("length_m = 105 (90 to 120 m; IFAB Law 1.3"));
}

#[test]
fn parameters_move_the_landmarks() {
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(
        folder.path(),
        "fields soccer --set length_m=100 --set width_m=64 --json",
    );
    let described: Value = serde_json::from_str(&ran.stdout).unwrap();
    let soccer = &described["templates"][0];
    let landmarks = soccer["landmarks"].as_array().unwrap();
    let corner = landmarks
        .iter()
        .find(|landmark| landmark["id"] == "corner_far_right")
        .unwrap();
    assert_eq!(corner["position_m"], serde_json::json!([50.0, 32.0, 0.0]));
    assert_eq!(soccer["params"]["length_m"]["value"], 100.0);
    let wrong = touchline(folder.path(), "fields soccer --set length_m=80");
    assert_eq!(wrong.code, 2);
    assert!(
        wrong
            .stderr
            .starts_with("touchline: soccer field: length_m = 80 is outside 90 to 120 (IFAB")
    );
}

#[test]
fn a_template_of_ones_own_is_drawn_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/fields/tennis.json");
    fs::copy(own, folder.path().join("own.json")).unwrap();
    touchline(folder.path(), "fields own.json --render own.svg").done();
    let svg = fs::read_to_string(folder.path().join("own.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.contains("Service line meets centre line, left"));
    let again = touchline(folder.path(), "fields own.json --render own.svg");
    assert_eq!(again.code, 2);
    assert!(
        again
            .stderr
            .contains("own.svg already exists; give --force to replace it")
    );
    // A copy of a built-in template is a template of its own.
    let copied = touchline(folder.path(), "fields badminton --template copy.json");
    assert_eq!(copied.code, 0, "{}", copied.stderr);
    assert_eq!(
        touchline(folder.path(), "fields copy.json").stdout,
        touchline(folder.path(), "fields badminton").stdout
    );
    for (wrong, line) in [
        ("fields badminton --template copy.json", "already exists"),
        (
            "fields quidditch --template other.json",
            "built in are soccer",
        ),
        ("fields tennis --template other.txt", "ending in .json"),
    ] {
        let wrong = touchline(folder.path(), wrong);
        assert!(
            wrong.code == 2 && wrong.stderr.contains(line),
            "{}",
            wrong.stderr
        );
    }
    let wrong = touchline(folder.path(), "fields own.json --render own.bmp");
    assert_eq!(
        wrong.stderr,
        "touchline: --render own.bmp: the name must end with .svg or .png\n"
    );
}
