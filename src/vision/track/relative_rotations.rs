//! Pan, tilt and focal length of matched frames, and the lens, from pairwise matches alone.
//!
//! A camera that stands still and rotates sees every static point in one direction. Rotations are
//! first estimated freely. The axis perpendicular to the x axes of all frames is the pan axis;
//! afterwards only pan, tilt and focal length of each frame are free, so that all matches together
//! determine the axis.

use super::edge_problem::{EdgeProblem, EdgeState, Freedom, residual_px};
use super::start::{steps, views};
use super::{TrackError, ViewGraphEdge};
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera, StatedLens};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_core::solve::{Equations, Loss, Stopping, minimise};

/// The lens prior, and options of the adjustment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnOptions {
    /// Prior mean of k₁ and of its change with the focal length; lengths are in px at 1920 px
    /// width.
    pub lens: FocalCurve,
    /// 1-σ of k₁. Default: 0.1.
    pub k1_sigma: f64,
    /// 1-σ of its change per 1000 px at 1920 px width. Default: 0.1.
    pub slope_sigma: f64,
    /// A factor applied to all focal lengths after the matches have determined them; everything
    /// else is adjusted to it. Default: 1.
    ///
    /// The common scale of the focal lengths is what matches determine worst.
    pub focal_scale: f64,
    /// The principal point of the frames, px; none: the middle of the picture. Default: none.
    pub principal_point: Option<ImagePoint>,
}

impl TurnOptions {
    /// The options with a lens as it is stated for frames of a size.
    pub fn with_lens(lens: &StatedLens, image_size: ImageSize) -> Self {
        let mut options = Self {
            principal_point: lens.principal_point,
            ..Self::default()
        };
        options.lens.pixel_aspect = lens.pixel_aspect.unwrap_or(1.0);
        if let Some(radial) = lens.radial {
            let px = image_size.scale_from_1920();
            (options.lens.value, options.k1_sigma) = radial.k1_at(options.lens.at_focal_px * px);
            options.lens.per_1000_px = radial.curve.per_1000_px * px;
            options.lens.k2_per_k1_squared = radial.curve.k2_per_k1_squared;
            options.slope_sigma = radial.per_1000_px_sigma * px;
        }
        options
    }
}

impl Default for TurnOptions {
    fn default() -> Self {
        Self {
            lens: FocalCurve {
                at_focal_px: 2000.0,
                value: -0.02,
                per_1000_px: 0.21,
                ..FocalCurve::NONE
            },
            k1_sigma: 0.1,
            slope_sigma: 0.1,
            focal_scale: 1.0,
            principal_point: None,
        }
    }
}

/// Relative pan, tilt and focal length of the frames of one camera, and its lens.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeRotations {
    /// Pan, tilt and focal length of each frame; pan 0 is the mean viewing direction.
    pub ptz: Vec<Ptz>,
    /// k₁ as a function of the focal length, in px of these frames.
    pub lens: FocalCurve,
    /// The principal point of the frames, px.
    pub principal_point: ImagePoint,
    /// The median residual of the matches, px at 1920 px width.
    pub residual_px: f64,
}

impl RelativeRotations {
    /// A frame's camera, at the origin of `world`, the pan axis along world z.
    pub fn camera(&self, frame: usize) -> PtzCamera {
        let level = BaseAngles::default().base_from_world();
        let base = CameraBase {
            distortion: self.lens,
            ..CameraBase::new(Vec3::zeros(), level, self.principal_point)
        };
        PtzCamera::new(base, self.ptz[frame])
    }
}

/// Largest median residual that a rotating camera may leave, px at 1920 px width.
const NOT_TURNING_PX: f64 = 6.0;

/// Start values of the first frame's focal length, in picture widths.
const FOCAL_WIDTHS: [f64; 7] = [0.8, 1.1, 1.5, 2.1, 3.0, 4.3, 6.2];

