//! Smaller copies of a picture, which prevent aliasing when it is drawn reduced.

use super::gpu::{bind_texture, layout, module, sampler, texture};
use touchline_shaders::MIPMAP;

/// Computes the mip levels of a texture, each from the one before.
#[derive(Debug)]
pub(super) struct MipmapMaker {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

impl MipmapMaker {
    pub fn new(device: &wgpu::Device) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = layout(
            device,
            "mipmap",
            &[(0, fragment, texture()), (1, fragment, sampler())],
        );
        let module = module(device, MIPMAP);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mipmap"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("mipmap"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_mipmap"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_mipmap"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        // Sampled at the corner that four pixels share, a linear filter gives their mean.
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("mipmap"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        Self {
            layout,
            pipeline,
            sampler,
        }
    }

    /// Fills all levels above the first.
    pub fn fill(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) {
        for smaller in 1..texture.mip_level_count() {
            let source = level_view(texture, smaller - 1);
            let bind_group =
                bind_texture(device, "mipmap", &self.layout, &source, Some(&self.sampler));
            let target = level_view(texture, smaller);
            let mut pass = super::begin_pass(encoder, "mipmap", &target, wgpu::Color::TRANSPARENT);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.draw(0..4, 0..1);
        }
    }
}

/// A view of a single mip level of a texture.
fn level_view(texture: &wgpu::Texture, level: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        base_mip_level: level,
        mip_level_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}
