//! A drawing as SVG.

use super::shape::{Anchor, Drawing, Rgb, Shape};
use std::fmt::Write as _;

/// The SVG document of a drawing; `title` is for screen readers.
pub fn write(drawing: &Drawing, title: &str) -> String {
    let (width, height) = (number(drawing.width), number(drawing.height));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <g font-family=\"Ubuntu, Helvetica, Arial, sans-serif\" stroke-linejoin=\"round\" fill=\"none\">\n",
        escaped(title)
    );
    for shape in &drawing.shapes {
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
                let [x, y] = at.map(number);
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let turn = if *upright {
                    format!(" transform=\"rotate(-90 {x} {y})\"")
                } else {
                    String::new()
                };
                let (text, size) = (escaped(text), number(*size));
                writeln!(
                    out,
                    "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"#000\"{turn}>{text}</text>"
                )
            }
        };
    }
    out.push_str("</g>\n</svg>\n");
    out
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

/// Formats px with at most two decimals, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