/// Estimates pan, tilt and focal length of `count` frames of one size that are connected by
/// matches.
///
/// # Errors
/// Fewer than two frames, frames that are not connected, or matches that no rotation and zoom
/// explains.
pub fn adjust_rotations(
    count: usize,
    edges: &[ViewGraphEdge],
    image_size: ImageSize,
    options: &TurnOptions,
) -> Result<RelativeRotations, TrackError> {
    // A spanning tree of the view graph reaches every frame; otherwise the frames are not
    // connected.
    let principal_point = options.principal_point.unwrap_or(image_size.centre());
    let along = steps(count, edges, (principal_point, options.lens.pixel_aspect));
    if count < 2 || along.len() < count {
        return Err(TrackError::TooFew {
            frames: count,
            edges: edges.len(),
        });
    }
    // The lens prior in px of these frames: the slope is per px, so it scales inversely.
    let px = image_size.scale_from_1920();
    let expected = FocalCurve {
        at_focal_px: options.lens.at_focal_px * px,
        per_1000_px: options.lens.per_1000_px / px,
        ..options.lens
    };
    let mut problem = EdgeProblem {
        edges,
        freedom: Freedom::Any,
        loss: Loss::Cauchy { c: 20.0 },
        px,
        expected,
        sigma: [options.k1_sigma, options.slope_sigma / px],
        fixed_scale: false,
    };
    // 1. Self-calibration from matches has local minima in the focal length. Descend briefly from
    //    each start value and keep the one of least robust cost. There is always one.
    let descents = FOCAL_WIDTHS.iter().map(|widths| {
        let focal_px = widths * image_size.reference_width_px();
        let start = EdgeState {
            views: views(count, &along, principal_point, focal_px),
            lens: expected,
        };
        minimise(&problem, start, stop_after(8))
    });
    let best = descents.min_by(|a, b| a.equations.cost().total_cmp(&b.equations.cost()));
    let Some(best) = best else {
        return Err(TrackError::TooFew {
            frames: count,
            edges: edges.len(),
        });
    };
    // 2. Free rotations, with the robust loss from coarse to fine. Roll is free as well, because
    //    the pan axis is not known yet.
    let state = descend(&mut problem, best.state, [20.0, 6.0]);
    // 3. Make the pan axis the y axis of the common frame; then every frame has pan, tilt and focal
    //    length only, and no roll.
    problem.freedom = Freedom::PanTilt;
    let mut state = descend(&mut problem, state.upright(), [6.0, 3.0]);
    // 4. Impose the focal scale and let everything else follow. The scale itself is fixed, since
    //    the matches would pull it back. The loss begins coarse again: scaled angles fit only
    //    roughly.
    if options.focal_scale != 1.0 {
        problem.fixed_scale = true;
        let scaled = state.scale_focal_lengths(options.focal_scale);
        state = descend(&mut problem, scaled, [20.0, 4.0]);
    }
    let residual_px = residual_px(edges, &state) / px;
    // A scale other than 1 leaves residuals even if the camera rotates; allow for them. The negated
    // comparison also rejects NaN.
    if !(residual_px <= NOT_TURNING_PX * options.focal_scale.max(1.0 / options.focal_scale).powi(2))
    {
        return Err(TrackError::NotTurning {
            frames: count,
            edges: edges.len(),
            residual_px,
        });
    }
    Ok(RelativeRotations {
        ptz: state.ptz(),
        lens: state.lens,
        principal_point,
        residual_px,
    })
}

/// Descends under a Cauchy loss of each of two scales, px at 1920 px width, coarse to fine.
fn descend(problem: &mut EdgeProblem<'_>, start: EdgeState, loss_scales_px: [f64; 2]) -> EdgeState {
    loss_scales_px.into_iter().fold(start, |state, c| {
        problem.loss = Loss::Cauchy { c };
        minimise(problem, state, stop_after(30)).state
    })
}

/// When an adjustment of matched frames ends.
pub(super) const fn stop_after(max_iterations: usize) -> Stopping {
    Stopping {
        max_iterations,
        short_step: 1e-7,
        small_gain: 1e-6,
    }
}

#[cfg(test)]
mod tests {
    use super::super::edge_residual::View;
    use super::*;
    use touchline_core::geometry::Mat3;
    use touchline_core::testing::SIZE;

    const LENS: FocalCurve = FocalCurve {
        at_focal_px: 2000.0,
        value: -0.05,
        per_1000_px: 0.15,
        ..FocalCurve::NONE
    };

    fn truth() -> RelativeRotations {
        truth_about(SIZE.centre())
    }

