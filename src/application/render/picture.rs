//! Frames on the GPU: uploaded once and kept while they are likely to be shown again.

use super::gpu::{Gpu, bind_texture, create_texture, layout, module, sampler, texture};
use super::view::{PictureKey, PictureLayer, View};
use bytemuck::{Pod, Zeroable};
use image::RgbaImage;
use lru::LruCache;
use std::num::NonZeroUsize;
use touchline_core::geometry::ImageSize;
use touchline_shaders::MIPMAP;
use touchline_vision::media;

/// Above this scale a picture is drawn without interpolation, so that its pixels show.
pub const SMOOTH_UP_TO_SCALE: f32 = 4.0;

/// Number of pictures on the GPU: the frame, its neighbours in both directions, and one to compare
/// with.
const KEPT: NonZeroUsize = NonZeroUsize::MIN.saturating_add(5);

/// Pictures are uploaded in bands of at most this size, bytes.
const BAND_BYTES: usize = 32 << 20;

/// The mip level is this much lower than the scale suggests, because trilinear filtering is too
/// soft.
const SHARPER_LEVELS: f32 = 0.25;

/// One picture; the fields are those of `Instance` in `picture.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct PictureInstance {
    /// Size of the picture, px.
    size: [f32; 2],
    /// Brightness, contrast, gamma; 1 leaves the values unchanged.
    look: [f32; 3],
    /// Mip level for the scale.
    level: f32,
    /// 1 for nearest-neighbour, 0 for smooth sampling.
    bare: u32,
}

/// The layout of [`PictureInstance`] in a vertex buffer.
pub(super) const PICTURE_ATTRIBUTES: [wgpu::VertexAttribute; 4] = wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32x3, 2 => Float32, 3 => Uint32
];

impl PictureInstance {
    pub fn new(picture: &PictureLayer, texture_width: u32, view: &View) -> Self {
        let ImageSize { width, height } = picture.pixels.size();
        // More than 1 if the picture is shown reduced. The texture is narrower than the picture if
        // the device takes no texture of that size.
        let texels_per_px = texture_width as f32 / width.max(1) as f32 / view.scale;
        Self {
            size: [width as f32, height as f32],
            look: [
                picture.look.brightness,
                picture.look.contrast,
                picture.look.gamma,
            ],
            level: if texels_per_px > 1.0 {
                (texels_per_px.log2() - SHARPER_LEVELS).max(0.0)
            } else {
                0.0
            },
            bare: u32::from(view.scale > SMOOTH_UP_TO_SCALE),
        }
    }
}

/// A picture on the GPU.
#[derive(Debug)]
struct Kept {
    texture: wgpu::Texture,
    bind_group: wgpu::BindGroup,
    has_mipmaps: bool,
}

/// The pictures on the GPU; the least recently used one is dropped first.
#[derive(Debug)]
pub(super) struct PictureCache {
    sampler: wgpu::Sampler,
    mipmaps: MipmapMaker,
    kept: LruCache<PictureKey, Kept>,
}

impl PictureCache {
    pub fn new(device: &wgpu::Device) -> Self {
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smooth"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let mipmaps = MipmapMaker::new(device);
        Self {
            sampler,
            mipmaps,
            kept: LruCache::new(KEPT),
        }
    }

    /// The bind group of a picture and the width of its texture; uploads the picture if necessary.
    /// `None` for an empty picture.
    ///
    /// Mipmaps are made when a picture is first drawn `shrunk`.
    pub fn bind(
        &mut self,
        gpu: &mut Gpu<'_>,
        layout: &wgpu::BindGroupLayout,
        picture: &PictureLayer,
        shrunk: bool,
    ) -> Option<(wgpu::BindGroup, u32)> {
        if picture.pixels.bytes() == 0 {
            return None;
        }
        let sampler = &self.sampler;
        let kept = self.kept.get_or_insert_mut(picture.key, || {
            let texture = upload(gpu.device, gpu.queue, &picture.pixels);
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let bind_group = bind_texture(gpu.device, "picture", layout, &view, Some(sampler));
            Kept {
                texture,
                bind_group,
                has_mipmaps: false,
            }
        });
        if shrunk && !kept.has_mipmaps {
            self.mipmaps.fill(gpu.device, gpu.encoder, &kept.texture);
            kept.has_mipmaps = true;
        }
        Some((kept.bind_group.clone(), kept.texture.width()))
    }
}

/// Uploads a picture into a texture with room for its mip levels. A picture larger than the
/// device's limit is scaled down to it.
fn upload(device: &wgpu::Device, queue: &wgpu::Queue, picture: &media::Picture) -> wgpu::Texture {
    let ImageSize { width, height } = picture.size();
    let limit = device.limits().max_texture_dimension_2d;
    let longer = width.max(height);
    let shrunk = (longer > limit).then(|| {
        let side = |px: u32| ((u64::from(px) * u64::from(limit) / u64::from(longer)) as u32).max(1);
        shrink(picture, side(width), side(height))
    });
    let (width, height) = shrunk
        .as_ref()
        .map_or((width, height), RgbaImage::dimensions);
    let rgba = shrunk
        .as_ref()
        .map_or_else(|| picture.rgba(), |shrunk| shrunk.as_raw());
    // Mip levels down to 1 × 1 px. A mip level is a render target while it is made.
    let levels = width.max(height).ilog2() + 1;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_DST
        | wgpu::TextureUsages::RENDER_ATTACHMENT;
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let texture = create_texture(device, "picture", [width, height], levels, format, usage);
    // In bands, because wgpu's staging buffers are smaller than the largest pictures.
    let band = (BAND_BYTES / (4 * width as usize)).max(1) as u32;
    for (top, rows) in (0..height)
        .step_by(band as usize)
        .zip(rgba.chunks((4 * width * band) as usize))
    {
        let into = wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d { x: 0, y: top, z: 0 },
            ..texture.as_image_copy()
        };
        let height = band.min(height - top);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: Some(height),
        };
        queue.write_texture(
            into,
            rows,
            layout,
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
        );
    }
    texture
}

/// A picture scaled to another size. Its pixels always have the length for its size, so that the
/// black fallback is never used.
fn shrink(picture: &media::Picture, width: u32, height: u32) -> RgbaImage {
    let size = picture.size();
    RgbaImage::from_raw(size.width, size.height, picture.rgba().to_vec()).map_or_else(
        || RgbaImage::new(width, height),
        |pixels| {
            image::imageops::resize(
                &pixels,
                width,
                height,
                image::imageops::FilterType::Triangle,
            )
        },
    )
}

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

#[cfg(test)]
mod tests {
    use super::*;

    fn instance(scale: f32) -> PictureInstance {
        let picture = PictureLayer {
            key: PictureKey(0),
            pixels: media::Picture::with_colour(ImageSize::new(8, 4), [0; 4]),
            look: crate::scene::PictureLook::default(),
        };
        PictureInstance::new(
            &picture,
            8,
            &View {
                scale,
                ..View::one_to_one([8, 4])
            },
        )
    }

    #[test]
    fn the_scale_decides_between_mipmaps_smooth_and_bare() {
        assert_eq!((instance(0.25).level, instance(0.25).bare), (1.75, 0));
        assert_eq!((instance(1.0).level, instance(1.0).bare), (0.0, 0));
        assert_eq!((instance(4.0).level, instance(4.0).bare), (0.0, 0));
        assert_eq!((instance(4.1).level, instance(4.1).bare), (0.0, 1));
    }
}
