//! A contact sheet of frames for visual inspection: the picture with the lines of the estimated
//! camera, and the field from above.

use image::RgbImage;
use image::imageops::{FilterType, replace, resize};
use touchline::camera::PtzCamera;
use touchline::field::{Curve, FieldModel};
use touchline::geometry::{ImageSize, Vec2};
use touchline::markings::{MarkingOptions, project_lines};
use touchline::report::figure::{
    Anchor, Drawing, FigureError, Rgb, SCALE, Shape, png_with_background,
};
use touchline::score::visible_field;

const COLUMNS: usize = 3;
/// Width of the sheet and of a tile, and the gap between tiles, figure px.
const WIDTH: f64 = 420.0;
const GAP: f64 = 9.0;
const TILE: f64 = (WIDTH - GAP * (COLUMNS as f64 + 1.0)) / COLUMNS as f64;
/// The height of the captions' text, and of the row that it stands in, figure px.
const TEXT: f64 = 10.0;
const CAPTION: f64 = 15.0;
/// Ground shown around the field, m.
const AROUND_M: f64 = 4.0;
/// Blue and vermilion of the figures' palette (Okabe and Ito), distinct with any colour vision.
const TRUE: Rgb = [0, 114, 178];
const FOUND: Rgb = [213, 94, 0];
const FIELD_LINE: Rgb = [190, 190, 190];

/// A frame on a sheet.
#[derive(Clone, Debug)]
pub struct SheetFrame<'a> {
    /// Its picture, as large as the cameras' image.
    pub picture: RgbImage,
    /// The text below the picture.
    pub caption: String,
    /// Its field.
    pub field: &'a FieldModel,
    /// Its true camera.
    pub truth: PtzCamera,
    /// The estimated camera; none if there is no estimate.
    pub estimate: Option<PtzCamera>,
}

impl SheetFrame<'_> {
    fn size(&self) -> ImageSize {
        ImageSize::new(self.picture.width(), self.picture.height())
    }
}

/// Draws the frames in rows of three and encodes the sheet as PNG; none without frames. All tiles
/// have the shape of the first frame's.
///
/// # Errors
/// The program's typeface cannot be read, or the PNG cannot be encoded.
pub fn contact_sheet(frames: &[SheetFrame]) -> Result<Option<Vec<u8>>, FigureError> {
    let Some(first) = frames.first() else {
        return Ok(None);
    };
    // A tile has the picture, its caption and the field below each other.
    let picture_height = TILE * f64::from(first.size().height) / f64::from(first.size().width);
    let map_height =
        TILE * (first.field.width_m + 2.0 * AROUND_M) / (first.field.length_m + 2.0 * AROUND_M);
    let row_height = picture_height + CAPTION + map_height + GAP;
    let rows = frames.len().div_ceil(COLUMNS);
    let mut drawing = Drawing {
        width: WIDTH,
        height: GAP + row_height * rows as f64,
        shapes: Vec::new(),
    };
    let mut pictures = Vec::with_capacity(frames.len());
    for (tile, frame) in frames.iter().enumerate() {
        let left = GAP + (TILE + GAP) * (tile % COLUMNS) as f64;
        let top = GAP + row_height * (tile / COLUMNS) as f64;
        let small = resize(
            &frame.picture,
            pixels(TILE),
            pixels(picture_height),
            FilterType::Triangle,
        );
        // Pictures are pasted in first, so that the shapes cover them: see `png_with_background`.
        pictures.push((small, [pixels(left), pixels(top)]));
        add_lines_over_picture(&mut drawing.shapes, frame, [left, top], picture_height);
        drawing.shapes.push(Shape::Text {
            text: frame.caption.clone(),
            at: [left + TILE / 2.0, top + picture_height + 11.0],
            size: TEXT,
            anchor: Anchor::Middle,
            upright: false,
        });
        add_field_from_above(
            &mut drawing.shapes,
            frame,
            [left, top + picture_height + CAPTION],
        );
    }
    let png = png_with_background(&drawing, |canvas| {
        for (small, [x, y]) in &pictures {
            replace(canvas, small, i64::from(*x), i64::from(*y));
        }
    })?;
    Ok(Some(png))
}

/// A length of the figure in pixels of the PNG.
fn pixels(length_px: f64) -> u32 {
    (length_px * SCALE).round() as u32
}

