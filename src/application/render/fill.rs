//! Filled polygons as triangles of `fill.wgsl`, with a soft border 1 px wide, and heat maps.

use super::gpu::{Gpu, bind_texture, create_texture};
use super::stroke::rgba;
use crate::scene::drawing::Area;
use crate::scene::uncertainty::{HEAT_STOPS, HeatMap};
use bytemuck::{Pod, Zeroable};
use touchline_core::geometry::ImageSize;

/// One corner of a triangle; the fields are those of `Vertex` in `fill.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FillVertex {
    /// The corner, px of the picture.
    at: [f32; 2],
    /// Shift of the corner for the soft border, px of the canvas.
    shift: [f32; 2],
    colour: [u8; 4],
}

/// The layout of [`FillVertex`] in a vertex buffer.
pub(super) const FILL_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4];

/// Appends the triangles of an area. An area with fewer than three corners, or with a corner that
/// is not finite, has none.
///
/// The polygon is drawn 0.5 px smaller than it is. A band from there to 0.5 px outside fades to
/// transparent, so that the opacity of a border pixel approximates the share that the polygon
/// covers.
pub(super) fn append_triangles(area: &Area, vertices: &mut Vec<FillVertex>) {
    let Some(corners) = counter_clockwise(&area.corners) else {
        return;
    };
    let colour = rgba(area.colour);
    let clear = [colour[0], colour[1], colour[2], 0];
    let count = corners.len();
    let outward: Vec<[f32; 2]> = (0..count)
        .map(|i| half_px_outward(with_neighbours(&corners, i)))
        .collect();
    let inner = |i: usize| FillVertex {
        at: corners[i],
        shift: outward[i].map(|x| -x),
        colour,
    };
    let outer = |i: usize| FillVertex {
        at: corners[i],
        shift: outward[i],
        colour: clear,
    };
    // The inside, and for each edge two triangles of the soft border.
    for triangle in triangulate(&corners) {
        vertices.extend(triangle.map(inner));
    }
    for i in 0..count {
        let j = (i + 1) % count;
        vertices.extend([inner(i), outer(i), inner(j), inner(j), outer(i), outer(j)]);
    }
}

/// The corners without repetitions, ordered from +x towards +y around the polygon. `None` if they
/// span no area.
fn counter_clockwise(corners: &[[f32; 2]]) -> Option<Vec<[f32; 2]>> {
    // A repeated corner has no edge, and an edge without length has no normal.
    let mut corners = corners.to_vec();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    let finite = corners.iter().flatten().all(|x| x.is_finite());
    let doubled_area: f32 = (0..corners.len())
        .map(|i| cross(corners[i], corners[(i + 1) % corners.len()]))
        .sum::<f32>();
    if !finite || corners.len() < 3 || doubled_area == 0.0 {
        return None;
    }
    // The y axis points down: a positive area runs clockwise on screen. Only the sign matters here,
    // so that normals point outwards.
    if doubled_area < 0.0 {
        corners.reverse();
    }
    Some(corners)
}

fn cross(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[1] - a[1] * b[0]
}

/// Twice the signed area of a triangle; positive if its corners run from +x towards +y.
fn turn(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f32 {
    cross([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]])
}

/// The shift of a corner when both its edges move outwards by 0.5 px: (n + m) / |n + m|² for the
/// unit normals n and m. |n + m|² is at least 0.25, so that acute corners do not become spikes.
fn half_px_outward([before, at, after]: [[f32; 2]; 3]) -> [f32; 2] {
    let (n, m) = (unit_normal(before, at), unit_normal(at, after));
    let sum = [n[0] + m[0], n[1] + m[1]];
    let squared = (sum[0] * sum[0] + sum[1] * sum[1]).max(0.25);
    sum.map(|x| x / squared)
}

/// The unit normal (y, −x) / |(x, y)| of an edge.
fn unit_normal(from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let length = x.hypot(y);
    [y / length, -x / length]
}

