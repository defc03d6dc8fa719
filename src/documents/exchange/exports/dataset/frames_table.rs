//! `frames.csv`: one row per frame.

use super::matches::match_names;
use super::plan::PlannedFrame;
use super::split::match_of;
use crate::document::{Click, Clip, Frame};
use crate::exchange::syntax::table::{field_text, push_row};
use touchline_core::geometry::text_cell;

const COLUMNS: [&str; 22] = [
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
    "grade",
    "ground_sigma_m",
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
        push_row(&row(planned, dataset, &name), &mut text);
    }
    text
}

fn row(planned: &PlannedFrame, frame: &Frame, name_of_match: &str) -> [String; 22] {
    let solution = frame.solution.as_ref();
    let ground = solution.and_then(|solution| solution.ground.as_ref());
    let video = frame.video.as_ref();
    // Names come from other people's files and folders; a spreadsheet must not calculate them. A
    // number that is negative may stay as it is.
    let clip = match &frame.clip {
        Some(Clip::Name(name)) => text_cell(name),
        clip => field_text(clip.as_ref()),
    };
    [
        frame.image.as_deref().map(text_cell).unwrap_or_default(),
        field_text(planned.split),
        planned.origin.to_string(),
        frame.status.as_str().to_owned(),
        text_cell(name_of_match),
        text_cell(frame.camera.as_str()),
        clip,
        field_text(video.map(|video| text_cell(&video.path))),
        field_text(video.map(|video| video.frame_index)),
        field_text(video.and_then(|video| video.pts_s)),
        frame.clicks.len().to_string(),
        count_clicks([frame], Click::is_on_line).to_string(),
        count_clicks([frame], |click| click.check).to_string(),
        count_clicks([frame], |click| click.snapped_sigma_px.is_some()).to_string(),
        field_text(solution.and_then(|solution| solution.confidence)),
        field_text(solution.and_then(|solution| solution.rms_px)),
        field_text(solution.and_then(|solution| solution.worst_corner_sigma_px)),
        field_text(frame.sha256.as_deref().map(text_cell)),
        field_text(planned.undistorted.as_deref().map(text_cell)),
        text_cell(frame.id.as_str()),
        ground.map_or_else(String::new, |ground| ground.grade.as_str().to_owned()),
        field_text(ground.and_then(|ground| ground.sigma_m)),
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

#[cfg(test)]
mod tests {
    use super::super::label_origin::LabelOrigin;
    use super::super::plan::Source;
    use super::*;
    use crate::document::{FrameId, VideoFrame};
    use crate::exchange::syntax::table::Table;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn names_of_others_are_no_formulas_and_come_back() {
        let size = ImageSize::new(64, 36);
        let mut frame = Frame::from_image("=1+1/=a.jpg", "@main".into(), size);
        frame.id = FrameId::from("=id");
        frame.clip = Some(Clip::Name("-first".to_owned()));
        frame.video = Some(VideoFrame::new("+match.mp4", 7, None));
        frame.sha256 = Some("=2+2".to_owned());
        let planned = PlannedFrame {
            id: frame.id.clone(),
            split: None,
            origin: LabelOrigin::Clicked,
            picture: None,
            undistorted: None,
            name: String::new(),
            source: Source::File("a.jpg".into()),
        };
        let text = frames_table(&[(&planned, &frame, &frame)]);
        let table = Table::read(text.as_bytes()).unwrap();
        let row = table.rows().next().unwrap();
        for (column, name) in [
            ("image", "=1+1/=a.jpg"),
            ("camera", "@main"),
            ("clip", "-first"),
            ("video", "+match.mp4"),
            ("sha256", "=2+2"),
            ("id", "=id"),
        ] {
            assert_eq!(row.text(column), Some(name));
            assert!(text.contains(&format!("'{name}")), "{text}");
        }
        frame.clip = Some(Clip::Number(-1));
        let text = frames_table(&[(&planned, &frame, &frame)]);
        assert!(text.contains(",-1,"), "a number is no formula: {text}");
    }
}
