//! The residual of a match between two frames: both should see its point in the same direction.

use nalgebra::Matrix3x2;
use touchline_core::camera::{CameraBase, FocalCurve, PanTilt, Ptz, undistort};
use touchline_core::geometry::rotation::skew;
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};

/// A frame of a camera that rotates and zooms about a fixed centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Rotation from the common frame of all views to this camera.
    pub cam_from_common: Mat3,
    pub focal_px: f64,
    pub principal_point: ImagePoint,
}

/// The direction in which a frame sees a point, unit, in the common frame, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointDirection {
    pub direction: Vec3,
    /// By ln f, including the change of k₁ with the focal length.
    pub by_log_focal: Vec3,
    pub by_k1: Vec3,
}

impl View {
    /// A frame of a camera on a known base; the common frame is `base`.
    pub fn from_camera(base: &CameraBase, ptz: Ptz) -> Self {
        Self {
            cam_from_common: ptz.cam_from_base(),
            focal_px: ptz.focal_px,
            principal_point: base.principal_point,
        }
    }

    /// Back-projects a pixel to the common frame; `None` beyond the fold of the lens.
    pub fn direction(&self, at: ImagePoint, lens: &FocalCurve) -> Option<PointDirection> {
        // Remove the distortion: the ideal point u solves D(u) = d for the distorted point d = (x −
        // pp) / f. `undistort` iterates; the derivatives below need its result only.
        let radial = lens.radial_at(self.focal_px);
        let distorted = at.offset_from(self.principal_point) / self.focal_px;
        let ideal: Vec2 = undistort(distorted, radial).ok()?;
        let radius_squared = ideal.norm_squared();
        // Implicit differentiation of D(u, k₁) = d: ∂u/∂d = (∂D/∂u)⁻¹ and ∂u/∂k₁ = −(∂D/∂u)⁻¹
        // ∂D/∂k₁. The focal length scales d (∂d/∂ln f = −d) and changes k₁ along the lens curve.
        let ideal_by = radial.by_ideal(ideal).try_inverse()?;
        let by_k1 = -(ideal_by * radial.pixels_from_square(ideal))
            * lens.stretch_by_k1(self.focal_px, radius_squared);
        let by_log_focal = -(ideal_by * distorted) + by_k1 * (lens.slope_per_px() * self.focal_px);
        // Normalise v = (u, 1). A change of v moves the unit direction by (I − v̂ v̂ᵀ) / |v|; the
        // third component of v is constant, so two columns remain.
        let in_cam = Vec3::new(ideal.x, ideal.y, 1.0);
        let length = in_cam.norm();
        let unit = in_cam / length;
        let across = (Mat3::identity() - unit * unit.transpose()) / length;
        let common_from_cam = self.cam_from_common.transpose();
        let chain: Matrix3x2<f64> = common_from_cam * across.fixed_columns::<2>(0);
        Some(PointDirection {
            direction: common_from_cam * unit,
            by_log_focal: chain * by_log_focal,
            by_k1: chain * by_k1,
        })
    }

    /// The distance of a pixel from the centre of projection, √(f² + r²), px: by so much a small
    /// rotation of the direction across the radius displaces the pixel.
    ///
    /// Directions alone are no measure: as the focal length shrinks to zero, all directions agree.
    pub fn range_px(&self, at: ImagePoint) -> f64 {
        self.focal_px.hypot(at.distance_px(self.principal_point))
    }

    /// Pan and tilt of the optical axis, if the y axis of the common frame is the pan axis.
    pub fn ray(&self) -> PanTilt {
        PanTilt::from_direction(self.cam_from_common.row(2).transpose())
    }

    /// Pan, tilt and focal length, if the y axis of the common frame is the pan axis.
    pub fn ptz(&self) -> Ptz {
        let PanTilt { pan, tilt } = self.ray();
        Ptz::new(pan, tilt, self.focal_px)
    }

    /// The axes about which a direction rotates with pan and with tilt, in the common frame.
    pub fn pan_and_tilt_axes(&self) -> [Vec3; 2] {
        [Vec3::y(), self.cam_from_common.row(0).transpose()]
    }
}

impl PointDirection {
    /// The derivatives by the parameters of the lens curve, k₁(f) = value + slope (f − f₀) / 1000:
    /// by its value and by its slope.
    fn by_lens(&self, focal_px: f64, lens: &FocalCurve) -> [Vec3; 2] {
        [
            self.by_k1,
            self.by_k1 * ((focal_px - lens.at_focal_px) / 1000.0),
        ]
    }
}

