//! The messages of a command on standard error: lines of text, or one JSON object per line.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeMap;
use std::fmt::{Display, Write as _};
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use touchline_core::files::{is_control, plain};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::Document;
use touchline_vision::media::VideoBackend;

/// Frames that are named for each reason.
const MOST_NAMED: usize = 10;

/// The format of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Messages {
    /// Text, for people.
    Text,
    /// JSON, for programs: `{"level": …, "message": …}`, with `frame` if the message is about one.
    Json,
}

impl Messages {
    /// Reports something that the user should know, although nothing failed.
    pub fn note(self, message: &str) {
        self.write("note", None, message);
    }

    /// Reports several such things, one after the other.
    pub fn notes(self, messages: impl IntoIterator<Item = impl Display>) {
        for message in messages {
            self.note(&message.to_string());
        }
    }

    /// Reports a frame for which the command failed.
    pub fn frame_failed(self, frame: &str, message: &str) {
        self.write("frame_failed", Some(frame), message);
    }

    /// Reports frames for which the command failed, each with the reason. A person reads the first
    /// ten names of a reason and the number of the others, a program all names.
    pub fn frames_failed(self, failed: impl IntoIterator<Item = (impl Display, impl Display)>) {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for (frame, reason) in failed {
            let (frame, reason) = (frame.to_string(), reason.to_string());
            // An error of a file names it, too.
            let reason = reason
                .strip_prefix(&format!("{frame}: "))
                .unwrap_or(&reason)
                .to_owned();
            let count = counts.entry(reason.clone()).or_default();
            *count += 1;
            if *count <= MOST_NAMED || self == Self::Json {
                self.frame_failed(&frame, &reason);
            }
        }
        for (reason, count) in counts {
            let others = count.saturating_sub(MOST_NAMED);
            if others > 0 && self == Self::Text {
                self.note(&format!(
                    "and {} more: {reason}",
                    pluralise(others, "frame")
                ));
            }
        }
    }

    /// Reports things that the command could not do, beside others that it did.
    pub fn failures(self, messages: &[String]) {
        for message in messages {
            self.write("failed", None, message);
        }
    }

    /// Reports why the whole command failed.
    pub fn error(self, message: &str) {
        self.write("error", None, message);
    }

    /// Says with JSON by which program the videos of a document are read, if it has any.
    pub fn name_video_backend(self, document: &Document) {
        let has_video = document.frames.iter().any(|frame| frame.video.is_some());
        if self == Self::Text || !has_video {
            return;
        }
        if let Some(backend) = VideoBackend::available().next() {
            self.note(&format!("videos are read by {backend}"));
        }
    }

    /// A progress bar for `count` steps. Visible only on a terminal, and not with JSON.
    pub fn progress(self, count: usize, what: &'static str) -> ProgressBar {
        let shown = self == Self::Text && std::io::stderr().is_terminal();
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(count as u64), target).with_message(what);
        // The template is constant and valid. If it were not, the bar would only be a plain one.
        match ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }

    fn write(self, level: &str, frame: Option<&str>, message: &str) {
        let line = self.line(level, frame, message);
        // If standard error is closed, nothing can be reported any more.
        let _ = writeln!(std::io::stderr(), "{line}");
    }

    /// One message as a line without control characters.
    pub(in crate::cli) fn line(self, level: &str, frame: Option<&str>, message: &str) -> String {
        // Text goes to a terminal, which obeys control characters, so that `plain` makes them
        // visible. JSON often ends there, too, and escapes only those below U+0020 by itself.
        let (frame, message) = (frame.map(shorten_message), &shorten_message(message));
        match (self, frame) {
            (Self::Text, None) => plain(&one_line(&format!("touchline: {message}"))),
            (Self::Text, Some(frame)) => {
                plain(&one_line(&format!("touchline: {frame}: {message}")))
            }
            (Self::Json, None) => {
                plain_json(&serde_json::json!({ "level": level, "message": message }))
            }
            (Self::Json, Some(frame)) => plain_json(
                &serde_json::json!({ "level": level, "frame": frame, "message": message }),
            ),
        }
    }
}

