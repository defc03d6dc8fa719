//! Approximate matching of a few letters, for finding a command.

/// How well letters match a text; larger is better, `None` if they do not.
///
/// The letters must occur in the text in order. A letter counts 1; at the beginning of a word 4
/// more; in a run of adjacent letters up to 8 more. The sum is divided by a measure of the text's
/// length. The best of all positions of the first letter counts, because the first match is not
/// always the best.
pub fn score(letters: &str, text: &str) -> Option<u32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let letters: Vec<char> = letters
        .to_lowercase()
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    // Every start is tried, which takes quadratic time; names of commands are short.
    let mut best = None;
    for start in 0..text.len().max(1) {
        best = best.max(score_from(&letters, &text, start));
    }
    best
}

/// The score with the first letter at `from` or later; each letter takes its first occurrence.
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
        // A letter directly after the one before it continues a run. The first letter continues
        // none, wherever it stands.
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
