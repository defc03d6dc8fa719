//! Untrusted names and texts in messages.

/// A text without control characters, and without characters that change the writing direction.
pub fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if is_control(letter) {
            plain.extend(letter.escape_default());
        } else {
            plain.push(letter);
        }
    }
    plain
}

/// Whether a terminal or a text view obeys a character instead of showing it.
pub fn is_control(letter: char) -> bool {
    // Beside the control characters: the marks, embeddings, overrides and isolates of Unicode's
    // bidirectional algorithm (UAX 9), characters of zero width, line and paragraph separators.
    letter.is_control()
        || matches!(
            letter,
            '\u{61c}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{2069}'
                | '\u{feff}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_that_change_the_direction_of_writing_are_escaped() {
        for mark in [
            '\u{61c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202e}', '\u{2060}', '\u{2066}',
            '\u{2069}',
        ] {
            let escaped = format!("a{}gpj.exe", mark.escape_default());
            assert_eq!(plain(&format!("a{mark}gpj.exe")), escaped);
        }
    }
}
