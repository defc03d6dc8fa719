//! Renders layers into pictures, without a window.

use super::gpu::{Gpu, create_texture};
use super::text::write_labels;
use super::view::{Layer, View};
use super::{CanvasId, Renderer};
use crate::scene::drawing::Colour;
use image::RgbaImage;
use std::fmt;
use thiserror::Error;

/// Why nothing can be rendered off-screen.
#[derive(Debug, Error)]
pub enum RenderError {
    /// There is neither a GPU nor a software renderer.
    #[error(
        "no graphics adapter: neither a GPU driver nor a software renderer was found; install one \
         (Debian: apt install mesa-vulkan-drivers libvulkan1)"
    )]
    NoAdapter,
    /// There are adapters, but none gives a device. States the first one's reason.
    #[error(
        "the graphics adapter {adapter} gives no device: {reason}; update its driver, or try WGPU_BACKEND=gl"
    )]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// The canvas is empty or larger than the adapter's textures.
    #[error(
        "a canvas of {width} × {height} px cannot be rendered: this adapter takes 1 to {limit} px a side"
    )]
    BadSize {
        /// Requested columns.
        width: u32,
        /// Requested rows.
        height: u32,
        /// Maximum side of the adapter's textures, px.
        limit: u32,
    },
    /// The typeface of the labels cannot be read.
    #[error("the program's built-in typeface cannot be read: {0}")]
    Typeface(#[from] ab_glyph::InvalidFont),
    /// The finished picture cannot be read back.
    #[error("the rendered picture could not be read back from the graphics adapter: {reason}")]
    Readback {
        /// The driver's message.
        reason: String,
    },
}

/// The adapter that draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterReport {
    /// The adapter's name, such as "llvmpipe (LLVM 15.0.6, 256 bits)".
    pub name: String,
    /// Its graphics interface, such as "vulkan".
    pub backend: String,
    /// Whether it is a software renderer: correct, but slow.
    pub is_cpu: bool,
}

impl AdapterReport {
    /// The description of a wgpu adapter.
    pub fn from_info(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            is_cpu: info.device_type == wgpu::DeviceType::Cpu,
        }
    }
}

impl fmt::Display for AdapterReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_cpu { "software" } else { "GPU" };
        write!(f, "{} ({}, {kind})", self.name, self.backend)
    }
}

/// Renders layers into pictures.
#[derive(Debug)]
pub struct Offscreen {
    device: wgpu::Device,
    queue: wgpu::Queue,
    adapter: AdapterReport,
    renderer: Renderer,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const CANVAS: CanvasId = CanvasId(0);
/// Maximum side of what is drawn at a time, px: 64 MiB, a quarter of the buffer size that every
/// adapter allows.
const TILE_PX: u32 = 4096;

impl Offscreen {
    /// Opens the fastest adapter: first discrete, then integrated, then virtual GPUs, then software
    /// renderers. OpenGL is tried only if no other interface gives a device, because Mesa's OpenGL
    /// can crash the process on exit.
    ///
    /// The environment variable `WGPU_BACKEND` (vulkan, gl, metal, dx12) restricts the choice.
    ///
    /// # Errors
    /// There is no adapter, or none that gives a device.
    pub fn new() -> Result<Self, RenderError> {
        if let Some(chosen) = wgpu::Backends::from_env() {
            return Self::among(chosen);
        }
        match Self::among(wgpu::Backends::PRIMARY) {
            Err(refusal) => Self::among(wgpu::Backends::GL).map_err(|other| match other {
                RenderError::NoAdapter => refusal,
                _ => other,
            }),
            drawing => drawing,
        }
    }

