//! Broken field templates: each has the message that its author gets.

use std::fs;
use std::path::Path;
use touchline_core::field::{Template, template_named};

/// A small, sound template.
const SOUND: &str = r#"{
  "format": "touchline-field", "version": 1, "name": "yard", "title": "A yard",
  "params": { "length_m": { "label": "Length", "unit": "m", "default": 20, "min": 10, "max": 30, "source": "measured" } },
  "dimensions": { "width_m": { "value": "length_m/2", "source": "measured" } },
  "extent_m": ["length_m", "width_m"],
  "symmetry": ["mirror_x"],
  "landmarks": [
    { "id": "corner_{near,far}_{left,right}", "label": "Corner, {near,far} {left,right}", "code": "c{n,f}{l,r}", "at": ["x_side*length_m/2", "y_side*width_m/2"] }
  ],
  "lines": [
    { "id": "side_{near,far}", "label": "Side, {near,far}", "code": "s{n,f}", "from": "corner_{near,far}_left", "to": "corner_{near,far}_right", "width_m": 0.05 }
  ]
}"#;

/// (what is wrong, what is replaced, by what, the message)
const BROKEN: &[(&str, &str, &str, &str)] = &[
    (
        "another format",
        "touchline-field",
        "touchline",
        "yard.json: not a field template: it has no \"format\": \"touchline-field\"",
    ),
    (
        "a newer version",
        "\"version\": 1",
        "\"version\": 7",
        "yard.json: version 7 of the template format is newer than this program knows (1); update touchline",
    ),
    (
        "a key that a terminal obeys",
        "\"landmarks\"",
        "\"\\u001b[2J\"",
        "yard.json: unknown field `\\u{1b}[2J`, expected one of `format`, `version`, `name`, `title`, `notes`, `params`, \
         `dimensions`, `extent_m`, `symmetry`, `click_sigma_px`, `landmarks`, `lines` at line 7 column 13",
    ),
    (
        "a misspelt key",
        "\"landmarks\"",
        "\"landmark\"",
        "yard.json: unknown field `landmark`, expected one of `format`, `version`, `name`, `title`, `notes`, `params`, \
         `dimensions`, `extent_m`, `symmetry`, `click_sigma_px`, `landmarks`, `lines` at line 7 column 12",
    ),
    (
        "a missing key",
        "\"title\": \"A yard\",",
        "",
        "yard.json: missing field `title` at line 13 column 1",
    ),
    (
        "a number beyond all numbers",
        "\"default\": 20",
        "\"default\": 1e999",
        "yard.json: number out of range at line 3 column 76",
    ),
    (
        "a boolean for a length",
        "\"default\": 20",
        "\"default\": true",
        "yard.json: invalid type: boolean `true`, expected a number or an expression in quotes at line 3 column 75",
    ),
    (
        "a name of a template with a space",
        "\"name\": \"yard\"",
        "\"name\": \"My yard\"",
        "yard.json: name: \"My yard\" is not a name of lower-case letters, digits and \"_\" that starts with a letter",
    ),
    (
        "a parameter in feet",
        "\"unit\": \"m\"",
        "\"unit\": \"ft\"",
        "yard.json: param \"length_m\": its unit is \"ft\"; parameters are metres (unit \"m\", name ending in _m)",
    ),
    (
        "a default outside its range",
        "\"max\": 30",
        "\"max\": 15",
        "yard.json: param \"length_m\": the default 20 is not within min 10 and max 15",
    ),
    (
        "a dimension without a source",
        "\"value\": \"length_m/2\", \"source\": \"measured\"",
        "\"value\": \"length_m/2\", \"source\": \" \"",
        "yard.json: dimension \"width_m\": source is empty",
    ),
    (
        "a dimension named as a parameter",
        "\"width_m\": {",
        "\"length_m\": {",
        "yard.json: dimension \"length_m\": the name \"length_m\" is taken",
    ),
    (
        "an expression cut short",
        "\"value\": \"length_m/2\"",
        "\"value\": \"length_m/\"",
        "yard.json: dimension \"width_m\": \"length_m/\": unexpected end at position 10: a number, a name or \"(\" was expected",
    ),
    (
        "an unknown name",
        "y_side*width_m/2",
        "y_side*widht_m/2",
        "yard.json: landmark \"corner_near_left\", at[1]: \"y_side*widht_m/2\": unknown name \"widht_m\" at position 8 \
         (known here: length_m, width_m, y_side, x_side)",
    ),
    (
        "a division by zero at the smallest length",
        "\"value\": \"length_m/2\"",
        "\"value\": \"100/(length_m - 10)\"",
        "yard.json: dimension \"width_m\": \"100/(length_m - 10)\": division by zero at position 4",
    ),
    (
        "a group that is none",
        "\"id\": \"corner_{near,far}",
        "\"id\": \"corner_{nigh,far}",
        "yard.json: landmark \"corner_{nigh,far}_{left,right}\": \"corner_{nigh,far}_{left,right}\": {nigh,far} is not a \
         group; groups are {near,far}, {n,f}, {left,right}, {l,r} and numbers such as {10,20}",
    ),
    (
        "one code for two corners",
        "\"code\": \"c{n,f}{l,r}\"",
        "\"code\": \"c{n,f}\"",
        "yard.json: landmark \"corner_near_right\": its code \"cn\" is taken",
    ),
    (
        "a code that is too long",
        "\"code\": \"c{n,f}{l,r}\"",
        "\"code\": \"corner{n,f}{l,r}\"",
        "yard.json: landmark \"corner_{near,far}_{left,right}\": its code \"cornernl\" is not 2 to 4 lower-case letters or digits",
    ),
    (
        "four coordinates",
        "\"y_side*width_m/2\"]",
        "\"y_side*width_m/2\", 0, 0]",
        "yard.json: landmark \"corner_near_left\", at: 4 coordinates instead of [x, y] or [x, y, z]",
    ),
    (
        "a corner a kilometre away",
        "\"y_side*width_m/2\"]",
        "\"y_side*width_m*200\"]",
        "yard.json: landmark \"corner_near_left\", at[1]: -2000 m is more than 1000 m from the field's centre",
    ),
    (
        "all corners in one place",
        "\"y_side*width_m/2\"]",
        "\"0*y_side\"]",
        "yard.json: landmark \"corner_far_left\": it lies where \"corner_near_left\" lies",
    ),
    (
        "a line to nowhere",
        "\"to\": \"corner_{near,far}_right\"",
        "\"to\": \"edge_{near,far}_right\"",
        "yard.json: line \"side_near\", to: there is no landmark \"edge_near_right\"",
    ),
    (
        "a line without length",
        "\"to\": \"corner_{near,far}_right\"",
        "\"to\": \"corner_{near,far}_left\"",
        "yard.json: line \"side_near\": it is only 0 m long",
    ),
    (
        "half a circle, half a line",
        "\"to\": \"corner_{near,far}_right\"",
        "\"radius_m\": 3",
        "yard.json: line \"side_near\": it needs from and to (straight), from, through and to (arc), or centre and \
         radius_m (circle)",
    ),
    (
        "an arc through a straight line",
        "\"to\": \"corner_{near,far}_right\"",
        "\"through\": [0, \"y_side*width_m/2\"], \"to\": \"corner_{near,far}_right\"",
        "yard.json: line \"side_near\": an arc's three points must not lie on one straight line",
    ),
    (
        "paint without width",
        "\"width_m\": 0.05",
        "\"width_m\": 0",
        "yard.json: line \"side_near\", width_m: 0 m is not greater than 0",
    ),
    (
        "dashes without a gap",
        "\"width_m\": 0.05",
        "\"width_m\": 0.05, \"dash_m\": [0.15, 0]",
        "yard.json: line \"side_near\", dash_m: 0 m is not greater than 0",
    ),
    (
        "dashes without number",
        "\"width_m\": 0.05",
        "\"width_m\": 0.05, \"dash_m\": [1e-6, 1e-6]",
        "yard.json: line \"side_near\", dash_m: 0.000001 and 0.000001 m make more than 2000 dashes",
    ),
    (
        "paint in the air",
        "\"to\": \"corner_{near,far}_right\"",
        "\"to\": [0, 0, 2.44]",
        "yard.json: line \"side_near\", to: it lies at z = 2.44 m: what is off the ground needs \"painted\": false",
    ),
    (
        "an edge that is none",
        "\"width_m\": 0.05",
        "\"width_m\": 0.05, \"edge\": \"left\"",
        "yard.json: line \"side_near\": edge \"left\" is not one of centre, outer, inner",
    ),
    (
        "an outer edge of nothing",
        "\"width_m\": 0.05",
        "\"width_m\": 0.05, \"edge\": \"outer\"",
        "yard.json: line \"side_near\": inside (a point of the area that the line bounds) belongs to straight lines whose \
         edge is outer or inner, and only to them",
    ),
    (
        "a symmetry that is none",
        "\"mirror_x\"",
        "\"mirror\"",
        "yard.json: symmetry: \"mirror\" is not one of mirror_x, mirror_y, turn_180",
    ),
    (
        "a promise of symmetry that is not kept",
        "\"x_side*length_m/2\"",
        "\"x_side*length_m/2 + 1\"",
        "yard.json: landmark \"corner_near_left\": the field is not symmetric by mirror_x: no landmark lies where this \
         one comes to lie",
    ),
    (
        "a click without scatter",
        "\"code\": \"c{n,f}{l,r}\"",
        "\"click_sigma_px\": 0, \"code\": \"c{n,f}{l,r}\"",
        "yard.json: landmark \"corner_near_left\": click_sigma_px = 0 is outside 0 to 100",
    ),
];

