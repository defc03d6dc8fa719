//! Where the size of the field comes from: venues differ within what the rules allow, and a wrong size looks like a wrong camera.

use super::{Document, FieldSpec, SolutionWarning};
use crate::field::builtin;
use crate::solve::WarningCode;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The parameters that are the size of a field.
const SIZE: [&str; 2] = ["length_m", "width_m"];

/// Where the size of a field comes from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FieldSize {
    /// Not checked: the template's usual size, or a guess.
    #[default]
    Assumed,
    /// A person knows it.
    Confirmed,
    /// It was found from clicks.
    Fitted,
    /// What another version of the program says of it.
    #[serde(untagged)]
    Other(Value),
}

impl FieldSpec {
    /// Where its size comes from; a document that says nothing assumes it.
    #[must_use]
    pub fn size(&self) -> &FieldSize {
        self.size.as_ref().unwrap_or(&FieldSize::Assumed)
    }

    /// Its length and width in words, where they are assumed although venues differ: “105 × 68 m”. None for a size that is
    /// known or that the rules leave no choice of, and for a template of the user's own.
    #[must_use]
    pub fn assumed_size(&self) -> Option<String> {
        if *self.size() != FieldSize::Assumed {
            return None;
        }
        let template = builtin(&self.template).ok()?;
        let params = SIZE.map(|name| template.params.iter().find(|param| param.name == name));
        if !params.iter().flatten().any(|param| param.min < param.max) {
            return None;
        }
        let [length, width] = params.map(|param| {
            let value = param.map(|param| self.params.get(&param.name).copied().unwrap_or(param.default));
            value.map_or_else(|| "?".to_owned(), |metres| format!("{}", (metres * 100.0).round() / 100.0))
        });
        Some(format!("{length} × {width} m"))
    }

    /// Whether another field is the same in everything but where its size comes from.
    #[must_use]
    pub fn is_same_field(&self, other: &Self) -> bool {
        self.template == other.template && self.params == other.params
    }

    /// The message where the size is assumed.
    #[must_use]
    pub fn describe_assumed_size(&self) -> Option<String> {
        self.assumed_size().map(|size| format!("Field size {size} is assumed."))
    }
}

impl Document {
    /// Says at every solved frame whose field's size is assumed that it is.
    pub(super) fn tell_assumed_sizes(&mut self) {
        let code = WarningCode::FieldAssumed.as_str();
        for index in 0..self.frames.len() {
            let told = self.field_of(&self.frames[index]).describe_assumed_size();
            let Some(told) = told.filter(|_| self.frames[index].ptz.is_some()) else { continue };
            let solution = self.frames[index].solution.get_or_insert_default();
            solution.warnings.retain(|warning| warning.code != code);
            solution.warnings.push(SolutionWarning::new(code, told));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ptz;
    use crate::document::{Camera, Frame, FramePtz};
    use crate::geometry::ImageSize;

    #[test]
    fn a_size_is_assumed_until_somebody_knows_it_where_the_rules_leave_a_choice() {
        let mut soccer = FieldSpec::new("soccer");
        assert_eq!(soccer.describe_assumed_size().unwrap(), "Field size 105 × 68 m is assumed.");
        soccer.params.insert("width_m".to_owned(), 66.5);
        assert_eq!(soccer.assumed_size().unwrap(), "105 × 66.5 m");
        for known in [FieldSize::Confirmed, FieldSize::Fitted, FieldSize::Other("measured".into())] {
            soccer.size = Some(known);
            assert_eq!(soccer.assumed_size(), None);
        }
        assert_eq!(FieldSpec::new("tennis").assumed_size(), None, "a tennis court is a tennis court");
        assert_eq!(FieldSpec::new("mine.json").assumed_size(), None);
    }

    #[test]
    fn a_dataset_says_so_at_every_solved_frame_once() {
        let size = ImageSize::new(1920, 1080);
        let mut document = Document::new(FieldSpec::new("soccer"));
        document.cameras.push(Camera::new("main".into(), size).into());
        for _ in 0..2 {
            document.frames.push(Frame::from_image("a.jpg", "main".into(), size).into());
        }
        document.frames[0].ptz = Some(FramePtz::new(Ptz::from_degrees(0.0, -10.0, 2000.0), None));
        let warnings = |document: &Document| -> Vec<Vec<String>> {
            let solutions = document.frames.iter().map(|frame| frame.solution.clone().unwrap_or_default());
            solutions.map(|solution| solution.warnings.into_iter().map(|warning| warning.code).collect()).collect()
        };
        let again = document.to_dataset().to_dataset();
        assert_eq!(warnings(&again), [vec!["field_assumed".to_owned()], vec![]]);
        assert_eq!(again.frames[0].solution.as_ref().unwrap().warnings_of_frame().count(), 0);
        document.field.size = Some(FieldSize::Confirmed);
        assert_eq!(warnings(&document.to_dataset()), [vec![], Vec::<String>::new()]);
    }

    #[test]
    fn the_state_is_written_by_name_and_what_is_not_known_is_kept() {
        let read = |json: &str| serde_json::from_str::<FieldSpec>(json).unwrap();
        assert_eq!(read(r#"{"template": "soccer"}"#).size, None);
        let fitted = read(r#"{"template":"soccer","params":{},"size":"fitted"}"#);
        assert_eq!(*fitted.size(), FieldSize::Fitted);
        for json in
            [r#"{"template":"soccer","params":{},"size":"fitted"}"#, r#"{"template":"soccer","params":{},"size":[7]}"#]
        {
            assert_eq!(serde_json::to_string(&read(json)).unwrap(), json);
        }
    }
}
