//! What is needed to put something on the GPU, and the small pieces that pipelines are bound with.

use touchline_shaders::Shader;

/// What is needed to put something on the GPU.
#[derive(Debug)]
pub struct Gpu<'a> {
    /// Makes buffers and textures.
    pub device: &'a wgpu::Device,
    /// Takes their contents.
    pub queue: &'a wgpu::Queue,
    /// Records what is drawn before a canvas's own pass.
    pub encoder: &'a mut wgpu::CommandEncoder,
}

/// A shader module of one of our shaders.
pub(super) fn module(device: &wgpu::Device, shader: Shader) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(shader.wgsl.into()),
    })
}

/// A bind group layout of (binding, stages, type).
pub(super) fn layout(
    device: &wgpu::Device,
    label: &str,
    entries: &[(u32, wgpu::ShaderStages, wgpu::BindingType)],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries
        .iter()
        .map(|&(binding, visibility, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}

/// A uniform buffer.
pub(super) const fn uniform() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A filterable two-dimensional texture.
pub(super) const fn texture() -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}

/// A filtering sampler.
pub(super) const fn sampler() -> wgpu::BindingType {
    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)
}
