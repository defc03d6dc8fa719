//! A place where a camera may stand, from a candidate to the answer.

use super::candidates::{Candidate, ViewGraph};
use super::refined::Refined;
use crate::calibrate::{UnclickedCamera, UnclickedFrame};
use touchline_core::geometry::ImageSize;

/// A camera where it may stand, with the view graph of its frames there.
#[derive(Clone)]
pub(super) struct Place {
    pub camera: UnclickedCamera,
    pub view_graph: ViewGraph,
}

impl Place {
    /// Of a candidate, as it is before its frames are pulled onto the paint of their own pictures.
    pub fn of(candidate: Candidate, frames: &[usize]) -> Self {
        let pointed = frames.iter().zip(&candidate.ptz);
        let pointed = pointed
            .filter_map(|(&index, ptz)| Some(UnclickedFrame { index, ptz: (*ptz)?, uncertainty: None, snapped: None }));
        let pointed = pointed.collect();
        let Candidate { base, field, sizes, evidence, view_graph, .. } = candidate;
        let is_other = |place: &usize| view_graph.indices.binary_search(place).is_err();
        let others = (0..frames.len()).filter(is_other).map(|place| frames[place]).collect();
        let camera = UnclickedCamera { base, field, sizes, frames: pointed, others, paint: Vec::new(), evidence };
        Self { camera, view_graph }
    }

    /// As it was adjusted once more.
    pub fn refined(self, refined: Refined, frames: &[usize], size: ImageSize) -> Self {
        Self { view_graph: refined.view_graph(self.view_graph, frames, size), camera: refined.camera(self.camera) }
    }
}
