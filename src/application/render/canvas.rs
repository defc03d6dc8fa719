//! The state of one canvas between `prepare` and `paint`: view, vertices, draw calls.

use super::fill::{FillVertex, HeatInstance, append_triangles, bind_heat};
use super::gpu::Gpu;
use super::picture::{PictureCache, PictureInstance};
use super::pipelines::{GroupInstance, GroupTarget, Pipelines};
use super::stroke::{MarkerInstance, append_segments};
use super::view::{Layer, View};
use crate::scene::drawing::{Drawing, StrokeGroup};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// The view, laid out as in `view.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ViewUniform {
    scale: f32,
    pixels_per_point: f32,
    offset: [f32; 2],
    size: [f32; 2],
}

/// One draw call of `paint`: the range of its vertices in the buffer, and their number.
#[derive(Debug)]
enum Draw {
    Picture {
        bind_group: wgpu::BindGroup,
        bytes: Range<u64>,
    },
    Heat {
        bind_group: wgpu::BindGroup,
        bytes: Range<u64>,
    },
    Fill {
        bytes: Range<u64>,
        vertices: u32,
    },
    Group {
        target: usize,
        bytes: Range<u64>,
    },
    Markers {
        bytes: Range<u64>,
        instances: u32,
    },
}

/// A group of strokes that `prepare` draws into a texture of its own.
struct PendingGroup {
    bytes: Range<u64>,
    instances: u32,
}

/// A canvas and its GPU resources.
#[derive(Debug)]
pub(super) struct Canvas {
    uniform: wgpu::Buffer,
    view_bind_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    targets: Vec<GroupTarget>,
    draws: Vec<Draw>,
}

