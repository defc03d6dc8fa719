//! The templates that come with the program.

use super::{FieldError, Template};
use std::path::Path;
use std::sync::LazyLock;

/// Name and text of every built-in template, in the order in which they are listed.
const FILES: &[(&str, &str)] = &[
    ("soccer", include_str!("../../assets/fields/soccer.json")),
    ("futsal", include_str!("../../assets/fields/futsal.json")),
    ("basketball_fiba", include_str!("../../assets/fields/basketball_fiba.json")),
    ("basketball_nba", include_str!("../../assets/fields/basketball_nba.json")),
    ("basketball_ncaa", include_str!("../../assets/fields/basketball_ncaa.json")),
    ("ice_hockey_iihf", include_str!("../../assets/fields/ice_hockey_iihf.json")),
    ("ice_hockey_nhl", include_str!("../../assets/fields/ice_hockey_nhl.json")),
    ("american_football_nfl", include_str!("../../assets/fields/american_football_nfl.json")),
    ("american_football_ncaa", include_str!("../../assets/fields/american_football_ncaa.json")),
    ("tennis", include_str!("../../assets/fields/tennis.json")),
    ("volleyball", include_str!("../../assets/fields/volleyball.json")),
    ("handball", include_str!("../../assets/fields/handball.json")),
];

static TEMPLATES: LazyLock<Vec<Result<Template, FieldError>>> =
    LazyLock::new(|| FILES.iter().map(|(name, text)| Template::from_json(text, &format!("built-in {name}"))).collect());

/// The names of the built-in templates, in the order in which they are listed.
#[must_use]
pub fn builtin_names() -> Vec<&'static str> {
    FILES.iter().map(|(name, _)| *name).collect()
}

/// A built-in template.
///
/// # Errors
/// There is none of this name.
pub fn builtin(name: &str) -> Result<&'static Template, FieldError> {
    let unknown = || FieldError::UnknownTemplate { name: name.to_owned(), known: builtin_names().join(", ") };
    let index = FILES.iter().position(|(known, _)| *known == name).ok_or_else(unknown)?;
    TEMPLATES[index].as_ref().map_err(Clone::clone)
}

/// The template that a document or a user names: a built-in one, or a path ending in `.json`, taken from `folder`
/// where it is relative.
///
/// # Errors
/// There is no such template, or its file is broken.
pub fn template_named(name: &str, folder: &Path) -> Result<Template, FieldError> {
    if Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        return Template::from_file(&folder.join(name));
    }
    builtin(name).cloned()
}
