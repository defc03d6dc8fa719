//! Rasterises a drawing. Every shape becomes closed outlines, and `ab_glyph_rasterizer` computes
//! how much of each pixel they cover.

use super::FigureError;
use super::shape::{Drawing, Rgb, Shape};
use super::typeface::{OutlineSegment, Typeface};
use ab_glyph_rasterizer::{Point, Rasterizer, point};
use image::{ImageFormat, Rgb as Pixel, RgbImage};
use std::io::Cursor;

/// Pixels per px of the drawing: 420 px become 992 pixels, which is 84 mm at 300 dots per inch.
pub const SCALE: f64 = 992.0 / 420.0;
/// Number of corners of the polygon that approximates a circle. For a disc of 3.2 px it differs
/// from the circle by less than a tenth of a pixel.
const CIRCLE_CORNERS: u32 = 24;

/// Rasterises a drawing and encodes it as PNG.
pub fn png(drawing: &Drawing) -> Result<Vec<u8>, FigureError> {
    png_with_background(drawing, |_| {})
}

/// The same, after `before` has drawn into the white picture.
pub fn png_with_background(
    drawing: &Drawing,
    before: impl FnOnce(&mut RgbImage),
) -> Result<Vec<u8>, FigureError> {
    let typeface = Typeface::load()?;
    let [width, height] =
        [drawing.width, drawing.height].map(|side| (side * SCALE).round().max(1.0) as u32);
    let mut picture = RgbImage::from_pixel(width, height, Pixel([255, 255, 255]));
    before(&mut picture);
    for shape in &drawing.shapes {
        draw(&mut picture, shape, &typeface);
    }
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png)?;
    Ok(png.into_inner())
}

/// Draws one shape.
fn draw(picture: &mut RgbImage, shape: &Shape, typeface: &Typeface) {
    match shape {
        Shape::Path {
            points,
            width,
            colour,
            dashes,
        } => {
            for part in split_into_dashes(points, dashes) {
                stroke(picture, &part, *width, *colour);
            }
        }
        Shape::Area { points, colour } => fill(picture, &polygon(points), *colour),
        Shape::Disc {
            centre,
            radius,
            colour,
        } => fill(picture, &polygon(&circle(*centre, *radius)), *colour),
        Shape::Text {
            text,
            at,
            size,
            anchor,
            upright,
        } => {
            let line = typeface.place_glyphs(text, *size, *anchor);
            let mut outlines = Vec::new();
            for glyph in &line.glyphs {
                outlines.extend(curves(&typeface.outline(glyph.id), |[x, y]| {
                    let [x, y] = [glyph.x + x, y].map(|units| units * line.px_per_unit);
                    // Rotate by 90° anticlockwise: upright text runs from bottom to top.
                    let [x, y] = if *upright { [y, -x] } else { [x, y] };
                    to_pixels([at[0] + x, at[1] + y])
                }));
            }
            fill(picture, &outlines, [0, 0, 0]);
        }
    }
}

fn to_pixels([x, y]: [f64; 2]) -> Point {
    point((x * SCALE) as f32, (y * SCALE) as f32)
}

/// A piece of an outline, in pixels.
#[derive(Clone, Copy)]
enum Piece {
    Line(Point, Point),
    Quad(Point, Point, Point),
    Cubic(Point, Point, Point, Point),
}

impl Piece {
    /// All points, some repeated: the piece lies within their bounding box.
    fn points(&self) -> [Point; 4] {
        match *self {
            Self::Line(a, b) => [a, b, a, b],
            Self::Quad(a, b, c) => [a, b, c, c],
            Self::Cubic(a, b, c, d) => [a, b, c, d],
        }
    }
}

fn polygon(points: &[[f64; 2]]) -> Vec<Piece> {
    let next = points.iter().cycle().skip(1);
    points
        .iter()
        .zip(next)
        .map(|(from, to)| Piece::Line(to_pixels(*from), to_pixels(*to)))
        .collect()
}

fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    (0..CIRCLE_CORNERS)
        .map(|corner| {
            let angle = std::f64::consts::TAU * f64::from(corner) / f64::from(CIRCLE_CORNERS);
            let (sin, cos) = angle.sin_cos();
            [x + radius * cos, y + radius * sin]
        })
        .collect()
}

/// The outline of a glyph in pixels. `place` maps a point of the glyph to the picture.
fn curves(segments: &[OutlineSegment], place: impl Fn([f64; 2]) -> Point) -> Vec<Piece> {
    let mut at = point(0.0, 0.0);
    let mut pieces = Vec::with_capacity(segments.len());
    for segment in segments {
        let end = match segment {
            OutlineSegment::Begin(to) => place(*to),
            OutlineSegment::Line(to) => {
                pieces.push(Piece::Line(at, place(*to)));
                place(*to)
            }
            OutlineSegment::Quad(a, to) => {
                pieces.push(Piece::Quad(at, place(*a), place(*to)));
                place(*to)
            }
            OutlineSegment::Cubic(a, b, to) => {
                pieces.push(Piece::Cubic(at, place(*a), place(*b), place(*to)));
                place(*to)
            }
        };
        at = end;
    }
    pieces
}