impl Canvas {
    pub fn new(device: &wgpu::Device, pipelines: &Pipelines) -> Self {
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<ViewUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &pipelines.view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: uniform.as_entire_binding(),
            }],
        });
        let vertices = vertex_buffer(device, 1 << 16);
        Self {
            uniform,
            view_bind_group,
            vertices,
            targets: Vec::new(),
            draws: Vec::new(),
        }
    }

    /// Uploads what the layers need and draws their groups of strokes into textures.
    pub fn prepare(
        &mut self,
        gpu: &mut Gpu<'_>,
        pipelines: &Pipelines,
        pictures: &mut PictureCache,
        view: &View,
        layers: &[Layer],
    ) {
        self.draws.clear();
        // A panel without extent, or a scale of zero or NaN: paint nothing.
        if view.size_px.contains(&0) || !(view.scale > 0.0) {
            return;
        }
        let uniform = ViewUniform {
            scale: view.scale,
            pixels_per_point: view.pixels_per_point,
            offset: view.offset_px,
            size: view.size_px.map(|px| px as f32),
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));

        // Collect the vertices of all layers in one buffer, and one draw call for each.
        let mut bytes = Vec::new();
        let mut groups = Vec::new();
        for layer in layers {
            match layer {
                Layer::Picture(picture) => {
                    let bound =
                        pictures.bind(gpu, &pipelines.picture_layout, picture, view.scale < 1.0);
                    if let Some((bind_group, texture_width)) = bound {
                        let instance = PictureInstance::new(picture, texture_width, view);
                        self.draws.push(Draw::Picture {
                            bind_group,
                            bytes: append(&mut bytes, &[instance]),
                        });
                    }
                }
                Layer::Heat(map, opacity) => {
                    if let Some(bind_group) = bind_heat(gpu, &pipelines.group_layout, map) {
                        let instance = HeatInstance::new(map.image_size, opacity.clamp(0.0, 1.0));
                        self.draws.push(Draw::Heat {
                            bind_group,
                            bytes: append(&mut bytes, &[instance]),
                        });
                    }
                }
                Layer::Drawing(drawing) => self.append_drawing(drawing, &mut bytes, &mut groups),
            }
        }
        self.upload(gpu, &bytes);
        self.draw_groups(gpu, pipelines, view.size_px, &groups);
    }

    /// Appends areas, groups of strokes and markers, in this order from bottom to top.
    fn append_drawing(
        &mut self,
        drawing: &Drawing,
        bytes: &mut Vec<u8>,
        groups: &mut Vec<PendingGroup>,
    ) {
        let mut fill: Vec<FillVertex> = Vec::new();
        for area in &drawing.areas {
            append_triangles(area, &mut fill);
        }
        if !fill.is_empty() {
            self.draws.push(Draw::Fill {
                bytes: append(bytes, &fill),
                vertices: fill.len() as u32,
            });
        }
        // An invisible group would cost a texture and a pass. So would one with opacity NaN.
        for group in drawing.strokes.iter().filter(|group| group.opacity > 0.0) {
            self.append_group(group, bytes, groups);
        }
        let markers: Vec<MarkerInstance> =
            drawing.markers.iter().map(MarkerInstance::from).collect();
        if !markers.is_empty() {
            self.draws.push(Draw::Markers {
                bytes: append(bytes, &markers),
                instances: markers.len() as u32,
            });
        }
    }

    /// Appends a group of strokes: its segments for the group's texture, and the draw call that
    /// composites that texture.
    fn append_group(
        &mut self,
        group: &StrokeGroup,
        bytes: &mut Vec<u8>,
        groups: &mut Vec<PendingGroup>,
    ) {
        let mut segments = Vec::new();
        for stroke in &group.strokes {
            append_segments(stroke, &mut segments);
        }
        if !segments.is_empty() {
            let target = groups.len();
            groups.push(PendingGroup {
                bytes: append(bytes, &segments),
                instances: segments.len() as u32,
            });
            let instance = GroupInstance::from(group);
            self.draws.push(Draw::Group {
                target,
                bytes: append(bytes, &[instance]),
            });
        }
    }

    /// Uploads the vertices, into a larger buffer if necessary.
    fn upload(&mut self, gpu: &Gpu<'_>, bytes: &[u8]) {
        let needed = bytes.len() as u64;
        // Powers of two, so that a drawing that grows seldom needs another buffer.
        if needed > self.vertices.size() {
            self.vertices = vertex_buffer(gpu.device, needed.next_power_of_two());
        }
        gpu.queue.write_buffer(&self.vertices, 0, bytes);
    }

    /// Draws each group opaque into its own texture: all rims, then all cores.
    fn draw_groups(
        &mut self,
        gpu: &mut Gpu<'_>,
        pipelines: &Pipelines,
        size_px: [u32; 2],
        groups: &[PendingGroup],
    ) {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let size_px = size_px.map(|side| side.min(limit));
        // Textures of the frame before are used again while the canvas has the same size.
        self.targets.truncate(groups.len());
        self.targets.retain(|target| target.size_px == size_px);
        while self.targets.len() < groups.len() {
            self.targets.push(GroupTarget::new(
                gpu.device,
                &pipelines.group_layout,
                size_px,
            ));
        }
        // Within a group the last core lies on top; the group's opacity is applied when its texture
        // is composited in `paint`.
        for (group, target) in groups.iter().zip(&self.targets) {
            let mut pass = super::begin_pass(
                gpu.encoder,
                "stroke group",
                &target.view,
                wgpu::Color::TRANSPARENT,
            );
            pass.set_bind_group(0, &self.view_bind_group, &[]);
            pass.set_vertex_buffer(0, self.vertices.slice(group.bytes.clone()));
            for pipeline in [&pipelines.rim, &pipelines.core] {
                pass.set_pipeline(pipeline);
                pass.draw(0..4, 0..group.instances);
            }
        }
    }

    /// Draws what was prepared. The pass's viewport is the canvas.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>, pipelines: &Pipelines) {
        pass.set_bind_group(0, &self.view_bind_group, &[]);
        for draw in &self.draws {
            let (pipeline, bytes, vertices, instances) = match draw {
                Draw::Picture { bind_group, bytes } => {
                    pass.set_bind_group(1, bind_group, &[]);
                    (&pipelines.picture, bytes, 4, 1)
                }
                Draw::Heat { bind_group, bytes } => {
                    pass.set_bind_group(1, bind_group, &[]);
                    (&pipelines.heat, bytes, 4, 1)
                }
                Draw::Group { target, bytes } => {
                    let Some(target) = self.targets.get(*target) else {
                        continue;
                    };
                    pass.set_bind_group(1, &target.bind_group, &[]);
                    (&pipelines.composite, bytes, 4, 1)
                }
                Draw::Fill { bytes, vertices } => (&pipelines.fill, bytes, *vertices, 1),
                Draw::Markers { bytes, instances } => (&pipelines.marker, bytes, 4, *instances),
            };
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, self.vertices.slice(bytes.clone()));
            pass.draw(0..vertices, 0..instances);
        }
    }
}

/// Appends plain data and returns its range. Sizes of items are multiples of four, as vertex
/// offsets must be.
fn append<T: Pod>(bytes: &mut Vec<u8>, items: &[T]) -> Range<u64> {
    let start = bytes.len() as u64;
    bytes.extend_from_slice(bytemuck::cast_slice(items));
    start..bytes.len() as u64
}

fn vertex_buffer(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("vertices"),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
