//! The file as TOML has it. Unknown keys are refused, because a misspelt option would else be
//! ignored; values whose mistakes are found later keep their places in the text (`Spanned`).

use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SeasonText {
    #[serde(default)]
    pub(super) options: OptionsText,
    #[serde(default, rename = "venue")]
    pub(super) venues: Vec<VenueText>,
    #[serde(default, rename = "match")]
    pub(super) matches: Vec<MatchText>,
}

#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OptionsText {
    pub(super) look_at: Option<Spanned<usize>>,
    pub(super) window_s: Option<Spanned<f64>>,
    pub(super) images: Option<Spanned<usize>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VenueText {
    pub(super) name: Spanned<String>,
    pub(super) field: Spanned<String>,
    #[serde(default)]
    pub(super) set: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MatchText {
    pub(super) name: Option<Spanned<String>>,
    #[serde(alias = "video")]
    pub(super) frames: Spanned<String>,
    pub(super) venue: Option<Spanned<String>>,
    pub(super) project: Option<Spanned<String>>,
    pub(super) forest: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) options: OptionsText,
}
