//! The joint adjustment of a clip: pan, tilt and focal length of every frame and the direction of
//! every tracked point, from all observations and pose priors at once.

use super::super::pose_problem::{
    AdjustedFrame, PointObservations, PosePrior, PoseProblem, PoseState, PriorSource, apply_offset,
    by_focal_px, offset,
};
use super::smooth::smoothed_offsets;
use super::{ClipCamera, PointTrack, PointTracks, PropagatedClip};
use touchline_core::camera::{PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::{Mat3, Vec3, median};
use touchline_core::solve::{Loss, Stopping, minimise};

/// Options of the joint adjustment of a clip. Lengths are in px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustOptions {
    /// 1-σ of a tracked point along one axis, before it is estimated from the clip itself. Default:
    /// 0.3.
    pub point_sigma_px: f64,
    /// Lower bound of the estimated 1-σ. Default: 0.05.
    pub min_sigma_px: f64,
    /// The scale of the Cauchy loss in 1-σ: beyond it a point is strongly down-weighted. Default:
    /// 3.
    pub loss_sigmas: f64,
    /// The number of observations of a track that count as one, because errors in neighbouring
    /// frames are correlated. Default: 4.
    pub sightings_alike: f64,
    /// Maximum number of iterations of each adjustment. Default: 15.
    pub max_iterations: usize,
}

impl Default for AdjustOptions {
    fn default() -> Self {
        Self {
            point_sigma_px: 0.3,
            min_sigma_px: 0.05,
            loss_sigmas: 3.0,
            sightings_alike: 4.0,
            max_iterations: 15,
        }
    }
}

/// A clip after the joint adjustment.
#[derive(Clone, Debug, PartialEq)]
pub struct AdjustedClip {
    /// The adjusted camera of each frame; `None` for a frame that was not reached.
    pub frames: Vec<Option<AdjustedFrame>>,
    /// 1-σ of a tracked point along one axis, estimated from the clip, px.
    pub sigma_px: f64,
    /// The factor by which the 1-σ of the points was inflated to make them agree with the priors; 1
    /// if they agree without.
    pub inflation: f64,
}

