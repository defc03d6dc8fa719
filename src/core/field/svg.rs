//! A field seen from above as an SVG: lines at their real width, landmarks with their codes.

use super::{Curve, FieldLine, FieldModel};
use crate::geometry::{Vec3, decimal, xml_text};
use std::fmt::Write as _;

/// The minimum margin around the field, m; landmarks outside the field are included.
const MARGIN_M: f64 = 2.0;

/// The drawing's width, px.
const WIDTH_PX: f64 = 1600.0;

/// Draws a field from above, x to the right and y up; parts above the ground are drawn at their x
/// and y.
pub fn svg(field: &FieldModel) -> String {
    // Half the extent of field and landmarks; the drawing is symmetric about the field's middle.
    let corner = field
        .landmarks
        .iter()
        .map(|landmark| landmark.nominal_m)
        .fold(
            Vec3::new(field.length_m / 2.0, field.width_m / 2.0, 0.0),
            |corner, at| Vec3::new(corner.x.max(at.x.abs()), corner.y.max(at.y.abs()), 0.0),
        );
    let reach_m = corner + Vec3::new(MARGIN_M, MARGIN_M, 0.0);
    let plan = Plan {
        reach_m,
        px_per_m: WIDTH_PX / (2.0 * reach_m.x),
    };
    let height_px = plan.length(2.0 * reach_m.y);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"{height_px}\">\n\
         <title>{}</title>\n\
         <rect width=\"{WIDTH_PX}\" height=\"{height_px}\" fill=\"#215c38\"/>\n\
         <g fill=\"none\" stroke=\"#f4f7f4\" stroke-linecap=\"square\">\n",
        xml_text(&field.template),
    );
    for line in &field.lines {
        out.push_str(&plan.line(line));
    }
    out.push_str(
        "</g>\n<g fill=\"#ffd54a\" stroke=\"none\" font-family=\"sans-serif\" font-size=\"13\">\n",
    );
    for landmark in &field.landmarks {
        let [x, y] = plan.at(landmark.nominal_m);
        let title = xml_text(&landmark.label);
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "<g><title>{title}</title><circle cx=\"{x}\" cy=\"{y}\" r=\"3\"/></g>"
        );
        // From above, the top of a post lies on its foot, and two codes would cover each other.
        if landmark.is_on_ground() {
            let _ = writeln!(
                out,
                "<text x=\"{x}\" y=\"{y}\" dx=\"4\" dy=\"-4\">{}</text>",
                landmark.code
            );
        }
    }
    out.push_str("</g>\n</svg>\n");
    out
}

/// The scale and origin of the drawing.
struct Plan {
    /// From the middle to the drawing's border, m.
    reach_m: Vec3,
    px_per_m: f64,
}

impl Plan {
    /// A point of the field in the drawing, px.
    fn at(&self, place_m: Vec3) -> [String; 2] {
        [(self.reach_m.x + place_m.x), (self.reach_m.y - place_m.y)]
            .map(|metres| self.length(metres))
    }

    /// A length in the drawing, px.
    fn length(&self, metres: f64) -> String {
        decimal(metres * self.px_per_m, 2)
    }

    fn line(&self, line: &FieldLine) -> String {
        let [from, to] = [0.0, 1.0].map(|t| self.at(line.paint_centre.point_at(t)));
        let ([x1, y1], [x2, y2]) = (from, to);
        let (tag, place) = match line.paint_centre {
            Curve::Segment { .. } => (
                "line",
                format!("x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\""),
            ),
            Curve::Arc {
                centre, radius_m, ..
            } if line.curve.is_closed() => {
                let [x, y] = self.at(centre);
                (
                    "circle",
                    format!("cx=\"{x}\" cy=\"{y}\" r=\"{}\"", self.length(radius_m)),
                )
            }
            Curve::Arc {
                radius_m, sweep, ..
            } => {
                let large = u8::from(sweep.radians().abs() > std::f64::consts::PI);
                // In the drawing y points down, which reverses the sense of rotation.
                let clockwise = u8::from(sweep.radians() < 0.0);
                let radius = self.length(radius_m);
                (
                    "path",
                    format!(
                        "d=\"M {x1} {y1} A {radius} {radius} 0 {large} {clockwise} {x2} {y2}\""
                    ),
                )
            }
        };
        let colour = if line.painted {
            ""
        } else {
            " stroke=\"#7fb4ff\""
        };
        let width = self.length(line.width_m);
        let dashes = line.dash_m.map_or_else(String::new, |[dash_m, gap_m]| {
            let [dash, gap] = [dash_m, gap_m].map(|along_m| self.length(along_m));
            format!(" stroke-dasharray=\"{dash} {gap}\"")
        });
        let title = xml_text(&line.label);
        let look = format!("stroke-width=\"{width}\"{dashes}{colour}");
        format!("<g><title>{title}</title><{tag} {place} {look}/></g>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{builtin, builtin_names};
    use crate::testing::soccer;

    #[test]
    fn every_template_draws_all_its_lines_and_landmarks() {
        for name in builtin_names() {
            let field = builtin(name).unwrap().default_model().unwrap();
            let text = svg(&field);
            assert_eq!(
                text.matches("stroke-width").count(),
                field.lines.len(),
                "{name}"
            );
            assert_eq!(
                text.matches("r=\"3\"").count(),
                field.landmarks.len(),
                "{name}"
            );
            assert!(!text.contains("NaN") && !text.contains("inf\""), "{name}");
        }
    }

    #[test]
    fn an_arc_bends_the_way_it_does_on_the_field() {
        let field = soccer();
        let plan = Plan {
            reach_m: Vec3::new(60.0, 40.0, 0.0),
            px_per_m: 10.0,
        };
        // The left penalty arc runs from near to far with its apex towards the middle:
        // counter-clockwise in the world.
        let arc = plan.line(field.line("penalty_arc_left").unwrap());
        assert!(
            arc.contains("<path d=\"M 239.64 472.65 A 90.9 90.9 0 0 0 239.64 327.35\""),
            "{arc}"
        );
        assert_eq!(
            plan.line(field.line("halfway_line").unwrap()),
            "<g><title>Halfway line</title><line x1=\"600\" y1=\"740\" x2=\"600\" y2=\"60\" stroke-width=\"1.2\"/></g>\n"
        );
    }
}
