//! One entry of a template for several places: `corner_{near,far}_{left,right}` names four
//! landmarks.
//!
//! A group in braces stands for one choice: `{near,far}` (or `{n,f}`) sets `y_side` to −1 or 1,
//! `{left,right}` (or `{l,r}`) sets `x_side`, and a list of numbers sets `number`. The expressions
//! of the entry use these names. The id says which choices there are; label, code and the names of
//! landmarks repeat them in any order and spelling.

use crate::files::plain;

/// What the choices of a group in braces vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// `{left,right}`: `x_side` is −1 or 1.
    X,
    /// `{near,far}`: `y_side` is −1 or 1.
    Y,
    /// `{5,10,15}`: `number` is the one chosen.
    Number,
}

/// The maximum number of landmarks, of lines, and of variants of one id: a short text can name
/// millions.
pub const MAX_ENTRIES: usize = 2000;

/// The groups of words, in the order of the sides: −1, then 1.
const SPELLINGS: [(Axis, [&str; 2]); 6] = [
    (Axis::X, ["left", "right"]),
    (Axis::X, ["Left", "Right"]),
    (Axis::X, ["l", "r"]),
    (Axis::Y, ["near", "far"]),
    (Axis::Y, ["Near", "Far"]),
    (Axis::Y, ["n", "f"]),
];

/// A piece of a text that is split at its groups.
enum Piece<'a> {
    Text(&'a str),
    Group { axis: Axis, options: Vec<&'a str> },
}

/// One choice for every group of an id.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variant {
    choices: Vec<Choice>,
}

#[derive(Clone, Debug, PartialEq)]
struct Choice {
    axis: Axis,
    index: usize,
    count: usize,
    value: f64,
}

impl Variant {
    /// The names that expressions can use for this choice, with their values.
    pub fn names(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        self.choices.iter().map(|choice| {
            let name = match choice.axis {
                Axis::X => "x_side",
                Axis::Y => "y_side",
                Axis::Number => "number",
            };
            (name, choice.value)
        })
    }

    /// The text with every group replaced by the chosen option.
    ///
    /// # Errors
    /// An invalid group, or one that the id does not have.
    pub fn fill(&self, text: &str) -> Result<String, String> {
        pieces(text)?
            .into_iter()
            .map(|piece| match piece {
                Piece::Text(text) => Ok(text),
                // The choice of the id's group of the same kind, whatever words or numbers stand
                // for it here; a list of another length cannot repeat it.
                Piece::Group { axis, options } => self
                    .choices
                    .iter()
                    .find(|choice| choice.axis == axis && choice.count == options.len())
                    .map(|choice| options[choice.index])
                    .ok_or_else(|| {
                        format!(
                            "{text:?} has the group {{{}}}, its id has not",
                            options.join(",")
                        )
                    }),
            })
            .collect()
    }
}

/// Every variant of an id, the last group running fastest; a plain id has one.
///
/// # Errors
/// An invalid group, or two of the same kind.
pub fn variants(id: &str) -> Result<Vec<Variant>, String> {
    let mut all = vec![Variant::default()];
    for piece in pieces(id)? {
        let Piece::Group { axis, options } = piece else {
            continue;
        };
        // `all` is never empty, because a group has at least one option. Two groups of one kind
        // would give their name in expressions two values.
        if all[0].choices.iter().any(|choice| choice.axis == axis) {
            return Err(format!("{id:?} has two groups of the same kind"));
        }
        // Before the product is made, because it may not fit into memory.
        if all.len() * options.len() > MAX_ENTRIES {
            return Err(format!("it has more than {MAX_ENTRIES} variants"));
        }
        // The Cartesian product of the variants so far with the options of this group.
        let mut longer = Vec::new();
        for variant in &all {
            for (index, option) in options.iter().enumerate() {
                let value = match axis {
                    Axis::Number => option
                        .parse()
                        .map_err(|_| format!("{option:?} is not a number"))?,
                    Axis::X | Axis::Y => [-1.0, 1.0][index],
                };
                let mut choices = variant.choices.clone();
                choices.push(Choice {
                    axis,
                    index,
                    count: options.len(),
                    value,
                });
                longer.push(Variant { choices });
            }
        }
        all = longer;
    }
    Ok(all)
}

