//! The render pipelines and their bind group layouts, built once for a device and a target format.

use super::fill::{FILL_ATTRIBUTES, FillVertex, HEAT_ATTRIBUTES, HeatInstance};
use super::gpu::{bind_texture, create_texture, layout, module, sampler, texture, uniform};
use super::picture::{PICTURE_ATTRIBUTES, PictureInstance};
use super::stroke::{MARKER_ATTRIBUTES, MarkerInstance, SEGMENT_ATTRIBUTES, Segment};
use crate::scene::drawing::StrokeGroup;
use bytemuck::{Pod, Zeroable};
use touchline_shaders::{COMPOSITE, FILL, HEAT, MARKER, PICTURE, STROKE, Shader};
use wgpu::VertexStepMode::{Instance, Vertex};

/// All pipelines.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub view_layout: wgpu::BindGroupLayout,
    pub picture_layout: wgpu::BindGroupLayout,
    pub group_layout: wgpu::BindGroupLayout,
    pub picture: wgpu::RenderPipeline,
    pub fill: wgpu::RenderPipeline,
    pub heat: wgpu::RenderPipeline,
    pub rim: wgpu::RenderPipeline,
    pub core: wgpu::RenderPipeline,
    pub composite: wgpu::RenderPipeline,
    pub marker: wgpu::RenderPipeline,
}

/// What distinguishes one pipeline from the others.
struct Parts<'a> {
    shader: Shader,
    vertex_entry: &'a str,
    fragment_entry: &'a str,
    layouts: &'a [&'a wgpu::BindGroupLayout],
    buffer: wgpu::VertexBufferLayout<'a>,
    topology: wgpu::PrimitiveTopology,
    format: wgpu::TextureFormat,
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let view_layout = layout(
            device,
            "view",
            &[(0, wgpu::ShaderStages::VERTEX, uniform())],
        );
        let texture_layout = (0, wgpu::ShaderStages::FRAGMENT, texture());
        let picture_layout = layout(
            device,
            "picture",
            &[texture_layout, (1, wgpu::ShaderStages::FRAGMENT, sampler())],
        );
        let group_layout = layout(device, "stroke group", &[texture_layout]);
        // Everything but areas is a quad for each instance: the vertex shader places its four
        // corners by the vertex index.
        let strip = wgpu::PrimitiveTopology::TriangleStrip;
        let stroke_layouts = [&view_layout];
        // Rims and cores differ in the vertex shader only. They are two pipelines, so that all rims
        // of a group are drawn before its cores.
        let stroke = |vertex_entry| Parts {
            shader: STROKE,
            vertex_entry,
            fragment_entry: "fs_stroke",
            layouts: &stroke_layouts,
            buffer: vertex_buffer::<Segment>(Instance, &SEGMENT_ATTRIBUTES),
            topology: strip,
            format: GROUP_FORMAT,
        };
        Self {
            picture: pipeline(
                device,
                &Parts {
                    shader: PICTURE,
                    vertex_entry: "vs_picture",
                    fragment_entry: "fs_picture",
                    layouts: &[&view_layout, &picture_layout],
                    buffer: vertex_buffer::<PictureInstance>(Instance, &PICTURE_ATTRIBUTES),
                    topology: strip,
                    format,
                },
            ),
            fill: pipeline(
                device,
                &Parts {
                    shader: FILL,
                    vertex_entry: "vs_fill",
                    fragment_entry: "fs_fill",
                    layouts: &[&view_layout],
                    buffer: vertex_buffer::<FillVertex>(Vertex, &FILL_ATTRIBUTES),
                    topology: wgpu::PrimitiveTopology::TriangleList,
                    format,
                },
            ),
            heat: pipeline(
                device,
                &Parts {
                    shader: HEAT,
                    vertex_entry: "vs_heat",
                    fragment_entry: "fs_heat",
                    layouts: &[&view_layout, &group_layout],
                    buffer: vertex_buffer::<HeatInstance>(Instance, &HEAT_ATTRIBUTES),
                    topology: strip,
                    format,
                },
            ),
            rim: pipeline(device, &stroke("vs_rim")),
            core: pipeline(device, &stroke("vs_core")),
            composite: pipeline(
                device,
                &Parts {
                    shader: COMPOSITE,
                    vertex_entry: "vs_composite",
                    fragment_entry: "fs_composite",
                    layouts: &[&view_layout, &group_layout],
                    buffer: vertex_buffer::<GroupInstance>(Instance, &GROUP_ATTRIBUTES),
                    topology: strip,
                    format,
                },
            ),
            marker: pipeline(
                device,
                &Parts {
                    shader: MARKER,
                    vertex_entry: "vs_marker",
                    fragment_entry: "fs_marker",
                    layouts: &[&view_layout],
                    buffer: vertex_buffer::<MarkerInstance>(Instance, &MARKER_ATTRIBUTES),
                    topology: strip,
                    format,
                },
            ),
            view_layout,
            picture_layout,
            group_layout,
        }
    }
}

fn vertex_buffer<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout {
        array_stride: size_of::<T>() as u64,
        step_mode,
        attributes,
    }
}

fn pipeline(device: &wgpu::Device, parts: &Parts<'_>) -> wgpu::RenderPipeline {
    let label = Some(parts.vertex_entry);
    let module = module(device, parts.shader);
    let layouts: Vec<_> = parts.layouts.iter().copied().map(Some).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(parts.vertex_entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(parts.buffer.clone())],
        },
        primitive: wgpu::PrimitiveState {
            topology: parts.topology,
            ..wgpu::PrimitiveState::default()
        },
        // The order of the layers replaces a depth test, and the shaders smooth edges themselves.
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(parts.fragment_entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: parts.format,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

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
