//! Draws layers with wgpu: pictures, anti-aliased lines, areas and markers; on screen and off.
//!
//! A canvas shows [`Layer`]s from bottom to top: pictures, heat maps and plain-data drawings
//! ([`crate::scene::drawing`]). [`Renderer::prepare`] uploads them and [`Renderer::paint`] draws
//! them, into a render pass that belongs to the window or to [`Offscreen`]. All values stay in
//! gamma space with premultiplied alpha. The shaders smooth edges, with one sample per pixel.
//! `stroke.rs` explains how strokes stay even where they join and cross.

mod canvas;
mod fill;
mod gpu;
mod offscreen;
mod picture;
mod pipelines;
mod stroke;
mod text;
mod view;

pub use gpu::Gpu;
pub use offscreen::{AdapterReport, Offscreen, RenderError};
pub use picture::SMOOTH_UP_TO_SCALE;
pub use view::{Layer, PictureKey, PictureLayer, View};

use self::canvas::Canvas;
use self::picture::PictureCache;
use self::pipelines::Pipelines;
use std::collections::BTreeMap;

/// Begins a pass that clears one target and draws on it.
fn begin_pass<'encoder>(
    encoder: &'encoder mut wgpu::CommandEncoder,
    label: &str,
    target: &wgpu::TextureView,
    clear: wgpu::Color,
) -> wgpu::RenderPass<'encoder> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(clear),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// One surface that layers are drawn on: the viewport, the loupe, the field map.
///
/// Each has its own buffers, so that several canvases can be prepared before the first is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CanvasId(pub u64);

/// The pipelines, the pictures on the GPU, and the canvases.
#[derive(Debug)]
pub struct Renderer {
    pipelines: Pipelines,
    pictures: PictureCache,
    canvases: BTreeMap<CanvasId, Canvas>,
}

impl Renderer {
    /// Builds the pipelines for passes with one colour attachment of `format`, one sample and no
    /// depth.
    ///
    /// `format` must be in gamma space (`Rgba8Unorm`, `Bgra8Unorm`), not an `Srgb` format: colours
    /// are written as they are stored.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self {
            pipelines: Pipelines::new(device, format),
            pictures: PictureCache::new(device),
            canvases: BTreeMap::new(),
        }
    }

    /// Uploads what the layers of a canvas need, and records the passes that precede the one of
    /// [`Self::paint`].
    ///
    /// Call it at most once per canvas between two submissions: a second call overwrites the first.
    pub fn prepare(&mut self, mut gpu: Gpu<'_>, id: CanvasId, view: &View, layers: &[Layer]) {
        let canvas = self
            .canvases
            .entry(id)
            .or_insert_with(|| Canvas::new(gpu.device, &self.pipelines));
        canvas.prepare(&mut gpu, &self.pipelines, &mut self.pictures, view, layers);
    }

    /// Draws the layers that were last prepared for a canvas. The pass's viewport must be the
    /// canvas, with the size [`View::size_px`]. A canvas that was never prepared draws nothing.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>, id: CanvasId) {
        if let Some(canvas) = self.canvases.get(&id) {
            canvas.paint(pass, &self.pipelines);
        }
    }
}