/// Adjusts all frames that propagation reached, together.
///
/// `None` if the clip is undetermined: no reached frame has an informative prior, or the normal
/// equations are singular.
pub fn adjust_clip(
    camera: &ClipCamera,
    tracks: &PointTracks,
    propagated: &PropagatedClip,
    priors: &[PosePrior],
    options: &AdjustOptions,
) -> Option<AdjustedClip> {
    // One row of unknowns per reached frame; frames that were not reached take no part.
    let mut row_of = vec![None; tracks.frames];
    let (mut start, mut frame_of) = (Vec::new(), Vec::new());
    for (frame, ptz) in propagated.ptz.iter().enumerate() {
        if let Some(ptz) = ptz {
            row_of[frame] = Some(start.len());
            start.push(camera.with_known_focal(frame, *ptz));
            frame_of.push(frame);
        }
    }
    let points = static_points(tracks, &propagated.moving, &row_of);
    // Without a prior only relative motion would be known, and pan and tilt of all frames open.
    let priors: Vec<PosePrior> = priors
        .iter()
        .filter(|prior| prior.is_informative())
        .filter_map(|prior| {
            Some(PosePrior {
                frame: row_of.get(prior.frame).copied().flatten()?,
                ..*prior
            })
        })
        .collect();
    if priors.is_empty() {
        return None;
    }
    // The envelope of the reduced normal equations: a point couples all frames that show it, so
    // each row reaches left to the earliest of them.
    let mut first: Vec<usize> = (0..start.len()).collect();
    for point in &points {
        let least = point.sightings.first().map_or(0, |(row, _)| *row);
        for (row, _) in &point.sightings {
            first[*row] = first[*row].min(least);
        }
    }
    // n correlated observations count as n / `sightings_alike` independent ones. Dividing their
    // information by that factor is multiplying σ by its root; the loss scale, in units of the
    // inflated σ, shrinks by the same factor and stays the same in px.
    let px = tracks.image_size.scale_from_1920();
    let alike = options.sightings_alike.sqrt();
    let mut problem = PoseProblem {
        bases: frame_of
            .iter()
            .map(|frame| camera.base_at(*frame).at_origin())
            .collect(),
        known_focal_px: frame_of
            .iter()
            .map(|frame| camera.focal_px_at(*frame))
            .collect(),
        points: &points,
        matches: None,
        priors,
        first: &first,
        sigma_px: vec![options.point_sigma_px * px * alike; start.len()],
        loss: Loss::Cauchy {
            c: options.loss_sigmas / alike,
        },
    };
    let until = Stopping {
        max_iterations: options.max_iterations,
        short_step: 1e-9,
        small_gain: 1e-8,
    };
    // First pass with the assumed σ; its residuals give σ of the clip and of each frame.
    let state = PoseState {
        directions: directions(&problem, &start),
        ptz: start,
    };
    let rough = minimise(&problem, state, until);
    let mut off: Vec<f64> = problem
        .residuals(&rough.state)
        .filter_map(|(_, off)| Some(off?.norm_squared()))
        .collect();
    let sigma_px = scatter_px(&mut off).max(options.min_sigma_px * px);
    // Motion blur displaces all points of a frame alike, and more observations do not average a
    // common error out. So a frame that scatters more than the clip is down-weighted beyond its own
    // σ, by the ratio of the two once more.
    let row_sigmas_px: Vec<f64> = row_sigmas(&problem, &rough.state, sigma_px)
        .into_iter()
        .map(|in_row_px| in_row_px * alike * (in_row_px / sigma_px))
        .collect();
    // Second pass with the estimated σ. Its cameras follow the motion of the points most closely;
    // `straight` stores them for the drift correction below.
    problem.sigma_px.clone_from(&row_sigmas_px);
    let mut fine = minimise(&problem, rough.state, until);
    let straight = fine.state.ptz.clone();
    // Inflate the σ of the points until the priors of persons and paint scatter as they state, and
    // the covariance of proposals until proposals do. The loss scale stays constant in px, so that
    // inflation does not readmit outliers. Each pass starts from the last one's result. After the
    // maximum number of passes a contradiction may be left, and the covariance is as it is.
    let mut inflation = 1.0;
    for _ in 0..MAX_INFLATIONS {
        let points = inflation_factor(&problem.priors, &fine.state, |source| {
            source != PriorSource::Proposal
        });
        let proposals = inflation_factor(&problem.priors, &fine.state, |source| {
            source == PriorSource::Proposal
        });
        if points.is_none() && proposals.is_none() {
            break;
        }
        inflation *= points.unwrap_or(1.0);
        problem.sigma_px = row_sigmas_px
            .iter()
            .map(|sigma_px| sigma_px * inflation)
            .collect();
        problem.loss = Loss::Cauchy {
            c: options.loss_sigmas / (alike * inflation),
        };
        // Information is the inverse of a variance, hence the square.
        let of_proposals = proposals.unwrap_or(1.0).powi(-2);
        for prior in problem
            .priors
            .iter_mut()
            .filter(|prior| prior.source == PriorSource::Proposal)
        {
            prior.information *= of_proposals;
        }
        fine = minimise(&problem, fine.state, until);
    }
    // If the points were inflated, their cameras jump at every prior; see `drift_corrected`. The
    // covariance is that of the inflated adjustment in any case.
    let covariances = fine.equations.covariances()?;
    let ptz = if inflation > 1.0 {
        drift_corrected(&straight, &fine.state.ptz, &covariances)
    } else {
        fine.state.ptz
    };
    // Back from rows to frames, and from ln f to f in px.
    let frames = row_of.iter().enumerate().map(|(frame, row)| {
        let row = (*row)?;
        let ptz = camera.with_known_focal(frame, ptz[row]);
        Some(AdjustedFrame {
            ptz,
            covariance: by_focal_px(&covariances[row], ptz.focal_px),
        })
    });
    Some(AdjustedClip {
        frames: frames.collect(),
        sigma_px,
        inflation,
    })
}

/// 1-σ of a tracked point along one axis in each row, px: estimated from the row's own residuals
/// and never below that of the clip. A fast pan blurs the picture and with it the points.
fn row_sigmas(problem: &PoseProblem<'_>, at: &PoseState, of_clip_px: f64) -> Vec<f64> {
    let mut squares: Vec<Vec<f64>> = vec![Vec::new(); at.ptz.len()];
    // A point's direction is fitted to its n observations, so their residuals have 1 − 1/n of the
    // variance of the noise.
    let shares = problem.points.iter().flat_map(|point| {
        let sightings = point.sightings.len();
        std::iter::repeat_n(1.0 - 1.0 / sightings as f64, sightings)
    });
    for ((row, off), share) in problem.residuals(at).zip(shares) {
        squares[row].extend(off.map(|off| off.norm_squared() / share));
    }
    squares
        .iter_mut()
        .map(|squares| scatter_px(squares).max(of_clip_px))
        .collect()
}

