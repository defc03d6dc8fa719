//! A drawing as SVG.
//!
//! Text is drawn as outlines, so that a viewer without the typeface shows the same figure. Each
//! glyph that occurs is defined once, in font units: they are integers, apart from some halves, and
//! one definition serves all sizes and both directions. A glyph's id is its number in the typeface,
//! so figures that share an HTML page agree about it. The text itself is the label of its group,
//! for screen readers.

use super::FigureError;
use super::shape::{Drawing, Rgb, Shape};
use super::typeface::{OutlineSegment, TextLine, Typeface};
use ab_glyph::GlyphId;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use touchline_core::geometry::{decimal, xml_text};

/// The SVG document of a drawing. `title` names it for screen readers.
pub fn write(drawing: &Drawing, title: &str) -> Result<String, FigureError> {
    let typeface = Typeface::load()?;
    // Shapes first: they show which glyphs have to be defined above them.
    let mut shapes = String::new();
    let mut glyphs = BTreeSet::new();
    for shape in &drawing.shapes {
        write_shape(&mut shapes, shape, &typeface, &mut glyphs);
    }

    let (width, height) = (number(drawing.width), number(drawing.height));
    let title = xml_text(title);
    // `xlink:href` is what viewers that do not know SVG 2 understand.
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{title}</title>\n\
         <defs>\n"
    );
    for glyph in glyphs {
        let path = path(&typeface.outline(glyph));
        // Writing to a string cannot fail.
        let _ = writeln!(out, "<path id=\"g{}\" d=\"{path}\"/>", glyph.0);
    }
    let _ = write!(
        out,
        "</defs>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <g stroke-linejoin=\"round\" fill=\"none\">\n\
         {shapes}</g>\n</svg>\n"
    );
    Ok(out)
}

/// Writes one shape, and adds the glyphs that it refers to.
fn write_shape(
    out: &mut String,
    shape: &Shape,
    typeface: &Typeface,
    glyphs: &mut BTreeSet<GlyphId>,
) {
    // Writing to a string cannot fail.
    let _ = match shape {
        Shape::Path {
            points,
            width,
            colour,
            dashes,
        } => {
            let dashes = if dashes.is_empty() {
                String::new()
            } else {
                let lengths = dashes
                    .iter()
                    .map(|length| number(*length))
                    .collect::<Vec<_>>()
                    .join(" ");
                format!(" stroke-dasharray=\"{lengths}\"")
            };
            let (points, width, colour) = (list(points), number(*width), hex(*colour));
            writeln!(
                out,
                "<polyline points=\"{points}\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>"
            )
        }
        Shape::Area { points, colour } => {
            writeln!(
                out,
                "<polygon points=\"{}\" fill=\"{}\"/>",
                list(points),
                hex(*colour)
            )
        }
        Shape::Disc {
            centre,
            radius,
            colour,
        } => {
            let [x, y] = centre.map(number);
            writeln!(
                out,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"{}\"/>",
                number(*radius),
                hex(*colour)
            )
        }
        Shape::Text {
            text,
            at,
            size,
            anchor,
            upright,
        } => {
            // The group's transform leads from font units to px, so that glyphs are used unscaled.
            // It needs more decimals than a position, because hundreds of units multiply it.
            let line = typeface.place_glyphs(text, *size, *anchor);
            let [x, y] = at.map(number);
            let turn = if *upright { " rotate(-90)" } else { "" };
            let scale = decimal(line.px_per_unit, 6);
            let (text, uses) = (xml_text(text), uses(&line, typeface, glyphs));
            writeln!(
                out,
                "<g role=\"img\" aria-label=\"{text}\" fill=\"#000\" transform=\"translate({x} {y}){turn} scale({scale})\">{uses}</g>"
            )
        }
    };
}

/// References to the glyphs of a line of text, in font units. Spaces need none.
fn uses(line: &TextLine, typeface: &Typeface, glyphs: &mut BTreeSet<GlyphId>) -> String {
    let mut out = String::new();
    for glyph in &line.glyphs {
        if typeface.outline(glyph.id).is_empty() {
            continue;
        }
        glyphs.insert(glyph.id);
        let (id, x) = (glyph.id.0, number(glyph.x));
        // Writing to a string cannot fail.
        let _ = write!(out, "<use xlink:href=\"#g{id}\" x=\"{x}\"/>");
    }
    out
}

