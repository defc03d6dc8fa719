//! `frames.csv`: one row per frame.

use super::matches::match_names;
use super::plan::PlannedFrame;
use super::split::match_of;
use crate::document::{Click, Frame};
use crate::exchange::table::{field_text, push_row};

const COLUMNS: [&str; 20] = [
    "image",
    "split",
    "label",
    "status",
    "match",
    "camera",
    "clip",
    "video",
    "frame_index",
    "pts_s",
    "clicks",
    "line_clicks",
    "check_clicks",
    "snapped_clicks",
    "confidence",
    "rms_px",
    "worst_corner_sigma_px",
    "sha256",
    "undistorted_image",
    "id",
];

/// The table of the frames of a dataset; each entry has the plan of a frame, the frame in the
/// dataset and the original frame.
pub fn frames_table(frames: &[(&PlannedFrame, &Frame, &Frame)]) -> String {
    // The names of matches depend on all of them: each is as short as tells it from the others.
    let matches = match_names(frames.iter().map(|(_, _, original)| *original));
    let mut text = String::new();
    push_row(&COLUMNS.map(ToOwned::to_owned), &mut text);
    for (planned, dataset, original) in frames {
        let name = field_text(matches.get(&match_of(original)));
        push_row(&row(planned, dataset, name), &mut text);
    }
    text
}

fn row(planned: &PlannedFrame, frame: &Frame, name_of_match: String) -> [String; 20] {
    let solution = frame.solution.as_ref();
    let video = frame.video.as_ref();
    [
        frame.image.clone().unwrap_or_default(),
        field_text(planned.split),
        planned.origin.to_string(),
        frame.status.as_str().to_owned(),
        name_of_match,
        frame.camera.to_string(),
        field_text(frame.clip.as_ref()),
        field_text(video.map(|video| &video.path)),
        field_text(video.map(|video| video.frame_index)),
        field_text(video.and_then(|video| video.pts_s)),
        frame.clicks.len().to_string(),
        count_clicks([frame], Click::is_on_line).to_string(),
        count_clicks([frame], |click| click.check).to_string(),
        count_clicks([frame], |click| click.snapped_sigma_px.is_some()).to_string(),
        field_text(solution.and_then(|solution| solution.confidence)),
        field_text(solution.and_then(|solution| solution.rms_px)),
        field_text(solution.and_then(|solution| solution.worst_corner_sigma_px)),
        frame.sha256.clone().unwrap_or_default(),
        planned.undistorted.clone().unwrap_or_default(),
        frame.id.to_string(),
    ]
}

/// The number of clicks of frames for which a condition is true.
pub fn count_clicks<'a>(
    frames: impl IntoIterator<Item = &'a Frame>,
    is_counted: impl Fn(&Click) -> bool,
) -> usize {
    frames
        .into_iter()
        .flat_map(|frame| &frame.clicks)
        .filter(|click| is_counted(click))
        .count()
}
