//! Every text that people read, in one file to be reviewed: what the window says, and why something
//! failed.

use crate::architecture::crates;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

/// Where texts for people are written.
const ROOMS: [&str; 9] = [
    "application/app",
    "ui",
    "application/jobs",
    "calibration/autocalibrate",
    "calibration/calibrate",
    "documents/store",
    "vision/media",
    "documents/exchange",
    "core/solve",
];
/// The list.
const LIST: &str = "tests/suite/samples/strings.txt";

/// The texts of a token stream in order. Attributes are no texts, save what an error says; modules
/// for tests are passed over.
fn texts(tokens: TokenStream, found: &mut Vec<String>) {
    let mut tokens = tokens.into_iter().peekable();
    let mut of_tests = false;
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                if matches!(tokens.peek(), Some(TokenTree::Punct(mark)) if mark.as_char() == '!') {
                    tokens.next();
                }
                let Some(TokenTree::Group(attribute)) = tokens.next() else {
                    continue;
                };
                let says = attribute.stream().to_string().replace(' ', "");
                of_tests |= says == "cfg(test)";
                if says.starts_with("error(") {
                    texts(attribute.stream(), found);
                }
            }
            TokenTree::Group(group) => {
                if !(of_tests && group.delimiter() == Delimiter::Brace) {
                    texts(group.stream(), found);
                }
                of_tests &= group.delimiter() != Delimiter::Brace;
            }
            TokenTree::Literal(literal) => {
                if let Ok(text) = syn::parse_str::<syn::LitStr>(&literal.to_string()) {
                    found.push(text.value());
                }
            }
            TokenTree::Punct(mark) if mark.as_char() == ';' => of_tests = false,
            _ => {}
        }
    }
}

/// Whether a text is read by people: words, and not a name, a path or a key.
fn is_read(text: &str) -> bool {
    let letters = text.chars().filter(|c| c.is_alphabetic()).count();
    let is_sentence = text
        .split_whitespace()
        .filter(|word| word.chars().any(char::is_alphabetic))
        .count()
        > 1;
    let is_title = text.starts_with(char::is_uppercase) && text.chars().any(char::is_lowercase);
    letters > 1 && (is_sentence || is_title || text.ends_with('…'))
}

/// The list as it is now.
fn list_strings() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files: BTreeSet<&Path> = crates()
        .iter()
        .flat_map(|map| map.modules.values())
        .map(|module| module.file.as_path())
        .collect();
    let mut list = String::new();
    for room in ROOMS {
        let room = Path::new("src").join(room);
        for file in files.iter().filter(|file| file.starts_with(&room)) {
            let source = std::fs::read_to_string(root.join(file)).unwrap();
            let mut found = Vec::new();
            texts(source.parse().unwrap(), &mut found);
            found.retain(|text| is_read(text));
            if found.is_empty() {
                continue;
            }
            let name: Vec<_> = file.iter().map(|part| part.to_string_lossy()).collect();
            writeln!(list, "{}", name.join("/")).unwrap();
            for text in found {
                writeln!(
                    list,
                    "    {}",
                    text.escape_debug()
                        .to_string()
                        .replace("\\'", "'")
                        .replace("\\\"", "\"")
                )
                .unwrap();
            }
            list.push('\n');
        }
    }
    list
}

/// A text is changed by reading it once more where it stands among the others: `UPDATE_STRINGS=1`
/// writes the list again.
#[test]
fn every_text_stands_in_the_list_for_review() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(LIST);
    let now = list_strings();
    if std::env::var_os("UPDATE_STRINGS").is_some() {
        std::fs::write(&file, &now).unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_default();
    let added: Vec<_> = now
        .lines()
        .filter(|line| !kept.lines().any(|other| other == *line))
        .collect();
    let gone: Vec<_> = kept
        .lines()
        .filter(|line| !now.lines().any(|other| other == *line))
        .collect();
    assert!(
        now == kept,
        "texts differ from {LIST}; read them there after UPDATE_STRINGS=1.\nadded:\n{}\ngone:\n{}",
        added.join("\n"),
        gone.join("\n")
    );
}

#[test]
fn texts_are_found_in_macros_and_errors_but_not_in_tests_or_attributes() {
    let source = r#"
        //! A comment.
        #[allow(missing_docs, reason = "no text for people")]
        #[error("{name}: there is no such file")]
        struct Missing { name: String }
        const KEY: &str = "snake_case";
        fn told(n: usize) -> String { format!("{n} frames left"); note!(deep, vec![("Save", "as a copy…")]) }
        #[cfg(test)]
        mod tests { const QUOTED: &str = "not for people"; }
        #[cfg(test)]
        use a::b;
        fn after() { tell("And this one.") }
    "#;
    let mut found = Vec::new();
    texts(source.parse().unwrap(), &mut found);
    found.retain(|text| is_read(text));
    assert_eq!(
        found,
        [
            "{name}: there is no such file",
            "{n} frames left",
            "Save",
            "as a copy…",
            "And this one."
        ]
    );
}
