//! Frames whose base is found, held by their neighbours and by the paint of their own pictures; those that stay uncertain are
//! not answered.

use super::candidates::ViewGraph;
use crate::calibrate::{UnclickedCamera, UnclickedFrame};
use std::collections::BTreeMap;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Mat3, Vec3};
use touchline_core::solve::{Loss, Uncertainty};
use touchline_vision::paint::{Snapped, overlays_apart_px};
use touchline_vision::track::{HeldFrame, Hold, filled, hold_frames};

/// A frame whose overlay is less certain at its worst corner is not answered: 1-σ of paint and ties, px at 1920 px width.
const CERTAIN_PX: f64 = 3.0;

/// A frame's own paint that pulls it farther than this from where its neighbours have it is not its paint, px at 1920 px width.
const APART_PX: f64 = 8.0;

/// A snapped camera counts less and less beyond so many of its sigmas.
const SNAPPED_SIGMAS: f64 = 3.0;

/// What is snapped is never taken as more exact than this at a corner: base and lens are not exact, px at 1920 px width.
const LEAST_SIGMA_PX: f64 = 1.0;

/// All frames of a group, held.
pub(super) struct Held {
    base: CameraBase,
    size: ImageSize,
    frames: Vec<HeldFrame>,
}

impl Held {
    /// Of a base, by what is known of its frames; none where that leaves one of them open.
    pub fn of(base: &CameraBase, view_graph: &ViewGraph, holds: &[Hold], size: ImageSize) -> Option<Self> {
        let start = filled(&view_graph.ptz, &view_graph.ptz_by_matches, &view_graph.matches)?;
        let frames = hold_frames(base, &start, &view_graph.matches, holds, size)?;
        Some(Self { base: *base, size, frames })
    }

    /// The frames by their places in the document, uncertain ones included.
    pub fn frames(&self, view_graph: &ViewGraph, looked_at: &[usize]) -> Vec<UnclickedFrame> {
        let of_frame = |(place, held): (&usize, &HeldFrame)| {
            let index = *looked_at.get(*place)?;
            Some(UnclickedFrame { index, ptz: held.ptz, uncertainty: self.uncertainty(held), snapped: None })
        };
        view_graph.indices.iter().zip(&self.frames).filter_map(of_frame).collect()
    }

    /// Holds all frames by what was snapped; what the neighbours contradict is let go, and frames that stay uncertain go.
    pub fn settle(&self, found: &mut UnclickedCamera, view_graph: &ViewGraph) {
        let mut holds: Vec<Hold> = Vec::new();
        for (frame, of_found) in found.frames.iter().enumerate() {
            let own = of_found.snapped.as_ref().and_then(|snapped| self.hold(frame, snapped));
            let by_all = || view_graph.paint_priors.iter().find(|hold| hold.frame == frame).copied();
            holds.extend(own.or_else(by_all));
        }
        let Some(held) = Self::of(&self.base, view_graph, &holds, self.size) else { return };
        let px = self.size.scale_from_1920();
        for (of_found, held_frame) in found.frames.iter_mut().zip(&held.frames) {
            of_found.ptz = held_frame.ptz;
            of_found.uncertainty = held.uncertainty(held_frame);
            let camera = PtzCamera::new(self.base, held_frame.ptz);
            let agrees = |snapped: &Snapped| overlays_apart_px(&camera, snapped.ptz, self.size) <= APART_PX * px;
            of_found.snapped = of_found.snapped.take().filter(agrees);
        }
        found.paint = held.paint(view_graph);
        found.frames.retain(|frame| {
            let certain = |known: &Uncertainty| self.corner_px(frame, known) <= CERTAIN_PX * px;
            frame.uncertainty.as_ref().is_some_and(certain)
        });
    }

    /// Where paint stays, thinned.
    fn paint(&self, view_graph: &ViewGraph) -> Vec<PanTilt> {
        const CELL_DEG: f64 = 0.04;
        let mut of_cell: BTreeMap<(i64, i64), PanTilt> = BTreeMap::new();
        for (held, places) in self.frames.iter().zip(&view_graph.paint) {
            let camera = PtzCamera::new(self.base, held.ptz);
            for ray in places.iter().filter_map(|at| camera.ray_from_image(*at).ok()) {
                let cell = [ray.pan, ray.tilt].map(|angle| (angle.degrees() / CELL_DEG).floor() as i64);
                of_cell.entry((cell[0], cell[1])).or_insert(ray);
            }
        }
        of_cell.into_values().collect()
    }

    /// What a snapped camera says of its frame.
    fn hold(&self, frame: usize, snapped: &Snapped) -> Option<Hold> {
        let ptz = snapped.ptz;
        hold_on_paint(frame, ptz, &snapped.uncertainty.clicks, self.size)
    }

    fn uncertainty(&self, held: &HeldFrame) -> Option<Uncertainty> {
        Uncertainty::of_known(&PtzCamera::new(self.base, held.ptz), held.covariance, self.size).ok()
    }

    /// 1-σ at the worst corner, the base taken as exact, px.
    fn corner_px(&self, frame: &UnclickedFrame, known: &Uncertainty) -> f64 {
        let camera = PtzCamera::new(self.base, frame.ptz);
        known.with_exact_base().worst_corner_sigma_px(&camera, self.size)
    }
}

/// What a frame's own paint says of it, where its lines leave this covariance of (pan rad, tilt rad, focal length px).
pub(super) fn hold_on_paint(frame: usize, ptz: Ptz, covariance: &Mat3, size: ImageSize) -> Option<Hold> {
    let least = LEAST_SIGMA_PX * size.scale_from_1920() / ptz.focal_px;
    let least_focal = 2.0 * LEAST_SIGMA_PX * size.scale_from_1920() / f64::from(size.width);
    let floor = Mat3::from_diagonal(&Vec3::new(least, least, least_focal).map(|sigma| sigma * sigma));
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, ptz.focal_px.recip()));
    let information = (scale * covariance * scale + floor).try_inverse()?;
    Some(Hold { frame, ptz, information, loss: Loss::Cauchy { c: SNAPPED_SIGMAS } })
}
