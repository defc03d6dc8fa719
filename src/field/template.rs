//! A sport's field with its parameters open: read from JSON, checked, and filled in for a venue.

use super::build;
use super::file::{FORMAT, Header, TemplateFile, VERSION};
use super::parts::{LandmarkPart, LinePart};
use super::read::read_parts;
use super::{Expression, FieldError, FieldModel, Symmetry};
use std::collections::BTreeMap;
use std::path::Path;

/// A crown higher than this is a mistake: pitches are 0.05 to 0.25 m higher in the middle.
pub const MAX_CROWN_M: f64 = 2.0;

/// A sport's field: named landmarks and lines whose places are expressions over parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// What documents call it: "soccer".
    pub name: String,
    /// What people read: "Soccer (IFAB)".
    pub title: String,
    /// What to know before trusting it.
    pub notes: Vec<String>,
    /// What differs between venues, in the template's order.
    pub params: Vec<Param>,
    /// What the rules fix, in the template's order.
    pub dimensions: Vec<Dimension>,
    /// The symmetries that the template promises; checked when it is read.
    pub symmetry: Vec<Symmetry>,
    pub(super) extent_m: [Expression; 2],
    pub(super) landmarks: Vec<LandmarkPart>,
    pub(super) lines: Vec<LinePart>,
    pub(super) place: String,
}

/// Something that differs between venues, such as `length_m`.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name in documents; the unit is its ending.
    pub name: String,
    /// What people read: "Length".
    pub label: String,
    /// Always "m".
    pub unit: String,
    /// Where nothing is said.
    pub default: f64,
    /// The smallest that the rules allow.
    pub min: f64,
    /// The largest.
    pub max: f64,
    /// Where the range comes from.
    pub source: String,
}

/// Something that the rules fix, such as `penalty_area_depth_m`; it may follow from parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Its name in expressions.
    pub name: String,
    /// Its value, over parameters and the dimensions before it.
    pub value: Expression,
    /// Where it comes from.
    pub source: String,
}

impl Template {
    /// Reads and checks a template; `place` is what its errors call it, usually the file's path.
    ///
    /// # Errors
    /// What is wrong, where in the file, and what could stand there. The template is tried with its default parameters
    /// and with each of them at its smallest and largest value, so one that is accepted can be filled in.
    pub fn from_json(text: &str, place: &str) -> Result<Self, FieldError> {
        let json = |problem: String| FieldError::Json { place: place.to_owned(), problem };
        if text.trim().is_empty() {
            return Err(json("the file is empty; a field template is a JSON object".to_owned()));
        }
        let header: Header = serde_json::from_str(text).map_err(|error| json(error.to_string()))?;
        if header.format.as_deref() != Some(FORMAT) {
            return Err(json(format!("not a field template: it has no \"format\": {FORMAT:?}")));
        }
        if let Some(version) = header.version.filter(|version| *version > VERSION) {
            return Err(FieldError::NewerVersion { place: place.to_owned(), version, known: VERSION });
        }
        let file: TemplateFile = serde_json::from_str(text).map_err(|error| json(error.to_string()))?;
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
        let unreadable = |problem: String| FieldError::Unreadable { place: place.clone(), problem };
        if path.is_dir() {
            return Err(unreadable("it is a folder; give the template's JSON file".to_owned()));
        }
        let bytes = std::fs::read(path).map_err(|error| unreadable(error.to_string()))?;
        let text = String::from_utf8(bytes)
            .map_err(|error| unreadable(format!("it is not UTF-8 text (byte {})", error.utf8_error().valid_up_to())))?;
        Self::from_json(&text, &place)
    }

    /// The parameters where nothing is said.
    #[must_use]
    pub fn default_params(&self) -> BTreeMap<String, f64> {
        self.params.iter().map(|param| (param.name.clone(), param.default)).collect()
    }

    /// The field of a venue: parameters that are not given take their defaults.
    ///
    /// `crown_m` is how much the middle is higher than the touchlines, m.
    ///
    /// # Errors
    /// A parameter that the template does not take or whose value the rules do not allow, or an impossible crown.
    pub fn model(&self, params: &BTreeMap<String, f64>, crown_m: f64) -> Result<FieldModel, FieldError> {
        if let Some(name) = params.keys().find(|name| !self.params.iter().any(|param| param.name == **name)) {
            return Err(FieldError::UnknownParam {
                template: self.name.clone(),
                name: name.clone(),
                known: self.params.iter().map(|param| param.name.as_str()).collect::<Vec<_>>().join(", "),
            });
        }
        if !(crown_m.abs() <= MAX_CROWN_M) {
            return Err(FieldError::CrownOutOfRange { crown_m, limit: MAX_CROWN_M });
        }
        let mut filled = self.default_params();
        for param in &self.params {
            let Some(&value) = params.get(&param.name) else { continue };
            if !(value >= param.min && value <= param.max) {
                return Err(FieldError::ParamOutOfRange {
                    template: self.name.clone(),
                    name: param.name.clone(),
                    value,
                    min: param.min,
                    max: param.max,
                    source_text: param.source.clone(),
                });
            }
            filled.insert(param.name.clone(), value);
        }
        build::model(self, filled, crown_m)
    }

    /// The field with every parameter at its default and no crown.
    ///
    /// # Errors
    /// None for a template that was read: it was tried then.
    pub fn default_model(&self) -> Result<FieldModel, FieldError> {
        self.model(&BTreeMap::new(), 0.0)
    }

    /// Tries the template where it is most likely to break.
    fn check(&self) -> Result<(), FieldError> {
        let model = self.default_model()?;
        build::check_distinct(self, &model)?;
        build::check_symmetry(self, &model)?;
        for param in &self.params {
            for value in [param.min, param.max] {
                self.model(&BTreeMap::from([(param.name.clone(), value)]), 0.0)?;
            }
        }
        Ok(())
    }
}
