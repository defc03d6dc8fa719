//! Groups of strokes: drawn opaque into a texture of their own, then composited onto the canvas.

use super::gpu::{bind_texture, create_texture};
use crate::scene::drawing::StrokeGroup;
use bytemuck::{Pod, Zeroable};

/// The format of those textures, in gamma space.
pub(super) const GROUP_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A group of strokes to be composited; the fields are those of `Instance` in `composite.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GroupInstance {
    clip: [f32; 4],
    opacity: f32,
}

/// The layout of [`GroupInstance`] in a vertex buffer.
pub(super) const GROUP_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32];

/// A box that clips nothing. Finite, so that it stays finite when it is scaled to the canvas.
const EVERYWHERE: [f32; 4] = [-1e9, -1e9, 1e9, 1e9];

impl From<&StrokeGroup> for GroupInstance {
    fn from(group: &StrokeGroup) -> Self {
        Self {
            clip: group.clip_px.unwrap_or(EVERYWHERE),
            opacity: group.opacity.min(1.0),
        }
    }
}

/// A texture for one group of strokes, with the size of the canvas.
#[derive(Debug)]
pub(super) struct GroupTarget {
    pub view: wgpu::TextureView,
    pub bind_group: wgpu::BindGroup,
    pub size_px: [u32; 2],
}

impl GroupTarget {
    pub fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, size_px: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = create_texture(device, "stroke group", size_px, 1, GROUP_FORMAT, usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bind_group = bind_texture(device, "stroke group", layout, &view, None);
        Self {
            view,
            bind_group,
            size_px,
        }
    }
}