    fn truth_about(principal_point: ImagePoint) -> RelativeRotations {
        let ptz = [
            (-24.0, -11.0, 1700.0),
            (-13.0, -13.0, 1850.0),
            (-2.0, -14.0, 2000.0),
            (8.0, -12.5, 1600.0),
            (16.0, -12.0, 2300.0),
            (24.0, -10.0, 1900.0),
        ];
        let ptz = ptz
            .map(|(pan, tilt, focal_px)| Ptz::from_degrees(pan, tilt, focal_px))
            .to_vec();
        RelativeRotations {
            ptz,
            lens: LENS,
            principal_point,
            residual_px: 0.0,
        }
    }

    /// The edges of frames that see the same directions, `noise_px` off in a pattern that repeats
    /// nowhere.
    fn edges(truth: &RelativeRotations, noise_px: f64) -> Vec<ViewGraphEdge> {
        let mut edges = Vec::new();
        for first in 0..truth.ptz.len() {
            for second in first + 1..truth.ptz.len() {
                let (one, other) = (truth.camera(first), truth.camera(second));
                let mut matches = Vec::new();
                for index in 0..160_u32 {
                    let at = ImagePoint::new(
                        f64::from(index % 16) * 120.0 + 60.0,
                        f64::from(index / 16) * 108.0 + 54.0,
                    );
                    let there = one
                        .ray_from_image(at)
                        .ok()
                        .and_then(|ray| other.image_from_ray(ray).ok());
                    let Some(there) = there.filter(|there| SIZE.contains(*there)) else {
                        continue;
                    };
                    let turn = f64::from(index * 37 + first as u32 * 11 + second as u32);
                    let noise = touchline_core::geometry::Vec2::new(turn.sin(), (1.7 * turn).cos())
                        * noise_px;
                    matches.push((at, there.translate(noise)));
                }
                if matches.len() < 15 {
                    continue;
                }
                let vector =
                    |point: ImagePoint| touchline_core::geometry::Vec2::new(point.x, point.y);
                let pairs: Vec<_> = matches
                    .iter()
                    .map(|(a, b)| (vector(*a), vector(*b)))
                    .collect();
                let second_from_first = touchline_core::geometry::homography(&pairs).unwrap();
                edges.push(ViewGraphEdge {
                    first,
                    second,
                    agreeing: matches.len(),
                    matches,
                    second_from_first,
                });
            }
        }
        edges
    }

    #[test]
    fn exact_edges_give_back_pan_tilt_focal_length_and_lens() {
        let truth = truth();
        let options = TurnOptions {
            k1_sigma: 10.0,
            slope_sigma: 10.0,
            ..TurnOptions::default()
        };
        let found = adjust_rotations(6, &edges(&truth, 0.0), SIZE, &options).unwrap();
        let middle = found.ptz[0].pan - truth.ptz[0].pan;
        for (found, exact) in found.ptz.iter().zip(&truth.ptz) {
            assert!(
                (found.pan - exact.pan - middle).degrees().abs() < 0.02,
                "{found:?} for {exact:?}"
            );
            assert!(
                (found.tilt - exact.tilt).degrees().abs() < 0.02,
                "{found:?} for {exact:?}"
            );
            assert!(
                (found.focal_px / exact.focal_px - 1.0).abs() < 1e-3,
                "{found:?} for {exact:?}"
            );
        }
        assert!(
            (found.lens.at(1900.0) - LENS.at(1900.0)).abs() < 2e-3,
            "{:?}",
            found.lens
        );
        assert!(found.residual_px < 0.05, "{}", found.residual_px);
    }

    #[test]
    fn pictures_cut_off_centre_turn_about_their_stated_principal_point() {
        let principal_point = ImagePoint::new(1300.0, 380.0);
        let truth = truth_about(principal_point);
        let adjust = |stated: Option<ImagePoint>| {
            let lens = StatedLens {
                principal_point: stated,
                ..StatedLens::default()
            };
            adjust_rotations(
                6,
                &edges(&truth, 0.0),
                SIZE,
                &TurnOptions::with_lens(&lens, SIZE),
            )
        };
        let found = adjust(Some(principal_point)).unwrap();
        assert_eq!(found.camera(0).base().principal_point, principal_point);
        for (found, exact) in found.ptz.iter().zip(&truth.ptz) {
            let off = (found.focal_px / exact.focal_px - 1.0).abs();
            assert!(off < 0.01, "{found:?} for {exact:?}");
        }
        // About the middle of the picture, no camera that only rotates explains them.
        let without = adjust(None);
        assert!(
            matches!(&without, Err(TrackError::NotTurning { residual_px, .. }) if *residual_px > 4.0 * found.residual_px),
            "{without:?} in place of {} px",
            found.residual_px
        );
    }

