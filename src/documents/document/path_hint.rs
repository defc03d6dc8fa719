//! What is probably meant by a path at which nothing lies.

use std::path::Path;

/// What is wrong with a path at which nothing lies, and how to mend it, where its text shows that:
/// a web address, a home folder that no shell has filled in, a path of another system, standard
/// input. None for an ordinary path.
pub fn hint_for_missing(path: &Path) -> Option<&'static str> {
    let text = path.to_str()?;
    let is_drive = |text: &str| {
        let mut letters = text.chars();
        letters
            .next()
            .is_some_and(|letter| letter.is_ascii_alphabetic())
            && letters.next() == Some(':')
            && letters.next() == Some('\\')
    };
    if text.contains("://") || text.contains(":/") && text.starts_with("http") {
        return Some("it is a web address; download the file and give its path");
    }
    if text == "~" || text.starts_with("~/") {
        return Some("~ stands for the home folder only without quotes; give the whole path");
    }
    if cfg!(not(windows)) && is_drive(text) {
        return Some("it is a path of Windows; give the path that the file has here");
    }
    (text == "-").then_some("standard input is not read; give a file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_says_what_it_was_meant_to_be() {
        for (path, wanted) in [
            ("https://x.org/a.json", Some("web address")),
            ("~/a.json", Some("home folder")),
            ("-", Some("standard input")),
            ("a~b/c.json", None),
            ("a:b.json", None),
        ] {
            let found = hint_for_missing(Path::new(path));
            assert_eq!(found.is_some(), wanted.is_some(), "{path}");
            let wanted = wanted.unwrap_or_default();
            assert!(found.unwrap_or_default().contains(wanted), "{path}");
        }
    }
}
