//! Which field a document is of, and where its size comes from: venues differ within what the rules
//! allow, and a wrong size looks like a wrong camera.

use super::adapters::finite;
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use touchline_core::field::{FieldError, FieldModel, Template, builtin, template_named};

/// The parameter that every template has: the height of the middle above the touchlines, m.
pub const CROWN: &str = "crown_m";

/// The parameters that are the size of a field.
const SIZE: [&str; 2] = ["length_m", "width_m"];

/// Which field: a template and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FieldSpec {
    /// The template's name: `soccer`.
    pub template: String,
    /// Its parameters by name, such as `length_m` and `crown_m`; absent ones take the template's
    /// defaults.
    #[serde(default, serialize_with = "finite")]
    pub params: BTreeMap<String, f64>,
    /// Where its size comes from: `assumed` (also where it is absent), `confirmed`, `fitted`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<FieldSize>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Where the size of a field comes from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// A template with its defaults.
    pub fn new(template: &str) -> Self {
        Self {
            template: template.to_owned(),
            params: BTreeMap::new(),
            size: None,
            extra: Extra::new(),
        }
    }

    /// A template with parameters that a person states. With its length or width among them, its
    /// size is known and not to be fitted.
    pub fn with_params(template: &str, params: BTreeMap<String, f64>) -> Self {
        let is_size_stated = SIZE.iter().any(|name| params.contains_key(*name));
        Self {
            size: is_size_stated.then_some(FieldSize::Confirmed),
            params,
            ..Self::new(template)
        }
    }

    /// Whether the template is the user's own file, not a built-in one.
    pub fn is_file(&self) -> bool {
        Path::new(&self.template)
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
    }

    /// The same with the path of a template file, given relative to the working directory, made
    /// absolute.
    ///
    /// # Errors
    /// There is no working directory, or its path is not UTF-8.
    pub fn with_absolute_path(mut self) -> io::Result<Self> {
        if self.is_file() {
            let path = std::path::absolute(&self.template)?;
            let path = path.to_str().ok_or_else(|| {
                let why = "the template's path is not UTF-8; rename it";
                io::Error::new(io::ErrorKind::InvalidInput, why)
            })?;
            path.clone_into(&mut self.template);
        }
        Ok(self)
    }

    /// The height of the middle above the touchlines, m.
    pub fn crown_m(&self) -> f64 {
        self.params.get(CROWN).copied().unwrap_or(0.0)
    }

    /// Sets the crown; a flat field without the key stays without it.
    pub fn set_crown_m(&mut self, crown_m: f64) {
        if crown_m != self.crown_m() {
            self.params.insert(CROWN.to_owned(), crown_m);
        }
    }

    /// The field with its parameters filled in; `folder` is the document's, for a template of the
    /// user's own.
    ///
    /// # Errors
    /// There is no such template, or it does not take a parameter or its value.
    pub fn model(&self, folder: &Path) -> Result<FieldModel, FieldError> {
        self.model_of_template(&self.template(folder)?)
    }

    /// The field from its template, which has already been read.
    ///
    /// # Errors
    /// The template does not take a parameter or its value.
    pub fn model_of_template(&self, template: &Template) -> Result<FieldModel, FieldError> {
        let mut params = self.params.clone();
        let crown_m = params.remove(CROWN).unwrap_or(0.0);
        template.model(&params, crown_m)
    }

    /// Its template; `folder` is the document's.
    ///
    /// # Errors
    /// There is no such template.
    pub fn template(&self, folder: &Path) -> Result<Template, FieldError> {
        template_named(&self.template, folder)
    }

    /// The source of its size; `assumed` if the document does not state it.
    pub fn size(&self) -> &FieldSize {
        self.size.as_ref().unwrap_or(&FieldSize::Assumed)
    }

    /// Whether a person or a file states its size, so that it is not to be fitted.
    pub fn is_size_stated(&self) -> bool {
        !matches!(self.size(), FieldSize::Assumed | FieldSize::Fitted)
    }

    /// Its length and width in words, where they are assumed although venues differ: “105 × 68 m”.
    /// None for a size that is known or that the rules leave no choice of, and for a template of
    /// the user's own.
    pub fn assumed_size(&self) -> Option<String> {
        if *self.size() != FieldSize::Assumed {
            return None;
        }
        // The rules of a user's own template are not known, and where both sides are prescribed
        // there is nothing to confirm.
        let template = builtin(&self.template).ok()?;
        let params = SIZE.map(|name| template.params.iter().find(|param| param.name == name));
        if !params.iter().flatten().any(|param| param.is_open()) {
            return None;
        }
        // Rounded to centimetres, for people; a template without one of the two parameters has “?”.
        let [length, width] = params.map(|param| {
            let value = param.map(|param| {
                self.params
                    .get(&param.name)
                    .copied()
                    .unwrap_or(param.default)
            });
            value.map_or_else(
                || "?".to_owned(),
                |metres| format!("{}", (metres * 100.0).round() / 100.0),
            )
        });
        Some(format!("{length} × {width} m"))
    }

    /// Whether another field is equal in everything but the source of its size.
    pub fn is_same_field(&self, other: &Self) -> bool {
        self.template == other.template && self.params == other.params
    }

    /// The message where the size is assumed.
    pub fn describe_assumed_size(&self) -> Option<String> {
        self.assumed_size()
            .map(|size| format!("Field size {size} is assumed."))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_assumed_until_it_is_stated_where_the_rules_leave_a_choice() {
        let mut soccer = FieldSpec::new("soccer");
        assert_eq!(
            soccer.describe_assumed_size().unwrap(),
            "Field size 105 × 68 m is assumed."
        );
        soccer.params.insert("width_m".to_owned(), 66.5);
        assert_eq!(soccer.assumed_size().unwrap(), "105 × 66.5 m");
        for known in [
            FieldSize::Confirmed,
            FieldSize::Fitted,
            FieldSize::Other("measured".into()),
        ] {
            soccer.size = Some(known);
            assert_eq!(soccer.assumed_size(), None);
        }
        assert_eq!(
            FieldSpec::new("tennis").assumed_size(),
            None,
            "a tennis court is a tennis court"
        );
        assert_eq!(FieldSpec::new("mine.json").assumed_size(), None);
        for (stated, assumed) in [("length_m", None), (CROWN, Some("105 × 68 m"))] {
            let params = BTreeMap::from([(stated.to_owned(), 105.0)]);
            let spec = FieldSpec::with_params("soccer", params);
            assert_eq!(spec.assumed_size().as_deref(), assumed, "{stated}");
        }
    }

    #[test]
    fn the_state_is_written_by_name_and_what_is_not_known_is_kept() {
        let read = |json: &str| serde_json::from_str::<FieldSpec>(json).unwrap();
        assert_eq!(read(r#"{"template": "soccer"}"#).size, None);
        let fitted = read(r#"{"template":"soccer","params":{},"size":"fitted"}"#);
        assert_eq!(*fitted.size(), FieldSize::Fitted);
        for json in [
            r#"{"template":"soccer","params":{},"size":"fitted"}"#,
            r#"{"template":"soccer","params":{},"size":[7]}"#,
        ] {
            assert_eq!(serde_json::to_string(&read(json)).unwrap(), json);
        }
    }
}
