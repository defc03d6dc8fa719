//! A heat map over the picture: a small texture of levels, which the shader maps to colours.

use super::gpu::{Gpu, bind_texture, create_texture};
use super::stroke::rgba;
use crate::scene::uncertainty::{HEAT_STOPS, HeatMap};
use bytemuck::{Pod, Zeroable};
use touchline_core::geometry::ImageSize;

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
pub(super) fn bind(
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
