//! Reports of the agreement of two annotators: tables, text and JSON.

use super::{Agreement, FrameAgreement};
use serde_json::{Value, json};
use std::fmt::Write as _;
use touchline_core::score::ClickScatter;
use touchline_documents::report::Table;

/// A table of landmarks, one row each; those with the largest median distance first.
pub fn agreement_by_landmark(agreement: &Agreement) -> Table {
    let mut table = Table::new(&[
        ("landmark", "landmark"),
        ("frames", "frames"),
        ("median_px", "median (px)"),
        ("p90_px", "90 % (px)"),
        ("offset_x_px", "median x (px)"),
        ("offset_y_px", "median y (px)"),
        ("sigma_px", "one annotator σ (px)"),
    ]);
    for landmark in &agreement.landmarks {
        table.push(vec![
            landmark.landmark.as_str().into(),
            landmark.pairs.into(),
            landmark.median_px.into(),
            landmark.p90_px.into(),
            landmark.offset_px.x.into(),
            landmark.offset_px.y.into(),
            landmark.noise.map(|noise| noise.sigma).into(),
        ]);
    }
    table
}

/// A table of frames, one row each.
pub fn agreement_by_frame(agreement: &Agreement) -> Table {
    let mut table = Table::new(&[
        ("frame", "frame"),
        ("clicks", "landmarks of both"),
        ("largest_px", "farthest (px)"),
        ("only_first", "only first"),
        ("only_second", "only second"),
        ("names_differ", "other names"),
        ("iou_part", "IoU_part"),
        ("worst_corner_px", "worst corner (px)"),
        ("pan_deg", "pan (°)"),
        ("tilt_deg", "tilt (°)"),
        ("focal_percent", "focal (%)"),
    ]);
    for frame in &agreement.frames {
        let cameras = frame.cameras.as_ref();
        table.push(vec![
            frame.name.as_str().into(),
            frame.clicks.len().into(),
            frame.largest_px().into(),
            frame.lone_clicks[0].len().into(),
            frame.lone_clicks[1].len().into(),
            frame.names.len().into(),
            cameras.and_then(|cameras| cameras.iou_part).into(),
            cameras.map(|cameras| cameras.worst_corner_px).into(),
            cameras.map(|cameras| cameras.pan.degrees()).into(),
            cameras.map(|cameras| cameras.tilt.degrees()).into(),
            cameras.map(|cameras| cameras.focal_percent).into(),
        ]);
    }
    table
}

/// The agreement as text and tables in the format of `write`.
pub fn agreement_tables(agreement: &Agreement, write: fn(&Table) -> String) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    if let Some(distances) = &agreement.distances {
        let _ = writeln!(
            text,
            "Two annotators: {} clicks on the same landmarks of {} frames lie {:.2} px apart, median (90 % {:.2}; at 1920 px \
             width).",
            distances.count,
            agreement.frames.len(),
            distances.median,
            distances.p90
        );
    }
    let _ = writeln!(text, "{}", agreement.describe_noise());
    for frame in agreement
        .frames
        .iter()
        .filter(|frame| !frame.names.is_empty())
    {
        let _ = writeln!(text, "{}: {}.", frame.name, describe_names(frame));
    }
    // An empty line ends the paragraph, so that Markdown does not take the table for its
    // continuation.
    text.push('\n');
    text.push_str(&write(&agreement_by_landmark(agreement)));
    text
}

/// The differing names in a frame: the first few, and the number of further ones.
fn describe_names(frame: &FrameAgreement) -> String {
    const SHOWN: usize = 3;
    let shown: Vec<String> = frame
        .names
        .iter()
        .take(SHOWN)
        .map(|dispute| {
            format!(
                "{} of the first is {} of the second",
                dispute.names[0], dispute.names[1]
            )
        })
        .collect();
    let more = match frame.names.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    shown.join(", ") + &more
}

/// All results as JSON.
pub fn agreement_json(agreement: &Agreement) -> Value {
    let disputes: Vec<Value> = agreement.frames.iter().flat_map(disputes_json).collect();
    // By axis: x points right and y down in the picture.
    let [right, down] = agreement
        .noise_by_axis
        .map(|noise| noise.as_ref().map(noise_json));
    json!({
        "width_px": 1920,
        "frames": agreement_by_frame(agreement).to_json(),
        "landmarks": agreement_by_landmark(agreement).to_json(),
        "clicks": agreement.distances.map_or(0, |distances| distances.count),
        "copies": agreement.copies,
        "median_px": agreement.distances.map(|distances| distances.median),
        "p90_px": agreement.distances.map(|distances| distances.p90),
        "one_annotator": agreement.noise.as_ref().map(noise_json),
        "one_annotator_x": right,
        "one_annotator_y": down,
        "names_differ": disputes,
        "only_first": lone_names(agreement, true),
        "only_second": lone_names(agreement, false),
    })
}

fn disputes_json(frame: &FrameAgreement) -> Vec<Value> {
    let disputes = frame.names.iter().map(|dispute| {
        json!({
            "frame": frame.name,
            "first": dispute.names[0].as_str(),
            "second": dispute.names[1].as_str(),
            "apart_px": dispute.apart_px,
        })
    });
    disputes.collect()
}

/// The names of the frames that only the first, or only the second annotator has labelled.
fn lone_names(agreement: &Agreement, by_first: bool) -> Vec<&str> {
    agreement
        .lone
        .iter()
        .filter(|lone| lone.by_first == by_first)
        .map(|lone| lone.name.as_str())
        .collect()
}

/// Click noise as JSON.
fn noise_json(noise: &ClickScatter) -> Value {
    json!({
        "sigma_px": noise.sigma,
        "interval_95_px": noise.interval_95,
        "pairs": noise.pairs,
        "set_aside": noise.set_aside,
    })
}
