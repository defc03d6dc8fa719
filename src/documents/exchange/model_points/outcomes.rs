//! What became of the points of models: for their makers, as data to train with.

use crate::document::{Click, ClickOrigin, DocumentAt, Fields, Frame, FrameStatus, Target};
use serde_json::{Map, Value, json};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::ImagePoint;
use touchline_core::solve::Observation;

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display)]
#[strum(serialize_all = "snake_case")]
pub enum PointOutcome {
    /// No person has decided on its frame.
    Open,
    /// A person accepted its frame and left it as the model had it.
    Accepted,
    /// A person moved or renamed it.
    Moved,
    /// A person took it away, or its frame was accepted with a camera that it contradicts.
    Refused,
    /// A person rejected its frame.
    FrameRejected,
}

impl PointOutcome {
    /// What became of a click of a frame.
    fn from_click(frame: &Frame, index: usize, click: &Click) -> Self {
        let disputed = frame.solution.as_ref().map(|solution| &solution.disputed);
        match frame.status {
            FrameStatus::Rejected => Self::FrameRejected,
            _ if !click.is_by_model() => Self::Moved,
            FrameStatus::Reference if disputed.is_some_and(|of| of.contains(&index)) => {
                Self::Refused
            }
            FrameStatus::Reference => Self::Accepted,
            FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested => Self::Open,
        }
    }
}

/// The points of the models of a document, or of one of them, with what became of each, as JSON:
/// frame by frame with the model's own name, probability and place of the point, its place and name
/// now, how far a person moved it, and its distance from what the frame's camera projects, px.
///
/// # Errors
/// The field of a frame is not valid.
pub fn point_outcomes(at: DocumentAt<'_>, model: Option<&str>) -> Result<Value, FieldError> {
    let (document, fields) = (at.document, Fields::from_document(at)?);
    let is_meant = |origin: &ClickOrigin| model.is_none_or(|model| origin.model() == model);
    let mut frames = Vec::new();
    for frame in &document.frames {
        let field = fields.for_frame(document, frame);
        let camera = document.ptz_camera(frame);
        let of_clicks = frame
            .clicks
            .iter()
            .enumerate()
            .map(|(index, click)| (click, PointOutcome::from_click(frame, index, click)));
        let refused = frame
            .refused_points
            .iter()
            .map(|click| (click, PointOutcome::Refused));
        let points = of_clicks.chain(refused).filter_map(|(click, outcome)| {
            let origin = click.origin.as_deref().filter(|origin| is_meant(origin))?;
            Some(describe(
                click,
                origin,
                outcome,
                (frame, field, camera.as_ref()),
            ))
        });
        let points: Vec<Value> = points.collect();
        if points.is_empty() {
            continue;
        }
        let mut entry = json!({
            "status": frame.status.as_str(),
            "image_size_px": [frame.image_size.width, frame.image_size.height],
            "points": points,
        });
        if let Some(image) = &frame.image {
            entry["image"] = json!(image);
        }
        if let Some(video) = &frame.video {
            entry["video"] = json!({ "path": video.path, "frame_index": video.frame_index });
        }
        frames.push(entry);
    }
    Ok(json!({
        "format": "touchline-point-outcomes",
        "version": 1,
        "conventions": "px of the frame from the picture's corner",
        "frames": frames,
    }))
}

/// A point with what became of it.
fn describe(
    click: &Click,
    origin: &ClickOrigin,
    outcome: PointOutcome,
    (frame, field, camera): (&Frame, &FieldModel, Option<&PtzCamera>),
) -> Value {
    let pair = |point: ImagePoint| json!([point.x, point.y]);
    let given = origin.given.unwrap_or(click.image);
    let mut entry = Map::new();
    let mut set = |key: &str, value: Value| entry.insert(key.to_owned(), value);
    set("model", json!(origin.model()));
    set("outcome", json!(outcome.to_string()));
    set("given_px", pair(given));
    if let Some(label) = &origin.label {
        set("label", json!(label));
    }
    if let Some(probability) = origin.probability {
        set("probability", json!(probability));
    }
    if let Some(sigma_px) = origin.sigma_px {
        set("sigma_px", json!(sigma_px));
    }
    match &click.target {
        Some(Target::Landmark(id)) => drop(set("landmark", json!(id.as_str()))),
        Some(Target::Line(id)) => drop(set("line", json!(id.as_str()))),
        None => {}
    }
    if outcome == PointOutcome::Moved {
        set("image_px", pair(click.image));
        set("moved_px", json!(given.distance_px(click.image)));
    }
    let off_px = camera.and_then(|camera| off_camera_px(click, (frame, field, camera), given));
    if let Some(off_px) = off_px {
        set("off_camera_px", json!(off_px));
    }
    Value::Object(entry)
}

/// The distance of the place that the model gave from what a camera projects, px; none where the
/// camera does not show it.
fn off_camera_px(
    click: &Click,
    (frame, field, camera): (&Frame, &FieldModel, &PtzCamera),
    given: ImagePoint,
) -> Option<f64> {
    let name = click.target.as_ref()?.as_str();
    let size = frame.image_size;
    let observation = match click.target.as_ref()? {
        Target::Landmark(_) => Observation::from_landmark(field, name, given, size, 0),
        Target::Line(_) => Observation::from_line(field, name, given, size, 0),
    };
    observation.ok()?.distance_px(camera)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::tests::with_clicks;
    use std::path::Path;

    #[test]
    fn points_say_what_became_of_them_and_how_far_they_are_from_the_camera() {
        let mut document = with_clicks();
        let frame = &mut document.frames[0];
        frame.status = FrameStatus::Reference;
        for click in &mut frame.clicks {
            click.origin = Some(Box::new(ClickOrigin::from_model("net")));
        }
        frame.clicks[1].take_over();
        frame.clicks[1].image.x += 3.0;
        frame.refuse_clicks(|index, _| index == 2);
        let outcomes = point_outcomes(document.at(Path::new(".")), Some("net")).unwrap();
        let points = outcomes["frames"][0]["points"].as_array().unwrap();
        let of: Vec<&str> = points
            .iter()
            .map(|point| point["outcome"].as_str().unwrap())
            .collect();
        assert_eq!(
            (of[0], of[1], of[of.len() - 1]),
            ("accepted", "moved", "refused")
        );
        assert_eq!(points[1]["moved_px"], 3.0);
        assert!(points[0]["off_camera_px"].as_f64().unwrap() < 1e-3);
        let others = point_outcomes(document.at(Path::new(".")), Some("other")).unwrap();
        assert_eq!(others["frames"], json!([]));
    }
}