/// Robust 1-σ along one axis, from squared distances in the image, px.
fn scatter_px(squares: &mut [f64]) -> f64 {
    // The squared distance of two independent errors of 1-σ s has the median 2 ln 2 s² (χ² with two
    // degrees of freedom).
    (median(squares).unwrap_or(0.0) / (2.0 * 2f64.ln())).sqrt()
}

/// Inflate once the mean squared offset of the priors exceeds this many σ² per degree of freedom.
const CONTRADICTED: f64 = 1.5;

/// Maximum number of inflations.
const MAX_INFLATIONS: usize = 8;

/// The factor by which a σ has to be inflated, because the priors of some sources contradict the
/// points; `None` if they scatter as stated.
///
/// A small error of the lens or the base biases all points alike, so it does not appear in their
/// scatter; only user clicks and painted lines reveal it, and they then take precedence over the
/// points. Answers of a forest do not: their errors vary from frame to frame, and cameras that
/// followed them would jump at each.
fn inflation_factor(
    priors: &[PosePrior],
    at: &PoseState,
    is_included: impl Fn(PriorSource) -> bool,
) -> Option<f64> {
    // Squared Mahalanobis distance per degree of freedom: 1 on average if the prior's covariance is
    // right.
    let mut squares: Vec<f64> = priors
        .iter()
        .filter(|prior| is_included(prior.source))
        .map(|prior| {
            let offset = prior.offset(at.ptz[prior.frame]);
            offset.dot(&(prior.information * offset)) / 3.0
        })
        .collect();
    // The median of χ² with three degrees of freedom is 2.366 = 0.789 · 3. The median, not the
    // mean: one wrong prior must not inflate everything.
    let contradiction = median(&mut squares).unwrap_or(0.0) / 0.789;
    (contradiction > CONTRADICTED).then(|| contradiction.sqrt().clamp(1.5, 4.0))
}

/// Drift correction: shifts the cameras of the adjustment before inflation (`straight`), which
/// follow the points, smoothly towards those after it (`inflated`), which agree with the priors.
///
/// The error of a lens or a base varies as slowly as the camera moves. Cameras of inflated points
/// jump at every prior instead; so only their slowly varying difference from `straight` is applied.
fn drift_corrected(straight: &[Ptz], inflated: &[Ptz], covariances: &[Mat3]) -> Vec<Ptz> {
    /// Time constant of the drift correction, in frames.
    const FRAMES: f64 = 15.0;
    // The difference per frame in (pan rad, tilt rad, ln f), treated as a measurement with the
    // frame's covariance.
    let by: Vec<Vec3> = straight
        .iter()
        .zip(inflated)
        .map(|(from, to)| offset(*from, *to))
        .collect();
    // A smoother whose rate performs a random walk of variance q per frame, on measurements of
    // variance R, has a time constant of about (R/q)^¼ frames; hence q = R / 15⁴.
    let typical = [0, 1, 2].map(|axis| median_variance(covariances, axis));
    let unrest = Vec3::from(typical) / FRAMES.powi(4);
    let drift = smoothed_offsets(&by, covariances, &unrest);
    straight
        .iter()
        .zip(drift)
        .map(|(ptz, by)| apply_offset(*ptz, by))
        .collect()
}

/// The median over all frames of the variance of one parameter (0: pan, 1: tilt, 2: focal length).
fn median_variance(covariances: &[Mat3], parameter: usize) -> f64 {
    let mut variances: Vec<f64> = covariances
        .iter()
        .map(|covariance| covariance[(parameter, parameter)])
        .collect();
    median(&mut variances).unwrap_or(0.0)
}

/// The points that at least two reached frames show and that do not move in the scene.
fn static_points(
    tracks: &PointTracks,
    moving: &[bool],
    row_of: &[Option<usize>],
) -> Vec<PointObservations> {
    let still = tracks
        .tracks
        .iter()
        .zip(moving)
        .filter(|(_, moving)| !**moving);
    // One observation alone says nothing about the camera.
    still
        .map(|(track, _)| observations(track, row_of))
        .filter(|point| point.sightings.len() > 1)
        .collect()
}

