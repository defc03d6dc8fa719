//! From the text of a season file to its matches.
//!
//! The text is read into types that mirror the TOML (`text.rs`), and checked after that: names,
//! paths, fields and numbers. A mistake is reported with the line in which it stands.

use super::text::{MatchText, OptionsText, SeasonText, VenueText};
use super::{Match, Season, SeasonError, SeasonMistake, ShardOptions, is_folder_name};
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use toml::Spanned;
use touchline_core::files::folder_of;
use touchline_documents::document::FieldSpec;

/// The field of a match without a venue.
const USUAL_FIELD: &str = "soccer";

/// Numbers of frames from which cameras may be found.
const LOOK_AT: RangeInclusive<usize> = 3..=300;

/// Lengths of a shard that are allowed, s.
const WINDOW_S: RangeInclusive<f64> = 1.0..=3600.0;

/// Numbers of images that a shard may have.
const IMAGES: RangeInclusive<usize> = 1..=100_000;

/// A season file while it is read.
pub(super) struct SeasonReader<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl SeasonReader<'_> {
    /// The season that the file describes.
    pub(super) fn season(&self) -> Result<Season, SeasonError> {
        let SeasonText {
            options,
            venues,
            matches,
        } = self.parse()?;
        let usual = self.options(ShardOptions::default(), &options)?;
        let fields = self.fields_of_venues(venues)?;
        let mut season = Season {
            matches: Vec::with_capacity(matches.len()),
        };
        let mut lines = Lines::default();
        for text in matches {
            let found = self.read_match(text, usual, &fields)?;
            self.refuse_repetition(&found, &mut lines)?;
            season.matches.push(found);
        }
        if season.matches.is_empty() {
            return Err(self.at_line(1, SeasonMistake::NoMatch));
        }
        Ok(season)
    }

    fn parse(&self) -> Result<SeasonText, SeasonError> {
        toml::from_str(self.text).map_err(|error| {
            // A message of the parser may have several lines; all messages here have one.
            let span = error.span().unwrap_or(0..0);
            let message = error.message().lines().collect::<Vec<_>>().join("; ");
            self.mistake(&span, SeasonMistake::Toml(message))
        })
    }

    fn read_match(
        &self,
        text: MatchText,
        usual: ShardOptions,
        fields: &BTreeMap<String, FieldSpec>,
    ) -> Result<Match, SeasonError> {
        let frames = self.existing(&text.frames)?;
        // A mistake in the name is reported at the line of the name, or of the frames that it is
        // taken from. The same line stands for the match in later messages.
        let (name, span) = if let Some(name) = text.name {
            (name.get_ref().clone(), name.span())
        } else {
            // What stands behind a dot in the name of a folder is no ending.
            let name = if frames.is_dir() {
                frames.file_name()
            } else {
                frames.file_stem()
            };
            let name = name.unwrap_or_default().to_string_lossy().into_owned();
            (name, text.frames.span())
        };
        if !is_folder_name(&name) {
            return Err(self.mistake(&span, SeasonMistake::Name { name }));
        }
        let field = match &text.venue {
            None => FieldSpec::new(USUAL_FIELD),
            Some(venue) => fields.get(venue.get_ref()).cloned().ok_or_else(|| {
                let name = venue.get_ref().clone();
                self.mistake(&venue.span(), SeasonMistake::UnknownVenue { name })
            })?,
        };
        let project = text.project.map(|path| self.existing(&path)).transpose()?;
        if let Some(forest) = &text.forest
            && project.is_none()
        {
            return Err(self.mistake(&forest.span(), SeasonMistake::ForestAlone));
        }
        Ok(Match {
            name,
            line: self.line_of(&span),
            frames,
            field,
            project,
            forest: text.forest.map(|path| self.existing(&path)).transpose()?,
            options: self.options(usual, &text.options)?,
        })
    }

    /// Refuses a match with the name or the frames of an earlier one. Names that differ in case
    /// alone are one folder on some systems.
    fn refuse_repetition(&self, found: &Match, lines: &mut Lines) -> Result<(), SeasonError> {
        if let Some(other) = lines.of_name.insert(found.name.to_lowercase(), found.line) {
            let name = found.name.clone();
            return Err(self.at_line(found.line, SeasonMistake::SameName { name, other }));
        }
        // Two paths may lead to one video. A path that cannot be resolved is compared as it is
        // written.
        let real = found.frames.canonicalize();
        let real = real.unwrap_or_else(|_| found.frames.clone());
        if let Some(other) = lines.of_frames.insert(real, found.line) {
            let frames = found.frames.clone();
            return Err(self.at_line(found.line, SeasonMistake::SameFrames { frames, other }));
        }
        Ok(())
    }

    fn fields_of_venues(
        &self,
        venues: Vec<VenueText>,
    ) -> Result<BTreeMap<String, FieldSpec>, SeasonError> {
        let mut fields = BTreeMap::new();
        for venue in venues {
            let spec = FieldSpec::with_params(venue.field.get_ref(), venue.set);
            if spec.is_file() {
                let template = spec.template;
                let mistake = SeasonMistake::OwnTemplate { template };
                return Err(self.mistake(&venue.field.span(), mistake));
            }
            // The field is built once here and dropped: a wrong parameter is reported with its
            // line, not by a shard on another machine.
            spec.model(folder_of(self.path))
                .map_err(|error| self.mistake(&venue.field.span(), error.into()))?;
            let name = venue.name.get_ref().clone();
            if fields.insert(name.clone(), spec).is_some() {
                let mistake = SeasonMistake::SameVenue { name };
                return Err(self.mistake(&venue.name.span(), mistake));
            }
        }
        Ok(fields)
    }

    /// The usual options, with those that a text states in their place.
    fn options(
        &self,
        usual: ShardOptions,
        text: &OptionsText,
    ) -> Result<ShardOptions, SeasonError> {
        let mut options = usual;
        if let Some(look_at) = &text.look_at {
            options.look_at = self.count_within("look_at", look_at, &LOOK_AT)?;
        }
        if let Some(images) = &text.images {
            options.images = self.count_within("images", images, &IMAGES)?;
        }
        if let Some(window_s) = &text.window_s {
            options.window_s = *window_s.get_ref();
            if !WINDOW_S.contains(&options.window_s) {
                let mistake = SeasonMistake::Range {
                    option: "window_s",
                    found: options.window_s,
                    least: *WINDOW_S.start(),
                    most: *WINDOW_S.end(),
                };
                return Err(self.mistake(&window_s.span(), mistake));
            }
        }
        Ok(options)
    }

    fn count_within(
        &self,
        option: &'static str,
        count: &Spanned<usize>,
        range: &RangeInclusive<usize>,
    ) -> Result<usize, SeasonError> {
        let found = *count.get_ref();
        if range.contains(&found) {
            return Ok(found);
        }
        let mistake = SeasonMistake::Range {
            option,
            found: found as f64,
            least: *range.start() as f64,
            most: *range.end() as f64,
        };
        Err(self.mistake(&count.span(), mistake))
    }

    /// A path of the file, from its folder, of something that exists.
    fn existing(&self, text: &Spanned<String>) -> Result<PathBuf, SeasonError> {
        let path = folder_of(self.path).join(text.get_ref());
        if path.exists() {
            return Ok(path);
        }
        Err(self.mistake(&text.span(), SeasonMistake::Missing { path }))
    }

    fn mistake(&self, span: &Range<usize>, mistake: SeasonMistake) -> SeasonError {
        self.at_line(self.line_of(span), mistake)
    }

    fn at_line(&self, line: usize, mistake: SeasonMistake) -> SeasonError {
        SeasonError::Line {
            path: self.path.to_path_buf(),
            line,
            mistake: Box::new(mistake),
        }
    }

    fn line_of(&self, span: &Range<usize>) -> usize {
        // A span that does not fit the text, which the parser never gives, counts as the first
        // line.
        let before = self.text.get(..span.start).unwrap_or_default();
        1 + before.matches('\n').count()
    }
}

