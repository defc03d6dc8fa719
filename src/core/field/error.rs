//! What can be wrong with a field template or its parameters.

use super::ExpressionError;
use thiserror::Error;

/// Why a field cannot be built. Each message states what is wrong, where, and how to fix it.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FieldError {
    /// No built-in template has this name, and it is not the path of a JSON file.
    #[error(
        "no field template is named {name:?}; built in are {known}; a template of your own is given as a path ending in .json"
    )]
    UnknownTemplate {
        /// The requested name.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// The file cannot be read at all.
    #[error("{place}: cannot be read: {problem}")]
    Unreadable {
        /// The file.
        place: String,
        /// What the system says.
        problem: String,
    },
    /// The file is being read in the background.
    #[error("{place}: the field template is being read")]
    BeingRead {
        /// The file.
        place: String,
    },
    /// The text is not a template's JSON.
    #[error("{place}: {problem}")]
    Json {
        /// The file.
        place: String,
        /// What is wrong, with line and column.
        problem: String,
    },
    /// Made by a newer program.
    #[error(
        "{place}: version {version} of the template format is newer than this program knows ({known}); update touchline"
    )]
    NewerVersion {
        /// The file.
        place: String,
        /// Its version.
        version: u64,
        /// The newest version known.
        known: u64,
    },
    /// A part of the template is wrong in itself.
    #[error("{place}: {part}: {problem}")]
    Invalid {
        /// The file.
        place: String,
        /// Which part: `landmark "corner_near_left"`.
        part: String,
        /// What is wrong with it.
        problem: String,
    },
    /// An expression cannot be read or has no value.
    #[error("{place}: {part}: {text:?}: {problem}")]
    Expression {
        /// The file.
        place: String,
        /// Which part: `landmark "corner_near_left", at[0]`.
        part: String,
        /// The expression as written.
        text: String,
        /// What is wrong with it.
        problem: Box<ExpressionError>,
    },
    /// The template has no such parameter.
    #[error("the field template {template:?} takes no parameter {name:?}; it takes {known}")]
    UnknownParam {
        /// The template.
        template: String,
        /// As given.
        name: String,
        /// The parameters that it has.
        known: String,
    },
    /// A parameter outside the range that the rules allow.
    #[error("{template} field: {name} = {value} is outside {min} to {max} ({source_text})")]
    ParamOutOfRange {
        /// The template.
        template: String,
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
        /// The smallest allowed.
        min: f64,
        /// The largest allowed.
        max: f64,
        /// Where the range comes from.
        source_text: String,
    },
    /// A crown that no field has.
    #[error("crown_m = {crown_m} is outside -{limit} to {limit}")]
    CrownOutOfRange {
        /// The value.
        crown_m: f64,
        /// The maximum height, m.
        limit: f64,
    },
}
