//! Files of other programs that are known and not imported as they are, with what to do instead.

use crate::exchange::files::{ending_of, text};
use crate::exchange::syntax::node::parse;

/// A kind of file that is known and has no format of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lookalike {
    /// Points that a model found.
    ModelPoints,
    /// Control points of a survey, with names of their own.
    ControlPoints,
    /// A table whose fields are not separated by commas.
    OtherSeparator,
}

impl Lookalike {
    /// What a file is; none where it is none of these.
    pub fn from_file(name: &str, bytes: &[u8]) -> Option<Self> {
        match ending_of(name).as_str() {
            "csv" => Self::from_table(bytes),
            "json" => Self::from_json(bytes),
            _ => None,
        }
    }

    fn from_table(bytes: &[u8]) -> Option<Self> {
        let first = text(bytes).ok()?.lines().next()?;
        let is_other = !first.contains(',') && first.contains([';', '\t']);
        is_other.then_some(Self::OtherSeparator)
    }

    fn from_json(bytes: &[u8]) -> Option<Self> {
        let value = parse(bytes).ok()?;
        let object = value.as_object()?;
        if object.contains_key("kp") {
            return Some(Self::ModelPoints);
        }
        let is_survey = value.pointer("/capture/annotations").is_some()
            || (object.contains_key("map_id") && object.contains_key("points"));
        is_survey.then_some(Self::ControlPoints)
    }

    /// What to do instead, as the end of a message.
    pub const fn hint(self) -> &'static str {
        match self {
            Self::ModelPoints => {
                "these are points that a model found: give --points PATH --layout pnlcalib in \
                 place of it"
            }
            Self::ControlPoints => {
                "control points of a survey are on no field: write them as landmarks, with one \
                 line or more, into a template (`touchline fields badminton --template my.json` \
                 writes one to change) and their pixels into a table frame,label,x,y; then import \
                 the table with --field my.json --each-own-camera"
            }
            Self::OtherSeparator => "write the table with commas between the fields",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_without_a_format_of_their_own_are_known() {
        for (name, text, wanted) in [
            (
                "1.json",
                r#"{"kp": {}, "lines": {}}"#,
                Some(Lookalike::ModelPoints),
            ),
            (
                "1.json",
                r#"{"capture": {"annotations": []}}"#,
                Some(Lookalike::ControlPoints),
            ),
            (
                "1.csv",
                "frame;label;x;y\n",
                Some(Lookalike::OtherSeparator),
            ),
            ("1.csv", "a,b\n1,2\n", None),
            ("1.json", "{}", None),
            ("1.json", "[1", None),
        ] {
            assert_eq!(
                Lookalike::from_file(name, text.as_bytes()),
                wanted,
                "{text}"
            );
        }
    }
}
