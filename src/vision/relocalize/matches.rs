//! Features with their candidate rays.

use super::RayCandidate;
use std::ops::Range;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_core::solve::Observation;

/// The features of a picture with their candidate rays, in flat memory. A feature is scored by its
/// best candidate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayMatches {
    points: Vec<ImagePoint>,
    ends: Vec<usize>,
    /// Unit directions in `base`.
    rays: Vec<Vec3>,
    /// The squared descriptor distance of each feature's best candidate.
    distances: Vec<f32>,
}

impl RayMatches {
    /// No features.
    pub fn new() -> Self {
        Self::default()
    }

    /// No features yet, with room for this many.
    pub fn with_capacity(features: usize) -> Self {
        Self {
            points: Vec::with_capacity(features),
            ends: Vec::with_capacity(features),
            // Most features have one to three.
            rays: Vec::with_capacity(3 * features),
            distances: Vec::with_capacity(features),
        }
    }

    /// Adds a feature with its candidates, the most likely first; a feature without candidates is
    /// ignored.
    pub fn push(&mut self, point: ImagePoint, candidates: &[RayCandidate]) {
        let Some(first) = candidates.first() else {
            return;
        };
        self.points.push(point);
        self.rays
            .extend(candidates.iter().map(|candidate| candidate.ray.direction()));
        self.ends.push(self.rays.len());
        self.distances.push(first.squared_distance);
    }

    /// The matches without some features, and the original index of each that remains.
    pub(super) fn without(&self, left_out: &[bool]) -> (Self, Vec<usize>) {
        let kept: Vec<usize> = (0..self.len())
            .filter(|&feature| !left_out[feature])
            .collect();
        let mut rest = Self::with_capacity(kept.len());
        for &feature in &kept {
            rest.points.push(self.points[feature]);
            rest.rays.extend_from_slice(self.rays(feature));
            rest.ends.push(rest.rays.len());
            rest.distances.push(self.distances[feature]);
        }
        (rest, kept)
    }

    /// Number of features with candidates.
    pub const fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether no feature has a candidate.
    pub const fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Position of a feature, px.
    pub fn point(&self, feature: usize) -> ImagePoint {
        self.points[feature]
    }

    /// The candidate rays of a feature, unit directions in `base`, the most likely first.
    pub fn rays(&self, feature: usize) -> &[Vec3] {
        &self.rays[self.range(feature)]
    }

    fn range(&self, feature: usize) -> Range<usize> {
        let start = feature.checked_sub(1).map_or(0, |last| self.ends[last]);
        start..self.ends[feature]
    }

    /// The features in ascending order of descriptor distance.
    pub(super) fn by_distance(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by(|&a, &b| {
            self.distances[a]
                .total_cmp(&self.distances[b])
                .then(a.cmp(&b))
        });
        order
    }

    /// The squared distance of a feature from its nearest candidate as the camera projects it, px²,
    /// and that candidate's direction; `None` if no candidate is in front of the camera and within
    /// the lens model.
    pub(super) fn nearest(&self, camera: &PtzCamera, feature: usize) -> Option<(f64, Vec3)> {
        let (rotation, ptz, lens) = (camera.cam_from_base(), camera.ptz(), camera.lens());
        // This is the inner loop of RANSAC: project by hand, in normalised coordinates, and skip
        // rays behind the camera or beyond the fold of the lens. The pixel is compared as it is,
        // since distorting a ray is closed and undistorting a pixel iterates.
        let offset = self.points[feature].offset_from(camera.base().principal_point) / ptz.focal_px;
        let fold_squared = camera.fold_radius().powi(2);
        let mut best = None::<(f64, Vec3)>;
        for &ray in self.rays(feature) {
            // The negated comparison also rejects NaN.
            let in_cam = rotation * ray;
            if !(in_cam.z > touchline_core::camera::MIN_DEPTH) {
                continue;
            }
            let (x, y) = (in_cam.x / in_cam.z, in_cam.y / in_cam.z);
            let radius_squared = x * x + y * y;
            if radius_squared >= fold_squared {
                continue;
            }
            // The distorted projection, compared with the pixel in normalised coordinates; px² at
            // the end.
            let stretch = lens.stretch(radius_squared);
            let (dx, dy) = (
                x * stretch - offset.x,
                y * stretch * lens.pixel_aspect - offset.y,
            );
            let squared = (dx * dx + dy * dy) * ptz.focal_px * ptz.focal_px;
            if best.is_none_or(|(least, _)| squared < least) {
                best = Some((squared, ray));
            }
        }
        best
    }

    /// Features with their nearest candidates as observations.
    pub(super) fn observations(
        &self,
        camera: &PtzCamera,
        features: impl Iterator<Item = usize>,
        sigma_px: f64,
    ) -> Vec<Observation> {
        features
            .filter_map(|feature| {
                let (_, ray) = self.nearest(camera, feature)?;
                Some(Observation::from_point(
                    ray,
                    self.point(feature),
                    sigma_px,
                    feature,
                ))
            })
            .collect()
    }
}