/// The derivative of a direction by a rotation ω of the camera, R ← R exp(ω×), hence d ← d − ω × d.
pub(super) fn by_turn(direction: Vec3) -> Mat3 {
    skew(direction)
}

/// The residual of a match, px, and its derivatives.
///
/// The difference of the two unit directions is multiplied by the geometric mean of the two pixels'
/// distances from the centre of projection, so that it is in px and symmetric in the frames.
pub(super) struct MatchJacobian {
    pub value_px: Vec3,
    /// By k₁ and by its slope per 1000 px.
    pub by_lens: [Vec3; 2],
    /// By the first and by the second frame.
    pub by_frame: [MatchByFrame; 2],
}

/// The derivatives by one of the two frames: px/rad for rotations, px for ln f.
pub(super) struct MatchByFrame {
    /// By a rotation about the axes of the common frame, applied before the frame's own rotation.
    pub turn: Mat3,
    pub pan: Vec3,
    pub tilt: Vec3,
    pub log_focal: Vec3,
}

impl MatchByFrame {
    /// The derivatives of the residual `value_px` by the frame `view`, which sees the point in
    /// `direction` and at the distance `own_range_px` from its centre of projection.
    ///
    /// `weight_px` is the factor of the direction in the residual, √(ρ₁ρ₂): positive for the first
    /// frame, negative for the second.
    fn new(
        view: &View,
        direction: &PointDirection,
        own_range_px: f64,
        weight_px: f64,
        value_px: Vec3,
    ) -> Self {
        let [pan_axis, tilt_axis] = view.pan_and_tilt_axes();
        // The factor √(ρ₁ρ₂) depends on f, too: ∂ ln √(ρ₁ρ₂) / ∂ ln f = ½ (f/ρ)², ρ² = f² + r².
        let of_measure = 0.5 * (view.focal_px / own_range_px).powi(2);
        Self {
            turn: by_turn(direction.direction) * weight_px,
            pan: pan_axis.cross(&direction.direction) * weight_px,
            tilt: tilt_axis.cross(&direction.direction) * weight_px,
            log_focal: direction.by_log_focal * weight_px + value_px * of_measure,
        }
    }
}

