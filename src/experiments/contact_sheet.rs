//! A sheet of frames to look at: the picture with the lines as the answer has them, the field from above, the `IoU`.

use super::ExperimentError;
use super::answers::AskedFrame;
use super::figure::{Anchor, Drawing, Rgb, SCALE, Shape, painted};
use super::sets::{FrameSet, KnownFrame};
use crate::camera::PtzCamera;
use crate::field::{Curve, FieldModel};
use crate::geometry::Vec2;
use crate::markings::{MarkingOptions, project_lines};
use crate::media::FrameReader;
use crate::score::seen_field;
use image::imageops::{FilterType, replace, resize};

/// Columns and rows of the sheet.
const COLUMNS: usize = 3;
const ROWS: usize = 2;
/// Width of the sheet and of a tile, and the gap between tiles, figure px.
const WIDTH: f64 = 420.0;
const GAP: f64 = 9.0;
const TILE: f64 = (WIDTH - GAP * (COLUMNS as f64 + 1.0)) / COLUMNS as f64;
const WORDS: f64 = 10.0;
const CAPTION: f64 = 15.0;
/// Ground shown around the field, m.
const AROUND_M: f64 = 4.0;
const TRUE: Rgb = [0, 114, 178];
const FOUND: Rgb = [213, 94, 0];
const FIELD_LINE: Rgb = [190, 190, 190];

/// Six of the frames asked, from the worst to the best; none where none was asked.
///
/// # Errors
/// A picture cannot be read, the program's typeface cannot be read, or the PNG cannot be encoded.
pub fn contact_sheet(set: &FrameSet, asked: &[AskedFrame]) -> Result<Option<Vec<u8>>, ExperimentError> {
    let mut order: Vec<&AskedFrame> = asked.iter().collect();
    let iou = |asked: &AskedFrame| asked.found.map_or(-1.0, |found| found.iou.unwrap_or(0.0));
    order.sort_by(|a, b| iou(a).total_cmp(&iou(b)));
    let tiles = (COLUMNS * ROWS).min(order.len());
    if tiles == 0 {
        return Ok(None);
    }
    let chosen = (0..tiles).map(|tile| order[tile * (order.len() - 1) / (tiles - 1).max(1)]);
    let first = &set.frames[order[0].frame];
    let picture_height =
        TILE * f64::from(first.features.image_size.height) / f64::from(first.features.image_size.width);
    let map_height = TILE * (first.field.width_m + 2.0 * AROUND_M) / (first.field.length_m + 2.0 * AROUND_M);
    let row_height = picture_height + CAPTION + map_height + GAP;
    let rows = tiles.div_ceil(COLUMNS);
    let mut drawing = Drawing { width: WIDTH, height: GAP + row_height * rows as f64, shapes: Vec::new() };
    let mut pictures = Vec::with_capacity(tiles);
    let mut reader = FrameReader::new();
    for (tile, asked) in chosen.enumerate() {
        let left = GAP + (TILE + GAP) * (tile % COLUMNS) as f64;
        let top = GAP + row_height * (tile / COLUMNS) as f64;
        let known = &set.frames[asked.frame];
        let estimate = asked.found.map(|found| found.camera);
        let picture = known.picture(&mut reader)?;
        let pixels = |length: f64| (length * SCALE).round() as u32;
        let small = resize(&picture, pixels(TILE), pixels(picture_height), FilterType::Triangle);
        pictures.push((small, [pixels(left), pixels(top)]));
        if let Some(camera) = &estimate {
            lines_over_picture(&mut drawing.shapes, known, camera, [left, top]);
        }
        let words = match asked.found {
            Some(found) => format!("view {:.0}°, IoU {:.4}", asked.view_deg, found.iou.unwrap_or(f64::NAN)),
            None => format!("view {:.0}°, not found", asked.view_deg),
        };
        let at = [left + TILE / 2.0, top + picture_height + 11.0];
        drawing.shapes.push(Shape::Text { words, at, size: WORDS, anchor: Anchor::Middle, upright: false });
        from_above(&mut drawing.shapes, known, estimate.as_ref(), [left, top + picture_height + CAPTION]);
    }
    let png = painted(&drawing, |canvas| {
        for (small, [x, y]) in &pictures {
            replace(canvas, small, i64::from(*x), i64::from(*y));
        }
    })?;
    Ok(Some(png))
}

/// The field's lines as a camera has them.
fn lines_over_picture(shapes: &mut Vec<Shape>, known: &KnownFrame, camera: &PtzCamera, [left, top]: [f64; 2]) {
    let size = known.features.image_size;
    let scale = TILE / f64::from(size.width);
    let options = MarkingOptions { margin_px: 0.0, ..MarkingOptions::default() };
    for line in project_lines(&known.field, camera, size, &options) {
        let points = line.points.iter().map(|point| [left + point.x * scale, top + point.y * scale]).collect();
        shapes.push(Shape::Path { points, width: 0.8, colour: FOUND, dashes: &[] });
    }
}

/// The field from above, and what the picture shows of it by the true camera and by the answer.
fn from_above(shapes: &mut Vec<Shape>, known: &KnownFrame, estimate: Option<&PtzCamera>, [left, top]: [f64; 2]) {
    let field: &FieldModel = &known.field;
    let scale = TILE / (field.length_m + 2.0 * AROUND_M);
    let place = |point: Vec2| {
        let (right, down) = (point.x + 0.5 * field.length_m + AROUND_M, 0.5 * field.width_m + AROUND_M - point.y);
        [left + right * scale, top + down * scale]
    };
    for line in field.lines.iter().filter(|line| line.painted) {
        let steps = if matches!(line.curve, Curve::Segment { .. }) { 1 } else { 24 };
        let points = (0..=steps).map(|step| place(line.curve.point_at(f64::from(step) / f64::from(steps)).xy()));
        shapes.push(Shape::Path { points: points.collect(), width: 0.6, colour: FIELD_LINE, dashes: &[] });
    }
    let size = known.features.image_size;
    let mut outline = |camera: &PtzCamera, width: f64, colour: Rgb| {
        for ring in seen_field(field, camera, size) {
            let points = ring.iter().chain(ring.first()).map(|point| place(*point)).collect();
            shapes.push(Shape::Path { points, width, colour, dashes: &[] });
        }
    };
    outline(&known.truth, 2.0, TRUE);
    if let Some(camera) = estimate {
        outline(camera, 0.9, FOUND);
    }
}