    /// Opens the fastest adapter of some interfaces.
    fn among(backends: wgpu::Backends) -> Result<Self, RenderError> {
        let described = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            ..described
        });
        let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
        adapters.sort_by_key(|adapter| slowness(adapter.get_info().device_type));
        let mut first_refusal = None;
        for adapter in adapters {
            let report = AdapterReport::from_info(&adapter.get_info());
            let request = adapter.request_device(&wgpu::DeviceDescriptor {
                label: Some("off-screen"),
                // The lowest limits that wgpu knows, so that old and software adapters give a
                // device. Only the size of textures is the adapter's own.
                required_limits: wgpu::Limits::downlevel_webgl2_defaults()
                    .using_resolution(adapter.limits()),
                ..wgpu::DeviceDescriptor::default()
            });
            match pollster::block_on(request) {
                Ok((device, queue)) => {
                    let renderer = Renderer::new(&device, FORMAT);
                    return Ok(Self {
                        device,
                        queue,
                        adapter: report,
                        renderer,
                    });
                }
                Err(error) => {
                    first_refusal = first_refusal.or(Some(RenderError::NoDevice {
                        adapter: report.name,
                        reason: error.to_string(),
                    }));
                }
            }
        }
        Err(first_refusal.unwrap_or(RenderError::NoAdapter))
    }

    /// The adapter that draws.
    pub const fn adapter(&self) -> &AdapterReport {
        &self.adapter
    }

    /// Draws layers on a canvas of `view.size_px` filled with `background`, and all labels on top.
    ///
    /// # Errors
    /// The canvas is empty or larger than the adapter's textures, or the picture cannot be read
    /// back.
    pub fn render(
        &mut self,
        view: &View,
        background: Colour,
        layers: &[Layer],
    ) -> Result<RgbaImage, RenderError> {
        let [width, height] = view.size_px;
        let limit = self.device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(RenderError::BadSize {
                width,
                height,
                limit,
            });
        }
        let mut picture = self.in_tiles(view, background, layers, TILE_PX.min(limit))?;
        let labels = layers.iter().flat_map(|layer| match layer {
            Layer::Drawing(drawing) => drawing.labels.as_slice(),
            Layer::Picture(_) | Layer::Heat(..) => &[],
        });
        write_labels(&mut picture, view, labels)?;
        Ok(picture)
    }

    /// Draws a canvas without labels, in tiles of at most `tile_px` a side.
    fn in_tiles(
        &mut self,
        view: &View,
        background: Colour,
        layers: &[Layer],
        tile_px: u32,
    ) -> Result<RgbaImage, RenderError> {
        let [width, height] = view.size_px;
        if width <= tile_px && height <= tile_px {
            return self.tile(view, background, layers);
        }
        let mut picture = RgbaImage::new(width, height);
        // Each tile is a canvas of its own with the picture shifted by the tile's position. Soft
        // edges and dashes depend on positions in the picture, so that they meet at the borders.
        for top in (0..height).step_by(tile_px as usize) {
            for left in (0..width).step_by(tile_px as usize) {
                let tile = View {
                    offset_px: [
                        view.offset_px[0] - left as f32,
                        view.offset_px[1] - top as f32,
                    ],
                    size_px: [tile_px.min(width - left), tile_px.min(height - top)],
                    ..*view
                };
                let drawn = self.tile(&tile, background, layers)?;
                image::imageops::replace(&mut picture, &drawn, i64::from(left), i64::from(top));
            }
        }
        Ok(picture)
    }

    /// Draws one tile and waits for its pixels.
    fn tile(
        &mut self,
        view: &View,
        background: Colour,
        layers: &[Layer],
    ) -> Result<RgbaImage, RenderError> {
        let [width, height] = view.size_px;
        let target = ReadbackTexture::new(&self.device, width, height);
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let gpu = Gpu {
            device: &self.device,
            queue: &self.queue,
            encoder: &mut encoder,
        };
        self.renderer.prepare(gpu, CANVAS, view, layers);
        target.draw(&mut encoder, &self.renderer, CANVAS, background);
        self.queue.submit([encoder.finish()]);
        target.read_back(&self.device)
    }
}

/// A texture to draw on, and a buffer to read it back through.
struct ReadbackTexture {
    texture: wgpu::Texture,
    buffer: wgpu::Buffer,
    bytes_per_row: u32,
}

impl ReadbackTexture {
    fn new(device: &wgpu::Device, width: u32, height: u32) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = create_texture(device, "off-screen", [width, height], 1, FORMAT, usage);
        // wgpu copies textures into buffers whose rows begin at multiples of 256 bytes.
        let bytes_per_row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(bytes_per_row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self {
            texture,
            buffer,
            bytes_per_row,
        }
    }

    /// Records the drawing of a prepared canvas and the copy into the buffer.
    fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        renderer: &Renderer,
        canvas: CanvasId,
        background: Colour,
    ) {
        let view = self
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = super::begin_pass(encoder, "off-screen", &view, clear_colour(background));
        renderer.paint(&mut pass, canvas);
        drop(pass);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.bytes_per_row),
            rows_per_image: None,
        };
        let into = wgpu::TexelCopyBufferInfo {
            buffer: &self.buffer,
            layout,
        };
        encoder.copy_texture_to_buffer(self.texture.as_image_copy(), into, self.texture.size());
    }

    /// Waits for the submitted work and returns the picture.
    fn read_back(&self, device: &wgpu::Device) -> Result<RgbaImage, RenderError> {
        let failed = |reason: String| RenderError::Readback { reason };
        // A failed mapping shows as an error of `get_mapped_range` after the wait.
        self.buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| failed(error.to_string()))?;
        let bytes = self
            .buffer
            .get_mapped_range(..)
            .map_err(|error| failed(error.to_string()))?;
        let (width, height) = (self.texture.width(), self.texture.height());
        let mut pixels = Vec::with_capacity(4 * width as usize * height as usize);
        // Rows in the buffer are padded to wgpu's alignment.
        for row in bytes.chunks_exact(self.bytes_per_row as usize) {
            pixels.extend_from_slice(&row[..4 * width as usize]);
        }
        RgbaImage::from_raw(width, height, pixels)
            .ok_or_else(|| failed("the picture is incomplete".into()))
    }
}

