//! Polylines as instances of `stroke.wgsl`.
//!
//! # How a translucent stroke stays even
//!
//! If each segment of a polyline is drawn as a capsule, joins are covered twice. That shows as dark
//! beads when the stroke is translucent, and as soft beads along the anti-aliased border even when
//! it is opaque. Two measures prevent it:
//!
//! 1. Within a stroke, every pixel belongs to one segment. The bisector of their join separates two
//!    neighbouring segments. A point on it is equally far from both: on the inner side from their
//!    interiors, on the outer side from the shared vertex. So the two coverages agree along the
//!    cut, and the result is exactly the union of the capsules, round joins included.
//! 2. A group of strokes is drawn opaque into a texture of its own, rims before cores, and
//!    composited with the group's opacity. So crossings of different strokes are as even as the
//!    strokes, and no rim shows through a core.
//!
//! Miter joins in a triangle strip would replace the first measure, but they spike at acute angles
//! and overlap within tight arcs. A coverage texture with maximum blending would replace both, but
//! only for one colour per texture. The cut assumes that a stroke does not fold back within its own
//! width; where it does, only the soft border of the overlap is affected.

use crate::scene::drawing::{Colour, Dash, Marker, MarkerShape, Stroke};
use bytemuck::{Pod, Zeroable};

/// One segment; the fields are those of `Instance` in `stroke.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    /// The two ends, px of the picture.
    a: [f32; 2],
    b: [f32; 2],
    /// Direction of the bisector at each end; zero at a loose end.
    through_a: [f32; 2],
    through_b: [f32; 2],
    /// Length of the stroke before `a`, px of the picture.
    before_a: f32,
    /// Half the width of the core, points.
    half_width: f32,
    /// Width of the rim beyond the core, points.
    rim_width: f32,
    /// Lengths of dash and gap, points; zeros draw a solid line.
    dash: [f32; 2],
    colour: [u8; 4],
    rim_colour: [u8; 4],
}

/// The layout of [`Segment`] in a vertex buffer.
pub(super) const SEGMENT_ATTRIBUTES: [wgpu::VertexAttribute; 10] = wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Float32,
    5 => Float32, 6 => Float32, 7 => Float32x2, 8 => Unorm8x4, 9 => Unorm8x4
];

/// A colour in the layout of the vertex buffers.
pub(super) fn rgba(colour: Colour) -> [u8; 4] {
    [colour.r, colour.g, colour.b, colour.a]
}

/// Appends the segments of a stroke. Points that are not finite split it; repeated points are
/// dropped.
pub(super) fn append_segments(stroke: &Stroke, segments: &mut Vec<Segment>) {
    for piece in stroke
        .points
        .split(|point| !point.iter().all(|x| x.is_finite()))
    {
        append_piece(stroke, piece, segments);
    }
}

/// Appends the segments of a polyline of finite points.
fn append_piece(stroke: &Stroke, piece: &[[f32; 2]], segments: &mut Vec<Segment>) {
    let mut points = piece.to_vec();
    close_exactly(&mut points);
    // Two equal neighbours have no direction.
    points.dedup();
    if points.len() < 2 {
        return;
    }
    let directions: Vec<[f32; 2]> = points
        .windows(2)
        .map(|pair| direction(pair[0], pair[1]))
        .collect();
    let last = directions.len() - 1;
    // A closed line is cut at its first vertex, too.
    let closing = if points.first() == points.last() {
        bisector(directions[last], directions[0])
    } else {
        [0.0; 2]
    };
    let Dash { on_pt, off_pt } = stroke.dash.unwrap_or(Dash {
        on_pt: 0.0,
        off_pt: 0.0,
    });
    let (rim_width, rim_colour) = stroke.outline.map_or((0.0, [0; 4]), |outline| {
        (outline.width_pt, rgba(outline.colour))
    });
    // The length so far places the dashes, so that they run on over the joins.
    let mut before_a = 0.0;
    for (i, pair) in points.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        segments.push(Segment {
            a,
            b,
            through_a: if i == 0 {
                closing
            } else {
                bisector(directions[i - 1], directions[i])
            },
            through_b: if i == last {
                closing
            } else {
                bisector(directions[i], directions[i + 1])
            },
            before_a,
            half_width: stroke.width_pt / 2.0,
            rim_width,
            dash: [on_pt, off_pt],
            colour: rgba(stroke.colour),
            rim_colour,
        });
        before_a += (b[0] - a[0]).hypot(b[1] - a[1]);
    }
}

