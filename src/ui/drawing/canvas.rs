//! Places in the window that the renderer of [`touchline_application::render`] draws.
//!
//! The window's wgpu state keeps one [`Renderer`]. A canvas is an egui paint callback that hands it
//! the layers of this frame of the window. Without wgpu (in a test without a GPU) a canvas shows a
//! message, and everything else works.

use eframe::egui_wgpu::{
    Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor,
};
use egui::{Align2, Color32, FontId, Id, Painter, Rect};
use std::sync::Arc;
use touchline_application::render::{CanvasId, Gpu, Layer, Renderer, View};
use touchline_application::scene::drawing::{Drawing, Label};

/// The picture of the shown frame.
pub const VIEWPORT: CanvasId = CanvasId(1);
/// The loupe around a point that is being placed.
pub const LOUPE: CanvasId = CanvasId(2);
/// The field map.
pub const FIELD_MAP: CanvasId = CanvasId(3);

/// Creates the renderer in the window's wgpu state. Without one, canvases show a message.
pub fn install(ctx: &egui::Context, render_state: Option<&RenderState>) {
    let Some(state) = render_state else { return };
    let renderer = Renderer::new(&state.device, state.target_format);
    state.renderer.write().callback_resources.insert(renderer);
    ctx.data_mut(|data| data.insert_temp(installed_id(), true));
}

fn installed_id() -> Id {
    Id::NULL.with("canvases can be drawn")
}

/// Draws layers into `rect`, which is in points and must lie on whole physical px.
pub fn paint(painter: &Painter, id: CanvasId, rect: Rect, view: View, layers: Vec<Layer>) {
    // A painter does not know the window's wgpu state, so `install` leaves a mark in egui's memory.
    if painter
        .ctx()
        .data(|data| data.get_temp::<bool>(installed_id()))
        == Some(true)
    {
        painter.add(Callback::new_paint_callback(
            rect,
            Canvas { id, view, layers },
        ));
    } else {
        painter.rect_filled(rect, 0.0, Color32::from_gray(24));
        let text = "No graphics adapter: pictures cannot be drawn.";
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            text,
            FontId::default(),
            Color32::from_gray(120),
        );
    }
}

/// Size of a rectangle of the window in physical px, rounded like the renderer's viewport.
pub fn size_px(rect: Rect, pixels_per_point: f32) -> [u32; 2] {
    [
        length_px(rect.left(), rect.right(), pixels_per_point),
        length_px(rect.top(), rect.bottom(), pixels_per_point),
    ]
}

/// Length between two edges in physical px. Each edge is rounded, so that neighbours share it.
fn length_px(from_pt: f32, to_pt: f32, pixels_per_point: f32) -> u32 {
    let length = (to_pt * pixels_per_point).round() - (from_pt * pixels_per_point).round();
    length.clamp(0.0, 32768.0) as u32
}

/// What one canvas draws in this frame of the window.
struct Canvas {
    id: CanvasId,
    view: View,
    layers: Vec<Layer>,
}

/// egui calls `prepare` of every canvas before the render pass begins, and `paint` within it, in
/// the order of drawing. The renderer keeps what it uploaded under the canvas's id in between.
impl CallbackTrait for Canvas {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(renderer) = resources.get_mut::<Renderer>() {
            renderer.prepare(
                Gpu {
                    device,
                    queue,
                    encoder,
                },
                self.id,
                &self.view,
                &self.layers,
            );
        }
        // The renderer records into egui's encoder and has no command buffers of its own.
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(renderer) = resources.get::<Renderer>() {
            renderer.paint(pass, self.id);
        }
    }
}

/// Drawings over a picture, from back to front.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    pub drawings: Vec<Arc<Drawing>>,
}

impl Overlay {
    /// The drawings as layers for the renderer.
    pub fn layers(&self) -> impl Iterator<Item = Layer> {
        self.drawings
            .iter()
            .map(|drawing| Layer::Drawing(Arc::clone(drawing)))
    }

    /// The texts of all drawings. The renderer draws no text; `labels.rs` does.
    pub fn labels(&self) -> impl Iterator<Item = &Label> {
        self.drawings.iter().flat_map(|drawing| &drawing.labels)
    }
}
