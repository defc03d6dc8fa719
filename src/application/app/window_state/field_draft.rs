//! A field template that the user writes in the window: its text, the field that the text
//! describes, and lines and landmarks that are written into it.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use touchline_core::field::{FieldError, FieldLine, FieldModel, Template, builtin_text};
use touchline_core::geometry::Vec3;

/// Places nearer to each other are one, m.
const SAME_PLACE_M: f64 = 0.005;

/// The template from which a court is drawn: boundary lines alone.
const BLANK: &str = r#"{
  "format": "touchline-field", "version": 1, "name": "my_court", "title": "My court",
  "params": {},
  "dimensions": {
    "length_m": { "value": 20, "source": "measured" },
    "width_m": { "value": 10, "source": "measured" },
    "line_width_m": { "value": 0.05, "source": "measured" }
  },
  "extent_m": ["length_m", "width_m"],
  "symmetry": ["mirror_x", "mirror_y", "turn_180"],
  "landmarks": [
    { "id": "corner_{near,far}_{left,right}", "label": "Corner, {near,far} {left,right}",
      "code": "c{n,f}{l,r}", "at": ["x_side*length_m/2", "y_side*width_m/2"] }
  ],
  "lines": [
    { "id": "sideline_{near,far}", "label": "Sideline, {near,far}", "code": "s{n,f}",
      "from": "corner_{near,far}_left", "to": "corner_{near,far}_right",
      "width_m": "line_width_m", "edge": "outer", "inside": [0, 0] },
    { "id": "end_line_{left,right}", "label": "End line, {left,right}", "code": "e{l,r}",
      "from": "corner_near_{left,right}", "to": "corner_far_{left,right}",
      "width_m": "line_width_m", "edge": "outer", "inside": [0, 0] }
  ]
}
"#;

/// A template that is being written.
#[derive(Clone, Debug)]
pub struct FieldDraft {
    text: String,
    /// The template and its field with the default parameters, or what is wrong with the text.
    state: Result<(Box<Template>, Arc<FieldModel>), FieldError>,
    /// The field of the last text that was a template, to be drawn meanwhile.
    last_field: Option<Arc<FieldModel>>,
    /// The texts before what was drawn or written into it, last last.
    earlier: Vec<String>,
    /// The name under which it was saved: it may replace that file.
    pub saved_as: Option<String>,
}

/// A line that is drawn into a template, m from the field's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnLine {
    Straight { from: [f64; 2], to: [f64; 2] },
    Circle { centre: [f64; 2], radius_m: f64 },
}

/// The sides on which a drawn line is painted as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mirrored {
    /// At the other end: x changes its sign.
    pub to_other_end: bool,
    /// On the other side: y changes its sign.
    pub to_other_side: bool,
}

impl FieldDraft {
    /// Begins with a copy of a built-in template, or with boundary lines alone if there is none of
    /// this name.
    pub fn begin(template: &str) -> Self {
        let text = match builtin_text(template) {
            Ok(text) => text.replacen(
                &format!("\"name\": \"{template}\""),
                &format!("\"name\": \"my_{template}\""),
                1,
            ),
            Err(_) => BLANK.to_owned(),
        };
        Self::new(text, None)
    }

    /// Begins with the text of a file, which it may replace.
    pub fn from_file(name: String, text: String) -> Self {
        Self::new(text, Some(name))
    }

    fn new(text: String, saved_as: Option<String>) -> Self {
        let state = parse(&text);
        Self {
            last_field: state.as_ref().ok().map(|(_, field)| Arc::clone(field)),
            state,
            text,
            earlier: Vec::new(),
            saved_as,
        }
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// The template and its field.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn field(&self) -> Result<(&Template, &Arc<FieldModel>), &FieldError> {
        let state = self.state.as_ref();
        state.map(|(template, field)| (&**template, field))
    }

    /// The field of the last text that was a template.
    pub fn last_field(&self) -> Option<&Arc<FieldModel>> {
        self.last_field.as_ref()
    }

    /// The name of its file, beside the project.
    pub fn file_name(&self) -> Option<String> {
        let (template, _) = self.state.as_ref().ok()?;
        Some(format!("{}.json", template.name))
    }

    /// Takes the text as it was typed.
    pub fn set_text(&mut self, text: String) {
        if self.text != text {
            self.state = parse(&text);
            self.text = text;
            if let Ok((_, field)) = &self.state {
                self.last_field = Some(Arc::clone(field));
            }
        }
    }

