//! The baselines, each in its strongest known form.

use crate::matching::{DescriptorRows, Nearest, nearest};
use crate::ransac::{Match, agreeing, by_four_points, through};
use crate::sets::KnownFrame;
use crate::setting::rng;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::geometry::{Angle, ImagePoint, Mat3, Vec3};
use touchline::relocalize::{
    PoseOptions, PredictOptions, RayCandidate, RayMatches, pose_from_candidates,
};
use touchline::solve::pose_from_plane;

/// Ratio test (Lowe 2004): a match is accepted if its distance is below this share of the
/// second-nearest's, squared.
const RATIO_SQUARED: f32 = 0.8 * 0.8;
/// Number of references that are verified geometrically: those with most matches.
const VERIFIED: usize = 5;
/// Minimum number of matches for a homography.
const LEAST: usize = 4;

/// A reference frame, prepared for matching.
pub struct Reference<'a> {
    pub known: &'a KnownFrame,
    pub rows: DescriptorRows,
}

impl<'a> Reference<'a> {
    pub fn from_known_frame(known: &'a KnownFrame) -> Self {
        Self {
            known,
            rows: DescriptorRows::from_descriptors(&known.features.descriptors),
        }
    }
}

/// A test frame and the nearest neighbours of its features in each reference.
pub struct Matched<'a> {
    pub query: &'a KnownFrame,
    /// One list for each reference.
    pub nearest: Vec<Vec<Nearest>>,
    pub seed: u64,
}