#[test]
fn a_sound_template_is_read() {
    let yard = Template::from_json(SOUND, "yard.json").unwrap();
    assert_eq!(yard.default_model().unwrap().landmarks.len(), 4);
}

#[test]
fn every_mistake_in_a_template_has_its_message() {
    let mut wrong = Vec::new();
    for (what, sound, broken, message) in BROKEN {
        assert!(SOUND.contains(sound), "{what}: nothing to break");
        let text = SOUND.replacen(sound, broken, 1);
        let said = Template::from_json(&text, "yard.json")
            .map_or_else(|error| error.to_string(), |_| "read".to_owned());
        if said != *message {
            wrong.push(format!("{what}:\n  said   {said}\n  wanted {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn text_that_is_no_template_has_its_message() {
    let twice = SOUND.replacen(
        "\"dimensions\": {",
        "\"dimensions\": { \"width_m\": { \"value\": 1, \"source\": \"a\" },",
        1,
    );
    let no_landmarks = {
        let from = SOUND.find("\"landmarks\": [").unwrap();
        let to = SOUND.find("\"lines\"").unwrap();
        format!("{}\"landmarks\": [],\n{}", &SOUND[..from], &SOUND[to..])
    };
    let mut wrong = Vec::new();
    for (text, message) in [
        (
            "",
            "yard.json: the file is empty; a field template is a JSON object",
        ),
        (
            "[]",
            "yard.json: invalid length 0, expected a field template, which is a JSON object at line 1 column 2",
        ),
        (
            "null",
            "yard.json: invalid type: null, expected a field template, which is a JSON object at line 1 column 4",
        ),
        (
            "{}",
            "yard.json: not a field template: it has no \"format\": \"touchline-field\"",
        ),
        (
            &SOUND[..200],
            "yard.json: EOF while parsing an object at line 3 column 118",
        ),
        (
            &twice,
            "yard.json: \"width_m\" is given twice at line 4 column 69",
        ),
        (&no_landmarks, "yard.json: landmarks: there are none"),
    ] {
        let said = Template::from_json(text, "yard.json")
            .map_or_else(|error| error.to_string(), |_| "read".to_owned());
        if said != message {
            wrong.push(format!("said   {said}\n  wanted {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_that_cannot_be_read_have_their_message() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("empty.json"), "").unwrap();
    fs::write(at("latin.json"), b"{ \"name\": \"F\xfcr uns\" }").unwrap();
    fs::create_dir(at("folder.json")).unwrap();
    fs::write(at("yard.JSON"), SOUND).unwrap();
    for (name, message) in [
        (
            "empty.json",
            "the file is empty; a field template is a JSON object",
        ),
        (
            "latin.json",
            "cannot be read: it is not UTF-8 text (byte 12)",
        ),
        (
            "folder.json",
            "cannot be read: it is a folder; give the template's JSON file",
        ),
        (
            "missing.json",
            "cannot be read: No such file or directory (os error 2)",
        ),
    ] {
        let error = template_named(name, folder.path())
            .map(|_| ())
            .expect_err(name);
        assert_eq!(
            error.to_string(),
            format!("{}: {message}", at(name).display())
        );
    }
    assert_eq!(
        template_named("yard.JSON", folder.path()).unwrap().name,
        "yard"
    );
    assert_eq!(
        template_named("soccer", Path::new("/nowhere"))
            .unwrap()
            .name,
        "soccer"
    );
}

#[test]
fn a_template_cut_anywhere_never_panics() {
    for end in (0..SOUND.len()).filter(|end| SOUND.is_char_boundary(*end)) {
        assert!(Template::from_json(&SOUND[..end], "yard.json").is_err());
    }
}