/// Draws a line: a rectangle for each segment, a disc at each bend.
fn stroke(picture: &mut RgbImage, points: &[[f64; 2]], width: f64, colour: Rgb) {
    let half = width / 2.0;
    for pair in points.windows(2) {
        let along = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = along[0].hypot(along[1]);
        if length > 0.0 {
            let [nx, ny] = [-along[1] / length * half, along[0] / length * half];
            let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
            let sides = [
                [ax + nx, ay + ny],
                [bx + nx, by + ny],
                [bx - nx, by - ny],
                [ax - nx, ay - ny],
            ];
            fill(picture, &polygon(&sides), colour);
        }
    }
    // Only inner points are bends: the ends of a line stay straight, as SVG draws them by default.
    for bend in points.iter().skip(1).take(points.len().saturating_sub(2)) {
        fill(picture, &polygon(&circle(*bend, half)), colour);
    }
}

/// Splits a line into its dashes. `dashes` are lengths of pen down and pen up in turn; if empty,
/// the line is returned whole.
fn split_into_dashes(points: &[[f64; 2]], dashes: &[f64]) -> Vec<Vec<[f64; 2]>> {
    if dashes.is_empty() || dashes.iter().any(|length| *length <= 0.0) {
        return vec![points.to_vec()];
    }
    // `left` is what remains of the present dash or gap, `part` the points of it so far. The pen is
    // down at even indices. A gap collects points, too, which are dropped where it ends.
    let mut parts = Vec::new();
    let (mut dash, mut left) = (0, dashes[0]);
    let mut part: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = (to[0] - from[0]).hypot(to[1] - from[1]);
        // Cut the segment where the current dash or gap ends.
        while length > left {
            let share = left / length;
            from = [
                from[0] + (to[0] - from[0]) * share,
                from[1] + (to[1] - from[1]) * share,
            ];
            length -= left;
            part.push(from);
            if dash % 2 == 0 {
                parts.push(std::mem::take(&mut part));
            }
            part = vec![from];
            dash = (dash + 1) % dashes.len();
            left = dashes[dash];
        }
        left -= length;
        part.push(to);
    }
    if dash % 2 == 0 {
        parts.push(part);
    }
    parts
}

/// Blends a colour into the picture, by the share of each pixel that the closed outlines cover.
fn fill(picture: &mut RgbImage, outlines: &[Piece], colour: Rgb) {
    let corners = || outlines.iter().flat_map(Piece::points);
    let low = corners().fold(point(f32::INFINITY, f32::INFINITY), |low, p| {
        point(low.x.min(p.x), low.y.min(p.y))
    });
    let high = corners().fold(point(f32::NEG_INFINITY, f32::NEG_INFINITY), |high, p| {
        point(high.x.max(p.x), high.y.max(p.y))
    });
    // Rasterise within the bounding box only, with a margin for partly covered pixels. The control
    // points of a curve enclose it. An empty outline has an infinite box and draws nothing; neither
    // does one that would need a buffer far larger than a figure.
    let origin = point(low.x.floor() - 1.0, low.y.floor() - 1.0);
    let (width, height) = (
        (high.x - origin.x).ceil() + 2.0,
        (high.y - origin.y).ceil() + 2.0,
    );
    if !(width.is_finite() && height.is_finite() && width < 1e4 && height < 1e4) {
        return;
    }
    let mut coverage = Rasterizer::new(width as usize, height as usize);
    let inner = |p: Point| point(p.x - origin.x, p.y - origin.y);
    for piece in outlines {
        match *piece {
            Piece::Line(a, b) => coverage.draw_line(inner(a), inner(b)),
            Piece::Quad(a, b, c) => coverage.draw_quad(inner(a), inner(b), inner(c)),
            Piece::Cubic(a, b, c, d) => coverage.draw_cubic(inner(a), inner(b), inner(c), inner(d)),
        }
    }
    let (left, top) = (origin.x as i64, origin.y as i64);
    coverage.for_each_pixel_2d(|x, y, share| {
        let at = (
            u32::try_from(left + i64::from(x)),
            u32::try_from(top + i64::from(y)),
        );
        let (Ok(x), Ok(y)) = at else { return };
        if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
            let share = share.clamp(0.0, 1.0);
            for (below, over) in pixel.0.iter_mut().zip(colour) {
                *below =
                    (f32::from(*below) * (1.0 - share) + f32::from(over) * share).round() as u8;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_cover_what_they_enclose() {
        let mut picture = RgbImage::from_pixel(100, 60, Pixel([255, 255, 255]));
        let side = |pixels: f64| pixels / SCALE;
        let square =
            [[10.0, 10.0], [30.5, 10.0], [30.5, 20.0], [10.0, 20.0]].map(|p: [f64; 2]| p.map(side));
        fill(&mut picture, &polygon(&square), [0, 0, 0]);
        let darkness: f64 = picture
            .pixels()
            .map(|pixel| 1.0 - f64::from(pixel.0[0]) / 255.0)
            .sum();
        assert!((darkness - 205.0).abs() < 0.5, "{darkness}");
        assert_eq!(
            (picture.get_pixel(15, 15).0, picture.get_pixel(40, 15).0),
            ([0; 3], [255; 3])
        );
        // Beyond the border nothing is drawn, and nothing is harmed.
        fill(
            &mut picture,
            &polygon(&[[-50.0, -50.0], [200.0, -50.0], [200.0, 200.0]]),
            [9, 9, 9],
        );
    }

    #[test]
    fn dashes_add_up() {
        let line = [[0.0, 0.0], [25.0, 0.0]];
        let parts = split_into_dashes(&line, &[6.0, 4.0]);
        let ends: Vec<[f64; 2]> = parts
            .iter()
            .map(|part| [part[0][0], part[part.len() - 1][0]])
            .collect();
        assert_eq!(ends, [[0.0, 6.0], [10.0, 16.0], [20.0, 25.0]]);
        assert_eq!(split_into_dashes(&line, &[]), [line.to_vec()]);
    }
}