impl<'a> Matched<'a> {
    /// Matches a frame to references.
    pub fn to(query: &'a KnownFrame, references: &[Reference<'_>], seed: u64) -> Self {
        let rows = DescriptorRows::from_descriptors(&query.features.descriptors);
        let nearest = references
            .iter()
            .map(|reference| nearest(&rows, &reference.rows))
            .collect();
        Self {
            query,
            nearest,
            seed,
        }
    }

    /// The paper's baseline, strengthened. Of the five references with most matches, the one with
    /// most inliers of a homography (four-point RANSAC) is chosen, and the camera follows from that
    /// homography and the reference's camera. The base is not used.
    pub fn by_homography(&self, references: &[Reference<'_>]) -> Option<PtzCamera> {
        let verified = self
            .most_matches(references.len())
            .into_iter()
            .filter_map(|at| {
                // Four pairs determine a homography; with fewer RANSAC cannot draw a sample.
                let pairs = self.pairs(&references[at], at);
                if pairs.len() < LEAST {
                    return None;
                }
                // The generator depends on frame and reference, so that the result is the same
                // whichever references were tried before.
                let h = by_four_points(&pairs, &mut rng(self.seed, [71, at as u64])).0?;
                Some((agreeing(&h, &pairs), at, h))
            });
        // Of equal counts take the first, so that the result is deterministic.
        let (_, at, h) = verified.max_by_key(|(count, at, _)| (*count, std::cmp::Reverse(*at)))?;
        // The homography relates two pictures; the reference's camera relates it to the ground.
        camera_through(
            &references[at].known.truth,
            &h,
            self.query.features.image_size.centre(),
            self.query,
        )
    }

    /// The same five references, each verified by two-point RANSAC with the known base. The camera
    /// with most inliers is chosen.
    pub fn by_known_base(
        &self,
        references: &[Reference<'_>],
        options: &PoseOptions,
    ) -> Option<PtzCamera> {
        let base = *self.query.truth.base();
        let size = self.query.features.image_size;
        let poses = self
            .most_matches(references.len())
            .into_iter()
            .filter_map(|at| {
                // A match becomes a pixel and the ray of its reference's pixel in the shared base:
                // the reference's camera is needed for nothing else.
                let mut matches = RayMatches::new();
                for (keypoint, nearest) in
                    self.query.features.keypoints.iter().zip(&self.nearest[at])
                {
                    if passes_ratio(nearest) {
                        push_ray(&mut matches, keypoint.point, &references[at], nearest);
                    }
                }
                let pose = pose_from_candidates(&matches, &base, size, options).ok()?;
                Some((pose.inliers.len(), at, pose.ptz))
            });
        let (.., ptz) = poses.max_by_key(|(count, at, _)| (*count, std::cmp::Reverse(*at)))?;
        Some(PtzCamera::new(base, ptz))
    }

    /// The ray of each feature's nearest neighbour among all references, then the camera by
    /// two-point RANSAC.
    pub fn by_neighbours(
        &self,
        references: &[Reference<'_>],
        options: &PoseOptions,
    ) -> Option<PtzCamera> {
        let gate = PredictOptions::default().max_squared_distance;
        let mut matches = RayMatches::new();
        for (feature, keypoint) in self.query.features.keypoints.iter().enumerate() {
            let of_all = self.nearest[..references.len()].iter().zip(references);
            let each =
                of_all.filter_map(|(nearest, reference)| Some((nearest.get(feature)?, reference)));
            // Over all references together, without a ratio test: the second-nearest neighbour
            // usually shows the same point in another reference.
            let best = each.min_by(|a, b| a.0.squared_distance.total_cmp(&b.0.squared_distance));
            if let Some((nearest, reference)) =
                // The gate of the forests, so that only the search for neighbours differs.
                best.filter(|(nearest, _)| nearest.squared_distance <= gate)
            {
                push_ray(&mut matches, keypoint.point, reference, nearest);
            }
        }
        let base = *self.query.truth.base();
        let pose =
            pose_from_candidates(&matches, &base, self.query.features.image_size, options).ok()?;
        Some(PtzCamera::new(base, pose.ptz))
    }

    /// Of the first `references` references, the [`VERIFIED`] with most matches.
    fn most_matches(&self, references: usize) -> Vec<usize> {
        let count = |at: usize| {
            self.nearest[at]
                .iter()
                .filter(|nearest| passes_ratio(nearest))
                .count()
        };
        let mut order: Vec<(usize, usize)> = (0..references).map(|at| (count(at), at)).collect();
        // Of equal counts the first reference, for the order must not depend on the sort.
        order.sort_by_key(|(count, at)| (std::cmp::Reverse(*count), *at));
        order.into_iter().take(VERIFIED).map(|(_, at)| at).collect()
    }

    /// Matched pixels: in the reference (as `ground`) and in the test frame.
    fn pairs(&self, reference: &Reference<'_>, at: usize) -> Vec<Match> {
        let each = self.query.features.keypoints.iter().zip(&self.nearest[at]);
        let good = each.filter(|(_, nearest)| passes_ratio(nearest));
        good.map(|(keypoint, nearest)| {
            let from = reference.known.features.keypoints[nearest.feature].point;
            Match {
                ground: Vec3::new(from.x, from.y, 0.0),
                image: keypoint.point,
            }
        })
        .collect()
    }
}

fn passes_ratio(nearest: &Nearest) -> bool {
    nearest.squared_distance < RATIO_SQUARED * nearest.second
}

fn push_ray(
    matches: &mut RayMatches,
    point: ImagePoint,
    reference: &Reference<'_>,
    nearest: &Nearest,
) {
    let from = reference.known.features.keypoints[nearest.feature].point;
    if let Ok(ray) = reference.known.truth.ray_from_image(from) {
        matches.push(
            point,
            &[RayCandidate {
                ray,
                squared_distance: nearest.squared_distance,
            }],
        );
    }
}

/// The camera of a frame, from its reference's camera and the homography `h` from reference to
/// frame: ground points that the reference sees are mapped by `h`, and a pose is solved from them.
fn camera_through(
    reference: &PtzCamera,
    h: &Mat3,
    centre: ImagePoint,
    query: &KnownFrame,
) -> Option<PtzCamera> {
    let size = query.features.image_size;
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    // A grid of 20 points over the lower part of the picture, where ground is likely: from 0.1 to
    // 0.9 of the width and from 0.35 to 0.95 of the height.
    let grid = (0..5)
        .flat_map(|i| (0..4).map(move |j| (0.1 + 0.2 * f64::from(i), 0.35 + 0.2 * f64::from(j))));
    let pairs = grid.filter_map(|(x, y)| {
        let pixel = ImagePoint::new(x * width, y * height);
        let ground = reference.plane_from_image(pixel, 0.0)?;
        Some((ground.xy(), through(h, Vec3::new(pixel.x, pixel.y, 0.0))?))
    });
    let points: Vec<_> = pairs.collect();
    // Square pixels, principal point in the middle, no distortion: what a homography of the ground
    // can give. Points above the horizon or at infinity were left out.
    let pose = pose_from_plane(&points, centre).ok()?;
    // Its whole rotation is put into the base, with pan and tilt 0: the base is the answer's own,
    // and errors are measured on the rotation as a whole.
    let base = CameraBase::new(pose.position_m, pose.cam_from_world, centre);
    Some(PtzCamera::new(
        base,
        Ptz {
            pan: Angle::ZERO,
            tilt: Angle::ZERO,
            focal_px: pose.focal_px,
        },
    ))
}
