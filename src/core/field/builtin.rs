//! The templates that come with the program.

use super::{FieldError, Template};
use std::path::Path;
use std::sync::LazyLock;
use touchline_assets::FIELDS;

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

/// A built-in template.
///
/// # Errors
/// There is none of this name.
pub fn builtin(name: &str) -> Result<&'static Template, FieldError> {
    let index = FIELDS
        .iter()
        .position(|(known, _)| *known == name)
        .ok_or_else(|| FieldError::UnknownTemplate {
            name: name.to_owned(),
            known: builtin_names().join(", "),
        })?;
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
