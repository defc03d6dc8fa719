//! What lies over a picture, as drawings.

use std::sync::Arc;
use touchline_application::render::Layer;
use touchline_application::scene::drawing::{Drawing, Label};

/// The drawings over the picture, the lowest first.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// What the renderer draws.
    pub drawings: Vec<Arc<Drawing>>,
}

impl Overlay {
    /// The drawings as layers.
    pub fn layers(&self) -> impl Iterator<Item = Layer> {
        self.drawings
            .iter()
            .map(|drawing| Layer::Drawing(Arc::clone(drawing)))
    }

    /// Every text.
    pub fn labels(&self) -> impl Iterator<Item = &Label> {
        self.drawings.iter().flat_map(|drawing| &drawing.labels)
    }
}