/// The rank of a kind of adapter by speed, the fastest first.
const fn slowness(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// The clear colour, premultiplied like the target.
fn clear_colour(colour: Colour) -> wgpu::Color {
    let alpha = f64::from(colour.a) / 255.0;
    let channel = |byte: u8| f64::from(byte) / 255.0 * alpha;
    wgpu::Color {
        r: channel(colour.r),
        g: channel(colour.g),
        b: channel(colour.b),
        a: alpha,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::drawing::{Drawing, Stroke, StrokeGroup};
    use std::sync::Arc;

    #[test]
    fn tiles_are_parts_of_one_picture() {
        let mut offscreen = Offscreen::new().unwrap();
        let stroke = |points: Vec<[f32; 2]>, width_pt| Stroke {
            points,
            colour: Colour::rgb(255, 200, 0),
            width_pt,
            outline: None,
            dash: None,
        };
        let strokes = vec![
            stroke(vec![[3.0, 5.0], [90.0, 61.0]], 3.0),
            stroke(vec![[0.0, 40.0], [99.0, 33.0]], 5.0),
        ];
        let group = StrokeGroup {
            strokes,
            opacity: 0.7,
            clip_px: None,
        };
        let drawing = Drawing {
            strokes: vec![group],
            ..Drawing::default()
        };
        let mut pixels = RgbaImage::new(100, 70);
        for (x, y, pixel) in pixels.enumerate_pixels_mut() {
            *pixel = image::Rgba([(x * 2) as u8, (y * 3) as u8, ((x * y) % 251) as u8, 255]);
        }
        let pixels = touchline_vision::media::Picture::new(
            touchline_core::geometry::ImageSize::new(100, 70),
            pixels.into_raw(),
        )
        .unwrap();
        let layers = [
            Layer::Picture(crate::render::PictureLayer {
                key: crate::render::PictureKey(1),
                pixels,
                look: crate::scene::PictureLook::default(),
            }),
            Layer::Drawing(Arc::new(drawing)),
        ];
        let view = View::one_to_one([100, 70]);
        let background = Colour::rgb(10, 20, 30);
        let whole = offscreen
            .in_tiles(&view, background, &layers, 4096)
            .unwrap();
        let tiled = offscreen.in_tiles(&view, background, &layers, 32).unwrap();
        assert_eq!(tiled.dimensions(), (100, 70));
        let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 1;
        let different = whole
            .as_raw()
            .iter()
            .zip(tiled.as_raw())
            .filter(|pair| differs(*pair))
            .count();
        assert_eq!(different, 0, "rounding aside, no pixel differs");
    }

    #[test]
    fn canvases_prepared_together_keep_their_own_views_and_layers() {
        let mut offscreen = Offscreen::new().unwrap();
        let line = |y: f32, colour| {
            let points = vec![[0.0, y], [40.0, y]];
            let strokes = vec![Stroke {
                points,
                colour,
                width_pt: 3.0,
                outline: None,
                dash: None,
            }];
            let group = StrokeGroup {
                strokes,
                opacity: 1.0,
                clip_px: None,
            };
            [Layer::Drawing(Arc::new(Drawing {
                strokes: vec![group],
                ..Drawing::default()
            }))]
        };
        let (red, blue) = (Colour::rgb(255, 0, 0), Colour::rgb(0, 0, 255));
        let views = [
            View::one_to_one([40, 20]),
            View {
                scale: 2.0,
                ..View::one_to_one([60, 50])
            },
        ];
        let layers = [line(5.5, red), line(20.25, blue)];
        let Offscreen {
            device,
            queue,
            renderer,
            ..
        } = &mut offscreen;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (canvas, (view, layers)) in (1..).map(CanvasId).zip(views.iter().zip(&layers)) {
            renderer.prepare(
                Gpu {
                    device,
                    queue,
                    encoder: &mut encoder,
                },
                canvas,
                view,
                layers,
            );
        }
        let targets = [1, 2].map(|canvas| {
            let [width, height] = views[canvas - 1].size_px;
            let target = ReadbackTexture::new(device, width, height);
            target.draw(
                &mut encoder,
                renderer,
                CanvasId(canvas as u64),
                Colour::rgb(0, 0, 0),
            );
            target
        });
        queue.submit([encoder.finish()]);
        let [first, second] = targets.map(|target| target.read_back(device).unwrap());
        assert_eq!(
            (first.get_pixel(20, 5).0, first.get_pixel(20, 15).0),
            ([255, 0, 0, 255], [0, 0, 0, 255])
        );
        assert_eq!(
            (second.get_pixel(20, 40).0, second.get_pixel(20, 11).0),
            ([0, 0, 255, 255], [0, 0, 0, 255])
        );
    }
}
