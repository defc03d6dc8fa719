//! Joint adjustment of matched frames of a camera with a known base: a prior of each frame's pan,
//! tilt and focal length, and the matches with its neighbours.

use super::cycles::ViewGraphEdge;
use super::pose_problem::{
    AdjustedFrame, PairwiseMatches, PosePrior, PoseProblem, PoseState, by_focal_px,
};
use super::relative_rotations::stop_after;
use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::solve::{Loss, minimise};

/// 1-σ of a match, px at 1920 px width: keypoints scatter by about 1 px, and crowds, boards and
/// lens models add to it.
const MATCH_SIGMA_PX: f64 = 2.0;

/// Maximum number of correspondences per pair of frames; more add little, since their errors are
/// correlated.
const OF_EDGE: usize = 6;

/// Scales of the Cauchy loss, in 1-σ, from coarse to fine: a frame whose start is far off must
/// first be reached by its matches.
const LOSS_SIGMAS: [f64; 3] = [30.0, 8.0, 2.0];

/// Adjusts matched frames to their matches and priors; `None` if that leaves a frame undetermined.
/// `start` has the cameras of all frames, `base` their lens.
pub fn adjust_matched_frames(
    base: &CameraBase,
    start: &[Ptz],
    edges: &[ViewGraphEdge],
    priors: &[PosePrior],
    image_size: ImageSize,
) -> Option<Vec<AdjustedFrame>> {
    let few: Vec<ViewGraphEdge> = edges
        .iter()
        .map(|edge| ViewGraphEdge {
            matches: subsample(&edge.matches, OF_EDGE).copied().collect(),
            ..*edge
        })
        .collect();
    // The envelope: each row reaches left to the earliest frame it has a match with.
    let mut first: Vec<usize> = (0..start.len()).collect();
    for edge in &few {
        let (one, other) = (edge.first.min(edge.second), edge.first.max(edge.second));
        first[other] = first[other].min(one);
    }
    let sigma_px = MATCH_SIGMA_PX * image_size.scale_from_1920();
    let problem = |sigmas| PoseProblem {
        bases: vec![base.at_origin(); start.len()],
        points: &[],
        matches: Some(PairwiseMatches {
            edges: &few,
            sigma_px,
            loss: Loss::Cauchy { c: sigmas },
        }),
        priors: priors.to_vec(),
        known_focal_px: vec![None; start.len()],
        first: &first,
        sigma_px: Vec::new(),
        loss: Loss::Squared,
    };
    let until = stop_after(10);
    // One descent per loss scale, each from the result of the last. The covariance is that of the
    // finest scale.
    let [first_sigmas, later @ ..] = LOSS_SIGMAS;
    let start = PoseState {
        ptz: start.to_vec(),
        directions: Vec::new(),
    };
    let mut found = minimise(&problem(first_sigmas), start, until);
    for sigmas in later {
        found = minimise(&problem(sigmas), found.state, until);
    }
    let covariances = found.equations.covariances()?;
    let frames = found
        .state
        .ptz
        .into_iter()
        .zip(covariances)
        .map(|(ptz, covariance)| AdjustedFrame {
            ptz: Ptz {
                pan: ptz.pan.wrap(),
                ..ptz
            },
            covariance: by_focal_px(&covariance, ptz.focal_px),
        });
    Some(frames.collect())
}

/// Pan, tilt and focal length of all frames in `base`, given some known cameras and the relative
/// `rotations` of all, in a common frame; `None` if no camera is known.
///
/// A frame without a known camera is placed relative to the known frame with which it has the most
/// inliers, or else relative to the first known frame.
pub fn fill_missing_cameras(
    known: &[Option<Ptz>],
    rotations: &[Ptz],
    edges: &[ViewGraphEdge],
) -> Option<Vec<Ptz>> {
    (0..known.len())
        .map(|frame| {
            if let Some(ptz) = known[frame] {
                return Some(ptz);
            }
            // A direct match with a known frame is best: relative rotations drift with the length
            // of the chain of matches.
            let beside = nearest_known_frame(frame, known, edges)?;
            let there = known[beside]?;
            // The known neighbour's camera relates the common frame to `base`. The optical axis is
            // mapped and roll is dropped; the focal length keeps its ratio to the neighbour's.
            let base_from_common =
                there.cam_from_base().transpose() * rotations[beside].cam_from_base();
            let ahead = base_from_common * rotations[frame].cam_from_base().row(2).transpose();
            let PanTilt { pan, tilt } = PanTilt::from_direction(ahead);
            Some(Ptz {
                pan,
                tilt,
                focal_px: rotations[frame].focal_px * there.focal_px / rotations[beside].focal_px,
            })
        })
        .collect()
}