    #[test]
    fn pictures_with_pixels_that_are_not_square_turn_with_their_stated_aspect() {
        let mut truth = truth();
        truth.lens.pixel_aspect = 0.75;
        let edges = edges(&truth, 0.0);
        let lens = StatedLens {
            pixel_aspect: Some(0.75),
            ..StatedLens::default()
        };
        let options = TurnOptions::with_lens(&lens, SIZE);
        let found = adjust_rotations(6, &edges, SIZE, &options).unwrap();
        assert_eq!(found.lens.pixel_aspect, 0.75);
        for (found, exact) in found.ptz.iter().zip(&truth.ptz) {
            let off = (found.focal_px / exact.focal_px - 1.0).abs();
            assert!(off < 0.01, "{found:?} for {exact:?}");
        }
    }

    #[test]
    fn a_few_wrong_edges_do_no_harm() {
        let truth = truth();
        let mut edges = edges(&truth, 0.7);
        let away = touchline_core::geometry::Vec2::new(400.0, -150.0);
        let wrong = edges
            .iter_mut()
            .find(|edge| edge.second == edge.first + 1)
            .unwrap();
        for (_, there) in &mut wrong.matches {
            *there = there.translate(away);
        }
        wrong.second_from_first =
            Mat3::new(1.0, 0.0, 400.0, 0.0, 1.0, -150.0, 0.0, 0.0, 1.0) * wrong.second_from_first;
        let kept = crate::track::cycles::cycle_consistent_edges(&edges, SIZE);
        let names = |edges: &[ViewGraphEdge]| {
            edges
                .iter()
                .map(|edge| (edge.first, edge.second))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            names(&kept),
            names(&edges)[1..],
            "only the wrong match is removed"
        );
        let found = adjust_rotations(6, &kept, SIZE, &TurnOptions::default()).unwrap();
        for (found, exact) in found.ptz.iter().zip(&truth.ptz) {
            assert!(
                (found.focal_px / exact.focal_px - 1.0).abs() < 0.03,
                "{found:?} for {exact:?}"
            );
        }
    }

    #[test]
    fn edges_stretch_at_another_requested_scale() {
        let options = TurnOptions {
            focal_scale: 1.06,
            ..TurnOptions::default()
        };
        let (usual, longer) = (TurnOptions::default(), options);
        let edges = edges(&truth(), 0.3);
        let [usual, longer] =
            [usual, longer].map(|options| adjust_rotations(6, &edges, SIZE, &options).unwrap());
        let mean = |rotations: &RelativeRotations| {
            rotations
                .ptz
                .iter()
                .map(|ptz| ptz.focal_px.ln())
                .sum::<f64>()
                / 6.0
        };
        assert!((mean(&longer) - mean(&usual) - 1.06_f64.ln()).abs() < 1e-3);
        assert!(longer.residual_px > usual.residual_px);
    }

    #[test]
    fn frames_do_not_agree_better_by_shrinking() {
        let truth = RelativeRotations {
            lens: FocalCurve::NONE,
            ..truth()
        };
        let edges = edges(&truth, 0.7);
        let residual_px = |share: f64| {
            let view = |ptz: &Ptz| View {
                cam_from_common: ptz.cam_from_base(),
                focal_px: ptz.focal_px * share,
                principal_point: SIZE.centre(),
            };
            let state = EdgeState {
                views: truth.ptz.iter().map(view).collect(),
                lens: truth.lens,
            };
            residual_px(&edges, &state)
        };
        assert!(residual_px(1.0) < 1.5, "{}", residual_px(1.0));
        for share in [0.5, 0.1, 1e-3, 1e-9] {
            assert!(residual_px(share) > 20.0, "{share}: {}", residual_px(share));
        }
    }

    #[test]
    fn what_does_not_hang_together_is_refused() {
        let edges = edges(&truth(), 0.0);
        let alone = adjust_rotations(7, &edges, SIZE, &TurnOptions::default());
        assert_eq!(
            alone,
            Err(TrackError::TooFew {
                frames: 7,
                edges: edges.len()
            })
        );
        assert!(adjust_rotations(1, &[], SIZE, &TurnOptions::default()).is_err());
    }
}
