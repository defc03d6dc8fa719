//! A frame number or a time in a video, as users type it.

use thiserror::Error;

/// A frame number or a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameOrTime {
    /// A frame by its number, from 0.
    Frame(u64),
    /// A time, s.
    Time(f64),
}

/// The text is neither a frame number nor a time.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0:?} is neither a frame nor a time; write for example 500 or 1:23.4")]
pub struct FrameOrTimeError(pub String);

impl std::str::FromStr for FrameOrTime {
    type Err = FrameOrTimeError;

    /// `500` is a frame number, `1:23.4` minutes and seconds, `1:02:03.4` hours, minutes and
    /// seconds; `83.4` and `83 s` are seconds.
    fn from_str(text: &str) -> Result<Self, FrameOrTimeError> {
        let wrong = || FrameOrTimeError(text.trim().to_owned());
        let typed = text.trim();
        if let Ok(frame) = typed.parse() {
            return Ok(Self::Frame(frame));
        }
        let typed = typed.trim_end_matches('s').trim_end();
        let mut seconds = 0.0;
        let parts: Vec<&str> = typed.split(':').collect();
        if parts.len() > 3 {
            return Err(wrong());
        }
        for (at, part) in parts.iter().enumerate() {
            // `f64` also parses "inf", "nan" and "1e3", which users do not mean as times.
            let number: f64 = Some(*part)
                .filter(|part| is_plain_number(part))
                .and_then(|part| part.parse().ok())
                .ok_or_else(wrong)?;
            // Minutes and seconds below a larger unit must be less than 60, and only seconds may
            // have a fraction.
            if at > 0 && number >= 60.0 || at + 1 < parts.len() && number.fract() != 0.0 {
                return Err(wrong());
            }
            seconds = 60.0 * seconds + number;
        }
        Ok(Self::Time(seconds))
    }
}

/// Whether a text has digits and decimal points only.
fn is_plain_number(text: &str) -> bool {
    !text.is_empty()
        && text
            .bytes()
            .all(|byte| byte.is_ascii_digit() || byte == b'.')
}

/// A time as text, such as "1:23.40" or "1:02:03.40".
pub fn time_code(seconds: f64) -> String {
    // Round once, before the parts are taken: 59.999 s is "1:00.00", not "0:60.00".
    let hundredths = (100.0 * seconds.max(0.0)).round() as u64;
    let (hours, minutes) = (hundredths / 360_000, hundredths / 6_000 % 60);
    let rest = format!("{:02}.{:02}", hundredths / 100 % 60, hundredths % 100);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{rest}")
    } else {
        format!("{minutes}:{rest}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_times_are_distinguished() {
        for (text, place) in [
            ("500", FrameOrTime::Frame(500)),
            (" 0 ", FrameOrTime::Frame(0)),
            ("1:23.4", FrameOrTime::Time(83.4)),
            ("1:02:03.5", FrameOrTime::Time(3723.5)),
            ("83.4", FrameOrTime::Time(83.4)),
            ("12 s", FrameOrTime::Time(12.0)),
            ("75:00", FrameOrTime::Time(4500.0)),
        ] {
            let Ok(found) = text.parse() else {
                panic!("{text} is a place")
            };
            match (found, place) {
                (FrameOrTime::Time(found), FrameOrTime::Time(wanted)) => {
                    assert!((found - wanted).abs() < 1e-9, "{text}: {found}");
                }
                (found, place) => assert_eq!(found, place, "{text}"),
            }
        }
        for text in [
            "", "kick-off", "-3", "1:75", "1.5:20", "1:2:3:4", "1:", "1e3:2", "inf",
        ] {
            assert_eq!(
                text.parse::<FrameOrTime>(),
                Err(FrameOrTimeError(text.to_owned()))
            );
        }
    }

    #[test]
    fn a_time_is_shown_as_it_is_typed() {
        assert_eq!(
            [0.0, 16.48, 83.4, 3723.5, 59.999].map(time_code),
            ["0:00.00", "0:16.48", "1:23.40", "1:02:03.50", "1:00.00"]
        );
        assert_eq!(time_code(-1.0), "0:00.00");
    }
}
