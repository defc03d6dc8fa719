//! The table with which `calibrate` ends: the frames of each camera by what their shots show.

use std::collections::BTreeMap;
use touchline_application::scene::shot_list::{ShotRow, ShotShows, shot_rows};
use touchline_core::geometry::thousands;
use touchline_documents::document::{Document, FrameStatus, shots_of_frames};

/// Maximum number of shots without a camera that are listed one by one.
const MAX_LISTED: usize = 12;

/// The name of the row of shots in which no frame has a camera.
const NO_CAMERA: &str = "no camera";

/// The counts of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Row {
    shots: usize,
    frames: usize,
    certain: usize,
    uncertain: usize,
    none: usize,
}

/// The lines of the table, and of the shots of a field that got no camera; none for a document
/// without shots or with a single one.
pub fn describe_shots(document: &Document) -> Vec<String> {
    let shots = shot_rows(document);
    if shots.len() < 2 {
        return Vec::new();
    }
    let mut rows: BTreeMap<(ShotShows, &str), Row> = BTreeMap::new();
    for shot in &shots {
        // Which camera would have filmed a crowd or a dissolve is not known.
        let camera = match shot.shows {
            ShotShows::Field if shot.is_without_camera() => NO_CAMERA,
            ShotShows::Field => shot.camera.as_str(),
            ShotShows::NoField | ShotShows::Transition => "",
        };
        let row = rows.entry((shot.shows, camera)).or_default();
        row.shots += 1;
        row.frames += shot.frames;
        row.certain += shot.certain;
        row.uncertain += shot.uncertain;
        row.none += shot.none;
    }
    let mut lines = vec![line([
        "camera",
        "shots",
        "frames",
        "certain",
        "uncertain",
        "none",
        "",
    ])];
    for ((kind, camera), row) in rows {
        let (camera, reason) = match kind {
            ShotShows::Field => (camera, ""),
            ShotShows::NoField => ("no field", "no lines of a field in view"),
            ShotShows::Transition => ("between shots", "dissolves, wipes and fades"),
        };
        let [shots, frames, certain, uncertain, none] =
            [row.shots, row.frames, row.certain, row.uncertain, row.none].map(thousands);
        lines.push(line([
            camera, &shots, &frames, &certain, &uncertain, &none, reason,
        ]));
    }
    let without = shots.iter();
    let without: Vec<&ShotRow> = without.filter(|shot| shot.is_without_camera()).collect();
    for shot in without.iter().take(MAX_LISTED) {
        lines.push(format!(
            "no camera from {} to {} ({} frames): neither the search nor the frames of the other \
             shots know it; 4 clicks in one of them do",
            document.frames[shot.first].name(),
            document.frames[shot.last].name(),
            shot.frames
        ));
    }
    if without.len() > MAX_LISTED {
        lines.push(format!(
            "and {} more shots without a camera",
            without.len() - MAX_LISTED
        ));
    }
    lines
}

/// Whether every frame without a camera lies in a shot without a field or between two shots, or was
/// rejected.
pub fn is_every_field_answered(document: &Document) -> bool {
    let shots = shots_of_frames(document);
    document.frames.iter().zip(shots).all(|(frame, shot)| {
        let kind = shot.map_or(ShotShows::Field, |shot| {
            ShotShows::from_shot(&document.shots[shot])
        });
        frame.ptz.is_some() || kind != ShotShows::Field || frame.status == FrameStatus::Rejected
    })
}

/// A line of the table: a name, five numbers, a remark.
fn line([name, shots, frames, certain, uncertain, none, remark]: [&str; 7]) -> String {
    let line = format!(
        "{name:<14} {shots:>6} {frames:>8} {certain:>8} {uncertain:>10} {none:>8}  {remark}"
    );
    line.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::{broadcast, ptz_at};

    #[test]
    fn frames_are_counted_by_camera_and_kind_of_shot() {
        let mut document = broadcast();
        document.frames[3].solution = None;
        let lines = describe_shots(&document);
        let words: Vec<Vec<&str>> = lines
            .iter()
            .map(|it| it.split_whitespace().collect())
            .collect();
        assert_eq!(words[1], ["main", "1", "6", "4", "2", "0"]);
        assert_eq!(words[2], ["no", "camera", "1", "6", "0", "0", "6"]);
        assert_eq!(words[3][..7], ["no", "field", "1", "5", "0", "0", "5"]);
        assert_eq!(words[4][..7], ["between", "shots", "1", "3", "0", "0", "3"]);
        assert!(
            lines[5].starts_with("no camera from a.mp4") && lines.len() == 6,
            "{lines:?}"
        );
        assert!(!is_every_field_answered(&document));
        for index in 14..20 {
            document.frames[index].ptz = ptz_at(0.0, -9.0, 90.0);
        }
        assert!(is_every_field_answered(&document));
    }

    #[test]
    fn a_document_of_one_shot_has_no_table() {
        let mut document = broadcast();
        document.shots.truncate(1);
        assert_eq!(describe_shots(&document), [""; 0]);
        document.shots.clear();
        assert_eq!(describe_shots(&document), [""; 0]);
        assert!(!is_every_field_answered(&document));
    }
}
