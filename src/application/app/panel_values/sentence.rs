//! Makes sentences from reasons and warnings.

/// A text with a capital letter and a full stop.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters
        .next()
        .map(|first| first.to_uppercase().collect::<String>())
        .unwrap_or_default();
    let stop = if text.ends_with(['.', '?', '!']) {
        ""
    } else {
        "."
    };
    format!("{first}{}{stop}", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_begins_with_a_capital_and_ends_with_a_stop() {
        assert_eq!(sentence("worst corner ±2.0 px"), "Worst corner ±2.0 px.");
        assert_eq!(sentence("Cut or wrong name?"), "Cut or wrong name?");
        assert_eq!(sentence(""), ".");
    }
}