/// The known frame relative to which a frame without a camera is placed: the one with which it has
/// the most inliers, or else the first known frame; `None` if no camera is known.
fn nearest_known_frame(
    frame: usize,
    known: &[Option<Ptz>],
    edges: &[ViewGraphEdge],
) -> Option<usize> {
    let beside = edges.iter().filter_map(|edge| {
        let other = if edge.first == frame {
            edge.second
        } else {
            edge.first
        };
        let is_of = edge.first == frame || edge.second == frame;
        (is_of && known[other].is_some()).then_some((edge.agreeing, other))
    });
    beside
        .max()
        .map(|(_, other)| other)
        .or_else(|| known.iter().position(Option::is_some))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::PriorSource;
    use touchline_core::camera::PtzCamera;
    use touchline_core::geometry::{Angle, ImagePoint, Mat3, Vec3};
    use touchline_core::testing::SIZE;

    fn base() -> CameraBase {
        CameraBase::new(
            Vec3::zeros(),
            touchline_core::camera::BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
    }

    fn truth() -> Vec<Ptz> {
        [
            (-6.0, -11.0, 2000.0),
            (2.0, -12.0, 2300.0),
            (9.0, -10.5, 1900.0),
        ]
        .map(|(pan, tilt, focal)| Ptz::from_degrees(pan, tilt, focal))
        .to_vec()
    }

    fn edges(truth: &[Ptz]) -> Vec<ViewGraphEdge> {
        let edge = |(first, second): (usize, usize)| {
            let [one, other] = [first, second].map(|frame| PtzCamera::new(base(), truth[frame]));
            let grid = (0..64).map(|at| {
                ImagePoint::new(
                    f64::from(at % 8) * 240.0 + 120.0,
                    f64::from(at / 8) * 135.0 + 67.0,
                )
            });
            let seen = |at: ImagePoint| {
                let there = other.image_from_ray(one.ray_from_image(at).ok()?).ok()?;
                SIZE.contains(there).then_some((at, there))
            };
            let matches: Vec<_> = grid.filter_map(seen).collect();
            ViewGraphEdge {
                first,
                second,
                agreeing: matches.len(),
                matches,
                second_from_first: Mat3::identity(),
            }
        };
        [(0, 1), (1, 2)].map(edge).to_vec()
    }

    fn prior(frame: usize, ptz: Ptz, sigma_deg: f64) -> PosePrior {
        let turn = sigma_deg.to_radians().powi(-2);
        PosePrior::new(
            frame,
            ptz,
            Mat3::from_diagonal(&Vec3::new(turn, turn, turn)),
            PriorSource::Person,
        )
    }

    #[test]
    fn a_frame_that_shows_nothing_is_placed_by_its_neighbours() {
        let truth = truth();
        let edges = edges(&truth);
        let known = [Some(truth[0]), None, None];
        let turned: Vec<Ptz> = truth
            .iter()
            .map(|ptz| Ptz {
                pan: ptz.pan + Angle::from_degrees(20.0),
                ..*ptz
            })
            .collect();
        let start = fill_missing_cameras(&known, &turned, &edges).unwrap();
        assert!((start[2].pan - truth[2].pan).degrees().abs() < 1e-9);
        let off = Ptz {
            pan: start[2].pan + Angle::from_degrees(0.5),
            ..start[2]
        };
        let adjusted = adjust_matched_frames(
            &base(),
            &[start[0], start[1], off],
            &edges,
            &[prior(0, truth[0], 0.01)],
            SIZE,
        )
        .unwrap();
        for (adjusted, exact) in adjusted.iter().zip(&truth) {
            assert!(
                (adjusted.ptz.pan - exact.pan).degrees().abs() < 1e-3,
                "{adjusted:?} for {exact:?}"
            );
            assert!(
                (adjusted.ptz.focal_px / exact.focal_px - 1.0).abs() < 1e-3,
                "{adjusted:?} for {exact:?}"
            );
        }
        // The farther from what is known, the less certain.
        assert!(adjusted[2].covariance[(0, 0)] > adjusted[1].covariance[(0, 0)]);
        assert!(adjusted[1].covariance[(0, 0)] > adjusted[0].covariance[(0, 0)]);
    }

    #[test]
    fn what_nothing_determines_is_refused() {
        let truth = truth();
        assert!(
            adjust_matched_frames(
                &base(),
                &truth,
                &edges(&truth)[..1],
                &[prior(0, truth[0], 0.01)],
                SIZE
            )
            .is_none()
        );
        assert!(fill_missing_cameras(&[None, None, None], &truth, &[]).is_none());
    }
}
