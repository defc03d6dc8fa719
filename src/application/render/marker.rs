//! Markers as instances of `marker.wgsl`.

use super::stroke::rgba;
use crate::scene::drawing::{Marker, MarkerShape};
use bytemuck::{Pod, Zeroable};

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
