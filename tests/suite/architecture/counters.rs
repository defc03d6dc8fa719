//! How legible the sources are, in figures that may only get better: comments among code, closures
//! where functions could be, crumbs of files, long lines, and words that a newcomer from computer
//! vision does not know.

use super::growth::Source;
use std::collections::BTreeSet;
use std::fmt;
use std::iter::Sum;
use std::path::{Path, PathBuf};

/// The counts of some sources. Tests within them are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    pub files: usize,
    pub code_lines: usize,
    /// Comments within code; documentation of items is counted apart.
    pub comment_lines: usize,
    /// Local closures that have a name.
    pub named_closures: usize,
    /// Files of fewer than [`SHORT_FILE`] lines, without the `mod.rs` of rooms.
    pub short_files: usize,
    /// Lines of more than [`LONG_LINE`] characters.
    pub long_lines: usize,
    /// Functions whose name is a bare participle: `judged`, `found_near`; `found_camera` is not, as
    /// it says what it returns.
    pub participles: usize,
    /// Words of the dialect that the glossary replaces, in names and comments.
    pub dialect: usize,
}

/// Lines of a file below which it had better join its only user.
pub const SHORT_FILE: usize = 40;
/// Characters of a line that is read without moving the eyes.
pub const LONG_LINE: usize = 100;

/// Words that the glossary replaces. `hold`, `place`, `row` and `spot` are left out: they are plain
/// English too.
const DIALECT: [&str; 24] = [
    "rig",
    "rigs",
    "tie",
    "ties",
    "tied",
    "turns",
    "traces",
    "strokes",
    "sight",
    "sighting",
    "rival",
    "rivals",
    "abstained",
    "told",
    "asked",
    "carried",
    "widened",
    "bent",
    "judged",
    "snapped",
    "thinned",
    "offer",
    "nobody",
    "somebody",
];

/// Participles that do not end in `ed`.
const IRREGULAR: [&str; 14] = [
    "found", "seen", "held", "taken", "shown", "drawn", "made", "kept", "left", "told", "written",
    "said", "known", "given",
];

/// Words in `ed` that are none.
const PREPOSITIONS: [&str; 24] = [
    "across", "after", "again", "alone", "along", "apart", "around", "as", "at", "before",
    "beside", "between", "beyond", "by", "for", "from", "in", "near", "of", "on", "out", "over",
    "to", "with",
];
const NO_PARTICIPLES: [&str; 6] = ["need", "feed", "seed", "embed", "shed", "speed"];

/// A file below the workspace's folder, and its counts.
pub type Counted = (PathBuf, Counters);

impl Counters {
    /// The counts of one file.
    pub fn of_file((path, text): &Source) -> Self {
        let mut counters = Self {
            files: 1,
            ..Self::default()
        };
        counters.add_file(path, text);
        counters
    }

    fn add_file(&mut self, path: &Path, text: &str) {
        let production = text
            .split("\n#[cfg(test)]\nmod ")
            .next()
            .unwrap_or_default();
        // The `mod.rs` of a room is its table of contents, which may be short.
        let is_short = production.lines().count() < SHORT_FILE && !path.ends_with("mod.rs");
        self.short_files += usize::from(is_short);
        for line in production.lines() {
            self.add_line(line);
        }
    }

    fn add_line(&mut self, line: &str) {
        let line_length = line.chars().count();
        let trimmed = line.trim_start();
        self.long_lines += usize::from(line_length > LONG_LINE);
        self.dialect += words(line)
            .filter(|word| DIALECT.contains(&word.as_str()))
            .count();
        if trimmed.starts_with("///") || trimmed.starts_with("//!") || trimmed.is_empty() {
            return;
        }
        if trimmed.starts_with("//") {
            self.comment_lines += 1;
            return;
        }
        self.code_lines += 1;
        self.comment_lines += usize::from(trimmed.contains(" // "));
        self.named_closures += usize::from(names_a_closure(trimmed));
        self.participles += usize::from(function_name(trimmed).is_some_and(is_bare_participle));
    }

    /// Lines of code for one comment within it.
    pub const fn code_lines_per_comment(&self) -> usize {
        self.code_lines.div_ceil(if self.comment_lines == 0 {
            1
        } else {
            self.comment_lines
        })
    }

    /// Named closures among ten thousand lines of code.
    pub const fn closures_per_10_000_lines(&self) -> usize {
        self.named_closures * 10_000
            / if self.code_lines == 0 {
                1
            } else {
                self.code_lines
            }
    }
}