/// The observations of a track in the frames that were reached, in ascending order of the rows.
fn observations(track: &PointTrack, row_of: &[Option<usize>]) -> PointObservations {
    let sightings = track
        .points
        .iter()
        .enumerate()
        .filter_map(|(place, point)| Some((row_of[track.first + place]?, *point)))
        .collect();
    PointObservations { sightings }
}

/// The start direction of each point, unit, `base`: the mean of its rays over the frames that show
/// it.
fn directions(problem: &PoseProblem<'_>, ptz: &[Ptz]) -> Vec<Vec3> {
    let cameras = problem.cameras(ptz);
    problem
        .points
        .iter()
        .map(|point| mean_direction(point, &cameras))
        .collect()
}

/// The mean of a point's rays, unit, `base`; `cameras` has the camera of each row.
fn mean_direction(point: &PointObservations, cameras: &[PtzCamera]) -> Vec3 {
    let rays = point
        .sightings
        .iter()
        .filter_map(|(row, at)| cameras[*row].ray_from_image(*at).ok());
    // Without a ray within the lens model, any direction serves as a start.
    let sum: Vec3 = rays.map(PanTilt::direction).sum();
    sum.try_normalize(1e-9).unwrap_or_else(Vec3::z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::PointTrack;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Mcg;
    use touchline_core::camera::{CameraBase, PtzCamera};
    use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

    const SIGMA_DEG: f64 = 0.01;

    fn covariance() -> Mat3 {
        let turn = SIGMA_DEG.to_radians();
        Mat3::from_diagonal(&Vec3::new(turn * turn, turn * turn, 1e-6))
    }

    fn pans(of: impl Fn(usize) -> f64) -> Vec<Ptz> {
        (0..200)
            .map(|frame| Ptz::from_degrees(of(frame), -10.0, 2000.0))
            .collect()
    }

    #[test]
    fn a_drift_that_changes_slowly_stays_and_jumps_at_anchors_go() {
        let straight = pans(|frame| 0.1 * frame as f64);
        let slow = |frame: usize| 0.2 * (frame as f64 / 60.0).sin();
        let jumping = pans(|frame| {
            0.1 * frame as f64 + slow(frame) + if frame.is_multiple_of(20) { 0.05 } else { 0.0 }
        });
        let corrected = drift_corrected(&straight, &jumping, &vec![covariance(); 200]);
        let pan = |frame: usize| corrected[frame].pan.degrees();
        for frame in 10..190 {
            let off = pan(frame) - 0.1 * frame as f64 - slow(frame);
            assert!(off.abs() < 0.012, "frame {frame}: {off}");
            let jump = pan(frame + 1) - 2.0 * pan(frame) + pan(frame - 1);
            assert!(jump.abs() < 0.002, "frame {frame}: {jump}");
        }
    }

    #[test]
    fn a_blurred_row_says_so_itself() {
        const SHARP_PX: f64 = 0.15;
        const BLURRED_PX: f64 = 0.8;
        let ptz = pans(|frame| 0.1 * frame as f64)[..6].to_vec();
        let base = CameraBase::new(
            Vec3::zeros(),
            Mat3::identity(),
            ImagePoint::new(640.0, 360.0),
        );
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut shaken = |px: f64| Normal::new(0.0, px).unwrap().sample(&mut random);
        let directions: Vec<Vec3> = (0..400)
            .map(|place| {
                let at = ImagePoint::new(
                    200.0 + 2.0 * f64::from(place),
                    100.0 + f64::from(place * 37 % 500),
                );
                PtzCamera::new(base, ptz[2])
                    .ray_from_image(at)
                    .unwrap()
                    .direction()
            })
            .collect();
        let seen_from = |direction: &Vec3| PointObservations {
            sightings: (0..ptz.len())
                .map(|row| {
                    let at = PtzCamera::new(base, ptz[row])
                        .image_from_ray(PanTilt::from_direction(*direction))
                        .unwrap();
                    let px = if row == 3 { BLURRED_PX } else { SHARP_PX };
                    (row, at.translate(Vec2::new(shaken(px), shaken(px))))
                })
                .collect(),
        };
        let points: Vec<PointObservations> = directions.iter().map(seen_from).collect();
        let problem = PoseProblem {
            bases: vec![base; 6],
            known_focal_px: vec![None; 6],
            points: &points,
            matches: None,
            priors: Vec::new(),
            first: &[0; 6],
            sigma_px: vec![SHARP_PX; 6],
            loss: Loss::Cauchy { c: 3.0 },
        };
        let sigmas = row_sigmas(&problem, &PoseState { ptz, directions }, 0.1);
        for (row, sigma) in sigmas.into_iter().enumerate() {
            // The directions are exact here, so that nothing of the scatter went into them.
            let expected =
                if row == 3 { BLURRED_PX } else { SHARP_PX } / (1.0f64 - 1.0 / 6.0).sqrt();
            assert!(
                (sigma / expected - 1.0).abs() < 0.15,
                "row {row}: {sigma} px, {expected} expected"
            );
        }
    }

    #[test]
    fn what_a_blurred_frame_is_off_by_alike_gives_way_to_a_click() {
        const OFF_PX: f64 = 1.0;
        const CLICK_PX: f64 = 0.3;
        let ptz = pans(|frame| 0.1 * frame as f64)[..6].to_vec();
        let base = CameraBase::new(
            Vec3::zeros(),
            Mat3::identity(),
            ImagePoint::new(640.0, 360.0),
        );
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut shaken = |px: f64| Normal::new(0.0, px).unwrap().sample(&mut random);
        let tracks = (0..400).map(|place| {
            let at = ImagePoint::new(
                200.0 + 2.0 * f64::from(place),
                100.0 + f64::from(place * 37 % 500),
            );
            let ray = PtzCamera::new(base, ptz[2]).ray_from_image(at).unwrap();
            let seen_from = |(row, ptz): (usize, &Ptz)| {
                let at = PtzCamera::new(base, *ptz).image_from_ray(ray).unwrap();
                let (px, off) = if row == 3 { (0.8, OFF_PX) } else { (0.15, 0.0) };
                at.translate(Vec2::new(off + shaken(px), shaken(px)))
            };
            PointTrack {
                first: 0,
                points: ptz.iter().enumerate().map(seen_from).collect(),
            }
        });
        let tracks = PointTracks {
            image_size: ImageSize::new(1280, 720),
            frames: 6,
            tracks: tracks.collect(),
        };
        let propagated = PropagatedClip {
            ptz: ptz.iter().copied().map(Some).collect(),
            moving: vec![false; tracks.tracks.len()],
            apart_px: vec![None; 6],
            stops: Vec::new(),
        };
        let turn = CLICK_PX / 2000.0;
        let covariance = Mat3::from_diagonal(&Vec3::new(turn * turn, turn * turn, 0.25));
        let priors = [0, 1, 3, 5].map(|frame| {
            PosePrior::from_covariance(frame, ptz[frame], &covariance, PriorSource::Person)
        });
        let adjusted = adjust_clip(
            &ClipCamera::new(base),
            &tracks,
            &propagated,
            &priors,
            &AdjustOptions::default(),
        )
        .unwrap();
        let off_px = |frame: usize| {
            let turned = adjusted.frames[frame]
                .unwrap()
                .ptz
                .pan
                .turn_from(ptz[frame].pan);
            (turned.degrees().to_radians() * 2000.0).abs()
        };
        assert!(off_px(3) < 0.5 * OFF_PX, "{} px", off_px(3));
        assert!(
            off_px(2) < 0.1 && off_px(4) < 0.1,
            "{} and {} px",
            off_px(2),
            off_px(4)
        );
    }

    #[test]
    fn points_give_way_to_people_and_paint_and_not_to_proposals() {
        let ptz = Ptz::from_degrees(0.0, -10.0, 2000.0);
        let off = Ptz::from_degrees(20.0 * SIGMA_DEG, -10.0, 2000.0);
        let at = PoseState {
            ptz: vec![ptz; 3],
            directions: Vec::new(),
        };
        let prior = |frame: usize, ptz: Ptz, source: PriorSource| {
            PosePrior::from_covariance(frame, ptz, &covariance(), source)
        };
        let of_points = |by: PriorSource| by != PriorSource::Proposal;
        let proposals = [0, 1].map(|frame| prior(frame, off, PriorSource::Proposal));
        assert_eq!(inflation_factor(&proposals, &at, of_points), None);
        assert!(inflation_factor(&proposals, &at, |by| !of_points(by)).is_some_and(|by| by > 3.0));
        let painted = prior(2, off, PriorSource::Paint);
        assert!(
            inflation_factor(&[proposals[0], painted], &at, of_points).is_some_and(|by| by > 3.0)
        );
        let agreeing = prior(2, ptz, PriorSource::Person);
        assert_eq!(
            inflation_factor(&[proposals[0], agreeing], &at, of_points),
            None
        );
    }
}
