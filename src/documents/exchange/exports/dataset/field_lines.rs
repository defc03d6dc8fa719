//! `fields.json`: the coordinates of landmarks and lines, so that a reader can draw them without
//! the rules of the sport.

use crate::document::{DocumentAt, Fields};
use crate::exchange::error::ExchangeError;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use touchline_core::field::{FieldLine, FieldModel};

/// The maximum distance of neighbouring points of a line, m: between them distortion curves a line
/// by at most about 0.01 px.
const STEP_M: f64 = 0.25;

/// The fields of a document's cameras as JSON.
///
/// # Errors
/// One of them is not valid.
pub fn fields_json(at: DocumentAt<'_>) -> Result<String, ExchangeError> {
    let fields = Fields::from_document(at)?;
    // Cameras of equal fields share an entry; a document has few different ones.
    let mut known: Vec<(Arc<FieldModel>, Vec<String>)> = Vec::new();
    for (camera, field) in at
        .document
        .cameras
        .iter()
        .zip(fields.per_camera(at.document))
    {
        match known.iter_mut().find(|(model, _)| **model == *field) {
            Some((_, cameras)) => cameras.push(camera.id.to_string()),
            None => known.push((field, vec![camera.id.to_string()])),
        }
    }
    let fields: Vec<Value> = known
        .iter()
        .map(|(field, cameras)| field_json(field, cameras))
        .collect();
    Ok(format!("{}\n", json!({ "unit": "m", "fields": fields })))
}

fn field_json(field: &FieldModel, cameras: &[String]) -> Value {
    let landmarks: Map<String, Value> = field
        .landmarks
        .iter()
        .map(|landmark| {
            let at = field.landmark_in_world(landmark);
            (landmark.id.to_string(), json!([at.x, at.y, at.z]))
        })
        .collect();
    let lines: Map<String, Value> = field
        .lines
        .iter()
        .map(|line| (line.id.to_string(), Value::Array(points(field, line))))
        .collect();
    json!({
        "template": field.template,
        "cameras": cameras,
        "length_m": field.length_m,
        "width_m": field.width_m,
        "landmarks": landmarks,
        "lines": lines,
    })
}

/// Points of a line in world coordinates (m), evenly spaced and at most [`STEP_M`] apart.
fn points(field: &FieldModel, line: &FieldLine) -> Vec<Value> {
    let steps = (line.curve.length_m() / STEP_M).ceil().max(1.0) as usize;
    (0..=steps)
        .map(|step| {
            let at = field.world_from_nominal(line.curve.point_at(step as f64 / steps as f64));
            json!([at.x, at.y, at.z])
        })
        .collect()
}
