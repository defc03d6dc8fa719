//! Reading and validating a template file.

use super::build::{check_distinct, check_symmetry};
use super::file::{FORMAT, Header, TemplateFile, VERSION};
use super::read::read_parts;
use super::{FieldError, Template};
use crate::files::{plain, read_named_text};
use std::collections::BTreeMap;
use std::path::Path;

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
        let place = path.display().to_string();
        // Reading would refuse a folder as well, but without saying what to give.
        if path.is_dir() {
            return Err(FieldError::Unreadable {
                place,
                problem: "it is a folder; give the template's JSON file".to_owned(),
            });
        }
        match read_named_text(path, MAX_BYTES) {
            Ok(text) => Self::from_json(&text, &place),
            Err(error) => Err(FieldError::Unreadable {
                place,
                problem: error.to_string(),
            }),
        }
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

/// The error of a text that is no field template; `problem` may quote the text.
fn json_error(place: &str, problem: &str) -> FieldError {
    FieldError::Json {
        place: place.to_owned(),
        problem: plain(problem),
    }
}
