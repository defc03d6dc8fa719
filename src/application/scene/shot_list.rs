//! The shots of a document's videos, as rows of a table: which camera filmed each, what it shows,
//! and how many of its frames have a camera.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use touchline_documents::document::{
    CameraId, Document, Frame, FrameStatus, Shot, ShotContent, ShotKind, shots_of_frames,
};
use touchline_vision::relocalize::CERTAIN;

/// What a shot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShotShows {
    /// A field, as far as is known.
    Field,
    /// No field: a close-up, the crowd, graphics.
    NoField,
    /// It is no shot, but a dissolve, wipe or fade between two.
    Transition,
}

impl ShotShows {
    /// What a shot of a document shows.
    pub fn from_shot(shot: &Shot) -> Self {
        match (shot.kind, shot.content) {
            (ShotKind::Transition, _) => Self::Transition,
            (_, Some(ShotContent::NoField)) => Self::NoField,
            _ => Self::Field,
        }
    }

    /// Its name for the user.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::NoField => "no field",
            Self::Transition => "between shots",
        }
    }
}

/// A shot of a document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShotRow {
    /// Its place in the document's list of shots.
    pub shot: usize,
    /// What it shows.
    pub shows: ShotShows,
    /// The camera of its first frame.
    pub camera: CameraId,
    /// The indices of its first and its last frame in the document.
    pub first: usize,
    /// As `first`.
    pub last: usize,
    /// Number of its frames that the document has.
    pub frames: usize,
    /// Number of frames with a certain camera; accepted ones are certain.
    pub certain: usize,
    /// Number of accepted frames among them.
    pub accepted: usize,
    /// Number of frames with a camera that is not certain.
    pub uncertain: usize,
    /// Number of frames without a camera.
    pub none: usize,
    /// Number of rejected frames among them.
    pub rejected: usize,
}

impl ShotRow {
    /// Whether it shows a field and no frame has a camera.
    pub fn is_without_camera(&self) -> bool {
        self.shows == ShotShows::Field && self.none == self.frames && self.rejected < self.frames
    }

    /// What is left to do, or why there is no camera; empty where all is well.
    pub fn reason(&self) -> &'static str {
        match self.shows {
            ShotShows::Transition => "dissolve, wipe or fade",
            ShotShows::NoField => "no lines of a field in view",
            ShotShows::Field if self.rejected == self.frames => "rejected",
            ShotShows::Field if self.is_without_camera() => "click 4 landmarks in one frame",
            ShotShows::Field if self.none > self.rejected => "some frames have no camera",
            ShotShows::Field if self.uncertain > 0 => "some frames are uncertain",
            ShotShows::Field => "",
        }
    }

    /// Number of frames that want a person: of a field, without a certain camera and not rejected.
    pub fn doubtful(&self) -> usize {
        match self.shows {
            ShotShows::Field => self.uncertain + self.none - self.rejected,
            ShotShows::NoField | ShotShows::Transition => 0,
        }
    }
}

/// The order of a list of shots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, strum::IntoStaticStr, strum::EnumIter)]
pub enum ShotOrder {
    /// As in the video.
    #[default]
    Time,
    /// Those with most frames that want a person first.
    Doubt,
    /// By camera.
    Camera,
}

impl ShotOrder {
    /// Its name in the panel.
    pub fn label(self) -> &'static str {
        self.into()
    }
}

/// The shots of a document in the order of their first frames.
pub fn shot_rows(document: &Document) -> Vec<ShotRow> {
    let mut rows: BTreeMap<usize, ShotRow> = BTreeMap::new();
    let frames = document.frames.iter().zip(shots_of_frames(document));
    for (index, (frame, shot)) in frames.enumerate() {
        let Some(shot) = shot else { continue };
        rows.entry(shot)
            .or_insert_with(|| ShotRow {
                shot,
                shows: ShotShows::from_shot(&document.shots[shot]),
                camera: frame.camera.clone(),
                first: index,
                last: index,
                frames: 0,
                certain: 0,
                accepted: 0,
                uncertain: 0,
                none: 0,
                rejected: 0,
            })
            .add(index, frame);
    }
    let mut rows: Vec<ShotRow> = rows.into_values().collect();
    rows.sort_by_key(|row| row.first);
    rows
}

/// The rows in an order, with those of fields alone if `fields_only`.
pub fn in_order(mut rows: Vec<ShotRow>, order: ShotOrder, fields_only: bool) -> Vec<ShotRow> {
    rows.retain(|row| !fields_only || row.shows == ShotShows::Field);
    match order {
        ShotOrder::Time => {}
        ShotOrder::Doubt => rows.sort_by_key(|row| Reverse(row.doubtful())),
        ShotOrder::Camera => {
            rows.sort_by(|a, b| (a.shows, &a.camera).cmp(&(b.shows, &b.camera)));
        }
    }
    rows
}

impl ShotRow {
    /// Counts one more frame.
    fn add(&mut self, index: usize, frame: &Frame) {
        self.last = index;
        self.frames += 1;
        self.accepted += usize::from(frame.status == FrameStatus::Reference);
        self.rejected += usize::from(frame.status == FrameStatus::Rejected);
        match certainty(frame) {
            None => self.none += 1,
            Some(certainty) if certainty >= CERTAIN => self.certain += 1,
            Some(_) => self.uncertain += 1,
        }
    }
}

/// How certain a frame's camera is, 0 to 1; none without a camera.
pub(super) fn certainty(frame: &Frame) -> Option<f64> {
    if frame.ptz.is_none() || frame.status == FrameStatus::Rejected {
        return None;
    }
    if frame.status == FrameStatus::Reference {
        return Some(1.0);
    }
    Some(frame.confidence().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::broadcast;

    #[test]
    fn rows_count_frames_by_their_cameras_and_say_what_is_left() {
        let mut document = broadcast();
        document.frames[0].status = FrameStatus::Reference;
        let rows = shot_rows(&document);
        let counts = |row: &ShotRow| (row.frames, row.certain, row.uncertain, row.none);
        assert_eq!(counts(&rows[0]), (6, 5, 1, 0));
        assert_eq!((rows[0].accepted, rows[0].doubtful()), (1, 1));
        assert_eq!(rows[0].reason(), "some frames are uncertain");
        assert_eq!(rows[1].shows, ShotShows::Transition);
        assert_eq!(rows[2].shows, ShotShows::NoField);
        assert!(rows[3].is_without_camera());
        assert_eq!((rows[3].first, rows[3].last), (14, 19));
        for index in 14..20 {
            document.frames[index].status = FrameStatus::Rejected;
        }
        let row = &shot_rows(&document)[3];
        assert_eq!((row.reason(), row.doubtful()), ("rejected", 0));
    }

    #[test]
    fn rows_are_sorted_and_filtered() {
        let shots = |order, fields_only| -> Vec<usize> {
            let rows = in_order(shot_rows(&broadcast()), order, fields_only);
            rows.iter().map(|row| row.shot).collect()
        };
        assert_eq!(shots(ShotOrder::Time, false), [0, 1, 2, 3]);
        assert_eq!(shots(ShotOrder::Time, true), [0, 3]);
        assert_eq!(shots(ShotOrder::Doubt, true), [3, 0]);
        assert_eq!(shots(ShotOrder::Camera, false), [0, 3, 2, 1]);
    }
}