/// Splits a text at its groups; the last piece is text, which may be empty.
fn pieces(text: &str) -> Result<Vec<Piece<'_>>, String> {
    let mut pieces = Vec::new();
    let mut rest = text;
    // A closing brace without an opening one stops the search as well, and is an error.
    while let Some(open) = rest.find(['{', '}']) {
        let Some((inside, after)) = rest[open..]
            .strip_prefix('{')
            .and_then(|group| group.split_once('}'))
        else {
            return Err(format!("{text:?} has a brace without its other half"));
        };
        pieces.push(Piece::Text(&rest[..open]));
        // Words say which kind of group it is; anything but these and whole numbers is a mistake.
        let options: Vec<&str> = inside.split(',').collect();
        let spelled = SPELLINGS
            .iter()
            .find(|(_, words)| *words == options[..])
            .map(|(axis, _)| *axis);
        let numbers = options
            .iter()
            .all(|option| !option.is_empty() && option.bytes().all(|b| b.is_ascii_digit()));
        let Some(axis) = spelled.or(numbers.then_some(Axis::Number)) else {
            return Err(format!(
                "{text:?}: {{{}}} is not a group; groups are {{near,far}}, {{n,f}}, {{left,right}}, {{l,r}} and \
                 numbers such as {{10,20}}",
                plain(inside)
            ));
        };
        pieces.push(Piece::Group { axis, options });
        rest = after;
    }
    pieces.push(Piece::Text(rest));
    Ok(pieces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_makes_one_variant_per_option() {
        let corners = variants("corner_{near,far}_{left,right}").unwrap();
        let filled: Vec<_> = corners
            .iter()
            .map(|corner| {
                let names: Vec<_> = corner.names().collect();
                (corner.fill("c{l,r}{n,f}").unwrap(), names)
            })
            .collect();
        assert_eq!(
            filled[0],
            ("cln".to_owned(), vec![("y_side", -1.0), ("x_side", -1.0)])
        );
        assert_eq!(
            filled[1],
            ("crn".to_owned(), vec![("y_side", -1.0), ("x_side", 1.0)])
        );
        assert_eq!(
            filled[3],
            ("crf".to_owned(), vec![("y_side", 1.0), ("x_side", 1.0)])
        );
        let yards = variants("yard_line_{5,10}").unwrap();
        assert_eq!(yards[1].fill("Yard line {05,10}").unwrap(), "Yard line 10");
        assert_eq!(yards[0].names().collect::<Vec<_>>(), [("number", 5.0)]);
    }

    #[test]
    fn invalid_groups_are_reported() {
        assert_eq!(
            variants("a_{one,two}").unwrap_err(),
            "\"a_{one,two}\": {one,two} is not a group; groups are {near,far}, {n,f}, {left,right}, {l,r} and numbers \
             such as {10,20}"
        );
        assert!(
            variants("{a\u{1b}}")
                .unwrap_err()
                .starts_with("\"{a\\u{1b}}\": {a\\u{1b}} is not a group")
        );
        assert_eq!(
            variants("a_{near").unwrap_err(),
            "\"a_{near\" has a brace without its other half"
        );
        assert_eq!(
            variants("a}").unwrap_err(),
            "\"a}\" has a brace without its other half"
        );
        let digits = ["1"; MAX_ENTRIES / 2 + 1].join(",");
        assert!(variants(&format!("a_{{{digits}}}")).is_ok());
        assert_eq!(
            variants(&format!("a_{{l,r}}_{{{digits}}}")).unwrap_err(),
            "it has more than 2000 variants"
        );
        assert_eq!(
            variants("{n,f}{near,far}").unwrap_err(),
            "\"{n,f}{near,far}\" has two groups of the same kind"
        );
        let plain = &variants("a").unwrap()[0];
        assert_eq!(
            plain.fill("{l,r}").unwrap_err(),
            "\"{l,r}\" has the group {l,r}, its id has not"
        );
    }
}