/// The path of an outline, in relative commands, which have fewer digits than absolute ones.
fn path(segments: &[OutlineSegment]) -> String {
    let mut out = String::new();
    let mut from = [0; 2];
    for segment in segments {
        let (command, points) = match *segment {
            OutlineSegment::Begin(to) => ('m', vec![to]),
            OutlineSegment::Line(to) => ('l', vec![to]),
            OutlineSegment::Quad(a, to) => ('q', vec![a, to]),
            OutlineSegment::Cubic(a, b, to) => ('c', vec![a, b, to]),
        };
        out.push(command);
        // Positions are rounded before they are subtracted, so that rounding does not add up.
        let points: Vec<[i64; 2]> = points.into_iter().map(tenths).collect();
        let steps: Vec<i64> = points
            .iter()
            .flat_map(|[x, y]| [x - from[0], y - from[1]])
            .collect();
        for (index, step) in steps.iter().enumerate() {
            // A minus sign separates numbers, too.
            if index > 0 && *step >= 0 {
                out.push(' ');
            }
            out.push_str(&decimal(*step as f64 / 10.0, 1));
        }
        from = points.last().copied().unwrap_or(from);
    }
    out
}

/// Rounds a position to tenths of a font unit.
fn tenths(point: [f64; 2]) -> [i64; 2] {
    point.map(|units| (units * 10.0).round() as i64)
}

fn list(points: &[[f64; 2]]) -> String {
    points
        .iter()
        .map(|[x, y]| format!("{},{}", number(*x), number(*y)))
        .collect::<Vec<_>>()
        .join(" ")
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Formats px or font units with at most two decimals.
fn number(value: f64) -> String {
    decimal(value, 2)
}

#[cfg(test)]
mod tests {
    use super::super::shape::Anchor;
    use super::*;

    fn text(text: &str, size: f64, upright: bool) -> Shape {
        Shape::Text {
            text: text.to_owned(),
            at: [20.0, 30.0],
            size,
            anchor: Anchor::Start,
            upright,
        }
    }

    fn svg(shapes: Vec<Shape>) -> String {
        let drawing = Drawing {
            width: 100.0,
            height: 60.0,
            shapes,
        };
        write(&drawing, "a \"b\"").unwrap()
    }

    #[test]
    fn text_is_drawn_as_outlines_that_are_defined_once() {
        let svg = svg(vec![text("- --", 13.0, false), text("-", 12.0, true)]);
        assert!(!svg.contains("<text") && !svg.contains("font"));
        let typeface = Typeface::load().unwrap();
        let id = typeface.place_glyphs("-", 1.0, Anchor::Start).glyphs[0]
            .id
            .0;
        // The hyphen of Ubuntu Light is a rectangle of 226 × 63 font units.
        let path = "m28-321l226 0l0 63l-226 0l0-63";
        assert_eq!(svg.matches("<path id=").count(), 1);
        assert!(
            svg.contains(&format!("<path id=\"g{id}\" d=\"{path}\"/>")),
            "{svg}"
        );
        assert_eq!(
            svg.matches(&format!("<use xlink:href=\"#g{id}\"")).count(),
            4
        );
    }

    #[test]
    fn text_keeps_its_place_direction_and_label() {
        let svg = svg(vec![text("a < \"b\"", 13.0, false), text("c", 12.5, true)]);
        assert!(svg.contains("<title>a &quot;b&quot;</title>"));
        let level = "aria-label=\"a &lt; &quot;b&quot;\" fill=\"#000\" transform=\"translate(20 30) scale(0.013)\"";
        let upright = "aria-label=\"c\" fill=\"#000\" transform=\"translate(20 30) rotate(-90) scale(0.0125)\"";
        assert!(svg.contains(level) && svg.contains(upright), "{svg}");
    }

    #[test]
    fn paths_do_not_gather_rounding_errors() {
        let mut strokes = vec![OutlineSegment::Begin([0.0, 0.0])];
        strokes
            .extend((1..=4).map(|number| OutlineSegment::Line([0.26 * f64::from(number), -1.5])));
        assert_eq!(path(&strokes), "m0 0l0.3-1.5l0.2 0l0.3 0l0.2 0");
    }
}
