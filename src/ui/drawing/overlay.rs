//! What is drawn over a picture, as data for the renderer and for the texts.

use std::sync::Arc;
use touchline_application::render::Layer;
use touchline_application::scene::drawing::{Drawing, Label};

/// Drawings over a picture, from back to front.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// The drawings.
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