/// The lines of matches that were read.
#[derive(Default)]
struct Lines {
    of_name: BTreeMap<String, usize>,
    of_frames: BTreeMap<PathBuf, usize>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// What is said of a season file beside two videos, behind the file's path.
    fn refusal(text: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        for video in ["a.mp4", "b.mp4"] {
            fs::write(folder.path().join(video), "video").unwrap();
        }
        let path = folder.path().join("season.toml");
        fs::write(&path, text).unwrap();
        let line = Season::read(&path).unwrap_err().to_string();
        assert!(!line.contains('\n'), "{line}");
        let folder = format!("{}/", folder.path().display());
        line.replace(&folder, "").replace("season.toml, ", "")
    }

    #[test]
    fn every_mistake_is_one_line_with_its_line() {
        let a = "[[match]]\nvideo = 'a.mp4'\n";
        for (text, said) in [
            (
                format!("{a}{a}"),
                "line 4: the match \"a\" has the name of the one in line 2",
            ),
            (
                format!("{a}{a}name = 'b'"),
                "line 5: a.mp4 is the match of line 2 already",
            ),
            (
                format!("{a}[[match]]\nname='A'\nvideo='b.mp4'"),
                "line 4: the match \"A\" has the name of the one in line 2",
            ),
            (
                "[[match]]\nvideo = 'c.mp4'".to_owned(),
                "line 2: there is no c.mp4",
            ),
            (
                "[[match]]\nvideo = 'a.mp4\n".to_owned(),
                "line 2: invalid literal string",
            ),
            (
                format!("{a}venu = 'x'"),
                "line 3: unknown field `venu`, expected one of",
            ),
            (
                format!("{a}venue = 'x'"),
                "line 3: no [[venue]] has the name \"x\"",
            ),
            (
                format!("{a}name = '../x'"),
                "line 3: \"../x\" cannot be the name of a match",
            ),
            (
                format!("{a}name = 'Queue.json'"),
                "line 3: \"Queue.json\" cannot be the name of a match",
            ),
            (
                format!("{a}forest = 'b.mp4'"),
                "line 3: a forest needs the project",
            ),
            (
                format!("{a}options = {{ window_s = 0.5 }}"),
                "line 3: window_s is 0.5; give a number from 1 to 3600",
            ),
            (
                format!("[options]\nlook_at = 2\n{a}"),
                "line 2: look_at is 2; give a number from 3 to 300",
            ),
            (
                format!("[[venue]]\nname = 'x'\nfield = 'cricket'\n{a}"),
                "line 3: no field template is named",
            ),
            (
                format!("[[venue]]\nname = 'x'\nfield = 'my.json'\n{a}"),
                "line 3: my.json: a venue takes the templates",
            ),
            ("\n".to_owned(), "line 1: the file names no match"),
        ] {
            let found = refusal(&text);
            assert!(found.starts_with(said), "{text}\n{found}");
        }
    }
}
