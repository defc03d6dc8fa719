//! Messages of a command on standard error: text lines, or one JSON object per line.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use touchline_core::files::plain;
use touchline_core::progress::Progress;

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Messages {
    /// For people.
    Text,
    /// For machines: `{"level": …, "message": …}`, with `frame` where it is about one.
    Json,
}

impl Messages {
    /// Something a person should know, though nothing failed.
    pub fn note(self, message: &str) {
        self.write("note", None, message);
    }

    /// A frame that could not be done.
    pub fn frame_failed(self, frame: &str, message: &str) {
        self.write("frame_failed", Some(frame), message);
    }

    /// Why the command failed as a whole.
    pub fn error(self, message: &str) {
        self.write("error", None, message);
    }

    /// A bar that shows how many of `count` are done; on a terminal only, and not among messages
    /// for machines.
    #[must_use]
    pub fn progress(self, count: usize, what: &'static str) -> ProgressBar {
        let shown = self == Self::Text && std::io::stderr().is_terminal();
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(count as u64), target).with_message(what);
        match ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }

    fn write(self, level: &str, frame: Option<&str>, message: &str) {
        let line = self.line(level, frame, message);
        // Standard error is closed: nothing more can be reported.
        let _ = writeln!(std::io::stderr(), "{line}");
    }

    pub(super) fn line(self, level: &str, frame: Option<&str>, message: &str) -> String {
        let (frame, message) = (frame.map(bounded), &bounded(message));
        match (self, frame) {
            (Self::Text, None) => plain(&one_line(&format!("touchline: {message}"))),
            (Self::Text, Some(frame)) => {
                plain(&one_line(&format!("touchline: {frame}: {message}")))
            }
            (Self::Json, None) => {
                serde_json::json!({ "level": level, "message": message }).to_string()
            }
            (Self::Json, Some(frame)) => {
                serde_json::json!({ "level": level, "frame": frame, "message": message })
                    .to_string()
            }
        }
    }
}

/// Moves a bar on by one at each step.
pub fn count_steps(bar: &ProgressBar) -> Progress<'_, ()> {
    Progress::new(|()| {
        bar.inc(1);
        ControlFlow::Continue(())
    })
}

/// The longest message; documents and file names may hold words of any length.
const LONGEST: usize = 1000;

/// A message without its middle if it is too long: what was wrong stands first, the way out last.
fn bounded(message: &str) -> String {
    let length = message.chars().count();
    if length <= LONGEST {
        return message.to_owned();
    }
    let (first, last) = (LONGEST * 2 / 3, LONGEST / 4);
    let begin: String = message.chars().take(first).collect();
    let end: String = message.chars().skip(length - last).collect();
    format!("{begin} … {} characters … {end}", length - first - last)
}

fn one_line(text: &str) -> String {
    text.lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::Messages;

    #[test]
    fn a_message_is_one_line_for_people_and_an_object_for_machines() {
        let text = Messages::Text.line("frame_failed", Some("a.jpg"), "no\n  base");
        assert_eq!(text, "touchline: a.jpg: no base");
        let json = Messages::Json.line("error", None, "a \"b\"\nc");
        assert_eq!(json, r#"{"level":"error","message":"a \"b\"\nc"}"#);
    }

    #[test]
    fn a_terminal_obeys_nothing_in_a_message() {
        let hostile = "\u{1b}]0;owned\u{7} \u{1b}[2Jé\u{9b}31m a\u{202e}gpj.exe\r\u{200b}";
        let text = Messages::Text.line("error", Some("\u{8}x.jpg"), hostile);
        let wanted = "touchline: \\u{8}x.jpg: \\u{1b}]0;owned\\u{7} \\u{1b}[2Jé\\u{9b}31m a\\u{202e}gpj.exe\\r\\u{200b}";
        assert_eq!(text, wanted);
    }

    #[test]
    fn a_long_message_keeps_what_was_wrong_and_the_way_out() {
        let long = format!("wrong: {}; mend it so", "x".repeat(100_000));
        for messages in [Messages::Text, Messages::Json] {
            let line = messages.line("error", None, &long);
            assert!(line.chars().count() < 1100, "{}", line.len());
            assert!(
                line.contains("wrong: x") && line.contains("mend it so"),
                "{line}"
            );
        }
    }
}