impl<'a> Sum<&'a Self> for Counters {
    fn sum<I: Iterator<Item = &'a Self>>(counters: I) -> Self {
        counters.fold(Self::default(), |sum, more| Self {
            files: sum.files + more.files,
            code_lines: sum.code_lines + more.code_lines,
            comment_lines: sum.comment_lines + more.comment_lines,
            named_closures: sum.named_closures + more.named_closures,
            short_files: sum.short_files + more.short_files,
            long_lines: sum.long_lines + more.long_lines,
            participles: sum.participles + more.participles,
            dialect: sum.dialect + more.dialect,
        })
    }
}

impl fmt::Display for Counters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} files, {} lines of code, {} a comment, {} closures in 10,000 lines, {} files under {SHORT_FILE} lines, \
             {} lines over {LONG_LINE} characters, {} functions named by a bare participle, {} words of dialect",
            self.files,
            self.code_lines,
            self.code_lines_per_comment(),
            self.closures_per_10_000_lines(),
            self.short_files,
            self.long_lines,
            self.participles,
            self.dialect,
        )
    }
}

/// Whether a line is `let name = |…|`.
fn names_a_closure(line: &str) -> bool {
    let Some((_, value)) = line
        .strip_prefix("let ")
        .and_then(|rest| rest.split_once(" = "))
    else {
        return false;
    };
    let value = value
        .trim_start_matches("move ")
        .trim_start_matches("&mut ")
        .trim_start_matches('&');
    value.starts_with('|')
}

/// The name of the function that a line begins.
fn function_name(line: &str) -> Option<&str> {
    let (before, after) = line.split_once("fn ")?;
    let is_declared = before.split_whitespace().all(|word| {
        word.starts_with("pub")
            || word.starts_with("in ")
            || ["const", "async", "unsafe", "crate::app)"].contains(&word)
    });
    let end = after
        .find(|letter: char| !letter.is_alphanumeric() && letter != '_')
        .unwrap_or(after.len());
    Some(&after[..end]).filter(|name| is_declared && !name.is_empty())
}

/// Whether a name is a participle, alone or with a preposition after it.
fn is_bare_participle(name: &str) -> bool {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default();
    let is_regular = first.len() > 3 && first.ends_with("ed") && !NO_PARTICIPLES.contains(&first);
    let is_bare = words
        .next()
        .is_none_or(|second| PREPOSITIONS.contains(&second));
    is_bare && (is_regular || IRREGULAR.contains(&first))
}

/// The words of a line, in small letters: a name of several words is several.
fn words(line: &str) -> impl Iterator<Item = String> {
    let mut separated = String::with_capacity(line.len() + 16);
    let mut was_small = false;
    for letter in line.chars() {
        if was_small && letter.is_uppercase() {
            separated.push(' ');
        }
        was_small = letter.is_lowercase();
        separated.extend(letter.to_lowercase());
    }
    let words: Vec<String> = separated
        .split(|letter: char| !letter.is_alphabetic())
        .map(str::to_owned)
        .collect();
    words.into_iter().filter(|word| !word.is_empty())
}

/// The files that hold most of what is counted by `count`, the worst first.
pub fn worst(files: &[Counted], count: fn(&Counters) -> usize, most: usize) -> String {
    let counted = files
        .iter()
        .map(|(path, counters)| (count(counters), path.display().to_string()));
    let by_count: BTreeSet<(usize, String)> = counted.collect();
    let lines = by_count
        .iter()
        .rev()
        .take(most)
        .map(|(count, file)| format!("{count} {file}"));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_counter_counts_what_it_says() {
        let text = "//! A room.\n\nfn judged() {\n    // Why.\n    let near = |x: f64| x < 1.0;\n    let far = 3; // so\n}\n\
                    \npub(crate) const fn seed_of(rig: TiedFrames) {}\n\nfn found_camera() {}\n\n#[cfg(test)]\nmod tests {\n    fn found() {}\n}\n";
        let counters = Counters::of_file(&("a.rs".into(), text.to_owned()));
        let expected = Counters {
            files: 1,
            code_lines: 6,
            comment_lines: 2,
            named_closures: 1,
            short_files: 1,
            long_lines: 0,
            participles: 1,
            // judged, rig, tied.
            dialect: 3,
        };
        assert_eq!(counters, expected);
        let twice: Counters = [counters, counters].iter().sum();
        assert_eq!(format!("{twice}").split(' ').next(), Some("2"));
        assert_eq!((twice.code_lines, twice.dialect), (12, 6));
    }
}