    /// Takes back what was drawn or written last.
    pub fn undo(&mut self) {
        if let Some(text) = self.earlier.pop() {
            self.set_text(text);
        }
    }

    pub const fn can_undo(&self) -> bool {
        !self.earlier.is_empty()
    }

    /// Writes a drawn line into the text, mirrored where it is not its own mirror image. Nothing
    /// while the text is no template.
    pub fn draw(&mut self, line: DrawnLine, mirrored: Mirrored) {
        let Ok((_, field)) = &self.state else { return };
        let number = field.lines.len() + 1;
        let code = unused_code(&mut codes_of(field), 'k');
        let entry = line_entry(line, line.asymmetric_of(mirrored), number, &code);
        self.insert("lines", &[entry]);
    }

    /// Adds landmarks where painted lines meet or end, as far as there are none yet. Returns how
    /// many.
    pub fn add_landmarks(&mut self) -> usize {
        let Ok((_, field)) = &self.state else {
            return 0;
        };
        let found = places_of_lines(field);
        let mut codes = codes_of(field);
        let first = field.landmarks.len() + 1;
        let numbered = found.iter().zip(first..);
        let entries: Vec<String> = numbered
            .map(|(place, number)| landmark_entry(place, number, &unused_code(&mut codes, 'p')))
            .collect();
        self.insert("landmarks", &entries);
        entries.len()
    }

    /// Writes entries at the end of an array of the template, and states the symmetries that hold
    /// then.
    fn insert(&mut self, array: &str, entries: &[String]) {
        let Some(inner) = array_of(&self.text, array).filter(|_| !entries.is_empty()) else {
            return;
        };
        self.earlier.push(self.text.clone());
        // After the last entry, in the layout of the file.
        let before = self.text[..inner.end].trim_end();
        let comma = if before.ends_with('[') { "" } else { "," };
        let text = format!(
            "{before}{comma}\n    {}\n  {}",
            entries.join(",\n    "),
            &self.text[inner.end..]
        );
        self.set_text(with_symmetries_that_hold(text));
    }
}

impl DrawnLine {
    /// Without the mirror images that are the line itself.
    fn asymmetric_of(self, mirrored: Mirrored) -> Mirrored {
        Mirrored {
            to_other_end: mirrored.to_other_end && !self.is_own_image(0),
            to_other_side: mirrored.to_other_side && !self.is_own_image(1),
        }
    }

    /// Whether it is its own mirror image where x (axis 0) or y (1) changes its sign.
    fn is_own_image(self, axis: usize) -> bool {
        match self {
            Self::Straight { from, to } => {
                let is_on_axis = from[axis].abs().max(to[axis].abs()) < SAME_PLACE_M;
                let across = 1 - axis;
                let crosses = (from[axis] + to[axis]).abs() < SAME_PLACE_M
                    && (from[across] - to[across]).abs() < SAME_PLACE_M;
                is_on_axis || crosses
            }
            Self::Circle { centre, .. } => centre[axis].abs() < SAME_PLACE_M,
        }
    }
}

fn parse(text: &str) -> Result<(Box<Template>, Arc<FieldModel>), FieldError> {
    let template = Template::from_json(text, "template")?;
    let field = template.default_model()?;
    Ok((Box::new(template), Arc::new(field)))
}

/// The entry of a drawn line.
fn line_entry(line: DrawnLine, mirrored: Mirrored, number: usize, code: &str) -> String {
    let curve = match line {
        DrawnLine::Straight { from, to } => format!(
            "\"from\": {}, \"to\": {}",
            point(from, mirrored),
            point(to, mirrored)
        ),
        DrawnLine::Circle { centre, radius_m } => format!(
            "\"centre\": {}, \"radius_m\": {}",
            point(centre, mirrored),
            decimal(radius_m)
        ),
    };
    let (mut id, mut label, mut codes) = (
        format!("line_{number}"),
        format!("Line {number}"),
        code.to_owned(),
    );
    let sides = [
        (mirrored.to_other_side, "{near,far}", "{n,f}"),
        (mirrored.to_other_end, "{left,right}", "{l,r}"),
    ];
    for (_, names, initials) in sides.into_iter().filter(|(is_mirrored, ..)| *is_mirrored) {
        id = format!("{id}_{names}");
        label = format!("{label}, {names}");
        codes.push_str(initials);
    }
    format!(
        "{{ \"id\": \"{id}\", \"label\": \"{label}\", \"code\": \"{codes}\", \
         {curve}, \"width_m\": 0.05 }}"
    )
}

