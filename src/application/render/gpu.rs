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

/// A two-dimensional texture with one sample per pixel.
pub(super) fn create_texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    mip_level_count: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// The bind group of a texture (binding 0) and of its sampler (binding 1), if it has one.
pub(super) fn bind_texture(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::TextureView,
    sampler: Option<&wgpu::Sampler>,
) -> wgpu::BindGroup {
    let texture = wgpu::BindGroupEntry {
        binding: 0,
        resource: wgpu::BindingResource::TextureView(view),
    };
    let sampler = sampler.map(|sampler| wgpu::BindGroupEntry {
        binding: 1,
        resource: wgpu::BindingResource::Sampler(sampler),
    });
    let entries: Vec<_> = std::iter::once(texture).chain(sampler).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
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
