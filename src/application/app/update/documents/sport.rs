//! The sport: selects the field of the shown frame's camera.

use crate::app::App;
use crate::app::effect::Effect;
use touchline_core::field::builtin;
use touchline_documents::document::{CROWN, FieldSpec};

impl App {
    /// Number of clicks that name landmarks or lines of the shown frame's field. They would lose
    /// their meaning with another field.
    pub fn points_of_field(&self) -> usize {
        let Some((open, spec)) = self.open().zip(self.shown_field_spec()) else {
            return 0;
        };
        let frames = open
            .document
            .frames
            .iter()
            .filter(|frame| open.document.field_of(frame).template == spec.template);
        frames
            .map(|frame| {
                frame
                    .clicks
                    .iter()
                    .filter(|click| click.target.is_some())
                    .count()
            })
            .sum()
    }

    /// Replaces the shown frame's field by that of another sport; one step of undo.
    pub(in crate::app::update) fn choose_sport(&mut self, template: &str) {
        let Ok(chosen) = builtin(template) else {
            self.session.dialog = None;
            self.session
                .warn(format!("No field is called {template:?}."));
            return;
        };
        if self.use_template(template) {
            self.settings.remember_sport(template);
            self.effects.push(Effect::SaveSettings);
            let text = format!("Field: {}.", chosen.title);
            self.session.note(text);
        }
    }

    /// Replaces the shown frame's field by that of a template; one step of undo. Returns whether it
    /// is another one.
    pub(super) fn use_template(&mut self, template: &str) -> bool {
        self.session.dialog = None;
        self.session.sport_guess = None;
        let Some(spec) = self
            .shown_field_spec()
            .filter(|spec| spec.template != template)
        else {
            return false;
        };
        // Parameters belong to a template, except the crown, which every field has.
        let crown = spec.params.get(CROWN).copied();
        let mut changed = FieldSpec {
            extra: spec.extra.clone(),
            ..FieldSpec::new(template)
        };
        changed
            .params
            .extend(crown.map(|crown_m| (CROWN.to_owned(), crown_m)));
        self.edit_field(changed)
    }
}

/// The field template that a file's name suggests, if any.
pub(super) fn guess_template(name: &str) -> Option<&'static str> {
    /// Words in names, and the templates that they suggest. Special ones precede general ones.
    const WORDS: [(&str, &str); 25] = [
        ("nba", "basketball_nba"),
        ("wnba", "basketball_nba"),
        ("ncaab", "basketball_ncaa"),
        ("ncaaf", "american_football_ncaa"),
        ("nfl", "american_football_nfl"),
        ("nhl", "ice_hockey_nhl"),
        ("iihf", "ice_hockey_iihf"),
        ("fiba", "basketball_fiba"),
        ("euroleague", "basketball_fiba"),
        ("basketball", "basketball_fiba"),
        ("basket", "basketball_fiba"),
        ("hockey", "ice_hockey_iihf"),
        ("football", "soccer"),
        ("soccer", "soccer"),
        ("fifa", "soccer"),
        ("uefa", "soccer"),
        ("futsal", "futsal"),
        ("handball", "handball"),
        ("tennis", "tennis"),
        ("badminton", "badminton"),
        ("pickleball", "pickleball"),
        ("padel", "padel"),
        ("rugby", "rugby_union"),
        ("squash", "squash"),
        ("volleyball", "volleyball"),
    ];
    // Whole words first: "wnba" contains "nba", and "nfl" would be found in "influence".
    let name = name.to_lowercase();
    let words = name.split(|c: char| !c.is_ascii_alphabetic());
    let found = WORDS
        .iter()
        .find(|(word, _)| words.clone().any(|part| part == *word));
    found
        // Without a separate word, one inside of a longer word; short ones would match by accident.
        .or_else(|| {
            WORDS
                .iter()
                .find(|(word, _)| word.len() > 5 && words.clone().any(|part| part.contains(word)))
        })
        .map(|(_, field)| *field)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_tells_the_sport_by_its_words() {
        assert_eq!(
            guess_template("NBA_2019_finals_g1.mp4"),
            Some("basketball_nba")
        );
        assert_eq!(
            guess_template("final-icehockey.mkv"),
            Some("ice_hockey_iihf")
        );
        assert_eq!(
            guess_template("basketball-nba-match"),
            Some("basketball_nba")
        );
        assert_eq!(guess_template("uefa cl"), Some("soccer"));
        assert_eq!(guess_template("bernabeu.mp4"), None, "no word of it");
        assert_eq!(guess_template("0412.jpg"), None);
    }
}
