//! Texts of the dialog for exports and imports.

use crate::app::sentence;
use touchline_calibration::pipelines::CameraSurvey;
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::{ExchangeError, JoinedImport};

/// Options of the command line in error messages, and their names in the dialog. Replaced in this
/// order; of two with the same beginning the longer one must come first.
const OPTIONS: [(&str, &str); 35] = [
    (
        "give a --map file with them, or --skip-unmapped",
        "choose what labels are, or leave out others",
    ),
    (" (--images FOLDER)", ""),
    ("give --images FOLDER", "choose the folder of the pictures"),
    (" (--size)", ""),
    ("give --map ", "choose what labels are: "),
    ("; --size WIDTHxHEIGHT gives another", ""),
    ("--size WIDTHxHEIGHT or --images FOLDER", "the picture size"),
    ("--video VIDEO or --size WIDTHxHEIGHT", "the picture size"),
    ("--size WIDTHxHEIGHT", "the picture size"),
    ("given by --size", "given as picture size"),
    ("--size ", "picture size "),
    ("give --format", "choose the format"),
    ("--sensor-mm", "sensor width"),
    ("--zoom", "what zoom values are"),
    ("--fps", "frames a second"),
    ("--match-id", "the match's id"),
    ("--start-time", "when the video begins"),
    ("--perspective", "the perspective"),
    ("choose one with --camera", "choose one"),
    ("--split-by ", "divided by "),
    ("; --outside-pictures takes it too", ""),
    ("; --outside-pictures copies them too", ""),
    ("; --set length_m=… and width_m=… give another", ""),
    (" (--outside keep)", ""),
    (" (--images copy)", ""),
    (" (--variant gamestate)", ""),
    ("--points in the layout", "points in the layout"),
    (
        "--points PATH --layout pnlcalib",
        "them to the command `touchline import`",
    ),
    ("; files of labels are imported without --points", ""),
    ("below --min-probability", "of a lower probability"),
    // The dialog has no fields for these.
    (
        "--template centre-m, corner-m, wc14 or shuttleset",
        "it to the command `touchline import`",
    ),
    (
        "--direction pitch_from_image or image_from_pitch",
        "it to the command `touchline import`",
    ),
    ("--columns h=NAME", "it to the command `touchline import`"),
    ("--template and --direction", "plane and direction"),
    ("; --video VIDEO says which", ""),
];

/// An error in one line, with the dialog's names in place of the command line's options.
pub(super) fn describe_error(error: &ExchangeError) -> String {
    match error {
        ExchangeError::Exists { path } => {
            format!("{} exists already; choose another place.", path.display())
        }
        ExchangeError::OtherDisk { .. } => {
            "The pictures lie on another disk and cannot be linked; copy them instead.".to_owned()
        }
        other => in_dialog(&other.to_string()),
    }
}

/// A message of an export or import as a sentence, with the dialog's names in place of the command
/// line's options.
pub fn in_dialog(text: &str) -> String {
    sentence(
        &OPTIONS
            .iter()
            .fold(text.to_owned(), |text, (option, words)| {
                text.replace(option, words)
            }),
    )
}

/// A number of bytes, such as "34 MB".
pub fn describe_bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["kB", "MB", "GB", "TB"];
    // The next unit begins where rounding would give 1000 of this one.
    let mut value = bytes as f64 / 1000.0;
    let mut unit = 0;
    while value >= 999.5 && unit + 1 < UNITS.len() {
        value /= 1000.0;
        unit += 1;
    }
    if value < 9.95 {
        format!("{value:.1} {}", UNITS[unit])
    } else {
        format!("{value:.0} {}", UNITS[unit])
    }
}

/// What given cameras say about themselves, in a few lines: how many are impossible or mirrored,
/// the first of them by name, and where the others stand.
pub fn describe_survey(survey: &CameraSurvey) -> Vec<String> {
    /// Impossible cameras that are named.
    const NAMED: usize = 3;
    let kinds = [
        (survey.impossible.len(), "impossible"),
        (survey.mirrored, "mirrored"),
    ];
    let of_kind = kinds.into_iter().filter(|(count, _)| *count > 0);
    let mut first = vec![pluralise(survey.cameras, "camera")];
    first.extend(of_kind.map(|(count, kind)| format!("{count} {kind}")));
    let mut lines = vec![first.join(", ") + "."];
    let impossible = survey.impossible.iter().take(NAMED);
    lines.extend(impossible.map(|camera| format!("{}: {}.", camera.frame, camera.fault)));
    if survey.impossible.len() > NAMED {
        lines.push(format!("… {} more.", survey.impossible.len() - NAMED));
    }
    lines.push(match &survey.places[..] {
        [] => "They do not agree on a place where a camera stands.".to_owned(),
        [place] => format!("They agree on one place: {place}."),
        places => {
            let places: Vec<String> = places.iter().map(ToString::to_string).collect();
            let count = pluralise(places.len(), "place");
            format!("They agree on {count}: {}.", places.join("; "))
        }
    });
    lines
}

/// What was imported, as text.
pub(super) fn describe_joined(joined: &JoinedImport) -> String {
    let frames = joined.matched + joined.added;
    format!(
        "Labels of {} were imported: {}, {}.",
        pluralise(frames, "frame"),
        pluralise(joined.clicks, "click"),
        pluralise(joined.cameras, "new camera")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::exchange::Format;

    #[test]
    fn sizes_are_said_as_people_say_them() {
        assert_eq!(
            [0, 1234, 34_400_000, 999_700_000, 1_260_000_000].map(describe_bytes),
            ["0.0 kB", "1.2 kB", "34 MB", "1.0 GB", "1.3 GB"]
        );
    }

    #[test]
    fn errors_are_sentences_without_options() {
        let exists = ExchangeError::Exists { path: "out".into() };
        assert_eq!(
            describe_error(&exists),
            "out exists already; choose another place."
        );
        let needed = ExchangeError::ExportNeeds {
            format: Format::Cdf,
            what: "the frame rate",
            option: "--fps",
        };
        assert_eq!(
            describe_error(&needed),
            "Cdf needs the frame rate; give frames a second."
        );
        assert_eq!(
            describe_error(&ExchangeError::Stopped),
            "Stopped; nothing was written."
        );
    }
}