/// Triangulates a simple polygon, whose corners run from +x towards +y, by ear clipping (Meisters
/// 1975), O(n²).
fn triangulate(corners: &[[f32; 2]]) -> Vec<[usize; 3]> {
    let mut rest: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    while rest.len() > 3 {
        // Cut off an ear and go on with the rest. An ear is a convex corner that forms a triangle
        // with its neighbours in which no other corner lies.
        let ear = (0..rest.len()).find(|&i| {
            let [a, b, c] = with_neighbours(&rest, i);
            turn(corners[a], corners[b], corners[c]) > 0.0
                && !rest
                    .iter()
                    .any(|&p| p != a && p != b && p != c && in_triangle(corners, p, [a, b, c]))
        });
        // A polygon that crosses itself may have no ear left; then cut any corner.
        let i = ear.unwrap_or(0);
        triangles.push(with_neighbours(&rest, i));
        rest.remove(i);
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    triangles
}

/// An item of a closed chain, between the one before it and the one after it.
fn with_neighbours<T: Copy>(chain: &[T], i: usize) -> [T; 3] {
    let count = chain.len();
    [
        chain[(i + count - 1) % count],
        chain[i],
        chain[(i + 1) % count],
    ]
}

fn in_triangle(corners: &[[f32; 2]], p: usize, [a, b, c]: [usize; 3]) -> bool {
    let (p, a, b, c) = (corners[p], corners[a], corners[b], corners[c]);
    turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
}

/// One heat map; the fields are those of `Instance` in `heat.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct HeatInstance {
    size: [f32; 2],
    opacity: f32,
    colours: [[u8; 4]; HEAT_STOPS.len()],
}

/// The layout of [`HeatInstance`] in a vertex buffer.
pub(super) const HEAT_ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32, 2 => Unorm8x4, 3 => Unorm8x4, 4 => Unorm8x4, 5 => Unorm8x4, 6 => Unorm8x4
];

impl HeatInstance {
    pub fn new(image_size: ImageSize, opacity: f32) -> Self {
        let size = [image_size.width as f32, image_size.height as f32];
        Self {
            size,
            opacity,
            colours: HEAT_STOPS.map(rgba),
        }
    }
}

/// Uploads the levels for one frame. `None` for an empty map.
pub(super) fn bind_heat(
    gpu: &Gpu<'_>,
    layout: &wgpu::BindGroupLayout,
    heat: &HeatMap,
) -> Option<wgpu::BindGroup> {
    let [width, height] = heat.size;
    if width == 0 || heat.levels.len() != (width * height) as usize {
        return None;
    }
    // Every adapter reads 8-bit channels, but 16-bit ones are optional. So upload a low and a high
    // byte for each level.
    let bytes: Vec<u8> = heat
        .levels
        .iter()
        .flat_map(|level| level.to_le_bytes())
        .collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let format = wgpu::TextureFormat::Rg8Unorm;
    let texture = create_texture(gpu.device, "heat map", heat.size, 1, format, usage);
    gpu.queue.write_texture(
        texture.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(2 * width),
            rows_per_image: Some(height),
        },
        texture.size(),
    );
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    Some(bind_texture(gpu.device, "heat map", layout, &view, None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::drawing::Colour;

    fn area_of(corners: &[[f32; 2]], triangles: &[[usize; 3]]) -> f32 {
        triangles
            .iter()
            .map(|&[a, b, c]| turn(corners[a], corners[b], corners[c]) / 2.0)
            .sum()
    }

    #[test]
    fn triangles_fill_a_polygon_with_a_notch() {
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        let triangles = triangulate(&notched);
        assert_eq!(triangles.len(), 3);
        assert_eq!(area_of(&notched, &triangles), 10.0);
        assert!(
            triangles
                .iter()
                .all(|&[a, b, c]| turn(notched[a], notched[b], notched[c]) > 0.0)
        );
    }

    #[test]
    fn what_spans_no_area_is_not_drawn() {
        for corners in [
            vec![],
            vec![[0.0, 0.0], [1.0, 1.0]],
            vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
            vec![[0.0, 0.0], [f32::NAN, 1.0], [2.0, 0.0]],
        ] {
            let mut vertices = Vec::new();
            append_triangles(
                &Area {
                    corners,
                    colour: Colour::rgb(0, 0, 0),
                },
                &mut vertices,
            );
            assert!(vertices.is_empty());
        }
    }

    #[test]
    fn the_soft_border_points_outwards_in_either_direction_of_turning() {
        let mut square = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        for _ in 0..2 {
            let corners = counter_clockwise(&square).unwrap();
            let first = corners
                .iter()
                .position(|&corner| corner == [10.0, 10.0])
                .unwrap();
            let shift = half_px_outward(with_neighbours(&corners, first));
            assert_eq!(shift, [0.5, 0.5]);
            square.reverse();
        }
    }
}
