//! Finding a command by a few of its letters.

/// How well letters match a text: they occur in it in order; beginnings of words and runs count
/// more. None: they do not.
pub fn score(letters: &str, text: &str) -> Option<u32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let letters: Vec<char> = letters
        .to_lowercase()
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    let mut best = None;
    for start in 0..text.len().max(1) {
        best = best.max(score_from(&letters, &text, start));
    }
    best
}

/// The same, with the first letter no earlier than `from`.
fn score_from(letters: &[char], text: &[char], from: usize) -> Option<u32> {
    let (mut total, mut at) = (0, from);
    let mut run = 0;
    for letter in letters {
        let found = at
            + text
                .get(at..)?
                .iter()
                .position(|candidate| candidate == letter)?;
        let begins_word = found == 0 || !text[found - 1].is_alphanumeric();
        run = if found == at && total > 0 { run + 1 } else { 0 };
        total += 1 + 4 * u32::from(begins_word) + 2 * run.min(4);
        at = found + 1;
    }
    // A shorter text is nearer to what was typed.
    Some(total * 100 / (10 + text.len() as u32 / 8))
}

#[cfg(test)]
mod tests {
    use super::score;

    #[test]
    fn letters_match_in_order_and_beginnings_win() {
        assert!(score("nf", "Next frame").is_some());
        assert!(score("fn", "Next frame").is_none());
        assert!(score("nf", "Next frame") > score("nf", "Open folder of frames… in full"));
        assert!(score("acc", "Accept and next") > score("acc", "a cubic centimetre"));
        assert!(score("fit", "Fit") > score("fit", "Next frame that needs it"));
        assert!(score("", "anything").is_some() && score("x", "").is_none());
    }
}