/// A point of an entry. Where it is mirrored, what is drawn at x > 0 is the right one of a pair:
/// `x_side` is 1 there, and `y_side` on the far side.
fn point([x, y]: [f64; 2], mirrored: Mirrored) -> String {
    let x = coordinate(x, mirrored.to_other_end.then_some("x_side"));
    let y = coordinate(y, mirrored.to_other_side.then_some("y_side"));
    format!("[{x}, {y}]")
}

fn coordinate(value_m: f64, side: Option<&str>) -> String {
    match side.filter(|_| value_m != 0.0) {
        Some(side) => format!("\"{side}*{}\"", decimal(value_m)),
        None => decimal(value_m),
    }
}

/// The entry of a landmark at a place, with its label.
fn landmark_entry((at, label): &(Vec3, String), number: usize, code: &str) -> String {
    let label = serde_json::Value::from(label.as_str());
    let [x, y] = [at.x, at.y].map(decimal);
    format!(
        "{{ \"id\": \"point_{number}\", \"label\": {label}, \"code\": \"{code}\", \
         \"at\": [{x}, {y}] }}"
    )
}

/// The codes of all landmarks and lines.
fn codes_of(field: &FieldModel) -> BTreeSet<String> {
    let landmarks = field.landmarks.iter().map(|landmark| landmark.code.clone());
    let lines = field.lines.iter().map(|line| line.code.clone());
    landmarks.chain(lines).collect()
}

/// A letter and a digit or letter with which none of some codes begins. It is added to them.
fn unused_code(codes: &mut BTreeSet<String>, first: char) -> String {
    const SECOND: &str = "123456789abcdefghijklmnopqrstuvwxyz";
    let mut letters = (first..='z').chain('a'..first);
    let code = letters.find_map(|letter| {
        let mut of_letter = SECOND.chars().map(|second| format!("{letter}{second}"));
        of_letter.find(|code| !codes.iter().any(|known| known.starts_with(code)))
    });
    // There are 910: a field with more has a mistake that its template names.
    let code = code.unwrap_or_default();
    codes.insert(code.clone());
    code
}

/// Where painted lines of the ground meet or end without a landmark, with a label for each.
fn places_of_lines(field: &FieldModel) -> Vec<(Vec3, String)> {
    let lines: Vec<&FieldLine> = field.lines.iter().filter(|line| line.painted).collect();
    let mut found = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        for other in &lines[index + 1..] {
            for at in line.curve.crossings(&other.curve) {
                found.push((at, format!("{} meets {}", line.label, other.label)));
            }
        }
    }
    for line in &lines {
        if line.curve.is_closed() {
            continue;
        }
        let [from, to] = [0.0, 1.0].map(|end| line.curve.point_at(end));
        for (end, other) in [(from, to), (to, from)] {
            let along = end - other;
            let side = match (along.x.abs() > along.y.abs(), along.x > 0.0, along.y > 0.0) {
                (true, false, _) => "left",
                (true, true, _) => "right",
                (false, _, false) => "near",
                (false, _, true) => "far",
            };
            found.push((end, format!("{}, {side} end", line.label)));
        }
    }
    // Of several names of one place the first counts, and none where there is a landmark.
    let mut taken: Vec<Vec3> = field
        .landmarks
        .iter()
        .map(|known| known.nominal_m)
        .collect();
    found.retain(|(at, _)| {
        let is_new = taken
            .iter()
            .all(|other| (other - at).norm() >= SAME_PLACE_M);
        if is_new {
            taken.push(*at);
        }
        is_new
    });
    found
}

/// A text whose list of symmetries has those that hold for its lines; as it is if it has another
/// mistake.
fn with_symmetries_that_hold(text: String) -> String {
    let Some(inner) = array_of(&text, "symmetry") else {
        return text;
    };
    let mut holding = ["mirror_x", "mirror_y", "turn_180"].to_vec();
    holding.retain(|name| parse(&with_list(&text, &inner, &[name])).is_ok());
    with_list(&text, &inner, &holding)
}

/// A text with a list of names at a place.
fn with_list(text: &str, at: &Range<usize>, names: &[&str]) -> String {
    let stated: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    format!(
        "{}{}{}",
        &text[..at.start],
        stated.join(", "),
        &text[at.end..]
    )
}