/// A progress that advances a bar by one per step.
pub fn count_steps(bar: &ProgressBar) -> Progress<'_, ()> {
    Progress::new(|()| {
        bar.inc(1);
        ControlFlow::Continue(())
    })
}

/// The bar of the step that a command of several steps is at. Dropping it removes the bar, so that
/// messages written afterwards do not run into it.
pub struct StepBar {
    messages: Messages,
    /// The bar, with the name of its step.
    shown: Option<(&'static str, ProgressBar)>,
}

impl StepBar {
    /// A bar that is not shown yet.
    pub const fn new(messages: Messages) -> Self {
        Self {
            messages,
            shown: None,
        }
    }

    /// The bar of a step of `count` parts. Removes the bar of another step.
    pub fn of(&mut self, step: &'static str, count: usize) -> &ProgressBar {
        if self.shown.as_ref().is_some_and(|(shown, _)| *shown != step) {
            self.clear();
        }
        let messages = self.messages;
        let (_, bar) = self
            .shown
            .get_or_insert_with(|| (step, messages.progress(count, step)));
        // A step may begin again with another number of parts, such as for the next camera.
        bar.set_length(count as u64);
        bar
    }

    /// The bar that is shown.
    pub fn current(&self) -> Option<&ProgressBar> {
        self.shown.as_ref().map(|(_, bar)| bar)
    }

    /// Removes the bar, so that messages do not run into it.
    pub fn clear(&mut self) {
        if let Some((_, bar)) = self.shown.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for StepBar {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Maximum length of a message, characters. Documents and file names may contain texts of any
/// length.
const MAX_CHARACTERS: usize = 1000;

/// Shortens a message that is too long. Keeps the beginning, which says what is wrong, and the end,
/// which says how to mend it.
fn shorten_message(message: &str) -> String {
    let length = message.chars().count();
    if length <= MAX_CHARACTERS {
        return message.to_owned();
    }
    let (first, last) = (MAX_CHARACTERS * 2 / 3, MAX_CHARACTERS / 4);
    // Cut by characters: a cut by bytes within one of them would panic.
    let begin: String = message.chars().take(first).collect();
    let end: String = message.chars().skip(length - last).collect();
    format!("{begin} … {} characters … {end}", length - first - last)
}

/// A JSON value on one line. What a terminal would obey is escaped as JSON does, so that readers of
/// the value get it back.
fn plain_json(value: &serde_json::Value) -> String {
    let text = value.to_string();
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if !is_control(letter) {
            escaped.push(letter);
            continue;
        }
        // Such characters occur only within the strings of the value, where an escape has a place.
        for unit in letter.encode_utf16(&mut [0; 2]) {
            // Writing to a string cannot fail.
            let _ = write!(escaped, "\\u{unit:04x}");
        }
    }
    escaped
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
    use super::{Messages, StepBar};

    #[test]
    fn a_step_that_begins_again_has_the_length_of_its_new_parts() {
        let mut bar = StepBar::new(Messages::Json);
        bar.of("Check", 40).set_position(40);
        assert_eq!(bar.of("Check", 90).length(), Some(90));
        assert_eq!(bar.of("Sample", 5).position(), 0);
    }

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
    fn a_terminal_obeys_nothing_in_json_and_a_reader_gets_the_message_back() {
        let hostile = "\u{1b}[2J \u{9b}31m \u{7f} a\u{202e}gpj.exe\u{feff} C:\\x";
        for frame in [None, Some("\u{8}\u{2066}x.jpg")] {
            let line = Messages::Json.line("error", frame, hostile);
            assert_eq!(touchline_core::files::plain(&line), line);
            let read: serde_json::Value = serde_json::from_str(&line).unwrap();
            assert_eq!(read["message"], hostile);
            assert_eq!(read["frame"].as_str(), frame);
        }
        let line = Messages::Json.line("note", None, "\u{9b}");
        assert_eq!(line, r#"{"level":"note","message":"\u009b"}"#);
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
