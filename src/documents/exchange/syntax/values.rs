//! Validation of single values of foreign files.

use crate::exchange::error::Problem;
use touchline_core::geometry::ImageSize;

/// The maximum frame number: at 60 frames per second it is reached after five centuries.
const MAX_FRAME: f64 = 1e12;

/// A side of a picture: a whole number of pixels, 1 to 65 535.
///
/// # Errors
/// It is none.
pub fn side_px(what: &str, value: f64) -> Result<u32, Problem> {
    if ImageSize::is_side_px(value) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    Err(Problem::out_of_range(
        what,
        value,
        "a whole number from 1 to 65535",
    ))
}

/// The number of a frame, counted from 0.
///
/// # Errors
/// It is none.
pub fn frame_number(what: &str, value: f64) -> Result<u64, Problem> {
    if (0.0..=MAX_FRAME).contains(&value) && value.fract() == 0.0 {
        return Ok(value as u64);
    }
    Err(Problem::out_of_range(
        what,
        value,
        "a whole number from 0 to 10^12",
    ))
}

/// The entry of a list of coefficients; one that the list does not have is zero.
pub fn coefficient(list: &[f64], index: usize) -> f64 {
    list.get(index).copied().unwrap_or(0.0)
}

/// Refuses a lens with coefficients beyond k1 and k2, which no document can have. Files often have
/// places for them, filled with zeros.
///
/// # Errors
/// One of them is not zero; it is named.
pub fn refuse_further_coefficients(others: &[f64]) -> Result<(), Problem> {
    match others.iter().find(|value| **value != 0.0) {
        Some(value) => Err(Problem::not_supported(
            format!("a distortion coefficient of {value} beyond k1 and k2"),
            "the document's lens has k1 and k2 only",
        )),
        None => Ok(()),
    }
}

/// The beginning of a text, for a message.
pub fn shorten(text: &str) -> String {
    const MAX_CHARACTERS: usize = 60;
    // Letters, not bytes: a cut within a letter of several bytes would panic.
    let mut clipped: String = text.chars().take(MAX_CHARACTERS).collect();
    if clipped.len() < text.len() {
        clipped.push('…');
    }
    clipped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_side_or_number_is_refused() {
        assert_eq!(
            (side_px("w", 1.0), side_px("w", 65_535.0)),
            (Ok(1), Ok(65_535))
        );
        for bad in [0.0, -1.0, 1.5, 65_536.0, f64::NAN, f64::INFINITY] {
            assert!(side_px("w", bad).is_err(), "{bad}");
        }
        assert_eq!(
            (frame_number("n", 0.0), frame_number("n", 1e12)),
            (Ok(0), Ok(1_000_000_000_000))
        );
        for bad in [-1.0, 0.5, 1e13, f64::NAN] {
            assert!(frame_number("n", bad).is_err(), "{bad}");
        }
        assert_eq!(shorten(&"é".repeat(61)), format!("{}…", "é".repeat(60)));
        assert_eq!(shorten("short"), "short");
    }
}