/// The contents of an array of the outermost object, as a range of the text between its brackets.
fn array_of(text: &str, key: &str) -> Option<Range<usize>> {
    // A string begins and ends with a quotation mark that no backslash precedes; brackets within
    // one do not count. The array opens at depth 1, right after the string that is its key.
    let (mut depth, mut string_from, mut escaped) = (0_usize, None, false);
    let (mut last_string, mut start) = ("", None);
    for (at, character) in text.char_indices() {
        if let Some(from) = string_from {
            match character {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    last_string = &text[from..at];
                    string_from = None;
                }
                _ => {}
            }
            continue;
        }
        match character {
            '"' => string_from = Some(at + 1),
            '{' | '[' => {
                if character == '[' && depth == 1 && last_string == key {
                    start = Some(at + 1);
                }
                depth += 1;
            }
            '}' | ']' => {
                depth = depth.checked_sub(1)?;
                if let Some(start) = start.filter(|_| depth == 1) {
                    return Some(start..at);
                }
            }
            _ => {}
        }
    }
    None
}

/// A length to the millimetre, m, without trailing zeros.
fn decimal(value_m: f64) -> String {
    let rounded = (1000.0 * value_m).round() / 1000.0;
    // No "-0".
    format!("{}", rounded + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::field::Landmark;

    const BOTH: Mirrored = Mirrored {
        to_other_end: true,
        to_other_side: true,
    };

    /// The lines of a badminton court inside its boundary.
    const INSIDE: [DrawnLine; 4] = [
        // Sidelines for singles, service lines, centre line.
        DrawnLine::Straight {
            from: [-6.7, 2.59],
            to: [6.7, 2.59],
        },
        DrawnLine::Straight {
            from: [5.94, -3.05],
            to: [5.94, 3.05],
        },
        DrawnLine::Straight {
            from: [1.98, -3.05],
            to: [1.98, 3.05],
        },
        DrawnLine::Straight {
            from: [1.98, 0.0],
            to: [6.7, 0.0],
        },
    ];

    fn badminton() -> FieldDraft {
        let mut draft = FieldDraft::begin("none of this name");
        let text = draft.text().replace("20", "13.4").replace("10", "6.1");
        draft.set_text(text);
        for line in INSIDE {
            draft.draw(line, BOTH);
        }
        draft
    }

    #[test]
    fn a_court_drawn_from_nothing_has_the_lines_and_landmarks_of_its_sport() {
        let mut draft = badminton();
        let (_, drawn) = draft.field().unwrap();
        let known = touchline_core::field::builtin("badminton").unwrap();
        let known = known.default_model().unwrap();
        let painted = known.lines.iter().filter(|line| line.painted).count();
        assert_eq!(drawn.lines.len(), painted);
        assert!(draft.add_landmarks() > 0);
        let (template, drawn) = draft.field().unwrap();
        assert_eq!(template.symmetry.len(), 3);
        for landmark in known
            .landmarks
            .iter()
            .filter(|known| known.nominal_m.x != 0.0)
        {
            let is_same = |own: &Landmark| (own.nominal_m - landmark.nominal_m).norm() < 1e-6;
            assert!(
                drawn.landmarks.iter().any(is_same),
                "{}",
                landmark.id.as_str()
            );
        }
        assert_eq!(draft.clone().add_landmarks(), 0, "each once");
        draft.undo();
        assert_eq!(draft.text(), badminton().text());
    }

    #[test]
    fn a_line_on_one_side_alone_ends_the_symmetry() {
        let mut draft = FieldDraft::begin("");
        let circle = DrawnLine::Circle {
            centre: [4.0, 0.0],
            radius_m: 1.5,
        };
        draft.draw(circle, Mirrored::default());
        let (template, field) = draft.field().unwrap();
        assert_eq!(field.lines.len(), 5);
        assert_eq!(
            template.symmetry,
            [touchline_core::field::Symmetry::MirrorY]
        );
    }

    #[test]
    fn a_copy_of_each_sport_takes_a_line_and_a_broken_text_takes_none() {
        for name in touchline_core::field::builtin_names() {
            let mut draft = FieldDraft::begin(name);
            let lines = draft.field().unwrap().1.lines.len();
            assert_eq!(draft.file_name(), Some(format!("my_{name}.json")));
            draft.draw(INSIDE[3], BOTH);
            assert_eq!(draft.field().unwrap().1.lines.len(), lines + 2, "{name}");
            draft.add_landmarks();
            assert!(draft.field().is_ok(), "{name}: {:?}", draft.field().err());
            draft.set_text(draft.text().replacen('[', "(", 1));
            let broken = draft.text().to_owned();
            draft.draw(INSIDE[3], BOTH);
            assert_eq!(
                (draft.field().is_err(), draft.text()),
                (true, broken.as_str())
            );
        }
    }
}
