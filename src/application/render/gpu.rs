//! Access to the GPU, and constructors of wgpu's small parts.

use touchline_shaders::Shader;

/// What uploading and drawing need.
#[derive(Debug)]
pub struct Gpu<'a> {
    /// Creates buffers and textures.
    pub device: &'a wgpu::Device,
    /// Uploads their contents.
    pub queue: &'a wgpu::Queue,
    /// Records passes that precede the one of the canvas.
    pub encoder: &'a mut wgpu::CommandEncoder,
}

/// The module of one of the program's shaders.
pub(super) fn module(device: &wgpu::Device, shader: Shader) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(shader.wgsl.into()),
    })
}

/// A bind group layout from entries of binding, stages and type.
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

/// The type of a uniform buffer.
pub(super) const fn uniform() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// The type of a filterable two-dimensional texture.
pub(super) const fn texture() -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}

/// The type of a filtering sampler.
pub(super) const fn sampler() -> wgpu::BindingType {
    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)
}