/// Draws the field's lines as the estimated camera projects them, over a picture of this height.
fn add_lines_over_picture(
    shapes: &mut Vec<Shape>,
    frame: &SheetFrame,
    [left, top]: [f64; 2],
    height: f64,
) {
    let Some(camera) = &frame.estimate else {
        return;
    };
    // A picture of another shape than the tile is stretched, and the lines with it. The margin is
    // cut off: a line may not leave its tile.
    let across = TILE / f64::from(frame.size().width);
    let down = height / f64::from(frame.size().height);
    let options = MarkingOptions {
        margin_px: 0.0,
        ..MarkingOptions::default()
    };
    for line in project_lines(frame.field, camera, frame.size(), &options) {
        let points = line
            .points
            .iter()
            .map(|point| [left + point.x * across, top + point.y * down])
            .collect();
        shapes.push(Shape::Path {
            points,
            width: 0.8,
            colour: FOUND,
            dashes: &[],
        });
    }
}

/// Draws the field from above, with outlines of the parts that the true and the estimated camera
/// show.
fn add_field_from_above(shapes: &mut Vec<Shape>, frame: &SheetFrame, [left, top]: [f64; 2]) {
    let field = frame.field;
    let map = FieldMap {
        field,
        left,
        top,
        px_per_m: TILE / (field.length_m + 2.0 * AROUND_M),
    };
    for line in field.lines.iter().filter(|line| line.painted) {
        // Circles and arcs become polygons: 24 sides of a circle of this size differ from it by
        // less than a tenth of a figure px.
        let steps = if matches!(line.curve, Curve::Segment { .. }) {
            1
        } else {
            24
        };
        let points = (0..=steps)
            .map(|step| line.curve.point_at(f64::from(step) / f64::from(steps)))
            .map(|point| map.position(point.xy()));
        shapes.push(Shape::Path {
            points: points.collect(),
            width: 0.6,
            colour: FIELD_LINE,
            dashes: &[],
        });
    }
    // The estimate is thinner and on top, so that both outlines are visible where they agree.
    let outlines = [
        (Some(&frame.truth), 2.0, TRUE),
        (frame.estimate.as_ref(), 0.9, FOUND),
    ];
    for (camera, width, colour) in outlines {
        let Some(camera) = camera else { continue };
        for ring in visible_field(field, camera, frame.size()) {
            // A ring does not repeat its first point; an outline has to close.
            let points = ring
                .iter()
                .chain(ring.first())
                .map(|point| map.position(*point))
                .collect();
            shapes.push(Shape::Path {
                points,
                width,
                colour,
                dashes: &[],
            });
        }
    }
}

/// The field from above, at a place of the figure.
struct FieldMap<'a> {
    field: &'a FieldModel,
    left: f64,
    top: f64,
    px_per_m: f64,
}

impl FieldMap<'_> {
    /// The position of a point of the ground (m, y up) in the figure (px, y down).
    fn position(&self, point_m: Vec2) -> [f64; 2] {
        let right_m = point_m.x + 0.5 * self.field.length_m + AROUND_M;
        let down_m = 0.5 * self.field.width_m + AROUND_M - point_m.y;
        [
            self.left + right_m * self.px_per_m,
            self.top + down_m * self.px_per_m,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use touchline::camera::{BaseAngles, CameraBase, Ptz};
    use touchline::field::builtin;
    use touchline::geometry::Vec3;

    #[test]
    fn lines_are_stretched_with_a_picture_of_another_shape() {
        let soccer = builtin("soccer").unwrap();
        let field = soccer.model(&BTreeMap::new(), 0.0).unwrap();
        let size = ImageSize::new(100, 100);
        let position_m = Vec3::new(0.0, -60.0, 18.0);
        let rotation = BaseAngles::default().base_from_world();
        let base = CameraBase::new(position_m, rotation, size.centre());
        let camera = PtzCamera::new(base, Ptz::from_degrees(0.0, -11.0, 100.0));
        let frame = SheetFrame {
            picture: RgbImage::new(size.width, size.height),
            caption: String::new(),
            field: &field,
            truth: camera,
            estimate: Some(camera),
        };
        // The near touchline is in the lowest tenth of the square picture.
        let height = TILE / 2.0;
        let mut shapes = Vec::new();
        add_lines_over_picture(&mut shapes, &frame, [0.0, 0.0], height);
        let mut lowest = 0.0_f64;
        for shape in shapes {
            if let Shape::Path { points, .. } = shape {
                lowest = points.iter().fold(lowest, |low, point| low.max(point[1]));
            }
        }
        assert!((0.9 * height..=height).contains(&lowest), "{lowest}");
    }
}
