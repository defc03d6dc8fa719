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
mod mipmap;
mod offscreen;
mod picture;
mod pipelines;
mod renderer;
mod stroke;
mod text;
mod view;

pub use gpu::Gpu;
pub use offscreen::{AdapterReport, Offscreen, RenderError};
pub use picture::SMOOTH_UP_TO_SCALE;
pub use renderer::{CanvasId, Renderer};
pub use view::{Layer, PictureKey, PictureLayer, View};

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