impl MatchJacobian {
    /// The residual of the match `at`, one pixel per frame; `None` beyond the fold of a lens.
    pub fn new(views: [&View; 2], lenses: [&FocalCurve; 2], at: [ImagePoint; 2]) -> Option<Self> {
        // In which direction each frame sees the point, and by how many px a rotation moves it
        // there.
        let [one, other] = views;
        let (here, there) = (
            one.direction(at[0], lenses[0])?,
            other.direction(at[1], lenses[1])?,
        );
        let ranges_px = [one.range_px(at[0]), other.range_px(at[1])];
        let range_px = (ranges_px[0] * ranges_px[1]).sqrt();
        let value_px = (here.direction - there.direction) * range_px;
        // For frames that share one lens curve: it acts at two focal lengths, and its parts are
        // subtracted as the directions are.
        let (by_here, by_there) = (
            here.by_lens(one.focal_px, lenses[0]),
            there.by_lens(other.focal_px, lenses[1]),
        );
        Some(Self {
            value_px,
            by_lens: [0, 1].map(|of_lens| (by_here[of_lens] - by_there[of_lens]) * range_px),
            by_frame: [
                MatchByFrame::new(one, &here, ranges_px[0], range_px, value_px),
                MatchByFrame::new(other, &there, ranges_px[1], -range_px, value_px),
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Angle;
    use touchline_core::geometry::rotation::{from_rotation_vector, q_pan, q_tilt};

    fn view(pan: f64, tilt: f64, log_focal: f64) -> View {
        let cam_from_common = q_tilt(Angle::from_radians(tilt)) * q_pan(Angle::from_radians(pan));
        View {
            cam_from_common,
            focal_px: 1900.0 * log_focal.exp(),
            principal_point: ImagePoint::new(960.0, 540.0),
        }
    }

    #[test]
    fn a_sight_changes_as_its_derivatives_say() {
        let lens = FocalCurve {
            at_focal_px: 2000.0,
            value: -0.07,
            per_1000_px: 0.21,
            pixel_aspect: 0.8,
            ..FocalCurve::NONE
        };
        let at = ImagePoint::new(1700.0, 130.0);
        let here = view(0.3, -0.2, 0.0).direction(at, &lens).unwrap();
        let numeric =
            |of: &dyn Fn(f64) -> PointDirection| (of(1e-6).direction - of(-1e-6).direction) / 2e-6;
        let [pan_axis, tilt_axis] = view(0.3, -0.2, 0.0).pan_and_tilt_axes();
        let by_pan = numeric(&|step| view(0.3 + step, -0.2, 0.0).direction(at, &lens).unwrap());
        let by_tilt = numeric(&|step| view(0.3, -0.2 + step, 0.0).direction(at, &lens).unwrap());
        let by_focal = numeric(&|step| view(0.3, -0.2, step).direction(at, &lens).unwrap());
        let by_k1 = numeric(&|step| {
            view(0.3, -0.2, 0.0)
                .direction(
                    at,
                    &FocalCurve {
                        value: lens.value + step,
                        ..lens
                    },
                )
                .unwrap()
        });
        assert!((by_pan - pan_axis.cross(&here.direction)).norm() < 1e-8);
        assert!((by_tilt - tilt_axis.cross(&here.direction)).norm() < 1e-8);
        assert!((by_focal - here.by_log_focal).norm() < 1e-8);
        assert!((by_k1 - here.by_k1).norm() < 1e-8);
        for axis in 0..3 {
            let by = numeric(&|step| {
                let mut turn = Vec3::zeros();
                turn[axis] = step;
                let from = view(0.3, -0.2, 0.0);
                let turned = from.cam_from_common * from_rotation_vector(turn);
                View {
                    cam_from_common: turned,
                    ..from
                }
                .direction(at, &lens)
                .unwrap()
            });
            assert!(
                (by - by_turn(here.direction).column(axis)).norm() < 1e-8,
                "axis {axis}"
            );
        }
    }

    #[test]
    fn a_match_changes_with_lens_and_frames_as_its_derivatives_say() {
        let lens = FocalCurve {
            at_focal_px: 2000.0,
            value: -0.07,
            per_1000_px: 0.21,
            pixel_aspect: 0.8,
            ..FocalCurve::NONE
        };
        let at = [
            ImagePoint::new(1700.0, 130.0),
            ImagePoint::new(640.0, 210.0),
        ];
        let steps = [[0.3, -0.2, 0.0], [0.6, -0.19, 0.15]];
        let views =
            |steps: [[f64; 3]; 2]| steps.map(|[pan, tilt, log_focal]| view(pan, tilt, log_focal));
        let jacobian = |[one, other]: [View; 2], lens: FocalCurve| {
            MatchJacobian::new([&one, &other], [&lens, &lens], at).unwrap()
        };
        let here = jacobian(views(steps), lens);
        let agrees = |analytic: Vec3, of: &dyn Fn(f64) -> MatchJacobian, what: &str| {
            let numeric = (of(1e-6).value_px - of(-1e-6).value_px) / 2e-6;
            assert!(
                (analytic - numeric).norm() < 1e-4,
                "{what}: {analytic} is not {numeric}"
            );
        };
        let with_k1 = |by: f64| {
            jacobian(
                views(steps),
                FocalCurve {
                    value: lens.value + by,
                    ..lens
                },
            )
        };
        let with_slope = |by: f64| {
            jacobian(
                views(steps),
                FocalCurve {
                    per_1000_px: lens.per_1000_px + by,
                    ..lens
                },
            )
        };
        agrees(here.by_lens[0], &with_k1, "k1");
        agrees(here.by_lens[1], &with_slope, "slope of k1");
        for (frame, by) in here.by_frame.iter().enumerate() {
            for (parameter, analytic) in [by.pan, by.tilt, by.log_focal].into_iter().enumerate() {
                let stepped = |step: f64| {
                    let mut steps = steps;
                    steps[frame][parameter] += step;
                    jacobian(views(steps), lens)
                };
                agrees(
                    analytic,
                    &stepped,
                    &format!("frame {frame}, pan, tilt or zoom {parameter}"),
                );
            }
            for axis in 0..3 {
                let turned = |step: f64| {
                    let mut views = views(steps);
                    let turn = from_rotation_vector(Vec3::ith(axis, step));
                    views[frame].cam_from_common *= turn;
                    jacobian(views, lens)
                };
                agrees(
                    by.turn.column(axis).into_owned(),
                    &turned,
                    &format!("frame {frame}, turn {axis}"),
                );
            }
        }
    }
}
