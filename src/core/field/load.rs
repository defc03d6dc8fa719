//! Reading and validating a template file.

use super::build::{check_distinct, check_symmetry};
use super::file::{FORMAT, Header, TemplateFile, VERSION};
use super::read::read_parts;
use super::{FieldError, Template};
use crate::files::{plain, read_named_text};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;
use touchline_assets::FIELDS;

/// The maximum size of a template file, bytes; the program's own have 20 KB.
const MAX_BYTES: u64 = 16 << 20;

impl Template {
    /// Reads and checks a template; `place` is its name in errors, usually the file's path.
    ///
    /// # Errors
    /// What is wrong, where in the file, and what is allowed there. The field is built with the
    /// default parameters and with each of them at its smallest and largest value, so that an
    /// accepted template can be built for a venue.
    pub fn from_json(text: &str, place: &str) -> Result<Self, FieldError> {
        if text.trim().is_empty() {
            let problem = "the file is empty; a field template is a JSON object";
            return Err(json_error(place, problem));
        }
        // The text is parsed twice. The header comes first, because a newer version may have keys
        // that the rest refuses, and the message has to be that of the version.
        let header: Header =
            serde_json::from_str(text).map_err(|error| json_error(place, &error.to_string()))?;
        if header.format.as_deref() != Some(FORMAT) {
            let problem = format!("not a field template: it has no \"format\": {FORMAT:?}");
            return Err(json_error(place, &problem));
        }
        if let Some(version) = header.version.filter(|version| *version > VERSION) {
            return Err(FieldError::NewerVersion {
                place: place.to_owned(),
                version,
                known: VERSION,
            });
        }
        let file: TemplateFile =
            serde_json::from_str(text).map_err(|error| json_error(place, &error.to_string()))?;
        let template = read_parts(file, place)?;
        template.check()?;
        Ok(template)
    }

    /// Reads and checks a template's file.
    ///
    /// # Errors
    /// As [`Template::from_json`], or the file cannot be read.
    pub fn from_file(path: &Path) -> Result<Self, FieldError> {
        Self::from_json(&template_text(path)?, &path.display().to_string())
    }

    /// Builds the template at the extremes of its parameters, where it is most likely to be
    /// invalid.
    fn check(&self) -> Result<(), FieldError> {
        // One parameter at a time: all combinations of the extremes would be 2ⁿ fields. So one
        // that is wrong only for a pair of extremes is found when that field is built.
        let model = self.default_model()?;
        check_distinct(self, &model)?;
        check_symmetry(self, &model)?;
        for param in &self.params {
            for value in [param.min, param.max] {
                self.model(&BTreeMap::from([(param.name.clone(), value)]), 0.0)?;
            }
        }
        Ok(())
    }
}

/// The text of a template's file.
///
/// # Errors
/// The file cannot be read.
pub fn template_text(path: &Path) -> Result<String, FieldError> {
    // Reading would refuse a folder as well, but without saying what to give.
    // A template is small: what is larger is another file.
    let text = if path.is_dir() {
        Err("it is a folder; give the template's JSON file".to_owned())
    } else {
        read_named_text(path, MAX_BYTES).map_err(|error| error.to_string())
    };
    text.map_err(|problem| FieldError::Unreadable {
        place: path.display().to_string(),
        problem,
    })
}

/// The error of a text that is no field template; `problem` may quote the text.
fn json_error(place: &str, problem: &str) -> FieldError {
    FieldError::Json {
        place: place.to_owned(),
        problem: plain(problem),
    }
}

/// The parsed templates in the order of [`FIELDS`].
static TEMPLATES: LazyLock<Vec<Result<Template, FieldError>>> = LazyLock::new(|| {
    FIELDS
        .iter()
        .map(|(name, text)| Template::from_json(text, &format!("built-in {name}")))
        .collect()
});

/// The names of the built-in templates, in the order in which they are listed.
pub fn builtin_names() -> Vec<&'static str> {
    FIELDS.iter().map(|(name, _)| *name).collect()
}

/// The file of a built-in template as text, to make one of its own of it.
///
/// # Errors
/// There is none of this name.
pub fn builtin_text(name: &str) -> Result<&'static str, FieldError> {
    let known = FIELDS.iter().find(|(known, _)| *known == name);
    known
        .map(|(_, text)| *text)
        .ok_or_else(|| unknown_template(name))
}

/// The error of a name that no built-in template has.
fn unknown_template(name: &str) -> FieldError {
    FieldError::UnknownTemplate {
        name: name.to_owned(),
        known: builtin_names().join(", "),
    }
}

/// A built-in template.
///
/// # Errors
/// There is none of this name.
pub fn builtin(name: &str) -> Result<&'static Template, FieldError> {
    let index = FIELDS
        .iter()
        .position(|(known, _)| *known == name)
        .ok_or_else(|| unknown_template(name))?;
    TEMPLATES[index].as_ref().map_err(Clone::clone)
}

/// The template that a document or a user names: a built-in one, or a path ending in `.json`, taken
/// from `folder` where it is relative.
///
/// # Errors
/// There is no such template, or its file is broken.
pub fn template_named(name: &str, folder: &Path) -> Result<Template, FieldError> {
    if Path::new(name)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
    {
        return Template::from_file(&folder.join(name));
    }
    builtin(name).cloned()
}
