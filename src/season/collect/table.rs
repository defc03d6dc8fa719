//! The table of a season.

use super::project::CollectedMatch;
use crate::part::Cost;
use crate::plan::PlannedMatch;
use crate::queue::confidence_of;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use touchline_documents::document::{Frame, FrameStatus};
use touchline_documents::report::{Cell, Table};

/// The columns: key and heading.
const COLUMNS: [(&str, &str); 9] = [
    ("match", "Match"),
    ("cameras", "Cameras"),
    ("frames", "Frames"),
    ("certain", "Right by their own evidence"),
    ("uncertain", "Uncertain"),
    ("none", "Without a camera"),
    ("gap", "In gaps"),
    ("why", "Why"),
    ("core_hours", "Core hours"),
];

/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;

/// Decimals of core hours.
const DECIMALS: usize = 2;

/// A table that is being filled, with the sums of its rows.
pub(super) struct SeasonTable {
    table: Table,
    sums: Counts,
}

/// What a row counts.
#[derive(Clone, Copy, Default)]
struct Counts {
    cameras: usize,
    frames: usize,
    certain: usize,
    uncertain: usize,
    none: usize,
    gap: usize,
    core_hours: f64,
}

impl SeasonTable {
    pub(super) fn new() -> Self {
        Self {
            table: Table::new(&COLUMNS),
            sums: Counts::default(),
        }
    }

    /// Adds the row of a match. Frames that a person accepted are right, whatever their confidence.
    pub(super) fn add(
        &mut self,
        planned: &PlannedMatch,
        found: &CollectedMatch,
        parts: &Path,
        below: f64,
    ) {
        let mut counts = Counts {
            frames: planned.num_frames,
            core_hours: core_hours(planned, parts),
            ..Counts::default()
        };
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        let mut of_match = 0;
        if let Some(document) = &found.document {
            let with_base = document
                .cameras
                .iter()
                .filter(|camera| camera.base().is_some());
            counts.cameras = with_base.count();
            for frame in &document.frames {
                // Frames of the match's project that are of other pictures fill no gap.
                of_match += usize::from(!is_of_other_frames(frame, planned));
                if frame.ptz.is_none() {
                    counts.none += 1;
                    *reasons.entry(reason_of(frame)).or_default() += 1;
                } else if is_certain(frame, below) {
                    counts.certain += 1;
                } else {
                    counts.uncertain += 1;
                }
            }
        }
        // Frames of the match that no part has: of missing windows, and images that cannot be read.
        counts.gap = planned.num_frames.saturating_sub(of_match);
        self.push(
            &planned.name,
            &counts,
            why(found.reason.as_deref(), &reasons),
        );
        self.sums.add(&counts);
    }

    /// The table, with the sums as its last row.
    pub(super) fn finish(mut self) -> Table {
        let sums = self.sums;
        self.push("all", &sums, String::new());
        self.table
    }

    fn push(&mut self, name: &str, counts: &Counts, why: String) {
        self.table.push(vec![
            name.into(),
            counts.cameras.into(),
            counts.frames.into(),
            counts.certain.into(),
            counts.uncertain.into(),
            counts.none.into(),
            counts.gap.into(),
            why.into(),
            Cell::Fixed(counts.core_hours, DECIMALS),
        ]);
    }
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.cameras += other.cameras;
        self.frames += other.frames;
        self.certain += other.certain;
        self.uncertain += other.uncertain;
        self.none += other.none;
        self.gap += other.gap;
        self.core_hours += other.core_hours;
    }
}

/// Whether a frame with a camera counts as right: a person accepted it, or its confidence says so.
fn is_certain(frame: &Frame, below: f64) -> bool {
    frame.status == FrameStatus::Reference
        || confidence_of(frame).is_some_and(|confidence| confidence >= below)
}

/// Whether the path of a frame says that it is no frame of the match.
fn is_of_other_frames(frame: &Frame, planned: &PlannedMatch) -> bool {
    // By the name of the video or folder alone: the season's folder may have been moved since its
    // projects were made. A path without a name, such as `../1.jpg`, says nothing.
    let name = Some(OsStr::new(&planned.frames_name));
    match (&frame.image, &frame.video) {
        (Some(image), _) => {
            let image = Path::new(image);
            let folder = image.parent().and_then(Path::file_name);
            folder.is_some() && folder != name && image.file_name() != name
        }
        (None, Some(video)) => {
            Path::new(&video.path).file_name() != name
                || video.frame_index >= planned.num_frames as u64
        }
        (None, None) => true,
    }
}

/// Why a frame has no camera, in a word: the code of its first warning.
fn reason_of(frame: &Frame) -> &str {
    let warnings = frame.solution.as_ref().map(|solution| &solution.warnings);
    let first = warnings.and_then(|warnings| warnings.first());
    first.map_or("not_tracked", |warning| warning.code.as_str())
}

/// Why frames have no camera: the reason for the match, and the numbers for each reason of a frame.
fn why(of_match: Option<&str>, reasons: &BTreeMap<&str, usize>) -> String {
    let counted = reasons
        .iter()
        .map(|(reason, count)| format!("{reason} {count}"));
    let all: Vec<String> = of_match
        .map(str::to_owned)
        .into_iter()
        .chain(counted)
        .collect();
    all.join("; ")
}

/// What the shards of a match cost, as far as it is stated beside their parts.
fn core_hours(planned: &PlannedMatch, parts: &Path) -> f64 {
    // A part without a stated cost counts as nothing, so the sum is a lower bound. Where the system
    // states no processor time, the clock's stands for it, as if one core had worked.
    let labels = planned.labels.iter().map(|label| &label.shard);
    let costs = labels
        .chain([&planned.find])
        .filter_map(|shard| Cost::read(parts, shard));
    // The sum of nothing would be a negative zero.
    let seconds = costs.map(|cost| cost.cpu_s.unwrap_or(cost.wall_s));
    seconds.fold(0.0, |sum, seconds| sum + seconds) / HOUR_S
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FieldSpec, VideoFrame};
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn frames_of_a_project_that_are_of_other_pictures_fill_no_gap() {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        for index in 0..4 {
            let video = VideoFrame::new("../../videos/a.mp4", index, None);
            let of_match = Frame::from_video(video, "main".into(), size);
            document.frames.push(of_match.into());
            let other = new_frame(&format!("own/{index}.jpg"), size);
            document.frames.push(other.into());
        }
        let planned = PlannedMatch {
            name: "north".to_owned(),
            frames: "videos/a.mp4".to_owned(),
            frames_name: "a.mp4".to_owned(),
            frames_sha256: String::new(),
            num_frames: 10,
            field: FieldSpec::new("soccer"),
            project: None,
            forest: None,
            look_at: 40,
            find: "find".to_owned(),
            labels: Vec::new(),
        };
        let found = CollectedMatch {
            document: Some(document),
            ..CollectedMatch::default()
        };
        let mut table = SeasonTable::new();
        table.add(&planned, &found, Path::new("/no/parts"), 0.9);
        assert_eq!((table.sums.none, table.sums.gap), (8, 6));
        assert!(!table.sums.core_hours.is_sign_negative());
    }
}
