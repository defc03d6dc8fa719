//! Draws layers in two steps, as a render pass that belongs to someone else wants it.

use super::canvas::Canvas;
use super::gpu::Gpu;
use super::layer::Layer;
use super::picture::PictureCache;
use super::pipelines::Pipelines;
use super::view::View;
use std::collections::BTreeMap;

/// One place that layers are drawn on: the viewport, the loupe, the field map.
///
/// Each keeps its own buffers, so that several can be prepared before the first is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CanvasId(pub u64);

/// The pipelines, the pictures on the GPU and the canvases.
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
    /// The format is one of gamma space (`Rgba8Unorm`, `Bgra8Unorm`), never one of the `Srgb`
    /// formats: colours are written as they are stored.
    #[must_use]
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self {
            pipelines: Pipelines::new(device, format),
            pictures: PictureCache::new(device),
            canvases: BTreeMap::new(),
        }
    }

    /// Uploads what a canvas's layers need and records the passes that go before `paint`'s.
    ///
    /// To be called at most once per canvas between two submissions: a second call replaces the
    /// first.
    pub fn prepare(&mut self, mut gpu: Gpu<'_>, id: CanvasId, view: &View, layers: &[Layer]) {
        let canvas = self
            .canvases
            .entry(id)
            .or_insert_with(|| Canvas::new(gpu.device, &self.pipelines));
        canvas.prepare(&mut gpu, &self.pipelines, &mut self.pictures, view, layers);
    }

    /// Draws what was last prepared for a canvas; the pass's viewport must be the canvas,
    /// `View::size_px` large.
    ///
    /// A canvas that was never prepared stays as it is.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>, id: CanvasId) {
        if let Some(canvas) = self.canvases.get(&id) {
            canvas.paint(pass, &self.pipelines);
        }
    }

    /// Frees what a canvas that is no longer shown keeps on the GPU.
    pub fn forget(&mut self, id: CanvasId) {
        self.canvases.remove(&id);
    }
}