/// Makes the last point equal to the first if they differ by less than 0.01 px: the points of a
/// circle are computed one by one, and the last differs from the first by rounding.
fn close_exactly(points: &mut [[f32; 2]]) {
    if let [first, .., last] = points
        && (first[0] - last[0]).hypot(first[1] - last[1]) < 1e-2
        && points.len() > 3
    {
        points[points.len() - 1] = points[0];
    }
}

fn direction(from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let length = x.hypot(y);
    [x / length, y / length]
}

/// The direction of the bisector of two unit vectors, not normalised. Zero, which means no cut, if
/// the stroke reverses its direction.
fn bisector(before: [f32; 2], after: [f32; 2]) -> [f32; 2] {
    let sum = [before[0] + after[0], before[1] + after[1]];
    if sum[0].hypot(sum[1]) < 1e-3 {
        [0.0; 2]
    } else {
        sum
    }
}

/// One marker; the fields are those of `Instance` in `marker.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct MarkerInstance {
    /// Centre, px of the picture.
    at: [f32; 2],
    /// Distance of the outermost point of the core from the centre, points.
    radius: f32,
    /// Width of the lines, points.
    line: f32,
    /// Width of the rim beyond the core, points.
    rim_width: f32,
    /// 0 cross, 1 ring, 2 dot, 3 diamond.
    shape: u32,
    colour: [u8; 4],
    rim_colour: [u8; 4],
}

/// The layout of [`MarkerInstance`] in a vertex buffer.
pub(super) const MARKER_ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32, 2 => Float32, 3 => Float32, 4 => Uint32, 5 => Unorm8x4, 6 => Unorm8x4
];

impl From<&Marker> for MarkerInstance {
    fn from(marker: &Marker) -> Self {
        let (rim_width, rim_colour) = marker.outline.map_or((0.0, [0; 4]), |outline| {
            (outline.width_pt, rgba(outline.colour))
        });
        Self {
            at: marker.at,
            radius: marker.radius_pt,
            line: marker.line_pt,
            rim_width,
            shape: match marker.shape {
                MarkerShape::Cross => 0,
                MarkerShape::Ring => 1,
                MarkerShape::Dot => 2,
                MarkerShape::Diamond => 3,
            },
            colour: rgba(marker.colour),
            rim_colour,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segments(points: &[[f32; 2]]) -> Vec<Segment> {
        let stroke = Stroke {
            points: points.to_vec(),
            colour: Colour::rgb(255, 255, 255),
            width_pt: 2.0,
            outline: None,
            dash: None,
        };
        let mut segments = Vec::new();
        append_segments(&stroke, &mut segments);
        segments
    }

    #[test]
    fn neighbours_share_their_cut_and_loose_ends_have_none() {
        let line = segments(&[[0.0, 0.0], [3.0, 4.0], [3.0, 4.0], [10.0, 4.0]]);
        assert_eq!(line.len(), 2);
        assert_eq!(line[0].through_a, [0.0; 2]);
        assert_eq!(line[0].through_b, line[1].through_a);
        assert_ne!(line[0].through_b, [0.0; 2]);
        assert_eq!(line[1].through_b, [0.0; 2]);
        assert_eq!(line[1].before_a, 5.0);
    }

    #[test]
    fn a_closed_line_is_cut_where_it_closes() {
        let square = segments(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]]);
        assert_eq!(square.len(), 4);
        assert_eq!(square[0].through_a, square[3].through_b);
        assert_ne!(square[0].through_a, [0.0; 2]);
    }

    #[test]
    fn what_is_not_a_number_leaves_a_gap() {
        assert!(segments(&[]).is_empty());
        assert!(segments(&[[1.0, 1.0], [1.0, 1.0]]).is_empty());
        let broken = segments(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [f32::NAN, 0.0],
            [2.0, 0.0],
            [3.0, 0.0],
        ]);
        assert_eq!(
            broken.iter().map(|s| (s.a[0], s.b[0])).collect::<Vec<_>>(),
            [(0.0, 1.0), (2.0, 3.0)]
        );
        assert_eq!(
            segments(&[[0.0, 0.0], [5.0, 0.0], [0.0, 0.0]])[0].through_b,
            [0.0; 2]
        );
    }
}
