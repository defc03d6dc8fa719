//! Formatting of numbers and texts for the user and for files.

use std::fmt::Write as _;

/// A count with thousands separators: 41,200.
pub fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: "1 frame", "2 frames", "41,200 frames".
pub fn pluralise(number: usize, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{} {singular}{plural}", thousands(number))
}

/// A number with at most this many decimals, at least one, without trailing zeros: 0.25, 12.
pub fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    // A small negative number rounds to "-0.00".
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// Text as XML has it in an element or an attribute. Characters that no XML file may contain
/// become U+FFFD.
pub fn xml_text(text: &str) -> String {
    text.replace(is_no_xml, "\u{fffd}")
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Whether a character is none of XML 1.0, not even escaped.
fn is_no_xml(letter: char) -> bool {
    (letter < ' ' && !matches!(letter, '\t' | '\n' | '\r'))
        || matches!(letter, '\u{fffe}' | '\u{ffff}')
}

/// Bytes in lower-case hexadecimal digits, two each.
pub fn hex(bytes: &[u8]) -> String {
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            // Writing to a string cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// Whether a spreadsheet would evaluate a cell as a formula, possibly after removing leading
/// apostrophes.
pub fn is_formula(cell: &str) -> bool {
    cell.trim_start_matches('\'')
        .starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// A cell with foreign text. Text that a spreadsheet would evaluate as a formula gets a leading
/// apostrophe.
pub fn text_cell(text: &str) -> String {
    if is_formula(text) {
        format!("'{text}")
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_set_apart() {
        let texts = [0, 12, 999, 1000, 41_200, 1_234_567].map(thousands);
        assert_eq!(texts, ["0", "12", "999", "1,000", "41,200", "1,234,567"]);
    }

    #[test]
    fn decimals_end_at_the_last_digit_that_says_something() {
        let texts = [0.25, 12.0, 10.04, -0.001].map(|value| decimal(value, 2));
        assert_eq!(texts, ["0.25", "12", "10.04", "0"]);
    }

    #[test]
    fn xml_has_no_control_characters() {
        assert_eq!(
            xml_text("a\u{1b}[2J & <b>\t\""),
            "a\u{fffd}[2J &amp; &lt;b&gt;\t&quot;"
        );
    }

    #[test]
    fn every_byte_has_two_digits() {
        assert_eq!(hex(&[0, 10, 255]), "000aff");
    }
}
